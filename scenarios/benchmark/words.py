"""Strings of tables: errors, values, times; a dash where a program gives no answer."""

from __future__ import annotations

from collections.abc import Sequence

from scenarios.benchmark.score import Score, Scored

DASH = "-"
#: Names of the columns before those of the programs.
HEADS = ("case", "answer", "points", "published", "bound")


def rows_of_table(scored: Sequence[Scored], programs: Sequence[str]) -> list[list[str]]:
    """Return the table: a row for each answer of each case, and the largest error of each program."""
    rows = []
    for one in scored:
        for name, answer in one.case.answers.items():
            of_program = {each.program: each for each in one.scores if each.answer.name == name}
            first = next(iter(of_program.values()))
            head = [one.case.name, name, str(first.points), published(first), bound(first)]
            rows.append([*head, *(worst(of_program[program]) for program in programs)])
            if not answer.judged:
                rows[-1][4] = "shown only"
    return rows


def rows_of_cost(scored: Sequence[Scored], programs: Sequence[str]) -> list[list[str]]:
    """Return the processor time of a point: a row for each case, a column for each program."""
    rows = []
    for one in scored:
        costs = {each.program: each.cost for each in one.scores if each.cost is not None}
        rows.append([one.case.name, *(time(costs.get(program)) for program in programs)])
    return rows


def published(one: Score) -> str:
    """Return the published value, or the range of several, with the unit."""
    values = [value / one.answer.scale for value in one.published if value is not None]
    unit = "" if one.answer.unit == "1" else f" {one.answer.unit}"
    if not values:
        return DASH
    least, most = min(values), max(values)
    return f"{least:.7g}{unit}" if least == most else f"{least:.5g} to {most:.5g}{unit}"


def bound(one: Score) -> str:
    """Return the bound of an answer with its unit."""
    return DASH if one.answer.bound is None else size(one, one.answer.bound)


def worst(one: Score) -> str:
    """Return the error of largest size, and a mark if it exceeds the bound."""
    if one.worst is None:
        return DASH
    answered = "" if len(one.errors) == one.points else f" ({len(one.errors)} of {one.points})"
    return size(one, one.worst, "+") + answered + (" !" if one.holds is False else "")


def size(one: Score, error: float, sign: str = "") -> str:
    """Return an error in percent of the published value, or in the unit of the answer."""
    if one.answer.relative:
        return f"{100 * error:{sign}.3g} %"
    unit = "" if one.answer.unit == "1" else f" {one.answer.unit}"
    return f"{error / one.answer.scale:{sign}.3g}{unit}"


def time(seconds: float | None) -> str:
    """Return a processor time with a unit that suits it."""
    if seconds is None:
        return DASH
    for unit, scale in (("s", 1.0), ("ms", 1e-3)):
        if seconds >= scale:
            return f"{seconds / scale:.3g} {unit}"
    return f"{seconds / 1e-6:.3g} us"


def columns(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """Return a table as lines of text."""
    table = [heads, *rows]
    widths = [max(len(row[at]) for row in table) for at in range(len(heads))]
    return ["  ".join(map(str.ljust, row, widths)).rstrip() for row in table]


def sentence(scored: Sequence[Scored], program: str) -> str:
    """Return how many judged answers a program gives within their bounds, the first that it misses named."""
    judged = [one for each in scored for one in each.scores if one.program == program and one.answer.judged]
    given = [one for one in judged if one.holds is not None]
    missed = [f"{one.case.name}, {one.answer.name}" for one in given if not one.holds]
    said = f"{program} answers {len(given)} of {len(judged)} judged questions, {len(given) - len(missed)} within bounds"
    return f"{said}; outside: {'; '.join(missed)}." if missed else f"{said}."

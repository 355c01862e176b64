"""Strings of tables: errors, values, times; a dash where a program gives no answer."""

from __future__ import annotations

from collections.abc import Sequence

from scenarios.benchmark.band import Band
from scenarios.benchmark.case import Answer, Case
from scenarios.benchmark.score import Score, Scored

DASH = "-"
#: With more points the root mean square of the errors is shown too.
MANY = 20
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


#: Names of the columns of ranges.
RANGES = ("case", "point", "answer", "published", "value", "median", "5 to 95 %", "published in range", "draws")


def rows_of_bands(bands: Sequence[Band]) -> list[list[str]]:
    """Return the table of ranges: a row for each point and answer."""
    rows = []
    for one in bands:
        ends = DASH if one.lower is None else f"{quantity(one.answer, one.lower)} to {quantity(one.answer, one.upper)}"
        inside = {True: "yes", False: "no", None: DASH}[one.holds]
        values = [quantity(one.answer, value) for value in (one.published, one.value, one.median)]
        count = f"{one.draws}" if one.answered == one.draws else f"{one.answered} of {one.draws}"
        point = point_of(one.case, one.number - 1)
        rows.append([one.case.name, point, one.answer.name, *values, ends, inside, count])
    return rows


def rows_of_points(one: Scored) -> list[list[str]]:
    """Return every value of a case: point, answer, published value, and value and error of each program with one."""
    rows = []
    for number in range(len(one.case.points)):
        for name, answer in one.case.answers.items():
            told = one.case.points[number].published.get(name)
            for each in one.scores:
                value = each.values[number]
                if each.answer.name == name and value is not None and told is not None:
                    error = (value - told) / told if answer.relative else value - told
                    cells = [quantity(answer, told), each.program, quantity(answer, value), size(each, error, "+")]
                    rows.append([point_of(one.case, number), name, *cells])
    return rows


def point_of(case: Case, number: int) -> str:
    """Return the number of a point, and its own inputs that are numbers or strings."""
    point = case.points[number]
    own = [f"{name} {value_of(case, name, point.inputs[name])}" for name in point.own]
    return f"{number + 1}: {', '.join(own)}" if own else f"{number + 1}"


def value_of(case: Case, name: str, value: object) -> str:
    """Return an input with its unit; lists by their length."""
    if isinstance(value, tuple):
        return f"of {len(value)}"
    unit, scale = displayed(case.units[name])
    return f"{value / scale:.4g}{'' if unit == '1' else ' ' + unit}" if isinstance(value, float) else str(value)


def displayed(unit: str) -> tuple[str, float]:
    """Return the unit in which inputs are shown, and its SI value: speeds in km/h."""
    return ("km/h", 1 / 3.6) if unit == "m/s" else (unit, 1.0)


def quantity(answer: Answer, value: float | None) -> str:
    """Return a value with the unit of the answer."""
    unit = "" if answer.unit == "1" else f" {answer.unit}"
    return DASH if value is None else f"{value / answer.scale:.4g}{unit}"


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
    spread = f", rms {size(one, one.rms or 0.0)}" if len(one.errors) > MANY else ""
    return size(one, one.worst, "+") + spread + answered + (" !" if one.holds is False else "")


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

"""Strings of tables: errors, values, times; a dash where a program gives no answer."""

from __future__ import annotations

from collections.abc import Sequence

from scenarios.benchmark.band import Band
from scenarios.benchmark.case import AnswerQuantity, BenchmarkCase
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
    for band in bands:
        ends = (
            DASH
            if band.lower is None
            else f"{quantity(band.answer, band.lower)} to {quantity(band.answer, band.upper)}"
        )
        inside = {True: "yes", False: "no", None: DASH}[band.holds]
        values = [quantity(band.answer, value) for value in (band.published, band.value, band.median)]
        count = f"{band.draws}" if band.answered == band.draws else f"{band.answered} of {band.draws}"
        point = point_of(band.case, band.number - 1)
        rows.append([band.case.name, point, band.answer.name, *values, ends, inside, count])
    return rows


def rows_of_points(scored: Scored) -> list[list[str]]:
    """Return every value of a case: point, answer, published value, and value and error of each program with one."""
    rows = []
    for number in range(len(scored.case.points)):
        for name, answer in scored.case.answers.items():
            told = scored.case.points[number].published.get(name)
            for each in scored.scores:
                value = each.values[number]
                if each.answer.name == name and value is not None and told is not None:
                    error = (value - told) / told if answer.relative else value - told
                    cells = [quantity(answer, told), each.program, quantity(answer, value), size(each, error, "+")]
                    rows.append([point_of(scored.case, number), name, *cells])
    return rows


def point_of(case: BenchmarkCase, number: int) -> str:
    """Return the number of a point, and its own inputs that are numbers or strings."""
    point = case.points[number]
    own = [f"{name} {value_of(case, name, point.inputs[name])}" for name in point.own]
    return f"{number + 1}: {', '.join(own)}" if own else f"{number + 1}"


def value_of(case: BenchmarkCase, name: str, value: object) -> str:
    """Return an input with its unit; lists by their length."""
    if isinstance(value, tuple):
        return f"of {len(value)}"
    unit, scale = displayed(case.units[name])
    return f"{value / scale:.4g}{'' if unit == '1' else ' ' + unit}" if isinstance(value, float) else str(value)


def displayed(unit: str) -> tuple[str, float]:
    """Return the unit in which inputs are shown, and its SI value: speeds in km/h."""
    return ("km/h", 1 / 3.6) if unit == "m/s" else (unit, 1.0)


def quantity(answer: AnswerQuantity, value: float | None) -> str:
    """Return a value with the unit of the answer."""
    unit = "" if answer.unit == "1" else f" {answer.unit}"
    return DASH if value is None else f"{value / answer.scale:.4g}{unit}"


def published(score: Score) -> str:
    """Return the published value, or the range of several, with the unit."""
    values = [value / score.answer.scale for value in score.published if value is not None]
    unit = "" if score.answer.unit == "1" else f" {score.answer.unit}"
    if not values:
        return DASH
    least, most = min(values), max(values)
    return f"{least:.7g}{unit}" if least == most else f"{least:.5g} to {most:.5g}{unit}"


def bound(score: Score) -> str:
    """Return the bound of an answer with its unit."""
    return DASH if score.answer.bound is None else size(score, score.answer.bound)


def worst(score: Score) -> str:
    """Return the error of largest size, and a mark if it exceeds the bound."""
    if score.worst is None:
        return DASH
    answered = "" if len(score.errors) == score.points else f" ({len(score.errors)} of {score.points})"
    spread = f", rms {size(score, score.rms or 0.0)}" if len(score.errors) > MANY else ""
    return size(score, score.worst, "+") + spread + answered + (" !" if score.holds is False else "")


def size(score: Score, error: float, sign: str = "") -> str:
    """Return an error in percent of the published value, or in the unit of the answer."""
    if score.answer.relative:
        return f"{100 * error:{sign}.3g} %"
    unit = "" if score.answer.unit == "1" else f" {score.answer.unit}"
    return f"{error / score.answer.scale:{sign}.3g}{unit}"


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
    judged = [score for each in scored for score in each.scores if score.program == program and score.answer.judged]
    given = [one for one in judged if one.holds is not None]
    missed = [f"{one.case.name}, {one.answer.name}" for one in given if not one.holds]
    said = f"{program} answers {len(given)} of {len(judged)} judged questions, {len(given) - len(missed)} within bounds"
    return f"{said}; outside: {'; '.join(missed)}." if missed else f"{said}."

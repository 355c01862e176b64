"""A report on a controller as lines for the terminal."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence

from bogie_braking.controllers.acceptance import (
    ACCEPTED,
    FAILS,
    NO_STOP,
    OPEN,
    PASSES,
    STOPS,
    UNDECIDED,
    Finding,
    verdict_of,
)
from bogie_braking.controllers.verdict import WIDTH
from bogie_braking.reporting.text_table import text_table
from products.protection.criteria import Criterion

#: Sentence of every report.
NO_CLAIM = (
    "No claim of conformity: cases and criteria are in the manner of EN 15595 and UIC 541-05, which could not be read; "
    "all stops are simulated."
)
HEADS = ("criterion", "limit", "cases", "fail", "undecided", "worst", "95 %", "in the case", "verdict")
NUMBERS = ("cases", "fail", "undecided", "worst", "95 %")
FAILED_HEADS = ("case", "criterion", "value", "95 %", "limit", "verdict")
#: Most findings of a criterion that the terminal shows.
MOST_SHOWN = 3
#: Half of an interval over the value that is shown as 0 [1].
NEGLIGIBLE = 1e-4
#: Most failures that a message names.
MOST_NAMED = 3


def headline(name: str, found: Sequence[Finding], criteria: Sequence[Criterion]) -> str:
    """Return the verdict on a controller with the first criteria that it fails, each in its worst case."""
    verdict, cases = verdict_of(found), len({one.case for one in found})
    if verdict == ACCEPTED:
        return f"accepted: {name} passes all {1 + len(criteria)} criteria in {cases} cases."
    wrong = FAILS if any(one.verdict == FAILS for one in found) else UNDECIDED
    limits = {one.name: one for one in criteria}
    worst: dict[str, Finding] = {}
    for one in found:
        if one.verdict == wrong and worse(one, worst.get(one.criterion), limits.get(one.criterion)):
            worst[one.criterion] = one
    named = [described(one, limits.get(one.criterion)) for one in worst.values()]
    more = f"; and {len(named) - MOST_NAMED} more criteria" if len(named) > MOST_NAMED else ""
    does = "fails" if wrong == FAILS else "cannot be judged by"
    many = f"{len(named)} of {1 + len(criteria)} criteria"
    return f"{verdict}: {name} {does} {many}: {'; '.join(named[:MOST_NAMED])}{more}."


def worse(finding: Finding, other: Finding | None, criterion: Criterion | None) -> bool:
    """Return whether a finding is worse than another of the same criterion."""
    if other is None or finding.value is None or other.value is None:
        return other is None
    return excess(finding, criterion) > excess(other, criterion)


def excess(finding: Finding, criterion: Criterion | None) -> float:
    """Return by how much a value is beyond its limit; 0 without either."""
    if criterion is None or finding.value is None:
        return 0.0
    return (finding.value - criterion.limit) * (1.0 if criterion.at_most else -1.0)


def described(finding: Finding, criterion: Criterion | None) -> str:
    """Return a finding in words: criterion, value with its limit, and case."""
    if criterion is None or finding.value is None:
        return f"{finding.criterion}: {finding.reason.removesuffix('.')} (in the case {finding.case})"
    return f"{finding.criterion} {amount(finding, criterion)}, {limit_of(criterion)} (in the case {finding.case})"


def number(value: float) -> str:
    """Return a number with four digits, without trailing zeros."""
    return f"{value:.4g}" if abs(value) < 1e4 else f"{value:.0f}"


def amount(finding: Finding, criterion: Criterion) -> str:
    """Return the value of a finding with half of its interval and its unit."""
    if finding.value is None:
        return finding.reason
    half = f" ± {number_of_half(finding)}" if finding.half else ""
    return f"{number(finding.value)}{half}{'' if criterion.unit == '1' else f' {criterion.unit}'}"


def number_of_half(finding: Finding) -> str:
    """Return half of an interval with two digits, 0 if it is below the digits of the value."""
    return f"{finding.half:.2g}" if finding.half > NEGLIGIBLE * abs(finding.value or 0.0) else "0"


def limit_of(criterion: Criterion | None) -> str:
    """Return the limit of a criterion in words."""
    if criterion is None:
        return "in every draw"
    unit = "" if criterion.unit == "1" else f" {criterion.unit}"
    return f"at {'most' if criterion.at_most else 'least'} {number(criterion.limit)}{unit}"


def lines(name: str, found: Sequence[Finding], criteria: Sequence[Criterion]) -> Iterator[str]:
    """Yield the verdict, a table of the criteria, and one of the findings that do not pass."""
    yield from textwrap.wrap(headline(name, found, criteria), WIDTH)
    yield from textwrap.wrap(NO_CLAIM, WIDTH)
    yield ""
    rows = [HEADS, *criteria_rows(found, criteria)]
    yield from text_table(rows, [HEADS.index(head) for head in HEADS if head not in NUMBERS], [1])
    rows = failed_rows(found, criteria)
    if rows:
        firsts = [row for row in rows if row in [one for one in rows if one[1] == row[1]][:MOST_SHOWN]]
        yield ""
        yield from text_table([FAILED_HEADS, *firsts], (0, 1, 4, 5), [1])
        if len(firsts) < len(rows):
            yield f"and {len(rows) - len(firsts)} more, which report.json has"


def criteria_rows(found: Sequence[Finding], criteria: Sequence[Criterion]) -> list[tuple[str, ...]]:
    """Return a row for each criterion, with its worst case."""
    rows = []
    for criterion in (None, *criteria):
        name = criterion.name if criterion else STOPS
        own = [one for one in found if one.criterion == name]
        valued = [one for one in own if one.value is not None] or own
        worst = max(valued, key=lambda one: excess(one, criterion))
        counts = [sum(one.verdict == which for one in own) for which in (FAILS, UNDECIDED)]
        value, half = ("-", "-") if criterion is None else cells_of(worst)
        where = "-" if criterion is None or worst.value is None else worst.case
        rows.append((name, limit_of(criterion), str(len(own)), *map(str, counts), value, half, where, of_all(own)))
    return rows


def of_all(own: Sequence[Finding]) -> str:
    """Return the verdict on one criterion."""
    verdicts = {one.verdict for one in own}
    return FAILS if FAILS in verdicts else UNDECIDED if UNDECIDED in verdicts else PASSES


def cells_of(finding: Finding) -> tuple[str, str]:
    """Return the value and half of its interval as cells of a table."""
    if finding.value is None:
        return "-", "-"
    return number(finding.value), f"±{number_of_half(finding)}" if finding.half else "-"


def failed_rows(found: Sequence[Finding], criteria: Sequence[Criterion]) -> list[tuple[str, ...]]:
    """Return the findings that do not pass as rows: criterion by criterion, failures first, the worst of them first."""
    limits, rows = {one.name: one for one in criteria}, list[tuple[str, ...]]()
    names = [STOPS, *limits]

    def place(finding: Finding) -> tuple[int, bool, float]:
        return names.index(finding.criterion), finding.verdict != FAILS, -excess(finding, limits.get(finding.criterion))

    for one in sorted(found, key=place):
        if one.verdict != PASSES and one.reason != NO_STOP:
            value, half = cells_of(one) if one.criterion in limits else ("-", "-")
            verdict = f"{one.verdict} ({one.reason.removesuffix('.')})" if one.reason else one.verdict
            rows.append((one.case, one.criterion, value, half, limit_of(limits.get(one.criterion)), verdict))
    return rows


def undecided_note(found: Sequence[Finding], most: int) -> str:
    """Return a note if draws do not decide a finding; empty otherwise."""
    open_ones = [one for one in found if one.verdict == UNDECIDED and one.half]
    if verdict_of(found) != OPEN or not open_ones:
        return ""
    return f"{len(open_ones)} findings are not decided by {most} draws; take more with --draws."

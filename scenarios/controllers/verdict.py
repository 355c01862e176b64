"""What a comparison comes to: a row for each controller, and in a sentence which is best and where each is worst."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from statistics import median

from products.protection.rails import LONGEST_LOCK
from scenarios.controllers.given import ALWAYS
from scenarios.controllers.scoring import Scored
from scenarios.controllers.words import STOPS, Words, words_of

HEADS = (
    "controller",
    "{does}",
    "{none}",
    "locks",
    "median over ideal",
    "worst",
    "in the case",
    "longest lock",
    "mean air",
)
UNITS = ("", "1", "1", "1", "1", "1", "", "s", "l")
#: Columns of words; the others are numbers.
WORDS = ("controller", "in the case")
WIDTH = 120
#: Ratios that differ by less are alike [1]: 0.5 % is what the rig and coupled FMUs differ by.
ALIKE = 0.005


@dataclass(frozen=True)
class Verdict:
    """What a controller came to in all cases.

    stopped, failed: cases in which it stopped, and in which it did not; locked: those with a lock of more than
    LONGEST_LOCK; median, worst: distance over the ideal where it
    stopped, None where there is none to compare with; worst_case: the first in which it did not stop, or that of the
    worst; longest_lock [s]; air [l], the mean.
    """

    controller: str
    stopped: int
    failed: int
    locked: int
    median: float | None
    worst: float | None
    worst_case: str
    longest_lock: float
    air: float
    words: Words = STOPS

    @property
    def rank(self) -> tuple[float, float, float, float]:
        """Fewest failures first, then the fewest locks, then the smallest median, then the smallest worst."""
        ratios = [math.inf if one is None else round(one / ALIKE) * ALIKE for one in (self.median, self.worst)]
        return self.failed, self.locked, ratios[0], ratios[1]


def verdicts(scores: Sequence[Scored]) -> list[Verdict]:
    """One for each controller, in their order."""
    names = dict.fromkeys(one.controller for one in scores)
    return [verdict(name, [one for one in scores if one.controller == name]) for name in names]


def verdict(name: str, own: Sequence[Scored]) -> Verdict:
    """Of one controller, whose scores these are."""
    ratios = {one.case: ratio for one in own if (ratio := one.over(one.ideal)) is not None}
    failed = [one.case for one in own if one.stop.distance is None]
    worst = max(ratios, key=lambda case: ratios[case]) if ratios else ""
    return Verdict(
        name,
        len(own) - len(failed),
        len(failed),
        sum(one.stop.longest_lock > LONGEST_LOCK for one in own),
        median(ratios.values()) if ratios else None,
        ratios.get(worst),
        failed[0] if failed else worst,
        max(one.stop.longest_lock for one in own),
        sum(one.air for one in own) / len(own),
        words_of(own[0].driven),
    )


def sentences(found: Sequence[Verdict]) -> list[str]:
    """Which is best; and where each is worst, but for the wheels that nothing protects."""
    order = sorted(found, key=lambda one: one.rank)
    best, cases = [one for one in order if one.rank == order[0].rank], found[0].stopped + found[0].failed
    words = found[0].words
    if not best[0].stopped:
        return [f"No controller {words.does} in any case."]
    names = " and ".join(one.controller for one in best)
    who = (
        "All controllers are alike" if len(best) == len(found) else f"{names} {'is' if len(best) == 1 else 'are'} best"
    )
    where = "in every case" if best[0].stopped == cases else f"in {best[0].stopped} of {cases} cases"
    said = [f"{who}: {f'it {words.does}' if len(best) == 1 else f'they {words.do}'} {where}{_median(best[0], cases)}."]
    worst = [_worst(one) for one in order if one.controller != "none"]
    return said if len(best) == len(found) or cases == 1 else [*said, f"Where each is worst: {'; '.join(worst)}."]


def _median(one: Verdict, cases: int) -> str:
    ratio = "" if one.median is None else f", after {one.median:.2f} of the ideal distance"
    return f"{ratio} in the median" if ratio and cases > 1 else ratio


def _worst(one: Verdict) -> str:
    more = f" and {one.failed - 1} more" if one.failed > 1 else ""
    ratio = one.words.none if one.failed else "no ideal" if one.worst is None else f"{one.worst:.2f}"
    return f"{one.controller} {ratio} ({one.worst_case}{more})" if one.worst_case else f"{one.controller} {ratio}"


def lines(found: Sequence[Verdict]) -> Iterator[str]:
    """The sentences, and the table for people."""
    yield from textwrap.wrap(" ".join(sentences(found)), WIDTH)
    yield ""
    rows = [heads(found), UNITS, *(cells(one) for one in found)]
    widths = [max(len(row[column]) for row in rows) for column in range(len(HEADS))]
    for number, row in enumerate(rows):
        if number == 2:
            yield "-" * (sum(widths) + 2 * (len(widths) - 1))
        texts = (
            text.ljust(width) if head in WORDS else text.rjust(width)
            for head, text, width in zip(rows[0], row, widths, strict=True)
        )
        yield "  ".join(texts).rstrip()


def heads(found: Sequence[Verdict]) -> tuple[str, ...]:
    """Of the table's columns."""
    words = found[0].words
    return tuple(head.format(does=words.does, none=words.none) for head in HEADS)


def cells(one: Verdict) -> tuple[str, ...]:
    """A row of the table."""
    ratios = ("-" if ratio is None else f"{ratio:.2f}" for ratio in (one.median, one.worst))
    rest = f"{one.longest_lock:.2f}", f"{one.air:.0f}"
    return one.controller, f"{one.stopped}", f"{one.failed}", f"{one.locked}", *ratios, one.worst_case or "-", *rest


def document(found: Sequence[Verdict]) -> dict[str, object]:
    """For programs."""
    return {
        "sentences": sentences(found),
        "controllers": [{k: v for k, v in asdict(one).items() if k != "words"} for one in found],
    }


def best_given(found: Sequence[Verdict]) -> Verdict:
    """The best of the controllers that were given, or of all where none was."""
    given = [one for one in found if one.controller not in ALWAYS]
    return min(given or found, key=lambda one: one.rank)

"""Result of a comparison: a row for each controller, and a message with the best one and the worst case of each."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from statistics import fmean as mean
from statistics import median

from products.protection.rails import LONGEST_LOCK
from scenarios.controllers.controller_loader import ALWAYS
from scenarios.controllers.scoring import Scored, sliding_cases
from scenarios.controllers.words import STOPS, Words, words_of

HEADS = (
    "controller",
    "{does}",
    "{none}",
    "locks",
    "median over ideal",
    "spread",
    "worst",
    "in the case",
    "longest lock",
    "mean air",
)
UNITS = ("", "1", "1", "1", "1", "1", "1", "", "s", "l")
#: Columns of words; the others are numbers.
WORDS = ("controller", "in the case")
WIDTH = 120
#: Ratios that differ by less are alike [1]: 0.5 % is the difference between the rig and coupled FMUs.
ALIKE = 0.005


@dataclass(frozen=True)
class Ratio:
    """A distance over the ideal [1]: mean, smallest and largest over the phases of sampling."""

    mean: float
    least: float
    most: float

    @property
    def spread(self) -> float:
        """Return the largest less the smallest."""
        return self.most - self.least

    def is_like(self, other: Ratio) -> bool:
        """Return whether both differ by less than the scatter of the sampling phase, or of the rig."""
        return abs(self.mean - other.mean) <= max(ALIKE, (self.spread + other.spread) / 2)


@dataclass(frozen=True)
class Verdict:
    """Results of a controller in all evaluated cases; its distances in those in which a wheel slides.

    stopped: cases with a stop in every phase; failed: cases without; not_judged: cases without a verdict; sliding:
    cases with a sliding wheel; locked: those with a lock of more than LONGEST_LOCK; median, worst: distance over the
    ideal of its stops, None without an ideal; worst_case: the first failed case, or that of the worst; longest_lock
    [s]; air [l], the mean.
    """

    controller: str
    stopped: int
    failed: int
    locked: int
    median: Ratio | None
    worst: Ratio | None
    worst_case: str
    longest_lock: float
    air: float
    words: Words = STOPS
    not_judged: int = 0
    sliding: int = 0

    @property
    def cases(self) -> int:
        """Return the number of cases."""
        return self.stopped + self.failed + self.not_judged

    @property
    def counts(self) -> tuple[bool, int, int]:
        """Return the criteria that precede distances: verdicts in all cases, then the fewest failures, then the fewest
        locks.
        """
        return self.not_judged > 0, self.failed, self.locked

    @property
    def rank(self) -> tuple[tuple[bool, int, int], float, float]:
        """Return the counts, then the median, then the worst, the smallest of each first."""
        median, worst = (math.inf if one is None else one.mean for one in (self.median, self.worst))
        return self.counts, median, worst


def leaders(found: Sequence[Verdict]) -> list[Verdict]:
    """Return the best controllers: those with the best counts whose median, and then worst, is like the smallest."""
    best = [one for one in found if one.counts == min(other.counts for other in found)]
    for name in ("median", "worst"):
        ratios = [ratio for one in best if (ratio := getattr(one, name)) is not None]
        if ratios:
            least = min(ratios, key=lambda ratio: ratio.mean)
            best = [one for one in best if (ratio := getattr(one, name)) is not None and least.is_like(ratio)]
    return best


def verdicts(scores: Sequence[Scored]) -> list[Verdict]:
    """Return one verdict for each controller, in their order."""
    names = dict.fromkeys(one.controller for one in scores)
    sliding = sliding_cases(scores)
    return [verdict(name, [one for one in scores if one.controller == name], sliding) for name in names]


def verdict(name: str, own: Sequence[Scored], sliding: Sequence[str]) -> Verdict:
    """Return the verdict on the scores `own` of one controller; sliding: the cases that count in the median."""
    judged = [one for one in own if one.stop.judged]
    every = {one.case: ratios for one in judged if (ratios := one.ratios)}
    each = list(zip(*(ratios for case, ratios in every.items() if case in sliding), strict=True))
    failed = [one.case for one in judged if one.stop.distance is None]
    worst = max(every, key=lambda case: mean(every[case])) if every else ""
    return Verdict(
        name,
        len(judged) - len(failed),
        len(failed),
        sum(one.stop.longest_lock > LONGEST_LOCK for one in judged),
        ratio([median(of_phase) for of_phase in each]),
        ratio(every.get(worst, ())),
        failed[0] if failed else worst,
        max((one.stop.longest_lock for one in judged), default=math.nan),
        sum(one.air for one in judged) / len(judged) if judged else math.nan,
        words_of(own[0].driven),
        len(own) - len(judged),
        len(sliding),
    )


def ratio(phases: Sequence[float]) -> Ratio | None:
    """Return the ratio of a value in each phase; None without phases."""
    return Ratio(mean(phases), min(phases), max(phases)) if phases else None


def messages(found: Sequence[Verdict]) -> list[str]:
    """Return messages: the best controllers, the worst case of each except the unprotected wheels, and missing
    verdicts.
    """
    best = leaders(found)
    order = [*best, *sorted((one for one in found if one not in best), key=lambda one: one.rank)]
    words, cases = found[0].words, found[0].cases
    silent = [f"{one.controller} ({one.not_judged} of {cases} cases)" for one in found if one.not_judged]
    rest = [f"Not judged, and so not ranked: {'; '.join(silent)}."] if silent else []
    if not any(one.stopped for one in found):
        return rest if silent else [f"No controller {words.does} in any case."]
    names = " and ".join(one.controller for one in best)
    who = (
        "All controllers are alike" if len(best) == len(found) else f"{names} {'is' if len(best) == 1 else 'are'} best"
    )
    where = "in every case" if best[0].stopped == cases else f"in {best[0].stopped} of {cases} cases"
    said = [f"{who}: {f'it {words.does}' if len(best) == 1 else f'they {words.do}'} {where}{_median(best[0], cases)}."]
    worst = [_worst(one) for one in order if one.controller != "none" and one.stopped + one.failed]
    alike = len(best) == len(found) or cases == 1
    return [*said, *rest] if alike else [*said, f"Where each is worst: {'; '.join(worst)}.", *rest]


def _median(one: Verdict, cases: int) -> str:
    ratio = "" if one.median is None else f", after {one.median.mean:.2f} of the ideal distance"
    if not ratio or cases == 1:
        return ratio
    if one.sliding == 1:
        return f"{ratio} where wheels slide"
    return f"{ratio} in the median" + ("" if one.sliding == cases else f" of the {one.sliding} where wheels slide")


def _worst(one: Verdict) -> str:
    more = f" and {one.failed - 1} more" if one.failed > 1 else ""
    ratio = one.words.none if one.failed else "no ideal" if one.worst is None else f"{one.worst.mean:.2f}"
    return f"{one.controller} {ratio} ({one.worst_case}{more})" if one.worst_case else f"{one.controller} {ratio}"


def lines(found: Sequence[Verdict]) -> Iterator[str]:
    """Yield the messages, and the table as text."""
    yield from textwrap.wrap(" ".join(messages(found)), WIDTH)
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
    """Return the heads of the table's columns."""
    words = found[0].words
    return tuple(head.format(does=words.does, none=words.none) for head in HEADS)


def cells(one: Verdict) -> tuple[str, ...]:
    """Return a row of the table."""
    if not one.stopped + one.failed:
        return one.controller, *["-"] * (len(HEADS) - 1)
    median, worst = ("-" if ratio is None else f"{ratio.mean:.2f}" for ratio in (one.median, one.worst))
    ratios = median, "-" if one.median is None else f"{one.median.spread:.3f}", worst
    rest = f"{one.longest_lock:.2f}", f"{one.air:.0f}"
    return one.controller, f"{one.stopped}", f"{one.failed}", f"{one.locked}", *ratios, one.worst_case or "-", *rest


def document(found: Sequence[Verdict]) -> dict[str, object]:
    """Return the results for programs; missing verdicts are null."""

    def row(one: Verdict) -> dict[str, object]:
        means = {name: ratio and ratio.mean for name in ("median", "worst") for ratio in [getattr(one, name)]}
        spreads = {f"{name}_spread": ratio and ratio.spread for name in means for ratio in [getattr(one, name)]}
        plain = {name: None if value != value else value for name, value in asdict(one).items() if name != "words"}
        return plain | means | spreads

    return {"messages": messages(found), "controllers": [row(one) for one in found]}


def best_given(found: Sequence[Verdict]) -> Verdict:
    """Return the best of the given controllers, or of all without a given one."""
    return leaders([one for one in found if one.controller not in ALWAYS] or found)[0]

"""Result of a comparison: a row for each controller, and a message with the best one and the worst case of each."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bogie_braking.controllers.controller_loader import ALWAYS
from bogie_braking.controllers.estimate import LEVEL, Estimate, Sample, across, less
from bogie_braking.controllers.scoring import LOOKS, STOP_WORDS, ScoredController, Words, slid_cases, sliding_cases
from bogie_braking.controllers.table import half
from bogie_braking.reporting.text_table import text_table
from products.protection.rails import LONGEST_LOCK

HEADS = (
    "controller",
    "{does}",
    "{none}",
    "locks",
    "median over ideal",
    "95 %",
    "worst",
    "in the case",
    "harm",
    "longest lock",
    "mean air",
)
UNITS = ("", "1", "1", "1", "1", "1", "1", "", "", "s", "l")
#: Columns of words; the others are numbers.
WORDS = ("controller", "in the case", "harm")
WIDTH = 120
#: Ratios that differ by less are alike [1]: 0.5 % is the difference between the rig and coupled FMUs.
ALIKE = 0.005
#: Criteria of distance by which two controllers are compared: the median and the worst case.
CRITERIA = 2
#: Largest growth of a distance that is not counted as harm where no wheel slides [1].
NO_HARM = 0.001


@dataclass(frozen=True)
class Harm:
    """Harm in the cases in which no wheel slides.

    cases: their number. longer: largest growth of the mean distance by the controller [1]. half: half of its interval.
    case: the case of this growth. moved: number of cases in which a valve moved.
    """

    cases: int
    longer: float
    half: float
    case: str
    moved: int

    @property
    def words(self) -> str:
        """Return the harm in a few words."""
        if self.longer > NO_HARM:
            return f"{100 * self.longer:+.1f} % ({self.case})"
        return "valves move" if self.moved else "none"


@dataclass(frozen=True)
class Verdict:
    """Results of a controller in all evaluated cases; its distances in those in which a wheel slides.

    stopped: cases with a stop in every draw. failed: other cases. not_judged: cases without a verdict. sliding: cases
    with a sliding wheel. locked: cases with a lock of more than LONGEST_LOCK. medians: median of the distances over the
    ideal in each draw. largest: those of the worst case. Both are None without an ideal. worst_case: the first failed
    case, or the worst. harm: where no wheel slides. longest_lock [s]. air: mean [l].
    """

    controller: str
    stopped: int
    failed: int
    locked: int
    medians: Sample | None
    largest: Sample | None
    worst_case: str
    harm: Harm | None
    longest_lock: float
    air: float
    words: Words = STOP_WORDS
    not_judged: int = 0
    sliding: int = 0

    @property
    def median(self) -> Estimate | None:
        """Return the median of the distances over the ideal [1]."""
        return None if self.medians is None else self.medians.estimate()

    @property
    def worst(self) -> Estimate | None:
        """Return the distance over the ideal in the worst case [1]."""
        return None if self.largest is None else self.largest.estimate()

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


def level_of(controllers: int) -> float:
    """Return the probability of one interval of a difference, so that all of a comparison hold with LEVEL.

    Bonferroni: each pair of controllers is compared by the criteria of distance, at most len(LOOKS) times. All pairs
    count because the draws decide which controller is the best.
    """
    return 1.0 - (1.0 - LEVEL) / (CRITERIA * max(math.comb(controllers, 2), 1) * len(LOOKS))


def differs(sample: Sample, least: Sample, level: float) -> bool:
    """Return whether two controllers are told apart: by more than ALIKE and, with two draws or more, by their draws."""
    difference = less(sample, least).estimate(level)
    return abs(difference.mean) > ALIKE and (difference.differs or difference.count < 2)


def settled(sample: Sample, least: Sample, level: float) -> bool:
    """Return whether more draws change nothing: the interval of the difference lies on one side of ALIKE."""
    difference = less(sample, least).estimate(level)
    return difference.half < abs(abs(difference.mean) - ALIKE)


def leaders(found: Sequence[Verdict]) -> list[Verdict]:
    """Return the best controllers.

    They have the best counts. Then those remain that are not told apart from the one with the smallest median, and then
    from the one with the smallest worst.
    """
    best, level = [one for one in found if one.counts == min(other.counts for other in found)], level_of(len(found))
    for name in ("medians", "largest"):
        samples = [(one, sample) for one in best if (sample := getattr(one, name)) is not None]
        if samples:
            least = min((sample for _, sample in samples), key=lambda sample: float(sample.values.mean()))
            best = [one for one, sample in samples if not differs(sample, least, level)]
    return best


def unsettled(scores: Sequence[ScoredController]) -> set[str]:
    """Return all cases while further draws may change which controllers are told apart from the best."""
    found = verdicts(scores)
    best, level = [one for one in found if one.counts == min(other.counts for other in found)], level_of(len(found))
    for name in ("medians", "largest"):
        samples = [sample for one in best if (sample := getattr(one, name)) is not None]
        least = min(samples, key=lambda sample: float(sample.values.mean()), default=None)
        if least is not None and not all(settled(one, least, level) for one in samples if one is not least):
            return {score.case for score in scores}
    return set()


def verdicts(scores: Sequence[ScoredController]) -> list[Verdict]:
    """Return one verdict for each controller, in their order."""
    names = dict.fromkeys(one.controller for one in scores)
    sliding, slid = sliding_cases(scores), slid_cases(scores)
    without = {score.case: score for score in scores if score.controller == "none" and score.case not in slid}
    return [verdict(name, [one for one in scores if one.controller == name], sliding, without) for name in names]


def verdict(
    name: str, own: Sequence[ScoredController], sliding: Sequence[str], without: Mapping[str, ScoredController]
) -> Verdict:
    """Return the verdict on the scores of one controller."""
    judged = [one for one in own if one.stop.judged]
    every = {one.case: ratios for one in judged if (ratios := one.ratios) is not None}
    counted = [ratios for case, ratios in every.items() if case in sliding]
    failed = [one.case for one in judged if one.stop.distance is None]
    worst = max(every, key=lambda case: float(every[case].values.mean())) if every else ""
    return Verdict(
        name,
        len(judged) - len(failed),
        len(failed),
        sum(one.stop.longest_lock > LONGEST_LOCK for one in judged),
        across(counted, lambda values: np.median(values, axis=0)) if counted else None,
        every.get(worst),
        failed[0] if failed else worst,
        harm_of(judged, without),
        max((one.stop.longest_lock for one in judged), default=math.nan),
        sum(one.air for one in judged) / len(judged) if judged else math.nan,
        own[0].words,
        len(own) - len(judged),
        len(sliding),
    )


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
    who = f"{names} {'is' if len(best) == 1 else 'are'} best"
    if 1 < len(best) == len(found):
        who = "No controller is best"
    where = "in every case" if best[0].stopped == cases else f"in {best[0].stopped} of {cases} cases"
    said = [f"{who}: {f'it {words.does}' if len(best) == 1 else f'they {words.do}'} {where}{_median(best, cases)}."]
    if len(best) > 1:
        said = [f"{said[0]} They cannot be told apart."]
    worst = [_worst(one) for one in order if one.controller != "none" and one.stopped + one.failed]
    alike = len(best) == len(found) or cases == 1
    return [*said, *rest] if alike else [*said, f"Where each is worst: {'; '.join(worst)}.", *rest]


def _median(best: Sequence[Verdict], cases: int) -> str:
    """Return the medians of the best controllers, from the smallest to the largest, in words."""
    one, means = best[0], [of.median.mean for of in best if of.median is not None]
    if not means:
        return ""
    ends = dict.fromkeys(f"{mean:.2f}" for mean in (min(means), max(means)))
    ratio = f", after {' to '.join(ends)} of the ideal distance"
    if cases == 1:
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
    yield from text_table(rows, [HEADS.index(head) for head in WORDS], [2])


def heads(found: Sequence[Verdict]) -> tuple[str, ...]:
    """Return the heads of the table's columns."""
    words = found[0].words
    return tuple(head.format(does=words.does, none=words.none) for head in HEADS)


def cells(one: Verdict) -> tuple[str, ...]:
    """Return a row of the table."""
    if not one.stopped + one.failed:
        return one.controller, *["-"] * (len(HEADS) - 1)
    median, worst = ("-" if ratio is None else f"{ratio.mean:.3f}" for ratio in (one.median, one.worst))
    ratios = median, "-" if one.median is None else half(one.median, 1.0, ".3f"), worst
    rest = "-" if one.harm is None else one.harm.words, f"{one.longest_lock:.2f}", f"{one.air:.0f}"
    return one.controller, f"{one.stopped}", f"{one.failed}", f"{one.locked}", *ratios, one.worst_case or "-", *rest


def document(found: Sequence[Verdict]) -> dict[str, object]:
    """Return the results for programs; missing verdicts are null."""
    level = level_of(len(found))

    def row(one: Verdict) -> dict[str, object]:
        names = ("controller", "stopped", "failed", "locked", "not_judged", "sliding", "longest_lock", "air")
        plain = {name: None if (value := getattr(one, name)) != value else value for name in names}
        ratios = {name: interval(getattr(one, name)) for name in ("median", "worst")}
        harm = None if one.harm is None else vars(one.harm)
        return plain | ratios | {"worst_case": one.worst_case, "harm": harm}

    apart = [
        {"controllers": [one.controller, other.controller], "level": level}
        | {name: interval(less(a, b).estimate(level)), "told_apart": a.values.size > 1 and differs(a, b, level)}
        for number, one in enumerate(found)
        for other in found[number + 1 :]
        for name, of in (("median", "medians"), ("worst", "largest"))
        if (a := getattr(one, of)) is not None and (b := getattr(other, of)) is not None
    ]
    return {"messages": messages(found), "controllers": [row(one) for one in found], "differences": apart}


def interval(estimate: Estimate | None) -> dict[str, object] | None:
    """Return an estimate for programs: mean, half of its interval, number of draws."""
    return (
        None
        if estimate is None
        else {"mean": estimate.mean, "half": estimate.half if estimate.count > 1 else None, "draws": estimate.count}
    )


def best_given(found: Sequence[Verdict]) -> Verdict:
    """Return the best of the given controllers, or of all without a given one."""
    return leaders([one for one in found if one.controller not in ALWAYS] or found)[0]


def harm_of(own: Sequence[ScoredController], without: Mapping[str, ScoredController]) -> Harm | None:
    """Return the harm of a controller; None if wheels slide in every case, or if it does not stop in another."""
    found, moved = [], 0
    for one in own:
        other = without.get(one.case)
        if other is None or other.distances is None or one.distances is None:
            continue
        distance = float(other.distances.values.mean())
        longer = less(one.distances, other.distances).over(distance).estimate()
        found.append((longer.mean, longer.half, one.case))
        moved += any(stop.commands for stop in one.stops or [one.stop])
    return Harm(len(found), *max(found), moved) if found else None

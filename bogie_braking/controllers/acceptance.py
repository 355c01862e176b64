"""Acceptance of a controller: each criterion against each case that it is for, and a verdict on all.

A mean over draws passes or fails if its interval lies on one side of the limit. Otherwise it cannot be decided. Locks,
vents, flats, pressures and commands are those of the worst draw.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from bogie_braking.controllers.controller_loader import Given
from bogie_braking.controllers.estimate import LEVEL, Sample
from bogie_braking.controllers.scoring import DrawsPlan, ScoredController, compare, litres, runs_of, stops_of
from products.machine import Machine
from products.protection.criteria import MEANS, Criterion
from products.protection.own_process import Order
from products.protection.programme import Case
from products.protection.runs import Stop
from products.protection.settings import Settings
from rbd_model.track.line import FRICTIONS, Line

#: Verdicts on a criterion in a case.
PASSES, FAILS, UNDECIDED = "passes", "fails", "undecided"
#: Verdicts on a controller.
ACCEPTED, REJECTED, OPEN = "accepted", "rejected", "not decided"
#: Name of the criterion that every stop ends.
STOPS = "stops"
#: Reason of a missing value; the criterion STOPS has the rest.
NO_STOP = "no stop"

#: Values of a case that lower the friction along the line; its stop on the dry rail is without them.
OF_THE_RAIL = ("patch_friction", "patch_start", "patch_length", "patch_blend", "cleaned_friction")


@dataclass(frozen=True)
class CaseResult:
    """The stops of a controller in a case.

    score: its `dry` is the distance of the same stop on the dry rail without a controller. dry: that stop.
    """

    case: Case
    score: ScoredController
    dry: Stop


@dataclass(frozen=True)
class Finding:
    """Result of a criterion in a case.

    value: in the unit of the criterion, or None. half: half of its interval, or 0 for the worst draw. reason: cause
    of a missing value, or of a stop that does not count.
    """

    criterion: str
    case: str
    value: float | None
    half: float
    verdict: str
    reason: str = ""


def findings(tested: Sequence[CaseResult], criteria: Sequence[Criterion], looks: int) -> list[Finding]:
    """Return a finding for each criterion and case that it is for, criterion by criterion, first that every stop ends.

    All intervals hold together with LEVEL: Bonferroni, over them and over `looks` numbers of draws.
    """
    pairs = [(one, of) for one in criteria for of in tested if one.holds_for(of.case)]
    means = sum(one.measure in MEANS for one, _ in pairs)
    level = 1.0 - (1.0 - LEVEL) / (max(means, 1) * max(looks, 1))
    return [*(ended(one) for one in tested), *(finding(one, of, level) for one, of in pairs)]


def ended(case_result: CaseResult) -> Finding:
    """Return whether every stop of a case ended at rest, and no draw made the controller fail."""
    stop, count = case_result.score.stop, float(sum(of.distance is not None for of in case_result.score.each))
    verdict = UNDECIDED if not stop.judged else PASSES if stop.distance is not None else FAILS
    return Finding(STOPS, case_result.case.name, count, 0.0, verdict, stop.message.replace(". (draw", " (draw"))


def finding(criterion: Criterion, case_result: CaseResult, level: float) -> Finding:
    """Return a criterion in a case; level: probability of the interval of a mean."""
    stop, name = case_result.score.stop, case_result.case.name
    if stop.distance is None:
        return Finding(criterion.name, name, None, 0.0, UNDECIDED, NO_STOP)
    if criterion.measure not in MEANS:
        value = extreme(criterion.measure, case_result)
        return Finding(criterion.name, name, value, 0.0, PASSES if criterion.passes(value) else FAILS)
    sample = mean(criterion.measure, case_result)
    if sample is None:
        return Finding(criterion.name, name, None, 0.0, UNDECIDED, "no distance to compare with")
    found = sample.estimate(level)
    half = found.half if math.isfinite(found.half) else 0.0  # one draw: its value decides
    sides = {criterion.passes(found.mean + sign * half) for sign in (-1.0, 1.0)}
    verdict = UNDECIDED if len(sides) > 1 else PASSES if sides.pop() else FAILS
    return Finding(criterion.name, name, found.mean, half, verdict)


def mean(measure: str, case_result: CaseResult) -> Sample | None:
    """Return a measure of each draw, in its unit; None without a distance to compare with."""
    score, each = case_result.score, case_result.score.each
    if measure == "over_ideal":
        return score.ratios
    if measure == "over_dry":
        return None if score.distances is None or not score.dry else score.distances.over(score.dry)
    values = {
        "in_band": lambda stop: stop.share_in_band,
        "air": litres,
        "fillings": lambda stop: stop.air / case_result.dry.air,
        "sliding": lambda stop: max(stop.sliding) / 2e3,
    }[measure]
    return score.sample([values(stop) for stop in each])


def extreme(measure: str, case_result: CaseResult) -> float:
    """Return a measure of the worst draw, in its unit."""
    score = case_result.score
    if measure == "commands":
        return float(max(stop.commands for stop in score.each))
    of: Mapping[str, float] = {
        "longest_lock": score.stop.longest_lock,
        "longest_vent": score.stop.longest_vent,
        "flat": 1e3 * score.flat,
        "jerk": score.stop.jerk,
        "reservoir": (score.stop.lowest_reservoir or 0.0) / 1e3,
    }
    return of[measure]


def verdict_of(found: Sequence[Finding]) -> str:
    """Return the verdict on a controller: a failure rejects it, otherwise an open finding keeps it from acceptance."""
    verdicts = {one.verdict for one in found}
    return REJECTED if FAILS in verdicts else OPEN if UNDECIDED in verdicts else ACCEPTED


def on_dry_rail(case: Case) -> Case:
    """Return the case on the dry rail, without faults; the friction of its line is omitted."""
    values = tuple((name, value) for name, value in case.values if name not in OF_THE_RAIL)
    line = case.line and Line({name: rows for name, rows in case.line.rows.items() if name not in FRICTIONS})
    return replace(case, rail="dry", friction=None, values=values, faults=(), line=line)


def stops_for_report(
    machine: Machine,
    name: str,
    controller: Given,
    cases: Sequence[Case],
    criteria: Sequence[Criterion],
    settings: Settings,
    plan: DrawsPlan,
    level: int,
    recorded: bool,
) -> list[CaseResult]:
    """Return the stops of a controller in every case; a case is drawn more often until its criteria are decided."""
    order = Order(machine, None, replace(settings, jitter=plan.spread.jitter), level=level)
    dry = stops_of(order, "none", runs_of(machine, [on_dry_rail(case) for case in cases], level))

    def tested(scores: Sequence[ScoredController]) -> list[CaseResult]:
        each = zip(cases, scores, dry, strict=True)
        return [CaseResult(case, replace(score, dry=stop.distance), stop) for case, score, stop in each]

    def unsettled(scores: Sequence[ScoredController]) -> set[str]:
        return undecided(tested(scores), criteria, plan)

    return tested(compare(machine, {name: controller}, cases, settings, plan, level, recorded, unsettled, deals=True))


def undecided(tested: Sequence[CaseResult], criteria: Sequence[Criterion], plan: DrawsPlan) -> set[str]:
    """Return the cases in which more draws may decide a criterion."""
    found = findings(tested, criteria, len(plan.looks))
    return {one.case for one in found if one.verdict == UNDECIDED and one.value is not None and one.half > 0.0}

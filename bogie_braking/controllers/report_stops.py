"""Stops of one controller for a report: more draws for the cases in which a criterion cannot be decided yet."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

from bogie_braking.controllers.acceptance import UNDECIDED, CaseResult, findings
from bogie_braking.controllers.controller_loader import Given
from bogie_braking.controllers.scoring import Plan, Scored, drawn_stops, ideal_distance, runs_of, stops_of, together
from bogie_braking.reporting.progress import counting
from products.machine import Machine
from products.protection.criteria import Criterion
from products.protection.own_process import Order
from products.protection.programme import Case
from products.protection.runs import Stop
from products.protection.settings import Settings
from products.protection.spread import Draw, draws_of
from rbd_model.track.line import FRICTIONS, Line

#: Values of a case that lower the friction along the line; its stop on the dry rail is without them.
OF_THE_RAIL = ("patch_friction", "patch_start", "patch_length", "patch_blend", "cleaned_friction")


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
    plan: Plan,
    level: int,
    recorded: bool,
) -> list[CaseResult]:
    """Return the stops of a controller in every case."""
    runs, settings = runs_of(machine, cases, level, plan.spread.friction), replace(settings, jitter=plan.spread.jitter)
    order = Order(machine, controller, settings, level=level)
    stops: list[list[Stop]] = [[] for _ in cases]
    draws: list[list[Draw]] = [[] for _ in cases]
    with counting(total=2 + len(cases), text="ideals and stops", unit="") as bar:
        ideals = []
        for run in runs:
            ideals.append(ideal_distance(machine, run, settings))
            bar.update()
        dry = stops_of(
            replace(order, controller=None), "none", runs_of(machine, [on_dry_rail(case) for case in cases], level)
        )
        bar.update()
        places = dealt(
            [(ideal or math.inf) / (run.speed or settings.speed) for ideal, run in zip(ideals, runs, strict=True)]
        )
        for before, count in pairwise((0, *plan.looks)):
            drawn = [
                draws_of(cases[place].name, range(before, count), len(machine.numbers), plan.spread, plan.seed)
                for place in places
            ]
            found = drawn_stops(order, name, [runs[place] for place in places], drawn, recorded and before == 0)
            for place, own, more in zip(places, drawn, found, strict=True):
                draws[place] += own
                stops[place] += more
            bar.update(int(before == 0))
            scores = [
                Scored(
                    case.name,
                    name,
                    together(own),
                    machine.parameters.wheel_radius,
                    ideal,
                    on_dry.distance,
                    stops=tuple(own),
                    draws=tuple(of),
                )
                for case, own, ideal, on_dry, of in zip(cases, stops, ideals, dry, draws, strict=True)
            ]
            tested = [CaseResult(*one) for one in zip(cases, scores, dry, strict=True)]
            unsettled = undecided(tested, criteria, plan)
            places = [place for place in places if cases[place].name in unsettled]
            if not places:
                break
    return tested


def dealt(durations: Sequence[float]) -> list[int]:
    """Return the places of stops in an order that gives each thread of the rig as many long stops as the others.

    Threads take equal shares of the stops, one after another. durations: estimates [s].
    """
    longest_first = sorted(range(len(durations)), key=lambda place: -durations[place])
    threads = os.cpu_count() or 1
    return [place for first in range(threads) for place in longest_first[first::threads]]


def undecided(tested: Sequence[CaseResult], criteria: Sequence[Criterion], plan: Plan) -> set[str]:
    """Return the cases in which more draws may decide a criterion."""
    found = findings(tested, criteria, len(plan.looks))
    return {one.case for one in found if one.verdict == UNDECIDED and one.value is not None and one.half > 0.0}

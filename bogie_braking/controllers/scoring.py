"""Stops of several controllers in several cases, each compared with the ideal and with its own on the dry rail."""

from __future__ import annotations

import contextlib
import math
import os
import sys
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np

from bogie_braking.controllers.controller_loader import Given
from bogie_braking.controllers.estimate import Estimate, Sample, sample_of
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.scenario import BadInputError
from fmu_src.suggestion import suggestion
from products.machine import Machine, filling_by_flow
from products.protection.compiled_machine import machine_table
from products.protection.history import EVERY, StopHistory
from products.protection.own_process import Apart, NoControllerError, Order, runs_apart
from products.protection.peak_adhesion import PeakAdhesion
from products.protection.programme import Case
from products.protection.rig import START_SPEED
from products.protection.runs import Run, Stop
from products.protection.settings import GAS, Settings
from products.protection.spread import Draw, Spread, draws_of, is_friction

#: Wear depth of a locked wheel per sliding distance [m/m]. Severe wear takes 55 ug from each mm2 of contact over each m
#: (Lewis and Dwyer-Joyce (2004), from memory and so assumed), of steel of 7850 kg/m3. Initial length of the contact
#: [m], assumed.
WORN, CONTACT = 55e-3 / 7850.0, 12e-3
#: Arguments of a case that replace settings of the rig, by names.
OF_THE_RIG = {"initial_speed": "give speed", "force_per_pressure": "give brake_ratio"}
#: Numbers of draws of a case at which a comparison may end; the last is the limit of a controller in C.
LOOKS = (8, 16, 32, 64)
#: Largest number of draws of a case by default if a controller is a Python class or a function of arrays.
FEW = 16
#: Pressure of the free air in which litres are given [Pa].
FREE_AIR = 101325.0


@dataclass(frozen=True)
class Words:
    """Words for the end of a run.

    Verbs for one and for several, the noun without an end, the compared quantity, the effort and its unit.
    """

    does: str
    do: str
    none: str
    distance: str
    effort: str
    unit: str


STOP_WORDS = Words("stops", "stop", "no stop", "stopping distance", "the pressure of its cylinder", "kPa")
START_WORDS = Words("arrives", "arrive", "no arrival", "distance to the speed", "the torque of its motor", "kN.m")


@dataclass(frozen=True)
class DrawsPlan:
    """Plan of the draws.

    spread: spreads between stops. seed: other seeds give independent draws. most: largest number of draws of a case.
    """

    spread: Spread = field(default_factory=Spread)
    seed: int = 1
    most: int = LOOKS[-1]

    @property
    def looks(self) -> tuple[int, ...]:
        """Return the numbers of draws at which a comparison may end: LOOKS, or as many with a larger growth."""
        growth = max(LOOKS[1] / LOOKS[0], (self.most / LOOKS[0]) ** (1.0 / (len(LOOKS) - 1)))
        counts = (round(LOOKS[0] * growth**number) for number in range(len(LOOKS) - 1))
        return (*(count for count in counts if count < self.most), self.most)


@dataclass(frozen=True)
class ScoredController:
    """A controller in a case: its stops over the draws as one, with the ideal and its own on the dry rail [m].

    radius: of the wheels [m]; driven: it is a start. stops: one for each draw; empty: `stop` is the only one. draws: of
    the stops; empty: nothing was drawn.
    """

    case: str
    controller: str
    stop: Stop
    radius: float
    ideal: float | None
    dry: float | None
    driven: bool = False
    stops: tuple[Stop, ...] = ()
    draws: tuple[Draw, ...] = ()

    @property
    def words(self) -> Words:
        """Return the words for its end."""
        return START_WORDS if self.driven else STOP_WORDS

    @cached_property
    def distances(self) -> Sample | None:
        """Return the distances [m], each without the effect of its friction and load; None if one is missing."""
        found = [one.distance for one in self.each if one.distance is not None]
        return self.sample(found) if len(found) == len(self.each) else None

    @property
    def each(self) -> tuple[Stop, ...]:
        """Return the stop of each draw."""
        return self.stops or (self.stop,)

    def sample(self, values: Sequence[float]) -> Sample:
        """Return a quantity of each draw, without the effect of its friction and load."""
        factors = [(draw.friction - 1.0, draw.load - 1.0) for draw in self.draws]
        return sample_of(values, factors or np.zeros(len(values)))

    @cached_property
    def distance(self) -> Estimate | None:
        """Return the mean distance with its interval [m]; None if one is missing."""
        return None if self.distances is None else self.distances.estimate()

    @property
    def ratios(self) -> Sample | None:
        """Return the distances over the ideal [1]; None without distances or an ideal."""
        return None if self.distances is None or self.ideal is None else self.distances.over(self.ideal)

    @property
    def history(self) -> StopHistory | None:
        """Return the course over time, if it was recorded."""
        return self.stop.history

    def over(self, other: float | None) -> float | None:
        """Return the mean distance over another [m]; None if one of them is missing."""
        return None if self.distance is None or other is None else self.distance.mean / other

    @property
    def tread_energy(self) -> float:
        """Return the sliding energy of the wheel that slid most, half of its wheelset's; the rail takes a part of it
        [J].
        """
        return max(self.stop.sliding) / 2

    @property
    def flat(self) -> float:
        """Return the length of the flat due to the longest sliding distance of a locked wheel [m]; 0 if none locked.

        A flat of length L and width w on a wheel of radius R lacks the volume w L^3 / (12 R). A contact as large as the
        flat loses WORN of depth over each metre, so that L^2 grows by 8 R WORN a metre.
        """
        grown = 8 * self.radius * WORN * self.stop.longest_skid
        return math.sqrt(CONTACT**2 + grown) if self.stop.longest_skid else 0.0

    @property
    def air(self) -> float:
        """Return the air of all cylinders, at atmospheric pressure [l]."""
        return litres(self.stop)


def litres(stop: Stop) -> float:
    """Return the air of all cylinders in a stop, at atmospheric pressure [l]."""
    return 1e3 * stop.air * GAS / FREE_AIR


def slid_cases(scores: Sequence[ScoredController]) -> set[str]:
    """Return the cases in which a wheel slides: under one controller at least, or without one, a wheelset locks.

    Driven, a wheelset spins.
    """
    return {score.case for score in scores if score.stop.judged and score.stop.longest_lock > 0.0}


def sliding_cases(scores: Sequence[ScoredController]) -> list[str]:
    """Return the cases that count in the median: those in which a wheel slides; all cases if no wheel slides."""
    cases, slid = list(dict.fromkeys(score.case for score in scores)), slid_cases(scores)
    return [case for case in cases if case in slid] or cases


#: Values of a stop that are means over draws, and those of the worst draw.
MEANS, LARGEST = ("end_speed", "time", "share_in_band", "air"), ("longest_lock", "longest_skid", "jerk", "longest_vent")


def together(stops: Sequence[Stop]) -> Stop:
    """Return the stops of one case, one for each draw, as one.

    Distances, times, shares, air and energy are means; locks and skids the longest, the reservoir's pressure the
    lowest. The distance is None if one is missing, and `judged` is False if one is.
    """
    first, count = stops[0], len(stops)
    if count == 1:
        return first
    distances = [stop.distance for stop in stops if stop.distance is not None]
    reservoirs = [one.lowest_reservoir for one in stops if one.lowest_reservoir is not None]
    messages = [f"{one.message} (draw {number} of {count})" for number, one in enumerate(stops, 1) if one.message]
    values: dict[str, Any] = {name: sum(getattr(one, name) for one in stops) / count for name in MEANS}
    values |= {name: max(getattr(one, name) for one in stops) for name in LARGEST}
    return replace(
        first,
        **values,
        distance=sum(distances) / count if len(distances) == count else None,
        sliding=tuple(sum(wheelset) / count for wheelset in zip(*(one.sliding for one in stops), strict=True)),
        lowest_reservoir=min(reservoirs, default=None),
        commands=round(sum(one.commands for one in stops) / count),
        message=messages[0] if messages else "",
        judged=all(one.judged for one in stops),
    )


def compare(
    machine: Machine,
    controllers: Mapping[str, Given],
    cases: Sequence[Case],
    settings: Settings,
    plan: DrawsPlan,
    level: int = 2,
    recorded: bool = False,
    unsettled: Callable[[Sequence[ScoredController]], Collection[str]] | None = None,
    deals: bool = False,
) -> list[ScoredController]:
    """Return the scores of every controller in every case, case by case.

    unsettled: returns the cases to draw more often; by default all. deals: threads get as many long stops as others.
    """
    runs, settings = runs_of(machine, cases, level, plan.spread.friction), replace(settings, jitter=plan.spread.jitter)
    orders = {name: Order(machine, one, settings, level=level) for name, one in controllers.items()}
    stops: dict[str, list[list[Stop]]] = {name: [[] for _ in cases] for name in controllers}
    draws: list[list[Draw]] = [[] for _ in cases]
    with counting(total=len(controllers) + len(runs), text="controllers and ideals", unit="") as bar:
        ideals = []
        for run in runs:
            ideals.append(ideal_distance(machine, run, settings))
            bar.update()
        durations = [(far or math.inf) / (run.speed or settings.speed) for far, run in zip(ideals, runs, strict=True)]
        places = dealt(durations) if deals else list(range(len(cases)))
        for before, count in pairwise((0, *plan.looks)):
            drawn = [
                draws_of(cases[place].name, range(before, count), len(machine.numbers), plan.spread, plan.seed)
                for place in places
            ]
            for place, more in zip(places, drawn, strict=True):
                draws[place] += more
            for name, order in orders.items():
                found = drawn_stops(order, name, [runs[place] for place in places], drawn, recorded and before == 0)
                for place, made in zip(places, found, strict=True):
                    stops[name][place] += made
                bar.update(int(before == 0))
            scores = scored(machine, cases, runs, ideals, stops, draws)
            remaining = [case.name for case in cases] if unsettled is None else unsettled(scores)
            places = [place for place in places if cases[place].name in remaining]
            if not places:
                break
    return scores


def dealt(durations: Sequence[float]) -> list[int]:
    """Return the places of stops in an order that gives each thread of the rig as many long stops as the others.

    Threads take equal shares of the stops, one after another. durations: estimates [s].
    """
    longest_first = sorted(range(len(durations)), key=lambda place: -durations[place])
    threads = os.cpu_count() or 1
    return [place for first in range(threads) for place in longest_first[first::threads]]


def drawn_stops(
    order: Order, name: str, runs: Sequence[Run], drawn: Sequence[Sequence[Draw]], recorded: bool = False
) -> list[list[Stop]]:
    """Return the stops of each run for its draws; recorded: the first stop of each with its history."""
    wanted = [draw.applied(run, order.machine) for run, own in zip(runs, drawn, strict=True) for draw in own]
    found = stops_of(order, name, wanted)
    each = len(drawn[0])
    if recorded and each:
        found[::each] = stops_of(replace(order, every=EVERY), name, wanted[::each])
    return [found[begin : begin + each] for begin in range(0, len(found), each)]


def scored(
    machine: Machine,
    cases: Sequence[Case],
    runs: Sequence[Run],
    ideals: Sequence[float | None],
    stops: Mapping[str, Sequence[Sequence[Stop]]],
    draws: Sequence[Sequence[Draw]],
) -> list[ScoredController]:
    """Return the scores of these stops, by controllers and cases; draws: by cases."""
    radius, found = machine.parameters.wheel_radius, []
    for place, (case, run, ideal) in enumerate(zip(cases, runs, ideals, strict=True)):
        for name, of_each in stops.items():
            own, drawn = tuple(of_each[place]), tuple(draws[place])
            found.append(ScoredController(case.name, name, together(own), radius, ideal, None, run.driven, own, drawn))
    dry = {one.controller: one.distance.mean for one in found if one.case == "dry" and one.distance}
    alike = {case.name for case in cases if case.speed is None}
    return [replace(one, dry=dry.get(one.controller)) if one.case in alike else one for one in found]


def runs_of(machine: Machine, cases: Sequence[Case], level: int = 2, spread: float = 0.0) -> list[Run]:
    """Return the stop of a vehicle in each case; spread: of the friction, which stays within its limits."""
    try:
        runs = [case.run(machine) for case in cases]
    except ValueError as error:
        raise BadInputError(str(error)) from None
    for case, run in zip(cases, runs, strict=True):
        equipped = replace(machine, by_flow=not run.driven, equipment=run.equipment)
        table, _ = machine_table(equipped, level, case.line is not None)
        known = {variable.name: variable for variable in table.variables}
        for name, value in run.values.items():
            if name not in known and name.startswith("sand"):
                raise BadInputError(f"The case {case.name} sets {name}; give it equipment = ['sanders'] too.")
            if name not in known:
                near = suggestion(name, known, "give one of docs/variables.md.")
                raise BadInputError(f"The case {case.name} sets {name}, which this machine has not; {near}")
            of = known[name]
            if of.causality not in ("input", "parameter") or name in OF_THE_RIG:
                instead = OF_THE_RIG.get(name, "what it gives is no input")
                raise BadInputError(f"The case {case.name} may not set {name}: {instead}.")
            most = of.maximum / (1.0 + spread) if is_friction(name) else of.maximum
            if not (of.minimum <= value <= most and math.isfinite(value)):
                words = f"{name} of the case {case.name} must be a finite value from {of.minimum:g} to {most:g}"
                unit = "" if of.unit == "1" else f" {of.unit}"
                raise BadInputError(f"{words}{unit}; got {value:g}.")
    return runs


def stops_of(order: Order, name: str, runs: Sequence[Run]) -> list[Stop]:
    """Return a stop of each run."""
    if not isinstance(order.controller, Apart):
        with contextlib.redirect_stdout(sys.stderr):  # output of the controller
            return order.rig().runs(runs, every=order.every)
    try:
        return runs_apart(order, runs)
    except NoControllerError as error:
        raise BadInputError(
            f"{name} is no controller ({error}); a library has the functions of wheel_slide.h, which bogie-braking "
            "controllers header prints, an FMU wheel speeds as inputs and valves as outputs."
        ) from None


def ideal_distance(machine: Machine, run: Run, settings: Settings) -> float | None:
    """Return the distance with the best slip at every instant; None if the rail cannot stop the vehicle."""
    brake_ratio = settings.brake_ratio if run.brake_ratio is None else run.brake_ratio
    filling = filling_by_flow(machine.full_pressure, settings.application_time)
    try:
        peak = PeakAdhesion(machine, run.values, filling, run.equipment, run.line)
        if run.driven:
            return peak.starting_distance(START_SPEED, run.speed or settings.speed, brake_ratio)
        return peak.stopping_distance(run.speed or settings.speed, brake_ratio)
    except ValueError:
        return None

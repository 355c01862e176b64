"""Stops of several controllers in several cases, each beside the ideal and its own on the dry rail."""

from __future__ import annotations

import contextlib
import math
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from fmu_src.suggestion import suggestion
from products.protection.apart import Apart, NoControllerError, Order, runs_apart
from products.protection.braked_machine import Machine
from products.protection.braked_system import Kind, filling_by_flow, machine_model
from products.protection.history import EVERY, History
from products.protection.programme import Case
from products.protection.protected_stop import GAS, Settings
from products.protection.rig import START_SPEED
from products.protection.runs import Run, Stop
from scenarios.bench.peak_adhesion import PeakAdhesion
from scenarios.controllers.given import Given
from scenarios.reporting.progress import counting
from scenarios.scenario import BadInputError

#: Depth that a locked wheel loses over its way [m/m]: severe wear takes 55 ug from each mm2 of contact over each m
#: (Lewis and Dwyer-Joyce (2004), from memory and so assumed), of steel of 7850 kg/m3. Length of the contact at first
#: [m], assumed.
WORN, CONTACT = 55e-3 / 7850.0, 12e-3
#: What a case sets otherwise, by names.
OF_THE_RIG = {"initial_speed": "give speed", "force_per_pressure": "give strength"}
#: Pressure at which litres of air are counted [Pa].
FREE_AIR = 101325.0


@dataclass(frozen=True)
class Scored:
    """A stop of a controller in a case, beside the ideal and its own on the dry rail [m].

    radius: of the wheels [m]; driven: it is a start.
    """

    case: str
    controller: str
    stop: Stop
    radius: float
    ideal: float | None
    dry: float | None
    driven: bool = False

    @property
    def history(self) -> History | None:
        """Its course over time, where it was asked for."""
        return self.stop.history

    def over(self, other: float | None) -> float | None:
        """The distance over another; None where one of them is missing."""
        return None if self.stop.distance is None or other is None else self.stop.distance / other

    @property
    def tread_energy(self) -> float:
        """Energy of sliding of the wheel that slid most, half of its wheelset's; the rail takes a part of it [J]."""
        return max(self.stop.sliding) / 2

    @property
    def flat(self) -> float:
        """Length of the flat that the longest way of a locked wheel leaves [m]; 0 if none locked.

        A flat of length L and width w on a wheel of radius R lacks the volume w L^3 / (12 R). A contact as large as the
        flat loses WORN of depth over each metre, so that L^2 grows by 8 R WORN a metre.
        """
        grown = 8 * self.radius * WORN * self.stop.longest_skid
        return math.sqrt(CONTACT**2 + grown) if self.stop.longest_skid else 0.0

    @property
    def air(self) -> float:
        """Of all cylinders, at atmospheric pressure [l]."""
        return 1e3 * self.stop.air * GAS / FREE_AIR


def compare(
    machine: Machine,
    controllers: Mapping[str, Given],
    cases: Sequence[Case],
    settings: Settings,
    level: int = 2,
    recorded: bool = False,
) -> list[Scored]:
    """Every controller in every case, case by case, and what each came to.

    level: 2 in the plane, where the ideal always is, 3 in space; recorded: with histories.
    """
    runs = runs_of(machine, cases, level)
    stops: dict[str, list[Stop]] = {}
    every = EVERY if recorded else 0.0
    with counting(total=len(controllers) + len(runs), text="controllers and ideals", unit="") as bar:
        for name, controller in controllers.items():
            stops[name] = stops_of(Order(machine, controller, settings, level=level, every=every), name, runs)
            bar.update()
        ideal = []
        for run in runs:
            ideal.append(ideal_distance(machine, run, settings))
            bar.update()
    names = [case.name for case in cases]
    dry = {name: found[names.index("dry")].distance if "dry" in names else None for name, found in stops.items()}
    radius = machine.parameters.wheel_radius
    return [
        Scored(case.name, name, stop, radius, best, dry[name] if case.speed is None else None, run.driven)
        for case, run, best, *of_each in zip(cases, runs, ideal, *stops.values(), strict=True)
        for name, stop in zip(stops, of_each, strict=True)
    ]


def runs_of(machine: Machine, cases: Sequence[Case], level: int = 2) -> list[Run]:
    """The stop of a machine in each case. Raises BadInputError for what it has not."""
    try:
        runs = [case.run(machine) for case in cases]
    except ValueError as error:
        raise BadInputError(str(error)) from None
    for case, run in zip(cases, runs, strict=True):
        kind = Kind(machine.counted, not run.driven, level, run.equipment)
        known = {variable.name: variable for variable in machine_model(kind).variables}
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
            if not (of.minimum <= value <= of.maximum and math.isfinite(value)):
                words = f"In the case {case.name} set {name} to a finite value from {of.minimum:g} to {of.maximum:g}"
                unit = "" if of.unit == "1" else f" {of.unit}"
                raise BadInputError(f"{words}{unit}: it was {value:g}.")
    return runs


def stops_of(order: Order, name: str, runs: Sequence[Run]) -> list[Stop]:
    """A stop of each run. Raises BadInputError for what is no controller."""
    if not isinstance(order.controller, Apart):
        with contextlib.redirect_stdout(sys.stderr):  # what a controller prints
            return order.rig().runs(runs, every=order.every)
    try:
        return runs_apart(order, runs)
    except NoControllerError as error:
        raise BadInputError(
            f"{name} is no controller ({error}); a library has the functions of wheel_slide.h, which bogie-braking "
            "controllers header prints, an FMU wheel speeds as inputs and valves as outputs."
        ) from None


def ideal_distance(machine: Machine, run: Run, settings: Settings) -> float | None:
    """With the best slip at every instant; None where the rail stops nothing."""
    strength = settings.strength if run.strength is None else run.strength
    filling = filling_by_flow(machine.full_pressure, settings.application_time)
    try:
        peak = PeakAdhesion(machine, run.values, filling, run.equipment)
        if run.driven:
            return peak.starting_distance(START_SPEED, run.speed or settings.speed, strength)
        return peak.stopping_distance(run.speed or settings.speed, strength)
    except ValueError:
        return None

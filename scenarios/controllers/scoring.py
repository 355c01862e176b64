"""Stops of several controllers in several cases, each beside the ideal and its own on the dry rail."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Sequence
from dataclasses import dataclass

from products.protection.braked_machine import Machine
from products.protection.braked_system import machine_model
from products.protection.forms import Form
from products.protection.programme import Case
from products.protection.protected_stop import CYLINDER_VOLUME, Settings
from products.protection.rig import Rig
from products.protection.runs import Run, Stop
from scenarios.bench.peak_adhesion import PeakAdhesion
from scenarios.reporting.progress import counting
from scenarios.scenario import BadInputError

#: Pressure at which litres of air are counted [Pa].
FREE_AIR = 101325.0


@dataclass(frozen=True)
class Scored:
    """A stop of a controller in a case, beside the ideal and its own on the dry rail [m]; air in litres."""

    case: str
    controller: str
    stop: Stop
    ideal: float | None
    dry: float | None

    def over(self, other: float | None) -> float | None:
        """The distance over another; None where one of them is missing."""
        return None if self.stop.distance is None or other is None else self.stop.distance / other

    @property
    def air(self) -> float:
        """Of all cylinders, whose volume is taken as constant [l]."""
        return 1e3 * self.stop.filled * CYLINDER_VOLUME / FREE_AIR


def compare(machine: Machine, forms: dict[str, Form], cases: Sequence[Case], settings: Settings) -> list[Scored]:
    """Every controller in every case, case by case, and what each came to."""
    try:
        runs = [case.run(len(machine.numbers)) for case in cases]
    except ValueError as error:
        raise BadInputError(str(error)) from None
    known = {variable.name for variable in machine_model(machine.counted).variables}
    for case, run in zip(cases, runs, strict=True):
        for name in run.values:
            if name not in known:
                raise BadInputError(f"The case {case.name} sets {name}, which this machine has not.")
    stops: dict[str, list[Stop]] = {}
    with counting(total=len(forms) + len(runs), text="controllers and ideals", unit="") as bar:
        for name, form in forms.items():
            with contextlib.redirect_stdout(sys.stderr):  # what a controller prints
                stops[name] = Rig(machine, form, settings).runs(runs)
            bar.update()
        ideal = []
        for run in runs:
            ideal.append(ideal_distance(machine, run, settings))
            bar.update()
    names = [case.name for case in cases]
    dry = {name: found[names.index("dry")].distance if "dry" in names else None for name, found in stops.items()}
    return [
        Scored(case, name, found[number], ideal[number], dry[name] if cases[number].speed is None else None)
        for number, case in enumerate(names)
        for name, found in stops.items()
    ]


def ideal_distance(machine: Machine, run: Run, settings: Settings) -> float | None:
    """With the best slip at every instant; None where the rail stops nothing."""
    strength = settings.strength if run.strength is None else run.strength
    try:
        return PeakAdhesion(machine, run.values).stopping_distance(run.speed or settings.speed, strength)
    except ValueError:
        return None

"""Wheel-slide protection on dry, wet, low and changing rail: without, with locked wheels, protected, and the ideal."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context

import numpy as np
from matplotlib.figure import Figure
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar
from tqdm import tqdm

from brake_controller.wheel_slide import SlideProtection, WheelSlideController
from rbd_model.adhesion import FallingFriction, RailCondition, dry, low, wet
from rbd_model.parameters import tables_5_1_and_5_2
from scenarios.cosimulation import PATIENCE, Recording
from scenarios.integrators import layout
from scenarios.plotting import BOGIE, LEADING, THESIS, TRAILING, plt
from scenarios.protected_stop import (
    APPLICATION_TIME,
    BRAKE_START,
    NUMBERS,
    STANDING,
    Settings,
    Stop,
    Train,
    full_deceleration,
)
from scenarios.report import Result, Row
from scenarios.scenario import Options, Scenario
from scenarios.scene import prepare

#: Friction of the low rail, with the fall of Polach's set for low adhesion, which is unverified (rbd_model/adhesion.py).
LOW_FRICTION = 0.08
#: Slip ratio up to which a wheel counts as protected, and speed [m/s] above which it is looked at.
BAND, ABOVE = 0.30, 3.0
#: Speed above which a lock counts [m/s].
LOCK_ABOVE = 0.3
#: What is asked of the protection on the low rail: longest lock [s], share of the time in the band, and the stopping
#: distance over that of the ideal.
LONGEST_LOCK, SHARE, OVER_IDEAL = 0.4, 0.8, 1.15
#: Controller periods and host steps on which the low rail is tried again [s].
PERIODS, HOST_STEPS = (2e-3, 5e-3, 1e-2, 2e-2), (1e-3, 5e-3, 1e-2)
#: Runs of the measurement of speed.
COUNTED = 24


@dataclass(frozen=True)
class Rail:
    """A rail: condition, and what changes along it (parameters of the bogie)."""

    name: str
    condition: RailCondition
    changes: tuple[tuple[str, float], ...] = ()

    def values(self) -> dict[str, float]:
        return self.condition.values() | dict(self.changes)


def low_rail() -> RailCondition:
    """The law of Polach's low set with a friction of LOW_FRICTION."""
    return RailCondition(LOW_FRICTION, low().law, verified=False)


#: On the changing rail leaves lie on a wet rail from 60 to 160 m, and the leading wheels clean it a little.
RAILS = (
    Rail("dry", dry()),
    Rail("wet", wet()),
    Rail("low", low_rail()),
    Rail(
        "changing",
        wet(),
        (("patch_friction", 0.25), ("patch_start", 60.0), ("patch_length", 100.0), ("cleaned_friction", 1.1)),
    ),
)
#: What stands between wheels and valves; "locked" brakes with full force at once.
MODES: dict[str, Callable[[], WheelSlideController] | None] = {
    "unprotected": None,
    "locked": None,
    "protected": SlideProtection,
}


def adhesion(law: FallingFriction, friction: float, sliding: float) -> float:
    """Largest adhesion at a sliding speed [m/s] when the creep law is saturated: mu0 ((1 - A) exp(-B w) + A)."""
    return friction * ((1.0 - law.friction_ratio) * np.exp(-law.friction_decay * sliding) + law.friction_ratio)


class PeakAdhesion:
    """Largest deceleration that a rail can give [m/s2], from the bogie's own equations: the creep force at its best slip."""

    #: Slip ratios that are tried.
    SLIPS = np.geomspace(2e-3, 0.4, 28)

    def __init__(self, rail: Mapping[str, float]) -> None:
        self.kernel = prepare("bogie", level=2, initial_speed=25.0, **rail)
        self.kernel.initialise()
        self.form = layout("bogie", 2)
        self.place = np.array(self.kernel.linearise().state)
        p = tables_5_1_and_5_2()
        self.radius, self.mass = p.wheel_radius, p.frame_mass + 2 * p.wheelset_mass

    def at(self, distance: float, speed: float, slip: float) -> float:
        """Deceleration [m/s2] with both wheelsets at a slip ratio."""
        place = self.place.copy()
        place[self.form.kept.index("frame_distance")] = distance
        place[self.form.kept.index("frame_speed")] = speed
        for number in NUMBERS:
            place[self.form.kept.index(f"angular_velocity_{number}")] = (1.0 - slip) * speed / self.radius
        self.kernel.arrive(self.kernel.time, place.tolist())
        return -(self.kernel["creep_force_1"] + self.kernel["creep_force_2"]) / self.mass

    def best(self, distance: float, speed: float) -> tuple[float, float]:
        """Largest deceleration [m/s2], and the slip ratio at which it is reached."""
        found = [self.at(distance, speed, slip) for slip in self.SLIPS]
        return max(found), float(self.SLIPS[int(np.argmax(found))])

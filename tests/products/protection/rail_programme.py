"""A test suite of rails for wheel-slide protection, in two halves: one to choose its thresholds on, one to report."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

from brake_controller.slide_protection import SlideProtectionParameters
from products.machine import Machine, filling_by_flow, filling_by_time
from products.protection.peak_adhesion import PeakAdhesion
from products.protection.rails import RailCase
from products.protection.rig import Rig
from products.protection.runs import Run
from products.protection.settings import Settings
from products.protection.slide_protection import SlideProtection
from rbd_model.contact.friction import constant_friction
from rbd_model.track.friction import RailCondition, low, wet

#: Friction, whether it falls with sliding speed as in Polach's low set, and initial speeds [m/s].
FRICTIONS, FALLS, SPEEDS = (0.04, 0.06, 0.08, 0.10, 0.12, 0.15), (False, True), (15.0, 25.0, 40.0)
#: Leaves on a wet rail: factor on its friction, and their first place [m]; they extend over 100 m.
LEAVES, BEGINNINGS, LEAVES_LENGTH = (0.15, 0.25), (40.0, 80.0), 100.0


@dataclass(frozen=True)
class Trial:
    """A rail and the speed of the stop on it [m/s]."""

    rail: RailCase
    speed: float


def programme() -> list[Trial]:
    """Return all trials: every friction with and without its fall from every speed, then wet rails with leaves."""
    trials = []
    for friction, falls, speed in product(FRICTIONS, FALLS, SPEEDS):
        condition = RailCondition(friction, low().law if falls else constant_friction(), verified=False)
        trials.append(Trial(RailCase(f"{friction}{' falling' if falls else ''}", condition), speed))
    for factor, begin in product(LEAVES, BEGINNINGS):
        leaves = (("patch_friction", factor), ("patch_start", begin), ("patch_length", LEAVES_LENGTH))
        trials.append(Trial(RailCase(f"leaves {factor} from {begin:g} m", wet(), leaves), SPEEDS[1]))
    return trials


def for_choosing() -> list[Trial]:
    """Return every second trial from the first on, to choose thresholds."""
    return programme()[::2]


def for_reporting() -> list[Trial]:
    """Return the other trials, which no threshold was chosen on."""
    return programme()[1::2]


@dataclass(frozen=True)
class Score:
    """Result of a stop: its distance over the ideal, None if it did not come to rest, and the longest lock [s]."""

    trial: Trial
    over_ideal: float | None
    longest_lock: float


def scores(
    machine: Machine,
    trials: Sequence[Trial],
    parameters: SlideProtectionParameters,
    settings: Settings,
    by_flow: bool = True,
) -> list[Score]:
    """Return the scores of protected stops on these rails; by_flow: as `Rig` takes it."""
    runs = [Run(trial.rail.values(len(machine.numbers)), trial.speed) for trial in trials]
    stops = Rig(machine, lambda: SlideProtection(parameters), settings, by_flow=by_flow).runs(runs)
    lasts = settings.application_time
    filling = filling_by_flow(machine.full_pressure, lasts) if by_flow else filling_by_time(lasts)
    ideal = [
        PeakAdhesion(machine, run.values, filling).stopping_distance(trial.speed)
        for run, trial in zip(runs, trials, strict=True)
    ]
    return [
        Score(trial, stop.over(best), stop.longest_lock) for trial, stop, best in zip(trials, stops, ideal, strict=True)
    ]

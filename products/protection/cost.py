"""What a protected stop costs, one number of its score: training and tuning make it small.

Distance counts over that of a stop in which all wheels roll. Each other measure costs at its limit (rails.py) as much
as a distance that is as far over as distances may be.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from products.machine import Machine
from products.protection.rails import LONGEST_LOCK, OVER_IDEAL, SHARE
from products.protection.settings import BRAKE_START, LONGEST, Settings

#: What a measure costs at its limit: that of a distance at its own.
AT_LIMIT = OVER_IDEAL - 1.0
#: Fillings of all cylinders that count as the limit of air. Assumed; the protection that comes along takes some 16 on
#: the low rail from 25 m/s.
FILLINGS = 40.0
#: What a run costs further that comes to no stop, as many stops in which all wheels roll. Assumed: without it a policy
#: that creeps on for ever, too slow for any sensor, costs less than one that stops.
NO_STOP = 1.0


@dataclass(frozen=True)
class Rolling:
    """Distance [m] and duration [s] of a stop in which all wheels roll."""

    distance: float
    duration: float


def rolling_stop(machine: Machine, settings: Settings, speed: float) -> Rolling:
    """From a speed [m/s]. The brake is demanded at BRAKE_START and fills as 1 - 20^(-t/T): integrals in closed form,
    without what it still lacks at the end.
    """
    slows = machine.deceleration(settings.strength * machine.full_torque)
    lag = settings.application_time / math.log(20.0)
    distance = speed * (BRAKE_START + lag) + speed**2 / (2 * slows) - slows * lag**2 / 2
    return Rolling(distance, BRAKE_START + lag + speed / slows)


def cost(score: Any, rolling: Any, machine: Machine, period: float) -> Any:
    """Of stops up to now: never falls. score: rows of `rig_score`; rolling: `distance` and `duration` of each."""
    outside = (score["looked"] - score["band"]) * period
    filled = score["filled"] / (len(machine.numbers) * machine.full_pressure)
    shares = score["longest_lock"] / LONGEST_LOCK + outside / ((1.0 - SHARE) * rolling["duration"]) + filled / FILLINGS
    return score["distance"] / rolling["distance"] + AT_LIMIT * shares


def cost_of_no_stop(speed: Any, time: Any, distance: Any) -> Any:
    """What is added where a run ends at a speed [m/s] and time [s]: NO_STOP, and the way that it would run on until the
    longest time. distance: of the stop in which all wheels roll [m].
    """
    return NO_STOP + speed * (LONGEST - time) / distance

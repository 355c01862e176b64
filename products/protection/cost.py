"""Cost of a protected stop, one number from its score, to be minimised by training and tuning.

Distance is relative to that of a stop in which all wheels roll. Each other measure costs at its limit (rails.py) as
much as a distance at its limit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from products.machine import Machine
from products.protection.rails import LONGEST_LOCK, OVER_IDEAL, SHARE
from products.protection.settings import BRAKE_START, LONGEST, Settings

#: Cost of a measure at its limit: that of a distance at its own limit.
AT_LIMIT = OVER_IDEAL - 1.0
#: Limit of air, in fillings of all cylinders. Assumed; the built-in protection uses some 10 on the low rail from 25
#: m/s.
FILLINGS = 40.0
#: Additional cost of a run without a stop, in stops in which all wheels roll. Assumed: without it a policy that creeps
#: indefinitely, too slow for any sensor, costs less than one that stops.
NO_STOP = 1.0


@dataclass(frozen=True)
class Rolling:
    """Distance [m] and duration [s] of a stop in which all wheels roll."""

    distance: float
    duration: float


def rolling_stop(machine: Machine, settings: Settings, speed: float) -> Rolling:
    """Return the stop from a speed [m/s] in which all wheels roll.

    The brake is demanded at BRAKE_START and fills as 1 - 20^(-t/T): integrals in closed form, without the remainder at
    the end.
    """
    slows = machine.deceleration(settings.brake_ratio * machine.full_torque)
    lag = settings.application_time / math.log(20.0)
    distance = speed * (BRAKE_START + lag) + speed**2 / (2 * slows) - slows * lag**2 / 2
    return Rolling(distance, BRAKE_START + lag + speed / slows)


def cost(score: Any, rolling: Any, machine: Machine, period: float) -> Any:
    """Return the costs of stops up to now, which never decrease.

    score: rows of `rig_score`; rolling: `distance` and `duration` of each.
    """
    outside = (score["checked"] - score["band"]) * period
    filled = score["filled"] / (len(machine.numbers) * machine.full_pressure)
    shares = score["longest_lock"] / LONGEST_LOCK + outside / ((1.0 - SHARE) * rolling["duration"]) + filled / FILLINGS
    return score["distance"] / rolling["distance"] + AT_LIMIT * shares


def cost_of_no_stop(speed: Any, time: Any, distance: Any) -> Any:
    """Return the additional cost of a run that ends at a speed [m/s] and time [s].

    It is NO_STOP and the distance at this speed until the longest time. distance: of the stop in which all wheels roll
    [m].
    """
    return NO_STOP + speed * (LONGEST - time) / distance

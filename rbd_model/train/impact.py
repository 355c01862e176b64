"""Impact of two vehicles on one coupler, in closed form: travel, force and energies by the areas below its curves.

The curves are straight between their points, so that an area is a sum of squares. The impact ends its approach where
the area below loading is the energy of the relative motion, m v^2 / 2 with the reduced mass m = m1 m2 / (m1 + m2)
(conservation of momentum and energy; energies of draft gears: Wu, Spiryagin and Cole (2016)).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from rbd_model.train.coupler import Coupler

Bends = Sequence[tuple[float, float]]


@dataclass(frozen=True)
class Impact:
    """Greatest travel [m] and force [N], energy taken and given back [J], relative speed afterwards [m/s]."""

    travel: float
    force: float
    taken: float
    returned: float
    rebound: float


def force_at(bends: Bends, way: float) -> float:
    """Return the force of a curve at a travel [N] (Hooke's law); bends: travels [m], changes of slope there [N/m]."""
    return sum(change * max(way - at, 0.0) for at, change in bends)


def energy_at(bends: Bends, way: float) -> float:
    """Return the area below a curve up to a travel [J], the sum of c (s - a)^2 / 2 (Hooke's law)."""
    return sum(change * max(way - at, 0.0) ** 2 / 2 for at, change in bends)


def impact(coupler: Coupler, masses: tuple[float, float], speed: float, sense: str = "compression") -> Impact:
    """Return the impact of two vehicles that are free otherwise (Wu, Spiryagin and Cole (2016)).

    Takes masses [kg], speed [m/s].
    """
    loading, unloading = coupler.bends(sense)
    reduced = masses[0] * masses[1] / (masses[0] + masses[1])
    taken = reduced * speed**2 / 2
    travel = _travel(loading, taken)
    force = force_at(loading, travel)
    returned = _returned(unloading, coupler.sticking_stiffness, travel, force)
    return Impact(travel, force, taken, returned, math.sqrt(2 * returned / reduced))


def _travel(loading: Bends, energy: float) -> float:
    """Return the travel [m] at which the area below a curve is an energy [J]."""
    starts = sorted({at for at, change in loading if change != 0.0})
    begin = max((at for at in starts if energy_at(loading, at) <= energy), default=0.0)
    force, rest = force_at(loading, begin), energy - energy_at(loading, begin)
    slope = sum(change for at, change in loading if at <= begin)
    return begin + 2 * rest / (force + math.sqrt(force**2 + 2 * slope * rest)) if rest > 0.0 else begin


def _returned(unloading: Bends, sticking: float, travel: float, force: float) -> float:
    """Return the energy [J] below the way back: at the sticking stiffness down to unloading, then along it."""

    def excess(way: float) -> float:
        return force - sticking * (travel - way) - force_at(unloading, way)

    ways = [travel, *sorted((at for at, change in unloading if change != 0.0 and at < travel), reverse=True), 0.0]
    meets = 0.0
    for far, near in pairwise(ways):
        if excess(near) <= 0.0:
            high, low = excess(far), excess(near)
            meets = far - (far - near) * high / (high - low) if high > low else far
            break
    at_meeting = force - sticking * (travel - meets)
    return (force + at_meeting) / 2 * (travel - meets) + energy_at(unloading, meets)


@dataclass(frozen=True)
class Capacity:
    """A coupler up to its stroke: travel [m], force [N], energy [J], and the share of it that friction takes [1]."""

    stroke: float
    force: float
    energy: float
    absorbed: float


def capacity(coupler: Coupler, sense: str = "compression") -> Capacity:
    """Return the capacity of a coupler in one sense, to the end of its curves (Wu, Spiryagin and Cole (2016))."""
    loading, unloading = coupler.bends(sense)
    stroke = max(curve.ways[-1] for curve in getattr(coupler, sense))
    force, energy = force_at(loading, stroke), energy_at(loading, stroke)
    return Capacity(
        stroke, force, energy, 1.0 - _returned(unloading, coupler.sticking_stiffness, stroke, force) / energy
    )

"""Kdry_rst from tolerances and failures of a train's brake, SUBSET-026, 7.5, and the causes that decide it.

Deceleration over its nominal value is the sum of all forces over the mass. The force of a vehicle is friction x
cylinder force x efficiency x radius of its discs / radius of its wheels. Each factor is normal with mean 1 and
independent of all others. Sums and products are convolved, without draws. Failures alone are summed exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import ndtri
from scipy.stats import binom

from products.supervision.arguments import all_of_type, check_sizes, finite, of_type, switch
from products.supervision.convolution import (
    SHARES,
    Law,
    Numbers,
    add_losses,
    failures_of,
    product_of,
    quantiles_of,
    quantiles_of_failures,
    sum_of,
)
from products.supervision.safety import WEAKER
from products.supervision.tolerances import Tolerances
from readers.text import BadInputError, shown

#: Largest numbers of equal vehicles, and of groups; largest force and mass of a vehicle.
MOST_VEHICLES, MOST_GROUPS, LARGEST = 2_000, 500, 1e12
#: Longest build-up time of train data [s].
LONGEST = 60.0
#: Remedy for tolerances of another type.
GIVE = "Give Tolerances(friction=0.05), or read_tolerances(path)."
#: Groups for which one failure is computed.
SHOWN = 3


@dataclass(frozen=True)
class BrakedVehicles:
    """Equal vehicles of a train, each with a distributor.

    Parameters
    ----------
    count : int
        Number of vehicles.
    force : float
        Nominal brake force of a vehicle, in any unit that all groups share; 0 without a brake.
    mass : float
        Mass of a vehicle, in any unit that all groups share.
    discs : bool
        True if it brakes by discs, whose force at the rim depends on the wheel diameter.

    Raises
    ------
    BadInputError
        If a number is outside its limits.
    """

    count: int
    force: float
    mass: float = 1.0
    discs: bool = True

    def __post_init__(self) -> None:
        limits = {"count": (1, MOST_VEHICLES), "force": (0.0, LARGEST), "mass": (1e-6, LARGEST)}
        check_sizes("braked vehicles", self, limits)
        switch("discs", self.discs)


@dataclass(frozen=True)
class Cause:
    """A cause of a weaker brake: its name and value, Kdry_rst without it, and how much that is more."""

    name: str
    value: float
    without: float
    gain: float


@dataclass(frozen=True)
class OneFailure:
    """A vehicle whose brake does not act: its group, its share of the nominal force, and Kdry_rst without it."""

    group: int
    share: float
    factor: float


def factors_of(vehicles: Sequence[BrakedVehicles], tolerances: Tolerances) -> Numbers:
    """Return Kdry_rst for the confidence levels 0 to 9.

    Returns (10).
    """
    return _factors(vehicles, tolerances, np.array(WEAKER))


def causes_of(vehicles: Sequence[BrakedVehicles], tolerances: Tolerances, level: int = 9) -> list[Cause]:
    """Return what each cause takes from Kdry_rst at a confidence level, the largest first."""
    weaker = _weaker(level)
    of_type("tolerances", tolerances, Tolerances, GIVE)
    whole = float(_factors(vehicles, tolerances, weaker)[0])
    found = []
    for name in tolerances.causes:
        without = float(_factors(vehicles, tolerances.without(name), weaker)[0])
        found.append(Cause(name, getattr(tolerances, name), without, without - whole))
    return sorted(found, key=lambda one: -one.gain)


def one_failure(vehicles: Sequence[BrakedVehicles], tolerances: Tolerances, level: int = 9) -> list[OneFailure]:
    """Return Kdry_rst at a confidence level if the brake of one vehicle does not act for certain."""
    weaker, found = _weaker(level), []
    of_type("tolerances", tolerances, Tolerances, GIVE)
    nominal = _nominal(vehicles)
    order = sorted(range(len(vehicles)), key=lambda number: -vehicles[number].force)
    for number in [one for one in order if vehicles[one].force][:SHOWN]:
        one = vehicles[number]
        rest = [*vehicles[:number], *([replace(one, count=one.count - 1)] if one.count > 1 else [])]
        rest += [*vehicles[number + 1 :], replace(one, count=1, force=0.0)]
        left = 1.0 - one.force / nominal
        factor = left * float(_factors(rest, tolerances, weaker)[0]) if left > 1e-12 else 0.0
        found.append(OneFailure(number, one.force / nominal, factor))
    return found


def build_up_of(vehicles: Sequence[BrakedVehicles], tolerances: Tolerances, build_up: float) -> Numbers:
    """Return T_brake_emergency for the confidence levels 0 to 9.

    SUBSET-026 has no factor for it. Its quantile is train data as it stands: a longer one is reached with the
    probability of the level, apart from that of Kdry_rst.

    Takes build_up [s]; returns [s] (10).
    """
    of_type("tolerances", tolerances, Tolerances, GIVE)
    build_up = finite("build_up", build_up)
    if not 0.0 <= build_up <= LONGEST:
        raise BadInputError(f"build_up must be 0 to {LONGEST:g} s; got {build_up:g} s. Correct it.")
    nominal = _nominal(vehicles)
    shares = np.array([vehicle.force / nominal for vehicle in vehicles])
    counts = np.array([one.count for one in vehicles])
    own = tolerances.delay * np.sqrt(counts @ shares**2)
    found: Numbers = build_up - ndtri(np.array(WEAKER)) * np.hypot(own, tolerances.delay_common)
    return found


def _weaker(level: int) -> Numbers:
    if isinstance(level, bool) or not isinstance(level, int | np.integer) or not 0 <= level < len(WEAKER):
        raise BadInputError(f"The confidence level must be an integer from 0 to 9; got {shown(level)}.")
    return np.array(WEAKER[level : level + 1])


def _nominal(vehicles: Sequence[BrakedVehicles]) -> float:
    all_of_type("vehicles", vehicles, BrakedVehicles, "Give BrakedVehicles(count=9, force=55.0, mass=50.0).")
    if len(vehicles) > MOST_GROUPS:
        raise BadInputError(
            f"Groups of braked vehicles must be at most {MOST_GROUPS}; got {len(vehicles)}. Join vehicles with similar "
            "forces."
        )
    nominal = float(sum(vehicle.count * vehicle.force for vehicle in vehicles))
    if not nominal > 0.0:
        raise BadInputError("A train must have a brake force for its factors; got none. Give vehicles with brakes.")
    return nominal


def _factors(vehicles: Sequence[BrakedVehicles], tolerances: Tolerances, weaker: Numbers) -> Numbers:
    """Return the factors at probabilities of a weaker brake, shape (levels,)."""
    t, nominal = of_type("tolerances", tolerances, Tolerances, GIVE), _nominal(vehicles)
    own = (t.friction, t.cylinder_force, t.efficiency, t.spread)
    laws = {discs: product_of(own, [t.wheel_diameter] if discs else []) for discs in {one.discs for one in vehicles}}
    masses, counts = np.array([one.mass for one in vehicles]), np.array([one.count for one in vehicles])
    of_train = t.mass * np.sqrt(counts @ masses**2) / (counts @ masses)
    common = product_of([t.friction_common, t.common], [of_train, t.mass_common])
    braked = [vehicle for vehicle in vehicles if vehicle.force]
    if common.values.size == 1 and all(laws[one.discs].values.size == 1 for one in braked):
        alone = failures_of([(one.count, _failures(one.force / nominal, t)) for one in braked])
        if alone is not None:
            return quantiles_of_failures(alone, weaker)
    forces = [(one.count, _of_vehicle(laws[one.discs], one.force / nominal, t)) for one in braked]
    return quantiles_of(sum_of(forces), common, weaker)


def _braking(t: Tolerances) -> Numbers:
    """Return the probabilities that none, one, ... and all units of a vehicle brake."""
    acts = 1.0 - t.isolated * (1.0 - t.noticed)
    braking: Numbers = acts * binom.pmf(np.arange(t.units + 1), t.units, 1.0 - t.lost)
    braking[0] += 1.0 - acts
    return braking


def _failures(share: float, t: Tolerances) -> Law:
    """Return the law of the train's share that a vehicle misses by failures alone."""
    braking = _braking(t)[::-1]
    likely = np.flatnonzero(braking)
    return Law(share * likely / t.units, braking[likely])


def _of_vehicle(law: Law, share: float, t: Tolerances) -> Numbers:
    """Return the masses of the train's share that a vehicle misses."""
    braking, found = _braking(t), np.zeros(SHARES)
    for number in np.flatnonzero(braking):
        add_losses(found, law, share, number / t.units, braking[number])
    return found

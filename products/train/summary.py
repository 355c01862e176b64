"""Numbers of a train by which a consist is checked: masses, brake weights, resistances, forces, stopping distances."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby, islice, pairwise

import numpy as np

from brake_controller.brake_weight import braked_weight
from products.train.brake_model import select_brake_model
from products.train.consist import Consist, TrainVehicle, forces_of
from products.train.driver_forces import resistance_of
from products.train.layout import START_FRICTION
from products.train.train import Train
from rbd_model.train.coupler import Coupler, screw_coupler
from rbd_model.train.impact import capacity
from rbd_model.train.vehicle import GRAVITY

#: Longest time of a stop, and time between two looks whether the train stands [s]; speed below which it does [m/s].
LONGEST, STEP, RESTS = 1800.0, 1.0, 1e-3
#: Speed at which the resistance of a vehicle is shown [m/s].
SHOWN = 80.0 / 3.6
#: Words of a note on a name or word that is read as another.
READ = " is read as "


@dataclass(frozen=True)
class OfVehicles:
    """Equal vehicles one behind the other: of each, mass [t], length [m], brake weight percentage [%].

    resistance: at 80 km/h, and by the formula of its kind [N/t]; formula: its name.
    """

    name: str
    kind: str
    count: int
    mass: float
    length: float
    percentage: float
    resistance: float
    resistance_by_formula: float
    formula: str


@dataclass(frozen=True)
class AtSpeed:
    """The train at a speed [km/h]: resistance and brake force [kN]; stopping distance [m], None if it does not stop."""

    speed: float
    resistance: float
    brake_force: float
    distance: float | None


@dataclass(frozen=True)
class OfCouplings:
    """Equal couplings in one sense up to their stroke: travel [mm], force [kN], energy [kJ], its share absorbed [%].

    speed: relative speed of the heaviest two vehicles at these couplings that takes the whole stroke [km/h].
    """

    name: str
    count: int
    sense: str
    stroke: float
    force: float
    energy: float
    absorbed: float
    speed: float


@dataclass(frozen=True)
class Summary:
    """A train: number of vehicles, mass and brake weight [t], length [m], percentage [%]; remarks on it."""

    vehicles: int
    mass: float
    length: float
    percentage: float
    brake_weight: float
    kinds: tuple[OfVehicles, ...]
    speeds: tuple[AtSpeed, ...]
    couplings: tuple[OfCouplings, ...] = ()
    remarks: tuple[str, ...] = ()


def summary_of(consist: Consist, speeds: Sequence[float]) -> Summary:
    """Return the numbers of a train.

    Takes speeds [km/h].
    """
    kinds = []
    for one, several in groupby(consist.vehicles):
        count, formula = len(list(several)), one.formula
        own, usual = (1e3 * _resisted(law, SHOWN) / one.mass for law in (one.resistance, formula.of(one.mass)))
        numbers = 1e-3 * one.mass, one.length, one.percentage, own, usual
        kinds.append(OfVehicles(one.name, one.kind, count, *numbers, formula.name))
    braked = [kind for kind in kinds if kind.percentage > 0.0]
    weight = sum(kind.count * braked_weight(kind.percentage, 1e3 * kind.mass) for kind in braked)
    return Summary(
        len(consist.vehicles),
        1e-3 * consist.mass,
        consist.length,
        consist.percentage,
        1e-3 * weight,
        tuple(kinds),
        tuple(_at(consist, speed) for speed in speeds),
        couplings_of(consist),
        (*_remarks(consist), *_account(consist)),
    )


def couplings_of(consist: Consist) -> tuple[OfCouplings, ...]:
    """Return the capacities of the couplings of a train, other than rigid ones, in the order of their first vehicle."""
    masses: dict[Coupler, list[float]] = {}
    for one, behind in pairwise(consist.vehicles):
        if one.coupler.name != "rigid":
            masses.setdefault(one.coupler, []).append(one.mass * behind.mass / (one.mass + behind.mass))
    found = []
    for own, reduced in masses.items():
        for sense in ("compression", "tension"):
            able = capacity(own, sense)
            speed = 3.6 * (2 * able.energy / max(reduced)) ** 0.5
            numbers = 1e3 * able.stroke, 1e-3 * able.force, 1e-3 * able.energy, 1e2 * able.absorbed, speed
            found.append(OfCouplings(own.name, len(reduced), sense, *numbers))
    return tuple(found)


def _remarks(consist: Consist) -> tuple[str, ...]:
    """Return remarks on values without an effect, on parking brakes, and on track brakes."""
    *ahead, last = consist.vehicles
    found = []
    if ahead and last.coupler not in (ahead[-1].coupler, screw_coupler()):
        found.append(f"The {last.coupler.name} coupler of the last vehicle has no effect: nothing is behind it.")
    parking = [
        (vehicle.parking.parking_force, START_FRICTION * vehicle.motion()["weight"]) for vehicle in consist.vehicles
    ]
    if parked := sum(min(force, most) for force, most in parking):  # what a dry rail transmits, Coulomb's law
        gradient = 1e3 * parked / (consist.mass * GRAVITY)
        found.append(f"Parking brakes: {1e-3 * parked:.1f} kN, which hold the train on {gradient:.1f} permille.")
    slides = ((number, *forces) for number, forces in enumerate(parking, 1) if forces[0] > forces[1])
    for number, force, most in islice(slides, 1):
        found.append(
            f"Vehicle {number}: parking_force {1e-3 * force:.4g} kN is above the {1e-3 * most:.4g} kN that a rail of "
            f"friction {START_FRICTION:g} transmits: its wheels slide first."
        )
    if any(one.track.magnetic_attraction + one.track.eddy_force > 0.0 for one in consist.vehicles):
        found.append("Track brakes are part of the stops, not of lambda and brake force.")
    return tuple(found)


def _account(consist: Consist) -> list[str]:
    """Return the notes of a consist: one for names and words, and those about assumed values."""
    read = [note.removeprefix("column ").replace(READ, " as ") for note in consist.notes if READ in note]
    others = [f"{note[0].upper()}{note[1:]}." for note in consist.notes if READ not in note]
    return [*([f"Read {', '.join(read)}."] if read else []), *others]


def brake_force(train_vehicle: TrainVehicle, speed: float) -> float:
    """Return the brake force of a vehicle with full cylinders at a speed [m/s] at its rims [N], eqs (2.4) to (2.7)."""
    return float(forces_of(train_vehicle.brake, train_vehicle.distributor.full_pressure, speed))


def _resisted(law: tuple[float, float, float], speed: float) -> float:
    """Return a + b v + c v^2 [N] at a speed [m/s]."""
    a, b, c = law
    return a + b * speed + c * speed**2


def _at(consist: Consist, speed: float) -> AtSpeed:
    metres = speed / 3.6
    resistance = _resisted(resistance_of(consist), metres)
    force = sum(brake_force(one, metres) for one in consist.vehicles)
    return AtSpeed(speed, 1e-3 * resistance, 1e-3 * force, stopping_distance(consist, metres))


def stopping_distance(consist: Consist, speed: float) -> float | None:
    """Return the distance [m] of the head in emergency braking from a speed [m/s], None if the train does not stop.

    A train starts with its head at 0, so that the middle of its first vehicle starts behind it.
    """
    train = Train(consist.unprotected, speed=speed, settings=select_brake_model(consist))
    start = float(train.distance[0])
    train.drive("emergency")
    for _ in range(int(LONGEST / STEP)):
        train.advance(STEP)
        if float(np.max(np.abs(train.speed))) < RESTS:
            return float(train.distance[0]) - start
    return None

"""Profiles of a wheelset in its equations: numbers of contact model 3, data of an instance of contact model 2."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from fmu_src.piecewise import look_up_in, polynomials
from fmu_src.records import OwnRecord
from fmu_src.symbols import ca
from rbd_model.contact.geometry import Side, Sides
from rbd_model.contact.pair_file import PAIR_FILE
from rbd_model.contact.pair_table import LARGEST_SHIFT, STAND_PITCH, pair_record, shape_at
from rbd_model.contact.patches import TreadStand, stand_on_treads
from rbd_model.vehicle.assembly import Assembly

Number: TypeAlias = "ca.SX | float"
#: Terms of a straight line; places of the tables of a `pair_table.PAIR`.
LINE_TERMS, HEIGHT, ROLL = 2, 0, 1


@dataclass(frozen=True)
class SideOf:
    """A wheel on its rail: half distances of both y = 0, limits of both profiles [m], and shape at rest.

    `shape` is depth [m] and slope of the wheel, and half the curvature of wheel and rail [1/m], at the place of a
    centred wheelset. `record` is that of the contact table; None at contact model 3.
    """

    wheel_half_distance: Number
    rail_half_distance: Number
    wheel_limits: tuple[Number, Number]
    rail_limits: tuple[Number, Number]
    shape: tuple[Number, Number, Number]
    record: ca.SX | None = None

    @classmethod
    def of(cls, one: Side, on_wheel: float) -> SideOf:
        """Return that of profiles that are numbers (section 4.3); on_wheel: place of the contact at rest [m]."""
        distances, limits = (one.wheel_half_distance, one.rail_half_distance), (one.wheel.limits, one.rail.limits)
        return cls(*distances, *limits, shape_at(one, on_wheel))


@dataclass(frozen=True)
class ProfilesOf:
    """Profiles of a wheelset: mean radius of its wheels and its lift over it when centred [m]; (left, right) side.

    `stand` returns its height over the centred one [m] and its roll, when it stands on its treads at a shift [m].
    """

    mean_radius: Number
    lift: Number
    sides: tuple[SideOf, SideOf]
    stand: Callable[[ca.SX], tuple[ca.SX, ca.SX]]

    @classmethod
    def of(cls, assembly: Assembly, number: int) -> ProfilesOf:
        """Return the profiles of a wheelset at the contact model of its vehicle (section 4.3)."""
        pair = assembly.vehicle.wheelsets[number - 1].pair
        return profiles_of_record(assembly, number) if assembly.contact.depth == 2 else profiles_of_numbers(pair)


def profiles_of_numbers(pair: Sides) -> ProfilesOf:
    """Return profiles that are written into the equations (section 4.3)."""
    middle = stand_on_treads(pair, 0.0)
    left, right = (SideOf.of(one, place) for one, place in zip(pair.both, middle.position, strict=True))

    def stand(shift: ca.SX) -> tuple[ca.SX, ca.SX]:
        shifts = np.arange(-LARGEST_SHIFT, LARGEST_SHIFT + STAND_PITCH / 2, STAND_PITCH).tolist()

        def of(value: Callable[[TreadStand], float]) -> ca.SX:
            return ca.pw_lin(shift, shifts, [value(stand_on_treads(pair, one)) for one in shifts])

        return of(lambda one: one.height - middle.height), of(lambda one: one.roll)

    return ProfilesOf(pair.mean_radius, middle.height - pair.mean_radius, (left, right), stand)


def record_of(assembly: Assembly, number: int, path: Sequence[tuple[int, int]] = (), name: str = "") -> ca.SX:
    """Return a number, or the record itself, of a wheelset's contact table; without a file that of its own pair.

    Section 4.3. path, name: as `System.of_record` has them.
    """
    own_record = OwnRecord(pair_record, assembly.vehicle.wheelsets[number - 1].pair)
    return assembly.system.of_record(PAIR_FILE, own_record, path, name, root=number - 1)


def profiles_of_record(assembly: Assembly, number: int) -> ProfilesOf:
    """Return profiles that a wheelset takes from the contact table of its instance (section 4.3)."""
    system = assembly.system

    def side(index: int) -> SideOf:
        def value(name: str) -> ca.SX:
            return record_of(assembly, number, [(0, index)], name)

        limits = [(value(f"{word}_begins"), value(f"{word}_ends")) for word in ("wheel", "rail")]
        shape = value("depth"), value("slope"), value("curvature")
        distances = value("wheel_half_distance"), value("rail_half_distance")
        return SideOf(*distances, limits[0], limits[1], shape, record_of(assembly, number, [(0, index)]))

    def stand(shift: ca.SX) -> tuple[ca.SX, ca.SX]:
        root = record_of(assembly, number)
        pieces = [look_up_in(system, root, table, LINE_TERMS, shift) for table in (HEIGHT, ROLL)]
        height, roll = (polynomials(piece, shift, 0)[0] for piece in pieces)
        return height, roll

    mean_radius, lift = (record_of(assembly, number, (), name) for name in ("mean_radius", "lift"))
    return ProfilesOf(mean_radius, lift, (side(0), side(1)), stand)

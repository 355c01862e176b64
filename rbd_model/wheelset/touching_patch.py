"""One patch of a wheel on its rail in 3D: stored energy, elastic forces, and the place for the creep forces.

A patch is a table over the offset of its wheel (`rbd_model.contact.bearing`). A wheel that rolls and yaws has the
offset and the distance of an equal wheel that does neither. A roll moves the wheel about the centre of the rail's arc.
A yaw moves the contact ahead on the wheel, where it lies further out and higher, (3.54). Elastic forces are the
derivatives of the stored energy by the coordinates, so that the contact is conservative in any motion.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import lru_cache
from typing import Protocol

import numpy as np

from fmu_src.chain import Bundle, Chain, Part, rows
from fmu_src.piecewise import look_up, look_up_in, numbers_in, polynomials
from fmu_src.records import Record
from fmu_src.symbols import ca
from rbd_model.body.kinematics import turned_by
from rbd_model.contact.bearing import APPROACHES, CUBIC, IN_CONTACT
from rbd_model.contact.elastic import SMALLEST_APPROACH
from rbd_model.contact.pair_table import PATCH
from rbd_model.wheelset.touch import Placement, Wheel, follow_cosines, touch_at

#: Numbers of a `pair_table.PATCH`, and places of its tables with the terms of a piece.
NUMBERS = [one.name for one in PATCH.numbers]
TABLES = {table.name: (place, 1 + table.degree) for place, table in enumerate(PATCH.tables)}
#: Places of the quantities of each approach in the table `in_contact`.
STARTS = [len(IN_CONTACT) * place for place in range(len(APPROACHES))]
#: Exponent of the wheel's radius in Hertz' stiffness, for A near B (Johnson 1985, section 4.2).
OF_RADIUS = 0.25


class PatchTable(Protocol):
    """Numbers and tables of a patch."""

    def number(self, chain: Chain, name: str) -> ca.SX:
        """Return a number of `pair_table.PATCH`."""

    def piece(self, chain: Chain, name: str, place: ca.SX) -> ca.SX:
        """Return the origin and the coefficients of a table's piece."""


@dataclass(frozen=True)
class InRecord:
    """The patch in a record of a contact table: data of an instance."""

    record: ca.SX

    def number(self, chain: Chain, name: str) -> ca.SX:
        """Implement `PatchTable`."""
        return numbers_in(chain, self.record, len(NUMBERS))[NUMBERS.index(name)]

    def piece(self, chain: Chain, name: str, place: ca.SX) -> ca.SX:
        """Implement `PatchTable`."""
        return look_up_in(chain, self.record, *TABLES[name], place)


@dataclass(frozen=True)
class InNumbers:
    """The patch with numbers of its own."""

    record: Record

    def number(self, chain: Chain, name: str) -> ca.SX:
        """Implement `PatchTable`."""
        return ca.SX(self.record.number(name))

    def piece(self, chain: Chain, name: str, place: ca.SX) -> ca.SX:
        """Implement `PatchTable`."""
        breakpoints, coefficients = self.record.tables[TABLES[name][0]]
        return look_up(chain, name, np.array(breakpoints), np.array(coefficients), place)


@dataclass(frozen=True)
class Stands:
    """A wheel over its rail: distances of its y = 0 from the rail's [m], outwards and up, (3.77)."""

    outwards: ca.SX
    up: ca.SX
    placement: Placement
    wheel: Wheel

    @classmethod
    def of(cls, placement: Placement, on: Wheel, height: ca.SX) -> Stands:
        """Return that of a wheel; height [m]: of the wheelset's centre over the rail."""
        origin = turned_by(placement.cosines) @ ca.vertcat(0, on.side * on.wheel_half_distance, -on.radius)
        outwards = on.side * (placement.lateral + origin[1]) - on.rail_half_distance
        return cls(outwards, height + origin[2], placement, on)

    @property
    def roll(self) -> tuple[ca.SX, ca.SX]:
        """Cosine and sine of its roll, positive if its field side moves up."""
        return self.placement.cosines[2], self.wheel.side * self.placement.cosines[3]

    def along_and_square(
        self, direction: tuple[ca.SX, ca.SX], slope: ca.SX, radius: ca.SX, place: ca.SX | float = 0.0
    ) -> tuple[ca.SX, ca.SX]:
        """Return its distances along and square to the direction of a patch (cosine, sine) without yaw [m].

        With the slope t of the profile, a yawed wheel touches r t yaw ahead of its axle, (3.54). There its contour lies
        further out by r t yaw^2 and higher by half of r t^2 yaw^2, both turned by the roll. Its breadth shrinks with
        cos yaw. place [m]: on the profile.
        """
        cosine, sine = self.placement.cosines[0], self.placement.cosines[1]
        ahead = radius * slope * sine**2
        higher, (level, leaning) = ahead * slope / 2, self.roll
        outwards = self.outwards + level * ahead - leaning * higher - place * (1 - cosine)
        up = self.up + level * higher + leaning * ahead
        return direction[0] * outwards + direction[1] * up, direction[0] * up - direction[1] * outwards


@dataclass(frozen=True)
class Nearest:
    """The point of a patch that is nearest to its rail, and its approach [m], (3.77), (3.78)."""

    position: ca.SX
    on_rail: ca.SX
    approach: ca.SX


def first_offset(chain: Chain, patch: PatchTable, stands: Stands) -> tuple[ca.SX, ca.SX]:
    """Return the offset without roll and yaw [m], to within the arcs of the rail, and the distance square to it,
    (3.77).
    """
    direction = patch.number(chain, "cosine"), patch.number(chain, "sine")
    along, square = stands.along_and_square(direction, direction[1] / direction[0], stands.wheel.radius)
    return along + patch.number(chain, "radius") * stands.roll[1], square


def near_rail(chain: Chain, patch: PatchTable, flange: bool, stands: Stands) -> Nearest:
    """Return the nearest point of a patch of a wheel that yaws and rolls little, (3.77), (3.78).

    The approach is estimated to some hundredths of a millimetre up to 2 mrad of roll and 10 mrad of yaw.
    """
    offset, square = first_offset(chain, patch, stands)
    lever = patch.number(chain, "middle") if flange else _line(chain, patch, "nearest", offset)
    return _nearest(chain, patch, stands, offset, square + lever * stands.roll[1])


def find_nearest(chain: Chain, patch: PatchTable, stands: Stands) -> Nearest:
    """Return the nearest point of a patch at any yaw and roll, (3.77), (3.78)."""
    return _nearest(chain, patch, stands, *_without_roll(chain, patch, stands))


def _nearest(chain: Chain, patch: PatchTable, stands: Stands, offset: ca.SX, square: ca.SX) -> Nearest:
    position = _line(chain, patch, "nearest", offset)
    return Nearest(position, stands.outwards + position, -_line(chain, patch, "gap", offset) - square)


def _line(chain: Chain, patch: PatchTable, name: str, offset: ca.SX) -> ca.SX:
    return polynomials(patch.piece(chain, name, offset), offset, 0)[0]


@dataclass(frozen=True)
class TouchingPatch(Bundle):
    """Contact of a patch; vectors in the wheelset's yaw-roll axes, except for `across`.

    `push`: minus the derivatives of the stored energy by lateral position, height [N], yaw and roll [N.m].
    """

    arm: ca.SX = rows(3)  # from the wheelset's centre to the contact on the wheel [m] (P)
    normal: ca.SX = rows(3)  # unit vector into the wheel
    across: ca.SX = rows(2)  # the normal in the axes of the track, its y and z
    approach: ca.SX = rows(1)  # by which the bodies press into each other [m]; negative where they are apart
    curvature_along: ca.SX = rows(1)  # A of eq. (3.83) [1/m]
    curvature_across: ca.SX = rows(1)  # B [1/m]
    position: ca.SX = rows(1)  # on the wheel's profile [m]
    load: ca.SX = rows(1)  # elastic normal force [N]
    stored: ca.SX = rows(1)  # energy [J]
    push: ca.SX = rows(4)


def touch_patch(
    chain: Chain, patch: PatchTable, place: tuple[ca.SX, ...], fixed: tuple[ca.SX, Wheel, ca.SX]
) -> TouchingPatch:
    """Return the contact of a patch: Hertz' energy U = E* k d^2.5 over the offset o, and its derivatives.

    Johnson (1985), section 4.2, (3.82)-(3.88). With the distance z(o) at rest, d = -z - z_0(o).

    place: lateral position, height [m], yaw, roll. fixed: direction cosines, the wheel, E* [Pa].
    """
    (lateral, height, yaw, roll), (cosines, on, modulus) = place, fixed
    placement = Placement(yaw, roll, cosines, lateral)
    stands = Stands.of(placement, on, height)
    direction = patch.number(chain, "cosine"), patch.number(chain, "sine")
    offset, square = _without_roll(chain, patch, stands)
    scale = modulus * (on.radius / patch.number(chain, "wheel_radius")) ** OF_RADIUS
    cubics = _cubics(patch.piece(chain, "in_contact", offset), offset, 1)
    light, usual = (Energy.of_parabola(cubics[start : start + len(IN_CONTACT)], square, scale) for start in STARTS)
    energy = Energy.between(light, usual)
    coordinates = ca.vertcat(lateral, height, cosines)
    moves = ca.jacobian(ca.vertcat(offset, square), coordinates)
    moves = ca.horzcat(moves[:, :2], moves[:, 2:4] @ _turn(cosines[:2]), moves[:, 4:] @ _turn(cosines[2:]))
    push = energy.by_square * moves[1, :] + energy.by_offset * moves[0, :]

    (cosine, sine), upright = direction, 1 / ca.sqrt(1 + energy.steep**2)
    slope = (sine - cosine * energy.steep) / (cosine + sine * energy.steep)
    one = touch_at(placement, on, energy.place, energy.depth, slope)
    return TouchingPatch(
        one.arm,
        one.normal,
        one.across,
        energy.approach * upright,
        one.unit / (2 * one.radius),
        energy.curvature,
        energy.place,
        energy.by_square / upright,
        energy.stored,
        push.T,
    )


@dataclass(frozen=True)
class Energy:
    """Energy of a contact by its offset and distance, and the contact's quantities, between both APPROACHES.

    `by_offset`, `by_square`: minus the derivatives of the energy by offset and distance square to the patch [N].
    `steep`: slope of the distance at rest over the offset.
    """

    stored: ca.SX
    by_offset: ca.SX
    by_square: ca.SX
    steep: ca.SX
    approach: ca.SX
    place: ca.SX
    depth: ca.SX
    curvature: ca.SX

    @classmethod
    def of_parabola(cls, cubics: list[list[ca.SX]], square: ca.SX, scale: ca.SX) -> Energy:
        """Return Hertz' energy E* k d^2.5 with d = -z - z_0(o), Johnson (1985), section 4.2.

        cubics: IN_CONTACT at one approach with their first derivatives. square [m]: distance; scale [Pa]: E*.
        """
        (rest, steep), (stiffness, stiffer), (place, _), (depth, _), (curvature, _) = cubics
        approach = -(square + rest)
        pressed = ca.if_else(approach > SMALLEST_APPROACH, approach, SMALLEST_APPROACH)
        of_approach = scale * pressed * ca.sqrt(pressed)
        load = 2.5 * stiffness * of_approach
        of_approach *= pressed
        by_offset = load * steep - stiffer * of_approach
        return cls(stiffness * of_approach, by_offset, load, steep, approach, place, depth, curvature)

    @classmethod
    def between(cls, light: Energy, usual: Energy) -> Energy:
        """Return U = U_1 + x (U_2 - U_1) of the parabolas of both APPROACHES; x depends on that of the first."""
        low, high = APPROACHES
        share = ca.fmin(ca.fmax((light.approach - low) / (high - low), 0), 1)
        part, growing = share**2 * (3 - 2 * share), 6 / (high - low) * share * (1 - share)
        passing = growing * (usual.stored - light.stored)
        pairs = ((getattr(light, field.name), getattr(usual, field.name)) for field in fields(cls))
        found = cls(*(first + part * (second - first) for first, second in pairs))
        return replace(found, by_offset=found.by_offset + passing * light.steep, by_square=found.by_square + passing)


def _without_roll(chain: Chain, patch: PatchTable, stands: Stands) -> tuple[ca.SX, ca.SX]:
    """Return offset and square distance of the wheel without yaw and roll that has the same overlap [m], (3.77)."""
    first = first_offset(chain, patch, stands)[0]
    centre_along, centre_square, slope, place, depth = (
        values[0] for values in _cubics(patch.piece(chain, "at_first", first), first, 0)
    )
    direction = patch.number(chain, "cosine"), patch.number(chain, "sine")
    along, square = stands.along_and_square(direction, slope, stands.wheel.radius - depth, place)
    (cosine, sine), beside, below = stands.roll, centre_along - along, centre_square - square
    return centre_along - cosine * beside - sine * below, centre_square + sine * beside - cosine * below


def _turn(cosine_and_sine: ca.SX) -> ca.SX:
    return ca.vertcat(-cosine_and_sine[1], cosine_and_sine[0])


def _cubics(piece: ca.SX, place: ca.SX, order: int) -> list[list[ca.SX]]:
    """Return values and derivatives of the packed cubics of a piece."""
    starts = range(1, piece.numel(), CUBIC)
    return [polynomials(ca.vertcat(piece[0], piece[start : start + CUBIC]), place, order) for start in starts]


@lru_cache
def touching_patch(flange: bool) -> Part:
    """Return the part for the `TouchingPatch` in a record, from lateral position, height, yaw and roll, (3.82)-(3.88).

    Constants: direction cosines, the wheel, E* [Pa], record.
    """
    record = ca.SX.sym("record")
    return part_of_patch("flange" if flange else "tread", InRecord(record), record)


def part_of_patch(name: str, patch: PatchTable, record: ca.SX | None = None) -> Part:
    """Return the same of any patch, (3.82)-(3.88); record: that of the patch, if it is data of an instance."""
    given, constants, chain = ca.SX.sym("given", 4), ca.SX.sym("constants", 9), Chain()
    cosines, on = constants[:4], Wheel(*ca.vertsplit(constants[4:8]))
    follow_cosines(chain, cosines, given[2:4])
    found = touch_patch(chain, patch, tuple(ca.vertsplit(given)), (cosines, on, constants[8]))
    whole = constants if record is None else ca.vertcat(constants, record)
    return Part(f"touching_{name}", given, whole, found.vector, chain)

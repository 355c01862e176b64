"""One patch of a wheel on its rail in 3D: its nearest point, its approach to the rail, and its curvatures.

This is like `rolling_contact`, but wheel and rail may be apart or penetrate each other. Along a `Patch` their distance
is measured square to its direction. The nearest point of rigid profiles, without yaw, comes from a table. One step of
Newton's method from there finds the common normal, eqs (3.54), (3.57), if the wheel yaws.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np

from fmu_src.chain import Bundle, Chain, Part, rows
from fmu_src.piecewise import look_up, look_up_in, numbers_in, polynomials
from rbd_model.body.kinematics import turned_by
from rbd_model.contact.patches import Patch
from rbd_model.contact.profiles import DEGREE, KNOT_DISTANCE, Profile
from rbd_model.wheelset.touch import Pieces, Placement, Touch, Wheel, follow_cosines, touch

#: Least sum of the curvatures of wheel and rail across the track in the search for a common normal [1/m]. Largest step
#: from the nearest point of the table [m]: half of a profile's piece, beyond which its polynomial is not valid.
LEAST_CURVATURE, LARGEST_STEP = 0.5, KNOT_DISTANCE / 10


@dataclass(frozen=True)
class TouchingPatch(Bundle):
    """The point where a patch touches or would touch; vectors in the wheelset's yaw-roll axes, except for `across`."""

    arm: ca.SX = rows(3)  # from the wheelset's centre to the nearest point of the wheel [m] (P)
    normal: ca.SX = rows(3)  # unit vector into the wheel
    across: ca.SX = rows(2)  # the normal in the axes of the track, its y and z
    approach: ca.SX = rows(1)  # by which the bodies press into each other [m]; negative where they are apart
    curvature_along: ca.SX = rows(1)  # A of eq. (3.83) [1/m]
    curvature_across: ca.SX = rows(1)  # B [1/m]
    position: ca.SX = rows(1)  # on the wheel's profile [m]


@dataclass(frozen=True)
class Meeting:
    """Wheel and rail square to a patch's direction: their distance [m], and the remaining error of the common
    normal.
    """

    gap: ca.SX
    mismatch: ca.SX  # sine of the angle between the normals
    uprightness: ca.SX  # of the wheel's normal in the patch's axes
    curvature: ca.SX  # of wheel and rail together, 2 B [1/m]


def along_and_square(one: Touch, height: ca.SX, direction: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Return coordinates of a point of the wheel (3.77) from the rail's origin along a patch's direction and square to
    it.

    height [m]: of the wheelset's centre over the rail; direction: its cosine and sine.
    """
    up = height + one.centre
    return direction[0] * one.on_rail + direction[1] * up, direction[0] * up - direction[1] * one.on_rail


def meet(one: Touch, on: Wheel, height: ca.SX, direction: ca.SX, bend: ca.SX, rail: ca.SX) -> Meeting:
    """Return distance and normals of a wheel's point and the rail beside it, as (3.54).

    bend: of the wheel's profile.
    """
    along, square = along_and_square(one, height, direction)
    value, slope, rail_bend = polynomials(rail, along, 2)
    unit = 1 / ca.sqrt(1 + slope**2)
    outward = on.side * one.across[0]
    leaning = direction[0] * outward + direction[1] * one.across[1]
    upright = direction[0] * one.across[1] - direction[1] * outward
    curvature = bend * one.unit**3 - rail_bend * unit**3
    return Meeting(square - value, unit * (leaning + slope * upright), upright, curvature)


@lru_cache
def patch_of_wheel(wheel_terms: int, rail_terms: int) -> Part:
    """Return the part for a `TouchingPatch`, from lateral position, height, yaw, roll and the table's nearest point.

    Equations (3.54), (3.83). Constants: direction cosines, the wheel, direction of the patch, and pieces of both
    profiles with `wheel_terms` and `rail_terms` terms.
    """
    given, constants = ca.SX.sym("given", 5), ca.SX.sym("constants", 10 + wheel_terms + rail_terms)
    lateral, height, yaw, roll, guess = ca.vertsplit(given)
    cosines, on, direction = constants[:4], Wheel(*ca.vertsplit(constants[4:8])), constants[8:10]
    wheel, rail = constants[10 : 10 + wheel_terms], constants[10 + wheel_terms :]
    chain = Chain()
    follow_cosines(chain, cosines, given[2:4])
    placement = Placement(yaw, roll, cosines, lateral)

    def at(position: ca.SX) -> tuple[Touch, Meeting]:
        one = touch(placement, on, position, wheel)
        return one, meet(one, on, height, direction, polynomials(wheel, position, 2)[2], rail)

    first, nearly = at(guess)
    step = nearly.mismatch * first.unit / ca.fmax(nearly.curvature, LEAST_CURVATURE)
    position = guess + ca.fmax(ca.fmin(step, LARGEST_STEP), -LARGEST_STEP)
    one, meeting = at(position)
    approach = -meeting.gap * meeting.uprightness
    shape = one.unit / (2 * one.radius), meeting.curvature / 2
    results = TouchingPatch(one.arm, one.normal, one.across, approach, *shape, position)
    return Part(f"patch_{wheel_terms}_{rail_terms}", given, constants, results.vector, chain)


@dataclass(frozen=True)
class Line:
    """The line along which a patch is described: `direction` [rad], `radius` [m] and `square` [m] of a `Patch`."""

    direction: float
    radius: float
    square: float

    @classmethod
    def of(cls, patch: Patch) -> Line:
        """Return that of a patch."""
        return cls(patch.direction, patch.radius, patch.square)

    @property
    def cosine_and_sine(self) -> tuple[float, float]:
        """Cosine and sine of its slope (section 3.3.2)."""
        return float(ca.cos(self.direction)), float(ca.sin(self.direction))


@dataclass(frozen=True)
class LineOfRecord:
    """The same of a patch in a contact table (`pair_table.PATCH`): numbers of an instance. A tread's line is level."""

    cosine_and_sine: tuple[ca.SX | float, ca.SX | float]
    radius: ca.SX
    square: ca.SX

    @classmethod
    def of(cls, chain: Chain, record: ca.SX, flange: bool) -> LineOfRecord:
        """Return that of the patch in a record."""
        numbers = numbers_in(chain, record, 4 if flange else 2)
        return cls((numbers[2], numbers[3]) if flange else (1.0, 0.0), numbers[0], numbers[1])


@dataclass(frozen=True)
class Outline:
    """A wheel's outline in the axes of a patch, from the rail's origin, including its motion by yaw and roll.

    along, square [m]: of its y = 0; cosine, sine: of its roll.
    """

    along: ca.SX
    square: ca.SX
    cosine: ca.SX
    sine: ca.SX

    @classmethod
    def of(cls, line: Line | LineOfRecord, placement: Placement, on: Wheel, height: ca.SX) -> Outline:
        """Return that of a wheel at a `placement`; height [m]: of the wheelset's centre over the rail.

        A wheel that yaws touches ahead of or behind its axle if it is steep. With the slope tan(g) of the direction,
        this distance is r tan(g) yaw, (3.54). It moves the outline outwards by r tan(g) yaw^2 and up by half of r
        tan(g)^2 yaw^2.
        """
        origin = turned_by(placement.cosines) @ ca.vertcat(0, on.side * on.wheel_half_distance, -on.radius)
        outward = on.side * (placement.lateral + origin[1]) - on.rail_half_distance
        up = height + origin[2]
        cosine, sine = line.cosine_and_sine
        slope, yawed = sine / cosine, on.radius * sine * placement.yaw**2
        level, leaning = placement.cosines[2], on.side * placement.cosines[3]
        return cls(
            cosine * outward + sine * up + yawed * (1 + slope**2 / 2),
            cosine * up - sine * outward - yawed * slope / 2,
            level,
            leaning,
        )

    def at(self, along: ca.SX, square: ca.SX | float) -> tuple[ca.SX, ca.SX]:
        """Return along and square coordinates from the rail's origin of a point with these from its y = 0 [m],
        (3.77).
        """
        return self.along + self.cosine * along - self.sine * square, (
            self.square + self.sine * along + self.cosine * square
        )


@dataclass(frozen=True)
class Nearest:
    """The point of a patch that is nearest to its rail without yaw, (3.77), (3.78).

    approach [m]: estimated to some hundredths of a millimetre, enough to determine which patches touch.
    """

    position: ca.SX
    pieces: Pieces
    on_rail: ca.SX  # position on the rail's profile in the patch's axes [m]
    approach: ca.SX


HashableTable = tuple[tuple[float, ...], tuple[tuple[float, ...], ...]]


def _hashable(breakpoints: np.ndarray, coefficients: np.ndarray) -> HashableTable:
    return tuple(breakpoints.tolist()), tuple(map(tuple, coefficients.tolist()))


@dataclass(frozen=True)
class PatchTables:
    """Data of a wheel's `Patch` for parts: its line, and breakpoints and coefficients of four tables, as tuples.

    nearest, along: those of the patch; wheel, rail: contours.
    """

    flange: bool
    line: Line
    nearest: HashableTable
    along: HashableTable
    wheel: HashableTable
    rail: HashableTable

    @classmethod
    def of(cls, patch: Patch, wheel: Profile) -> PatchTables:
        """Return those of a patch of a wheel with this profile."""
        tables = (patch.nearest, patch.along, wheel.pieces, patch.rail.pieces)
        return cls(patch.flange, Line.of(patch), *(_hashable(*one) for one in tables))


def find_nearest(chain: Chain, patch: PatchTables, at: tuple[Placement, Wheel, ca.SX]) -> Nearest:
    """Return the nearest point of a patch, pieces of both profiles there, and their relative position, (3.77), (3.78).

    at: position of the wheelset, its wheel, and its height over the rail.
    """
    placement, on, height = at
    given = ca.vertcat(placement.lateral, height, placement.yaw, placement.roll)
    constants = ca.vertcat(placement.cosines, on.vector)
    found = chain.call(nearest_point(patch), given, constants)
    of_wheel = 2 + len(patch.wheel[1][0])
    pieces = Pieces(found[1:of_wheel], found[of_wheel:])
    beside = beside_rail(patch.line, pieces.wheel.numel(), pieces.rail.numel())
    lies = chain.call(beside, ca.vertcat(given, found[0]), ca.vertcat(constants, pieces.vector))
    return Nearest(found[0], pieces, lies[0], lies[1])


def _placed(given: ca.SX, constants: ca.SX) -> tuple[Chain, tuple[Placement, Wheel, ca.SX]]:
    """Return a chain, and a wheel's position from arguments (lateral, height, yaw, roll) and constants."""
    chain, cosines = Chain(), constants[:4]
    follow_cosines(chain, cosines, given[2:4])
    placement = Placement(given[2], given[3], cosines, given[0])
    return chain, (placement, Wheel(*ca.vertsplit(constants[4:8])), given[1])


@lru_cache
def nearest_point(patch: PatchTables) -> Part:
    """Return the part for the position on the wheel's profile nearest to the rail, and both profiles' pieces there.

    Equations (3.77), (3.78). Arguments: lateral position, height, yaw and roll; constants: direction cosines and the
    wheel. In the wheel's axes, a roll moves the rail's arc as its centre moves.
    """
    given, constants = ca.SX.sym("given", 4), ca.SX.sym("constants", 8)
    chain, at = _placed(given, constants)
    outline = Outline.of(patch.line, *at)
    offset = outline.along + patch.line.radius * at[1].side * constants[3]

    def piece(name: str, table: HashableTable, place: ca.SX) -> ca.SX:
        return look_up(chain, name, np.array(table[0]), np.array(table[1]), place)

    guess = polynomials(piece("nearest", patch.nearest, offset), offset, 0)[0]
    same = patch.along == patch.nearest  # on the tread
    beside = guess if same else polynomials(piece("along", patch.along, offset), offset, 0)[0]
    on_rail = outline.at(beside, patch.line.square)[0]
    results = ca.vertcat(guess, piece("wheel", patch.wheel, guess), piece("rail", patch.rail, on_rail))
    name = hashlib.sha256(repr(patch).encode()).hexdigest()[:12]
    return Part(f"nearest_{name}", given, constants, results, chain)


#: Terms of a piece of a profile, with its origin; and of a table of nearest points without.
PROFILE_TERMS, NEAREST_TERMS = 2 + DEGREE, 4
#: Places of the tables of a `pair_table.PATCH`.
NEAREST, ALONG, WHEEL, RAIL = range(4)


def find_nearest_in(chain: Chain, record: ca.SX, flange: bool, at: tuple[Placement, Wheel, ca.SX]) -> Nearest:
    """Return the same as `find_nearest` for the patch in a record of a contact table, (3.77), (3.78)."""
    placement, on, height = at
    given = ca.vertcat(placement.lateral, height, placement.yaw, placement.roll)
    constants = ca.vertcat(placement.cosines, on.vector, record)
    found = chain.call(nearest_in_record(flange), given, constants)
    pieces = Pieces(found[1 : 1 + PROFILE_TERMS], found[1 + PROFILE_TERMS :])
    lies = chain.call(beside_in_record(flange), ca.vertcat(given, found[0]), ca.vertcat(constants, pieces.vector))
    return Nearest(found[0], pieces, lies[0], lies[1])


@lru_cache
def nearest_in_record(flange: bool) -> Part:
    """Return the part `nearest_point` of the patches in records, (3.77), (3.78); the record is the last constant."""
    given, constants = ca.SX.sym("given", 4), ca.SX.sym("constants", 9)
    chain, at = _placed(given, constants)
    line = LineOfRecord.of(chain, constants[8], flange)
    outline = Outline.of(line, *at)
    offset = outline.along + line.radius * at[1].side * constants[3]

    def piece(table: int, terms: int, place: ca.SX) -> ca.SX:
        return look_up_in(chain, constants[8], table, terms, place)

    guess = polynomials(piece(NEAREST, NEAREST_TERMS, offset), offset, 0)[0]
    beside = polynomials(piece(ALONG, NEAREST_TERMS, offset), offset, 0)[0] if flange else guess
    on_rail = outline.at(beside, line.square)[0]
    results = ca.vertcat(guess, *(piece(table, 1 + DEGREE, at) for table, at in ((WHEEL, guess), (RAIL, on_rail))))
    return Part(f"nearest_on_{_place(flange)}", given, constants, results, chain)


@lru_cache
def beside_in_record(flange: bool) -> Part:
    """Return the part `beside_rail` of the patches in records, (3.78)."""
    given, constants = ca.SX.sym("given", 5), ca.SX.sym("constants", 9 + 2 * PROFILE_TERMS)
    chain, at = _placed(given, constants)
    line, pieces = LineOfRecord.of(chain, constants[8], flange), constants[9:]
    results = _beside(line, at, given[4], pieces[:PROFILE_TERMS], pieces[PROFILE_TERMS:])
    return Part(f"beside_{_place(flange)}", given, constants, results, chain)


def _place(flange: bool) -> str:
    return "flange" if flange else "tread"


@lru_cache
def beside_rail(line: Line, wheel_terms: int, rail_terms: int) -> Part:
    """Return the part for the nearest point's position on the rail's profile [m] and its approach [m], (3.78).

    Arguments: those of `nearest_point` and its position. Constants: the same, and pieces of both profiles.
    """
    given, constants = ca.SX.sym("given", 5), ca.SX.sym("constants", 8 + wheel_terms + rail_terms)
    chain, at = _placed(given, constants)
    wheel, rail = constants[8 : 8 + wheel_terms], constants[8 + wheel_terms :]
    results = _beside(line, at, given[4], wheel, rail)
    name = hashlib.sha256(repr(line).encode()).hexdigest()[:12]
    return Part(f"beside_{name}_{wheel_terms}_{rail_terms}", given, constants, results, chain)


def _beside(
    line: Line | LineOfRecord, at: tuple[Placement, Wheel, ca.SX], guess: ca.SX, wheel: ca.SX, rail: ca.SX
) -> ca.SX:
    outline, (cosine, sine) = Outline.of(line, *at), line.cosine_and_sine
    rises = polynomials(wheel, guess, 0)[0]
    along, square = outline.at(cosine * guess + sine * rises, cosine * rises - sine * guess)
    return ca.vertcat(along, polynomials(rail, along, 0)[0] - square)

"""One patch of a wheel on its rail in space: its nearest point, how far it presses into the rail, and with which shape.

As `rolling_contact`, but wheel and rail may be apart or pressed into each other, and along a `Patch` their distance is
taken square to its direction. The nearest point of rigid profiles, without yaw, comes from a table; one step of
Newton's method from there finds the common normal, eqs (3.54), (3.57), where the wheel yaws.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import casadi as ca

from fmu_src.chain import Bundle, Chain, Part, rows
from fmu_src.system import System, polynomials
from rbd_model.body.kinematics import turned_by
from rbd_model.contact.patches import Patch
from rbd_model.contact.profiles import KNOT_DISTANCE, Profile
from rbd_model.wheelset.touch import Pieces, Placement, Touch, Wheel, follow_cosines, touch

#: Least sum of the curvatures of wheel and rail across the track with which a common normal is looked for [1/m], and
#: how far from the nearest point of the table [m]: half of a profile's piece, beyond which its polynomial means little.
LEAST_CURVATURE, LARGEST_STEP = 0.5, KNOT_DISTANCE / 10


@dataclass(frozen=True)
class TouchingPatch(Bundle):
    """Where a patch touches or would touch; vectors in the wheelset's yaw-roll axes, but for `across`."""

    arm: ca.SX = rows(3)  # from the wheelset's centre to the nearest point of the wheel [m] (P)
    normal: ca.SX = rows(3)  # unit vector into the wheel
    across: ca.SX = rows(2)  # the normal in the axes of the track, its y and z
    approach: ca.SX = rows(1)  # by which the bodies press into each other [m]; negative where they are apart
    curvature_along: ca.SX = rows(1)  # A of eq. (3.83) [1/m]
    curvature_across: ca.SX = rows(1)  # B [1/m]
    position: ca.SX = rows(1)  # on the wheel's profile [m]


@dataclass(frozen=True)
class Meeting:
    """Wheel and rail square to a patch's direction: their distance [m], and what of the common normal is missing."""

    gap: ca.SX
    mismatch: ca.SX  # sine of the angle between the normals
    uprightness: ca.SX  # of the wheel's normal in the patch's axes
    curvature: ca.SX  # of wheel and rail together, 2 B [1/m]


def along_and_square(one: Touch, height: ca.SX, direction: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Coordinates of a point of the wheel (3.77) from the rail's origin along the patch's direction and square to it.

    height [m]: of the wheelset's centre over the rail; direction: its cosine and sine.
    """
    up = height + one.centre
    return direction[0] * one.on_rail + direction[1] * up, direction[0] * up - direction[1] * one.on_rail


def meet(one: Touch, on: Wheel, height: ca.SX, direction: ca.SX, bend: ca.SX, rail: ca.SX) -> Meeting:
    """Distance and normals of the wheel's point and of the rail beside it, as (3.54); bend: of the wheel's profile."""
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
    """A `TouchingPatch` of lateral position, height, yaw, roll and the nearest point of the table, (3.54), (3.83).

    Constants: direction cosines, the wheel, direction of the patch, pieces of both profiles with so many terms.
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
class Outline:
    """A wheel's outline in the axes of a patch, from the rail's origin, as far as yaw and roll move it there.

    along, square [m]: of its y = 0; cosine, sine: of its roll.
    """

    along: ca.SX
    square: ca.SX
    cosine: ca.SX
    sine: ca.SX

    @classmethod
    def of(cls, patch: Patch, placement: Placement, on: Wheel, height: ca.SX) -> Outline:
        """Of a wheel that stands as `placement` says; height [m]: of the wheelset's centre over the rail.

        A wheel that yaws touches ahead of or behind its axle where it is steep: with the slope tan(g) of the direction
        by r tan(g) yaw, (3.54), which moves its outline outwards by r tan(g) yaw^2 and up by half of r tan(g)^2 yaw^2.
        """
        origin = turned_by(placement.cosines) @ ca.vertcat(0, on.side * on.wheel_half_distance, -on.radius)
        outward = on.side * (placement.lateral + origin[1]) - on.rail_half_distance
        up = height + origin[2]
        cosine, sine = direction_of(patch)
        slope, yawed = sine / cosine, on.radius * sine * placement.yaw**2
        level, leaning = placement.cosines[2], on.side * placement.cosines[3]
        return cls(
            cosine * outward + sine * up + yawed * (1 + slope**2 / 2),
            cosine * up - sine * outward - yawed * slope / 2,
            level,
            leaning,
        )

    def at(self, along: ca.SX, square: ca.SX | float) -> tuple[ca.SX, ca.SX]:
        """Along and square coordinates from the rail's origin of a point that has these from its y = 0 [m], (3.77)."""
        return self.along + self.cosine * along - self.sine * square, (
            self.square + self.sine * along + self.cosine * square
        )


def direction_of(patch: Patch) -> tuple[float, float]:
    """Cosine and sine of the slope along which a patch is described (section 3.3.2)."""
    return float(ca.cos(patch.direction)), float(ca.sin(patch.direction))


@dataclass(frozen=True)
class Nearest:
    """The point of a patch that is nearest to its rail without yaw, (3.77), (3.78).

    approach [m]: what it says of the approach, to some hundredths of a millimetre: enough to tell who touches.
    """

    position: ca.SX
    pieces: Pieces
    on_rail: ca.SX  # position on the rail's profile in the patch's axes [m]
    approach: ca.SX


def look_up_patch(
    system: System, name: str, patch: Patch, wheel: Profile, at: tuple[Placement, Wheel, ca.SX]
) -> Nearest:
    """Nearest point of a patch and pieces of both profiles there (3.77), (3.78).

    at: where the wheelset stands, its wheel, and its height over the rail. Adds the tables, named after `name`. Seen
    from the wheel, a roll moves the rail's arc as its centre moves.
    """
    placement, on, _ = at
    outline = Outline.of(patch, *at)
    offset = outline.along + patch.radius * on.side * placement.cosines[3]
    guess = system.table(f"nearest_{name}", *patch.nearest, offset)
    piece = system.look_up(f"wheel_{name}", *wheel.pieces, guess)
    beside = system.table(f"along_{name}", *patch.along, offset)
    rail = system.look_up(f"rail_{name}", *patch.rail.pieces, outline.at(beside, patch.square)[0])
    cosine, sine = direction_of(patch)
    rises = polynomials(piece, guess, 0)[0]
    along, square = outline.at(cosine * guess + sine * rises, cosine * rises - sine * guess)
    return Nearest(guess, Pieces(piece, rail), along, polynomials(rail, along, 0)[0] - square)

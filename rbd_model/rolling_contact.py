"""One wheel on its rail in space: where they touch, and how the wheel slides there.

The wheel is a surface of revolution with the radius r(s) = r0 - w(s), the rail a prism with the height rho(u); s and u
are positions across the profiles, positive to the field side. `side` is 1 for the left wheel and -1 for the right one.

Contact asks for a common normal and no gap, eqs (3.54), (3.57). In the axes that yaw and roll with the wheelset the
wheel's normal at (s, theta) is (-sin theta, -side w', cos theta) / sqrt(1 + w'^2). That it stands across the rail gives
theta in closed form; that the rail's slope is the same is one equation for s; and the height follows from no gap.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import casadi as ca

from fmu_src.chain import Part
from fmu_src.system import System, polynomials
from rbd_model.contact_geometry import Pair
from rbd_model.kinematics import yaw_roll
from rbd_model.profiles import Profile

LEFT, RIGHT = 1, -1
SIDES = {LEFT: "left", RIGHT: "right"}


@dataclass(frozen=True)
class Placement:
    """Where a wheelset stands: yaw and roll [rad], lateral position over the rails [m], radius of the wheel [m]."""

    yaw: ca.SX
    roll: ca.SX
    lateral: ca.SX
    wheel_radius: ca.SX


@dataclass(frozen=True)
class WheelContact:
    """Geometry of one contact; vectors in the wheelset's yaw-roll axes, but for `across`."""

    side: int
    arm: ca.SX  # from the wheelset's centre to the contact point [m] (P)
    normal: ca.SX  # unit vector into the wheel
    along: ca.SX  # unit vector along the rail
    across: ca.SX  # the normal in the axes of the track, its y and z; along the rail it has no part
    lever: ca.SX  # moment arms of the normal force about x and z [m]; it has none about the axle, which its line meets
    height: ca.SX  # height of the wheelset's centre over the rail's origin that leaves no gap [m]
    slope_error: ca.SX  # 0 where wheel and rail have a common normal
    curvature_along: ca.SX  # of the contact, A of eq. (3.83) [1/m]
    curvature_across: ca.SX  # B [1/m]
    #: Derivatives of (across, lever, slope_error) by lateral position, yaw, roll and position s, shape (5, 4).
    slopes: ca.SX
    inside: ca.SX  # distance of the contact from the nearest end of either profile [m]

    @property
    def sideways(self) -> ca.SX:
        """Unit vector of lateral creep: from the normal to the left."""
        return ca.cross(self.normal, self.along)

    @property
    def bend(self) -> ca.SX:
        """How the slope error changes with the position s [1/m]; 0 at the fold."""
        return self.slopes[4, 3]

    def rate(self, placement_rate: ca.SX) -> ca.SX:
        """Rates of (across, lever) while lateral position, yaw and roll change; the contact moves as (3.57) asks."""
        travel = -(self.slopes[4, :3] @ placement_rate) / self.bend
        return self.slopes[:4, :] @ ca.vertcat(placement_rate, travel)


@dataclass(frozen=True)
class Touch:
    """A wheel and a rail in the terms of the part: where they are, and where the contact lies on the rail."""

    arm: ca.SX
    normal: ca.SX
    along: ca.SX
    across: ca.SX
    on_rail: ca.SX
    centre: ca.SX  # height of the contact over the wheelset's centre [m]
    unit: ca.SX
    radius: ca.SX


def touch(placement: Placement, side: ca.SX, position: ca.SX, half: tuple[ca.SX, ca.SX], wheel: ca.SX) -> Touch:
    """Contact point of a wheel (3.77) at the position s: the normal stands across the rail, from (3.54).

    half [m]: half distances of the wheels' and of the rails' y = 0; wheel: the piece of its profile at s.
    """
    profile, slope = polynomials(wheel, position, 1)
    axes, radius = yaw_roll(placement.yaw, placement.roll), placement.wheel_radius - profile
    along = axes[0, :].T
    # -sin(theta) t1 - side w' t2 + cos(theta) t3 = 0: the normal stands across the rail, whose direction is t.
    level = 1 / ca.sqrt(along[0] ** 2 + along[2] ** 2)
    lead = -side * slope * along[1] * level
    rest = ca.sqrt(1 - lead**2)
    sine, cosine = level * (lead * along[0] + rest * along[2]), level * (rest * along[0] - lead * along[2])
    unit = 1 / ca.sqrt(1 + slope**2)
    normal = unit * ca.vertcat(-sine, -side * slope, cosine)
    arm = ca.vertcat(radius * sine, side * (half[0] + position), -radius * cosine)
    across, place = (axes @ normal)[1:], axes @ arm
    on_rail = side * (placement.lateral + place[1]) - half[1]
    return Touch(arm, normal, along, across, on_rail, place[2], unit, radius)


@lru_cache
def contact_of_wheel(wheel_terms: int, rail_terms: int) -> Part:
    """Geometry of one contact, eqs (3.54), (3.57), (3.83), of lateral position, yaw, roll and position on the wheel.

    Constants: side, radius, half distances, pieces of both profiles with so many terms. Results: arm, normal, across,
    lever, slope error, height, both curvatures, and `slopes` of a WheelContact.
    """
    given, constants = ca.SX.sym("given", 4), ca.SX.sym("constants", 4 + wheel_terms + rail_terms)
    lateral, yaw, roll, position = ca.vertsplit(given)
    side, radius, *half = ca.vertsplit(constants[:4])
    wheel, rail = constants[4 : 4 + wheel_terms], constants[4 + wheel_terms :]
    one = touch(Placement(yaw, roll, lateral, radius), side, position, (half[0], half[1]), wheel)
    bend = polynomials(wheel, position, 2)[2]
    height, rail_slope, rail_bend = polynomials(rail, one.on_rail, 2)
    rail_unit = 1 / ca.sqrt(1 + rail_slope**2)
    moment = ca.cross(one.arm, one.normal)
    moving = ca.vertcat(one.across, moment[0], moment[2], -side * one.across[0] - rail_slope * one.across[1])
    curvatures = one.unit / (2 * one.radius), (bend * one.unit**3 - rail_bend * rail_unit**3) / 2
    results = ca.vertcat(one.arm, one.normal, moving, height - one.centre, *curvatures)
    return Part(
        f"contact_{wheel_terms}_{rail_terms}", given, constants, ca.vertcat(results, ca.vec(ca.jacobian(moving, given)))
    )


def wheel_contact(
    system: System, name: str, pair: Pair, placement: Placement, side: int, position: ca.SX
) -> WheelContact:
    """Contact of a wheel (3.77) at the position s on its profile with a rail (3.78): eqs (3.54), (3.57), (3.83).

    Adds the tables of both profiles, named after `name`.
    """
    half = ca.SX(pair.wheel_half_distance), ca.SX(pair.rail_half_distance)
    wheel = system.look_up(f"wheel_{name}", *pair.wheel.pieces, position)
    one = touch(placement, ca.SX(side), position, half, wheel)
    rail = system.look_up(f"rail_{name}", *pair.rail.pieces, one.on_rail)
    given = ca.vertcat(placement.lateral, placement.yaw, placement.roll, position)
    constants = ca.vertcat(side, placement.wheel_radius, *half, wheel, rail)
    found = system.call(contact_of_wheel(wheel.numel(), rail.numel()), given, constants)
    return WheelContact(
        side,
        arm=found[0:3],
        normal=found[3:6],
        along=one.along,
        across=found[6:8],
        lever=found[8:10],
        slope_error=found[10],
        height=found[11],
        curvature_along=found[12],
        curvature_across=found[13],
        slopes=ca.reshape(found[14:], 5, 4),
        inside=ca.fmin(_inside(pair.wheel, position), _inside(pair.rail, one.on_rail)),
    )


def _inside(profile: Profile, y: ca.SX) -> ca.SX:
    """Distance from the nearer end of a profile [m], negative beyond it."""
    low, high = profile.limits
    return ca.fmin(y - low, high - y)

"""One wheel on its rail in space: where they touch, and how the wheel slides there.

The wheel is a surface of revolution with the radius r(s) = r0 - w(s), the rail a prism with the height rho(u); s and u
are positions across the profiles, positive to the field side. `side` is 1 for the left wheel and -1 for the right one.

Contact asks for a common normal and no gap, eqs (3.54), (3.57). In the axes that yaw and roll with the wheelset the
wheel's normal at (s, theta) is (-sin theta, -side w', cos theta) / sqrt(1 + w'^2). That it stands across the rail gives
theta in closed form; that the rail's slope is the same is one equation for s; and the height follows from no gap.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from fmu_src.system import System
from rbd_model.contact_geometry import Pair
from rbd_model.profiles import Profile

LEFT, RIGHT = 1, -1
SIDES = {LEFT: "left", RIGHT: "right"}


@dataclass(frozen=True)
class Placement:
    """Where a wheelset stands: its yaw-roll axes (3 x 3, columns in the axes of the track) and lateral position [m]."""

    axes: ca.SX
    lateral: ca.SX
    wheel_radius: ca.SX


@dataclass(frozen=True)
class WheelContact:
    """Geometry of one contact; vectors in the wheelset's yaw-roll axes, but for `across`."""

    side: int
    position: ca.SX  # s [m]
    arm: ca.SX  # from the wheelset's centre to the contact point [m] (P)
    normal: ca.SX  # unit vector into the wheel
    along: ca.SX  # unit vector along the rail
    across: ca.SX  # the normal in the axes of the track, its y and z; along the rail it has no part
    height: ca.SX  # height of the wheelset's centre over the rail's origin that leaves no gap [m]
    slope_error: ca.SX  # 0 where wheel and rail have a common normal
    curvature_along: ca.SX  # of the contact, A of eq. (3.83) [1/m]
    curvature_across: ca.SX  # B [1/m]
    inside: ca.SX  # distance of the contact from the nearest end of either profile [m]

    @property
    def sideways(self) -> ca.SX:
        """Unit vector of lateral creep: from the normal to the left."""
        return ca.cross(self.normal, self.along)

    @property
    def lever(self) -> ca.SX:
        """Moment arms of the normal force [m]; it has none about the axle, which its line meets."""
        moment = ca.cross(self.arm, self.normal)
        return ca.vertcat(moment[0], 0, moment[2])


def wheel_contact(
    system: System, name: str, pair: Pair, placement: Placement, side: int, position: ca.SX, rail_shift: ca.SX
) -> WheelContact:
    """Contact of a wheel (3.77) at the position s on its profile with a rail (3.78): eqs (3.54), (3.57), (3.83).

    Adds the tables of both profiles, named after `name`. rail_shift [m]: lateral irregularity of the rail.
    """
    wheel, slope, bend = system.curve(f"wheel_{name}", *pair.wheel.pieces, position, 2)
    axes, radius = placement.axes, placement.wheel_radius - wheel
    along = axes[0, :].T
    # -sin(theta) t1 - side w' t2 + cos(theta) t3 = 0: the normal stands across the rail, whose direction is t.
    level = 1 / ca.sqrt(along[0] ** 2 + along[2] ** 2)
    lead = -side * slope * along[1] * level
    rest = ca.sqrt(1 - lead**2)
    sine, cosine = level * (lead * along[0] + rest * along[2]), level * (rest * along[0] - lead * along[2])
    unit = 1 / ca.sqrt(1 + slope**2)
    normal = unit * ca.vertcat(-sine, -side * slope, cosine)
    arm = ca.vertcat(radius * sine, side * (pair.wheel_half_distance + position), -radius * cosine)

    across, place = (axes @ normal)[1:], axes @ arm
    on_rail = side * (placement.lateral + place[1] - rail_shift) - pair.rail_half_distance
    rail, rail_slope, rail_bend = system.curve(f"rail_{name}", *pair.rail.pieces, on_rail, 2)
    rail_unit = 1 / ca.sqrt(1 + rail_slope**2)
    return WheelContact(
        side,
        position,
        arm,
        normal,
        along,
        across,
        rail - place[2],
        -side * across[0] - rail_slope * across[1],
        unit / (2 * radius),
        (bend * unit**3 - rail_bend * rail_unit**3) / 2,
        ca.fmin(_inside(pair.wheel, position), _inside(pair.rail, on_rail)),
    )


def _inside(profile: Profile, y: ca.SX) -> ca.SX:
    """Distance from the nearer end of a profile [m], negative beyond it."""
    low, high = profile.limits
    return ca.fmin(y - low, high - y)

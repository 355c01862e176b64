"""The contact of a wheel with a rail by a point of its profile, common to all contact models.

The wheel is a surface of revolution with the radius r(s) = r0 - w(s), the rail a prism with the height rho(u).
Positions across the profiles, s and u, are positive to the field side. `side` is 1 for the left wheel and -1 for the
right one.

In the axes that yaw and roll with the wheelset the wheel's normal at (s, theta) is (-sin theta, -side w', cos theta) /
sqrt(1 + w'^2). Its direction across the rail gives theta in closed form, from eq. (3.54).
"""

from __future__ import annotations

from dataclasses import dataclass

from fmu_src.chain import Chain
from fmu_src.piecewise import polynomials
from fmu_src.symbols import ca
from rbd_model.body.kinematics import turned_by

LEFT, RIGHT = 1, -1

SIDES = {LEFT: "left", RIGHT: "right"}


@dataclass(frozen=True)
class Placement:
    """Position of a wheelset: yaw and roll [rad], their `direction_cosines`, lateral position over the rails [m]."""

    yaw: ca.SX
    roll: ca.SX
    cosines: ca.SX
    lateral: ca.SX


@dataclass(frozen=True)
class Wheel:
    """A wheel on its rail: side, radius [m], half distances of the wheels' and of the rails' y = 0 [m]."""

    side: ca.SX
    radius: ca.SX
    wheel_half_distance: ca.SX
    rail_half_distance: ca.SX

    @property
    def vector(self) -> ca.SX:
        """All of its values, shape (4, 1)."""
        return ca.vertcat(self.side, self.radius, self.wheel_half_distance, self.rail_half_distance)


@dataclass(frozen=True)
class Touch:
    """A wheel and a rail in the terms of the part: their positions, and that of the contact on the rail."""

    arm: ca.SX
    normal: ca.SX
    along: ca.SX
    across: ca.SX
    on_rail: ca.SX
    centre: ca.SX  # height of the contact over the wheelset's centre [m]
    unit: ca.SX
    radius: ca.SX


def touch(placement: Placement, on: Wheel, position: ca.SX, piece: ca.SX) -> Touch:
    """Return the contact point of a wheel (3.77) at the position s: the normal is across the rail, from (3.54).

    piece: of the wheel's profile at s.
    """
    return touch_at(placement, on, position, *polynomials(piece, position, 1))


def touch_at(placement: Placement, on: Wheel, position: ca.SX, profile: ca.SX, slope: ca.SX) -> Touch:
    """Return the same from the height [m] and the slope of the wheel's profile there, (3.54), (3.77)."""
    axes, radius = turned_by(placement.cosines), on.radius - profile
    along = axes[0, :].T
    # -sin(theta) t1 - side w' t2 + cos(theta) t3 = 0: the normal is across the rail, whose direction is t.
    level = 1 / ca.sqrt(along[0] ** 2 + along[2] ** 2)
    lead = -on.side * slope * along[1] * level
    rest = ca.sqrt(1 - lead**2)
    sine, cosine = level * (lead * along[0] + rest * along[2]), level * (rest * along[0] - lead * along[2])
    unit = 1 / ca.sqrt(1 + slope**2)
    normal = unit * ca.vertcat(-sine, -on.side * slope, cosine)
    arm = ca.vertcat(radius * sine, on.side * (on.wheel_half_distance + position), -radius * cosine)
    across, place = (axes @ normal)[1:], axes @ arm
    on_rail = on.side * (placement.lateral + place[1]) - on.rail_half_distance
    return Touch(arm, normal, along, across, on_rail, place[2], unit, radius)


def follow_cosines(chain: Chain, cosines: ca.SX, turned: ca.SX) -> None:
    """Declare derivatives of a part's `direction_cosines` (section 3.2.1) by yaw and roll, its arguments."""
    change = ca.vertcat(-cosines[1], cosines[0], -cosines[3], cosines[2])
    chain.follow(cosines, turned, ca.horzcat(ca.vertcat(change[:2], 0, 0), ca.vertcat(0, 0, change[2:])))


@dataclass(frozen=True)
class Pieces:
    """The pieces of both profiles at the contact of a wheel with its rail."""

    wheel: ca.SX
    rail: ca.SX

    @property
    def vector(self) -> ca.SX:
        """Both, one below the other."""
        return ca.vertcat(self.wheel, self.rail)

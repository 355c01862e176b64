"""One wheel on its rail in 3D: its contact point and its sliding there.

The wheel is a surface of revolution with the radius r(s) = r0 - w(s), the rail a prism with the height rho(u).
Positions across the profiles, s and u, are positive to the field side. `side` is 1 for the left wheel and -1 for the
right one.

A contact has a common normal and no gap, eqs (3.54), (3.57). In the axes that yaw and roll with the wheelset the
wheel's normal at (s, theta) is (-sin theta, -side w', cos theta) / sqrt(1 + w'^2). Its direction across the rail gives
theta in closed form. The equal slope of the rail is one equation for s. The height follows from no gap.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

from fmu_src.chain import Chain, Part
from fmu_src.piecewise import polynomials
from fmu_src.symbols import ca
from fmu_src.system import System
from rbd_model.body.kinematics import turned_by
from rbd_model.contact.geometry import Pair
from rbd_model.wheelset.touch import Pieces, Placement, Wheel, follow_cosines, touch


@dataclass(frozen=True)
class WheelContact:
    """Geometry of one contact; vectors in the wheelset's yaw-roll axes, except for `across`."""

    side: ca.SX
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
    on_rail: ca.SX  # position on the rail's profile [m]

    @property
    def sideways(self) -> ca.SX:
        """Unit vector of lateral creep: from the normal to the left."""
        return ca.cross(self.normal, self.along)

    @property
    def bend(self) -> ca.SX:
        """Derivative of the slope error by the position s [1/m]; 0 at the fold."""
        return self.slopes[4, 3]

    def rate(self, placement_rate: ca.SX) -> ca.SX:
        """Return rates of (across, lever) while lateral position, yaw and roll change; the contact moves by (3.57)."""
        travel = -(self.slopes[4, :3] @ placement_rate) / self.bend
        return self.slopes[:4, :] @ ca.vertcat(placement_rate, travel)


@lru_cache
def contact_of_wheel(wheel_terms: int, rail_terms: int) -> Part:
    """Return the part for the geometry of one contact, eqs (3.54), (3.57), (3.83).

    Arguments: lateral position, yaw, roll and position on the wheel. Constants: direction cosines, the wheel, pieces of
    both profiles with `wheel_terms` and `rail_terms` terms. Results: arm, normal, across, lever, slope error, height,
    both curvatures, position on the rail, and `slopes` of a WheelContact.
    """
    given, constants = ca.SX.sym("given", 4), ca.SX.sym("constants", 8 + wheel_terms + rail_terms)
    lateral, yaw, roll, position = ca.vertsplit(given)
    cosines, on = constants[:4], Wheel(*ca.vertsplit(constants[4:8]))
    wheel, rail = constants[8 : 8 + wheel_terms], constants[8 + wheel_terms :]
    chain = Chain()
    follow_cosines(chain, cosines, given[1:3])
    one = touch(Placement(yaw, roll, cosines, lateral), on, position, wheel)
    bend = polynomials(wheel, position, 2)[2]
    height, rail_slope, rail_bend = polynomials(rail, one.on_rail, 2)
    rail_unit = 1 / ca.sqrt(1 + rail_slope**2)
    moment = ca.cross(one.arm, one.normal)
    moving = ca.vertcat(one.across, moment[0], moment[2], -on.side * one.across[0] - rail_slope * one.across[1])
    curvatures = one.unit / (2 * one.radius), (bend * one.unit**3 - rail_bend * rail_unit**3) / 2
    results = ca.vertcat(one.arm, one.normal, moving, height - one.centre, *curvatures, one.on_rail)
    slopes = ca.vec(ca.densify(chain.jacobian(moving, given)))
    return Part(f"contact_{wheel_terms}_{rail_terms}", given, constants, ca.vertcat(results, slopes), chain)


@lru_cache
def end_of_contact(wheel_terms: int, rail_terms: int) -> Part:
    """Return the part with those results of `contact_of_wheel` that determine its end: its bend (3.57) and rail place
    [m].
    """
    whole = contact_of_wheel(wheel_terms, rail_terms)
    return replace(whole, name=f"end_of_{whole.name}", results=whole.results[[BEND, ON_RAIL]])


#: Places in the results of `contact_of_wheel`.
ON_RAIL, SLOPES, BEND = 14, 15, 34


def look_up_profiles(system: System, name: str, pair: Pair, placement: Placement, on: Wheel, position: ca.SX) -> Pieces:
    """Return pieces of both profiles at the position s on the wheel (3.77), (3.78); adds their tables, named `name`."""
    wheel = system.look_up(f"wheel_{name}", *pair.wheel.pieces, position)
    on_rail = touch(placement, on, position, wheel).on_rail
    return Pieces(wheel, system.look_up(f"rail_{name}", *pair.rail.pieces, on_rail))


def given_to_contact(placement: Placement, on: Wheel, position: ca.SX, pieces: Pieces) -> tuple[ca.SX, ca.SX]:
    """Return arguments and constants of `contact_of_wheel` at the position s on the profile, (3.77)."""
    given = ca.vertcat(placement.lateral, placement.yaw, placement.roll, position)
    return given, ca.vertcat(placement.cosines, on.vector, pieces.vector)


def wheel_contact(chain: Chain, placement: Placement, on: Wheel, position: ca.SX, pieces: Pieces) -> WheelContact:
    """Return the contact of a wheel (3.77) at the position s on its profile with a rail (3.78): (3.54), (3.57),
    (3.83).
    """
    part = contact_of_wheel(pieces.wheel.numel(), pieces.rail.numel())
    found = chain.call(part, *given_to_contact(placement, on, position, pieces))
    return WheelContact(
        on.side,
        arm=found[0:3],
        normal=found[3:6],
        along=turned_by(placement.cosines)[0, :].T,
        across=found[6:8],
        lever=found[8:10],
        slope_error=found[10],
        height=found[11],
        curvature_along=found[12],
        curvature_across=found[13],
        slopes=ca.reshape(found[SLOPES:], 5, 4),
        on_rail=found[ON_RAIL],
    )


def inside(pair: Pair, position: ca.SX, on_rail: ca.SX) -> ca.SX:
    """Return the distance of a contact from the nearest end of either profile [m], negative beyond it.

    Section 9.4.1.
    """
    (low, high), (first, last) = pair.wheel.limits, pair.rail.limits
    return ca.fmin(ca.fmin(position - low, high - position), ca.fmin(on_rail - first, last - on_rail))

"""Forces of one patch of a wheel: the rail's normal force and the creep forces, by its approach and its sliding.

Treads and flanges are two parts. Each is generated once, called for each such patch of each wheel of a vehicle, and
evaluated only if it may touch.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import casadi as ca

from fmu_src.chain import Bundle, Chain, Part, rows
from rbd_model.body.kinematics import turned_by
from rbd_model.contact.creep.law import SMALLEST_LOAD, at_least
from rbd_model.contact.creep_of_wheel import creep_of_wheel, how_it_slides
from rbd_model.contact.depth import Contact
from rbd_model.contact.elastic import damped, elastic_force
from rbd_model.contact.friction import friction_over_angle
from rbd_model.wheelset.touch import Pieces, follow_cosines
from rbd_model.wheelset.touching_patch import TouchingPatch, patch_of_wheel


@dataclass(frozen=True)
class PatchState(Bundle):
    """Position and motion of a wheelset, with the rail's slopes, friction and nearest point at a patch of a wheel."""

    forward: ca.SX = rows(1)  # v_x [m/s]
    sideways: ca.SX = rows(1)  # v_y [m/s]
    rise: ca.SX = rows(1)  # v_z [m/s]
    roll_rate: ca.SX = rows(1)  # omega_x [rad/s]
    angular_velocity: ca.SX = rows(1)  # omega_y [rad/s]
    yaw_rate: ca.SX = rows(1)  # omega_z [rad/s]
    offset: ca.SX = rows(1)  # lateral displacement from the track's centre [m]
    height: ca.SX = rows(1)  # of the wheelset's centre over the rail [m]
    yaw: ca.SX = rows(1)  # [rad]
    roll: ca.SX = rows(1)  # [rad]
    slopes: ca.SX = rows(2)  # of the rail along the track, sideways and upwards [1]
    friction: ca.SX = rows(1)  # without sliding [1]
    nearest: ca.SX = rows(1)  # position on the wheel's profile without yaw [m]


@dataclass(frozen=True)
class TurningTrack(Bundle):
    """The turning of the axes of a track that is not straight, and the ratio of the wheelset's travel to that of its
    place.

    Both follow a `PatchState`, whose slopes are then those of the rail's place in these axes: as the axes turn, so does
    the place.
    """

    turning: ca.SX = rows(3)  # as in `TrackFrame` [rad/m]
    stretch: ca.SX = rows(1)  # as `Body.stretch` [1]

    @classmethod
    def straight(cls) -> TurningTrack:
        """Return that of straight track, section 3.2.1."""
        return cls(ca.SX.zeros(3), ca.SX(1))


@dataclass(frozen=True)
class PatchConstants(Bundle):
    """Inputs of a patch that are not differentiated; the cosines are those of `direction_cosines`."""

    cosines: ca.SX = rows(4)
    wheel: ca.SX = rows(4)  # `Wheel`
    direction: ca.SX = rows(2)  # cosine and sine
    creepage_speed: ca.SX = rows(1)  # [m/s]
    shear_modulus: ca.SX = rows(1)  # [Pa]
    surface: ca.SX = rows(5)
    damping: ca.SX = rows(1)  # of the contact [s/m]
    gauge_face: ca.SX = rows(1)  # factor on the friction of the rail's gauge face [1]


@dataclass(frozen=True)
class Press(Bundle):
    """Effect of one patch on its wheelset: force in the axes of the track, moment in the wheelset's own."""

    force: ca.SX = rows(3)  # [N]
    moment: ca.SX = rows(3)  # [N.m]
    creep_along: ca.SX = rows(1)  # creep force along the rail [N]
    creep_power: ca.SX = rows(1)  # what both creep forces take [W]
    approach: ca.SX = rows(1)  # [m]
    damping_power: ca.SX = rows(1)  # what the contact loses as it is pressed [W]
    stored: ca.SX = rows(1)  # its energy [J]


@dataclass(frozen=True)
class RailSlope:
    """Deviation of a rail from the track's direction at the contact of a patch, to first order of its slopes, for
    (3.89).

    Along the rail it goes sideways by `aside` and into the wheel by `drift` for each metre [1]. A wheel touches a
    rising rail ahead of its axle, by r drift / n_z. Its surface moves down there: sideways on the patch by `lead` for
    each radian of rotation [m]. Sliding and forces are consistent in virtual work.
    """

    aside: ca.SX
    drift: ca.SX
    lead: ca.SX

    @classmethod
    def of(
        cls, chain: Chain, track: TurningTrack, patch: TouchingPatch, sideways: ca.SX, sections: ca.SX, drift: ca.SX
    ) -> RailSlope:
        """sideways: in the wheelset's axes; sections: slopes per metre of the track; drift: see `press`."""
        if track.turning.is_zero():
            return cls(ca.SX(0), ca.SX(0), ca.SX(0))
        aside = (patch.across[1] * sections[0] - patch.across[0] * sections[1]) / track.stretch
        lead = patch.arm[2] * drift * sideways[2] / patch.normal[2]
        return cls(chain.narrow(aside), drift, chain.narrow(lead))

    def slides(self, slides: ca.SX, closing: ca.SX, rolling: ca.SX) -> ca.SX:
        """Return the sliding along the rail (3.89)-(3.91) from that along the track.

        rolling: angular velocity [rad/s].
        """
        along, sideways = slides[0], slides[1]
        on_rail = along + self.aside * sideways - self.drift * closing
        return ca.vertcat(on_rail, sideways - self.aside * along + self.lead * rolling, slides[2:])

    def forces(self, along: ca.SX, sideways: ca.SX, normal: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
        """Return the forces along the rail, sideways and normal to it [N], (3.105), in the directions of track and
        patch.

        The component of the normal force along the track is not included, see `press`.
        """
        return along - self.aside * sideways, sideways + self.aside * along, normal + self.drift * along


@lru_cache
def pressing_patch(wheel_terms: int, rail_terms: int, flange: bool, contact: Contact, on_line: bool = False) -> Part:
    """Return the part that computes a `Press` from a `PatchState`, (3.82)-(3.105) with Hertz' force by the approach.

    Constants include the pieces. flange: true for a flange, false for a tread; they have their own creep laws. on_line:
    a `TurningTrack` follows the state.
    """
    place = "flange" if flange else "tread"
    state, fixed, chain = PatchState.symbols("state"), PatchConstants.symbols("constants"), Chain()
    pieces = Pieces(ca.SX.sym("wheel", wheel_terms), ca.SX.sym("rail", rail_terms))
    follow_cosines(chain, fixed.cosines, ca.vertcat(state.yaw, state.roll))
    patch = find_patch(chain, state, fixed, pieces)
    track = TurningTrack.symbols("track") if on_line else TurningTrack.straight()
    creeping = creep_of_wheel(contact.law_of(flange), place)
    results = press(chain, state, track, fixed, patch, creeping, contact.poisson_ratio).vector
    given = ca.vertcat(state.vector, track.vector) if on_line else state.vector
    constants = ca.vertcat(fixed.vector, pieces.vector)
    return Part(f"press_{place}_{wheel_terms}_{rail_terms}", given, constants, results, chain)


def find_patch(chain: Chain, state: PatchState, fixed: PatchConstants, pieces: Pieces) -> TouchingPatch:
    """Return the point where the patch touches or would touch, (3.54), (3.57)."""
    given = ca.vertcat(state.offset, state.height, state.yaw, state.roll, state.nearest)
    constants = ca.vertcat(fixed.cosines, fixed.wheel, fixed.direction, pieces.vector)
    part = patch_of_wheel(pieces.wheel.numel(), pieces.rail.numel())
    return TouchingPatch.of(chain.call(part, given, constants))


def press(
    chain: Chain,
    state: PatchState,
    track: TurningTrack,
    fixed: PatchConstants,
    patch: TouchingPatch,
    creeping: Part,
    poisson_ratio: float,
) -> Press:
    """Return normal force by the approach (Hertz, Johnson 1985), creep forces by (3.89)-(3.105), and their moments.

    creeping: a `creep_of_wheel`.
    """
    axes = turned_by(fixed.cosines)
    along = axes[0, :].T
    sideways = ca.cross(patch.normal, along)
    own_rate = ca.vertcat(state.roll_rate, state.angular_velocity, state.yaw_rate)
    velocity = ca.vertcat(state.forward, state.sideways, state.rise)
    sliding = chain.narrow(axes.T @ velocity + ca.cross(own_rate, patch.arm))
    # The rail's section moves sideways and upwards as the wheelset moves along.
    beside_rail = ca.vertcat(0, state.offset, state.height) + axes @ patch.arm
    sections = state.slopes + ca.cross(track.turning, beside_rail)[1:]
    drift = chain.narrow(ca.dot(patch.across, sections) / track.stretch)
    closing = state.forward * drift - ca.dot(patch.normal, sliding)
    curvatures = patch.curvature_along, patch.curvature_across
    elastic = elastic_force(patch.approach, *curvatures, fixed.shear_modulus, poisson_ratio)
    normal = chain.narrow(damped(elastic, closing, fixed.damping))

    directions = along, sideways, patch.normal
    slides = how_it_slides(sliding, own_rate, directions, state.forward, fixed.creepage_speed)
    slope = RailSlope.of(chain, track, patch, sideways, sections, drift)
    slides = chain.narrow(slope.slides(slides, closing, state.angular_velocity))
    friction = state.friction * friction_over_angle(-fixed.wheel[0] * patch.across[0], fixed.gauge_face)
    given = ca.vertcat(slides, *curvatures, normal, friction)
    creep = chain.call(creeping, given, ca.vertcat(fixed.shear_modulus, fixed.surface))
    # The law does not model loads below the smallest. Without load the creep force is 0.
    share = normal / at_least(normal, SMALLEST_LOAD)
    creep_along, creep_aside = share * creep[0], share * creep[1]
    ahead_force, side_force, pressing = slope.forces(creep_along, creep_aside, normal)
    own = ahead_force * along + side_force * sideways + pressing * patch.normal
    across = pressing * patch.across + side_force * ca.vertcat(patch.across[1], -patch.across[0])
    return Press(
        ca.vertcat(ahead_force - drift * pressing, across),
        ca.cross(patch.arm, own) + ca.vertcat(0, slope.lead * creep_aside, 0),
        creep_along,
        -creep_along * slides[0] - creep_aside * slides[1],
        patch.approach,
        (normal - elastic) * closing,
        0.4 * elastic * ca.fmax(patch.approach, 0),
    )

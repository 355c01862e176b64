"""Forces of one patch of a wheel: the rail's normal force and the creep forces, by its approach and its sliding.

Treads and flanges are two parts. Each is generated once, called for each such patch of each wheel of a vehicle, and
evaluated only if it may touch.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

from fmu_src.chain import Bundle, Chain, Part, rows
from fmu_src.symbols import ca
from rbd_model.body.kinematics import turned_by
from rbd_model.contact.creep.law import SMALLEST_LOAD, CreepLaw, at_least
from rbd_model.contact.creep.of_steel import OfSteel
from rbd_model.contact.creep_of_wheel import creep_of_wheel, how_it_slides
from rbd_model.contact.depth import Contact
from rbd_model.contact.elastic import damped
from rbd_model.contact.friction import friction_over_angle
from rbd_model.wheelset.touch import follow_cosines
from rbd_model.wheelset.touching_patch import TouchingPatch, touching_patch

#: Contact angles between which a contact passes from the tread to the flange [rad].
FLANGE_ANGLES = math.radians(15.0), math.radians(25.0)


@dataclass(frozen=True)
class PatchState(Bundle):
    """Position and motion of a wheelset, with the rail's slopes and friction at a wheel."""

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
    """Inputs of a wheel that are not differentiated; the cosines are those of `direction_cosines`."""

    cosines: ca.SX = rows(4)
    wheel: ca.SX = rows(4)  # `Wheel`
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
class WheelPress(Bundle):
    """Effect of all patches of a wheel on its wheelset, sums of a `Press`."""

    force: ca.SX = rows(3)  # in the axes of the track [N]
    moment: ca.SX = rows(3)  # in the wheelset's own [N.m]
    creep_along: ca.SX = rows(1)  # creep forces along the rail [N]
    creep_power: ca.SX = rows(1)  # what all creep forces take [W]
    damping_power: ca.SX = rows(1)  # what the contacts lose as they are pressed [W]
    stored: ca.SX = rows(1)  # their energy [J]
    flange_force: ca.SX = rows(1)  # of the rail on the flange, to the left [N]

    @classmethod
    def of_patches(cls, patches: Sequence[Press], flanges: Sequence[ca.SX | float]) -> WheelPress:
        """flanges: share of the flange in each patch."""
        flange = [share * patch.force[1] for patch, share in zip(patches, flanges, strict=True)]

        def total(name: str) -> ca.SX:
            return sum((getattr(one, name) for one in patches[1:]), getattr(patches[0], name))

        powers = total("creep_along"), total("creep_power"), total("damping_power"), total("stored")
        return cls(total("force"), total("moment"), *powers, flange_force=sum(flange, ca.SX(0)))


def flange_share(patch: TouchingPatch, side: ca.SX) -> ca.SX:
    """Return 0 for a contact on the tread, 1 on the flange, by its angle (section 9.4.1)."""
    low, high = (math.sin(angle) for angle in FLANGE_ANGLES)
    share = ca.fmin(ca.fmax((-side * patch.across[0] - low) / (high - low), 0), 1)
    return share**2 * (3 - 2 * share)


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
def pressing_patch(flange: bool, contact: Contact, on_line: bool = False) -> Part:
    """Return the part for the `WheelPress` of one patch from a `PatchState`, (3.82)-(3.105).

    The last constant is the record of the patch. flange: true for a flange, false for a tread; they have their own
    creep laws. on_line: a `TurningTrack` follows the state.
    """
    place = "flange" if flange else "tread"
    state, fixed, chain = PatchState.symbols("state"), PatchConstants.symbols("constants"), Chain()
    record = ca.SX.sym("record")
    follow_cosines(chain, fixed.cosines, ca.vertcat(state.yaw, state.roll))
    patch = find_patch(chain, state, fixed, touching_patch(flange), contact.poisson_ratio, record)
    track = TurningTrack.symbols("track") if on_line else TurningTrack.straight()
    creeping = creep_of_wheel(contact.law_of(flange), place)
    pressed = press(chain, state, track, fixed, patch, creeping)
    results = WheelPress.of_patches([pressed], [flange_share(patch, fixed.wheel[0])]).vector
    given = ca.vertcat(state.vector, track.vector) if on_line else state.vector
    name = f"press_{place}_{law_name(contact.law_of(flange))}{'_on_line' if on_line else ''}"
    return Part(name, given, ca.vertcat(fixed.vector, record), results, chain)


def law_name(law: CreepLaw) -> str:
    """Return letters that are equal for equal laws."""
    return hashlib.sha256(_name_of(law).encode()).hexdigest()[:8]


def _name_of(law: CreepLaw) -> str:
    if isinstance(law, OfSteel):
        return f"{_name_of(law.law)} {law.poisson_ratio!r}"
    return f"{law.__module__}.{getattr(law, '__qualname__', type(law).__qualname__)}"


def find_patch(
    chain: Chain,
    state: PatchState,
    fixed: PatchConstants,
    touching: Part,
    poisson_ratio: float,
    record: ca.SX | None = None,
) -> TouchingPatch:
    """Return the contact of a patch, (3.54), (3.57); touching: a `touching_patch`; record: its own, if it has one."""
    given = ca.vertcat(state.offset, state.height, state.yaw, state.roll)
    modulus = fixed.shear_modulus / (1 - poisson_ratio)
    constants = ca.vertcat(fixed.cosines, fixed.wheel, modulus, *([] if record is None else [record]))
    return TouchingPatch.of(chain.call(touching, given, constants))


@dataclass(frozen=True)
class CreepingPatch:
    """Sliding and creep of a patch in its directions `along` the rail and `sideways`, and its normal force [N].

    `axes` are those that yaw and roll with the wheelset. `slides` are the results of `how_it_slides` against the rail.
    `drift`, `closing`: the rail's drift into the wheel [1] and the speed at which both close in [m/s].
    """

    axes: ca.SX
    along: ca.SX
    sideways: ca.SX
    drift: ca.SX
    closing: ca.SX
    slides: ca.SX
    slope: RailSlope
    normal: ca.SX
    creep_along: ca.SX
    creep_aside: ca.SX


def creep_on_patch(
    chain: Chain,
    state: PatchState,
    track: TurningTrack,
    fixed: PatchConstants,
    patch: TouchingPatch,
    creeping: Part,
) -> CreepingPatch:
    """Return sliding and creep of a patch, (3.89)-(3.105); creeping: a `creep_of_wheel`."""
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
    normal = chain.narrow(damped(patch.load, closing, fixed.damping))

    directions = along, sideways, patch.normal
    slides = how_it_slides(sliding, own_rate, directions, state.forward, fixed.creepage_speed)
    slope = RailSlope.of(chain, track, patch, sideways, sections, drift)
    slides = chain.narrow(slope.slides(slides, closing, state.angular_velocity))
    friction = state.friction * friction_over_angle(-fixed.wheel[0] * patch.across[0], fixed.gauge_face)
    given = ca.vertcat(slides, *curvatures, normal, friction)
    creep = chain.call(creeping, given, ca.vertcat(fixed.shear_modulus, fixed.surface))
    # The law does not model loads below the smallest. Without load the creep force is 0.
    share = normal / at_least(normal, SMALLEST_LOAD)
    forces = share * creep[0], share * creep[1]
    return CreepingPatch(axes, along, sideways, drift, closing, slides, slope, normal, *forces)


def press(
    chain: Chain,
    state: PatchState,
    track: TurningTrack,
    fixed: PatchConstants,
    patch: TouchingPatch,
    creeping: Part,
) -> Press:
    """Return normal force by the approach (Hertz, Johnson 1985), creep forces by (3.89)-(3.105), and their moments.

    The elastic force is that of the stored energy, and its moment has no part about the wheel's own axis. Damping acts
    along the normal at the contact. creeping: a `creep_of_wheel`.
    """
    creep, elastic = creep_on_patch(chain, state, track, fixed, patch, creeping), patch.load
    axes, slope, drift, normal = creep.axes, creep.slope, creep.drift, creep.normal
    ahead_force, side_force, pressing = slope.forces(creep.creep_along, creep.creep_aside, normal - elastic)
    own = ahead_force * creep.along + side_force * creep.sideways + pressing * patch.normal
    across = pressing * patch.across + side_force * ca.vertcat(patch.across[1], -patch.across[0])
    pushed, moment = patch.push[:2], ca.vertcat(patch.push[3], 0, patch.push[2] / fixed.cosines[2])
    # The rail's section moves and turns as the wheelset moves along: the elastic force does virtual work on it.
    moving = state.slopes + ca.cross(track.turning, ca.vertcat(0, state.offset, state.height))[1:]
    behind = (ca.dot(pushed, moving) + ca.dot(axes @ moment, track.turning)) / track.stretch
    return Press(
        ca.vertcat(ahead_force - behind - drift * pressing, pushed + across),
        ca.cross(patch.arm, own) + moment + ca.vertcat(0, slope.lead * creep.creep_aside, 0),
        creep.creep_along,
        -creep.creep_along * creep.slides[0] - creep.creep_aside * creep.slides[1],
        patch.approach,
        (normal - elastic) * creep.closing,
        patch.stored,
    )

"""A wheelset in 3D at its place in a vehicle, common to all contact models: states, track, suspension, brake."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from fmu_src.symbols import ca
from rbd_model.body.bodies import Shift, move_along
from rbd_model.body.effect import Load
from rbd_model.body.kinematics import Body
from rbd_model.track.frame import TrackFrame
from rbd_model.track.irregularity import Section
from rbd_model.vehicle.assembly import Assembly
from rbd_model.vehicle.description import Wheelset
from rbd_model.vehicle.scales import NOMINAL_TRAVEL, NOMINAL_TRAVEL_SPEED
from rbd_model.wheelset.rotation import (
    Grip,
    Rotation,
    add_axle_shift,
    add_hold,
    add_rotation,
    add_rotation_states,
    rail_friction,
    stand_still,
    traction_force,
)
from rbd_model.wheelset.touch import SIDES

NOMINAL_ROLL = 1e-3

#: Distance from the end of a profile at which a contact is treated as lost [m]. Beyond the end there is no contact.
END_MARGIN = 1e-3


@dataclass(frozen=True)
class WheelsetMotion:
    """Effects of the forces: longitudinal acceleration [m/s2], rotation, power of the yaw torque [W].

    held [N]: force along the track with which the rails hold an axle that stands, else 0.
    """

    acceleration: ca.SX
    held: ca.SX
    rotation: Rotation
    yaw_power: ca.SX


@dataclass(frozen=True)
class OnTrack:
    """The states of a wheelset that do not depend on its contact with the rails, and the track below it."""

    shift: Shift
    along: ca.SX  # from the vehicle's place [m]
    lateral: ca.SX
    sideways: ca.SX
    yaw: ca.SX
    yaw_rate: ca.SX
    rotated: ca.SX
    angular_velocity: ca.SX
    centre: ca.SX  # lateral position of both rails' middle [m]
    heights: ca.SX  # of the (left, right) rail [m]
    slopes: ca.SX  # along the track, of its lateral position and of the heights [1]
    bends: ca.SX  # the same once more [1/m], at model 1
    frictions: ca.SX  # of the (left, right) rail
    distance: ca.SX  # [m]
    spread: ca.SX  # of each rail, outwards [m], and its slope [1]
    track: TrackFrame

    @property
    def forward(self) -> ca.SX:
        """Speed of the axle [m/s]."""
        return self.shift.speed

    @property
    def offset(self) -> ca.SX:
        """Lateral displacement from the track's centre [m]."""
        return self.lateral - self.centre


def follow_track(assembly: Assembly, number: int, section: Callable[[int, ca.SX, int], Section]) -> OnTrack:
    """Declare the states of a wheelset along and across the track, and return them with the track there.

    Section 5.2.
    """
    system, data = assembly.system, assembly.vehicle.wheelsets[number - 1]
    shift = add_axle_shift(assembly, number)
    lateral = system.state(f"lateral_{number}", "m", assembly.parameter["initial_lateral"], NOMINAL_TRAVEL)
    sideways = system.state(f"lateral_speed_{number}", "m/s", 0.0, NOMINAL_TRAVEL_SPEED)
    yaw = system.state(f"yaw_{number}", "rad", assembly.parameter["initial_yaw"], NOMINAL_TRAVEL)
    yaw_rate = system.state(f"yaw_rate_{number}", "rad/s", 0.0, NOMINAL_TRAVEL_SPEED)
    rotated, omega = add_rotation_states(assembly, number)
    along = assembly.value(data.along) + shift.place
    distance = assembly.distance + along
    # The constraints of model 1 are differentiated twice.
    order = 2 if assembly.contact.depth == 1 else 1
    track = section(number, distance, order)
    system.limit_change(1 / track.density, assembly.distance)
    rails, slopes, *bends = ca.horzsplit(track.rails)
    of_rails = ca.vertcat(*[assembly.parameter[f"{side}_rail_friction"] for side in SIDES.values()])
    frictions = rail_friction(assembly, number, distance) * track.friction * of_rails
    frame = assembly.track_at(along)
    motion = lateral, sideways, yaw, yaw_rate, rotated, omega
    along_it = rails[0], rails[1:], slopes, ca.vertcat(*bends)
    return OnTrack(shift, along, *motion, *along_it, frictions, distance, track.spread, frame)


def stand_on_track(assembly: Assembly, on: OnTrack, body: Body) -> None:
    """Set the derivatives of place, lateral position and yaw of a wheelset, by (3.12) and section 3.2.2."""
    move_along(assembly, body, on.shift)
    assembly.system.derivative(on.lateral, body.moving[0])
    assembly.system.derivative(on.yaw, body.turning[2] / ca.cos(body.angles[0]))


def yaw_torque_of(assembly: Assembly, number: int, rotated: ca.SX) -> ca.SX:
    """Return the yaw torque in the axes that yaw and roll with a wheelset [N.m]; rotated: its angle of rotation [rad].

    It acts about their upright axis, as the couple of the shoe forces (9.1) does, which are square to the axle. The
    vertical of the track, the other reading, differs by a roll (1e-3) and would turn the axle by its sine. If
    yaw_torque_rotates is 1, the torque acts about an axis that also turns with the wheelset's rotation. This is the
    effect of the body's matrix instead of the global one in (3.36).
    """
    angle = assembly.parameter["yaw_torque_rotates"] * rotated
    return assembly.input[f"yaw_torque_{number}"] * ca.vertcat(ca.sin(angle), 0, ca.cos(angle))


@dataclass(frozen=True)
class WheelsetOnRails:
    """A wheelset on its rails before its suspension's forces are added; pairs are (left, right).

    The body's own axes are those that yaw and roll with the wheelset. `rail_heights` [m] are those of rails that may be
    flexible. `loads` and `thrusts` [N] are the vertical forces of the rails, and the lateral ones on their heads,
    outwards. `flange_force` [N] is that of the rails on the flanges, to the left. `creep_along` [N] are creep forces
    along the rails. `creep_powers` [W] are the powers dissipated by all creep forces. `stored` [J] is the energy in the
    contacts and the track below, `damping_power` [W] the power dissipated in both.

    `free` is the acceleration [m/s2] and turning by rails and weight alone: moments over inertia about x and z
    [rad/s2], between them the moment about the axle [N.m]. `lost` is the remaining distance of each wheel's contact to
    its end, negative beyond it (section 9.4.1).
    """

    number: int
    data: Wheelset
    body: Body
    on: OnTrack
    rail_heights: ca.SX
    loads: ca.SX
    thrusts: ca.SX
    flange_force: ca.SX
    creep_along: ca.SX
    creep_powers: ca.SX
    kinetic_of_track: ca.SX
    stored: ca.SX
    damping_power: ca.SX
    free: ca.SX
    lost: list[ca.SX]

    def wheel_half_distance(self, index: int) -> ca.SX | float:
        """Return half the distance of the y = 0 of the left (0) or right wheel (1) [m] (section 4.3)."""
        return self.data.pair.both[index].wheel_half_distance

    @property
    def static(self) -> ca.SX:
        """Largest force with which both rails hold along the track [N], friction times load as at the end of (3.97)."""
        return ca.dot(self.on.frictions, ca.fmax(self.loads, 0))


def push_wheelset(
    assembly: Assembly, wheelset: WheelsetOnRails, suspension: Load, first_acceleration: ca.SX
) -> tuple[ca.SX, WheelsetMotion]:
    """Return the suspension's addition to the rails' effect, and the motion along, across and about the vertical,
    (3.73).

    The addition has the rows of `free`. It includes the force of rails that hold a standing axle.
    """
    system, data, body = assembly.system, wheelset.data, wheelset.body
    number, rotated = wheelset.number, wheelset.on.rotated
    mass, inertia = assembly.value(data.mass), [assembly.value(size) for size in data.inertia]
    yaw_torque = yaw_torque_of(assembly, number, rotated)
    moment = suspension.moment + yaw_torque
    turning = ca.vertcat(moment[0] / inertia[0], moment[1], moment[2] / inertia[2])
    push = system.narrow(ca.vertcat((1 / mass) * suspension.force, turning))
    moved = wheelset.free + push
    hold = add_hold(system, number, wheelset.on.shift.speed)
    held = (hold.moves - 1) * mass * moved[0]
    states, on = [wheelset.on.shift.lead, assembly.speed], wheelset.on
    pushed = mass * moved[0] - ca.sum1(wheelset.creep_along), traction_force(assembly, number)
    grip = Grip.of(assembly, number, hold, wheelset.static)
    stand_still(assembly, f"Wheelset {number}", hold, states, pushed, grip)
    turned = rotated, wheelset.on.angular_velocity
    rotation = add_rotation(assembly, number, hold, turned, moved[4], -held * assembly.radius(data))
    # The brake torque reacts on all angles of a body.
    rotation = replace(rotation, brake_torque=system.narrow(rotation.brake_torque))
    acceleration = hold.moves * moved[0]
    system.derivative(on.shift.lead, acceleration - first_acceleration)
    system.derivative(on.sideways, moved[1])
    system.derivative(on.yaw_rate, moved[5])
    motion = WheelsetMotion(acceleration, held, rotation, ca.dot(yaw_torque, body.own_rate))
    return push + ca.vertcat(held / mass, ca.SX(5, 1)), motion

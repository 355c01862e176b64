"""The rotation of one wheelset, common to all levels of detail: it rolls, skids or is locked, in 2D or in 3D."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from fmu_src.symbols import ca
from fmu_src.system import System
from rbd_model.body.bodies import Shift, add_shift
from rbd_model.contact.creep.law import SMALLEST_LOAD, at_least, creepage
from rbd_model.vehicle.assembly import Assembly
from rbd_model.vehicle.description import Wheelset
from rbd_model.vehicle.scales import NOMINAL_ANGULAR_VELOCITY, NOMINAL_ROTATION

#: Creepage at which wheels of any load begin to slide as a whole; its order of magnitude, from (3.92) and (3.94).
BENDING = 0.01

#: Speed of an axle over creepage_speed above which its vehicle, after a stop, is treated as moving again. At this speed
#: the regularised creepage differs by half a per cent from that of (2.3). Bodies that rock back at the end of a stop
#: remain below.
ON_ITS_WAY = 10.0

#: Speed of an axle over creepage_speed up to which an axle on a locked wheelset is treated as still. It is ten times
#: the sliding that remains there by BENDING. Stopping from it takes 0.1 um of travel.
STILL = 0.1


@dataclass(frozen=True)
class Hold:
    """The constraints that may hold a wheelset: its brake, so that it is locked, and its rails, so that its axle
    stands.

    turning, moving: symbols of the directions in which it turns and moves along: 1, -1, or 0 if it is held. forward
    [m/s]: speed of its axle.
    """

    turning: ca.SX
    moving: ca.SX
    forward: ca.SX

    @property
    def turns(self) -> ca.SX:
        """1, or 0 if the wheelset is locked."""
        return self.turning**2

    @property
    def moves(self) -> ca.SX:
        """1, or 0 if its axle stands."""
        return self.moving**2


@dataclass(frozen=True)
class Rotation:
    """Symbols of one wheelset: angle, velocity, torques of its brake with sign; moving is 0 if its brake holds it."""

    number: int
    angle: ca.SX
    angular_velocity: ca.SX
    friction_torque: ca.SX  # brake and rolling resistance
    brake_torque: ca.SX  # the brake's part of it
    traction_torque: ca.SX
    moving: ca.SX


def follow_creep(assembly: Assembly, speed: ca.SX, *states: ca.SX) -> None:
    """Limit the change of an axle's speed, the sum of the states, to half of it per step: (2.3) varies with its
    inverse.

    Near rest, the limit is half of the speed at which the creep curve bends there: BENDING times the creepage's
    smallest speed. The error estimate of a step does not include this effect. At the end of a stop the creep is so
    stiff that it is solved for implicitly. With the Jacobian of another speed the force would be wrong, and a wheelset
    that has just locked would break free.
    """
    least = BENDING * assembly.parameter["creepage_speed"]
    assembly.system.limit_change(ca.sqrt(speed**2 + least**2) / 2, *states)


@dataclass(frozen=True)
class RollingWheelset:
    """A wheelset that rolls, skids or is locked, as at every level of detail.

    `number` is from 1. `displacement` [m] is that of its axle from its place in the vehicle. `forward` [m/s] is the
    speed of the axle. `creep_force` and `load` [N] are forces of both rails on it, along the track and upwards.
    `creep_power` [W] is the power dissipated at both rails.
    """

    number: int
    data: Wheelset
    rotation: Rotation
    displacement: ca.SX
    forward: ca.SX
    creep_force: ca.SX
    load: ca.SX
    creep_power: ca.SX


@dataclass(frozen=True)
class Grip:
    """Largest forces that hold a locked wheelset along the track, else 0 [N].

    able: force of its brake, also while the wheelset turns. braked: force of its brake if it is locked. whole: force of
    brake and rails together. The whole force does not exceed that of the brake, third line of (2.8): before the
    wheelset turns, its axle must move, because otherwise no creep force turns it.
    """

    able: ca.SX
    braked: ca.SX
    whole: ca.SX

    @classmethod
    def of(cls, assembly: Assembly, number: int, hold: Hold, static: ca.SX) -> Grip:
        """Return the forces for a wheelset by its number; static [N]: friction times load, as at the end of (3.97)."""
        locked, braked = 1 - hold.turns, brake_capacity(assembly, number) / radius_of(assembly, number)
        return cls(braked, locked * braked, locked * ca.fmin(static, braked))


class Described(Protocol):
    """A system that is being written, and the symbols of its parameters."""

    @property
    def system(self) -> System:
        """The system."""

    @property
    def parameter(self) -> Mapping[str, ca.SX]:
        """Symbols by name."""


def stand_still(
    assembly: Described, label: str, hold: Hold, states: Sequence[ca.SX], pushed: tuple[ca.SX, ca.SX], grip: Grip
) -> None:
    """Add the rails' static hold of a vehicle on locked wheels, as the third line of (2.8) holds a locked wheelset.

    This differs from the thesis, whose creep (2.3) has no state of rest: regularised, it lets a locked vehicle slide
    indefinitely. The compliance of the contacts, some micrometres, is not modelled. states: their sum is the velocity.
    pushed [N]: force on the rails without their creep, and traction torque over radius.
    """
    still = STILL * assembly.parameter["creepage_speed"]
    push = ca.fmax(ca.fabs(pushed[0]), ca.fabs(pushed[0] + pushed[1]))
    # The capacity is checked after each step, the drive only while something is still. The loads are thus in the drive.
    drive = push * grip.braked / at_least(grip.whole, SMALLEST_LOAD)
    words = "stands", "moves again"
    reported = grip.able, ca.fabs(hold.forward) - ON_ITS_WAY * assembly.parameter["creepage_speed"]
    assembly.system.dry_friction(
        label, hold.moving, states, drive, grip.braked, words, still, whole="The vehicle", reported=reported
    )


def slides_along(assembly: Assembly, forward: ca.SX) -> ca.SX:
    """Return an expression that is above 0 while an axle moves; forward [m/s]: speed of the axle.

    A wheelset that does not turn (2.8) is then locked. Creepage is regularised below creepage_speed. There the creep of
    a wheelset that does not turn may still carry its brake's whole force, as at the end of every stop.
    """
    return ca.fabs(forward) - assembly.parameter["creepage_speed"]


def traction_force(assembly: Assembly, number: int) -> ca.SX:
    """Return the traction torque over radius [N], eq. (2.8)."""
    return assembly.input[f"traction_torque_{number}"] / radius_of(assembly, number)


def radius_of(assembly: Assembly, number: int) -> ca.SX:
    """Return the nominal rolling radius of a wheelset [m], r of (2.8), by its number."""
    return assembly.radius(assembly.vehicle.wheelsets[number - 1])


def brake_capacity(assembly: Assembly, number: int) -> ca.SX:
    """Return the capacity of a wheelset's brake and rolling resistance [N.m], T_B of (2.8)."""
    return assembly.input[f"brake_torque_{number}"] + assembly.parameter["rolling_resistance_torque"]


def add_rotation_states(assembly: Assembly, number: int) -> tuple[ca.SX, ca.SX]:
    """Declare the rotation [rad] of a wheelset and its angular velocity [rad/s], omega of (2.8).

    At the start it rolls.
    """
    start = assembly.initial_speed / assembly.radius(assembly.vehicle.wheelsets[number - 1])
    rotated = assembly.system.state(f"rotation_{number}", "rad", 0.0, NOMINAL_ROTATION)
    return rotated, assembly.system.state(f"angular_velocity_{number}", "rad/s", start, NOMINAL_ANGULAR_VELOCITY)


def add_hold(system: System, number: int, forward: ca.SX) -> Hold:
    """Return new symbols of the constraints of a wheelset, third line of (2.8); forward [m/s]: speed of its axle."""
    return Hold(system.direction(f"direction_{number}"), system.direction(f"moving_{number}"), forward)


def add_rotation(
    assembly: Assembly, number: int, hold: Hold, turned: tuple[ca.SX, ca.SX], rail_torque: ca.SX, held_torque: ca.SX
) -> Rotation:
    """Add the rotation of one wheelset, third line of eq. (2.8): J dw/dt = F_x r - T_B.

    Traction and rolling resistance are included.

    turned: its rotation [rad] and angular velocity [rad/s]. rail_torque [N.m]: moment of the creep about the axle.
    held_torque [N.m]: moment of rails that hold a standing axle, only for a locked wheelset. The brake torque is a
    capacity. It is dry friction that opposes the rotation, or holds the wheelset locked while the rail cannot turn it.
    """
    system = assembly.system
    rotated, omega = turned
    direction = hold.turning
    brake, capacity = assembly.input[f"brake_torque_{number}"], brake_capacity(assembly, number)
    traction = assembly.input[f"traction_torque_{number}"]
    drive = traction + rail_torque
    # While sliding, the friction equals the capacity. While locked, it balances the drive, shared in proportion.
    moving, holding = hold.turns, drive + held_torque
    friction_torque = moving * direction * capacity + (1 - moving) * holding
    own = assembly.vehicle.wheelsets[number - 1].inertia[1]
    inertia = system.derived(f"turning_inertia_{number}", assembly.value(own) + assembly.drive_inertia)
    system.derivative(rotated, omega)
    system.derivative(omega, moving * (drive - direction * capacity) / inertia)
    words, reported = ("locked", "turns again"), (slides_along(assembly, hold.forward), 1.0)
    system.dry_friction(f"Wheelset {number}", direction, [omega], holding, capacity, words, reported=reported)
    share = brake / ca.fmax(capacity, 1e-9)
    return Rotation(number, rotated, omega, friction_torque, share * friction_torque, traction, moving)


def add_wheelset_outputs(assembly: Assembly, rolling: RollingWheelset, speed: ca.SX) -> None:
    """Add the outputs of one wheelset; speed [m/s]: of the vehicle.

    Slip ratio: (2.10), regularised as the creepage is.
    """
    system, number, rotation = assembly.system, rolling.number, rolling.rotation
    slip = speed - assembly.radius(rolling.data) * rotation.angular_velocity
    rows = {
        "angular_velocity": rotation.angular_velocity,
        "rotation": rotation.angle,
        "slip": slip,
        "slip_ratio": creepage(slip, speed, assembly.parameter["creepage_speed"]),
        "creep_force": rolling.creep_force,
        "axle_load": rolling.load,
        "locked": (1 - rotation.moving) * (slides_along(assembly, rolling.forward) > 0),
    }
    for name, expression in rows.items():
        system.output(assembly.outputs[f"{name}_{number}"], expression)


def add_axle_shift(assembly: Assembly, number: int) -> Shift:
    """Return the displacement of an axle along the track (section 5.2). Steps are limited to follow its creep."""
    shift = add_shift(assembly, f"shift_{number}", f"shift_speed_{number}")
    follow_creep(assembly, shift.speed, assembly.speed, shift.lead)
    return shift


def rail_friction(assembly: Assembly, number: int, distance: ca.SX) -> ca.SX:
    """Return the friction coefficient without sliding, mu0 of Polach (2005), below a wheelset at a distance [m]."""
    return assembly.input[f"friction_{number}"] * assembly.rail.factor(number, distance)

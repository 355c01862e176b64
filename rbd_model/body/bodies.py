"""The bodies above the wheelsets: six degrees of freedom each, less those that are held."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from fmu_src.chain import symbols_in
from fmu_src.symbols import ca
from fmu_src.system import System
from rbd_model.body.effect import Load
from rbd_model.body.kinematics import Body, axes_rate, pitch_rotation, yaw_roll
from rbd_model.vehicle.assembly import Assembly
from rbd_model.vehicle.description import ANGLES, Motion, RigidBody
from rbd_model.vehicle.scales import NOMINAL_TRAVEL, NOMINAL_TRAVEL_SPEED


@dataclass(frozen=True)
class Turning:
    """Angular velocity of a body whose angles may be held, in its own axes: `rate` is linear in `free`.

    slope: derivative of each of the three components by those that are states; slope_rate: its change.
    """

    free: dict[str, int]  # angles that are not held, each with the component of the rate that is its state
    rate: ca.SX
    slope: ca.SX
    slope_rate: ca.SX


@dataclass(frozen=True)
class Shift:
    """A longitudinal displacement from the place in the vehicle, section 5.2.

    States: place [m]; lead [m/s]: speed relative to the first body. speed [m/s]: total.
    """

    place: ca.SX
    lead: ca.SX
    speed: ca.SX


@dataclass(frozen=True)
class MovingBody:
    """A body of the vehicle with its symbols; position, rates: its states and their rates' by the motions it has.

    shift: None for the first body, whose place and speed are those of the vehicle.
    """

    data: RigidBody
    body: Body
    turning: Turning
    shift: Shift | None
    position: dict[str, ca.SX]
    rates: dict[str, ca.SX]


def place_body(assembly: Assembly, data: RigidBody, held: frozenset[Motion] = frozenset()) -> MovingBody:
    """Declare the states of a body (sections 4.2, 5.2); `held` is added to the motions that its description holds.

    The distance of a vehicle is that of its first body. Displacements of the others along the track are relative to
    their place in the vehicle that moves along, as are all positions. Angular velocities are in the axes of the body.
    """
    held = held | data.held
    system = assembly.system
    shift = None if data is assembly.vehicle.bodies[0] else add_shift(assembly, f"{data.name}_shift")
    place = assembly.value(data.along) + (shift.place if shift else ca.SX(0))
    speed = shift.speed if shift else assembly.speed
    position: dict[str, ca.SX] = {}
    rates: dict[str, ca.SX] = {}
    for motion in ("lateral", "bounce", *ANGLES):
        if motion in held:
            continue
        name, unit = data.variable(motion), "rad" if motion in ANGLES else "m"
        start = assembly.parameter["initial_lateral"] if motion == "lateral" else 0.0
        position[motion] = system.state(name, unit, start, NOMINAL_TRAVEL)
        rates[motion] = system.state(f"{name}_rate", f"{unit}/s", 0.0, NOMINAL_TRAVEL_SPEED)
    angles = ca.vertcat(*[position.get(angle, ca.SX(0)) for angle in ANGLES])
    turning = turn(angles, rates)
    height = assembly.axle_height + assembly.value(data.height) + position.get("bounce", 0)
    body = Body(
        ca.vertcat(place, position.get("lateral", 0), height),
        ca.vertcat(speed, rates.get("lateral", 0), rates.get("bounce", 0)),
        yaw_roll(angles[2], angles[0]) @ pitch_rotation(angles[1]),
        turning.rate,
        angles,
        assembly.track_at(place),
    )
    if assembly.on_line:
        body = carry_along(data, body, turning, held)
        start_along(assembly, body, [rates.get(motion) for motion in ("lateral", "bounce", *ANGLES)])
    for motion, change in zip(("lateral", "bounce"), ca.vertsplit(body.moving), strict=True):
        if motion in position:
            system.derivative(position[motion], change)
    for angle, change in zip(ANGLES, angle_rates(angles, body.turning), strict=True):
        if angle in turning.free:
            system.derivative(position[angle], change)
    move_along(assembly, body, shift)
    return MovingBody(data, body, turning, shift, position, rates)


def place_bodies(assembly: Assembly, held: frozenset[Motion] = frozenset()) -> tuple[Assembly, list[MovingBody]]:
    """Return all bodies of a vehicle, see `place_body`, and the assembly with the travel of the first, eq. (3.12)."""
    first, *others = assembly.vehicle.bodies
    leading = place_body(assembly, first, held)
    assembly = replace(assembly, first_stretch=leading.body.stretch)
    return assembly, [leading, *(place_body(assembly, data, held) for data in others)]


def carry_along(data: RigidBody, body: Body, turning: Turning, held: frozenset[Motion]) -> Body:
    """Return a body whose held motions follow the axes of the track, which turn along the line, eq. (3.12).

    The constraint of held motions does work, above all to turn the body: its energy is not constant where the track
    turns.
    """
    if turning.free.keys() not in (set(), {"pitch"}, set(ANGLES)):
        raise ValueError(f"{data.name} holds {', '.join(held & set(ANGLES))}; on a line hold all angles or none.")
    carried = ca.cross(body.spin, ca.vertcat(0, body.position[1:]))
    for component, motion in enumerate(("lateral", "bounce"), 1):
        if motion in held:
            body.velocity[component] = carried[component]
    return body if turning.free else replace(body, own_rate=body.axes.T @ body.spin)


def start_along(assembly: Assembly, body: Body, states: Sequence[ca.SX | None]) -> None:
    """Set start values for a body on a line that turns at once: eq. (3.12) without motion relative to the track.

    states: existing states of its velocity across and upwards and of its angular velocity.
    """
    spin = assembly.initial_speed / body.stretch * body.track.turning
    carried = ca.cross(spin, ca.vertcat(0, body.position[1:]))
    values = ca.vertsplit(at_start(assembly.system, ca.vertcat(carried[1:], spin)))
    for state, value in zip(states, values, strict=True):
        if state is not None:
            assembly.system.add_to_start(state, value)


def at_start(system: System, expression: ca.SX) -> ca.SX:
    """Return an expression at the start (section 5.2): all declared states have their start values."""
    plain = system.expand(expression)
    within = symbols_in(plain)
    known = [state for state in system.states.values() if state.symbol.element_hash() in within]
    return ca.substitute(plain, ca.vertcat(*[s.symbol for s in known]), ca.vertcat(*[s.start for s in known]))


def add_shift(assembly: Assembly, name: str, speed_name: str = "") -> Shift:
    """Declare a longitudinal displacement from the place in the vehicle, section 5.2."""
    place = assembly.system.state(name, "m", 0.0, NOMINAL_TRAVEL)
    lead = assembly.system.state(speed_name or f"{name}_speed", "m/s", 0.0, NOMINAL_TRAVEL_SPEED)
    return Shift(place, lead, assembly.speed + lead)


def move_along(assembly: Assembly, body: Body, shift: Shift | None) -> None:
    """Set the rate of a body's place on the line, eq. (3.12): the distance of the first, a displacement of the others.

    On a curved line, the speed along it of bodies beside its centre differs from their speed in 3D.
    """
    if shift is None:
        assembly.system.derivative(assembly.distance, body.travel)
        return
    ahead = body.velocity[0] - assembly.speed
    gained = assembly.speed * (1 / body.stretch - 1 / assembly.first_stretch)
    assembly.system.derivative(shift.place, ahead / body.stretch + gained)


def angle_rates(angles: ca.SX, own_rate: ca.SX) -> Sequence[ca.SX]:
    """Return rates of roll, pitch and yaw from the angular velocity in the own axes, section 3.2.2."""
    rate = pitch_rotation(angles[1]) @ own_rate  # in the yaw-roll axes
    tangent = ca.sin(angles[0]) / ca.cos(angles[0])
    return rate[0], rate[1] - axes_rate(tangent, rate)[1], rate[2] / ca.cos(angles[0])


def turn(angles: ca.SX, rates: dict[str, ca.SX]) -> Turning:
    """Return the angular velocity in the own axes from the rates that are states: section 3.2.2 for the held angle.

    With one angle held at 0 the body still turns about that own axis, because of the lean by the other two. The holding
    moment has no component about their axes, so that it does no work. Held pitch: by tan(roll) of the rate about the
    third axis.
    """
    free = {angle: component for component, angle in enumerate(ANGLES) if angle in rates}
    rate = ca.vertcat(*[rates.get(angle, ca.SX(0)) for angle in ANGLES])
    # The component of the held angle, the one that it follows, and the angle whose tangent is the factor.
    leaning: dict[tuple[str, ...], tuple[int, int, int, int]] = {
        ("roll", "yaw"): (1, 2, 0, 1),
        ("pitch", "yaw"): (0, 2, 1, -1),
        ("roll", "pitch"): (2, 0, 1, 1),
    }
    slope, slope_rate, kept = ca.SX.zeros(3), ca.SX.zeros(3), tuple(free)
    if kept in leaning:
        component, other, angle, sign = leaning[kept]
        slope[other] = sign * ca.tan(angles[angle])
        rate[component] = slope[other] * rate[other]
        slope_rate[other] = sign * (1 + slope[other] ** 2) * angle_rates(angles, rate)[angle]
    return Turning(free, rate, slope, slope_rate)


def move_body(assembly: Assembly, moving: MovingBody, load: Load, first_acceleration: ca.SX) -> None:
    """Add Newton's and Euler's equations of a body: (3.73) in its own axes.

    first_acceleration [m/s2]: of the first one.
    """
    system, data, body = assembly.system, moving.data, moving.body
    lightness, falling = 1 / assembly.value(data.mass), body.falling(assembly.parameter["gravity"])
    if moving.shift is None:
        system.derivative(assembly.speed, first_acceleration)
    else:
        system.derivative(moving.shift.lead, lightness * load.force[0] + falling[0] - first_acceleration)
    for motion, component in (("lateral", 1), ("bounce", 2)):
        if motion in moving.rates:
            system.derivative(moving.rates[motion], lightness * load.force[component] + falling[component])
    inertia = ca.vertcat(*[assembly.value(size) for size in data.inertia])
    moment = load.moment - ca.cross(body.own_rate, inertia * body.own_rate)
    for angle, acceleration in turning_accelerations(moving.turning, inertia, moment).items():
        system.derivative(moving.rates[angle], acceleration)


def turning_accelerations(turning: Turning, inertia: ca.SX, moment: ca.SX) -> dict[str, ca.SX]:
    """Return rates of the free angular velocity components, Euler's equations; moment [N.m]: less the gyroscopic one.

    A held angle's own axis adds its moment and its inertia to the component that it follows (section 4.2).
    """
    held = next((i for i, angle in enumerate(ANGLES) if angle not in turning.free), 0)
    found = {}
    for angle, component in turning.free.items():
        slope, change = turning.slope[component], turning.slope_rate[component]
        driving = moment[component] + slope * (moment[held] - inertia[held] * change * turning.rate[component])
        found[angle] = driving / (inertia[component] + inertia[held] * slope**2)
    return found

"""One driven wheelset below a mass: motor, drive and two wheels, which shafts with torsional stiffness may join.

The bodies are in a row, at the speed of the axle: the rotor behind its gear, wheel 1 next to the gear, wheel 2. Each
shaft is elastic or rigid. Newton's laws, as (2.8) with two rails and with torques of shafts M:

m dV/dt = F_1 + F_2 - R,   J_i dw_i/dt = M_before - M_after - F_i r - B_i,   M = k theta + c dtheta/dt
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields

from fmu_src.symbols import ca
from fmu_src.system import ParameterSet, System, Variable, quantity
from rbd_model.contact.creep.law import SMALLEST_FRICTION, SMALLEST_LOAD, at_least
from rbd_model.contact.friction import FallingFriction, Surface
from rbd_model.contact.hertz import POISSON_RATIO
from rbd_model.track.friction import dry
from rbd_model.vehicle.parameters import tables_5_1_and_5_2
from rbd_model.vehicle.scales import NOMINAL_ANGULAR_VELOCITY, NOMINAL_DISTANCE, NOMINAL_SPEED
from rbd_model.vehicle.variables import HIGHEST_FRICTION, initial_speed
from rbd_model.wheelset.level_rail import CentredContact, CentredLoad, centred_creep_force, contact_stiffness
from rbd_model.wheelset.rotation import BENDING, Grip, Hold, stand_still

#: Scale of the error control: the twist of an axle at full traction is some milliradians.
NOMINAL_TWIST = 1e-3
#: Parameters of the contact, which are those of vehicles.
CONTACT = ("wheel_profile_curvature", "rail_head_radius", "shear_modulus", "creepage_speed", "gravity")
#: Wheels by their numbers.
WHEELS = {1: "the wheel next to the gear", 2: "the other wheel"}


@dataclass(frozen=True)
class DrivenParameters(ParameterSet):
    """Masses, inertias and shafts of a driven wheelset; those of the drive are referred to the axle."""

    carried_mass: float = quantity("kg", "Mass that this wheelset carries, its own included", 1.0)
    trailing_mass: float = quantity("kg", "Mass that this wheelset pulls and does not carry", 0.0, 1e8)
    wheel_radius: float = quantity("m", "Radius of both wheels (r)", 0.05, 2.0)
    wheel_inertia_1: float = quantity("kg.m2", "Inertia of wheel 1 and all that turns with it, its gear (J_1)", 1e-2)
    wheel_inertia_2: float = quantity("kg.m2", "Inertia of wheel 2 and all that turns with it (J_2)", 1e-2)
    rotor_inertia: float = quantity("kg.m2", "Inertia of the rotor at its own speed (J_M)", 1e-3)
    gear_ratio: float = quantity("1", "Speed of the rotor over that of the axle (i)", 0.1, 100.0)
    axle_stiffness: float = quantity("N.m/rad", "Torsional stiffness of the axle between its wheels (k_A)", 1.0)
    axle_damping: float = quantity("N.m.s/rad", "Torsional damping of the axle (c_A)", 0.0)
    drive_stiffness: float = quantity(
        "N.m/rad", "Torsional stiffness between rotor and wheel 1, at the axle's speed (k_D)", 1.0
    )
    drive_damping: float = quantity("N.m.s/rad", "Torsional damping of the drive, at the axle's speed (c_D)", 0.0)


def electric_locomotive() -> DrivenParameters:
    """Return one of four wheelsets of an electric locomotive; all values are assumed, none is of a real one.

    Load of 21.5 t. Wheels of 500 kg with a radius of gyration of 0.4 m: 80 kg.m2; the gear adds 30 kg.m2. Axle: a steel
    shaft of 0.19 m over 1.5 m, G I_p / l = 6.8 MN.m/rad (Hooke's law), 61 Hz of wheel against wheel; 0.5 % of its
    critical damping. Rotor: 18 kg.m2 at 4.5 times the axle's speed. The drive's stiffness is that of 20 Hz of the rotor
    against a rigid wheelset; 3 % of its critical damping, as of rubber elements.
    """
    return DrivenParameters(
        carried_mass=21500.0,
        trailing_mass=0.0,
        wheel_radius=0.625,
        wheel_inertia_1=110.0,
        wheel_inertia_2=80.0,
        rotor_inertia=18.0,
        gear_ratio=4.5,
        axle_stiffness=6.8e6,
        axle_damping=180.0,
        drive_stiffness=2.0e6,
        drive_damping=950.0,
    )


#: A motor: a function of the system and the rotor's speed [rad/s]. Results: its torque on the rotor [N.m], and the same
#: at the start.
Motor = Callable[[System, "ca.SX"], "tuple[ca.SX, ca.SX]"]


@dataclass(frozen=True)
class _Described:
    """The system that is being written, and the symbols of its parameters."""

    system: System
    parameter: Mapping[str, ca.SX]


@dataclass(frozen=True)
class _Body:
    """A body in the row: inertia [kg.m2], torque of the motor, capacity of its brake [N.m], and of its rail its creep
    force and the largest force without sliding [N].
    """

    inertia: ca.SX
    torque: ca.SX
    brake: ca.SX
    creep: ca.SX
    static: ca.SX


@dataclass(frozen=True)
class _Group:
    """Bodies that turn together, by their places in the row: sums over them, and symbols of their motion.

    own: the bodies; outside [N.m]: torque of motor and elastic shafts. turning: direction, 1 of a rotor alone.
    """

    own: Sequence[int]
    omega: ca.SX
    outside: ca.SX
    all: _Body
    turning: ca.SX

    @property
    def wheels(self) -> list[int]:
        """Numbers of its wheels."""
        return [n for n in self.own if n in WHEELS]

    @property
    def locked(self) -> ca.SX:
        """1 while its brake holds it, else 0."""
        return 1 - self.turning**2


@dataclass(frozen=True)
class _Turning:
    """Motion of a body: acceleration [rad/s2], torque of its brake [N.m], force of its rail [N]; 1 if locked."""

    acceleration: ca.SX
    brake_torque: ca.SX
    force: ca.SX
    locked: ca.SX


def driven_wheelset(name: str, defaults: DrivenParameters, motor: Motor, elastic: tuple[bool, bool]) -> System:
    """Return the system of Newton's laws; elastic: drive, axle.

    The limits of level 1 apply: the wheels do not move sideways, and their loads do not change.
    """
    system = System(name, "One driven wheelset below a mass, its wheels on rails with their own friction")
    brakes, friction = _wheel_inputs(system)
    text = "Force that holds the vehicle back: running resistance, gradient, train. It does not turn with the motion"
    resistance = system.input(Variable("resistance", "input", "N", text))
    p = _parameters(system, defaults)
    speed = system.state("speed", "m/s", p["initial_speed"], NOMINAL_SPEED)
    shared = _shared(elastic)
    omega = _speeds(system, p, shared)
    turning = [omega[place] for place in shared]
    torque, first_torque = motor(system, p["gear_ratio"] * turning[0])
    sliding = [speed - p["wheel_radius"] * one for one in turning[1:]]
    creep = _creep(system, p, friction, speed, sliding)
    bodies = _bodies(system, p, p["gear_ratio"] * torque, brakes, creep, friction)
    twists = _twists(system, p, elastic, turning, p["gear_ratio"] * first_torque)
    shafts = [torque for _, torque in twists]
    groups = _groups(system, shared, bodies, omega, shafts)
    moves, held = _stand(_Described(system, p), groups, speed, resistance)
    slides = ca.fabs(speed) - p["creepage_speed"]
    motions = [one for pair in zip(groups, held, strict=True) for one in _turn(system, p, bodies, *pair, slides)]
    _move(system, p, speed, moves * (creep[0] + creep[1] - resistance))
    _add_rotor(system, p["gear_ratio"] * turning[0], bodies[0].torque * turning[0])
    _add_wheels(system, p["wheel_radius"], turning[1:], sliding, [motion.force for motion in motions[1:]])
    _add_locks(system, motions, slides)
    _add_shafts(system, [twist for twist, _ in twists], _shaft_torques(p, bodies, motions, elastic, shafts))
    return system


def _wheel_inputs(system: System) -> tuple[list[ca.SX], list[ca.SX]]:
    """Return torque capacities of the brakes [N.m] and friction coefficients mu0 of both wheels."""
    brakes, friction = [], []
    for number, place in WHEELS.items():
        text = f"Largest torque that the brake of {place} can resist with (a capacity)"
        brakes.append(system.input(Variable(f"brake_torque_{number}", "input", "N.m", text, 0.0, 0.0)))
    for number, place in WHEELS.items():
        text = f"Wheel-rail friction coefficient under {place}, without sliding"
        variable = Variable(f"friction_{number}", "input", "1", text, dry().friction, 0.0, HIGHEST_FRICTION)
        friction.append(system.input(variable))
    return brakes, friction


def _parameters(system: System, defaults: DrivenParameters) -> dict[str, ca.SX]:
    """Return the parameters of start, bodies and contact; the surface is that of a dry rail, Polach (2005)."""
    text = "Speed minus wheel radius times angular velocity at the start, below 0 while the wheels spin"
    slip = Variable("initial_slip", "parameter", "m/s", text)
    contact = tables_5_1_and_5_2()
    variables = [initial_speed(10.0), slip, *map(defaults.variable, defaults.values())]
    variables += [contact.variable(name) for name in CONTACT]
    law: FallingFriction = dry().law
    variables += [law.variable(name) for name in law.values()]
    return {variable.name: system.parameter(variable) for variable in variables}


def _shared(elastic: Sequence[bool]) -> list[int]:
    """Return for each body the place of the first one that turns with it: bodies on rigid shafts share a speed."""
    found = [0]
    for place, one in enumerate(elastic, 1):
        found.append(place if one else found[-1])
    return found


def _speeds(system: System, p: Mapping[str, ca.SX], shared: Sequence[int]) -> dict[int, ca.SX]:
    """Return the angular velocities [rad/s] by the place of the first body that has each, all equal at the start."""
    start, found = (p["initial_speed"] - p["initial_slip"]) / p["wheel_radius"], {}
    for place in dict.fromkeys(shared):
        wheels = [number for number in WHEELS if shared[number] == place]
        name = f"angular_velocity_{wheels[0]}" if wheels else "rotor"
        found[place] = system.state(name, "rad/s", start, NOMINAL_ANGULAR_VELOCITY)
    return found


def _bodies(
    system: System,
    p: Mapping[str, ca.SX],
    torque: ca.SX,
    brakes: Sequence[ca.SX],
    creep: Sequence[ca.SX],
    friction: Sequence[ca.SX],
) -> list[_Body]:
    """Return rotor and wheels at the axle's speed, third line of (2.8); torque [N.m]: of the motor, at that speed."""
    none, load = ca.SX(0), system.derived_symbols["wheel_load"]
    rotor = _Body(p["gear_ratio"] ** 2 * p["rotor_inertia"], torque, none, none, none)
    inertias = [p[f"wheel_inertia_{number}"] for number in WHEELS]
    wheels = zip(inertias, brakes, creep, friction, strict=True)
    return [rotor, *(_Body(inertia, none, brake, force, mu * load) for inertia, brake, force, mu in wheels)]


def _creep(
    system: System, p: Mapping[str, ca.SX], friction: Sequence[ca.SX], speed: ca.SX, sliding: Sequence[ca.SX]
) -> list[ca.SX]:
    """Return the forces of the rails on both wheels [N], (3.94), (3.97), Polach (2005)."""
    fall = system.derived("friction_fall", 1 - p["friction_ratio"])
    surface = Surface(p["friction_ratio"], p["friction_decay"], fall, p["adhesion_reduction"], p["slip_reduction"])
    stiffness = contact_stiffness(p["wheel_radius"], p, POISSON_RATIO)
    contact = CentredContact(system.derived("contact_stiffness", stiffness))
    wheel = system.derived("wheel_load", at_least(p["carried_mass"] * p["gravity"] / 2, SMALLEST_LOAD))
    load = CentredLoad(wheel, system.derived("load_growth", wheel ** (1 / 3)))
    return [
        centred_creep_force(surface, mu, contact, load, (one, speed, p["creepage_speed"])) / 2
        for mu, one in zip(friction, sliding, strict=True)
    ]


def _twists(
    system: System, p: Mapping[str, ca.SX], elastic: Sequence[bool], turning: Sequence[ca.SX], first: ca.SX
) -> list[tuple[ca.SX, ca.SX]]:
    """Return twist [rad] and torque [N.m] of drive and axle, Hooke's law with damping; 0 if rigid.

    first [N.m]: torque of the motor at the start, at the axle's speed. The shafts start twisted by it, the axle half.
    """
    found = []
    for place, (name, share) in enumerate((("drive", 1.0), ("axle", 0.5))):
        stiffness, damping = p[f"{name}_stiffness"], p[f"{name}_damping"]
        if not elastic[place]:
            found.append((ca.SX(0), ca.SX(0)))
            continue
        twist = system.state(f"{name}_twist", "rad", share * first / stiffness, NOMINAL_TWIST)
        rate = turning[place] - turning[place + 1]
        system.derivative(twist, rate)
        found.append((twist, stiffness * twist + damping * rate))
    return found


def _groups(
    system: System,
    shared: Sequence[int],
    bodies: Sequence[_Body],
    omega: Mapping[int, ca.SX],
    shafts: Sequence[ca.SX],
) -> list[_Group]:
    """Return the bodies that share a speed, third line of (2.8); shafts [N.m]: torques of elastic ones."""
    found, passed = [], [ca.SX(0), *shafts, ca.SX(0)]
    for place, state in omega.items():
        own = [n for n, one in enumerate(shared) if one == place]
        whole = _Body(
            **{field.name: ca.SX(sum(getattr(bodies[n], field.name) for n in own)) for field in fields(_Body)}
        )
        outside = whole.torque + passed[own[0]] - passed[own[-1] + 1]
        wheels = [n for n in own if n in WHEELS]
        turning = system.direction(f"direction_{wheels[0]}") if wheels else ca.SX(1)
        found.append(_Group(own, state, outside, whole, turning))
    return found


def _stand(
    described: _Described, groups: Sequence[_Group], speed: ca.SX, resistance: ca.SX
) -> tuple[ca.SX, list[ca.SX]]:
    """Return 1, or 0 while locked wheels hold the vehicle at rest, and the force of their rails then [N].

    It is that of `stand_still`, third line of (2.8): each group holds by its `Grip`, in proportion to its maximum. Only
    a rigid axle holds: on an elastic one, whose twist moves wheels and vehicle by micrometres, holds would chatter.
    """
    if not any(len(group.wheels) == len(WHEELS) for group in groups):
        return ca.SX(1), [ca.SX(0) for _ in groups]
    radius, moving = described.parameter["wheel_radius"], described.system.direction("moving")
    grips = []
    for one in groups:
        braked = one.all.brake / radius
        grips.append(Grip(braked, one.locked * braked, one.locked * ca.fmin(one.all.static, braked)))
    whole = Grip(*(ca.SX(sum(getattr(one, of.name) for one in grips)) for of in fields(Grip)))
    creep = ca.SX(sum(one.all.creep for one in groups))
    rolling = ca.SX(sum((1 - one.locked) * one.all.creep for one in groups))
    turned = ca.SX(sum(one.locked * one.outside for one in groups)) / radius
    hold = Hold(moving, moving, speed)
    stand_still(described, "The vehicle", hold, [speed], (rolling - resistance, turned), whole)
    share = (hold.moves - 1) * (creep - resistance) / at_least(whole.whole, SMALLEST_LOAD)
    return hold.moves, [share * grip.whole for grip in grips]


def _turn(
    system: System, p: Mapping[str, ca.SX], bodies: Sequence[_Body], group: _Group, held: ca.SX, slides: ca.SX
) -> list[_Turning]:
    """Add the rotation of a group, third line of (2.8), and return that of its bodies; its brakes are dry friction.

    held [N]: force of its rails that holds a standing vehicle, else 0. slides: above 0 while the axle moves.
    """
    torque, capacity = group.outside - p["wheel_radius"] * group.all.creep, group.all.brake
    turns, holding = 1 - group.locked, torque - p["wheel_radius"] * held
    acceleration = turns * (torque - group.turning * capacity) / group.all.inertia
    system.derivative(group.omega, acceleration)
    if group.wheels:
        label = f"Wheel {group.wheels[0]}" if len(group.wheels) < len(WHEELS) else "The wheelset"
        words, reported = ("locked", "turns again"), (slides, 1.0)
        system.dry_friction(label, group.turning, [group.omega], holding, capacity, words, reported=reported)
    braked = (turns * group.turning * capacity + group.locked * holding) / ca.fmax(capacity, SMALLEST_FRICTION)
    on_rail = held / at_least(group.all.static, SMALLEST_LOAD)
    return [
        _Turning(acceleration, one.brake * braked, one.creep + one.static * on_rail, group.locked)
        for one in (bodies[n] for n in group.own)
    ]


def _move(system: System, p: Mapping[str, ca.SX], speed: ca.SX, force: ca.SX) -> None:
    """Add the motion along the track, first line of (2.8), with steps as in `follow_creep`."""
    distance = system.state("distance", "m", 0.0, NOMINAL_DISTANCE)
    acceleration = force / system.derived("total_mass", p["carried_mass"] + p["trailing_mass"])
    system.derivative(distance, speed)
    system.derivative(speed, acceleration)
    least = BENDING * p["creepage_speed"]
    system.limit_change(ca.sqrt(speed**2 + least**2) / 2, speed)
    system.output(Variable("speed", "output", "m/s", "Forward speed", display_unit="km/h"), speed)
    system.output(Variable("distance", "output", "m", "Distance travelled"), distance)
    system.output(Variable("acceleration", "output", "m/s2", "Forward acceleration"), acceleration)


def _shaft_torques(
    p: Mapping[str, ca.SX],
    bodies: Sequence[_Body],
    motions: Sequence[_Turning],
    elastic: Sequence[bool],
    torques: Sequence[ca.SX],
) -> list[ca.SX]:
    """Return the torques of drive and axle [N.m]; that of a rigid shaft accelerates all bodies after it, (2.8)."""
    after, found = ca.SX(0), []
    for place in (2, 1):
        motion = motions[place]
        against = p["wheel_radius"] * motion.force + motion.brake_torque
        rigid = bodies[place].inertia * motion.acceleration + against + after
        after = torques[place - 1] if elastic[place - 1] else rigid
        found.append(after)
    return found[::-1]


def _add_rotor(system: System, turning: ca.SX, power: ca.SX) -> None:
    system.output(Variable("rotor_speed", "output", "rad/s", "Angular velocity of the rotor"), turning)
    text = "Power of the motor on its rotor, below 0 while it brakes"
    system.output(Variable("rotor_power", "output", "W", text), power)


def _add_locks(system: System, motions: Sequence[_Turning], slides: ca.SX) -> None:
    for number, place in WHEELS.items():
        text = f"The brake holds {place} while the axle moves; false at rest"
        variable = Variable(f"locked_{number}", "output", "1", text, kind="boolean")
        system.output(variable, motions[number].locked * (slides > 0))


def _add_wheels(
    system: System, radius: ca.SX, turning: Sequence[ca.SX], sliding: Sequence[ca.SX], creep: Sequence[ca.SX]
) -> None:
    rows = (
        ("angular_velocity", "rad/s", "Angular velocity of {}, positive when rolling forward", turning),
        ("wheel_speed", "m/s", "Circumferential speed of {}", [radius * one for one in turning]),
        ("slip", "m/s", "Speed minus wheel radius times angular velocity of {}, below 0 while it spins", sliding),
        ("creep_force", "N", "Force of the rail on {} along the track, positive forward", creep),
    )
    for name, unit, text, values in rows:
        for number, place in WHEELS.items():
            system.output(Variable(f"{name}_{number}", "output", unit, text.format(place)), values[number - 1])


def _add_shafts(system: System, twists: Sequence[ca.SX], torques: Sequence[ca.SX]) -> None:
    texts = {"drive": "drive, at the axle's speed, positive while it drives", "axle": "axle from wheel 1 to wheel 2"}
    for (name, text), twist, torque in zip(texts.items(), twists, torques, strict=True):
        system.output(Variable(f"{name}_twist", "output", "rad", f"Twist of the {text}; 0 if it is rigid"), twist)
        system.output(Variable(f"{name}_torque", "output", "N.m", f"Torque in the {text}"), torque)

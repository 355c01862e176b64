"""Braked vehicles as data: a vehicle, a brake on each wheelset and its equipment, composed into one system.

The test rig, BrakedVehicle.fmu, `bb.run` and the live page take their equations from `composed`. The C code contains
only the equations of the present equipment.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from itertools import pairwise

import numpy as np

from brake_controller.cylinder import Rubbing, alone, reservoir_brake, timed_brake, treads
from brake_controller.discs import MEAN_PAD_FRICTION, DiscParameters, axle_discs, discs
from brake_controller.flow_parameters import FlowParameters
from brake_controller.magnet_valves import common_valves
from brake_controller.motors import dynamic_brake, motor_of, traction_motor
from brake_controller.parameters import BrakeParameters, qr30
from brake_controller.ready_sets import qr30_experiment
from brake_controller.reservoir import ReservoirParameters, air_reservoir
from brake_controller.timing import filling_time, with_application_time, with_release_time
from fmu_src.compose import compose, renamed, scope
from fmu_src.system import System, Variable
from products import bogie as chapter_5
from rbd_model.track.sand import sanders
from rbd_model.vehicle.description import Vehicle, size_of
from rbd_model.vehicle.parameters import BogieParameters
from rbd_model.vehicle.ready import passenger_coach, two_axle_bogie

#: Pressure [Pa] and torque capacity of one wheelset [N.m] of the coach's full brake, for a deceleration of 1.2 m/s2;
#: times of its cylinder with a dump valve [s]. Assumed: the benchmark reports no brake data; these are common in
#: passenger stock.
FULL_PRESSURE, FULL_TORQUE = 380e3, 6.4e3
APPLICATION_TIME, RELEASE_TIME = 2.0, 0.6
#: Available equipment: discs instead of treads, a dynamic brake that blends with the cylinders, a sander ahead of each
#: wheelset; or, instead of cylinders, traction by a motor on each wheelset.
EQUIPMENT = DISCS, DYNAMIC_BRAKE, SANDERS, TRACTION = ("discs", "dynamic brake", "sanders", "traction")
#: Volume of a cylinder [m3] (AAR, brake_data.csv of the sources), and the exponent of its air, as fast as that of the
#: experiment.
CYLINDER_VOLUME, EXPONENT = 10.3e-3, 1.2
#: Assumed: 100 l a bogie at 5 bar, fed from a pipe of 5 bar through 3 mm.
RESERVOIR_OF_A_BOGIE, RESERVOIR_PRESSURE, FEED_ORIFICE = 0.1, 500e3, 3e-3
#: Vehicles by the names of their FMUs.
VEHICLES: Mapping[str, Callable[[], Vehicle]] = {"bogie": two_axle_bogie, "vehicle": passenger_coach}


def in_order(equipment: Iterable[str]) -> tuple[str, ...]:
    """Return names of equipment in the order of EQUIPMENT, each once. Raises ValueError if a name is unknown."""
    given = set(equipment)
    for name in given:
        if name not in EQUIPMENT:
            raise ValueError(f"Equipment must be one of {', '.join(EQUIPMENT)}; got {name!r}.")
    if TRACTION in given and given & {DISCS, DYNAMIC_BRAKE}:
        raise ValueError("A vehicle with traction must have no discs and no dynamic brake: its run does not brake.")
    return tuple(name for name in EQUIPMENT if name in given)


@dataclass(frozen=True)
class OwnNumbers:
    """Numbers of a vehicle file that replace those of a built-in vehicle.

    title: name of the vehicle. parameters: masses, sizes, springs. resistance: running resistance by the names of its
    parameters [SI].
    """

    title: str
    parameters: BogieParameters
    resistance: tuple[tuple[str, float], ...] = ()


@dataclass(frozen=True)
class Machine:
    """A vehicle with a brake on each wheelset and additional equipment.

    name: one of VEHICLES. full_pressure [Pa], full_torque [N.m]: of the full brake of one wheelset. supply_pressure
    [Pa]: largest output of its regulator. by_flow: cylinders fill by flow of air from a reservoir, through magnet
    valves with switching times; else by application and release time. equipment: some of EQUIPMENT. own: numbers of a
    vehicle file. Raises ValueError if equipment is unknown, or if it requires cylinders by flow of air.
    """

    name: str
    full_pressure: float
    full_torque: float
    supply_pressure: float
    by_flow: bool = False
    equipment: tuple[str, ...] = ()
    own: OwnNumbers | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "equipment", in_order(self.equipment))
        if self.equipment and not (self.by_flow or self.driven):
            raise ValueError(
                f"A vehicle with {' and '.join(self.equipment)} must have cylinders filled by flow of air."
            )

    @cached_property
    def vehicle(self) -> Vehicle:
        """The vehicle as data."""
        found = VEHICLES[self.name]()
        return replace(found, parameters=self.own.parameters) if self.own else found

    @property
    def built_in(self) -> Machine:
        """The built-in vehicle with the same equations, which are compiled once for all vehicle files."""
        return replace(MACHINES[self.name](), by_flow=self.by_flow, equipment=self.equipment)

    @property
    def title(self) -> str:
        """Name of the vehicle in tables."""
        return self.own.title if self.own else self.name

    @cached_property
    def numbers(self) -> tuple[int, ...]:
        """Numbers of its wheelsets, from 1."""
        return tuple(number for number, _ in self.vehicle.numbered)

    @property
    def parameters(self) -> BogieParameters:
        """Parameters of the vehicle."""
        found = self.vehicle.parameters
        assert isinstance(found, BogieParameters)
        return found

    @property
    def mass(self) -> float:
        """Mass of all bodies and wheelsets [kg]."""
        values = self.parameters.values()
        sizes = [*(body.mass for body in self.vehicle.bodies), *(wheelset.mass for wheelset in self.vehicle.wheelsets)]
        return float(sum(size_of(mass, values) for mass in sizes))

    @property
    def counted(self) -> str:
        """Name of the body whose distance and speed are states."""
        return self.vehicle.bodies[0].name

    @property
    def driven(self) -> bool:
        """True if motors drive it instead of brakes."""
        return TRACTION in self.equipment

    def deceleration(self, torque: float, load: float = 0.0) -> float:
        """Return the deceleration on a dry rail with this torque on each wheelset [N.m], rotation included [m/s2].

        load: additional mass [kg].
        """
        return len(self.numbers) * torque / self.parameters.wheel_radius / self.turning_mass(load)

    def turning_mass(self, load: float = 0.0) -> float:
        """Return the mass with that of the rotation of rolling wheelsets, and an additional load [kg]."""
        p = self.parameters
        return self.mass + load + len(self.numbers) * p.wheelset_pitch_inertia / p.wheel_radius**2


def bogie() -> Machine:
    """Return the bogie of chapter 5."""
    supply = chapter_5.brake_values()["supply_pressure"]
    return Machine("bogie", chapter_5.FULL_PRESSURE, chapter_5.FULL_TORQUE, supply)


def coach() -> Machine:
    """Return the complete vehicle: vehicle 1 of the Manchester benchmarks with traction rods."""
    return Machine("vehicle", FULL_PRESSURE, FULL_TORQUE, FULL_PRESSURE)


#: Braked vehicles by the names of their vehicles.
MACHINES: Mapping[str, Callable[[], Machine]] = {"bogie": bogie, "vehicle": coach}


def coach_brake() -> BrakeParameters:
    """Return the brake of one wheelset of the coach."""
    return brake_of(passenger_coach(), FULL_TORQUE)


def brake_of(vehicle: Vehicle, full_torque: float) -> BrakeParameters:
    """Return the brake of one wheelset: `qr30` scaled to a torque at FULL_PRESSURE [N.m]; assumed."""
    brake, radius = qr30(), vehicle.parameters.values()["wheel_radius"]
    shoe_torque = brake.wheelset_share * brake.rigging_efficiency * brake.constant_shoe_friction * radius
    return replace(
        brake,
        supply_pressure=FULL_PRESSURE,
        application_time=APPLICATION_TIME,
        release_time=RELEASE_TIME,
        wheel_radius=radius,
        force_per_pressure=full_torque / FULL_PRESSURE / shoe_torque,
    )


def of_pads(brake: BrakeParameters, disc: DiscParameters) -> float:
    """Return the force per pressure [N/Pa] at which pads with MEAN_PAD_FRICTION brake as much as shoes on treads."""
    on_treads = brake.constant_shoe_friction * brake.wheel_radius
    return brake.force_per_pressure * on_treads / (MEAN_PAD_FRICTION * disc.friction_radius)


# ---- the system ------------------------------------------------------------------------------------------------------


def composed(machine: Machine, system: System, rubbing: Rubbing | None = None) -> System:
    """Return the vehicle at one level of detail, with or without a line, composed with all its equipment.

    All brakes begin with the parameters of `brake_of`. rubbing: friction pair of the cylinders, instead of treads or
    discs.
    """
    vehicle = machine.vehicle
    if SANDERS in machine.equipment:
        system = _on_sand(system, vehicle)
    if machine.driven:
        motor = motor_of(machine.full_torque, machine.parameters.wheel_radius)
        return _on_each_wheelset(system, vehicle, lambda: traction_motor(motor), "traction_torque")
    if machine.by_flow:
        return _with_reservoir(system, machine, rubbing)
    brake = brake_of(vehicle, machine.full_torque)
    return _on_each_wheelset(system, vehicle, lambda: timed_brake(brake, rubbing=rubbing), "brake_torque")


def _on_each_wheelset(system: System, vehicle: Vehicle, make: Callable[[], System], torque: str) -> System:
    """Return the system with a brake, or a motor, on each wheelset that makes a torque from its `angular_velocity`.

    All have the same parameters. torque: that output, and the input of the vehicle that it is connected to.
    """
    parts, radius = [], system.parameter_symbols["wheel_radius"]
    for number, _ in vehicle.numbered:
        text = f"Circumferential speed of the wheels of wheelset {number}, which a wheel-slide protection measures"
        measured = Variable(f"wheel_speed_{number}", "output", "m/s", text)
        system.output(measured, radius * system.outputs[f"angular_velocity_{number}"])
        one = make()
        parts.append(scope(one, after=f"_{number}", common=list(one.parameter_symbols)))
    faces = [f"{name}_{number}" for name in (torque, "angular_velocity") for number, _ in vehicle.numbered]
    return compose(system.name, system.description, [system, *parts], {name: name for name in faces})


def _on_sand(system: System, vehicle: Vehicle) -> System:
    """Return a vehicle with a sander ahead of each wheelset; its friction is that of the sanded rail."""
    places = {number: vehicle.number(one.along) for number, one in vehicle.numbered}
    own = {f"friction_{number}": f"friction_with_sand_{number}" for number in places}
    given = {inside: f"sanded_{name}" for name, inside in own.items()} | {"speed": "speed"}
    return compose(system.name, system.description, [renamed(system, own), sanders(list(places.values()))], given)


def _with_reservoir(system: System, machine: Machine, given_rubbing: Rubbing | None) -> System:
    """Return a vehicle with a cylinder and other brakes on each wheelset, and one reservoir for all."""
    air, numbers, full = cylinder_air(machine.full_pressure), machine.numbers, machine.full_torque
    brake, rubbing = brake_of(machine.vehicle, full), given_rubbing or treads()
    if DISCS in machine.equipment:
        disc = axle_discs()
        brake, rubbing = replace(brake, force_per_pressure=of_pads(brake, disc)), discs(disc)
    motor = motor_of(full, machine.parameters.wheel_radius)
    blending = dynamic_brake(motor, machine.full_pressure, full) if DYNAMIC_BRAKE in machine.equipment else alone

    def cylinder() -> System:
        return reservoir_brake(brake, air, common_valves(), rubbing, blending)

    braked = _on_each_wheelset(system, machine.vehicle, cylinder, "brake_torque")
    reservoir = air_reservoir(
        reservoir_of(len(numbers)), air.variable("ambient_pressure"), air.variable("air_temperature"), len(numbers)
    )
    taken = {f"air_flow_{number}": f"air_flow_{number}" for number in numbers}
    given = {f"reservoir_pressure_{number}": "reservoir_pressure" for number in numbers}
    return compose(system.name, system.description, [braked, reservoir], taken | given)


@lru_cache
def cylinder_air(full_pressure: float, application_time: float = APPLICATION_TIME) -> FlowParameters:
    """Return air of a cylinder of constant volume, with the times of the timed law [s] for its full brake [Pa]."""
    experiment = qr30_experiment().flow
    flow = replace(experiment, dead_volume=CYLINDER_VOLUME, polytropic_exponent=EXPONENT)
    flow = with_application_time(flow, full_pressure, application_time)
    return with_release_time(flow, full_pressure, RELEASE_TIME)


def filling_by_time(application_time: float = APPLICATION_TIME) -> Callable[[float], float]:
    """Return the share of the full pressure as a function of the time [s] since the demand, by the timed law.

    application_time: to 95 % [s].
    """
    return lambda since: 1.0 - 20.0 ** (-max(since, 0.0) / application_time)


@lru_cache
def filling_by_flow(full_pressure: float, application_time: float = APPLICATION_TIME) -> Callable[[float], float]:
    """Return the function of time since the demand [s] that gives the share of the full pressure, from empty.

    The supply of air is not limited.
    """
    air, shares = cylinder_air(full_pressure, application_time), np.linspace(0.0, 0.999, 200)
    pressures = (full_pressure * shares).tolist()
    times = np.cumsum([0.0, *(filling_time(air, full_pressure, end, start) for start, end in pairwise(pressures))])
    return lambda since: float(np.interp(since, times, shares))


def reservoir_of(wheelsets: int) -> ReservoirParameters:
    """Return a reservoir for this number of wheelsets. Assumed."""
    return ReservoirParameters(
        reservoir_volume=RESERVOIR_OF_A_BOGIE * wheelsets / 2,
        initial_reservoir_pressure=RESERVOIR_PRESSURE,
        feed_pressure=RESERVOIR_PRESSURE,
        feed_orifice=FEED_ORIFICE,
    )

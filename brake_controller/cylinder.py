"""BrakeCylinder: pressure demand in, torque capacity of one wheelset out; pressure by a timed law or by flow of air."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from brake_controller.air import GAS_CONSTANT
from brake_controller.flow import (
    Openings,
    Regulator,
    air_rates,
    air_temperature,
    commanded,
    piston,
    spring_force,
    valve_flows,
)
from brake_controller.flow_parameters import FlowParameters
from brake_controller.magnet_valves import ValveParameters, following
from brake_controller.parameters import BrakeParameters, qr30
from brake_controller.pneumatics import APPLY, VALVE, pressure_rate, regulated_pressure
from brake_controller.ready_sets import qr30_experiment
from brake_controller.rigging import shoe_force, torque_capacity
from brake_controller.shoe_friction import EXAMPLE_TABLE, FrictionTable, shoe_friction, sliding_speed
from fmu_src.symbols import ca
from fmu_src.system import Model, System, Variable, choosing, model_of_choices

#: Local error of 0.1 Pa per step at this tolerance.
DEFAULT_TOLERANCE = 1e-6
NOMINAL_PRESSURE, NOMINAL_MASS = 1e5, 1e-3
#: Kinds of `cylinder_model`, by their numbers.
PNEUMATICS = {1: "by application and release time", 2: "by flow of air through restrictions"}
#: Parameters of the timed law alone: its times, and the pressure of the piston's spring, which the flow law computes.
TIMES = ("application_time", "release_time", "touch_pressure")


@dataclass(frozen=True)
class Brake:
    """A brake under construction: the symbols that its equations share."""

    system: System
    parameter: Mapping[str, ca.SX]
    target: ca.SX
    valve: ca.SX
    angular_velocity: ca.SX
    beside: ca.SX


#: A brake in addition to the cylinder. It is a function of the system, the demand [Pa], the valve and the angular
#: velocity [rad/s]. Results: the remaining demand for the cylinder [Pa] and its own torque capacity [N.m].
Blending = Callable[[System, "ca.SX", "ca.SX", "ca.SX"], "tuple[ca.SX, ca.SX]"]


def alone(_: System, demand: ca.SX, __: ca.SX, ___: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Return the demand unchanged: no other brake exists."""
    return demand, ca.SX(0)


def _begin(
    name: str,
    description: str,
    defaults: BrakeParameters,
    without: tuple[str, ...] = (),
    blending: Blending = alone,
) -> Brake:
    """Declare inputs and parameters. Fail-safe: a demand that is lost (NaN), or never set, is treated as full supply.

    The de-energised solenoid of the experiment has the same effect: it opens the line to the cylinders (section 6.3.9).
    """
    system = System(name, description)
    full = defaults.supply_pressure
    demand = system.input(
        Variable(
            "pressure_demand",
            "input",
            "Pa",
            "Demanded cylinder pressure; NaN counts as a lost signal: full brake",
            full,
            0.0,
            display_unit="kPa",
            when_lost=full,
        )
    )
    valve = system.input(Variable("valve", "input", start=APPLY, **choosing("Valve of the cylinder", VALVE)))
    angular_velocity = system.input(
        Variable(
            "angular_velocity",
            "input",
            "rad/s",
            "Angular velocity of the braked wheelset, for friction laws that "
            "depend on sliding speed; laws 0 and 1 do not",
        )
    )
    p = {name: system.parameter(defaults.variable(name)) for name in defaults.values() if name not in without}
    left, beside = blending(system, demand, valve, angular_velocity)
    return Brake(system, p, regulated_pressure(left, p["supply_pressure"]), valve, angular_velocity, beside)


@dataclass(frozen=True)
class Rubbing:
    """Friction pairs on which a cylinder acts.

    `without` holds fields of BrakeParameters that it does not use. `torque` adds its equations and outputs to a system
    and returns the torque capacity [N.m]. Arguments: the system, its parameters, the force [N] and the angular velocity
    [rad/s].
    """

    without: tuple[str, ...]
    torque: Callable[[System, Mapping[str, ca.SX], ca.SX, ca.SX], ca.SX]


def treads(table: FrictionTable = EXAMPLE_TABLE) -> Rubbing:
    """Return shoes on the treads of the wheels, eq. (2.7). table: for friction law 5."""

    def torque(system: System, p: Mapping[str, ca.SX], force: ca.SX, angular_velocity: ca.SX) -> ca.SX:
        speed = sliding_speed(angular_velocity, p["wheel_radius"])
        friction = shoe_friction(system, p, force / p["shoes"], speed, table)
        system.output(Variable("shoe_force", "output", "N", "Normal force of the shoes on this wheelset"), force)
        text = "Friction coefficient between shoes and wheel"
        system.output(Variable("shoe_friction", "output", "1", text), friction)
        return torque_capacity(friction, force, p["wheel_radius"])

    return Rubbing((), torque)


def _finish(brake: Brake, pressure: ca.SX, spring_pressure: ca.SX, rubbing: Rubbing) -> System:
    """Return the system with outputs from cylinder pressure on; spring_pressure: its part for the piston's spring."""
    system, p = brake.system, brake.parameter
    per_pressure = p["force_per_pressure"] * p["wheelset_share"]
    counter_force = p["slack_adjuster_force"] + per_pressure * spring_pressure
    force = shoe_force(pressure, per_pressure, counter_force, p["rigging_efficiency"])
    text = "Pressure in the cylinder"
    system.output(Variable("cylinder_pressure", "output", "Pa", text, display_unit="kPa"), pressure)
    torque = rubbing.torque(system, p, force, brake.angular_velocity)
    text = "Torque capacity of the brake on this wheelset"
    system.output(Variable("brake_torque", "output", "N.m", text), torque + brake.beside)
    return system


def timed_brake(
    defaults: BrakeParameters, table: FrictionTable = EXAMPLE_TABLE, rubbing: Rubbing | None = None
) -> System:
    """Return a brake whose pressure follows its demand with an application and a release time, section 2.4.2."""
    rubbing = rubbing or treads(table)
    brake = _begin("timed", "Cylinder pressure by application and release time", defaults, rubbing.without)
    p = brake.parameter
    pressure = brake.system.state("cylinder_pressure", "Pa", 0.0, NOMINAL_PRESSURE)
    rate = pressure_rate(pressure, brake.target, brake.valve, p["application_time"], p["release_time"])
    brake.system.derivative(pressure, rate)
    return _finish(brake, pressure, p["touch_pressure"], rubbing)


def flow_brake(defaults: BrakeParameters, air: FlowParameters, table: FrictionTable = EXAMPLE_TABLE) -> System:
    """Return a brake whose pressure follows from air flow through restrictions (section 6.3.9) and piston travel."""
    brake = _begin("flow", "Cylinder pressure by flow of air through restrictions", defaults, TIMES)
    cylinder = _filled(brake, air, Regulator(brake.target, brake.target), commanded(brake.valve))
    return _finish(brake, cylinder.pressure, cylinder.spring_pressure, treads(table))


def reservoir_brake(
    defaults: BrakeParameters,
    air: FlowParameters,
    valves: ValveParameters,
    rubbing: Rubbing | None = None,
    blending: Blending = alone,
) -> System:
    """Return a brake as `flow_brake` (section 6.3.9), with air from a reservoir, an input, through valves with a delay.

    There is no flow back into a reservoir that has less pressure than the cylinder. rubbing: by default shoes on
    treads; blending: of a dynamic brake with it.
    """
    rubbing = rubbing or treads()
    text = "Cylinder pressure by flow of air from a reservoir, through valves that take time"
    brake = _begin("reservoir", text, defaults, (*TIMES, *rubbing.without), blending)
    text = "Pressure in the reservoir that the cylinder is filled from"
    reservoir = Variable("reservoir_pressure", "input", "Pa", text, defaults.supply_pressure, 0.0, display_unit="kPa")
    regulator = Regulator(brake.target, ca.fmin(brake.target, brake.system.input(reservoir)))
    cylinder = _filled(brake, air, regulator, following(brake.system, brake.valve, valves))
    text = "Air that flows from the reservoir into the cylinder"
    brake.system.output(Variable("air_flow", "output", "kg/s", text), cylinder.flows[0])
    return _finish(brake, cylinder.pressure, cylinder.spring_pressure, rubbing)


@dataclass(frozen=True)
class _Cylinder:
    """Pressure [Pa], the part of it that the piston's spring takes [Pa], mass flows in and out [kg/s]."""

    pressure: ca.SX
    spring_pressure: ca.SX
    flows: tuple[ca.SX, ca.SX]


def _filled(brake: Brake, air: FlowParameters, regulator: Regulator, valves: Openings) -> _Cylinder:
    """Return the air in the cylinder as two states, with its observables."""
    system = brake.system
    flow = {name: system.parameter(air.variable(name)) for name in air.values()}
    empty = flow["ambient_pressure"] * piston(ca.SX(0), flow).volume / (GAS_CONSTANT * flow["air_temperature"])
    pressure = system.state("cylinder_pressure", "Pa", 0.0, NOMINAL_PRESSURE)
    mass = system.state("air_mass", "kg", empty, NOMINAL_MASS)

    position = piston(pressure, flow)
    temperature = air_temperature(pressure, mass, position, flow)
    flows = valve_flows(pressure, temperature, regulator, valves, flow)
    rates = air_rates(pressure, temperature, position, flows, flow)
    system.derivative(pressure, rates.pressure)
    system.derivative(mass, flows[0] - flows[1])
    for name, unit, observed in (
        ("air_temperature_in_cylinder", "K", temperature),
        ("piston_travel", "m", position.travel),
        ("mass_flow_in", "kg/s", flows[0]),
        ("mass_flow_out", "kg/s", flows[1]),
        ("enthalpy_in", "W", rates.enthalpy_in),
        ("enthalpy_out", "W", rates.enthalpy_out),
        ("piston_work", "W", rates.piston_work),
        ("heat_loss", "W", rates.heat_loss),
    ):
        system.observe(name, unit, observed)
    return _Cylinder(pressure, spring_force(position, flow) / flow["piston_area"], flows)


def brake_model(systems: tuple[System, ...]) -> Model:
    """Return the systems, in the order of the parameter `cylinder_model`, as one FMU."""
    known = {number: PNEUMATICS[number] for number in range(1, len(systems) + 1)}
    chosen = Variable("cylinder_model", "parameter", start=1.0, **choosing("Cylinder pressure", known))
    text = "Pneumatic brake cylinder, rigging and shoes of one wheelset, after Handoko (2006)"
    return model_of_choices("BrakeCylinder", text, systems, (chosen,), tuple(range(len(systems))), DEFAULT_TOLERANCE)


def brake_cylinder(
    defaults: BrakeParameters | None = None,
    air: FlowParameters | None = None,
    table: FrictionTable = EXAMPLE_TABLE,
) -> Model:
    """Return the brake cylinder as one FMU, by default that of the QR30 experiment at 180 kPa (section 7.4).

    table: shoe friction over sliding speed, for friction law 5.
    """
    rigging = defaults or qr30()
    return brake_model((timed_brake(rigging, table), flow_brake(rigging, air or qr30_experiment().flow, table)))

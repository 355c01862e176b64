"""BrakeCylinder: pressure demand in, torque capacity of one wheelset out."""

from __future__ import annotations

from brake_controller.parameters import BrakeParameters, qr30
from brake_controller.pneumatics import APPLY, VENT, pressure_rate, regulated_pressure
from brake_controller.rigging import shoe_force, torque_capacity
from brake_controller.shoe_friction import shoe_friction
from fmu_src.system import Model, System, Variable, model_of

#: Local error of 0.1 Pa per step at this tolerance.
DEFAULT_TOLERANCE = 1e-6
NOMINAL_PRESSURE = 1e5


def brake_cylinder_system(defaults: BrakeParameters) -> System:
    """Pressure demand -> cylinder pressure -> shoe force -> torque capacity.

    Fail-safe: a demand that is lost (NaN), or never given, counts as the full supply, as the de-energised solenoid of
    the experiment opens the line to the cylinders (section 6.3.9).
    """
    system = System(
        "BrakeCylinder", "Pneumatic brake cylinder, rigging and shoes of one wheelset, after Handoko (2006)"
    )
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
    valve = system.input(
        Variable("valve", "input", "1", "0 apply (de-energised), 1 hold, 2 vent", APPLY, APPLY, VENT, "integer")
    )
    system.input(
        Variable(
            "angular_velocity",
            "input",
            "rad/s",
            "Angular velocity of the braked wheelset, for friction laws that "
            "depend on sliding speed; laws 0 and 1 do not",
        )
    )
    p = {name: system.parameter(defaults.variable(name)) for name in defaults.values()}

    pressure = system.state("cylinder_pressure", "Pa", 0.0, NOMINAL_PRESSURE)
    target = regulated_pressure(demand, p["supply_pressure"])
    rate = pressure_rate(pressure, target, valve, p["application_time"], p["release_time"])
    system.derivative("cylinder_pressure", rate)

    area = p["force_per_pressure"] * p["wheelset_share"]
    force = shoe_force(pressure, area, p["slack_adjuster_force"], p["rigging_efficiency"])
    friction = shoe_friction(system, p["friction_law"], p["constant_shoe_friction"], force / p["shoes"])
    torque = torque_capacity(friction, force, p["wheel_radius"])
    system.output(
        Variable("cylinder_pressure", "output", "Pa", "Pressure in the cylinder", display_unit="kPa"), pressure
    )
    system.output(Variable("shoe_force", "output", "N", "Normal force of the shoes on this wheelset"), force)
    system.output(Variable("shoe_friction", "output", "1", "Friction coefficient between shoes and wheel"), friction)
    system.output(Variable("brake_torque", "output", "N.m", "Torque capacity of the brake on this wheelset"), torque)
    return system


def brake_cylinder(defaults: BrakeParameters | None = None) -> Model:
    """The brake cylinder as one FMU, by default that of the QR30 experiment at 180 kPa."""
    return model_of(brake_cylinder_system(defaults or qr30()), DEFAULT_TOLERANCE)

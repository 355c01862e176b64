"""Electric motors on wheelsets: a dynamic brake that blends with the cylinders, and traction, both with protection.

A protection commands the motor of a wheelset like its valve: 0 as demanded, 1 hold, 2 release. The torque follows as a
first-order lag. It is limited by the motor's largest torque and, at speed, its largest power. Lag, limits and values
are assumed, because motors differ widely from their mean.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from brake_controller.cylinder import Blending
from brake_controller.pneumatics import APPLY, HOLD, TIME_CONSTANTS_TO_95_PERCENT, VENT
from fmu_src.symbols import ca
from fmu_src.system import ParameterSet, System, Variable, choosing, quantity

NOMINAL_TORQUE = 1e3
#: Corner of |w|, and speed below which a dynamic brake fades [rad/s]; the second is assumed: 8 km/h on common wheels.
REST, FADE_SPEED = 0.02, 5.0


@dataclass(frozen=True)
class MotorParameters(ParameterSet):
    """The motor of one wheelset; its values are referred to the wheelset."""

    motor_torque: float = quantity("N.m", "Largest torque of the motor on its wheelset", 0.0)
    motor_power: float = quantity("W", "Largest power of the motor", 0.0)
    motor_rise_time: float = quantity("s", "Time to 95 % of a torque that is asked for", 1e-3)
    motor_release_time: float = quantity("s", "Time to 5 % of the torque where it is let go", 1e-3)


def motor_of(full_torque: float, radius: float) -> MotorParameters:
    """Return a motor with half of a full brake's torque [N.m] up to 15 m/s at this radius [m], then its power.

    All values are assumed.
    """
    torque = full_torque / 2
    return MotorParameters(
        motor_torque=torque, motor_power=torque / radius * 15.0, motor_rise_time=0.3, motor_release_time=0.15
    )


def _given(system: System, defaults: MotorParameters) -> dict[str, ca.SX]:
    return {name: system.parameter(defaults.variable(name)) for name in defaults.values()}


def available(p: Mapping[str, ca.SX], angular_velocity: ca.SX) -> ca.SX:
    """Return the largest torque of the motor at this angular velocity [N.m]."""
    turning = ca.sqrt(angular_velocity**2 + REST**2)
    return ca.fmin(p["motor_torque"], p["motor_power"] / turning)


def follow(system: System, name: str, p: Mapping[str, ca.SX], wanted: ca.SX, largest: ca.SX, valve: ca.SX) -> ca.SX:
    """Return the motor's torque as a state of this name [N.m]; it reaches 95 % in its times, as in section 2.4.2.

    wanted, largest: demanded and available torque [N.m].
    """
    torque = system.state(name, "N.m", 0.0, NOMINAL_TORQUE)
    held = ca.if_else(valve == HOLD, torque, wanted)
    target = ca.if_else(valve == VENT, 0, ca.fmin(held, largest))
    time = ca.if_else(target > torque, p["motor_rise_time"], p["motor_release_time"])
    system.derivative(torque, (target - torque) * TIME_CONSTANTS_TO_95_PERCENT / time)
    return torque


def dynamic_brake(defaults: MotorParameters, full_pressure: float, full_torque: float) -> Blending:
    """Return a blending with this motor: it takes as much of the demand as it can, and leaves the cylinder the rest.

    It fades below `fade_speed`, so that the cylinder brings the wheelset to rest. full_pressure [Pa], full_torque
    [N.m]: of the friction brake, whose pressure is the unit of the demand.
    """

    def blend(system: System, demand: ca.SX, valve: ca.SX, turning: ca.SX) -> tuple[ca.SX, ca.SX]:
        p = _given(system, defaults)
        text = "Torque of the friction brake for each pascal of the demand"
        per_pressure = system.parameter(
            Variable("torque_per_pressure", "parameter", "N.m/Pa", text, full_torque / full_pressure, 1e-9)
        )
        text = "Angular velocity below which the dynamic brake fades"
        fade = system.parameter(Variable("fade_speed", "parameter", "rad/s", text, FADE_SPEED, 0.1))
        fades = ca.fmin(ca.sqrt(turning**2 + REST**2) / fade, 1)
        torque = follow(system, "dynamic_torque", p, demand * per_pressure, available(p, turning) * fades, valve)
        system.output(Variable("dynamic_torque", "output", "N.m", "Torque capacity of the dynamic brake"), torque)
        return ca.fmax(demand - torque / per_pressure, 0), torque

    return blend


def traction_motor(defaults: MotorParameters) -> System:
    """Return a system with the demanded share of torque as input and the torque on the wheelset as output."""
    system = System("traction_motor", "Motor that drives a wheelset")
    p = _given(system, defaults)
    text = "Demanded share of the largest torque; NaN counts as a lost signal: no traction"
    demand = system.input(Variable("traction_demand", "input", "1", text, 0.0, 0.0, 1.0, when_lost=0.0))
    commands = {APPLY: "as demanded (de-energised)", HOLD: "hold", VENT: "let go"}
    valve = system.input(Variable("valve", "input", start=APPLY, **choosing("Command of the protection", commands)))
    turning = system.input(Variable("angular_velocity", "input", "rad/s", "Angular velocity of the driven wheelset"))
    largest = available(p, turning)
    torque = follow(system, "traction_torque", p, demand * p["motor_torque"], largest, valve)
    system.output(Variable("traction_torque", "output", "N.m", "Torque that drives this wheelset"), torque)
    return system


@dataclass(frozen=True)
class TorqueLoopParameters(ParameterSet):
    """A motor whose inverter controls its torque; its values are those at the rotor."""

    motor_torque: float = quantity("N.m", "Largest torque of the motor at its rotor", 0.0)
    motor_power: float = quantity("W", "Largest power of the motor; above it the torque is power over speed", 0.0)
    torque_time_constant: float = quantity("s", "Time constant of the torque loop", 1e-4)


def traction_inverter() -> TorqueLoopParameters:
    """Return the motor of one of four wheelsets of an electric locomotive.

    All values are assumed: 75 kN at a wheel of 0.625 m behind a gear of 4.5, 1.6 MW, and a loop of 10 ms.
    """
    return TorqueLoopParameters(motor_torque=10.4e3, motor_power=1.6e6, torque_time_constant=0.01)


def torque_loop(defaults: TorqueLoopParameters) -> Callable[[System, ca.SX], tuple[ca.SX, ca.SX]]:
    """Return a motor: a function of a system and the rotor's speed [rad/s]; its torque [N.m], now and at the start.

    T dM/dt = M* - M; M* is the demand within the largest torque and power over speed. It drives and brakes.
    """

    def motor(system: System, turning: ca.SX) -> tuple[ca.SX, ca.SX]:
        text = "Demanded torque of the motor at its rotor, below 0 to brake; NaN counts as a lost signal: no torque"
        demand = system.input(Variable("torque_demand", "input", "N.m", text, when_lost=0.0))
        p = {name: system.parameter(defaults.variable(name)) for name in defaults.values()}
        text = "Torque of the motor at the start, which twists its shafts, within its largest torque"
        initial = system.parameter(Variable("initial_torque", "parameter", "N.m", text))
        start = ca.fmax(ca.fmin(initial, p["motor_torque"]), -p["motor_torque"])
        torque = system.state("rotor_torque", "N.m", start, NOMINAL_TORQUE)
        most = available(p, turning)
        system.derivative(torque, (ca.fmax(ca.fmin(demand, most), -most) - torque) / p["torque_time_constant"])
        system.output(Variable("rotor_torque", "output", "N.m", "Torque of the motor on its rotor"), torque)
        return torque, start

    return motor

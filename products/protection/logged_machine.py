"""A vehicle driven by the log of its own run: cylinder pressures and wheel speeds are inputs, its speed is an output.

Friction affects the deceleration while wheels slide. Sliding wheels are unstable if friction falls with slip: without
feedback, a model with slightly too little friction locks wheels that did not lock. So each wheelset is pulled to its
measured speed, as the predictor of the prediction-error method does (Ljung 1999, System Identification, section 3.2)
with a Luenberger observer as its gain. The pull is a torque on the wheelset. It acts on the vehicle through the rail
alone, within the limits of friction.
"""

from __future__ import annotations

from functools import lru_cache

from fmu_src.compose import compose, scope
from fmu_src.suggestion import suggestion
from fmu_src.symbols import ca
from fmu_src.system import Model, System, Variable, model_of
from products.machine import MACHINES, Machine
from products.registry import fmu_named
from rbd_model.levels.models import DEFAULT_TOLERANCE, places_of, system_at

#: Rate at which a wheelset is pulled to its measured speed [1/s]; assumed: well above the rate at which a sliding wheel
#: diverges, 1/s on the low rail, and well below that of the creep of a rolling one.
TRACKING_RATE = 20.0


@lru_cache
def logged_machine(name: str) -> Model:
    """Return the planar "bogie" or "coach" (also "vehicle") with inputs pressure_1 [Pa], wheel_speed_1 [m/s] and so on.

    full_torque is that of its full brake; friction_1 and so on can be fitted. Raises KeyError if the name is unknown.
    """
    if fmu_named(name) not in MACHINES:
        raise KeyError(f"There is no machine {name} with a log; {suggestion(name, MACHINES)}")
    machine, [planar] = MACHINES[fmu_named(name)](), places_of(level=2, on_line=False)
    system = system_at(machine.vehicle, planar)
    logs = [scope(_wheelset(machine), after=f"_{n}", common=_COMMON) for n in machine.numbers]
    faces = [f"{face}_{n}" for face in ("brake_torque", "traction_torque", "angular_velocity") for n in machine.numbers]
    text = "A railway vehicle driven by the cylinder pressures and wheel speeds of a log"
    whole = compose("LoggedMachine", text, [system, *logs], {face: face for face in faces})
    return model_of(whole, DEFAULT_TOLERANCE)


#: Parameters that the vehicle has too, or all wheelsets share.
_COMMON = ("full_torque", "tracking_rate", "wheel_radius", "wheelset_pitch_inertia")


def _wheelset(machine: Machine) -> System:
    """Return the torques of a wheelset from measured data: J w' = ... + L J (w_measured - w), Luenberger (1971)."""
    system = System("logged_wheelset", "Torques of a wheelset whose pressure and speed were measured")
    pressure = system.input(Variable("pressure", "input", "Pa", "Measured pressure in the brake cylinder", minimum=0.0))
    speed = system.input(Variable("wheel_speed", "input", "m/s", "Measured circumferential speed of the wheels"))
    turning = system.input(Variable("angular_velocity", "input", "rad/s", "Angular velocity of the wheelset"))
    text = f"Brake torque at {machine.full_pressure / 1e3:g} kPa, in proportion to the pressure: constant shoe friction"
    torque = system.parameter(Variable("full_torque", "parameter", "N.m", text, machine.full_torque, minimum=0.0))
    text = "Rate at which a wheelset is pulled to its measured speed"
    rate = system.parameter(Variable("tracking_rate", "parameter", "1/s", text, TRACKING_RATE, minimum=0.0))
    p = machine.parameters
    radius, inertia = (system.parameter(p.variable(one)) for one in ("wheel_radius", "wheelset_pitch_inertia"))
    text = "Brake torque by the measured pressure"
    system.output(Variable("brake_torque", "output", "N.m", text), torque * pressure / machine.full_pressure)
    # A sensor shows 0 where a wheel creeps or stands: there nothing pulls.
    pull = ca.if_else(speed > 0, rate * inertia * (speed / radius - turning), 0)
    system.output(Variable("traction_torque", "output", "N.m", "Torque that pulls to the measured speed"), pull)
    return system

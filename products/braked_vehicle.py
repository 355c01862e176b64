"""BrakedVehicle: a complete vehicle and the brake cylinders of its wheelsets as one FMU, without a coupling's error."""

from collections.abc import Callable, Sequence
from dataclasses import replace

from brake_controller.cylinder import timed_brake
from brake_controller.parameters import BrakeParameters, qr30
from fmu_src.compose import compose, scope
from fmu_src.system import Model, System, Variable, model_of_choices
from rbd_model.levels.models import CHOICE, DEFAULT_TOLERANCE, LEVELS, choice_of, selectors, system_at
from rbd_model.vehicle.description import Vehicle, relations_of
from rbd_model.vehicle.ready import passenger_coach

#: Pressure [Pa] and torque capacity of one wheelset [N.m] of the coach's full brake, which slows it at 1.2 m/s2; times
#: of its cylinder with a dump valve [s]. Assumed: the benchmark prints no brake.
FULL_PRESSURE, FULL_TORQUE = 380e3, 6.4e3
APPLICATION_TIME, RELEASE_TIME = 2.0, 0.6
#: Numbers of its systems, those of a vehicle on level track.
PLACES = tuple(sorted(set(CHOICE)))


def coach_brake() -> BrakeParameters:
    """The brake of one wheelset of the coach."""
    return brake_of(passenger_coach(), FULL_TORQUE)


def brake_of(vehicle: Vehicle, full_torque: float) -> BrakeParameters:
    """A brake of one wheelset: rigging and shoes of `qr30` scaled to a torque at full pressure [N.m]. Assumed."""
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


def with_brakes(system: System, vehicle: Vehicle, brake: Callable[[], System]) -> System:
    """A vehicle at one level of detail with a brake on each wheelset; all brakes have the same parameters."""
    return on_each_wheelset(system, vehicle, brake, "brake_torque")


def on_each_wheelset(system: System, vehicle: Vehicle, make: Callable[[], System], torque: str) -> System:
    """The same with a brake, or a motor, that makes a torque of its `angular_velocity`; all have the same parameters.

    torque: that output, and the input of the vehicle that it becomes.
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


def braked_vehicle(
    vehicle: Vehicle | None = None, brake: BrakeParameters | None = None, places: Sequence[int] = PLACES
) -> Model:
    """Pressure demands and valves in; speed, wheel speeds and pressures out; by default the coach, its brake timed.

    places: which of the systems it has; those that it lacks cannot be chosen.
    """
    whole, cylinder = vehicle or passenger_coach(), brake or coach_brake()
    systems = tuple(with_brakes(system_at(whole, place), whole, lambda: timed_brake(cylinder)) for place in places)
    text = "Four-axle railway vehicle with a brake cylinder on each wheelset: pressure in, speed and slip out"
    parameters = {name for system in systems for name in system.parameter_symbols}
    return model_of_choices(
        "BrakedVehicle",
        text,
        systems,
        selectors(),
        choice_of(places, len(LEVELS), on_line=False),
        DEFAULT_TOLERANCE,
        relations=relations_of(whole, parameters),
        stop_time=25.0,
    )

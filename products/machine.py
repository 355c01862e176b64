"""A machine and the cylinders of its wheelsets as one system, for the test rig."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from pathlib import Path

import numpy as np

from brake_controller.cylinder import alone, reservoir_brake, timed_brake, treads
from brake_controller.discs import MEAN_PAD_FRICTION, axle_discs, discs
from brake_controller.flow_parameters import FlowParameters
from brake_controller.magnet_valves import common_valves
from brake_controller.motors import dynamic_brake, motor_of, traction_motor
from brake_controller.ready_sets import qr30_experiment
from brake_controller.reservoir import ReservoirParameters, air_reservoir
from brake_controller.timing import filling_time, with_application_time, with_release_time
from fmu_src.batch import BatchLibrary
from fmu_src.compile import build_library
from fmu_src.compose import compose, renamed
from fmu_src.kernel import Library
from fmu_src.system import Model, System, model_of
from products.braked_vehicle import brake_of, on_each_wheelset, with_brakes
from products.protection.braked_machine import APPLICATION_TIME, RELEASE_TIME, Machine, bogie, coach
from products.protection.protected_stop import CYLINDER_VOLUME
from products.protection.runs import DISCS, DYNAMIC_BRAKE, SANDERS, TRACTION
from products.remembered import noted_path
from rbd_model.levels.models import DEFAULT_TOLERANCE, places_of, system_at
from rbd_model.track.sand import sanders
from rbd_model.vehicle.description import Vehicle
from rbd_model.vehicle.ready import passenger_coach, two_axle_bogie

#: Assumed: 100 l a bogie at 5 bar, fed from a pipe of 5 bar through 3 mm.
RESERVOIR_OF_A_BOGIE, RESERVOIR_PRESSURE, FEED_ORIFICE = 0.1, 500e3, 3e-3
#: Numbers of the systems by level; in space with contacts that yield.
PLACES = {2: places_of(level=2, on_line=False)[0], 3: places_of(level=3, depth=2, on_line=False)[0]}
#: Volume of a cylinder [m3], as that of the timed law; the exponent of its air, as fast as that of the experiment.
EXPONENT = 1.2


@dataclass(frozen=True)
class Kind:
    """Which equations of a machine. counted: frame, the bogie; body, the coach. level: 2 in the plane, 3 in space.

    by_flow: cylinders are filled by flow of air from a reservoir, through valves that take their time; else timed.
    equipment: what else it has, as `Run` has it. Raises ValueError for another level, and for what is not together.
    """

    counted: str
    by_flow: bool = False
    level: int = 2
    equipment: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if self.level not in PLACES:
            raise ValueError(f"Set level to 2 (in the plane) or 3 (in space) on the test rig: it was {self.level}.")
        if self.equipment and not (self.by_flow or TRACTION in self.equipment):
            raise ValueError(f"Fill cylinders by flow of air on a machine with {' and '.join(self.equipment)}.")


@lru_cache
def machine_model(kind: Kind) -> Model:
    """The machine with a cylinder, or with traction a motor, on each wheelset, one system."""
    machine = bogie() if kind.counted == "frame" else coach()
    vehicle = two_axle_bogie() if kind.counted == "frame" else passenger_coach()
    system = system_at(vehicle, PLACES[kind.level])
    if SANDERS in kind.equipment:
        system = on_sand(system, vehicle)
    if TRACTION in kind.equipment:
        motor = motor_of(machine.full_torque, machine.parameters.wheel_radius)
        whole = on_each_wheelset(system, vehicle, lambda: traction_motor(motor), "traction_torque")
    elif kind.by_flow:
        whole = with_reservoir(system, vehicle, machine, kind)
    else:
        brake = brake_of(vehicle, machine.full_torque)
        whole = with_brakes(system, vehicle, lambda: timed_brake(brake))
    return model_of(whole, DEFAULT_TOLERANCE)


@lru_cache
def machine_library(kind: Kind) -> BatchLibrary:
    """Its equations compiled, many machines side by side."""
    model = machine_model(kind)
    return BatchLibrary(model, model.systems[0], kept=partial(machine_file, kind))


@lru_cache
def machine_kernel(kind: Kind) -> Library:
    """Its equations compiled, one machine."""
    return Library(machine_file(kind, "kernel", lambda: build_library(machine_model(kind))))


def machine_file(kind: Kind, what: str, make: Callable[[], Path]) -> Path:
    """A file of this machine, known without writing its equations anew while the sources are the same."""
    return noted_path(f"{what} of the rig's {kind}", make)


def on_sand(system: System, vehicle: Vehicle) -> System:
    """A vehicle with a sander ahead of each wheelset, whose friction is that of the rail with their sand."""
    places = {number: vehicle.number(one.along) for number, one in vehicle.numbered}
    own = {f"friction_{number}": f"friction_with_sand_{number}" for number in places}
    given = {inside: f"sanded_{name}" for name, inside in own.items()} | {"speed": "speed"}
    return compose(system.name, system.description, [renamed(system, own), sanders(list(places.values()))], given)


def with_reservoir(system: System, vehicle: Vehicle, machine: Machine, kind: Kind) -> System:
    """A vehicle with a cylinder on each wheelset, with what else brakes it, and one reservoir for all."""
    air, numbers, full = cylinder_air(machine.full_pressure), machine.numbers, machine.full_torque
    brake, rubbing = brake_of(vehicle, full), treads()
    if DISCS in kind.equipment:
        disc = axle_discs()
        on_treads = brake.constant_shoe_friction * brake.wheel_radius
        same = brake.force_per_pressure * on_treads / (MEAN_PAD_FRICTION * disc.friction_radius)
        brake, rubbing = replace(brake, force_per_pressure=same), discs(disc)
    motor = motor_of(full, machine.parameters.wheel_radius)
    blending = dynamic_brake(motor, machine.full_pressure, full) if DYNAMIC_BRAKE in kind.equipment else alone
    braked = with_brakes(system, vehicle, lambda: reservoir_brake(brake, air, common_valves(), rubbing, blending))
    reservoir = air_reservoir(
        reservoir_of(len(numbers)), air.variable("ambient_pressure"), air.variable("air_temperature"), len(numbers)
    )
    taken = {f"air_flow_{number}": f"air_flow_{number}" for number in numbers}
    given = {f"reservoir_pressure_{number}": "reservoir_pressure" for number in numbers}
    return compose(system.name, system.description, [braked, reservoir], taken | given)


@lru_cache
def cylinder_air(full_pressure: float, application_time: float = APPLICATION_TIME) -> FlowParameters:
    """Air of a cylinder of constant volume whose full brake [Pa] comes and goes in the times of the timed law [s]."""
    experiment = qr30_experiment().flow
    flow = replace(experiment, dead_volume=CYLINDER_VOLUME, polytropic_exponent=EXPONENT)
    flow = with_application_time(flow, full_pressure, application_time)
    return with_release_time(flow, full_pressure, RELEASE_TIME)


@lru_cache
def filling_by_flow(full_pressure: float, application_time: float) -> Callable[[float], float]:
    """Share of the full pressure so long after the demand [s], from empty, with all the air that it asks for."""
    air, shares = cylinder_air(full_pressure, application_time), np.linspace(0.0, 0.999, 200)
    times = [filling_time(air, full_pressure, share * full_pressure) for share in shares.tolist()]
    return lambda since: float(np.interp(since, times, shares))


def reservoir_of(wheelsets: int) -> ReservoirParameters:
    """A reservoir for so many wheelsets. Assumed."""
    return ReservoirParameters(
        reservoir_volume=RESERVOIR_OF_A_BOGIE * wheelsets / 2,
        initial_reservoir_pressure=RESERVOIR_PRESSURE,
        feed_pressure=RESERVOIR_PRESSURE,
        feed_orifice=FEED_ORIFICE,
    )

"""A machine and the cylinders of its wheelsets as one system, for the test rig."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from pathlib import Path

import numpy as np

from brake_controller.cylinder import reservoir_brake, timed_brake
from brake_controller.flow_parameters import FlowParameters
from brake_controller.magnet_valves import common_valves
from brake_controller.parameters import BrakeParameters
from brake_controller.ready_sets import qr30_experiment
from brake_controller.reservoir import ReservoirParameters, air_reservoir
from brake_controller.timing import filling_time, with_application_time, with_release_time
from fmu_src.batch import BatchLibrary
from fmu_src.compile import build_library
from fmu_src.compose import compose
from fmu_src.kernel import Library
from fmu_src.system import Model, System, model_of
from products.braked_vehicle import brake_of, with_brakes
from products.protection.braked_machine import APPLICATION_TIME, RELEASE_TIME, Machine, bogie, coach
from products.protection.protected_stop import CYLINDER_VOLUME
from products.remembered import noted_path
from rbd_model.levels.models import DEFAULT_TOLERANCE, places_of, system_at
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
    """

    counted: str
    by_flow: bool = False
    level: int = 2


@lru_cache
def machine_model(kind: Kind) -> Model:
    """The machine with a cylinder on each wheelset, one system. Raises ValueError for another level."""
    if kind.level not in PLACES:
        raise ValueError(f"Set level to 2 (in the plane) or 3 (in space) on the test rig: it was {kind.level}.")
    machine = bogie() if kind.counted == "frame" else coach()
    vehicle = two_axle_bogie() if kind.counted == "frame" else passenger_coach()
    brake, system = brake_of(vehicle, machine.full_torque), system_at(vehicle, PLACES[kind.level])
    if kind.by_flow:
        return model_of(with_reservoir(system, vehicle, brake, machine), DEFAULT_TOLERANCE)
    return model_of(with_brakes(system, vehicle, lambda: timed_brake(brake)), DEFAULT_TOLERANCE)


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


def with_reservoir(system: System, vehicle: Vehicle, brake: BrakeParameters, machine: Machine) -> System:
    """A vehicle with a cylinder on each wheelset and one reservoir for all."""
    air, numbers = cylinder_air(machine.full_pressure), machine.numbers
    braked = with_brakes(system, vehicle, lambda: reservoir_brake(brake, air, common_valves()))
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

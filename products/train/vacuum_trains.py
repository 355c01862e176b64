"""Trains whose pipe holds a vacuum: their brakes in the columns of a consist, both ways, and their valves and pipes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from brake_controller.distributors import kind_of, pneumatic
from brake_controller.distributors.vacuum import STROKE, VacuumBrake, fill_time, vacuum_brake
from brake_controller.vacuum_valve import PIPE, VacuumValve, vacuum_valve
from products.train.consist import Consist, TrainVehicle
from products.train.consist_columns import si
from products.train.notches import check_handle

#: Columns of a driver's valve of a vacuum.
OF_VALVE = ("exhauster", "ejector")
#: Columns that a vacuum excludes, and remedies: pressures of an air pipe, and air that supplies a driver's valve.
OF_AIR = {
    "traction_cut_out": "Use the inputs",
    "track_brake_pressure": "Use the inputs",
    "main_reservoir": "Add direct_pressure",
}


def vacuum_of(vehicles: Sequence[TrainVehicle]) -> float:
    """Return the vacuum of a train's charged pipe [Pa], 0 if it holds air. Raises ValueError for a mixed train."""
    vacuums: dict[float, int] = {}
    fed: dict[bool, int] = {}
    for number, vehicle in enumerate(vehicles, 1):
        kind = kind_of(vehicle.distributor)
        if isinstance(vehicle.distributor, VacuumBrake):
            vacuums.setdefault(vehicle.distributor.vacuum, number)
        if kind.name in pneumatic():
            fed.setdefault(kind.vacuum, number)
    if len(fed) > 1:
        name = kind_of(vehicles[fed[False] - 1].distributor).name
        raise ValueError(
            f"The pipe of a train must hold either air or a vacuum; got distributor = {name} of vehicle {fed[False]}, "
            f"and vacuum of vehicle {fed[True]}. Give both one kind, or brake = none to one that only carries the pipe."
        )
    if len(vacuums) > 1:
        (one, first), (other, second), *_ = vacuums.items()
        raise ValueError(
            f"vacuum must be one number for a train; got {1e-5 * one:.4g} bar of vehicle {first} and "
            f"{1e-5 * other:.4g} bar of vehicle {second}. Give it to all, as it is 0.7111 bar where it is left out."
        )
    return next(iter(vacuums), 0.0)


def check_valves(consist: Consist) -> None:
    """Check that all driver's valves hold what the brakes need. Raises ValueError."""
    vacuum = vacuum_of(consist.vehicles)
    for number, vehicle in enumerate(consist.vehicles, 1):
        own = vehicle.valve.vacuum if isinstance(vehicle.valve, VacuumValve) else 0.0
        if vehicle.valve is not None and own != vacuum:
            raise ValueError(
                f"The driver's valve of vehicle {number} must hold {1e-5 * vacuum:.4g} bar of vacuum, as brakes do; "
                f"got {1e-5 * own:.4g} bar. Take vacuum_valve, or drivers_valve for air."
            )


def with_vacuum(vehicles: Sequence[TrainVehicle], rows: Sequence[Mapping[str, Any]]) -> list[TrainVehicle]:
    """Return vehicles with valves and pipes for a vacuum if a brake has one; rows: values of the row of each.

    Raises ValueError for a mixed train, and for values without an effect.
    """
    vacuum = vacuum_of(vehicles)
    without = OF_AIR if vacuum else dict.fromkeys(OF_VALVE, "Add it")
    where = "with a vacuum in the pipe" if vacuum else "without distributor = vacuum"
    for number, values in enumerate(rows, 1):
        used = {"main_reservoir"} if "direct_pressure" in values else set[str]()
        for column in (one for one in without if values.get(one) and one not in used):
            text = f"{where}. {without[column]}, or leave {column} out."
            raise ValueError(f"{column} of vehicle {number} has no effect {text}")
    found = list(vehicles)
    if vacuum:
        found = [_evacuated(vehicle, values, vacuum) for vehicle, values in zip(vehicles, rows, strict=True)]
    for vehicle in found:
        if vehicle.handle and vehicle.valve is not None:
            check_handle(vehicle.handle, vehicle.valve)
    return found


def _evacuated(train_vehicle: TrainVehicle, values: Mapping[str, Any], vacuum: float) -> TrainVehicle:
    """Return a vehicle of a train whose pipe holds a vacuum [Pa]: the pipe ends neither traction nor track braking."""
    usual, valve = vacuum_valve(vacuum), train_vehicle.valve
    if valve is not None:
        area = math.pi / 4 * si(values, "exhaust") ** 2 if "exhaust" in values else usual.exhaust_area
        valve = replace(
            usual,
            exhauster=si(values, "exhauster", usual.exhauster),
            ejector=si(values, "ejector", usual.ejector),
            exhaust_area=area,
            service_rate=si(values, "service_rate", usual.service_rate),
        )
    return replace(
        train_vehicle,
        valve=valve,
        pipe_diameter=si(values, "pipe_diameter", PIPE),
        traction=replace(train_vehicle.traction, traction_cut_out=0.0),
        track=replace(train_vehicle.track, applied_below=0.0),
    )


def brake_of_row(values: Mapping[str, Any]) -> VacuumBrake:
    """Return the vacuum brake of a row; cylinders of a stated diameter sweep their area times 4.5 inches."""
    usual = vacuum_brake()
    by_diameter = values.get("cylinders", 1.0) * math.pi / 4 * si(values, "cylinder_diameter") ** 2 * STROKE
    return vacuum_brake(
        si(values, "vacuum", usual.vacuum),
        si(values, "auxiliary", usual.chamber_volume),
        si(values, "cylinder", by_diameter or usual.swept_volume),
        values.get("fill_time"),
        values.get("direct_admission") == "yes",
    )


def row_of_vacuum(own: VacuumBrake) -> dict[str, Any]:
    """Return the columns of a vacuum brake."""
    volumes = {"auxiliary": 1e3 * own.chamber_volume, "cylinder": 1e3 * own.swept_volume}
    admission = {"direct_admission": "yes"} if own.direct_admission else {}
    return {"vacuum": 1e-5 * own.vacuum} | volumes | {"fill_time": fill_time(own)} | admission


def row_of_valve(valve: VacuumValve) -> dict[str, Any]:
    """Return the columns of a driver's valve that are not those of every vacuum."""
    usual = vacuum_valve(valve.vacuum)
    row: dict[str, Any] = {name: 60.0 * getattr(valve, name) for name in OF_VALVE}
    if valve.service_rate != usual.service_rate:
        row["service_rate"] = 1e-5 * valve.service_rate
    if valve.exhaust_area != usual.exhaust_area:
        row["exhaust"] = 1e3 * (4 / math.pi * valve.exhaust_area) ** 0.5
    return row

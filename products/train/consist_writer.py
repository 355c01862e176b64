"""Consists as files: rows of columns, or the rows that state a consist of vehicles."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import replace
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np

from products.train.consist import Consist, TrainVehicle
from products.train.consist_columns import NAMES, NUMBERS, values_of
from products.train.consist_file import consist_of
from products.train.consist_row import Row, row_of
from products.train.coupler_tables import TABLE_NAMES, couplers_of, table_of
from products.train.layout import UNBREAKABLE
from rbd_model.train.adhesion import ADHESIONS
from rbd_model.train.coupler import COUPLERS, Coupler, screw_coupler
from readers.storage import write_whole

#: Relative difference of numbers that are equal: rounding of a column's unit.
ROUNDING = 1e-9


def write_consist(what: Consist | Iterable[Mapping[str, Any]], path: str | Path) -> None:
    """Write a consist to a file, TOML where its name ends so, otherwise CSV with commas."""
    couplers = coupler_tables_of(what) if isinstance(what, Consist) else []
    rows = rows_of(what) if isinstance(what, Consist) else [values_of(row) for row in what]
    consist_of(rows, couplers=couplers_of(couplers, "the consist"))
    place = Path(path)
    if couplers and place.suffix.lower() != ".toml":
        raise ValueError(f"{place} must end in .toml, as its couplers are tables; got {place.suffix!r}. Rename it.")
    text = toml_of_rows(rows, couplers) if place.suffix.lower() == ".toml" else _csv(rows)
    write_whole(place, text.encode())


def _number(name: str, value: Any) -> str:
    return str(int(value)) if NUMBERS[name].whole else repr(float(value))


def toml_of_rows(rows: Iterable[Mapping[str, Any]], couplers: Iterable[Mapping[str, Any]] = ()) -> str:
    """Return rows as TOML after their [[coupler]] tables, numbers with all digits."""
    parts = []
    for table in couplers:
        lines = [f"{name} = {json.dumps(table[name], ensure_ascii=False)}" for name in TABLE_NAMES if name in table]
        parts.append("\n".join(["[[coupler]]", *lines]) + "\n")
    for row in rows:
        lines = [
            f"{name} = {_number(name, row[name]) if name in NUMBERS else json.dumps(row[name], ensure_ascii=False)}"
            for name in NAMES
            if name in row
        ]
        parts.append("\n".join(["[[vehicle]]", *lines]) + "\n")
    return "\n".join(parts)


def _csv(rows: list[Row]) -> str:
    """Return rows as CSV, with the columns that any of them has."""
    names = [name for name in NAMES if any(name in row for row in rows)]
    units = {name: f" [{NUMBERS[name].unit}]" for name in names if name in NUMBERS and NUMBERS[name].unit != "1"}
    lines = [",".join(f"{name}{units.get(name, '')}" for name in names)]
    for row in rows:
        cells = ("" if name not in row else _cell(name, row[name]) for name in names)
        lines.append(",".join(cells))
    return "\n".join(lines) + "\n"


def _cell(name: str, value: Any) -> str:
    if name in NUMBERS:
        return _number(name, value)
    quote = '"'
    return f'"{value.replace(quote, 2 * quote)}"' if name in ("name", "protection") and value else str(value)


def coupler_tables_of(consist: Consist) -> list[dict[str, Any]]:
    """Return the [[coupler]] tables of a consist: of couplers that are neither built-in nor numbers of a row."""
    found: dict[str, Coupler] = {}
    for one in consist.vehicles[:-1]:
        name = one.coupler.name
        if name not in COUPLERS and found.setdefault(name, one.coupler) != one.coupler:
            raise ValueError(f"Couplers of a consist must have names of their own; got {name!r} twice. Rename one.")
    return [table_of(one) for one in found.values()]


def rows_of(consist: Consist) -> list[Row]:
    """Return the rows that state a consist."""
    rows = []
    *ahead, last = consist.vehicles
    if last.coupler.name not in {*COUPLERS, *(one.coupler.name for one in ahead)}:
        last = replace(last, coupler=screw_coupler())  # nothing is behind it
    consist = Consist((*ahead, last))
    for one, several in groupby(consist.vehicles):
        row, count = row_of(one), len(list(several))
        rows.append(row | ({"count": count} if count > 1 else {}))
    found = consist_of(rows, couplers=couplers_of(coupler_tables_of(consist), "the consist")).vehicles
    for number, (one, again) in enumerate(zip(consist.vehicles, found, strict=True), 1):
        own, other = _numbers(one), _numbers(again)
        off = [name for name in own if not np.allclose(own[name], other.get(name, math.nan), rtol=ROUNDING, atol=1e-15)]
        if off or type(one.distributor) is not type(again.distributor):
            name = off[0] if off else "distributor"
            raise ValueError(f"vehicle {number} must have values that columns state; its {name} has none. Change it.")
    return rows


def _numbers(train_vehicle: TrainVehicle) -> dict[str, Any]:
    """Return the numbers of a vehicle by name, forces of the brake after its losses."""
    brake = train_vehicle.brake.values()
    lost = brake.pop("efficiency")
    brake |= {name: lost * brake[name] for name in ("force_per_pressure", "counter_force")}
    brake.pop("shoes")
    own = {
        "length": train_vehicle.length,
        "at": train_vehicle.distributor_at,
        "leak": train_vehicle.leak,
        "branch": train_vehicle.branch,
    }
    own |= {
        "pipe_diameter": train_vehicle.pipe_diameter,
        "valve_delay": train_vehicle.valve_delay,
        "braked_share": train_vehicle.braked_share,
    }
    valve = (
        list(train_vehicle.valve.numbers(0, 0.0, train_vehicle.valve_delay).values()) if train_vehicle.valve else [0.0]
    )
    own |= (
        train_vehicle.electric.values()
        | train_vehicle.heat.values()
        | train_vehicle.track.values()
        | train_vehicle.parking.values()
        | train_vehicle.direct.values()
        | train_vehicle.main_reservoir.values()
        | train_vehicle.vigilance.values()
    )
    own |= {f"protection: {name}": value for name, value in train_vehicle.protection.values().items()}
    own["adhesion"] = ADHESIONS[train_vehicle.adhesion]
    own |= {f"traction: {name}": value for name, value in train_vehicle.traction.values().items()}
    own["coupler_strength"] = min(train_vehicle.coupler.strength, UNBREAKABLE)
    return (
        brake
        | own
        | {"valve": valve}
        | train_vehicle.motion()
        | train_vehicle.distributor.values()
        | train_vehicle.coupler.values()
    )

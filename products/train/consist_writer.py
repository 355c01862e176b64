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

from brake_controller.air import DISCHARGE
from brake_controller.distributors import kind_of
from brake_controller.distributors.aar import RETAINERS, AarValve, FreightCar, retaining, slow_exhaust
from brake_controller.distributors.aar import release_time as release_time_of_car
from brake_controller.distributors.ecp import EcpValve
from brake_controller.distributors.ecp import fill_time as fill_time_of_ecp
from brake_controller.distributors.ep_direct import RELEASED, EpDirect
from brake_controller.distributors.piped import Piped
from brake_controller.distributors.registered import POSITIONS
from brake_controller.distributors.uic import UicDistributor, filling_time, release_time
from brake_controller.drivers_valve import drivers_valve
from brake_controller.shoe_friction import KILOMETRES_PER_HOUR
from brake_controller.vehicle_brake import FORCELESS, FRACTIONS, FRICTIONS, TABLE, VehicleBrake, points_of
from products.train.columns import NAMES, NUMBERS, WHOLE
from products.train.consist import Consist, TrainVehicle
from products.train.consist_file import consist_of
from products.train.coupler_tables import TABLE_NAMES, couplers_of, table_of
from products.train.layout import UNBREAKABLE
from products.train.stated import PAD_RADIUS
from products.train.stated_drive import row_of_electric, row_of_traction, table_as_text
from products.train.stated_extra import row_of_extra
from products.train.stated_heat import row_of_heat
from rbd_model.train.adhesion import ADHESIONS
from rbd_model.train.coupler import COUPLERS, Coupler, screw_coupler
from readers.storage import write_whole

#: Diameters of cylinders by which a brake without a stated cylinder is written [mm].
DIAMETERS = (406.0, 150.0, 1000.0, 50.0)
#: Relative difference of numbers that are equal: rounding of a column's unit.
ROUNDING = 1e-9

Row = dict[str, Any]


def write_consist(what: Consist | Iterable[Mapping[str, Any]], path: str | Path) -> None:
    """Write a consist to a file, TOML where its name ends so, otherwise CSV with commas."""
    couplers = coupler_tables_of(what) if isinstance(what, Consist) else []
    rows = rows_of(what) if isinstance(what, Consist) else [dict(row) for row in what]
    consist_of(rows, couplers=couplers_of(couplers, "the consist"))
    place = Path(path)
    if couplers and place.suffix.lower() != ".toml":
        raise ValueError(f"{place} must end in .toml, as its couplers are tables; got {place.suffix!r}. Rename it.")
    text = toml_of_rows(rows, couplers) if place.suffix.lower() == ".toml" else _csv(rows)
    write_whole(place, text.encode())


def _number(name: str, value: Any) -> str:
    return str(int(value)) if name in WHOLE else repr(float(value))


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
    units = {name: f" [{NUMBERS[name][0]}]" for name in names if name in NUMBERS and NUMBERS[name][0] != "1"}
    lines = [",".join(f"{name}{units.get(name, '')}" for name in names)]
    for row in rows:
        cells = ("" if name not in row else _cell(name, row[name]) for name in names)
        lines.append(",".join(cells))
    return "\n".join(lines) + "\n"


def _cell(name: str, value: Any) -> str:
    if name in NUMBERS:
        return _number(name, value)
    quote = '"'
    return f'"{value.replace(quote, 2 * quote)}"' if name == "name" and value else str(value)


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


def _numbers(one: TrainVehicle) -> dict[str, Any]:
    """Return the numbers of a vehicle by name, forces of the brake after its losses."""
    brake = one.brake.values()
    lost = brake.pop("efficiency")
    brake |= {name: lost * brake[name] for name in ("force_per_pressure", "counter_force")}
    brake.pop("shoes")
    own = {"length": one.length, "at": one.distributor_at, "leak": one.leak, "branch": one.branch}
    own |= {"pipe_diameter": one.pipe_diameter, "valve_delay": one.valve_delay, "braked_share": one.braked_share}
    valve = list(one.valve.numbers(0, 0.0, one.valve_delay).values()) if one.valve else [0.0]
    own |= one.electric.values() | one.heat.values() | one.track.values() | one.parking.values()
    own["adhesion"] = ADHESIONS[one.adhesion]
    own |= {f"traction: {name}": value for name, value in one.traction.values().items()}
    own["coupler_strength"] = min(one.coupler.strength, UNBREAKABLE)
    return brake | own | {"valve": valve} | one.motion() | one.distributor.values() | one.coupler.values()


def row_of(one: TrainVehicle) -> Row:
    """Return the row that states a vehicle, as near as columns can."""
    a, b, c = one.resistance
    row: Row = {"kind": one.kind} | ({"name": one.name} if one.name else {})
    row |= {"mass": 1e-3 * one.mass, "length": one.length, "rotating": 1e2 * one.rotating_share}
    row |= {"resistance_a": a, "resistance_b": b, "resistance_c": c}
    row |= _brake(one) | _distributor(one)
    row |= row_of_electric(one.electric) | row_of_traction(one.traction)
    row |= row_of_heat(one.heat) | row_of_extra(one.track, one.parking)
    row |= {} if one.adhesion == "input" else {"adhesion": one.adhesion}
    if one.friction_ratio != 1.0:
        row |= {"friction_ratio": one.friction_ratio, "friction_decay": one.friction_decay}
    row |= {"pipe_diameter": 1e3 * one.pipe_diameter, "at": one.distributor_at}
    if one.leak:
        row["leak"] = 1e3 * (4 / math.pi * one.leak / DISCHARGE) ** 0.5
    if one.branch:
        row["branch"] = 1e3 * one.branch
    row |= _coupler(one.coupler)
    return row | _valve(one)


def _coupler(one: Coupler) -> Row:
    """Return the columns of a coupler: a built-in one, one with a stiffness of its own, or the name of a table."""
    strength = {} if math.isinf(one.strength) else {"coupler_strength": 1e-3 * one.strength}
    name = one.name
    if name not in COUPLERS:
        return {"coupler": name}
    if replace(one, strength=math.inf) == COUPLERS[name]():
        return {"coupler": name} | strength
    loading, unloading = one.compression
    ways, forces = loading.ways, loading.forces
    slack = max(way for way, force in zip(ways, forces, strict=True) if force == 0.0) if forces[0] == 0.0 else 0.0
    preload = forces[-2]
    stiffness = (forces[-1] - forces[-2]) / (ways[-1] - ways[-2])
    row: Row = {"coupler": name, "coupler_stiffness": 1e-6 * stiffness, "coupler_preload": 1e-3 * preload}
    row |= {"coupler_slack": 1e3 * slack}
    damping = round(1.0 - unloading.forces[-1] / forces[-1], 12)
    return row | ({"coupler_damping": damping} if one.dissipates or not damping else {}) | strength


def _valve(one: TrainVehicle) -> Row:
    if one.valve is None:
        return {"valve": "none"} if one.kind == "locomotive" else {}
    row: Row = {"valve": "head"} if one.valve_delay < 0.0 else {"valve": "second", "delay": one.valve_delay}
    usual = drivers_valve()
    if one.valve.service_rate != usual.service_rate:
        row["service_rate"] = 1e-5 * one.valve.service_rate
    if one.valve.exhaust_area != usual.exhaust_area:
        row["exhaust"] = 1e3 * (4 / math.pi * one.valve.exhaust_area) ** 0.5
    return row


def _distributor(one: TrainVehicle) -> Row:
    """Return the columns of a distributor: a built-in one by its name and position, or one of UIC with its times."""
    own = one.distributor
    if isinstance(own, Piped):
        return {"brake": "none"}
    if isinstance(own, EpDirect):
        fill, release = 0.95 * own.full_pressure / own.filling_rate, (own.full_pressure - RELEASED) / own.release_rate
        times = {"fill_time": fill, "release_time": release}
        return {"brake": "ep-direct", "full_pressure": 1e-5 * own.full_pressure} | times
    kind = kind_of(own)
    named: Row = {} if kind.name == "uic" else {"distributor": kind.name}
    if isinstance(own, FreightCar):
        return named | (_aar_valve(own) if isinstance(own, AarValve) else {}) | _times_of_car(own)
    ready = {position: kind.ready(position) for position in POSITIONS}
    for position, usual in ready.items():
        if usual == own:
            return named | ({} if ready["P"] == ready["G"] else {"position": position})
    if not isinstance(own, UicDistributor):
        return named | ({"full_pressure": 1e-5 * own.full_pressure} if "full_pressure" in kind.adjustable else {})
    volumes = {"auxiliary": 1e3 * own.auxiliary_volume, "cylinder": 1e3 * own.cylinder_volume}
    times = {"fill_time": filling_time(own, 0.95 * own.full_pressure), "release_time": release_time(own)}
    row = {"full_pressure": 1e-5 * own.full_pressure} | volumes | times
    return named | {name: value for name, value in row.items() if name in kind.adjustable}


def _times_of_car(own: FreightCar) -> Row:
    """Return the times of an AAR or ECP valve that are not those of its kind."""
    plain, row = kind_of(own).ready("P"), {}
    if own.release_choke not in (getattr(plain, "release_choke", 0.0), slow_exhaust()):
        row["release_time"] = release_time_of_car(own)
    if isinstance(own, EcpValve) and own.service_choke != getattr(plain, "service_choke", 0.0):
        row["fill_time"] = fill_time_of_ecp(own)
    return row


def _aar_valve(own: AarValve) -> Row:
    """Return the columns of the retainer, release and empty/load device of a control valve."""
    row: Row = {"accelerated_release": "no"} if own.accelerated_choke == 0.0 else {}
    row |= {"empty_load": own.empty_share} if own.empty_share < 1.0 else {}
    found = [one for one in RETAINERS[1:] if replace(own, **retaining(one)) == own]
    return row | ({"retainer": found[0]} if found else {})


def _friction(one: VehicleBrake) -> Row:
    """Return the columns of a brake's friction."""
    if one.friction_law == FRACTIONS and one.friction_force_added == one.friction_force_divisor:
        standing = one.friction_scale * one.friction_speed_added / one.friction_speed_divisor
        half = KILOMETRES_PER_HOUR * one.friction_speed_divisor
        own = {"friction_value": standing, "friction_fast": one.friction_scale, "friction_speed": half}
        return {"friction": "speed"} | own
    if one.friction_law == TABLE:
        return {"friction": "table", "friction_table": table_as_text(*points_of(one.values()))}
    scaled = one.friction_scale / FRICTIONS["pads"]["friction_scale"]
    for name, law in {**FRICTIONS, **FORCELESS}.items():
        pads = {"friction_scale": law["friction_scale"] * scaled} if name == "pads" else {}
        if replace(one, **(dict(law) | pads)) != one:
            continue
        if name == "pads":
            return {"friction": name, "shoes": one.shoes} | (
                {} if scaled == PAD_RADIUS else {"friction_radius": scaled}
            )
        more = {"shoes": one.shoes} if name in FRICTIONS else {}
        return {"friction": name} | more | ({"friction_value": one.constant_friction} if name == "constant" else {})
    return {}


def _brake(one: TrainVehicle) -> Row:
    """Return the columns of a brake: force of the shoes, or cylinder data if springs draw these back."""
    own, friction = one.brake, _friction(one.brake)
    if isinstance(one.distributor, Piped):
        return {}
    by_cylinder = isinstance(one.distributor, AarValve) and one.distributor.empty_share < 1.0
    if own.counter_force == 0.0 and not by_cylinder:
        force = own.force_per_pressure * own.efficiency * one.distributor.full_pressure
        return {"shoe_force": 1e-3 * force} | friction
    ratios = {d: own.force_per_pressure / (math.pi / 4 * (1e-3 * d) ** 2) for d in DIAMETERS}
    diameter, ratio = next(
        ((d, i) for d, i in ratios.items() if 0.2 <= i <= 40.0), (DIAMETERS[0], ratios[DIAMETERS[0]])
    )
    data = {"cylinder_diameter": diameter, "rigging_ratio": ratio, "rigging_efficiency": own.efficiency}
    return data | {"return_force": own.counter_force / ratio} | friction

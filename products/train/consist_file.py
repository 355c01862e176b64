"""Consists from files: CSV with a row for each kind of vehicle in turn, or TOML with a [[vehicle]] for each.

The columns are those of `consist_columns.py`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from products.train.consist import Consist, TrainVehicle
from products.train.consist_columns import MOST, columns
from products.train.consist_row import vehicle_of
from products.train.coupler_tables import couplers_of
from products.train.layout import MOST_VALVES
from products.train.row_statements import assumed_brakes
from products.train.vacuum_trains import with_vacuum
from rbd_model.train.coupler import Coupler
from readers.tables import read_table
from readers.text import quoted
from readers.toml_files import toml_of


def read_consist(path: Path) -> Consist:
    """Return the consist in a file, TOML where its name ends so, otherwise a table."""
    if path.suffix.lower() == ".toml":
        rows, couplers = _rows_of_toml(path)
        places = [f"vehicle {number}" for number in range(1, len(rows) + 1)]
        return _beside(consist_of(_of_folder(rows, path.parent), str(path), places, couplers), path.parent)
    table = read_table(path, columns(), most_rows=MOST)
    rows = []
    for row in range(table.places.size):
        numbers = {name: float(values[row]) for name, values in table.numbers.items() if not math.isnan(values[row])}
        rows.append({name: values[row] for name, values in table.words.items() if values[row]} | numbers)
    consist = consist_of(_of_folder(rows, path.parent), str(path), [f"row {place}" for place in table.places])
    return _beside(replace(consist, notes=(*table.meant, *consist.notes)), path.parent)


def _beside(consist: Consist, folder: Path) -> Consist:
    """Return a consist whose files of controllers are found from the folder of its own file."""
    named = [(one, one.controller) for one in consist.vehicles]
    vehicles = [replace(one, controller=str(folder / name)) if "." in name else one for one, name in named]
    return replace(consist, vehicles=tuple(vehicles))


def _of_folder(rows: list[dict[str, Any]], folder: Path) -> list[dict[str, Any]]:
    """Return rows whose vehicle files are named from the folder of the consist on."""
    found = []
    for row in rows:
        name = row.get("detail") if isinstance(row, dict) else None
        if isinstance(name, str) and name.lower().endswith(".toml"):
            row = row | {"detail": str(folder / name)}
        found.append(row)
    return found


def _rows_of_toml(path: Path) -> tuple[list[dict[str, Any]], dict[str, Coupler]]:
    """Return the vehicles of a file, and its couplers by name."""
    read = toml_of(path)
    for name in read:
        if name not in ("vehicle", "coupler"):
            raise ValueError(f"{path}: the table {quoted(name)} is unknown. Call each [[vehicle]] or [[coupler]].")
    vehicles = read.get("vehicle", [])
    if not isinstance(vehicles, list):
        raise ValueError(f"{path}: vehicle must be a list of tables. Write each as [[vehicle]], with two brackets.")
    return vehicles, couplers_of(read.get("coupler", []), str(path))


def consist_of(
    rows: list[dict[str, Any]],
    name: str = "the consist",
    places: Sequence[str] = (),
    couplers: Mapping[str, Coupler] | None = None,
) -> Consist:
    """Return a consist of rows as a file has them."""
    own = dict(couplers or {})
    vehicles: list[TrainVehicle] = []
    heads: list[str] = []
    notes: dict[str, None] = {}
    stated: list[Mapping[str, Any]] = []
    by_place: dict[str, Mapping[str, Any]] = {}
    for number, row in enumerate(rows):
        place = places[number] if places else f"row {number + 1}"
        try:
            one, values = vehicle_of(row, own, notes)
            by_place[place] = values
            heads += [place] if one.leads else []
            vehicles += [one] * int(values.get("count", 1))
            stated += [values] * int(values.get("count", 1))
            if len(heads) > 1:
                raise ValueError(f"one vehicle must have valve = head; {heads[0]} has it already. Take one away.")
            if len(vehicles) > MOST:
                raise ValueError(
                    f"a train must have at most {MOST} vehicles; with this one it has {len(vehicles)}. Take fewer."
                )
        except ValueError as error:
            raise ValueError(f"{name}, {place}: {error}") from None
    if not vehicles:
        raise ValueError(f"{name} must have vehicles; it has none. Give it a row for each kind of vehicle in turn.")
    led = _with_head(vehicles, name)
    try:
        led = with_vacuum(led, stated)
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None
    _check_pipe(led, name)
    _check_couplers(led, own, name)
    valves = sum(one.valve is not None for one in led)
    if valves > MOST_VALVES:
        raise ValueError(f"{name} must have at most {MOST_VALVES} driver's valves; it has {valves}. Take fewer.")
    return Consist(tuple(led), (*notes, *assumed_brakes(by_place)))


def _with_head(vehicles: list[TrainVehicle], name: str) -> list[TrainVehicle]:
    """The head's valve first: the one that is so called, or that of the first locomotive; others are cut out."""
    places = [i for i, vehicle in enumerate(vehicles) if vehicle.valve is not None and vehicle.valve_delay < 0.0]
    if not places:
        raise ValueError(f"{name} must have a driver's valve; add a locomotive, or give one vehicle valve = head.")
    called = [i for i in places if vehicles[i].kind != "locomotive" or vehicles[i].leads]
    head = called[0] if called else places[0]
    return [replace(one, valve=None) if i in places and i != head else one for i, one in enumerate(vehicles)]


def _check_pipe(vehicles: Sequence[TrainVehicle], name: str) -> None:
    """Check that all pipes have one diameter. Raises ValueError."""
    found = sorted({round(1e3 * vehicle.pipe_diameter, 6) for vehicle in vehicles})
    if len(found) > 1:
        raise ValueError(
            f"{name}: pipe_diameter must be one number for all vehicles; got {found[0]:g} and {found[-1]:g} mm. Give it"
            " to all, as it is 31.75 mm where it is left out."
        )


def _check_couplers(vehicles: Sequence[TrainVehicle], own: Iterable[str], name: str) -> None:
    """Check that each coupler of a table is between two vehicles. Raises ValueError."""
    used = {vehicle.coupler.name for vehicle in vehicles[:-1]}
    for coupler in own:
        if coupler not in used:
            raise ValueError(
                f"{name}: the coupler {quoted(coupler)} must be behind a vehicle, other than the last one; it is not. "
                f"Write coupler = {quoted(coupler)} in a [[vehicle]], or remove it."
            )

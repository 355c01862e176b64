"""Consists from files: CSV with a row for each kind of vehicle in turn, or TOML with a [[vehicle]] for each.

kind        wagon, locomotive, coach
count       how many of them, one behind the other (default 1)
load        on each [t] (default 60 t for wagons, otherwise 0)
distributor of each: uic (default uic)
position    of the distributor, P or G (default P)
coupler     behind each: screw, draft-gear, rigid (default screw)
weighing    of a wagon's brake: lever (for empty and loaded) or continuous (default lever)
lambda      brake weight percentage [%], in place of the cylinder's and shoes' data
mass        of one with its load [t], in place of load
length      over buffers [m], in place of the kind's
rotating    mass of what turns at the rim, over the vehicle's [%] (default 4)
at          of the distributor, as a share of the length from the front (default 0.5); counts from two cells on
leak        of the pipe, diameter of a hole [mm] (default 0)
branch      what branches of the pipe hold [l] (default 0)
valve       of a driver: head, second (it follows the head's by radio) or none; by itself the first locomotive is head
delay       of that radio [s] (default 0)
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from brake_controller.air import DISCHARGE
from brake_controller.distributors import DISTRIBUTORS
from brake_controller.drivers_valve import drivers_valve
from fmu_src.suggestion import suggestion
from products.train.consist import EMPTY, KINDS, LONGEST_VEHICLE, Consist, TrainVehicle, braked_by
from products.train.layout import MOST_VALVES
from rbd_model.train.coupler import COUPLERS
from readers.tables import Column, number_of, read_table
from readers.text import quoted, shown
from readers.toml_files import toml_of

#: Largest number of vehicles, and limits of a consist: load and mass [t], lambda [%], delay [s], leak [mm].
MOST = 2000
LIMITS = {
    "count": (1, MOST),
    "load": (0.0, 200.0),
    "lambda": (1.0, 250.0),
    "mass": (1.0, 300.0),
    "length": (3.0, LONGEST_VEHICLE),
    "at": (0.0, 1.0),
    "rotating": (0.0, 100.0),
    "leak": (0.0, 10.0),
    "branch": (0.0, 25.0),
    "delay": (0.0, 9.0),
}
UNITS = {
    "rotating": "%",
    "load": "t",
    "lambda": "%",
    "mass": "t",
    "length": "m",
    "leak": "mm",
    "branch": "l",
    "delay": "s",
}
WORDS: dict[str, Collection[str]] = {
    "kind": tuple(KINDS),
    "distributor": DISTRIBUTORS,
    "position": ("P", "G"),
    "coupler": tuple(COUPLERS),
    "weighing": ("lever", "continuous"),
    "valve": ("head", "second", "none"),
}


def _columns() -> list[Column]:
    """Return the columns of a CSV file: empty cells leave a value to its default."""
    found = [
        Column(name, words=tuple(words), required=name == "kind", filled=name == "kind")
        for name, words in WORDS.items()
    ]
    for name, limits in LIMITS.items():
        found.append(Column(name, UNITS.get(name, "1"), *limits, filled=False, whole=name == "count"))
    return found


def read_consist(path: Path) -> Consist:
    """Return the consist in a file, TOML where its name ends so, otherwise a table.

    Raises
    ------
    FileError, ValueError
        If the file is not a consist; the message names file, row, column, value and remedy.
    """
    if path.suffix.lower() == ".toml":
        rows = _rows_of_toml(path)
        return consist_of(rows, str(path), [f"vehicle {number}" for number in range(1, len(rows) + 1)])
    table = read_table(path, _columns(), most_rows=MOST)
    rows = []
    for row in range(table.places.size):
        numbers = {name: float(values[row]) for name, values in table.numbers.items() if not math.isnan(values[row])}
        rows.append({name: values[row] for name, values in table.words.items() if values[row]} | numbers)
    return consist_of(rows, str(path), [f"row {place}" for place in table.places])


def _rows_of_toml(path: Path) -> list[dict[str, Any]]:
    read = toml_of(path)
    for name in read:
        if name != "vehicle":
            raise ValueError(f"{path}: the table {quoted(name)} is unknown. Call each [[vehicle]].")
    vehicles = read.get("vehicle", [])
    if not isinstance(vehicles, list):
        raise ValueError(f"{path}: vehicle must be a list of tables. Write each as [[vehicle]], with two brackets.")
    return vehicles


def consist_of(rows: list[dict[str, Any]], name: str = "the consist", places: Sequence[str] = ()) -> Consist:
    """Return a consist of rows as a file has them; places: of each row, for messages. Raises ValueError."""
    vehicles: list[TrainVehicle] = []
    heads: list[str] = []
    for number, row in enumerate(rows):
        place = places[number] if places else f"row {number + 1}"
        try:
            values = _checked(row)
            if values.get("valve") == "head":
                heads.append(place)
            vehicles += _vehicles(values)
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
    valves = sum(one.valve is not None for one in led)
    if valves > MOST_VALVES:
        raise ValueError(f"{name} must have at most {MOST_VALVES} driver's valves; it has {valves}. Take fewer.")
    return Consist(tuple(led))


def _with_head(vehicles: list[TrainVehicle], name: str) -> list[TrainVehicle]:
    """The head's valve first: the one that is so called, or that of the first locomotive; others are cut out."""
    places = [i for i, one in enumerate(vehicles) if one.valve is not None and one.valve_delay < 0.0]
    if not places:
        raise ValueError(f"{name} must have a driver's valve; add a locomotive, or give one vehicle valve = head.")
    called = [i for i in places if vehicles[i].kind != "locomotive" or vehicles[i].leads]
    head = called[0] if called else places[0]
    return [replace(one, valve=None) if i in places and i != head else one for i, one in enumerate(vehicles)]


def _number(name: str, value: Any) -> float:
    number = number_of(value)
    low, high = LIMITS[name]
    unit = f" {UNITS[name]}" if name in UNITS else ""
    if not low <= number <= high or (name == "count" and number != int(number)):
        kind = "an integer" if name == "count" else "a number"
        raise ValueError(f"{name} must be {kind} from {low:g} to {high:g}{unit}; got {shown(value)}. Correct it.")
    return number


def _checked(row: Mapping[str, Any]) -> dict[str, Any]:
    values: dict[str, Any] = {}
    if not isinstance(row, Mapping):
        raise ValueError(f"a vehicle must be names with values; got {shown(row)}. Write kind = 'wagon'.")
    for name, value in row.items():
        if name in WORDS and value not in WORDS[name]:
            raise ValueError(f"{name} must be one of {', '.join(WORDS[name])}; got {shown(value)}. Choose one.")
        if name not in WORDS and name not in LIMITS:
            raise ValueError(f"the name {quoted(str(name))} is unknown; {suggestion(str(name), [*WORDS, *LIMITS])}")
        values[name] = value if name in WORDS else _number(name, value)
    if "kind" not in values:
        raise ValueError(f"a vehicle must have a kind, one of {', '.join(KINDS)}. Add it.")
    return values


def _vehicles(values: Mapping[str, Any]) -> list[TrainVehicle]:
    kind = values["kind"]
    if "load" in values and "mass" in values:
        raise ValueError("a vehicle must have load or mass, not both. The mass is that with the load.")
    load = values.get("load", 60.0 if kind == "wagon" else 0.0)
    if "mass" in values:
        load = values["mass"] - 1e-3 * EMPTY[kind]
    if "weighing" in values and kind != "wagon":
        raise ValueError(f"weighing must be of a wagon; the vehicle is a {kind}. Leave it out.")
    more = {"weighing": values["weighing"]} if "weighing" in values else {}
    one = KINDS[kind](1e3 * load, values.get("position", "P"), **more)
    if "distributor" in values:
        one = replace(one, distributor=DISTRIBUTORS[values["distributor"]].ready(values.get("position", "P")))
    if "lambda" in values:
        one = replace(one, brake=braked_by(values["lambda"], one.mass, one.resistance))
    one = replace(
        one,
        length=values.get("length", one.length),
        rotating_share=1e-2 * values["rotating"] if "rotating" in values else one.rotating_share,
        coupler=COUPLERS[values.get("coupler", "screw")](),
        distributor_at=values.get("at", 0.5),
        branch=1e-3 * values.get("branch", 0.0),
        leak=DISCHARGE * math.pi / 4 * (1e-3 * values.get("leak", 0.0)) ** 2,
    )
    valve = values.get("valve")
    if "delay" in values and valve != "second":
        raise ValueError("delay must be of a valve that follows by radio. Set valve to second, or leave it out.")
    if valve == "none":
        one = replace(one, valve=None)
    elif valve is not None:
        delay = values.get("delay", 0.0) if valve == "second" else -1.0
        one = replace(one, valve=drivers_valve(), valve_delay=delay, leads=valve == "head")
    count = int(values.get("count", 1))
    if valve in ("head", "second") and count > 1:
        raise ValueError(f"count must be 1 with a {valve} valve; got {count}. Give that vehicle a row of its own.")
    return [one] * count

"""Consists from files: CSV with a row for each kind of vehicle in turn, or TOML with a [[vehicle]] for each.

kind        wagon, locomotive, coach
count       how many of them, one behind the other (default 1)
load        on each [t] (default 60 t for wagons, otherwise 0)
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

import csv
import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from brake_controller.distributor import DISCHARGE
from brake_controller.drivers_valve import drivers_valve
from products.toml import tomllib
from products.train.consist import EMPTY, KINDS, LONGEST_VEHICLE, Consist, TrainVehicle, braked_by
from rbd_model.train.coupler import COUPLERS

#: Vehicles of a train at most, and of what a consist may have: load and mass [t], lambda [%], delay [s], leak [mm].
MOST = 2000
#: Driver's valves at most, MOST_VALVES of pipe.h.
MOST_VALVES = 16
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
    "rotating": " %",
    "load": " t",
    "lambda": " %",
    "mass": " t",
    "length": " m",
    "leak": " mm",
    "branch": " l",
    "delay": " s",
}
WORDS = {
    "kind": tuple(KINDS),
    "position": ("P", "G"),
    "coupler": tuple(COUPLERS),
    "weighing": ("lever", "continuous"),
    "valve": ("head", "second", "none"),
}


def read_consist(path: Path) -> Consist:
    """The consist in a file. Raises ValueError with one sentence that names the file and the row, OSError."""
    try:
        rows = _rows_of_toml(path) if path.suffix == ".toml" else _rows_of_csv(path)
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ValueError(f"{path} is no consist ({error}); mend it.") from None
    return consist_of(rows, str(path))


def _rows_of_csv(path: Path) -> list[dict[str, Any]]:
    lines = path.read_text(encoding="utf-8-sig").splitlines()
    rows = csv.DictReader([line for line in lines if line.strip() and not line.lstrip().startswith("#")])
    names = [name.strip() for name in rows.fieldnames or ()]
    for name in names:
        if name and names.count(name) > 1:
            raise ValueError(f"{path}: it names {name} twice; name each column once.")
    found = []
    for number, row in enumerate(rows, 1):
        if None in row:
            raise ValueError(f"{path}, row {number}: it has more values than names; give one for each name.")
        found.append({name.strip(): (text or "").strip() for name, text in row.items() if (text or "").strip()})
    return found


def _rows_of_toml(path: Path) -> list[dict[str, Any]]:
    read = tomllib.loads(path.read_text(encoding="utf-8"))
    for name in read:
        if name != "vehicle":
            raise ValueError(f"{path}: there is no {name}; call each [[vehicle]].")
    vehicles = read.get("vehicle", [])
    if not isinstance(vehicles, list):
        raise ValueError(f"{path}: give each vehicle as [[vehicle]], with two brackets.")
    return vehicles


def consist_of(rows: list[dict[str, Any]], name: str = "the consist") -> Consist:
    """A consist of rows as a file has them. Raises ValueError."""
    vehicles: list[TrainVehicle] = []
    heads: list[int] = []
    for number, row in enumerate(rows, 1):
        try:
            values = _checked(row)
            if values.get("valve") == "head":
                heads.append(number)
            vehicles += _vehicles(values)
            if len(heads) > 1:
                raise ValueError(f"row {heads[0]} is the head already; give one vehicle valve = head.")
            if len(vehicles) > MOST:
                raise ValueError(
                    f"a train has at most {MOST} vehicles: with this row it had {len(vehicles)}; take fewer."
                )
        except ValueError as error:
            raise ValueError(f"{name}, row {number}: {error}") from None
    if not vehicles:
        raise ValueError(f"{name} has no vehicle; give it a row for each kind of vehicle in turn.")
    led = _with_head(vehicles, name)
    valves = sum(one.valve is not None for one in led)
    if valves > MOST_VALVES:
        raise ValueError(f"{name} has {valves} driver's valves; give it at most {MOST_VALVES}.")
    return Consist(tuple(led))


def _with_head(vehicles: list[TrainVehicle], name: str) -> list[TrainVehicle]:
    """The head's valve first: the one that is so called, or that of the first locomotive; others are cut out."""
    places = [i for i, one in enumerate(vehicles) if one.valve is not None and one.valve_delay < 0.0]
    if not places:
        raise ValueError(f"{name} has no driver's valve; give it a locomotive, or one vehicle valve = head.")
    called = [i for i in places if vehicles[i].kind != "locomotive" or vehicles[i].leads]
    head = called[0] if called else places[0]
    return [replace(one, valve=None) if i in places and i != head else one for i, one in enumerate(vehicles)]


def _number(name: str, value: Any) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = math.nan
    low, high = LIMITS[name]
    unit = UNITS.get(name, "")
    if isinstance(value, bool) or not low <= number <= high or (name == "count" and number != int(number)):
        kind = "a whole number" if name == "count" else "a number"
        raise ValueError(f"set {name} to {kind} from {low:g} to {high:g}{unit}: it was {value}{unit}.")
    return number


def _checked(row: Mapping[str, Any]) -> dict[str, Any]:
    values: dict[str, Any] = {}
    if not isinstance(row, Mapping):
        raise ValueError("give names and values, as in kind = 'wagon'.")
    for name, value in row.items():
        if name in WORDS and value not in WORDS[name]:
            raise ValueError(f"set {name} to one of {', '.join(WORDS[name])}: it was {value}.")
        if not name:
            raise ValueError("there is a value without a name; name each column.")
        if name not in WORDS and name not in LIMITS:
            raise ValueError(f"there is no {name}; give some of {', '.join([*WORDS, *LIMITS])}.")
        values[name] = value if name in WORDS else _number(name, value)
    if "kind" not in values:
        raise ValueError(f"give a kind, one of {', '.join(KINDS)}.")
    return values


def _vehicles(values: Mapping[str, Any]) -> list[TrainVehicle]:
    kind = values["kind"]
    if "load" in values and "mass" in values:
        raise ValueError("give load or mass, not both: the mass is that with the load.")
    load = values.get("load", 60.0 if kind == "wagon" else 0.0)
    if "mass" in values:
        load = values["mass"] - 1e-3 * EMPTY[kind]
    if "weighing" in values and kind != "wagon":
        raise ValueError("weighing is of wagons; leave it out.")
    more = {"weighing": values["weighing"]} if "weighing" in values else {}
    one = KINDS[kind](1e3 * load, values.get("position", "P"), **more)
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
        raise ValueError("a delay is of a valve that follows by radio; set valve to second.")
    if valve == "none":
        one = replace(one, valve=None)
    elif valve is not None:
        delay = values.get("delay", 0.0) if valve == "second" else -1.0
        one = replace(one, valve=drivers_valve(), valve_delay=delay, leads=valve == "head")
    count = int(values.get("count", 1))
    if valve in ("head", "second") and count > 1:
        raise ValueError(f"one vehicle has a {valve} valve: count was {count}; give it a row of its own.")
    return [one] * count

"""Consists from files: CSV with a row for each kind of vehicle in turn, or TOML with a [[vehicle]] for each.

The columns are those of `columns.py`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from brake_controller.air import DISCHARGE
from brake_controller.distributors import distributors
from brake_controller.distributors.aar import OF_AAR
from brake_controller.drivers_valve import DriversValve, drivers_valve
from fmu_src.suggestion import suggestion
from products.train.columns import (
    ABOVE_0,
    COUPLING,
    ELECTRIC,
    HEAT,
    MOST,
    NAMES,
    NUMBERS,
    PARKING,
    TEXTS,
    TRACK,
    TRACTION,
    WHOLE,
    WORDS,
    choices,
    columns,
    longest_of,
    number_with_unit,
    remedies,
)
from products.train.consist import EMPTY, KINDS, Consist, TrainVehicle, braked_with
from products.train.coupler_tables import couplers_of
from products.train.layout import MOST_VALVES
from products.train.stated import brake_of, check_control, check_force, distributor_of
from products.train.stated_drive import check_drive, electric_of, traction_of
from products.train.stated_extra import check_extra, parking_of, track_of
from products.train.stated_heat import check_heat, heat_of
from rbd_model.train.coupler import COUPLERS, Coupler, with_numbers
from readers.documents import is_number
from readers.tables import read_table
from readers.text import quoted, shown
from readers.toml_files import toml_of
from readers.usual import almost_0, is_almost_0, likely_unit

#: Columns that leave the brake of the kind as it is.
WITHOUT_BRAKE = (
    "kind",
    "name",
    "count",
    "load",
    "mass",
    "length",
    "distributor",
    *OF_AAR,
    "position",
    "coupler",
    "weighing",
    "friction_ratio",
    "friction_decay",
    "valve",
    "at",
    "leak",
    "branch",
    "delay",
    "service_rate",
    "exhaust",
    "pipe_diameter",
    *ELECTRIC,
    "dynamic_table",
    *TRACTION,
    "traction_table",
    "adhesion",
    *HEAT,
    "fade_table",
    *TRACK,
    *PARKING,
    "parking_compounding",
    *COUPLING,
)


def read_consist(path: Path) -> Consist:
    """Return the consist in a file, TOML where its name ends so, otherwise a table."""
    if path.suffix.lower() == ".toml":
        rows, couplers = _rows_of_toml(path)
        places = [f"vehicle {number}" for number in range(1, len(rows) + 1)]
        return consist_of(rows, str(path), places, couplers)
    table = read_table(path, columns(), most_rows=MOST)
    rows = []
    for row in range(table.places.size):
        numbers = {name: float(values[row]) for name, values in table.numbers.items() if not math.isnan(values[row])}
        rows.append({name: values[row] for name, values in table.words.items() if values[row]} | numbers)
    return consist_of(rows, str(path), [f"row {place}" for place in table.places])


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
    for number, row in enumerate(rows):
        place = places[number] if places else f"row {number + 1}"
        try:
            values = _checked(row, own)
            if values.get("valve") == "head":
                heads.append(place)
            vehicles += _vehicles(values, own)
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
    _check_pipe(led, name)
    _check_couplers(led, own, name)
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


def _check_pipe(vehicles: Sequence[TrainVehicle], name: str) -> None:
    """Check that all pipes have one diameter. Raises ValueError."""
    found = sorted({round(1e3 * one.pipe_diameter, 6) for one in vehicles})
    if len(found) > 1:
        raise ValueError(
            f"{name}: pipe_diameter must be one number for all vehicles; got {found[0]:g} and {found[-1]:g} mm. Give it"
            " to all, as it is 31.75 mm where it is left out."
        )


def _check_couplers(vehicles: Sequence[TrainVehicle], own: Iterable[str], name: str) -> None:
    """Check that each coupler of a table is between two vehicles. Raises ValueError."""
    used = {one.coupler.name for one in vehicles[:-1]}
    for coupler in own:
        if coupler not in used:
            raise ValueError(
                f"{name}: the coupler {quoted(coupler)} must be behind a vehicle, other than the last one; it is not. "
                f"Write coupler = {quoted(coupler)} in a [[vehicle]], or remove it."
            )


def _number(name: str, value: Any) -> float:
    unit, low, high = NUMBERS[name]
    number = number_with_unit(value, unit)
    if not low <= number <= high or (name in WHOLE and number != int(number)):
        kind = "an integer" if name in WHOLE else "a number"
        said = f"{low:g} to {high:g} {unit}" if unit != "1" else f"{low:g} to {high:g}"
        likely = likely_unit(number, unit, low, high) if is_number(value) else ""
        raise ValueError(f"{name} must be {kind} from {said}; got {shown(value)}.{likely or ' Correct it.'}")
    if 0.0 < number < (least := ABOVE_0.get(name, 0.0)):
        likely = likely_unit(number, unit, least, high) if is_number(value) else ""
        raise ValueError(f"{name} must be 0 or from {least:g} to {high:g} {unit}; got {shown(value)}.{likely}")
    if is_almost_0(number, unit):
        raise ValueError(almost_0(name, number, unit, high))
    return number


def _text(name: str, value: Any) -> str:
    if not isinstance(value, str) or len(value) > longest_of(name) or not value.isprintable():
        limit = f"printable text of at most {longest_of(name)} characters"
        raise ValueError(f"{name} must be {limit}; got {shown(value)}. Correct it.")
    return value.strip()


def _checked(row: Mapping[str, Any], couplers: Iterable[str]) -> dict[str, Any]:
    values: dict[str, Any] = {}
    if not isinstance(row, Mapping):
        raise ValueError(f"a vehicle must be names with values; got {shown(row)}. Write kind = 'wagon'.")
    for name, value in row.items():
        words = (*choices(name), *(couplers if name == "coupler" else ())) if name in WORDS else ()
        if name in WORDS and value not in words:
            remedy = next((text for word, text in remedies(name) if word == value), "Choose one.")
            raise ValueError(f"{name} must be one of {', '.join(words)}; got {shown(value)}. {remedy}")
        if name not in NAMES:
            raise ValueError(f"the name {quoted(str(name))} is unknown; {suggestion(str(name), NAMES)}")
        values[name] = value if name in WORDS else _text(name, value) if name in TEXTS else _number(name, value)
    if "kind" not in values:
        raise ValueError(f"a vehicle must have a kind, one of {', '.join(KINDS)}. Add it.")
    return values


def _vehicles(values: Mapping[str, Any], couplers: Mapping[str, Coupler]) -> list[TrainVehicle]:
    one = replace(_bare(values), coupler=_coupler(values, couplers))
    check_control(values)
    check_force(values)
    check_drive(values)
    check_heat(values)
    check_extra(values, one.mass)
    one = replace(one, distributor=distributor_of(values, one.distributor))
    if values.get("brake") == "none":
        one = replace(one, brake=braked_with(0.0))
    elif set(values) - set(WITHOUT_BRAKE):
        one = replace(one, brake=brake_of(values, one))
    one = replace(one, electric=electric_of(values, one.distributor), heat=heat_of(values, one.brake))
    one = replace(one, track=track_of(values), parking=parking_of(values, one.mass))
    one = replace(one, traction=traction_of(values), adhesion=values.get("adhesion", "input"))
    one = _with_valve(values, one)
    return [one] * int(values.get("count", 1))


def _bare(values: Mapping[str, Any]) -> TrainVehicle:
    """Return a vehicle with its masses, resistance, distributor and pipe."""
    kind = values["kind"]
    if "load" in values and "mass" in values:
        raise ValueError("a vehicle must have load or mass, not both. The mass is that with the load.")
    load = values.get("load", 60.0 if kind == "wagon" else 0.0)
    if "mass" in values:
        load = values["mass"] - 1e-3 * EMPTY[kind]
    if ("friction_ratio" in values) != ("friction_decay" in values):
        raise ValueError("friction_ratio and friction_decay must come together: one alone has no effect. Give both.")
    if "weighing" in values and kind != "wagon":
        raise ValueError(f"weighing must be of a wagon; the vehicle is a {kind}. Leave it out.")
    more = {"weighing": values["weighing"]} if "weighing" in values else {}
    more |= {"weighing": "none"} if "empty_load" in values and kind == "wagon" else {}
    one = KINDS[kind](1e3 * load, values.get("position", "P"), **more)
    if "distributor" in values:
        one = replace(one, distributor=distributors()[values["distributor"]].ready(values.get("position", "P")))
    return replace(
        one,
        name=values.get("name", ""),
        length=values.get("length", one.length),
        resistance=_resistance(values, one),
        friction_ratio=values.get("friction_ratio", one.friction_ratio),
        friction_decay=values.get("friction_decay", one.friction_decay),
        rotating_share=1e-2 * values["rotating"] if "rotating" in values else one.rotating_share,
        distributor_at=values.get("at", 0.5),
        pipe_diameter=1e-3 * values["pipe_diameter"] if "pipe_diameter" in values else one.pipe_diameter,
        branch=1e-3 * values.get("branch", 0.0),
        leak=DISCHARGE * math.pi / 4 * (1e-3 * values.get("leak", 0.0)) ** 2,
    )


def _coupler(values: Mapping[str, Any], couplers: Mapping[str, Coupler]) -> Coupler:
    """Return the coupler behind a vehicle: of a table, or built-in with numbers of the row instead of its own."""
    called, stated = values.get("coupler", "screw"), [name for name in COUPLING if name in values]
    if called in couplers and stated:
        number = stated[0].removeprefix("coupler_")
        raise ValueError(f"{stated[0]} must be left out with a [[coupler]], which has its own {number}. Leave it out.")
    if called in couplers:
        return couplers[called]
    one = COUPLERS[called]()
    if not stated:
        return one
    if "coupler_preload" in values and "coupler_stiffness" not in values:
        raise ValueError("coupler_preload must come with coupler_stiffness. Add it, or leave coupler_preload out.")
    scale = {"MN/m": 1e6, "kN": 1e3, "mm": 1e-3, "1": 1.0}
    given = {
        name.removeprefix("coupler_"): scale[COUPLING[name][0]] * values[name] for name in COUPLING if name in values
    }
    found = with_numbers(one, **given)
    if values.get("coupler_damping", 0.0) > 0.0 and not found.dissipates:
        most = 1e-6 * one.sticking_stiffness
        raise ValueError(
            f"coupler_damping must come with a coupler_stiffness below {most:g} MN/m, at which the friction of a "
            f"{one.name} coupler sticks. Decrease coupler_stiffness, or leave coupler_damping out."
        )
    return found


def _resistance(values: Mapping[str, Any], one: TrainVehicle) -> tuple[float, float, float]:
    """Return a + b v + c v^2 of a row [N] (Davis 1926), or that of the formula of its kind."""
    names = ("resistance_a", "resistance_b", "resistance_c")
    stated = [name for name in names if name in values]
    if not stated:
        return one.formula.of(one.mass)
    if stated not in (["resistance_a"], list(names)):
        raise ValueError(
            f"resistance_a must come alone, or all of {', '.join(names)}; got {', '.join(stated)}. Add 0s."
        )
    a, b, c = (values.get(name, 0.0) for name in names)
    return a, b, c


def _with_valve(values: Mapping[str, Any], one: TrainVehicle) -> TrainVehicle:
    """Return a vehicle with its driver's valve."""
    valve, count = values.get("valve"), int(values.get("count", 1))
    if "delay" in values and valve != "second":
        raise ValueError("delay must be of a valve that follows by radio. Set valve to second, or leave it out.")
    if valve in ("head", "second") and count > 1:
        raise ValueError(f"count must be 1 with a {valve} valve; got {count}. Give that vehicle a row of its own.")
    if valve == "none":
        one = replace(one, valve=None)
    elif valve is not None:
        delay = values.get("delay", 0.0) if valve == "second" else -1.0
        one = replace(one, valve=drivers_valve(), valve_delay=delay, leads=valve == "head")
    return replace(one, valve=_stated_valve(values, one.valve))


def _stated_valve(values: Mapping[str, Any], one: DriversValve | None) -> DriversValve | None:
    """Return a driver's valve with the rate and the exhaust of a row."""
    for name in ("service_rate", "exhaust"):
        if name in values and one is None:
            raise ValueError(f"{name} must be of a vehicle with a driver's valve. Set valve to head, or leave it out.")
    if one is not None and "service_rate" in values:
        one = replace(one, service_rate=1e5 * values["service_rate"])
    if one is not None and "exhaust" in values:
        one = replace(one, exhaust_area=math.pi / 4 * (1e-3 * values["exhaust"]) ** 2)
    return one

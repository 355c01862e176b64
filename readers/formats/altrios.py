"""Trains of ALTRIOS (YAML): kinds of cars, a train of them by number, locomotives.

Fields as ALTRIOS writes them, in SI units; numbers of a train name cars by their car_type. The resistance of a car is,
by its module train/resistance,

    R = axles x bearing + (rolling_ratio + davis_b v) W + rho cd_area v^2,    W = m g

Its drag has no factor 1/2 (kind/aerodynamic.rs). `cd_area_vec` of a train replaces the cd_area of all cars, and the
means of rolling_ratio and davis_b act on the weight of the locomotives too (train_config.rs).

`braking_ratio` is the brake force over the weight (its module train/rail_vehicle). ALTRIOS takes it as retardation,
0.11 g loaded and 0.25 g empty. The figures are those of AAR net braking ratios, the force of all shoes over the weight.
They are read so, with a friction of the shoes on top. This is assumed, not ALTRIOS' own reading.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from readers.formats.any_case import in_any_case
from readers.formats.vehicle_rows import (
    AIR,
    GRAVITY,
    MOST,
    checked,
    fitting,
    named_number,
    printable,
    rounded,
    whole_train,
)
from readers.import_account import Imported, Notes, Row
from readers.text import FileError, quoted, shown
from readers.yaml_files import yaml_of

#: Limits and unit of each number of a car, and its spellings, the newest first.
_NUMBERS: dict[str, tuple[tuple[float, float, str], tuple[str, ...]]] = {
    "length": ((1.0, 1000.0, "m"), ("length_meters", "length", "Length (m)")),
    "axles": ((1, 400, ""), ("axle_count", "Axle Count")),
    "base": ((100.0, 1e7, "kg"), ("mass_static_base_kilograms", "mass_static_base", "Mass Static Base (kg)")),
    "freight": ((0.0, 1e7, "kg"), ("mass_freight_kilograms", "mass_freight", "Mass Freight (kg)")),
    "static": ((100.0, 1e7, "kg"), ("mass_static_kilograms", "mass_static", "Mass Static Loaded (kg)")),
    "ratio": ((0.0, 2.0, ""), ("braking_ratio", "Braking Ratio", "Braking Ratio Loaded")),
    "rotating": (
        (0.0, 1e5, "kg"),
        ("mass_rot_per_axle_kilograms", "mass_rot_per_axle", "mass_extra_per_axle", "Mass Extra per Axle (kg)"),
    ),
    "bearing": ((0.0, 1e5, "N"), ("bearing_res_per_axle_newtons", "bearing_res_per_axle", "Bearing Res per Axle (N)")),
    "rolling": ((0.0, 0.1, ""), ("rolling_ratio", "Rolling Ratio")),
    "davis_b": ((0.0, 1.0, "s/m"), ("davis_b_seconds_per_meter", "davis_b", "Davis B (s/m)")),
    "area": (
        (0.0, 100.0, "m2"),
        ("cd_area_square_meters", "cd_area", "drag_area", "Cd*A (m^2)", "Drag Area Cd*A Loaded (m^2)"),
    ),
}
LIMITS = {name: limits for name, (limits, _) in _NUMBERS.items()}
SPELLINGS = {name: spellings for name, (_, spellings) in _NUMBERS.items()}
#: Numbers that are 0 where a car does not have them; ALTRIOS itself refuses such a car.
OPTIONAL = {"freight", "rotating", "bearing", "davis_b", "area"}


@dataclass(frozen=True)
class Car:
    """A car: its name, its numbers by the names in SPELLINGS, and those of them that its file does not have."""

    name: str
    numbers: Mapping[str, float]
    missing: tuple[str, ...] = ()

    def with_area(self, area: float) -> Car:
        """Return the car with another drag area [m2]."""
        missing = tuple(one for one in self.missing if one not in SPELLINGS["area"])
        return replace(self, numbers={**self.numbers, "area": area}, missing=missing)


def _number(read: Mapping[str, Any], what: str, source: str, default: float | None = None) -> float:
    """Return a number of a car by any spelling. Raises FileError for another unit, or if it has no default either."""
    check_units(read, {what: SPELLINGS[what]}, source)
    for name in SPELLINGS[what]:
        if read.get(name) is not None:
            low, high, unit = LIMITS[what]
            return checked(named_number(read[name], name, source), name, (low, high), unit, source)
    if default is None:
        raise FileError(f"{source} must have {SPELLINGS[what][0]}; got {shown(', '.join(map(str, read)))}. Add it.")
    return default


def check_units(read: Mapping[str, Any], fields: Mapping[str, Sequence[str]], source: str) -> None:
    """Raise FileError if a field has another unit in its name than ALTRIOS writes, as length_feet or Length (ft)."""
    known = {name for names in (*SPELLINGS.values(), *fields.values()) for name in names}
    for names in fields.values():
        begins = tuple(f"{one.partition('(')[0]}(" if "(" in one else f"{one}_" for one in names[1:])
        for name in read:
            if str(name) not in known and str(name).startswith(begins):
                raise FileError(f"{source} must have {names[0]}; got {shown(name)}. Convert it to this unit.")


def car_of(read: Mapping[str, Any], source: str) -> Car:
    """Return a car of its file. Raises FileError."""
    name = read.get("car_type", read.get("Car Type", "car"))
    numbers = {what: _number(read, what, source) for what in ("length", "axles", "ratio", "rolling")}
    numbers |= {what: _number(read, what, source, 0.0) for what in ("rotating", "bearing", "davis_b", "area")}
    if any(spelling in read for spelling in SPELLINGS["base"]):
        numbers["mass"] = _number(read, "base", source) + _number(read, "freight", source, 0.0)
    else:
        numbers["mass"] = _number(read, "static", source)
    stated = {what for what, names in SPELLINGS.items() if any(read.get(one) is not None for one in names)}
    due = OPTIONAL if "base" in stated else OPTIONAL - {"freight"}
    return Car(printable(name, "car"), numbers, tuple(SPELLINGS[what][0] for what in due - stated))


#: Spellings of a locomotive's numbers.
UNITS = {"mass": ("mass_kilograms", "mass", "mass_kg"), "force_max": ("force_max_newtons", "force_max")}


def locomotives_of(read: Mapping[str, Any], source: str, notes: Notes) -> list[Row]:
    """Return the rows of the locomotives in loco_con or loco_vec, none if the file has none. Raises FileError."""
    consist = read.get("loco_con", read)
    stated = consist.get("loco_vec") if isinstance(consist, dict) else None
    if stated is None:
        return []
    if not isinstance(stated, list) or len(stated) > MOST:
        raise FileError(f"{source}: loco_vec must be a list of at most {MOST} locomotives; got another. Correct it.")
    rows: list[Row] = []
    notes.begin("locomotives")
    for number, one in enumerate(stated):
        place = f"{source}, locomotive {number + 1}"
        if not isinstance(one, dict):
            raise FileError(f"{place} must be a locomotive; got {shown(one)}. Correct it.")
        row: Row = {"kind": "locomotive", "name": f"locomotive {number + 1}"}
        check_units(one, UNITS, place)
        given = next((one[name] for name in UNITS["mass"] if one.get(name) is not None), None)
        if given is None:
            notes.assumed("Mass of a locomotive: missing; that of the kind.")
        else:
            row["mass"] = rounded(checked(1e-3 * named_number(given, "mass", place), "mass", (1.0, 300.0), "t", place))
            notes.taken("loco_vec mass -> mass [t]")
        rows.append(row | _motors(one, place, notes))
    notes.assumed(
        "Length, rotating mass and brake of a locomotive, and without cars its running resistance: those of the kind; "
        "ALTRIOS does not have them."
    )
    notes.left("Powertrain of a locomotive: efficiencies, limits of engine and battery, and dynamic brakes.")
    return rows


def _motors(one: Mapping[str, Any], place: str, notes: Notes) -> Row:
    """Return the largest force of a locomotive and the power of its electric drivetrain, if it states both."""
    drive = next((inner for inner in _within(one) if "edrv" in inner), {}).get("edrv", {})
    given = [
        next((read[name] for name in names if isinstance(read, dict) and read.get(name) is not None), None)
        for read, names in ((one, UNITS["force_max"]), (drive, ("pwr_out_max_watts", "pwr_out_max")))
    ]
    if None in given:
        notes.left("Motors of a locomotive: they need force_max and pwr_out_max of edrv.")
        return {}
    force, power = (named_number(value, name, place) for value, name in zip(given, ("force_max", "edrv"), strict=True))
    checked(1e-3 * force, "force_max", (0.1, 2000.0), "kN", place)
    checked(1e-3 * power, "pwr_out_max of edrv", (1.0, 30e3), "kW", place)
    notes.taken("force_max -> traction_force [kN], pwr_out_max of edrv -> traction_power [kW]")
    return {"traction_force": rounded(1e-3 * force), "traction_power": rounded(1e-3 * power)}


def _within(read: Any, depth: int = 4) -> Iterator[Mapping[str, Any]]:
    """Yield a mapping and those inside it."""
    if isinstance(read, dict):
        yield read
        for inner in read.values() if depth else ():
            yield from _within(inner, depth - 1)


def hauled(locomotives: list[Row], cars: list[tuple[Car, int]], notes: Notes) -> list[Row]:
    """Return locomotives with the mean rolling_ratio and davis_b of the cars, as ALTRIOS takes them for all weight."""
    total = sum(car.numbers["mass"] * count for car, count in cars)
    if not locomotives or not total:
        return locomotives
    ratio, slope = (
        sum(car.numbers[name] * car.numbers["mass"] * count for car, count in cars) / total
        for name in ("rolling", "davis_b")
    )
    notes.vehicle = "locomotives"
    notes.converted(
        "rolling_ratio, davis_b: their means over the mass of the cars x weight -> resistance_a, _b of a locomotive "
        "with mass; ALTRIOS has no drag of a locomotive -> resistance_c = 0"
    )
    notes.vehicle = ""
    return [_with_resistance(row, ratio, slope) for row in locomotives]


def _with_resistance(row: Row, ratio: float, slope: float) -> Row:
    """Return a locomotive with its resistance over weight [1] and its rise with speed [s/m], if it has a mass."""
    if "mass" not in row:
        return row
    weight = 1e3 * row["mass"] * GRAVITY
    return row | {
        "resistance_a": rounded(ratio * weight),
        "resistance_b": rounded(slope * weight),
        "resistance_c": 0.0,
    }


#: Friction of composite shoes on wheels, on top of a net braking ratio. Assumed.
FRICTION = 0.3
#: Shoes of an axle. Assumed.
SHOES = 2
#: Fields without a column, each with the reason.
LEFT = {
    "brake_count": "a number of control valves; a vehicle has one distributor",
    "speed_max_meters_per_second": "it does not affect braking",
    "Speed Max (m/s)": "it does not affect braking",
    "curve_coeff_0": "curve resistance is that of the line",
    "curve_coeff_1": "curve resistance is that of the line",
    "curve_coeff_2": "curve resistance is that of the line",
    "Curve Coefficient 0": "curve resistance is that of the line",
    "Braking Ratio Empty": "the loaded state is read",
    "Mass Static Empty (kg)": "the loaded state is read",
}
#: Fields of a train without a column.
LEFT_OF_TRAIN = {
    "train_type": "it does not affect the brake",
    "history": "a recorded run",
    "state": "a recorded run",
    "save_interval": "a setting of ALTRIOS",
}


def read_altrios(path: Path) -> Imported:
    """Return the train of a file: one car, cars with numbers of them, or locomotives."""
    read = yaml_of(path)
    if not isinstance(read, dict):
        raise FileError(f"{path} must be a rolling stock or a train of ALTRIOS; got {shown(read)}. Give another file.")
    notes, source = Notes(), str(path)
    train = read.get("train_config", read)
    config = train if isinstance(train, dict) else read
    rows = locomotives_of(read, source, notes)
    if "n_cars_by_type" in config or "rail_vehicles" in config:
        rows = hauled(rows, cars := _cars_of_train(config, path, notes), notes) + _rows_of_cars(cars, source, notes)
        _tell_train(config, read, rows, notes)
    elif not rows:
        rows = _car_rows(car_of(read, source), 1, source, notes)
        notes.left_of(LEFT, _stated(read))
    return notes.imported(whole_train(rows, notes, source))


def _car_rows(car: Car, count: int, source: str, notes: Notes) -> list[Row]:
    """Return the rows of cars of one kind."""
    notes.begin(car.name)
    n, weight = car.numbers, car.numbers["mass"] * GRAVITY
    row: Row = {"kind": "wagon", "name": car.name, "mass": rounded(1e-3 * n["mass"]), "length": rounded(n["length"])}
    notes.taken("length_meters -> length [m]")
    notes.converted("mass_static_base + mass_freight -> mass [t]")
    row["rotating"] = rounded(100 * n["axles"] * n["rotating"] / n["mass"])
    notes.converted("mass_rot_per_axle: 100 x axle_count x mass_rot_per_axle / mass -> rotating [%]")
    row["resistance_a"] = rounded(n["axles"] * n["bearing"] + n["rolling"] * weight)
    row["resistance_b"] = rounded(n["davis_b"] * weight)
    row["resistance_c"] = rounded(AIR * n["area"])
    notes.converted(
        "bearing_res_per_axle, rolling_ratio, davis_b, cd_area: axles x bearing + rolling_ratio x weight, davis_b x "
        f"weight, {AIR:g} kg/m3 x cd_area (no factor 1/2) -> resistance_a, _b, _c (weight with {GRAVITY:g} m/s2)"
    )
    for name in sorted(car.missing):
        notes.assumed(f"{name}: missing; 0.")
    row |= _brake(n, notes)
    parts = fitting(row, notes, source)
    return [{**part, "count": count} for part in parts] if len(parts) == 1 else parts * count


def _brake(n: Mapping[str, float], notes: Notes) -> Row:
    """Return a net braking ratio, and its friction."""
    if n["ratio"] == 0.0:
        notes.converted("braking_ratio 0 -> brake = none")
        return {"brake": "none"}
    notes.converted("braking_ratio: 100 x ratio -> net_braking_ratio [%], with friction = constant")
    own = n["ratio"] * GRAVITY
    notes.assumed(
        f"braking_ratio is read as an AAR net braking ratio, shoe force over weight, with a friction of {FRICTION:g}: "
        f"{FRICTION * own:.2f} m/s2. ALTRIOS takes it as retardation: {own:.2f} m/s2. "
        "Set friction_value = 1 for its reading."
    )
    notes.assumed("Filling and release times: those of position P; a built train of ALTRIOS has a ramp of 0 s.")
    return {
        "net_braking_ratio": rounded(100 * n["ratio"]),
        "friction": "constant",
        "friction_value": FRICTION,
    }


def _cars_of_train(config: Mapping[str, Any], path: Path, notes: Notes) -> list[tuple[Car, int]]:
    """Return a train's cars and their numbers, in the order of n_cars_by_type. Raises FileError."""
    source = str(path)
    counts, stated = config.get("n_cars_by_type"), config.get("rail_vehicles", [])
    if not isinstance(counts, dict) or not isinstance(stated, list):
        raise FileError(f"{source} must have n_cars_by_type with names and numbers; got {shown(counts)}. Correct it.")
    known = {}
    for number, one in enumerate(stated):
        if not isinstance(one, dict):
            raise FileError(f"{source}: rail_vehicles must hold cars; got {shown(one)}. Correct it.")
        known[str(one.get("car_type"))] = car_of(one, f"{source}, car {number + 1}")
    for count in counts.values():
        if isinstance(count, bool) or not isinstance(count, int) or not 0 <= count <= MOST:
            raise FileError(
                f"{source}: n_cars_by_type must have integers from 0 to {MOST}; got {shown(count)}. Correct it."
            )
    if sum(counts.values()) > MOST:
        raise FileError(f"{source} must have at most {MOST} vehicles; got more. Take cars away.")
    cars = [(known.get(str(name)) or _car_beside(str(name), path), count) for name, count in counts.items() if count]
    notes.taken("n_cars_by_type -> count")
    if len(counts) > 1:
        notes.assumed("The order of the cars is that of n_cars_by_type; a train of ALTRIOS is a sum without an order.")
    return _with_areas(cars, config.get("cd_area_vec"), source, notes)


def _with_areas(cars: list[tuple[Car, int]], areas: Any, source: str, notes: Notes) -> list[tuple[Car, int]]:
    """Return cars with the mean of the drag areas of a train, if it states these. Raises FileError."""
    if areas is None:
        return cars
    total = sum(count for _, count in cars)
    if not isinstance(areas, list) or len(areas) != total:
        raise FileError(f"{source}: cd_area_vec must have {total} numbers, one a car; got {shown(areas)}. Correct it.")
    low, high, unit = LIMITS["area"]
    numbers = [named_number(area, "cd_area_vec", source) for area in areas]
    mean = sum(checked(number, "cd_area_vec", (low, high), unit, source) for number in numbers) / max(total, 1)
    notes.converted("cd_area_vec: its mean for each car, in place of cd_area; the drag of the train is that of the sum")
    return [(car.with_area(mean), count) for car, count in cars]


def _rows_of_cars(cars: list[tuple[Car, int]], source: str, notes: Notes) -> list[Row]:
    """Return the rows of a train's cars."""
    rows: list[Row] = []
    for car, count in cars:
        rows += _car_rows(car, count, source, notes)
    notes.vehicle = ""
    if len({car.numbers["ratio"] for car, _ in cars}) > 1:
        notes.assumed(
            "braking_ratio of unlike cars: each is that of its car; ALTRIOS takes their mean by number times the mass "
            "of all cars."
        )
    return rows


def _car_beside(name: str, path: Path) -> Car:
    """Return the car of a name from a file beside the train, or in rolling_stock there. Raises FileError."""
    for folder in (path.parent, path.parent / "rolling_stock", path.parent.parent / "rolling_stock"):
        for ending in (".yaml", ".yml"):
            found = in_any_case(folder, f"{name}{ending}") if "/" not in name and "\\" not in name else None
            if found is not None:
                read = yaml_of(found)
                if isinstance(read, dict):
                    return car_of(read, str(found))
    raise FileError(
        f"{path} must have the car {quoted(name)} in rail_vehicles, or in {name}.yaml beside it; got neither. Add it."
    )


def _stated(read: Mapping[str, Any]) -> list[str]:
    return [name for name, value in read.items() if value is not None]


def _tell_train(config: Mapping[str, Any], read: Mapping[str, Any], rows: list[Row], notes: Notes) -> None:
    """Tell fields of a train without a column; its mass and length where they differ from those of its cars."""
    notes.vehicle = ""
    notes.left_of(LEFT_OF_TRAIN, _stated({**read, **config}))
    for one in config.get("rail_vehicles", []):
        notes.left_of(LEFT, _stated(one))
    for names, column, factor in (
        (("train_mass_kilograms", "train_mass"), "mass", 1e3),
        (("train_length_meters", "train_length"), "length", 1.0),
    ):
        for name in names:
            if isinstance(value := config.get(name), int | float) and value:
                total = factor * sum(row.get(column, 0.0) * row.get("count", 1) for row in rows)
                notes.left(f"{name} = {value:g}: the sum of the vehicles is taken, {total:g}.")
    brake = read.get("fric_brake")
    if isinstance(brake, dict):
        notes.left("fric_brake: one force of the whole train has no column; each car has its braking_ratio.")

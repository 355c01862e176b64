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

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from readers.formats import Imported, Row
from readers.formats.altrios_car import LIMITS, Car, car_of
from readers.formats.altrios_locomotives import hauled, locomotives_of
from readers.formats.any_case import in_any_case
from readers.formats.notes import Notes
from readers.formats.vehicle_rows import AIR, GRAVITY, MOST, checked, fitting, named_number, rounded, whole_train
from readers.text import FileError, quoted, shown
from readers.yaml_files import yaml_of

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
        _tell_left(read, LEFT, notes)
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
    row |= _brake(n, weight, notes)
    parts = fitting(row, notes, source)
    return [{**part, "count": count} for part in parts] if len(parts) == 1 else parts * count


def _brake(n: Mapping[str, float], weight: float, notes: Notes) -> Row:
    """Return the shoe force of a net braking ratio, and its friction."""
    if n["ratio"] == 0.0:
        notes.converted("braking_ratio 0 -> brake = none")
        return {"brake": "none"}
    notes.converted("braking_ratio: ratio x weight -> shoe_force [kN], with friction = constant")
    own = n["ratio"] * GRAVITY
    notes.assumed(
        f"braking_ratio is read as an AAR net braking ratio, shoe force over weight, with a friction of {FRICTION:g}: "
        f"{FRICTION * own:.2f} m/s2. ALTRIOS takes it as retardation: {own:.2f} m/s2. "
        "Set friction_value = 1 for its reading."
    )
    notes.assumed("Filling and release times: those of position P; a built train of ALTRIOS has a ramp of 0 s.")
    return {
        "shoe_force": rounded(1e-3 * n["ratio"] * weight),
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
    numbers = [named_number(one, "cd_area_vec", source) for one in areas]
    mean = sum(checked(one, "cd_area_vec", (low, high), unit, source) for one in numbers) / max(total, 1)
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


def _tell_left(read: Mapping[str, Any], reasons: Mapping[str, str], notes: Notes) -> None:
    told: dict[str, list[str]] = {}
    for name, reason in reasons.items():
        if read.get(name) is not None:
            told.setdefault(reason, []).append(name)
    for reason, names in told.items():
        notes.left(f"{', '.join(names)}: {reason}.")


def _tell_train(config: Mapping[str, Any], read: Mapping[str, Any], rows: list[Row], notes: Notes) -> None:
    """Tell fields of a train without a column; its mass and length where they differ from those of its cars."""
    notes.vehicle = ""
    _tell_left({**read, **config}, LEFT_OF_TRAIN, notes)
    for one in config.get("rail_vehicles", []):
        _tell_left(one, LEFT, notes)
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

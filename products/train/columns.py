"""Columns of a consist: names, units, limits and words. Tables in docs/train.md, docs/train-brakes.md and
docs/train-couplers.md explain each.

A CSV file has them in its first row, a TOML file as keys of each [[vehicle]].
"""

from __future__ import annotations

import math
from collections.abc import Collection
from typing import Any

from brake_controller.distributors import BRAKES, pneumatic
from brake_controller.distributors.aar import RETAINERS
from brake_controller.electric_brake import BLENDINGS
from brake_controller.parking_brake import COMPOUNDING
from brake_controller.vehicle_brake import FORCELESS, FRICTIONS
from products.train.consist import KINDS, LONGEST_VEHICLE
from rbd_model.train.adhesion import ADHESIONS
from rbd_model.train.coupler import COUPLERS
from readers.columns import LONGEST_TEXT, Column, number_of
from readers.command_line import number_in

#: Largest number of vehicles, and of characters of a name.
MOST, LONGEST_NAME = 2000, LONGEST_TEXT
#: Numbers: unit and limits, both included. Columns of the vehicle itself, and of its resistance a + b v + c v^2.
VEHICLE: dict[str, tuple[str, float, float]] = {
    "count": ("1", 1, MOST),
    "load": ("t", 0.0, 200.0),
    "mass": ("t", 1.0, 300.0),
    "length": ("m", 3.0, LONGEST_VEHICLE),
    "rotating": ("%", 0.0, 100.0),
    "resistance_a": ("N", 0.0, 1e5),
    "resistance_b": ("N/(m/s)", 0.0, 1e4),
    "resistance_c": ("N/(m/s)^2", 0.0, 1e3),
    "friction_ratio": ("1", 0.0, 1.0),
    "friction_decay": ("s/m", 0.0, 10.0),
}
#: Columns that state the brake's force, one group of them in a row, and its friction.
FORCE: dict[str, tuple[str, float, float]] = {
    "lambda": ("%", 5.0, 250.0),
    "deceleration": ("m/s2", 0.01, 3.0),
    "brake_force": ("kN", 0.1, 1000.0),
    "shoe_force": ("kN", 0.1, 5000.0),
    "shoes": ("1", 1, 96),
    "cylinder_diameter": ("mm", 50.0, 1000.0),
    "cylinders": ("1", 1, 32),
    "rigging_ratio": ("1", 0.1, 50.0),
    "rigging_efficiency": ("1", 0.1, 1.0),
    "return_force": ("N", 0.0, 20e3),
    "friction_value": ("1", 0.01, 1.0),
    "friction_fast": ("1", 0.001, 1.0),
    "friction_speed": ("km/h", 0.1, 1000.0),
    "friction_radius": ("1", 0.1, 1.0),
}
#: Columns of the air: cylinder, reservoirs and pipe; the driver's valve.
AIR: dict[str, tuple[str, float, float]] = {
    "full_pressure": ("bar", 1.0, 8.0),
    "fill_time": ("s", 0.5, 120.0),
    "release_time": ("s", 0.5, 240.0),
    "auxiliary": ("l", 5.0, 1000.0),
    "cylinder": ("l", 0.5, 200.0),
    "pipe_diameter": ("mm", 15.0, 60.0),
    "at": ("1", 0.0, 1.0),
    "leak": ("mm", 0.0, 10.0),
    "branch": ("l", 0.0, 25.0),
    "delay": ("s", 0.0, 9.0),
    "service_rate": ("bar/s", 0.01, 5.0),
    "exhaust": ("mm", 1.0, 30.0),
    "empty_load": ("1", 0.3, 0.9),
}
#: Columns of the electric command and of the electric brake.
ELECTRIC: dict[str, tuple[str, float, float]] = {
    "dead_time": ("s", 0.0, 9.0),
    "dynamic_force": ("kN", 0.1, 1000.0),
    "dynamic_power": ("kW", 10.0, 20e3),
    "dynamic_fade": ("km/h", 0.0, 100.0),
    "dynamic_rise": ("s", 0.0, 30.0),
    "blending_speed": ("km/h", 0.0, 300.0),
}
#: Columns of the motors.
TRACTION: dict[str, tuple[str, float, float]] = {
    "traction_force": ("kN", 0.1, 2000.0),
    "traction_power": ("kW", 10.0, 30e3),
    "traction_rise": ("s", 0.0, 60.0),
    "traction_cut_out": ("bar", 0.0, 4.8),
}
#: Columns of the heat of brakes; those of one wheel or disc and of the blocks or pads on it, except its number.
HEAT: dict[str, tuple[str, float, float]] = {
    "wheel_mass": ("kg", 1.0, 5000.0),
    "wheels": ("1", 1, 96),
    "disc_mass": ("kg", 1.0, 5000.0),
    "discs": ("1", 1, 96),
    "heat_share": ("1", 0.0, 1.0),
    "cooling": ("W/K", 0.0, 1000.0),
    "cooling_speed": ("W.s/(K.m)", 0.0, 100.0),
    "thickness": ("mm", 2.0, 200.0),
    "rubbed_area": ("m2", 0.01, 2.0),
    "block_mass": ("kg", 0.1, 500.0),
    "block_heat": ("J/(kg.K)", 100.0, 3000.0),
    "block_cooling": ("W/K", 0.0, 100.0),
    "block_cooling_speed": ("W.s/(K.m)", 0.0, 10.0),
}
#: Columns of track brakes: magnets on the rails, eddy currents in them, and the pressure of the pipe that applies both.
TRACK: dict[str, tuple[str, float, float]] = {
    "magnetic_attraction": ("kN", 1.0, 2000.0),
    "magnetic_friction": ("1", 0.01, 0.5),
    "magnetic_fast": ("1", 0.001, 0.5),
    "magnetic_speed": ("km/h", 0.1, 1000.0),
    "magnetic_lift": ("km/h", 0.0, 100.0),
    "magnetic_from": ("km/h", 0.0, 200.0),
    "magnetic_rise": ("s", 0.0, 10.0),
    "eddy_force": ("kN", 0.1, 500.0),
    "eddy_speed": ("km/h", 10.0, 1000.0),
    "eddy_rise": ("s", 0.0, 10.0),
    "track_brake_pressure": ("bar", 0.0, 4.8),
}
#: Columns of the hand brake or spring-applied parking brake.
PARKING: dict[str, tuple[str, float, float]] = {
    "parking_force": ("kN", 0.1, 1000.0),
    "parking_gradient": ("permille", 0.1, 300.0),
    "parking_time": ("s", 0.0, 300.0),
}
#: Columns of the coupler behind a vehicle, in place of numbers of the built-in one.
COUPLING: dict[str, tuple[str, float, float]] = {
    "coupler_stiffness": ("MN/m", 0.1, 1000.0),
    "coupler_preload": ("kN", 0.0, 500.0),
    "coupler_slack": ("mm", 0.0, 200.0),
    "coupler_damping": ("1", 0.0, 0.95),
    "coupler_strength": ("kN", 10.0, 10e3),
}
NUMBERS = VEHICLE | FORCE | AIR | ELECTRIC | TRACTION | HEAT | TRACK | PARKING | COUPLING
#: Smallest values above 0 [unit of the column]: a smaller one is in another unit. Pressures have theirs.
ABOVE_0 = {"load": 0.05, "rotating": 0.3, "coupler_slack": 0.2}
#: Columns of integers.
WHOLE = ("count", "shoes", "cylinders", "wheels", "discs")
#: Columns of words with a choice. `choices` has the names of distributors, those that there are when a file is read.
WORDS: dict[str, Collection[str]] = {
    "kind": tuple(KINDS),
    "brake": tuple(BRAKES),
    "distributor": (),
    "retainer": RETAINERS,
    "accelerated_release": ("yes", "no"),
    "position": ("P", "G"),
    "friction": (*FRICTIONS, *FORCELESS),
    "adhesion": tuple(ADHESIONS),
    "coupler": tuple(COUPLERS),
    "weighing": ("lever", "continuous"),
    "valve": ("head", "second", "none"),
    "parking_compounding": tuple(COMPOUNDING),
    "blending": tuple(BLENDINGS),
}
#: Words of brakes that are not modelled, and what to take instead.
NOT_MODELLED = {
    "vacuum": "A vacuum brake is not modelled: take distributor = uic with its force, fill_time and release_time."
}
#: Columns of free text.
TABLES = ("friction_table", "dynamic_table", "traction_table", "fade_table")
TEXTS = ("name", *TABLES)
#: Largest number of characters of a table.
LONGEST_TABLE = 400
#: All names, in the order in which files are written.
NAMES = (
    *("kind", "name", *VEHICLE, "brake", *FORCE, "friction", "friction_table", *AIR, *ELECTRIC, "dynamic_table"),
    *(*TRACTION, "traction_table", *HEAT, "fade_table", *TRACK, *PARKING),
    *(name for name in WORDS if name not in ("kind", "brake", "friction")),
    *COUPLING,
)


def longest_of(name: str) -> int:
    """Return the largest number of characters of a column of free text."""
    return LONGEST_TABLE if name in TABLES else LONGEST_NAME


def choices(name: str) -> tuple[str, ...]:
    """Return the words that a column may have."""
    return pneumatic() if name == "distributor" else tuple(WORDS[name])


def remedies(name: str) -> tuple[tuple[str, str], ...]:
    """Return words that a column may not have, each with its remedy."""
    return tuple(NOT_MODELLED.items()) if name in ("brake", "distributor") else ()


def columns() -> list[Column]:
    """Return the columns of a CSV file: empty cells leave a value to its default."""
    found = [
        Column(name, words=choices(name), required=name == "kind", filled=name == "kind", remedies=remedies(name))
        for name in WORDS
    ]
    found += [Column(name, filled=False, text=True, longest=longest_of(name)) for name in TEXTS]
    for name, (unit, least, most) in NUMBERS.items():
        found.append(Column(name, unit, least, most, filled=False, whole=name in WHOLE))
    return found


def number_with_unit(value: Any, unit: str) -> float:
    """Return a number, or a text with a number and a unit such as "60 t", in a unit; NaN if it is neither."""
    number = number_of(value)
    if math.isnan(number) and isinstance(value, str):
        found = number_in(value, unit)
        return math.nan if found is None else found
    return number

"""Columns of a consist: names, units, limits and words. Tables in docs/train.md, docs/train-brakes.md and
docs/train-couplers.md explain each.

A CSV file has them in its first row, a TOML file as keys of each [[vehicle]]; both also in German and French, with
words in cells as people write them.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import replace
from functools import lru_cache
from typing import Any

from brake_controller.distributors import BRAKES, pneumatic
from brake_controller.distributors.aar import RETAINERS
from brake_controller.electric_brake import BLENDINGS
from brake_controller.parking_brake import COMPOUNDING
from brake_controller.vehicle_brake import FORCELESS, FRICTIONS
from brake_controller.vigilance import PENALTIES
from products.train.cell_tables import CELL_TABLES
from products.train.consist import KINDS, LONGEST_VEHICLE
from products.train.notches import handles
from rbd_model.train.adhesion import ADHESIONS
from rbd_model.train.coupler import COUPLERS
from readers.cell_words import SEVERAL, spellings
from readers.column_names import advice
from readers.column_words import plain, with_columns
from readers.columns import LONGEST_TEXT, Column, word_read_as
from readers.quantity import Quantity, by_name
from readers.text import LONGEST_ROW, quoted, shown

#: Largest number of vehicles, and of characters of a name.
MOST, LONGEST_NAME = 2000, LONGEST_TEXT
#: Numbers with unit and limits. Columns of the vehicle itself, and of its resistance a + b v + c v^2.
VEHICLE = by_name(
    Quantity("count", "1", 1, MOST, whole=True),
    Quantity("load", "t", 0.0, 200.0, above_0=0.05),
    Quantity("mass", "t", 1.0, 300.0),
    Quantity("length", "m", 3.0, LONGEST_VEHICLE),
    Quantity("rotating", "%", 0.0, 100.0, above_0=0.3),
    Quantity("resistance_a", "N", 0.0, 1e5),
    Quantity("resistance_b", "N/(m/s)", 0.0, 1e4),
    Quantity("resistance_c", "N/(m/s)^2", 0.0, 1e3),
    Quantity("friction_ratio", "1", 0.0, 1.0),
    Quantity("friction_decay", "s/m", 0.0, 10.0),
    Quantity("tare", "t", 1.0, 300.0),
)
#: Columns that state the brake's force, one group of them in a row, and its friction.
FORCE = by_name(
    Quantity("lambda", "%", 5.0, 250.0),
    Quantity("deceleration", "m/s2", 0.01, 3.0),
    Quantity("brake_force", "kN", 0.1, 1000.0),
    Quantity("shoe_force", "kN", 0.1, 5000.0),
    Quantity("shoes", "1", 1, 96, whole=True),
    Quantity("cylinder_diameter", "mm", 50.0, 1000.0),
    Quantity("cylinders", "1", 1, 32, whole=True),
    Quantity("rigging_ratio", "1", 0.1, 50.0),
    Quantity("rigging_efficiency", "1", 0.1, 1.0),
    Quantity("return_force", "N", 0.0, 20e3),
    Quantity("friction_value", "1", 0.01, 1.0),
    Quantity("friction_fast", "1", 0.001, 1.0),
    Quantity("friction_speed", "km/h", 0.1, 1000.0),
    Quantity("friction_radius", "1", 0.1, 1.0),
    Quantity("brake_weight", "t", 0.0, 500.0, above_0=0.5),
    Quantity("net_braking_ratio", "%", 0.5, 250.0),
)
#: Columns of the air: cylinder, reservoirs and pipe; the driver's valve.
AIR = by_name(
    Quantity("full_pressure", "bar", 1.0, 8.0),
    Quantity("fill_time", "s", 0.5, 120.0),
    Quantity("release_time", "s", 0.5, 240.0),
    Quantity("auxiliary", "l", 5.0, 1000.0),
    Quantity("cylinder", "l", 0.5, 200.0),
    Quantity("pipe_diameter", "mm", 15.0, 60.0),
    Quantity("at", "1", 0.0, 1.0),
    Quantity("leak", "mm", 0.0, 10.0),
    Quantity("branch", "l", 0.0, 25.0),
    Quantity("delay", "s", 0.0, 9.0),
    Quantity("service_rate", "bar/s", 0.01, 5.0),
    Quantity("exhaust", "mm", 1.0, 30.0),
    Quantity("empty_load", "1", 0.3, 0.9),
)
#: Columns of a vacuum brake, and of its driver's valve.
VACUUM = by_name(
    Quantity("vacuum", "bar", 0.3, 0.9),
    Quantity("exhauster", "m3/min", 0.05, 100.0),
    Quantity("ejector", "m3/min", 0.0, 100.0),
)
#: Columns of the electric command and of the electric brake.
ELECTRIC = by_name(
    Quantity("dead_time", "s", 0.0, 9.0),
    Quantity("dynamic_force", "kN", 0.1, 1000.0),
    Quantity("dynamic_power", "kW", 10.0, 20e3),
    Quantity("dynamic_fade", "km/h", 0.0, 100.0),
    Quantity("dynamic_rise", "s", 0.0, 30.0),
    Quantity("blending_speed", "km/h", 0.0, 300.0),
)
#: Columns of the motors.
TRACTION = by_name(
    Quantity("traction_force", "kN", 0.1, 2000.0),
    Quantity("traction_power", "kW", 10.0, 30e3),
    Quantity("traction_rise", "s", 0.0, 60.0),
    Quantity("traction_cut_out", "bar", 0.0, 4.8),
)
#: Columns of the heat of brakes; those of one wheel or disc and of the blocks or pads on it, except its number.
HEAT = by_name(
    Quantity("wheel_mass", "kg", 1.0, 5000.0),
    Quantity("wheels", "1", 1, 96, whole=True),
    Quantity("disc_mass", "kg", 1.0, 5000.0),
    Quantity("discs", "1", 1, 96, whole=True),
    Quantity("heat_share", "1", 0.0, 1.0),
    Quantity("cooling", "W/K", 0.0, 1000.0),
    Quantity("cooling_speed", "W.s/(K.m)", 0.0, 100.0),
    Quantity("thickness", "mm", 2.0, 200.0),
    Quantity("rubbed_area", "m2", 0.01, 2.0),
    Quantity("block_mass", "kg", 0.1, 500.0),
    Quantity("block_heat", "J/(kg.K)", 100.0, 3000.0),
    Quantity("block_cooling", "W/K", 0.0, 100.0),
    Quantity("block_cooling_speed", "W.s/(K.m)", 0.0, 10.0),
)
#: Columns of track brakes: magnets on the rails, eddy currents in them, and the pressure of the pipe that applies both.
TRACK = by_name(
    Quantity("magnetic_attraction", "kN", 1.0, 2000.0),
    Quantity("magnetic_friction", "1", 0.01, 0.5),
    Quantity("magnetic_fast", "1", 0.001, 0.5),
    Quantity("magnetic_speed", "km/h", 0.1, 1000.0),
    Quantity("magnetic_lift", "km/h", 0.0, 100.0),
    Quantity("magnetic_from", "km/h", 0.0, 200.0),
    Quantity("magnetic_rise", "s", 0.0, 10.0),
    Quantity("eddy_force", "kN", 0.1, 500.0),
    Quantity("eddy_speed", "km/h", 10.0, 1000.0),
    Quantity("eddy_rise", "s", 0.0, 10.0),
    Quantity("track_brake_pressure", "bar", 0.0, 4.8),
)
#: Columns of the hand brake or spring-applied parking brake.
PARKING = by_name(
    Quantity("parking_force", "kN", 0.1, 1000.0),
    Quantity("parking_gradient", "permille", 0.1, 300.0),
    Quantity("parking_time", "s", 0.0, 300.0),
)
#: Columns of the wheel-slide protection: its sensor, controller and magnet valves.
SLIDE = by_name(
    Quantity("wheel_diameter", "mm", 300.0, 1500.0),
    Quantity("encoder_teeth", "1", 8, 1000, whole=True),
    Quantity("sample_time", "ms", 1.0, 1000.0),
    Quantity("valve_time", "s", 0.0, 1.0),
    Quantity("vent_time", "s", 0.25, 20.0),
)
#: Columns of the cab: direct brake, main reservoir with compressor and governor, vigilance device.
CAB = by_name(
    Quantity("direct_pressure", "bar", 0.5, 10.0),
    Quantity("direct_fill_time", "s", 0.4, 60.0),
    Quantity("direct_release_time", "s", 0.4, 60.0),
    Quantity("direct_volume", "l", 0.5, 200.0),
    Quantity("main_reservoir", "l", 20.0, 10e3),
    Quantity("compressor", "l/min", 0.0, 30e3, above_0=10.0),
    Quantity("cut_in", "bar", 1.0, 15.0),
    Quantity("cut_out", "bar", 2.0, 16.0),
    Quantity("start_pressure", "bar", 0.0, 16.0),
    Quantity("vigilance_time", "s", 1.0, 3600.0),
    Quantity("warning_time", "s", 0.5, 600.0),
)
#: Columns of the coupler behind a vehicle, instead of numbers of the built-in one.
COUPLING = by_name(
    Quantity("coupler_stiffness", "MN/m", 0.1, 1000.0),
    Quantity("coupler_preload", "kN", 0.0, 500.0),
    Quantity("coupler_slack", "mm", 0.0, 200.0, above_0=0.2),
    Quantity("coupler_damping", "1", 0.0, 0.95),
    Quantity("coupler_strength", "kN", 10.0, 10e3),
)
#: Columns of a vehicle that is computed in detail, with its name.
DETAIL = by_name(Quantity("level", "1", 1, 3, whole=True), Quantity("contact_model", "1", 1, 3, whole=True))
NUMBERS = (
    VEHICLE | FORCE | AIR | ELECTRIC | TRACTION | HEAT | TRACK | PARKING | COUPLING | SLIDE | DETAIL | VACUUM | CAB
)
#: Columns of words with a choice. `choices` has the names of distributors, those that there are when a file is read.
WORDS: dict[str, Collection[str]] = {
    "kind": tuple(KINDS),
    "brake": tuple(BRAKES),
    "distributor": (),
    "retainer": RETAINERS,
    "accelerated_release": ("yes", "no"),
    "position": ("P", "G", "R", "R+Mg"),
    "friction": (*FRICTIONS, *FORCELESS),
    "adhesion": tuple(ADHESIONS),
    "coupler": tuple(COUPLERS),
    "weighing": ("lever", "continuous"),
    "valve": ("head", "second", "none"),
    "parking_compounding": tuple(COMPOUNDING),
    "blending": tuple(BLENDINGS),
    "direct_admission": ("yes", "no"),
    "handle": tuple(handles()),
    "vigilance_penalty": tuple(PENALTIES),
}
#: Words of another column, and what to write.
OF_DISTRIBUTOR = {"vacuum": "Write distributor = vacuum."}
#: Columns of free text, a name, files and tables, with their largest numbers of characters.
TEXTS = {"name": LONGEST_NAME, "protection": 400, "detail": 400} | dict.fromkeys(CELL_TABLES, 400)
#: Columns of brake sheets that have no effect on a train, with the reason: they are left out, and told.
IDLE = {
    "number": "numbers of vehicles have no effect",
    "axles": "no equation here has their number",
    "remark": "remarks have no effect",
    "class": "letters of a class have no effect",
    "train_type": "positions of the brakes have its effect",
    "top_speed": "brakes do not depend on it",
}
#: All names, in the order in which files are written.
NAMES = (
    *("kind", "name", *VEHICLE, "brake", *FORCE, "friction", "friction_table", *AIR, *ELECTRIC, "dynamic_table"),
    *(*TRACTION, "traction_table", *HEAT, "fade_table", *TRACK, *PARKING),
    *(name for name in WORDS if name not in ("kind", "brake", "friction")),
    *COUPLING,
    *("protection", *SLIDE),
    *VACUUM,
    *("detail", *DETAIL),
    *CAB,
)


def choices(name: str) -> tuple[str, ...]:
    """Return the words that a column may have."""
    return pneumatic() if name == "distributor" else tuple(WORDS[name])


def remedies(name: str) -> dict[str, str]:
    """Return words that a column may not have, as `plain` returns them, each with its remedy."""
    return SEVERAL.get(name, {}) | (OF_DISTRIBUTOR if name == "brake" else {})


@lru_cache
def _column_of_words(name: str, words: tuple[str, ...]) -> Column:
    is_kind = name == "kind"
    found = Column(name, words=words, required=is_kind, filled=is_kind, as_written=True)
    return replace(found, remedies=tuple(remedies(name).items()), meanings=spellings(name, words))


def columns() -> list[Column]:
    """Return the columns of a CSV file: empty cells leave a value to its default."""
    found = [_column_of_words(name, choices(name)) for name in WORDS]
    found += [Column(name, filled=False, text=True, longest=longest) for name, longest in TEXTS.items()]
    found += [
        Column(number.name, number.unit, number.least, number.most, False, False, (), number.whole, as_written=True)
        for number in NUMBERS.values()
    ]
    idle = [Column(name, filled=False, text=True, longest=LONGEST_ROW) for name in IDLE]
    return [*sorted(found, key=lambda column: NAMES.index(column.name)), *idle]


def values_of(
    row: Mapping[str, Any], couplers: Iterable[str] = (), notes: dict[str, None] | None = None
) -> dict[str, Any]:
    """Return the values of a row, each in the unit of its column and within its limits. Raises ValueError.

    couplers: names of the [[coupler]] tables of its file; notes: get a message for each name and word that is read as
    another.
    """
    notes = {} if notes is None else notes
    if not isinstance(row, Mapping):
        raise ValueError(f"a vehicle must be names with values; got {shown(row)}. Write kind = 'wagon'.")
    found: dict[str, Any] = {}
    for name, value in with_columns(row, (*NAMES, *IDLE), notes).items():
        if name in WORDS:
            words = (*choices(name), *(couplers if name == "coupler" else ()))
            found[name] = _word(_column_of_words(name, words), value, notes)
        elif name in IDLE:
            notes[idle_note(name)] = None
        elif name in TEXTS:
            if not isinstance(value, str) or len(value) > TEXTS[name] or not value.isprintable():
                limit = f"printable text of at most {TEXTS[name]} characters"
                raise ValueError(f"{name} must be {limit}; got {shown(value)}. Correct it.")
            found[name] = value.strip()
        elif name in NUMBERS:
            found[name] = NUMBERS[name].read(value)
        else:
            raise ValueError(f"the name {quoted(str(name))} is unknown. {advice(str(name), (*NAMES, *IDLE))}")
    if "kind" not in found:
        raise ValueError(f"a vehicle must have a kind, one of {', '.join(KINDS)}. Add it.")
    return found


def _word(column: Column, value: Any, notes: dict[str, None]) -> str:
    """Return the word of a value. Raises ValueError if it is not allowed."""
    word = column.word_of(value) if isinstance(value, str) else None
    if word is None:
        text = plain(value) if isinstance(value, str) else ""
        remedy = dict(column.remedies).get(text, "Choose one.")
        raise ValueError(f"{column.name} must be one of {', '.join(column.words)}; got {shown(value)}. {remedy}")
    if word != value and plain(word) != plain(value):
        notes[word_read_as(value, column.name, word)] = None
    return word


def idle_note(name: str) -> str:
    """Return the note about a column that is left out."""
    return f"column {name} is left out: {IDLE[name]}"


def si(values: Mapping[str, Any], name: str, default: float = 0.0) -> float:
    """Return the value of a column in SI units, or the default [SI] if the row does not have it."""
    return NUMBERS[name].scale * float(values[name]) if name in values else default

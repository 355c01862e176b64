"""Words by which loggers name what they record, in English, German, French and Spanish, and how they write units.

Only names that can mean one quantity are here. A name of one letter counts if its unit confirms it.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from types import MappingProxyType

from readers.column_words import plain as plain
from readers.column_words import words_of
from readers.units import quantity_of

#: Names of each quantity, words joined by underscores. Keys: names of variables, the first that exists is meant; if
#: several exist, the name is ambiguous unless its unit decides.
_FAMILIES: dict[tuple[str, ...], tuple[str, ...]] = {
    ("time",): (
        *("t", "time", *words_of("time"), "tiempo", "timestamp", "time_stamp", "zeitstempel", "datetime", "date_time"),
        *("datum_zeit", "elapsed", "elapsed_time", "epoch", "unix_time", "unixtime", "utc", "utc_time", "uhrzeit"),
        *("datum_uhrzeit", "heure", "heure_utc", "horodatage", "date_heure", "temps_utc", "timestamp_utc"),
        *("seconds", "time_of_day", "messzeit", "zeit_utc", "time_utc"),
    ),
    ("speed",): (
        *("v", "speed", "velocity", *words_of("speed"), "velocidad", "vehicle_speed", "train_speed"),
        *("v_train", "v_vehicle", "v_zug", "v_ist", "zuggeschwindigkeit", "fahrgeschwindigkeit", "gps_speed", "v_gps"),
        *(
            "speed_gps",
            "ground_speed",
            "actual_speed",
            "vitesse_train",
            "vitesse_du_train",
            "istgeschwindigkeit",
            "train_velocity",
        ),
    ),
    ("distance",): (*("distance", *words_of("distance"), "s", "distance_travelled", "travelled_distance", "fahrweg"),),
    ("acceleration",): ("acceleration", "a", "beschleunigung", "accel"),
    ("wheel_speed", "angular_velocity"): (
        *("wheel_speed", "speed_wheel", "axle_speed", "speed_axle", "wheelset_speed", "v_wheel", "v_axle", "v_rad"),
        *("v_achse", "v", "speed", "n", "omega", "radgeschwindigkeit", "achsgeschwindigkeit", "raddrehzahl"),
        *("achsdrehzahl", "radsatzdrehzahl", "drehzahl", "n_wheel", "n_axle", "n_rad", "n_achse", "wheel_rpm"),
        *("axle_rpm", "angular_velocity", "angular_speed", "winkelgeschwindigkeit", "vitesse_essieu", "vitesse_roue"),
    ),
    ("pressure", "cylinder_pressure"): (
        *("brake_cylinder_pressure", "cylinder_pressure", "bc_pressure", "bcp", "c_pressure", "c_druck", "p_c", "p_bc"),
        *("p_cyl", "p_zyl", "bremszylinderdruck", "zylinderdruck", "pression_cylindre", "brake_cylinder"),
    ),
    ("pressure", "cylinder_pressure", "pressure_demand"): ("p", "pressure", "druck", "pression", "brake_pressure"),
    ("pressure_demand",): (
        "pressure_demand",
        "demanded_pressure",
        "p_demand",
        "p_soll",
        "solldruck",
        "target_pressure",
    ),
    ("brake_torque", "torque"): ("torque", "brake_torque", "bremsmoment", "drehmoment", "m_brems", "couple_frein"),
    ("valve",): ("valve", "ventil", "dump_valve", "wsp_valve"),
}
FAMILIES = MappingProxyType(_FAMILIES)
#: Names that count only with a unit of the right quantity.
SHORT = {"s", "a", "v", "n", "p", "t", "p_c"}
#: Quantity of each variable of FAMILIES; a wheel's speed is also measured as an angular velocity.
QUANTITIES = {
    "time": ("time",),
    "speed": ("speed",),
    "distance": ("length",),
    "acceleration": ("acceleration",),
    "wheel_speed": ("speed", "angular velocity"),
    "angular_velocity": ("angular velocity", "speed"),
    "pressure": ("pressure",),
    "cylinder_pressure": ("pressure",),
    "pressure_demand": ("pressure",),
    "brake_torque": ("torque",),
    "torque": ("torque",),
    "valve": ("ratio",),
}
#: Last words of names that are units written without signs, by quantity.
SUFFIXES = {
    "time": {"s": "s", "sec": "s", "sek": "s", "seconds": "s", "ms": "ms", "us": "us", "min": "min", "h": "h"},
    "speed": {"kmh": "km/h", "km_h": "km/h", "kph": "km/h", "kmph": "km/h", "mph": "mph", "mps": "m/s", "m_s": "m/s"},
    "length": {"m": "m", "km": "km"},
    "acceleration": {"mps2": "m/s2", "m_s2": "m/s2"},
    "angular velocity": {"rpm": "rpm", "rad_s": "rad/s", "radps": "rad/s"},
    "pressure": {"bar": "bar", "mbar": "mbar", "pa": "Pa", "kpa": "kPa", "mpa": "MPa"},
    "torque": {"nm": "N.m", "knm": "kN.m"},
    "force": {"n": "N", "kn": "kN"},
}


def numbered(words: str) -> tuple[str, int | None]:
    """Return the words without the only whole number among them, and this number: `axle_1_speed`, `v1`."""
    parts = re.findall(r"[a-z]+|\d+", words)
    digits = [part for part in parts if part.isdigit()]
    if len(digits) != 1 or not 1 <= int(digits[0]) <= 99:
        return words, None
    return "_".join(one for one in parts if not one.isdigit()), int(digits[0])


def suffixed(words: str) -> list[tuple[str, str]]:
    """Return each name and unit that words may be, if the last ones are a unit: `time_ms`, `v_km_h`."""
    found = []
    for units in SUFFIXES.values():
        for suffix, unit in units.items():
            if words.endswith(f"_{suffix}"):
                found.append((words[: -len(suffix) - 1], unit))
    return found


def meant(words: str, unit: str, variables: Mapping[str, str]) -> list[str]:
    """Return the variables that words can mean; unit: "" if the file has none; variables: their units by name."""
    bare, number = numbered(words)
    short = bare in SHORT
    found: list[str] = []
    for bases, names in FAMILIES.items():
        if bare not in names:
            continue
        for base in bases:
            fits = quantity_of(unit) in QUANTITIES[base] if unit else not short or (base == "time" and number is None)
            own = base if number is None else f"{base}_{number}"
            if fits and own in variables and own not in found:
                found.append(own)
    return _by_unit(found, unit, variables)


def _by_unit(found: list[str], unit: str, variables: Mapping[str, str]) -> list[str]:
    """Return those of several variables whose unit needs no wheel diameter, if there are any."""
    direct = [one for one in found if quantity_of(variables[one]) == quantity_of(unit)] if unit else found
    return direct or found

"""The brake of a vehicle file: parameters of the FMU from a deceleration, a brake weight, a force or cylinder data."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from scipy.optimize import brentq

from brake_controller.brake_weight import force_beside
from brake_controller.discs import MEAN_PAD_FRICTION, DiscParameters, axle_discs
from brake_controller.parameters import qr30
from brake_controller.shoe_friction import CAST_IRON_P6, CAST_IRON_P10, COMPOSITE, COMPOSITE_BY_FORCE, CONSTANT
from products.braked_vehicle import TIMED, TIMED_DISCS
from products.machine import APPLICATION_TIME, FULL_PRESSURE, RELEASE_TIME, coach_brake, of_pads
from products.train.brake_columns import CYLINDER
from products.train.consist_columns import NUMBERS
from products.train.row_statements import percentage_of
from products.vehicle_entries import choice_of, number_of
from products.vehicle_sheet import SheetBrake
from readers.column_words import with_columns
from readers.quantity import Quantity, by_name
from readers.units import si_of

#: Friction laws of shoes by their names in a file, which are those of consists; and by their older names.
FRICTION_LAWS = {
    "constant": CONSTANT,
    "cast-iron-p6": CAST_IRON_P6,
    "cast-iron-p10": CAST_IRON_P10,
    "composite": COMPOSITE_BY_FORCE,
    "composite-k": COMPOSITE,
}
OLDER_LAWS = {"cast-iron": "cast-iron-p6"}
#: Mean friction of shoes if the file gives none: that of the built-in coach.
SHOE_FRICTION = 0.25
#: Gauge pressure below which a cylinder is released [Pa] (UIC 540).
RELEASED = 40e3
#: Speed from which pads on cold discs have the stated friction on average over the distance [m/s].
ASSESSED = 120.0 / 3.6
#: Entries that state the brake; a file has those of one line.
STATEMENTS = (
    ("deceleration",),
    ("percentage",),
    ("brake_weight",),
    ("force",),
    ("cylinder_diameter", "cylinders", "rigging_ratio"),
)


def _as_in_consists(name: str, column: str, text: str) -> Quantity:
    """Return an entry in SI units with the limits of a column of consists, which states the same in its own unit."""
    of_row = NUMBERS[column]
    unit, scale = ("%", 1.0) if of_row.unit == "%" else (si_of(of_row.unit), of_row.scale)
    least = max(of_row.least, of_row.above_0)
    return Quantity(name, unit, scale * least, scale * of_row.most, text, of_row.whole)


BRAKE_ENTRIES = by_name(
    _as_in_consists("deceleration", "deceleration", "of the full brake on a dry rail, after build-up"),
    _as_in_consists("percentage", "lambda", "or lambda: brake weight percentage (UIC 544-1, from 100 km/h)"),
    _as_in_consists("brake_weight", "brake_weight", "lambda times the mass (UIC 544-1)"),
    _as_in_consists("force", "brake_force", "of the full brake at the rims of all wheelsets"),
    _as_in_consists("cylinder_diameter", "cylinder_diameter", "of each cylinder"),
    _as_in_consists("cylinders", "cylinders", "cylinders of the vehicle"),
    _as_in_consists("rigging_ratio", "rigging_ratio", "force of all shoes or pads over the force of their cylinder"),
    _as_in_consists("rigging_efficiency", "rigging_efficiency", "effective over calculated force"),
    _as_in_consists("return_force", "return_force", "of the return spring at each piston"),
    _as_in_consists("friction", "friction_value", "mean friction of shoes or pads"),
    Quantity("friction_law", "1", 0, 0, f"of shoes: {', '.join(FRICTION_LAWS)}"),
    Quantity("shoes", "1", 1, 16, "shoes on each wheelset; consists count those of the vehicle", whole=True),
    Quantity("friction_radius", "m", 0.01, 1.0, "radius at which pads rub"),
    _as_in_consists("full_pressure", "full_pressure", "of the cylinders at full brake"),
    _as_in_consists("application_time", "fill_time", "from 0 to 95 % of the full pressure"),
    _as_in_consists("release_time", "release_time", "from the full pressure to 0.4 bar (UIC 540)"),
)
#: Entries that state a column of consists under another name, by this column.
ENTRY_OF_COLUMN = {
    "lambda": "percentage",
    "brake_force": "force",
    "friction_value": "friction",
    "fill_time": "application_time",
}
#: Columns of consists that state the same as an entry. There `shoes` are those of a vehicle, `friction_radius` a ratio.
OF_CONSISTS = {*ENTRY_OF_COLUMN, *(BRAKE_ENTRIES.keys() & NUMBERS.keys())} - {"shoes", "friction_radius"}
#: Entries of the rigging, which only cylinder data use, and those of one kind of brake alone.
OF_RIGGING = ("rigging_efficiency", "return_force")
OF_TREADS, OF_DISCS = ("friction_law", "shoes"), ("friction_radius",)


def with_entry_names(table: Mapping[str, Any]) -> dict[str, Any]:
    """Return the table [brake] of a file with the names of its entries instead of those of consists, in any language.

    Raises ValueError.
    """
    found: dict[str, Any] = {}
    for key, value in with_columns(table, OF_CONSISTS).items():
        name = ENTRY_OF_COLUMN.get(key, key)
        if name in found:
            raise ValueError(f"[brake] {name} must be given once; got {key} beside it. Leave one out.")
        found[name] = value
    return found


def brake_of_sheet(
    table: Mapping[str, Any],
    turning_mass: float,
    axles: int,
    radius: float,
    resistance: Sequence[float] = (0.0, 0.0, 0.0),
    mass: float = math.nan,
) -> SheetBrake:
    """Return the brake of each wheelset from the table [brake] of a file.

    Takes turning_mass, that with the rotating parts, and mass [kg], radius [m], resistance [SI].
    """
    acts_on = choice_of(("treads", "discs"), table.get("acts_on", "treads"), "[brake] acts_on", "Choose one.")
    given = {
        key: number_of(BRAKE_ENTRIES[key], value, f"[brake] {key}")
        for key, value in table.items()
        if key not in ("acts_on", "friction_law")
    }
    stated = _statement(given)
    law = _law(table, acts_on)
    unused: tuple[str, ...] = OF_DISCS if acts_on == "treads" else OF_TREADS
    unused += () if stated[0] == "cylinder_diameter" else OF_RIGGING
    for key in unused:
        if key in table:
            raise ValueError(f"[brake] {key} has no effect here; got it beside {stated[0]} on {acts_on}. Leave it out.")
    pressure = given.get("full_pressure", FULL_PRESSURE)
    arm = given.get("friction_radius", axle_discs().friction_radius) if acts_on == "discs" else radius
    friction = given.get("friction", MEAN_PAD_FRICTION if acts_on == "discs" else SHOE_FRICTION)
    force = _force(given, stated, turning_mass, resistance, mass)
    rigging = _rigging(given, stated, pressure, axles, friction * arm, force * radius)
    timed = {
        "application_time": given.get("application_time", APPLICATION_TIME),
        "release_time": _to_5_percent(given["release_time"], pressure) if "release_time" in given else RELEASE_TIME,
    }
    values = rigging | timed | {"supply_pressure": pressure}
    if acts_on == "discs":
        values |= _on_discs(rigging, friction, arm, radius, turning_mass / axles)
    else:
        values |= {"brake_kind": float(TIMED), "friction_law": float(law), "constant_shoe_friction": friction}
        values |= {"shoes": given["shoes"]} if "shoes" in given else {}
    torque = _normal_force(rigging, pressure) * friction * arm
    lasts = timed["application_time"]
    return SheetBrake(acts_on, values, pressure, torque, lasts, _assumed(table, acts_on, stated), dict(table))


def _to_5_percent(release_time: float, pressure: float) -> float:
    """Return the time from a full pressure [Pa] to 5 % of it [s] of the exponential fall that ends at 0.4 bar."""
    return release_time * math.log(20.0) / math.log(max(pressure / RELEASED, math.e))


def _statement(given: Mapping[str, float]) -> tuple[str, ...]:
    """Return the entries that state the brake. Raises ValueError unless they are those of one line of STATEMENTS."""
    found = [those for those in STATEMENTS if any(key in given for key in those)]
    choice = "deceleration, percentage, brake_weight, force, or cylinder_diameter with cylinders and rigging_ratio"
    if len(found) != 1:
        got = " and ".join(next(key for key in those if key in given) for those in found) or "none"
        raise ValueError(f"[brake] must be stated once, by {choice}; got {got}.")
    missing = [key for key in found[0] if key not in given]
    if missing:
        raise ValueError(f"[brake] {missing[0]} must be given beside {found[0][0]}; got none.")
    return found[0]


def _law(table: Mapping[str, Any], acts_on: str) -> int:
    given = table.get("friction_law", "constant")
    given = OLDER_LAWS.get(given, given) if isinstance(given, str) else given
    name = choice_of(FRICTION_LAWS, given, "[brake] friction_law", "Choose one.")
    if name != "constant" and "friction" in table:
        raise ValueError(f"[brake] friction must be left out with friction_law {name}, which gives it; got both.")
    return FRICTION_LAWS[name]


def _force(
    given: Mapping[str, float],
    stated: tuple[str, ...],
    turning_mass: float,
    resistance: Sequence[float],
    mass: float,
) -> float:
    """Return the force at all rims [N]; 0 with cylinder data, which give it by themselves."""
    if stated == ("deceleration",):
        return given["deceleration"] * turning_mass
    if stated == ("percentage",):
        return force_beside(resistance, given["percentage"], turning_mass)
    if stated == ("brake_weight",):
        return force_beside(resistance, percentage_of(1e-3 * given["brake_weight"], 1e-3 * mass), turning_mass)
    return given.get("force", 0.0)


def _rigging(
    given: Mapping[str, float], stated: tuple[str, ...], pressure: float, axles: int, lever: float, torque: float
) -> dict[str, float]:
    """Return the parameters from pressure to the normal force on one wheelset, section 6.2.3.

    lever: friction times radius [m]; torque: of all wheelsets at the full pressure [N.m].
    """
    if stated[0] == "cylinder_diameter":
        area = math.pi / 4 * given["cylinder_diameter"] ** 2
        spring = given.get("return_force", CYLINDER["return_force"])
        if not pressure * area > spring:
            raise ValueError(
                f"[brake] return_force must be below full_pressure times the piston's area, {pressure * area:.4g} N;"
                f" got {spring:g} N."
            )
        return {
            "wheelset_share": 1.0,
            "force_per_pressure": given["cylinders"] / axles * area * given["rigging_ratio"],
            "touch_pressure": spring / area,
            "rigging_efficiency": given.get("rigging_efficiency", CYLINDER["rigging_efficiency"]),
        }
    usual = qr30()
    effective = usual.rigging_efficiency * lever * pressure
    return {
        "wheelset_share": 1.0,
        "force_per_pressure": torque / axles / effective,
        "touch_pressure": 0.0,
        "rigging_efficiency": usual.rigging_efficiency,
    }


def _normal_force(rigging: Mapping[str, float], pressure: float) -> float:
    effective = rigging["wheelset_share"] * rigging["rigging_efficiency"] * rigging["force_per_pressure"]
    return effective * (pressure - rigging["touch_pressure"])


def friction_at_rest(mean: float, slower: float, mass: float, disc: DiscParameters) -> float:
    """Return the friction of pads at rest on cold discs with which a stop has the distance of the mean friction.

    The stop is one from ASSESSED without build-up. Friction falls with speed and with the heat of the disc, which grows
    with the energy of the stop and is not cooled (`brake_controller/discs.py`): S = integral of v dv / a(v).

    Takes mass [kg].
    """
    speed = np.linspace(0.0, ASSESSED, 2001)
    heat = disc.disc_heat_share * mass / 2 * (ASSESSED**2 - speed**2)
    warmer = heat / (disc.disc_mass * disc.disc_heat_capacity)
    fall = disc.pad_friction_over_speed * slower * speed + disc.pad_friction_over_temperature * warmer

    def longer(at_rest: float) -> float:
        friction = np.maximum(at_rest - fall, disc.least_pad_friction)
        return float(np.trapezoid(speed / friction, speed)) - ASSESSED**2 / (2 * mean)

    if longer(mean) <= 0.0:  # friction that does not fall, or is held from below
        return mean
    return float(brentq(longer, mean, mean + 2 * float(np.max(fall)) + 1e-9))


def _on_discs(
    rigging: Mapping[str, float], friction: float, arm: float, radius: float, mass: float
) -> dict[str, float]:
    """Return the parameters of pads on discs; mass: on one wheelset, with that of its rotation [kg].

    The FMU presses its pads by a fixed multiple of the shoes' force (`of_pads`).
    """
    disc, shoes = axle_discs(), coach_brake()
    multiple = of_pads(shoes, disc) / shoes.force_per_pressure
    return {
        "brake_kind": float(TIMED_DISCS),
        "force_per_pressure": rigging["force_per_pressure"] / multiple,
        "friction_radius": arm,
        "pad_friction_at_rest": friction_at_rest(friction, arm / radius, mass, disc),
    }


def _assumed(table: Mapping[str, Any], acts_on: str, stated: tuple[str, ...]) -> dict[str, str]:
    """Return how the values were found that the table does not give."""
    usual = {
        "acts_on": "treads",
        "full_pressure": f"{FULL_PRESSURE:g} Pa, as the built-in coach",
        "application_time": f"{APPLICATION_TIME:g} s, as the built-in coach",
        "release_time": f"{RELEASE_TIME:g} s, as the built-in coach",
    }
    if acts_on == "discs":
        usual["friction"] = (
            f"{MEAN_PAD_FRICTION:g} on average in a stop from 120 km/h, falling as with the built-in discs"
        )
        usual["friction_radius"] = f"{axle_discs().friction_radius:g} m, as the built-in discs"
    elif "friction_law" not in table:
        usual["friction"] = f"{SHOE_FRICTION:g}, constant, as the built-in coach"
    if stated[0] == "cylinder_diameter":
        usual["rigging_efficiency"] = f"{CYLINDER['rigging_efficiency']:g}, as in consists"
        usual["return_force"] = f"{CYLINDER['return_force']:g} N, as in consists"
    found = {f"[brake] {key}": text for key, text in usual.items() if key not in table}
    if table.get("friction_law") == "composite":
        found["[brake] friction_law"] = "composite over force and speed, as in consists; once it meant composite-k"
    return found

"""Mass and brake of a vehicle, which a row of a consist may state in several ways, as the columns that build it.

A brake weight B [t] of a mass m [t] is lambda = 100 B / m (UIC 544-1). A net braking ratio is a force of shoes over the
weight (AAR S-401); American cars that state no force have that of `net_braking_ratio.py`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from brake_controller.distributors import distributors
from brake_controller.distributors.aar import FreightCar
from brake_controller.net_braking_ratio import EMPTY as EMPTY_RATIO
from brake_controller.net_braking_ratio import EMPTY_LIMITS, LOADED_LIMITS, SHOES, shoe_force
from brake_controller.net_braking_ratio import LOADED as LOADED_RATIO
from products.train.consist import EMPTY, EMPTY_UP_TO, PERCENTAGE
from products.train.consist_columns import FORCE
from rbd_model.train.vehicle import GRAVITY

Row = Mapping[str, Any]
#: Columns that state a brake's force, one of them in a row.
STATEMENTS = (
    *("lambda", "deceleration", "brake_force", "shoe_force", "cylinder_diameter", "brake_weight", "net_braking_ratio"),
)
#: Load of a wagon that states neither load nor mass [t].
LOAD = 60.0
#: Positions whose times are those of another one (UIC 540).
FILLED_AS = {"R": "P", "R+Mg": "P"}
#: Largest number of rows that a note lists.
MOST_PLACES = 10
#: Largest difference of masses and of brake weights that are rounded to tonnes: of three numbers, and of one [t]; of a
#: percentage that is rounded [%].
ROUNDED_MASSES, ROUNDED_WEIGHT, ROUNDED_PERCENTAGE = 1.5, 0.5, 0.5


def load_of(values: Row) -> float:
    """Return the load of a row, or that of its kind [t]."""
    return float(values.get("load", LOAD if values["kind"] == "wagon" else 0.0))


def mass_of(values: Row) -> float:
    """Return the mass with the load of a row [t]."""
    if "mass" in values:
        return float(values["mass"])
    return float(values.get("tare", 1e-3 * EMPTY[values["kind"]])) + load_of(values)


def check_mass(row: Row) -> None:
    """Check that a row states its mass once, or without a contradiction. Raises ValueError."""
    if "tare" not in row:
        if {"load", "mass"} <= row.keys():
            raise ValueError("a vehicle must have load or mass, not both. The mass is that with the load.")
        return
    if not {"load", "mass"} & row.keys():
        raise ValueError("tare must come with load or mass. Add the load, 0 if the vehicle is empty.")
    mass, tare = mass_of(row), row["tare"]
    whole = tare + row.get("load", max(mass - tare, 0.0))
    if abs(mass - whole) > ROUNDED_MASSES:
        raise ValueError(f"mass must be tare and load, {whole:g} t; got {mass:g} t. Correct or remove one of them.")


def check_statements(row: Row) -> None:
    """Check that a row states its brake once, or without a contradiction. Raises ValueError."""
    stated = [name for name in STATEMENTS if name in row]
    if stated == ["lambda", "brake_weight"]:
        percentage = 100.0 * row["brake_weight"] / mass_of(row)
        rounding = ROUNDED_PERCENTAGE + 100.0 * ROUNDED_WEIGHT / mass_of(row)
        if abs(percentage - row["lambda"]) <= rounding:
            return
        raise ValueError(
            f"lambda must be brake_weight over mass, {percentage:.4g} %; got {row['lambda']:g} %. Correct one, or leave"
            " one out."
        )
    if len(stated) > 1:
        raise ValueError(f"a brake must be stated once; got {' and '.join(stated)}. Leave all but one out.")


def is_american(values: Row) -> bool:
    """Return whether a row is a wagon with the reservoirs and valves of North American freight cars."""
    if values["kind"] != "wagon" or "distributor" not in values or values.get("brake", "pneumatic") != "pneumatic":
        return False
    return issubclass(distributors()[values["distributor"]].parameters, FreightCar)


def cut_out(values: Row) -> dict[str, Any]:
    """Return a row in which a brake weight of 0 is a vehicle without a brake, in any position."""
    if values.get("brake_weight") != 0.0 or values.get("brake", "none") not in ("none", "pneumatic"):
        return dict(values)
    return {name: value for name, value in values.items() if name not in ("brake_weight", "position")} | {
        "brake": "none"
    }


def resolved(values: Row, notes: dict[str, None]) -> dict[str, Any]:
    """Return a checked row with mass, lambda and shoe_force instead of other statements of these. Raises ValueError.

    notes: get a message for a force that is assumed.
    """
    found = dict(values)
    if "tare" in found:
        found["mass"] = mass_of(found)
        found = {name: value for name, value in found.items() if name not in ("tare", "load")}
    weight = found.pop("brake_weight", None)
    if weight is not None:
        found.setdefault("lambda", percentage_of(weight, mass_of(found)))
    ratio = found.pop("net_braking_ratio", None)
    mass = mass_of(found)
    if ratio is None and is_american(found) and not set(STATEMENTS) & found.keys():
        ratio, mass = _assumed_ratio(found, mass, notes)
    elif ratio is not None and is_american(found):
        notes |= dict.fromkeys(_unusual_ratio(ratio, mass))
    if ratio is not None:
        found["shoe_force"] = 1e-3 * shoe_force(ratio, 1e3 * mass * GRAVITY)
        if is_american(found):
            found.setdefault("shoes", SHOES)
    return found


def assumed_brakes(rows: Mapping[str, Row]) -> list[str]:
    """Return the note on brakes that some rows leave to their kind, where others state a percentage; rows by place."""
    if not any("lambda" in values for values in rows.values()):
        return []
    without = [
        (place, values["kind"])
        for place, values in rows.items()
        if values.get("brake") != "none" and not set(STATEMENTS) & values.keys()
    ]
    named = [f"{place} ({kind}{f', {PERCENTAGE[kind]:g} %' if kind in PERCENTAGE else ''})" for place, kind in without]
    more = f" and {len(named) - MOST_PLACES} more" if len(named) > MOST_PLACES else ""
    text = f"brakes without a stated force are assumed as those of the kind: {', '.join(named[:MOST_PLACES])}{more}"
    return [f"{text}. State brake_weight, 0 if there is no brake"] if named else []


def percentage_of(weight: float, mass: float) -> float:
    """Return the percentage of a brake weight and a mass, both [t], within the limits of lambda. Raises ValueError."""
    percentage, limits = 100.0 * weight / mass, FORCE["lambda"]
    if not limits.least <= percentage <= limits.most:
        raise ValueError(
            f"brake_weight must be {limits.least:g} to {limits.most:g} % of the mass of {mass:g} t; got {weight:g} t. "
            "Check both."
        )
    return percentage


def _unusual_ratio(ratio: float, mass: float) -> list[str]:
    """Return the note on a net braking ratio [%] outside of the limits of AAR for a car of a mass [t], if it is."""
    about, limits = ("loaded", LOADED_LIMITS) if mass > 1e-3 * EMPTY_UP_TO else ("empty", EMPTY_LIMITS)
    if limits[0] <= ratio <= limits[1]:
        return []
    return [
        f"a net braking ratio of {ratio:g} % is unusual for a car of {mass:.4g} t: AAR has {limits[0]:g} to "
        f"{limits[1]:g} % {about}. Check net_braking_ratio"
    ]


def _assumed_ratio(values: Row, mass: float, notes: dict[str, None]) -> tuple[float, float]:
    """Return the net braking ratio of an American car that states no force [%], and the mass of which it is one [t].

    With an empty/load device it is a share of that of the loaded car, which has the load of a wagon.
    """
    share = values.get("empty_load")
    is_loaded = mass > 1e-3 * EMPTY_UP_TO
    about, ratio = ("loaded", LOADED_RATIO) if is_loaded or share else ("empty", EMPTY_RATIO)
    if share:
        mass, ratio = 1e-3 * EMPTY["wagon"] + LOAD, share * ratio
        about = f"of a loaded car of {mass:g} t, times empty_load"
    notes[
        f"a wagon with distributor = {values['distributor']} that states no force has a net braking ratio of "
        f"{ratio:.3g} % {about}, assumed; AAR has {LOADED_LIMITS[0]:g} to {LOADED_LIMITS[1]:g} % loaded, "
        f"{EMPTY_LIMITS[0]:g} to {EMPTY_LIMITS[1]:g} % empty. State net_braking_ratio, or another force"
    ] = None
    return ratio, mass

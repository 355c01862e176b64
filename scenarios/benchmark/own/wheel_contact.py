"""A wheel on its rail, by contact model 3: strips over the whole overlap of the profiles."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import brentq

from rbd_model.contact.distance import LEFT, RIGHT, stand_of, touching
from rbd_model.contact.geometry import Pair, contact_at
from rbd_model.contact.normal import ContactArea, Steel, patches
from rbd_model.contact.profiles import from_points, wheel_s1002
from rbd_model.contact.strips import rolling
from readers.tables import Column, read_table
from scenarios.bench.wheel_on_strips import wheel_under_load

#: Profiles by their names in cases: a wheel, and the file of a rail, y and z [mm].
WHEELS = {"S1002": wheel_s1002}
RAILS = {"UIC60 of the benchmark, 1:40": Path(__file__).parents[2] / "contact" / "manchester_rail.csv"}
#: y of the gauge face of that rail, 14 mm below its top [m].
GAUGE_FACE = -43.0315e-3
#: Least and largest approach of wheel and rail under a load [m].
APPROACHES = 1e-6, 400e-6


def answer(inputs: Mapping[str, Any]) -> dict[str, float]:
    """Return place [m], angle [rad], forces [N] and pressure [Pa]; none for a profile that has no such name here."""
    if inputs["wheel_profile"] not in WHEELS or inputs["rail_profile"] not in RAILS:
        return {}
    names = ("wheel_profile", "rail_profile", "radius", "gauge", "flange_back", "tape_circle_from_back")
    pair = pair_of(*(inputs[name] for name in names))
    steel = Steel(inputs["shear_modulus"], inputs["poisson_ratio"])
    return under_weight(pair, steel, inputs) if inputs["load_axis"] == "vertical" else at_rest(pair, steel, inputs)


@lru_cache
def pair_of(wheel: str, rail: str, radius: float, gauge: float, back: float, tape: float) -> Pair:
    """Return a pair of profiles on both sides; lengths in m."""
    read = read_table(RAILS[rail], [Column("y_mm"), Column("z_mm")])
    y, z = (read.numbers[name] / 1e3 for name in ("y_mm", "z_mm"))
    return Pair(WHEELS[wheel](), from_points(rail, rail, y, z), radius, back / 2 + tape, gauge / 2 - GAUGE_FACE)


def under_weight(pair: Pair, steel: Steel, inputs: Mapping[str, Any]) -> dict[str, float]:
    """Return the contact of a rolling wheel that carries a vertical load.

    Axes of the case: y to the right, z down. The left wheel's axes here: y outwards, z up.
    """
    side = LEFT if inputs["wheel"] == "left" else RIGHT
    stand = stand_of(side, -inputs["lateral"], 0.0, inputs["roll"], -inputs["yaw"])
    motion = rolling(stand, inputs["speed"], -inputs["pitch_rate"])
    found = wheel_under_load(pair, steel, inputs["friction"], stand, motion, inputs["load"])
    along, across = (-float(one) for one in found.force[:2])
    return {
        "place": -side * found.place,
        "angle": side * found.angle,
        "force_along": along,
        "force_across": -side * across,
        "pressure": found.pressure,
    }


def at_rest(pair: Pair, steel: Steel, inputs: Mapping[str, Any]) -> dict[str, float]:
    """Return the contact of the left wheel pressed with a normal force, at the roll of a wheelset on both rails."""
    stand = stand_of(LEFT, inputs["lateral"], 0.0, contact_at(pair, inputs["lateral"]).roll, 0.0)
    top, _ = touching(pair, stand)

    def at(approach: float) -> list[ContactArea]:
        return patches(pair, replace(stand, height=top - approach), steel)

    load = inputs["load"]
    found = at(brentq(lambda approach: sum(one.load for one in at(approach)) - load, *APPROACHES, xtol=1e-9))
    on_wheel, slope, weights = (
        np.concatenate(values)
        for values in zip(*((one.strips.on_wheel, one.strips.angle, one.overlap) for one in found), strict=True)
    )
    place = float(np.average(on_wheel, weights=weights)) + pair.wheel_half_distance
    return {"wheel_place": place, "angle": float(np.average(slope, weights=weights))}

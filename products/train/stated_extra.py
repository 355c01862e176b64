"""Track brakes and the parking brake of a vehicle as a row of a consist states them, and the rows that state them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from brake_controller.parking_brake import COMPOUNDING, NO_PARKING_BRAKE, ParkingBrake
from brake_controller.shoe_friction import KILOMETRES_PER_HOUR
from brake_controller.track_brakes import NO_TRACK_BRAKES, TrackBrakes
from products.train.columns import TRACK
from products.train.layout import START_FRICTION
from rbd_model.train.vehicle import GRAVITY

#: Deceleration by track brakes at most [m/s2]: that of the column `deceleration`.
MOST = 3.0
#: Scale of a column's unit to SI.
_SCALE = {"kN": 1e3, "km/h": 1 / KILOMETRES_PER_HOUR, "bar": 1e5, "1": 1.0, "s": 1.0}
#: Fields of track brakes by column.
_TRACK = {name: name for name in TRACK} | {"track_brake_pressure": "applied_below"}
#: Columns that have an effect with one of others alone.
_NEEDED = {
    **{name: ("magnetic_attraction",) for name in TRACK if name.startswith("magnetic")},
    **{name: ("eddy_force",) for name in TRACK if name.startswith("eddy")},
    "track_brake_pressure": ("magnetic_attraction", "eddy_force"),
    **dict.fromkeys(("parking_time", "parking_compounding"), ("parking_force", "parking_gradient")),
}


def check_extra(values: Mapping[str, Any], mass: float) -> None:
    """Check that a row states its track brakes and parking brake completely, for a mass [kg]. Raises ValueError."""
    for name, others in _NEEDED.items():
        if name in values and not values.keys() & set(others):
            raise ValueError(f"{name} must come with {' or '.join(others)}. Add it, or leave {name} out.")
    if {"parking_force", "parking_gradient"} <= values.keys():
        raise ValueError("a parking brake must be stated once; got parking_force and parking_gradient. Leave one out.")
    one = track_of(values)
    for low, high in (("magnetic_fast", "magnetic_friction"), ("magnetic_lift", "magnetic_from")):
        if one.values()[low] > one.values()[high]:
            unit = "" if TRACK[low][0] == "1" else f" {TRACK[low][0]}"
            raise ValueError(
                f"{low} must be at most {high}, {_in_column(one, high):g}{unit}; got {_in_column(one, low):g}{unit}. "
                f"Decrease {low}, or increase {high}."
            )
    _check_size("magnetic_attraction", one.magnetic_friction, values, mass)
    _check_size("eddy_force", 1.0, values, mass)


def _check_size(name: str, friction: float, values: Mapping[str, Any], mass: float) -> None:
    most = 1e-3 * MOST * mass / friction
    if values.get(name, 0.0) > most:
        raise ValueError(
            f"{name} must be at most {most:.4g} kN, which brakes {1e-3 * mass:g} t with {MOST:g} m/s2; got "
            f"{values[name]:g} kN. Decrease it."
        )


def track_of(values: Mapping[str, Any]) -> TrackBrakes:
    """Return the track brakes of a row; without columns the vehicle has none."""
    stated = {_TRACK[name]: _SCALE[TRACK[name][0]] * values[name] for name in TRACK if name in values}
    return TrackBrakes(**(NO_TRACK_BRAKES.values() | stated))


def parking_of(values: Mapping[str, Any], mass: float) -> ParkingBrake:
    """Return the parking brake of a row for a mass [kg]; without columns the vehicle has none."""
    force = 1e3 * values.get("parking_force", 0.0) + 1e-3 * values.get("parking_gradient", 0.0) * mass * GRAVITY
    if not force:
        return NO_PARKING_BRAKE
    return ParkingBrake(
        parking_force=force,
        parking_time=values.get("parking_time", NO_PARKING_BRAKE.parking_time),
        parking_compounding=float(COMPOUNDING[values.get("parking_compounding", "adds")]),
    )


def _in_column(one: TrackBrakes, name: str) -> float:
    return float(one.values()[_TRACK[name]]) / _SCALE[TRACK[name][0]]


def row_of_extra(track: TrackBrakes, parking: ParkingBrake) -> dict[str, Any]:
    """Return the columns of track brakes and of a parking brake."""
    row: dict[str, Any] = {}
    kinds = {"magnetic": track.magnetic_attraction, "eddy": track.eddy_force}
    kinds["track"] = sum(kinds.values())
    for name in TRACK:
        if kinds[name.partition("_")[0]] > 0.0:
            row[name] = _in_column(track, name)
    if parking.parking_force:
        row["parking_force"] = 1e-3 * parking.parking_force
        row["parking_time"] = parking.parking_time
        words = {number: word for word, number in COMPOUNDING.items()}
        row["parking_compounding"] = words[int(parking.parking_compounding)]
    return row


def held_by(parking: ParkingBrake, weight: float) -> float:
    """Return the force of a parking brake on a weight [N] that a dry rail transmits [N], Coulomb's law."""
    return min(parking.parking_force, START_FRICTION * weight)


def slides_at(parking: ParkingBrake, weight: float) -> str:
    """Return the begin of a remark on a parking brake that exceeds adhesion on a weight [N]; empty if it does not."""
    most = START_FRICTION * weight
    if parking.parking_force <= most:
        return ""
    return (
        f"parking_force {1e-3 * parking.parking_force:.4g} kN is above the {1e-3 * most:.4g} kN that a rail of "
        f"friction {START_FRICTION:g} transmits: its wheels slide first"
    )

"""Track brakes and the parking brake of a vehicle in the columns of a consist, both ways."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from brake_controller.parking_brake import COMPOUNDING, NO_PARKING_BRAKE, ParkingBrake
from brake_controller.track_brakes import NO_TRACK_BRAKES, TrackBrakes
from products.train.consist_columns import TRACK, si
from rbd_model.train.vehicle import GRAVITY

#: Deceleration by track brakes at most [m/s2]: that of the column `deceleration`.
MOST = 3.0
#: Fields of track brakes by column.
FIELDS = {name: name for name in TRACK} | {"track_brake_pressure": "applied_below"}


def track_of(values: Mapping[str, Any], mass: float) -> TrackBrakes:
    """Return the track brakes of a row for a mass [kg]; without columns the vehicle has none. Raises ValueError."""
    stated = {FIELDS[name]: si(values, name) for name in TRACK if name in values}
    track_brakes = TrackBrakes(**(NO_TRACK_BRAKES.values() | stated))
    for low, high in (("magnetic_fast", "magnetic_friction"), ("magnetic_lift", "magnetic_from")):
        if track_brakes.values()[low] > track_brakes.values()[high]:
            unit = TRACK[low].of_unit
            raise ValueError(
                f"{low} must be at most {high}, {_in_column(track_brakes, high):g}{unit}; got "
                f"{_in_column(track_brakes, low):g}{unit}. Decrease {low}, or increase {high}."
            )
    for name, friction in (("magnetic_attraction", track_brakes.magnetic_friction), ("eddy_force", 1.0)):
        most = 1e-3 * MOST * mass / friction
        if values.get(name, 0.0) > most:
            raise ValueError(
                f"{name} must be at most {most:.4g} kN, which brakes {1e-3 * mass:g} t with {MOST:g} m/s2; got "
                f"{values[name]:g} kN. Decrease it."
            )
    return track_brakes


def parking_of(values: Mapping[str, Any], mass: float) -> ParkingBrake:
    """Return the parking brake of a row for a mass [kg]; without columns the vehicle has none."""
    force = 1e3 * values.get("parking_force", 0.0) + 1e-3 * values.get("parking_gradient", 0.0) * mass * GRAVITY
    if not force:
        return NO_PARKING_BRAKE
    time = values.get("parking_time", NO_PARKING_BRAKE.parking_time)
    compounding = float(COMPOUNDING[values.get("parking_compounding", "adds")])
    return ParkingBrake(parking_force=force, parking_time=time, parking_compounding=compounding)


def _in_column(track_brakes: TrackBrakes, name: str) -> float:
    return float(track_brakes.values()[FIELDS[name]]) / TRACK[name].scale


def row_of_track(track: TrackBrakes, parking: ParkingBrake) -> dict[str, Any]:
    """Return the columns of track brakes and of a parking brake."""
    row: dict[str, Any] = {}
    kinds = {"magnetic": track.magnetic_attraction, "eddy": track.eddy_force}
    kinds["track"] = sum(kinds.values())
    for name in TRACK:
        if kinds[name.partition("_")[0]] > 0.0:
            row[name] = _in_column(track, name)
    if parking.parking_force:
        row |= {"parking_force": 1e-3 * parking.parking_force, "parking_time": parking.parking_time}
        words = {number: word for word, number in COMPOUNDING.items()}
        row["parking_compounding"] = words[int(parking.parking_compounding)]
    return row

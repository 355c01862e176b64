"""Direct brake, main reservoir and vigilance device of a vehicle in the columns of a consist, both ways."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from brake_controller.direct_brake import (
    FILLING,
    NO_DIRECT_BRAKE,
    RELEASE,
    DirectBrake,
    times_of,
    with_direct_times,
)
from brake_controller.distributors.distributor import DistributorParameters
from brake_controller.main_reservoir import CUT_IN, CUT_OUT, FREE_AIR, NO_MAIN_RESERVOIR, MainReservoir
from brake_controller.vehicle_protection import VOLUME
from brake_controller.vigilance import NO_VIGILANCE, PENALTIES, WARNING, Vigilance
from products.train.consist_columns import CAB, si


def main_reservoir_of(values: Mapping[str, Any]) -> MainReservoir:
    """Return the main reservoir of a row, or a constant supply without one. Raises ValueError."""
    if "main_reservoir" not in values:
        return NO_MAIN_RESERVOIR
    cut_in, cut_out = (si(values, f"cut_{way}", usual) for way, usual in (("in", CUT_IN), ("out", CUT_OUT)))
    if not cut_in < cut_out:
        raise ValueError(
            f"cut_in must be below cut_out, {1e-5 * cut_out:g} bar; got {1e-5 * cut_in:g} bar. Decrease cut_in, or "
            "increase cut_out."
        )
    start = si(values, "start_pressure", cut_out)
    if start > cut_out:
        raise ValueError(
            f"start_pressure must be at most cut_out, {1e-5 * cut_out:g} bar; got {1e-5 * start:g} bar. Decrease it."
        )
    return MainReservoir(si(values, "main_reservoir"), si(values, "compressor", FREE_AIR), cut_in, cut_out, start)


def direct_brake_of(
    values: Mapping[str, Any], distributor: DistributorParameters, main_reservoir: MainReservoir
) -> DirectBrake:
    """Return the direct brake of a row; its times are those from a full main reservoir. Raises ValueError."""
    if "direct_pressure" not in values:
        return NO_DIRECT_BRAKE
    pressure = si(values, "direct_pressure")
    if not pressure < main_reservoir.cut_out:
        raise ValueError(
            f"direct_pressure must be below the pressure of its supply, {1e-5 * main_reservoir.cut_out:g} bar; got "
            f"{1e-5 * pressure:g} bar. Decrease it, or state main_reservoir with a higher cut_out."
        )
    volume = si(values, "direct_volume", getattr(distributor, "cylinder_volume", VOLUME))
    times = values.get("direct_fill_time", FILLING), values.get("direct_release_time", RELEASE)
    return with_direct_times(pressure, volume, main_reservoir.cut_out, *times)


def vigilance_of(values: Mapping[str, Any]) -> Vigilance:
    """Return the vigilance device of a row."""
    if "vigilance_time" not in values:
        return NO_VIGILANCE
    penalty = float(PENALTIES[values.get("vigilance_penalty", "emergency")])
    return Vigilance(values["vigilance_time"], values.get("warning_time", WARNING), penalty)


def row_of_cab(direct: DirectBrake, main_reservoir: MainReservoir, vigilance: Vigilance) -> dict[str, Any]:
    """Return the columns of a direct brake, a main reservoir and a vigilance device."""
    row: dict[str, Any] = {}
    if main_reservoir.reservoir_volume > 0.0:
        names = ("main_reservoir", "compressor", "cut_in", "cut_out", "start_pressure")
        row |= {n: value / CAB[n].scale for n, value in zip(names, main_reservoir.values().values(), strict=True)}
    if direct.direct_pressure > 0.0:
        filling, release = times_of(direct, main_reservoir.cut_out)
        row |= {"direct_pressure": 1e-5 * direct.direct_pressure, "direct_volume": 1e3 * direct.direct_volume}
        row |= {"direct_fill_time": filling, "direct_release_time": release}
    if vigilance.vigilance_time > 0.0:
        row |= {"vigilance_time": vigilance.vigilance_time, "warning_time": vigilance.warning_time}
        row["vigilance_penalty"] = next(name for name, n in PENALTIES.items() if n == vigilance.vigilance_penalty)
    return row

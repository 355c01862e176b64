"""The electric brake and the motors of a vehicle in the columns of a consist, both ways."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from brake_controller.distributors import kind_of
from brake_controller.distributors.distributor import DistributorParameters
from brake_controller.drive import NO_LIMIT, RISE, points_of_drive, shape_of
from brake_controller.electric_brake import BLENDINGS, FADE, ElectricBrake
from brake_controller.shoe_friction import KILOMETRES_PER_HOUR
from brake_controller.traction import CUT_OUT, NO_TRACTION, Traction
from products.train.cell_tables import points_in, text_of
from products.train.consist_columns import si


def _force(values: Mapping[str, Any], drive: str) -> dict[str, float]:
    """Return largest force, power and shape of a drive; empty without one."""
    force, table = f"{drive}_force", f"{drive}_table"
    power = {f"{drive}_power": si(values, f"{drive}_power", NO_LIMIT)}
    if table not in values:
        return {force: si(values, force)} | power if force in values else {}
    speeds, forces = points_in(table, values[table])
    in_newtons = [1e3 * one for one in forces]
    return {force: max(in_newtons)} | power | shape_of([v / KILOMETRES_PER_HOUR for v in speeds], in_newtons)


def electric_of(values: Mapping[str, Any], parameters: DistributorParameters) -> ElectricBrake:
    """Return the electric command and brake of a row; parameters: its distributor."""
    found = _force(values, "dynamic")
    fade = 0.0 if "dynamic_table" in values else FADE
    if "dynamic_fade" in values:
        fade = values["dynamic_fade"] / KILOMETRES_PER_HOUR
    return ElectricBrake(
        blended_pressure=parameters.full_pressure if kind_of(parameters).wired else 0.0,
        dead_time=values.get("dead_time", 0.0),
        dynamic_fade=fade,
        dynamic_rise=values.get("dynamic_rise", RISE if found else 0.0),
        blending=float(BLENDINGS[values.get("blending", "fills")]),
        blending_speed=values.get("blending_speed", 0.0) / KILOMETRES_PER_HOUR,
        **({"dynamic_force": 0.0, "dynamic_power": NO_LIMIT} | found),
    )


def traction_of(values: Mapping[str, Any]) -> Traction:
    """Return the motors of a row."""
    found = _force(values, "traction")
    if not found:
        return NO_TRACTION
    cut_out = si(values, "traction_cut_out", CUT_OUT)
    return Traction(traction_rise=values.get("traction_rise", RISE), traction_cut_out=cut_out, **found)


def _row(drive: str, p: Mapping[str, float]) -> dict[str, Any]:
    """Return the columns of a drive's force, power and rise."""
    force, power = p[f"{drive}_force"], p[f"{drive}_power"]
    points = points_of_drive(p, 1e-3 * force)
    row: dict[str, Any] = {f"{drive}_force": 1e-3 * force}
    if points is not None:
        speeds, forces = points
        row = {f"{drive}_table": text_of([KILOMETRES_PER_HOUR * v for v in speeds], forces)}
    return row | {f"{drive}_rise": p[f"{drive}_rise"]} | ({f"{drive}_power": 1e-3 * power} if power < NO_LIMIT else {})


def row_of_electric(electric_brake: ElectricBrake) -> dict[str, Any]:
    """Return the columns of an electric command and of an electric brake."""
    row: dict[str, Any] = {"dead_time": electric_brake.dead_time} if electric_brake.dead_time else {}
    if not electric_brake.dynamic_force:
        return row
    row |= _row("dynamic", electric_brake.values()) | {
        "dynamic_fade": KILOMETRES_PER_HOUR * electric_brake.dynamic_fade
    }
    name = next(name for name, number in BLENDINGS.items() if number == electric_brake.blending)
    row |= {} if name == "fills" else {"blending": name}
    return row | ({"blending_speed": KILOMETRES_PER_HOUR * electric_brake.blending_speed} if name == "closes" else {})


def row_of_traction(traction: Traction) -> dict[str, Any]:
    """Return the columns of motors."""
    if not traction.traction_force:
        return {}
    return _row("traction", traction.values()) | {"traction_cut_out": 1e-5 * traction.traction_cut_out}

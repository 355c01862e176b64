"""The electric brake and the motors of a vehicle as a row of a consist states them, and the row that states them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from brake_controller.distributors import DISTRIBUTORS, kind_of
from brake_controller.distributors.distributor import DistributorParameters
from brake_controller.distributors.uic import UIC
from brake_controller.drive import MOST_DRIVE_POINTS, NO_LIMIT, RISE, points_of_drive, shape_of
from brake_controller.electric_brake import BLENDINGS, FADE, ElectricBrake
from brake_controller.shoe_friction import KILOMETRES_PER_HOUR
from brake_controller.traction import CUT_OUT, NO_TRACTION, Traction
from products.train.columns import TRACTION
from products.train.pairs import pairs_of, text_of

#: Largest force of a table [kN].
MOST_FORCE = 2000.0


def table_in(text: str, most: int, least: float, largest: float) -> tuple[list[float], list[float]]:
    """Return speeds [m/s] and values of a string of pairs "km/h:value"; empty lists if it is not such a table."""
    speeds, found = pairs_of(text, (0.0, 1000.0), (least, largest), most) or ([], [])
    return [v / KILOMETRES_PER_HOUR for v in speeds], found


def table_as_text(speeds: list[float], values: list[float]) -> str:
    """Return the text of a table by `table_in`."""
    return text_of([KILOMETRES_PER_HOUR * v for v in speeds], values)


def check_drive(values: Mapping[str, Any]) -> None:
    """Check that a row states electric brake and motors once, with nothing without effect. Raises ValueError."""
    others = {"dynamic": ("power", "fade", "rise"), "traction": ("power", "rise", "cut_out")}
    for drive, names in others.items():
        force, table = f"{drive}_force", f"{drive}_table"
        if force in values and table in values:
            raise ValueError(f"{force} must be left out with {table}, which has the forces. Leave one of them out.")
        for name in (f"{drive}_{one}" for one in names):
            if name in values and force not in values and table not in values:
                raise ValueError(f"{name} must come with {force} or {table}. Add one of them, or leave {name} out.")
        if table in values:
            _forces(table, values[table])
    _check_blending(values)
    if "traction_force" in values and "traction_power" not in values:
        raise ValueError(
            "traction_force must come with traction_power, or slipping wheels would spin up without a limit. Add it."
        )
    if values.get("rotating") == 0.0 and set(values) & {*TRACTION, "traction_table"}:
        raise ValueError("rotating must be above 0 % on a vehicle with motors; got 0. Raise it, or leave it out.")


def _check_blending(values: Mapping[str, Any]) -> None:
    """Check the columns of blending. Raises ValueError."""
    blending = values.get("blending")
    if blending is not None and not {"dynamic_force", "dynamic_table"} & set(values):
        raise ValueError("blending must come with dynamic_force or dynamic_table. Add one of them, or leave it out.")
    kind = DISTRIBUTORS.get(values.get("distributor", UIC.name), UIC)
    if blending is not None and not (values.get("brake") == "ep-direct" or kind.wired):
        raise ValueError(
            "blending must be of brake = ep-direct, or of a distributor by wire; other brakes add. Leave it out."
        )
    if ("blending_speed" in values) != (blending == "closes"):
        raise ValueError("blending_speed must come with blending = closes, and that with it. Add both, or neither.")


def _forces(name: str, text: str) -> tuple[list[float], list[float]]:
    """Return the speeds [m/s] and forces [N] of a table. Raises ValueError."""
    speeds, forces = table_in(text, MOST_DRIVE_POINTS, 0.0, MOST_FORCE)
    if not speeds or max(forces) <= 0.0:
        raise ValueError(
            f"{name} must be 2 to {MOST_DRIVE_POINTS} pairs of a speed that rises by 0.001 km/h or more, up to 1000 "
            f"km/h, and a force from 0 to {MOST_FORCE:g} kN, not all of them 0; got {text!r}. Write it as 0:300 50:290 "
            "100:150."
        )
    return speeds, [1e3 * force for force in forces]


def _force(values: Mapping[str, Any], drive: str) -> dict[str, float]:
    """Return largest force, power and shape of a drive; empty without one."""
    power = {f"{drive}_power": 1e3 * values[f"{drive}_power"] if f"{drive}_power" in values else NO_LIMIT}
    if f"{drive}_table" in values:
        speeds, forces = _forces(f"{drive}_table", values[f"{drive}_table"])
        return {f"{drive}_force": max(forces)} | power | shape_of(speeds, forces)
    return {f"{drive}_force": 1e3 * values[f"{drive}_force"]} | power if f"{drive}_force" in values else {}


def electric_of(values: Mapping[str, Any], one: DistributorParameters) -> ElectricBrake:
    """Return the electric command and brake of a row that `check_drive` has checked; one: its distributor."""
    found = _force(values, "dynamic")
    fade = 0.0 if "dynamic_table" in values else FADE
    if "dynamic_fade" in values:
        fade = values["dynamic_fade"] / KILOMETRES_PER_HOUR
    more = {"dynamic_fade": fade, "dynamic_rise": values.get("dynamic_rise", RISE if found else 0.0)}
    more |= {"blending": float(BLENDINGS[values.get("blending", "fills")])}
    more |= {"blending_speed": values.get("blending_speed", 0.0) / KILOMETRES_PER_HOUR}
    return ElectricBrake(
        blended_pressure=one.full_pressure if kind_of(one).wired else 0.0,
        dead_time=values.get("dead_time", 0.0),
        **({"dynamic_force": 0.0, "dynamic_power": NO_LIMIT} | found | more),
    )


def traction_of(values: Mapping[str, Any]) -> Traction:
    """Return the motors of a row that `check_drive` has checked."""
    found = _force(values, "traction")
    if not found:
        return NO_TRACTION
    cut_out = 1e5 * values["traction_cut_out"] if "traction_cut_out" in values else CUT_OUT
    return Traction(traction_rise=values.get("traction_rise", RISE), traction_cut_out=cut_out, **found)


def _row(drive: str, p: Mapping[str, float]) -> dict[str, Any]:
    """Return the columns of a drive's force, power and rise."""
    force, power = p[f"{drive}_force"], p[f"{drive}_power"]
    points = points_of_drive(p, 1e-3 * force)
    row: dict[str, Any] = {f"{drive}_force": 1e-3 * force} if points is None else {}
    row |= {} if points is None else {f"{drive}_table": table_as_text(*points)}
    return row | {f"{drive}_rise": p[f"{drive}_rise"]} | ({f"{drive}_power": 1e-3 * power} if power < NO_LIMIT else {})


def row_of_electric(one: ElectricBrake) -> dict[str, Any]:
    """Return the columns of an electric command and of an electric brake."""
    row: dict[str, Any] = {"dead_time": one.dead_time} if one.dead_time else {}
    if not one.dynamic_force:
        return row
    row |= _row("dynamic", one.values()) | {"dynamic_fade": KILOMETRES_PER_HOUR * one.dynamic_fade}
    name = next(name for name, number in BLENDINGS.items() if number == one.blending)
    row |= {} if name == "fills" else {"blending": name}
    return row | ({"blending_speed": KILOMETRES_PER_HOUR * one.blending_speed} if name == "closes" else {})


def row_of_traction(one: Traction) -> dict[str, Any]:
    """Return the columns of motors."""
    if not one.traction_force:
        return {}
    return _row("traction", one.values()) | {"traction_cut_out": 1e-5 * one.traction_cut_out}

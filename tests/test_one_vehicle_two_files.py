"""The same vehicle as a vehicle file and as a row of a consist: one brake, one percentage, one rail, one resistance."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import bogie_braking as bb
from brake_controller.brake_weight import FROM_100, KILOMETRES_PER_HOUR
from products.train.consist_file import consist_of
from products.vehicle_brakes import BRAKE_ENTRIES

#: A coach of 46 t whose wheels have 4 % of its mass; resistance a + b v + c v^2 [SI].
MASS, ROTATING, RESISTANCE = 46e3, 0.04, (800.0, 20.0, 4.0)
PRESSURE, SPEED = 3.8e5, FROM_100.speed
#: Statements of one brake: in a vehicle file, and in a consist with its units.
BRAKES: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "percentage": ({"percentage": 120.0}, {"lambda": 120.0}),
    "force": ({"force": 50e3}, {"brake_force": 50.0}),
    "cylinder": (
        {"cylinder_diameter": 0.3, "cylinders": 2, "rigging_ratio": 8.0, "friction": 0.2},
        {
            "cylinder_diameter": 300.0,
            "cylinders": 2,
            "rigging_ratio": 8.0,
            "friction": "constant",
            "friction_value": 0.2,
        },
    ),
    "deceleration": ({"deceleration": 1.1}, {"deceleration": 1.1}),
}
#: Relative tolerance of forces and of distances, which the protection of no wheel ends.
SAME = 1e-3


def sheet_of(folder: Path, brake: dict[str, Any]) -> Any:
    rows = "\n".join(f"{name} = {value!r}" for name, value in brake.items()).replace("'", '"')
    a, b, c = RESISTANCE
    (folder / "own.toml").write_text(
        f'like = "coach"\ntare = {MASS}\nrotating_mass = {ROTATING * MASS}\n'
        f"[resistance]\nconstant = {a}\nlinear = {b}\nquadratic = {c}\n[brake]\n{rows}\n"
    )
    return bb.read_vehicle(folder / "own.toml")


def row_of(brake: dict[str, Any]) -> dict[str, Any]:
    names = dict(zip(("resistance_a", "resistance_b", "resistance_c"), RESISTANCE, strict=True))
    return {"kind": "coach", "valve": "head", "mass": 1e-3 * MASS, "rotating": 1e2 * ROTATING, **names, **brake}


@pytest.mark.parametrize("name", BRAKES)
def test_one_brake_has_one_force(name: str, tmp_path: Path) -> None:
    """At the full pressure of 3.8 bar: default efficiency and return force are those of consists."""
    of_file, of_row = BRAKES[name]
    brake = sheet_of(tmp_path, of_file).brake
    train = bb.train([row_of(of_row)], speed=SPEED)
    train.drive("emergency")
    train.advance(15.0)
    force = 4 * brake.full_torque / 0.46
    assert train.brake_force[0] == pytest.approx(force, rel=5 * SAME)  # the cylinder is a little below 3.8 bar


def test_a_percentage_contains_the_running_resistance(tmp_path: Path) -> None:
    """A stop from 100 km/h with the full force and the resistance has the distance of the percentage, UIC 544-1."""
    a, b, c = RESISTANCE
    brake = sheet_of(tmp_path, {"percentage": 120.0}).brake
    speed = np.linspace(0.0, 100 / KILOMETRES_PER_HOUR, 2001)
    whole = 4 * brake.full_torque / 0.46 + a + b * speed + c * speed**2
    way = np.trapezoid((1 + ROTATING) * MASS * speed / whole, speed)
    assert way + 2.0 * speed[-1] == pytest.approx(52840.0 / (120.0 + 10.0), rel=SAME)
    assert consist_of([row_of({"lambda": 120.0})]).vehicles[0].percentage == pytest.approx(120.0, rel=SAME)


def test_limits_are_those_of_consists() -> None:
    assert (BRAKE_ENTRIES["force"].least, BRAKE_ENTRIES["force"].most) == (100.0, 1e6)
    assert (BRAKE_ENTRIES["full_pressure"].least, BRAKE_ENTRIES["full_pressure"].most) == (1e5, 8e5)


def test_locked_wheels_stop_in_one_distance(tmp_path: Path) -> None:
    """Friction 0.1 at all speeds of sliding, as both have by default: v^2 / (2 mu g) less the time of the cylinders."""
    friction, speed = 0.1, 30.0
    sheet = sheet_of(tmp_path, {"force": 120e3})
    values = {f"friction_{number}": friction for number in range(1, 5)}
    values |= {f"pressure_demand_{number}": PRESSURE for number in range(1, 5)}
    alone = bb.run(sheet, 90.0, names=["distance", "locked_1"], level=1, initial_speed=speed, **values)
    train = bb.train([row_of({"brake_force": 120.0, "brake": "ep-direct", "fill_time": 2.0})], speed=speed)
    train.inputs["friction"] = friction
    train.drive("emergency")
    log = train.record(90.0)
    way = log["distance[1]"][-1] - log["distance[1]"][0]
    assert alone["locked_1"].max() == 1.0
    assert way == pytest.approx(alone["distance"][-1], rel=0.02)  # two laws of filling

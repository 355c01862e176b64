"""The same vehicle as a vehicle file and as a row of a consist: one brake, one percentage, one rail, one resistance."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import bogie_braking as bb
from brake_controller.brake_weight import KILOMETRES_PER_HOUR
from products.train.consist_file import consist_of
from products.train.train import Train
from products.vehicle_brakes import BRAKE_ENTRIES

#: A coach of 46 t whose wheels have 4 % of its mass; resistance a + b v + c v^2 [SI].
MASS, ROTATING, RESISTANCE = 46e3, 0.04, (800.0, 20.0, 4.0)
PRESSURE = 3.8e5
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
#: Relative tolerance of distances; measured 2e-5.
SAME = 1e-4


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


def from_15(speed: np.ndarray, distance: np.ndarray) -> float:
    """Return the distance from 15 m/s to rest [m]."""
    return float(distance[-1] - np.interp(-15.0, -speed, distance))


@pytest.mark.study
@pytest.mark.parametrize(
    ("name", "friction"), [*((name, 0.5) for name in BRAKES), ("locking", 0.1)], ids=[*BRAKES, "locked"]
)
def test_one_brake_has_one_force_and_one_stop(name: str, friction: float, tmp_path: Path) -> None:
    """Cylinders are full before 15 m/s: their times are two laws. Efficiency, return force and gravity are defaults."""
    of_file, of_row = BRAKES.get(name, ({"force": 120e3}, {"brake_force": 120.0}))
    sheet = sheet_of(tmp_path, of_file)
    values = {f"friction_{number}": friction for number in range(1, 5)}
    values |= {f"pressure_demand_{number}": PRESSURE for number in range(1, 5)}
    names = ["speed", "distance", "locked_1"]
    alone = bb.run(sheet, 60.0, names=names, interval=0.01, level=1, initial_speed=30.0, **values)
    one = consist_of([row_of({**of_row, "brake": "ep-direct"})])
    train, found = Train(one, speed=30.0, cylinder=PRESSURE), []
    train.inputs["friction"] = friction
    train.drive("emergency")
    while train.speed[0] > 0.0:
        found.append([float(train.speed[0]), float(train.distance[0])])
        train.advance(0.005)
    found.append([0.0, float(train.distance[0])])
    assert (alone["locked_1"].max() == 1.0) == (friction == 0.1)
    assert train.brake_force[0] == pytest.approx(4 * sheet.brake.full_torque / 0.46, rel=1e-9)
    assert from_15(*np.transpose(found)) == pytest.approx(from_15(alone["speed"], alone["distance"]), rel=SAME)


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

"""Every public function takes a vehicle by its name, from a file, as data, and as equations, and gives one answer."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.stats import norm

import bogie_braking as bb
from bogie_braking.machines import model_from
from rbd_model.levels.models import places_of

TORQUES = {f"brake_torque_{number}": 5e3 for number in (1, 2, 3, 4)}
VALUES: dict[str, Any] = {"level": 1, "initial_speed": 30.0, **TORQUES}
#: Duration of the runs [s], in which all vehicles stop.
LONG = 40.0


@pytest.fixture(scope="module")
def kinds(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Return one vehicle of 64 t in each form."""
    path = tmp_path_factory.mktemp("kinds") / "own.toml"
    path.write_text('name = "own"\nlike = "coach"\ntare = 64000\n')
    sheet = bb.read_vehicle(path)
    vehicle = sheet.vehicle
    return {"file": sheet, "vehicle": vehicle, "model": model_from(vehicle, places_of(1))}


def rare(what: Any, **how: Any) -> float:
    given = {name: value for name, value in VALUES.items() if name != "brake_torque_1"}
    found = bb.rare(what, LONG, "distance", 600.0, {"brake_torque_1": norm(5e3, 1e-3)}, particles=10, **how, **given)
    return float(found.worst["distance"][0])


def fitted(what: Any) -> float:
    """Return the distance with the mass that a fit finds in a log of the vehicle itself."""
    log = bb.run(what, 10.0, names=["speed"], interval=0.5, **VALUES)
    mass = bb.fit(what, log, {"body_mass": 40e3}, **VALUES).values["body_mass"]
    return float(bb.run(what, LONG, names=["distance"], **{**VALUES, "body_mass": mass})["distance"][-1])


def advanced(what: Any) -> float:
    with bb.instances(what, 1, ["brake_torque_1"], ["distance"], **VALUES) as made:
        return float(made.step(LONG, {"brake_torque_1": np.array([5e3])})["distance"][0])


def swept(what: Any, vary: dict[str, list[float]], **how: Any) -> float:
    given = {name: value for name, value in VALUES.items() if name not in vary}
    return float(bb.sweep(what, LONG, ["distance"], vary, **how, **given)["distance"][0])


FUNCTIONS: dict[str, Callable[[Any], float]] = {
    "run": lambda what: float(bb.run(what, LONG, names=["distance"], **VALUES)["distance"][-1]),
    "batch": lambda what: float(bb.batch(what, LONG, ["distance"], **VALUES)["distance"][0]),
    "instances": advanced,
    "sweep": lambda what: swept(what, {"brake_torque_1": [5e3]}),
    "sweep of what a file sets": lambda what: swept(what, {"body_mass": [51518.0]}),
    "sweep by an executor": lambda what: swept(what, {"friction_1": [0.3]}, executor=ThreadPoolExecutor(1)),
    "rare": rare,
    "rare by an executor": lambda what: rare(what, executor=ThreadPoolExecutor(1)),
    "fit": fitted,
}


@pytest.mark.study
@pytest.mark.parametrize("name", FUNCTIONS)
def test_each_function_gives_each_form_its_own_answer(name: str, kinds: dict[str, Any]) -> None:
    """A deceleration of 4 M / (r m') from 30 m/s: 674 m for 64 t; the built-in coach stops in 482 m."""
    for kind, what in kinds.items():
        if kind == "model" and "executor" in name:
            continue  # equations cannot be sent, which is refused
        assert FUNCTIONS[name](what) == pytest.approx(674.0, abs=0.5), kind


@pytest.mark.study
def test_a_creep_law_applies_to_a_vehicle_from_a_file(kinds: dict[str, Any]) -> None:
    rolled = bb.run(kinds["file"], 1.0, names=["distance"], level=3, initial_speed=10.0, creep_law="polach")
    assert rolled["distance"][-1] == pytest.approx(10.0, abs=1e-6)


@pytest.mark.study
def test_the_test_rig_takes_a_vehicle_from_a_file(kinds: dict[str, Any], tmp_path: Path) -> None:
    """On a dry rail: v^2 / 2 a, a second before the command, and the mean delay of cylinders that fill to 95 % in T.

    The delay is between T / ln 20 of an exponential and T / 1.9 of a straight rise. What the brake does before it is
    full shortens the stop by a / 2 times the variance of the delay, at most (T / ln 20)^2.
    """
    text, path = 'like = "coach"\ntare = 64000\n[brake]\ndeceleration = 1.2\n', tmp_path / "own.toml"
    speed, deceleration = 100 / 3.6, 1.2
    for entry, filling in (("", 2.0), ("application_time = 6\n", 6.0)):
        path.write_text(text + entry)
        stop = bb.protected_stop("protection", "dry", bb.read_vehicle(path), speed=speed)
        rest, exponential = speed**2 / (2 * deceleration) + speed, filling / np.log(20.0)
        shortest = rest + speed * exponential - deceleration / 2 * exponential**2
        assert shortest < stop["distance"][-1] < rest + speed * filling / 1.9
    with pytest.raises(ValueError, match="must have a \\[brake\\]"):
        bb.protected_stop("protection", "dry", kinds["file"])


def test_runs_kept_for_another_table_are_not_resumed(tmp_path: Path) -> None:
    """The file of a line has another content under the same name."""

    def sweep_on(gradient: float) -> float:
        bb.line_of([bb.straight(5000.0, gradient=gradient)]).write(tmp_path / "line.csv")
        values = {"line_file": str(tmp_path / "line.csv"), **VALUES}
        found = bb.sweep("coach", LONG, ["distance"], {"friction_1": [0.3]}, folder=tmp_path / "kept", **values)
        return float(found["distance"][0])

    sweep_on(0.0)
    with pytest.raises(ValueError, match="another sweep"):
        sweep_on(0.005)

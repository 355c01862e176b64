"""Every function that takes a log takes it as a file, a Recording and named arrays, and gives one answer."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import bogie_braking as bb
from bogie_braking.controllers.replay import read_log

pandas = pytest.importorskip("pandas")
ROWS = [{"kind": "locomotive"}, {"kind": "wagon", "count": 4}]
SCENE: dict[str, Any] = {"level": 1, "initial_speed": 25.0}


def structured(log: bb.Recording) -> np.ndarray:
    return np.asarray(log)


def by_date(log: bb.Recording) -> Any:
    """Return a data frame over dates, as loggers have them, or over its first column."""
    frame = log.to_pandas()
    if "time" not in log:
        return frame
    frame = frame.rename(columns={"speed": "v [m/s]"})
    start = pandas.Timestamp("2026-05-01T12:00:00Z")
    frame.index = pandas.Index(start + pandas.to_timedelta(frame.pop("time"), "s"), name="time")
    return frame


def in_kmh(log: bb.Recording) -> dict[str, np.ndarray]:
    return {
        name if name != "speed" else "speed [km/h]": 3.6 * values if name == "speed" else values
        for name, values in log.items()
    }


KINDS: dict[str, Callable[[bb.Recording, Path], Any]] = {
    "file": lambda log, folder: log.write(folder / "log.csv"),
    "Recording": lambda log, folder: log,
    "mapping": lambda log, folder: dict(log),
    "mapping in km/h": lambda log, folder: in_kmh(log),
    "data frame": lambda log, folder: log.to_pandas(),
    "data frame over dates": lambda log, folder: by_date(log),
    "data set": lambda log, folder: log.to_xarray(),
    "structured array": lambda log, folder: structured(log),
}


def coasting() -> bb.Recording:
    return bb.run("vehicle", 30.0, None, ["speed"], 1.0, davis_constant=2000.0, **SCENE)


def mass_of(given: Any) -> float:
    """Return the resistance that a fit finds in a coasting test [N]."""
    return float(bb.fit("vehicle", given, {"davis_constant": 1500.0}, **SCENE).values["davis_constant"])


def stops() -> bb.Recording:
    """Return stopping distances of a train with a brake of 60 %."""
    units, found = {"speed": "m/s", "distance": "m"}, []
    for speed in (10.0, 20.0):
        train = bb.train([ROWS[0], ROWS[1] | {"lambda": 60.0}], speed=speed)
        begin = train.distance[0]
        train.drive("emergency")
        while train.speed[0] > 0.0:
            train.advance(0.1)
        found.append([speed, train.distance[0] - begin])
    return bb.Recording(units, found)


def run_of_train() -> bb.Recording:
    train = bb.train([ROWS[0], ROWS[1] | {"lambda": 60.0}], speed=20.0)
    train.drive("emergency")
    run = train.record(8.0, 0.5)
    return bb.Recording({"time": "s", "speed": "m/s"}, np.column_stack([run["time"], run["speed[1]"]]))


def weight_of(given: Any) -> float:
    return float(bb.fit(ROWS, given, {"lambda": 70.0}).values["lambda"])


def wheels() -> bb.Recording:
    stop = bb.protected_stop("protection", "low", speed=10.0)
    names = ["time", "speed", "wheel_speed_1", "wheel_speed_2"]
    return bb.Recording({name: stop.units[name] for name in names}, np.column_stack([stop[name] for name in names]))


def friction_of(given: Any) -> float:
    """Return the friction that a field finds in the log of locked wheels."""
    law = {"friction_ratio": 0.4, "adhesion_reduction": 1.0, "slip_reduction": 0.4, "friction_decay": 0.2}
    return float(bb.fit("bogie", given, {"friction": 0.15}, places=[0.0, 400.0], **law).values[0])


def sliding() -> bb.Recording:
    stop = bb.protected_stop(None, "low", speed=12.0)
    names = ["time", "speed", "distance", "wheel_speed_1", "wheel_speed_2", "pressure_1", "pressure_2"]
    rows = np.column_stack([stop[name] for name in names])[::20]
    return bb.Recording({name: stop.units[name] for name in names}, rows)


def slowest(given: Any) -> float:
    return float(read_log(given)["speed"].sum())


#: Functions of a log, with the log and the relative difference of ten digits.
FUNCTIONS: dict[str, tuple[Callable[[], bb.Recording], Callable[[Any], float], float]] = {
    "fit": (coasting, mass_of, 1e-4),
    "fit of a train to stops": (stops, weight_of, 1e-4),
    "fit of a train to a run": (run_of_train, weight_of, 1e-3),
    "fit of friction": (sliding, friction_of, 1e-4),
    "replay": (wheels, slowest, 1e-9),
    "measured_from": (coasting, lambda given: float(bb.measured_from(given)["speed"].sum()), 1e-9),
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_each_function_takes_each_kind_of_log(name: str, tmp_path: Path) -> None:
    make, function, tolerance = FUNCTIONS[name]
    log = make()
    due = function(log.write(tmp_path / "due.csv"))
    for kind, form in KINDS.items():
        given = form(log, tmp_path)
        if name == "measured_from" and kind == "Recording":
            continue  # it is one already, which is refused
        assert function(given) == pytest.approx(due, rel=tolerance), kind


@pytest.mark.parametrize(
    "form",
    [
        lambda log: log,
        lambda log: dict(log),
        lambda log: {"time [ms]": 1e3 * log["time"], "brake_torque_1 [kN.m]": log["brake_torque_1"] / 1e3},
        lambda log: log.to_pandas().set_index("time"),
        lambda log: log.to_xarray(),
        lambda log: np.asarray(log),
    ],
)
def test_an_input_over_time_may_be_a_log(form: Callable[[bb.Recording], Any]) -> None:
    log = bb.Recording({"time": "s", "brake_torque_1": "N.m"}, [[0.0, 0.0], [1.0, 6e3], [1.0, 2e3], [4.0, 9e3]])
    due = bb.run("bogie", 4.0, names=["speed"], brake_torque_1=(log["time"], log["brake_torque_1"]), **SCENE)
    run = bb.run("bogie", 4.0, names=["speed"], brake_torque_1=form(log), **SCENE)
    assert run["speed"] == pytest.approx(due["speed"], rel=1e-12)


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"time": [0.0, 1.0], 3: [1.0, 2.0]}, "The log must have names of columns; got 3"),
        ({"time": [0.0, 1.0], "speed": [[1.0], [2.0]]}, r"'speed' must be a column; got an array of shape \(2, 1\)"),
        ({"time": [0.0, 1.0], "speed": [1.0]}, "The log must have columns of one length; got 1, 2 values"),
        ({"time": [0.0, 1.0], "speed": np.ma.masked_less([1.0, 2.0], 1.5)}, "some are masked"),
        ({"time [Pa]": [0.0, 1.0], "speed": [1.0, 2.0]}, "time"),
        ({"time": [0.0, 1.0], "speed": [1.0, np.inf]}, "inf"),
        ({"speed": [1.0, 2.0]}, "The log: the column time is missing"),
        ([1.0, 2.0], "The log must be a Recording, columns by name"),
    ],
)
def test_wrong_columns_are_refused_in_one_message(given: Any, sentence: str) -> None:
    with pytest.raises((ValueError, TypeError), match=sentence):
        bb.measured_from(given)


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        (
            {"time": [0.0], "a": [1.0], "b": [2.0]},
            "must be a log with the columns time and brake_torque_1; it has time, a, b",
        ),
        ({}, "brake_torque_1 must have at least one column; got none"),
        (
            {"time": [0.0], "brake_torque_1": [1.0], "brake_torque_1 [kN.m]": [1.0]},
            r"brake_torque_1 must be one column; got brake_torque_1 and brake_torque_1 \[kN\.m\]",
        ),
        ({"time [s]": [0.0, 1.0], "brake_torque_1 [bar]": [1.0, 2.0]}, r"must be in N\.m; got bar"),
    ],
)
def test_a_wrong_log_of_an_input_is_refused(given: Any, sentence: str) -> None:
    with pytest.raises(bb.SimulationError, match=sentence):
        bb.run("bogie", 1.0, brake_torque_1=given, **SCENE)


def test_a_frame_that_a_recording_made_has_its_units() -> None:
    """The unit is in `attrs`, which wins over the unit of the variable, and names with units win over both."""
    log = bb.Recording({"time": "s", "speed": "km/h"}, [[0.0, 36.0], [1.0, 18.0], [2.0, 9.0]])
    assert read_speed(log.to_pandas()) == read_speed(log.to_xarray()) == pytest.approx([10.0, 5.0, 2.5])


def read_speed(given: Any) -> list[float]:
    from bogie_braking.measured_data import log_of

    return list(log_of(given, {"time": "s", "speed": "m/s"})["speed"])

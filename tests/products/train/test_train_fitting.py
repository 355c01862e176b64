"""Brake, filling time and resistance of a train, fitted to stops and to runs of known parameters."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import bogie_braking as bb
from products.train.consist_file import consist_of
from products.train.factors import changed
from products.train.numbers import Settings
from products.train.train import Train

ROWS: list[dict[str, Any]] = [{"kind": "locomotive"}, {"kind": "wagon", "count": 3, "brake_force": 70.0}]
SETTINGS = Settings("whole", cells=1.0)
SPEEDS = np.array([8.0, 12.0, 16.0, 20.0, 24.0])
STOPS = {"speed": "m/s", "distance": "m"}
TRUE = {"brake_factor": 0.83, "fill_time": 6.5}


def distances(values: dict[str, float]) -> np.ndarray:
    """Return the stopping distances of the train with other parameters [m]."""
    found = []
    for speed in SPEEDS:
        train = Train(changed(consist_of(ROWS), values), speed=float(speed), settings=SETTINGS)
        train.drive("emergency")
        while train.speed[0] > 0.0:
            train.advance(0.1)
        found.append(train.distance[0])
    own = Train(consist_of(ROWS)).distance[0]
    return np.array(found) - own


@pytest.mark.study
def test_stops_give_the_brake_and_the_filling_time_that_made_them(tmp_path: Path) -> None:
    rows = np.c_[SPEEDS * 3.6, distances(TRUE)]
    text = "speed [km/h],distance [m]\n" + "".join(f"{speed},{way}\n" for speed, way in rows)
    (tmp_path / "stops.csv").write_text(text)
    found = bb.fit(ROWS, tmp_path / "stops.csv", {"brake_factor": 1.0, "fill_time": 4.0}, settings=SETTINGS)
    assert found.values == pytest.approx(TRUE, rel=1e-4)
    assert found.deviations["distance"] < 0.02


@pytest.mark.study
def test_errors_of_stops_are_those_of_least_squares() -> None:
    """s^2 (J^T J)^-1 with the slopes of the distances by central differences, for errors of about 2 m."""
    noise = np.array([2.1, -1.2, 0.8, -2.4, 1.6])
    table = bb.Recording(STOPS, np.c_[SPEEDS, distances(TRUE) + noise])
    found = bb.fit(ROWS, table, {"brake_factor": 0.9, "fill_time": 6.0}, settings=SETTINGS)
    slopes = np.empty((SPEEDS.size, 2))
    for column, name in enumerate(TRUE):
        step = 0.01 * found.values[name]
        ends = [distances(found.values | {name: found.values[name] + sign * step}) for sign in (1.0, -1.0)]
        slopes[:, column] = (ends[0] - ends[1]) / (2 * step)
    off = distances(found.values) - table["distance"]
    errors = np.sqrt(np.diag(np.linalg.inv(slopes.T @ slopes)) * (off @ off) / (SPEEDS.size - 2))
    assert list(found.standard_errors.values()) == pytest.approx(errors, rel=0.02)
    assert slopes.T @ off == pytest.approx([0.0, 0.0], abs=1e-2 * np.linalg.norm(slopes) * np.linalg.norm(off))


def test_a_lambda_is_fitted_with_the_resistance_it_includes() -> None:
    exact = distances({"lambda": 58.0})
    found = bb.fit(ROWS, bb.Recording(STOPS, np.c_[SPEEDS, exact]), {"lambda": 80.0}, settings=SETTINGS)
    assert found.values["lambda"] == pytest.approx(58.0, rel=1e-4)


def test_a_run_that_coasts_and_brakes_gives_resistance_and_brake() -> None:
    """The driver's valve follows the measured pipe pressure: 20 s coasting, full service afterwards."""
    true = {"resistance_a": 4e3, "resistance_c": 30.0, "brake_factor": 0.9}
    train = Train(changed(consist_of(ROWS), true), speed=25.0, settings=SETTINGS)
    rows = []
    for n in range(500):
        if n == 200:
            train.drive("service", 1.0)
        rows.append([train.time, train.speed[0], 500e3 if n <= 200 else 350e3])
        train.advance(0.1)
    rows = [row for row in rows if row[1] > 0.0]
    table = bb.Recording({"time": "s", "speed": "m/s", "pipe_pressure": "Pa"}, np.array(rows))
    begin = {"resistance_a": 6e3, "resistance_c": 20.0, "brake_factor": 1.0}
    found = bb.fit(ROWS, table, begin, settings=SETTINGS)
    assert found.values == pytest.approx(true, rel=2e-3)
    assert found.deviations["speed"] < 1e-3


def test_parameters_that_a_fit_of_trains_cannot_have_are_refused() -> None:
    table = bb.Recording(STOPS, np.c_[SPEEDS, distances({})])
    for parameters, message in (
        ({"lambda": 60.0, "brake_factor": 1.0}, "must have lambda or brake_factor, not both"),
        ({"brake_facter": 1.0}, "no parameter brake_facter to be fitted; did you mean brake_factor"),
        ({"lambda": 0.5}, "initial value of lambda must be between 5 and 250 %"),
        ({}, "must have start values by name"),
        (
            dict.fromkeys(("lambda", "fill_time", "resistance_a", "resistance_b", "resistance_c"), 9.0),
            "do not decide",
        ),
    ):
        with pytest.raises(ValueError, match=message):
            bb.fit(ROWS, table, parameters)
    with pytest.raises(ValueError, match=r"distance of a stop must be from 1 to 100000 m; got -5 m"):
        bb.fit(ROWS, bb.Recording(STOPS, np.array([[10.0, -5.0]] * 3)), {"lambda": 60.0})


def test_options_of_other_fits_are_refused() -> None:
    table = bb.Recording(STOPS, np.c_[SPEEDS, 10.0 * SPEEDS])
    with pytest.raises(ValueError, match="must be without until; it has drive, settings"):
        bb.fit(ROWS, table, {"lambda": 60.0}, until=5.0)
    with pytest.raises(ValueError, match="The fit of a train must be without initial_speed"):
        bb.fit(ROWS, table, {"lambda": 60.0}, initial_speed=5.0)
    with pytest.raises(ValueError, match="drive must be one of emergency, service; got 'brake'"):
        bb.fit(ROWS, table, {"lambda": 60.0}, drive="brake")


def test_values_that_end_at_their_limits_are_told_and_stops_have_no_begin() -> None:
    """Distances that no brake of the limits has: a tenth of those of the train."""
    own = distances({})
    found = bb.fit(ROWS, bb.Recording(STOPS, np.c_[SPEEDS, 0.1 * own]), {"fill_time": 4.0}, settings=SETTINGS)
    assert found.values["fill_time"] == pytest.approx(0.5, rel=1e-3)
    assert any(one.startswith("fill_time ended at its limit of 0.5") for one in found.warnings)
    assert any(one.startswith("The run does not describe distance") for one in found.warnings)
    assert "begin" not in found.status
    assert not bb.fit(ROWS, bb.Recording(STOPS, np.c_[SPEEDS, own]), {"fill_time": 4.0}, settings=SETTINGS).warnings


PRESSURES = {
    "bar": (5.0, 3.5, "pipe_pressure must reach 100000 Pa, as the pipe is charged before it brakes; got at most 5 Pa"),
    "absolute": (600e3, 450e3, "must be a gauge pressure from -10000 to 560000 Pa; got 600000 Pa"),
    "a fall": (0.0, -150e3, "must be a gauge pressure from -10000 to 560000 Pa; got -150000 Pa"),
}


@pytest.mark.parametrize("case", PRESSURES)
def test_a_pipe_pressure_that_is_not_a_gauge_pressure_in_pa_is_refused(case: str) -> None:
    high, low, message = PRESSURES[case]
    rows = [[0.0, 20.0, high], [1.0, 20.0, low], [2.0, 19.0, low]]
    table = bb.Recording({"time": "s", "speed": "m/s", "pipe_pressure": "Pa"}, np.array(rows))
    with pytest.raises(ValueError, match=re.escape(message)):
        bb.fit(ROWS, table, {"brake_factor": 1.0}, settings=SETTINGS)


def test_settings_that_are_none_are_refused() -> None:
    table: Any = bb.Recording(STOPS, np.c_[SPEEDS, 10.0 * SPEEDS])
    for refused in (
        lambda one: bb.train(3, settings=one),
        lambda one: bb.fit(ROWS, table, {"lambda": 60.0}, settings=one),
    ):
        for one in ("whole", {"cells": 1.0}):
            with pytest.raises(
                TypeError, match=r"settings must be a Settings of products\.train\.numbers, or None; got"
            ):
                refused(one)

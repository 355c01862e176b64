"""Times of inputs and of logs are read as meant, or refused with one message."""

from __future__ import annotations

import datetime
import math
from typing import Any

import numpy as np
import pytest

import bogie_braking as bb
from bogie_braking.histories import times_and_values
from tests.fmu_src.fmi.sled import sled

#: The sled's mass [kg], brake force [N] and start speed [m/s] in the generated data.
MASS, BRAKE, SPEED = 10.0, 5.0, 2.0
#: Error of a fit to noise-free data: the run's tolerance of 1e-6 of the speed, divided by its sensitivity to the mass.
FITTED = 1e-4
#: Start time of a log [s]: zero, a moment, minutes, seconds since 1970.
BEGINS = (0.0, 5.0, 100.0, 1.7e9)
#: Equivalent forms of one push, 0 N at 0 s and 20 N at 2 s.
TIMES, PUSH = [0.0, 2.0], [0.0, 20.0]
MILLISECONDS = np.array([0, 2000], "timedelta64[ms]")
FIELDS = np.array(list(zip(TIMES, PUSH, strict=True)), [("time", float), ("push", float)])


def logged(begin: float) -> bb.Recording:
    """Return the log of a sled under constant braking, by the closed form v = v0 - F t / m."""
    elapsed = np.linspace(0.0, 2.0, 21)
    return bb.Recording({"time": "s", "speed": "m/s"}, np.c_[begin + elapsed, SPEED - BRAKE * elapsed / MASS])


@pytest.mark.study
@pytest.mark.parametrize("begin", BEGINS)
def test_a_fit_finds_the_mass_whenever_the_log_begins(begin: float) -> None:
    found = bb.fit(sled(), logged(begin), {"mass": 7.0}, brake=BRAKE, length=100.0)
    assert found.values["mass"] == pytest.approx(MASS, rel=FITTED)
    assert found.fitted["time"][0] == begin
    early = bb.fit(sled(), logged(begin), {"mass": 7.0}, until=begin + 1.0, brake=BRAKE, length=100.0)
    assert early.values["mass"] == pytest.approx(MASS, rel=FITTED)
    assert early.held_out["speed"] < FITTED * SPEED


@pytest.mark.parametrize("begin", BEGINS)
def test_a_measured_input_counts_from_the_same_row_as_what_it_moves(begin: float) -> None:
    """The push grows by g each second: v = v0 + g t^2 / 2 m."""
    elapsed = np.linspace(0.0, 2.0, 21)
    columns = np.c_[begin + elapsed, SPEED + 10.0 * elapsed**2 / (2 * MASS), 10.0 * elapsed]
    log = bb.Recording({"time": "s", "speed": "m/s", "push": "N"}, columns)
    # A parabola between rows 0.1 s apart is up to a t^2 / 8 above its chord: 1.25e-3 m/s of 2.
    assert bb.fit(sled(), log, {"mass": 7.0}, length=100.0).values["mass"] == pytest.approx(MASS, rel=2e-3)


def test_the_unit_of_a_logs_time_counts() -> None:
    whole = logged(0.0)
    log = bb.Recording({"time": "ms", "speed": "m/s"}, np.c_[1e3 * whole["time"], whole["speed"]])
    assert bb.fit(sled(), log, {"mass": 7.0}, brake=BRAKE).values["mass"] == pytest.approx(MASS, rel=FITTED)
    log = bb.Recording({"time": "Pa", "speed": "m/s"}, np.c_[whole["time"], whole["speed"]])
    with pytest.raises(ValueError, match=r"time.* Pa"):
        bb.fit(sled(), log, {"mass": 7.0}, brake=BRAKE)


def test_a_log_may_begin_after_its_run() -> None:
    """The rows begin at 0.5 s, but `begin` sets the start of the run to 0 s."""
    whole = logged(0.0)
    late = bb.Recording(whole.units, np.c_[whole["time"], whole["speed"]][5:])
    found = bb.fit(sled(), late, {"mass": 7.0}, begin=0.0, brake=BRAKE, length=100.0)
    assert found.values["mass"] == pytest.approx(MASS, rel=FITTED)
    for wrong in (0.6, math.nan, "0"):
        with pytest.raises(ValueError, match=r"begin must be at most 0.5 s, the time of the first row; got"):
            bb.fit(sled(), late, {"mass": 7.0}, begin=wrong, brake=BRAKE)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "given",
    [
        (TIMES, PUSH),
        [np.array(TIMES), np.array(PUSH)],
        list(zip(TIMES, PUSH, strict=True)),
        (MILLISECONDS, PUSH),
        (MILLISECONDS.astype("timedelta64[ns]"), PUSH),
        ([datetime.timedelta(seconds=time) for time in TIMES], PUSH),
        FIELDS,
        np.array([[0.0, 0.0], [1.0, 10.0], [2.0, 20.0]]),
        np.array([[0.0, 1.0, 2.0], [0.0, 10.0, 20.0]]),
        [[0.0, 0.0], [1.0, 10.0], [2.0, 20.0]],
        ([0.0, 1.0, 2.0], [0.0, 10.0, 20.0]),
    ],
    ids=str,
)
def test_every_form_of_a_table_is_the_same_push(given: Any) -> None:
    """The push grows by 10 N each second, so the sled gains 10 t^2 / 2 m."""
    run = bb.run(sled(), 2.0, names=["speed"], interval=0.5, push=given, length=100.0)
    assert run["speed"] == pytest.approx(SPEED + 10.0 * run["time"] ** 2 / (2 * MASS), rel=1e-6)


@pytest.mark.study
@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ([TIMES, PUSH], r"push must be columns or rows; .* can be both. Write \(\[0, 2\], \[0, 5e3\]\) for columns"),
        (((0.0, 0.0), (2.0, 20.0)), "push must be columns or rows; .* can be both"),
        ([(0.0, 0.0), [2.0, 20.0]], "push must be columns or rows; .* can be both"),
        (np.array([TIMES, PUSH]), r"an array of shape \(2, 2\) can be both"),
        (np.zeros((3, 3)), "push must be one number, a function of time, a pair of columns"),
        (np.zeros(()), "push must be one number, a function of time, a pair of columns"),
        ((np.array(1.0), np.array(2.0)), "push must be one number, a function of time, a pair of columns"),
        (zip(TIMES, PUSH, strict=True), "push must be one number, a function of time, a pair of columns"),
        (np.timedelta64(5, "s"), "push must be one number, a function of time, a pair of columns"),
        ([], "push must be one number, a function of time, a pair of columns"),
        (([], []), "as many values as times, and at least one of each; got 0 and 0"),
        (([0, 1, 2], [1, 2]), "as many values as times, and at least one of each; got 3 and 2"),
        (
            (MILLISECONDS.astype("datetime64[ms]"), PUSH),
            "times of push must be numbers .*Subtract the first",
        ),
        (([datetime.datetime(2026, 1, 1)] * 2, PUSH), "times of push must be numbers .*Subtract the first"),
        ((np.array([np.timedelta64(0), np.timedelta64(2)]), PUSH), "times of push must be numbers of seconds"),
        ((["0", "2"], PUSH), r"times of push must be numbers of seconds .*; got \['0', '2'\]"),
        (([0, 10**400], PUSH), "times of push must be numbers of seconds"),
        ((TIMES, MILLISECONDS), "values of push must be numbers; got"),
        ((np.ma.array(TIMES, mask=[False, True]), PUSH), "push must have all its times; some are masked"),
        (np.zeros(2, [("t", float), ("push", float)]), "fields time and push; it has t, push"),
        (([2.0, 0.0], PUSH), "The times of push must increase; row 1 has 0 s"),
        ((np.array([0, "NaT"], "timedelta64[s]"), PUSH), "The times of push must increase; row 1 has nan s"),
        (([1.7e9, 1.7e9 + 2], PUSH), "must begin within the run, from 0 to 2 s; the first is 1700000000 s.*subtract"),
        (([2.5, 3.0], PUSH), "must begin within the run, from 0 to 2 s; the first is 2.5 s"),
    ],
)
def test_a_table_that_can_be_read_in_two_ways_or_in_none_gets_one_sentence(given: Any, sentence: str) -> None:
    with pytest.raises(bb.SimulationError, match=sentence) as told:
        bb.run(sled(), 2.0, names=["speed"], push=given)
    assert "\n" not in str(told.value)


def test_columns_of_a_data_frame_are_columns() -> None:
    """They have an order and a length without being lists, as a pandas Series."""

    class Column:
        def __init__(self, values: list[float]) -> None:
            self.values = values

        def __len__(self) -> int:
            return len(self.values)

        def __getitem__(self, row: int) -> float:
            return self.values[row]

        def __array__(self, dtype: Any = None, copy: Any = None) -> np.ndarray:
            return np.array(self.values, dtype)

    times, values = times_and_values("push", (Column(TIMES), Column(PUSH)))
    assert (times.tolist(), values.tolist()) == (TIMES, PUSH)


@pytest.mark.parametrize(
    "duration", [2.0, np.timedelta64(2000, "ms"), np.timedelta64(2 * 10**9, "ns"), datetime.timedelta(seconds=2)]
)
def test_a_duration_has_its_unit(duration: Any) -> None:
    assert bb.run(sled(), duration, names=["distance"], interval=0.5, length=100.0)["distance"][-1] == pytest.approx(
        4.0
    )


@pytest.mark.parametrize("duration", [np.timedelta64(2), np.datetime64("2026-01-01"), "2", 10**400, math.inf])
def test_a_duration_that_is_none_is_refused(duration: Any) -> None:
    with pytest.raises(ValueError, match="The duration must be a number of seconds above 0"):
        bb.run(sled(), duration)


def test_columns_of_a_sweep_are_numbers() -> None:
    with pytest.raises(ValueError, match="brake must be a list of numbers, one for each run"):
        bb.sweep(sled(), 1.0, ["speed"], {"brake": MILLISECONDS})

"""Sweeps, batches and rare events keep statistics of whole runs, equal to those of the recorded runs."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.stats import norm, uniform

import bogie_braking as bb

SCENE: dict[str, Any] = {"initial_speed": 25.0, "brake_torque_1": 20e3, "brake_torque_2": 20e3}
VARY = {"friction_1": [0.1, 0.2, 0.3]}
NAMES = ["distance", "maximum(axle_load_1)", "minimum( axle_load_1 )", "mean(speed)", "percentile(slip_1, 99.85)"]
#: Functions of NumPy on a recorded column, by the names of the columns of a table.
BY_NUMPY: dict[str, Callable[[bb.Recording], Any]] = {
    "distance": lambda run: run["distance"][-1],
    "maximum(axle_load_1)": lambda run: run["axle_load_1"].max(),
    "minimum(axle_load_1)": lambda run: run["axle_load_1"].min(),
    "mean(speed)": lambda run: run["speed"].mean(),
    "percentile(slip_1, 99.85)": lambda run: np.percentile(run["slip_1"], 99.85),
}


def steepest(run: bb.Recording) -> float:
    """Return the largest jerk of a run [m/s3]."""
    return float(np.abs(np.gradient(run["acceleration"], run["time"])).max())


def test_statistics_of_a_sweep_are_those_of_recorded_runs(tmp_path: Path) -> None:
    """In threads, in worker processes, kept in a folder, and in a batch."""
    table = bb.sweep("bogie", 4.0, NAMES, VARY, reduce={"jerk [m/s3]": steepest}, **SCENE)
    for row, friction in enumerate(VARY["friction_1"]):
        run = bb.run("bogie", 4.0, friction_1=friction, **SCENE)
        for name, function in BY_NUMPY.items():
            assert table[name][row] == pytest.approx(function(run), rel=1e-9), name
        assert table["jerk"][row] == pytest.approx(steepest(run), rel=1e-9)
    assert (table.units["jerk"], table.units["maximum(axle_load_1)"]) == ("m/s3", "N")
    with ThreadPoolExecutor(2) as pool:
        assert bb.sweep("bogie", 4.0, NAMES, VARY, pool, reduce={"jerk [m/s3]": steepest}, **SCENE) == table
    kept = [bb.sweep("bogie", 4.0, NAMES, VARY, folder=tmp_path / "kept", **SCENE) for _ in range(2)]
    assert kept[0] == kept[1]
    ends = bb.batch("bogie", 4.0, NAMES, messages=True, **VARY, **SCENE)
    for name in BY_NUMPY:
        assert np.array_equal(kept[0][name], table[name]), name
        assert np.array_equal(ends[name], table[name]), name
    assert ends.messages == kept[0].messages
    assert bb.repeat(kept[0]) == kept[0]


def test_mean_and_maximum_are_those_of_a_closed_form() -> None:
    """A constant deceleration: v0 - a t over a time T has the mean v0 - a T / 2, and is evenly distributed."""
    ends = bb.sweep(
        "bogie",
        4.0,
        ["mean(speed)", "maximum(speed)", "minimum(speed)", "percentile(speed, 25)"],
        {"brake_torque_1": [0.0, 5e3]},
        level=1,
        initial_speed=25.0,
        rolling_resistance_torque=0.0,
    )
    assert [ends[name][0] for name in ("mean(speed)", "maximum(speed)", "minimum(speed)")] == pytest.approx([25.0] * 3)
    slowest = ends["minimum(speed)"][1]
    assert slowest < 24.9
    assert ends["mean(speed)"][1] == pytest.approx((25.0 + slowest) / 2, rel=1e-4)
    assert ends["percentile(speed, 25)"][1] - slowest == pytest.approx((25.0 - slowest) / 4, rel=1e-2)


def test_a_table_of_what_varies_may_be_a_data_frame_with_units() -> None:
    due = bb.sweep("bogie", 4.0, ["distance"], {"initial_speed": [10.0, 20.0], "friction_1": [0.1, 0.2]}, level=1)
    plan = bb.Recording({"initial_speed": "km/h", "friction_1": "1"}, [[36.0, 0.1], [72.0, 0.2]])
    for vary in (plan, plan.to_pandas()):
        assert bb.sweep("bogie", 4.0, ["distance"], vary, level=1)["distance"] == pytest.approx(
            due["distance"], rel=1e-9
        )
    pandas = pytest.importorskip("pandas")
    twice = {"initial_speed [m/s]": [10.0], "initial_speed [km/h]": [72.0]}
    with pytest.raises(ValueError, match="initial_speed must be one column; got"):
        bb.sweep("bogie", 4.0, ["distance"], pandas.DataFrame(twice), level=1)
    with pytest.raises(ValueError, match="initial_speed must be in m/s; got bar"):
        bb.sweep("bogie", 4.0, ["distance"], bb.Recording({"initial_speed": "bar"}, [[1.0]]), level=1)


def test_an_interval_sets_the_rows_of_a_run_and_no_final_value() -> None:
    coarse = bb.sweep("bogie", 4.0, NAMES[:2], VARY, interval=1.0, **SCENE)
    run = bb.run("bogie", 4.0, interval=1.0, friction_1=0.1, **SCENE)
    assert coarse["maximum(axle_load_1)"][0] == pytest.approx(run["axle_load_1"].max(), rel=1e-9)
    final = bb.sweep("bogie", 4.0, ["distance"], VARY, **SCENE)
    assert coarse["distance"] == pytest.approx(final["distance"], rel=1e-6)
    short = bb.sweep("bogie", 1e-3, ["maximum(distance)", "distance"], VARY, **SCENE)
    assert np.array_equal(short["maximum(distance)"], short["distance"])


def test_the_probability_of_a_maximum_is_that_of_a_closed_form() -> None:
    """The largest speed of a braked run is its initial one: P(v > 26) of a uniform speed from 20 to 30 m/s is 0.4."""
    values = {"level": 1, "brake_torque_1": 9e3}
    found = bb.rare(
        "bogie",
        0.1,
        "maximum(speed)",
        26.0,
        {"initial_speed": uniform(20.0, 10.0)},
        particles=10,
        interval=0.05,
        **values,
    )
    assert found.interval[0] < 0.4 < found.interval[1]
    assert found.tail.names[0] == "maximum(speed)"


def never(run: bb.Recording) -> Any:
    return None


@pytest.mark.parametrize(
    ("call", "error", "sentence"),
    [
        (lambda: sweep(["maximum(axle_load)"]), KeyError, "There is no variable axle_load"),
        (lambda: sweep(["maximun(speed)"]), KeyError, "There is no statistic maximun; did you mean maximum"),
        (lambda: sweep(["percentile(speed)"]), ValueError, r"must be written as percentile\(NAME, SHARE\)"),
        (lambda: sweep(["maximum(speed, 3)"]), ValueError, r"must be written as maximum\(NAME\)"),
        (lambda: sweep(["percentile(speed, 101)"]), ValueError, "must be from 0 to 100 %; got 101"),
        (lambda: sweep(["percentile(speed, 0.95)"]), ValueError, r"must be in %; got 0\.95\. Write 95\."),
        (lambda: sweep(["speed", "speed"]), ValueError, "Each column must have a name of its own"),
        (lambda: sweep([]), ValueError, "names must have at least one result"),
        (lambda: sweep(["speed"], interval=0.1), ValueError, "interval must be left out where all results are final"),
        (
            lambda: sweep(["maximum(speed)"], interval=0.0),
            ValueError,
            "The interval must be a number of seconds above 0",
        ),
        (
            lambda: sweep(["maximum(speed)"], interval=2.0),
            ValueError,
            "interval must be at most the duration, 1 s; got 2 s",
        ),
        (lambda: sweep([], reduce={"jerk [m/s3]": 3}), TypeError, "reduce must have functions by name"),
        (lambda: sweep([], reduce=steepest), TypeError, "reduce must have functions by name"),
        (lambda: sweep([], reduce={"jerk": steepest}, folder="kept"), TypeError, "Leave folder out"),
        (lambda: in_processes(), TypeError, "must stand at the top level of a file"),
        (lambda: bb.batch("bogie", 1.0, ["speed"], interval=0.1), ValueError, "interval must be left out"),
        (lambda: likely(interval=0.1), ValueError, "interval must be left out"),
    ],
)
def test_a_wrong_result_is_refused_in_one_message(
    call: Callable[[], Any], error: type[Exception], sentence: str
) -> None:
    with pytest.raises(error, match=sentence):
        call()


def sweep(names: list[str], **how: Any) -> bb.Recording:
    return bb.sweep("bogie", 1.0, names, VARY, level=1, **how)


def in_processes() -> None:
    with ProcessPoolExecutor(1) as pool:
        sweep([], executor=pool, reduce={"jerk": lambda run: 0.0})


def likely(**how: Any) -> None:
    bb.rare("bogie", 1.0, "speed", 30.0, {"initial_speed": norm(25.0, 1.0)}, level=1, **how)


def test_a_function_that_fails_fails_its_row() -> None:
    table = sweep(["speed"], reduce={"jerk": never, "half": lambda run: 1 / 0})
    assert np.all(np.isnan(table["speed"]))
    assert "Row 0: The function of jerk must return a number; got None." in table.messages
    assert sweep(["speed"], reduce={"none": lambda run: np.float32(np.nan)})["speed"][0] > 0.0

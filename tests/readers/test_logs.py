"""Test the reader of logs: names, units, clocks, gaps and missing values, and what is refused."""

from __future__ import annotations

import json
import math
import os
import re
from pathlib import Path

import numpy as np
import pytest

from bogie_braking.controllers.replay import read_log as read_replayed
from readers.columns import TableError
from readers.log_rows import after_events, averaged, filled
from readers.logs import read_log
from scenarios.bench.torque_history import read_torque_history

VARIABLES = {"time": "s", "speed": "m/s", "distance": "m", "wheel_speed_1": "m/s", "wheel_speed_2": "m/s"}
VARIABLES |= {"pressure_1": "Pa", "pressure_2": "Pa"}
#: Logs of others: altrios_speed_trace.csv of NREL ALTRIOS.
OF_OTHERS = Path(os.environ.get("LOGS_OF_OTHERS", "nowhere"))


@pytest.fixture
def log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return Path("log.csv")


@pytest.mark.parametrize(
    ("text", "columns", "expected"),
    [
        ("t,v [m/s]\n0,1\n1,2\n", None, {"time": [0, 1], "speed": [1, 2]}),
        ("Zeit [Sek.],v [m/s]\n0,1\n1,2\n", None, {"time": [0, 1], "speed": [1, 2]}),
        ("Zeit;Geschwindigkeit / km/h\n0;3,6\n0,5;7,2\n", None, {"time": [0, 0.5], "speed": [1, 2]}),
        ("time_ms,axle_1_speed [km/h]\n0,36\n50,72\n", None, {"time": [0, 0.05], "wheel_speed_1": [10, 20]}),
        ("t [s],V Zug in km/h\n0,36\n1,72\n", {"V Zug": "speed"}, {"time": [0, 1], "speed": [10, 20]}),
        (
            "epoch,n1 [rpm],v_kmh\n1767225600.25,60,36\n1767225600.5,120,36\n",
            {"n1": {"name": "wheel_speed_1", "diameter": 2 / math.pi}},
            {"time": [0, 0.25], "wheel_speed_1": [2, 4], "speed": [10, 10]},
        ),
        (
            "time,Druck 1 [bar],C-Druck 2 [bar]\n0,1,2\n1,1.5,2\n",
            None,
            {"time": [0, 1], "pressure_1": [1e5, 1.5e5], "pressure_2": [2e5, 2e5]},
        ),
        (
            "time,p [bar]\n0,1\n1,1.5\n",
            {"p": ["pressure_1", "pressure_2"]},
            {"time": [0, 1], "pressure_1": [1e5, 1.5e5], "pressure_2": [1e5, 1.5e5]},
        ),
        (
            "time,omega_1 [rad/s]\n0,10\n1,20\n",
            {"omega_1": {"name": "wheel_speed_1", "diameter": "1000 mm"}},
            {"time": [0, 1], "wheel_speed_1": [5, 10]},
        ),
        (
            "t_ms,v_kmh,C_bar\n0,36,3\n500,72,3.5\n",
            {"t_ms": "time", "v_kmh": "speed", "C_bar": ["pressure_1", "pressure_2"]},
            {"time": [0, 0.5], "speed": [10, 20], "pressure_1": [3e5, 3.5e5], "pressure_2": [3e5, 3.5e5]},
        ),
        (
            "time,v_kmh\n0,1\n1,2\n",
            {"v_kmh": {"name": "speed", "unit": "m/s"}},
            {"time": [0, 1], "speed": [1, 2]},
        ),
        ("2,speed\n", None, {}),
        (
            "time,speed,speed_raw\n0,1,8\n1,2,9\n",
            {"speed": False, "speed_raw": "speed"},
            {"time": [0, 1], "speed": [8, 9]},
        ),
        (
            "time,speed\n0,1\n1,-1\n2,4\n",
            {"speed": {"name": "speed", "missing": [-1]}},
            {"time": [0, 1, 2], "speed": [1, math.nan, 4]},
        ),
        (",time,speed\n0,5,1\n1,6,2\n", None, {"time": [5, 6], "speed": [1, 2]}),
        (
            "timestamp,speed\n2026-01-01 00:00:00+01:00,1\n2025-12-31T23:00:02.5Z,2\n",
            None,
            {"time": [0, 2.5], "speed": [1, 2]},
        ),
        ("time [ns],speed\n1,1\n", None, {}),
    ],
)
def test_columns_get_names_and_units_of_variables(text: str, columns: object, expected: dict, log: Path) -> None:
    log.write_text(text)
    if not expected:
        with pytest.raises(TableError):
            read_log(log, VARIABLES, columns)
        return
    found = read_log(log, VARIABLES, columns)
    assert list(found.numbers) == list(expected)
    for name, values in expected.items():
        np.testing.assert_allclose(found.numbers[name], values, rtol=1e-15, atol=1e-15)


@pytest.mark.parametrize(
    ("text", "columns", "said"),
    [
        (
            "time,v_gps [km/h],v_ist [km/h]\n0,1,1\n1,1,1\n",
            None,
            "the columns 'v_gps [km/h] and v_ist [km/h]' can both be speed. Name one in a map",
        ),
        (
            "time,p [bar]\n0,1\n1,1\n",
            None,
            "the column 'p [bar]' can be pressure_1, pressure_2. Name it in a map (--columns, columns=): \"p [bar]\" = "
            '["pressure_1", "pressure_2"], or those of them that have it, or false.',
        ),
        ("time,n1 [rpm]\n0,1\n1,1\n", None, "the column 'n1 [rpm]' in rpm needs the diameter of its wheel"),
        ("time,sped\n0,1\n1,1\n", None, "row 1: the column sped is unknown. Did you mean speed?"),
        ("time,speed [bar]\n0,1\n1,1\n", None, "row 1: the unit 'bar' of speed is of another quantity."),
        ("time,speed\n0,1\n1,x\n", None, "row 3, column speed: the value must be a number; got 'x'."),
        ("time,speed\n0,1,5\n1,1,5\n", None, "row 2: a row must have at most 2 values"),
        ("time,speed,,\n0,5,20,5\n", None, "row 2: a row must have at most 2 values; got 3"),
        (
            "time,speed\n0,1\n0,2\n0,3\n1,3\n",
            None,
            "row 3, column time: values must grow from row to row; got 0 s after 0 s. 2 rows repeat a time",
        ),
        (
            "time,speed\n0,1\n2,2\n1,3\n",
            None,
            "row 4, column time: values must grow from row to row; got 1 s after 2 s. Sort the rows",
        ),
        (
            "Uhrzeit,speed\n12:00:00,1\n12:61:00,2\n",
            None,
            "row 3, column time: times must have one form; got '12:61:00'.",
        ),
        ("time,speed\n2026-05-01T12:00:00Z,1\n2026-05-01T12:00:01,2\n", None, "times must have one form"),
        (
            "time,speed\n12:00,1\n12:01,2\n",
            None,
            "row 2, column time: times must be numbers, dates or times of day; got '12:00'. Write",
        ),
        (
            "time,speed\n" + "".join(f"{46143.5 + t / 864000:.9f},1\n" for t in range(20)),
            None,
            "row 2, column time: times without a unit must not be days, as spreadsheets write them; got 46143.5 with",
        ),
        (
            "Zeit;v [m/s]\n46143,5;1\n46143,5006;2\n",
            None,
            "row 2, column time: times without a unit must not be days",
        ),
        (
            "time,speed\n" + "".join(f"{0.5 + t / 86400:.9f},1\n" for t in range(20)),
            None,
            "row 2, column time: times without a unit must not be days, as spreadsheets write them; got 0.5 with steps",
        ),
        ("time,speed\n0,1\n1,2\n", {"v": "speed"}, "columns: log.csv, row 1 has no column v; it has 'time, speed'."),
        (
            "time,speed\n0,1\n1,2\n",
            {"speed": "sped"},
            "columns: speed must be the name of a variable; got sped. Did you mean speed?",
        ),
        (
            "time,w\n0,1\n1,2\n",
            {"w": {"name": "speed", "diameter": 920}},
            "diameter must be from 0.2 to 2.5 m; got 920.",
        ),
        (
            "time,w\n0,1\n1,2\n",
            {"w": {"name": "speed", "factor": 2}},
            "must have the keys name, unit, diameter, missing; got factor.",
        ),
        ("time,n_rpm\n0,1\n1,2\n", {"n_rpm": "wheel_speed_1"}, "the column 'n_rpm' in rpm needs the diameter of its"),
        ("0,1\n1,2\n", None, "row 1: the first row must have names; got '0'."),
        (
            "time,x [m],x [km]\n0,1,1\n1,2,2\n",
            {"x [m]": "distance", "x [km]": "distance"},
            "columns: distance must be named once; it is named 2 times.",
        ),
        ("date,speed\n0,1\n1,2\n", None, "row 1: the column time is missing; there are 'date, speed'."),
    ],
)
def test_an_unclear_log_is_refused_with_the_remedy(text: str, columns: object, said: str, log: Path) -> None:
    log.write_text(text)
    with pytest.raises(TableError, match=re.escape(said)):
        read_log(log, VARIABLES, columns)


def test_columns_of_one_name_are_not_one_column(log: Path) -> None:
    log.write_text("time,load [t],load [kN]\n0,1,2\n1,1,2\n")
    with pytest.raises(TableError, match="the column load must be there once; it is there twice"):
        read_log(log, {}, others=True)
    read = read_log(log, {}, {"load [t]": "load", "load [kN]": "weight"}, others=True)
    assert list(read.numbers) == ["time", "load", "weight"]


def test_all_that_is_left_out_or_assumed_is_told(log: Path) -> None:
    rows = [f"{t},{10 + t % 3},{'x'},,20" for t in range(20)]
    rows[5] = "5,9999,x,,20"
    rows[6] = "6,n/a,x,,20"
    log.write_text("\n".join(["Zeit,speed,note,engine,cabin", *rows, rows[-1], "60,11,x,,20"]))
    assert read_log(log, VARIABLES).messages == [
        "log.csv: 'Zeit' is read as time [s].",
        "log.csv: 'speed' has no unit; m/s is assumed.",
        "log.csv: left out 'note' (text), 'engine' (no values), 'cabin' (no variable).",
        "log.csv: 'Zeit' has no unit; s is assumed.",
        "log.csv: 'speed' is 9999 in 1 row, taken as no value.",
        "log.csv: left out 1 row equal to the row before, as row 22.",
        "log.csv: 1 gap between rows, the longest 41 s after row 21; the usual step is 1 s.",
        "log.csv: speed has no value in 2 of 21 rows.",
    ]


def test_a_wheel_in_another_unit_than_the_vehicle_is_refused(log: Path) -> None:
    log.write_text("time,speed [km/h],wheel_speed_1\n0,72,72.5\n1,70,69.9\n")
    with pytest.raises(
        TableError, match=r"wheel_speed_1 must be near speed; got 3.6\d* times as much .*as if it were in km/h"
    ):
        read_log(log, VARIABLES)
    log.write_text("time,speed [km/h],wheel_speed_1 [km/h]\n0,72,20\n1,70,70\n")
    assert read_log(log, VARIABLES).numbers["wheel_speed_1"].size == 2


def test_a_number_near_the_others_is_a_value(log: Path) -> None:
    log.write_text("time,torque\n" + "\n".join(f"{t},{9000 + 111 * t}" for t in range(20)))
    assert not np.any(np.isnan(read_log(log, {"torque": "N.m"}).numbers["torque"]))


def test_clocks_lose_no_digit(log: Path) -> None:
    """As a number of 64 bits the time would be rounded to 0.24 us."""
    log.write_text("epoch,speed\n" + "\n".join(f"1767225600.{t:06d},1" for t in range(0, 900_000, 100_001)))
    assert read_log(log, VARIABLES).numbers["time"].tolist() == [t / 1e6 for t in range(0, 900_000, 100_001)]


def test_seconds_that_look_like_days_are_read_with_their_unit(log: Path) -> None:
    for first, step in ((46143.5, 0.01), (0.0, 1e-6)):
        times = first + step * np.arange(20)
        log.write_text("time [s],speed\n" + "".join(f"{t:.9f},1\n" for t in times))
        np.testing.assert_allclose(read_log(log, VARIABLES).numbers["time"], times, rtol=1e-12)
    log.write_text("time,speed\n" + "".join(f"{46143 + t},1\n" for t in range(20)))
    assert read_log(log, VARIABLES).numbers["time"][-1] == 46162.0


def test_speeds_in_kmh_under_a_name_in_metres_are_told(log: Path) -> None:
    time = np.arange(60.0)
    for begin, slowing, factor, said in (
        (60.0, 0.9, 1.0, []),
        (22.0, 0.9, 3.6, ["log.csv: the fastest wheel slows down by 3.24 m/s2 over 10 s, more than trains do."]),
        (40.0, 0.0, 3.6, ["log.csv: the fastest wheel reaches 144 m/s, more than trains do."]),
    ):
        speed = factor * np.maximum(begin - slowing * time, 0.0)
        rows = "".join(f"{t},{0.5 * v},{v}\n" for t, v in zip(time, speed, strict=True))
        log.write_text("time [s],wheel_speed_1 [m/s],wheel_speed_2 [m/s]\n" + rows)
        found = read_log(log, VARIABLES).messages
        assert [one.split(" Check")[0] for one in found] == said


def test_an_input_has_no_long_gap() -> None:
    times, values = np.arange(30.0), np.ones(30)
    values[3:14] = math.nan
    with pytest.raises(TableError, match=r"pressure must have no gap above 10 s, .* got one of 12 s after 2 s"):
        filled(times, values, "pressure")
    assert filled(times, values, "pressure", 12.0)[0].size == 19
    with pytest.raises(TableError, match="must have at least 2 values; it has 0"):
        filled(times, np.full(30, math.nan), "pressure")


def test_means_are_those_of_the_rows_in_each_interval() -> None:
    rows = np.array(
        [[0.0, 1.0], [0.1, math.nan], [0.3, 3.0], [0.30000000000000004 + 0.3, 5.0], [0.7, 7.0], [2.0, math.nan]]
    )
    expected = [[0.4 / 3, 2.0], [0.65, 6.0], [2.0, math.nan]]
    np.testing.assert_allclose(averaged(rows, 0.6), expected)


def test_torques_and_replays_take_maps_too(log: Path) -> None:
    log.write_text("Zeit [ms];M hinten [kNm];x\n0;0;a\n500;1,5;b\n")
    map_ = Path("map.toml")
    map_.write_text('"M hinten" = "torque"\n')
    times, torques, messages = read_torque_history(log, map_)
    assert (times.tolist(), torques.tolist()) == ([0.0, 0.5], [0.0, 1500.0])
    assert messages == ["log.csv: 'Zeit [ms]' is read as time [s].", "log.csv: left out 'x' (text)."]
    log.write_text("t;a;b\n0;60;60\n0,1;30;60\n")
    rule = {"unit": "rpm", "diameter": "0.92 m"}
    keys = {name: {"name": f"wheel_speed_{at}", **rule} for at, name in ((1, "a"), (2, "b"))}
    map_.write_text(
        "\n".join(
            f"{key} = {{ {', '.join(f'{one} = {json.dumps(value)}' for one, value in of.items())} }}"
            for key, of in keys.items()
        )
    )
    assert read_replayed(log, map_)["wheel_speed_1"] == pytest.approx([0.92 * math.pi, 0.46 * math.pi], rel=1e-15)


@pytest.mark.skipif(not OF_OTHERS.is_dir(), reason="LOGS_OF_OTHERS names no folder of their files")
def test_a_log_of_others_is_read() -> None:
    path = OF_OTHERS / "altrios_speed_trace.csv"
    found = read_log(path, VARIABLES)
    assert found.numbers["speed"].size == 10328
    assert [one.removeprefix(f"{path}: ") for one in found.messages] == [
        "'speed' has no unit; m/s is assumed.",
        "left out 'engine_on' (no values).",
        "'time' has no unit; s is assumed.",
    ]


def test_rows_of_one_time_are_an_event(log: Path) -> None:
    """The first one holds until there, the last one from there on; those of an iteration between them fall away."""
    log.write_text("time,speed\n0,9\n0,0\n1,0\n1,3\n1,5\n2,5\n3,5\n4,5\n5,5\n")
    found = read_log(log, VARIABLES)
    assert found.numbers["time"].tolist() == [0.0, 1.0 - 1e-5, 1.0, 2.0, 3.0, 4.0, 5.0]
    assert found.numbers["speed"].tolist() == [0.0, 0.0, 5.0, 5.0, 5.0, 5.0, 5.0]
    assert found.places.tolist() == [3, 4, 6, 7, 8, 9, 10]
    assert any("3 rows with the time before and other values, as row 3: an event" in one for one in found.messages)
    assert after_events(found.numbers["time"]).tolist() == [True, False, True, True, True, True, True]


@pytest.mark.parametrize(
    "text",
    [
        "time;speed;note\n0;1,000;0,1\n1;2,125;0,2\n",
        "Uhrzeit;speed\n12:00:00,5;1,000\n12:00:01,5;2,125\n",
        "time;speed;count\n2026-01-01 12:00:00,5;1,000;7\n2026-01-01 12:00:01,5;2,125;8\n",
    ],
)
def test_any_column_and_the_clock_show_the_decimal_mark(text: str, log: Path) -> None:
    log.write_text(text)
    assert read_log(log, VARIABLES).numbers["speed"].tolist() == [1.0, 2.125]
    log.write_text(text.replace("0,1", "1").replace("0,2", "2").replace(",5", ".5"))
    with pytest.raises(TableError, match="numbers must have one reading"):
        read_log(log, VARIABLES)

"""Fits to logs: the same run in many spellings gives the same fit; standard errors hold for correlated errors."""

from __future__ import annotations

import datetime
import math
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import lfilter

import bogie_braking as bb
from bogie_braking.correlated import errors_of

#: Largest relative difference of fits to one run in several spellings.
SAME = 1e-9
#: Largest relative error of a fit without noise, on a line.
ON_LINE = 2e-3
#: The coach, its brake torque on each wheelset [N.m], and the parameter that is fitted.
COACH = {"level": 1, "initial_speed": 30.0}
DAVIS = "davis_constant"
#: Row that every spelling lacks, in some as an empty cell or a number for no value.
LACKING = 33
#: Time of the first row as a clock: 23:59:58.3 on 30 April 2026, so that midnight is passed.
CLOCK = datetime.datetime(2026, 4, 30, 23, 59, 58, 300_000, datetime.timezone.utc)
#: Diameter of the wheel whose speed is logged [m].
DIAMETER = 0.92

Rows = list[tuple[float, float, float]]


@pytest.fixture(scope="module")
def rows() -> Rows:
    """Return time [s], speed [m/s] and torque on the first wheelset [N.m] every 0.1 s, with noise."""
    time = np.arange(101) / 10
    torque = np.interp(time, [0.0, 2.0, 6.0], [0.0, 0.0, 9e3])
    driven = {"brake_torque_1": (time, torque)}
    run = bb.run("vehicle", 10.0, None, ["speed"], 0.1, davis_constant=900.0, **COACH, **driven)
    speed = run["speed"] + np.random.default_rng(1).normal(0.0, 0.01, time.size)
    table = list(zip(time.tolist(), speed.tolist(), torque.tolist(), strict=True))
    return [row for at, row in enumerate(table) if at != LACKING]


def spelt(rows: Rows, head: str, row: Callable[[float, float, float], str]) -> str:
    return "\n".join([head, *(row(*one) for one in rows), ""])


def at(time: float) -> datetime.datetime:
    return CLOCK + datetime.timedelta(milliseconds=round(1e3 * time))


def comma(value: float) -> str:
    return repr(value).replace(".", ",")


def rpm(speed: float) -> float:
    return speed / (math.pi * DIAMETER) * 60


SPEED_BY_RPM = {"n1": {"name": "speed", "unit": "rpm", "diameter": "920 mm"}, "M": "brake_torque_1"}
#: Names of the forms: head, row, and map of names.
FORMS: dict[str, tuple[str, Callable[[float, float, float], str], object]] = {
    "SI": ("time [s],speed [m/s],brake_torque_1 [N.m]", lambda t, v, m: f"{t!r},{v!r},{m!r}", None),
    "km/h, decimal commas": (
        "Zeit;Geschwindigkeit [km/h];Bremsmoment 1 [kNm]",
        lambda t, v, m: f"{comma(t)};{comma(3.6 * v)};{comma(m / 1e3)}",
        None,
    ),
    "milliseconds, tabs, suffixes": (
        "t_ms\tspeed_kmh\tbrake_torque_1_nm",
        lambda t, v, m: f"{round(1e3 * t)}\t{3.6 * v!r}\t{m!r}",
        None,
    ),
    "mph": (
        "Elapsed time (s),Speed (mph),Brake torque 1 (kN.m)",
        lambda t, v, m: f"{t!r},{v / 0.44704!r},{m / 1e3!r}",
        None,
    ),
    "ISO dates": (
        "timestamp,v [km/h],brake_torque_1",
        lambda t, v, m: f"{at(t):%Y-%m-%dT%H:%M:%S.%f}Z,{3.6 * v!r},{m!r}",
        None,
    ),
    "German dates": (
        "Zeitstempel;v in km/h;brake_torque_1",
        lambda t, v, m: f"{at(t):%d.%m.%Y %H:%M:%S,%f};{comma(3.6 * v)};{comma(m)}",
        None,
    ),
    "times of day past midnight": (
        "Heure (UTC);v_ist [m/s];brake_torque_1",
        lambda t, v, m: f"{at(t):%H:%M:%S.%f};{v!r};{m!r}",
        None,
    ),
    "seconds since 1970": (
        "epoch,speed,brake_torque_1 [N.m]",
        lambda t, v, m: f"{at(t):%s}.{at(t):%f},{v!r},{m!r}".replace(f"{at(t):%s}", f"{int(at(t).timestamp())}"),
        None,
    ),
    "milliseconds since 1970": (
        "unix_time,speed,brake_torque_1 [N.m]",
        lambda t, v, m: f"{round(at(t).timestamp() * 1e3)},{v!r},{m!r}",
        None,
    ),
    "rpm of a wheel, by a map": (
        "time,n1,M [kNm]",
        lambda t, v, m: f"{t!r},{rpm(v)!r},{m / 1e3!r}",
        SPEED_BY_RPM,
    ),
    "text, empty columns, numbers for no value": (
        "time,speed [km/h],note,engine_on,brake_torque_1,cabin [degC]",
        lambda t, v, m: (
            f"{t!r},{3.6 * v!r},braking,,{m!r},20"
            + (f"\n{LACKING / 10},-999,lost,,NaN,20" if round(10 * t) == LACKING - 1 else "")
        ),
        None,
    ),
    "a title, a row of units, repeated rows": (
        "Log of run 12\nTime;Speed;Brake torque 1\nms;km/h;kN.m",
        lambda t, v, m: "\n".join([f"{round(1e3 * t)};{comma(3.6 * v)};{comma(m / 1e3)}"] * (2 if t == 5.0 else 1)),
        None,
    ),
}


def test_one_run_in_twelve_spellings_gives_one_fit(rows: Rows, tmp_path: Path) -> None:
    found = {}
    for name, (head, row, columns) in FORMS.items():
        path = tmp_path / "log.csv"
        path.write_text(spelt(rows, head, row), encoding="utf-16" if "German" in name else "utf-8")
        found[name] = bb.fit("vehicle", path, {DAVIS: 500.0}, columns=columns, **COACH)
    first = found["SI"]
    assert len(found) == 12
    assert first.values[DAVIS] == pytest.approx(900.0, abs=3 * first.standard_errors[DAVIS])
    for name, one in found.items():
        assert one.values[DAVIS] == pytest.approx(first.values[DAVIS], rel=SAME), name
        assert one.standard_errors[DAVIS] == pytest.approx(first.standard_errors[DAVIS], rel=1e-6), name


def test_one_run_in_binary_files_gives_one_fit(rows: Rows, tmp_path: Path) -> None:
    """In MDF with the torque every 0.5 s: it changes linearly between its rows, so that bridging has no error."""
    pytest.importorskip("h5py")
    asammdf = pytest.importorskip("asammdf")
    table = np.array(rows)
    head, row, _ = FORMS["SI"]
    paths = [tmp_path / "log.csv", tmp_path / "bus.mf4"]
    paths[0].write_text(spelt(rows, head, row))
    units = {"Zeit": "s", "v_ist": "km/h", "Bremsmoment 1": "kNm"}
    paths += [bb.Recording(units, table * [1.0, 3.6, 1e-3]).write(tmp_path / f"log{end}") for end in (".mat", ".h5")]
    with asammdf.MDF(version="4.10") as mdf:
        time, speed, torque = table.T
        rare = np.isin(np.round(10 * time), np.arange(0, 101, 5))
        mdf.append(asammdf.Signal(3.6 * speed, time, name="v_ist", unit="km/h"))
        mdf.append(asammdf.Signal(1e-3 * torque[rare], time[rare], name="Bremsmoment 1", unit="kNm"))
        mdf.save(paths[1])
    found = [bb.fit("vehicle", path, {DAVIS: 500.0}, **COACH) for path in paths]
    for one in found[1:]:
        assert one.values[DAVIS] == pytest.approx(found[0].values[DAVIS], rel=SAME)
        assert one.standard_errors[DAVIS] == pytest.approx(found[0].standard_errors[DAVIS], rel=1e-6)


def test_a_speed_in_another_unit_is_refused_if_it_begins_late(tmp_path: Path) -> None:
    """The first row of the log has the torque alone, as another raster begins before that of the speed."""
    rows = [f"{t / 10},{'' if t % 2 == 0 else 3.6 * 30.0},{0 if t % 2 == 0 else ''}" for t in range(40)]
    (tmp_path / "log.csv").write_text("\n".join(["time [s],speed [m/s],brake_torque_1 [N.m]", *rows, ""]))
    with pytest.raises(ValueError, match=r"speed must begin near 30 m/s, .* got 108 m/s .* as if in km/h"):
        bb.fit("vehicle", tmp_path / "log.csv", {DAVIS: 500.0}, **COACH)


def test_a_map_in_a_file_is_that_in_python(rows: Rows, tmp_path: Path) -> None:
    head, row, columns = FORMS["rpm of a wheel, by a map"]
    log, names = tmp_path / "log.csv", tmp_path / "map.toml"
    log.write_text(spelt(rows, head, row))
    names.write_text('n1 = { name = "speed", unit = "rpm", diameter = 0.92 }\n"M [kNm]" = "brake_torque_1"\n')
    both = [bb.measured_from(log, one) for one in (columns, names)]
    assert both[0].units == both[1].units == {"time": "s", "speed": "m/s", "brake_torque_1": "kNm"}
    assert np.array_equal(both[0]["speed"], both[1]["speed"])


def test_a_log_in_another_unit_is_refused_or_told(
    rows: Rows, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "log.csv"
    path.write_text(spelt(rows, "time [s],speed [m/s]", lambda t, v, _: f"{t!r},{3.6 * v!r}"))
    said = "speed must begin near 30 m/s, as the run does; got 108 m/s in the first row, as if in km/h."
    with pytest.raises(ValueError, match=re.escape(said)):
        bb.fit("vehicle", path, {DAVIS: 500.0}, **COACH)
    path.write_text(spelt(rows, "t [s],speed [m/s],note", lambda t, v, _: f"{t!r},{v - 12.0!r},x"))
    capsys.readouterr()
    found = bb.fit("vehicle", path, {DAVIS: 500.0}, **COACH)
    assert "The run does not describe speed: it is off by " in found.status
    assert "speed begins at 18 m/s in the log and at 30 m/s in the run." in found.status
    told = [f"{path}: 't [s]' is read as time [s].", f"{path}: left out 'note' (text)."]
    assert capsys.readouterr().err.splitlines() == told


def test_a_gap_in_an_input_is_refused_and_can_be_allowed(rows: Rows, tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    gap = [row for row in rows if not 3.0 < row[0] < 6.0]
    path.write_text(spelt(gap, *FORMS["SI"][:2]))
    with pytest.raises(
        ValueError, match=r"brake_torque_1 must have no gap above 2 s, as it drives the run; got one of 3 s"
    ):
        bb.fit("vehicle", path, {DAVIS: 500.0}, **COACH)
    bridged = bb.fit("vehicle", path, {DAVIS: 500.0}, longest_gap=3.5, **COACH)
    assert bridged.values[DAVIS] == pytest.approx(900.0, abs=4 * bridged.standard_errors[DAVIS])


def test_rows_are_averaged_over_intervals(rows: Rows, tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text(spelt(rows, *FORMS["SI"][:2]))
    every, mean = (bb.fit("vehicle", path, {DAVIS: 500.0}, interval=one, **COACH) for one in (None, 0.5))
    assert mean.fitted["time"].size == 21
    assert mean.values[DAVIS] == pytest.approx(every.values[DAVIS], abs=every.standard_errors[DAVIS])


def test_brake_force_friction_and_resistance_are_found_on_ones_own_line(tmp_path: Path) -> None:
    """A measured torque locks wheelset 1, a constant one brakes wheelset 2. Without the line the fit does not hold."""
    line = bb.line_of([bb.straight(300.0), bb.straight(400.0, gradient=0.01), bb.straight(900.0, gradient=-0.005)])
    true = {"davis_quadratic": 6.0, "friction_1": 0.07, "brake_torque_2": 2.5e3}
    time = np.arange(151) / 5
    torque = np.interp(time, [0.0, 10.0, 11.0], [0.0, 0.0, 20e3])
    run = bb.run("vehicle", 30.0, line, ["speed"], 0.2, **true, **COACH, brake_torque_1=(time, torque))
    path, begin = tmp_path / "run.csv", {"davis_quadratic": 4.0, "friction_1": 0.1, "brake_torque_2": 2e3}
    table = np.column_stack([time, 3.6 * run["speed"], torque / 1e3])
    np.savetxt(path, table, "%.12g", ";", header="t [s];v [km/h];M [kNm]", comments="")
    found, without = (
        bb.fit("vehicle", path, begin, one, columns={"M": "brake_torque_1"}, **COACH) for one in (line, None)
    )
    for name, value in true.items():
        assert found.values[name] == pytest.approx(value, rel=ON_LINE), name
    assert found.deviations["speed"] < 1e-3 < without.deviations["speed"]


# ---- correlated errors ---------------------------------------------------------------------------------------------

#: Rows every 0.1 s, correlation time [s], size of the errors [m/s].
STEP, OVER, NOISE = 0.1, 1.0, 0.05


def coasting() -> bb.Recording:
    return bb.run("vehicle", 60.0, None, ["speed"], STEP, davis_constant=2000.0, **COACH)


def with_errors(run: bb.Recording, seed: int) -> bb.Recording:
    """Return a run with errors of an autoregressive process of first order."""
    rho = math.exp(-STEP / OVER)
    white = np.random.default_rng(seed).normal(0.0, 1.0, run["speed"].size)
    white[1:] *= math.sqrt(1 - rho**2)
    errors = NOISE * lfilter([1.0], [1.0, -rho], white)
    return bb.Recording(run.units, np.column_stack([run["time"], run["speed"] + errors]))


def within(seeds: int) -> tuple[int, list[float]]:
    """Return how many fits lie within two standard errors, and the correlation times found [s]."""
    run, count, times = coasting(), 0, []
    for seed in range(seeds):
        found = bb.fit("vehicle", with_errors(run, seed), {DAVIS: 1500.0}, **COACH)
        count += abs(found.values[DAVIS] - 2000.0) < 2 * found.standard_errors[DAVIS]
        times.append(found.correlation_times["speed"])
    return count, times


@pytest.mark.study
def test_standard_errors_hold_for_errors_correlated_over_a_second() -> None:
    """Of 25 fits at least 21 lie within two standard errors; with independent errors it would be half."""
    count, times = within(25)
    assert count >= 21
    assert np.median(times) == pytest.approx(OVER, rel=0.3)


@pytest.mark.long
def test_90_to_99_of_100_seeds_lie_within_two_standard_errors() -> None:
    count, _ = within(100)
    print(f"{count} of 100")
    assert 90 <= count <= 99


def test_errors_are_those_that_were_drawn() -> None:
    """Share and time of an autoregressive process with an independent part, at irregular times."""
    random = np.random.default_rng(5)
    times = np.sort(random.uniform(0.0, 400.0, 4000))
    decay = np.exp(-np.diff(times) / 2.0)
    slow = random.normal(0.0, 1.0, times.size)
    for row, keep in enumerate(decay):
        slow[row + 1] = keep * slow[row] + math.sqrt(1 - keep**2) * slow[row + 1]
    drawn = 3.0 * (math.sqrt(0.6) * slow + math.sqrt(0.4) * random.normal(0.0, 1.0, times.size))
    found = errors_of(times, drawn, np.ones((times.size, 1)))
    assert found.variance == pytest.approx(9.0, rel=0.15)
    assert found.share == pytest.approx(0.6, abs=0.08)
    assert found.time == pytest.approx(2.0, rel=0.2)
    white = errors_of(times, random.normal(0.0, 1.0, times.size), np.ones((times.size, 1)))
    assert white.share == 0.0
    assert white.variance == pytest.approx(1.0, rel=0.05)


def test_their_covariance_is_that_of_the_dense_matrix() -> None:
    random = np.random.default_rng(2)
    times = np.sort(random.uniform(0.0, 3.0, 40))
    slopes = np.column_stack([times, times**2])
    errors = errors_of(times, random.normal(0.0, 1.0, 40), slopes)
    errors = type(errors)(2.0, 0.7, 0.4)
    dense = 2.0 * (0.7 * np.exp(-np.abs(times[:, None] - times) / 0.4) + 0.3 * np.eye(40))
    assert errors.times(times, slopes) == pytest.approx(dense @ slopes, rel=1e-10)


def test_a_vehicle_from_its_data_sheet_is_fitted_as_it_runs(tmp_path: Path) -> None:
    path = tmp_path / "regio.toml"
    path.write_text('tare = "38 t"\nload = "6 t"\n[brake]\ndeceleration = "1.1 m/s2"\n')
    regio, name = bb.read_vehicle(path), "davis_constant"
    run = bb.run(regio, 10.0, None, ["speed"], 0.5, **{name: 2500.0}, initial_speed=30.0)
    found = bb.fit(regio, run, {name: 2000.0}, initial_speed=30.0)
    assert found.values[name] == pytest.approx(2500.0, rel=1e-3)


def test_a_value_that_ends_at_its_limit_is_reported() -> None:
    """A coach that coasts cannot gain speed: its resistance is fitted to 0, the lower limit of 0 N."""
    coast = bb.run("vehicle", 20.0, None, ["speed"], 0.5, level=1, initial_speed=20.0, davis_constant=50.0)
    coast["speed"][:] = 20.0 + 0.01 * coast["time"]
    found = bb.fit("vehicle", coast, {"davis_constant": 500.0}, level=1, initial_speed=20.0)
    assert any(one.startswith("davis_constant ended at its limit of 0") for one in found.warnings)
    assert "ended at its limit" in found.status


def test_inputs_that_the_log_lacks_beside_one_that_it_has_are_told(rows: Rows, tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text(spelt(rows, *FORMS["SI"][:2]))
    found = bb.fit("vehicle", path, {DAVIS: 500.0, "brake_torque_2": 100.0}, **COACH, brake_torque_3=0.0)
    lacks = "The log has brake_torque_1, but it lacks brake_torque_4 (0 N.m): start values are taken."
    assert next(one for one in found.warnings if "lacks" in one).startswith(lacks)
    stated = dict.fromkeys([f"brake_torque_{number}" for number in (2, 3, 4)], 0.0)
    assert not bb.fit("vehicle", path, {DAVIS: 500.0}, **COACH, **stated).warnings


def test_a_row_alone_is_refused() -> None:
    table = bb.Recording({"time": "s", "speed": "m/s"}, np.array([[0.0, 30.0]]))
    with pytest.raises(ValueError, match="1 measured values do not decide on 1 parameters"):
        bb.fit("vehicle", table, {DAVIS: 500.0}, **COACH)


@pytest.mark.parametrize(
    ("factor", "message"), [(1e-5, "at most 3 Pa. Did you mean 3 bar"), (1e-3, "at most 300 Pa. Did you mean 300 kPa")]
)
def test_a_pressure_in_another_unit_is_refused(factor: float, message: str) -> None:
    """A cylinder that fills to 3 bar, logged in bar and in kPa under Pa."""
    times = np.arange(50) / 10
    pressures = 3e5 * (1.0 - np.exp(-times)) / (1.0 - math.exp(-4.9))
    demand = np.where(times > 0.0, 3e5, 0.0)
    for columns in ((pressures, factor * demand), (factor * pressures, demand)):
        table = bb.Recording(
            {"time": "s", "cylinder_pressure": "Pa", "pressure_demand": "Pa"}, np.column_stack([times, *columns])
        )
        with pytest.raises(ValueError, match=message):
            bb.fit("brake", table, {"supply_pressure": 5e5})
    brake = bb.run("brake", 2.0, None, ["cylinder_pressure"], 0.1, pressure_demand=180e3)
    for given in ({}, {"pressure_demand": 180e3}):
        found = bb.fit("brake", brake, {"application_time": 0.7}, **given)
        lacks = "The log has cylinder_pressure, but it lacks pressure_demand (350000 Pa): start values are taken."
        assert any(one.startswith(lacks) for one in found.warnings) == (not given)

"""Logs in binary files, written by other packages as loggers and MATLAB write them, and what is refused."""

from __future__ import annotations

import math
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.io
from scipy.io import savemat

from bogie_braking.controllers.replay import read_log as replayed_log
from bogie_braking.friction_logs import friction_logs
from fmu_src.cosimulation.recording import Recording
from readers.extras import MissingExtraError
from readers.formats.table_files import ENDS
from readers.log_columns import COMMON
from readers.logs import read_log
from readers.text import FileError

asammdf = pytest.importorskip("asammdf")
h5py = pytest.importorskip("h5py")
pandas = pytest.importorskip("pandas")
pyarrow = pytest.importorskip("pyarrow")

VARIABLES = COMMON | {"cylinder_pressure": "Pa", "valve_1": "1"}
#: Files of MATLAB that SciPy brings for its own tests.
OF_MATLAB = Path(scipy.io.__file__).parent / "matlab" / "tests" / "data"
TIME = 0.01 * np.arange(300)
SPEED = 20.0 - 0.9 * TIME
RUN = {"time": "s", "speed": "m/s", "Kraft ä μ": "kN", "wheel_speed_1": "m/s"}


@pytest.fixture
def run() -> Recording:
    rows = np.random.default_rng(7).standard_normal((300, 4)) + 20.0
    rows[:, 0] = TIME * (1.0 + 1e-13)
    rows[5:9, 2] = math.nan
    return Recording(RUN, rows)


@pytest.mark.parametrize("end", ENDS)
def test_a_written_run_is_read_bit_for_bit(end: str, run: Recording, tmp_path: Path) -> None:
    about = {"version": "3.1", "inputs": "two\nlines, ä"}
    read = read_log(run.write(tmp_path / f"Lauf ü{end}", about), COMMON, others=True)
    assert read.units == {name: RUN[name] for name in read.numbers}
    assert set(read.numbers) == set(RUN)
    for name, values in read.numbers.items():
        np.testing.assert_array_equal(values, run[name])
    assert list(tmp_path.iterdir()) == [tmp_path / f"Lauf ü{end}"]


@pytest.mark.parametrize("end", ENDS)
def test_a_table_without_times_is_read_bit_for_bit(end: str, tmp_path: Path) -> None:
    table = Recording({"share": "%", "level": "1", "stops": "m"}, [[3.0, 1.0, math.nan], [1.0, 1.0, math.nan]])
    if end == ".mf4":
        table.add("time", "s", np.array([0.0, 1.0]))
    read = Recording.read(table.write(tmp_path / f"table{end}"))
    assert read.units == table.units
    for name in table.names:
        np.testing.assert_array_equal(read[name], table[name])


def test_provenance_is_where_other_programs_show_it(run: Recording, tmp_path: Path) -> None:
    from scipy.io import loadmat

    paths = {end: run.write(tmp_path / f"run{end}", {"version": "3.1"}) for end in ENDS}
    assert paths[".csv"].read_text(encoding="utf-8").startswith("# version: 3.1\ntime [s],speed [m/s],")
    assert pyarrow.parquet.read_schema(paths[".parquet"]).metadata == {b"version": b"3.1"}
    mat = loadmat(paths[".mat"], simplify_cells=True)
    assert (mat["metadata"], mat["units"]["speed"]) == ({"version": "3.1"}, "m/s")
    with asammdf.MDF(paths[".mf4"]) as mdf, h5py.File(paths[".h5"]) as file:
        assert "version: 3.1" in mdf.header.comment
        assert mdf.get("speed").unit == file["speed"].attrs["units"] == "m/s"
        assert file.attrs["version"] == "3.1"


def test_groups_of_an_mdf_keep_their_own_samples(tmp_path: Path) -> None:
    """A bus in km/h every 10 ms, pressures as raw counts every 100 ms, an enumeration, and invalid samples."""
    path, slow, late = tmp_path / "run.mf4", TIME[::10] + 0.003, TIME + 1e-9
    invalid = np.zeros(300, bool)
    invalid[3] = True
    counts = asammdf.Signal(np.arange(30, dtype="<u2"), slow, name="p_C", unit="bar", conversion={"a": 0.02, "b": 0.5})
    states = {"val_0": 0, "text_0": b"closed", "val_1": 1, "text_1": b"open", "default": b"?"}
    with asammdf.MDF(version="4.10") as mdf:
        mdf.append(asammdf.Signal(3.6 * SPEED, TIME, name="v_ist", unit="km/h", invalidation_bits=invalid))
        mdf.append([counts])
        valve = (np.arange(300) % 2).astype("u1")
        mdf.append(asammdf.Signal(valve, late, name="Ventil 1", conversion=states))
        mdf.append(asammdf.Signal(np.array([b"a"] * 300), TIME, name="note", encoding="utf-8"))
        mdf.save(path)
    read = read_log(path, VARIABLES)
    assert read.numbers["time"].size == 330
    on_bus = np.isfinite(read.numbers["valve_1"])
    expected = np.where(invalid, math.nan, SPEED)
    np.testing.assert_allclose(read.numbers["speed"][on_bus], expected, rtol=1e-15)
    there = np.isfinite(read.numbers["cylinder_pressure"])
    np.testing.assert_allclose(read.numbers["time"][there], slow, rtol=0, atol=1e-15)
    np.testing.assert_allclose(read.numbers["cylinder_pressure"][there], 1e5 * (0.5 + 0.02 * np.arange(30)))
    assert np.sum(on_bus & there) == 0
    np.testing.assert_array_equal(read.numbers["valve_1"][on_bus], valve)
    said = "columns without values in the rows of each other: speed (each 0.01 s); cylinder_pressure (each 0.1 s); "
    assert f"{path}: {said}valve_1 (each 0.01 s)." in read.messages
    assert f"{path}: left out 'note' (text)." in read.messages


@pytest.mark.parametrize(("version", "end"), [("2.14", ".dat"), ("3.30", ".mdf"), ("4.20", ".mf4")])
def test_versions_of_mdf_give_the_same_numbers(version: str, end: str, tmp_path: Path) -> None:
    with asammdf.MDF(version=version, column_storage=True) as mdf:  # 4.20: each channel in a group of its own
        mdf.append([asammdf.Signal(SPEED, TIME, name="speed", unit="m/s")])
        place = mdf.save(tmp_path / f"run{end}")
    place = place.rename(place.with_suffix(end))
    np.testing.assert_array_equal(read_log(place, COMMON).numbers["speed"], SPEED)


def test_a_name_in_several_groups_is_chosen_by_its_group(tmp_path: Path) -> None:
    path = tmp_path / "run.mf4"
    with asammdf.MDF(version="4.10") as mdf:
        for name, offset in (("GPS", 0.0), ("MVB", 1.0)):
            mdf.append(asammdf.Signal(SPEED + offset, TIME, name="speed", unit="m/s"), acq_source=None, comment=name)
        mdf.save(path)
    with pytest.raises(FileError, match=r'can both be speed\. Name one in a map .*: "GPS/speed" = "speed"'):
        read_log(path, COMMON)
    assert read_log(path, COMMON, {"MVB/speed": "speed"}).numbers["speed"][0] == SPEED[0] + 1.0
    both = read_log(path, {}, others=True)
    assert list(both.numbers) == ["time", "GPS/speed", "MVB/speed"]
    assert not any("without values" in one for one in both.messages)


def test_a_dat_that_is_no_mdf_is_text(tmp_path: Path) -> None:
    path = tmp_path / "run.dat"
    path.write_text("time;speed\n0;1,5\n1;2\n")
    assert read_log(path, COMMON).numbers["speed"].tolist() == [1.5, 2.0]


def flat(at: Path) -> None:
    units = {"v": "km/h", "p_c": "bar"}
    savemat(at, {"t": TIME, "v": 3.6 * SPEED, "p_c": 2.0 + TIME, "units": units, "mass": 40.0, "title": "run"})


def beside(at: Path) -> None:
    savemat(at, {"t": TIME, "v": 3.6 * SPEED, "v_unit": "km/h", "p_c": 2.0 + TIME, "p_c_unit": "bar"})


def struct_of_run(at: Path) -> None:
    savemat(at, {"run": {"Zeit": TIME, "v_kmh": 3.6 * SPEED, "p_c_bar": 2.0 + TIME}})


def signals(at: Path) -> None:
    """As exported by tools for measurements: a struct for each signal."""
    one = {"time": TIME, "data": 3.6 * SPEED, "unit": "km/h"}
    savemat(at, {"v_ist": one, "p_c": {"Time": TIME, "Data": 2.0 + TIME, "Unit": "bar"}})


def to_workspace(at: Path) -> None:
    """As Simulink's To Workspace: structure with time."""
    both = np.zeros((2,), dtype=[("values", "O"), ("dimensions", "O"), ("label", "O")])
    both[0], both[1] = (3.6 * SPEED[:, None], 1.0, "v / km/h"), (2.0 + TIME[:, None], 1.0, "p_c in bar")
    savemat(at, {"logsout": {"time": TIME[:, None], "signals": both, "blockName": "model/scope"}})


@pytest.mark.parametrize("form", [flat, beside, struct_of_run, signals, to_workspace])
@pytest.mark.parametrize("turned", [False, True])
def test_forms_of_matlab_files_are_one_log(form: Callable[[Path], None], turned: bool, tmp_path: Path) -> None:
    path = tmp_path / "run.mat"
    form(path)
    if turned:
        path = as_7_3(path)
    read = read_log(path, VARIABLES)
    assert set(read.numbers) == {"time", "speed", "cylinder_pressure"}, read.messages
    np.testing.assert_array_equal(read.numbers["time"], TIME)
    np.testing.assert_allclose(read.numbers["speed"], SPEED, rtol=1e-15)
    np.testing.assert_allclose(read.numbers["cylinder_pressure"], 1e5 * (2.0 + TIME), rtol=1e-15)


def as_7_3(path: Path) -> Path:
    """Write the variables of a file as MATLAB 7.3 does: transposed, text as UTF-16, struct arrays by reference."""
    from scipy.io import loadmat

    place = path.with_name("turned.mat")
    with h5py.File(place, "w", userblock_size=512) as file:
        for name, value in loadmat(path, struct_as_record=True).items():
            if not name.startswith("__"):
                _put(file, name, value)
    with place.open("r+b") as raw:
        raw.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64, Created on: Mon Nov 29 12:00:00 2026 HDF5 schema 1.00 .")
    return place


def _put(group: Any, name: str, value: np.ndarray) -> None:
    if value.dtype.names and value.size == 1:
        inner = group.create_group(name)
        inner.attrs["MATLAB_class"] = np.bytes_("struct")
        for field in value.dtype.names:
            _put(inner, field, value[0, 0][field])
    elif value.dtype.names:
        inner = group.create_group(name)
        inner.attrs["MATLAB_class"] = np.bytes_("struct")
        kept = group.file.require_group("#refs#")
        for field in value.dtype.names:
            places = []
            for element in value.ravel():
                _put(kept, key := f"{field}{len(kept)}", element[field])
                places.append(kept[key].ref)
            inner.create_dataset(field, data=np.array(places, h5py.ref_dtype).reshape(-1, 1))
    elif value.dtype.kind == "U":
        codes = np.frombuffer(str(value.item()).encode("utf-16-le"), np.uint16).reshape(-1, 1)
        group.create_dataset(name, data=codes).attrs["MATLAB_class"] = np.bytes_("char")
    else:
        group.create_dataset(name, data=value.T).attrs["MATLAB_class"] = np.bytes_("double")


@pytest.mark.skipif(not OF_MATLAB.is_dir(), reason="SciPy is installed without the files of its tests")
def test_files_of_matlab_itself_are_read_or_refused() -> None:
    """Versions 4.2 to 7.4 on several computers; the vector is 0:pi/4:2*pi."""
    read, said = dict[str, Recording](), list[str]()
    for path in sorted(OF_MATLAB.glob("*.mat")):
        try:
            read[path.name] = Recording.read(path)
        except FileError as error:
            said.append(str(error))
    assert len(read) >= 15
    assert all(one.startswith(str(OF_MATLAB)) and "\n" not in one for one in said)
    vectors = [table["testdouble"] for name, table in read.items() if name.startswith("testdouble")]
    assert len(vectors) == 5
    for vector in vectors:
        np.testing.assert_array_equal(vector, np.arange(9) * math.pi / 4)
    assert Recording.read(OF_MATLAB / "teststruct_7.4_GLNX86.mat").names == ["doublefield"]


def test_a_matrix_has_a_column_for_each_wheelset(tmp_path: Path) -> None:
    wheels = SPEED[:, None] * [1.0, 0.99]
    savemat(tmp_path / "run.mat", {"t": TIME[None, :], "wheel_speed": wheels})
    with h5py.File(tmp_path / "run.h5", "w") as file:
        file["t"], file["wheel_speed"] = TIME, wheels
    for end in ("mat", "h5"):
        read = read_log(tmp_path / f"run.{end}", COMMON).numbers
        np.testing.assert_array_equal(np.column_stack([read["wheel_speed_1"], read["wheel_speed_2"]]), wheels)


def test_a_struct_with_more_than_one_array_is_a_group(tmp_path: Path) -> None:
    savemat(tmp_path / "run.mat", {"run": {"t": TIME, "y": 0.0 * TIME, "speed": SPEED, "unit": "m/s"}})
    assert list(read_log(tmp_path / "run.mat", COMMON, others=True).numbers) == ["time", "speed", "y"]


def test_arrays_of_another_length_need_a_time_of_theirs(tmp_path: Path) -> None:
    path = tmp_path / "run.mat"
    savemat(
        path, {"t": TIME, "v": SPEED, "p_c": 2.0 + TIME[::5], "uhr": TIME[::5], "units": {"v": "m/s", "p_c": "bar"}}
    )
    with pytest.raises(FileError, match=r"'p_c' must have a time with as many values, 60; 't' has 300\. Name"):
        read_log(path, VARIABLES)
    read = read_log(path, VARIABLES, {"uhr": "time"}).numbers
    np.testing.assert_allclose(read["cylinder_pressure"][::5], 1e5 * (2.0 + TIME[::5]))
    assert np.sum(np.isfinite(read["cylinder_pressure"])) == 60
    read_without = read_log(path, VARIABLES, {"p_c": False})
    assert list(read_without.numbers) == ["time", "speed"]


@pytest.mark.parametrize("count", [0, 1])
def test_a_message_that_came_once_or_never_is_left_out(count: int, tmp_path: Path) -> None:
    with asammdf.MDF(version="4.10") as mdf:
        for name, at in (("speed", TIME), ("wheel_speed_1", TIME[:count])):
            mdf.append(asammdf.Signal(20.0 - at, at, name=name, unit="m/s"))
        mdf.save(tmp_path / "run.mf4")
    read = read_log(tmp_path / "run.mf4", COMMON)
    assert list(read.numbers) == ["time", "speed"]
    assert read.messages == [f"{read.source}: left out columns with fewer than 2 times: wheel_speed_1."]


@pytest.mark.parametrize("end", [".csv", ".parquet"])
def test_a_column_may_begin_late(end: str, tmp_path: Path) -> None:
    values = np.where(TIME < 2.5, math.nan, SPEED)
    table = Recording({"time": "s", "v_ist": "m/s"}, np.column_stack([TIME, values]))
    np.testing.assert_array_equal(read_log(table.write(tmp_path / f"run{end}"), COMMON).numbers["speed"], values)


def test_clocks_of_several_bases_have_one_begin(tmp_path: Path) -> None:
    begin = 1_767_225_600.0
    with h5py.File(tmp_path / "run.h5", "w") as file:
        for name, late, values in (("speed", 0.0, SPEED), ("distance", 0.5, TIME)):
            file[f"{name}/timestamp"], file[f"{name}/{name}"] = begin + late + 0.25 * np.arange(300), values
            file[f"{name}/{name}"].attrs["units"] = COMMON[name]
    read = read_log(tmp_path / "run.h5", COMMON).numbers
    assert read["time"][np.isfinite(read["distance"])].tolist() == (0.5 + 0.25 * np.arange(300)).tolist()
    with h5py.File(tmp_path / "run.h5", "r+") as file:
        file["speed/timestamp"][:] = TIME
    with pytest.raises(FileError, match="must be those of a clock, or of none; got both"):
        read_log(tmp_path / "run.h5", COMMON)


def test_tables_and_packed_datasets_of_hdf5_are_read(tmp_path: Path) -> None:
    table = np.zeros(300, dtype=[("time [s]", "f8"), ("note", "S4")])
    table["time [s]"] = TIME
    packed = np.round(SPEED / 0.001).astype("i2")
    packed[4] = -1
    with h5py.File(tmp_path / "run.h5", "w") as file:
        file["log"] = table
        file["log2/t"], file["log2/v"] = TIME, packed
        file["log2/v"].attrs.update({"units": "m/s", "scale_factor": 0.001, "_FillValue": np.int16(-1)})
        file["other"] = h5py.ExternalLink("/etc/passwd", "/")
        file["log2/around"] = h5py.SoftLink("/")
    read = read_log(tmp_path / "run.h5", COMMON)
    expected = np.round(SPEED, 3)
    expected[4] = math.nan
    np.testing.assert_allclose(read.numbers["speed"], expected, rtol=1e-14)


@pytest.mark.parametrize("named", [True, False])
def test_frames_of_pandas_keep_index_units_and_gaps(named: bool, tmp_path: Path) -> None:
    clock = pandas.to_datetime("2026-05-01T12:00:00Z") + pandas.to_timedelta(TIME, unit="s")
    frame = pandas.DataFrame(
        {"v": 3.6 * SPEED, "p_c [bar]": np.arange(300), "text": "a", "n": [None, *range(299)]}, index=clock
    )
    frame.index.name = "Zeitstempel" if named else None
    frame.attrs["units"] = {"v": "km/h"}
    frame.loc[frame.index[7], "v"] = -999.0
    frame.to_parquet(tmp_path / "run.parquet")
    read = read_log(tmp_path / "run.parquet", VARIABLES)
    expected = SPEED.copy()
    expected[7] = math.nan
    np.testing.assert_allclose(read.numbers["speed"], expected, rtol=1e-15)
    np.testing.assert_allclose(read.numbers["time"], TIME, rtol=0, atol=1e-9)
    assert any("'v' is -999 in 1 row, taken as no value" in one for one in read.messages)
    assert any("time counts from the first row, '2026-05-01T12:00:00" in one for one in read.messages)
    frame.reset_index(drop=True).assign(time=TIME).to_parquet(tmp_path / "flat.parquet")
    np.testing.assert_array_equal(read_log(tmp_path / "flat.parquet", VARIABLES).numbers["time"], TIME)


def test_text_in_columns_has_the_rules_of_text(tmp_path: Path) -> None:
    frame = pandas.DataFrame({"Uhrzeit": ["23:59:59,5", "00:00:00,5", "00:00:01"], "v [km/h]": ["3,6", "n/a", "7,2"]})
    frame.to_parquet(tmp_path / "run.parquet")
    read = read_log(tmp_path / "run.parquet", COMMON).numbers
    assert read["time"].tolist() == [0.0, 1.0, 1.5]
    np.testing.assert_array_equal(read["speed"], [1.0, math.nan, 2.0])


def test_rows_of_one_time_are_an_event_in_each_format(tmp_path: Path) -> None:
    table = Recording({"time": "s", "speed": "m/s"}, [[0, 1], [1, 1], [1, 5], [2, 5], [3, 5], [4, 5], [5, 5]])
    for end in ENDS:
        read = read_log(table.write(tmp_path / f"run{end}"), COMMON)
        assert read.numbers["time"].tolist() == [0.0, 1.0 - 1e-5, 1.0, 2.0, 3.0, 4.0, 5.0]
        assert any("an event, after which the last row holds" in one for one in read.messages)


def whole(end: str, at: Path) -> bytes:
    return (
        Recording({"time": "s", "speed": "m/s"}, np.column_stack([TIME, SPEED])).write(at / f"whole{end}").read_bytes()
    )


@pytest.mark.parametrize("end", ENDS[1:])
def test_a_damaged_file_is_refused_with_one_sentence(end: str, tmp_path: Path) -> None:
    good, path = whole(end, tmp_path), tmp_path / f"run{end}"
    cut = [good[: len(good) * share // 20] for share in range(20)]
    for content in (*cut, b"time,speed\n0,1\n1,2\n", bytes(100) + good[100:]):
        path.write_bytes(content)
        with pytest.raises(FileError) as refused:
            read_log(path, COMMON)
        assert str(refused.value).startswith(str(path))
        assert "\n" not in str(refused.value)
        assert ("it is empty. Export it again." in str(refused.value)) == (content == b"")
        assert ("it is text. Rename it, as .csv." in str(refused.value)) == content.startswith(b"time")


def test_declared_sizes_are_checked_before_they_are_read(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "run.h5", "w") as file:  # 80 TB of zeros in 10 kB
        for name in ("time", "speed"):
            file.create_dataset(name, (10_000_000_000_000,), float, chunks=(1000,))
    with pytest.raises(FileError, match="must have at most 4000000 rows and 250000000 values; it has 10000000000000"):
        read_log(tmp_path / "run.h5", COMMON)
    head = struct.pack("<5i", 0, 100_000, 100_000, 0, 2) + b"t\0"  # a .mat of version 4 with 80 GB
    (tmp_path / "run.mat").write_bytes(head)
    with pytest.raises(FileError, match=r"run\.mat must have at most 250000000 values; it has 10000000000"):
        read_log(tmp_path / "run.mat", COMMON)


def test_objects_of_matlab_are_named_with_the_remedy(tmp_path: Path) -> None:
    from scipy.io.matlab import MatlabOpaque

    from readers.formats.matlab import _node

    opaque = MatlabOpaque(np.array([(b"tt", b"MCOS", b"timetable", None)], [(f"s{n}", "O") for n in range(4)]))
    assert "save its columns as vectors" in _node("None", opaque).unusable
    with h5py.File(tmp_path / "run.h5", "w") as file:
        file["time"], file["speed"] = TIME, SPEED.astype(complex)
    with pytest.raises(FileError, match="the column 'speed' must have numbers; it is array of complex128"):
        read_log(tmp_path / "run.h5", COMMON)


def test_a_missing_package_is_told_before_work(monkeypatch: pytest.MonkeyPatch, run: Recording, tmp_path: Path) -> None:
    path = run.write(tmp_path / "run.mf4")
    monkeypatch.setattr("readers.extras.find_spec", lambda name: None)
    for work in (lambda: read_log(path, COMMON), lambda: run.write(tmp_path / "again.mf4")):
        with pytest.raises(MissingExtraError, match=r"needs asammdf: pip install 'bogie-braking\[formats\]'"):
            work()
    assert not (tmp_path / "again.mf4").exists()


def test_wheels_of_two_messages_of_a_bus_are_replayed(tmp_path: Path) -> None:
    """Their speeds fall linearly, so that the values between two messages have no error."""
    times = [TIME, TIME + 0.004]
    with asammdf.MDF(version="4.10") as mdf:
        for number, at in enumerate(times, 1):
            mdf.append(asammdf.Signal(20.0 - at, at, name=f"wheel_speed_{number}", unit="m/s"))
        mdf.append(asammdf.Signal(20.0 - TIME, TIME + 0.002, name="speed", unit="m/s"))
        mdf.save(tmp_path / "run.mf4")
    log = replayed_log(tmp_path / "run.mf4")
    assert log["time"].size == 600
    within = (log["time"] >= 0.004) & (log["time"] <= TIME[-1])
    for name in ("wheel_speed_1", "wheel_speed_2"):
        np.testing.assert_allclose(log[name][within], 20.0 - log["time"][within], rtol=1e-13)


def test_a_field_of_friction_has_all_quantities_at_the_rows_of_the_wheels(tmp_path: Path) -> None:
    """Three rasters; all but the wheel's change linearly, so that bridging has no error."""
    with asammdf.MDF(version="4.10") as mdf:
        late = TIME[::10] + 0.004
        for name, unit, at in (("speed", "m/s", late), ("distance", "m", late), ("pressure_1", "Pa", late + 0.003)):
            mdf.append(asammdf.Signal(1e3 + at, at, name=name, unit=unit))
        mdf.append(asammdf.Signal(20.0 - TIME, TIME, name="wheel_speed_1", unit="m/s"))
        mdf.save(tmp_path / "run.mf4")
    [log] = friction_logs([tmp_path / "run.mf4"], [0.46], 2.0, None)
    of_wheel = np.isfinite(log.wheel_speed[:, 0]) & (log.time >= 0.01) & (log.time <= 2.9)
    assert np.sum(of_wheel) == 290
    for values in (log.speed, log.distance, log.torque[:, 0] / 2.0):
        np.testing.assert_allclose(values[of_wheel], 1e3 + log.time[of_wheel], rtol=1e-12)


def test_a_table_has_a_place_in_its_format(run: Recording, tmp_path: Path) -> None:
    with pytest.raises(FileError, match=r"run.xls must end in one of .csv, .parquet, .mat, .mf4, .h5; got '.xls'"):
        run.write(tmp_path / "run.xls")
    with pytest.raises(FileError, match=r"run\.mf4: an MDF file must have the times of its rows"):
        Recording({"x": "m"}, [[1.0]]).write(tmp_path / "run.mf4")
    with pytest.raises(FileError, match="names of HDF5 must not have a slash; got 'a/b'"):
        Recording({"a/b": "m"}, [[1.0]]).write(tmp_path / "run.h5")
    for name in ("a [b]", "# a", "a\nb", " a", ""):
        with pytest.raises(FileError, match="a name must be printable, without brackets, and not begin as a remark"):
            Recording({name: "m"}, [[1.0]]).write(tmp_path / "run.csv")
    assert list(tmp_path.iterdir()) == []


def test_units_beside_and_in_a_name_agree(tmp_path: Path) -> None:
    table = pyarrow.table(
        {"time": TIME, "speed [km/h]": SPEED},
        schema=pyarrow.schema(
            [("time", pyarrow.float64()), pyarrow.field("speed [km/h]", pyarrow.float64(), metadata={"unit": "m/s"})]
        ),
    )
    pyarrow.parquet.write_table(table, tmp_path / "run.parquet")
    with pytest.raises(FileError, match="must have one unit; got 'km/h' in its name and 'm/s' beside it"):
        read_log(tmp_path / "run.parquet", COMMON)

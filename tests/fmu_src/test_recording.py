"""A recording is a mapping of columns, and shows itself in notebooks, data frames and data sets."""

from __future__ import annotations

import io
import json
import sys
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import bogie_braking as bb
from tests.needed import needed_package

TIME = np.linspace(0.0, 2.0, 21)


def recording_of(columns: dict[str, np.ndarray], units: dict[str, str], **how: Any) -> bb.Recording:
    return bb.Recording(units, np.column_stack(list(columns.values())), **how)


@pytest.fixture
def stop() -> bb.Recording:
    columns = {"time": TIME, "speed": 25.0 - TIME, "distance": 25.0 * TIME - TIME**2 / 2.0}
    return recording_of(columns, {"time": "s", "speed": "m/s", "distance": "m"}, messages=["It <b>stood</b>."])


@pytest.fixture
def train() -> bb.Recording:
    """Return speeds and pressures of 150 vehicles, and 40 forces with long names of their own."""
    speeds = {f"speed[{n}]": 25.0 - n * TIME for n in range(1, 151)}
    pressures = {f"pressure[{n}]": 1e5 * TIME / n for n in range(1, 151)}
    forces = {f"force_of_a_coupler_between_vehicles_{'abcdefgh'[n % 8] * (n + 1)}": n * TIME for n in range(40)}
    units = dict.fromkeys(speeds, "m/s") | dict.fromkeys(pressures, "Pa") | dict.fromkeys(forces, "N")
    return recording_of({"time": TIME} | speeds | pressures | forces, {"time": "s"} | units)


def test_a_recording_is_a_mapping_of_columns_and_a_structured_array(stop: bb.Recording) -> None:
    assert ("speed" in stop, "sped" in stop, list(stop), len(stop)) == (True, False, ["time", "speed", "distance"], 3)
    assert {name: values[-1] for name, values in stop.items()} == {
        name: column[-1] for name, column in dict(stop).items()
    }
    table = np.asarray(stop)
    assert (table.dtype.names, table.shape, table[-1]["speed"]) == (("time", "speed", "distance"), (21,), 23.0)
    with pytest.raises(ValueError, match="copy must be None or True"):
        np.asarray(stop, copy=False)


def test_recordings_are_equal_by_names_units_and_values(stop: bb.Recording) -> None:
    rows = np.column_stack([*stop.values()])
    rows[3, 1] = np.nan
    first, second = bb.Recording(stop.units, rows), bb.Recording(stop.units, rows)
    assert first == second
    assert first != stop
    assert first != bb.Recording(stop.units | {"speed": "km/h"}, rows)
    assert bool(bb.Recording({"time": "s"}, []))  # as a dict: it has a column
    assert np.asarray(bb.Recording({"time": "s"}, [])).shape == np.asarray(bb.Recording({}, [])).shape == (0,)


def test_a_notebook_shows_units_first_rows_and_escaped_messages(stop: bb.Recording, train: bb.Recording) -> None:
    text = stop._repr_html_()
    assert "21 rows and 3 columns" in text
    assert "[m/s]" in text
    assert "&lt;b&gt;stood" in text
    assert "<b>" not in text
    assert text.count("<tr>") == 8  # names, units, five rows, and one for those that are left out
    assert "pressure[#] [Pa] x 150" in train._repr_html_()
    assert repr(train).startswith(
        "<Recording of 21 rows: time [s], speed[#] [m/s] x 150, pressure[#] [Pa] x 150, force"
    )


def test_data_frame_and_data_set_have_units(stop: bb.Recording) -> None:
    frame, data = stop.to_pandas(), stop.to_xarray()
    assert frame.attrs["units"]["speed"] == "m/s"
    assert frame["speed"].iloc[-1] == 23.0
    assert (data["speed"].attrs["units"], data["time"].attrs["units"], data["speed"].dims) == ("m/s", "s", ("time",))
    assert float(data["speed"].sel(time=2.0)) == 23.0
    units = {"number": "1", "torque": "N.m", "distance": "m"}
    table = bb.Recording(units, [[0.0, 5e3, 9.0], [1.0, 4e3, 8.0]], coordinates=["number", "torque"])
    assert set(table.to_xarray().coords) == {"number", "torque"}


@pytest.mark.parametrize("end", [".csv", ".parquet", ".mat", ".mf4"])
def test_numbered_columns_come_back_from_files(end: str, train: bb.Recording, tmp_path: Path) -> None:
    """The brackets of `speed[1]` hold the number of a vehicle, and those of the unit are behind them."""
    assert bb.Recording.read(train.write(tmp_path / f"train{end}")) == train


def test_a_missing_package_is_told_with_its_remedy(stop: bb.Recording, monkeypatch: pytest.MonkeyPatch) -> None:
    for package, make in (("pandas", stop.to_pandas), ("xarray", stop.to_xarray)):
        monkeypatch.setitem(sys.modules, package, None)
        with pytest.raises(ImportError, match=rf"needs {package}: pip install 'bogie-braking\[tables\]'"):
            make()


def test_a_chart_has_few_columns_and_no_legend_larger_than_its_panel(train: bb.Recording) -> None:
    for names in ((), tuple(train.names[1:])):
        figure = train.plot(*names)
        figure.savefig(io.BytesIO(), format="png")  # lays out
        assert len(figure.axes) <= 4
        for panel in figure.axes:
            legend = panel.get_legend()
            assert legend is not None
            size, space = legend.get_window_extent(), panel.get_window_extent()
            assert size.height <= space.height
            assert size.width <= space.width
    assert sum(len(panel.lines) for panel in train.plot().axes) < len(train) - 1
    assert len(train.plot("speed[7]", "pressure[2]").axes) == 2


def test_a_fresh_notebook_shows_the_picture() -> None:
    """No pyplot, no magic: the output of the cell that returns the chart is a PNG of the usual begin."""
    for package in ("nbconvert", "ipykernel"):
        needed_package(package)
    nbformat, execute = import_module("nbformat"), import_module("nbconvert.preprocessors").ExecutePreprocessor
    code = "import bogie_braking as bb\nbb.Recording({'time': 's', 'speed': 'm/s'}, [[0.0, 9.0], [1.0, 8.0]]).plot()"
    book = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(code)])
    execute(timeout=120).preprocess(book, {"metadata": {"path": "."}})
    [output] = book.cells[0].outputs
    assert output["data"]["image/png"].startswith("iVBORw0KGgo"), json.dumps(output)[:300]

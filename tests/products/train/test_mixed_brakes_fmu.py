"""The FMU of a train of all types of brakes: both standards against the class, its states, its inputs, its page."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from fmpy import read_model_description

import bogie_braking as bb
from brake_controller.distributors import pneumatic
from fmu_src.cosimulation.slave import FmuInstance
from products.building import write_in_c
from products.train.consist_columns import NAMES
from products.train.fmu import INPUTS, OUTPUTS, PARAMETERS, train_fmu
from products.train.train import Train

STEP, COUNT, SPEED = 0.25, 80, 25.0
ROOT = Path(__file__).parents[3]
MAGNETS: dict[str, object] = {"magnetic_attraction": 200, "track_brake_pressure": 3.0}
ROWS: list[dict[str, object]] = [
    {
        **{"kind": "locomotive", "traction_force": 300, "traction_power": 5600, "adhesion": "curtius-kniffler"},
        **{"dynamic_table": "0:0 10:150 60:150 120:75", "dynamic_rise": 2, "blending": "interlock"},
        **{"direct_pressure": 3.5, "main_reservoir": 400, "vigilance_time": 8, "warning_time": 2},
    },
    {"kind": "wagon", "position": "G", "wheel_mass": 370, "block_mass": 28, "friction": "cast-iron-p10"},
    {"kind": "wagon", "distributor": "aar", "retainer": "high", "parking_force": 60},
    {"kind": "wagon", "distributor": "aar", "load": 0, "empty_load": 0.5, "accelerated_release": "no"},
    {"kind": "wagon", "distributor": "ecp", "dead_time": 0.3, "dynamic_force": 40},
    {"kind": "coach", "distributor": "ep_uic", "dead_time": 0.2, "disc_mass": 90, "thickness": 25, **MAGNETS},
    {
        **{"kind": "coach", "distributor": "twin_pipe", "eddy_force": 30},
        **{"parking_gradient": 40, "parking_compounding": "larger"},
    },
    {
        **{"kind": "coach", "brake": "ep-direct", "deceleration": 1.2, "dead_time": 0.1, **MAGNETS},
        **{"dynamic_force": 60, "dynamic_power": 900, "traction_force": 60, "traction_power": 900},
    },
    {"kind": "wagon", "brake": "none"},
    {"kind": "locomotive", "valve": "second", "delay": 1.5, "coupler": "draft-gear", "direct_pressure": 3.8},
]
VEHICLES = len(ROWS)
#: Units of the outputs of brakes and drives, as the page of trains gives them.
UNITS = {
    **dict.fromkeys(("pipe_pressure", "cylinder_pressure", "main_reservoir_pressure"), "Pa"),
    **dict.fromkeys(("brake_force", "rail_force", "track_brake_force", "traction_force", "coupler_force"), "N"),
    **dict.fromkeys(("brake_temperature", "surface_temperature", "block_temperature"), "K"),
    **dict.fromkeys(("brake_heat", "traction_energy", "electric_brake_energy"), "J"),
    **dict.fromkeys(("air_used", "compressor_air"), "kg"),
}


def orders() -> dict[str, np.ndarray]:
    """Return rows of every input, one a step: pull, then service, emergency, release; each vehicle has its own."""
    draw, steps = np.random.default_rng(11), np.arange(COUNT)[:, None]
    late = steps >= COUNT // 2

    def shares(begin: int, end: int) -> np.ndarray:
        return np.where((begin <= steps) & (steps < end), draw.uniform(0.2, 1.0, VEHICLES), 0.0)

    one = np.arange(VEHICLES)
    head = np.select([steps < 8, steps < 30, steps < 50, steps < 52], [1, 3, 4, 2], 1)
    return {
        "driver_position": np.hstack([head, np.where(steps < 70, 0, 3)]),
        "driver_step": np.hstack([np.minimum(steps / 20, 1.0), 0.5 + 0.0 * steps]),
        "pull": 5e3 * shares(2, 40),
        "friction": np.where(late, 0.3, draw.uniform(0.04, 0.3, VEHICLES)),
        "protection": np.where((steps > 20) & (steps < 48), draw.integers(0, 3, (COUNT, VEHICLES)), 0),
        "coupling_closed": np.where((steps > 60) & (one[:-1] == 3), 0, 1),
        "hose_state": np.where((steps > 62) & (one[:-1] == 3), 2, 0) + np.where((steps > 55) & (one[:-1] == 7), 1, 0),
        "end_force": np.where(steps > 10, [[20e3, 5e3]], 0.0),
        "external_vehicle": np.where((steps > 4) & (steps < 20) & (one == 8), 2, 0),
        "external_vehicle_speed": SPEED + 0.01 * steps + 0.0 * one,
        "dynamic_brake": shares(10, 45),
        "track_brake": shares(12, 34),
        "parking_brake": shares(0, 60),
        "traction": shares(0, 8),
        "direct_brake": shares(30, 60),
        "bail_off": np.where((steps > 12) & (steps < 29) & (one == VEHICLES - 1), 1, 0),
        "penalty": np.where((steps > 64) & (steps < 72), [[1, 0]], 0),
        "vigilance": np.where(steps % 24 < 12, [[1, 0]], 0),
    }


ORDERS = orders()


@pytest.fixture(scope="module")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> dict[int, Path]:
    """Return the FMUs of the train by version of FMI."""
    folder, consist = tmp_path_factory.mktemp("mixed"), bb.train(ROWS).consist
    for version in (2, 3):
        write_in_c(train_fmu(consist), folder / f"{version}.fmu", version)
    return {version: folder / f"{version}.fmu" for version in (2, 3)}


@pytest.fixture(params=[2, 3])
def path(request: pytest.FixtureRequest, fmus: dict[int, Path]) -> Path:
    """Return the FMU of each version."""
    return fmus[request.param]


def of_class(left_out: str = "") -> list[dict[str, np.ndarray]]:
    """Return the outputs of the class after each step; an input that is left out keeps its start value."""
    train, rows = Train(bb.train(ROWS).consist, speed=SPEED), []  # bb.train has fewer cells
    for row in range(COUNT):
        for name, values in ORDERS.items():
            if name != left_out:
                train.inputs[name] = values[row]
        train.advance(STEP)
        rows.append(outputs_of(train))
    return rows


def outputs_of(train: Train) -> dict[str, np.ndarray]:
    """Return the outputs of a train, with locked and slip as the FMU has them."""
    found = {one.name: np.atleast_1d(getattr(train, one.name)) for one in OUTPUTS if one.name not in ("locked", "slip")}
    v, w = train.speed, train.wheel_speed
    larger = np.maximum(np.abs(v), np.abs(w))
    found["slip"] = np.divide(v - w, larger, out=np.zeros(VEHICLES), where=larger > 0.0)
    found["locked"] = (w == 0.0) & (v != 0.0)
    return found


def names_in(slave: FmuInstance, name: str) -> list[str]:
    """Return the scalar variables of an array in FMI 2, of a single name otherwise."""
    return [name] if name in slave.units else [one for one in slave.units if one.startswith(f"{name}[")]


def put(slave: FmuInstance, row: int) -> None:
    """Set the inputs of a step, without vehicles of the host: the FMU refuses these at such long steps."""
    for name, values in ORDERS.items():
        if name == "external_vehicle":
            continue
        own = [int(v) if values.dtype.kind == "i" else float(v) for v in values[row]]
        known = names_in(slave, name)
        slave.set(**({name: own} if known == [name] else dict(zip(known, own, strict=True))))


def read(slave: FmuInstance) -> dict[str, np.ndarray]:
    """Return all outputs."""
    found = {}
    for one in OUTPUTS:
        known = names_in(slave, one.name)
        found[one.name] = np.ravel(slave.array(one.name) if known == [one.name] else slave.get(known))
    return found


def run(slave: FmuInstance, rows: range) -> list[dict[str, np.ndarray]]:
    """Step the FMU through these rows of orders; return its outputs after each."""
    found = []
    for row in rows:
        put(slave, row)
        slave.step(row * STEP, STEP)
        found.append(read(slave))
    return found


def test_all_types_of_brakes_are_in_the_train() -> None:
    vehicles = bb.train(ROWS).consist.vehicles
    assert {row.get("distributor", "uic") for row in ROWS} >= set(pneumatic()) - {"vacuum"}  # it has a pipe of its own
    assert {row.get("brake") for row in ROWS} >= {"ep-direct", "none"}
    assert sum(one.heat.heat_capacity > 0.0 for one in vehicles) == 2


@pytest.mark.study
def test_an_fmu_of_either_standard_has_the_numbers_of_the_class_and_its_state_goes_on(path: Path) -> None:
    expected, middle = of_class("external_vehicle"), COUNT // 2
    with FmuInstance(path, start_speed=SPEED) as slave:
        slave.start()
        found = run(slave, range(middle))
        saved = slave.save()
        found += run(slave, range(middle, COUNT))
        slave.restore(saved)
        again = run(slave, range(middle, COUNT))
        slave.forget(saved)
    for row, own in enumerate(expected):
        for name, values in own.items():
            assert found[row][name].tolist() == values.tolist(), (row, name)
            assert row < middle or again[row - middle][name].tolist() == values.tolist(), (row, name)


def test_each_input_has_an_effect_in_this_train() -> None:
    """An input that neither the class nor the FMU reads would give equal numbers in both."""
    whole = of_class()[-1]
    assert sorted(ORDERS) == sorted(one.name for one in INPUTS)
    for name in ORDERS:
        other = of_class(name)[-1]
        assert any(not np.array_equal(whole[key], other[key]) for key in whole), name


def test_each_brake_acts_in_this_train() -> None:
    """Forces, temperatures and work of the vehicles that have them; zero, or the surroundings, at all others."""
    rows = of_class()

    def largest(name: str) -> np.ndarray:
        return np.max([row[name] for row in rows], axis=0)

    assert np.flatnonzero(largest("track_brake_force")).tolist() == [5, 6, 7]
    assert np.flatnonzero(largest("traction_energy")).tolist() == [0, 7]
    assert np.flatnonzero(largest("electric_brake_energy")).tolist() == [0, 4, 7]
    assert np.flatnonzero(largest("brake_temperature") > 294.0).tolist() == [1, 5]
    assert np.flatnonzero(largest("cylinder_pressure") < 1e5).tolist() == [8]
    assert largest("coupler_force").max() > 10e3


def test_its_description_has_the_outputs_of_each_vehicle_with_units(path: Path) -> None:
    about = read_model_description(str(path))
    units = {one.name: one.unit for one in about.modelVariables if one.causality == "output"}
    assert {one.name for one in OUTPUTS} == {name.partition("[")[0] for name in units}
    for name, unit in UNITS.items():
        known = [one for one in units if one.partition("[")[0] == name]
        each = name != "air_used" and about.fmiVersion == "2.0"
        assert len(known) == ((VEHICLES - (name == "coupler_force")) if each else 1), name
        assert {units[one] for one in known} == {unit}, name


def test_the_page_of_trains_has_each_parameter_input_and_output_of_the_fmu() -> None:
    text = (ROOT / "docs" / "train.md").read_text(encoding="utf-8")
    for title, arrays in (("parameters", PARAMETERS), ("inputs", INPUTS), ("outputs", OUTPUTS)):
        [table] = re.findall(rf"^\| {title} \| \|\n\|---\|---\|\n((?:\|.*\n)+)", text, re.MULTILINE)
        written = [name for row in table.splitlines() for name in re.findall(r"`(\w+)`", row.split("|")[1])]
        due = {one.name for one in arrays if not one.name.endswith("_at")}
        assert len(written) == len(set(written)), title
        assert {name for name in written if name != "_at"} == due, title


def test_the_pages_of_trains_have_each_column_of_a_consist() -> None:
    found = set[str]()
    for name in ("train", "train-brakes", "train-cab", "train-couplers", "vacuum-brakes"):
        text = (ROOT / "docs" / f"{name}.md").read_text(encoding="utf-8")
        cells = re.findall(r"^\|([^|]*)\|", text, re.MULTILINE)
        found |= {word for cell in cells for word in re.findall(r"`(\w+)`", cell)}
    assert [name for name in NAMES if name not in found] == []

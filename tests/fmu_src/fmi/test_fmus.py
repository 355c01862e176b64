"""The FMUs in a host, through FMPy."""

from __future__ import annotations

import math
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from fmpy import read_model_description, simulate_fmu
from fmpy.validation import validate_fmu

from build_fmu import main
from fmu_src import compile as compiling
from fmu_src.cosimulation.slave import CosimulationError, FmuInstance
from products.building import variables_of
from products.registry import DIFFERENT, model_of

#: Kinds of FMI 2.0.
KINDS = ["native", "python"]
BUILT = [(name, kind) for kind in KINDS for name in DIFFERENT]


def outputs_of_the_bogie() -> list[str]:
    return [one.name for one in variables_of("bogie").values() if one.causality == "output"]


@pytest.mark.study
@pytest.mark.parametrize("key", BUILT)
def test_fmpy_finds_no_problem(fmus: dict, key: tuple[str, str]) -> None:
    assert validate_fmu(str(fmus[key])) == []


@pytest.mark.study
@pytest.mark.parametrize("key", BUILT)
def test_variables_are_those_of_the_model_in_their_order(fmus: dict, key: tuple[str, str]) -> None:
    """The names that hosts rely on are in `products/variables.csv` (tests/fmu_src/fmi/test_promised_variables.py)."""
    of_model = [one for one in model_of(key[0]).variables if one.causality != "local"]
    variables = read_model_description(str(fmus[key])).modelVariables
    for causality in ("input", "output", "parameter"):
        names = [one.name for one in of_model if one.causality == causality]
        assert [v.name for v in variables if v.causality == causality][: len(names)] == names
    assert all(v.description and (v.type != "Real" or v.unit) for v in variables)


@pytest.mark.study
@pytest.mark.parametrize("key", BUILT)
def test_outputs_and_initial_unknowns_are_all_listed(fmus: dict, key: tuple[str, str]) -> None:
    description = read_model_description(str(fmus[key]))
    outputs = [v.name for v in description.modelVariables if v.causality == "output"]
    slopes = [unknown.variable for unknown in description.derivatives]
    states = {slope.derivative.name for slope in slopes}
    assert [u.variable.name for u in description.outputs] == outputs
    found = [u.variable.name for u in description.initialUnknowns]
    assert found[: len(outputs)] == outputs
    assert set(found[len(outputs) :]) == states | {slope.name for slope in slopes}


def known_inputs(unknowns: list) -> dict[str, set[str]]:
    """Return the inputs that each unknown depends on."""
    return {u.variable.name: {d.name for d in u.dependencies if d.causality == "input"} for u in unknowns}


def test_dependencies_come_from_the_equations(fmus: dict) -> None:
    description = read_model_description(str(fmus["brake", "native"]))
    found = known_inputs(description.outputs)
    # Outputs depend on inputs through the pressure, except that some laws of shoe friction use the sliding speed.
    assert found["cylinder_pressure"] == found["shoe_force"] == set()
    assert found["shoe_friction"] == found["brake_torque"] == {"angular_velocity"}
    description = read_model_description(str(fmus["bogie", "native"]))
    found = known_inputs(description.outputs)
    # Creep forces depend on friction and load while rolling (in the planar model a gradient shifts the load), and at
    # rest on all pulling and braking inputs.
    pushes, holds = {"gradient", "curvature", "drawbar_force"}, {"brake_torque_1", "brake_torque_2"}
    assert found["creep_force_1"] == {"friction_1", "friction_2"} | pushes | holds
    assert found["axle_load_1"] == {"friction_1", "gradient"}
    assert found["speed"] == set()


@pytest.mark.study
@pytest.mark.parametrize("level", [1, 2])
def test_native_and_pythonfmu_give_the_same_trajectory(fmus: dict, level: int) -> None:
    """Compare runs through skid, lock and rest, to 1e-12 of each quantity's size. Both kinds have the same kernel."""
    names = outputs_of_the_bogie()
    rows: dict[str, np.ndarray] = {}
    for kind in KINDS:
        with FmuInstance(fmus["bogie", kind], level=level, initial_speed=10.0) as bogie:
            bogie.start(friction_1=0.2)
            found = []
            for number in range(900):
                bogie.set(brake_torque_1=min(number * 100.0, 40e3), brake_torque_2=20e3, drawbar_force=-1e4)
                bogie.step(number * 0.01, 0.01)
                found.append(bogie.get(names))
            rows[kind] = np.array(found)
    scale = np.abs(rows["native"]).max(axis=0) + 1e-300
    assert np.abs((rows["native"] - rows["python"]) / scale).max() < 1e-12
    assert rows["native"][:, names.index("locked_1")].any()


@pytest.mark.parametrize("kind", KINDS)
def test_brake_drives_bogie_to_the_same_stop_in_both_kinds(fmus: dict, kind: str) -> None:
    with FmuInstance(fmus["brake", kind]) as brake, FmuInstance(fmus["bogie", kind], initial_speed=2.0) as bogie:
        brake.start(pressure_demand=180e3)
        bogie.start()
        for number in range(100):
            brake.step(number * 0.01, 0.01)
            bogie.set(brake_torque_2=brake["brake_torque"])
            bogie.step(number * 0.01, 0.01)
        assert brake["cylinder_pressure"] == pytest.approx(175.744e3, rel=1e-4)
        assert bogie["speed"] == pytest.approx(1.963, abs=0.01)


@pytest.mark.parametrize("kind", KINDS)
def test_lost_demand_applies_the_brake_in_any_host(fmus: dict, kind: str) -> None:
    with FmuInstance(fmus["brake", kind]) as brake:
        brake.start(pressure_demand=0.0)
        brake.set(pressure_demand=math.nan)
        brake.step(0.0, 5.0)
        assert brake["cylinder_pressure"] == pytest.approx(350e3, rel=1e-4)
        assert brake.messages == ["The signal pressure_demand is lost (NaN): it counts as 350000 Pa, the safe side."]


@pytest.mark.study
@pytest.mark.parametrize("key", BUILT)
def test_simulate_fmu_works_out_of_the_box(fmus: dict, key: tuple[str, str]) -> None:
    result = simulate_fmu(str(fmus[key]), stop_time=1.0)
    assert result["time"][-1] == pytest.approx(1.0)
    assert all(np.isfinite(result[name]).all() for name in result.dtype.names)


def test_start_values_and_input_signals_reach_the_fmu(fmus: dict) -> None:
    signal = np.array([(0.0, 0.0), (1.0, 20e3), (30.0, 20e3)], dtype=[("time", "f8"), ("brake_torque_1", "f8")])
    result = simulate_fmu(
        str(fmus["bogie", "native"]), stop_time=5.0, start_values={"initial_speed": 12.0, "level": 1}, input=signal
    )
    assert result["speed"][0] == 12.0
    assert result["speed"][-1] < 10.0


def test_saved_state_of_the_native_fmu_is_bit_identical(fmus: dict) -> None:
    with FmuInstance(fmus["bogie", "native"]) as bogie:
        bogie.start(brake_torque_1=60e3, brake_torque_2=60e3)
        for number in range(100):
            bogie.step(number * 1e-3, 1e-3)
        names, state = outputs_of_the_bogie(), bogie.fmu.getFMUstate()
        serialised = bogie.fmu.serializeFMUstate(state)

        def onward() -> list[float]:
            found = []
            for number in range(100, 400):
                bogie.step(number * 1e-3, 1e-3)
                found += bogie.get(names)
            return found

        first = onward()
        bogie.fmu.setFMUstate(state)
        assert onward() == first
        bogie.fmu.setFMUstate(bogie.fmu.deSerializeFMUstate(serialised))
        assert onward() == first
        bogie.fmu.freeFMUstate(state)


@pytest.mark.study
@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda b: b.set(brake_torque_1=-5.0), "brake_torque_1 must be at least 0 N.m"),
        (lambda b: b.set(brake_torque_1=math.nan), "brake_torque_1 must be a finite number"),
        (lambda b: b.step(0.0, 0.0), "The step must be above 0 s"),
        (lambda b: b.step(0.0, -1.0), "The step must be above 0 s"),
        (lambda b: b.step(0.0, math.nan), "The step must be above 0 s"),
        (lambda b: b.step(7.0, 0.1), "The step must begin at t = 0 s"),
        (lambda b: b["nothing"], "has no variable nothing"),
        (lambda b: b["sped"], "has no variable sped; did you mean speed?"),
    ],
)
@pytest.mark.parametrize("kind", KINDS)
def test_bad_input_is_refused_with_a_sentence_and_the_next_good_call_works(
    fmus: dict, kind: str, call: object, sentence: str
) -> None:
    with FmuInstance(fmus["bogie", kind]) as bogie:
        bogie.start(brake_torque_1=1e3)

        def offend() -> None:
            call(bogie)  # type: ignore[operator]
            bogie.step(0.0, 0.1)  # pythonfmu can refuse a value only here

        with pytest.raises(CosimulationError) as caught:
            offend()
        assert sentence in str(caught.value)
        assert bogie["brake_torque_1"] == 1e3
        bogie.set(brake_torque_1=2e3)
        bogie.step(0.0, 0.1)
        assert math.isfinite(bogie["speed"])


@pytest.mark.parametrize("kind", KINDS)
def test_bad_parameter_never_starts_a_run(fmus: dict, kind: str) -> None:
    def begin(bogie: FmuInstance) -> None:
        bogie.start()
        bogie.step(0.0, 0.1)

    with FmuInstance(fmus["bogie", kind], wheelset_mass=-1.0) as bogie:
        with pytest.raises(CosimulationError) as caught:
            begin(bogie)
        assert "wheelset_mass must be at least 5 kg" in str(caught.value)


def test_end_of_a_run_is_a_discarded_step_with_its_sentence(fmus: dict) -> None:
    with FmuInstance(fmus["bogie", "native"], torque_reaction=1.0, frame_height=1.2) as bogie:
        bogie.start(brake_torque_1=60e3, brake_torque_2=60e3)
        with pytest.raises(CosimulationError, match="Wheelset 2 lifted off the rail at"):
            bogie.step(0.0, 3.0)
        assert 0.0 < bogie["distance"] < 25.0


def test_events_are_told_as_sentences(fmus: dict) -> None:
    for kind in KINDS:
        with FmuInstance(fmus["bogie", kind], torque_reaction=0.0) as bogie:
            bogie.start(brake_torque_1=60e3)
            bogie.step(0.0, 1.0)
            assert bogie.messages == ["Wheelset 1 locked at 0.48372 s."]


@pytest.mark.study
def test_equal_content_makes_equal_bytes(tmp_path: Path, fmus: dict) -> None:
    for name, kind in (("bogie", "native"), ("brake", "python")):
        assert main([name, "--kind", kind, "--out", str(tmp_path)]) == 0
        path = fmus[name, kind]
        assert (tmp_path / kind / path.name).read_bytes() == path.read_bytes(), (name, kind)


@pytest.mark.long
def test_the_vehicle_with_other_numbers_is_an_fmu_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The coal wagon has wheelset loads of 306 kN. A run of 0.1 s needs no optimised code."""
    monkeypatch.setattr(compiling, "OPTIMISE_GENERATED", "-O0")
    assert main(["coal-wagon", "--kind", "native", "--out", str(tmp_path)]) == 0
    with FmuInstance(tmp_path / "native" / "CoalWagonDynamics.fmu", level=3) as wagon:
        wagon.start()
        wagon.step(0.0, 0.1)
        assert [wagon[f"axle_load_{n}"] for n in (1, 2, 3, 4)] == pytest.approx([306e3] * 4, rel=2e-3)


def test_pythonfmu_fmu_needs_neither_casadi_nor_this_project(fmus: dict, tmp_path: Path) -> None:
    """The process ends without its exit handlers, in which pythonfmu writes to freed memory (docs/hosts.md)."""
    script = (
        "import os, sys\n"
        "for name in ('casadi', 'fmu_src', 'rbd_model', 'ziglang'): sys.modules[name] = None\n"
        "from fmpy import simulate_fmu\n"
        f"result = simulate_fmu({str(fmus['bogie', 'python'])!r},"
        " stop_time=0.1, start_values={'brake_torque_1': 4e3})\n"
        "print(result['speed'][-1], flush=True)\n"
        "os._exit(0)\n"
    )
    done = subprocess.run([sys.executable, "-c", script], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert 24.9 < float(done.stdout.split()[-1]) < 25.0


@pytest.mark.study
def test_archives_hold_no_paths_of_the_machine_that_built_them(fmus: dict) -> None:
    root = str(Path(__file__).parents[3]).encode()
    for path in fmus.values():
        with zipfile.ZipFile(path) as archive:
            assert not any(root in archive.read(name) for name in archive.namelist())


def test_refusal_without_a_sentence_is_not_explained_by_an_older_one(fmus: dict) -> None:
    with FmuInstance(fmus["bogie", "native"]) as bogie:
        bogie.start(brake_torque_1=60e3)
        bogie.step(0.0, 1.0)
        assert bogie.messages  # the lock
        with pytest.raises(CosimulationError) as caught:
            bogie._call(bogie.fmu.getIntegerStatus, 0)
        assert "locked" not in str(caught.value)


def test_build_into_a_file_gets_a_sentence(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "taken").write_text("")
    assert main(["brake", "--kind", "native", "--out", str(tmp_path / "taken")]) == 2
    assert "Choose another folder with --out" in capsys.readouterr().err


def test_build_command_prints_a_line_for_each_fmu(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["brake", "--kind", "native", "--out", str(tmp_path)]) == 0
    line = capsys.readouterr().out
    assert all(word in line for word in ("BrakeCylinder.fmu", "kB", " s ", "valid"))

"""Saved states, parallel instances, derivatives of outputs, and the archive in a host without Python."""

from __future__ import annotations

import json
import random
import shutil
import subprocess
import sys
import zipfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from fmu_src import compile as compiling
from fmu_src.cosimulation.slave import FmuInstance
from fmu_src.kernel import Kernel, Library, SimulationError
from fmu_src.variables import state_variable
from products.building import variables_of
from products.sources import ROOMS
from rbd_model.levels.models import levels
from rbd_model.vehicle.ready import two_axle_bogie

HOST = Path(__file__).with_name("host.c")
#: Cases: lock-up, flange contact with a rotating yaw torque, and rest.
SCENES = {
    "lock-up": {"level": 2, "initial_speed": 20.0, "brake_torque_1": 60e3, "brake_torque_2": 60e3},
    "flange": {
        **{"level": 3, "initial_speed": 20.0, "lateral_irregularity": 0.03, "brake_torque_1": 2e4},
        **{"yaw_torque_1": 8e4, "yaw_torque_rotates": 1, "wheel_lift_ends": 0, "tolerance": 1e-5},
    },
    "rest": {"level": 3, "initial_speed": 0.3, "brake_torque_1": 20e3, "brake_torque_2": 20e3},
}
READ = ("speed", "distance", "rotation_1", "creep_force_1", "lateral_1", "wheel_load_1_left", "locked_1")


def outputs(kernel: Kernel) -> list[float]:
    return [kernel[name] for name in READ]


@pytest.mark.parametrize("scene", SCENES)
def test_thousand_rollbacks_are_bit_identical(bogie: Library, scene: str) -> None:
    """Save, advance by random steps, restore, and advance by the same steps."""
    rng = random.Random(scene)
    kernel = Kernel(bogie, **SCENES[scene])
    kernel.initialise()
    for _ in range(334):
        saved, at = kernel.save(), kernel.time
        steps = [10.0 ** rng.uniform(-5, -2) for _ in range(rng.randint(1, 4))]
        torque = rng.uniform(0.0, 6e4)
        found = []
        for _ in range(2):
            kernel.restore(saved)
            kernel.set(brake_torque_2=torque)
            for size in steps:
                kernel.step(kernel.time, size)
            found.append((kernel.save(), outputs(kernel)))
        assert found[0] == found[1]
        assert kernel.time > at
    if scene == "flange":
        assert abs(kernel["lateral_1"]) > 1e-3


def test_serialised_state_survives_a_new_process(fmus: dict, tmp_path: Path) -> None:
    program = (
        "import json, sys\n"
        "from fmpy import extract, read_model_description\n"
        "from fmpy.fmi2 import FMU2Slave\n"
        "path, file, act = sys.argv[1:]\n"
        "about = read_model_description(path)\n"
        "refs = {v.name: v.valueReference for v in about.modelVariables}\n"
        "fmu = FMU2Slave(guid=about.guid, unzipDirectory=extract(path),\n"
        "                modelIdentifier=about.coSimulation.modelIdentifier, instanceName='x')\n"
        "fmu.instantiate()\n"
        "fmu.setupExperiment()\n"
        "fmu.setInteger([refs['level']], [3]); fmu.setReal([refs['lateral_irregularity']], [0.02])\n"
        "fmu.enterInitializationMode(); fmu.exitInitializationMode()\n"
        "fmu.setReal([refs['brake_torque_1']], [3e4])\n"
        "if act == 'write':\n"
        "    for i in range(50): fmu.doStep(i * 0.01, 0.01)\n"
        "    open(file, 'wb').write(fmu.serializeFMUstate(fmu.getFMUstate()))\n"
        "else:\n"
        "    fmu.setFMUstate(fmu.deSerializeFMUstate(open(file, 'rb').read()))\n"
        "for i in range(50, 80): fmu.doStep(i * 0.01, 0.01)\n"
        "print(json.dumps([x.hex() for x in fmu.getReal([refs['speed'], refs['lateral_1'], refs['rotation_1']])]))\n"
    )
    path = str(fmus["bogie", "native"])
    command = [sys.executable, "-c", program, path, str(tmp_path / "state")]
    answers = [
        json.loads(subprocess.run([*command, act], capture_output=True, text=True, check=True).stdout)
        for act in ("write", "read")
    ]
    assert answers[0] == answers[1]


def test_sixteen_threads_give_the_answers_of_one(bogie: Library) -> None:
    def journey(number: int) -> list[list[float]]:
        kernel = Kernel(bogie, level=1 + number % 3, initial_speed=10.0 + number, lateral_irregularity=0.01)
        kernel.set(brake_torque_1=2e4 + 1e3 * number, traction_torque_2=500.0 * number)
        kernel.initialise()
        rows = []
        for i in range(300):
            kernel.step(i * 0.01, 0.01)
            rows.append(outputs(kernel))
        return rows

    alone = [journey(number) for number in range(16)]
    with ThreadPoolExecutor(16) as pool:
        assert list(pool.map(journey, range(16))) == alone


@pytest.mark.parametrize("level", [1, 2, 3])
def test_output_derivatives_are_those_of_differences(bogie: Library, level: int) -> None:
    """The brake torque rises at the same rate as in the last step."""
    kernel = Kernel(bogie, level=level, tolerance=1e-10, lateral_irregularity=0.01, yaw_torque_1=1e3 * (level == 3))
    kernel.advance(1.0)
    names = ["speed", "distance", "angular_velocity_1", "axle_load_1", "creep_force_1", "lateral_1", "slip_ratio_1"]
    kernel.set_rate(brake_torque_1=4e3)
    kernel.step(1.0, 0.5)
    rates, saved = kernel.rates(names), kernel.save()
    values = []
    for size in (1e-4, 2e-4):
        kernel.restore(saved)
        kernel.set_rate(brake_torque_1=4e3)
        kernel.step(1.5, size)
        values.append([kernel[name] for name in names])
    kernel.restore(saved)
    here = np.array([kernel[name] for name in names])
    differences = (-3 * here + 4 * np.array(values[0]) - np.array(values[1])) / 2e-4
    scale = {"axle_load_1": 1e5, "creep_force_1": 1e5}
    for name, rate, difference in zip(names, rates, differences, strict=True):
        assert rate == pytest.approx(difference, rel=1e-3, abs=1e-5 * scale.get(name, 1.0)), name
    assert rates[0] == pytest.approx(kernel["acceleration"], rel=1e-9)


@pytest.mark.parametrize("level", [1, 2, 3])
def test_directional_derivatives_are_those_of_differences(bogie: Library, level: int) -> None:
    kernel = Kernel(bogie, level=level, tolerance=1e-10, brake_torque_1=1e4, lateral_irregularity=0.005)
    kernel.advance(1.0)
    names = ["acceleration", "creep_force_1", "axle_load_1", "speed"]
    change = {"friction_1": 0.01, "friction_2": 0.02, "drawbar_force": 100.0}
    found = kernel.directional(names, change)
    size = 1e-3
    begin = {name: kernel[name] for name in change}
    saved, shifted = kernel.save(), []
    for sign in (1.0, -1.0):
        kernel.restore(saved)
        kernel.set(**{name: begin[name] + sign * size * value for name, value in change.items()})
        kernel.linearise()  # the algebraic states follow the inputs
        shifted.append([kernel[name] for name in names])
    differences = (np.array(shifted[0]) - np.array(shifted[1])) / (2 * size)
    assert found == pytest.approx(list(differences), rel=1e-5, abs=1e-6)
    assert abs(found[0]) > 0.0
    with pytest.raises(SimulationError, match="A derivative must be with respect to a real input or state; got level"):
        kernel.directional(["speed"], {"level": 1.0})
    with pytest.raises(SimulationError, match="A derivative must be of a real output; got locked_1"):
        kernel.rates(["locked_1"])


@pytest.mark.study
@pytest.mark.parametrize("level", [2, 3])
def test_derivatives_by_states_are_those_of_the_linearisation(bogie: Library, level: int) -> None:
    """The acceleration's derivative by a state is a combination of rows of the exact Jacobian."""
    kernel = Kernel(bogie, level=level, contact_model=1, brake_torque_1=1e4)
    kernel.advance(1.0)
    assert kernel.directional(["speed"], {"state_frame_speed": 1.0}) == pytest.approx([1.0])
    assert kernel["state_angular_velocity_1"] == kernel["angular_velocity_1"]
    assert kernel.rates(["state_frame_distance"]) == pytest.approx([kernel["state_frame_speed"]])
    saved = kernel.save()
    names = [state.name for state in levels(two_axle_bogie())[level - 1].states.values() if not state.algebraic]
    found = [kernel.directional(["acceleration"], {state_variable(name): 1.0})[0] for name in names]
    assert kernel.save() == saved
    place = [kernel[state_variable(name)] for name in names]
    rows = dict(zip(names, np.array(kernel.jacobian_at(kernel.time, place)), strict=True))
    axles = rows["frame_speed"] + (rows["shift_speed_1"] + rows["shift_speed_2"]) / 2
    assert np.abs(axles).max() > 10.0  # per second: the creep law is stiff
    assert found == pytest.approx(list(axles), rel=1e-6, abs=1e-6)
    with pytest.raises(SimulationError, match="state_frame_speed is a state and cannot be set"):
        kernel.set(state_frame_speed=1.0)


def library_in(fmu: Path, folder: Path) -> Path:
    with zipfile.ZipFile(fmu) as archive:
        [name] = [name for name in archive.namelist() if name.startswith("binaries/")]
        archive.extract(name, folder)
    return folder / name


@pytest.mark.study
def test_archive_runs_without_python(fmus: dict, tmp_path: Path) -> None:
    """A C program loads the binary of the archive, brakes to a stop and frees 1000 instances."""
    host = tmp_path / "host"
    command = [*compiling.compiler(), "-O1", "-Wall", "-Wextra", "-Werror", f"-I{compiling.fmi_headers()}", str(HOST)]
    subprocess.run([*command, "-o", str(host), "-ldl", "-lm"], check=True)
    library = library_in(fmus["bogie", "native"], tmp_path)
    with zipfile.ZipFile(fmus["bogie", "native"]) as archive:
        text = archive.read("modelDescription.xml").decode()
    guid = text.split('guid="')[1].split('"')[0]
    speed = text.split('name="speed" valueReference="')[1].split('"')[0]
    torque = text.split('name="brake_torque_1" valueReference="')[1].split('"')[0]
    call = [str(host), str(library), guid, speed, torque]
    done = subprocess.run(call, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stdout + done.stderr
    assert float(done.stdout.split()[1]) < 25.0
    if shutil.which("valgrind"):
        checked = subprocess.run(
            ["valgrind", "--leak-check=full", "--error-exitcode=9", *call], capture_output=True, text=True
        )
        assert checked.returncode == 0, checked.stderr[-2000:]


@pytest.mark.study
def test_sources_in_the_archive_build(fmus: dict, tmp_path: Path) -> None:
    """Users can compile sources/ themselves; modelDescription.xml lists the files for each interface."""
    with zipfile.ZipFile(fmus["brake", "native"]) as archive:
        archive.extractall(tmp_path / "own")
    about = ElementTree.parse(tmp_path / "own/modelDescription.xml").getroot()
    names, others = (
        [file.attrib["name"] for file in about.iterfind(f"{one}/SourceFiles/File")]
        for one in ("CoSimulation", "ModelExchange")
    )
    assert names == others
    [library] = (tmp_path / "own/binaries").rglob("BrakeCylinder.*")
    library.unlink()
    command = [*compiling.compiler(), *compiling.FLAGS, "-O1", "-shared", "-o", str(library), *names, "-lm"]
    subprocess.run(command, cwd=tmp_path / "own/sources", check=True)
    shutil.make_archive(str(tmp_path / "own"), "zip", tmp_path / "own")
    with FmuInstance(tmp_path / "own.zip") as brake:
        brake.start(pressure_demand=1e5)
        brake.step(0.0, 10.0)
        assert brake["cylinder_pressure"] == pytest.approx(1e5, rel=1e-3)


@pytest.mark.study
def test_two_builds_on_two_paths_have_equal_bytes(fmus: dict, tmp_path: Path) -> None:
    """Build in this checkout and in a copy of it."""
    root, copy = Path(compiling.__file__).parents[1], tmp_path / "another" / "place"
    copy.mkdir(parents=True)
    for part in (*ROOMS, "build_fmu.py", "LICENSE", "pyproject.toml"):
        source = root / part
        if source.is_dir():
            shutil.copytree(source, copy / part, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copyfile(source, copy / part)
    command = [sys.executable, "build_fmu.py", "brake", "--kind", "native"]
    subprocess.run(command, cwd=copy, check=True, capture_output=True)
    built = (copy / "build" / "native" / "BrakeCylinder.fmu").read_bytes()
    assert built == fmus["brake", "native"].read_bytes()


def test_bogie_has_a_page_a_picture_a_license_and_an_icon(fmus: dict) -> None:
    with zipfile.ZipFile(fmus["bogie", "native"]) as archive:
        page = archive.read("documentation/index.html").decode()
        for name in variables_of("bogie"):
            assert f"<code>{name}</code>" in page
        for name in ("documentation/picture.png", "model.png"):
            assert archive.read(name)[:4] == b"\x89PNG"
        assert b"MIT" in archive.read("documentation/licenses/license.txt")

"""The FMUs and the system in masters that are not ours: FMPy, ecos, libcosim; and fmutool's check.

The other masters are in the extra `masters`; each runs in a process of its own.
"""

from __future__ import annotations

import importlib.util
import json
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from fmpy import read_model_description
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import read_ssv

from fmu_src.ssp import Component, write_ssp
from scenarios.fmus.building import build_system, fmu_path
from scenarios.fmus.registry import DIFFERENT

#: Band of docs/checking.md for the end speed [m/s].
SPEED_BAND = 1e-6
SECONDS, STEP = 1.0, 1e-3

ECOS = """
import ctypes, json, sys
from pathlib import Path
ctypes.CDLL(str(Path(sys.prefix) / "lib" / "libtbb.so.12"), ctypes.RTLD_GLOBAL)
from ecospy import EcosSimulation
with EcosSimulation(step_size=1e-3, ssp_path=sys.argv[1]) as simulation:
    simulation.init(parameter_set="BogieBraking")
    simulation.step(1000)
    print("ANSWER", json.dumps([simulation.get_real("bogie::speed"), simulation.get_real("brake::cylinder_pressure")]))
    simulation.terminate()
"""
LIBCOSIM = """
import json, sys
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver
execution = CosimExecution.from_ssp_file(sys.argv[1], step_size=1_000_000)
observer = CosimObserver.create_last_value()
execution.add_observer(observer)
execution.step(1000)  # what it returns differs between versions; the values below tell
bogie, brake = (execution.slave_index_from_instance_name(name) for name in ("bogie", "brake"))
found = observer.last_real_values(bogie, [int(sys.argv[2])]) + observer.last_real_values(brake, [int(sys.argv[3])])
print("ANSWER", json.dumps(list(found)))
"""


@pytest.fixture(scope="module")
def system(fmus: dict, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The system BogieBraking.ssp and, beside it, its contents."""
    out = tmp_path_factory.mktemp("system")
    for name in ("bogie", "brake"):
        target = fmu_path(name, "native", out)
        target.parent.mkdir(exist_ok=True)
        shutil.copyfile(fmus[name, "native"], target)
    path = build_system(out)
    with zipfile.ZipFile(path) as archive:
        archive.extractall(out / "contents")
    return path


@pytest.fixture(scope="module")
def by_fmpy(system: Path) -> tuple[float, float]:
    """Speed of the bogie and pressure of the cylinder after a second."""
    parameters = read_ssv(str(system.parent / "contents" / "resources" / "BogieBraking.ssv"))
    table = simulate_ssp(str(system), stop_time=SECONDS, step_size=STEP, parameter_set=parameters)
    return float(table["bogie.speed"][-1]), float(table["brake.cylinder_pressure"][-1])


def answer(program: str, *arguments: str) -> list[float]:
    done = subprocess.run([sys.executable, "-c", program, *arguments], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr[-2000:]
    [line] = [line for line in done.stdout.splitlines() if line.startswith("ANSWER")]  # libcosim talks as well
    return json.loads(line.removeprefix("ANSWER"))


def test_system_brakes_in_fmpy(by_fmpy: tuple[float, float]) -> None:
    speed, pressure = by_fmpy
    assert 2.0 < speed < 2.9
    assert pressure == pytest.approx(180e3, rel=0.05)


@pytest.mark.skipif(importlib.util.find_spec("ecospy") is None, reason="install the extra: pip install -e .[masters]")
def test_system_gives_the_same_speed_in_ecos(system: Path, by_fmpy: tuple[float, float]) -> None:
    speed, pressure = answer(ECOS, str(system))
    assert speed == pytest.approx(by_fmpy[0], abs=SPEED_BAND)
    assert pressure == pytest.approx(by_fmpy[1], rel=1e-6)


@pytest.mark.skipif(
    importlib.util.find_spec("libcosimpy") is None, reason="install the extra: pip install -e .[masters]"
)
def test_system_gives_the_same_speed_in_libcosim(system: Path, by_fmpy: tuple[float, float]) -> None:
    contents = system.parent / "contents"
    references = []
    for fmu, name in (("BogieDynamics", "speed"), ("BrakeCylinder", "cylinder_pressure")):
        about = read_model_description(str(contents / "resources" / f"{fmu}.fmu"))
        references += [str(v.valueReference) for v in about.modelVariables if v.name == name]
    speed, pressure = answer(LIBCOSIM, str(contents), *references)
    assert speed == pytest.approx(by_fmpy[0], abs=SPEED_BAND)
    assert pressure == pytest.approx(by_fmpy[1], rel=1e-6)


@pytest.mark.skipif(
    importlib.util.find_spec("fmu_manipulation_toolbox") is None, reason="install the extra: pip install -e .[masters]"
)
@pytest.mark.parametrize("key", [(name, kind) for name in DIFFERENT for kind in ("native", "python")])
def test_fmutool_finds_no_fault(fmus: dict, key: tuple[str, str]) -> None:
    tool = Path(sys.executable).parent / "fmutool"
    done = subprocess.run([tool, "-input", str(fmus[key]), "-check"], capture_output=True, text=True)
    assert "This FMU seems to be compliant with FMI-2.0" in done.stdout + done.stderr


def test_parameter_that_does_not_exist_is_refused(fmus: dict, tmp_path: Path) -> None:
    component = Component("brake", fmus["brake", "native"], {"pressure": 1.0})
    with pytest.raises(ValueError, match="has no variable pressure"):
        write_ssp(tmp_path / "x.ssp", "x", [component], [], (1.0, 1e-3))
    assert list(tmp_path.iterdir()) == []

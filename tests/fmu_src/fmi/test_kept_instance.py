"""One instance is reset and reused for many stops, with FMPy only, as in docs/driving.md."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave

from tests.conftest import Fmus

#: Largest growth of resident memory without a leak [bytes].
NOISE = 500_000
LENGTH = 20.0
SOME, MANY = 5_000, 100_000


class Kept:
    """An instance of an FMU of either standard, unpacked and loaded once."""

    def __init__(self, path: Path) -> None:
        about = read_model_description(str(path))
        self.three = about.fmiVersion == "3.0"
        self.refs = {variable.name: variable.valueReference for variable in about.modelVariables}
        self.folder = extract(str(path))
        identifier = about.coSimulation.modelIdentifier
        kind = FMU3Slave if self.three else FMU2Slave
        self.fmu = kind(guid=about.guid, unzipDirectory=self.folder, modelIdentifier=identifier, instanceName="kept")
        self.fmu.instantiate()

    def stop(self, number: int) -> list[float]:
        """Stop from 10 m/s at level 1 with the torque of this number; return the distance and the speed at the end."""
        fmu, refs, torque = self.fmu, self.refs, 15e3 + 1e-2 * number
        reals, whole = (fmu.setFloat64, fmu.setInt32) if self.three else (fmu.setReal, fmu.setInteger)
        if not self.three:
            fmu.setupExperiment(startTime=0.0)
        whole([refs["level"]], [1])
        reals([refs[name] for name in ("initial_speed", "brake_torque_1", "brake_torque_2")], [10.0, torque, torque])
        fmu.enterInitializationMode()
        fmu.exitInitializationMode()
        fmu.doStep(0.0, LENGTH)
        read = [refs["distance"], refs["speed"]]
        found = list(fmu.getFloat64(read)) if self.three else list(fmu.getReal(read))
        fmu.reset()
        return found

    def close(self) -> None:
        self.fmu.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)


def resident() -> int:
    """Return the resident memory of this process [bytes]."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096


def mapped() -> set[str]:
    """Return the FMU libraries that this process has mapped."""
    lines = Path("/proc/self/maps").read_text().splitlines()
    return {line.split()[-1] for line in lines if line.endswith("BogieDynamics.so")}


def run(path: Path, count: int) -> None:
    """Make `count` stops of one instance in a separate process; print its growth of memory and number of libraries."""
    kept = Kept(path)
    for number in range(SOME // 2):
        kept.stop(number)
    before, found = resident(), {}
    for number in range(count):
        ends = kept.stop(number)
        if number % (count // 10) == 0:
            found[number] = ends
    grown, loaded = resident() - before, len(mapped())
    for number, ends in found.items():
        new = Kept(path)
        assert new.stop(number) == ends
        new.close()
    assert len({distance for distance, _ in found.values()}) == 10
    assert all(speed == 0.0 for _, speed in found.values())
    kept.close()
    print(grown, loaded)


@pytest.mark.skipif(sys.platform != "linux", reason="memory and libraries of a process are read from /proc")
@pytest.mark.parametrize("kind", ["native", "fmi3"])
@pytest.mark.parametrize("count", [SOME, pytest.param(MANY, marks=pytest.mark.long)])
def test_a_kept_instance_neither_grows_nor_loads_anew_and_gives_the_bits_of_a_new_one(
    fmus: Fmus, kind: str, count: int
) -> None:
    call = [sys.executable, "-m", "tests.fmu_src.fmi.test_kept_instance", str(fmus["bogie", kind]), str(count)]
    done = subprocess.run(call, cwd=Path(__file__).parents[3], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    grown, loaded = map(int, done.stdout.split())
    assert grown < NOISE
    assert loaded == 1


if __name__ == "__main__":
    run(Path(sys.argv[1]), int(sys.argv[2]))

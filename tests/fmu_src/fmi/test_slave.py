"""Our FmuInstance and master with FMUs of both standards, including arrays."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import pytest
from fmpy import platform_tuple
from fmpy.fmi3 import FMU3Slave

from fmu_src import compile as compiling
from fmu_src.compile import library_suffix
from fmu_src.cosimulation.master import Connection, Coupling, Master, cosimulate
from fmu_src.cosimulation.slave import CosimulationError, FmuInstance
from tests.fmu_src.fmi.sanitized import HEADERS

DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="Arrays" instantiationToken="{arrays}">
  <CoSimulation modelIdentifier="Arrays"/>
  <ModelVariables>
    <Float64 name="gain" valueReference="1" causality="parameter" variability="fixed" start="0 0 0 0 0 0">
      <Dimension start="2"/><Dimension start="3"/>
    </Float64>
    <Float64 name="u" valueReference="2" causality="input" start="0 0 0"><Dimension start="3"/></Float64>
    <Float64 name="y" valueReference="3" causality="output"><Dimension start="2"/></Float64>
    <Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>
    <Int32 name="count" valueReference="4" causality="input" start="0"/>
  </ModelVariables>
  <ModelStructure><Output valueReference="3"/></ModelStructure>
</fmiModelDescription>
"""
#: Relative difference between two FMI versions of the same kernel.
SAME = 1e-12


@pytest.fixture(scope="module")
def arrays(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return an FMU with array variables; our own FMUs have none."""
    folder = tmp_path_factory.mktemp("arrays")
    library = folder / f"Arrays{library_suffix()}"
    source = Path(__file__).parent / "arrays.c"
    others = [name for name in dir(FMU3Slave) if name.startswith("fmi3") and name not in source.read_text("utf-8")]
    # FMPy loads all functions of the standard. Functions that are not called refuse.
    (folder / "others.c").write_text(
        "".join(f"int {name}(void);\nint {name}(void) {{ return 3; }}\n" for name in others)
    )
    call = ["-shared", "-fPIC", *map(str, HEADERS), "-o", str(library), str(source), "others.c"]
    compiling.run(call, None, folder)
    with zipfile.ZipFile(folder / "Arrays.fmu", "w") as archive:
        archive.writestr("modelDescription.xml", DESCRIPTION)
        archive.write(library, f"binaries/{platform_tuple}/Arrays{library_suffix()}")
    return folder / "Arrays.fmu"


def test_arrays_go_in_and_come_out_row_by_row(arrays: Path) -> None:
    gain = np.arange(6.0).reshape(2, 3)
    with FmuInstance(arrays, gain=gain.tolist()) as slave:
        slave.start(u=[1.0, 2.0, 3.0], count=7)
        assert slave.array("gain").tolist() == gain.tolist()
        assert slave.array("y") == pytest.approx(gain @ [1.0, 2.0, 3.0])
        assert slave["count"] == 7.0
        slave.set(u=np.array([0.0, 0.0, 1.0]))
        assert slave.array("y") == pytest.approx(gain[:, 2])


def test_what_an_array_is_not_is_told(arrays: Path) -> None:
    with FmuInstance(arrays) as slave:
        slave.start()
        with pytest.raises(CosimulationError, match="u of Arrays must have 3 numbers; got 2"):
            slave.set(u=[1.0, 2.0])
        with pytest.raises(CosimulationError, match="y of Arrays is not a single number; use `array` for an array"):
            slave["y"]
        slave.step(0.0, 1.0)
        with pytest.raises(CosimulationError, match="Arrays: The FMU asked to end the run"):
            slave.step(1.0, 0.5)


def braked(bogie: Path, brake: Path, master: Master) -> np.ndarray:
    """Return the speed of the bogie and the torque of its brake, which are coupled, after each macro step."""
    with FmuInstance(bogie, initial_speed=25.0) as one, FmuInstance(brake) as other:
        one.start()
        other.start(pressure_demand=180e3, angular_velocity=25.0 / 0.425)
        connections = [
            Connection(other, "brake_torque", one, "brake_torque_2"),
            Connection(one, "angular_velocity_2", other, "angular_velocity"),
        ]
        record = [(one, "speed"), (other, "brake_torque")]
        slaves = [other, one]
        found = cosimulate(slaves, connections, 2.0, 1e-2, record, coupling=Coupling(slaves, connections, master))
        return np.column_stack([found[name] for name in ("time", "speed", "brake_torque")])


@pytest.mark.study
def test_both_standards_give_the_same_run_in_the_master(fmus: dict) -> None:
    """FMUs of different versions are included, and macro steps that are repeated."""
    pairs = [(one, other) for one in ("native", "fmi3") for other in ("native", "fmi3")]
    held = [braked(fmus["bogie", one], fmus["brake", other], Master()) for one, other in pairs]
    assert all(found == pytest.approx(held[0], rel=SAME) for found in held[1:])
    chosen = [
        braked(fmus["bogie", kind], fmus["brake", kind], Master(coupling_tolerance=1e-4)) for kind in ("native", "fmi3")
    ]
    assert chosen[0] == pytest.approx(chosen[1], rel=SAME)
    assert len(chosen[0]) != len(held[0])


def test_a_value_that_is_refused_is_told_with_the_sentence_of_the_fmu(fmus: dict) -> None:
    for kind in ("native", "fmi3"):
        with (
            FmuInstance(fmus["bogie", kind]) as slave,
            pytest.raises(CosimulationError, match="brake_torque_1 must be at least 0"),
        ):
            slave.start(brake_torque_1=-1.0)


def test_another_version_is_refused(arrays: Path, tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "Old.fmu", "w") as archive:
        text = DESCRIPTION.replace('fmiVersion="3.0"', 'fmiVersion="3.1"')
        archive.writestr("modelDescription.xml", text)
    with pytest.raises(Exception, match=r"3\.1"):
        FmuInstance(tmp_path / "Old.fmu")

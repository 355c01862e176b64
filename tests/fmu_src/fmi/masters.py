"""Simulate a system of FMUs (.ssp) in third-party masters. All except FMPy run in a separate process."""

from __future__ import annotations

import importlib.util
import json
import re
import subprocess
import sys
import zipfile
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest
from fmpy import read_model_description
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import ParameterSet, read_ssd, read_ssv

from fmu_src import compile as compiling

ECOS = """
import ctypes, json, os, sys
from pathlib import Path
ctypes.CDLL(str(Path(sys.prefix) / "lib" / "libtbb.so.12"), ctypes.RTLD_GLOBAL)
from ecospy import EcosSimulation
path, step, count, *names = sys.argv[1:]
with EcosSimulation(step_size=float(step), ssp_path=path) as simulation:
    simulation.init(parameter_set=Path(path).stem)
    simulation.step(int(count))
    print("ANSWER", json.dumps([simulation.get_real(name) for name in names]), flush=True)
    os._exit(0)  # pythonfmu ends badly (docs/hosts.md)
"""
LIBCOSIM = """
import json, os, sys
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver
folder, step, count, *names = sys.argv[1:]
execution = CosimExecution.from_ssp_file(folder, step_size=round(float(step) * 1e9))
observer = CosimObserver.create_last_value()
execution.add_observer(observer)
execution.step(int(count))  # what it returns differs between versions; the values below tell
found = []
for name in names:
    component, reference = name.split(":")
    slave = execution.slave_index_from_instance_name(component)
    found += list(observer.last_real_values(slave, [int(reference)]))
print("ANSWER", json.dumps(found), flush=True)
os._exit(0)
"""
#: Name of a component and of one of its real outputs.
Output = tuple[str, str]


def contents(system: Path) -> Path:
    """Unpack the system into a folder next to it; return the folder."""
    folder = system.with_suffix(".contents")
    with zipfile.ZipFile(system) as archive:
        archive.extractall(folder)
    return folder


def parameters_of(system: Path) -> ParameterSet:
    """Return the parameter file of a system."""
    return read_ssv(str(contents(system) / "resources" / f"{system.stem}.ssv"))


def by_fmpy(system: Path, step: float, count: int, outputs: Sequence[Output]) -> list[float]:
    """Return output values after `count` steps."""
    stop = (count - 0.5) * step
    table = simulate_ssp(str(system), stop_time=stop, step_size=step, parameter_set=parameters_of(system))
    return [float(table[f"{component}.{name}"][-1]) for component, name in outputs]


def by_ecos(system: Path, step: float, count: int, outputs: Sequence[Output]) -> list[float]:
    """Return the values of by_fmpy; ecos reads the parameters from the system's description."""
    return answer(ECOS, str(system), repr(step), str(count), *(f"{component}::{name}" for component, name in outputs))


def by_libcosim(system: Path, step: float, count: int, outputs: Sequence[Output]) -> list[float]:
    """Return the values of by_ecos; libcosim identifies variables by value reference."""
    folder, names = contents(system), []
    fmus = {component.name: component.source for component in read_ssd(str(system)).system.elements}
    for component, name in outputs:
        about = read_model_description(str(folder / fmus[component]))
        [reference] = [v.valueReference for v in about.modelVariables if v.name == name]
        names.append(f"{component}:{reference}")
    return answer(LIBCOSIM, str(folder), repr(step), str(count), *names)


def by_program_in_c(system: Path, step: float, count: int, outputs: Sequence[Output]) -> list[float]:
    """Return the values of by_ecos, by the program in the archive: unpacked and compiled as its first lines say."""
    folder = contents(system)
    program = (folder / "documentation" / "host.c").read_text(encoding="utf-8")
    fmus = re.findall(r"^ \*   python -m zipfile -e (\S+) (\S+)$", program, re.MULTILINE)
    for fmu, name in fmus:
        with zipfile.ZipFile(folder / fmu) as archive:
            archive.extractall(folder / name)
    headers = f"-I{fmus[0][1]}/sources"
    assert f"cc {headers} documentation/host.c -ldl -o host && ./host . SECONDS" in program
    compiling.run(["-Wall", "-Wextra", "-Werror", headers, "documentation/host.c", "-ldl", "-o", "host"], None, folder)
    assert subprocess.run([folder / "host", folder], capture_output=True).returncode == 1
    called = [folder / "host", folder, repr(step * count)]
    done = subprocess.run(called, capture_output=True, text=True, check=True, timeout=120)
    found = dict(line.split() for line in done.stdout.splitlines())
    return [float(found[f"{component}.{name}"]) for component, name in outputs]


def answer(program: str, *arguments: str) -> list[float]:
    """Run a program in a separate process; return its answer."""
    done = subprocess.run([sys.executable, "-c", program, *arguments], capture_output=True, text=True, timeout=120)
    lines = [line for line in done.stdout.splitlines() if line.startswith("ANSWER")]  # libcosim prints to stdout, too
    assert lines, done.stderr[-2000:]
    return json.loads(lines[0].removeprefix("ANSWER"))


#: Masters by package, and the program in C. Packages except FMPy are in the extra `masters`.
IN_C = "C"
MASTERS: dict[str, Callable] = {
    "fmpy": by_fmpy,
    "ecospy": by_ecos,
    "libcosimpy": by_libcosim,
    IN_C: by_program_in_c,
}


def master(name: str) -> Callable:
    """Return a master; skip the test if its package is missing."""
    if name != IN_C and importlib.util.find_spec(name) is None:
        pytest.skip("install the extra: pip install -e .[masters]")
    return MASTERS[name]

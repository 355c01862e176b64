"""Cost of the FMI interface beyond the kernel, and of an instance: through FMPy, and from a host in C."""

import ctypes
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from bogie_braking.reporting.report import Row, measured
from bogie_braking.reporting.timing import least
from fmu_src import compile as compiling
from fmu_src.cosimulation.slave import CosimulationError, FmuInstance
from fmu_src.kernel import Kernel, Library
from products.building import up_to_date

#: A host in C that makes `count` equal steps from time 0.
HOST = """
typedef int step_function(void *, double, double, int);
int make_steps(step_function *step, void *component, double size, int count) {
    for (int i = 0; i < count; ++i) {
        const int status = step(component, i * size, size, 1);
        if (status > 1) return status;
    }
    return 0;
}
"""
STEP, STEPS, RUNS = 1e-3, 20000, 9
INSTANCES = 200
#: Vehicle at rest: the steps of the kernel are cheapest, so that the cost of the interface is visible.
SCENE = {"level": 1, "initial_speed": 0.0}
#: Targets of the project [us].
THROUGH_FMPY, FROM_C, INSTANTIATE = 1.0, 0.05, 1000.0


def host_library(folder: Path) -> ctypes.CDLL:
    (folder / "host.c").write_text(HOST)
    name = f"host{compiling.library_suffix()}"
    compiling.run(["-O2", "-shared", "-fPIC", "-o", name, "host.c"], None, folder)
    return ctypes.CDLL(str(folder / name))


def kernel_seconds(library: Library) -> float:
    """Return the time of the steps alone, called in C [s]."""
    kernel = Kernel(library, **SCENE)
    kernel.initialise()
    start = kernel.save()

    def steps() -> None:
        kernel.restore(start)
        kernel.repeat_step(STEP, STEPS)

    return least(steps, RUNS)


def face_seconds(bogie: FmuInstance, make_steps: Callable[..., int]) -> tuple[float, float]:
    """Return the time of the same steps through fmi2DoStep [s]: called by FMPy, and by the host in C."""
    by_fmpy = by_c = float("inf")
    for _ in range(RUNS):
        bogie.restart(SCENE)
        step, begin = bogie.fmu.doStep, time.perf_counter()
        for number in range(STEPS):
            step(number * STEP, STEP)
        by_fmpy = min(by_fmpy, time.perf_counter() - begin)
        bogie.restart(SCENE)
        function = ctypes.cast(bogie.fmu.dll.fmi2DoStep, ctypes.c_void_p)
        begin = time.perf_counter()
        status = make_steps(function, ctypes.c_void_p(bogie.fmu.component), ctypes.c_double(STEP), STEPS)
        by_c = min(by_c, time.perf_counter() - begin)
        if status:
            raise CosimulationError(f"A step of the host in C returned {status}.")
    return by_fmpy, by_c


def instantiate_seconds(bogie: FmuInstance) -> float:
    """Return the time of fmi2Instantiate and fmi2FreeInstance, with the library loaded [s]."""
    fmu = bogie.fmu
    kept = fmu.component
    begin = time.perf_counter()
    for _ in range(INSTANCES):
        fmu.instantiate()
        fmu.fmi2FreeInstance(fmu.component)
    seconds = (time.perf_counter() - begin) / INSTANCES
    fmu.component = kept
    return seconds


def rows(library: Library) -> list[Row]:
    """Return rows of the measurements, in microseconds, least of several runs."""
    with tempfile.TemporaryDirectory() as folder, FmuInstance(up_to_date("bogie", "native")) as bogie:
        make_steps = host_library(Path(folder)).make_steps
        bare = kernel_seconds(library)
        by_fmpy, by_c = face_seconds(bogie, make_steps)
        instance = instantiate_seconds(bogie)
    found = (
        ("doStep beyond the kernel, through fmpy", 1e6 * (by_fmpy - bare) / STEPS, THROUGH_FMPY),
        ("doStep beyond the kernel, from C", 1e6 * (by_c - bare) / STEPS, FROM_C),
        ("an instance made and freed, through fmpy", 1e6 * instance, INSTANTIATE),
    )
    return [measured(name, "us", value, f"measured now; to stay below {limit:g}") for name, value, limit in found]

"""CVODE and IDA of SUNDIALS on the compiled equations, called from C (sundials.c) without Python's overhead."""

import ctypes
import hashlib
import math
import time as clock
from collections.abc import Callable
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from evidence.measuring.runs import SceneRun, failed, finish, layout_of
from evidence.measuring.scenes import SMOOTH, Scene
from evidence.peers.scipy_methods import BUDGET
from fmu_src import compile as compiling
from fmu_src.kernel import Kernel, SimulationError

SOURCE = Path(__file__).parent / "sundials.c"
FLAGS = ("-std=c11", "-O2", "-fPIC", "-shared", "-Wall", "-Wextra", "-Werror")
LIBRARIES = ("core", "nvecserial", "sunmatrixdense", "sunlinsoldense", "cvode", "ida")
METHODS = ("CVODE", "IDA")

_pointer = ctypes.POINTER(ctypes.c_double)


class Session(ctypes.Structure):
    """`run` of sundials.c."""

    _fields_ = [
        ("machine", ctypes.c_void_p),
        *((name, ctypes.c_void_p) for name in ("slopes_at", "equations_at", "margin_at")),
        ("size", ctypes.c_int),
        ("differentials", ctypes.c_int),
        ("chosen", ctypes.POINTER(ctypes.c_int)),
        ("inertia", _pointer),
        *((name, ctypes.c_double) for name in ("time", "end", "interval", "tolerance", "longest_step")),
        *((name, _pointer) for name in ("nominal", "place", "slope", "samples")),
        ("written", ctypes.c_long),
        ("capacity", ctypes.c_long),
        ("rooted", ctypes.c_int),
        *((name, ctypes.c_long) for name in ("slopes", "jacobians", "steps")),
        ("deadline", ctypes.c_double),
        *(
            (name, ctypes.c_void_p)
            for name in ("context", "memory", "vector", "rate", "spare", "absolute", "matrix", "solver")
        ),
    ]


def is_installed() -> bool:
    """Return whether scikit-SUNDAE, whose wheel contains the libraries, is installed; it needs Python 3.11."""
    return find_spec("sksundae") is not None


@lru_cache
def driver() -> ctypes.CDLL:
    """Return sundials.c, compiled unless it is in the cache. Raises CompilerError."""
    import sksundae

    folder = Path(sksundae.__file__).parent.parent / "scikit_sundae.libs"
    libraries = [str(next(folder.glob(f"libsundials_{name}-*"))) for name in LIBRARIES]
    words = " ".join([compiling.here(), *compiling.compiler(), *FLAGS, *libraries])
    digest = hashlib.sha256(SOURCE.read_bytes() + words.encode()).hexdigest()

    def linked(work: Path) -> Path:
        compiling.run([*FLAGS, "-o", "driver", str(SOURCE), *libraries, f"-Wl,-rpath,{folder}"], None, work)
        return work / "driver"

    return compiling.loaded(compiling.in_cache(f"sundials-{digest[:16]}{compiling.library_suffix()}", linked))


def _address(function: Callable[..., int]) -> int | None:
    return ctypes.cast(function, ctypes.c_void_p).value  # type: ignore[arg-type]


class Integrator:
    """CVODE or IDA on one kernel of a case, from the kernel's present state; `samples` rows go into `rows`."""

    def __init__(self, method: str, kernel: Kernel, scene: Scene, tolerance: float, samples: int) -> None:
        form, functions = layout_of(scene), kernel.library.functions
        self.kernel, self.whole, self.differential = kernel, method == "IDA", form.differential
        self._begin, self._advance, self._close = (
            getattr(driver(), f"{method.lower()}_{word}") for word in ("open", "advance", "close")
        )
        kept = np.ones(len(form.names), bool) if self.whole else form.differential
        size = int(kept.sum())
        self.names = form.names if self.whole else form.kept
        self._nominal = form.nominal[kept]
        self._inertia = form.differential.astype(float)
        self._chosen = np.flatnonzero(form.differential).astype(np.int32)
        self._place, self._slope, self.rows = np.zeros(size), np.zeros(size), np.zeros((samples, size))
        self.session = Session(
            machine=kernel.handle,
            slopes_at=_address(functions.kernel_slopes_at),
            equations_at=_address(functions.kernel_equations_at),
            margin_at=_address(functions.kernel_margin_at),
            size=size,
            differentials=int(form.differential.sum()),
            chosen=self._chosen.ctypes.data_as(ctypes.POINTER(ctypes.c_int)),
            inertia=self._inertia.ctypes.data_as(_pointer),
            time=kernel.time,
            interval=scene.interval,
            longest_step=scene.longest_step,
            tolerance=tolerance,
            nominal=self._nominal.ctypes.data_as(_pointer),
            place=self._place.ctypes.data_as(_pointer),
            slope=self._slope.ctypes.data_as(_pointer),
            samples=self.rows.ctypes.data_as(_pointer),
            capacity=samples,
            deadline=math.inf,
        )
        self._look()
        if samples:
            self.rows[0], self.session.written = self._place, 1
        self._begin(ctypes.byref(self.session))

    def _look(self) -> None:
        """Read the kernel's present state, and for IDA its derivatives."""
        found = self.kernel.linearise()
        state, slope = np.array(found.state), np.array(found.slope)
        self._place[:] = state if self.whole else state[self.differential]
        if self.whole:
            self._slope[:] = np.where(self.differential, slope, 0.0)

    def advance(self, end: float) -> None:
        """Restart with the kernel's present inputs, and run to `end` [s], through switches."""
        session = self.session
        while session.time < end and not self.kernel.ended:
            session.end = end
            flag = self._advance(ctypes.byref(session))
            late = clock.time() > session.deadline
            if flag < 0 or late:
                why = "given up" if late else f"SUNDIALS stopped with flag {flag}"
                raise SimulationError(
                    f"{why} at t = {session.time:.4g} s after {self.kernel.counts['events']} switches", 3
                )
            differential = self._place[self.differential] if self.whole else self._place
            arrived = self.kernel.arrive(session.time, differential.tolist(), bool(session.rooted))
            if self.whole:
                self._look()
            else:
                self._place[:] = arrived

    def close(self) -> None:
        self._close(ctypes.byref(self.session))


def sundials(scene: Scene, method: str, tolerance: float, budget: float = BUDGET / 2) -> SceneRun:
    """Run CVODE or IDA through a case, restarted at each corner of the inputs and each switch.

    Takes budget [s].
    """
    kernel, wanted = scene.kernel(), scene.times()
    integrator = Integrator(method, kernel, scene, tolerance, wanted.size)
    begin = clock.perf_counter()
    integrator.session.deadline = clock.time() + budget
    try:
        for start, end in scene.segments():
            scene.set_inputs(kernel, start, end)
            integrator.advance(end)
    except SimulationError as error:
        return failed(scene, clock.perf_counter() - begin, str(error), kernel)
    finally:
        seconds = clock.perf_counter() - begin
        integrator.close()
    columns = [integrator.names.index(name) for name in scene.read]
    session = integrator.session
    work = {"right_hand_sides": session.slopes, "jacobians": session.jacobians, "steps": session.steps}
    return finish(scene, integrator.rows[: session.written, columns], seconds, work, kernel)


#: A host that changes the torque at each communication step: mean and swing [N.m], swing's frequency [Hz], length [s].
TORQUE, SWING, FREQUENCY, HOSTED = 16e3, 4e3, 0.5, 8.0


def hosted_seconds(method: str, step: float, tolerance: float) -> tuple[float, float]:
    """Run a host that sets a torque at each communication step, in C, without Python's overhead.

    Takes step [s]; returns [s].
    """
    kernel = SMOOTH.kernel(tolerance=tolerance if method == "own" else 1e-6)
    integrator = Integrator("CVODE", kernel, SMOOTH, tolerance, 0)
    functions, steps = kernel.library.functions, round(HOSTED / step)
    torque = TORQUE + SWING * np.sin(2 * np.pi * FREQUENCY * step * np.arange(steps))
    numbers = [kernel.library.index[f"brake_torque_{n}"] for n in (1, 2)]
    loop = getattr(driver(), f"{method.lower()}_hosted")
    last = functions.kernel_step if method == "own" else functions.kernel_arrive
    begin = clock.perf_counter()
    failure = loop(
        ctypes.byref(integrator.session),
        ctypes.c_void_p(_address(functions.kernel_set)),
        ctypes.c_void_p(_address(last)),
        (ctypes.c_int * 2)(*numbers),
        torque.ctypes.data_as(_pointer),
        ctypes.c_long(steps),
        ctypes.c_double(step),
    )
    seconds = clock.perf_counter() - begin
    integrator.close()
    if failure:
        raise SimulationError(f"{method} failed within communication steps of {step:g} s", 3)
    return seconds / steps, kernel["distance"]

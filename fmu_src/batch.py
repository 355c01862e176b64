"""Many runs of one model at once, in vector lanes and threads: arrays in, arrays out.

Each run has the bits that it has alone, whatever the order, the number of threads and the width of the lanes.
"""

from __future__ import annotations

import ctypes
import os
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray
from tqdm import tqdm

from fmu_src.batch_in_c import batch_source
from fmu_src.codegen import generate
from fmu_src.compile import batch_library, build_library
from fmu_src.kernel import DISCARD, WARNING, Kernel, KernelError, Library
from fmu_src.progress import PATIENCE
from fmu_src.system import Model, System

#: Time between two looks at how far runs are [s].
GLANCE = 0.1
Numbers = NDArray[np.float64]
_DOUBLES, _INTS = ctypes.POINTER(ctypes.c_double), ctypes.POINTER(ctypes.c_int)


class _Runs(ctypes.Structure):
    _fields_ = (
        ("count", ctypes.c_longlong),
        ("next", ctypes.POINTER(ctypes.c_longlong)),
        ("variables", ctypes.c_int),
        ("outputs", ctypes.c_int),
        ("variable", _INTS),
        ("output", _INTS),
        ("value", _DOUBLES),
        ("start", ctypes.c_double),
        ("stop", ctypes.c_double),
        ("result", _DOUBLES),
        ("end", _DOUBLES),
        ("status", _INTS),
    )


class _Steps(ctypes.Structure):
    _fields_ = (
        ("count", ctypes.c_longlong),
        ("instance", ctypes.POINTER(ctypes.c_void_p)),
        ("inputs", ctypes.c_int),
        ("outputs", ctypes.c_int),
        ("input", _INTS),
        ("output", _INTS),
        ("value", _DOUBLES),
        ("size", ctypes.c_double),
        ("result", _DOUBLES),
        ("status", _INTS),
    )


_SIGNATURES = {
    "batch_create": (ctypes.c_void_p, []),
    "batch_free": (None, [ctypes.c_void_p]),
    "batch_lanes": (ctypes.c_int, []),
    "batch_run": (ctypes.c_bool, [ctypes.c_void_p, ctypes.POINTER(_Runs)]),
    "batch_step": (None, [ctypes.POINTER(ctypes.c_void_p), ctypes.POINTER(_Steps)]),
}


@dataclass(frozen=True)
class Ends:
    """How runs ended, a row or an entry for each.

    outputs: by name; time [s]; ended: which ended by themselves before the stop; failures: sentences, by the number of
    the run, whose numbers are not finite.
    """

    outputs: dict[str, Numbers]
    time: Numbers
    ended: NDArray[np.bool_]
    failures: dict[int, str]


class BatchLibrary(Library):
    """One system of a compiled model in lanes; lanes: 2, 4 or 8, or the most that the processor has."""

    def __init__(self, model: Model, system: System, lanes: int = 0) -> None:
        own = lanes or lanes_here(model)
        super().__init__(batch_library(generate(model) | batch_source(model, system), own))
        for name, (result, arguments) in _SIGNATURES.items():
            function = getattr(self.functions, name)
            function.restype, function.argtypes = result, arguments
        self.lanes = int(self.functions.batch_lanes())

    def numbers(self, names: Sequence[str]) -> ctypes.Array[ctypes.c_int]:
        """Places of variables. Raises KernelError."""
        kernel = Kernel(self)
        return (ctypes.c_int * len(names))(*(kernel.number_of(name) for name in names))


def lanes_here(model: Model) -> int:
    """The most lanes that this processor has, at least 2 and at most 8."""
    return max(2, Kernel(Library(build_library(model))).use_lanes(8))


@lru_cache(maxsize=16)
def library_of_batch(model: Model, system: str, lanes: int = 0) -> BatchLibrary:
    """The library of the system of this name, loaded once."""
    return BatchLibrary(model, next(one for one in model.systems if one.name == system), lanes)


def _in_threads(library: BatchLibrary, count: int, runs: _Runs, queue: ctypes.c_longlong) -> None:
    """Makes the runs in so many threads, each with lanes of its own, and shows how many have begun."""
    call = library.functions
    every = [call.batch_create() for _ in range(count)]
    try:
        if not all(every):
            raise MemoryError("There is not enough memory for a batch.")
        with (
            ThreadPoolExecutor(count) as pool,
            tqdm(total=runs.count, desc="runs", delay=PATIENCE, leave=False, unit="run") as bar,
        ):
            waiting = {pool.submit(call.batch_run, lanes, runs) for lanes in every}
            while waiting:
                done, waiting = wait(waiting, timeout=GLANCE)
                if not all(one.result() for one in done):
                    raise MemoryError("There is not enough memory for a batch.")
                bar.update(min(queue.value, runs.count) - bar.n)
    finally:
        for lanes in every:
            call.batch_free(lanes)


def run_batch(
    library: BatchLibrary,
    values: Mapping[str, ArrayLike],
    stop: float,
    outputs: Sequence[str],
    threads: int | None = None,
) -> Ends:
    """Runs from 0 to `stop` seconds, or where they end by themselves.

    values: parameters and inputs by name, a number for all runs or an array with one for each. threads: as many as the
    machine has processors. Raises KernelError for names, ValueError where arrays differ in length.
    """
    given = {name: np.atleast_1d(np.asarray(value, float)) for name, value in values.items()}
    count = max((one.size for one in given.values()), default=1)
    for name, one in given.items():
        if one.ndim != 1 or one.size not in (1, count):
            raise ValueError(f"{name} has the shape {one.shape}; give a number, or {count} of them as the others have.")
    table = np.column_stack([np.broadcast_to(one, count) for one in given.values()] or [np.zeros((count, 0))])
    table = np.ascontiguousarray(table, float)
    result, time = np.empty((count, len(outputs))), np.empty(count)
    status, queue = np.zeros(count, np.int32), ctypes.c_longlong(0)
    runs = _Runs(
        count,
        ctypes.pointer(queue),
        len(given),
        len(outputs),
        library.numbers(list(given)),
        library.numbers(outputs),
        table.ctypes.data_as(_DOUBLES),
        0.0,
        stop,
        result.ctypes.data_as(_DOUBLES),
        time.ctypes.data_as(_DOUBLES),
        status.ctypes.data_as(_INTS),
    )
    _in_threads(library, min(threads or os.cpu_count() or 1, count), runs, queue)
    failed = np.flatnonzero(status > DISCARD)
    failures = {int(row): _sentence(library, dict(zip(given, table[row], strict=True)), stop) for row in failed}
    return Ends({name: result[:, i] for i, name in enumerate(outputs)}, time, status == DISCARD, failures)


def _sentence(library: Library, values: Mapping[str, float], stop: float) -> str:
    """What a run says that failed: it fails alone as it did in its lane."""
    try:
        kernel = Kernel(library, **values)
        kernel.initialise()
        kernel.step(0.0, stop)
    except KernelError as error:
        return str(error)
    return "These values choose another system than the batch runs."


class Instances:
    """Many instances that go on in steps, as a controller asks them to.

    >>> instances = Instances(library, 1000, ["brake_torque_1"], ["speed"], initial_speed=speeds)
    >>> speed = instances.step(5e-3, torque)["speed"]      # arrays of 1000 each
    """

    def __init__(
        self,
        library: BatchLibrary,
        count: int,
        inputs: Sequence[str],
        outputs: Sequence[str],
        *,
        threads: int | None = None,
        **values: ArrayLike,
    ) -> None:
        self._library, self._threads = library, threads or os.cpu_count() or 1
        given = {name: np.broadcast_to(np.asarray(value, float), count) for name, value in values.items()}
        self._kernels = [Kernel(library) for _ in range(count)]
        for number, kernel in enumerate(self._kernels):
            kernel.set(**{name: float(one[number]) for name, one in given.items()})
            kernel.initialise()
        self._handles = (ctypes.c_void_p * count)(*(kernel.handle for kernel in self._kernels))
        self.inputs, self.outputs = list(inputs), list(outputs)
        self._input, self._output = library.numbers(inputs), library.numbers(outputs)
        self._given, self._found = np.zeros((count, len(inputs))), np.zeros((count, len(outputs)))
        self._status = np.zeros(count, np.int32)
        self._pool = ThreadPoolExecutor(self._threads)
        groups = [library.functions.batch_create() for _ in range(-(-count // library.lanes))]
        self._groups = (ctypes.c_void_p * len(groups))(*groups)

    def close(self) -> None:
        """Gives threads and memory back."""
        self._pool.shutdown()
        for group in self._groups:
            self._library.functions.batch_free(group)
        self._groups = (ctypes.c_void_p * 0)()

    def step(self, size: float, inputs: Mapping[str, ArrayLike] | None = None) -> dict[str, Numbers]:
        """A step of `size` seconds; outputs at its end. Inputs that are not given stay as they are.

        The arrays are those of every step: copy what is to be kept. Raises KernelError where a run fails or has ended.
        """
        for name, value in (inputs or {}).items():
            self._given[:, self.inputs.index(name)] = value
        count = len(self._kernels)
        width = self._library.lanes
        share = -(-count // (self._threads * width)) * width
        done = [
            self._pool.submit(self._step_some, first, min(first + share, count), size)
            for first in range(0, count, share)
        ]
        for one in done:
            one.result()
        failed = np.flatnonzero(self._status > WARNING)
        if failed.size:
            message = self._library.functions.kernel_message(self._handles[failed[0]]).decode()
            raise KernelError(f"Run {failed[0]} of {count}: {message}", int(self._status[failed[0]]))
        return {name: self._found[:, number] for number, name in enumerate(self.outputs)}

    def _step_some(self, first: int, end: int, size: float) -> None:
        steps = _Steps(
            end - first,
            _from(self._handles, first),
            len(self.inputs),
            len(self.outputs),
            self._input,
            self._output,
            self._given[first:].ctypes.data_as(_DOUBLES),
            size,
            self._found[first:].ctypes.data_as(_DOUBLES),
            self._status[first:].ctypes.data_as(_INTS),
        )
        self._library.functions.batch_step(_from(self._groups, first // self._library.lanes), steps)


def _from(handles: ctypes.Array[ctypes.c_void_p], first: int) -> ctypes._Pointer[ctypes.c_void_p]:
    """The handles from one on."""
    there = ctypes.byref(handles, first * ctypes.sizeof(ctypes.c_void_p))
    return ctypes.cast(there, ctypes.POINTER(ctypes.c_void_p))

"""Many runs of one model at once, in vector lanes and threads: arrays in, arrays out.

Each run is bit-identical to the same run alone, for any order, number of threads and width of the lanes.
"""

from __future__ import annotations

import ctypes
import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fmu_src.codegen import generate, guid_of
from fmu_src.compile import library_of
from fmu_src.elimination import elimination, elimination_in_lanes
from fmu_src.equations import functions, table_ranks
from fmu_src.equations_in_c import HEAD, functions_in_lanes
from fmu_src.kernel import DISCARD, ERROR, Kernel, Library, SimulationError
from fmu_src.progress import counting
from fmu_src.refusals import without_value_before
from fmu_src.suggestion import suggestion
from fmu_src.system import Model, System
from readers.renamed import FormerNames

#: Time between two readings of the progress of runs [s].
GLANCE = 0.1
NO_MEMORY = "There is not enough memory for a batch; use fewer threads or instances."
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
        ("files", ctypes.c_int),
        ("file", _INTS),
        ("path", ctypes.POINTER(ctypes.c_char_p)),
        ("start", ctypes.c_double),
        ("stop", ctypes.c_double),
        ("result", _DOUBLES),
        ("end", _DOUBLES),
        ("status", _INTS),
        ("messages", ctypes.POINTER(ctypes.c_void_p)),
        ("all_messages", ctypes.c_bool),
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
    "batch_create": (ctypes.c_void_p, [ctypes.c_void_p]),
    "batch_free": (None, [ctypes.c_void_p]),
    "batch_lanes": (ctypes.c_int, []),
    "batch_run": (ctypes.c_bool, [ctypes.c_void_p, ctypes.POINTER(_Runs)]),
    "batch_free_message": (None, [ctypes.c_void_p]),
    "batch_forget": (None, [ctypes.c_void_p]),
    "batch_step": (None, [ctypes.POINTER(ctypes.c_void_p), ctypes.POINTER(_Steps)]),
    "batch_read_outputs": (None, [ctypes.POINTER(_Steps)]),
    "batch_control": (
        None,
        [
            ctypes.POINTER(ctypes.c_void_p),
            ctypes.POINTER(_Steps),
            ctypes.c_longlong,
            ctypes.c_void_p,
            ctypes.c_void_p,
            ctypes.c_longlong,
        ],
    ),
}


@dataclass(frozen=True)
class Ends(FormerNames):
    """Results of a batch, an entry for each run in arrays of shape (runs,).

    Attributes
    ----------
    outputs : dict of str to ndarray
        Final values by name, in their units.
    time : ndarray
        Time at which the run ended [s].
    ended : ndarray of bool
        True if the run ended by itself before the stop, such as by a derailment.
    failures : dict of int to str
        Messages of failed runs by the number of the run; their numbers are NaN.
    messages : list of str or None
        Messages of each run, if `all_messages` was set.
    """

    outputs: dict[str, Numbers]
    time: Numbers
    ended: NDArray[np.bool_]
    failures: dict[int, str]
    messages: list[str] | None = None

    def __getitem__(self, name: str) -> Numbers:
        """Return an output by its name. Raises KeyError."""
        if name not in self.outputs:
            raise KeyError(f"The batch has no output {name}; {suggestion(name, self.outputs)}")
        return self.outputs[name]


#: Type of a function that returns the path of a file by its name; it calls the given function only to make the file.
Kept = Callable[[str, Callable[[], Path]], Path]


def made_now(what: str, make: Callable[[], Path]) -> Path:
    """Make the file; it is not known beforehand."""
    return make()


#: Functions of a system in the order of `batch_functions` in batch.h.
FUNCTIONS = ("ode", "jacobian", "output", "drive", "capacity", "condition_margin", "largest_change")


def batch_source(model: Model, system: System) -> dict[str, str]:
    """Return the C file, by its name, of a system of a model in BATCH_LANES lanes."""
    every, name = functions(system), system.name
    ranks = [f"table_argument_{rank}" for rank in range(table_ranks(system))]
    made = {one: every[one] for one in (*FUNCTIONS, *ranks) if one in every}
    given, texts = functions_in_lanes(name, made)
    texts += elimination_in_lanes(name, elimination(system))
    in_lanes = [
        f"LANES_NAME({name}_{every[function].function.name()})" if function in every else "0" for function in FUNCTIONS
    ]
    arguments = [f"LANES_NAME({name}_{every[one].function.name()})" for one in ranks]
    tables = f"static const lanes_function ARGUMENT[] = {{{', '.join(arguments)}}};" if ranks else ""
    solving = [f"LANES_NAME({name}_factorise)", f"LANES_NAME({name}_substitute)"]
    fields = ["LANES", str(model.systems.index(system)), *in_lanes, "ARGUMENT" if ranks else "0", *solving]
    described = [tables, f"const batch_functions BATCH = {{{', '.join(fields)}}};"]
    lanes = ["#define LANES BATCH_LANES", '#include "lanes.h"', *texts, *described, '#include "lanes_end.h"', ""]
    return {f"batch_{name}.c": "\n".join([*HEAD, '#include "batch_lanes.h"', *given, *lanes])}


class BatchLibrary(Library):
    """One system of a model in lanes, compiled; model: its table of variables, with or without equations."""

    def __init__(self, path: Path, model: Model) -> None:
        super().__init__(path)
        for name, (result, arguments) in _SIGNATURES.items():
            function = getattr(self.functions, name)
            function.restype, function.argtypes = result, arguments
        self.lanes, self.model = int(self.functions.batch_lanes()), model
        self.identity = ""
        self.file = model.table_file.variable.name if model.table_file else None

    def parted(
        self, values: Mapping[str, ArrayLike | str], path: str | None
    ) -> tuple[dict[str, ArrayLike], dict[str, str]]:
        """Return the numbers among values, and the paths of files by the variables that name them.

        path: of the table file, if the library has one.
        """
        files = {name: value for name, value in values.items() if isinstance(value, str)}
        numbers = {name: value for name, value in values.items() if name not in files}
        return numbers, ({self.file: path} if path and self.file else {}) | files

    def numbers(self, names: Sequence[str]) -> ctypes.Array[ctypes.c_int]:
        """Return the numbers of variables. Raises SimulationError for an unknown name."""
        kernel = Kernel(self)
        return (ctypes.c_int * len(names))(*(kernel.number_of(name) for name in names))


def most_lanes(kernel: Path) -> int:
    """Return the most lanes of this processor, 2, 4 or 8, by any compiled kernel."""
    return max(2, Kernel(Library(kernel)).use_lanes(8))


def compiled_batch(model: Model, system: System, lanes: int = 0, kept: Kept = made_now) -> BatchLibrary:
    """Return the library of a system; lanes: 2, 4 or 8, or 0 for the most that the processor has."""
    sources = cache(lambda: generate(model))
    most = most_lanes(kept("kernel", lambda: library_of(sources())))
    own = lanes or most
    if own not in (2, 4, 8) or own > most:
        raise ValueError(f"lanes must be 2, 4 or 8, at most {most} on this processor, or 0 for the most; got {lanes}.")
    words = f"{own} lanes of {system.name}"
    made = kept(words, lambda: library_of(sources() | batch_source(model, system), lanes=own))
    found = BatchLibrary(made, model)
    found.identity = guid_of(sources()) if kept is made_now else ""
    return found


def lane_sources(model: Model, system: System) -> dict[str, str]:
    """Return the C files of a model with one of its systems in lanes, by name."""
    return generate(model) | batch_source(model, system)


@lru_cache(maxsize=16)
def library_of_batch(model: Model, system: str) -> BatchLibrary:
    """Return the library of the system of this name, loaded once."""
    return compiled_batch(model, next(one for one in model.systems if one.name == system))


def _in_threads(library: BatchLibrary, count: int, runs: _Runs, queue: ctypes.c_longlong) -> None:
    """Make the runs in `count` threads, each with its own lanes, and show the number of runs begun."""
    call = library.functions
    every = [call.batch_create(None) for _ in range(count)]
    try:
        if not all(every):
            raise MemoryError(NO_MEMORY)
        with (
            ThreadPoolExecutor(count) as pool,
            counting(text="runs", total=runs.count, unit="run") as bar,
        ):
            waiting = {pool.submit(call.batch_run, lanes, runs) for lanes in every}
            try:
                while waiting:
                    done, waiting = wait(waiting, timeout=GLANCE)
                    if not all(one.result() for one in done):
                        raise MemoryError(NO_MEMORY)
                    bar.update(min(queue.value, runs.count) - bar.n)
            except BaseException:  # no thread begins another run
                queue.value = runs.count
                raise
    finally:
        for lanes in every:
            call.batch_free(lanes)


def table_of(values: Mapping[str, ArrayLike]) -> Numbers:
    """Return a row of values for each run, shape (runs, values). Raises ValueError if arrays differ in length."""
    given = {name: np.asarray(value, float) for name, value in values.items()}
    count = next((one.size for one in given.values() if one.ndim), 1)
    for name, one in given.items():
        if one.ndim and one.shape != (count,):
            raise ValueError(
                f"{name} must be one number, or {count} of them as others are; got an array of shape {one.shape}."
            )
    table = np.empty((count, len(given)))
    for column, one in enumerate(given.values()):
        table[:, column] = one
    return table


def run_batch(
    library: BatchLibrary,
    values: Mapping[str, ArrayLike],
    stop: float,
    outputs: Sequence[str],
    threads: int | None = None,
    path: str | None = None,
    all_messages: bool = False,
) -> Ends:
    """Run each set of values from 0 to `stop` seconds, or until the run ends by itself.

    Takes values (runs,), stop [s].
    """
    values, named = library.parted(values, path)
    table = table_of(values)
    count = len(table)
    result, time = np.empty((count, len(outputs))), np.empty(count)
    status, queue, messages = np.zeros(count, np.int32), ctypes.c_longlong(0), (ctypes.c_void_p * count)()
    runs = _Runs(
        count,
        ctypes.pointer(queue),
        len(values),
        len(outputs),
        library.numbers(list(values)),
        library.numbers(outputs),
        table.ctypes.data_as(_DOUBLES),
        len(named),
        library.numbers(list(named)),
        (ctypes.c_char_p * len(named))(*map(os.fsencode, named.values())),
        0.0,
        stop,
        result.ctypes.data_as(_DOUBLES),
        time.ctypes.data_as(_DOUBLES),
        status.ctypes.data_as(_INTS),
        messages,
        all_messages,
    )
    try:
        if count:
            _in_threads(library, min(threads or os.cpu_count() or 1, count), runs, queue)
        found = {name: result[:, i] for i, name in enumerate(outputs)}
        failures = {
            row: without_value_before(_text(messages[row])) for row in np.flatnonzero(status > DISCARD).tolist()
        }
        kept = [failures.get(row, _text(one)) for row, one in enumerate(messages)] if all_messages else None
    finally:
        for one in filter(None, messages):
            library.functions.batch_free_message(one)
    return Ends(found, time, status == DISCARD, failures, kept)


def _text(place: int | None) -> str:
    return ctypes.string_at(place).decode() if place else ""


class Instances:
    """Many instances that advance in steps together, for controllers that are functions of arrays.

    `step` returns the same arrays each time, filled with new values: copy those that you keep. A run that ends by
    itself, such as by a derailment, stays where it ended. `ended` marks such runs, and `reset` begins rows again.
    Threads and memory are held until `close`, or the end of a `with` block.

    >>> with Instances(library, 1000, ["brake_torque_1"], ["speed"], initial_speed=speeds) as instances:
    ...     speed = instances.step(5e-3, {"brake_torque_1": torque})["speed"]  # arrays of 1000 each
    """

    def __init__(
        self,
        library: BatchLibrary,
        count: int,
        inputs: Sequence[str],
        outputs: Sequence[str],
        *,
        threads: int | None = None,
        path: str | None = None,
        **values: ArrayLike,
    ) -> None:
        """Initialise all instances at 0 s.

        Parameters
        ----------
        library : BatchLibrary
            The compiled system.
        count : int
            Number of instances.
        inputs, outputs : sequence of str
            Names of the variables that are set and returned at every step.
        threads : int or None
            Number of threads; None: the number of processors.
        path : str or None
            Table file of all instances.
        **values : float or array_like
            Parameters and first inputs, one for all or an array of shape (count,). A file has one path for all.

        Raises
        ------
        SimulationError
            If a name is unknown or a value is refused.
        ValueError
            If an array has another length.
        """
        self._library, self._threads = library, threads or os.cpu_count() or 1
        values, self._files = library.parted(values, path)
        self.at_close: Callable[[], None] | None = None
        self._start = {name: _for_each(name, value, count) for name, value in values.items()}
        self._kernels = [Kernel(library) for _ in range(count)]
        self._handles = (ctypes.c_void_p * count)(*(kernel.handle for kernel in self._kernels))
        self.inputs, self.outputs = list(inputs), list(outputs)
        self._input, self._output = library.numbers(inputs), library.numbers(outputs)
        self._given, self._found = np.zeros((count, len(inputs))), np.zeros((count, len(outputs)))
        self._status = np.zeros(count, np.int32)
        self._groups: ctypes.Array[ctypes.c_void_p] = (ctypes.c_void_p * 0)()
        for row in range(count):
            self._begin(row, {})
        groups = [group for first, end in self._shares() for group in self._beside_each_other(end - first)]
        self._groups = (ctypes.c_void_p * len(groups))(*groups)
        self._pool = ThreadPoolExecutor(max(self._threads - 1, 1))
        if not all(groups):
            self.close()
            raise MemoryError(NO_MEMORY)

    def __len__(self) -> int:
        return len(self._kernels)

    def __enter__(self) -> Instances:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Free threads and memory."""
        self._pool.shutdown()
        for group in self._groups:
            self._library.functions.batch_free(group)
        self._groups, self._handles, self._kernels = (ctypes.c_void_p * 0)(), (ctypes.c_void_p * 0)(), []
        if self.at_close:
            self.at_close()

    @property
    def ended(self) -> NDArray[np.bool_]:
        """Return whether each instance has ended by itself, shape (count,)."""
        return np.array([kernel.ended for kernel in self._kernels], bool)

    @property
    def time(self) -> Numbers:
        """Return the time of each instance [s], shape (count,)."""
        return np.array([kernel.time for kernel in self._kernels])

    def reset(self, rows: int | Sequence[int] | NDArray[np.integer], **values: ArrayLike) -> None:
        """Begin rows again at 0 s, with the initial values except for those given here.

        Parameters
        ----------
        rows : int or array of int
            Numbers of the instances.
        **values : float or array_like
            A number for all of these rows, or one for each.

        Raises
        ------
        SimulationError
            If a value is refused.
        """
        those = np.atleast_1d(np.asarray(rows, int))
        given = {name: _for_each(name, value, those.size) for name, value in values.items()}
        for number, row in enumerate(those):
            self._begin(int(row), {name: float(one[number]) for name, one in given.items()})
            self._library.functions.batch_forget(self._groups[row // self._library.lanes])

    def _begin(self, row: int, values: Mapping[str, float]) -> None:
        kernel, given = self._kernels[row], {name: float(one[row]) for name, one in self._start.items()}
        kernel.reset()
        try:
            kernel.set(**self._files)
            kernel.set(**(given | dict(values)))
            kernel.initialise()
        except SimulationError as error:
            raise SimulationError(f"Instance {row} of {len(self)}: {error}", error.status) from None
        kernel.messages.clear()
        self._given[row] = [kernel[name] for name in self.inputs]

    def step(self, size: float, inputs: Mapping[str, ArrayLike] | None = None) -> dict[str, Numbers]:
        """Make a step of `size` seconds and return the outputs at its end, in the same arrays at every step.

        Parameters
        ----------
        size : float
            Size of the step [s].
        inputs : mapping of str to array_like
            New values of inputs; all others are unchanged.

        Returns
        -------
        dict of str to ndarray
            Outputs by name, shape (count,).

        Raises
        ------
        SimulationError
            If a step fails. All other instances have made theirs; the failed one stays where it was.
        """
        for name, value in (inputs or {}).items():
            if name not in self.inputs:
                raise SimulationError(f"No input {name} was named; {suggestion(name, self.inputs)}", ERROR)
            self._given[:, self.inputs.index(name)] = _one_or_each(name, value, len(self))
        self.go_on(size)
        failed = np.flatnonzero(self._status > DISCARD)
        if failed.size:
            message = self.message(int(failed[0]))
            raise SimulationError(f"Instance {failed[0]} of {len(self)}: {message}", int(self._status[failed[0]]))
        return {name: self._found[:, number] for number, name in enumerate(self.outputs)}

    def go_on(self, size: float) -> None:
        """Make a step with `input_values`. `status` is above 1 from then on if an instance ended or failed."""
        call = self._library.functions.batch_step
        self._in_shares(lambda first, end: call(self._groups_from(first), self._steps(first, end, size)))

    def read_outputs(self, first: int, end: int) -> None:
        """Read all present outputs of the instances from `first` up to `end` into `output_values`."""
        self._library.functions.batch_read_outputs(self._steps(first, end, 0.0))

    @property
    def output_values(self) -> Numbers:
        """Return the outputs, shape (count, outputs), the same array at every step."""
        return self._found

    @property
    def input_values(self) -> Numbers:
        """Return the inputs of the next step, shape (count, inputs); to be changed in place."""
        return self._given

    @property
    def status(self) -> NDArray[np.int32]:
        """Return the status of the last step, shape (count,)."""
        return self._status

    def control(self, size: float, steps: int, between: Any, context: int) -> None:
        """Make `steps` steps of `size` seconds, each after a call of `between` in C, `batch_between` in batch.h.

        It ends early if no instance continues. A failed instance stays where it was; `between` receives its status.
        """
        call, pointer = self._library.functions, ctypes.cast(between, ctypes.c_void_p)

        def control_some(first: int, end: int) -> None:
            call.batch_control(self._groups_from(first), self._steps(first, end, size), steps, pointer, context, first)

        self._in_shares(control_some)

    def message(self, row: int) -> str:
        """Return the last message of an instance."""
        return str(self._library.functions.kernel_message(self._handles[row]).decode())

    def _in_shares(self, work: Callable[[int, int], None]) -> None:
        """Do the work for all instances, shared among the threads by whole groups."""
        shares = self._shares()
        done = [self._pool.submit(work, *share) for share in shares[1:]]
        work(*shares[0])  # waking a thread takes as long as hundreds of steps
        for one in done:
            one.result()

    def _shares(self) -> list[tuple[int, int]]:
        """Return the first and last row of each thread."""
        count, width = len(self), self._library.lanes
        share = max(1, -(-count // (self._threads * width))) * width
        return [(first, min(first + share, count)) for first in range(0, count, share)]

    def _beside_each_other(self, count: int) -> list[int | None]:
        """Return the groups of `count` instances of one thread; None for a group without memory."""
        create, groups = self._library.functions.batch_create, -(-count // self._library.lanes)
        first = create(None)
        return [first, *(create(first) for _ in range(groups - 1))]

    def _groups_from(self, first: int) -> ctypes._Pointer[ctypes.c_void_p]:
        """Return the groups from the one of an instance on."""
        return _from(self._groups, first // self._library.lanes)

    def _steps(self, first: int, end: int, size: float) -> _Steps:
        return _Steps(
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


def _from(handles: ctypes.Array[ctypes.c_void_p], first: int) -> ctypes._Pointer[ctypes.c_void_p]:
    """Return the handles from number `first` on."""
    there = ctypes.byref(handles, first * ctypes.sizeof(ctypes.c_void_p))
    return ctypes.cast(there, ctypes.POINTER(ctypes.c_void_p))


def _for_each(name: str, value: ArrayLike, count: int) -> Numbers:
    """Return an array of shape (count,). Raises ValueError."""
    return np.broadcast_to(_one_or_each(name, value, count), count).copy()


def _one_or_each(name: str, value: ArrayLike, count: int) -> Numbers:
    """Return one number for all, or an array of shape (count,). Raises ValueError."""
    given = np.asarray(value, float)
    if np.ma.is_masked(value):
        raise ValueError(f"{name} must be numbers that are not masked; got {value!r}. Fill in the masked ones.")
    if given.shape not in ((), (count,)):
        raise ValueError(f"{name} must be one number, or {count} of them; got an array of shape {given.shape}.")
    return given

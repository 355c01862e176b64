"""A compiled kernel seen from Python. Standard library only: this file also travels inside the pythonfmu FMU."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

OK, WARNING, DISCARD, ERROR = range(4)
#: The most numbers that a record holds.
MOST_NUMBERS = 1e8
#: The most names that a message lists, as in suggestion.py.
MOST_NAMES = 12
COUNTERS = ("right_hand_sides", "jacobians", "factorisations", "steps", "rejected", "events")


class _Sentence(ctypes.Structure):
    """A record of the kernel's message log, `kernel_sentence` in status.h."""

    _fields_ = (("status", ctypes.c_int), ("text", ctypes.c_char_p))


_SIGNATURES = {
    "kernel_create": (ctypes.c_void_p, []),
    "kernel_free": (None, [ctypes.c_void_p]),
    "kernel_reset": (None, [ctypes.c_void_p]),
    "kernel_reopen": (None, [ctypes.c_void_p]),
    "kernel_set": (ctypes.c_int, [ctypes.c_void_p, ctypes.c_int, ctypes.c_double]),
    "kernel_set_rate": (ctypes.c_int, [ctypes.c_void_p, ctypes.c_int, ctypes.c_double]),
    "kernel_get": (ctypes.c_int, [ctypes.c_void_p, ctypes.c_int, ctypes.POINTER(ctypes.c_double)]),
    "kernel_plan": (
        ctypes.c_int,
        [ctypes.c_void_p, ctypes.POINTER(ctypes.c_double), ctypes.c_double, ctypes.POINTER(ctypes.c_double)],
    ),
    "kernel_set_text": (ctypes.c_int, [ctypes.c_void_p, ctypes.c_int, ctypes.c_char_p]),
    "kernel_get_text": (ctypes.c_int, [ctypes.c_void_p, ctypes.c_int, ctypes.POINTER(ctypes.c_char_p)]),
    "kernel_initialise": (ctypes.c_int, [ctypes.c_void_p, ctypes.c_double]),
    "kernel_step": (ctypes.c_int, [ctypes.c_void_p, ctypes.c_double, ctypes.c_double]),
    "kernel_record": (
        ctypes.c_int,
        [
            ctypes.c_void_p,
            ctypes.c_double,
            ctypes.c_double,
            ctypes.c_double,
            ctypes.c_int,
            ctypes.POINTER(ctypes.c_int),
            ctypes.POINTER(ctypes.c_double),
            ctypes.c_longlong,
        ],
    ),
    "kernel_state_size": (ctypes.c_size_t, [ctypes.c_void_p]),
    "kernel_state_count": (ctypes.c_int, [ctypes.c_void_p]),
    "kernel_save": (None, [ctypes.c_void_p, ctypes.c_char_p]),
    "kernel_restore": (ctypes.c_int, [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_size_t]),
    "kernel_time": (ctypes.c_double, [ctypes.c_void_p]),
    "kernel_ended": (ctypes.c_bool, [ctypes.c_void_p]),
    "kernel_message": (ctypes.c_char_p, [ctypes.c_void_p]),
    "kernel_hear": (ctypes.c_bool, [ctypes.c_void_p, ctypes.POINTER(_Sentence)]),
    "kernel_counts": (None, [ctypes.c_void_p, ctypes.POINTER(ctypes.c_longlong)]),
    "kernel_linearise": (
        ctypes.c_int,
        [ctypes.c_void_p, *[ctypes.POINTER(ctypes.c_double)] * 3],
    ),
    "kernel_get_rates": (
        ctypes.c_int,
        [ctypes.c_void_p, ctypes.c_int, ctypes.POINTER(ctypes.c_int), ctypes.POINTER(ctypes.c_double)],
    ),
    "kernel_get_directional": (
        ctypes.c_int,
        [
            ctypes.c_void_p,
            *[ctypes.c_int, ctypes.POINTER(ctypes.c_int)] * 2,
            *[ctypes.POINTER(ctypes.c_double)] * 2,
        ],
    ),
    "kernel_slopes_at": (
        ctypes.c_int,
        [ctypes.c_void_p, ctypes.c_double, *[ctypes.POINTER(ctypes.c_double)] * 3],
    ),
    "kernel_margin_at": (ctypes.c_int, [ctypes.c_void_p, ctypes.c_double, *[ctypes.POINTER(ctypes.c_double)] * 2]),
    "kernel_equations_at": (
        ctypes.c_int,
        [ctypes.c_void_p, ctypes.c_double, *[ctypes.POINTER(ctypes.c_double)] * 3],
    ),
    "kernel_arrive": (
        ctypes.c_int,
        [ctypes.c_void_p, ctypes.c_double, ctypes.POINTER(ctypes.c_double), ctypes.c_bool],
    ),
    "kernel_use_lanes": (ctypes.c_int, [ctypes.c_void_p, ctypes.c_int]),
    "kernel_variable_count": (ctypes.c_int, []),
    "kernel_variable_name": (ctypes.c_char_p, [ctypes.c_int]),
    "kernel_repeat_right_hand_side": (ctypes.c_int, [ctypes.c_void_p, ctypes.c_longlong]),
    "kernel_repeat_jacobian": (ctypes.c_int, [ctypes.c_void_p, ctypes.c_longlong]),
    "kernel_repeat_step": (ctypes.c_int, [ctypes.c_void_p, ctypes.c_double, ctypes.c_double, ctypes.c_longlong]),
}


class SimulationError(Exception):
    """A refused value or a failed step; `status` is 2 (discard: the run ended) or 3 (error)."""

    def __init__(self, sentence: str, status: int) -> None:
        super().__init__(sentence)
        self.status = status


class Library:
    """A compiled model: names of the variables, and the C functions with their signatures.

    Parameters
    ----------
    path : str or Path
        The shared library.

    Raises
    ------
    SimulationError
        If it cannot be loaded.
    """

    def __init__(self, path: str | Path) -> None:
        try:
            self.functions = ctypes.CDLL(str(path))
        except OSError as error:
            words = f"Cannot load {path}: {error}. Put it on a disk from which programs may run."
            raise SimulationError(words, ERROR) from error
        for name, (result, arguments) in _SIGNATURES.items():
            function = getattr(self.functions, name)
            function.restype, function.argtypes = result, arguments
        count = self.functions.kernel_variable_count()
        self.names = [self.functions.kernel_variable_name(i).decode() for i in range(count)]
        self.index = {name: number for number, name in enumerate(self.names)}


@dataclass(frozen=True)
class Linearisation:
    """State, right-hand side (residuals for algebraic states) and Jacobian by rows, in the order of the states."""

    state: list[float]
    slope: list[float]
    jacobian: list[list[float]]


class Kernel:
    """One instance of a compiled model.

    Parameters
    ----------
    library : Library
        The model.
    **values : float or str
        Parameters and first inputs by name, in their units.

    Raises
    ------
    SimulationError
        If a value is refused.
    MemoryError
        If there is not enough memory.

    Examples
    --------
    >>> kernel = Kernel(library, mass=10.0, force=1.0)
    >>> kernel.advance(1.0)  # seconds
    >>> kernel["velocity"]
    """

    def __init__(self, library: Library, **values: float | str) -> None:
        self.library = library
        self._call = library.functions
        self._handle = self._call.kernel_create()
        self._number, self._heard = ctypes.c_double(), _Sentence()
        self.messages: list[str] = []
        if not self._handle:
            raise MemoryError("There is not enough memory for a kernel.")
        self.set(**values)

    def __del__(self) -> None:
        if getattr(self, "_handle", None):
            self._call.kernel_free(self._handle)
            self._handle = None

    @property
    def journal(self) -> NoReturn:
        """Refuse the former name of `messages`. Raises AttributeError."""
        raise AttributeError("Kernel has no attribute journal; its name is messages now.")

    def set(self, **values: float | str) -> None:
        """Set parameters (before the first step) or inputs, by name, in their units."""
        for name, value in values.items():
            if isinstance(value, str):
                self.set_text(self.number_of(name), value)
            else:
                self.set_number(self.number_of(name), value)

    def set_number(self, variable: int, value: float) -> None:
        """Set one variable as `set` does, by its number in `Library.names`."""
        self._check(self._call.kernel_set(self._handle, variable, value))

    def set_text(self, variable: int, text: str) -> None:
        """Set one string variable as `set` does, by its number in `Library.names`."""
        self._check(self._call.kernel_set_text(self._handle, variable, os.fsencode(text)))

    def get_text(self, variable: int) -> str:
        """Return the text of a variable by its number in `Library.names`. Raises SimulationError."""
        found = ctypes.c_char_p()
        self._check(self._call.kernel_get_text(self._handle, variable, ctypes.byref(found)))
        return os.fsdecode(found.value or b"")

    def set_rate(self, **rates: float) -> None:
        """Set rates of change of inputs for the next step, so that steps become ramps."""
        for name, rate in rates.items():
            self._check(self._call.kernel_set_rate(self._handle, self.number_of(name), rate))

    def __getitem__(self, name: str) -> float:
        return self.get_number(self.number_of(name))

    def get_number(self, variable: int) -> float:
        """Return the value of a variable by its number."""
        self._check(self._call.kernel_get(self._handle, variable, ctypes.byref(self._number)))
        return self._number.value

    @property
    def time(self) -> float:
        """Return the present time of the run [s]."""
        return float(self._call.kernel_time(self._handle))

    @property
    def initialised(self) -> bool:
        """Return whether `initialise` has been called since the last `reset` or `reopen`."""
        return bool(self._call.kernel_state_count(self._handle))

    @property
    def ended(self) -> bool:
        """Return whether a condition of the model has ended the run; no step goes further."""
        return self._call.kernel_ended(self._handle)

    def use_lanes(self, most: int) -> int:
        """Set how many wheels equations compute at once, at most 1, 2, 4 or 8; return how many the processor allows.

        Results are bit-identical for any number.
        """
        return int(self._call.kernel_use_lanes(self._handle, most))

    def plan(self, start: float, stop: float | None = None, tolerance: float | None = None) -> None:
        """Set the stop time and the tolerance before initialisation.

        Takes start [s], stop [s].
        """
        asked, end = (None if value is None else ctypes.byref(ctypes.c_double(value)) for value in (tolerance, stop))
        self._check(self._call.kernel_plan(self._handle, asked, start, end))

    def initialise(self, time: float = 0.0) -> None:
        """Compute the state at the start; parameters are fixed from then on.

        Takes time [s].
        """
        self._check(self._call.kernel_initialise(self._handle, time))

    def reset(self) -> None:
        """Set all variables to their start values; parameters may be set again."""
        self._call.kernel_reset(self._handle)

    def reopen(self) -> None:
        """Go back to before initialisation, all values kept."""
        self._call.kernel_reopen(self._handle)

    def step(self, time: float, size: float) -> None:
        """Advance by one step.

        Takes time [s], size [s].
        """
        self._check(self._call.kernel_step(self._handle, time, size))

    def advance(self, size: float) -> None:
        """Advance from the present time; initialise if needed.

        Takes size [s].
        """
        if not self.initialised:
            self.initialise()
        self.step(self.time, size)

    def record(self, size: float, interval: float, names: Sequence[str]) -> dict[str, list[float]]:
        """Advance and return the named variables at equal intervals as `record_rows`, by name, `time` included."""
        if not self.initialised:
            self.initialise()
        start, rows = self.time, self.record_rows(size, interval, names)
        times = [start + row * interval for row in range(len(rows))]
        return {"time": times} | {name: rows[:, column].tolist() for column, name in enumerate(names)}

    def record_rows(self, size: float, interval: float, names: Sequence[str]) -> NDArray[np.float64]:
        """Advance and return the named variables at equal intervals, shape (rows, names).

        Recording uses the continuous extension of the method and does not shorten its steps. If a run ends early, the
        rows before its end are returned.

        Takes size [s], interval [s].
        """
        import numpy as np  # not in pythonfmu FMUs, which have this file

        if not self.initialised:
            self.initialise()
        if not (interval > 0.0 and size / interval * (1 + len(names)) <= MOST_NUMBERS):
            raise SimulationError(
                f"The interval must be above 0 s and give at most {MOST_NUMBERS:g} numbers; got {interval:g} s over "
                f"{size:g} s. Record at longer intervals.",
                ERROR,
            )
        start, rows, columns = self.time, int(size / interval + 1e-9) + 1, len(names)
        numbers = self._numbers(names)
        buffer = (ctypes.c_double * (rows * columns))()
        status = self._call.kernel_record(self._handle, start, size, interval, columns, numbers, buffer, rows)
        if status == ERROR:
            self._check(status)
        self.hear()
        table = np.frombuffer(memoryview(buffer), float).reshape(rows, columns)
        first = table[:, 0]
        return table[: int(np.argmax(np.isnan(first)))] if np.isnan(first[-1]) else table

    def save(self) -> bytes:
        """Return the complete state bit for bit, sealed: changed bytes are refused."""
        buffer = ctypes.create_string_buffer(self._call.kernel_state_size(self._handle))
        self._call.kernel_save(self._handle, buffer)
        return buffer.raw

    def restore(self, state: bytes) -> None:
        """Restore a state from `save` of the same model."""
        self._check(self._call.kernel_restore(self._handle, state, len(state)))

    @property
    def counts(self) -> dict[str, int]:
        """Return the work done since the last reset."""
        numbers = (ctypes.c_longlong * len(COUNTERS))()
        self._call.kernel_counts(self._handle, numbers)
        return dict(zip(COUNTERS, numbers, strict=True))

    def linearise(self) -> Linearisation:
        """Return the linearised equations at the present state."""
        count = self._call.kernel_state_count(self._handle)
        state, slope, jacobian = ((ctypes.c_double * size)() for size in (count, count, count * count))
        self._check(self._call.kernel_linearise(self._handle, state, slope, jacobian))
        rows = [jacobian[row * count : (row + 1) * count] for row in range(count)]
        return Linearisation(list(state), list(slope), rows)

    def slopes_at(self, time: float, place: Sequence[float]) -> list[float]:
        """Return the slopes of the differential states at a time and place, the algebraic ones solved for.

        It is for other methods, which start at the present state: inputs continue along their ramps, modes stay. See
        `margin_at` and `arrive`.

        Takes time [s].
        """
        count = len(place)
        given, slope = (ctypes.c_double * count)(*place), (ctypes.c_double * count)()
        self._check(self._call.kernel_slopes_at(self._handle, time, given, slope, None))
        return list(slope)

    def jacobian_at(self, time: float, place: Sequence[float]) -> list[list[float]]:
        """Return the exact derivatives of `slopes_at` by `place`.

        Takes time [s].
        """
        count = len(place)
        given, slope = (ctypes.c_double * count)(*place), (ctypes.c_double * count)()
        jacobian = (ctypes.c_double * (count * count))()
        self._check(self._call.kernel_slopes_at(self._handle, time, given, slope, jacobian))
        return [jacobian[row * count : (row + 1) * count] for row in range(count)]

    def margin_at(self, time: float, place: Sequence[float]) -> float:
        """Return the margin of the next switch of a mode, or of the end of the run.

        Takes time [s].
        """
        given = (ctypes.c_double * len(place))(*place)
        self._check(self._call.kernel_margin_at(self._handle, time, given, ctypes.byref(self._number)))
        return self._number.value

    def arrive(self, time: float, place: Sequence[float], crossed: bool = False) -> list[float]:
        """Go to a time and place and switch what has crossed, unless the run has `ended`.

        Takes time [s].
        """
        given = (ctypes.c_double * len(place))(*place)
        self._check(self._call.kernel_arrive(self._handle, time, given, crossed))
        return list(given)

    @property
    def handle(self) -> int:
        """Return the instance in C, for callers of the library's functions; it lives as long as this object."""
        return int(self._handle)

    def rates(self, names: Sequence[str]) -> list[float]:
        """Return first derivatives of outputs by time, with the inputs continued as in the last step."""
        found = (ctypes.c_double * len(names))()
        self._check(self._call.kernel_get_rates(self._handle, len(names), self._numbers(names), found))
        return list(found)

    def directional(self, outputs: Sequence[str], change: Mapping[str, float]) -> list[float]:
        """Return derivatives of outputs along a change of inputs and states; other states are held."""
        found, values = (ctypes.c_double * len(outputs))(), (ctypes.c_double * len(change))(*change.values())
        self._check(
            self._call.kernel_get_directional(
                self._handle, len(outputs), self._numbers(outputs), len(change), self._numbers(change), values, found
            )
        )
        return list(found)

    def _numbers(self, names: Iterable[str]):  # type: ignore[no-untyped-def]
        numbers = [self.number_of(name) for name in names]
        return (ctypes.c_int * len(numbers))(*numbers)

    def repeat_right_hand_side(self, repeat: int) -> None:
        """Compute `repeat` right-hand sides at the present state in one call, to measure the cost of one."""
        self._check(self._call.kernel_repeat_right_hand_side(self._handle, repeat))

    def repeat_jacobian(self, repeat: int) -> None:
        """Compute `repeat` Jacobians at the present state in one call, to measure the cost of one."""
        self._check(self._call.kernel_repeat_jacobian(self._handle, repeat))

    def repeat_step(self, size: float, repeat: int) -> None:
        """Make `repeat` steps of `size` [s] in one call, to measure the cost of a step for a host written in C."""
        self._check(self._call.kernel_repeat_step(self._handle, self.time, size, repeat))

    def hear(self) -> None:
        """Append the new messages of the C side."""
        while self._call.kernel_hear(self._handle, ctypes.byref(self._heard)):
            self.messages.append(self._heard.text.decode())

    def _check(self, status: int) -> None:
        self.hear()
        if status > WARNING:
            raise SimulationError(self._call.kernel_message(self._handle).decode(), status)

    def number_of(self, name: str) -> int:
        """Return the number of a variable."""
        number = self.library.index.get(name)
        if number is None:
            raise SimulationError(f"There is no variable {name}; {self._suggestion(name)}", ERROR)
        return number

    def _suggestion(self, name: str) -> str:
        import difflib

        names = self.library.names
        near = difflib.get_close_matches(name, names, 1)
        more = f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
        return f"did you mean {near[0]}?" if near else f"there are {', '.join(names[:MOST_NAMES])}{more}."

"""Runs of vehicles and brakes in this process, by the kernels inside their FMUs."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np

from bogie_braking.batches import file_of
from bogie_braking.checks import is_number, line_or_none, names_of, near, refused, seconds, shown
from bogie_braking.histories import History, Value
from bogie_braking.machines import Machine, Runnable, machine_at, machine_of
from fmu_src.cosimulation.recording import Recording
from fmu_src.kernel import MOST_NUMBERS, Kernel, SimulationError
from fmu_src.refusals import without_value_before
from fmu_src.system import NONE
from products.registry import FMUS
from rbd_model.track.line import Line
from rbd_model.track.line_table import LINE

#: The parameter that names a line's file.
LINE_FILE = LINE.variable.name
#: Columns of a recording are this far apart unless another interval is asked for [s].
INTERVAL = 0.01
#: Values that differ by so small a share of them are the same, and instants so near to each other [s]; and a share that
#: rounding may take.
SAME, CLOCK = 1e-9, 1e-9
LAST_DIGITS = 1e-15


class Simulation:
    """One vehicle or brake on its way through time.

    what: an FMU by its name, a vehicle, a system or a model of one's own; of a vehicle the equations of one level of
    detail are compiled, that which the values `level` and `contact_model` choose. line: what it runs on; None:
    straight, level track. values: parameters and inputs by name, in SI units; an input may be a function of time [s],
    a pair of columns ([0, 2], [0, 5e3]), times [s] and values, rows [(0, 0), (2, 5e3)], or an array with a field time,
    between whose rows it is linear. Raises KeyError for another name, TypeError for what cannot be run,
    SimulationError for a value that cannot be, each with a sentence.

    >>> stop = Simulation("bogie", initial_speed=25.0, brake_torque_1=([0.0, 2.0], [0.0, 20e3]))
    >>> stop.advance(5.0).status
    """

    def __init__(self, what: Runnable, line: Line | None = None, **values: Value) -> None:
        self._line, self._laid = line_or_none(line), ""
        self._machine = machine_of(what, values, line is not None)
        self._kernel = Kernel(self._machine.library)
        self._histories: dict[str, History] = {}
        self._told = 0  # of the kernel's sentences, so many were in a recording
        try:
            if self._line is not None:
                self._lay(self._kernel, self._line)
            self._take(values)
        except SimulationError as error:
            raise SimulationError(without_value_before(str(error)), error.status) from error

    def _lay(self, kernel: Kernel, line: Line) -> None:
        if LINE_FILE not in self._machine.variables:
            raise refused(f"{self._machine.name} runs on no line; leave the line out.")
        with tempfile.TemporaryDirectory() as folder:  # a kernel reads a line once and keeps it
            self._laid = str(file_of(line, folder))
            kernel.set(**{LINE_FILE: self._laid})

    @property
    def histories(self) -> list[History]:
        """Inputs over time."""
        return list(self._histories.values())

    @property
    def time(self) -> float:
        """Where it stands [s]."""
        return self._kernel.time

    @property
    def ended(self) -> bool:
        """Whether something has ended the run, such as a derailment: no step goes further."""
        return self._kernel.ended

    def __getitem__(self, name: str) -> float:
        """Value of a variable. Raises SimulationError."""
        return self._kernel[name]

    def set(self, **values: Value) -> None:
        """Sets inputs, before the first step parameters too, as at the start. Raises SimulationError, the old value
        kept.

        An input over time counts its time from the start of the run.
        """
        for name in self._machine.fixed & values.keys():
            raise refused(f"{name} chose the equations of {self._machine.name}; give it as the simulation is made.")
        if self._machine.place is not None and not self._kernel.initialised:
            now = (
                {name: self._kernel[name] for name in FMUS[self._machine.name].selectors}
                | {LINE_FILE: self._line_file()}
                | values
            )
            self._go_on_with(machine_of(self._machine.name, now, on_line=False))
        self._take(values)

    def _line_file(self) -> str:
        """Return the path of the line's file, no text if there is none."""
        return self._kernel.get_text(self._kernel.number_of(LINE_FILE)) if LINE_FILE in self._machine.variables else ""

    def _go_on_with(self, machine: Machine, state: bytes | None = None) -> None:
        """Put another system of the same FMU in place of this one, with its values and its line; restore a state.

        Raises SimulationError, nothing changed.
        """
        kernel = self._kernel
        if machine.place != self._machine.place:
            numbers = (one for one in machine.variables.values() if one.causality in ("parameter", "input"))
            now = {one.name: self._kernel[one.name] for one in numbers if one.kind != "string"}
            changed = {name: value for name, value in now.items() if value != machine.variables[name].start}
            kernel, path = Kernel(machine.library, **changed), self._line_file()
            if self._line is not None and path == self._laid:
                self._lay(kernel, self._line)
            elif path:
                kernel.set(**{LINE_FILE: path})
            kernel.journal[:] = self._kernel.journal
        if state is not None:
            kernel.restore(state)
        self._machine, self._kernel = machine, kernel

    def _take(self, values: Mapping[str, Value]) -> None:
        for name, value in values.items():
            if name not in self._machine.variables:
                raise refused(f"There is no variable {name}; {near(name, self._machine.variables)}")
            if isinstance(value, str) or is_number(value):
                self._kernel.set(**{name: value if isinstance(value, str) else float(value)})
                self._histories.pop(name, None)
            else:
                history = History(self._machine.variables[name], value)
                self._kernel.set(**{name: history.at(self.time)})
                self._histories[name] = history

    def advance(self, duration: float, names: Sequence[str] | None = None, interval: float = INTERVAL) -> Recording:
        """Goes on for a duration [s] and records outputs, or the variables `names`, every `interval` [s].

        Neither changes the motion beyond its tolerance. A run that ends early keeps what came before, and its status
        says why. Columns have shape (int(duration / interval) + 1,), the instants at both ends among them. Raises
        ValueError for a duration or interval that is not above 0, KeyError for a name that there is not,
        SimulationError.
        """
        duration, interval = (
            seconds(what, value, math.inf) for what, value in (("the duration", duration), ("the interval", interval))
        )
        variables, kernel = self._machine.variables, self._kernel
        asked = names_of(names, variables)
        if duration / interval * (1 + len(asked)) > MOST_NUMBERS:
            raise ValueError(
                f"Give an interval above {interval:g} s: {duration:g} s would be more than {MOST_NUMBERS:g} numbers."
            )
        duration, interval = seconds("the duration", duration), seconds("the interval", interval)
        before = kernel.counts if kernel.initialised else {}
        rows = self._rows(duration, interval, asked)
        units = {"time": "s"} | {name: variables[name].unit for name in asked}
        counts = {name: count - before.get(name, 0) for name, count in kernel.counts.items()}
        heard, self._told = self._told, len(kernel.journal)
        return Recording(units, rows, kernel.journal[heard:], counts)

    def _rows(self, duration: float, interval: float, names: Sequence[str]) -> list[list[float]]:
        """Time and variables every interval from here on, straight line by straight line of the inputs over time."""
        if not self._kernel.initialised:
            self._kernel.initialise()
        begin = self.time
        corners = {one for history in self._histories.values() for one in history.corners(begin, begin + duration)}
        rows: list[list[float]] = []
        if not corners:
            rows = self._go(begin, begin + duration, duration, interval, names)
        for first, last in pairwise([begin, *sorted(corners), begin + duration] if corners else []):
            due = begin + len(rows) * interval
            middle = first if on_grid(due - first, interval) else min(due, last)
            for start, stop in ((first, middle), (middle, last)):
                if stop - start > CLOCK and not self.ended:
                    rows += self._piece(start, stop, begin + len(rows) * interval, interval, names)
        times = begin + interval * np.arange(len(rows))
        return [[time, *row] for time, row in zip(times.tolist(), rows, strict=True)]

    def _piece(self, start: float, stop: float, due: float, interval: float, names: Sequence[str]) -> list[list[float]]:
        """Goes from one instant to another [s]; the variables from `due` on, the next instant to be recorded."""
        size = stop - start
        if on_grid(due - start, interval):
            return self._go(start, stop, size, interval, names)[round((due - start) / interval) :]
        ends = self._go(start, stop, size, size, names)
        return ends[1:] if abs(due - stop) <= CLOCK else []

    def _go(self, first: float, last: float, size: float, interval: float, names: Sequence[str]) -> list[list[float]]:
        """From one instant to another [s], inputs on straight lines; the variables every interval."""
        for name, history in self._histories.items():
            one, value, aim = history.variable, self[name], history.at(first)
            if abs(value - aim) > SAME * max(abs(value), abs(aim)):
                self._kernel.set(**{name: aim})
                value = aim
            rate = 0.0 if history.steps else (history.at(last, after=False) - value) / size
            if not one.minimum <= value + size * rate <= one.maximum:  # by the last digit
                rate *= 1.0 - SAME
            if rate != 0.0:
                self._kernel.set_rate(**{name: rate})
        count = round(size / interval)
        if count * interval > size and on_grid(size, interval):  # the last row is not lost by the last digit
            interval = size / count * (1.0 - LAST_DIGITS)
        table = self._kernel.record(size, interval, names)
        return [list(row) for row in zip(*(table[name] for name in names), strict=True)]

    def save(self) -> bytes:
        """The complete state, to be kept in a file or sent elsewhere; inputs over time are not part of it."""
        return _mark(self._machine.name, self._machine.place) + self._kernel.save()

    def restore(self, state: bytes) -> None:
        """Go back to a saved state of the same FMU, even of another process. Raises SimulationError otherwise."""
        if not isinstance(state, bytes):
            raise TypeError(f"Give the bytes that save gave: it was {shown(state)}.")
        name, own = self._machine.name, self._machine.place
        places = [own] if own is None else sorted({*FMUS[name].choice, NONE})
        found = [one for one in places if state.startswith(_mark(name, one))]
        if not found:
            raise refused(f"This is no saved state of {name}, whose equations are these; none is restored.")
        machine = self._machine if found[0] == own else machine_at(name, found[0])
        self._go_on_with(machine, state.removeprefix(_mark(name, found[0])))


def _mark(name: str, place: int | None) -> bytes:
    """Return what stands before a saved state: the name of the FMU and the number of the system."""
    return "".join(f"{one}\0" for one in (name, place) if one is not None).encode()


def on_grid(distance: float, interval: float) -> bool:
    """Whether a distance in time is a whole number of intervals [s]."""
    return abs(distance - round(distance / interval) * interval) <= CLOCK


def run(
    what: Runnable,
    duration: float,
    line: Line | None = None,
    names: Sequence[str] | None = None,
    interval: float = INTERVAL,
    **values: Value,
) -> Recording:
    """One run from its start over a duration [s]: `Simulation` and `Simulation.advance`, which say what they take.

    Raises SimulationError for an input over time whose first point lies behind the end of the run.
    """
    one = Simulation(what, line, **values)
    for history in one.histories:
        history.check_begin(seconds("the duration", duration))
    return one.advance(duration, names, interval)

"""Runs of vehicles and brakes in this process, by the kernels inside their FMUs."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np

from bogie_braking.checks import is_number, line_or_none, names_of, near, refused, seconds, shown
from bogie_braking.histories import History, Numbers, Value
from bogie_braking.line_in_file import file_of
from bogie_braking.machines import CompiledMachine, Runnable, machine_at, machine_of, unfolded
from bogie_braking.provenance import SimulationHistory, encoded, encoded_value
from fmu_src.cosimulation.recording import Recording
from fmu_src.kernel import MOST_NUMBERS, Kernel, SimulationError
from fmu_src.refusals import without_value_before
from fmu_src.system import NONE, Variable
from products.registry import FMUS
from products.vehicle_sheet import DataSheet
from rbd_model.contact.pair_file import PAIR_FILE
from rbd_model.track.line import Line
from rbd_model.track.line_table import LINE
from readers.usual import almost_0, is_almost_0, note

#: The parameters that name a line's file and that of a contact table.
LINE_FILE, PROFILE_FILE = LINE.variable.name, PAIR_FILE.variable.name
#: Default interval of the rows of a recording [s].
INTERVAL = 0.01
#: Relative difference below which values are equal; the same for instants [s]; and a share due to rounding.
SAME, CLOCK = 1e-9, 1e-9
LAST_DIGITS = 1e-15


class Simulation:
    """One vehicle or brake over time.

    Parameters
    ----------
    what : str, DataSheet, Vehicle, System or Model
        A built-in FMU by its name, a vehicle from a file (`read_vehicle`), or your own vehicle, system or model. For a
        vehicle, only the level of detail that the values `level` and `contact_model` select is compiled.
    line : Line, optional
        Line of the vehicle; by default straight, level track.
    **values
        Parameters and inputs by name, in SI units. An input may be a function of time [s], a pair of columns ([0, 2],
        [0, 5e3]), times [s] and values, rows [(0, 0), (2, 5e3)], or an array with a field time. It is linear between
        the rows.

    Raises
    ------
    KeyError
        If the name of an FMU is unknown.
    TypeError
        If `what` cannot be run.
    SimulationError
        If the name or the value of a variable is invalid.

    Examples
    --------
    >>> stop = Simulation("bogie", initial_speed=25.0, brake_torque_1=([0.0, 2.0], [0.0, 20e3]))
    >>> stop.advance(5.0).status
    """

    def __init__(self, what: Runnable | DataSheet, line: Line | None = None, **values: Value) -> None:
        given, (what, values) = (what, values), unfolded(what, values)
        self._line, self._laid = line_or_none(line), ""
        self._machine = machine_of(what, values, line is not None)
        self._run_history = SimulationHistory(encoded(given[0]), encoded(self._line), self._machine.identity)
        self._kernel = Kernel(self._machine.library)
        self._histories: dict[str, History] = {}
        self._told = 0  # number of the kernel's messages in earlier recordings
        try:
            if self._line is not None:
                self._lay(self._kernel, self._line)
            self._take(values)
            for name, value in given[1].items():
                self._run_history.set(name, encoded_value(self._histories.get(name, value)))
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
        """The current time [s]."""
        return self._kernel.time

    @property
    def ended(self) -> bool:
        """True if the run has ended, such as by a derailment; it cannot advance then."""
        return self._kernel.ended

    def __getitem__(self, name: str) -> float:
        """Return the value of a variable. Raises SimulationError."""
        return self._kernel[name]

    def set(self, **values: Value) -> None:
        """Set inputs; before the first step also parameters.

        The times of an input are relative to the start of the run.

        Parameters
        ----------
        **values : float, or pair of times and values
            Values by name, in their units.

        Raises
        ------
        SimulationError
            If a name or a value is invalid; the old value is kept.
        """
        for name in self._machine.fixed & values.keys():
            raise refused(f"{name} chose the equations of {self._machine.name}; give it as the simulation is made.")
        if self._machine.place is not None and not self._kernel.initialised:
            now = (
                {name: self._kernel[name] for name in FMUS[self._machine.name].selectors}
                | {LINE_FILE: self._file_of(LINE_FILE)}
                | values
            )
            self._go_on_with(machine_of(self._machine.name, now, on_line=False))
        for name, value in values.items():
            self._take({name: value})
            self._run_history.set(name, encoded_value(self._histories.get(name, value)))

    def _file_of(self, name: str) -> str:
        """Return the path of the file that a variable names, or an empty string."""
        return self._kernel.get_text(self._kernel.number_of(name)) if name in self._machine.variables else ""

    def _go_on_with(self, machine: CompiledMachine, state: bytes | None = None) -> None:
        """Change to another system of the same FMU with the same values and files, and restore a state.

        Raises SimulationError, with nothing changed.
        """
        kernel = self._kernel
        if machine.place != self._machine.place:
            numbers = (
                variable for variable in machine.variables.values() if variable.causality in ("parameter", "input")
            )
            now = {number.name: self._kernel[number.name] for number in numbers if number.kind != "string"}
            changed = {name: value for name, value in now.items() if value != machine.variables[name].start}
            kernel, path = Kernel(machine.library, **changed), self._file_of(LINE_FILE)
            if self._file_of(PROFILE_FILE):
                kernel.set(**{PROFILE_FILE: self._file_of(PROFILE_FILE)})
            if self._line is not None and path == self._laid:
                self._lay(kernel, self._line)
            elif path:
                kernel.set(**{LINE_FILE: path})
            kernel.messages[:] = self._kernel.messages
        if state is not None:
            kernel.restore(state)
        self._machine, self._kernel = machine, kernel

    def _take(self, values: Mapping[str, Value]) -> None:
        for name, value in values.items():
            if name not in self._machine.variables:
                raise refused(f"There is no variable {name}; {near(name, self._machine.variables)}")
            if isinstance(value, str) or is_number(value):
                if not isinstance(value, str) and not self._kernel.initialised:
                    self._weigh(self._machine.variables[name], float(value))
                self._kernel.set(**{name: value if isinstance(value, str) else float(value)})
                self._histories.pop(name, None)
            else:
                history = History(self._machine.variables[name], value)
                self._kernel.set(**{name: history.at(self.time)})
                self._histories[name] = history

    def _weigh(self, variable: Variable, value: float) -> None:
        """Refuse a start value that no brake has; add a message about one that is rare."""
        if value >= variable.minimum and is_almost_0(value, variable.unit):
            raise refused(almost_0(variable.name, value, variable.unit, variable.maximum))
        if said := note(variable.name, value, variable.unit):
            self._kernel.messages.append(said)

    def advance(self, duration: float, names: Sequence[str] | None = None, interval: float = INTERVAL) -> Recording:
        """Advance by a duration and record outputs, or the variables `names`.

        Neither `names` nor `interval` changes the motion beyond its tolerance.

        Parameters
        ----------
        duration : float
            Time to advance [s].
        names : sequence of str, optional
            Variables to record; by default all outputs.
        interval : float
            Interval of the rows [s].

        Returns
        -------
        Recording
            Columns of shape (int(duration / interval) + 1,), including the instants at both ends. A run that ends early
            keeps the earlier rows, and its status states the reason.

        Raises
        ------
        ValueError
            If the duration or the interval is not above 0.
        KeyError
            If a name is unknown.
        SimulationError
            If a step fails.
        """
        duration, interval = (
            seconds(what, value, math.inf) for what, value in (("the duration", duration), ("the interval", interval))
        )
        variables, kernel = self._machine.variables, self._kernel
        asked = names_of(names, variables)
        if duration / interval * (1 + len(asked)) > MOST_NUMBERS:
            raise ValueError(
                f"The interval must be longer; got {interval:g} s, over {MOST_NUMBERS:g} numbers in {duration:g} s."
            )
        duration, interval = seconds("the duration", duration), seconds("the interval", interval)
        before = kernel.counts if kernel.initialised else {}
        try:
            rows = self._rows(duration, interval, asked)
        except Exception:
            self._run_history.discard("a step of it failed")
            raise
        self._run_history.add("advance", duration, interval, None if names is None else asked)
        units = {"time": "s"} | {name: variables[name].unit for name in asked}
        counts = {name: count - before.get(name, 0) for name, count in kernel.counts.items()}
        heard, self._told = self._told, len(kernel.messages)
        return Recording(units, rows, kernel.messages[heard:], counts, provenance=self._run_history.snapshot())

    def _rows(self, duration: float, interval: float, names: Sequence[str]) -> Numbers:
        """Return time and variables every interval, one linear piece of the inputs after the other."""
        if not self._kernel.initialised:
            self._kernel.initialise()
        begin = self.time
        corners = {
            corner for history in self._histories.values() for corner in history.corners(begin, begin + duration)
        }
        parts, count = [np.empty((0, len(names)))], 0
        if not corners:
            parts.append(self._go(begin, begin + duration, duration, interval, names))
        for first, last in pairwise([begin, *sorted(corners), begin + duration] if corners else []):
            due = begin + count * interval
            middle = first if on_grid(due - first, interval) else min(due, last)
            for start, stop in ((first, middle), (middle, last)):
                if stop - start > CLOCK and not self.ended:
                    parts.append(self._piece(start, stop, begin + count * interval, interval, names))
                    count += len(parts[-1])
        rows = np.concatenate(parts)
        return np.column_stack([begin + interval * np.arange(len(rows)), rows])

    def _piece(self, start: float, stop: float, due: float, interval: float, names: Sequence[str]) -> Numbers:
        """Advance from one instant to another [s]; return the variables from `due` on, the next instant of a row."""
        size = stop - start
        if on_grid(due - start, interval):
            return self._go(start, stop, size, interval, names)[round((due - start) / interval) :]
        ends = self._go(start, stop, size, size, names)
        return ends[1:] if abs(due - stop) <= CLOCK else ends[:0]

    def _go(self, first: float, last: float, size: float, interval: float, names: Sequence[str]) -> Numbers:
        """Advance from one instant to another [s], inputs interpolated; return the variables every interval."""
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
        return self._kernel.record_rows(size, interval, names)

    def jacobian(self) -> np.ndarray:
        """Return the derivatives of the equations by the states at the present state, exact.

        Returns
        -------
        numpy.ndarray
            Shape (states, states), in the order in which the equations have their states: of the slopes, and of the
            residuals for algebraic states.

        Raises
        ------
        SimulationError
            If the run has not begun.
        """
        if not self._kernel.initialised:
            raise refused("A jacobian is that of a run that has begun. Call advance first.")
        return np.array(self._kernel.linearise().jacobian)

    def save(self) -> bytes:
        """Return the complete state, for a file or another process; inputs over time are not included.

        Returns
        -------
        bytes
            The state, for `restore`.
        """
        return _mark(self._machine.name, self._machine.place) + self._kernel.save()

    def restore(self, state: bytes) -> None:
        """Restore a saved state of the same FMU, also from another process.

        Parameters
        ----------
        state : bytes
            A result of `save`.

        Raises
        ------
        TypeError
            If `state` is not of type bytes.
        SimulationError
            If it is a state of another FMU.
        """
        if not isinstance(state, bytes):
            raise TypeError(f"A saved state must be the bytes that save returned; got {shown(state)}.")
        name, own = self._machine.name, self._machine.place
        places = [own] if own is None else sorted({*FMUS[name].choice, NONE})
        found = [place for place in places if state.startswith(_mark(name, place))]
        if not found:
            raise refused(f"The state must be one of {name} with the same equations; nothing was restored.")
        machine = self._machine if found[0] == own else machine_at(name, found[0])
        self._go_on_with(machine, state.removeprefix(_mark(name, found[0])))
        self._run_history.discard("it was restored from a saved state")


def _mark(name: str, place: int | None) -> bytes:
    """Return the prefix of a saved state: the name of the FMU and the number of the system."""
    return "".join(f"{one}\0" for one in (name, place) if one is not None).encode()


def on_grid(distance: float, interval: float) -> bool:
    """Return whether a time difference is an integer number of intervals [s]."""
    return abs(distance - round(distance / interval) * interval) <= CLOCK


def run(
    what: Runnable | DataSheet,
    duration: float,
    line: Line | None = None,
    names: Sequence[str] | None = None,
    interval: float = INTERVAL,
    **values: Value,
) -> Recording:
    """Simulate one run from its start, as `Simulation` and `Simulation.advance` do.

    Parameters
    ----------
    what : str, DataSheet, Vehicle, System or Model
        A built-in FMU by its name, a vehicle from a file, or your own vehicle, system or model, as in `Simulation`.
    duration : float
        Duration of the run [s].
    line : Line, optional
        Line of the vehicle; by default straight, level track.
    names : sequence of str, optional
        Variables to record; by default all outputs.
    interval : float
        Interval of the rows [s].
    **values
        Parameters and inputs by name, in SI units, as in `Simulation`; inputs may vary over time.

    Returns
    -------
    Recording
        As from `Simulation.advance`.

    Raises
    ------
    KeyError
        If a name is unknown.
    TypeError
        If `what` cannot be run.
    ValueError
        If the duration or the interval is not above 0.
    SimulationError
        If a value is invalid, a step fails, or the first point of an input over time is after the end of the run.
    """
    simulation = Simulation(what, line, **values)
    for history in simulation.histories:
        history.check_begin(seconds("the duration", duration))
    return simulation.advance(duration, names, interval)

"""Co-simulation of FMUs: Jacobi or Gauss-Seidel, inputs constant or extrapolated, macro steps fixed or adaptive."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from fmu_src.cosimulation.recording import Recording
from fmu_src.cosimulation.slave import CosimulationError, FmuInstance
from fmu_src.progress import counting
from fmu_src.variables import LARGEST_TOLERANCE


class Connection(NamedTuple):
    """An output that becomes an input, times a factor.

    Attributes
    ----------
    source, output : FmuInstance, str
        The instance and the name of its output.
    target, input : FmuInstance, str
        The instance and the name of its input.
    factor : float
        Input over output.
    """

    source: FmuInstance
    output: str
    target: FmuInstance
    input: str
    factor: float = 1.0

    def value(self) -> float:
        """Return the present value of the source.

        Returns
        -------
        float
            The value, in the unit of the input.

        Raises
        ------
        CosimulationError
            If the output is unknown.
        """
        return self.factor * self.source[self.output]

    def rate(self) -> float:
        """Return the first derivative of `value` by time.

        Returns
        -------
        float
            The derivative, in the unit of the input per second; 0 if the source provides none.
        """
        return self.factor * self.source.rate(self.output)

    def nominal(self) -> float:
        """Return the typical size of `value`.

        Returns
        -------
        float
            Nominal value, in the unit of the input.
        """
        return abs(self.factor) * self.source.nominal(self.output)


#: A connected torque or force, and the slave and the speed on which it works.
Bond = tuple[Connection, tuple[FmuInstance, str]]

JACOBI, GAUSS_SEIDEL = "jacobi", "gauss-seidel"
#: Change of the macro step from one to the next, and the smallest one [s] before the master gives up.
SHRINK, GROW, SAFETY, SMALLEST = 0.2, 2.0, 0.9, 1e-7
#: The most macro steps of a run, whose rows still go into memory.
MOST_STEPS = 1e8


@dataclass(frozen=True)
class Master:
    """Coupling method of a co-simulation.

    Attributes
    ----------
    method : str
        JACOBI: all instances step with the values at the start of the step. GAUSS_SEIDEL: one after the other, each
        with the newest values of those before it.
    extrapolated : bool
        True: inputs continue within a step with the rate of their source, or on the straight line to a known value.
        False: they stay constant.
    coupling_tolerance : float or None
        Tolerance of the error of one step, in nominal values of the outputs; the FMUs must save their states for it.
        None: the macro step is fixed.
    """

    method: str = GAUSS_SEIDEL
    extrapolated: bool = False
    coupling_tolerance: float | None = None

    def __post_init__(self) -> None:
        if self.method not in (JACOBI, GAUSS_SEIDEL):
            raise CosimulationError(f"method must be {JACOBI} or {GAUSS_SEIDEL}; got {self.method}.")
        tolerance = self.coupling_tolerance
        if tolerance is not None and not 0.0 < tolerance <= LARGEST_TOLERANCE:
            raise CosimulationError(
                f"coupling_tolerance must be above 0 and at most {LARGEST_TOLERANCE:g}; got {tolerance:g}."
            )


@dataclass
class CouplingStatistics:
    """Statistics of the coupling: macro steps made and repeated, and their smallest and largest size [s].

    energy [J]: energy that the inputs of the bonds added to that of their sources, in total and without sign.
    """

    steps: int = 0
    repeated: int = 0
    smallest: float = math.inf
    largest: float = 0.0
    energy: float = 0.0
    energy_moved: float = 0.0

    def as_dict(self) -> dict[str, float]:
        """Return the statistics for the summary of a scenario."""
        return {
            "macro_steps": self.steps,
            "repeated_steps": self.repeated,
            "smallest_step": self.smallest,
            "largest_step": self.largest,
            "coupling_energy": self.energy,
            "coupling_energy_without_sign": self.energy_moved,
        }


@dataclass
class Coupling:
    """Slaves with their connections, on their way through time. `cosimulate` is the short form."""

    slaves: Sequence[FmuInstance]
    connections: Sequence[Connection]
    master: Master = Master()
    bonds: Sequence[Bond] = ()
    account: CouplingStatistics = field(default_factory=CouplingStatistics)

    def advance(self, time: float, size: float) -> dict[Connection, tuple[float, float, float, float]]:
        """Make one macro step.

        Takes time, size [s].
        """
        begin = {c: c.value() for c in self.connections}
        # Read before any instance steps: a source that went first would otherwise return its rate at the end of the
        # step.
        known = {c: begin[c] + size * c.rate() for c in begin} if self.master.extrapolated else begin
        used: dict[Connection, tuple[float, float]] = {}
        done: set[FmuInstance] = set()
        for slave in self.slaves:
            for connection in self.connections:
                if connection.target is slave:
                    newest = connection.source in done and self.master.method == GAUSS_SEIDEL
                    end = connection.value() if newest else known[connection]
                    used[connection] = self._feed(connection, begin[connection], end, size)
            slave.step(time, size)
            done.add(slave)
        return {c: (*used[c], begin[c], c.value()) for c in self.connections}

    def _feed(self, connection: Connection, begin: float, end: float, size: float) -> tuple[float, float]:
        """Set an input for one step, constant or on its line, and return its values at both ends."""
        target, name = connection.target, connection.input
        if not self.master.extrapolated:
            target.set(**{name: end})
            return end, end
        target.set(**{name: begin})
        target.set_rate(name, (end - begin) / size)
        return begin, end

    def error_of(self, lines: Mapping[Connection, tuple[float, float, float, float]]) -> float:
        """Return the largest distance of an input from its source within the step, in nominal values."""
        return max(
            (
                max(abs(a - begin), abs(b - end)) / connection.nominal()
                for connection, (a, b, begin, end) in lines.items()
            ),
            default=0.0,
        )

    def step(self, time: float, size: float) -> tuple[float, float]:
        """Make one accepted macro step from `time` of at most `size` [s]; return its size and the next proposal [s]."""
        tolerance = self.master.coupling_tolerance
        while True:
            flows = {bond: bond[1][0][bond[1][1]] for bond in self.bonds}
            states = [] if tolerance is None else [slave.save() for slave in self.slaves]
            try:
                lines, error = self._try(time, size)
                order = 2.0 if self.master.extrapolated else 1.0
                factor = SAFETY * error ** (-1.0 / order) if error > 0.0 else GROW
                proposed = size * min(GROW, max(SHRINK, factor))
                if error <= 1.0:
                    self._book(size, lines, flows)
                    return size, proposed
                if size <= SMALLEST:
                    raise CosimulationError(
                        f"The coupling error at {time:.6g} s stays above the tolerance {tolerance:g} with steps of "
                        f"{size:.1e} s; enlarge the tolerance."
                    )
                for slave, state in zip(self.slaves, states, strict=True):
                    slave.restore(state)
                self.account.repeated += 1
                size = max(SMALLEST, min(proposed, size / 2))
            finally:
                for slave, state in zip(self.slaves, states, strict=False):
                    slave.forget(state)

    def _try(self, time: float, size: float) -> tuple[dict[Connection, tuple[float, float, float, float]], float]:
        """Make a macro step; return its error in units of the tolerance, infinite if an FMU refused so long a step.

        For example, a line may lead a capacity below zero.
        """
        tolerance = self.master.coupling_tolerance
        try:
            lines = self.advance(time, size)
        except CosimulationError:
            if tolerance is None or size <= SMALLEST:
                raise
            return {}, math.inf
        return lines, self.error_of(lines) / tolerance if tolerance else 0.0

    def _book(
        self, size: float, lines: Mapping[Connection, tuple[float, float, float, float]], flows: Mapping[Bond, float]
    ) -> None:
        account = self.account
        account.steps += 1
        account.smallest, account.largest = min(account.smallest, size), max(account.largest, size)
        for (connection, (slave, name)), flow in flows.items():
            a, b, begin, end = lines[connection]
            energy = size * ((a - begin) * flow + (b - end) * slave[name]) / 2
            account.energy += energy
            account.energy_moved += abs(energy)

    def run(
        self,
        duration: float,
        step: float,
        drive: Callable[[float], None] | None = None,
        instants: Sequence[float] = (),
    ) -> Iterator[float]:
        """Yield the time after each accepted step.

        Parameters
        ----------
        duration, step : float
            Duration of the run and first macro step [s].
        drive : callable or None
            Called as `drive(time)` before each step; it may set inputs.
        instants : sequence of float
            Times that no step of adaptive size may cross [s].

        Raises
        ------
        CosimulationError
            If the step is not above 0 s, or the run has too many steps.
        """
        if not (math.isfinite(step) and step > 0.0):
            raise CosimulationError(f"step must be finite and above 0 s; got {step:g} s.")
        if not duration / step <= MOST_STEPS:
            raise CosimulationError(
                f"A run must have at most {MOST_STEPS:g} macro steps; got {duration:g} s with steps of {step:g} s. "
                "Give longer steps, or a shorter run."
            )
        if self.master.coupling_tolerance is None:
            for number in range(max(1, round(duration / step))):
                if drive:
                    drive(number * step)
                self.step(number * step, step)
                yield (number + 1) * step
            return
        time, size = 0.0, step
        for edge in [*sorted(t for t in instants if 0.0 < t < duration), duration]:
            while time < edge:
                if drive:
                    drive(time)
                left = edge - time
                whole = size >= left or left - size < SMALLEST
                made, size = self.step(time, left if whole else size)
                time = edge if whole and made == left else time + made
                yield time
            size = min(size, step)


def cosimulate(
    slaves: Sequence[FmuInstance],
    connections: Sequence[Connection],
    duration: float,
    step: float,
    record: Sequence[tuple[FmuInstance, str]],
    drive: Callable[[float], None] | None = None,
    label: str = "",
    coupling: Coupling | None = None,
    instants: Sequence[float] = (),
) -> Recording:
    """Run started FMUs together from t = 0 and record outputs after every macro step.

    In each step the instances go in the given order, each with the newest outputs of the others, or as `coupling` says.
    The columns are named by `column_names`.

    Parameters
    ----------
    slaves : sequence of FmuInstance
        The instances, started.
    connections : sequence of Connection
        Outputs that become inputs.
    duration, step : float
        Duration of the run and macro step [s].
    record : sequence of tuple
        Instance and output of each column.
    drive : callable or None
        Called as `drive(time)` before each step; it may set inputs.
    label : str
        Text of the progress bar.
    coupling : Coupling or None
        Method and statistics; None: Gauss-Seidel with the fixed macro step.
    instants : sequence of float
        Times that no step of adaptive size may cross [s].

    Returns
    -------
    Recording
        Time and outputs, a row for each step.

    Raises
    ------
    CosimulationError
        If an FMU fails or two columns have one name.
    """
    coupling = coupling or Coupling(slaves, connections)
    by_slave = {slave: [name for owner, name in record if owner is slave] for slave in slaves}
    ordered = [(slave, name) for slave, names in by_slave.items() for name in names]
    units = {column: slave.units[name] for column, (slave, name) in zip(column_names(ordered), ordered, strict=True)}

    def sample(time: float) -> list[float]:
        values: list[float] = [time]
        for slave, names in by_slave.items():
            values += slave.get(names)
        return values

    rows = [sample(0.0)]
    with counting(text=label, total=duration, unit="s") as bar:
        for time in coupling.run(duration, step, drive, instants):
            rows.append(sample(time))
            bar.update(time - rows[-2][0])
    return Recording({"time": "s"} | units, rows)


def column_names(record: Sequence[tuple[FmuInstance, str]]) -> list[str]:
    """Return `output` if only one instance records it, otherwise `instance.output`. Raises CosimulationError."""
    asked = Counter(name for _, name in record)
    names = [f"{slave.name}.{name}" if asked[name] > 1 else name for slave, name in record]
    twice = [name for name, count in Counter(names).items() if count > 1 or name == "time"]
    if twice:
        raise CosimulationError(
            f"Each column must have its own name; two are {twice[0]}. Name each instance, FmuInstance(path, name), "
            "and record each output once."
        )
    return names

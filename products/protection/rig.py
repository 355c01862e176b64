"""The test rig: many braked vehicles at once, each with sensors, a wheel-slide controller and a score.

Vehicle and cylinders are one composed system. Between its steps, sensors, controllers in C and scores are computed in C
(brake_controller/rig/). A controller in Python is called between the same steps.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import KW_ONLY, dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from time import monotonic
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from brake_controller.protection_fmu import MOST_WHEELSETS
from brake_controller.sensors import GATE, LOWEST_FREQUENCY, TIMER, edge_errors
from brake_controller.wheel_slide import (
    APPLY,
    GUARD,
    PATIENCE,
    SHARED,
    VENT,
    ControllerError,
    LateError,
    NotJudgedError,
    SilentError,
    Supervised,
    Watch,
    failure,
    silence,
    within,
)
from fmu_src.batch import Instances
from fmu_src.suggestion import suggestion
from products.controller_kinds import Arrays, Form, FunctionsInC, InC, ManyControllers, Outside, at_once
from products.machine import (
    CYLINDER_VOLUME,
    DYNAMIC_BRAKE,
    FULL_PRESSURE,
    RELEASE_TIME,
    TRACTION,
    Machine,
    cylinder_air,
    in_order,
)
from products.protection import rig_in_c
from products.protection.compiled_machine import machine_library, machine_table, own_values
from products.protection.history import Notebook
from products.protection.rails import ABOVE, BAND, JERK_TIME, LOCK_ABOVE
from products.protection.rig_in_c import BEYOND, DONE, LOST, RUNS, SCORE, TOO_LONG, RigWheelset
from products.protection.runs import SENSOR_FAILURES, Run, Stop
from products.protection.settings import BRAKE_START, GAS, LONGEST, STANDING, Settings
from rbd_model.track.line import Line

#: Sampling instants between two checks for ended runs; an ended run advances at most this many further.
GLANCE = 100
#: Processor time limit of one step of a controller on arrays [s].
PATIENCE_WITH_ARRAYS = 10.0
#: After this number of runs without an answer a controller is not called in the others.
SILENCES = 3
#: Initial speed of a vehicle with traction [m/s].
START_SPEED = 1.0


def not_asked(who: str) -> NotJudgedError:
    """Return the error of a controller that is not evaluated because it gave no answer in other runs."""
    return NotJudgedError(f"{who} gave no answer in {SILENCES} runs; it was not asked again and is not judged here.")


def as_commands(answer: NDArray[Any]) -> tuple[NDArray[np.int32], NDArray[np.bool_]]:
    """Return an answer of shape (rows, wheelsets) as commands, and a mask of rows that contain only 0, 1 and 2."""
    if answer.dtype.kind not in "iuf":
        return np.zeros(answer.shape, np.int32), np.zeros(len(answer), bool)
    with np.errstate(invalid="ignore"):  # not a number
        commands = answer.astype(np.int32)
    return commands, ((commands == answer) & (commands >= APPLY) & (commands <= VENT)).all(axis=1)


@dataclass(frozen=True)
class Beginning:
    """Start values of a run for the rig in C: its last speed [m/s], the faults of each wheelset, errors of its teeth.

    errors: shape (wheelsets, pulses), as shares of the pitch; None without errors.
    """

    end_speed: float
    wheelsets: ctypes.Array[RigWheelset]
    errors: NDArray[np.float64] | None


@dataclass(eq=False)
class Rig:
    """Many stops at once of one vehicle under one controller."""

    machine: Machine
    form: Form
    settings: Settings
    _: KW_ONLY
    #: True if cylinders fill by flow of air from a reservoir of limited volume, through valves with switching times.
    by_flow: bool = False
    #: 2: planar model; 3: 3D model, which costs 4 to 5 times as much.
    level: int = 2
    #: Integration step [s], of which a period is a multiple; 0: adaptive step size.
    step: float = 0.0
    #: Number of threads; by default the number of processors.
    threads: int | None = None
    #: Equipment of all runs. A vehicle with traction has no cylinders, and starts instead of stopping.
    equipment: Iterable[str] = ()
    #: Line of all runs that have none of their own.
    line: Line | None = None

    def __post_init__(self) -> None:
        self.equipment = in_order(self.equipment)
        self.driven = TRACTION in self.equipment
        self.has_reservoir = self.by_flow and not self.driven
        self.machine = replace(self.machine, by_flow=self.has_reservoir, equipment=self.equipment)
        self._call = rig_in_c.functions()
        self.model, _ = machine_table(self.machine, self.level, self.line is not None)
        #: Start values of all variables.
        self.first = {variable.name: variable.start for variable in self.model.variables}
        n, demand = self.machine.numbers, "traction_demand" if self.driven else "pressure_demand"
        self._inputs = [f"{name}_{number}" for name in (demand, "valve") for number in n]
        effort = "traction_torque" if self.driven else "cylinder_pressure"
        of_each = ("rotation", "angular_velocity", effort, "creep_force", "axle_load")
        self._outputs = ["speed", "distance", *(f"{name}_{number}" for name in of_each for number in n)]
        self._outputs += ["air_taken", "reservoir_pressure"] if self.has_reservoir else []

    def stops(self, rails: Sequence[Mapping[str, float]]) -> list[Stop]:
        """Run a stop on each rail (inputs and parameters of the vehicle); return the stops in their order."""
        return self.runs([Run(rail) for rail in rails])

    def runs(self, runs: Sequence[Run], goes_on: Callable[[], None] = lambda: None, every: float = 0.0) -> list[Stop]:
        """Run the stops, each with its own equipment in addition to that of the rig, and on its own line.

        Takes every [s].
        """
        kinds = [self._kind(run) for run in runs]
        stops: list[Stop | None] = [None] * len(runs)
        for kind in dict.fromkeys(kinds):
            rig = self if kind == (self.equipment, self.line) else replace(self, equipment=kind[0], line=kind[1])
            places = [place for place, own in enumerate(kinds) if own == kind]
            found = rig._alike([runs[place] for place in places], goes_on, every)
            for place, stop in zip(places, found, strict=True):
                stops[place] = stop
        return [one for one in stops if one is not None]

    def _kind(self, run: Run) -> tuple[tuple[str, ...], Line | None]:
        """Return the equipment and the line of a run."""
        return in_order({*self.equipment, *run.equipment}), run.line or self.line

    def _alike(self, runs: Sequence[Run], goes_on: Callable[[], None], every: float) -> list[Stop]:
        """Return a stop for each run with the rig's own equipment and line."""
        samples = max(1, round(every / self.settings.period)) if every else 0
        found: list[Stop | None] = [None] * len(runs)
        count = min(len(runs), at_once(self.form))
        own = [self.values(run) for run in runs]
        beginnings = [self.beginning(run) for run in runs]
        names = sorted({name for one in own for name in one})
        for name in names:
            if name not in self.first:
                raise ValueError(f"This machine has no {name}; {suggestion(name, self.first)}")
        values = [{name: one.get(name, self.first[name]) for name in names} for one in own]
        start: dict[str, Any] = {name: [value[name] for value in values[:count]] for name in names}
        with (
            self.instances(count, start) as instances,
            Loop(self, instances) as loop,
        ):
            notebook = Notebook(count, loop.wheelsets, samples, self.settings.period) if samples else None
            if notebook:
                self._call.rig_write_down(loop.own, notebook.place)
            for row, number in self._turns(loop, values, beginnings, count, goes_on):
                stop = loop.stop(row)
                found[number] = replace(stop, history=notebook.history(row)) if notebook else stop
        return [one for one in found if one is not None]

    def prepare(self, runs: Sequence[Run]) -> None:
        """Compile, or load, the equations of these runs."""
        for equipment, on_line in {(kind, line is not None) for kind, line in map(self._kind, runs)}:
            machine_library(replace(self, equipment=equipment, line=None).machine, self.level, on_line)

    def instances(self, count: int, start: Mapping[str, Any]) -> Instances:
        """Return `count` instances with these initial values, one number for all or one for each."""
        library = machine_library(self.machine, self.level, self.line is not None)
        with ExitStack() as kept:  # an instance that begins again reads the line again
            path = None
            if self.line is not None:
                path = str(self.line.write(Path(kept.enter_context(TemporaryDirectory())) / "line.csv"))
            made = Instances(library, count, self._inputs, self._outputs, threads=self.threads, path=path, **start)
            made.at_close = kept.pop_all().close
        return made

    def _turns(
        self,
        loop: Loop,
        values: Sequence[Mapping[str, float]],
        beginnings: Sequence[Beginning],
        count: int,
        goes_on: Callable[[], None],
    ) -> Iterator[tuple[int, int]]:
        """Yield rows that have ended, with the numbers of their runs; each row then takes the next waiting run."""
        runs = dict(enumerate(range(count)))
        waiting = iter(range(count, len(values)))
        loop.begin({row: beginnings[number] for row, number in runs.items()})
        while runs:
            loop.go_on(GLANCE)
            goes_on()
            done = [row for row in runs if loop.score["state"][row] != RUNS]
            for row in done:
                yield row, runs.pop(row)
            begun = dict(zip(done, waiting, strict=False))
            for row, number in begun.items():
                loop.instances.reset(row, **values[number])
            runs |= begun
            loop.begin({row: beginnings[number] for row, number in begun.items()})

    def beginning(self, run: Run) -> Beginning:
        """Return the start values of a run for the rig in C. Raises ValueError for a fault of an unknown wheelset."""
        end = (self.settings.speed if run.speed is None else run.speed) if self.driven else STANDING
        return Beginning(end, self._faults(run), self._errors(run))

    def _errors(self, run: Run) -> NDArray[np.float64] | None:
        """Return the errors of the teeth of a run, other ones for each of its seeds and wheelsets."""
        s = self.settings
        if not s.jitter:
            return None
        seeds = [run.teeth * MOST_WHEELSETS + number for number in self.machine.numbers]
        return np.array([edge_errors(s.pulses, s.jitter, seed) for seed in seeds])

    def _faults(self, run: Run) -> ctypes.Array[RigWheelset]:
        count = len(self.machine.numbers)
        phases = run.phases or (0.0,) * count
        if len(phases) != count:
            raise ValueError(f"phases must be one for each of {count} wheelsets; got {len(phases)}.")
        each = (RigWheelset * count)(*(RigWheelset(1.0, 0.0, 0.0, phase, 0, 0) for phase in phases))
        for fault in run.faults:
            if fault.wheelset not in self.machine.numbers:
                raise ValueError(f"The wheelset of a fault must be from 1 to {len(each)}; got {fault.wheelset}.")
            of = each[fault.wheelset - 1]
            of.radius, of.sensor_from = fault.radius, fault.sensor_from
            of.sensor = SENSOR_FAILURES.get(fault.sensor, 0)
            of.valve_sticks, of.valve_from = int(math.isfinite(fault.valve_from)), min(fault.valve_from, LONGEST)
        return each

    def values(self, run: Run) -> dict[str, float]:
        """Return the initial values and parameters of a run."""
        s = self.settings
        brake_ratio = s.brake_ratio if run.brake_ratio is None else run.brake_ratio
        first = self.first
        fixed = {"integration_method": 2.0, "integration_step": self.step} if self.step else {}
        fixed |= own_values(self.machine, self.level, self.line is not None)
        if self.driven:
            motor = {name: brake_ratio * first[name] for name in ("motor_torque", "motor_power")}
            return {"initial_speed": START_SPEED, **fixed, **motor, **run.values}
        share = brake_ratio * FULL_PRESSURE / self.machine.full_pressure
        brake = {
            "supply_pressure": self.machine.supply_pressure,
            "force_per_pressure": first["force_per_pressure"] * share,
        }
        if DYNAMIC_BRAKE in self.equipment:
            brake |= {"torque_per_pressure": brake_ratio * first["torque_per_pressure"]}
        if self.has_reservoir:
            air = cylinder_air(self.machine.full_pressure, s.application_time)
            brake |= {"application_orifice": air.application_orifice}
        else:
            brake |= {"application_time": s.application_time, "release_time": RELEASE_TIME}
        speed = s.speed if run.speed is None else run.speed
        return {"initial_speed": speed, **fixed, **brake, **run.values}


class Loop:
    """A rig in C with its instances.

    A controller in Python reads `time` [s], shape (count,), and `speeds` [m/s], and sets `valves`, both of shape
    (count, wheelsets), the same arrays at every step; `score` has shape (count,).
    """

    def __init__(self, rig: Rig, instances: Instances) -> None:
        self.rig, self.instances, self.call = rig, instances, rig._call
        machine, s = rig.machine, rig.settings
        self.count, self.wheelsets = len(instances), len(machine.numbers)
        form = rig.form
        self.in_c = form is None or isinstance(form, InC)
        controller = form.functions(self.wheelsets) if isinstance(form, InC) else FunctionsInC()
        self.bytes = int(controller.size)
        settings = rig_in_c.RigSettings(
            self.wheelsets,
            machine.parameters.wheel_radius,
            s.period,
            BRAKE_START,
            1.0 if rig.driven else machine.full_pressure,
            LONGEST,
            LOCK_ABOVE,
            JERK_TIME,
            BAND,
            ABOVE,
            int(rig.has_reservoir),
            int(rig.driven),
            rig_in_c.SensorSettings(s.pulses, GATE, TIMER, LOWEST_FREQUENCY),
        )
        self.time, self.speeds = np.zeros(self.count), np.zeros((self.count, self.wheelsets))
        self.valves = np.zeros((self.count, self.wheelsets), np.int32)
        desk = rig_in_c.Desk(*(one.ctypes.data for one in (self.time, self.speeds, self.valves)))
        self.own = self.call.rig_create(self.count, settings, controller, desk)
        if not self.own:
            raise MemoryError(f"There is not enough memory for {self.count} rows of sensors; take fewer at once.")
        place = ctypes.cast(self.call.rig_scores(self.own), ctypes.POINTER(ctypes.c_char))
        whole = np.ctypeslib.as_array(place, (self.count * SCORE.itemsize,))
        self.score = whole.view(SCORE)
        self.each: list[Supervised | None] = [None] * self.count
        self.messages: dict[int, str] = {}
        self.not_judged: set[int] = set()
        self.silences = 0
        self.watch = Watch(PATIENCE, GUARD)
        self.ends = np.zeros(self.count)

    def __enter__(self) -> Loop:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.call.rig_free(self.own)

    def begin(self, rows: Mapping[int, Beginning]) -> None:
        """Begin runs in these rows."""
        if not rows:
            return
        form = self.rig.form
        for row, one in rows.items():
            errors = None if one.errors is None else one.errors.ctypes.data
            self.call.rig_begin(self.own, row, one.end_speed, errors, ctypes.addressof(one.wheelsets))
            self.ends[row] = one.end_speed
            self.messages.pop(row, None)
            self.not_judged.discard(row)
            self.valves[row] = 0
        if isinstance(form, Arrays):
            form.controller.start(np.array(list(rows)), self.count, self.wheelsets, self.rig.settings.period)
        elif form is not None and not isinstance(form, InC | Outside):
            for row in rows:
                self.each[row] = None  # the previous one ends first: an FMU may not allow a second instance
                self.each[row] = Supervised(form(), self.wheelsets, PATIENCE, GUARD)
        self._look(rows)

    def _look(self, rows: Iterable[int]) -> None:
        """Take the first sample of new rows; for a controller in C this happens together with its first step."""
        shown, status = self.instances.output_values, self.instances.status
        for row in rows:
            self.instances.read_outputs(row, row + 1)
            if not self.in_c:
                self.call.rig_sample(self.own, row, int(status[row]), shown[row].ctypes.data)

    def go_on(self, samples: int) -> None:
        """Advance by `samples` sampling instants with the integration after each."""
        form, period = self.rig.form, self.rig.settings.period
        if self.in_c:
            self.instances.control(period, samples, self.call.rig_between, self.own)
            return
        ask = self._ask_all if isinstance(form, Arrays) else self._ask_each
        for _ in range(samples):
            if not np.any(self.score["state"] == RUNS):
                return
            ask()
            self.turn()

    def turn(self) -> None:
        """Apply `valves`, advance by one period and sample, all in C and in the threads of the instances."""
        self.instances.control(self.rig.settings.period, 2, self.call.rig_take_or_sample, self.own)

    def _ask_all(self) -> None:
        """Call a controller on arrays, unless all running rows have failed."""
        assert isinstance(self.rig.form, Arrays)
        running = np.flatnonzero(self.score["state"] == RUNS).tolist()
        if self.messages.keys() >= set(running):
            return
        controller, given = self.rig.form.controller, [one.copy() for one in (self.time, self.speeds)]
        for one in given:
            one.flags.writeable = False
        error = self._asked_of_all(controller, *given)
        if error:
            for row in running:
                self._give_up(row, error)

    def _asked_of_all(self, controller: ManyControllers, *given: NDArray[np.float64]) -> ControllerError | None:
        """Apply the answer of a controller on arrays; return the reason if there is no valid answer."""
        name, at, limit = f"The controller {type(controller).__name__}", float(self.time.max()), PATIENCE_WITH_ARRAYS
        if self.silences >= SILENCES:
            return not_asked(name)
        try:
            answer = np.asarray(within(Watch(limit, GUARD), lambda: controller.step(*given)))
            if answer.shape != self.valves.shape:
                raise ValueError(f"its commands must have the shape {self.valves.shape}; got {answer.shape}")
            self._take_all(answer)
            return None
        except LateError:
            words = f"{name} used more than {limit:g} s of processor time for its answer at {at:.6g} s; "
        except SilentError:
            self.silences += 1
            return NotJudgedError(silence(name, GUARD, f" at {at:.6g} s"))
        except (Exception, SystemExit) as error:
            words = f"{name} failed at {at:.6g} s ({failure(error, controller)}); "
        return ControllerError(words + "the brake stays applied.")

    def _take_all(self, answer: NDArray[np.integer]) -> None:
        """Apply the commands of all rows, except rows with values other than 0, 1 and 2."""
        commands, good = as_commands(answer)
        self.valves[good] = commands[good]
        for row in np.flatnonzero(~good & (self.score["state"] == RUNS)).tolist():
            words = (
                f"The controller gave {answer[row].tolist()} at {self.time[row]:.6g} s where 0 (apply), 1 (hold) or 2 "
            )
            words += "(vent) was due for each wheelset; the brake stays applied."
            self._give_up(row, ControllerError(words))

    def _give_up(self, row: int, error: ControllerError) -> None:
        """Keep the brake of a row applied; the first message counts."""
        if row not in self.messages and isinstance(error, NotJudgedError):
            self.not_judged.add(row)
        self.messages.setdefault(row, str(error))
        self.valves[row] = 0
        self.call.rig_give_up(self.own, row)

    def _ask_each(self) -> None:
        waiting = [row for row in np.flatnonzero(self.score["state"] == RUNS).tolist() if self.each[row]]
        times, speeds, every = self.time.tolist(), self.speeds.tolist(), self.valves.tolist()
        watch, failed = self.watch, dict[int, ControllerError]()

        def ask() -> None:
            while waiting:
                row = waiting[-1]
                one = self.each[row]
                assert one is not None
                try:
                    every[row] = one.unhurried(times[row], speeds[row])
                except ControllerError as error:
                    failed[row] = error
                if monotonic() - watch.begun > SHARED:
                    watch.end()
                    watch.begin()
                waiting.pop()

        while waiting and self.silences < SILENCES:
            try:
                within(watch, ask)
            except (LateError, SilentError) as raised:
                row, silent = waiting.pop(), isinstance(raised, SilentError)
                late = self.each[row]
                assert late is not None
                failed[row] = late.silent(times[row]) if silent else late.late(times[row])
                self.silences += silent
        failed |= {row: not_asked(f"The controller {one.name}") for row in waiting if (one := self.each[row])}
        self.valves[:] = every
        for row, error in failed.items():
            self.each[row] = None
            self._give_up(row, error)

    def stop(self, row: int) -> Stop:
        """Return the result of the run in a row."""
        one, by_flow, driven = self.score[row], self.rig.has_reservoir, self.rig.driven
        message = self.messages.get(row, "") or self._failure(one)
        stands = one["state"] == DONE and math.isnan(one["failed_at"])
        distance = float(one["distance"])
        if one["state"] == LOST:
            message = message or f"The machine went no further: {self.instances.message(row)}"
        elif one["state"] == TOO_LONG:
            missed = f"come to {self.ends[row]:g} m/s" if driven else "stop"
            message = message or f"It did not {missed}: {one['speed']:.1f} m/s after {one['time']:.0f} s."
        return Stop(
            distance if stands else None,
            float(one["speed"]),
            float(one["time"]),
            float(one["longest_lock"]),
            float(one["longest_skid"]),
            float(one["band"] / one["checked"]) if one["checked"] else 1.0,
            0.0 if driven else float(one["taken"] if by_flow else one["filled"] * CYLINDER_VOLUME / GAS),
            tuple(one["sliding"][: self.wheelsets].tolist()),
            float(one["reservoir"]) if by_flow else None,
            int(one["commands"]),
            message,
            row not in self.not_judged,
            jerk=float(one["jerk"]),
            longest_vent=float(one["longest_vent"]),
        )

    def _failure(self, one: Any) -> str:
        if math.isnan(one["failed_at"]):
            return ""
        if one["valve"] == BEYOND:
            return (
                f"The controller wrote behind its memory (wheel_slide_size asked for {self.bytes} bytes) or behind its "
                f"{self.wheelsets} valves at {one['failed_at']:.6g} s; the brake stays applied."
            )
        return (
            f"The controller gave {one['answer']} for valve {one['valve'] + 1} at {one['failed_at']:.6g} s where 0 "
            "(apply), 1 (hold) or 2 (vent) was due; the brake stays applied."
        )

"""Run an FMU in real time on this computer, one step at each tick of the clock, and report the times of steps.

  bogie-braking pace                                          the planar bogie, 10 s with steps of 1 ms
  bogie-braking pace spatial --step 0.5ms --seconds 60        the bogie in 3D, for a minute
  bogie-braking pace coach --level spatial                    the coach
  bogie-braking pace --step 10ms --integration-step 1ms       ten integrator steps in each communication step
  bogie-braking pace --step 10ms --integration-step 0         adaptive steps, whose cost has no bound
  bogie-braking pace wheelset --set initial_speed=20          any FMU of the list, here at 20 m/s
  bogie-braking pace build/native/BrakeCylinder.fmu           any file of an FMU, FMI 2.0 or 3.0
  taskset -c 1 chrt -f 80 bogie-braking pace                  on a separate processor, in the real-time class of Linux
  bogie-braking pace --json | jq .overruns                    for a program

Vehicles make a stop from 8 m/s with lock-up, release and flange contact, and then stand; other FMUs keep their start
values. Logging is off. A step here sets the inputs and calls doStep, through Python, which takes microseconds of it.
An overrun is a step that ends after the next should have begun. The bar is drawn while the program waits for the next
step: with steps below 0.5 ms use --quiet.

Exit status: 0 no overrun; 1 overruns; 2 bad input; 3 the simulation failed; 130 interrupted with Ctrl-C.
"""

from __future__ import annotations

import argparse
import gc
import json
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from bogie_braking.common_options import add_speech, bars, describe
from bogie_braking.exit_status import DOES_NOT_HOLD, HOLDS
from bogie_braking.reporting.progress import counting
from fmu_src.cosimulation import CosimulationError
from fmu_src.suggestion import suggestion
from products.building import up_to_date
from products.dry_stops import stop_of
from products.kernel_runs import value_at
from products.registry import ALIASES, FMUS, fmu_named
from readers.command_line import quantity
from readers.extras import need
from readers.text import BadInputError, shown

if TYPE_CHECKING:
    from fmu_src.cosimulation.slave import FmuInstance

LEVELS = {"point": 1, "planar": 2, "spatial": 3}
#: Wheelsets of the FMUs that make a stop.
VEHICLES = {"bogie": 2, "vehicle": 4, "coal-wagon": 4}
#: Largest communication step, and longest run [s]; shortest step that a clock and Python can pace.
LARGEST_STEP, LONGEST, SHORTEST_STEP = 1.0, 86400.0, 2e-5
#: Last part of a wait, which polls the clock instead of sleeping, and interval of the progress bar [s].
WATCHED, DRAWN = 5e-4, 0.5
SHARES = {"median": 50.0, "99 %": 99.0, "99.9 %": 99.9, "longest": 100.0}


@dataclass(frozen=True)
class Pace:
    """A run: an FMU by its name or file, communication and integration step, duration [s], values, input histories.

    states_step: the integration step is stated, and must have an effect.
    """

    name: str
    path: Path
    step: float
    integration_step: float
    seconds: float
    values: dict[str, float] = field(default_factory=dict)
    inputs: dict[str, Sequence[tuple[float, float]]] = field(default_factory=dict)
    states_step: bool = False

    @property
    def steps(self) -> int:
        """Return the number of macro steps."""
        return round(self.seconds / self.step)


@dataclass(frozen=True)
class Paced:
    """Duration of each step, and delay of its start [s]."""

    took: np.ndarray
    late: np.ndarray
    step: float

    @property
    def overruns(self) -> int:
        """Return the number of steps that ended after the next should have begun."""
        return int(np.count_nonzero(self.took + self.late > self.step))

    def shares(self) -> dict[str, dict[str, float]]:
        """Return percentiles of the duration of a step and of the delay of its start [s], and of the used share of the
        step.
        """
        of = {"took": self.took, "share": self.took / self.step, "late": self.late}
        found = {name: np.percentile(values, list(SHARES.values())).tolist() for name, values in of.items()}
        return {name: dict(zip(SHARES, values, strict=True)) for name, values in found.items()}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of `pace`."""
    describe(parser, __doc__)
    text = "an FMU of the list, the file of one, or a level of the bogie: point, planar, spatial (default: planar)"
    parser.add_argument("name", nargs="?", default="planar", help=text)
    parser.add_argument("--level", choices=list(LEVELS), help="level of a vehicle (default: planar)")
    step, text = quantity("--step", "s", SHORTEST_STEP, LARGEST_STEP), "host step, as 1ms or 0.001 in seconds"
    parser.add_argument("--step", type=step, default="1ms", metavar="TIME", help=f"{text} (default: 1ms)")
    text = "step of the integrator, 0: chosen by the error (default: the host step)"
    within = quantity("--integration-step", "s", 0.0, LARGEST_STEP)
    parser.add_argument("--integration-step", type=within, metavar="TIME", help=text)
    text, length = "length of the run, as 10 or 1min (default: 10 s)", quantity("--seconds", "s", 0.0, LONGEST)
    parser.add_argument("--seconds", type=length, default=10.0, metavar="TIME", help=text)
    text = "a parameter or a constant input, as NAME=VALUE; may be given several times"
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", help=text)
    add_speech(parser)


def names() -> Sequence[str]:
    """Return the names of FMUs, their aliases, and the levels of the bogie."""
    return [*FMUS, *ALIASES, *LEVELS]


def pace_of(chosen: argparse.Namespace) -> Pace:
    """Return the run that the command line requests."""
    step: float = chosen.step
    if chosen.seconds < step:
        raise BadInputError(f"--seconds must be at least one step of {step:g} s; got {chosen.seconds:g} s.")
    within = step if chosen.integration_step is None else chosen.integration_step
    name, level = fmu_named(chosen.name), chosen.level or "planar"
    if chosen.name in LEVELS:
        name, level = "bogie", chosen.name
    if chosen.level and (chosen.name in LEVELS or name not in VEHICLES):
        raise BadInputError(f"--level has no effect on {chosen.name}; it belongs to {', '.join(VEHICLES)}.")
    values, inputs = values_of(chosen.set), {}
    stated = chosen.integration_step is not None
    if stated and "integration_step" in values:
        raise BadInputError("--integration-step and --set integration_step state the same. Leave one out.")
    within = values.get("integration_step", within)
    if name in VEHICLES:
        stop = stop_of(VEHICLES[name], level=float(LEVELS[level]))
        values = {**stop.values, **values}
        inputs = {one: history for one, history in stop.inputs.items() if one not in values}
    return Pace(name, path_of(name), step, within, chosen.seconds, values, dict(inputs), stated)


def path_of(name: str) -> Path:
    """Return the FMU of a name or file."""
    if name in FMUS:
        return up_to_date(name, "native")
    if name.endswith(".fmu"):
        if Path(name).is_file():
            return Path(name)
        raise BadInputError(f"The file {name} does not exist. Check the path.")
    raise BadInputError(
        f"There is no FMU {name}; {suggestion(name, names(), 'these are: ' + ', '.join(names()) + '.')}"
    )


def values_of(texts: Sequence[str]) -> dict[str, float]:
    """Return numbers by name."""
    values = {}
    for text in texts:
        name, _, value = text.partition("=")
        try:
            values[name] = float(value)
        except ValueError:
            raise BadInputError(f"--set must be NAME=NUMBER, as level=2; got {shown(text)}.") from None
    return values


def paced(pace: Pace, drawn: Callable[[int], object]) -> Paced:
    """Make all steps, each at its time."""
    try:
        from fmu_src.cosimulation.slave import FmuInstance  # with FMPy, an optional dependency

        slave = FmuInstance(pace.path)
    except OSError as error:
        raise CosimulationError(
            f"{pace.path} cannot be unpacked: {error}; make room, or name a folder in TMPDIR."
        ) from error
    with slave:
        slave.fmu.setDebugLogging(False, [])
        values = dict(pace.values)
        for name in values:
            if name not in slave.units:
                raise BadInputError(f"{slave.name} has no variable {name}; {suggestion(name, slave.units)}")
        if "integration_step" in slave.units:
            values.setdefault("integration_step", pace.integration_step)
        elif pace.states_step:
            raise BadInputError(f"--integration-step has no effect on {slave.name}, which has no such parameter.")
        times = np.arange(pace.steps) * pace.step
        rows = [{one: value_at(history, at, after=True) for one, history in pace.inputs.items()} for at in times]
        slave.start(**values)
        gc.collect()
        gc.disable()
        try:
            return keep_pace(slave, pace.step, rows, drawn)
        finally:
            gc.enable()


def keep_pace(
    slave: FmuInstance, step: float, rows: Sequence[dict[str, float]], drawn: Callable[[int], object]
) -> Paced:
    """Make one step at each tick of the clock."""
    took, late = np.zeros(len(rows)), np.zeros(len(rows))
    clock, told, number = time.perf_counter, 0, 0
    begin = last = clock() + 10 * WATCHED
    try:
        for number, row in enumerate(rows):
            due = begin + number * step
            if clock() - last > DRAWN:
                drawn(number - told)
                told, last = number, clock()
            while (left := due - clock()) > 0.0:
                if left > 2 * WATCHED:
                    time.sleep(left - WATCHED)
            start = clock()
            slave.set(**row)
            slave.step(number * step, step)
            took[number], late[number] = clock() - start, start - due
    except KeyboardInterrupt:
        raise KeyboardInterrupt(f"Interrupted after {number} of {len(rows)} steps.") from None
    return Paced(took, late, step)


def run(chosen: argparse.Namespace) -> int:
    """Run in real time; return DOES_NOT_HOLD if a step overran.

    Raises BadInputError, CompilerError, CosimulationError.
    """
    need("fmpy")
    pace = pace_of(chosen)
    with bars(chosen), counting(text=f"pace of {pace.name}", total=pace.steps, unit="step") as bar:
        found = paced(pace, bar.update)
    if chosen.json:
        print(json.dumps(document(pace, found), indent=2))
    elif not chosen.quiet:
        print(report(pace, found))
    return DOES_NOT_HOLD if found.overruns else HOLDS


def document(pace: Pace, found: Paced) -> dict[str, Any]:
    """Return the results for programs; times in s."""
    about = {"fmu": pace.name, "step": pace.step, "integration_step": pace.integration_step, "seconds": pace.seconds}
    return {**about, "steps": pace.steps, "overruns": found.overruns, "platform": sys.platform, **found.shares()}


def report(pace: Pace, found: Paced) -> str:
    """Return the results as text."""
    shares, within = found.shares(), f"{pace.integration_step * 1e3:g} ms"
    within = "chosen by the error" if pace.integration_step == 0.0 else f"of {within}"
    texts = {"took": "a step took [us]", "share": "of the host step [%]", "late": "a step began late by [us]"}
    factors = {"took": 1e6, "share": 1e2, "late": 1e6}
    lines = [f"{pace.name}: {pace.steps} steps of {pace.step * 1e3:g} ms in real time, integration steps {within}", ""]
    lines.append(" " * 26 + "".join(at.rjust(10) for at in SHARES))
    for name, text in texts.items():
        lines.append(text.ljust(26) + "".join(f"{shares[name][at] * factors[name]:10.4g}" for at in SHARES))
    return "\n".join([*lines, "", f"Overruns: {found.overruns} of {pace.steps}."])

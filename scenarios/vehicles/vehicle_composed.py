"""Vehicle and brakes as one FMU or as five that a master couples: the cost of each, and the error of the coupling."""

import time as clock
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import LEADING, THESIS, TRAILING, plt, titled
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, Row, at_most, measured, near
from bogie_braking.reporting.scenario import Options, Scenario
from fmu_src.cosimulation.master import Coupling, Master
from fmu_src.cosimulation.recording import Recording
from fmu_src.cosimulation.slave import FmuInstance
from products.building import up_to_date
from products.machine import coach, coach_brake
from scenarios.bench.coupled_machine import CoupledMachine

#: Initial speed of the full brake [m/s], applied at t = 0, and simulated time [s]: the brake reaches 95 %.
SPEED, DURATION = 25.0, 2.0
#: Macro steps [s], the first one that of the rows; those of a quick run; relative tolerance of the distance.
STEPS = (1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 1e-2, 2e-2)
QUICK_STEPS = (2e-3, 2.5e-3, 4e-3, 5e-3, 8e-3, 1e-2, 1.25e-2, 1.6e-2, 2e-2, 2.5e-2)
ALLOWED = 1e-6
#: Macro steps at which costs are compared [s].
COSTED = (2e-3, 1e-2)
#: Tolerances of all FMUs. With the tight one their own errors are far below the coupling's; the other is the default.
TIGHT, DEFAULT = 1e-10, 1e-6
MASTERS = {"held": Master(), "lines": Master(extrapolated=True)}
ORDERS = {"held": 1.0, "lines": 2.0}
#: Tolerance of the slopes, over steps whose next term of the series is a few percent.
ORDER_BAND = 0.1


@dataclass(frozen=True)
class Braking:
    """Distance [m] after DURATION, and wall time [s]."""

    distance: float
    seconds: float


@dataclass(frozen=True)
class CoupledRuns:
    """Runs by macro step: coupled, by master; composed, by tolerance; and the distance of reference [m]."""

    coupled: dict[str, dict[float, Braking]]
    composed: dict[float, dict[float, Braking]]
    reference: float

    def error(self, run: Braking) -> float:
        """Return the relative error of the distance."""
        return abs(run.distance / self.reference - 1.0)


def composed(slave: FmuInstance, tolerance: float, step: float) -> Braking:
    """Run one FMU, with one call each step."""
    machine = coach()
    demands = {f"pressure_demand_{number}": machine.full_pressure for number in machine.numbers}
    values = {"level": 2.0, "initial_speed": SPEED, "tolerance": tolerance}
    slave.restart(values, **demands)
    begin = clock.perf_counter()
    for number in range(round(DURATION / step)):
        slave.step(number * step, step)
    return Braking(slave["distance"], clock.perf_counter() - begin)


def coupled(machine: CoupledMachine, master: Master, step: float) -> Braking:
    """Run five FMUs: the torques of the cylinders to the vehicle, wheel speeds back."""
    brake = {**coach_brake().values(), "tolerance": TIGHT}
    machine.start({"level": 2.0, "initial_speed": SPEED, "tolerance": TIGHT}, [brake] * len(machine.brakes))
    machine.demand(coach().full_pressure)
    coupling = machine.coupling()
    coupling = Coupling(coupling.slaves, coupling.connections, master)
    begin = clock.perf_counter()
    for _ in coupling.run(DURATION, step):
        pass
    return Braking(machine.vehicle["distance"], clock.perf_counter() - begin)


def measure(steps: Sequence[float]) -> CoupledRuns:
    with ExitStack() as stack:
        one = stack.enter_context(FmuInstance(up_to_date("braked-vehicle", "native")))
        five = stack.enter_context(CoupledMachine("vehicle", coach().numbers))
        count = len(steps) * (len(MASTERS) + 2)
        bar = stack.enter_context(counting(total=count, unit="run"))

        def each(runs: Iterator[tuple[float, Braking]]) -> dict[float, Braking]:
            found = {}
            for step, run in runs:
                found[step] = run
                bar.update()
            return found

        return CoupledRuns(
            {name: each((s, coupled(five, master, s)) for s in steps) for name, master in MASTERS.items()},
            {tolerance: each((s, composed(one, tolerance, s)) for s in steps) for tolerance in (TIGHT, DEFAULT)},
            composed(one, TIGHT / 100, DURATION).distance,
        )


def order(errors: Mapping[float, float]) -> float:
    """Return the slope of the error over the macro step, both as logarithms."""
    return float(np.polyfit(np.log(list(errors)), np.log(list(errors.values())), 1)[0])


def rows_of(found: CoupledRuns) -> list[Row]:
    source = "difference of BrakedVehicle.fmu and its parts coupled"
    rows = []
    for name, runs in found.coupled.items():
        errors = {step: found.error(run) for step, run in runs.items()}
        rows.append(measured(f"coupled, {name}: order", "1", order(errors), "theory", near(ORDERS[name], ORDER_BAND)))
        shown = min(errors)
        label = f"coupled, {name}: error of distance at {1e3 * shown:g} ms"
        rows.append(measured(label, "1", errors[shown], source, at_most(ALLOWED)))
    worst = max(found.error(run) for run in found.composed[TIGHT].values())
    rows.append(measured("one FMU: largest error of distance", "1", worst, "any step: no coupling", at_most(1e-9)))
    lost = max(found.error(run) for run in found.composed[DEFAULT].values())
    rows.append(measured("one FMU, default tolerance: the same", "1", lost, "any step", at_most(ALLOWED)))
    for step in COSTED:
        ratio = found.coupled["held"][step].seconds / found.composed[TIGHT][step].seconds
        label = f"cost of coupling at {1e3 * step:g} ms over that of one FMU"
        rows.append(measured(label, "1", ratio, f"measured now, tolerance {TIGHT:g}"))
    return rows


def run(options: Options, quick: bool = False) -> Report:
    steps = QUICK_STEPS if quick else STEPS
    found = measure(steps)
    names = [*(f"coupled_{name}" for name in MASTERS), "one_fmu", "one_fmu_default"]
    columns = [*found.coupled.values(), *found.composed.values()]
    table = [
        [step, *(value for runs in columns for value in (found.error(runs[step]), runs[step].seconds / DURATION))]
        for step in steps
    ]
    units = {f"{name}_{what}": "1" for name in names for what in ("error", "cost")}
    remarks = [
        "Planar level, timed cylinders, full brake, all roll. Held: the torque of the end of each step, so the vehicle "
        "gets half a step of its growth too early; lines: the chord of the torque within the step. Coupled FMUs run at "
        f"the tolerance {TIGHT:g}, so that the coupling's error is what is seen."
    ]
    series = Recording({"macro_step": "s"} | units, table)
    return Report(rows_of(found), series, lambda: draw(found), dict(coach_brake().values()), DURATION, remarks)


def draw(found: CoupledRuns) -> Figure:
    figure, axes = plt.subplots(1, 2, figsize=(11.0, 4.8), sharey=True)
    curves = [
        ("coupled, held", found.coupled["held"], TRAILING, "o"),
        ("coupled, lines", found.coupled["lines"], LEADING, "s"),
        ("one FMU, default tolerance", found.composed[DEFAULT], THESIS, "^"),
        (f"one FMU, tolerance {TIGHT:g}", found.composed[TIGHT], "#333333", "v"),
    ]
    for name, runs, colour, marker in curves:
        steps = np.array(list(runs))
        errors = np.maximum([found.error(one) for one in runs.values()], 1e-14)
        cost = 1e3 * np.array([one.seconds for one in runs.values()]) / DURATION
        style = {"color": colour, "marker": marker, "markersize": 4.0, "linewidth": 1.0}
        axes[0].plot(1e3 * steps, errors, label=name, **style)
        axes[1].plot(cost, errors, **style)
    finish(axes[0], "error of distance [1] over the macro step", "macro step [ms]")
    finish(axes[1], "error over cost", "time to compute one second through fmpy [ms]")
    axes[0].legend(fontsize=8)
    whole, parts = (runs[COSTED[0]].seconds for runs in (found.composed[TIGHT], found.coupled["held"]))
    return titled(figure, f"At {1e3 * COSTED[0]:g} ms five coupled FMUs cost {parts / whole:.0f} times one")


def finish(axis: Axes, title: str, label: str) -> None:
    axis.set(xscale="log", yscale="log")
    axis.xaxis.set_major_formatter("{x:g}")
    axis.set(title=title, xlabel=label)


SCENARIO = Scenario("vehicle-composed", "Vehicle and brakes as one FMU or as five coupled: error against cost", run)

"""Cost and error of each brake model of a train: whole distributors, empirical valves, a delay."""

from __future__ import annotations

import time as clock
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import BOGIE as GREY
from bogie_braking.reporting.plots import FOUR, charts
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, at_most, measured
from bogie_braking.reporting.scenario import Options, Scenario
from fmu_src.cosimulation.recording import Recording
from products.train.brake_model import BRAKE_MODELS_BY_COST
from products.train.train import Train
from scenarios.bench.train_runs import train_of

#: Lengths of the trains behind the errors in products/train/brake_model.py, and of the trains that test them [m].
#: Those of a quick run are the first ones.
FITTED, HELD = (300.0, 900.0), (250.0, 400.0, 1200.0)
SPEED, STRIDE, LONGEST = 25.0, 2.0, 250.0
COMMANDS = {"emergency": ("emergency", 0.0), "full service": ("service", 1.0), "half service": ("service", 0.4)}
#: Compressions below this depend on a preload and are not compared [N].
LEAST = 60e3
REFERENCE = "whole, eight cells"


@dataclass(frozen=True)
class ModelledStop:
    """A stop of one train."""

    length: float
    position: str
    command: str

    def stop(self, brake_model: str) -> tuple[float, float, float]:
        """Return distance [m], largest compression [N], and pace in units of real time."""
        train = Train(
            train_of(self.length, position=self.position),
            speed=SPEED,
            settings=BRAKE_MODELS_BY_COST[brake_model].settings,
        )
        start = float(train.distance[0])
        train.drive(*COMMANDS[self.command])
        begin = clock.perf_counter()
        while train.speed.max() > 0.0 and train.time < LONGEST:
            train.advance(STRIDE)
        pace = train.time / (clock.perf_counter() - begin)
        return float(train.distance[0]) - start, train.largest_compression, pace


def scenes(lengths: tuple[float, ...]) -> list[ModelledStop]:
    return [ModelledStop(length, position, command) for length in lengths for position in "PG" for command in COMMANDS]


@dataclass(frozen=True)
class Error:
    """Errors of a brake model over cases: largest errors of distance and force [1], and the least pace."""

    distance: float
    force: float
    pace: float


def errors(
    brake_model: str, found: Mapping[tuple[ModelledStop, str], tuple[float, float, float]], lengths: tuple[float, ...]
) -> Error:
    """Return the errors against the reference; no train is longer than the brake model allows."""
    within = [scene for scene in scenes(lengths) if scene.length <= BRAKE_MODELS_BY_COST[brake_model].longest]
    pairs = [(found[one, brake_model], found[one, REFERENCE]) for one in within]
    distance = max(abs(a[0] / b[0] - 1) for a, b in pairs)
    force = max((abs(a[1] / b[1] - 1) for a, b in pairs if b[1] > LEAST), default=0.0)
    return Error(distance, force, min(a[2] for a, _ in pairs))


def run(options: Options, quick: bool = False) -> Report:
    on_fitted, on_held = (lengths[: 1 if quick else None] for lengths in (FITTED, HELD))
    shown = max(on_held)
    tries = [(one, brake_model) for one in scenes(on_fitted + on_held) for brake_model in BRAKE_MODELS_BY_COST]
    found = {(one, brake_model): one.stop(brake_model) for one, brake_model in counting(tries, "stops", unit="stop")}
    held = {
        brake_model: errors(brake_model, found, on_held)
        for brake_model in BRAKE_MODELS_BY_COST
        if brake_model != REFERENCE
    }
    fitted = {brake_model: errors(brake_model, found, on_fitted) for brake_model in held}
    rows = []
    for brake_model, one in held.items():
        claim, source = BRAKE_MODELS_BY_COST[brake_model], "what `select_brake_model` counts with, from other trains"
        for name, error, most in (("distance", one.distance, claim.distance), ("compression", one.force, claim.force)):
            asked = at_most(100 * most)
            rows.append(measured(f"{brake_model}: largest error of {name}", "%", 100 * error, source, asked))
    for brake_model, one in fitted.items():
        for name, error in (("distance", one.distance), ("compression", one.force)):
            rows.append(measured(f"{brake_model}: error of {name}, fitted half", "%", 100 * error, "300 and 900 m"))
    pace = {
        brake_model: float(np.median([found[one, brake_model][2] for one in scenes((shown,))]))
        for brake_model in BRAKE_MODELS_BY_COST
    }
    for brake_model, times in pace.items():
        rows.append(measured(f"{brake_model}: times real time, {shown:g} m", "1", times, "measured, one core"))
    cheap = held["empirical, half a cell"]
    said = [
        f"Empirical valves on half a cell a vehicle err by {100 * cheap.distance:.1f} % of the distance and "
        f"{100 * cheap.force:.1f} % of the compression at {pace['empirical, half a cell']:.0f} times real time.",
        "A delay errs by a quarter of the distance in service of 1200 m: the pipe sets the pace there.",
    ]
    units = {"time": "s", "length": "m", "stopping_distance": "m", "largest_compression": "N", "pace": "1"}
    series = Recording(units, [[n, scene.length, *stop] for n, ((scene, _), stop) in enumerate(found.items())])
    seconds = len(tries) * 40.0
    return Report(rows, series, lambda: draw(found, pace, on_held), {"speed": SPEED}, seconds, said)


def draw(
    found: Mapping[tuple[ModelledStop, str], tuple[float, float, float]],
    pace: Mapping[str, float],
    on_held: tuple[float, ...],
) -> Figure:
    cheap, names = "empirical, half a cell", list(BRAKE_MODELS_BY_COST)[:-1]
    off, times = 100 * errors(cheap, found, on_held).distance, float(f"{pace[cheap]:.2g}")
    message = f"Empirical valves err by {off:.1f} % and run {times:g} times real time"
    figure, axes = charts(message, ("", ""), (10.0, 4.6), sharey=True)
    for axis, which, label in zip(axes, (0, 1), ("stopping distance", "largest compression"), strict=True):
        for colour, mark, length in zip((*FOUR, GREY), "o^sDv", sorted({one.length for one, _ in found}), strict=False):
            kept = [scene for scene in scenes((length,)) if which == 0 or found[scene, REFERENCE][1] > LEAST]
            due = [found[one, REFERENCE][which] for one in kept]
            pairs = {name: zip([found[one, name][which] for one in kept], due, strict=True) for name in names}
            off_by = [max((100 * abs(a / b - 1) for a, b in pairs[name]), default=np.nan) for name in names]
            axis.loglog(off_by, [pace[name] for name in names], mark + "-", color=colour, label=f"{length:g} m")
        axis.set(xlabel=f"largest error of the {label} [%]")
    for name in names:
        axes[1].annotate(name, (1.02, pace[name]), xycoords=("axes fraction", "data"), va="center", fontsize=8)
    axes[0].set_ylabel(f"times real time, {max(on_held):g} m")
    axes[0].legend(fontsize=8)
    return figure


SCENARIO = Scenario("train-brake-models", "Cost, error and limits of each brake model of a train", run)

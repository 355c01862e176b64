"""Evidence on a train's brake: mechanisms switched on one at a time, against published stopping distances.

ARTC's tables of four trains. Mechanisms are chosen by sources and on two trains, and reported on the two others. One
number of each train, the size of its brake, is fitted to one stop on level track. Driver's time, margin and brakes
inside the tables are not published, so that errors of the reporting trains are only compared with those of plain full
service.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import FOUR, charts
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, Row, at_most, measured
from bogie_braking.reporting.scenario import Options, Scenario
from evidence.trains.brake_switches import (
    AFTER,
    BEFORE,
    CHOOSING,
    REPORTING,
    SERVICE,
    SWITCHES,
    Switches,
    Told,
    after,
    distances,
    errors,
    rms,
    told,
)
from evidence.trains.point_train import Numbers
from evidence.trains.ramp_stops import MODELS, RampStop, fitted
from fmu_src.cosimulation.recording import Recording

TRAINS = (*CHOOSING, *REPORTING)
#: Gradients of the figure, and the steepest that is compared [1]; speeds of the switches [km/h].
GRADIENTS = {"1:60 up": 1 / 60, "level": 0.0, "1:100 down": -1 / 100, "1:60 down": -1 / 60}
STEEPEST, SPEEDS = 1 / 59.0, (20.0, 60.0, 110.0)
#: Random draws of unknown inputs, those of a quick run, and their seed. Bound of the rms error of a reporting train:
#: half of that before.
DRAWS, QUICK_DRAWS, SEED, HALF = 16, 2, 1, 0.5
#: Ranges of what is not known: rate of the driver's valve [bar/s], branches [l], factor on the pipe's friction [1], and
#: margin [1]; driver's time [s]; GW10's length [m], whose consist is not published.
RANGES = {"rate": (0.14, 0.5), "branch": (1.0, 5.0), "friction": (1.0, 1.5), "margin": (1.06, 1.26)}
RANGES |= {"delay": (0.0, 4.0)}
LENGTHS = (680.0, 1800.0)
#: Length of the train whose build-up time is compared with formulas [m], and mass of its wagons [kg].
SHORT, SHORT_MASS = 600.0, 1.5e6


@dataclass(frozen=True)
class TrainErrors:
    """Relative errors of a train: as compared first, in full service, with the chosen mechanisms [1]."""

    before: Numbers
    service: Numbers
    after: Numbers


@dataclass(frozen=True)
class Moved:
    """A train with a switch: its build-up time, and that of an emergency at SHORT [s]; rms error [1]; distances [m]."""

    build_up: float
    short: float
    error: float
    distance: Numbers


def run(options: Options, quick: bool = False) -> Report:
    draws = QUICK_DRAWS if quick else DRAWS
    switches = dict(list(SWITCHES.items())[:: 5 if quick else 1])
    models = list(MODELS)[-1:] if quick else list(MODELS)
    found = {
        name: TrainErrors(*(errors(one, told(name)) for one in (BEFORE, SERVICE, after(name))))
        for name in counting(TRAINS, "trains", unit="train")
    }
    forms = {(name, model): fitted(told(name), model) for name in TRAINS for model in models}
    table = told("GW40", STEEPEST)
    plain = moves(SERVICE, table)
    moved = {name: moves(one, table) for name, one in counting(switches.items(), "switches", unit="switch")}
    bands = {name: band(told(name, STEEPEST), draws) for name in REPORTING}
    rows = [row for name in TRAINS for row in rows_of_train(name, found[name])]
    rows += [row for name in TRAINS for row in rows_of_forms(name, forms)]
    rows += [measured("GW40, full service: build-up time", "s", plain.build_up, "equivalent time of all cylinders")]
    rows += [measured("600 m, emergency in P: build-up time", "s", plain.short, "equivalent time of all cylinders")]
    rows += [row for name, one in moved.items() for row in rows_of_switch(name, one, plain)]
    rows += [
        measured(f"{name}: published distances within {draws} draws", "%", 100 * inside(told(name, STEEPEST), one))
        for name, one in bands.items()
    ]
    parameters = {"choosing": CHOOSING, "reporting": REPORTING, "ranges": RANGES, "draws": draws, "seed": SEED}
    return Report(rows, series(found), lambda: draw(found), parameters, 0.0, said(found, forms))


def rows_of_train(name: str, train_errors: TrainErrors) -> list[Row]:
    """Return rms and largest errors of a train up to STEEPEST, and of all its stops."""
    part = "reporting" if name in REPORTING else "choosing"
    rows, bound, kept = [], None, flat(name)
    for words, values in (
        ("emergency", train_errors.before),
        ("full service", train_errors.service),
        ("chosen", train_errors.after),
    ):
        if words == "chosen" and name in REPORTING:
            bound = at_most(100 * HALF * rms(train_errors.service[kept]))
        source, many = f"ARTC ESD-05-03, {part} train", f"{np.isnan(values).sum()} stops do not end"
        rows.append(measured(f"{name}, {words}: rms error up to 1:60", "%", 100 * rms(values[kept]), source, bound))
        largest = 100 * float(np.nanmax(np.abs(values[kept])))
        rows.append(measured(f"{name}, {words}: largest error up to 1:60", "%", largest, source))
        rows.append(measured(f"{name}, {words}: rms error up to 1:33", "%", 100 * rms(values), source, None, many))
    return rows


def flat(name: str) -> np.ndarray:
    """Return which points of a table are not steeper than STEEPEST."""
    return np.asarray(np.abs(told(name).gradient) <= STEEPEST)


def rows_of_forms(name: str, forms: Mapping[tuple[str, str], tuple[RampStop, float]]) -> list[Row]:
    """Return what the table says by itself: the error of each closed form, and its numbers."""
    rows = []
    for (train, model), (stop, error) in forms.items():
        if train != name:
            continue
        words = f"{name}, closed form {model}"
        rows.append(measured(f"{words}: rms error", "%", 100 * error, "25 stops of the table"))
        if "margin" in MODELS[model]:
            rows.append(measured(f"{words}: margin", "1", stop.margin, "25 stops of the table"))
    return rows


def rows_of_switch(name: str, one: Moved, plain: Moved) -> list[Row]:
    """Return what a switch moves on GW40, and in an emergency at 600 m."""
    source = "ARTC, choosing train, fitted at 80 km/h on level track"
    rows = [
        measured(f"{name}: rms error", "%", 100 * one.error, source),
        measured(f"{name}: later by", "s", one.build_up - plain.build_up, "equivalent build-up time of GW40"),
        measured(f"{name}: later at 600 m by", "s", one.short - plain.short, "emergency in P, 600 m"),
    ]
    places = [f"{speed:g} km/h, {gradient}" for gradient in ("level", "1:100 down", "1:60 down") for speed in SPEEDS]
    moved = 100 * (one.distance / plain.distance - 1.0)
    return rows + [measured(f"{name}: {at}", "%", of, source) for at, of in zip(places, moved, strict=True)]


def moves(switches: Switches, table: Told) -> Moved:
    """Return build-up times, error and distances of a table, fitted to one stop on level track."""
    own = switches.train(table.inputs)
    found = distances(switches, table, own)
    places = [table.place(speed, gradient) for gradient in (0.0, -1 / 100, -1 / 60) for speed in SPEEDS]
    inputs = {**table.inputs, "length": SHORT, "locomotives": 1.0, "wagons.mass": SHORT_MASS}
    short = replace(switches, drive=BEFORE.drive).train(inputs)
    return Moved(own.build_up, short.build_up, rms(found / table.distance - 1.0), found[places])


def band(table: Told, draws: int) -> tuple[Numbers, Numbers]:
    """Return the least and largest distance of a table over draws of what is not known [m]."""
    generator = np.random.default_rng(SEED)
    rows = []
    for number in range(draws):
        drawn = {name: float(generator.uniform(*limits)) for name, limits in RANGES.items()}
        one = replace(
            AFTER,
            columns={**AFTER.columns, "branch": drawn["branch"]},
            locomotive={"service_rate": drawn["rate"]},
            friction=drawn["friction"],
            margin=drawn["margin"],
            delay=drawn["delay"],
            released="locomotive" if number % 2 else "",
        )
        inputs = dict(table.inputs)
        if table.name == "GW10":
            length = float(generator.uniform(*LENGTHS))
            inputs |= {"wagons.mass": inputs["wagons.mass"] * length / inputs["length"], "length": length}
        rows.append(distances(one, replace(table, inputs=inputs)))
    return np.nanmin(rows, axis=0), np.nanmax(rows, axis=0)


def inside(table: Told, limits: tuple[Numbers, Numbers]) -> float:
    """Return the share of published distances in a band; they are rounded to 1 m."""
    least, most = limits
    within = (table.distance >= least - 0.5) & (table.distance <= most + 0.5)
    return float(np.mean(within))


def said(found: Mapping[str, TrainErrors], forms: Mapping[tuple[str, str], tuple[RampStop, float]]) -> list[str]:
    """Return the sentences of the summary."""
    errors_of = {
        name: [100 * rms(one[flat(name)]) for one in (found[name].service, found[name].after)] for name in REPORTING
    }
    worst = max(100 * forms[name, list(MODELS)[-1]][1] for name in TRAINS)
    return [
        "On trains that were not used to choose, the rms error up to 1:60 falls from "
        + " and ".join(f"{was:.0f} to {now:.1f} % ({name})" for name, (was, now) in errors_of.items())
        + ".",
        f"One deceleration, ramp, margin and fall with speed meet each table within {worst:.1f} % rms: no train needs "
        "a brake that depends on the gradient.",
    ]


def series(found: Mapping[str, TrainErrors]) -> Recording:
    """Return errors over speed for each train and gradient of the figure."""
    speeds = np.arange(20.0, 125.0, 5.0)
    recording = Recording({"speed": "km/h"}, speeds[:, None])
    for name, one in found.items():
        for gradient in GRADIENTS:
            for words in ("service", "after"):
                at, error = curve(told(name), getattr(one, words), gradient)
                column = np.full(speeds.size, np.nan)
                column[np.isin(speeds, at)] = error[np.isin(at, speeds)]
                recording.add(f"error_{words}_{name}_{gradient.replace(':', '_').replace(' ', '_')}", "1", column)
    return recording


def curve(table: Told, values: Numbers, gradient: str) -> tuple[Numbers, Numbers]:
    """Return speeds [km/h] and values of a table on a gradient of the figure."""
    kept = np.abs(table.gradient - GRADIENTS[gradient]) < 1e-4
    return np.round(3.6 * table.speed[kept], 6), values[kept]


def draw(found: Mapping[str, TrainErrors]) -> Figure:
    shown = {"service": "full service", "after": "chosen"}
    titles = [f"{name}, {words}" for words in shown.values() for name in found]
    size = (13.0, 6.4)
    message = "Later brakes, composite blocks and a margin meet published stops on gradients"
    figure, axes = charts(message, titles, size, "speed [km/h]", columns=4, sharey=True)
    for axis, (words, name) in zip(axes, ((w, n) for w in shown for n in found), strict=True):
        draw_errors(axis, told(name), getattr(found[name], words))
    for axis in axes[::4]:
        axis.set_ylabel("error of the distance [%]")
    axes[1].legend(fontsize=8)
    return figure


def draw_errors(axis: Axes, table: Told, values: Numbers) -> None:
    """Draw errors over speed, a line for each gradient."""
    for colour, mark, gradient in zip(FOUR, "v.^s", GRADIENTS, strict=True):
        speed, error = curve(table, 100 * values, gradient)
        axis.plot(speed, error, mark + "-", color=colour, label=gradient, markersize=3, linewidth=1.2)
    axis.axhline(0.0, color="black", linewidth=0.8)


SCENARIO = Scenario(
    "train-brake-evidence",
    "What is missing in a train's brake: mechanisms switched on one at a time against tables",
    run,
)

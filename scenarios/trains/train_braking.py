"""Emergency and full service of freight trains from 400 to 1500 m: pressures along the pipe, forces of couplers,
distances.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import FOUR, charts, one_word
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, Row, at_least, at_most, measured
from bogie_braking.reporting.scenario import Options, Scenario, Sweepable
from products.train.train import Train
from rbd_model.train.coupler import COUPLERS
from scenarios.bench.train_pressures import draw_pressures
from scenarios.bench.train_runs import TrainCourse, build_up_time, follow, propagation, seconds_of, stop, train_of

#: Lengths of the trains, of which a quick run has two [m], and speed [m/s].
LENGTHS, SPEED = (400.0, 750.0, 1000.0, 1500.0), 100 / 3.6
#: Positions of the distributors: common one of all vehicles, and number of vehicles at the head in G.
MODES = {"P": ("P", 0), "five in G": ("P", 5), "G": ("G", 0)}
COMMANDS = {"emergency": ("emergency", 0.0), "full service": ("service", 1.0)}
#: Length of the trains that are drawn [m], and lower limit of the wave speed of an emergency (UIC 540) [m/s].
DRAWN, WAVE = 750.0, 250.0


@dataclass(frozen=True)
class FreightTrain:
    """One train, its command and its coupler."""

    length: float
    mode: str
    command: str
    coupler: str = "screw"

    def train(self) -> Train:
        position, fast_from = MODES[self.mode]
        values = {"position": position, "fast_from": fast_from, "coupler": COUPLERS[self.coupler]()}
        return Train(train_of(self.length, **values), speed=SPEED)

    def run(self) -> tuple[Train, TrainCourse]:
        train = self.train()
        train.drive(*COMMANDS[self.command])
        return train, stop(train)

    @property
    def name(self) -> str:
        return f"{self.length:g} m, {self.mode}, {self.command}, {self.coupler}"


def cases(lengths: Sequence[float]) -> list[FreightTrain]:
    """Return every length in every position, and again with draft gears for the plots."""
    found = [FreightTrain(length, mode, command) for length in lengths for mode in MODES for command in COMMANDS]
    return found + [FreightTrain(DRAWN, mode, "emergency", "draft-gear") for mode in MODES]


def run(options: Options, quick: bool = False) -> Report:
    lengths = LENGTHS[:2] if quick else LENGTHS
    done = {case: case.run() for case in counting(cases(lengths), "trains", unit="train")}
    rows = judged_rows(done, lengths)
    for case, (train, course) in done.items():
        where = f"in coupling {train.largest_compression_at:g}"
        rows += [
            measured(f"{case.name}: stopping distance", "m", course.braking_distance, "from 100 km/h"),
            measured(f"{case.name}: build-up time", "s", build_up_time(course), "mean of all cylinders"),
            measured(f"{case.name}: largest compression", "kN", 1e-3 * train.largest_compression, where),
            measured(f"{case.name}: largest tension", "kN", 1e-3 * train.largest_tension),
        ]
    drawn = {mode: done[FreightTrain(DRAWN, mode, "emergency")] for mode in MODES}
    parameters = {"speed": SPEED, "wagon": "80 t, 14 m, composite blocks", "mode": list(MODES)}
    force = {mode: 1e-3 * train.largest_compression for mode, (train, _) in drawn.items()}
    said = [
        f"An emergency of {DRAWN:g} m compresses couplers by {force['P']:.0f} kN in P, "
        f"{force['five in G']:.0f} kN with five vehicles in G at the head, {force['G']:.0f} kN in G: "
        "the head brakes before the end.",
    ]
    seconds = seconds_of(course for _, course in done.values())
    return Report(rows, drawn["P"][1].recording(), lambda: draw(drawn), parameters, seconds, said)


def judged_rows(done: Mapping[FreightTrain, tuple[Train, TrainCourse]], lengths: Sequence[float]) -> list[Row]:
    """Return the rows of the standard's limit of the wave speed, and of the order of positions and lengths."""
    fresh = FreightTrain(DRAWN, "P", "emergency").train()
    fresh.drive("emergency")
    wave, standard = propagation(follow(fresh, 8.0, 0.01), fresh.consist.length), "UIC 540: at least 250 m/s"
    rows = [measured(f"{DRAWN:g} m, emergency: propagation", "m/s", wave, standard, at_least(WAVE))]
    for length in lengths[1:]:  # shorter ones hardly exceed the preload of their buffers
        slow, fast = (done[FreightTrain(length, mode, "emergency")][0].largest_compression for mode in ("G", "P"))
        name = f"{length:g} m, emergency: compression in G over that in P"
        rows.append(measured(name, "1", slow / fast, "slow filling is what position G is for", at_most(0.8)))
    for mode in MODES:
        grows = np.diff([done[FreightTrain(length, mode, "emergency")][1].braking_distance for length in lengths]).min()
        rows.append(measured(f"{mode}: least growth of the distance with length", "m", grows, "delay", at_least(0.0)))
    return rows


def draw(drawn: Mapping[str, tuple[Train, TrainCourse]]) -> Figure:
    slow, fast = (1e-3 * drawn[mode][0].largest_compression for mode in ("G", "P"))
    message = f"Emergency at {one_word(f'{DRAWN:g} m')}: couplers take {slow:.0f} kN in G, {fast:.0f} in P"
    titles = {f"{mode}: pressure in the pipe [bar]": "time [s]" for mode in drawn}
    titles |= {f"{mode}: extremes of\ncoupler forces [kN]": "coupler" for mode in drawn}
    figure, axes = charts(message, titles, (11.0, 6.6), columns=3, sharey="row")
    for pipe, forces, (_, course) in zip(axes[:3], axes[3:], drawn.values(), strict=True):
        shades, force = draw_pressures(pipe, course, "pipe", 25.0, (0.0, 5.0)), course.force / 1e3
        forces.fill_between(range(1, force.shape[1] + 1), force.min(axis=0), force.max(axis=0), color=FOUR[0])
    axes[0].set_ylabel("behind the head [m]")
    axes[3].set_ylabel("tension above 0 [kN]")
    figure.colorbar(shades, ax=axes[:3], label="bar")
    return figure


def point(length: float = DRAWN, load: float = 60e3, position: float = 0.0) -> dict[str, float | None]:
    """Return the results of one emergency.

    Takes length [m], load [kg].
    """
    train = Train(train_of(length, load=load, position="G" if position else "P"), speed=SPEED)
    train.drive("emergency")
    course = stop(train)
    return {
        "stopping_distance": course.braking_distance,
        "largest_compression": train.largest_compression,
        "largest_tension": train.largest_tension,
        "air_used": train.air_used,
    }


SCENARIO = Scenario(
    "train-braking",
    "Emergency and full service of freight trains in P, G and mixed: pressures, coupler forces, distances",
    run,
    sweep=Sweepable(
        {"length": "m", "load": "kg", "position": "1"},
        {"stopping_distance": "m", "largest_compression": "N", "largest_tension": "N", "air_used": "kg"},
        point,
    ),
)

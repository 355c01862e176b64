"""Surface of braked wheels and discs: error and cost of one lump, of four modes and of finite volumes.

A slab that is heated on one side has a series (Carslaw and Jaeger 1959). At constant heat the share of the surface's
rise that a lump misses depends on the Fourier number a t / L^2 alone, and not on the power. Two stops of one vehicle
compare the surface of a train with finite volumes that have the same heat. Thicknesses and areas are assumed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from bogie_braking.reporting.plots import BOGIE, FOUR, charts
from bogie_braking.reporting.report import Report, Row, at_most, measured, near
from bogie_braking.reporting.scenario import Options, Scenario
from brake_controller.brake_heat import DISCS, SURROUNDINGS, WHEELS
from brake_controller.slab_surface import GAINS, RATES
from fmu_src.cosimulation.recording import Recording
from products.train.consist_file import consist_of
from products.train.heat_columns import BODIES
from products.train.train import Train
from scenarios.bench.warm_slab import Slab

#: Fourier numbers of the figure and the comparison; terms of the series.
FOURIER, TERMS = np.geomspace(1e-3, 10.0, 121), 2000
#: Fourier numbers of rows; share of the surface's rise that a lump may miss [1], assumed.
SHOWN, MISSED = (0.01, 0.1, 1.0, 10.0), 0.1
#: Cells of finite volumes over the thickness.
CELLS = (5, 10, 20)
#: Largest errors: of modes from the series [%], and of a stop from finite volumes [%].
ERROR, STOP_ERROR = 0.5, 1.0
#: Time between two values of a stop [s], and number of wheels or discs.
PERIOD, NUMBER = 0.05, 8
Numbers = NDArray[np.float64]


@dataclass(frozen=True)
class SlabBody:
    """Wheels or discs: number in `BODIES`, thickness [m], speed of the stop [m/s], row of the vehicle."""

    number: int
    thickness: float
    speed: float
    row: Mapping[str, Any]

    @property
    def slab(self) -> Slab:
        """Return all of them as one slab."""
        return Slab.of_body(self.number, self.thickness, NUMBER * BODIES[self.number].area)

    @property
    def vehicle(self) -> dict[str, Any]:
        """Return the row of the vehicle, whose lump is the slab, without cooling."""
        own = BODIES[self.number]
        mass = own.density * own.area * self.thickness
        heat = {own.mass: mass, "thickness": 1e3 * self.thickness, "cooling": 0.0, "cooling_speed": 0.0}
        return {"valve": "head"} | dict(self.row) | heat


#: A rim of 50 mm under a loaded wagon, and ventilated discs with rings of 22 mm under a coach.
BRAKED = {
    "tread from 100 km/h": SlabBody(WHEELS, 0.05, 100.0 / 3.6, {"kind": "wagon", "friction": "composite"}),
    "disc from 160 km/h": SlabBody(DISCS, 0.022, 160.0 / 3.6, {"kind": "coach", "friction": "pads"}),
}


@dataclass(frozen=True)
class HeatedStop:
    """A stop: times [s], rise of the mean, of the surface, and of that by finite volumes [K]."""

    times: Numbers
    mean: Numbers
    surface: Numbers
    conducted: Numbers

    @property
    def off(self) -> float:
        """Return the difference of the largest rise of the surface from finite volumes [%]."""
        return 100 * abs(float(self.surface.max() / self.conducted.max()) - 1)

    @property
    def missed(self) -> float:
        """Return the share of the largest rise of the surface that the mean has not then [%]."""
        peak = int(self.conducted.argmax())
        return 100 * (1 - float(self.mean[peak] / self.conducted[peak]))


def series(fourier: Numbers) -> Numbers:
    """Return the surface above the mean over q L / k, Carslaw and Jaeger (1959)."""
    n = np.pi * np.arange(1, TERMS + 1)[:, None]
    return 1 / 3 - np.asarray(np.sum(2 / n**2 * np.exp(-(n**2) * fourier), axis=0))


def modes(fourier: Numbers) -> Numbers:
    """Return the same by the modes of a train's brakes."""
    gains, rates = (np.array(one)[:, None] for one in (GAINS, RATES))
    return np.asarray(np.sum(gains * (1 - np.exp(-rates * fourier)), axis=0))


def volumes(fourier: Numbers, cells: int) -> Numbers:
    """Return the same by finite volumes up to a Fourier number of 1, then NaN."""
    found = Slab(1.0, 1.0, 1.0, 1.0, 1.0).conducted(1.0, 1.0, cells)
    return np.interp(fourier, found[:, 0], found[:, 1], right=np.nan)


def errors() -> dict[str, Numbers]:
    """Return the errors of the surface's rise over FOURIER [%], by model and count of its numbers."""
    exact = series(FOURIER)
    found = {"lump, 1 number": np.zeros_like(exact), "four modes, 5 numbers": modes(FOURIER)}
    found |= {f"{cells} cells, {cells} numbers": volumes(FOURIER, cells) for cells in CELLS}
    return {name: 100 * np.abs(own - exact) / (exact + FOURIER) for name, own in found.items()}


def stop(body: SlabBody) -> HeatedStop:
    """Return an emergency stop of a vehicle, and its surface by finite volumes with the same heat."""
    train = Train(consist_of([body.vehicle]), speed=body.speed)
    share = train.consist.vehicles[0].heat.heat_share
    train.drive("emergency")
    found = train.record(200.0, PERIOD)
    times, heat = found["time"], share * found["brake_heat[1]"]
    power = np.gradient(heat, times)
    above = body.slab.conducted(lambda time: float(np.interp(time, times, power)), float(times[-1]))
    mean = found["brake_temperature[1]"] - SURROUNDINGS
    conducted = mean + np.interp(times, above[:, 0], above[:, 1])
    return HeatedStop(times, mean, found["surface_temperature[1]"] - SURROUNDINGS, conducted)


def rows_of_models(off: Mapping[str, Numbers]) -> list[Row]:
    """Return the errors of models, and the Fourier number from which a lump is enough."""
    bounds = {"four modes, 5 numbers": at_most(ERROR)}
    rows = [
        measured(f"{name}: largest error of the surface's rise", "%", float(np.nanmax(own)), "series", bounds.get(name))
        for name, own in off.items()
    ]
    excess = series(np.array(SHOWN))
    for fourier, own in zip(SHOWN, excess, strict=True):
        closed = 100 / (1 + 3 * fourier)
        bound = near(closed, 0.01 * closed) if fourier >= 1.0 else None
        name = f"a lump misses of the surface's rise at a t / L^2 = {fourier:g}"
        rows.append(measured(name, "%", 100 * own / (own + fourier), "1 / (1 + 3 a t / L^2) after a long time", bound))
    fine = np.linspace(1.0, 10.0, 9001)
    enough = float(fine[np.argmax(series(fine) / (series(fine) + fine) <= MISSED)])
    name = f"a t / L^2 from which a lump misses less than {100 * MISSED:g} %"
    return [*rows, measured(name, "1", enough, "(1 / 0.1 - 1) / 3", near((1 / MISSED - 1) / 3, 0.01))]


def rows_of_stops(stops: Mapping[str, HeatedStop]) -> list[Row]:
    """Return the temperatures of stops against finite volumes."""
    rows = list[Row]()
    for name, one in stops.items():
        lasts, body = float(one.times[-1]), BRAKED[name].slab
        rows += [
            measured(f"{name}: duration", "s", lasts),
            measured(f"{name}: a t / L^2", "1", lasts / body.settles),
            measured(f"{name}: rise of the mean", "K", float(one.mean.max()), assumption="thickness and area assumed"),
            measured(f"{name}: largest rise of the surface", "K", float(one.surface.max())),
            measured(f"{name}: from finite volumes", "%", one.off, "40 cells, same heat", at_most(STOP_ERROR)),
            measured(f"{name}: a lump misses of the largest rise", "%", one.missed),
        ]
    return rows


def run(options: Options, quick: bool = False) -> Report:
    off, stops = errors(), {name: stop(one) for name, one in BRAKED.items()}
    rows = rows_of_models(off) + rows_of_stops(stops)
    table = Recording({"fourier": "1"}, FOURIER[:, None])
    for name, own in off.items():
        table.add(f"error ({name})", "%", own)
    seconds = sum(float(one.times[-1]) for one in stops.values())
    parameters = {name: 1e3 * one.thickness for name, one in BRAKED.items()}
    return Report(rows, table, lambda: draw(off, stops), parameters, seconds, [])


def draw(off: Mapping[str, Numbers], stops: Mapping[str, HeatedStop]) -> Figure:
    name, one = next(iter(stops.items()))
    message = f"A lump misses {one.missed:.0f} % of a tread's rise in a stop"
    titles = {"error of the surface's rise [%]": "Fourier number a t / L² [1]", f"rise, {name} [K]": "time [s]"}
    figure, axes = charts(message, titles, (9.0, 4.2))
    for colour, (model, own) in zip(FOUR, off.items(), strict=False):
        axes[0].loglog(FOURIER, np.maximum(own, 1e-3), color=colour, label=model)
    axes[0].set_ylim(1e-2, 200.0)
    axes[1].plot(one.times, one.conducted, color=BOGIE, linestyle="--", label="surface, finite volumes")
    axes[1].plot(one.times, one.surface, color=FOUR[1], label="surface, four modes")
    axes[1].plot(one.times, one.mean, color=FOUR[0], label="lump")
    for axis in axes:
        axis.legend(fontsize=8)
    return figure


SCENARIO = Scenario(
    "brake-surface", "Surface of braked wheels and discs: what a lump misses, four modes against finite volumes", run
)

"""Drivers by timetable with and without a profile of least energy, against a dynamic program, on three lines.

A metro unit and a locomotive with six coaches run 6 km in 300 to 420 s, on level track, on slopes and with limits of
speed. The dynamic program (`energy_program`) has the same forces, and the time in which the driver arrived.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import LEADING, TRAILING, charts
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, Row, at_most, measured, near
from bogie_braking.reporting.scenario import Options, Scenario
from evidence.trains.energy_program import Array, Journey, least_energy_of
from fmu_src.cosimulation.recording import Recording
from products.train.consist_file import consist_of
from products.train.stations import StationStop
from products.train.timetable import TimetableDriver
from products.train.train import Train
from rbd_model.track.line import line_of, straight
from rbd_model.train.vehicle import GRAVITY

#: A metro car, and a locomotive: columns of a consist.
CAR: dict[str, Any] = {
    "kind": "coach", "mass": 45.0, "length": 18.0, "rotating": 9.0, "coupler": "rigid",
    "brake": "ep-direct", "deceleration": 1.2, "dead_time": 0.3, "fill_time": 1.2, "dynamic_force": 60.0,
    "dynamic_power": 900.0, "traction_force": 60.0, "traction_power": 900.0,
}  # fmt: skip
LOCOMOTIVE = {"kind": "locomotive", "traction_force": 300.0, "traction_power": 5600.0, "adhesion": "curtius-kniffler"}
TRAINS: dict[str, list[dict[str, Any]]] = {
    "metro": [CAR | {"valve": "head"}, CAR, CAR],
    "coaches": [LOCOMOTIVE, {"kind": "coach", "count": 6}],
}
#: Distance [m], deceleration [m/s2], speed above which no journey goes [m/s]; adhesion of the driver.
WAY, DECELERATION, FASTEST, ADHESION = 6000.0, 0.5, 120.0 / 3.6, 0.25
#: Lines: gradients from places on, and limits of speed from places on [m], [1], [m/s].
GRADIENTS: dict[str, list[tuple[float, float]]] = {
    "slopes": [(-500.0, 0.0), (1000.0, 0.015), (2200.0, 0.0), (2800.0, -0.02), (4300.0, 0.0)],
}
LIMITS = {"limits": [(0.0, FASTEST), (1500.0, 18.0), (2500.0, FASTEST), (4200.0, 15.0), (4800.0, 25.0)]}
LINES = ("level", "slopes", "limits")
#: Cases: train, line, due time [s]; those of a quick run.
CASES = [(train, line, due) for train in TRAINS for line in LINES for due in (300.0, 420.0)]
CASES = [(train, line, 400.0 if line == "limits" and due == 300.0 else due) for train, line, due in CASES]
QUICK = (("metro", "slopes", 420.0),)
#: Energy over that of the program that is allowed [1], distance from the place [m] and time [s] of a stop.
OVER, PLACE, TIME = 0.01, 1.0, 4.0


@dataclass(frozen=True)
class Run:
    """A run of a driver: recording, time of arrival [s], overrun [m], energy less the recovered part [J]."""

    recording: Recording
    arrived: float
    overrun: float
    energy: float


def train_of(name: str, line: str) -> Train:
    """Return a train at rest with its front 27 to 81 m before a line's first place."""
    ends = [*GRADIENTS.get(line, [(-500.0, 0.0)]), (9000.0, 0.0)]
    parts = [straight(ends[n + 1][0] - place, slope) for n, (place, slope) in enumerate(ends[:-1])]
    return Train(consist_of(TRAINS[name]), line=line_of(parts, start=-500.0))


def driven(name: str, line: str, due: float, energy: bool, recovery: float = 0.0) -> Run:
    """Return the run of a driver."""
    limits = LIMITS.get(line, [(0.0, FASTEST)])
    driver = TimetableDriver(
        [StationStop(WAY, arrival=due)], limits, DECELERATION, adhesion=ADHESION, energy=energy, recovery=recovery
    )
    run = driver.drive(train_of(name, line), 2 * due)
    used = run["traction_energy"][-1] - recovery * run["electric_brake_energy"][-1]
    return Run(run, driver.calls[0].arrived, driver.calls[0].overrun, float(used))


def _drive(rows: Sequence[Mapping[str, Any]], kind: str, speed: Array) -> Array:
    """Return the sum of min(F, P / v) of the motors or electric brakes of a train's rows [N]."""
    total = np.zeros_like(speed)
    for row in rows:
        if f"{kind}_force" in row:
            force, power = 1e3 * row[f"{kind}_force"], 1e3 * row[f"{kind}_power"]
            total += row.get("count", 1) * np.minimum(force, power / np.maximum(speed, 0.1))
    return total


def journey_of(name: str, line: str, recovery: float = 0.0) -> Journey:
    """Return what the program needs, from the columns: no function of the driver is used."""
    vehicles, rows = consist_of(TRAINS[name]).vehicles, TRAINS[name]
    a, b, c = np.sum([vehicle.resistance for vehicle in vehicles], axis=0)
    driven_weight = sum(one.mass for one in vehicles if one.traction.traction_force) * GRAVITY
    starts = np.array([place for place, _ in GRADIENTS.get(line, [])])
    slopes = np.array([0.0, *(slope for _, slope in GRADIENTS.get(line, []))])
    limits = LIMITS.get(line, [(0.0, FASTEST)])
    length = sum(vehicle.length for vehicle in vehicles)

    def pull(speed: Array) -> Array:
        falls = (0.161 + 7.5 / (3.6 * speed + 44.0)) / (0.161 + 7.5 / 44.0)  # Curtius and Kniffler
        return np.minimum(_drive(rows, "traction", speed), ADHESION * driven_weight * falls)

    def climbing(place: Array) -> Array:
        total, front = np.zeros(len(place)), np.array(place)
        for vehicle in vehicles:
            points = front[:, None] - vehicle.length * (np.arange(10) + 0.5) / 10
            total += vehicle.mass * GRAVITY * slopes[np.searchsorted(starts, points, "right")].mean(axis=1)
            front = front - vehicle.length
        return total

    def allowed(place: Array) -> Array:
        least = np.full(len(place), FASTEST)
        ends = [*(start for start, _ in limits[1:]), np.inf]
        for (start, speed), end in zip(limits, ends, strict=True):
            below = (place >= start) & (place <= end + length)
            least = np.where(below, np.minimum(least, speed), least)
        return least

    return Journey(
        sum((1 + vehicle.rotating_share) * vehicle.mass for vehicle in vehicles),
        WAY,
        DECELERATION,
        pull,
        lambda speed: a + b * speed + c * speed**2,
        climbing,
        allowed,
        lambda speed: _drive(rows, "dynamic", speed) * np.minimum(speed / (8.0 / 3.6), 1.0),
        recovery,
    )


def rows_of(name: str, line: str, due: float, holding: Run, saving: Run, least: float) -> list[Row]:
    """Return the rows of a case: both energies, the program's, arrival and place."""
    case = f"{name}, {line}, {due:.0f} s"
    return [
        measured(f"{case}: energy of a steady speed", "kWh", holding.energy / 3.6e6),
        measured(f"{case}: energy of the profile", "kWh", saving.energy / 3.6e6),
        measured(f"{case}: saved", "%", 100 * (1 - saving.energy / holding.energy)),
        measured(
            f"{case}: energy over the program's",
            "%",
            100 * (saving.energy / least - 1),
            "program",
            at_most(100 * OVER),
        ),
        measured(f"{case}: late", "s", saving.arrived - due, "driver", near(0.0, TIME)),
        measured(f"{case}: overrun", "m", saving.overrun, "driver", near(0.0, PLACE)),
    ]


def run(options: Options, quick: bool = False) -> Report:
    rows: list[Row] = []
    runs: dict[tuple[str, str, float], tuple[Run, Run]] = {}
    for name, line, due in counting(QUICK if quick else CASES, "journeys"):
        holding, saving = (driven(name, line, due, energy) for energy in (False, True))
        least = least_energy_of(journey_of(name, line), saving.arrived)[2]
        rows += rows_of(name, line, due, holding, saving, least)
        runs[name, line, due] = holding, saving
    last = list(runs.values())[-1][1].recording
    return Report(rows, last, lambda: draw(runs), {"deceleration": DECELERATION}, float(last["time"][-1]))


def draw(runs: Mapping[tuple[str, str, float], tuple[Run, Run]]) -> Figure:
    shown = {line: max((key for key in runs if key[1] == line), default=None) for line in LINES}
    cases = [key for key in shown.values() if key]
    least = min(100 * (1 - saving.energy / holding.energy) for holding, saving in runs.values())
    message = f"Coasting saves {least:.0f} % of a steady speed's energy or more"
    labels = [f"{line}: speed [km/h]" for _, line, _ in cases]
    figure, axes = charts(message, labels, (8.0, 2.8 * len(cases)), "place of the front [km]", 1)
    for axis, key in zip(np.ravel(axes), cases, strict=True):
        for found, color, label in zip(runs[key], (TRAILING, LEADING), ("steady speed", "least energy"), strict=True):
            place, speed = 1e-3 * found.recording["distance"], 3.6 * found.recording["speed"]
            axis.plot(place, speed, color=color, label=f"{label}: {found.energy / 3.6e6:.1f} kWh")
        axis.legend(fontsize=8, title=f"{key[0]}, {key[2]:.0f} s", title_fontsize=8)
    return figure


SCENARIO = Scenario(
    "train-energy", "Drivers of least energy on three lines, against a dynamic program: energy, arrival, place", run
)

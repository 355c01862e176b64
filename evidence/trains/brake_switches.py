"""Mechanisms of a train brake that are switched on one at a time, and what each moves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any

import numpy as np

from evidence.trains.point_train import Numbers, PointTrain, point_train
from products.train.consist import Consist
from products.train.consist_file import consist_of
from products.train.numbers import Settings
from products.train.running_resistance import formula_of
from scenarios.benchmark.case import BenchmarkCase
from scenarios.benchmark.case_file import CASES, read_case
from scenarios.benchmark.own.train_stop import rows_of

#: Trains by which mechanisms are chosen, and trains that only report.
CHOOSING, REPORTING = ("GW40", "MSP120"), ("GW16", "GW10")
#: Slowest stop that is compared [m/s]: tables round to 1 m.
SLOWEST = 19.9 / 3.6


@dataclass(frozen=True)
class Switches:
    """How a train brakes.

    columns: of all vehicles, of the locomotives and of the wagons, as in a consist; distributor: its parameters;
    friction: factor on the pipe's wall friction; released: kind of vehicles that do not brake; delay: before the demand
    [s]; margin: factor on the distance.
    """

    drive: tuple[str, float] = ("service", 1.0)
    columns: Mapping[str, Any] = field(default_factory=dict)
    locomotive: Mapping[str, Any] = field(default_factory=dict)
    wagon: Mapping[str, Any] = field(default_factory=dict)
    distributor: Mapping[str, float] = field(default_factory=dict)
    friction: float = 1.0
    released: str = ""
    delay: float = 0.0
    margin: float = 1.0

    def consist(self, inputs: Mapping[str, Any]) -> Consist:
        """Return the train of a case with these switches."""
        head, wagons = rows_of(inputs)
        rows = [{**head, **self.columns, **self.locomotive}, {**wagons, **self.columns, **self.wagon}]
        for row in rows:
            if "distributor" in row or "brake" in row:
                del row["position"]
        changed = [
            replace(v, distributor=replace(v.distributor, **self.distributor), resistance=formula_of(v.kind).of(v.mass))
            for v in consist_of(rows).vehicles
        ]  # a valve of the AAR does not change the resistance
        return Consist(tuple(changed))

    def train(self, inputs: Mapping[str, Any]) -> PointTrain:
        """Return the train of a case, ready to stop."""
        settings = Settings(cells=1.0, friction=self.friction)
        return point_train(self.consist(inputs), self.drive, settings, without=self.released)


#: Brakes as they were compared first, and as they are applied in service.
BEFORE, SERVICE = Switches(drive=("emergency", 0.0)), Switches()
#: Freight trains: valve of Open Rails' default, 2 psi/s; branches with which a wave has the measured 280 to 300 m/s;
#: composite blocks. Chosen on GW40: released locomotives, and a margin between both of its closed forms.
AFTER = Switches(
    columns={"friction": "composite-k", "branch": 4.0},
    locomotive={"service_rate": 0.14},
    released="locomotive",
    margin=1.18,
)
#: Passenger train: pads, and the margin and the build-up that MSP120's table leaves room for.
PASSENGER = Switches(columns={"friction": "pads", "brake": "ep-direct", "fill_time": 0.5}, margin=1.08)
#: Mechanisms that are switched on one at a time, in a train that brakes in full service.
SWITCHES = {
    "emergency instead of full service": BEFORE,
    "position G": Switches(columns={"position": "G"}),
    "equalising reservoir at 0.14 bar/s": Switches(locomotive={"service_rate": 0.14}),
    "exhaust of the driver's valve 7 mm": Switches(locomotive={"exhaust": 7.0}),
    "branches of 4 l": Switches(columns={"branch": 4.0}),
    "pipe friction 1.5 times": Switches(friction=1.5),
    "no accelerators": Switches(distributor={"accelerator_volume": 0.0}),
    "sensitivity 30 kPa": Switches(distributor={"sensitivity": 30e3}),
    "no in-shot": Switches(distributor={"inshot": 0.0}),
    "AAR valves on the wagons": Switches(wagon={"distributor": "aar"}),
    "blocks of composite, by speed": Switches(columns={"friction": "composite-k"}),
    "blocks of composite, by force and speed": Switches(columns={"friction": "composite"}),
    "blocks of cast iron P10": Switches(columns={"friction": "cast-iron-p10"}),
    "locomotives released": Switches(released="locomotive"),
    "driver's time 4 s": Switches(delay=4.0),
    "margin 18 % of the distance": Switches(margin=1.18),
}


def after(name: str) -> Switches:
    """Return the chosen brakes of a train."""
    return PASSENGER if name == "MSP120" else AFTER


@dataclass(frozen=True)
class Told:
    """A published table: speeds [m/s], gradients, rising above 0 [1], and distances [m]; inputs of its case.

    at: the point on level track to which the brakes are fitted.
    """

    name: str
    inputs: Mapping[str, Any]
    speed: Numbers
    gradient: Numbers
    distance: Numbers
    at: int

    def place(self, speed: float, gradient: float) -> int:
        """Return the number of the point with a speed [km/h] and a gradient [1]."""
        return int(np.argmin(np.abs(3.6 * self.speed - speed) + 1e4 * np.abs(self.gradient - gradient)))

    def few(self) -> np.ndarray:
        """Return the points of some speeds and gradients, for fits."""
        speeds, gradients = (20, 40, 60, 80, 110), (1 / 60, 0.0, -1 / 200, -1 / 100, -1 / 60)
        return np.unique([self.place(speed, gradient) for speed in speeds for gradient in gradients])


@lru_cache
def told(name: str, steepest: float = 1.0) -> Told:
    """Return one of ARTC's tables from its case: stops from 20 km/h on, on gradients up to the steepest [1]."""
    case: BenchmarkCase = read_case(CASES / f"artc-{name.lower()}.toml")
    rows = [[p.inputs["speed"], p.inputs["gradient"], p.published["distance"]] for p in case.points]
    speed, gradient, distance = np.array(rows, float).T
    kept = (speed > SLOWEST) & (np.abs(gradient) <= steepest)
    speed, gradient, distance = speed[kept], gradient[kept], distance[kept]
    level = np.flatnonzero(gradient == 0.0)
    at = int(level[np.argmin(np.abs(3.6 * speed[level] - min(80.0, 3.6 * speed.max())))])
    return Told(name, case.points[0].inputs, speed, gradient, distance, at)


def distances(switches: Switches, table: Told, train: PointTrain | None = None) -> Numbers:
    """Return our distances of a table [m], the brakes fitted to one point of it on level track; NaN without a stop."""
    own = train or switches.train(table.inputs)
    speed, due = float(table.speed[table.at]), float(table.distance[table.at])
    factor = own.fitted(speed, due, switches.margin, switches.delay)
    return switches.margin * own.distances(table.speed, table.gradient, factor, switches.delay)


def errors(switches: Switches, table: Told) -> Numbers:
    """Return relative errors of our distances [1]."""
    return np.asarray(distances(switches, table) / table.distance - 1.0)


def rms(values: Numbers) -> float:
    """Return the root mean square of the values that are there."""
    return float(np.sqrt(np.nanmean(values**2)))

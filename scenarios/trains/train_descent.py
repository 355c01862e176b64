"""Drag braking on a long descent: power and heat of the wheels, with and without a dynamic brake, to the runaway.

A driver holds the speed. The drag case of the TSI has a closed form. The friction of the freight train's blocks fades
with an assumed curve, since no public one was found: the gradients of its runaway are examples, not predictions.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import LEADING, TRAILING, charts
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, Row, at_most, measured, near
from bogie_braking.reporting.scenario import Options, Scenario
from brake_controller.air import AMBIENT
from brake_controller.brake_heat import SURROUNDINGS, WHEELS, BrakeHeat
from fmu_src.cosimulation.recording import Recording
from products.train.consist_file import consist_of
from products.train.driver import HoldingDriver
from products.train.heat_columns import BODIES, STEEL, ZERO
from products.train.numbers import Settings
from products.train.train import Train
from rbd_model.track.line import Line
from rbd_model.train.vehicle import GRAVITY
from scenarios.bench.warm_slab import Slab

#: Drag case of the TSI: gradient [1], speed [m/s], distance [m], mass on an axle [kg]; power of a wheel [W], time [s].
DRAG, SPEED, FAR, AXLE = 0.021, 70.0 / 3.6, 40e3, 22.5e3
POWER, TIME = AXLE / 2 * GRAVITY * DRAG * SPEED, FAR / SPEED
#: Masses of a wheel that takes heat, and of its blocks [kg]; cooling of a wheel [W/K]. Assumed.
WHEEL, BLOCKS, COOLINGS = 370.0, 14.0, (48.0, 80.0)
#: Heat that its bodies may not account for [%].
UNCLOSED = 1e-4
#: Time after which the driver's law has settled [s], and relative errors of power and time, and of the rise.
SETTLED, ERROR, RISE_ERROR = 300.0, 1e-3, 0.01
#: The freight train: a locomotive, whose wheels stay cold, and wagons of 80 t; gradients [1], and those of a quick
#: run; speed above which it has run away, over the held one.
WAGONS, GRADIENTS, QUICK_GRADIENTS, RUNAWAY = 20, (0.021, 0.027, 0.033, 0.039, 0.045), (0.021, 0.039), 1.25
#: Fading of its blocks [degC], [degC], [1]; dynamic brake of its locomotive [kN], [kW], share of the train's. Assumed.
FADE = {"fade_table": "250:1 450:0.3"}
DYNAMIC, SHARE = {"dynamic_force": 150.0, "dynamic_power": 4000.0}, 0.12
BRAKES = ("air alone", "air and dynamic brake")
DRAWN = 0.039
#: Thickness of a rim [m]. Assumed.
RIM = 0.05
#: Time of heating before the heat reaches the back of the rim [s].
SHORT = 20.0


@dataclass(frozen=True)
class Descent:
    """Course of a descent: time [s], distance [m], speed [m/s], warmest wheel [K], emptiest reservoir [Pa, gauge].

    Then temperatures of wheels and blocks [K], and heat of the brake [J], of the last vehicle.

    power: mean heat of a wheel of the last vehicle after SETTLED [W]. heat: parameters of its heat.
    """

    course: np.ndarray
    power: float
    heat: BrakeHeat

    @property
    def lasts(self) -> float:
        """Return the time for FAR at the mean speed after SETTLED [s]."""
        settled = self.course[self.course[:, 0] > SETTLED]
        return float(FAR * (settled[-1, 0] - settled[0, 0]) / (settled[-1, 1] - settled[0, 1]))

    @property
    def ran_away(self) -> bool:
        """Return whether the speed exceeded that of a runaway."""
        return bool(self.course[:, 2].max() > RUNAWAY * SPEED)

    @property
    def warmest(self) -> float:
        """Return the largest mean temperature of a wheel [degC]."""
        return float(self.course[:, 3].max()) - ZERO

    def shares(self) -> dict[str, float]:
        """Return the shares of the last vehicle's heat at the end [%], by the bodies that have it."""
        time, speed, heat = self.course[:, 0], self.course[:, 2], self.course[-1, 7]
        found = dict[str, float]()
        for name, of, column in (("wheels", "", 5), ("blocks", "block_", 6)):
            rest, rise = (getattr(self.heat, f"{of}cooling_{part}") for part in ("at_rest", "over_speed"))
            capacity = self.heat.block_capacity if of else self.heat.heat_capacity
            over = self.course[:, column] - SURROUNDINGS
            found[name] = 100 * capacity * float(over[-1]) / heat
            found[f"air at {name}"] = 100 * float(np.trapezoid((rest + rise * speed) * over, time)) / heat
        return found


def descend(rows: list[dict[str, Any]], gradient: float, driver: HoldingDriver, cells: float = 1.0) -> Descent:
    """Run a train down a gradient over FAR, or until it has run away or stands."""
    line = Line({"distance": np.array([-1e4, 2 * FAR]), "gradient": np.array([-gradient, -gradient])})
    train = Train(consist_of(rows), speed=driver.speed, line=line, settings=Settings(cells=cells))
    begin, settled, found = float(train.distance[0]), (0.0, 0.0), list[list[float]]()
    while train.distance[0] - begin < FAR and 0.0 < train.speed[0] <= RUNAWAY * driver.speed:
        driver.act(train)
        train.advance(driver.period)
        found.append(
            [
                train.time,
                float(train.distance[0]) - begin,
                float(train.speed[0]),
                float(train.brake_temperature[-WAGONS:].max()),
                float(train.air.vehicle_pressures("auxiliary").min()) - AMBIENT,
                float(train.brake_temperature[-1]),
                float(train.block_temperature[-1]),
                float(train.brake_heat[-1]),
            ]
        )
        if train.time <= SETTLED:
            settled = train.time, float(train.brake_heat[-1])
    power = (float(train.brake_heat[-1]) - settled[1]) / max(train.time - settled[0], driver.period) / 8
    return Descent(np.array(found), power, train.consist.vehicles[-1].heat)


def drag_case(cooling: float) -> Descent:
    """Return the drag case of the TSI: a wagon with four axles, all heat in the wheels, without running resistance."""
    wagon = {"kind": "wagon", "valve": "head", "mass": 4e-3 * AXLE, "wheel_mass": WHEEL, "heat_share": 1.0}
    wagon |= {"cooling": cooling, "cooling_speed": 0.0, "resistance_a": 0.0, "resistance_b": 0.0, "resistance_c": 0.0}
    return descend([wagon], DRAG, HoldingDriver(SPEED), 2.0)


def freight(gradient: float, brake: str) -> Descent:
    """Return the descent of a freight train with blocks that fade."""
    dynamic = brake == BRAKES[1]
    locomotive = {"kind": "locomotive"} | (DYNAMIC if dynamic else {})
    wagons = {"kind": "wagon", "count": WAGONS, "wheel_mass": WHEEL, "block_mass": BLOCKS, "friction": "composite"}
    wagons |= FADE
    return descend([locomotive, wagons], gradient, HoldingDriver(SPEED, SHARE if dynamic else 0.0))


def rise(cooling: float) -> float:
    """Return the rise of a lump with constant power [K]: P / G (1 - exp(-G t / C))."""
    return POWER / cooling * (1 - math.exp(-cooling * TIME / (WHEEL * STEEL)))


def rows_of_drag(found: Mapping[float, Descent]) -> list[Row]:
    """Return power, time and temperatures of the drag case against closed forms."""
    one = next(iter(found.values()))
    source = "TSI WAG, 21 permille, 70 km/h, 40 km: m g i v"
    rows = [
        measured(
            "drag case: power of a wheel", "kW", 1e-3 * one.power, source, near(1e-3 * POWER, 1e-3 * ERROR * POWER)
        ),
        measured("drag case: duration", "min", one.lasts / 60, source, near(TIME / 60, ERROR * TIME / 60)),
    ]
    for cooling, descent in found.items():
        own, closed = descent.course[-1, 3] - SURROUNDINGS, rise(cooling)
        name = f"drag case: mean rise of a wheel of {WHEEL:g} kg, {cooling:g} W/K"
        rows.append(
            measured(name, "K", own, "lump with constant power", near(closed, RISE_ERROR * closed), "cooling assumed")
        )
    return rows


def rows_of_rim() -> list[Row]:
    """Return how much the tread is warmer than the mean of its rim, which a lump leaves out, against closed forms."""
    rim, rows = Slab.of_body(WHEELS, RIM, BODIES[WHEELS].area), list[Row]()
    forms = {TIME: (rim.excess(POWER), "q L / (3 k)"), SHORT: (rim.early_excess(POWER, SHORT), "half space")}
    for time, (closed, source) in forms.items():
        above = rim.conducted(POWER, time)[-1, 1]
        name = f"drag case: tread above the mean of its rim after {time:.0f} s"
        rows.append(measured(name, "K", above, source, near(closed, RISE_ERROR * closed), "rim of 50 mm assumed"))
    rows.append(measured("time after which the tread follows the mean", "s", rim.settles, "L^2 rho c / k"))
    return rows


def rows_of_freight(found: Mapping[tuple[float, str], Descent]) -> list[Row]:
    """Return what each descent of the freight train came to, and the steepest gradient that it held."""
    rows = []
    for (gradient, brake), one in found.items():
        name, assumption = f"{1e3 * gradient:g} permille, {brake}", "fading assumed"
        far, fast = 1e-3 * one.course[-1, 1], 3.6 * one.course[:, 2].max()
        rows.append(measured(f"{name}: warmest wheel", "degC", one.warmest, assumption=assumption))
        rows.append(measured(f"{name}: largest speed", "km/h", fast, assumption=assumption))
        lowest = 1e-5 * float(one.course[:, 4].min())
        rows.append(measured(f"{name}: lowest pressure of a reservoir", "bar", lowest))
        if one.ran_away:
            rows.append(measured(f"{name}: distance to the runaway", "km", far, assumption=assumption))
    gradients = list(dict.fromkeys(gradient for gradient, _ in found))
    for brake in BRAKES:
        held = 1e3 * max((g for g in gradients if not found[g, brake].ran_away), default=0.0)
        rows.append(measured(f"steepest gradient held, {brake}", "permille", held, assumption="fading assumed"))
    warmer = max(found[g, BRAKES[1]].warmest - found[g, BRAKES[0]].warmest for g in gradients[:1])
    rows.append(measured("a dynamic brake warms wheels by", "K", warmer, "it takes heat from them", at_most(0.0)))
    return rows


def rows_of_heat(found: Mapping[tuple[float, str], Descent]) -> list[Row]:
    """Return the heat of the last wagon on DRAWN by the bodies that have it at the end, and its blocks."""
    rows = []
    for brake in BRAKES:
        one, of = found[DRAWN, brake], f"{1e3 * DRAWN:g} permille, {brake}"
        shares = one.shares()
        rows.append(measured(f"{of}: heat of the last wagon", "MJ", 1e-6 * float(one.course[-1, 7])))
        rows += [measured(f"{of}: heat in {name}", "%", share) for name, share in shares.items()]
        left = abs(100 - sum(shares.values()))
        rows.append(measured(f"{of}: heat that is not accounted for", "%", left, "first law", at_most(UNCLOSED)))
        hot = float(one.course[:, 6].max()) - ZERO
        rows.append(
            measured(f"{of}: warmest blocks of the last wagon", "degC", hot, assumption="mass, cooling assumed")
        )
    return rows


def run(options: Options, quick: bool = False) -> Report:
    drag = {cooling: drag_case(cooling) for cooling in COOLINGS}
    gradients = QUICK_GRADIENTS if quick else GRADIENTS
    tries = [(gradient, brake) for gradient in gradients for brake in BRAKES]
    found = {one: freight(*one) for one in counting(tries, "descents", unit="descent")}
    rows = rows_of_drag(drag) + rows_of_rim() + rows_of_freight(found) + rows_of_heat(found)
    units = {"time": "s", "distance": "m", "speed": "m/s", "brake_temperature": "K", "lowest_reservoir": "Pa"}
    units |= {"last_wheels": "K", "last_blocks": "K", "last_heat": "J"}
    series = Recording(units, found[DRAWN, BRAKES[0]].course)
    away = {brake: sum(found[g, brake].ran_away for g in gradients) for brake in BRAKES}
    said = [f"The train runs away on {away[b]} of {len(gradients)} gradients with {b}." for b in BRAKES]
    parameters = {"speed": SPEED, "distance": FAR, "wheel_mass": WHEEL} | FADE | DYNAMIC
    seconds = sum(one.course[-1, 0] for one in (*drag.values(), *found.values()))
    return Report(rows, series, lambda: draw(found), parameters, seconds, said)


def draw(found: Mapping[tuple[float, str], Descent]) -> Figure:
    drawn = {brake: found[DRAWN, brake] for brake in BRAKES}
    far = 1e-3 * drawn[BRAKES[0]].course[-1, 1]
    end = f"runs away after {far:.0f} km" if drawn[BRAKES[0]].ran_away else "holds its speed"
    message = f"Air alone on {1e3 * DRAWN:.0f} permille: the train {end}"
    titles = ["speed [km/h]", "warmest wheel of a wagon [degC]", "emptiest reservoir [bar]"]
    figure, axes = charts(message, titles, (12.0, 4.0), "distance [km]", columns=3)
    for colour, (brake, one) in zip((TRAILING, LEADING), drawn.items(), strict=True):
        axes[0].plot(1e-3 * one.course[:, 1], 3.6 * one.course[:, 2], color=colour, label=brake)
        axes[1].plot(1e-3 * one.course[:, 1], one.course[:, 3] - ZERO, color=colour, label=brake)
        axes[2].plot(1e-3 * one.course[:, 1], 1e-5 * one.course[:, 4], color=colour, label=brake)
    axes[1].legend(fontsize=8)
    return figure


SCENARIO = Scenario(
    "train-descent", "Drag braking on a long descent, with and without a dynamic brake: heat of wheels, runaway", run
)

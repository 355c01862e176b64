"""A locomotive starts a train, stops at two stations in time, and shows its energy at the wheel.

Acceleration by force and power, the speed of balance and the bound of slip have closed forms. The energies of motors,
brakes and resistance close over the whole run.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from scipy.integrate import quad
from scipy.optimize import brentq

from bogie_braking.reporting.plots import LEADING, TRAILING, charts
from bogie_braking.reporting.report import Report, Row, at_most, measured, near
from bogie_braking.reporting.scenario import Options, Scenario
from fmu_src.cosimulation.recording import Recording
from products.train.consist_file import consist_of
from products.train.stations import StationStop
from products.train.timetable import TimetableDriver
from products.train.train import Train
from rbd_model.train.vehicle import GRAVITY

#: The locomotive: force [kN] and power [kW]; the train behind it.
MOTORS: dict[str, Any] = {"traction_force": 300.0, "traction_power": 5600.0}
LOCOMOTIVE: dict[str, Any] = {"kind": "locomotive", "adhesion": "curtius-kniffler"} | MOTORS
COACHES = {"kind": "coach", "count": 6}
#: Stops of the front [m], time that is due [s]; limits of speed [m], [m/s]; deceleration of braking curves [m/s2].
STOPS = (StationStop(2500.0, standing=40.0), StationStop(6000.0, arrival=440.0), StationStop(9000.0, arrival=680.0))
LIMITS, DECELERATION = ((0.0, 25.0), (4500.0, 16.0), (6200.0, 30.0)), 0.5
#: Stops: largest distance from the place [m], and from the time [s]; error of the energies, over that of the motors.
PLACE, TIME, ENERGY = 2.0, 15.0, 2e-3
#: The locomotive alone: final speed [m/s]; friction on which it slips, and Polach's share of it at high slip.
FAST, SLIPPERY, LEFT = 50.0, 0.2, 0.4


def lone(**columns: float) -> Train:
    """Return the locomotive alone with its motors on, which do not rise."""
    train = Train(consist_of([LOCOMOTIVE | {"adhesion": "input", "traction_rise": 0.0} | columns]))
    train.inputs["traction"], train.inputs["friction"] = 1.0, 0.6
    return train


def net_force(train: Train, speed: float) -> float:
    """Return min(F, P / v) less the resistance a + b v + c v^2 of a lone locomotive [N]."""
    a, b, c = train.consist.vehicles[0].resistance
    force = min(1e3 * MOTORS["traction_force"], 1e3 * MOTORS["traction_power"] / max(speed, 1e-9))
    return force - a - b * speed - c * speed**2


def rows_of_forms() -> list[Row]:
    """Return acceleration, balance and slip of the locomotive alone against closed forms."""
    train = lone()
    one = train.consist.vehicles[0]
    while train.speed[0] < FAST:
        train.advance(0.1)
    turning = (1 + one.rotating_share) * one.mass
    corner, ends = MOTORS["traction_power"] / MOTORS["traction_force"], float(train.speed[0])
    due = quad(lambda v: turning / net_force(train, v), 0.0, ends, points=[corner])[0]
    rows = [measured("acceleration to 180 km/h", "s", train.time, "int m dv / F", near(due, 1e-4 * due))]
    steep = lone(resistance_a=60e3, resistance_b=0.0, resistance_c=10.0)
    steep.advance(900.0)
    balance = brentq(lambda v: net_force(steep, v), 20.0, 150.0)
    rows.append(measured("speed of balance", "m/s", float(steep.speed[0]), "P / v = R", near(balance, 1e-4 * balance)))
    slipping = lone()
    slipping.inputs["friction"] = SLIPPERY
    fastest = float(slipping.record(60.0, 0.1)["wheel_speed[1]"].max())
    bound = 1e3 * MOTORS["traction_power"] / (LEFT * SLIPPERY * one.mass * GRAVITY)
    rows.append(measured("fastest wheels that slip", "m/s", fastest, "P / (A mu N)", at_most(1.001 * bound)))
    return rows


def rows_of_run(driver: TimetableDriver, train: Train, run: Recording) -> list[Row]:
    """Return stops and energies of the run."""
    rows = []
    for number, call in enumerate(driver.calls, 1):
        rows.append(measured(f"stop {number}: overrun", "m", call.overrun, "driver", near(0.0, PLACE)))
        if STOPS[number - 1].arrival:
            rows.append(measured(f"stop {number}: late", "s", call.late, "driver", near(0.0, TIME)))
    speed, way = run["speed"], np.diff(run["distance"])
    a, b, c = np.sum([vehicle.resistance for vehicle in train.consist.vehicles], axis=0)
    force = a + b * speed + c * speed**2
    resisted = float(np.sum((force[1:] + force[:-1]) / 2 * way))
    motors, electric, brakes = (run[name][-1] for name in ("traction_energy", "electric_brake_energy", "brake_heat"))
    for name, energy in (("motors", motors), ("resistance", resisted), ("brakes", brakes)):
        rows.append(measured(f"energy at the wheel: {name}", "kWh", energy / 3.6e6))
    open_ = abs(motors - resisted - brakes - electric) / motors
    rows.append(measured("energies that do not close", "1", open_, "couplers take a part", at_most(ENERGY)))
    return rows


def run(options: Options, quick: bool = False) -> Report:
    train = Train(consist_of([LOCOMOTIVE, COACHES]))
    driver = TimetableDriver(STOPS, LIMITS, DECELERATION)
    found = driver.drive(train)
    rows = rows_of_forms() + rows_of_run(driver, train, found)
    parameters = MOTORS | {"deceleration": DECELERATION}
    return Report(rows, found, lambda: draw(found, driver), parameters, float(found["time"][-1]))


def draw(found: Recording, driver: TimetableDriver) -> Figure:
    far = 1e-3 * found["distance"]
    away = max(abs(call.overrun) for call in driver.calls)
    message = f"The train stops within {away:.1f} m of each station"
    figure, axes = charts(message, ["speed [km/h]", "energy at the wheel [kWh]"], (9.0, 4.0), "place of the front [km]")
    axes[0].plot(far, 3.6 * found["speed"], color=LEADING, label="speed")
    places = 1e-3 * np.array([*(place for place, _ in LIMITS), STOPS[-1].place])
    axes[0].step(places, 3.6 * np.array([*(v for _, v in LIMITS), LIMITS[-1][1]]), where="post", color="grey", ls="--")
    for stop in STOPS:
        axes[0].axvline(1e-3 * stop.place, color="grey", lw=0.8)
    axes[1].plot(far, found["traction_energy"] / 3.6e6, color=LEADING, label="motors")
    axes[1].plot(far, found["brake_heat"] / 3.6e6, color=TRAILING, label="brakes")
    axes[1].legend(fontsize=8)
    return figure


SCENARIO = Scenario(
    "train-timetable", "A locomotive starts a train and stops at stations in time: acceleration, slip, energies", run
)

"""A coach that ETCS stops before an end of authority: on a dry rail, and on a low rail with and without protection.

Three FMUs are coupled: BrakedVehicle, whose cylinders fill by flow of air, BrakingCurves and WheelSlideProtection. The
train data are from the coach's own emergency stop on a dry rail, so the curves are right on paper. The driver keeps the
permitted speed of the line and does not brake. The emergency brake acts at EBI.
"""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import BOGIE, FOUR, LINES, single
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, Row, at_least, at_most, measured, near
from bogie_braking.reporting.scenario import Options, Scenario
from brake_controller.protection_fmu import wheel_slide_protection
from fmu_src.cosimulation.master import Connection, Coupling, cosimulate
from fmu_src.cosimulation.recording import Recording
from fmu_src.cosimulation.slave import FmuInstance
from products.braking_curves.fmu import curves_fmu
from products.braking_curves.train_data import fmu_parameters
from products.building import build_protection, up_to_date, write_in_c
from products.coach import NUMBERS
from products.machine import FULL_PRESSURE, coach
from products.supervision import SupervisedTrain
from products.supervision.curves import speed_inaccuracy
from products.supervision.of_run import brake_of_run
from rbd_model.track.friction import RailCondition, dry, low

KMH = 1.0 / 3.6
#: Speed of the line, and that of a quick run; largest speed of the train data, and speed at which the stop for these
#: begins [m/s].
SPEED, QUICK_SPEED, LARGEST, BEGIN = 140.0 * KMH, 60.0 * KMH, 150.0 * KMH, 165.0 * KMH
#: Length of the coach [m]: without effect on level track. Time until traction is off [s]: assumed.
LENGTH, CUT_OFF = 26.4, 1.0
#: Macro step with and without protection [s], interval and longest duration of a stop [s], speed at rest [m/s].
PROTECTED_STEP, STEP, INTERVAL, LONGEST, AT_REST = 5e-3, 1e-2, 0.05, 150.0, 0.01
#: Acceleration of a driver who does not brake [m/s2].
ACCELERATION = 0.3
#: Tolerances [m]. The first is that of a stop on a dry rail, where half of the rise to 95 % stands for the build-up of
#: the brake. The second is that of a difference of two places of EBI: a step of time at 39 m/s.
OF_BUILD_UP, OF_STEP = 4.0, 0.5
PLANAR, BY_FLOW = 2, 2
LOW, PROTECTED, REDUCED = "low, unprotected", "low, protected", "low, protected, reduced adhesion in the curves"


@dataclass(frozen=True)
class Conditions:
    """Rail, whether protection is on and the curves are those of reduced adhesion; acceleration of the driver."""

    rail: RailCondition
    protected: bool = False
    reduced: bool = False
    acceleration: float = 0.0


CASES = {
    "dry": Conditions(dry()),
    "dry, driver accelerates": Conditions(dry(), acceleration=ACCELERATION),
    LOW: Conditions(low()),
    PROTECTED: Conditions(low(), protected=True),
    REDUCED: Conditions(low(), protected=True, reduced=True),
}


@dataclass(frozen=True)
class SupervisedStop:
    """A stop: distance behind the end of authority [m], speed [m/s] and command of the emergency brake over time."""

    series: Recording

    @property
    def begins(self) -> int:
        """Return the first row with the command."""
        return int(np.flatnonzero(self.series["emergency_brake"])[0])

    @property
    def overrun(self) -> float | None:
        """Return where it stops behind the end of authority [m], below 0 before it; None if it does not stop."""
        return float(self.series["behind"][-1]) if self.series["speed"][-1] < AT_REST else None

    @property
    def deceleration(self) -> float | None:
        """Return the mean deceleration over the distance from the command to rest [m/s2]."""
        if self.overrun is None:
            return None
        way = self.overrun - float(self.series["behind"][self.begins])
        return float(self.series["speed"][self.begins]) ** 2 / (2.0 * way)


def coach_instance(rail: RailCondition, speed: float) -> FmuInstance:
    """Return an instance of the coach on a rail."""
    given = {"level": PLANAR, "brake_kind": BY_FLOW, "initial_speed": speed} | rail.values(len(NUMBERS))
    return FmuInstance(up_to_date("braked-vehicle", "native"), **given)


def train_data() -> SupervisedTrain:
    """Return the train data of the coach, from its own emergency stop on a dry rail."""
    pressures = [f"cylinder_pressure_{number}" for number in NUMBERS]
    with coach_instance(dry(), BEGIN) as vehicle:
        vehicle.start()
        series = cosimulate([vehicle], [], 60.0, 0.02, [(vehicle, name) for name in ("speed", *pressures)])
    rolls = slice(0, int(np.flatnonzero(series["speed"] < AT_REST)[0]))
    pressure = np.sum([series[name] for name in pressures], axis=0)
    brake = brake_of_run(series["time"][rolls], series["speed"][rolls], (pressure / pressure.max())[rolls], LARGEST)
    steps, time = brake.deceleration, brake.build_up
    return SupervisedTrain(LENGTH, steps, steps, time, time, T_traction_cut_off=CUT_OFF)


def stop(case: Conditions, train: SupervisedTrain, folder: Path, speed: float) -> SupervisedStop:
    """Run the coach from its indication to rest."""
    with ExitStack() as stack:
        vehicle = stack.enter_context(coach_instance(case.rail, speed))
        curves = stack.enter_context(FmuInstance(folder / "BrakingCurves.fmu", **fmu_parameters(train)))
        slaves, step = [curves, vehicle], STEP
        links = [Connection(curves, "emergency_brake", vehicle, f"pressure_demand_{n}", FULL_PRESSURE) for n in NUMBERS]
        curves.start(V_est=speed, A_est=case.acceleration, distance_to_target=1e5, reduced_adhesion=case.reduced)
        target = curves["distance_I"]
        vehicle.start(**{f"pressure_demand_{number}": 0.0 for number in NUMBERS})
        if case.protected:
            protection = stack.enter_context(FmuInstance(folder / "native" / "WheelSlideProtection4.fmu"))
            slaves, step = [curves, protection, vehicle], PROTECTED_STEP
            protection.start(**{f"wheel_speed_{number}": speed for number in NUMBERS})
            links += [Connection(vehicle, f"wheel_speed_{n}", protection, f"wheel_speed_{n}") for n in NUMBERS]
            links += [Connection(protection, f"valve_{n}", vehicle, f"valve_{n}") for n in NUMBERS]
        return _until_rest(Coupling(slaves, links), vehicle, curves, Driver(case.acceleration, target), step)


@dataclass
class Driver:
    """A driver who accelerates until traction is off, and never brakes; target: distance to the end of authority."""

    acceleration: float
    target: float
    commanded: float | None = None

    @cached_property
    def torque(self) -> float:
        """Return the torque of each wheelset for the acceleration [N.m]."""
        return self.acceleration / coach().deceleration(1.0)

    def drive(self, vehicle: FmuInstance, curves: FmuInstance, time: float) -> None:
        """Set traction, and the inputs of the curves, before a step."""
        speed, distance, rate = vehicle.get(["speed", "distance", "acceleration"])
        curves.set(V_est=speed, distance_to_target=self.target - distance)
        if not self.acceleration:
            return
        curves.set(A_est=rate)
        if curves["emergency_brake"] and self.commanded is None:
            self.commanded = time
        pulls = self.commanded is None or time < self.commanded + CUT_OFF
        vehicle.set(**{f"traction_torque_{number}": self.torque if pulls else 0.0 for number in NUMBERS})


def _until_rest(
    coupling: Coupling, vehicle: FmuInstance, curves: FmuInstance, driver: Driver, step: float
) -> SupervisedStop:
    """Run the coupled FMUs until the coach is at rest, at most LONGEST."""
    rows: list[list[float]] = []
    for time in coupling.run(LONGEST, step, partial(driver.drive, vehicle, curves)):
        distance, speed = vehicle.get(["distance", "speed"])
        if not rows or time > rows[-1][0] + INTERVAL - step / 2.0 or speed < AT_REST:
            rows.append([time, distance - driver.target, speed, curves["emergency_brake"], curves["V_EBI"]])
        if speed < AT_REST:
            break
    units = {"time": "s", "behind": "m", "speed": "m/s", "emergency_brake": "1", "V_EBI": "m/s"}
    return SupervisedStop(Recording(units, np.array(rows)))


def expected(train: SupervisedTrain, speed: float) -> float:
    """Return where the coach stops on a dry rail [m]: the error of the speed, which it does not have, is its margin."""
    rate, time, error = float(train.A_brake_emergency.values.mean()), train.T_brake_emergency, speed_inaccuracy(speed)
    return -float(error * (speed / rate + time) + error**2 / (2.0 * rate))


def rows_of(found: Mapping[str, SupervisedStop], of_speed: float) -> list[Row]:
    """Return the overruns, those with limits first."""
    over = {name: one.overrun for name, one in found.items()}
    places = {name: -float(one.series["behind"][one.begins]) for name, one in found.items()}
    source = "behind the end of authority; below 0 before it"
    late, less_late = over[PROTECTED], over[REDUCED]
    shift = None if late is None or less_late is None else late - less_late
    earlier = places[REDUCED] - places[PROTECTED]
    first = [
        measured("dry: overrun", "m", over["dry"], "closed form: error of the speed", near(of_speed, OF_BUILD_UP)),
        measured("dry, driver accelerates: overrun", "m", over["dry, driver accelerates"], source, at_most(0.0)),
        measured(f"{PROTECTED}: overrun", "m", over[PROTECTED], source, at_least(0.0)),
        measured("low: overrun that reduced adhesion saves", "m", shift, "earlier by EBI", near(earlier, OF_STEP)),
    ]
    judged = {row.quantity for row in first}
    others = [measured(f"{name}: overrun", "m", value, source) for name, value in over.items()]
    rows = first + [row for row in others if row.quantity not in judged]
    for name, one in found.items():
        rows.append(measured(f"{name}: emergency brake before the end of authority", "m", places[name], "EBI"))
        rows.append(measured(f"{name}: mean deceleration", "m/s2", one.deceleration, "over the distance to rest"))
    return rows


def run(options: Options, quick: bool = False) -> Report:
    """Take the train data from a stop, and stop the coach in all cases."""
    train, speed = train_data(), QUICK_SPEED if quick else SPEED
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as name:  # Windows removes no loaded library
        folder = Path(name)
        write_in_c(curves_fmu(), folder / "BrakingCurves.fmu", 2)
        build_protection(folder, wheel_slide_protection(len(NUMBERS)))
        found = {name: stop(case, train, folder, speed) for name, case in counting(CASES.items(), "stops", unit="stop")}
    remarks = [
        "Kdry_rst and Kwet_rst are 1: the curves have the coach's own deceleration and no margin for adhesion. The low "
        f"rail is an unverified set: {low().source}.",
    ]
    parameters = {
        "speed": speed,
        "A_brake_emergency": train.A_brake_emergency.values.tolist(),
        "T_brake_emergency": float(train.T_brake_emergency),
        "T_traction_cut_off": CUT_OFF,
        "rails": {name: case.rail.values(len(NUMBERS)) for name, case in CASES.items()},
    }
    seconds = sum(float(one.series["time"][-1]) for one in found.values())
    series = found[PROTECTED].series
    return Report(rows_of(found, expected(train, speed)), series, lambda: draw(found), parameters, seconds, remarks)


def draw(found: Mapping[str, SupervisedStop]) -> Figure:
    """Draw the speeds over the distance from the end of authority."""
    over = found[PROTECTED].overrun
    way = "does not stop" if over is None else f"stops {over:.0f} m behind the EOA"
    figure, axis = single(f"On low rail the protected coach {way}", "behind the end of authority [m]", "speed [km/h]")
    names = [name for name in found if not CASES[name].acceleration]
    for name, line, colour in zip(names, LINES, FOUR, strict=True):
        series, overrun = found[name].series, found[name].overrun
        label = name if overrun is None else f"{name}: {overrun:+.0f} m"
        axis.plot(series["behind"], series["speed"] / KMH, line, color=colour, label=label)
        begins = found[name].begins
        axis.plot(series["behind"][begins], series["speed"][begins] / KMH, "o", color=colour)
    axis.axvline(0.0, color=BOGIE, linewidth=0.8)
    axis.set(xlim=(-1500.0, None), ylim=(0.0, 215.0), yticks=range(0, 141, 20))
    axis.legend(
        loc="upper right",
        fontsize="medium",
        frameon=True,
        framealpha=1.0,
        edgecolor="white",
        title="stops; dots: emergency brake at EBI",
    )
    return figure


SCENARIO = Scenario(
    "etcs-low-adhesion",
    "A coach that ETCS stops on its curve: overrun on dry rail and on low rail, with and without protection",
    run,
)

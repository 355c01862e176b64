"""Asymmetric brake shoes on one wheelset of the bogie: the case of chapter 9, and the results of the thesis."""

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import product

import numpy as np

from bogie_braking.reporting.progress import counting
from fmu_src.cosimulation.recording import Recording
from fmu_src.kernel import Kernel
from products.kernel_runs import bogie, play
from rbd_model.vehicle.parameters import AS_PRINTED

BRAKE_TORQUE, BRAKE_START, SPEED = 20e3, 1.0, 25.0
#: Yaw torque at full brake by error of the shoe forces [%], Tables 9.2 and 9.3.
YAW_TORQUE = {25: 43.92e3, 50: 87.84e3, 75: 131.76e3}
APPLICATION_TIMES = (10.0, 5.0, 1.0)
#: Stop times [s] by application time; peak lateral shift [mm] of leading and trailing wheelset, in that order.
STOP_TIME = {10.0: 22.9, 5.0: 20.4, 1.0: 18.3}
PEAKS = {
    (1, 25): ((2.4, 1.5), (2.5, 1.7), (2.5, 1.9)),
    (1, 50): ((8.3, 6.1), (9.2, 6.5), (9.3, 7.3)),
    (2, 25): ((1.6, 2.2), (1.7, 2.4), (1.7, 2.7)),
    (2, 50): ((7.4, 5.6), (7.5, 5.9), (7.8, 6.2)),
    (2, 75): ((10.9, 10.8), (11.1, 11.2), (11.2, 11.1)),
}
#: Speed at which the program of the thesis broke down [m/s].
DERAILED_AT = {10.0: 5.9, 5.0: 6.1, 1.0: 6.1}
STANDING, DURATION, INTERVAL = 0.01, 24.0, 2e-3
#: Tolerance for peaks within 1 % away from the flange; after flange impacts the motion is chaotic.
TOLERANCE = 1e-6
LOADS = tuple(f"wheel_load_{n}_{side}" for n in (1, 2) for side in ("left", "right"))
RECORDED = ("speed", "lateral_1", "lateral_2", "flange_force_1", "flange_force_2", *LOADS)
SAID = ("Wheel lift", "Flange climb", "Derailed", "Overturn")


#: Axis of the yaw torque, which turns with the wheelset or is fixed, and points of reaction; the first is the thesis's.
AS_THESIS, AT_RAIL, FIXED, PHYSICAL = "rotating axis", "rotating axis, flange at the rail", "fixed axis", "physical"
READINGS: dict[str, Mapping[str, float]] = {
    AS_THESIS: AS_PRINTED | {"yaw_torque_rotates": 1},
    AT_RAIL: AS_PRINTED | {"yaw_torque_rotates": 1, "flange_at_rail": 1},
    FIXED: AS_PRINTED | {"yaw_torque_rotates": 0},
    PHYSICAL: {"yaw_torque_rotates": 0},
}
#: The thesis's and the physical interpretation with a flange of separate place, force, friction and creep.
ON_PATCHES = {reading: f"{reading}, contact model 2" for reading in (AS_THESIS, PHYSICAL)}
#: Physical except for the flange force, which acts as in the thesis: shows the effect on wheel loads against
#: `PHYSICAL`.
AT_CENTRE = "physical, flange at the axle's centre"
#: The thesis's interpretation with a tenth of the flange's compliance: shows the effect of the spring on derailment.
STIFF = "rotating axis, flange stiffness 1e9 N/m"
FURTHER: dict[str, Mapping[str, float]] = {
    **{name: {**READINGS[reading], "contact_model": 2} for reading, name in ON_PATCHES.items()},
    AT_CENTRE: {**READINGS[PHYSICAL], "flange_at_rail": 0},
    STIFF: {**READINGS[AS_THESIS], "flange_stiffness": 1e9},
}


@dataclass(frozen=True)
class ShoeCase:
    """One line of the tables in one of the READINGS or of the FURTHER ones."""

    wheelset: int
    error: int
    application: float
    reading: str

    @property
    def name(self) -> str:
        place = {1: "leading", 2: "trailing"}[self.wheelset]
        return f"{self.reading}, {place}, {self.error} %, {self.application:g} s"


@dataclass(frozen=True)
class ShoeOutcome:
    """Results of a case: time of rest, or speed at derailment; peaks [m] while it moved; messages."""

    series: Recording
    stop_time: float | None
    derailed_at: float | None
    peaks: tuple[float, float]
    messages: list[str]  # the first wheel lift, the first climb (or quotient above Nadal's limit), and the derailment

    def flanging_load(self, wheelset: int) -> float:
        """Return the largest load of a wheel of this wheelset while the rail pushes its flange [N]."""
        force = self.series[f"flange_force_{wheelset}"]
        left, right = (self.series[f"wheel_load_{wheelset}_{side}"] for side in ("left", "right"))
        return float(np.where(force < 0, left, np.where(force > 0, right, 0.0)).max())

    @property
    def largest_load(self) -> float:
        """Return the largest load of all wheels [N]."""
        return max(float(self.series[name].max()) for name in LOADS)


FASTEST = min(APPLICATION_TIMES)
CASES = [ShoeCase(*values) for values in product((1, 2), YAW_TORQUE, APPLICATION_TIMES, READINGS)]
#: The fastest application with a separate flange contact, all applications of the thesis's derailments, and the others.
FURTHER_CASES = [
    *(ShoeCase(*values) for values in product((1, 2), YAW_TORQUE, [FASTEST], ON_PATCHES.values())),
    *(ShoeCase(1, 75, time, ON_PATCHES[AS_THESIS]) for time in APPLICATION_TIMES if time > FASTEST),
    *(ShoeCase(1, error, FASTEST, AT_CENTRE) for error in YAW_TORQUE),
    ShoeCase(1, 75, FASTEST, STIFF),
]


def brake(
    case: ShoeCase, duration: float, record: Sequence[str] = RECORDED, /, **values: float
) -> tuple[Kernel, Recording]:
    """Run a stop from 25 m/s, with contact maintained where a wheel would lift; return the final kernel and the
    recording.
    """
    full = BRAKE_START + case.application
    torque = [(0.0, 0.0), (BRAKE_START, 0.0), (full, BRAKE_TORQUE)]
    yaw = [(0.0, 0.0), (BRAKE_START, 0.0), (full, YAW_TORQUE[case.error])]
    inputs = {"brake_torque_1": torque, "brake_torque_2": torque, f"yaw_torque_{case.wheelset}": yaw}
    reading = {"wheel_lift_ends": 0.0} | dict((READINGS | FURTHER)[case.reading])
    kernel = bogie(inputs, RECORDED, initial_speed=SPEED, **reading | values)
    return kernel, play("bogie", kernel, duration, INTERVAL, record, inputs)


def run_case(case: ShoeCase, tolerance: float = TOLERANCE) -> ShoeOutcome:
    """Run one stop until rest or derailment."""
    kernel, series = brake(case, DURATION, tolerance=tolerance)
    stop = series.first_time(series["speed"] < STANDING)
    moving = series["time"] <= (DURATION if stop is None else stop)
    peaks = [float(np.abs(series[f"lateral_{n}"][moving]).max()) for n in (1, 2)]
    derailed = float(series["speed"][-1]) if kernel["derailed"] else None
    first = [[line for line in kernel.messages if line.startswith(word)][:1] for word in SAID]
    return ShoeOutcome(series, stop, derailed, (peaks[0], peaks[1]), [line for lines in first for line in lines])


def run_all(cases: Sequence[ShoeCase] = CASES) -> dict[ShoeCase, ShoeOutcome]:
    """Run all these cases; they share the compiled library and run in parallel."""
    bogie((), RECORDED)  # the common library is written and compiled once, before the threads load it
    with ThreadPoolExecutor() as pool:
        found = pool.map(run_case, cases)
        bar = counting(found, "cases", len(cases), unit="case")
        return dict(zip(cases, bar, strict=True))

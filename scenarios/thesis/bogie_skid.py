"""Heavy braking of the bogie behind a lateral wave: a locked wheelset no longer guides (section 5.5)."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from fmu_src.cosimulation.recording import Recording
from rbd_model.levels.models import smallest_level
from rbd_model.vehicle.parameters import AS_PRINTED, as_printed, tables_5_1_and_5_2
from rbd_model.vehicle.ready import two_axle_bogie
from scenarios.bench.drive import bogie, play
from scenarios.reporting.motion import Motion, irregular, motion_columns
from scenarios.reporting.plots import BOGIE, LEADING, TRAILING, mark, plt, titled
from scenarios.reporting.report import Report, Row
from scenarios.scenario import Options, Scenario

TORQUE, APPLIED, SPEED = 60e3, 4.0, 25.0
DURATION, INTERVAL = 14.0, 2e-3
CASES = {"leading wheelset braked": (1,), "both wheelsets braked": (1, 2)}
WAVE = {"lateral_irregularity": 0.025}
RECORDED = (
    *("speed", "angular_velocity_1", "angular_velocity_2"),
    *("lateral_1", "lateral_2", "locked_1", "locked_2", "distance"),
)


def brake(
    braked: tuple[int, ...], reading: Mapping[str, float] = AS_PRINTED, columns: Sequence[str] = RECORDED
) -> tuple[Recording, list[str]]:
    history = [(0.0, 0.0), (APPLIED, 0.0), (APPLIED, TORQUE)]
    inputs = {f"brake_torque_{n}": history for n in braked}
    kernel = bogie(inputs, columns, initial_speed=SPEED, **WAVE, **reading)
    series = play("bogie", kernel, DURATION, INTERVAL, columns, inputs)
    return series, kernel.journal


def run(options: Options) -> Report:
    runs = {name: brake(braked) for name, braked in CASES.items()}
    rows, remarks = [], []
    for name, (series, journal) in runs.items():
        remarks += [f"{name}: {line}" for line in journal]
        hung = brake(CASES[name], {})[1][:1]
        remarks += [f"{name}, torques react on the frame, flanges at the rail: {line}" for line in hung]
        for number in CASES[name]:
            locked = series.first_time(series[f"locked_{number}"] > 0.5)
            delay = None if locked is None else locked - APPLIED
            rows.append(Row(f"{name}: lock of wheelset {number} after", "s", None, delay, None, "section 5.5, rapidly"))
        before = series["time"] < APPLIED
        for label, chosen in (("just before the brake", before & (series["time"] > APPLIED - 0.5)), ("after", ~before)):
            shift = 1e3 * float(np.abs(series["lateral_1"][chosen]).max())
            rows.append(Row(f"{name}: shift of wheelset 1 {label}", "mm", None, shift, None, "Figs 5.45, 5.47"))
    first = runs["leading wheelset braked"][0]
    choice = smallest_level(("brake_torque_1", *WAVE), RECORDED)
    remarks.append(choice.reason)
    parameters = as_printed(tables_5_1_and_5_2()).values() | WAVE | {"level": choice.level}
    return Report(rows, first, lambda: draw(runs), parameters, 2 * DURATION * len(runs), remarks, motion=motion)


def motion() -> Motion:
    """Of the first case."""
    vehicle, (name, braked) = two_axle_bogie(), next(iter(CASES.items()))
    series = brake(braked, columns=motion_columns(vehicle))[0]
    return Motion(f"Behind a wave, {name}", vehicle, series, irregular(**WAVE))


def draw(runs: dict[str, tuple[Recording, list[str]]]) -> Figure:
    figure, grid = plt.subplots(2, len(runs), sharex=True, figsize=(11.0, 6.0))
    radius = tables_5_1_and_5_2().wheel_radius
    for column, (name, (series, _)) in enumerate(runs.items()):
        upper, lower = grid[:, column]
        upper.plot(series["time"], series["speed"], color=BOGIE, label="bogie")
        upper.plot(series["time"], radius * series["angular_velocity_1"], color=LEADING, label="leading wheels")
        upper.plot(series["time"], radius * series["angular_velocity_2"], color=TRAILING, label="trailing wheels")
        upper.set_title(f"{name}: speed and circumferential speeds [m/s]")
        lower.plot(series["time"], 1e3 * series["lateral_1"], color=LEADING)
        lower.plot(series["time"], 1e3 * series["lateral_2"], color=TRAILING)
        lower.set(title="lateral displacement [mm]", xlabel="time [s]")
        for axis in (upper, lower):
            mark(axis, APPLIED, "brake")
    grid[0, 0].legend(loc="lower left")
    return titled(figure, "60 kN.m on one and on both wheelsets at 25 m/s (Figs 5.44-5.47)")


SCENARIO = Scenario("bogie-skid", "60 kN.m behind a lateral wave: skid in space (section 5.5)", run)

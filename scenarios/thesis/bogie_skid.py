"""Heavy braking of the bogie after a lateral wave: a locked wheelset no longer guides (section 5.5)."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.motion import Motion, irregular, motion_columns
from bogie_braking.reporting.plots import LEADING, TRAILING, mark, one_word, single
from bogie_braking.reporting.report import Report, measured
from bogie_braking.reporting.scenario import Options, Scenario
from fmu_src.cosimulation.recording import Recording
from products.kernel_runs import bogie, play
from rbd_model.levels.models import recommend_level
from rbd_model.vehicle.parameters import AS_PRINTED, as_printed, tables_5_1_and_5_2
from rbd_model.vehicle.ready import two_axle_bogie

TORQUE, APPLIED, SPEED = 60e3, 4.0, 25.0
DURATION, INTERVAL = 14.0, 2e-3
#: Time after the brake's application from which the title takes the largest shift [s].
SETTLED = 2.0
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
    return series, kernel.messages


def run(options: Options, quick: bool = False) -> Report:
    runs = {name: brake(braked) for name, braked in CASES.items()}
    rows, remarks = [], []
    for name, (series, messages) in runs.items():
        remarks += [f"{name}: {line}" for line in messages]
        hung = brake(CASES[name], {})[1][:1]
        remarks += [f"{name}, torques react on the frame, flanges at the rail: {line}" for line in hung]
        for number in CASES[name]:
            locked = series.first_time(series[f"locked_{number}"] > 0.5)
            delay = None if locked is None else locked - APPLIED
            rows.append(measured(f"{name}: lock of wheelset {number} after", "s", delay, "section 5.5, rapidly"))
        before = series["time"] < APPLIED
        for label, chosen in (("just before the brake", before & (series["time"] > APPLIED - 0.5)), ("after", ~before)):
            shift = 1e3 * float(np.abs(series["lateral_1"][chosen]).max())
            rows.append(measured(f"{name}: shift of wheelset 1 {label}", "mm", shift, "Figs 5.45, 5.47"))
    first = runs["leading wheelset braked"][0]
    choice = recommend_level(("brake_torque_1", *WAVE), RECORDED)
    remarks += [choice.reason, f"The picture tells the largest shift later than {SETTLED:g} s after the brake."]
    parameters = as_printed(tables_5_1_and_5_2()).values() | WAVE | {"level": choice.level}
    return Report(rows, first, lambda: draw(runs), parameters, 2 * DURATION * len(runs), remarks, motion=motion)


def motion() -> Motion:
    """Run the first case."""
    vehicle, (name, braked) = two_axle_bogie(), next(iter(CASES.items()))
    series = brake(braked, columns=motion_columns(vehicle))[0]
    return Motion(f"Behind a wave, {name}", vehicle, series, irregular(**WAVE))


def draw(runs: dict[str, tuple[Recording, list[str]]]) -> Figure:
    """Draw the lateral shift of the leading wheelset in both cases."""
    swings = [
        1e3 * float(np.abs(series["lateral_1"][series["time"] > APPLIED + SETTLED]).max())
        for series, _ in runs.values()
    ]
    message = one_word(f"{1e-3 * TORQUE:g} kN.m") + " on one wheelset swing it {:.0f} mm, on two {:.0f} mm"
    figure, axis = single(message.format(*swings), "time [s]", "lateral shift of the leading wheelset [mm]")
    for (words, (series, _)), line, colour in zip(runs.items(), ("-", "--"), (LEADING, TRAILING), strict=True):
        axis.plot(series["time"], 1e3 * series["lateral_1"], line, color=colour, label=words, linewidth=2.2)
    axis.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, fontsize="large")
    axis.axvspan(APPLIED + SETTLED, DURATION, color="#eeeeee", zorder=0)
    mark(axis, APPLIED, "brake")
    mark(axis, APPLIED + SETTLED, "swings settled")
    return figure


SCENARIO = Scenario("bogie-skid", "60 kN.m after a lateral wave: skid at level 3 (section 5.5)", run)

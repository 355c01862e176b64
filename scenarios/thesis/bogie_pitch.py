"""The frame pitches when torque acts below its centre: nose up in traction, down in braking (section 5.4.2)."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.motion import Motion, motion_columns
from bogie_braking.reporting.plots import BOGIE, TRAILING, panels
from bogie_braking.reporting.report import Report, at_most, measured
from bogie_braking.reporting.scenario import Options, Scenario
from fmu_src.cosimulation.recording import Recording
from products.kernel_runs import RIGID, period, play, prepare
from rbd_model.vehicle.parameters import AS_PRINTED, as_printed, tables_5_1_and_5_2
from rbd_model.vehicle.ready import two_axle_bogie

TORQUE = 15e3
#: Fig. 5.24: traction grows over 5 s and ends at 20.5 s; braking grows from 25.5 s over 5 s and ends at 37 s.
TRACTION = [(0.0, 0.0), (5.0, TORQUE), (20.5, TORQUE), (20.5, 0.0)]
BRAKE = [(0.0, 0.0), (25.5, 0.0), (30.5, TORQUE), (37.0, TORQUE), (37.0, 0.0)]
DURATION, INTERVAL = 40.0, 2e-3
#: Times of steady traction and braking [s].
PULLED, BRAKED = (15.0, 20.0), (33.0, 36.5)
LEVELS = {2: "planar", 3: "spatial"}
RECORDED = ("speed", "pitch", "distance")
#: Largest relative difference of the pitch of two levels: the tolerance of statics in docs/checking.md.
SAME = 1e-3


def drive(level: int, reaction: float = AS_PRINTED["torque_reaction"], columns: Sequence[str] = RECORDED) -> Recording:
    kernel = prepare("bogie", **RIGID | {"level": level}, initial_speed=0.01, torque_reaction=reaction)
    inputs = {f"traction_torque_{n}": TRACTION for n in (1, 2)} | {f"brake_torque_{n}": BRAKE for n in (1, 2)}
    return play("bogie", kernel, DURATION, INTERVAL, columns, inputs)


def mean_between(series: Recording, begin: float, end: float) -> float:
    chosen = (series["time"] > begin) & (series["time"] < end)
    return float(series["pitch"][chosen].mean())


def run(options: Options, quick: bool = False) -> Report:
    runs = {level: drive(level) for level in LEVELS}
    hung = drive(2, tables_5_1_and_5_2().torque_reaction)
    series, source = runs[2], "section 5.4.2, Fig. 5.29"
    where = "brakes and motors hung in the frame, which (3.36) leaves out"
    ringing = (series["time"] > 20.51) & (series["time"] < 22.0)
    pull = 1e3 * mean_between(series, *PULLED)
    ringing_period = period(series["time"][ringing], series["pitch"][ringing])
    difference = 1e3 * float(np.abs(runs[3]["pitch"] - series["pitch"]).max())
    same, levels = at_most(SAME * abs(pull)), "levels against each other, not the thesis"
    note = "of the pitch in traction what rigid statics are asked for, 0.1 %"
    rows = [
        measured("pitch in traction", "mrad", pull, source, None, "negative"),
        measured("pitch in braking", "mrad", 1e3 * mean_between(series, *BRAKED), source, None, "positive"),
        measured("pitch in traction, motors hung", "mrad", 1e3 * mean_between(hung, *PULLED), where),
        measured("pitch in braking, brakes hung", "mrad", 1e3 * mean_between(hung, *BRAKED), where),
        measured("period of the ringing after the release", "s", ringing_period, source),
        measured("largest difference of pitch, spatial - planar", "mrad", difference, levels, same, note),
    ]
    series.add_from("pitch, spatial", runs[3], "pitch")
    remark = "Symmetric track and loads: the planar level is enough; the spatial one is run to show it."
    parameters = as_printed(tables_5_1_and_5_2()).values()
    return Report(rows, series, lambda: draw(series), parameters, DURATION * (len(runs) + 1), [remark], motion=motion)


def motion() -> Motion:
    """Run at the planar level."""
    vehicle = two_axle_bogie()
    return Motion("Traction, then braking", vehicle, drive(2, columns=motion_columns(vehicle)))


def draw(series: Recording) -> Figure:
    labels = ("speed [m/s]", "pitch of the frame [mrad], positive nose down")
    pull, brake = (1e3 * mean_between(series, *times) for times in (PULLED, BRAKED))
    message = f"{1e-3 * TORQUE:g} kN.m pitch the frame {pull:.1f} mrad in traction, {brake:.1f} in braking"
    figure, axes = panels(message, labels, 2.6)
    axes[0].plot(series["time"], series["speed"], color=BOGIE)
    axes[1].plot(series["time"], 1e3 * series["pitch"], color=BOGIE, label="planar")
    axes[1].plot(series["time"], 1e3 * series["pitch, spatial"], color=TRAILING, linestyle="--", label="spatial")
    axes[1].legend(loc="upper left")
    return figure


SCENARIO = Scenario("bogie-pitch", "Pitch of the frame under torque (section 5.4.2)", run)

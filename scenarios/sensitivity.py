"""What the fitted and assumed values decide: critical speed, lateral peak and derailment over each of them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from matplotlib.figure import Figure

from rbd_model.bogie import wheelset_in_frame
from rbd_model.linear import critical_speed
from rbd_model.parameters import tables_4_1_and_4_2, tables_5_1_and_5_2
from rbd_model.track import section_5_3
from scenarios.asymmetric_braking import BRAKE_START, BRAKE_TORQUE, YAW_TORQUE
from scenarios.cosimulation import Recording
from scenarios.critical_speed import RANGE, growth_by_eigenvalue
from scenarios.plotting import LEADING, THESIS, plt
from scenarios.report import Result, Row
from scenarios.scenario import Options, Scenario
from scenarios.scene import bogie_in_space, play

TOLERANCE = 1e-5
#: Panel: parameter, its values, what is answered, unit, the thesis's answer.
CRITICAL_SPACING = np.linspace(0.30, 0.60, 7)
SPACING = np.linspace(0.55, 0.85, 7)
HEIGHT = np.linspace(0.4, 1.0, 7)
FLANGE = 10.0 ** np.linspace(6.5, 9.0, 6)
BLEND = np.array([0.2, 0.5, 1.0, 2.0, 4.0])


def critical_over_spacing(half_spacing: float) -> float:

    system = wheelset_in_frame()
    return critical_speed(lambda speed: growth_by_eigenvalue(system, speed, half_spacing), *RANGE)


def lateral_peak(**values: float) -> float:
    """Largest shift of the leading wheelset over the lateral wave at 15 m/s [mm]."""
    kernel = bogie_in_space(
        initial_speed=15.0, constant_speed=1, lateral_irregularity=0.025, tolerance=TOLERANCE, **values
    )
    return 1e3 * float(np.abs(play("bogie", kernel, 4.0, 2e-3, ("lateral_1",), {})["lateral_1"]).max())


def derailment_speed(**values: float) -> float:
    """Speed at derailment, 75 % error on the leading wheelset, brake applied in 1 s [m/s]; 0: it stops on the rails."""
    kernel = bogie_in_space(yaw_torque_rotates=1, wheel_lift_ends=0, tolerance=TOLERANCE, **values)
    ramp = [(0.0, 0.0), (BRAKE_START, 0.0), (BRAKE_START + 1.0, 1.0)]
    inputs = {f"brake_torque_{n}": [(t, BRAKE_TORQUE * x) for t, x in ramp] for n in (1, 2)}
    inputs["yaw_torque_1"] = [(t, YAW_TORQUE[75] * x) for t, x in ramp]
    play("bogie", kernel, 20.0, 0.1, ("speed",), inputs)
    return kernel["speed"] if kernel["derailed"] else 0.0


#: Title: name and unit of the abscissa, values, answer, unit of the answer, thesis, value used.
Panel = tuple[str, np.ndarray, Callable[[float], float], str, float | None, float]


def panels_of() -> dict[str, Panel]:
    used, wheelset, track = tables_5_1_and_5_2(), tables_4_1_and_4_2(), section_5_3()
    spacing, height = used.suspension_half_spacing, used.frame_height
    name = "half spacing [m]"
    return {
        "chapter 4: critical speed": (
            *(name, CRITICAL_SPACING, critical_over_spacing, "m/s", 27.0),
            wheelset.suspension_half_spacing,
        ),
        "lateral peak over spacing": (
            *(name, SPACING, lambda x: lateral_peak(suspension_half_spacing=x), "mm", 9.5, spacing),
        ),
        "lateral peak over flange stiffness": (
            *("flange stiffness [N/m]", FLANGE, lambda x: lateral_peak(flange_stiffness=x), "mm", 9.5),
            used.flange_stiffness,
        ),
        "lateral peak over blend": (
            *("blend of the wave [m]", BLEND, lambda x: lateral_peak(irregularity_blend=x), "mm", 9.5),
            track.irregularity_blend,
        ),
        "derailment speed over spacing": (
            *(name, SPACING, lambda x: derailment_speed(suspension_half_spacing=x), "m/s", 6.1, spacing),
        ),
        "derailment speed over height": (
            *("frame height [m]", HEIGHT, lambda x: derailment_speed(frame_height=x), "m/s", 6.1, height),
        ),
    }


def run(options: Options) -> Result:
    panels = panels_of()
    answers = {title: [panel[2](float(x)) for x in panel[1]] for title, panel in panels.items()}
    rows = []
    for title, (name, values, _, unit, thesis, used) in panels.items():
        low, high = min(answers[title]), max(answers[title])
        source = f"{name} from {values[0]:g} to {values[-1]:g}; used {used:g}"
        rows += [Row(f"{title}: least", unit, thesis, low, None, source)]
        rows += [Row(f"{title}: largest", unit, thesis, high, None, source)]
    longest = max(len(found) for found in answers.values())
    series = Recording({"point": "1"}, [[number] for number in range(12)])
    assert longest <= 12
    for title, found in answers.items():
        for label, column in ((panels[title][0].split(" [")[0], panels[title][1]), (title, found)):
            padded = np.full(12, np.nan)
            padded[: len(column)] = column
            series.add(f"{title}: {label}", "SI" if label != title else panels[title][3], padded)
    return Result(rows, series, lambda: draw(panels, answers), tables_5_1_and_5_2().values(), 0.0)


def draw(panels: dict[str, Panel], answers: dict[str, list[float]]) -> Figure:
    figure, grid = plt.subplots(2, 3, figsize=(12.0, 7.0))
    for axis, (title, (name, values, _, unit, thesis, used)) in zip(grid.ravel(), panels.items(), strict=True):
        axis.plot(values, answers[title], "o-", color=LEADING)
        axis.axvline(used, color="#999999", linewidth=0.8)
        if thesis is not None:
            axis.axhline(thesis, color=THESIS, linestyle="--", linewidth=1.0)
        if "stiffness" in name:
            axis.set_xscale("log")
        axis.set_title(f"{title} [{unit}]")
        axis.set_xlabel(name)
    figure.suptitle("What fitted values decide; grey: used, green: thesis, 0 m/s: no derailment", x=0.02, ha="left")
    figure.set_layout_engine("constrained")
    return figure


SCENARIO = Scenario("sensitivity", "What the fitted and assumed values decide", run, frozenset())

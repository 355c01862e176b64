"""Effect of the fitted and assumed values: critical speed, lateral peak, derailment and wheel load over each.

All plots but one use the thesis's assumptions on where forces react. Two compare with contact model 2, whose flange
has its own place and force, and three vary the assumptions of that model.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import LEADING, THESIS, TRAILING, plt, titled
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, Row
from bogie_braking.reporting.scenario import Options, Scenario
from evidence.measuring.scenes import asymmetric
from fmu_src.cosimulation.recording import Recording
from products.kernel_runs import bogie, play
from rbd_model.levels.models import wheelset_in_frame
from rbd_model.linear import critical_speed
from rbd_model.track.irregularity import section_5_3
from rbd_model.vehicle.parameters import AS_PRINTED, as_printed, tables_4_1_and_4_2, tables_5_1_and_5_2
from scenarios.bench.asymmetric_shoes import (
    AS_THESIS,
    DERAILED_AT,
    LOADS,
    ON_PATCHES,
    ShoeCase,
    brake,
)
from scenarios.bench.hunting_wheelset import RANGE, growth_by_eigenvalue
from scenarios.bench.irregularities import CROSS_LEVEL, LATERAL_PEAK, WHEEL_LOAD, largest_wheel_load, travel

TOLERANCE = 1e-5
HALF_SPACING = "half spacing [m]"
SPACINGS = np.linspace(0.55, 0.85, 7)


@dataclass(frozen=True)
class Panel:
    """One plot: the varied parameter and its values, the result, the thesis's result, and the value used.

    on_patches: the same at contact model 2, if both are shown.
    """

    title: str
    varied: str
    values: np.ndarray
    answer: Callable[[float], float]
    unit: str
    thesis: float | None
    used: float
    on_patches: Callable[[float], float] | None = None

    @property
    def lines(self) -> dict[str, Callable[[float], float]]:
        """Return the results by their suffix to the title in the table."""
        return {"": self.answer} | ({} if self.on_patches is None else {", contact model 2": self.on_patches})


def critical_over_spacing(half_spacing: float) -> float:
    """Return the critical speed of the wheelset of chapter 4 [m/s]."""
    system = wheelset_in_frame()
    return critical_speed(lambda speed: growth_by_eigenvalue(system, speed, half_spacing), *RANGE)


def lateral_peak(**values: float) -> float:
    """Return the largest shift of the leading wheelset over the lateral wave at 15 m/s [mm]."""
    read = ("lateral_1",)
    scene = {"initial_speed": 15.0, "constant_speed": 1, "lateral_irregularity": 0.025, "tolerance": TOLERANCE}
    kernel = bogie((), read, **AS_PRINTED | scene | values)
    return 1e3 * float(np.abs(play("bogie", kernel, 4.0, 2e-3, read, {})["lateral_1"]).max())


def derailment_speed(**values: float) -> float:
    """Return the derailment speed, 75 % error on the leading wheelset, brake applied in 1 s [m/s]; 0: no derailment."""
    inputs = asymmetric(75)
    reading = {"yaw_torque_rotates": 1, "wheel_lift_ends": 0, "tolerance": TOLERANCE}
    kernel = bogie(inputs, ("speed", "derailed"), **AS_PRINTED | reading | values)
    play("bogie", kernel, 20.0, 0.1, ("speed",), inputs)
    return kernel["speed"] if kernel["derailed"] else 0.0


def wheel_load(**values: float) -> float:
    """Return the largest load of the leading wheels over the plateau of cross level at 25 m/s [kN]."""
    return largest_wheel_load(travel(CROSS_LEVEL, 25.0, tolerance=TOLERANCE, **values)[1])


@lru_cache
def stop_on_patches(damping: float) -> tuple[float, float]:
    """Return speed at derailment [m/s], as `derailment_speed`, and largest wheel load [kN] at contact model 2."""
    case = ShoeCase(1, 75, 1.0, ON_PATCHES[AS_THESIS])
    kernel, series = brake(case, 20.0, contact_damping=damping, tolerance=TOLERANCE)
    load = max(float(series[name].max()) for name in LOADS)
    return kernel["speed"] if kernel["derailed"] else 0.0, 1e-3 * load


def spaced(half_spacing: float) -> dict[str, float]:
    """Return parameters that place all springs at one half spacing [m]."""
    return {"longitudinal_half_spacing": half_spacing, "vertical_half_spacing": half_spacing}


#: Parameter that moves the wheel load over cross level towards the reported one; chapter 9 needs less for its yaw
#: springs.
HIGH = {"frame_height": 1.2}


def panels() -> list[Panel]:
    """Return all plots: chapter 4, the wave of section 5.3.1, the derailments of chapter 9, and parameters that raise
    wheel loads.
    """
    wheelset, spacings = tables_4_1_and_4_2(), np.linspace(0.30, 0.60, 7)
    used = wheelset.longitudinal_half_spacing
    return [
        Panel("chapter 4: critical speed", HALF_SPACING, spacings, critical_over_spacing, "m/s", 27.0, used),
        *peak_panels(),
        *derailment_panels(),
        *high_panels(),
        *patch_panels(),
    ]


def over(answer: Callable[..., float], name: str) -> Callable[[float], float]:
    """Return a result as a function of one parameter."""
    return lambda value: answer(**{name: value})


def peak_panels() -> list[Panel]:
    """Return the plots of the lateral peak over the wave of section 5.3.1."""
    used, answer = tables_5_1_and_5_2(), ("mm", LATERAL_PEAK[0])
    spacings, stiffnesses, blends = SPACINGS, 10.0 ** np.linspace(6.5, 9.0, 6), np.array([0.2, 0.5, 1.0, 2.0, 4.0])
    return [
        Panel(
            "lateral peak over spacing",
            *(HALF_SPACING, spacings, lambda value: lateral_peak(**spaced(value)), *answer),
            used=used.longitudinal_half_spacing,
            on_patches=lambda value: lateral_peak(contact_model=2, **spaced(value)),
        ),
        Panel(
            "lateral peak over flange stiffness",
            *("flange stiffness [N/m]", stiffnesses, over(lateral_peak, "flange_stiffness"), *answer),
            used=used.flange_stiffness,
        ),
        Panel(
            "lateral peak over blend",
            *("blend of the wave [m]", blends, over(lateral_peak, "irregularity_blend"), *answer),
            used=section_5_3().irregularity_blend,
        ),
    ]


def derailment_panels() -> list[Panel]:
    """Return the plots of the speed at the derailment of chapter 9."""
    used, answer = tables_5_1_and_5_2(), ("m/s", DERAILED_AT[1.0])
    return [
        Panel(
            "derailment speed over spacing against yaw",
            *(HALF_SPACING, SPACINGS, over(derailment_speed, "longitudinal_half_spacing"), *answer),
            used=used.longitudinal_half_spacing,
        ),
        Panel(
            "derailment speed over height",
            *("frame height [m]", np.linspace(0.4, 1.0, 7), over(derailment_speed, "frame_height"), *answer),
            used=used.frame_height,
        ),
    ]


def high_panels() -> list[Panel]:
    """Return plots of parameters that move the wheel load of section 5.3.3 towards the reported one, with effects on
    chapter 9.
    """
    used, wide = tables_5_1_and_5_2(), np.linspace(0.6, 1.0, 5)
    load = ("kN", WHEEL_LOAD[25.0][0])
    return [
        Panel(
            "wheel load over spacing against roll, height 1.2 m",
            *(HALF_SPACING, wide, lambda value: wheel_load(vertical_half_spacing=value, **HIGH), *load),
            used=used.vertical_half_spacing,
        ),
        Panel(
            "the same, flange pushed at the rail",
            *(HALF_SPACING, wide),
            lambda value: wheel_load(vertical_half_spacing=value, flange_at_rail=1, **HIGH),
            *load,
            used=used.vertical_half_spacing,
            on_patches=lambda value: wheel_load(vertical_half_spacing=value, contact_model=2, **HIGH),
        ),
        Panel(
            "derailment speed over spacing against yaw, against roll 0.9 m, height 1.2 m",
            *(HALF_SPACING, SPACINGS),
            lambda value: derailment_speed(longitudinal_half_spacing=value, vertical_half_spacing=0.9, **HIGH),
            *("m/s", DERAILED_AT[1.0]),
            used=used.longitudinal_half_spacing,
        ),
    ]


def patch_panels() -> list[Panel]:
    """Return the effect of the damping of an elastic contact, which is assumed; the thesis's model has no damping."""
    used = tables_5_1_and_5_2().contact_damping
    over = "contact damping [s/m]", used * np.array([0.5, 1.0, 2.0])
    return [
        Panel(
            "lateral peak at contact model 2",
            *over,
            lambda value: lateral_peak(contact_model=2, contact_damping=value),
            *("mm", LATERAL_PEAK[0]),
            used=used,
        ),
        Panel(
            "derailment speed at contact model 2",
            *over,
            lambda value: stop_on_patches(value)[0],
            *("m/s", DERAILED_AT[1.0]),
            used=used,
        ),
        Panel("largest wheel load of that stop", *over, lambda value: stop_on_patches(value)[1], "kN", None, used=used),
    ]


READING = (
    "In the picture a grey line is the value that is used, a green one what the thesis prints; 0 m/s is no derailment; "
    "orange, in the last row, is contact model 2."
)


def run(options: Options, quick: bool = False) -> Report:
    asked = [
        (f"{panel.title}{word}", answer, float(value))
        for panel in panels()
        for word, answer in panel.lines.items()
        for value in panel.values
    ]
    answers: dict[str, list[float]] = {name: [] for name, _, _ in asked}
    for name, answer, value in counting(asked, "values", unit="value"):
        answers[name].append(answer(value))
    rows = []
    for panel, name in [(one, f"{one.title}{word}") for one in panels() for word in one.lines]:
        source = f"{panel.varied} from {panel.values[0]:g} to {panel.values[-1]:g}; used {panel.used:g}"
        for word, found in (("least", min(answers[name])), ("largest", max(answers[name]))):
            rows.append(Row(f"{name}: {word}", panel.unit, panel.thesis, found, None, source))
    series = Recording({"panel": "1", "varied": "SI", "answer": "m/s, mm or kN"}, table(answers))
    parameters = as_printed(tables_5_1_and_5_2()).values()
    return Report(rows, series, lambda: draw(answers), parameters, 0.0, [READING])


def table(answers: dict[str, list[float]]) -> list[list[float]]:
    """Return rows (panel counted from 1, plus a half for its results at contact model 2; value, result)."""
    return [
        [number + line / 2, value, answer]
        for number, panel in enumerate(panels(), 1)
        for line, word in enumerate(panel.lines)
        for value, answer in zip(panel.values, answers[f"{panel.title}{word}"], strict=True)
    ]


def draw(answers: dict[str, list[float]]) -> Figure:
    figure, grid = plt.subplots(4, 3, figsize=(12.0, 13.0))
    for axis, panel in zip(grid.ravel(), panels(), strict=True):
        for word, style in zip(panel.lines, ("o-", "s--"), strict=False):
            colour = TRAILING if word else LEADING
            axis.plot(panel.values, answers[f"{panel.title}{word}"], style, color=colour)
        axis.axvline(panel.used, color="#999999", linewidth=0.8)
        if panel.thesis is not None:
            axis.axhline(panel.thesis, color=THESIS, linestyle="--", linewidth=1.0)
        if "stiffness" in panel.varied:
            axis.set_xscale("log")
        axis.set_title(f"{panel.title} [{panel.unit}]", fontsize=9, wrap=True)
        axis.set_xlabel(panel.varied)
    critical = answers[panels()[0].title]
    words = f"critical speed from {min(critical):.0f} to {max(critical):.0f} m/s"
    return titled(figure, f"The half spacing moves the {words}")


SCENARIO = Scenario("sensitivity", "Effect of the fitted and assumed values", run)

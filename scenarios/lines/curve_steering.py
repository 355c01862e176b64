"""A bogie in steady curves: where its wheelsets run, which flange bears, and what the rails carry, over radius."""

from __future__ import annotations

import math
import tempfile
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from tqdm import tqdm

from rbd_model.line import GAUGE, arc, clothoid, line_of, straight
from rbd_model.parameters import tables_5_1_and_5_2
from scenarios.bench.drive import prepare
from scenarios.cosimulation.recording import Recording
from scenarios.reporting.plots import LEADING, TRAILING, plt
from scenarios.reporting.progress import PATIENCE
from scenarios.reporting.report import Result, Row, at_most, near
from scenarios.scenario import Options, Scenario

BOGIE = tables_5_1_and_5_2()
RADII = (150.0, 200.0, 300.0, 450.0, 700.0, 1000.0, 1500.0, 3000.0)
#: Cant deficiencies at one radius [m]; negative: too much cant.
DEFICIENCIES, RADIUS = (-0.1, -0.05, 0.0, 0.05, 0.1, 0.15), 300.0
#: Speed that wide curves are canted for [m/s], and the most cant that a curve gets [m]; up to 24 m/s with the largest
#: deficiency, below the critical speed of the bogie.
SPEED, MOST_CANT = 15.0, 0.15
#: Way in the curve until all is steady [m].
SETTLED = 250.0
#: Of the sum of all guiding forces, which nothing but the cant deficiency decides.
BAND = 5e-4
COLUMNS = {
    "lateral_1": "m",
    "lateral_2": "m",
    "yaw_1": "rad",
    "yaw_2": "rad",
    "flange_force_1": "N",
    "flange_force_2": "N",
    "guiding_force_1": "N",
    "guiding_force_2": "N",
    "derailment_quotient_1_right": "1",
}
GIVEN = {"radius": "m", "deficiency": "m", "speed": "m/s", "cant": "m"}


def curve(radius: float, deficiency: float, cant: float) -> list[float]:
    """Values of GIVEN and means of COLUMNS over the last 50 m, in a curve to the left."""
    speed = math.sqrt(radius * BOGIE.gravity * (cant + deficiency) / GAUGE)
    before, behind = straight(20.0), arc(SETTLED + 50.0, radius, cant)
    line = line_of([before, clothoid(max(60.0, 600.0 * abs(cant)), before, behind), behind])
    with tempfile.TemporaryDirectory() as folder:
        path = line.write(Path(folder) / "curve.csv")
        kernel = prepare("bogie", level=3.0, initial_speed=speed, constant_speed=1.0, line_file=str(path))
    kernel.advance((line.length - 90.0) / speed)
    steady = kernel.record(50.0 / speed, 0.01, list(COLUMNS))
    return [radius, deficiency, speed, cant, *(float(np.mean(steady[name])) for name in COLUMNS)]


def run(options: Options) -> Result:
    cases = [(radius, 0.0, min(MOST_CANT, GAUGE * SPEED**2 / radius / BOGIE.gravity)) for radius in RADII]
    cases += [(RADIUS, one, MOST_CANT) for one in DEFICIENCIES]
    table = [curve(*case) for case in tqdm(cases, desc="curve-steering", leave=False, delay=PATIENCE)]
    series = Recording(GIVEN | COLUMNS, table)
    mass = BOGIE.frame_mass + 2 * BOGIE.wheelset_mass
    rows = []
    for place, (radius, deficiency, _) in enumerate(cases):
        angle, speed = math.asin(series["cant"][place] / GAUGE), float(series["speed"][place])
        outwards = speed**2 / radius * math.cos(angle) - BOGIE.gravity * math.sin(angle)
        guiding = float(series["guiding_force_1"][place] + series["guiding_force_2"][place])
        rows.append(
            Row(
                f"sum of guiding forces, R = {radius:g} m, cant deficiency {1e3 * deficiency:g} mm",
                "kN",
                None,
                guiding / 1e3,
                near(mass * outwards / 1e3, BAND * mass * BOGIE.gravity / 1e3),
                "Newton's second law: m (V^2 / R cos - g sin of the cant)",
            )
        )
    wide = float(series["lateral_1"][RADII.index(3000.0)])
    rows.append(
        Row("shift of the leading wheelset, R = 3000 m", "mm", None, 1e3 * abs(wide), at_most(9.5), "flange at 9.5 mm")
    )
    return Result(rows, series, lambda: draw(series), {"speed": SPEED}, 0.0, [who_flanges(series)])


def who_flanges(series: Recording) -> str:
    """Up to which radius each wheelset presses a flange against its rail."""
    words = []
    for number, word in ((1, "leading"), (2, "trailing")):
        forces = np.abs(series[f"flange_force_{number}"][: len(RADII)])
        bearing = [radius for radius, force in zip(RADII, forces, strict=True) if force > 100.0]
        words.append(f"the {word} one up to {max(bearing):g} m" if bearing else f"the {word} one nowhere")
    return f"Flanges that bear at balanced cant: {', '.join(words)}."


def draw(series: Recording) -> Figure:
    figure, axes = plt.subplots(2, 2, figsize=(9.5, 7.0))
    (shift, yaw), (guiding, balance) = axes
    radii, rest = slice(0, len(RADII)), slice(len(RADII), None)
    for number, colour, word in ((1, LEADING, "leading"), (2, TRAILING, "trailing")):
        for axis, name, factor in ((shift, "lateral", 1e3), (yaw, "yaw", 1e3), (guiding, "guiding_force", 1e-3)):
            values = factor * series[f"{name}_{number}"][radii]
            axis.semilogx(series["radius"][radii], values, "o-", color=colour, label=word)
        forces = series[f"guiding_force_{number}"][rest] / 1e3
        balance.plot(1e3 * series["deficiency"][rest], forces, "o-", color=colour)
    shift.set_title("lateral shift, to the left [mm]")
    yaw.set_title("yaw against the track [mrad]")
    guiding.set_title("guiding force, to the left [kN]")
    balance.set_title(f"guiding force at R = {RADIUS:g} m [kN]")
    for axis in (shift, yaw, guiding):
        axis.set_xlabel("radius [m]")
        axis.set_xticks([150, 300, 700, 1500, 3000], ["150", "300", "700", "1500", "3000"], minor=False)
        axis.minorticks_off()
    balance.set_xlabel("cant deficiency [mm]")
    shift.legend()
    figure.suptitle("A bogie in steady curves to the left", x=0.02, ha="left")
    figure.set_layout_engine("constrained")
    return figure


SCENARIO = Scenario(
    "curve-steering",
    "A bogie in steady curves: shift, yaw and guiding forces over radius and cant deficiency",
    run,
    frozenset(),
)

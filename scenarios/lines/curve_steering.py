"""A bogie in steady curves over the radius: lateral position of its wheelsets, bearing flange, loads on the rails."""

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import LEADING, TRAILING, charts
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, at_most, measured, near
from bogie_braking.reporting.scenario import Options, Scenario
from fmu_src.cosimulation.recording import Recording
from products.kernel_runs import prepare_on_line
from scenarios.bench.curves import BOGIE, MASS, MOST_CANT, into_curve, outward_acceleration, suited_cant, suited_speed

RADII = (150.0, 200.0, 300.0, 450.0, 700.0, 1000.0, 1500.0, 3000.0)
#: Cant deficiencies at one radius [m]; negative: cant excess.
DEFICIENCIES, RADIUS = (-0.1, -0.05, 0.0, 0.05, 0.1, 0.15), 300.0
#: Speed for which wide curves have balanced cant [m/s]. With the largest deficiency it is up to 24 m/s, below the
#: critical speed of the bogie.
SPEED = 15.0
#: Distance in the curve to steady running [m].
SETTLED = 250.0
#: Tolerance of the sum of all guiding forces, which only the cant deficiency determines.
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
    """Return values of GIVEN and means of COLUMNS over the last 50 m, in a curve to the left."""
    speed, line = suited_speed(radius, cant, deficiency), into_curve(radius, cant, SETTLED + 50.0)
    kernel = prepare_on_line("bogie", line, level=3.0, initial_speed=speed, constant_speed=1.0)
    kernel.advance((line.length - 90.0) / speed)
    steady = kernel.record(50.0 / speed, 0.01, list(COLUMNS))
    return [radius, deficiency, speed, cant, *(float(np.mean(steady[name])) for name in COLUMNS)]


def run(options: Options, quick: bool = False) -> Report:
    cases = [(radius, 0.0, suited_cant(radius, SPEED)) for radius in RADII]
    cases += [(RADIUS, one, MOST_CANT) for one in DEFICIENCIES]
    table = [curve(*case) for case in counting(cases, "curve-steering")]
    series = Recording(GIVEN | COLUMNS, table)
    rows = []
    for place, (radius, deficiency, _) in enumerate(cases):
        outwards = outward_acceleration(radius, float(series["cant"][place]), float(series["speed"][place]))
        guiding = float(series["guiding_force_1"][place] + series["guiding_force_2"][place])
        name = f"sum of guiding forces, R = {radius:g} m, cant deficiency {1e3 * deficiency:g} mm"
        asked = near(MASS * outwards / 1e3, BAND * MASS * BOGIE.gravity / 1e3)
        law = "Newton's second law: m (V^2 / R cos - g sin of the cant)"
        rows.append(measured(name, "kN", guiding / 1e3, law, asked))
    wide = float(series["lateral_1"][RADII.index(3000.0)])
    name = "shift of the leading wheelset, R = 3000 m"
    rows.append(measured(name, "mm", 1e3 * abs(wide), "flange at 9.5 mm", at_most(9.5)))
    return Report(rows, series, lambda: draw(series), {"speed": SPEED}, 0.0, [who_flanges(series)])


def who_flanges(series: Recording) -> str:
    """Return the radius up to which each wheelset presses a flange against its rail."""
    words = []
    for number, word in ((1, "leading"), (2, "trailing")):
        forces = np.abs(series[f"flange_force_{number}"][: len(RADII)])
        bearing = [radius for radius, force in zip(RADII, forces, strict=True) if force > 100.0]
        words.append(f"the {word} one up to {max(bearing):g} m" if bearing else f"the {word} one nowhere")
    return f"Flanges that bear at balanced cant: {', '.join(words)}."


def draw(series: Recording) -> Figure:
    radii, rest = slice(0, len(RADII)), slice(len(RADII), None)
    tightest = 1e-3 * abs(float(series["guiding_force_1"][radii][0]))
    message = f"The leading wheelset guides with {tightest:.0f} kN at {RADII[0]:g} m radius"
    names = ("lateral shift, to the left [mm]", "yaw against the track [mrad]", "guiding force, to the left [kN]")
    titles = dict.fromkeys(names, "radius [m]") | {f"guiding force at R = {RADIUS:g} m [kN]": "cant deficiency [mm]"}
    figure, (*over_radius, balance) = charts(message, titles, (9.5, 7.0))
    for number, colour, line, word in ((1, LEADING, "o-", "leading"), (2, TRAILING, "s--", "trailing")):
        for axis, name, factor in zip(over_radius, ("lateral", "yaw", "guiding_force"), (1e3, 1e3, 1e-3), strict=True):
            values = factor * series[f"{name}_{number}"][radii]
            axis.semilogx(series["radius"][radii], values, line, color=colour, label=word)
        forces = series[f"guiding_force_{number}"][rest] / 1e3
        balance.plot(1e3 * series["deficiency"][rest], forces, line, color=colour)
    for axis in over_radius:
        axis.set_xticks([150, 300, 700, 1500, 3000], ["150", "300", "700", "1500", "3000"], minor=False)
        axis.minorticks_off()
    over_radius[0].legend()
    return figure


SCENARIO = Scenario(
    "curve-steering", "A bogie in steady curves: shift, yaw and guiding forces over radius and cant deficiency", run
)

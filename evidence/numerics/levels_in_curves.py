"""Levels in curves: point and planar with von Roeckl's resistance, compared with spatial, over the radius.

Levels point and planar model a curve by `curve_resistance` alone, a share of the weight (von Roeckl 1880). At level 3
the creep of the wheels and the flanges retard the bogie. The scenario measures the energy that a rolling bogie loses
in a curve, and the stopping distance if it is braked there. `levels` has the same for straight track, over adhesion
utilisation.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product

import casadi as ca
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import BOGIE as GREY
from bogie_braking.reporting.plots import LEADING, THREE, TRAILING, plt, titled
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, Row, measured, near
from bogie_braking.reporting.scenario import Options, Scenario
from bogie_braking.reporting.timing import LEVELS, REPEATS, least
from fmu_src.cosimulation.recording import Recording
from fmu_src.kernel import Kernel
from products.kernel_runs import play, prepare_on_line
from rbd_model.levels.resistance import curve_share
from scenarios.bench.curves import (
    APPROACH,
    BOGIE,
    MASS,
    TURNING_MASS,
    into_curve,
    suited_cant,
    suited_speed,
    transition_length,
)

RADII = (150.0, 200.0, 250.0, 299.0, 300.0, 400.0, 500.0, 700.0, 1000.0, 1500.0, 2000.0, 3000.0)
#: Radii of the table; and of the stop whose cost is measured [m].
SHOWN, COSTED = (150.0, 300.0, 700.0, 1500.0, 3000.0), 300.0
#: Radius above which a curve is wide [m].
WIDE = 700.0
#: Speed, lower in curves whose cant is too small for it [m/s].
SPEED = 15.0
#: Wheel-rail friction; the second value is that of the stops.
FRICTIONS, FRICTION = (0.15, 0.3, 0.45), 0.3
#: Distance in the curve to steady running, then distance of rolling over which the loss is measured [m].
SETTLED, MEASURED = 150.0, 150.0
#: Adhesion utilisation of a light brake and a service brake, 0.3 and 0.9 m/s2; application time [s].
UTILISATIONS, APPLIED = (0.1, 0.3), 1.0
#: Tolerance of the point level's loss against von Roeckl's share: speeds are read from a recording.
SHARE_BAND = 1e-3
#: Tolerance of the resistance of a bogie in 3D on straight track, as share of the weight; the exact value is zero.
NOTHING = 1e-8
#: Level, and whether it has von Roeckl's term.
MODELS = {
    "point": (1, 1.0),
    "planar": (2, 1.0),
    "point without the term": (1, 0.0),
    "spatial": (3, 0.0),
}


def start(radius: float, level: int, term: float, friction: float = FRICTION) -> Kernel:
    """Return the rolling bogie at the beginning of a line into a curve."""
    cant = suited_cant(radius, SPEED)
    values = {"level": level, "curve_resistance": term, "initial_speed": speed_in(radius)}
    frictions = {f"friction_{number}": friction for number in (1, 2)}
    return prepare_on_line("bogie", into_curve(radius, cant, 2e3), **values, **frictions)


def speed_in(radius: float) -> float:
    """Return the speed of balanced cant [m/s]."""
    return SPEED if math.isinf(radius) else min(SPEED, suited_speed(radius, suited_cant(radius, SPEED)))


def way_to_curve(radius: float) -> float:
    """Return the distance from the start to steady running in the curve [m]."""
    return APPROACH + transition_length(suited_cant(radius, SPEED)) + SETTLED


def resistance(radius: float, level: int, term: float, friction: float = FRICTION) -> float:
    """Return the resistance of a rolling bogie in a steady curve, from its loss of energy.

    Takes radius [m]; returns [1].
    """
    kernel, first = start(radius, level, term, friction), way_to_curve(radius)
    series = play("bogie", kernel, 1.1 * (first + MEASURED) / speed_in(radius), 0.05, ("speed", "distance"), {})
    before, behind = (np.interp(place, series["distance"], series["speed"]) for place in (first, first + MEASURED))
    lost = (MASS + TURNING_MASS) * (before**2 - behind**2) / 2
    return float(lost / (MASS * BOGIE.gravity * MEASURED))


def brake(kernel: Kernel, radius: float, utilisation: float) -> float:
    """Return the distance from the start of the line to rest, braked in the curve [m]."""
    torque = utilisation * FRICTION * MASS * BOGIE.gravity * BOGIE.wheel_radius / 2
    begin = way_to_curve(radius) / speed_in(radius)
    ramp = [(0.0, 0.0), (begin, 0.0), (begin + APPLIED, torque)]
    duration = begin + APPLIED + 1.1 * speed_in(radius) / (utilisation * FRICTION * BOGIE.gravity)
    series = play("bogie", kernel, duration, duration, ("distance",), {f"brake_torque_{n}": ramp for n in (1, 2)})
    return float(series["distance"][-1])


@dataclass(frozen=True)
class CurveComparison:
    """Shares of the weight by radius: von Roeckl's, the point level's, the spatial level's by friction; stopping
    distances [m] by model and utilisation, for each radius; wall time of a stop by level [s].
    """

    roeckl: np.ndarray
    point: np.ndarray
    spatial: Mapping[float, np.ndarray]
    straight: float
    stops: Mapping[tuple[str, float], np.ndarray]
    costs: Mapping[str, float]

    def error(self, model: str, utilisation: float) -> np.ndarray:
        """Return the error of the stopping distance, measured from the place where the brakes are applied [m]."""
        return self.stops[model, utilisation] - self.stops["spatial", utilisation]

    def share(self, model: str, utilisation: float) -> np.ndarray:
        """Return the error as share of that distance."""
        braked = self.stops["spatial", utilisation] - [way_to_curve(radius) for radius in RADII]
        return np.asarray(self.error(model, utilisation) / braked)

    @property
    def break_even(self) -> float:
        """Return the radius above which the point level has the smaller error without the term [m]."""
        rest = self.spatial[FRICTION] / self.roeckl - 0.5
        last = int(np.flatnonzero(rest > 0.0)[-1])
        share = rest[last] / (rest[last] - rest[last + 1])
        return RADII[last] + share * (RADII[last + 1] - RADII[last])


def measure(repeats: int) -> CurveComparison:
    roeckl = np.array([float(curve_share(ca.SX(1 / radius))) for radius in RADII])
    point = np.array([resistance(radius, 1, 1.0) for radius in RADII])
    cases = counting(list(product(FRICTIONS, RADII)), "rolling")
    losses = np.array([resistance(radius, 3, 0.0, friction) for friction, radius in cases]).reshape(-1, len(RADII))
    wanted = counting(list(product(MODELS, UTILISATIONS)), "stops")
    stops = {
        (model, utilisation): np.array([brake(start(radius, *MODELS[model]), radius, utilisation) for radius in RADII])
        for model, utilisation in wanted
    }
    straight = resistance(math.inf, 3, 0.0)
    spatial = dict(zip(FRICTIONS, losses, strict=True))
    costs = {name: cost(level, repeats) for level, name in LEVELS.items()}
    return CurveComparison(roeckl, point, spatial, straight, stops, costs)


def cost(level: int, repeats: int) -> float:
    """Return the wall time of one stop, the least of several [s]."""
    kernel = start(COSTED, level, 1.0)

    def once() -> None:
        kernel.reopen()
        brake(kernel, COSTED, UTILISATIONS[1])

    return least(once, repeats)


def run(options: Options, quick: bool = False) -> Report:
    found = measure(1 if quick else REPEATS)
    series = Recording({"radius": "m"}, [[radius] for radius in RADII])
    series.add("von_roeckl", "1", found.roeckl)
    for friction, shares in found.spatial.items():
        series.add(f"spatial_friction_{friction:g}", "1", shares)
    for (model, utilisation), ways in found.stops.items():
        series.add(f"way_{model.replace(' ', '_')}_{utilisation:g}", "m", ways)
    rows = [*checks(found), *loss_rows(found), *stop_rows(found), *cost_rows(found)]
    parameters = BOGIE.values() | {"speed": SPEED, "friction": FRICTION}
    return Report(rows, series, lambda: draw(found), parameters, 0.0, remarks(found))


def checks(found: CurveComparison) -> list[Row]:
    """Return the rows of resistances with closed forms."""
    off = float(np.max(np.abs(found.point / found.roeckl - 1.0)))
    source = "von Roeckl (1880): 0.650 / (R - 55 m), 0.500 / (R - 30 m) below 300 m"
    name = "point: largest relative error of the share of the weight that a curve takes"
    straight = "spatial: share of the weight that straight track takes"
    return [
        measured(name, "1", off, source, near(0.0, SHARE_BAND)),
        measured(straight, "1", found.straight, "conservation of energy: nothing slides", near(0.0, NOTHING)),
    ]


def loss_rows(found: CurveComparison) -> list[Row]:
    rows = []
    for radius in SHOWN:
        at = RADII.index(radius)
        low, high = (f"{1e3 * found.spatial[friction][at]:.3g}" for friction in FRICTIONS[::2])
        frictions = f"friction {FRICTIONS[0]:g}: {low}, {FRICTIONS[2]:g}: {high}"
        words = f"{frictions}; von Roeckl {1e3 * found.roeckl[at]:.3g}"
        name = f"spatial: resistance at R = {radius:g} m"
        resistance = 1e3 * float(found.spatial[FRICTION][at])
        rows.append(measured(name, "N/kN", resistance, words))
    return rows


def stop_rows(found: CurveComparison) -> list[Row]:
    rows = []
    for utilisation, model, radius in product(UTILISATIONS, ("point", "point without the term"), SHOWN):
        at = RADII.index(radius)
        percent, metres = 100 * found.share(model, utilisation)[at], found.error(model, utilisation)[at]
        name = f"{model}: error of the stop at R = {radius:g} m, utilisation {utilisation:g}"
        rows.append(measured(name, "%", percent, f"against the spatial level; {metres:+.2f} m"))
    apart = [np.abs(found.stops["planar", one] - found.stops["point", one]) for one in UTILISATIONS]
    name = "planar: largest difference of a stop from that of the point level"
    even = "point: errs less without the term from a radius of"
    return [
        *rows,
        measured(name, "m", np.max(apart), "all radii, both utilisations"),
        measured(even, "m", found.break_even, "in space the resistance is half of the term there"),
    ]


def cost_rows(found: CurveComparison) -> list[Row]:
    point = found.costs["point"]
    what, source = (
        f"cost of a stop at R = {COSTED:g} m over that of the point level",
        "measured now, least of several runs",
    )
    return [
        measured(f"{name}: {what}", "1", seconds / point, source, None, f"{1e3 * seconds:.2g} ms")
        for name, seconds in found.costs.items()
    ]


def remarks(found: CurveComparison) -> list[str]:
    """Return the rule in words."""
    service = UTILISATIONS[1]
    with_term, without = (100 * found.share(model, service) for model in ("point", "point without the term"))
    wide = np.array(RADII) >= WIDE
    share = found.spatial[FRICTION] / found.roeckl
    return [
        f"Stops with a service brake, {service:g} of the adhesion, behind some 230 m of rolling: with von Roeckl's "
        f"term the point and the planar level stop up to {-np.min(with_term):.1f} % early, without it up to "
        f"{np.max(without):.1f} % late. From R = {WIDE:g} m on it is {-np.min(with_term[wide]):.1f} % and "
        f"{np.max(without[wide]):.1f} %: from R = {found.break_even:.0f} m on they err less without the term.",
        f"Rolling: in space this bogie loses {np.min(share[~wide]):.2f} to {np.max(share[~wide]):.2f} of what the term "
        f"says below {WIDE:g} m, and {share[-1]:.2f} of it at {RADII[-1]:g} m, where both wheelsets roll on their line "
        f"and no flange bears. Below {WIDE:g} m it nearly goes with friction, which the term does not know. How far a "
        "vehicle rolls is a question for the spatial level at any radius.",
        "The term has a step: at 300 m it says 1.4 times what it says just below.",
    ]


def draw(found: CurveComparison) -> Figure:
    figure, ((loss, relative), (metres, bars)) = plt.subplots(2, 2, figsize=(10.5, 7.6))
    loss.loglog(RADII, 1e3 * found.roeckl, color=GREY, label="von Roeckl")
    for (friction, shares), colour in zip(found.spatial.items(), THREE, strict=True):
        loss.loglog(RADII, 1e3 * shares, "o-", color=colour, markersize=3, label=f"spatial, friction {friction:g}")
    loss.set_title("resistance of a rolling bogie [N/kN]")
    loss.legend()
    draw_errors(relative, metres, found)
    relative.set_title("error of the stopping distance [%]")
    metres.set_title("error of the stopping distance [m]")
    relative.legend(title="von Roeckl's term, utilisation", ncols=2, fontsize=8)
    for axis in (loss, relative, metres):
        axis.set_xlabel("radius [m]")
        axis.set_xticks([150, 300, 700, 1500, 3000], ["150", "300", "700", "1500", "3000"])
        axis.minorticks_off()
    loss.yaxis.set_major_formatter("{x:g}")
    draw_costs(bars, found)
    errors = (
        100 * max(float(np.abs(found.share(model, utilisation)).max()) for utilisation in UTILISATIONS)
        for model in ("point", "point without the term")
    )
    message = "With von Roeckl's term stops err by {:.0f}%, without by {:.0f}%"
    return titled(figure, message.format(*errors))


def draw_errors(relative: Axes, metres: Axes, found: CurveComparison) -> None:
    """Draw the errors of the stops at the point level, with von Roeckl's term and without it."""
    models = {"with": ("point", LEADING), "without": ("point without the term", TRAILING)}
    for (word, (model, colour)), utilisation in product(models.items(), UTILISATIONS):
        style = "o:" if utilisation == UTILISATIONS[0] else "o-"
        look = {"color": colour, "markersize": 3, "label": f"{word}, {utilisation:g}"}
        relative.semilogx(RADII, 100 * found.share(model, utilisation), style, **look)
        metres.semilogx(RADII, found.error(model, utilisation), style, **look)


def draw_costs(axis: Axes, found: CurveComparison) -> None:
    """Draw the costs as ratios to the point level."""
    ratios = {name: seconds / found.costs["point"] for name, seconds in found.costs.items()}
    for place, (name, colour) in enumerate(zip(ratios, THREE, strict=True)):
        axis.barh(-place, ratios[name], color=colour)
        axis.annotate(f"{ratios[name]:.0f}", (ratios[name], -place), xytext=(3, -3), textcoords="offset points")
    axis.set_yticks(-np.arange(len(ratios)), list(ratios))
    axis.set(xscale="log", xlim=(0.5, 3 * max(ratios.values())))
    axis.xaxis.set_major_formatter("{x:g}")
    axis.grid(axis="y", visible=False)
    axis.set_title(f"cost of one stop at R = {COSTED:g} m, over the point level [1]")


SCENARIO = Scenario(
    "levels-in-curves",
    "Point and planar level with von Roeckl's curve resistance against the spatial one over radius, and their cost",
    run,
)

"""Effect of braking torque on Y/Q in curves: a bogie braked in steady curves and on straight track, and stopped in one.

In steady curves the speed is held while the brakes drag, so that only their torque differs; the cant suits the speed.
Then the bogie stops from that speed in the curve, or is braked from the beginning of the transition on. Adhesion
utilisation: as in `levels`, brake torque over wheel radius, over friction times the static load.
"""

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bogie_braking.reporting.motion import Motion, motion_columns
from bogie_braking.reporting.plots import FOUR, THREE, charts
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, Row, measured, near
from bogie_braking.reporting.scenario import Options, Scenario
from fmu_src.cosimulation.recording import Recording
from products.kernel_runs import play, prepare_on_line
from rbd_model.track.line import Line
from rbd_model.vehicle.ready import two_axle_bogie
from scenarios.bench.curves import (
    APPROACH,
    BOGIE,
    MASS,
    into_curve,
    outward_acceleration,
    suited_cant,
    transition_length,
)

#: Radii of curves to the left, and straight track [m].
RADII = (200.0, 300.0, 600.0, math.inf)
#: Adhesion utilisations; on straight track the trailing wheelset locks from 0.70 on (scenario `levels`).
UTILISATIONS = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.65, 0.68)
#: Utilisations of the stops in a curve: medium, and near the adhesion limit; and of those through the transition, up to
#: its end.
STOPPED, THROUGH = (0.2, 0.4, 0.65), 0.2
#: Friction of the inputs' start values [1], and speed for which the cant is balanced [m/s].
FRICTION, SPEED = 0.3, 12.0
#: Distance in the curve to steady running [m], distance over which means are taken [m], application time [s].
SETTLED, MEASURED, APPLIED = 150.0, 50.0, 1.0
#: Speed at which a stop is evaluated [m/s]: it has cant excess then, and the bogie does not yet rock.
READ = SPEED / 2
#: Speed below which a stop is not drawn: it rocks [m/s].
SLOW = 1.0
#: Tolerance of the sum of the guiding forces, as in `curve-steering`: only the cant deficiency determines it.
BAND = 5e-4
QUOTIENT = "derailment_quotient_1_right"
COLUMNS = {
    QUOTIENT: "1",
    "lateral_force_1_right": "N",
    "wheel_load_1_right": "N",
    "axle_load_1": "N",
    "guiding_force_1": "N",
    "guiding_force_2": "N",
    "lateral_1": "m",
    "lateral_2": "m",
    "locked_2": "1",
}
GIVEN = {"radius": "m", "utilisation": "1", "cant": "m"}
STOP_COLUMNS = ("distance", "speed", QUOTIENT, "guiding_force_1", "locked_2")


TORQUED = (
    "Y/Q of the leading outer wheel [1]",
    "guiding force, inwards [kN];\ndotted: trailing",
    "lateral shift, outwards [mm];\ndotted: trailing",
)


def brake_torque(utilisation: float) -> float:
    """Return the brake torque on each wheelset [N.m]."""
    return utilisation * FRICTION * MASS * BOGIE.gravity * BOGIE.wheel_radius / 2


def steady(radius: float, utilisation: float, speed: float = SPEED) -> list[float]:
    """Return values of GIVEN and means of COLUMNS with dragging brakes, after the transition."""
    cant, torque = suited_cant(radius, SPEED), brake_torque(utilisation)
    line = into_curve(radius, cant, SETTLED + MEASURED)
    kernel = prepare_on_line("bogie", line, level=3.0, initial_speed=speed, constant_speed=1.0)
    inputs = {f"brake_torque_{number}": [(0.0, 0.0), (APPLIED, torque)] for number in (1, 2)}
    way = curve_begins(cant) + SETTLED
    series = play("bogie", kernel, (way + MEASURED) / speed, 0.02, tuple(COLUMNS), inputs)
    late = series["time"] >= way / speed
    # tables contain 0 for the infinite radius of straight track
    own = 0.0 if math.isinf(radius) else radius
    return [own, utilisation, cant, *(float(np.mean(series[name][late])) for name in COLUMNS)]


def curve_begins(cant: float) -> float:
    """Return the distance at which the curve begins, after the straight and the transition [m]."""
    return APPROACH + transition_length(cant)


def curved(radius: float) -> Line:
    """Return a line long enough to stop on."""
    return into_curve(radius, suited_cant(radius, SPEED), 500.0)


def stop(radius: float, utilisation: float, place: float, columns: Sequence[str] = STOP_COLUMNS) -> Recording:
    """Run to rest.

    Takes radius [m], place [m].
    """
    torque = brake_torque(utilisation)
    kernel = prepare_on_line("bogie", curved(radius), level=3.0, initial_speed=SPEED)
    begin = place / SPEED
    ramp = [(0.0, 0.0), (begin, 0.0), (begin + APPLIED, torque)]
    inputs = {f"brake_torque_{number}": ramp for number in (1, 2)}
    duration = begin + APPLIED + 1.2 * SPEED / (utilisation * FRICTION * BOGIE.gravity)
    return play("bogie", kernel, duration, 0.01, columns, inputs)


def stops_of(radius: float) -> dict[float, Recording]:
    """Return all stops in one curve, by utilisation; the stop through the transition has key 0."""
    cant = suited_cant(radius, SPEED)
    found = {utilisation: stop(radius, utilisation, curve_begins(cant) + SETTLED / 2) for utilisation in STOPPED}
    return found | {0.0: stop(radius, THROUGH, APPROACH)}


def read(series: Recording, name: str) -> float:
    """Return a quantity at the instant at which the speed has fallen to READ."""
    first = int(np.argmax(series["speed"] <= READ))
    return float(series[name][first])


Stops = dict[float, dict[float, Recording]]


def run(options: Options, quick: bool = False) -> Report:
    cases = [(radius, utilisation) for radius in RADII for utilisation in UTILISATIONS]
    bar = counting(cases, "steady curves")
    series = Recording(GIVEN | COLUMNS, [steady(*case) for case in bar])
    stops = {radius: stops_of(radius) for radius in counting(RADII, "stops")}
    rows = [row for radius in RADII for row in steady_rows(radius, of_radius(series, radius))]
    rows += [row for radius in RADII for row in stop_rows(radius, stops[radius])]
    parameters = BOGIE.values() | {"speed": SPEED, "friction": FRICTION}
    seconds = sum(float(one["time"][-1]) for found in stops.values() for one in found.values())
    return Report(rows, series, lambda: draw(series, stops), parameters, seconds, remarks(series), motion=motion)


def motion() -> Motion:
    """Run into the tightest curve, braked from the beginning of its transition."""
    vehicle, radius = two_axle_bogie(), RADII[0]
    series = stop(radius, THROUGH, APPROACH, motion_columns(vehicle))
    return Motion(f"Braked from the transition into R = {radius:g} m on", vehicle, series, curved(radius))


def of_radius(series: Recording, radius: float) -> Recording:
    """Return the rows of one radius, by rising torque."""
    own = series["radius"] == (0.0 if math.isinf(radius) else radius)
    return Recording(series.units, list(zip(*(series[name][own] for name in series.names), strict=True)))


def place_of(radius: float) -> str:
    return "straight" if math.isinf(radius) else f"R = {radius:g} m"


def steady_rows(radius: float, found: Recording) -> list[Row]:
    """Return the sum of the guiding forces at the least and the largest torque, which follows from statics, and the
    effects of the torques.
    """
    place, cant = place_of(radius), suited_cant(radius, SPEED)
    outwards, band = MASS * outward_acceleration(radius, cant, SPEED) / 1e3, BAND * MASS * BOGIE.gravity / 1e3
    rows = []
    for at in (0, -1):
        guiding = float(found["guiding_force_1"][at] + found["guiding_force_2"][at]) / 1e3
        name = f"{place}: sum of guiding forces, utilisation {UTILISATIONS[at]:g}"
        source = "Newton's second law: m (V^2 / R cos - g sin of the cant)"
        rows.append(measured(name, "kN", guiding, source, near(outwards, band)))
    for utilisation in (0.0, 0.4, 0.65):
        at = UTILISATIONS.index(utilisation)
        name = f"{place}: Y/Q of the leading outer wheel, utilisation {utilisation:g}"
        force, load = (found[column][at] / 1e3 for column in ("lateral_force_1_right", "wheel_load_1_right"))
        rows.append(measured(name, "1", found[QUOTIENT][at], f"Y {force:.1f} kN, Q {load:.1f} kN"))
    return rows


def stop_rows(radius: float, found: dict[float, Recording]) -> list[Row]:
    """Return Y/Q at half of the speed, compared with a bogie that rolls there at this speed."""
    rolling = steady(radius, 0.0, READ)[len(GIVEN) + list(COLUMNS).index(QUOTIENT)]
    rows = []
    for utilisation, series in found.items():
        words = f"stopping at utilisation {utilisation:g}" if utilisation else "braked from the transition on"
        locked = np.any(series["locked_2"][series["speed"] > SLOW] > 0.5)
        note = "the trailing wheelset locks" if locked else "no wheelset locks"
        name, source = f"{place_of(radius)}: Y/Q at {READ:g} m/s, {words}", f"rolling at this speed: {rolling:.3f}"
        rows.append(measured(name, "1", read(series, QUOTIENT), source, None, note))
    return rows


def remarks(series: Recording) -> list[str]:
    """Return the effects of braking in words, with the measured values."""
    said = []
    for radius in RADII[:-1]:
        found, last = of_radius(series, radius), UTILISATIONS.index(0.65)
        quotient, load, force, shift, guiding = (
            found[name][[0, last]]
            for name in (QUOTIENT, "wheel_load_1_right", "lateral_force_1_right", "lateral_2", "guiding_force_1")
        )
        said.append(
            f"R = {radius:g} m: from no torque to {100 * UTILISATIONS[last]:g} % of the adhesion Y/Q of the leading "
            f"outer wheel falls from {quotient[0]:.3f} to {quotient[1]:.3f}: Y from {force[0] / 1e3:.1f} to "
            f"{force[1] / 1e3:.1f} kN, while Q grows from {load[0] / 1e3:.0f} to {load[1] / 1e3:.0f} kN. The leading "
            f"wheelset's guiding force, inwards, goes from {guiding[0] / 1e3:.1f} to {guiding[1] / 1e3:.1f} kN. It "
            f"stays at its flange, the other goes from {-1e3 * shift[0]:.1f} to {-1e3 * shift[1]:.1f} mm outwards."
        )
    found = of_radius(series, math.inf)
    return [
        *said,
        f"Straight: Y/Q rises from {found[QUOTIENT][0]:.3f} to {found[QUOTIENT][-1]:.3f}. There the creep that the "
        "spin of the cone makes holds against its slope, and gives way to braking.",
        "Braking does not raise Y/Q of this bogie in curves. It loads the leading wheels, and it uses the adhesion by "
        "which both wheelsets hold the bogie against turning and the inner wheel pushes its wheelset outwards.",
    ]


def draw(series: Recording, stops: Stops) -> Figure:
    first, *_, last = of_radius(series, RADII[0])[QUOTIENT]
    word, place = "lowers" if last < first else "raises", f"stops at R = {RADII[0]:g} m"
    message = f"Braking {word} Y/Q at {RADII[0]:g} m radius from {first:.2f} to {last:.2f}"
    titles = dict.fromkeys(TORQUED, "adhesion utilisation of the brakes [1]")
    stopped = f"Y/Q, braked from the transition on, {THROUGH:g} [1]", f"Y/Q, {place} [1]", f"speed, {place} [m/s]"
    titles |= dict.fromkeys(stopped, "distance [m]")
    figure, (quotient, guiding, shift, through, within, speed) = charts(message, titles, (12.5, 7.2), columns=3)
    for radius, colour in zip(RADII, FOUR, strict=True):
        found, look = of_radius(series, radius), {"color": colour, "markersize": 3}
        quotient.plot(found["utilisation"], found[QUOTIENT], "o-", label=place_of(radius), **look)
        for number, style in ((1, "o-"), (2, "o:")):
            guiding.plot(found["utilisation"], found[f"guiding_force_{number}"] / 1e3, style, **look)
            shift.plot(found["utilisation"], -1e3 * found[f"lateral_{number}"], style, **look)
        draw_stop(through, stops[radius][0.0], colour)
    for utilisation, colour in zip(STOPPED, THREE, strict=True):
        one = stops[RADII[0]][utilisation]
        draw_stop(within, one, colour, f"{utilisation:g}")
        speed.plot(one["distance"], one["speed"], color=colour)
    quotient.legend(fontsize=8)
    within.legend(title="utilisation")
    return figure


def draw_stop(axis: Axes, recording: Recording, colour: str, name: str | None = None) -> None:
    """Draw Y/Q over the distance until the bogie rocks."""
    moving = recording["speed"] > SLOW
    axis.plot(recording["distance"][moving], recording[QUOTIENT][moving], color=colour, label=name)


SCENARIO = Scenario(
    "curve-braking",
    "Y/Q, guiding forces and shift of a bogie that is braked in curves, through transitions and on straight track",
    run,
)

"""A wheelset pushed against its rail: at which Y/Q it climbs, over friction and yaw, against Nadal (1896)."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.motion import Motion, motion_columns
from bogie_braking.reporting.plots import BOGIE, LEADING, LINES, THESIS, THREE, TRAILING, plt, titled
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, Row, at_least, measured, near
from bogie_braking.reporting.scenario import Options, Scenario
from fmu_src.cosimulation.recording import Recording
from fmu_src.symbols import ca
from rbd_model.contact.creep.exact_table import exact_law
from rbd_model.contact.creep.polach import polach
from rbd_model.contact.depth import Contact
from rbd_model.wheelset.rigid_part import nadal_limit
from scenarios.bench.climbing_wheelset import GROWTH, SPEED, climbing_wheelset, instants, push, vehicle_that_climbs

#: Flange angles [deg], of which a quick run has that of the curve, and frictions.
ANGLES, FRICTIONS = (60.0, 70.3, 75.0), (0.1, 0.3, 0.5)
#: Angle of attack at which the flange slides sideways as a whole, and which turns its contact by less than 1 % [rad].
ATTACK = 0.035
#: Heights between which the wheel has left its tread and rests on its flange alone [m].
ONSET = (0.1e-3, 0.3e-3)
#: Tolerance of Nadal's limit: yaw and roll steepen the flange by a degree at most, which is 1 to 2 % of tan.
BAND = 0.02
#: Angles of attack of the curve [rad], its flange angle and its friction.
YAWS = (0.0005, 0.001, 0.002, 0.0035, 0.005, 0.0075, 0.01, 0.015, 0.02, 0.035, 0.05)
CURVE_ANGLE, CURVE_FRICTION = 70.3, 0.3
#: Contact models with the creep law of the flange; the default is `kalker_to_coulomb`.
LAWS = {"default": Contact(2), "exact": Contact(2, flange_law=exact_law), "Polach": Contact(2, flange_law=polach)}
COLOURS = {"default": LEADING, "exact": TRAILING, "Polach": BOGIE}
#: Without lateral creep a wheel climbs at tan of its flange, twice Nadal's limit; a tenth of that is a clear margin.
FALLS = 1.1
SOURCE = "Nadal (1896)"


def nadal(angle: float, friction: float) -> float:
    """Return the Y/Q at which a flange of this angle [deg] that slides down carries the whole load (Nadal 1896)."""
    return float(nadal_limit(math.radians(angle), ca.SX(friction)))


def run(options: Options, quick: bool = False) -> Report:
    rows, steps, angles = [], 0, (CURVE_ANGLE,) if quick else ANGLES
    cases = [(angle, friction) for angle in angles for friction in FRICTIONS]
    for angle, friction in counting(cases, "flange-climb"):
        climb = push(climbing_wheelset(math.radians(angle), LAWS["default"]), friction, ATTACK)
        limit, steps = nadal(angle, friction), steps + climb.steps
        name = f"Y/Q at the onset of climbing, flange {angle:g} degrees, friction {friction:g}"
        found = climb.limit(*ONSET)
        rows.append(measured(name, "1", found, SOURCE, near(limit, BAND * limit), climb.messages[-1]))
    curves = {
        name: [push(climbing_wheelset(math.radians(CURVE_ANGLE), law), CURVE_FRICTION, yaw) for yaw in YAWS]
        for name, law in counting(LAWS.items(), "flange-climb")
    }
    series = Recording({"yaw": "rad"}, [[yaw] for yaw in YAWS])
    for name, climbs in curves.items():
        series.add(f"limit_{name.lower()}", "1", np.array([climb.limit(*ONSET) for climb in climbs]))
    rows += remarks(series)
    parameters = {"speed": SPEED, "growth_of_push": GROWTH, "attack": ATTACK, "steps": steps}
    return Report(rows, series, lambda: draw(rows, series, angles), parameters, 0.0, motion=motion)


def motion() -> Motion:
    """Return the motion of the flange and the friction of the curve, at the largest angle of attack."""
    angle = math.radians(CURVE_ANGLE)
    vehicle, library = vehicle_that_climbs(angle), climbing_wheelset(angle, LAWS["default"])
    columns = ("time", *motion_columns(vehicle))
    rows = [
        [kernel.time, *(kernel[name] for name in columns[1:])] for kernel in instants(library, CURVE_FRICTION, ATTACK)
    ]
    text = f"Pushed to the left, flange {CURVE_ANGLE:g} degrees, friction {CURVE_FRICTION:g}, yaw {1e3 * ATTACK:g} mrad"
    return Motion(text, vehicle, Recording(dict.fromkeys(columns, "SI"), rows))


def remarks(series: Recording) -> list[Row]:
    """Return rows on the fall of the limit with the angle of attack, and on the effect of the flange's creep law."""
    limit, place = nadal(CURVE_ANGLE, CURVE_FRICTION), f"{CURVE_ANGLE:g} degrees, friction {CURVE_FRICTION:g}"
    curves = {name: series[f"limit_{name.lower()}"] for name in LAWS}
    settled = {name: float(np.interp(ATTACK, series["yaw"], curve)) for name, curve in curves.items()}
    falls = {name: float(curve[0]) / settled[name] for name, curve in curves.items()}
    fall = f"limit at {1e3 * YAWS[0]:g} mrad over that at {1e3 * ATTACK:g}, {place}"
    rises = f"limit over yaw, {place}: largest rise from one yaw to the next"
    rise = float(np.max(np.diff(curves["default"]))) / limit
    lower = "less yaw, less lateral creep, a higher limit; above saturation it stays, but for the steeper contact"
    no_yaw = "a curve that does not feel the yaw would hold Nadal's limit everywhere"
    spin = (
        f"not judged: the limit is up to {percent_under(curves['default'], curves['exact']):.0f} % under "
        "that by exact theory, on the safe side"
    )
    polach = f"{place}: by Polach's law at {ATTACK} rad over Nadal's"
    unsafe = (
        "not judged: the spin of a flange takes lateral force from Polach's law, which puts the limit too high, on "
        "the unsafe side"
    )
    return [
        measured(rises, "1", rise, SOURCE, near(0.0, BAND), lower),
        measured(f"{fall}: exact theory", "1", falls["exact"], SOURCE, at_least(FALLS), no_yaw),
        measured(f"{fall}: default", "1", falls["default"], SOURCE, None, spin),
        measured(polach, "1", settled["Polach"] / limit, SOURCE, None, unsafe),
    ]


def percent_under(low: np.ndarray, high: np.ndarray) -> float:
    """Return the largest relative distance of one curve below the other [%]."""
    return 100 * float(np.max(1 - low / high))


def draw(rows: list[Row], series: Recording, angles: Sequence[float]) -> Figure:
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 4.4))
    friction = np.linspace(0.05, 0.55, 101)
    for number, (angle, line, colour) in enumerate(zip(angles, LINES, THREE, strict=False)):
        limit = [nadal(angle, mu) for mu in friction]
        left.plot(friction, limit, line, color=colour, label=f"Nadal, {angle:g} degrees")
        found = [row.simulated for row in rows[3 * number : 3 * number + 3]]
        left.plot(FRICTIONS, found, "o", color=colour)
    left.set(xlabel="friction coefficient [1]", title=f"Y/Q at the onset, yaw {1e3 * ATTACK:g} mrad")
    left.legend()
    for name, colour in COLOURS.items():
        right.plot(1e3 * series["yaw"], series[f"limit_{name.lower()}"], "o-", color=colour, label=name)
    right.axhline(nadal(CURVE_ANGLE, CURVE_FRICTION), color=THESIS, linestyle=":", label="Nadal")
    right.axhline(
        math.tan(math.radians(CURVE_ANGLE)), color=THESIS, linestyle="--", label="no friction: tan of the flange"
    )
    right.set_xlabel("angle of attack [mrad]")
    right.set_title(f"the same by creep law, {CURVE_ANGLE:g} degrees, friction {CURVE_FRICTION:g}")
    right.legend()
    limits = [nadal(angle, mu) for angle in angles for mu in FRICTIONS]
    off = [(row.simulated or 0.0) / limit - 1 for row, limit in zip(rows, limits, strict=False)]
    return titled(
        figure, f"At {1e3 * ATTACK:g} mrad yaw wheelsets climb within {100 * max(map(abs, off)):.1f} % of Nadal's limit"
    )


SCENARIO = Scenario(
    "flange-climb",
    "Y/Q at which a pushed wheelset climbs its flange, over friction, flange angle and yaw, against Nadal",
    run,
)

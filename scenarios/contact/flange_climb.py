"""A wheelset pushed against its rail: at which Y/Q it climbs, over friction and yaw, against Nadal (1896)."""

from __future__ import annotations

import math

import casadi as ca
import numpy as np
from matplotlib.figure import Figure
from tqdm import tqdm

from rbd_model.contact.creep.fastsim import fastsim
from rbd_model.contact.creep.polach import polach
from rbd_model.rolling_wheelset import nadal_limit
from scenarios.bench.climbing_wheelset import GROWTH, SPEED, climbing_wheelset, push
from scenarios.cosimulation.recording import Recording
from scenarios.reporting.plots import BOGIE, LEADING, THESIS, THREE, plt
from scenarios.reporting.progress import PATIENCE
from scenarios.reporting.report import Result, Row, at_least, near
from scenarios.scenario import Options, Scenario

ANGLES, FRICTIONS = (60.0, 70.3, 75.0), (0.1, 0.3, 0.5)
#: Angle of attack with which the flange slides sideways as a whole, and which turns its contact by less than 1 % [rad].
ATTACK = 0.035
#: Heights between which the wheel has left its tread and stands on its flange alone [m].
ONSET = (0.1e-3, 0.3e-3)
#: Asked of Nadal's limit: yaw and roll steepen the flange by a degree at most, which is 1 to 2 % of tan.
BAND = 0.02
#: Angles of attack of the curve [rad], its flange and its friction.
YAWS = (0.0005, 0.001, 0.002, 0.0035, 0.005, 0.0075, 0.01, 0.015, 0.02, 0.035, 0.05)
CURVE_ANGLE, CURVE_FRICTION = 70.3, 0.3
LAWS = {"FASTSIM 5 x 5": fastsim(5), "Polach": polach}
#: Without lateral creep a wheel climbs at tan of its flange, twice Nadal's limit; a tenth of the way is far from none.
FALLS = 1.1
SOURCE = "Nadal (1896)"


def nadal(angle: float, friction: float) -> float:
    """Y/Q at which a flange of this angle [deg] that slides down carries all."""
    return float(nadal_limit(math.radians(angle), ca.SX(friction)))


def run(options: Options) -> Result:
    rows, steps = [], 0
    cases = [(angle, friction) for angle in ANGLES for friction in FRICTIONS]
    for angle, friction in tqdm(cases, desc="flange-climb", leave=False, delay=PATIENCE):
        climb = push(climbing_wheelset(math.radians(angle), LAWS["FASTSIM 5 x 5"]), friction, ATTACK)
        limit, steps = nadal(angle, friction), steps + climb.steps
        name = f"Y/Q at the onset of climbing, flange {angle:g} degrees, friction {friction:g}"
        found = climb.limit(*ONSET)
        rows.append(Row(name, "1", None, found, near(limit, BAND * limit), SOURCE, climb.sentence))
    curves = {
        name: [push(climbing_wheelset(math.radians(CURVE_ANGLE), law), CURVE_FRICTION, yaw) for yaw in YAWS]
        for name, law in tqdm(LAWS.items(), desc="flange-climb", leave=False, delay=PATIENCE)
    }
    series = Recording({"yaw": "rad"}, [[yaw] for yaw in YAWS])
    for name, climbs in curves.items():
        series.add(f"limit_{name.split()[0].lower()}", "1", np.array([climb.limit(*ONSET) for climb in climbs]))
    rows += remarks(series)
    parameters = {"speed": SPEED, "growth_of_push": GROWTH, "attack": ATTACK, "steps": steps}
    return Result(rows, series, lambda: draw(rows, series), parameters, 0.0)


def remarks(series: Recording) -> list[Row]:
    """How the limit falls with the angle of attack, and what the default creep law makes of it."""
    limit, falling = nadal(CURVE_ANGLE, CURVE_FRICTION), series["limit_fastsim"]
    rising = float(np.max(np.diff(falling))) / limit
    name = f"limit over yaw, {CURVE_ANGLE:g} degrees, friction {CURVE_FRICTION:g}"
    text = "less yaw, less lateral creep, a higher limit; above saturation it stays, but for the steeper contact"
    return [
        Row(f"{name}: largest rise from one yaw to the next", "1", None, rising, near(0.0, BAND), SOURCE, text),
        Row(
            f"{name}: at {1e3 * YAWS[0]:g} mrad over that at {1e3 * ATTACK:g}",
            "1",
            None,
            float(falling[0] / np.interp(ATTACK, series["yaw"], falling)),
            at_least(FALLS),
            SOURCE,
            "a curve that does not feel the yaw would hold Nadal's limit everywhere",
        ),
        Row(
            f"{name}: by Polach's law at {ATTACK} rad over Nadal's",
            "1",
            None,
            float(np.interp(ATTACK, series["yaw"], series["limit_polach"])) / limit,
            None,
            SOURCE,
            "not judged: the spin of a flange takes lateral force from Polach's law, which puts the limit too high",
        ),
    ]


def draw(rows: list[Row], series: Recording) -> Figure:
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 4.4))
    friction = np.linspace(0.05, 0.55, 101)
    for number, (angle, colour) in enumerate(zip(ANGLES, THREE, strict=True)):
        left.plot(friction, [nadal(angle, mu) for mu in friction], color=colour, label=f"Nadal, {angle:g} degrees")
        found = [row.simulated for row in rows[3 * number : 3 * number + 3]]
        left.plot(FRICTIONS, found, "o", color=colour)
    left.set_xlabel("friction coefficient [1]")
    left.set_title(f"Y/Q at the onset, yaw {1e3 * ATTACK:g} mrad")
    left.legend()
    for name, colour in (("fastsim", LEADING), ("polach", BOGIE)):
        right.plot(1e3 * series["yaw"], series[f"limit_{name}"], "o-", color=colour, label=name)
    right.axhline(nadal(CURVE_ANGLE, CURVE_FRICTION), color=THESIS, linestyle=":", label="Nadal")
    right.axhline(
        math.tan(math.radians(CURVE_ANGLE)), color=THESIS, linestyle="--", label="no friction: tan of the flange"
    )
    right.set_xlabel("angle of attack [mrad]")
    right.set_title(f"{CURVE_ANGLE:g} degrees, friction {CURVE_FRICTION:g}")
    right.legend()
    figure.suptitle("Flange climb of a wheelset that is pushed sideways", x=0.02, ha="left")
    figure.set_layout_engine("constrained")
    return figure


SCENARIO = Scenario(
    "flange-climb",
    "At which Y/Q a pushed wheelset climbs its flange, over friction, flange angle and yaw, against Nadal",
    run,
    frozenset(),
)

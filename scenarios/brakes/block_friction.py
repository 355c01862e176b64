"""Laws of friction of blocks and pads in trains, over speed and force, against their sources.

Constants are those of a public train simulation. Two laws have a second source: cast iron P6 is Karwatzki's formula
(1950), whose constants in the literature are 16 / g and 80 / g; composite is a rule of RailProfAC with the force in tf.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from bogie_braking.reporting.plots import FOUR, charts
from bogie_braking.reporting.report import Report, Row, at_most, measured
from bogie_braking.reporting.scenario import Options, Scenario
from brake_controller.shoe_friction import KILOMETRES_PER_HOUR
from fmu_src.cosimulation.recording import Recording
from products.train.consist import forces_of
from products.train.consist_file import consist_of

#: Forces of a block [kN], and speeds [km/h], of twelve points; speeds of the figure.
FORCES, POINTS = (5.0, 10.0, 15.0, 20.0), np.array([0.0, 60.0, 120.0])
SPEEDS = np.linspace(0.0, 160.0, 81)
#: Force of a block of the wagon at full service [kN].
WAGON = 14.0
#: Standard gravity as in the literature [m/s2].
G = 9.81
LAWS = {"cast-iron-p6": "cast iron P6", "cast-iron-p10": "cast iron P10", "composite": "composite", "pads": "disc pads"}
#: k1, k2, k3 [kN], k4, k5 [km/h] of mu = k1 (F + k2) / (F + k3) (V + k4) / (V + k5).
CONSTANTS = {
    "cast-iron-p6": (0.024, 62.5, 12.5, 100.0, 20.0),
    "cast-iron-p10": (0.05, 62.5, 31.25, 100.0, 20.0),
    "composite": (0.055, 200.0, 50.0, 150.0, 75.0),
    "pads": (0.385, -24.5, -27.2, 39.5, 33.0),
}
Numbers = NDArray[np.float64]


def friction(law: str, force: float, speeds: Numbers) -> Numbers:
    """Return the friction of a law in trains [1] at a force of one block [kN] and speeds [km/h]."""
    row = {"kind": "wagon", "valve": "head", "shoe_force": 8 * force, "friction": law}
    if law in LAWS:
        row["shoes"] = 8
    if law == "pads":
        row["friction_radius"] = 1.0
    one = consist_of([row]).vehicles[0]
    pressure = np.full(speeds.size, one.distributor.full_pressure)
    return forces_of(one.brake, pressure, speeds / KILOMETRES_PER_HOUR) / (8e3 * force)


def formula(law: str, force: float, speeds: Numbers) -> Numbers:
    """Return a law by its constants."""
    k1, k2, k3, k4, k5 = CONSTANTS[law]
    return k1 * (force + k2) / (force + k3) * (speeds + k4) / (speeds + k5)


def literature(force: float, speeds: Numbers) -> Numbers:
    """Return Karwatzki's formula (1950) with the constants of the literature; force [kN], speeds [km/h]."""
    above, below = 16 / G * force + 100, 80 / G * force + 100
    return 0.60 * above / below * (speeds + 100) / (5 * speeds + 100)


def rule(force: float, speeds: Numbers) -> Numbers:
    """Return the rule of composite blocks, 0.44 (K + 20) / (4 K + 20) (V + 150) / (2 V + 150), K in tf."""
    tf = force / 10.0  # as the rule rounds standard gravity
    return 0.44 * (tf + 20) / (4 * tf + 20) * (speeds + 150) / (2 * speeds + 150)


def apart(law: str, other: Callable[[float, Numbers], Numbers]) -> float:
    """Return the largest relative difference of a law at the twelve points [%]."""
    found = [friction(law, force, POINTS) / other(force, POINTS) - 1 for force in FORCES]
    return 100 * float(np.abs(found).max())


def rows_of_sources() -> list[Row]:
    """Return the differences of laws from their sources."""
    source, exact = "a public train simulation; its formula", at_most(1e-9)
    rows = [
        measured(f"{name}: from its formula at 12 points", "%", apart(law, partial(formula, law)), source, exact)
        for law, name in LAWS.items()
    ]
    bounded = 100 * float(np.abs(friction("pads", 40.0, POINTS) / friction("pads", 20.0, POINTS) - 1).max())
    p6, composite = apart("cast-iron-p6", literature), apart("composite", rule)
    return [
        *rows,
        measured("disc pads: above 20 kN, from 20 kN", "%", bounded, "bounded before its pole", exact),
        measured("cast iron P6: from the literature", "%", p6, "Karwatzki (1950)", at_most(1.0)),
        measured("composite: from the rule in tf", "%", composite, "RailProfAC", exact),
    ]


def rows_between_laws() -> list[Row]:
    """Return the differences of laws from each other."""
    rows, ends = list[Row](), np.array([0.0, 100.0])
    for force in (10.0, 20.0):
        above = friction("cast-iron-p10", force, ends) / friction("cast-iron-p6", force, ends) - 1
        rows.append(measured(f"cast iron P10 above P6 at {force:g} kN", "%", 100 * above[0]))
    below = 1 - friction("composite-k", WAGON, ends) / friction("composite", WAGON, ends)
    for speed, share in zip(ends, below, strict=True):
        name = f"composite-k below composite at {WAGON:g} kN, {speed:g} km/h"
        rows.append(measured(name, "%", 100 * share, "the wagon has composite"))
    return rows


def run(options: Options, quick: bool = False) -> Report:
    rows = rows_of_sources() + rows_between_laws()
    found = {law: [friction(law, force, SPEEDS) for force in FORCES] for law in LAWS}
    series = Recording({"speed": "km/h"}, SPEEDS[:, None])
    for law, of_forces in found.items():
        for force, values in zip(FORCES, of_forces, strict=True):
            series.add(f"friction ({LAWS[law]}, {force:g} kN)", "1", values)
    return Report(rows, series, lambda: draw(found), {"wagon_force": WAGON}, 0.0, [])


def draw(found: dict[str, list[Numbers]]) -> Figure:
    iron = found["cast-iron-p6"][1]
    message = f"Cast iron P6 keeps {100 * iron[-1] / iron[0]:.0f} % of its friction at 160 km/h"
    figure, axes = charts(message, list(LAWS.values()), (8.5, 6.4), "speed [km/h]", sharex=True, sharey=True)
    for axis, of_forces in zip(axes, found.values(), strict=True):
        for colour, force, values in zip(FOUR, FORCES, of_forces, strict=True):
            axis.plot(SPEEDS, values, color=colour, label=f"{force:g} kN a block")
    axes[0].legend(fontsize=8)
    for axis in axes[::2]:
        axis.set_ylabel("friction [1]")
    axes[0].set_ylim(bottom=0.0)
    return figure


SCENARIO = Scenario(
    "block-friction", "Friction of blocks and pads of trains over force and speed: each law and its source", run
)

"""Figures of docs/adhesion.md: a law of friction each, and a fitted field.

python -m evidence.measuring.adhesion_figures
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
from matplotlib.figure import Figure

import bogie_braking as bb
from bogie_braking.reporting import plots
from rbd_model.track.adhesion_laws import curtius_kniffler, fallen_friction, recovered_friction
from rbd_model.track.friction import CONDITIONS, low
from rbd_model.track.recovery import assumed_recovery, easy_recovery, hard_recovery
from rbd_model.track.sand import common_sand, friction_with_sand

DOCS = Path(__file__).parents[2] / "docs"
#: Map of friction and speeds of the stops [m], [1], [m/s]; error of the logged speed [m/s].
PLACES = np.arange(0.0, 401.0, 50.0)
FRICTION, SPEEDS, ERROR = np.array([8, 8, 5, 10, 7, 6, 9, 8, 7]) / 100, (13.0, 15.0, 18.0), 0.03


def over_sliding() -> Figure:
    """Draw Polach's (2005) falling friction of each rail with a name."""
    figure, axis = plots.single("Friction falls to 40 % where wheels slide fast", "sliding speed [m/s]", "friction [1]")
    sliding = np.linspace(0.0, 25.0, 200)
    for name, make in CONDITIONS.items():
        axis.plot(sliding, fallen_friction(make(), sliding), label=name, linestyle="-" if make().verified else "--")
    axis.legend(title="dashed: not verified")
    return figure


def over_speed() -> Figure:
    """Draw the adhesion of Curtius and Kniffler."""
    title = "Locomotives use 0.33 at rest, and 0.21 at 100 km/h"
    figure, axis = plots.single(title, "speed [km/h]", "adhesion [1]")
    speed = np.linspace(0.0, 200.0, 200)
    axis.plot(speed, curtius_kniffler(speed / 3.6), color=plots.LEADING, label="Curtius and Kniffler")
    axis.set_ylim(0.0, 0.4)
    axis.legend()
    return figure


def over_energy() -> Figure:
    """Draw the recovery by sliding energy with its scatter."""
    title = "Some kJ of sliding a metre clean the rail"
    figure, axis = plots.single(title, "sliding energy [kJ/m]", "friction [1]")
    energy = np.geomspace(0.1, 100.0, 200)
    for name, make in {"least": easy_recovery, "assumed": assumed_recovery, "largest": hard_recovery}.items():
        axis.semilogx(energy, recovered_friction(make(), 1e3 * energy), label=f"{name} energy of the scatter")
    axis.legend()
    return figure


def over_sand() -> Figure:
    """Draw the law of sand on two rails."""
    figure, axis = plots.single("Sand lifts the lowest friction most", "sand on the rail [g/m]", "friction [1]")
    sand, law = np.linspace(0.0, 10.0, 200), common_sand()
    for name in ("very_low", "low"):
        rail, limits = ca.SX(CONDITIONS[name]().friction), (ca.SX(law.sanded_friction), ca.SX(law.sand_scale))
        mu = [float(ca.evalf(friction_with_sand(rail, ca.SX(each), *limits))) for each in 1e-3 * sand]
        axis.plot(sand, mu, label=name)
    axis.legend()
    return figure


def over_place() -> Figure:
    """Draw the field that three stops show, as on docs/public.md."""
    line = bb.line_of([bb.straight(1200)], start=-20).with_friction(PLACES, FRICTION / low().friction)
    error, logs = np.random.default_rng(1), []
    for speed in SPEEDS:
        stop = bb.protected_stop(None, "low", line=line, speed=speed)
        stop["speed"][:] += error.normal(0.0, ERROR, stop["speed"].size)
        logs.append(stop)
    law: dict[str, Any] = {name: value for name, value in low().law.values().items() if name != "friction_decay"}
    field = bb.fit("bogie", logs, {"friction": 0.15}, places=PLACES, friction_decay=0.2, **law)
    figure, axis = plots.single("Three stops show the friction of 400 m of rail", "place [m]", "friction [1]")
    axis.plot(PLACES, FRICTION, color=plots.BOGIE, label="of the rail")
    half = (field.upper - field.lower) / 2
    axis.errorbar(PLACES, field.values, half, fmt="o", color=plots.TRAILING, capsize=4, label="fitted, 95 %")
    axis.set_ylim(0.0, 0.12)
    axis.legend()
    return figure


def main() -> int:
    """Write the figures."""
    for draw in (over_sliding, over_speed, over_energy, over_sand, over_place):
        draw().savefig(DOCS / "pictures" / f"adhesion-{draw.__name__.replace('_', '-')}.png", dpi=110)
    return 0


if __name__ == "__main__":
    sys.exit(main())

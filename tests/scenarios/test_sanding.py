"""The train on sand against a separate integration, based on the page's text alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rbd_model.track.sand import common_sand
from scenarios.brakes import sanding
from scenarios.brakes.sanding import FITTED, NONE, ONE, TWO, Trial

#: Difference of two methods; sand begins over half a metre.
SAME = 2e-3
#: Four cars of 20 m: bogies of 2.6 m, 14 m apart.
PLACES = np.array([-(20.0 * car + along) for car in range(4) for along in (0.0, 2.6, 14.0, 16.6)])


def way(trial: Trial) -> float:
    """Return the stopping distance [m] of wheelsets that use all adhesion, braked after 1 s, with sand after 2 s."""
    rate, limit = (4 / 60, 7.5e-3) if trial.varies else (2 / 60, np.inf)
    law = common_sand()

    def slope(time: float, state: np.ndarray) -> list[float]:
        speed, sanded = max(state[1], 0.1), state[2]
        sand = np.zeros(PLACES.size)
        for number in trial.sanders:
            ahead = PLACES[number - 1] - PLACES
            sand += min(rate / speed, limit) * ((ahead >= 0.0) & (sanded > ahead))
        friction = 0.02 + (law.sanded_friction - 0.02) * (1.0 - np.exp(-sand / law.sand_scale))
        asked = 0.9 * (1.0 - 20.0 ** (-max(time - 1.0, 0.0) / 2.0))
        return [state[1], -np.minimum(asked, 9.81 * friction).mean(), state[1] if time > 2.0 else 0.0]

    def stands(time: float, state: np.ndarray) -> float:
        return float(state[1]) - 0.02

    stands.terminal = True  # type: ignore[attr-defined]
    found = solve_ivp(slope, (0.0, 300.0), [0.0, 55 * 0.44704, 0.0], events=stands, max_step=0.05, rtol=1e-6)
    return float(found.y[0, -1])


@pytest.mark.parametrize("trial", [NONE, *FITTED, ONE, TWO], ids=lambda one: one.name)
def test_stops_on_sand_are_those_of_another_integration(trial: Trial) -> None:
    assert sanding.way(trial.values(), common_sand()) == pytest.approx(way(trial), rel=SAME)


def test_the_numbers_of_the_law_are_those_that_are_fitted() -> None:
    """Compare the values in rbd_model/track/sand.py to their digits; a law with another decay misses the trials."""
    found = sanding.fitted()
    assert common_sand().sanded_friction == pytest.approx(found.sanded_friction, rel=0.01)
    assert common_sand().sand_scale == pytest.approx(found.sand_scale, rel=0.01)
    for trial in FITTED:
        assert sanding.way(trial.values(), found) == pytest.approx(trial.printed, abs=0.1)
        assert (
            abs(sanding.way(trial.values(), replace(found, sand_scale=1.5 * found.sand_scale)) - trial.printed) > 20.0
        )

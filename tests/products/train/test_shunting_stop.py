"""A shunting stop with scattered parameters: the published means, their sensitivity, and a stop in closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest

from scenarios.bench.shunting_stop import ONCE, SHIFTED, distances
from scenarios.benchmark.case_file import CASES, read_case

#: The published program's stop in positions G and P; means of 1e7 stops [m]. With STOPS stops, 0.1 % is three to five
#: standard errors.
POINTS, STOPS = dict(zip("GP", read_case(CASES / "railprofac-shunting.toml").points, strict=True)), 2000


@pytest.mark.parametrize("name", POINTS)
def test_a_shunting_stop_is_the_published_one(name: str) -> None:
    given = POINTS[name].inputs
    found = distances(given, STOPS, 1, published_method=True)
    assert np.mean(found) == pytest.approx(POINTS[name].published["mean"], rel=1e-3)
    assert np.mean(distances(given, STOPS, 1)) == pytest.approx(np.mean(found), rel=4e-4)


@pytest.mark.parametrize("name", POINTS)
def test_counted_once_and_with_a_true_delay_it_is_longer(name: str) -> None:
    given = POINTS[name].inputs
    published, once, shifted = (distances({**given, **rules}, 100, 1) for rules in ({}, ONCE, SHIFTED))
    assert np.all(once > 1.1 * published)
    # A demand with a mean delay of 0.154 s costs at most its distance at 25 km/h, and more than a stretched one.
    assert np.all((once < shifted) & (shifted < once + 0.154 * given["speed"]))


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("propagation", 125.0),
        ("cylinder.return_force", 3000.0),
        ("wagon.rotating", 1.0),
        ("rigging.ratio", 5.60),
        ("locomotive.brake_force", 46e3),
    ],
)
def test_another_input_of_the_shunting_stop_misses_its_mean(name: str, value: float) -> None:
    given = POINTS["G"].inputs
    before = np.mean(distances(given, 100, 1))
    assert abs(np.mean(distances({**given, name: value}, 100, 1)) / before - 1) > 1e-3


def test_a_full_stop_without_spread_is_that_of_the_energy() -> None:
    """Brakes act at once with one friction, without resistance: m v^2 / 2 over the force (Newton's second law)."""
    given = {**POINTS["P"].inputs, **ONCE, "cylinder.at_once": 1.0}
    given |= {name: 0.0 for name in given if name.endswith("_deviation")}
    given |= {"friction.speed_1": 20.0, "friction.speed_2": 20.0}
    given |= {"resistance.constant": 0.0, "resistance.square": 0.0}
    blocks = 5.65 * (math.pi / 4 * 0.406**2 * 380e3 - 1500.0)
    friction = 0.055 * (blocks / 16 + 200e3) / (blocks / 16 + 50e3)
    force = 5 * blocks * 0.83 * friction + 53e3 * 0.86
    expected = (53e3 + 5 * 1.04 * 90e3) * (25 / 3.6) ** 2 / 2 / force
    assert distances(given, 3, 1) == pytest.approx([expected] * 3, rel=1e-9)

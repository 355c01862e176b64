"""A shunting stop with scattered parameters: the published means, their sensitivity, and a stop in closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest

from scenarios.bench import shunting_stop
from scenarios.bench.shunting_stop import ONCE, PUBLISHED, SHIFTED, distances

KMH = 1 / 3.6
#: Published means of 1e7 stops [m]. With STOPS stops, 0.1 % is three to five standard errors.
MEANS, STOPS = {"G": 64.26639, "P": 38.34120}, 2000


@pytest.mark.parametrize("name", MEANS)
def test_a_shunting_stop_is_the_published_one(name: str) -> None:
    found = distances(name, PUBLISHED, STOPS, 1, published_method=True)
    assert np.mean(found) == pytest.approx(MEANS[name], rel=1e-3)
    assert np.mean(distances(name, PUBLISHED, STOPS, 1)) == pytest.approx(np.mean(found), rel=4e-4)


@pytest.mark.parametrize("name", MEANS)
def test_counted_once_and_with_a_true_delay_it_is_longer(name: str) -> None:
    published, once, shifted = (distances(name, rules, 100, 1) for rules in (PUBLISHED, ONCE, SHIFTED))
    assert np.all(once > 1.1 * published)
    # A demand with a mean delay of 0.154 s costs at most its distance at 25 km/h, and more than a stretched one.
    assert np.all((once < shifted) & (shifted < once + 0.154 * 25 * KMH))


@pytest.mark.parametrize(
    ("name", "value"),
    [("PROPAGATION", 125.0), ("RETURN_FORCE", 3000.0), ("TURNING", 1.0), ("RATIO", 5.60), ("LOCOMOTIVE_FORCE", 46e3)],
)
def test_another_input_of_the_shunting_stop_misses_its_mean(
    name: str, value: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = np.mean(distances("G", PUBLISHED, 100, 1))
    monkeypatch.setattr(shunting_stop, name, value)
    assert abs(np.mean(distances("G", PUBLISHED, 100, 1)) / before - 1) > 1e-3


def test_a_full_stop_without_spread_is_that_of_the_energy(monkeypatch: pytest.MonkeyPatch) -> None:
    """Brakes act at once with one friction, without resistance: m v^2 / 2 over the force (Newton's second law)."""
    monkeypatch.setattr(shunting_stop, "POSITIONS", {"P": shunting_stop.Position(4.0, 0.0, 1.0)})
    for name in ("PRESSURE", "EFFICIENCY", "FRICTION"):
        monkeypatch.setattr(shunting_stop, name, (getattr(shunting_stop, name)[0], 0.0))
    monkeypatch.setattr(shunting_stop, "SPEEDS", (20.0, 20.0))
    monkeypatch.setattr(shunting_stop, "RESISTANCE", (0.0, 0.0))
    blocks = 5.65 * (math.pi / 4 * 0.406**2 * 380e3 - 1500.0)
    friction = 0.055 * (blocks / 16 + 200e3) / (blocks / 16 + 50e3)
    force = 5 * blocks * 0.83 * friction + 53e3 * 0.86
    expected = (53e3 + 5 * 1.04 * 90e3) * (25 * KMH) ** 2 / 2 / force
    assert distances("P", ONCE, 3, 1) == pytest.approx([expected] * 3, rel=1e-9)

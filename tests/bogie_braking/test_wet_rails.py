"""Quantiles with confidence intervals, and Kwet_rst over drawn wet rails."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.special import ndtri
from scipy.stats import binom, loguniform, norm

from bogie_braking import etcs
from bogie_braking.quantiles import drawn_quantile, split_quantile
from bogie_braking.splitting import Numbers, climb

#: Acceptance limits for the coverage of 200 intervals of 95 %: 190 and 2.5 standard deviations of the binomial
#: distribution.
FEWEST, MOST = 180, 198


def plane(points: Numbers) -> Numbers:
    """Linear limit state, standard normal for any number of inputs."""
    return np.sum(points, axis=1) / np.sqrt(points.shape[1])


@pytest.mark.long
def test_intervals_of_quantiles_at_1e_4_hold_as_often_as_they_say() -> None:
    """Splitting as for Kwet_rst, with four inputs; seeds 0 to 199."""
    true, hold = -float(ndtri(1e-4)), 0
    for seed in range(200):
        populations, _ = climb(plane, 4, np.inf, 20, 3, seed, 1e-4 / 4.0)
        _, low, high = split_quantile(populations, 1e-4)
        hold += low <= true <= high
    assert FEWEST <= hold <= MOST


def test_plain_draws_bound_a_quantile_by_their_order() -> None:
    random, true = np.random.default_rng(0), -float(ndtri(1e-2))
    found = np.array([drawn_quantile(random.standard_normal(500), 1e-2) for _ in range(200)])
    assert FEWEST <= np.sum((found[:, 1] <= true) & (true <= found[:, 2])) <= MOST
    few = drawn_quantile(random.standard_normal(100), 1e-2)
    assert binom.cdf(0, 100, 1e-2) > 0.025
    assert few[2] == np.inf


def test_a_quantile_by_splitting_holds_the_closed_form_and_nothing_is_extrapolated() -> None:
    populations, _ = climb(plane, 4, np.inf, 20, 3, 0, 1e-6 / 4.0)
    found, low, high = split_quantile(populations, 1e-6)
    assert low < -float(ndtri(1e-6)) < high < low + 0.6
    assert low < found < high
    assert split_quantile(populations, 1e-12)[2] == np.inf


@pytest.mark.study
def test_wet_factors_are_bounded_by_adhesion() -> None:
    """Factors are at most 1, and at least mu g over the deceleration on a dry rail, 1.48 m/s2."""
    mixed = etcs.WetRails(loguniform(0.08, 0.30), "assumed")
    found = etcs.wet_factors("bogie", mixed, level=2, draws=120, speed=20.0)
    assert np.all(found.lower[:2] <= found.factors[:2])
    assert np.all(found.factors[:2] <= found.upper[:2])
    assert 0.08 * 9.81 * 0.7 / 1.48 < found.factors[1] < found.factors[0] <= 1.0
    assert np.all(np.isnan(found.factors[2:]))
    assert "The stops do not suffice for level 2; give more draws" in found.status
    assert "assumed" in found.status


@pytest.mark.parametrize(
    ("more", "says"),
    [
        ({"rails": "snow"}, "no law of wet rails snow"),
        ({"vehicle": "tram"}, "no vehicle with brakes tram"),
        ({"level": 10}, "confidence level must be an integer from 0 to 9; got 10"),
        ({"speed": 300.0}, "speed must be from 10 to 100 m/s; got 300.0"),
        ({"step": 1.0}, "step must be from 0 to 0.005 s"),
        ({"draws": 10**9}, "draws"),
        ({"draws": 5}, "Draws must be a whole number of at least 100"),
        ({"particles": 1}, "Particles must be"),
        ({"rails": etcs.WetRails(0.2, "x")}, "friction must have a distribution"),  # type: ignore[arg-type]
        ({"rails": etcs.WetRails(norm(0.1, -1.0), "x")}, "must have a median"),
        ({"rails": etcs.WetRails(norm(3.0, 0.1), "x"), "draws": 100}, "must be at most 2; got a draw of 3"),
        ({"rails": None}, "rails must be low to wet, training, normal or WetRails"),
        ({"seed": -1}, "The seed must be a whole number of at least 0; got -1"),
    ],
)
def test_wet_rails_that_cannot_be_drawn_are_refused(more: dict[str, Any], says: str) -> None:
    with pytest.raises((KeyError, TypeError, ValueError), match=says):
        etcs.wet_factors(**more)

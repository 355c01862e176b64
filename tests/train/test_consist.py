"""Vehicles of trains and their brake weight percentage, both ways; which depth of a brake a scene needs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from products.train.consist import Consist, block_train, braked_by, coach, locomotive, wagon
from products.train.train import Train


@pytest.mark.parametrize("percentage", [40.0, 65.0, 100.0, 150.0])
def test_a_percentage_becomes_forces_and_forces_that_percentage(percentage: float) -> None:
    one = wagon()
    assert replace(one, brake=braked_by(percentage, one.mass)).percentage == pytest.approx(percentage, rel=1e-9)


def test_a_vehicle_of_a_percentage_stops_where_that_says() -> None:
    """S = 52840 / (lambda + 10) from 100 km/h with a build-up of 2 s; here cylinders are full from the start."""
    one = replace(locomotive(), brake=braked_by(80.0, 84e3), resistance=(0.0, 0.0, 0.0))
    train = Train(Consist((one,)), speed=100 / 3.6, pipe=350e3, cylinder=380e3)
    train.drive("service", 1.0)
    while train.speed[0] > 0.0:
        train.advance(0.1)
    way = train.distance[0] + one.length / 2  # its middle begins half a length behind its front
    assert way + 2.0 * 100 / 3.6 == pytest.approx(52840.0 / 90.0, rel=2e-3)


def test_a_train_has_the_percentage_of_its_braked_weights() -> None:
    train = Consist((locomotive(), coach(), coach()))
    assert train.percentage == pytest.approx((85.0 * 84 + 135.0 * 92) / 176, rel=1e-3)
    assert 60.0 < block_train(30).percentage < 85.0


def test_weighing_brakes_an_empty_wagon_less() -> None:
    full, empty = wagon(60e3), wagon(0.0)
    assert empty.brake.force_per_pressure == pytest.approx(0.4 * full.brake.force_per_pressure)
    half = wagon(20e3, weighing="continuous")
    assert half.brake.force_per_pressure == pytest.approx(0.5 * full.brake.force_per_pressure)
    assert np.isclose(wagon(60e3, weighing="continuous").percentage, full.percentage)

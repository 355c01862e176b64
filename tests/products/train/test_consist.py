"""Vehicles of trains, their brake weight percentage in both directions, and the choice of a brake model."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad

from brake_controller.brake_weight import FROM_100, VEHICLE_BUILD_UP, percentage_of_vehicle
from products.train.brake_model import BRAKE_MODELS_BY_COST, select_brake_model
from products.train.consist import Consist, block_train, braked_by, coach, locomotive, wagon
from products.train.numbers import Settings
from products.train.train import Train


@pytest.mark.parametrize("percentage", [40.0, 65.0, 100.0, 150.0])
def test_a_percentage_becomes_forces_and_forces_that_percentage(percentage: float) -> None:
    one = wagon()
    assert replace(one, brake=braked_by(percentage, one.mass, one.resistance)).percentage == pytest.approx(
        percentage, rel=1e-9
    )


def test_a_vehicle_of_a_percentage_stops_where_that_says() -> None:
    """S = 52840 / (lambda + 10) from 100 km/h with a build-up of 2 s; here the cylinders are full from the start.

    The percentage includes the vehicle's resistance.
    """
    plain = locomotive()
    one = replace(plain, brake=braked_by(80.0, 84e3, plain.resistance))
    train = Train(Consist((one,)), speed=100 / 3.6, pipe=350e3, cylinder=380e3)
    train.drive("service", 1.0)
    while train.speed[0] > 0.0:
        train.advance(0.1)
    way = train.distance[0] + one.length / 2  # the middle is half a length behind the front
    assert way + 2.0 * 100 / 3.6 == pytest.approx(52840.0 / 90.0, rel=2e-3)


def test_a_train_has_the_percentage_of_its_braked_weights() -> None:
    train = Consist((locomotive(), coach(), coach()))
    assert train.percentage == pytest.approx((85.0 * 84 + 135.0 * 92) / 176, rel=1e-3)


def test_a_loaded_wagon_has_the_percentage_of_its_cylinder_and_blocks() -> None:
    # RailProfAC's shunting stops: cylinder, rigging and the law of composite blocks; int m v / (F + R) dv, EN 14531-1
    pressed = (5.65 * (380e3 * math.pi / 4 * 0.406**2 - 1500.0)) * 0.83
    tf = pressed / 16 / 1e4
    mass, gravity = 1.04 * 80e3, 9.80665

    def slowing(v: float) -> float:
        friction = 0.44 * (tf + 20) / (4 * tf + 20) * (3.6 * v + 150) / (2 * 3.6 * v + 150)
        return mass * v / (friction * pressed + gravity * (200.0 + 20e-3 * (3.6 * v) ** 2))  # Strahl, 2.5 permille

    stop = quad(slowing, 0.0, 100 / 3.6)[0] + VEHICLE_BUILD_UP * 100 / 3.6
    assert wagon().percentage == pytest.approx(percentage_of_vehicle(stop, FROM_100), rel=1e-4)
    assert block_train(30).percentage == pytest.approx(87.9, abs=0.1)


def test_weighing_brakes_an_empty_wagon_less() -> None:
    full, empty = wagon(60e3), wagon(0.0)
    assert empty.brake.force_per_pressure == pytest.approx(0.4 * full.brake.force_per_pressure)
    half = wagon(20e3, weighing="continuous")
    assert half.brake.force_per_pressure == pytest.approx(0.5 * full.brake.force_per_pressure)
    assert np.isclose(wagon(60e3, weighing="continuous").percentage, full.percentage)


def test_the_smallest_depth_follows_what_is_asked() -> None:
    short, long = block_train(10), block_train(60)
    assert select_brake_model(short, distance=0.05, force=0.2).brake_model == "delay"
    assert select_brake_model(long, distance=0.05, force=0.2).brake_model == "empirical"
    assert select_brake_model(long, distance=0.05, force=0.2, releases=True).brake_model == "whole"
    assert select_brake_model(long).cells == 1.0
    assert select_brake_model(long, distance=0.003, force=0.06).cells == 2.0
    assert select_brake_model(long, force=0.01).cells == 8.0
    with pytest.raises(ValueError, match=r"The error of the force must be a share from 0 to 0\.5; got nan"):
        select_brake_model(short, force=float("nan"))


@pytest.mark.study
@pytest.mark.parametrize("length", [15, 70])
def test_the_errors_that_the_choice_counts_with_hold_for_another_train(length: int) -> None:
    """Trains of 229 m and 999 m, half service in P, compared with eight cells a vehicle."""
    consist = block_train(length)
    stops = []
    for one in BRAKE_MODELS_BY_COST.values():
        train = Train(consist, speed=25.0, settings=one.settings)
        start = train.distance[0]
        train.drive("service", 0.4)
        while train.speed.max() > 0.0:
            train.advance(2.0)
        stops.append(train.distance[0] - start)
    for one, stop in zip(BRAKE_MODELS_BY_COST.values(), stops, strict=True):
        if one.longest >= consist.length:
            assert stop == pytest.approx(stops[-1], rel=max(one.distance, 1e-12))


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"brake_model": "deep"}, "brake_model must be one of whole, empirical, delay; got deep"),
        ({"cells": 0.0}, "cells must be a number from 0.1 to 32; got 0"),
        ({"cells": 1.5}, "cells must be an integer, or one over an integer; got 1.5"),
        ({"share": 4.0}, "share must be a number from 1e-05 to 2.5; got 4"),
        ({"courant": 1.1}, "courant must be a number from 0.01 to 1; got 1.1"),
        ({"heat": float("nan")}, "heat must be a number from 0 to 1e\\+06; got nan"),
    ],
)
def test_settings_that_cannot_be_are_refused(values: dict, sentence: str) -> None:
    with pytest.raises(ValueError, match=sentence):
        Settings(**values)

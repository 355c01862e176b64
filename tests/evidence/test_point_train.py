"""Stops of a train as one mass: closed forms, and the train model with couplers."""

from __future__ import annotations

import numpy as np
import pytest

from evidence.trains.brake_switches import SERVICE, told
from evidence.trains.point_train import SPEEDS, PointTrain
from evidence.trains.ramp_stops import RampStop, fitted
from rbd_model.train.vehicle import GRAVITY
from scenarios.benchmark.own.train_stop import answer

#: Relative error of midpoint steps of 0.25 s against closed forms.
STEP_ERROR = 2e-4
#: Largest relative difference to a train of vehicles with couplers.
COUPLERS = 3e-3


def constant(deceleration: float) -> PointTrain:
    """Return a mass of 1 kg that brakes at once, without resistance."""
    return PointTrain(np.full((500, SPEEDS.size), deceleration), 1.0, GRAVITY, (0.0, 0.0, 0.0), 0.0)


@pytest.mark.parametrize("gradient", [0.0, 0.01, -0.02])
def test_a_constant_force_stops_in_half_the_square_of_its_speed(gradient: float) -> None:
    """v^2 / 2 (a + g i)."""
    [found] = constant(0.6).distances(np.array([20.0]), np.array([gradient]))
    assert found == pytest.approx(200.0 / (0.6 + GRAVITY * gradient), rel=STEP_ERROR)


def test_a_train_whose_brake_is_below_the_gradient_does_not_stop() -> None:
    assert np.isnan(constant(0.1).distances(np.array([20.0]), np.array([-0.02]))).all()


def test_the_factor_of_a_fit_gives_the_distance_over_the_margin() -> None:
    train = constant(0.5)
    [found] = train.distances(np.array([20.0]), np.zeros(1), train.fitted(20.0, 300.0, margin=1.2))
    assert 1.2 * found == pytest.approx(300.0, rel=STEP_ERROR)


@pytest.mark.study
@pytest.mark.parametrize(("speed", "gradient"), [(80.0, 0.0), (60.0, -1 / 100), (110.0, 1 / 60)])
def test_couplers_change_a_distance_by_less_than_its_bound(speed: float, gradient: float) -> None:
    """The train of the benchmark, with couplers and vehicles on the gradient one by one."""
    inputs = told("GW40").inputs
    due = answer({**inputs, "speed": speed / 3.6, "gradient": gradient})["distance"]
    [found] = SERVICE.train(inputs).distances(np.array([speed / 3.6]), np.array([gradient]))
    assert found == pytest.approx(due, rel=COUPLERS)


@pytest.mark.study
def test_a_closed_form_is_found_again_in_its_own_distances() -> None:
    """A table made of one deceleration, ramp and margin gives them back; a form without a margin misses it."""
    table = told("GW16")
    own = RampStop(0.5, 2.0, 20.0, 1.2)
    made = type(table)(**{**vars(table), "distance": own.distances(table.speed, table.gradient)})
    found, error = fitted(made, "and a margin")
    assert error < 1e-3
    assert (found.deceleration, found.ramp, found.margin) == pytest.approx((0.5, 20.0, 1.2), rel=0.03)
    assert fitted(made, "and a ramp")[1] > 0.02

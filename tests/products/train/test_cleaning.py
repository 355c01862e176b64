"""A train that cleans its rail against fixed points of the law of cleaning."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import fsolve

from products.train.cleaning import CleanedRail
from products.train.consist import Consist, locomotive
from products.train.train import Train
from rbd_model.track.recovery import assumed_recovery, no_recovery

GRAVITY, WHEELSETS = 9.80665, 4
#: Relative tolerance: steps of 20 ms lag behind the mean of a force, and energies are stored in cells of 1 m.
CELLS = 1e-3
RAIL = replace(assumed_recovery(), recovery_energy=200e3)


def locked_train(number: int) -> Train:
    """Return vehicles with locked wheels, whose friction does not fall with sliding, and without forces of couplers."""
    brake = replace(locomotive().brake, force_per_pressure=1.0, constant_friction=0.5)
    one = replace(locomotive(), brake=brake, resistance=(0.0, 0.0, 0.0), friction_ratio=1.0)
    train = Train(Consist((one,) * number), speed=25.0, cylinder=380e3, pipe=350e3)
    train.inputs["coupling_closed"] = 0.0
    train.drive("service", 1.0)
    return train


def fixed_point(vehicles: int) -> list[float]:
    """Return friction of locked vehicles: a wheelset slides with mu m g / n, and finds what all ahead have slid."""
    weight = locomotive().mass * GRAVITY / WHEELSETS

    def error(friction: np.ndarray) -> list[float]:
        energies = np.repeat(friction, WHEELSETS) * weight
        ahead = np.cumsum(energies) - energies
        own = 1.0 - np.exp(-energies / RAIL.recovery_energy)
        share = 1.0 - (1.0 - own) * (1.0 - RAIL.left_behind * (1.0 - np.exp(-ahead / RAIL.recovery_energy)))
        found = RAIL.degraded_friction + (RAIL.recovered_friction - RAIL.degraded_friction) * share
        return list(found.reshape(vehicles, WHEELSETS).mean(axis=1) - friction)

    return [float(one) for one in fsolve(error, np.full(vehicles, 0.1))]


def test_each_vehicle_finds_the_rail_that_the_wheels_ahead_have_cleaned() -> None:
    train = locked_train(3)
    rail = CleanedRail(train, RAIL)
    rail.advance(5.0)
    due = fixed_point(3)
    assert due[0] + 0.01 < due[1] < due[2] - 0.005
    assert train.inputs["friction"] == pytest.approx(due, rel=CELLS)
    fast = train.speed
    rail.advance(1.0)
    assert (fast - train.speed) / GRAVITY == pytest.approx(due, rel=CELLS)
    behind = float(train.distance[2]) - locomotive().length
    assert rail.energy(behind) == pytest.approx(sum(due) * locomotive().mass * GRAVITY, rel=CELLS)
    assert rail.energy(train.distance[0] + 30.0) == 0.0


def test_a_rail_that_stays_dirty_is_that_of_an_even_friction() -> None:
    train, even = locked_train(2), locked_train(2)
    CleanedRail(train, no_recovery()).advance(3.0)
    even.inputs["friction"] = no_recovery().degraded_friction
    even.advance(3.0)
    assert train.speed == pytest.approx(even.speed, rel=1e-4)


@pytest.mark.parametrize("wheelsets", [0, 2.5, 33])
def test_a_number_of_wheelsets_that_cannot_be_is_refused(wheelsets: float) -> None:
    with pytest.raises(ValueError, match=f"wheelsets must be an integer from 1 to 32; got {wheelsets}."):
        CleanedRail(locked_train(1), RAIL, wheelsets)  # type: ignore[arg-type]

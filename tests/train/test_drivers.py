"""Drivers of trains: a held speed, stops at stations, braking curves, an overrun on a rail that is too slippery."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from products.train.consist_file import consist_of
from products.train.driver import HoldingDriver
from products.train.timetable import StationStop, TimetableDriver
from products.train.train import Train
from rbd_model.track.line import Line

LOCOMOTIVE: dict[str, Any] = {
    "kind": "locomotive", "traction_force": 300.0, "traction_power": 5600.0, "adhesion": "curtius-kniffler",
}  # fmt: skip
CAR: dict[str, Any] = {
    "kind": "coach", "mass": 45.0, "length": 18.0, "rotating": 9.0, "coupler": "rigid",
    "brake": "ep-direct", "deceleration": 1.2, "dead_time": 0.3, "fill_time": 1.2, "dynamic_force": 60.0,
    "dynamic_power": 900.0, "traction_force": 60.0, "traction_power": 900.0,
}  # fmt: skip
TRAINS = {"coaches": [LOCOMOTIVE, {"kind": "coach", "count": 6}], "metro": [CAR | {"valve": "head"}, CAR, CAR]}


def train_of(name: str, gradient: float = 0.0, **values: Any) -> Train:
    """Return a train on a gradient."""
    line = Line({"distance": np.array([-1e5, 1e6]), "gradient": np.array([gradient] * 2)})
    return Train(consist_of(TRAINS[name]), line=line, **values)


@pytest.mark.parametrize("gradient", [0.0, 0.01, -0.012])
def test_a_driver_holds_a_speed_uphill_and_downhill(gradient: float) -> None:
    """The train begins 3 m/s slower. Brakes hold it on 12 permille, motors on the other gradients."""
    train, driver = train_of("coaches", gradient, speed=17.0), HoldingDriver(20.0)
    driver.act(train)
    assert train.inputs["traction"][0] == 1.0  # 3 m/s below the speed all motors pull
    for _ in range(400):
        driver.act(train)
        train.advance(driver.period)
    assert train.speed[0] == pytest.approx(20.0, abs=0.5 if gradient < 0.0 else 0.02)  # a least step of air
    assert (train.traction_force[0] > 1e3) == (gradient >= 0.0)
    assert (train.brake_force.sum() > 1e3) == (gradient < 0.0)


@pytest.mark.parametrize(("name", "deceleration"), [("coaches", 0.5), ("metro", 0.9)])
@pytest.mark.parametrize("gradient", [0.0, 0.008, -0.008])
def test_a_driver_stops_at_stations_in_time_within_the_limits(name: str, deceleration: float, gradient: float) -> None:
    """The second leg of 2400 m is due 200 s after the start of the first one, of 900 m."""
    stops = [StationStop(900.0, standing=20.0), StationStop(2400.0, arrival=270.0)]
    limits = [(0.0, 18.0), (1500.0, 14.0)]
    driver = TimetableDriver(stops, limits, deceleration)
    run = driver.drive(train_of(name, gradient), 600.0)
    assert [call.place for call in driver.calls] == [900.0, 2400.0]
    assert all(abs(call.overrun) < 5.0 for call in driver.calls)
    assert abs(driver.calls[1].late) < 15.0
    assert driver.calls[1].arrived - 270.0 == driver.calls[1].late
    allowed = np.where(run["distance"] < 1500.0, 18.0, 14.0)
    assert np.all(run["speed"] < allowed + 0.7)
    first = run["time"] < driver.calls[0].arrived
    fast, slow = (np.flatnonzero(first & (run["speed"] > v))[-1] for v in (13.0, 4.0))
    slows = (run["speed"][fast] - run["speed"][slow]) / (run["time"][slow] - run["time"][fast])
    assert slows == pytest.approx(deceleration, rel=0.1)


def test_a_higher_limit_holds_once_the_whole_train_has_passed_its_place() -> None:
    driver = TimetableDriver([StationStop(1e5)], [(0.0, 10.0), (500.0, 20.0)], 0.5)
    assert [driver.target(front, 200.0, 0.0, 0.0)[0] for front in (499.0, 501.0, 699.0, 701.0)] == [10.0] * 3 + [20.0]


def test_a_stop_on_a_slippery_rail_is_overrun_and_reported() -> None:
    """Friction of 0.04, of 0.016 for sliding wheels, cannot give 0.9 m/s2: at least v^2 / 2 (0.04 g) from the curve."""
    train, speed = train_of("metro", speed=15.0), 15.0
    train.inputs["friction"] = 0.04
    driver = TimetableDriver([StationStop(300.0)], [(0.0, speed)], 0.9)
    driver.drive(train, 300.0)
    least = speed**2 / 2 * (1 / (0.04 * 9.80665) - 1 / 0.9) - 20.0
    assert driver.calls[0].overrun > least
    assert driver.calls[0].overrun == pytest.approx(driver.front(train) - 300.0)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"stops": []}, "must have at least one stop and one speed limit"),
        ({"stops": [StationStop(9.0), StationStop(5.0)]}, "stops must have places that rise"),
        ({"limits": [(0.0, 10.0), (0.0, 20.0)]}, "limits must have places that rise"),
        ({"limits": [(0.0, 500.0)]}, "speed must be a number from 0.5 to 150"),
        ({"deceleration": math.nan}, "deceleration must be a number from 0.05 to 1.5"),
        ({"adhesion": 2.0}, "adhesion must be a number from 0.01 to 1"),
    ],
)
def test_a_timetable_that_cannot_be_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        TimetableDriver(**({"stops": [StationStop(100.0)], "limits": [(0.0, 20.0)]} | changes))


def test_a_time_that_cannot_be_and_a_second_train_are_refused() -> None:
    with pytest.raises(ValueError, match="standing must be a number from 0 to 86400 s"):
        StationStop(100.0, standing=-1.0)
    driver = TimetableDriver([StationStop(100.0)], [(0.0, 20.0)])
    driver.act(train_of("metro"))
    with pytest.raises(ValueError, match="must stay with one train"):
        driver.act(train_of("coaches"))


def test_a_brake_that_releases_wholly_is_refused() -> None:
    train = Train(consist_of([LOCOMOTIVE, {"kind": "wagon", "distributor": "aar"}]))
    with pytest.raises(ValueError, match="vehicle 2 has distributor = aar"):
        TimetableDriver([StationStop(100.0)], [(0.0, 20.0)]).act(train)


def test_a_train_without_motors_is_refused() -> None:
    with pytest.raises(ValueError, match="must have a train with motors"):
        TimetableDriver([StationStop(100.0)], [(0.0, 20.0)]).act(Train(consist_of([{"kind": "locomotive"}])))


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"speed": math.nan}, "speed must be a number from 0.1 to 150 m/s; got nan"),
        ({"dynamic": 1.0}, "dynamic must be a number from 0 to 0.95; got 1.0"),
        ({"period": 0.0}, "period must be a number from 0.01 to 10 s; got 0.0"),
    ],
)
def test_a_holding_driver_that_cannot_be_is_refused(values: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        HoldingDriver(**{"speed": 20.0, **values})


def test_a_dynamic_brake_that_no_vehicle_has_is_refused() -> None:
    with pytest.raises(ValueError, match="dynamic must be 0 with a train without dynamic brakes; got"):
        HoldingDriver(20.0, dynamic=0.5).act(Train(consist_of([{"kind": "locomotive"}])))

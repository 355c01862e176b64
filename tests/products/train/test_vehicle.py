"""A single vehicle against closed forms: resistance, curves, gradients, falling friction, traction, shoes."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad

from products.train.consist import Consist, locomotive, wagon
from products.train.train import Train
from rbd_model.track.line import Line

GRAVITY, MASS, TURNING, SPEED = 9.80665, 84e3, 1.04, 20.0
#: Relative tolerance of closed forms: resistance and brake force are constant within steps of 0.1 s.
CLOSED = 1e-3


def lone(line: Line | None = None, **changes: object) -> Train:
    """Return a locomotive at SPEED with its brake released; without resistance by default."""
    own = {"resistance": (0.0, 0.0, 0.0), "friction_ratio": 1.0} | changes
    return Train(Consist((replace(locomotive(), **own),)), speed=SPEED, line=line)  # type: ignore[arg-type]


def level(gradient: float = 0.0, curvature: float = 0.0) -> Line:
    """Return a line of constant gradient and curvature."""
    rows = {"distance": (-1e4, 1e4), "gradient": (gradient,) * 2, "curvature": (curvature,) * 2}
    return Line({name: np.array(values) for name, values in rows.items()})


@pytest.mark.parametrize("resistance", [(2e3, 0.0, 0.0), (0.0, 500.0, 0.0), (0.0, 0.0, 30.0), (2e3, 300.0, 20.0)])
def test_it_coasts_as_its_resistance_says(resistance: tuple[float, float, float]) -> None:
    """t = int (m + m_r) dv / (a + b v + c v^2) from the final speed to the initial speed."""
    a, b, c = resistance
    train = lone(resistance=resistance)
    train.advance(30.0)
    assert train.speed[0] < SPEED - 0.5
    time = quad(lambda v: TURNING * MASS / (a + b * v + c * v**2), float(train.speed[0]), SPEED)[0]
    assert time == pytest.approx(30.0, rel=CLOSED)


@pytest.mark.parametrize(("radius", "share"), [(1000.0, 0.65 / 945.0), (300.0, 0.65 / 245.0), (200.0, 0.5 / 170.0)])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_curves_and_gradients_slow_it_by_their_share_of_its_weight(radius: float, share: float, side: float) -> None:
    """Roeckl's 0.65 m / (R - 55 m) from 300 m on and 0.5 m / (R - 30 m) below, to either side; m g sin uphill."""
    for gradient in (0.0, 0.01):
        train = lone(level(gradient, side / radius))
        train.advance(10.0)
        lost = GRAVITY * (share + gradient) / TURNING * 10.0
        assert SPEED - train.speed[0] == pytest.approx(lost, rel=CLOSED)


def test_a_locked_wheel_slides_with_the_friction_of_its_speed() -> None:
    """dv/dt = -mu g (l + (1 - l) exp(-B v)) (Polach 2005), once the wheels are locked."""
    left, fall, friction = 0.4, 0.6, 0.05
    brake = replace(locomotive().brake, force_per_pressure=1.0, constant_friction=0.5)
    train = Train(
        Consist(
            (replace(locomotive(), brake=brake, resistance=(0.0, 0.0, 0.0), friction_ratio=left, friction_decay=fall),)
        ),
        speed=SPEED,
        cylinder=380e3,
        pipe=350e3,
    )
    train.drive("service", 1.0)
    train.inputs["friction"][:] = friction
    train.advance(2.0)
    assert train.wheel_speed[0] == 0.0
    first = float(train.speed[0])
    while train.speed[0] > 3.0:
        train.advance(0.1)
    time = train.time - 2.0
    due = quad(lambda v: 1.0 / (friction * GRAVITY * (left + (1 - left) * math.exp(-fall * v))), train.speed[0], first)
    assert time == pytest.approx(due[0], rel=CLOSED)


#: A map of friction: places [m], factors of the left rail and of the right one.
PLACES, LEFT, RIGHT = (0.0, 60.0, 65.0, 110.0), (1.0, 0.2, 0.2, 1.4), (1.0, 0.6, 0.6, 1.4)


def locked(line: Line | None, friction: float, number: int = 1) -> Train:
    """Return vehicles at SPEED, with the head at 0, whose brakes lock the wheels at any friction of a test."""
    brake = replace(locomotive().brake, force_per_pressure=1.0, constant_friction=0.5)
    one = replace(locomotive(), brake=brake, resistance=(0.0, 0.0, 0.0), friction_ratio=1.0)
    train = Train(Consist((one,) * number), speed=SPEED, cylinder=380e3, pipe=350e3, line=line)
    train.drive("service", 1.0)
    train.inputs["friction"] = friction
    return train


@pytest.mark.parametrize("gradient", [0.0, 0.004])
def test_locked_wheels_lose_on_a_map_what_the_mean_friction_below_the_vehicle_takes(gradient: float) -> None:
    """v dv = -g (mu0 f + i) dx, f the mean of both rails over the length of the vehicle, by quadrature."""
    friction, half = 0.1, locomotive().length / 2.0
    train = locked(level(gradient).with_friction(PLACES, LEFT, RIGHT), friction)
    train.advance(2.0)
    assert train.wheel_speed[0] == 0.0
    begin, fast = float(train.distance[0]), float(train.speed[0])
    train.advance(7.0)
    step = 0.01
    fine = np.arange(-100.0, 300.0, step)
    rails = np.interp(fine, PLACES, np.add(LEFT, RIGHT) / 2.0)
    below = np.convolve(rails, np.full(round(2.0 * half / step), step / 2.0 / half), "same")
    passed = (fine >= begin) & (fine <= train.distance[0])
    assert train.distance[0] > PLACES[-1] - half > PLACES[1] > begin
    taken = GRAVITY * (friction * below[passed].sum() * step + gradient * (train.distance[0] - begin))
    assert (fast**2 - train.speed[0] ** 2) / 2.0 == pytest.approx(taken, rel=CLOSED)


def test_each_vehicle_of_a_train_slides_at_its_own_place() -> None:
    """Leaves below the second of three vehicles bound its rail force by mu0 f m g, and no other one."""
    friction, leaves, length = 0.2, 0.1, locomotive().length
    places = (-2.0 * length - 5.0, -2.0 * length - 5.0, -length + 5.0, -length + 5.0)
    line = level().with_friction(places, (1.0, leaves, leaves, 1.0))
    train = locked(line, friction, 3)
    train.advance(0.01)
    share = -train.rail_force / (friction * MASS * GRAVITY)
    assert share[1] == pytest.approx(leaves, rel=CLOSED)
    assert np.all(share[[0, 2]] > 0.7)


def test_a_map_of_factors_1_changes_no_bit_and_beyond_its_ends_it_goes_on() -> None:
    short = Line({"distance": np.array([-10.0, 10.0]), "gradient": np.zeros(2), "curvature": np.zeros(2)})
    trains = [locked(line, 0.1) for line in (None, short, short.with_friction((-10.0, 10.0), (1.0, 1.0)))]
    trains.append(locked(short.with_friction((-10.0, 10.0), (0.5, 0.5)), 0.2))
    for one in trains:
        one.advance(6.0)
    assert len({(float(one.speed[0]), float(one.distance[0])) for one in trains[:3]}) == 1
    assert float(trains[3].speed[0]) == pytest.approx(float(trains[0].speed[0]), rel=1e-9)


def test_wheels_that_are_pulled_too_much_spin_up() -> None:
    """m dv/dt = mu m g and m_r dw/dt = P - mu m g."""
    pull, friction = 100e3, 0.05
    train = lone()
    train.inputs["friction"][:], train.inputs["pull"][:] = friction, pull
    train.advance(2.0)
    held = friction * MASS * GRAVITY
    assert train.speed[0] - SPEED == pytest.approx(held / MASS * 2.0, rel=CLOSED)
    assert train.wheel_speed[0] - SPEED == pytest.approx((pull - held) / (0.04 * MASS) * 2.0, rel=CLOSED)


@pytest.mark.parametrize("load", [0.0, 60e3])
def test_shoes_hold_what_cylinder_and_rigging_make(load: float) -> None:
    """mu eta (k p - F_c) (2.4), (2.6), at constant friction."""
    one = wagon(load)
    share, area = (1.0 if load else 0.4), math.pi / 4 * 0.406**2
    pressed = 0.83 * share * 5.65 * (area * 380e3 - 1500.0)
    vehicle = replace(locomotive(), brake=replace(one.brake, friction_law=0.0, constant_friction=0.25))
    train = Train(Consist((vehicle,)), cylinder=380e3, pipe=350e3)
    assert train.brake_force[0] == pytest.approx(0.25 * pressed, rel=1e-9)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("friction", "friction must be set as an input. Write train.inputs"),
        ("speed", "speed must be read, it is an output. Set the inputs, or motion"),
        ("inputz", "must have the attribute that is set; got 'inputz'"),
        ("inputs", "inputs must be set by name"),
    ],
)
def test_what_would_have_no_effect_on_a_train_is_not_set(name: str, message: str) -> None:
    train = Train(Consist((locomotive(),)))
    with pytest.raises(AttributeError, match=message):
        setattr(train, name, 0.02)

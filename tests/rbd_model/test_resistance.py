"""Test running resistance against closed forms: run-out, rest on a gradient, start from it, and return downhill."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import pytest

from fmu_src.kernel import Kernel, Library
from fmu_src.system import model_of
from rbd_model.track.line import line_of, straight
from tests.fmu_src.quick_library import quick_library
from tests.rbd_model.test_standing import MAKERS, MASS, P

ROLLING = MASS + 2 * P.wheelset_pitch_inertia / P.wheel_radius**2
GRADIENT = 0.005
PULL = MASS * P.gravity * GRADIENT
#: a [N], b [N.s/m], c [N.s2/m2] of Davis, and the initial speed of a run-out [m/s].
DAVIS, SPEED = (900.0, 25.0, 6.0), 20.0
#: Relative tolerance of a run-out, with a tolerance of 1e-7; measured 3e-10.
RUN_OUT_BAND = 1e-8
#: Displacements of a standing vehicle [m]: springs deflect under its weight, 11 um, and rock it if only wheels hold, 3
#: mm.
GIVEN_WAY, ROCKED = 5e-5, 5e-3
#: Tolerances of the speed gained on that gradient: in ten minutes, with slip due to held torques, 1.4e-6; and in the
#: first minute, while springs are loaded, 4e-5.
GAIN_BAND, START_BAND = 3e-6, 1e-4
#: Tolerance of speed and position after the turn downhill; springs are loaded as the force reverses.
BACK_BAND = 1e-6
#: Holding forces as shares of the gradient's pull: constant a, and rolling resistance.
HELD_BY = [(1.02, 0.0), (0.0, 1.02), (0.51, 0.51)]

Make = Callable[..., Kernel]


@pytest.fixture(scope="module", params=list(MAKERS))
def library(request: pytest.FixtureRequest) -> Library:
    """A bogie on a line, at each level and with two contact models."""
    return quick_library(model_of(MAKERS[request.param](), 1e-6))


@pytest.fixture
def on_gradient(library: Library, tmp_path: Path) -> Make:
    """Return a function that makes a kernel on a gradient; by default without rolling resistance of the axle boxes."""

    def make(gradient: float, **values: float) -> Kernel:
        path = str(line_of([straight(4000.0, gradient)]).write(tmp_path / "line.csv"))
        kernel = Kernel(library, line_file=path, tolerance=1e-7, rolling_resistance_torque=0.0)
        kernel.set(**values)
        return kernel

    return make


def run_out(speed: float) -> tuple[float, float]:
    """Return distance [m] and time [s] to rest: integrals of M v dv and M dv over a + b v + c v^2."""
    a, b, c = DAVIS
    root = math.sqrt(4 * a * c - b**2)
    time = 2 * ROLLING / root * (math.atan((2 * c * speed + b) / root) - math.atan(b / root))
    return (ROLLING * math.log(1 + (b + c * speed) * speed / a) - b * time) / (2 * c), time


@pytest.mark.study
def test_a_vehicle_runs_out_and_stops_as_its_momentum_says(on_gradient: Make) -> None:
    kernel = on_gradient(0.0, initial_speed=SPEED)
    kernel.set(**dict(zip(("davis_constant", "davis_linear", "davis_quadratic"), DAVIS, strict=True)))
    way, time = run_out(SPEED)
    kernel.advance(time + 30.0)
    assert kernel["distance"] == pytest.approx(way, rel=RUN_OUT_BAND)
    assert kernel.messages == [f"Running resistance holds the vehicle at {time:.6g} s."]
    assert kernel["speed"] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.study
@pytest.mark.parametrize(("constant", "rolling"), HELD_BY)
def test_resistance_above_the_pull_of_a_gradient_holds(on_gradient: Make, constant: float, rolling: float) -> None:
    """After settling for a minute the vehicle stays at rest for nine more."""
    torque = rolling * PULL * P.wheel_radius / 2
    kernel = on_gradient(-GRADIENT, initial_speed=0.0, davis_constant=constant * PULL, rolling_resistance_torque=torque)
    kernel.advance(60.0)
    settled = kernel["distance"]
    kernel.advance(540.0)
    assert kernel["distance"] == pytest.approx(settled, abs=1e-10)
    assert 0.0 <= settled < (ROCKED if rolling else GIVEN_WAY)


@pytest.mark.parametrize(("constant", "rolling"), HELD_BY)
def test_resistance_below_it_lets_go_with_what_is_left(on_gradient: Make, constant: float, rolling: float) -> None:
    """a = (m g i - A) / (m + J / r^2), once springs are loaded; from the start without rolling resistance."""
    share, begin, end = 0.98 / 1.02, 60.0, 600.0
    torque = share * rolling * PULL * P.wheel_radius / 2
    kernel = on_gradient(-GRADIENT, initial_speed=0.0, davis_constant=share * constant * PULL)
    kernel.set(rolling_resistance_torque=torque)
    kernel.advance(begin)
    before, acceleration = kernel["speed"], (1 - 0.98) * PULL / ROLLING
    kernel.advance(end - begin)
    assert kernel["speed"] - before == pytest.approx(acceleration * (end - begin), rel=GAIN_BAND)
    if not rolling:
        assert before == pytest.approx(acceleration * begin, rel=START_BAND)


def test_resistance_turns_with_the_motion(on_gradient: Make) -> None:
    """Uphill gravity and resistance add, downhill they subtract: speed and position 20 s after the turn."""
    gradient, begin, after = 0.02, 5.0, 20.0
    gravity, resistance = MASS * P.gravity * gradient, 0.3 * MASS * P.gravity * gradient
    up, down = (gravity + resistance) / ROLLING, (gravity - resistance) / ROLLING
    kernel = on_gradient(gradient, initial_speed=begin, davis_constant=resistance)
    kernel.advance(begin / up + after)
    assert kernel["speed"] == pytest.approx(-down * after, rel=BACK_BAND)
    assert kernel["distance"] == pytest.approx(begin**2 / (2 * up) - down * after**2 / 2, rel=BACK_BAND)


def test_without_resistance_nothing_happens_at_rest(on_gradient: Make) -> None:
    """A force that alternates about rest causes no event if a, b and c are 0."""
    kernel = on_gradient(0.0, initial_speed=0.0)
    for sign in (1.0, -2.0, 2.0, -1.0):
        kernel.set(drawbar_force=sign * 1e3)
        kernel.advance(1.0)
    assert kernel.counts["events"] == 0
    assert kernel.messages == []

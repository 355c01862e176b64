"""Test vehicles at rest on locked wheels: held by their rails, released, or pulled harder than friction."""

from __future__ import annotations

from pathlib import Path

import pytest

from fmu_src.kernel import Kernel, Library
from fmu_src.system import model_of
from rbd_model.contact.depth import Contact
from rbd_model.levels.planar import planar_vehicle
from rbd_model.levels.point import point_vehicle
from rbd_model.levels.spatial import spatial_vehicle
from rbd_model.track.irregularity import irregular_track, section_5_3
from rbd_model.track.line import line_of, straight
from rbd_model.vehicle.ready import two_axle_bogie
from tests.fmu_src.quick_library import quick_library

BOGIE = two_axle_bogie()
P = BOGIE.parameters
MASS = P.frame_mass + 2 * P.wheelset_mass
GRADIENT, DAY, HOLDING = 0.04, 86400.0, 20e3
#: Round-off of a distance of some metres, over a day [m]; latest start [s], half of which is due to slip.
STANDING_BAND, LATE_BAND = 1e-9, 1e-3
#: Tolerance of friction times load: the creep law is within 2 % of it at full sliding (3.97).
SLIDING_BAND = 0.02


MAKERS = {
    "point": lambda: point_vehicle(BOGIE, True),
    "planar": lambda: planar_vehicle(BOGIE, True),
    "spatial": lambda: spatial_vehicle(BOGIE, irregular_track(section_5_3()), Contact(2), True),
}


@pytest.fixture(scope="module", params=list(MAKERS))
def library(request) -> Library:  # type: ignore[no-untyped-def]
    """A bogie on a line, at each level."""
    return quick_library(model_of(MAKERS[request.param](), 1e-6))


@pytest.fixture
def uphill(library: Library, tmp_path: Path):  # type: ignore[no-untyped-def]
    """Return a function that makes a kernel on a gradient of 40 per mille."""
    path = str(line_of([straight(3000.0, GRADIENT)]).write(tmp_path / "line.csv"))

    def make(**values: float) -> Kernel:
        kernel = Kernel(library, line_file=path, initial_speed=0.0, brake_torque_1=HOLDING, brake_torque_2=HOLDING)
        kernel.set(**values)
        return kernel

    return make


@pytest.mark.parametrize("speed", [0.0, 4.0])
def test_locked_vehicle_stands_for_a_day_and_starts_by_newtons_law_once_released(uphill, speed) -> None:  # type: ignore[no-untyped-def]
    kernel = uphill(initial_speed=speed)
    kernel.advance(40.0)
    place = kernel["distance"]
    kernel.advance(DAY)
    assert kernel["distance"] == pytest.approx(place, abs=STANDING_BAND)
    assert kernel["speed"] == 0.0
    assert kernel["angular_velocity_1"] == kernel["angular_velocity_2"] == 0.0
    assert kernel["locked_1"] == kernel["locked_2"] == 0.0
    force = kernel["creep_force_1"] + kernel["creep_force_2"]
    assert force == pytest.approx(MASS * P.gravity * GRADIENT, rel=1e-6)
    assert kernel.counts["events"] < 10
    kernel.set(brake_torque_1=0.0, brake_torque_2=0.0)
    kernel.advance(40.0)
    acceleration = P.gravity * GRADIENT * MASS / (MASS + 2 * P.wheelset_pitch_inertia / P.wheel_radius**2)
    assert 40.0 + kernel["speed"] / acceleration == pytest.approx(0.0, abs=LATE_BAND)


def test_vehicle_stands_as_long_as_friction_times_load_holds_it(uphill) -> None:  # type: ignore[no-untyped-def]
    kernel = uphill(friction_1=0.05, friction_2=0.05)
    kernel.advance(10.0)
    assert kernel["speed"] == 0.0
    slippery = uphill(friction_1=0.03, friction_2=0.03)
    slippery.advance(10.0)
    closed = -P.gravity * (GRADIENT - 0.03) * 10.0
    assert slippery["speed"] == pytest.approx(closed, rel=0.03 / (GRADIENT - 0.03) * SLIDING_BAND)
    assert slippery["locked_1"] == 1.0


def test_brake_that_lets_go_slowly_holds_until_its_torque_is_what_gravity_asks(uphill) -> None:  # type: ignore[no-untyped-def]
    """The torque falls to 0 within one communication step: the vehicle starts in time, not at the end of the step."""
    kernel = uphill()
    kernel.advance(30.0)
    kernel.set_rate(brake_torque_1=-HOLDING / 10.0, brake_torque_2=-HOLDING / 10.0)
    kernel.advance(10.0)
    asked = MASS * P.gravity * GRADIENT * P.wheel_radius / 2
    rolled = HOLDING / 10.0  # from there the brake loses the same torque each second
    left = asked / rolled
    mass = MASS + 2 * P.wheelset_pitch_inertia / P.wheel_radius**2
    closed = -2 * rolled / P.wheel_radius / mass * left**2 / 2
    assert kernel["speed"] == pytest.approx(closed, rel=0.02)
    assert kernel["locked_1"] == kernel["locked_2"] == 0.0

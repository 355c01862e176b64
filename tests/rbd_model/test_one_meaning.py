"""Test that lines with few rows mean the same for vehicles, trains and Python: gradients are linear between rows."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fmu_src.kernel import Kernel, Library
from fmu_src.system import model_of
from products.train.consist import Consist, locomotive
from products.train.numbers import Settings
from products.train.train import Train
from rbd_model.levels.planar import planar_vehicle
from rbd_model.levels.point import point_vehicle
from rbd_model.track.line import Line, read_line
from rbd_model.track.line_table import ROUNDING
from rbd_model.vehicle.description import Vehicle
from rbd_model.vehicle.ready import passenger_coach, two_axle_bogie
from tests.fmu_src.quick_library import quick_library

#: A vertical curve of 120 m to 15 per mille, and one of 200 m back to level.
PLACES, GRADIENTS = [-100.0, 100.0, 220.0, 1500.0, 1700.0, 3000.0], [0.0, 0.0, 0.015, 0.015, 0.0, 0.0]
#: Tolerance of a gradient outside the rounding.
STRAIGHT_BAND = 1e-4
#: Tolerance within it: a sixth of the change of slope in 1 m; cubics deviate from straight lines by 4 / 27 of it.
ROUNDED_BAND = ROUNDING * 0.015 / 120 / 6
#: Work of creep and dampers as a share of that of a hill, and step errors at a tolerance of 1e-8.
HILL_BAND = 2e-3
GRAVITY, SPEED = 9.81, 40.0


@pytest.fixture
def few_rows(tmp_path: Path) -> Path:
    rows = "".join(f"{place:g},0,0,{gradient:g}\n" for place, gradient in zip(PLACES, GRADIENTS, strict=True))
    path = tmp_path / "line.csv"
    path.write_text("distance,curvature,cant,gradient\n" + rows)
    return path


def straight_lines(places: np.ndarray) -> np.ndarray:
    return np.interp(places, PLACES, GRADIENTS)


def rolling(vehicle: Vehicle) -> Library:
    return quick_library(model_of(point_vehicle(vehicle, True), 1e-9))


@pytest.mark.study
@pytest.mark.parametrize("make", [two_axle_bogie, passenger_coach])
def test_a_vehicle_feels_straight_lines_of_gradient(make, few_rows: Path) -> None:  # type: ignore[no-untyped-def]
    """a = -g m / (m + J / r^2) times the mean of the gradients under its masses, for freely rolling wheels."""
    vehicle: Vehicle = make()
    kernel = Kernel(rolling(vehicle), line_file=str(few_rows), initial_speed=SPEED, tolerance=1e-8)
    kernel.set(rolling_resistance_torque=0.0)
    table = kernel.record(60.0, 0.25, ["distance", "speed", "acceleration"])
    place, masses = np.array(table["distance"]), [vehicle.number(part.mass) for part in vehicle.parts]
    places = [place + vehicle.number(part.along) for part in vehicle.parts]
    mean = np.average([straight_lines(one) for one in places], axis=0, weights=masses)
    turning = sum(vehicle.number(one.inertia[1]) / vehicle.number(one.mean_radius) ** 2 for one in vehicle.wheelsets)
    felt = -np.array(table["acceleration"]) / GRAVITY * (1.0 + turning / sum(masses))
    assert np.ptp(place) > 2000.0
    assert np.max(np.abs(felt - mean)) < STRAIGHT_BAND


@pytest.mark.study
@pytest.mark.parametrize(("make", "halves"), [(point_vehicle, (0.5, 5.0, 50.0, 500.0)), (planar_vehicle, (50.0,))])
def test_no_step_passes_over_a_hill(make, halves: tuple[float, ...], tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    """A peak of 20 per mille alone on its line: m g h = (m + J / r^2) (v0^2 - v1^2) / 2. Nothing else limits steps."""
    vehicle = two_axle_bogie()
    library = quick_library(model_of(make(vehicle, True), 1e-8))
    mass = sum(vehicle.number(part.mass) for part in vehicle.parts)
    turning = sum(vehicle.number(one.inertia[1]) / vehicle.number(one.mean_radius) ** 2 for one in vehicle.wheelsets)
    for half in halves:
        places, peak = (
            np.array([-100.0, 1000.0 - half, 1000.0, 1000.0 + half, 20e3]),
            np.array([0.0, 0.0, 0.02, 0.0, 0.0]),
        )
        rows = dict(zip(("distance", "curvature", "cant", "gradient"), (places, 0 * peak, 0 * peak, peak), strict=True))
        file = Line(rows).write(tmp_path / f"{half:g}.csv")
        kernel = Kernel(library, line_file=str(file), initial_speed=30.0, rolling_resistance_torque=0.0)
        kernel.advance(120.0)
        lost = (30.0**2 - kernel["speed"] ** 2) / 2 * (1.0 + turning / mass)
        assert kernel["distance"] > 1000.0 + half + 10.0
        assert lost == pytest.approx(GRAVITY * 0.02 * half, rel=HILL_BAND, abs=1e-4)


def test_a_train_feels_straight_lines_of_gradient(few_rows: Path) -> None:
    """m (1 + share) dv/dt = -m g (h(front) - h(rear)) / length, by quadrature of the straight lines."""
    one = locomotive()
    train = Train(Consist((one,)), speed=SPEED, line=read_line(few_rows), settings=Settings(brake_model="delay"))
    nodes, weights = np.polynomial.legendre.leggauss(60)
    for _ in range(60):
        before, speed = float(train.motion[0, 0]), float(train.speed[0])
        train.advance(1.0)
        lost = speed - float(train.speed[0])
        middle = np.linspace(before, float(train.motion[0, 0]), 41)[:, None] - one.length / 2
        mean = float(np.mean(straight_lines(middle + one.length / 2 * nodes) @ weights / 2))
        held = sum(c * speed**n for n, c in enumerate(one.resistance)) / one.mass / GRAVITY
        assert mean + held == pytest.approx(lost / 9.80665 * 1.04, abs=STRAIGHT_BAND)


def test_python_reads_straight_lines_of_gradient(few_rows: Path) -> None:
    line = read_line(few_rows)
    places = np.linspace(-150.0, 3050.0, 6401)
    away = np.min(np.abs(places[:, None] - PLACES), axis=1)
    departure = np.abs(line.value("gradient", places) - straight_lines(places))
    assert np.max(departure[away > ROUNDING]) < 1e-15
    assert 0.5 * ROUNDED_BAND < np.max(departure) < ROUNDED_BAND


def test_a_train_is_straight_beyond_the_ends_of_its_line(few_rows: Path) -> None:
    """The same applies to a vehicle: beyond the line there is no curve, and the last gradient continues."""
    rows = {"distance": np.array([0.0, 100.0]), "gradient": np.zeros(2), "curvature": np.full(2, 1 / 300)}
    train = Train(Consist((locomotive(),)), speed=SPEED, distance=500.0, line=Line(rows))
    free = Train(Consist((locomotive(),)), speed=SPEED, distance=500.0)
    for one in (train, free):
        one.advance(5.0)
    assert train.speed[0] == free.speed[0]
    assert Line(rows).value("curvature", 500.0) == 0.0

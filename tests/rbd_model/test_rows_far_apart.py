"""A bogie on lines with rows every 10 m, and on lines from noisy points, against exact lines."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fmu_src.compile import build_library
from fmu_src.kernel import Kernel, Library
from rbd_model.levels.models import bogie_dynamics
from rbd_model.track.line import Line, arc, clothoid, line_of, straight
from rbd_model.track.line_points import line_from_points
from tests.rbd_model.test_line_points import sampled as points_of_arc

CURVE = arc(150.0, 200.0, cant=0.10)
SPEED = 15.0
#: Tolerance of the guiding force where rows coincide with corners; measured 4.2e-4 (corners are rounded alike).
SAME = 1e-3
#: Largest loss of the peak if corners lie between rows of 10 m; measured 7.0 %. Tolerance of the mean in the arc, where
#: the wheelset still swings; measured 0.2 %.
BLUNTED, IN_ARC = 0.08, 5e-3
#: Largest errors of the force with noise of 1 mm: of its peak and of its mean in the arc; measured 0.9 % and 0.05 %.
OF_PEAK, OF_MEAN = 0.03, 2e-3


@pytest.fixture(scope="module")
def bogie() -> Library:
    return Library(build_library(bogie_dynamics()))


def sampled(line: Line, phase: float) -> Line:
    """Return a line with rows every 10 m only, from its start plus `phase` [m] on."""
    first, last = line.rows["distance"][[0, -1]]
    places = np.unique(np.concatenate([[first], np.arange(first + phase, last, 10.0), [last]]))
    return Line({name: line.value(name, places) for name in line.rows} | {"distance": places})


def guiding_force(bogie: Library, line: Line, folder: Path) -> np.ndarray:
    kernel = Kernel(bogie, level=3, line_file=str(line.write(folder / "line.csv")))
    kernel.set(initial_speed=SPEED)
    seconds = float(line.rows["distance"][-1]) / SPEED - 1.5
    return np.array(kernel.record(seconds, 0.02, ["guiding_force_1"])["guiding_force_1"])


@pytest.mark.study
def test_rows_every_10_m_run_with_the_forces_of_the_line(bogie: Library, tmp_path: Path) -> None:
    """Corners at 73, 133, 283 and 343 m: 3 m behind a row for rows from -20 m on, at a row for rows from -17 m on."""
    into, out = clothoid(60.0, straight(1.0), CURVE), clothoid(60.0, CURVE, straight(1.0))
    line = line_of([straight(93.0), into, CURVE, out, straight(60.0)], -20.0)
    exact = guiding_force(bogie, line, tmp_path)
    at_corners, between = (guiding_force(bogie, sampled(line, phase), tmp_path) for phase in (3.0, 0.0))
    assert np.max(np.abs(at_corners - exact)) <= SAME * np.max(np.abs(exact))
    assert 1.0 - BLUNTED <= np.max(np.abs(between)) / np.max(np.abs(exact)) <= 1.0
    way = SPEED * 0.02 * np.arange(exact.size)
    arc_alone = (way > 200.0) & (way < 260.0)
    assert np.mean(between[arc_alone]) == pytest.approx(np.mean(exact[arc_alone]), rel=IN_ARC)


def test_points_with_noise_of_1_mm_give_the_forces_of_the_exact_line(bogie: Library, tmp_path: Path) -> None:
    """A curve of 300 m at 15 m/s. Transients at the corners are up to 7 % of the peak apart; they have no tolerance."""
    curve = arc(200.0, 300.0)
    into, out = clothoid(60.0, straight(1.0), curve), clothoid(60.0, curve, straight(1.0))
    line = line_of([straight(120.0), into, curve, out, straight(100.0)], -20.0)
    exact = guiding_force(bogie, line, tmp_path)
    inside = slice(int(200 / SPEED / 0.02), int(330 / SPEED / 0.02))
    for spacing in (2.5, 5.0, 10.0):
        ahead = np.column_stack([np.arange(-20.0, 0.0, spacing), np.zeros(int(20 / spacing))])
        points = np.concatenate([ahead, points_of_arc(300.0, spacing, 0.0, 0)])
        points += 0.001 * np.random.default_rng(5).standard_normal(points.shape)
        found = guiding_force(bogie, line_from_points(points, start=-20.0), tmp_path)
        assert np.max(np.abs(found)) == pytest.approx(np.max(np.abs(exact)), rel=OF_PEAK)
        assert np.mean(found[inside]) == pytest.approx(np.mean(exact[inside]), rel=OF_MEAN)

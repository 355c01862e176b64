"""Test the limits on the size of a line, which are checked before the work begins."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from rbd_model.track.irregularity import track_from_points
from rbd_model.track.line import Line, arc, line_of, straight
from rbd_model.track.spectra import ERRI_LOW, irregular

LINE = line_of([straight(200.0)])


@pytest.mark.parametrize("segment", [straight(1e9), straight(1e300), arc(1e6, 1e-3)])
def test_a_segment_of_millions_of_rows_is_refused(segment: object) -> None:
    with pytest.raises(ValueError, match="A line must have at most 1000000 rows; this one has more than"):
        line_of([segment])  # type: ignore[list-item]


@pytest.mark.parametrize(
    ("waves", "pitch"), [((3.0, 100.0), 1e-6), ((3.0, 100.0), 0.0), ((3.0, 100.0), -1.0), ((1e-3, 2e-3), 1e-4)]
)
def test_irregularities_of_too_many_rows_and_waves_are_refused(waves: tuple[float, float], pitch: float) -> None:
    long = line_of([straight(20e3)]) if waves[0] < 1.0 else LINE
    with pytest.raises(ValueError, match=r"A line must have at most 1000000 rows, and 1e.10 rows times waves"):
        irregular(long, ERRI_LOW, 1, waves, pitch)


def test_points_of_a_track_that_are_nearly_one_are_refused() -> None:
    """Steps resolve the distance between points: with these they would be 1e-10 m long."""
    flat = np.zeros(7)
    with pytest.raises(ValueError, match=r"Points of a track must be at least 0.001 m apart; got 1e-09 m"):
        track_from_points(np.array([0.0, 1.0, 1.0 + 1e-9, 2.0, 3.0, 4.0, 5.0]), flat, flat, flat, flat + 1)


@pytest.mark.parametrize(
    ("changes", "error", "sentence"),
    [
        ({"gradient": [0.0, 10.0]}, ValueError, r"gradient must be from -0.5 to 0.5; got 10 in row 2\."),
        ({"cant": [np.nan, 0.0]}, ValueError, r"cant must be from -0.3 to 0.3 m; got nan m in row 1\."),
        ({"gradent": [0.0, 0.0]}, KeyError, r"no column 'gradent'\. Did you mean gradient\?"),
        ({"distance": None}, ValueError, "must have the column distance"),
        ({"distance": [5.0, 0.0]}, ValueError, r"by at least 0.001 m .* got 0 m in row 2 after 5 m\."),
        ({"distance": [0.0]}, ValueError, r"at least 2 rows; got 1\."),
        ({"cant": [0.0] * 3}, ValueError, r"cant must have 2 rows as distance has; got 3\."),
        ({"cant": ["0", "0"]}, ValueError, "cant must be a list of numbers"),
        ({"cant": [[0.0], 0.0]}, ValueError, "cant must be a list of numbers"),
        ({"cant": np.ma.array([0.0, 0.1], mask=[False, True])}, ValueError, "none of them masked"),
    ],
)
def test_rows_that_are_no_line_are_refused(changes: dict, error: type[Exception], sentence: str) -> None:
    rows = {"distance": [0.0, 100.0], "gradient": [0.0, 0.0]} | changes
    with pytest.raises(error, match=sentence):
        Line({name: values for name, values in rows.items() if values is not None})  # type: ignore[misc]


def test_lists_are_rows_of_a_line() -> None:
    assert Line({"distance": [0, 100], "gradient": [0, 0.01]}).value("gradient", 50.0) == 0.005  # type: ignore[dict-item]


def test_lines_are_equal_by_their_rows() -> None:
    same, other = line_of([straight(200.0)]), line_of([straight(200.0, 0.01)])
    assert LINE == same != other
    assert hash(LINE) == hash(same)
    assert Line({name: values for name, values in LINE.rows.items() if name != "cant"}) != LINE
    assert replace(LINE) == LINE
    assert math.isfinite(irregular(LINE, ERRI_LOW, 1).rows["left_vertical"][-1])
    assert irregular(LINE, ERRI_LOW, 1) == irregular(LINE, ERRI_LOW, 1) != irregular(LINE, ERRI_LOW, 2)

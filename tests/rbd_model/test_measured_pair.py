"""Test pairs of measured profiles: equal to an independent calculation, whatever the axes; notes; one message."""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator

import bogie_braking as bb
from bogie_braking.pairs import profile
from rbd_model.contact.geometry import Pair, Sides, contact_at, equivalent_conicity
from rbd_model.contact.measured_pair import gauge_of
from rbd_model.contact.profiles import from_points
from readers.text import BadInputError

REFERENCE = Path(__file__).parents[1] / "data" / "contact"
#: Files of instruments and programs, if available.
STRANGERS = Path(os.environ.get("PROFILES_OF_OTHERS", "nowhere"))
#: y and z of a reference wheel and rail of EN 15302 [mm]; the wheel's points lie 0.135 mm apart.
WHEEL, RAIL = (
    np.loadtxt(REFERENCE / f"en15302_{name}.csv", delimiter=",", skiprows=1) for name in ("RUIC519H", "SUIC519A")
)


def simpack(path: Path, points: np.ndarray, keys: str = "") -> Path:
    """Write points [mm] as a SIMPACK file; the ending gives the type."""
    rows = "\n".join(f"{y:.9f} {z:.9f}" for y, z in points)
    kind = int(path.suffix == ".prw")
    path.write_text(
        f"header.begin\nversion = 1\ntype = {kind}\nheader.end\nspline.begin\nunits.len.f = 1000\n{keys}\n"
        f"point.begin\n{rows}\npoint.end\nspline.end\n"
    )
    return path


#: Change of a conicity by smoothing; noise of 2 um scatters it by 0.004. EN 15302 allows 0.05 or half of it.
SMOOTHED = 0.002


def brute_force_conicity(wheel: np.ndarray, rail: np.ndarray, amplitude: float) -> float:
    """Return the equivalent conicity by another method: points, no splines; the wave is integrated in time.

    The wheel is laid over the rail at each shift by the smallest gap of monotone cubics through the points [mm], both
    with their flange at negative y, 0.01 mm apart. Klingel's equation y'' = -Dr / (e r0) then runs from the amplitude
    at rest over a quarter of a wave (EN 15302:2008, annex B), and the wavelength gives the cone.
    """
    y = np.arange(-45.0, 45.0, 0.01)
    on_wheel, on_rail = (PchipInterpolator(*one.T, extrapolate=False) for one in (wheel, rail))
    height = on_wheel(y)
    shifts = np.linspace(-1.02, 1.02, 2 * round(amplitude / 0.05) + 1) * amplitude

    def radius(shift: float) -> float:
        gap = height - on_rail(y + shift)
        return -float(height[np.nanargmin(gap)])

    outward = np.array([radius(shift) for shift in shifts])
    difference = outward - outward[::-1]

    def motion(_: float, state: np.ndarray) -> list[float]:
        return [state[1], -float(np.interp(state[0], shifts, difference)) / (1500.0 * 460.0)]

    def crosses(_: float, state: np.ndarray) -> float:
        return float(state[0])

    found = solve_ivp(motion, (0.0, 3e4), [amplitude, 0.0], events=crosses, rtol=1e-8, atol=1e-9, max_step=50.0)
    quarter = float(found.t_events[0][0])
    return 750.0 * 460.0 * (math.pi / 2 / quarter) ** 2


@pytest.mark.study
@pytest.mark.parametrize("amplitude", [2.0, 3.0, 4.0])
def test_conicity_is_that_of_an_independent_calculation(amplitude: float, tmp_path: Path) -> None:
    """A cone 1:20 with a hollow of 0.2 mm on the reference rail: no flange jumps."""
    y = np.arange(-60.0, 60.0, 0.2)
    hollow = 0.05 * y - 0.2 * np.exp(-((y / 25.0) ** 2))
    flange = 28.0 / (1 + np.exp((y + 45.0) / 1.5))
    wheel = np.column_stack([y, hollow - flange])
    pair = bb.pair(simpack(tmp_path / "w.prw", wheel), simpack(tmp_path / "r.prr", RAIL), gauge=1.435)
    beside = np.array([1e3 * (pair.left.rail_half_distance - pair.left.wheel_half_distance), 0.0])
    found = float(equivalent_conicity(pair, np.array([amplitude / 1e3]), rolls=False)[0])
    smooth = [1e3 * np.column_stack([one.points[:, 0], one.height(one.points[:, 0])])
              for one in (pair.left.wheel, pair.left.rail) if one.points is not None]  # fmt: skip
    assert found == pytest.approx(brute_force_conicity(smooth[0], smooth[1] + beside, amplitude), rel=0.01)
    # Through the points themselves: joints of the rail's arcs are rounded.
    assert found == pytest.approx(brute_force_conicity(wheel, RAIL + beside, amplitude), abs=SMOOTHED)


def numbers_of(pair: Sides) -> np.ndarray:
    """Return places, radii and angles of the contacts at three shifts, and the conicity."""
    rows = [contact_at(pair, shift) for shift in (-5e-3, 0.0, 2e-3)]
    contacts = [value for one in rows for value in (*one.radius, *one.angle, one.roll)]
    return np.array([*contacts, *equivalent_conicity(pair, np.array([3e-3]), rolls=False, points=20)])


def test_mirrored_shifted_and_turned_copies_are_one_pair(tmp_path: Path) -> None:
    """Copies carry the header that undoes the change, or their gauge side and back of flange place them."""
    back = np.column_stack([np.full(30, WHEEL[0, 0]), np.linspace(0.0, WHEEL[0, 1], 30, endpoint=False)])
    wheel = np.concatenate([back, WHEEL])
    angle, shift = 0.02, np.array([12.5, -7.25])
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    keys = f"shift.y = {-shift[0]}\nshift.z = {-shift[1]}\nrotate = {angle}\nmirror.y = 1"
    expected = numbers_of(bb.pair(simpack(tmp_path / "w.prw", wheel), simpack(tmp_path / "r.prr", RAIL), gauge=1.435))
    for name, change, header in (
        ("mirrored", lambda points: points * [-1, 1], ""),
        ("shifted", lambda points: points + shift, ""),
        ("below", lambda points: points[::-1] * [1, -1], ""),
        ("turned", lambda points: points * [-1, 1] @ turn + shift, keys),
    ):
        files = [
            simpack(tmp_path / f"{name}{ending}", change(points), header)
            for ending, points in ((".prw", wheel), (".prr", RAIL))
        ]
        copy = bb.pair(*files, gauge=1.435)
        assert numbers_of(copy) == pytest.approx(expected, abs=1e-6, rel=1e-6), name


def test_every_decision_is_a_note(tmp_path: Path) -> None:
    wheel, rail = simpack(tmp_path / "w.prw", WHEEL), simpack(tmp_path / "r.prr", RAIL)
    notes = bb.pair(wheel, rail).notes
    assert [note.split(": ")[-1].split(",")[0] for note in notes] == [
        "y- (its flange lies there)",
        "y = 0 of the file",
        "y- (it leans 1:20 to there)",
        "1:20",
        "1435.20 mm",
        "1360 mm",
        "460 mm",
    ]
    told = " ".join(bb.pair(wheel, rail, gauge=1.437, radius=(0.46, 0.459), flange_back=1.358).notes)
    assert "left radius at the tape circle: 460 mm, given; right 459 mm, given" in told
    assert "flange back: 1358 mm, given" in told
    assert "gauge: 1437 mm, given" in told


@pytest.mark.parametrize(("off", "gauge"), [(0.0, 1.4352), (0.3, 1.435), (-0.34, 1.434516), (-0.36, 1.435)])
def test_rails_keep_the_standard_distance_if_it_gives_the_usual_gauge(off: float, gauge: float, tmp_path: Path) -> None:
    """The y = 0 of both rails are 1500 mm apart, unless this is off 1435 mm by more than 0.5 mm; in every format."""
    wheel, points = simpack(tmp_path / "w.prw", WHEEL), RAIL + np.array([off, 0.0])
    np.savetxt(table := tmp_path / "r.csv", points, delimiter=",")
    for path in (table, simpack(tmp_path / "r.prr", points)):
        found = bb.pair(wheel, path)
        assert gauge_of(found) == pytest.approx(gauge, abs=1e-5)
        kept = found.left.rail_half_distance == 0.75
        assert kept == (gauge != 1.435)
        assert ("apart (EN 15302)" in " ".join(found.notes)) == kept


def test_unequal_sides_differ_and_equal_ones_are_a_pair(tmp_path: Path) -> None:
    wheel, rail = simpack(tmp_path / "w.prw", WHEEL), simpack(tmp_path / "r.prr", RAIL)
    worn = simpack(tmp_path / "worn.prw", WHEEL - [0.0, 0.1] * (np.abs(WHEEL[:, :1]) < 20.0))
    assert isinstance(bb.pair(wheel, [rail, rail]), Pair)
    found = bb.pair([wheel, worn], rail)
    assert found.left.wheel != found.right.wheel
    assert found.left.rail is found.right.rail
    assert any(note.startswith("right wheel worn.prw: ") for note in found.notes)


@pytest.mark.parametrize(
    ("more", "sentence"),
    [
        ({"gauge": 1435.0}, "gauge must be from 0.5 to 2 m; got 1435 m. Give metres."),
        ({"radius": 460}, "radius must be from 0.1 to 1 m; got 460 m"),
        ({"inclination": 40}, "inclination must be from 0 to 0.2; got 40. Give a slope"),
        ({"gauge": 1.4}, "the left wheel stands on its flange, y = -"),
        ({"radius": (0.4, 0.4, 0.4)}, "radius must be one or two numbers"),
        ({"gauge": "1.435"}, "gauge must be a number or None; got 1.435"),
        ({"radius": True}, "radius must be a number or None; got true"),
        ({"rail": None}, "rail must be a profile, a path, or two of them; got null"),
    ],
)
def test_numbers_that_fit_no_pair_get_one_sentence(more: dict[str, Any], sentence: str, tmp_path: Path) -> None:
    wheel, rail = simpack(tmp_path / "w.prw", WHEEL), simpack(tmp_path / "r.prr", RAIL)
    with pytest.raises(BadInputError) as told:
        bb.pair(**{"wheel": wheel, "rail": rail, **more})
    assert sentence in str(told.value)
    assert "\n" not in str(told.value)


def test_origin_of_a_wheel_that_is_neither_tape_circle_nor_back_must_be_given(tmp_path: Path) -> None:
    """The contour ends before the back of its flange; y = 0 of the file lies 20 mm off the tape circle."""
    path = simpack(tmp_path / "w.prw", WHEEL + np.array([20.0, 0.0]))
    with pytest.raises(BadInputError, match=r"the flange's flank lies at y = -1\d\.\d+ mm. Give the tape circle's y"):
        profile(path)
    given = profile(path, tape_circle=0.020)
    assert given.height(np.array(0.0)) == pytest.approx(float(profile(simpack(path, WHEEL)).height(np.array(0.0))))


def test_rail_of_another_origin_lies_about_its_head(tmp_path: Path) -> None:
    wheel = simpack(tmp_path / "w.prw", WHEEL)
    rails = [simpack(tmp_path / f"{at}.prr", RAIL + np.array([at, 0.0])) for at in (0.0, 140.0)]
    near, far = (bb.pair(wheel, rail, gauge=1.435) for rail in rails)
    assert far.left.rail.height(np.array(0.0)) > -1e-3
    assert "y = 0: moved by 143.25 mm to the middle of the head" in " ".join(far.notes)
    assert numbers_of(far) == pytest.approx(numbers_of(near), abs=1e-6, rel=1e-6)


def test_spline_does_not_ring_beside_the_wall_of_a_rail() -> None:
    """A head R13 at its corner with vertical sides: within 5 um up to 70 degrees, square to the contour."""
    angle = np.radians(np.arange(0.0, 90.0, 0.5))
    corner = np.column_stack([25.0 + 13.0 * np.sin(angle), 13.0 * np.cos(angle) - 13.0])
    side = corner[-1] + np.arange(0.2, 25.0, 0.2)[:, None] * [1e-4, -1.0]
    half = np.concatenate([np.column_stack([np.arange(0.0, 24.9, 0.2), np.zeros(125)]), corner, side])
    points = np.concatenate([half[:0:-1] * [-1, 1], half]) / 1e3
    y = 25e-3 + 13e-3 * np.sin(np.radians(np.arange(5.0, 70.0)))
    slope = np.radians(np.arange(5.0, 70.0))
    off = [
        np.abs(from_points("head", "R13", *points.T, measured=one).height(y) - (13e-3 * np.cos(slope) - 13e-3))
        * np.cos(slope)
        for one in (True, False)
    ]
    assert off[0].max() < 5e-6
    assert off[1].max() > 10 * off[0].max()


@pytest.mark.skipif(not STRANGERS.is_dir(), reason="PROFILES_OF_OTHERS names no folder of their files")
def test_pair_of_the_manchester_benchmark_is_s1002_on_uic_60() -> None:
    found = bb.pair(STRANGERS / "MBench_S1002_v3.prw", STRANGERS / "MBench_UIC60_v3.prr")
    same = bb.pair(STRANGERS / "MBench_S1002_v3.prw", STRANGERS / "MBench_UIC60_v3.ban")
    conicity = [equivalent_conicity(one, np.array([3e-3]), rolls=False)[0] for one in (found, same)]
    assert conicity[0] == pytest.approx(0.1805, abs=5e-4)
    assert conicity[1] == pytest.approx(conicity[0], rel=1e-6)

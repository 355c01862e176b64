"""Kalker's exact theory against published rows and its own limits, and the laws that are made or chosen by it."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from fmu_src.chain import Chain
from rbd_model.contact.creep.exact import exact, half_space
from rbd_model.contact.creep.exact_table import exact_law, shipped
from rbd_model.contact.creep.fastrip import fastrip
from rbd_model.contact.creep.fastsim import fastsim
from rbd_model.contact.creep.kalker import kalker_coefficients, smooth_kalker_coefficients
from rbd_model.contact.creep.law import CreepLaw
from rbd_model.contact.creep.tabulated import axes, patch_at
from scenarios.contact.creep_laws import exact as published
from scenarios.measuring.creep_cost import SHEAR_MODULUS, symbols, values, with_coefficients
from scenarios.measuring.creep_cost import forces as law_at
from scenarios.measuring.exact_states import LARGEST, counts, distance, linear_forces, points_of, random_states, read

#: The published rows on two grids.
ROWS = Path(__file__).parents[1] / "data" / "creep" / "exact.csv"
#: Cells of the oracle in tests, along and across.
COARSE = (16, 16)
#: Of the published rows [% of mu N]: their own grids of 61 and 41 differ by up to 0.5.
PUBLISHED, PUBLISHED_MEDIAN = 0.7, 0.25
#: Two of them, with the place that does not slide inside the patch: there equal elements, with slip taken in their
#: middles and behind them, and these cells all come to -0.222 mu N, where the published row has -0.213.
POLE, POLE_ROWS = 1.2, 2
#: Cells along and across, and elements of the published rows, whose forces are extrapolated by their second order: from
#: 16 over 24 to 32 cells differences fall by 2.6, where order 2 has 2.9 and order 1 has 2.
FINER, ELEMENTS = (20, 32), (41, 61)
#: What then is left [% of mu N], of all but the two; of those 0.76 and 0.97, as with any cells.
EXTRAPOLATED, EXTRAPOLATED_POLE = 0.5, 1.0
#: Kalker (1990), table E.3, has three digits and was computed with his coarse grids; these cells' error is as large.
TABLE_E3 = 0.012
#: What goes on behind its end, where these cells come to 1.5 % more, 2.0 % with spin; finer ones to 1.4 and 0.4 %. Held
#: at 10.5 the coefficients were 35 to 54 % short at 20, and 51 to 72 % at 30.
BEYOND_TABLE = 0.022


def scaled(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """a/b, and creepages and spin as the oracle has them, of points as `creep_cost` has them."""
    x, y, spin, load, friction, a, b = points.T
    stiffness = SHEAR_MODULUS * a * b / (load * friction)
    return a / b, np.column_stack([x * stiffness, y * stiffness, spin * stiffness * np.sqrt(a * b)])


def interpreted(law: CreepLaw, points: np.ndarray) -> np.ndarray:
    """As `creep_cost.values`, by CasADi: what is asked a few times is not worth a compiler."""
    point = symbols()
    function = ca.Function("law", [point], [law_at(law, point, Chain())])
    return np.array(function.map(len(points))(with_coefficients(points).T)).T


def oracle(points: np.ndarray, count: int) -> np.ndarray:
    """Exact forces over mu N of points as `creep_cost` has them, with count x count cells."""
    places = zip(*scaled(points), strict=True)
    return np.array([exact(half_space(float(ratio), (count, count)), given).forces for ratio, given in places])


def extrapolated(coarse: np.ndarray, fine: np.ndarray, counts: tuple[int, int]) -> np.ndarray:
    """To no width of cells, with an error of second order in it."""
    return np.asarray(fine + (fine - coarse) / ((counts[1] / counts[0]) ** 2 - 1))


@pytest.mark.parametrize("step", [4, pytest.param(1, marks=pytest.mark.long)])
def test_exact_theory_gives_the_published_forces(step: int) -> None:
    """All rows, or every fourth, among which one of POLE_ROWS is."""
    points, forces, _ = (one[step - 1 :: step] for one in published())
    off = 100 * np.hypot(*(oracle(points, COARSE[0]).T - forces.T / (points[:, 3] * points[:, 4])))
    off.sort()
    assert np.median(off) < PUBLISHED_MEDIAN
    assert off[-1 - POLE_ROWS] < PUBLISHED
    assert off[-1] < POLE


@pytest.mark.long
def test_exact_theory_and_published_forces_have_the_same_limit_of_fine_cells() -> None:
    points, forces, _ = published()
    table = list(csv.DictReader(ROWS.read_text(encoding="utf-8").splitlines()))
    coarse = np.array([[float(row["coarse_x_N"]), float(row["coarse_y_N"])] for row in table])
    theirs = extrapolated(coarse, forces, ELEMENTS).T / (points[:, 3] * points[:, 4])
    ours = extrapolated(oracle(points, FINER[0]), oracle(points, FINER[1]), FINER).T
    off = 100 * np.hypot(*(ours - theirs))
    off.sort()
    assert off[-1 - POLE_ROWS] < EXTRAPOLATED
    assert off[-1] < EXTRAPOLATED_POLE


@pytest.mark.parametrize(
    ("ratio", "nu"), [(0.1, 0.25), (0.3, 0.25), (1.0, 0.25), (1 / 0.3, 0.25), (10.0, 0.25), (0.3, 0.28), (10.0, 0.28)]
)
def test_small_creepages_give_kalkers_coefficients(ratio: float, nu: float) -> None:
    """Of his table, and of steel between its columns."""
    table = kalker_coefficients(ca.SX(ratio), nu)
    space = half_space(ratio, COARSE, nu)
    slopes = np.array([exact(space, 1e-5 * one).forces / 1e-5 for one in np.eye(3)])
    assert -slopes[0, 0] == pytest.approx(float(table.c11), rel=TABLE_E3)
    assert -slopes[1, 1] == pytest.approx(float(table.c22), rel=TABLE_E3)
    assert -slopes[2, 1] == pytest.approx(float(table.c23), rel=TABLE_E3)


@pytest.mark.parametrize("ratio", [15.0, 20.0, 30.0])
def test_small_creepages_on_the_long_ellipses_of_flanges_give_what_a_moving_contact_takes(ratio: float) -> None:
    used, space = smooth_kalker_coefficients(ca.SX(math.log(ratio))), half_space(ratio, COARSE)
    slopes = np.array([exact(space, 1e-5 * one).forces / 1e-5 for one in np.eye(3)])
    for found, of in ((slopes[0, 0], used.c11), (slopes[1, 1], used.c22), (slopes[2, 1], used.c23)):
        assert -found == pytest.approx(float(of), rel=BEYOND_TABLE)


def test_mirror_images_roll_as_the_patch_and_large_creepage_slides_with_all_of_friction() -> None:
    space = half_space(1.5, (8, 8))
    given = np.array([0.2, -0.15, 0.3])
    found = exact(space, given).forces
    for signs, of in (((-1, 1, 1), (-1, 1)), ((1, -1, -1), (1, -1)), ((-1, -1, -1), (-1, -1))):
        assert exact(space, given * signs).forces == pytest.approx(found * of, abs=1e-9)
    assert exact(space, np.array([30.0, 40.0, 0.0])).forces == pytest.approx([-0.6, -0.8], abs=1e-3)


def test_stress_obeys_coulomb_and_sliding_takes_energy_in_every_cell() -> None:
    space = half_space(0.7, (10, 10))
    given = np.array([0.1, 0.15, -0.2])
    found = exact(space, given)
    stress = found.stress.reshape(2, -1)
    assert 0 < found.sticks.sum() < found.sticks.size
    assert np.all(np.hypot(*stress) <= space.cells.bound * (1 + 1e-6))
    rigid = np.array([given[0] - given[2] * space.y, given[1] + given[2] * space.x[1]])
    slip = rigid + (space.sliding @ found.stress).reshape(2, -1)
    assert np.all((slip * stress).sum(axis=0)[~found.sticks] <= 1e-9)


def test_stored_states_are_those_of_the_maker() -> None:
    """Of 1000 three, with the maker's cells; a wide patch among them."""
    states, forces = read()
    assert random_states() == pytest.approx(states, rel=1e-5)
    for number in (1, 3, 900):
        ratio = float(states[number, 0])
        found = exact(half_space(ratio, counts(ratio)), states[number, 1:]).forces
        assert found == pytest.approx(forces[number], abs=1e-4)


#: At the random states [% of mu N], mean and 99 %: all of them; those at which all creepages together ask for three
#: times mu N at most. Measured: FASTSIM 6.1 and 17.5, together 5.5 and 17.0, with 48 cells 6.2 and 17.3; FaStrip 3.8
#: and 10.8, together 3.3 and 10.2, with 32 cells 3.2 and 10.0: these theories come no nearer. As published, with 21
#: rows of equal elements, FASTSIM is 4.9 and 16.0 off, FaStrip 6.3 and 18.6.
AT_RANDOM: dict[str, tuple[CreepLaw, tuple[float, float], tuple[float, float]]] = {
    "FASTSIM 14 x 14": (fastsim(14), (6.6, 18.0), (6.0, 17.5)),
    "FaStrip 12 x 12": (fastrip(12), (4.1, 11.3), (3.6, 10.6)),
    "table of exact theory": (exact_law, (0.7, 3.0), (0.6, 3.0)),
}


@pytest.mark.parametrize("name", AT_RANDOM)
def test_distance_at_random_states_is_what_is_told(name: str) -> None:
    law, *bands = AT_RANDOM[name]
    for together, (mean, most) in zip((False, True), bands, strict=True):
        found = distance(law, together)
        assert found.mean < mean
        assert found.most < most


def test_half_of_the_random_states_ask_for_three_times_friction_together() -> None:
    """A ball in a cube, pi/6 of it."""
    share = np.mean(linear_forces(read()[0]) <= LARGEST)
    assert share == pytest.approx(math.pi / 6, abs=0.05)


def test_table_of_exact_theory_is_near_the_published_rows() -> None:
    """Within 3 % of mu N at all of them; the best law that marches is 4 off."""
    points, forces, _ = published()
    off = 100 * np.hypot(*(values(exact_law, points) - forces).T) / (points[:, 3] * points[:, 4])
    assert off.max() < 3.0


#: Of the table of exact theory beyond three times saturation, where spin rules [% of mu N]; within it: AT_RANDOM.
BEYOND = 5.0
#: a/b, creepages and spin as the oracle has them, and its cells: the worst of 80 random states whose spin is 3 to 40
#: times what saturates, with creepages of up to 5 times, and one more.
FAR = (
    (7.19813915, -0.17696619, 0.22721403, -1.22918056, (30, 14)),
    (1.15989114, -0.21905782, 0.13989235, -5.8824251, (16, 20)),
)


def test_table_of_exact_theory_is_farther_off_where_spin_is_beyond_three_times_saturation() -> None:
    states = np.array([one[:4] for one in FAR])
    assert np.all(linear_forces(states) > 2 * LARGEST)
    true = np.array([exact(half_space(ratio, cells), np.array(given)).forces for ratio, *given, cells in FAR])
    points = points_of(states)
    off = 100 * np.hypot(*(values(exact_law, points) / (points[:, 3] * points[:, 4])[:, None] - true).T)
    assert off.max() < BEYOND
    assert off.max() > AT_RANDOM["table of exact theory"][2][1]  # more than within it


@pytest.mark.parametrize("index", [(4, 10, 6, 5), (4, 10, 9, 2)])
def test_table_that_ships_holds_what_its_maker_computes(index: tuple[int, int, int, int]) -> None:
    """At two places, one of a wide ellipse; with other cells, which are within 1 % of mu N there."""
    places = [one[number] for one, number in zip(axes(), index, strict=True)]
    place = ca.SX.sym("place", 4)
    given = np.array(ca.Function("at", [place], [ca.vertcat(*patch_at(place).creepages)])(places)).ravel()
    ratio = math.exp(places[3])
    assert shipped().forces[index] == pytest.approx(exact(half_space(ratio, counts(ratio)), given).forces, abs=0.01)


#: At an ellipse of 8 x 4 mm, lateral creepage -0.001, spin 1/m [% of mu N]: its author's program is 1.6 off.
NAMED = 2.5


def test_fastrip_follows_strong_spin_where_enough_cells_follow_its_slip() -> None:
    """Slip turns along a strip: 8 cells are 2.7 % off, 16 2.1, FASTSIM with 20 6.4."""
    point = np.array([[0.0, -0.001, 1.0, 80e3, 0.3, 8e-3, 4e-3]])
    ratio, given = scaled(point)
    truth = exact(half_space(float(ratio[0]), (24, 24)), given[0]).forces
    off = [100 * np.hypot(*(interpreted(law, point)[0] / 24e3 - truth)) for law in (fastrip(16), fastsim(20))]
    assert off[0] < NAMED
    assert off[1] > 2 * NAMED  # FASTSIM fails there, so that the test can


def test_points_of_states_are_as_the_oracle_has_them() -> None:
    states = read()[0][:50]
    ratio, given = scaled(points_of(states))
    assert np.column_stack([ratio, given]) == pytest.approx(states, rel=1e-9)

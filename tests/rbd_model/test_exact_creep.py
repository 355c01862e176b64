"""Compare Kalker's exact theory with published rows and its limits, and the laws derived from it with the theory."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from evidence.contact.creep_laws import exact as published
from evidence.measuring.creep_cost import SHEAR_MODULUS, symbols, values, with_coefficients
from evidence.measuring.creep_cost import forces as law_at
from evidence.measuring.exact_states import (
    BEYOND,
    COUNT,
    EACH,
    LARGEST,
    TOGETHER,
    counts,
    distance,
    distances,
    linear_forces,
    points_of,
    random_states,
    read,
)
from fmu_src.chain import Chain
from rbd_model.contact.creep.exact import exact, half_space
from rbd_model.contact.creep.exact_table import exact_law, shipped
from rbd_model.contact.creep.fastrip import fastrip
from rbd_model.contact.creep.fastsim import fastsim
from rbd_model.contact.creep.kalker import kalker_coefficients, smooth_kalker_coefficients
from rbd_model.contact.creep.kalker_to_coulomb import kalker_to_coulomb
from rbd_model.contact.creep.law import CreepLaw
from rbd_model.contact.creep.polach import polach
from rbd_model.contact.creep.shen_hedrick_elkins import shen_hedrick_elkins
from rbd_model.contact.creep.tabulated import axes, patch_at

#: Published rows on two grids.
ROWS = Path(__file__).parents[1] / "data" / "creep" / "exact.csv"
#: Number of cells of the oracle in tests, along and across.
COARSE = (16, 16)
#: Tolerance of the published rows [% of mu N]: their own grids of 61 and 41 elements differ by up to 0.5.
PUBLISHED, PUBLISHED_MEDIAN = 0.7, 0.25
#: Tolerance of two of these rows, which have a point without sliding inside the patch. There these cells give -0.222 mu
#: N. So do equal elements with slip taken at their middles or trailing edges. The published row has -0.213.
POLE, POLE_ROWS = 1.2, 2
#: Numbers of cells, and of elements of the published rows, from whose forces the limit is extrapolated with second
#: order. The differences fall by 2.6 from 16 by way of 24 to 32 cells; order 2 gives 2.9 and order 1 gives 2.
FINER, ELEMENTS = (20, 32), (41, 61)
#: Extrapolated difference [% of mu N] of all but these two rows; those have 0.76 and 0.97, as with any cells.
EXTRAPOLATED, EXTRAPOLATED_POLE = 0.5, 1.0
#: Kalker (1990), table E.3, has three digits and was computed with his coarse grids; the error of these cells is as
#: large.
TABLE_E3 = 0.012
#: Tolerance of the coefficients extrapolated beyond the table. These cells give 1.5 % more, 2.0 % with spin; finer ones
#: 1.4 and 0.4 %. If the coefficients were constant beyond 10.5, they would be 35 to 54 % too small at 20, and 51 to 72
#: % at 30.
BEYOND_TABLE = 0.022


def scaled(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Convert points from the form of `creep_cost` to that of the oracle: a/b, and creepages and spin."""
    x, y, spin, load, friction, a, b = points.T
    stiffness = SHEAR_MODULUS * a * b / (load * friction)
    return a / b, np.column_stack([x * stiffness, y * stiffness, spin * stiffness * np.sqrt(a * b)])


def interpreted(law: CreepLaw, points: np.ndarray) -> np.ndarray:
    """Evaluate a law like `creep_cost.values`, but interpreted by CasADi: compiling does not pay off for few calls."""
    point = symbols()
    function = ca.Function("law", [point], [law_at(law, point, Chain())])
    return np.array(function.map(len(points))(with_coefficients(points).T)).T


def oracle(points: np.ndarray, count: int) -> np.ndarray:
    """Return exact forces over mu N of points in the form of `creep_cost`, with count x count cells."""
    places = zip(*scaled(points), strict=True)
    return np.array([exact(half_space(float(ratio), (count, count)), given).forces for ratio, given in places])


def extrapolated(coarse: np.ndarray, fine: np.ndarray, counts: tuple[int, int]) -> np.ndarray:
    """Extrapolate to zero cell width, with second order."""
    return np.asarray(fine + (fine - coarse) / ((counts[1] / counts[0]) ** 2 - 1))


@pytest.mark.parametrize("step", [4, pytest.param(1, marks=pytest.mark.long)])
def test_exact_theory_gives_the_published_forces(step: int) -> None:
    """All rows, or every fourth one, which includes one of POLE_ROWS."""
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


@pytest.mark.study
@pytest.mark.parametrize(
    ("ratio", "nu"), [(0.1, 0.25), (0.3, 0.25), (1.0, 0.25), (1 / 0.3, 0.25), (10.0, 0.25), (0.3, 0.28), (10.0, 0.28)]
)
def test_small_creepages_give_kalkers_coefficients(ratio: float, nu: float) -> None:
    """Coefficients of Kalker's table, and of steel, between its columns."""
    table = kalker_coefficients(ca.SX(ratio), nu)
    space = half_space(ratio, COARSE, nu)
    slopes = np.array([exact(space, 1e-5 * one).forces / 1e-5 for one in np.eye(3)])
    assert -slopes[0, 0] == pytest.approx(float(table.c11), rel=TABLE_E3)
    assert -slopes[1, 1] == pytest.approx(float(table.c22), rel=TABLE_E3)
    assert -slopes[2, 1] == pytest.approx(float(table.c23), rel=TABLE_E3)


@pytest.mark.study
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


@pytest.mark.study
def test_stored_states_are_those_of_the_maker() -> None:
    """Check three of 1000 states with the maker's cells; one has a wide patch."""
    states, forces = read()
    assert random_states() == pytest.approx(states, rel=1e-5)
    for number in (1, 3, 900):
        ratio = float(states[number, 0])
        found = exact(half_space(ratio, counts(ratio)), states[number, 1:]).forces
        assert found == pytest.approx(forces[number], abs=1e-4)


#: Limits at random states [% of mu N], mean and 99 %: of all, of those whose linear force is at most three times mu N,
#: and of further ones beyond. Measured, all and limited: FASTSIM 6.1 and 17.5, 5.5 and 17.0, with 48 cells 6.2 and
#: 17.3. FaStrip 3.8 and 10.8, 3.3 and 10.2, with 32 cells 3.2 and 10.0. More cells do not bring these theories closer.
#: The published versions, with 21 rows of equal elements, have 4.9 and 16.0 (FASTSIM), 6.3 and 18.6 (FaStrip).
AT_RANDOM: dict[str, tuple[CreepLaw, dict[str, tuple[float, float]]]] = {
    "FASTSIM 14 x 14": (fastsim(14), {EACH: (6.6, 18.0), TOGETHER: (6.0, 17.5)}),
    "FaStrip 12 x 12": (fastrip(12), {EACH: (4.1, 11.3), TOGETHER: (3.6, 10.6)}),
    "Kalker to Coulomb": (kalker_to_coulomb, {EACH: (4.0, 13.0), TOGETHER: (4.0, 13.0)}),
    "table of exact theory": (exact_law, {EACH: (0.7, 3.0), TOGETHER: (0.6, 3.0), BEYOND: (0.7, 3.0)}),
}


@pytest.mark.study
@pytest.mark.parametrize("name", AT_RANDOM)
def test_distance_at_random_states_is_what_is_told(name: str) -> None:
    law, bands = AT_RANDOM[name]
    for states, (mean, most) in bands.items():
        found = distance(law, states)
        assert found.mean < mean
        assert found.most < most


#: Smallest a/b of the states to half of which the default law is fitted. Mean error, that of 99 % and the largest at
#: the other half [% of mu N]. FaStrip has 10.8 at 99 % of all states, Polach's law 76.
FITTED_FROM, HELD_OUT, HELD_OUT_MOST, HELD_OUT_LARGEST = 0.2, 3.6, 10.4, 11.7


def test_default_law_is_as_near_at_states_to_which_it_is_not_fitted() -> None:
    states = read()[0][:COUNT]
    off, wide = distances(kalker_to_coulomb)[:COUNT], states[:, 0] < FITTED_FROM
    fitted, others = (off[number::2][~wide[number::2]] for number in (0, 1))
    found = (others.mean(), np.quantile(others, 0.99), others.max())
    assert found == pytest.approx((HELD_OUT, HELD_OUT_MOST, HELD_OUT_LARGEST), abs=0.06)
    assert others.mean() == pytest.approx(fitted.mean(), rel=0.15)


def test_half_of_the_random_states_ask_for_three_times_friction_together() -> None:
    """This is the volume of a ball in a cube, pi/6."""
    share = np.mean(linear_forces(read()[0])[:COUNT] <= LARGEST)
    assert share == pytest.approx(math.pi / 6, abs=0.05)


@pytest.mark.study
def test_table_of_exact_theory_is_near_the_published_rows() -> None:
    """Within 3 % of mu N at all rows; the best law that integrates along strips has an error of 4 %."""
    points, forces, _ = published()
    off = 100 * np.hypot(*(values(exact_law, points) - forces).T) / (points[:, 3] * points[:, 4])
    assert off.max() < 3.0


#: Error limit of the table of exact theory beyond three times saturation, as within it [% of mu N]; see AT_RANDOM.
BEYOND = 3.0
#: a/b, creepages and spin in the form of the oracle, and cells. The first two were the worst of states with a spin
#: of 3 to 40 times saturation and creepages of up to 5 times; they had errors of 4 to 5 %. The third, a long ellipse
#: with creepage ahead and spin of 6 to 8 times saturation, had 13 %: creepage ahead was related to its own spin alone.
FAR = (
    (7.19813915, -0.17696619, 0.22721403, -1.22918056, (30, 14)),
    (1.15989114, -0.21905782, 0.13989235, -5.8824251, (16, 20)),
    (17.584352, -0.4797199, -0.04115587, -0.21361822, (36, 8)),
)


@pytest.mark.study
def test_table_of_exact_theory_is_as_near_beyond_three_times_saturation() -> None:
    states = np.array([one[:4] for one in FAR])
    assert np.all(linear_forces(states) > 2 * LARGEST)
    true = np.array([exact(half_space(ratio, cells), np.array(given)).forces for ratio, *given, cells in FAR])
    points = points_of(states)
    off = 100 * np.hypot(*(values(exact_law, points) / (points[:, 3] * points[:, 4])[:, None] - true).T)
    assert off.max() < BEYOND


@pytest.mark.study
@pytest.mark.parametrize("index", [(4, 10, 6, 5), (4, 10, 9, 2)])
def test_table_that_ships_holds_what_its_maker_computes(index: tuple[int, int, int, int]) -> None:
    """At two places, one with a wide ellipse. Other cells differ by up to 1 % of mu N there."""
    places = [one[number] for one, number in zip(axes(), index, strict=True)]
    place = ca.SX.sym("place", 4)
    given = np.array(ca.Function("at", [place], [ca.vertcat(*patch_at(place).creepages)])(places)).ravel()
    ratio = math.exp(places[3])
    assert shipped().forces[index] == pytest.approx(exact(half_space(ratio, counts(ratio)), given).forces, abs=0.01)


#: Error limit at an ellipse of 8 x 4 mm, lateral creepage -0.001, spin 1/m [% of mu N]. The author's program has 1.6.
NAMED = 2.5


@pytest.mark.study
def test_fastrip_follows_strong_spin_where_enough_cells_follow_its_slip() -> None:
    """Slip turns along a strip: the error is 2.7 % with 8 cells, 2.1 % with 16, and 6.4 % for FASTSIM with 20."""
    point = np.array([[0.0, -0.001, 1.0, 80e3, 0.3, 8e-3, 4e-3]])
    ratio, given = scaled(point)
    truth = exact(half_space(float(ratio[0]), (24, 24)), given[0]).forces
    off = [100 * np.hypot(*(interpreted(law, point)[0] / 24e3 - truth)) for law in (fastrip(16), fastsim(20))]
    assert off[0] < NAMED
    assert off[1] > 2 * NAMED  # FASTSIM fails there, so the test can detect a fault


#: Tolerance of the slopes of the default law at zero creepage with the spin of treads, over Kalker's: ahead, aside.
SLOPES = (0.1, 0.05)


@pytest.mark.study
@pytest.mark.parametrize(("ratio", "turning"), [(0.7, 0.1), (0.7, 0.2), (1.5, 0.1), (1.5, 0.2)])
def test_default_law_has_the_slopes_of_exact_theory_about_steady_spin(ratio: float, turning: float) -> None:
    """Eigenvalues of a vehicle depend on them; turning: linear force of the spin over mu N."""
    state = np.array([[ratio, 0.0, 0.0, 1.0]])
    coefficients = with_coefficients(points_of(state))[0, 7:]
    steps = np.repeat(0.02 * np.eye(2, 3), 2, axis=0) * [[1], [-1], [1], [-1]] + [0.0, 0.0, turning]
    states = np.column_stack([np.full(4, ratio), steps / coefficients])
    truth = np.array([exact(half_space(ratio, COARSE), row[1:]).forces for row in states])
    points = points_of(states)
    found = values(kalker_to_coulomb, points) / (points[:, 3] * points[:, 4])[:, None]
    for axis, limit in enumerate(SLOPES):
        slope, true = ((one[2 * axis, axis] - one[2 * axis + 1, axis]) / 0.04 for one in (found, truth))
        assert slope == pytest.approx(true, abs=limit)


#: Creepages, spin [1/m], load [N], friction and semi-axes [m] of a flange. Error limit of the default law [% of mu N];
#: that of Shen, Hedrick and Elkins is 30 % off.
FLANGE, FLANGE_ERROR = (0.01, 0.005, 1.85, 14e3, 0.3, 6.52e-3, 0.383e-3), 5.0


@pytest.mark.study
def test_flange_slides_against_its_mean_sliding_although_it_spins() -> None:
    point = np.array([FLANGE])
    ratio, given = scaled(point)
    truth = exact(half_space(float(ratio[0]), (36, 8)), given[0]).forces
    laws = (kalker_to_coulomb, shen_hedrick_elkins)
    off = [100 * np.hypot(*(interpreted(law, point)[0] / (0.3 * 14e3) - truth)) for law in laws]
    assert off[0] < FLANGE_ERROR
    assert off[1] > 5 * FLANGE_ERROR


#: Limit of the default law ahead and sideways on the Manchester contact benchmark, at frictions of 0.1 to 0.5, and its
#: largest errors [% of mu N].
BOTH_WAYS, MANCHESTER_AHEAD, MANCHESTER_ASIDE = 5.0, 3.2, 4.3


@pytest.mark.study
def test_default_law_is_near_at_every_half_millimetre_of_the_manchester_benchmark_at_any_friction() -> None:
    """Patches of model 2 by their ellipses, loads and creepages. Some of them have spin of 60 times saturation."""
    rows = list(csv.DictReader((ROWS.parent / "manchester.csv").read_text(encoding="utf-8").splitlines()))
    table = np.array([[float(value) for name, value in row.items() if name != "wheel"] for row in rows])[:, 1:]
    points, truth = table[:, :7] * (1, 1, 1, 1, 1, 1e-3, 1e-3), table[:, 7:]
    off = [
        100 * np.abs(values(law, points) / (points[:, 3] * points[:, 4])[:, None] - truth)
        for law in (kalker_to_coulomb, polach)
    ]
    assert off[0].max() < BOTH_WAYS < off[1].max() / 4
    assert off[0].max(axis=0) == pytest.approx((MANCHESTER_AHEAD, MANCHESTER_ASIDE), abs=0.06)
    ratio, given = scaled(points[:3])
    found = [exact(half_space(float(one), counts(one)), each).forces for one, each in zip(ratio, given, strict=True)]
    assert np.array(found) == pytest.approx(truth[:3], abs=1e-4)


def test_points_of_states_are_as_the_oracle_has_them() -> None:
    states = read()[0][:50]
    ratio, given = scaled(points_of(states))
    assert np.column_stack([ratio, given]) == pytest.approx(states, rel=1e-9)

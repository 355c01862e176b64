"""Kalker's exact theory against published rows and its own limits, and the laws that are made or chosen by it."""

from __future__ import annotations

import math

import casadi as ca
import numpy as np
import pytest

from fmu_src.chain import Chain
from rbd_model.contact.creep.exact import exact, half_space
from rbd_model.contact.creep.exact_table import exact_law, shipped
from rbd_model.contact.creep.fastrip import fastrip
from rbd_model.contact.creep.fastsim import fastsim
from rbd_model.contact.creep.kalker import kalker_coefficients
from rbd_model.contact.creep.law import CreepLaw
from rbd_model.contact.creep.tabulated import axes, patch_at
from scenarios.contact.creep_laws import exact as published
from scenarios.methods.creep_cost import SHEAR_MODULUS, symbols, values, with_coefficients
from scenarios.methods.creep_cost import forces as law_at
from scenarios.methods.exact_states import CELLS, distance, points_of, random_states, read

#: Cells of the oracle in tests, along and across.
COARSE = (16, 16)
#: Of the published rows [% of mu N]: their own grids of 61 and 41 differ by up to 0.5.
PUBLISHED, PUBLISHED_MEDIAN = 0.7, 0.25
#: Two of them, with the place that does not slide inside the patch: there equal elements, with slip taken in their
#: middles and behind them, and these cells all come to -0.222 mu N, where the published row has -0.213.
POLE, POLE_ROWS = 1.2, 2
#: Kalker (1990), table E.3, has three digits and was computed with his coarse grids; these cells' error is as large.
TABLE_E3 = 0.012


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


@pytest.mark.parametrize("step", [4, pytest.param(1, marks=pytest.mark.long)])
def test_exact_theory_gives_the_published_forces(step: int) -> None:
    """All rows, or every fourth, among which one of POLE_ROWS is."""
    points, forces, _ = (one[step - 1 :: step] for one in published())
    off = []
    for point, force, ratio, given in zip(points, forces, *scaled(points), strict=True):
        found = exact(half_space(float(ratio), COARSE), given).forces
        off.append(100 * np.hypot(*(found - force / (point[3] * point[4]))))
    off.sort()
    assert np.median(off) < PUBLISHED_MEDIAN
    assert off[-1 - POLE_ROWS] < PUBLISHED
    assert off[-1] < POLE


@pytest.mark.parametrize("ratio", [0.1, 0.3, 1.0, 1 / 0.3, 10.0])
def test_small_creepages_give_kalkers_coefficients(ratio: float) -> None:
    table = kalker_coefficients(ca.SX(ratio))
    space = half_space(ratio, COARSE)
    slopes = np.array([exact(space, 1e-5 * one).forces / 1e-5 for one in np.eye(3)])
    assert -slopes[0, 0] == pytest.approx(float(table.c11), rel=TABLE_E3)
    assert -slopes[1, 1] == pytest.approx(float(table.c22), rel=TABLE_E3)
    assert -slopes[2, 1] == pytest.approx(float(table.c23), rel=TABLE_E3)


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
    """Of 1000 three, with the maker's cells."""
    states, forces = read()
    assert random_states() == pytest.approx(states, rel=1e-5)
    for number in (3, 400, 900):
        found = exact(half_space(float(states[number, 0]), CELLS), states[number, 1:]).forces
        assert found == pytest.approx(forces[number], abs=1e-4)


#: At the random states for reporting, to which nothing was fitted [% of mu N]: mean and 99 %. What is asked, 8.5 of the
#: laws that march and 3 of the table, no law keeps at all of them; measured 5.1 and 14.1, of the table 0.8 and 3.7.
AT_RANDOM: dict[str, tuple[CreepLaw, float, float]] = {
    "FaStrip 12 x 12": (fastrip(12), 5.5, 14.5),
    "table of exact theory": (exact_law, 0.9, 4.0),
}


@pytest.mark.parametrize("name", AT_RANDOM)
def test_distance_at_random_states_is_what_is_told(name: str) -> None:
    law, mean, most = AT_RANDOM[name]
    found = distance(law)
    assert found.mean < mean
    assert found.most < most


def test_table_of_exact_theory_is_near_the_published_rows() -> None:
    """Within 3 % of mu N at all of them; the best law that marches is 4 off."""
    points, forces, _ = published()
    off = 100 * np.hypot(*(values(exact_law, points) - forces).T) / (points[:, 3] * points[:, 4])
    assert off.max() < 3.0


def test_table_that_ships_holds_what_its_maker_computes() -> None:
    """At one place; with other cells, which are within 2 % of mu N there."""
    places = [one[index] for one, index in zip(axes(), (3, 8, 5, 4), strict=True)]
    place = ca.SX.sym("place", 4)
    given = np.array(ca.Function("at", [place], [ca.vertcat(*patch_at(place).creepages)])(places)).ravel()
    found = exact(half_space(math.exp(places[3]), COARSE), given).forces
    assert shipped().forces[3, 8, 5, 4] == pytest.approx(found, abs=0.02)


#: At an ellipse of 8 x 4 mm, lateral creepage -0.001, spin 1/m [% of mu N]: its author's program is 1.6 off, this 2.1.
NAMED = 2.5


def test_fastrip_follows_strong_spin_where_enough_cells_follow_its_slip() -> None:
    """Slip turns along a strip, by more than 8 cells follow: they are 8 % off, FASTSIM with 20 is 11."""
    point = np.array([[0.0, -0.001, 1.0, 80e3, 0.3, 8e-3, 4e-3]])
    ratio, given = scaled(point)
    truth = exact(half_space(float(ratio[0]), CELLS), given[0]).forces
    off = [100 * np.hypot(*(interpreted(law, point)[0] / 24e3 - truth)) for law in (fastrip(16), fastsim(20))]
    assert off[0] < NAMED
    assert off[1] > 2 * NAMED  # FASTSIM fails there, so that the test can


def test_points_of_states_are_as_the_oracle_has_them() -> None:
    states = read()[0][:50]
    ratio, given = scaled(points_of(states))
    assert np.column_stack([ratio, given]) == pytest.approx(states, rel=1e-9)

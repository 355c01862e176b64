"""Test every creep law: theoretical properties, derivatives, and distance from Kalker's exact theory."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Sequence
from functools import lru_cache
from itertools import pairwise
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq, least_squares
from scipy.special import ellipe, ellipk

from rbd_model.contact.creep.fastrip import fastrip
from rbd_model.contact.creep.fastsim import fastsim
from rbd_model.contact.creep.johnson_vermeulen import johnson_vermeulen
from rbd_model.contact.creep.kalker import Kalker, kalker_coefficients
from rbd_model.contact.creep.kalker_linear import kalker_linear
from rbd_model.contact.creep.kalker_to_coulomb import kalker_to_coulomb
from rbd_model.contact.creep.law import CLEAN, ContactPatch, CreepLaw, Reduction
from rbd_model.contact.creep.modified_fastsim import SlopeReduction, modified_fastsim
from rbd_model.contact.creep.polach import polach
from rbd_model.contact.creep.polach_2005 import polach_2005
from rbd_model.contact.creep.shen_hedrick_elkins import shen_hedrick_elkins
from rbd_model.contact.creep.strip_theory import strip_theory
from rbd_model.contact.hertz import POISSON_RATIO
from scenarios.benchmark.case_file import CASES, read_case

STEEL = 82e9
DATA = Path(__file__).parents[1] / "data" / "creep"
#: Laws with Kalker's limits for small creepages, and those that saturate. Few cells suffice, because the tested
#: properties hold for any number.
KALKERS: dict[str, CreepLaw] = {
    "kalker_linear": kalker_linear,
    "shen_hedrick_elkins": shen_hedrick_elkins,
    "kalker_to_coulomb": kalker_to_coulomb,
    "polach": polach,
    "polach_2005": polach_2005,
    "fastsim": fastsim(6),
    "modified_fastsim": modified_fastsim(5, SlopeReduction(1.0, 1.0, 0.0)),
    "fastrip": fastrip(4),
    "strip_theory": strip_theory(4),
}
SATURATING = {name: law for name, law in KALKERS.items() if name != "kalker_linear"} | {
    "johnson_vermeulen": johnson_vermeulen
}
ALL = {"kalker_linear": kalker_linear} | SATURATING
#: Largest error of friction times load at a creepage of 1. Polach's arc tangent has this one, with the cube of the
#: gradient. A law whose formula saturates more slowly has its own here, by its name.
SATURATED, SLOWER = 1e-6, dict[str, float]()
#: Order of the values of a point: creepages, spin [1/m], load [N], friction, semi-axes [m].
POINT = (0.0, 0.0, 0.0, 80e3, 0.3, 6e-3, 5e-3)
ROUND_OFF = 1e-9


def patch_of(point: ca.SX, kalker: Kalker | None = None) -> ContactPatch:
    """Return the contact patch of a point; Kalker's coefficients come from his table unless they are given."""
    axes = (point[5], point[6])
    kalker = kalker or kalker_coefficients(axes[0] / axes[1])
    return ContactPatch((point[0], point[1], point[2]), point[3], point[4], axes, ca.SX(STEEL), kalker)


@lru_cache
def function(law: CreepLaw, kalker: Kalker | None = None) -> ca.Function:
    point = ca.SX.sym("point", 7)
    return ca.Function("law", [point], [ca.vertcat(*law(patch_of(point, kalker)))])


def forces(law: CreepLaw, points: np.ndarray, kalker: Kalker | None = None) -> np.ndarray:
    """Return (F_x, F_y) [N] of each row of points."""
    points = np.atleast_2d(points)
    return np.array(function(law, kalker).map(len(points))(points.T)).T


def at(x: float = 0.0, y: float = 0.0, spin: float = 0.0) -> np.ndarray:
    """Return the standard patch with these creepages."""
    return np.array([x, y, spin, *POINT[3:]])


def random_points(count: int, seed: int = 1) -> np.ndarray:
    """Random patches: creepages to 0.1 and spins to 10/m, of either sign over five decades; ellipses to 1 : 5."""
    generator = np.random.default_rng(seed)
    sizes = 10 ** generator.uniform(-5, 0, (count, 3)) * np.array([0.1, 0.1, 10.0])
    load, friction = generator.uniform(1e3, 150e3, count), generator.uniform(0.02, 0.6, count)
    ratio, mean = np.exp(generator.uniform(-1.6, 1.6, count)), generator.uniform(2e-3, 8e-3, count)
    creepages = sizes * generator.choice([-1.0, 1.0], (count, 3))
    return np.column_stack([creepages, load, friction, mean * np.sqrt(ratio), mean / np.sqrt(ratio)])


# -- limits ---------------------------------------------------------------------------------------------------------

#: Creepages and spin so small that nonlinear terms are below the tolerance after extrapolation with twice their size.
SMALL = np.array([1e-8, 1e-8, 1e-6])
KALKERS_LIMITS = 1e-6


def slopes(law: CreepLaw, a: float, b: float) -> np.ndarray:
    """Return dF/d(creepages) at 0, extrapolated from the quotients at two small creepages.

    The quotients converge linearly in the creepage. Those of FaStrip converge with the square root of the spin. At the
    trailing edge, where one of its strips slips, FASTSIM's stress and that of strip theory differ in direction.
    """
    found = []
    for number, size in enumerate(SMALL):
        points = np.tile([*POINT[:5], a, b], (2, 1))
        points[:, number] = size, 2 * size
        once, twice = forces(law, points)
        root = math.sqrt(2) if law is KALKERS["fastrip"] and number == 2 else 2.0
        found.append((root * once / size - twice / (2 * size)) / (root - 1))
    return np.array(found).T


@pytest.mark.study
@pytest.mark.parametrize("ratio", [0.3, 1.2, 2.6])
@pytest.mark.parametrize("name", KALKERS)
def test_small_creepages_give_kalkers_three_slopes_and_no_others(name: str, ratio: float) -> None:
    """-G a b c11, -G a b c22, -G (a b)^1.5 c23; exact with the flexibilities that a grid of cells requires."""
    b = 5e-3
    a, kalker = ratio * b, kalker_coefficients(ca.SX(ratio))
    c11, c22, c23 = (float(value) for value in (kalker.c11, kalker.c22, kalker.c23))
    expected = -STEEL * a * b * np.array([[c11, 0, 0], [0, c22, math.sqrt(a * b) * c23]])
    found = slopes(KALKERS[name], a, b)
    assert found == pytest.approx(expected, rel=KALKERS_LIMITS, abs=KALKERS_LIMITS * STEEL * a * b * 1e-3)


@pytest.mark.parametrize("ratio", [0.3, 1.0, 2.6])
def test_johnsons_and_vermeulens_slopes_are_those_of_their_elliptic_integrals(ratio: float) -> None:
    """B, C, D by quadrature; for a circle 16/(4 - 3 nu) and 16/(4 - nu), which exceed Kalker's by 16 %."""
    square = 1 - min(ratio, 1 / ratio) ** 2
    nu = POISSON_RATIO
    inverse = [
        quad(
            lambda t, i=i, j=j, n=n: np.cos(t) ** i * np.sin(t) ** j / (1 - square * np.sin(t) ** 2) ** n, 0, np.pi / 2
        )
        for i, j, n in ((2, 0, 0.5), (2, 2, 1.5), (0, 2, 0.5))
    ]
    b, c, d = (value for value, _ in inverse)
    phi, psi = b - nu * (d - c), b - nu * ratio**2 * c
    if ratio > 1:
        phi, psi = (d - nu * (d - c)) / ratio, (d - nu * c) / ratio
    if ratio == 1:
        assert (math.pi / phi, math.pi / psi) == pytest.approx((16 / (4 - 3 * nu), 16 / (4 - nu)), rel=1e-9)
        assert math.pi / phi > 1.15 * float(kalker_coefficients(ca.SX(1.0)).c11)
    area = ratio * 25e-6
    found = slopes(johnson_vermeulen, ratio * 5e-3, 5e-3) / (-STEEL * area)
    assert found[0, 0] == pytest.approx(math.pi / phi, rel=KALKERS_LIMITS)
    assert found[1, 1] == pytest.approx(math.pi / psi, rel=KALKERS_LIMITS)
    assert found[:, 2] == pytest.approx(0.0)  # no spin in this law


@pytest.mark.parametrize("name", SATURATING)
def test_large_creepage_gives_friction_times_load_against_the_sliding(name: str) -> None:
    x, y, error = 0.6, -0.8, SLOWER.get(name, SATURATED)
    found = forces(SATURATING[name], at(x, y), ISOTROPIC)[0] / (0.3 * 80e3)
    if name == "johnson_vermeulen":  # the force has the direction of the law's own linear force
        assert np.hypot(*found) == pytest.approx(1.0, rel=error)
    else:
        assert found == pytest.approx([-x, -y], rel=error)


def test_the_linear_law_does_not_saturate() -> None:
    assert np.hypot(*forces(kalker_linear, at(0.1))[0]) > 10 * 0.3 * 80e3


# -- symmetry -------------------------------------------------------------------------------------------------------

#: A material of equal stiffness in both directions.
ISOTROPIC = Kalker(ca.SX(4.0), ca.SX(4.0), ca.SX(1.5))


@pytest.mark.parametrize("name", [name for name in ALL if name != "johnson_vermeulen"])
def test_a_turned_creepage_turns_the_force_where_both_stiffnesses_are_equal(name: str) -> None:
    """Without spin. The law of Johnson and Vermeulen has stiffnesses of its own, which are not equal."""
    sizes, angles = (grid.ravel() for grid in np.meshgrid(np.geomspace(1e-5, 0.03, 7), np.linspace(0, 6, 9)))
    points = np.array([at(size * np.cos(t), size * np.sin(t)) for size, t in zip(sizes, angles, strict=True)])
    found = forces(ALL[name], points, ISOTROPIC)
    straight = forces(ALL[name], np.array([at(size) for size in sizes]), ISOTROPIC)[:, 0]
    expected = np.column_stack([straight * np.cos(angles), straight * np.sin(angles)])
    assert np.abs(found - expected).max() < ROUND_OFF * np.abs(straight).max()


@pytest.mark.study
@pytest.mark.parametrize("name", ALL)
def test_forces_are_mirrored_with_the_creepages(name: str) -> None:
    """Mirror left to right, and reverse all signs. Theory requires both, and thus also the reversal of the direction of
    travel.
    """
    points = random_points(500)
    scale = (points[:, 3] * points[:, 4])[:, None]
    found = forces(ALL[name], points) / scale
    for signs, mirrored in (((1, -1, -1), (1, -1)), ((-1, -1, -1), (-1, -1))):
        other = forces(ALL[name], points * [*signs, 1, 1, 1, 1]) / scale
        assert other * mirrored == pytest.approx(found, abs=ROUND_OFF, rel=ROUND_OFF)


@pytest.mark.parametrize("name", ALL)
def test_more_creepage_gives_no_less_force_without_spin(name: str) -> None:
    """In every direction of creepage, at constant friction, as theory requires."""
    for angle in np.linspace(0, np.pi / 2, 5):
        size = np.linspace(0, 0.02, 201)
        points = np.array([at(s * np.cos(angle), s * np.sin(angle)) for s in size])
        found = np.hypot(*forces(ALL[name], points).T)
        assert np.diff(found).min() > -ROUND_OFF * found.max()


# -- properties of 1e5 patches --------------------------------------------------------------------------------------


@pytest.mark.study
@pytest.mark.parametrize("name", ALL)
def test_creep_takes_energy_and_never_more_than_friction_allows_on_1e5_patches(name: str) -> None:
    """Every other patch is without spin: there F . sliding <= 0. With spin this includes the moment, which no law
    returns.

    The moment about the normal is at most that of full rotation, 3 pi/16 mu N max(a, b). Creepages may therefore return
    at most the power of this moment. The force is at most mu N.
    """
    points = random_points(100_000)
    points[::2, 2] = 0
    x, y, spin, load, friction, a, b = points.T
    limit = friction * load
    found = forces(ALL[name], points)
    assert np.isfinite(found).all()
    given = found[:, 0] * x + found[:, 1] * y
    assert (given[::2] <= 0).all()
    if name != "kalker_linear":  # this law is not bounded
        most = 3 * np.pi / 16 * limit * np.maximum(a, b) * np.abs(spin)
        assert (given <= most * (1 + ROUND_OFF)).all()
        assert (np.hypot(*found.T) <= limit * (1 + ROUND_OFF)).all()


DEGENERATE = np.array(
    [
        at(),
        at(x=1e-300),
        at(y=-1e-300),
        at(spin=1e-300),
        at(1e-12, 1e-12, 1e-12),
        at(x=1.0),
        at(1.0, 1.0, 1e4),
        at(spin=1e4),
        at(0.0, 6e-3, -1.0),  # spin and lateral creepage cancel at the leading edge
        at(5e-3, 0.0, 1.0),  # spin and longitudinal creepage cancel at the side
        at(0.0, -0.001, 1.052),  # near the limit of strip theory, psi = 1
        [1e-3, 1e-3, 0.1, 1e-3, 0.3, 6e-3, 5e-3],
        [1e-3, 1e-3, 0.1, 80e3, 1e-6, 6e-3, 5e-3],
        [1e-3, 1e-3, 0.1, 80e3, 0.3, 5e-3, 5e-3],
        [1e-3, 1e-3, 0.1, 80e3, 0.3, 1e-4, 1e-2],
        [1e-3, 1e-3, 0.1, 80e3, 0.3, 1e-2, 1e-4],
    ]
)


@pytest.mark.study
@pytest.mark.parametrize("name", ALL)
def test_value_and_derivatives_are_numbers_everywhere(name: str) -> None:
    """Derivatives by all seven: creepages, load, friction, semi-axes; at zero creepage, at kinks of the laws, and at
    random.
    """
    points = np.vstack([DEGENERATE, random_points(300, 2)])
    point = ca.SX.sym("point", 7)
    result = function(ALL[name])(point)
    both = ca.Function("both", [point], [result, ca.jacobian(result, point)])
    for found in both.map(len(points))(points.T):
        assert np.isfinite(np.array(found)).all()


@pytest.mark.study
@pytest.mark.parametrize("name", SATURATING)
def test_forces_change_without_jumps(name: str) -> None:
    """From patch to patch through psi = 1 and full slip: a hundredth of the step changes a force at most a tenth as
    much.

    The bound is a tenth because stresses at the ends of strips grow as square roots. A jump would not decrease.
    """
    ends = np.array([at(0.0, -0.002, 0.2), at(0.0, -0.002, 3.0), at(0.002, 0.001, 3.0), at(0.01, 0.02, -1.0), at()])
    for begin, end in pairwise(ends):
        largest = []
        for count in (20, 2000):
            way = np.linspace(0, 1, count + 1)[:, None]
            found = forces(SATURATING[name], begin + way * (end - begin)) / (0.3 * 80e3)
            largest.append(np.hypot(*np.diff(found, axis=0).T).max())
        assert largest[1] <= 0.1 * largest[0]


#: Tolerance of central differences [1]: round-off to the power 2/3, times ten for the curvature of the laws.
DIFFERENCES = 1e-6


@pytest.mark.parametrize("name", ALL)
def test_derivatives_are_exact(name: str) -> None:
    """Compare with differences over 1e-6 of each input. None of the cells changes its regime within these steps."""
    point = ca.SX.sym("point", 7)
    jacobian = ca.Function("jacobian", [point], [ca.jacobian(function(ALL[name])(point), point)])
    for place in random_points(12, 3):
        exact = np.array(jacobian(place)) * place
        steps = 1e-6 * np.diag(place)
        up, down = forces(ALL[name], place + steps), forces(ALL[name], place - steps)
        numeric = (up - down).T / 2e-6
        assert np.abs(numeric - exact).max() < DIFFERENCES * max(np.abs(exact).max(), 1.0)


# -- FASTSIM: cells -------------------------------------------------------------------------------------------------


def fastsim_without_spin(x: float, y: float) -> np.ndarray:
    """Return FASTSIM's limit, by one integral: a strip has 2 q - q^2 + q^3/6 of 4/3, q its slip over the bound's."""
    load, friction, a, b = POINT[3:]
    kalker = kalker_coefficients(ca.SX(a / b))
    bound = 2 * friction * load / (math.pi * a * b)
    rates = np.array([x * float(kalker.c11), y * float(kalker.c22)]) * 3 * STEEL / 8 / bound
    size = np.hypot(*rates)

    def strip(t: float) -> float:
        q = min(size / np.cos(t), 2.0)
        return float((2 * q - q**2 + q**3 / 6) * np.cos(t) ** 4)

    corner = [math.acos(size / 2)] if size < 2 else []
    total = 2 * quad(strip, 0, math.pi / 2, points=corner, epsabs=1e-12)[0] * 2 / math.pi
    return np.asarray(-friction * load * total * rates / size)


def fastsim_in_numpy(x: float, y: float, spin: float, count: int) -> np.ndarray:
    """Return FASTSIM as in Kalker (1982): strips of equal width, stresses at the ends of count x count cells."""
    load, friction, a, b = POINT[3:]
    kalker = kalker_coefficients(ca.SX(a / b))
    c11, c22, c23 = (float(value) for value in (kalker.c11, kalker.c22, kalker.c23))
    flexible = 8 * a / (3 * STEEL * c11), 8 * a / (3 * STEEL * c22), math.pi * a * math.sqrt(a / b) / (4 * STEEL * c23)
    place = b * ((2 * np.arange(count) + 1) / count - 1)
    ends = a * np.sqrt(1 - (place / b) ** 2)
    step, stress, total = 2 * ends / count, np.zeros((2, count)), np.zeros(2)
    for number in range(count):
        ahead = ends - step * (number + 0.5)
        slip = [x / flexible[0] - spin * place / flexible[2], y / flexible[1] + spin * ahead / flexible[2]]
        stress = stress - step * np.array(slip)
        height = np.maximum(1 - ((ahead - step / 2) / a) ** 2 - (place / b) ** 2, 0)
        bound = 2 * friction * load / (math.pi * a * b) * height
        stress = stress * np.minimum(1, bound / np.maximum(np.hypot(*stress), 1e-30))
        total += (stress * step).sum(axis=1) * 2 * b / count
    return total


#: Random patches between adhesion and full slip, with spin to psi = 1. At a single one the error may happen to be zero.
MIXED = np.array([at(*row) for row in np.random.default_rng(5).uniform(-1, 1, (40, 3)) * [2e-3, 2e-3, 0.9]])
#: Scatter of the order of convergence over these patches [1].
ORDERS = 0.3


def size(forces_off: np.ndarray) -> float:
    """Return the root mean square over patches, in % of mu N."""
    return float(100 * np.sqrt(np.mean(np.sum(forces_off**2, axis=1))) / (0.3 * 80e3))


#: FASTSIM by its number of cells, each built once.
grid_of = lru_cache(fastsim)


def order(law: Callable[[int], CreepLaw], counts: tuple[int, ...]) -> float:
    """Return the mean order of convergence over doubled counts, from the differences of neighbours."""
    found = [forces(law(count), MIXED) for count in counts]
    differences = [size(one - other) for one, other in pairwise(found)]
    return math.log2(differences[0] / differences[-1]) / (len(differences) - 1)


@pytest.mark.study
def test_fastsim_without_spin_converges_to_its_closed_form_with_order_one() -> None:
    """The scheme is implicit Euler, as in Kalker's programs: the extrapolated error is 0.1 % of mu N."""
    points = MIXED * [1, 1, 0, 1, 1, 1, 1]
    exact = np.array([fastsim_without_spin(*point[:2]) for point in points])
    found = [forces(grid_of(count), points) for count in (10, 20, 40)]
    assert size(2 * found[-1] - found[-2] - exact) < 0.1
    errors = [size(one - exact) for one in found]
    assert math.log2(errors[0] / errors[-1]) / 2 == pytest.approx(1.0, abs=ORDERS)


def test_fastsim_with_spin_converges_with_order_one() -> None:
    """Stresses change direction while they slip. Kalker's scheme, used here, follows their direction to first order."""
    assert order(grid_of, (5, 10, 20, 40)) == pytest.approx(1.0, abs=ORDERS)


@pytest.mark.study
def test_fastsim_is_kalkers_to_their_common_limit() -> None:
    """Compare with another program of the published scheme, both extrapolated by their order; 0.1 % of mu N."""
    ours = 2 * forces(grid_of(40), MIXED) - forces(grid_of(20), MIXED)
    theirs = [np.array([fastsim_in_numpy(*point[:3], count) for point in MIXED]) for count in (80, 160)]
    assert size(ours - (2 * theirs[1] - theirs[0])) < 0.1
    assert size(forces(grid_of(40), MIXED) - theirs[1]) > 0.1


@pytest.mark.study
def test_strip_theory_converges_with_order_two_and_fastrip_with_order_one() -> None:
    finest = forces(strip_theory(24), MIXED)
    errors = [size(forces(strip_theory(count), MIXED) - finest) for count in (4, 12)]
    assert math.log(errors[0] / errors[1], 3) == pytest.approx(2.0, abs=ORDERS)
    assert order(fastrip, (4, 8, 16)) == pytest.approx(1.0, abs=ORDERS)


def test_an_odd_number_of_strips_is_refused() -> None:
    with pytest.raises(ValueError, match="number of strips is 5"):
        strip_theory(5)


# -- the exact theory -----------------------------------------------------------------------------------------------

#: Limits of the distance from the exact theory in % of mu N at each row: for pure creepage, for all rows (None: no
#: limit). FASTSIM with a parabolic bound has 3.7 and 6.3 in the limit of its cells. Strip theory falls to 4.4 with more
#: cells. FaStrip's 3.9 benefits from coarse cells: 40 x 40 give 5.2.
ASKED: dict[str, tuple[CreepLaw, float, float | None]] = {
    "polach": (polach, 5.5, None),
    "shen_hedrick_elkins": (shen_hedrick_elkins, 5.5, None),
    "kalker_to_coulomb": (kalker_to_coulomb, 3.0, 6.0),
    "johnson_vermeulen": (johnson_vermeulen, 6.5, None),
    "fastsim": (fastsim(10), 4.0, 8.0),
    "fastrip": (fastrip(8), 2.5, 5.0),
    "strip_theory": (strip_theory(8), 2.5, 5.0),
}


def exact_rows() -> tuple[np.ndarray, np.ndarray]:
    """Return points and exact forces [N] of all rows."""
    rows = list(csv.DictReader((DATA / "exact.csv").read_text().splitlines()))
    names = ("longitudinal", "lateral", "spin_1_per_m", "load_N", "friction", "a_mm", "b_mm", "exact_x_N", "exact_y_N")
    table = np.array([[float(row[name]) for name in names] for row in rows])
    table[:, 5:7] *= 1e-3
    return table[:, :7], table[:, 7:]


@pytest.mark.study
@pytest.mark.parametrize("name", ASKED)
def test_distance_from_the_exact_theory_is_within_what_is_asked(name: str) -> None:
    points, exact = exact_rows()
    assert len(points) == 45
    law, pure, every = ASKED[name]
    distance = 100 * np.hypot(*(forces(law, points) - exact).T) / (points[:, 3] * points[:, 4])
    plain = (points[:, 2] == 0) & (points[:, 0] * points[:, 1] == 0)
    assert distance[plain].max() < pure
    if every is not None:
        assert distance.max() < every
    else:
        assert distance.max() > 10.0  # These laws must fail with spin, as the documentation states.


# -- falling friction -----------------------------------------------------------------------------------------------

#: Largest distance from a traction curve over all its creepages, in % of mu_0 N; limit of the fits.
CURVE = 2.0
WHEEL_LOAD, WHEEL_RADIUS, SPEED, CURVES_NU = 106.7e3, 0.625, 10.0, 0.28


#: Theory and thickness of the elastic layer [mm] of a series of the benchmark case `traction-curves`.
SERIES = {
    "exact_falling_layer": ("exact", 1.25),
    "fastsim_coulomb": ("FASTSIM", 0.0),
    "modified_fastsim_falling": ("modified FASTSIM", 0.0),
}


def traction(series: str) -> tuple[np.ndarray, np.ndarray]:
    theory, layer = SERIES[series]
    table = [
        (one.inputs["creepage"], one.published["traction"])
        for one in read_case(CASES / "traction-curves.toml").points
        if (one.inputs["theory"], one.inputs["layer"]) == (theory, pytest.approx(layer / 1e3))
    ]
    creepage, coefficient = np.array(table, float).T
    return creepage, coefficient


@lru_cache
def wheel() -> tuple[float, float, Kalker]:
    """Return semi-axes by Hertz for a/b = 0.5, Johnson (1985), section 4.2, and Kalker's coefficients."""
    square = 0.75
    ratio = (ellipe(square) / 0.25 - ellipk(square)) / (ellipk(square) - ellipe(square))
    along = 1 / (2 * WHEEL_RADIUS)
    across = brentq(lambda b: along / b - ratio, 1e-3, 10.0)
    cube = 1.5 * 0.5 * WHEEL_LOAD * (1 - CURVES_NU) * ellipe(square) / (math.pi * STEEL * (along + across))
    a = cube ** (1 / 3)
    return a, 2 * a, kalker_coefficients(ca.SX(0.5), CURVES_NU)


def falling(kinetic: float, drop: float, half: float) -> Callable[[ca.SX], ca.SX]:
    """mu = mu_kin + d 2^(-w / w_half)."""
    return lambda speed: kinetic + drop * ca.exp(-math.log(2) / half * speed)


def curves(
    law: CreepLaw, friction_at: Callable[[ca.SX], ca.SX], reduction: Reduction = CLEAN, chosen: ca.SX | None = None
) -> Callable[..., np.ndarray]:
    """Return the traction coefficient of the wheel by its creepages, and by the symbols `chosen`."""
    a, b, kalker = wheel()
    x, zero, mu = ca.SX.sym("x"), ca.SX(0), friction_at(ca.SX(0))
    axes, creepages = (ca.SX(a), ca.SX(b)), (x, zero, zero)
    patch = ContactPatch(creepages, ca.SX(WHEEL_LOAD), mu, axes, ca.SX(STEEL), kalker, reduction, friction_at, SPEED)
    force = ca.Function("law", [x, ca.SX(0, 1) if chosen is None else chosen], [-law(patch)[0] / WHEEL_LOAD])

    def at_creepages(creepage: np.ndarray, values: Sequence[float] = ()) -> np.ndarray:
        return np.array([float(force(one, np.array(values))) for one in creepage])

    return at_creepages


@pytest.mark.study
def test_the_wheel_is_that_of_the_curves() -> None:
    """FASTSIM is within 1.5 % of mu N of CONTACT. Half of it is the slope, which is 3 % above Kalker's table there."""
    creepage, coefficient = traction("fastsim_coulomb")
    found = curves(fastsim(20), lambda speed: ca.SX(0.33))(creepage)
    assert found[0] == pytest.approx(coefficient[0], rel=0.035)
    assert np.abs(found - coefficient).max() < 0.015 * 0.33


@pytest.mark.study
def test_modified_fastsim_follows_its_curve_with_the_printed_parameters() -> None:
    """No fit: k_0, alpha, beta and the friction are those of the curve. With constant slopes the law fails."""
    creepage, coefficient = traction("modified_fastsim_falling")
    friction = falling(0.1368, 0.2232, 0.99)
    found = curves(modified_fastsim(10, SlopeReduction(0.54, 0.02, 0.62)), friction)(creepage)
    assert 100 * np.abs(found - coefficient).max() / 0.36 < CURVE
    constant_slope = curves(modified_fastsim(10, SlopeReduction(0.54, 1.0, 0.62)), friction)(creepage)
    assert 100 * np.abs(constant_slope - coefficient).max() / 0.36 > 4 * CURVE


#: Largest error at the odd points of a curve, of fits to its even points [% of mu_0 N]. Between creepages of 1e-5 and
#: 0.004 the curve of modified FASTSIM has one point, 0.002, which is odd. Without it Polach's law is CURVE off there;
#: with all points it is within 1.5 %.
ODD_POLACH, ODD_FASTSIM, ODD_POLACH_ON_FASTSIM = 0.4, 1.3, 4.0
#: Least-squares fits to the even points of a curve, with its friction: k_A, k_S of Polach's law, and k_0, alpha, beta.
FITS = {
    ("polach_2005", "exact_falling_layer"): ((0.14, 0.19, 1.25), (0.252, 0.279), ODD_POLACH),
    ("polach_2005", "modified_fastsim_falling"): ((0.1368, 0.2232, 0.99), (0.440, 0.267), ODD_POLACH_ON_FASTSIM),
    ("modified_fastsim", "exact_falling_layer"): ((0.14, 0.19, 1.25), (0.310, 0.0, 0.094), ODD_FASTSIM),
}


@pytest.mark.parametrize(("name", "series"), FITS)
def test_fits_to_even_points_of_a_traction_curve_are_judged_on_odd_ones(name: str, series: str) -> None:
    friction, expected, odd = FITS[name, series]
    creepage, coefficient = traction(series)
    symbols = ca.SX.sym("chosen", len(expected))
    parts = ca.vertsplit(symbols)
    if name == "polach_2005":
        fitted = curves(polach_2005, falling(*friction), Reduction(*parts), symbols)
    else:
        fitted = curves(modified_fastsim(6, SlopeReduction(*parts)), falling(*friction), chosen=symbols)

    def distances(chosen: np.ndarray, first: int = 0) -> np.ndarray:
        at = slice(first, None, 2)
        return np.asarray(100 * (fitted(creepage[at], chosen) - coefficient[at]) / (friction[0] + friction[1]))

    start = np.array([0.4, 0.4, 0.3][: len(expected)])
    fit = least_squares(distances, start, bounds=(0, 2))
    assert fit.x == pytest.approx(expected, abs=0.01)
    assert np.abs(fit.fun).max() < CURVE
    assert np.abs(distances(fit.x, 1)).max() == pytest.approx(odd, abs=0.05)
    assert np.abs(distances(start)).max() > CURVE


def test_polach_2005_is_the_law_of_1999_where_nothing_falls() -> None:
    points = random_points(50, 4)
    assert forces(polach_2005, points) == pytest.approx(forces(polach, points), rel=1e-15)

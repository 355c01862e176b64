"""Random states of a contact patch and their forces by Kalker's exact theory, for the tolerances of fast creep laws.

`python -m evidence.measuring.exact_states` recomputes the table in some thirty minutes.
"""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from evidence.measuring.creep_cost import SHEAR_MODULUS, values, with_coefficients
from fmu_src.progress import counting
from rbd_model.contact.creep.exact import exact, half_space
from rbd_model.contact.creep.law import CreepLaw

#: File of the table that `write` makes.
TABLE = Path(__file__).parent / "exact_states.csv"
COLUMNS = "axis_ratio,longitudinal,lateral,spin,force_longitudinal,force_lateral"
#: Number of states, their seed, the slenderest ellipse, and the largest linear force of each creepage, over mu N.
COUNT, SEED, SLENDEREST, LARGEST = 1000, 29, 20.0, 3.0
#: Number of further states and the largest linear force of each of their creepages.
FURTHER, FARTHEST = 300, (10.0, 10.0, 40.0)
#: Sets of states: the first ones; those of them whose total linear force is at most LARGEST; further ones above it.
EACH, TOGETHER, BEYOND = "random states", "states up to three in all", "states beyond three in all"
#: Cells of the exact theory along and across, by a/b up to a limit. In a wide patch with spin, slip turns about a point
#: within a length a, which the strips must resolve. STRIPS times b/a strips are 0.6 a wide in the middle. With 20 x 20
#: cells everywhere forces differ by up to 4 % of mu N at a/b = 1/15; with 60 strips instead of 80 by 0.4.
CELLS = ((0.1, (10, None)), (0.25, (12, None)), (4.0, (24, 24)), (8.0, (36, 14)), (np.inf, (48, 18)))
STRIPS = 5.25
#: Properties of any patch: load [N], friction, (a b)^(1/2) [m]; forces over mu N do not depend on them.
LOAD, FRICTION, SIZE = 80e3, 0.3, 5.5e-3


@dataclass(frozen=True)
class Distance:
    """Distance of a law from exact theory over states, % of mu N: mean, 99 % of them, largest."""

    mean: float
    most: float
    largest: float


def counts(axis_ratio: float) -> tuple[int, int]:
    """Return the cells along and across for exact forces at a/b."""
    along, across = next(counts for limit, counts in CELLS if axis_ratio <= limit)
    return along, across or 2 * math.ceil(STRIPS / axis_ratio / 2)


def random_states() -> np.ndarray:
    """Return rows of a/b, creepages and spin as for `exact`: a/b uniform in its logarithm, linear forces uniform."""
    generator, rows = np.random.default_rng(SEED), []
    for count, largest in ((COUNT, LARGEST), (FURTHER, np.array(FARTHEST))):
        ratio = np.exp(generator.uniform(-np.log(SLENDEREST), np.log(SLENDEREST), count))
        linear = generator.uniform(-1.0, 1.0, (count, 3)) * largest
        points = np.column_stack([np.zeros((count, 5)), ratio, np.ones(count)])
        rows.append(np.column_stack([ratio, linear / with_coefficients(points)[:, 7:]]))
    return np.vstack(rows)


def write() -> None:
    """Write the states with their exact forces over mu N."""
    states = random_states()
    forces = [exact(half_space(row[0], counts(row[0])), row[1:]).forces for row in counting(states, "states")]
    np.savetxt(TABLE, np.column_stack([states, forces]), "%.6g", ",", header=COLUMNS, comments="")


def read() -> tuple[np.ndarray, np.ndarray]:
    """Return the states, shape (1300, 4), and exact forces over mu N, shape (1300, 2)."""
    table = np.loadtxt(TABLE, delimiter=",", skiprows=1)
    return table[:, :4], table[:, 4:]


def points_of(states: np.ndarray) -> np.ndarray:
    """Return the states as points of `creep_cost`."""
    ratio, creepages = states[:, 0], states[:, 1:]
    strain = LOAD * FRICTION / (SHEAR_MODULUS * SIZE**2)
    same = np.ones(len(states))
    axes = SIZE * np.sqrt(ratio), SIZE / np.sqrt(ratio)
    return np.column_stack([creepages * strain / (1, 1, SIZE), LOAD * same, FRICTION * same, *axes])


def linear_forces(states: np.ndarray) -> np.ndarray:
    """Return the linear force of all three creepages, over mu N."""
    return np.asarray(np.linalg.norm(states[:, 1:] * with_coefficients(points_of(states))[:, 7:], axis=1))


def distances(law: CreepLaw) -> np.ndarray:
    """Return the distance of a law from exact theory at all states [% of mu N]."""
    states, forces = read()
    return np.asarray(100 * np.hypot(*(values(law, points_of(states)) / (LOAD * FRICTION) - forces).T))


def chosen(states: str = EACH) -> np.ndarray:
    """Return which rows are in a set of states, of EACH, TOGETHER and BEYOND."""
    total = linear_forces(read()[0])
    first = np.arange(total.size) < COUNT
    return {EACH: first, TOGETHER: first & (total <= LARGEST), BEYOND: ~first & (total > LARGEST)}[states]


def distance(law: CreepLaw, states: str = EACH) -> Distance:
    """Return the distance over a set of states, of EACH, TOGETHER and BEYOND."""
    found = distances(law)[chosen(states)]
    return Distance(float(found.mean()), float(np.quantile(found, 0.99)), float(found.max()))


if __name__ == "__main__":
    write()

"""Random states of a contact patch and their forces by Kalker's exact theory, for the bands of fast creep laws.

`python -m scenarios.methods.exact_states` makes the table anew, in some three minutes.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from tqdm import tqdm

from rbd_model.contact.creep.exact import exact, half_space
from rbd_model.contact.creep.law import CreepLaw
from scenarios.methods.creep_cost import SHEAR_MODULUS, values, with_coefficients

#: The table that `write` makes.
TABLE = Path(__file__).parent / "exact_states.csv"
COLUMNS = "axis_ratio,longitudinal,lateral,spin,force_longitudinal,force_lateral"
#: States, their seed, the slenderest ellipse, and the largest linear force, over mu N, that each creepage asks for.
COUNT, SEED, SLENDEREST, LARGEST = 1000, 29, 20.0, 3.0
#: Of the exact theory, cells along and across; 24 x 36 differ by 0.4 % of mu N at most, and by 1.9 below a/b = 0.14.
CELLS = (20, 20)
#: From this state on they are for reporting; those before are for choosing.
REPORTED_FROM = COUNT // 2
#: Any patch: load [N], friction, (a b)^(1/2) [m]; forces over mu N do not depend on them.
LOAD, FRICTION, SIZE = 80e3, 0.3, 5.5e-3


@dataclass(frozen=True)
class Distance:
    """Of a law from exact theory over states, % of mu N: mean, 99 % of them, largest."""

    mean: float
    most: float
    largest: float


def random_states() -> np.ndarray:
    """a/b, and creepages and spin as `exact` has them, by rows: a/b even in its logarithm, linear forces even."""
    generator = np.random.default_rng(SEED)
    ratio = np.exp(generator.uniform(-np.log(SLENDEREST), np.log(SLENDEREST), COUNT))
    linear = generator.uniform(-LARGEST, LARGEST, (COUNT, 3))
    points = np.column_stack([np.zeros((COUNT, 5)), ratio, np.ones(COUNT)])
    return np.column_stack([ratio, linear / with_coefficients(points)[:, 7:]])


def write() -> None:
    """The states with their exact forces over mu N."""
    states = random_states()
    forces = [exact(half_space(row[0], CELLS), row[1:]).forces for row in tqdm(states, "states")]
    np.savetxt(TABLE, np.column_stack([states, forces]), "%.6g", ",", header=COLUMNS, comments="")


def read() -> tuple[np.ndarray, np.ndarray]:
    """States, shape (1000, 4), and exact forces over mu N, shape (1000, 2)."""
    table = np.loadtxt(TABLE, delimiter=",", skiprows=1)
    return table[:, :4], table[:, 4:]


def points_of(states: np.ndarray) -> np.ndarray:
    """States as points of `creep_cost`."""
    ratio, creepages = states[:, 0], states[:, 1:]
    strain = LOAD * FRICTION / (SHEAR_MODULUS * SIZE**2)
    same = np.ones(len(states))
    axes = SIZE * np.sqrt(ratio), SIZE / np.sqrt(ratio)
    return np.column_stack([creepages * strain / (1, 1, SIZE), LOAD * same, FRICTION * same, *axes])


def distances(law: CreepLaw, part: slice) -> np.ndarray:
    """Of a law from exact theory at a part of the states, % of mu N."""
    states, forces = (one[part] for one in read())
    return np.asarray(100 * np.hypot(*(values(law, points_of(states)) / (LOAD * FRICTION) - forces).T))


def distance(law: CreepLaw, part: slice = slice(REPORTED_FROM, None)) -> Distance:
    """At the states for reporting, or at others."""
    found = distances(law, part)
    return Distance(float(found.mean()), float(np.quantile(found, 0.99)), float(found.max()))


if __name__ == "__main__":
    write()

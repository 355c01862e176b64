"""The creep law of Kalker's exact theory: a table, computed by this file and stored next to it.

`python -m rbd_model.contact.creep.exact_table` computes it again, in some two hours.
"""

from __future__ import annotations

import math
import zlib
from functools import lru_cache
from pathlib import Path
from zipfile import BadZipFile

import numpy as np
from tqdm import tqdm

from fmu_src.symbols import ca
from rbd_model.contact.creep.exact import HalfSpace, StickAndSlip, exact, half_space
from rbd_model.contact.creep.law import ContactPatch, CreepLaw
from rbd_model.contact.creep.tabulated import INFINITE, CreepTable, axes, continued, patch_at, tabulated

#: The stored table: forces at the places of `axes`.
SHIPPED = Path(__file__).parent / "exact_table.npz"
#: Cells along and across of ellipses with ln(a/b) up to a limit. On a wide patch with spin, slip turns about a place in
#: it within a length a, which strips must resolve. With 24 strips forces at a/b = 1/15 have errors of 3 % of mu N, with
#: 60 of 0.3 %. On a long patch it turns within a length b, which cells along must resolve. With 11 strips forces
#: from a/b = 2.5 on were up to 4 % of mu N too small.
CELLS = (
    *((-2.6, (8, 60)), (-1.9, (8, 40)), (-1.1, (9, 26)), (-0.4, (11, 18))),
    *((0.9, (14, 14)), (math.inf, (40, 20))),
)
#: Factors on the creepages, applied in turn if the search for sticking cells does not converge.
NUDGES = (1.0, 1.002, 0.998, 1.005, 0.995)


def exact_law(patch: ContactPatch) -> tuple[ca.SX, ca.SX]:
    """Return the creep forces (F_x, F_y) [N] of exact theory, Kalker (1990), from the stored table.

    Poisson's ratio is 0.25.

    Errors are within 2 % of mu N at 99 % of states, also beyond three times saturation (docs/limits.md, Creep laws).
    """
    return _law()(patch)


@lru_cache
def _law() -> CreepLaw:
    """Return the law of the stored table, Kalker (1990): once, since equations hold one part of a name."""
    return tabulated(shipped())


@lru_cache
def shipped() -> CreepTable:
    """Return the stored table, Kalker (1990). Raises RuntimeError if the file is damaged."""
    try:
        with np.load(SHIPPED) as file:
            return CreepTable(file["forces"].astype(float))
    except (OSError, ValueError, KeyError, EOFError, BadZipFile, zlib.error) as error:
        raise RuntimeError(f"{SHIPPED} is damaged: {error}. Install the package again.") from error


def made() -> CreepTable:
    """Return the table of exact theory, Kalker (1990); places with u < 0 or spin < 0 are mirror images."""
    places = axes()
    forces = np.zeros((*(place.size for place in places), 2))
    for number in tqdm(range(1, places[3].size - 1), "ellipses", disable=None):
        forces[..., number, :] = of_ellipse(places, float(places[3][number]))
    forces[0] = forces[2] * (-1, 1)
    forces[:, :, 0] = forces[:, ::-1, 2] * (1, -1)
    return continued(forces)


def of_ellipse(places: list[np.ndarray], log_ratio: float) -> np.ndarray:
    """Return forces over mu N of one ellipse, Kalker (1990), shape (places ahead, aside, of spin, 2).

    They are 0 beyond the ends.
    """
    counts = next(counts for limit, counts in CELLS if log_ratio < limit)
    space = half_space(math.exp(log_ratio), counts)
    place = ca.SX.sym("place", 4)
    creepages = ca.Function("creepages", [place], [ca.vertcat(*patch_at(place).creepages)])
    forces = np.zeros((*(one.size for one in places[:3]), 2))
    for turn in range(1, places[2].size - 1):
        for ahead in range(1, places[0].size - 1):
            last: StickAndSlip | None = None
            for aside in range(1, places[1].size - 1):
                at = np.array([places[0][ahead], places[1][aside], places[2][turn]])
                given = np.array(creepages([*np.clip(at, -INFINITE, INFINITE), log_ratio])).ravel()
                if np.hypot(at[0], at[1]) >= INFINITE or at[2] >= INFINITE:
                    forces[ahead, aside, turn] = sliding_force(space, given)
                else:
                    last = nearly_exact(space, given, last)
                    forces[ahead, aside, turn] = last.forces
    return forces


def sliding_force(space: HalfSpace, creepages: np.ndarray) -> np.ndarray:
    """Return the force over mu N of a patch that slides everywhere: the bound, against the rigid slip.

    Kalker (1990).
    """
    x, y, spin = creepages
    slip = np.array([x - spin * space.y, y + spin * space.x[1]])
    friction = space.cells.bound * space.cells.area
    return np.asarray(-slip / np.maximum(np.hypot(*slip), 1e-300) @ friction)


def nearly_exact(space: HalfSpace, creepages: np.ndarray, start: StickAndSlip | None) -> StickAndSlip:
    """Return steady rolling, Kalker (1990), at these creepages, or at nearby ones if the search fails; see NUDGES.

    Raises ArithmeticError if it fails for all of them.
    """
    for nudge in NUDGES:
        for begin in (start, None):
            try:
                return exact(space, nudge * creepages, begin)
            except ArithmeticError:
                continue
    raise ArithmeticError(f"The exact theory found no end near creepages {creepages}; use other cells.")


if __name__ == "__main__":
    np.savez_compressed(SHIPPED, forces=made().forces.astype(np.float32))

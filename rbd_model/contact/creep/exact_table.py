"""The creep law of Kalker's exact theory: a table of it, made once by this file and shipped beside it.

`python -m rbd_model.contact.creep.exact_table` makes it anew, in some ten minutes.
"""

import math
import zlib
from functools import lru_cache
from pathlib import Path
from zipfile import BadZipFile

import casadi as ca
import numpy as np
from tqdm import tqdm

from rbd_model.contact.creep.exact import HalfSpace, StickAndSlip, exact, half_space
from rbd_model.contact.creep.law import ContactPatch
from rbd_model.contact.creep.tabulated import INFINITE, CreepTable, axes, continued, patch_at, tabulated

#: The table that ships: forces at the places of `axes`.
SHIPPED = Path(__file__).parent / "exact_table.npz"
#: Cells along and across of ellipses with ln(a/b) up to a limit. Where a wide patch spins, slip turns about a place in
#: it within a length a, which strips have to follow: with 24 forces at a/b = 1/15 are 3 % of mu N off, with 60 0.3.
#: In a long one it does so within a length b, which cells along have to follow.
CELLS = (
    *((-2.6, (8, 60)), (-1.9, (8, 40)), (-1.1, (9, 26)), (-0.4, (11, 18))),
    *((1.1, (14, 14)), (2.6, (20, 11)), (math.inf, (36, 8))),
)
#: Where the search for sticking cells goes round in circles, creepages that differ by so little are taken instead.
NUDGES = (1.0, 1.002, 0.998, 1.005, 0.995)


def exact_law(patch: ContactPatch) -> tuple[ca.SX, ca.SX]:
    """Creep forces (F_x, F_y) [N] of exact theory, Kalker (1990), from the table that ships, Poisson's ratio 0.25.

    Within 2 % of mu N at 99 % of states up to three times saturation; up to 5 % off beyond it, where spin rules
    (docs/limits.md, Creep laws).
    """
    return tabulated(shipped())(patch)


@lru_cache
def shipped() -> CreepTable:
    """Return the table that ships, Kalker (1990). Raises RuntimeError where the file is damaged."""
    try:
        with np.load(SHIPPED) as file:
            return CreepTable(file["forces"].astype(float))
    except (OSError, ValueError, KeyError, EOFError, BadZipFile, zlib.error) as error:
        raise RuntimeError(f"{SHIPPED} is damaged: {error}. Install the package again.") from error


def made() -> CreepTable:
    """The table of exact theory, Kalker (1990); its places with u < 0 or spin < 0 are mirror images of others."""
    places = axes()
    forces = np.zeros((*(place.size for place in places), 2))
    for number in tqdm(range(1, places[3].size - 1), "ellipses", disable=None):
        forces[..., number, :] = of_ellipse(places, float(places[3][number]))
    forces[0] = forces[2] * (-1, 1)
    forces[:, :, 0] = forces[:, ::-1, 2] * (1, -1)
    return continued(forces)


def of_ellipse(places: list[np.ndarray], log_ratio: float) -> np.ndarray:
    """Forces over mu N of one ellipse, Kalker (1990), shape (places ahead, aside, of spin, 2); none beyond the ends."""
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
    """Force over mu N of a patch that slides all over, Kalker (1990): everywhere the bound, against the rigid slip."""
    x, y, spin = creepages
    slip = np.array([x - spin * space.y, y + spin * space.x[1]])
    friction = space.cells.bound * space.cells.area
    return np.asarray(-slip / np.maximum(np.hypot(*slip), 1e-300) @ friction)


def nearly_exact(space: HalfSpace, creepages: np.ndarray, start: StickAndSlip | None) -> StickAndSlip:
    """Steady rolling, Kalker (1990), at these creepages, or at some nearby where these find no end; see NUDGES.

    Raises ArithmeticError where none do.
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

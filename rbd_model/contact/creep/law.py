"""Definition of a creep law: a function from a `ContactPatch` to the creep forces (F_x, F_y) on the wheel.

Each law is one file of this folder. A law of the user is one function, given to a level by `Contact`, for tread or
flange.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from fmu_src.chain import Chain
from fmu_src.symbols import ca
from rbd_model.contact.creep.kalker import Kalker
from rbd_model.contact.hertz import POISSON_RATIO


def creepage(sliding_speed: ca.SX, forward_speed: ca.SX, creepage_speed: ca.SX) -> ca.SX:
    """Return the longitudinal creepage (xi_x), eq. (2.3): sliding speed over forward speed.

    This differs from the thesis: sqrt(V^2 + v_eps^2) instead of V, which is 0 at rest.
    """
    return sliding_speed / ca.sqrt(forward_speed**2 + creepage_speed**2)


@dataclass(frozen=True)
class Reduction:
    """Reduction factors of the gradient by contamination in the areas of adhesion (k_A) and slip (k_S).

    Polach (2005).
    """

    adhesion: ca.SX | float = 1.0
    slip: ca.SX | float = 1.0


#: Factors of clean surfaces, as in the law of 1999.
CLEAN = Reduction()


@dataclass(frozen=True)
class ContactPatch:
    """Arguments of a creep law: an elliptical patch that rolls and slides, eqs (3.87), (3.89)-(3.91).

    `creepages` are longitudinal, lateral [1] and spin [1/m], of the wheel against the rail. Axes point ahead, to the
    left and into the wheel. `load` is in N. `friction` is the coefficient at the sliding speed of the whole patch.
    `semi_axes` [m] are along and across. `shear_modulus` is in Pa. `friction_at` is the coefficient by sliding speed
    [m/s], for laws with different friction within the patch, with `rolling_speed` [m/s]. Without them it is the same
    everywhere. `chain` calls parts, such as a table. `poisson_ratio` is that of `kalker` and of the semi-axes.
    """

    creepages: tuple[ca.SX, ca.SX, ca.SX]
    load: ca.SX
    friction: ca.SX
    semi_axes: tuple[ca.SX, ca.SX]
    shear_modulus: ca.SX
    kalker: Kalker
    reduction: Reduction = CLEAN
    friction_at: Callable[[ca.SX], ca.SX] | None = None
    rolling_speed: ca.SX | float = 1.0
    chain: Chain = field(default_factory=Chain)
    poisson_ratio: float = POISSON_RATIO


#: Creep forces (F_x, F_y) [N] on the wheel of a patch. For small creepages they are those of Kalker, F_x = -G a b c11
#: xi_x and F_y = -G a b c22 xi_y - G (a b)^1.5 c23 xi_s. For large ones their size is friction times load.
CreepLaw = Callable[[ContactPatch], "tuple[ca.SX, ca.SX]"]


#: Load for trial steps that would compute the contact of an unloaded wheel [N]; a run ends before (wheel lift).
SMALLEST_LOAD = 1.0
SMALLEST_FRICTION = 1e-9


def at_least(value: ca.SX, least: float) -> ca.SX:
    """Return the larger of both; as a comparison, which costs less in C than fmax."""
    return ca.if_else(value > least, value, least)

"""Polach's creep forces (2005): contaminated surfaces, and friction that falls with the sliding of the patch."""

from __future__ import annotations

from dataclasses import replace

from fmu_src.symbols import ca
from rbd_model.contact.creep.law import ContactPatch
from rbd_model.contact.creep.polach import polach

#: Smallest sliding, over the speed of rolling, that is distinguished from 0.
SLIDING_FLOOR = 1e-12


def polach_2005(patch: ContactPatch) -> tuple[ca.SX, ca.SX]:
    """Return the creep forces (F_x, F_y) [N], Polach (2005), Creep forces in simulations of traction vehicles, Wear
    258.

    This is the law of 1999 with the patch's reduction (k_A, k_S), and the friction `friction_at` the sliding speed of
    the whole patch, without spin. A wheelset that passes its own friction, as in `creep_of_wheel`, has the same value.
    """
    if patch.friction_at is None:
        return polach(patch)
    x, y, _ = patch.creepages
    sliding = ca.sqrt(x**2 + y**2 + SLIDING_FLOOR**2)
    return polach(replace(patch, friction=patch.friction_at(patch.rolling_speed * sliding)))

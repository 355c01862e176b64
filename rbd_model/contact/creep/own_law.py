"""A check of a user's creep law before its equations are written."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fmu_src.symbols import ca
from rbd_model.contact.creep.kalker import smooth_kalker_coefficients
from rbd_model.contact.creep.law import ContactPatch

#: The patch of the check: load [N], friction, semi-axes [m], shear modulus [Pa].
LOAD, FRICTION, AXES, MODULUS = 5e4, 0.3, (6e-3, 6e-3), 82e9
#: Creepages ahead and to the left at which friction must take power, in both senses.
SLIDING = (1e-4, 1e-3, 1e-2)


def check_own_law(law: Callable[[ContactPatch], Any], name: str) -> None:
    """Check that a law returns two forces that are finite without creepage and oppose it, Kalker (1990).

    Their size is not checked: Kalker's linear law has no limit either.
    """
    creepages = ca.SX.sym("creepages", 3)
    patch = ContactPatch(
        (creepages[0], creepages[1], creepages[2]),
        ca.SX(LOAD),
        ca.SX(FRICTION),
        (ca.SX(AXES[0]), ca.SX(AXES[1])),
        ca.SX(MODULUS),
        smooth_kalker_coefficients(ca.SX(0.0)),
    )
    try:
        forces = law(patch)
        both = ca.vertcat(*forces)
    except Exception as error:  # of the user's own code, with any message
        reason = str(error).strip().splitlines()[-1:] or [type(error).__name__]
        raise ValueError(
            f"creep_law must return two CasADi expressions; {name} failed: {reason[0].rstrip('.')}. Write ca.if_else,"
            " ca.sqrt and ca.fmax in place of if, math and max."
        ) from error
    if both.numel() != 2:
        raise ValueError(f"creep_law must return two forces, ahead and to the left; {name} returned {both.numel()}.")
    if _calls_parts(both, creepages):
        return  # it calls parts, whose values are known in a run alone
    _check_values(ca.Function("own", [creepages], [both]), name)


def _calls_parts(both: ca.SX, creepages: ca.SX) -> bool:
    own = {symbol.name() for symbol in ca.symvar(creepages)}
    return any(symbol.name() not in own for symbol in ca.symvar(both))


def _check_values(forces: ca.Function, name: str) -> None:
    """Raise ValueError if the forces are not finite at rest, or if they drive the wheel."""
    if not np.all(np.isfinite(np.array(forces([0.0, 0.0, 0.0])))):
        raise ValueError(
            f"creep_law must be finite without creepage; {name} is not. Add a small number below a square root or a"
            " quotient, such as ca.sqrt(x**2 + y**2 + 1e-18)."
        )
    for size in SLIDING:
        for place in (0, 1):
            for sense in (-1.0, 1.0):
                creepage = np.zeros(3)
                creepage[place] = sense * size
                found = np.array(forces(creepage)).ravel()
                if not float(found @ creepage[:2]) <= 0.0:
                    raise ValueError(
                        f"creep_law must oppose the creepage; {name} returned {found[place]:.4g} N for"
                        f" {creepage[place]:g} {'to the left' if place else 'ahead'}. Check the signs: the forces"
                        " act on the wheel."
                    )

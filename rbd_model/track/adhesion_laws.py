"""Public laws of friction between wheel and rail as functions of numbers, each with its source (docs/adhesion.md).

Vehicles have the fall over sliding, a map over place and a patch as equations (friction.py, line_table.py). Recovery
and sand are systems of their own (recovery.py, sand.py). The law over speed is an equation in trains only
(rbd_model/train/adhesion.py).
"""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fmu_src.symbols import ca
from rbd_model.track.friction import RailCondition
from rbd_model.track.recovery import RecoveryParameters

Numbers = NDArray[np.float64]
#: A number, numbers, or a symbol.
Value = TypeVar("Value", float, Numbers, "ca.SX")


def at_speed(speed: Value) -> Value:
    """Return the law of Curtius and Kniffler (1950) at a speed [m/s] that is not checked, 7.5 / (V + 44) + 0.161."""
    return 7.5 / (3.6 * speed + 44.0) + 0.161


def curtius_kniffler(speed: ArrayLike) -> Numbers:
    """Return the adhesion that locomotives can use at a speed V [km/h], 7.5 / (V + 44) + 0.161.

    Curtius and Kniffler (1950), Elektrische Bahnen; the formula is that of the documentation of Open Rails, the paper
    was not read.

    Takes speed [m/s].
    """
    return np.asarray(at_speed(_at_least_0("speed", speed, "m/s")))


def fallen_friction(rail: RailCondition, sliding: ArrayLike) -> Numbers:
    """Return friction at a sliding speed [m/s], mu0 ((1 - A) exp(-B w) + A): Polach (2005), Wear 258, 992-1000.

    Raises ValueError if a speed is below 0.
    """
    ratio, decay = rail.law.friction_ratio, rail.law.friction_decay
    left = (1.0 - ratio) * np.exp(-decay * _at_least_0("sliding", sliding, "m/s")) + ratio
    return np.asarray(rail.friction * left)


def cleaned_share(rail: RecoveryParameters, energy: ArrayLike) -> Numbers:
    """Return the share of a rail that sliding has cleaned with an energy per metre [J/m], 1 - exp(-e / e_0).

    The form is assumed (`recovery.py`), the effect is described by Meli, Ridolfi and Rindi (2014). Energies of wheels
    behind each other add. Raises ValueError if one is below 0.
    """
    return np.asarray(-np.expm1(-_at_least_0("energy", energy, "J/m") / rail.recovery_energy))


def recovered_friction(rail: RecoveryParameters, energy: ArrayLike) -> Numbers:
    """Return friction of a rail that sliding has cleaned with an energy per metre [J/m], as in `recovery.py`.

    mu = (1 - l) mu_d + l mu_r, l = 1 - exp(-e / e_0), assumed. Meli, Ridolfi and Rindi (2014), Meccanica 49, 919-937,
    describe such a recovery; their formula was not read. Raises ValueError if an energy is below 0.
    """
    gain = rail.recovered_friction - rail.degraded_friction
    return np.asarray(rail.degraded_friction + gain * cleaned_share(rail, energy))


def _at_least_0(name: str, value: ArrayLike, unit: str) -> Numbers:
    found = np.asarray(value, float)
    wrong = found[~(found >= 0.0)]
    if wrong.size:
        raise ValueError(f"{name} must be at least 0 {unit}; got {wrong.flat[0]:g} {unit}. Give its size.")
    return found

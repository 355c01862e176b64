"""Forces as functions of travel and rate: a user's function becomes data, and is checked once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from fmu_src.symbols import ca
from rbd_model.vehicle.scales import BEYOND, BEYOND_RATE

#: Travels and rates of the check, as shares of the largest, in both senses.
SHARES = np.concatenate([-np.geomspace(1.0, 1e-6, 31), [0.0], np.geomspace(1e-6, 1.0, 31)])
#: Change of the force over no distance that is a jump [N], halvings of a distance until it is none, and round-off as a
#: share of the largest force.
JUMP, HALVINGS, ROUND_OFF = 1.0, 48, 1e-9


@dataclass(frozen=True)
class ForceFunction:
    """A force over travel [m], rate [m/s] and further numbers, as data.

    text: the CasADi function, so that equal functions are equal and can be stored.
    """

    text: str

    @classmethod
    def of(cls, force: Callable[..., Any], count: int) -> ForceFunction:
        """Return a user's function with `count` further numbers. Raises ValueError if it returns no expression."""
        symbols = [ca.SX.sym(name) for name in ("travel", "rate", *(f"size_{number}" for number in range(count)))]
        try:
            result = ca.SX(force(*symbols))
        except Exception as error:  # of the user's own code, with any message
            reason = str(error).strip().splitlines()[-1:] or [type(error).__name__]
            raise ValueError(
                f"force must return a CasADi expression of travel, rate and {count} sizes; it failed: "
                f"{reason[0].rstrip('.')}. Write ca.if_else, ca.tanh and ca.fmax instead of if, math and max."
            ) from error
        if result.numel() != 1:
            raise ValueError(f"force must return one number [N]; got {result.numel()}. Return the force alone.")
        if others := {one.name() for one in ca.symvar(result)} - {one.name() for one in symbols}:
            raise ValueError(f"force must depend on travel, rate and its sizes; got {min(others)} too. Make it a size.")
        return cls(ca.Function("force", symbols, [result]).serialize())

    def __call__(self, travel: Any, rate: Any, *sizes: Any) -> Any:
        """Return the force [N] of numbers or symbols."""
        return ca.Function.deserialize(self.text)(travel, rate, *sizes)


@lru_cache
def function_fault(force: ForceFunction, sizes: tuple[float, ...]) -> str:
    """Return what is wrong with a force, or an empty text.

    It must be finite, with finite slopes, without jumps and 0 at rest, and its part by the rate must take power.
    """
    x, v = ca.SX.sym("x"), ca.SX.sym("v")
    value = force(x, v, *sizes)
    both = ca.Function("both", [x, v], [ca.horzcat(value, ca.jacobian(value, ca.vertcat(x, v)))])
    rate, travel = np.meshgrid(SHARES * BEYOND_RATE, SHARES * BEYOND, indexing="ij")

    def at(rates: np.ndarray, travels: np.ndarray) -> np.ndarray:
        mapped = both.map(rates.size)(travels.reshape(1, -1), rates.reshape(1, -1))
        return np.array(mapped).reshape(*rates.shape, 3)

    found = at(rate, travel)
    for what, columns in (("force", found[..., :1]), ("slope of the force", found)):
        missing = ~np.all(np.isfinite(columns), axis=-1)
        if np.any(missing):
            where = _place(missing, rate, travel)
            return f"{what} must be finite; it is not at {where}. Add a small number below a root or a quotient."
    values, middle = found[..., 0], len(SHARES) // 2
    largest = float(np.max(np.abs(values)))
    if largest == 0.0:
        return "force must depend on travel or rate; it is 0 everywhere. Remove the connection."
    if abs(values[middle, middle]) > ROUND_OFF * largest:
        return f"force must be 0 at rest; got {values[middle, middle]:g} N at travel 0 and rate 0. Subtract it."
    driving = (values - values[middle]) * np.sign(rate) < -ROUND_OFF * largest
    if np.any(driving):
        where = _place(driving, rate, travel)
        return f"force must not drive: its part by the rate must have the sign of the rate; it has not at {where}."
    for axis in (0, 1):
        if where := _jump(lambda *place: at(*place)[..., 0], np.stack([rate, travel]), axis):
            return f"force must not jump; it does at {where}. Take ca.tanh, or a FrictionSlider for dry friction."
    return ""


def _place(marked: np.ndarray, rate: np.ndarray, travel: np.ndarray) -> str:
    """Return the marked place next to rest in words."""
    nearest = int(np.argmin(np.abs(rate[marked]) + np.abs(travel[marked])))
    both = (float(one[marked][nearest]) for one in (travel, rate))
    return "travel {:.3g} m, rate {:.3g} m/s".format(*(round(one, 9) + 0.0 for one in both))


def _jump(force: Callable[..., np.ndarray], places: np.ndarray, axis: int) -> str:
    """Return the place of a jump between neighbours on a grid along an axis, by halving distances, or an empty text."""
    near, far = np.split(np.stack([np.roll(places, 1, axis + 1), places]), 2)
    inner = [slice(None)] * 3
    inner[axis + 1] = slice(1, None)
    near, far = (one[0][tuple(inner)].reshape(2, -1) for one in (near, far))
    for _ in range(HALVINGS):
        middle = (near + far) / 2
        left, centre, right = (force(*one) for one in (near, middle, far))
        is_left = np.abs(centre - left) > np.abs(right - centre)
        changed = np.maximum(np.abs(centre - left), np.abs(right - centre)) > JUMP
        near, far = np.where(is_left, near, middle)[:, changed], np.where(is_left, middle, far)[:, changed]
        if not near.size:
            return ""
    return _place(np.isfinite(near[0]), *near)

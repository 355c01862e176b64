"""Gradients along a line, and the acceleration by the lowest one under a train, SUBSET-026, 3.13.4."""

from __future__ import annotations

from dataclasses import InitVar, dataclass

import numpy as np

from products.supervision.arguments import at_least, numbers
from readers.text import BadInputError, shown

#: Acceleration of gravity [m/s2]. SUBSET-026 prints 9.8; the test frames of ERA have 9.81.
GRAVITY = 9.81
#: Rotating mass where the train has no nominal one, uphill and downhill [% of the mass]: SUBSET-026, A.3.1.
ROTATING_UPHILL, ROTATING_DOWNHILL = 15.0, 2.0
#: Steepest gradient of a line [permille].
STEEPEST = 255.0
#: Units of gradients: permille in one.
UNITS = {"permille": 1.0, "1": 1000.0}


@dataclass(frozen=True)
class Gradients:
    """Gradients of a line: each holds from its place to the next one, the first also before it, the last also behind.

    Parameters
    ----------
    starts : ndarray
        Places [m], ascending, shape (n).
    permille : ndarray
        Gradients [unit], positive uphill, shape (n); the attribute is in permille.
    unit : str or None
        "permille", or "1" for rise over length, as in line files. None: permille, and gradients that are all flat
        enough for rise over length are refused.

    Raises
    ------
    BadInputError
        If a number is not finite, places do not ascend, or a gradient is steeper than 255 permille; if the unit is
        None and all gradients are below 0.255.
    """

    starts: np.ndarray
    permille: np.ndarray
    unit: InitVar[str | None] = None

    def __post_init__(self, unit: str | None) -> None:
        if unit is not None and not (isinstance(unit, str) and unit in UNITS):
            raise BadInputError(f'unit must be "permille" or "1"; got {shown(unit)}.')
        starts, permille = (np.atleast_1d(numbers("Gradients", one)) for one in (self.starts, self.permille))
        permille = permille * UNITS[unit or "permille"]
        if starts.shape != permille.shape or starts.ndim != 1:
            raise BadInputError(
                f"Gradients must have one place each; got {starts.size} places and {permille.size} gradients."
            )
        if not (np.all(np.isfinite(starts)) and np.all(np.diff(starts) > 0.0)):
            raise BadInputError(f"Places of gradients must ascend; got {shown(starts.tolist())}. Sort them.")
        if not np.all(np.abs(permille) <= STEEPEST):
            raise BadInputError(
                f"A gradient must be within -{STEEPEST:g} and {STEEPEST:g} permille; got {shown(permille.tolist())}. "
                "Give permille, not percent or a ratio."
            )
        steepest = float(np.abs(permille).max(initial=0.0))
        if unit is None and 0.0 < steepest < STEEPEST / 1000.0:
            raise BadInputError(
                f"Gradients must be in permille; got {shown(permille.tolist())}, all below {STEEPEST / 1000.0:g}. Give "
                '-10 for a fall of 1 in 100, or unit="1" for rise over length, or unit="permille" if they are so small.'
            )
        object.__setattr__(self, "starts", starts)
        object.__setattr__(self, "permille", permille)

    @classmethod
    def level(cls) -> Gradients:
        """Return those of a level line."""
        return cls(np.zeros(1), np.zeros(1))

    def lowest_under(self, length: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
        """Return the lowest gradient under a train over the place of its front, SUBSET-026, 3.13.4.2.

        Takes length [m] (...); returns places [m] (..., m), gradients [permille] (..., m + 1).
        """
        lengths, edges = at_least("length", length, 0.0, "m")[..., None], self.starts[1:]
        entering = np.broadcast_to(edges, (*lengths.shape[:-1], edges.size))
        places = np.sort(np.concatenate([entering, entering + lengths], axis=-1), axis=-1)
        # Between two places the same gradients are under the train: those at the middle.
        inside = (places[..., 1:] + places[..., :-1]) / 2.0
        front = np.concatenate([places[..., :1] - 1.0, inside, places[..., -1:] + 1.0], axis=-1)
        if not edges.size:
            front = np.zeros((*places.shape[:-1], 1))
        last, first = np.searchsorted(edges, front), np.searchsorted(edges, front - lengths, side="right")
        return places, _lowest(self.permille, first, last)


def _lowest(values: np.ndarray, first: np.ndarray, last: np.ndarray) -> np.ndarray:
    """Return the lowest of the values from `first` to `last`: the lower one of two runs of 2**n values."""
    runs = [values]
    while 2 ** len(runs) <= values.size:
        ahead = 2 ** (len(runs) - 1)
        runs.append(np.append(np.minimum(runs[-1][:-ahead], runs[-1][ahead:]), runs[-1][-ahead:]))
    size = np.frexp(last - first + 1)[1] - 1
    table = np.stack(runs)
    return np.minimum(table[size, first], table[size, last + 1 - 2**size])


def acceleration_by(permille: np.ndarray, rotating: np.ndarray | float | None) -> np.ndarray:
    """Return what a gradient adds to the deceleration of a train, SUBSET-026, 3.13.4.3.

    Takes permille [permille] (..., n), rotating [% of the mass] (...); returns [m/s2] (..., n).
    """
    if rotating is None:
        share = np.where(permille > 0.0, ROTATING_UPHILL, ROTATING_DOWNHILL)
    else:
        share = np.asarray(rotating, dtype=float)[..., None]
    return GRAVITY * permille / (1000.0 + 10.0 * share)

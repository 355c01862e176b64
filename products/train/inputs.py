"""The inputs of a train: arrays by name, to be written into or set as a whole."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fmu_src.suggestion import suggestion
from products.train.layout import INPUTS
from readers.usual import likely_unit

#: Inputs by name, with their limits.
BY_NAME = {input_.name: input_ for input_ in INPUTS}


class Inputs(Mapping[str, NDArray[np.float64]]):
    """Input arrays of a train. Setting one copies values into it: one for all places, or one each."""

    def __init__(self, arrays: Mapping[str, NDArray[np.float64]]) -> None:
        self._arrays = dict(arrays)

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """Return the array of an input. Raises KeyError for another name."""
        if name not in self._arrays:
            raise KeyError(f"A train has no input {name}; {suggestion(name, self._arrays)}")
        return self._arrays[name]

    def __setitem__(self, name: str, value: ArrayLike) -> None:
        """Copy one number for all places, or one for each. Raises KeyError, ValueError; the old values stay then."""
        array = self[name]
        self._check(name, value)
        array[:] = np.asarray(value, float)

    def __iter__(self) -> Iterator[str]:
        return iter(self._arrays)

    def __len__(self) -> int:
        return len(self._arrays)

    def __repr__(self) -> str:
        return repr(self._arrays)

    def _check(self, name: str, value: ArrayLike) -> None:
        least, most, whole = BY_NAME[name].least, BY_NAME[name].most, BY_NAME[name].whole
        try:
            given = np.asarray(value)
        except ValueError:  # rows of different lengths
            given = np.empty(0, object)
        if np.ma.is_masked(value) or given.dtype.kind not in ("biuf" if whole else "iuf"):
            raise ValueError(f"inputs['{name}'] must be numbers; got {value!r}. Write numbers, none of them masked.")
        if given.shape not in ((), self[name].shape):
            raise ValueError(
                f"inputs['{name}'] must be one number, or {self[name].size} of them, one for each place; got an array "
                f"of shape {given.shape}. Give another length."
            )
        values = np.broadcast_to(given, self[name].shape).astype(float)
        right = (least <= values) & (values <= most) & ((values == np.rint(values)) | (not whole))
        for place in np.flatnonzero(~right)[:1].tolist():
            raise ValueError(wrong_input(name, place, float(values[place])))


def wrong_input(name: str, place: int, value: float) -> str:
    """Return the message for a value of an input outside its limits."""
    one = BY_NAME[name]
    kind = "an integer from" if one.whole else "a number from"
    hint = "" if one.whole else likely_unit(value, one.unit, one.least, one.most)
    return f"inputs['{name}'][{place}] must be {kind} {one.least:g} to {one.most:g}; got {value:g}.{hint}"

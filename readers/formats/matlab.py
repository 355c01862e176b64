"""MATLAB files of versions 4 to 7 by SciPy: vectors, matrices and structs (`log_tree.py`). 7.3 is HDF5."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import chain, count
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import loadmat, savemat, whosmat
from scipy.io.matlab import MatlabFunction, MatlabOpaque, mat_struct
from scipy.sparse import issparse

from readers.formats.log_tree import METADATA, NAMES, UNITS, Leaf, columns_of, leaf_of
from readers.log_arrays import MOST_VALUES, RawColumn
from readers.text import FileError

#: Longest name of a variable of MATLAB, 63, less room for a number.
LONGEST_NAME = 57
#: Objects of classes of MATLAB, of which the file has no description that others can read.
OBJECT = "object of MATLAB such as a timetable: save its columns as vectors"


@contextmanager
def opened(path: Path) -> Iterator[list[RawColumn]]:
    """Yield the columns of a file."""
    size = sum(prod(shape) for _, shape, _ in whosmat(path, appendmat=False))
    if size > MOST_VALUES:
        raise FileError(f"{path} must have at most {MOST_VALUES} values; it has {size}. Save fewer variables.")
    read = loadmat(path, appendmat=False, squeeze_me=False, struct_as_record=False, chars_as_strings=True)
    tree = {name: node for name, value in read.items() if (node := _node(name, value)) is not None}
    yield columns_of({_name_of(name, read[name]): node for name, node in tree.items()})


def _name_of(name: str, value: Any) -> str:
    """Return the name of a variable; that of an object is in its value."""
    return str(value[0]["s0"].decode()) if isinstance(value, MatlabOpaque) and name == "None" else name


def _node(name: str, value: Any) -> Any:
    """Return a node of a tree; None for the header that MATLAB adds."""
    if name.startswith("__"):
        return None
    if isinstance(value, MatlabOpaque | MatlabFunction) or issparse(value):
        return Leaf((0,), lambda at, count: [], unusable="sparse matrix" if issparse(value) else OBJECT)
    if isinstance(value, mat_struct):
        return {key: _node("", getattr(value, key)) for key in value._fieldnames}
    if isinstance(value, np.ndarray) and value.dtype.kind == "O":
        parts = [_node("", one) for one in value.ravel()]
        return parts[0] if len(parts) == 1 else {f"({number})": part for number, part in enumerate(parts, 1)}
    if isinstance(value, np.ndarray) and value.dtype.kind == "U":
        return str(value.item()) if value.size == 1 else ""
    return leaf_of(value)


def write(
    path: Path, columns: Mapping[str, Sequence[Any]], units: Mapping[str, str], metadata: Mapping[str, str]
) -> None:
    """Write each column as a vector, with structs of units, of names that MATLAB does not allow, and of metadata."""
    keys = _keys([*columns])
    content: dict[str, Any] = {key: np.asarray(columns[name], float) for name, key in keys.items()}
    content[UNITS] = {key: units[name] for name, key in keys.items()}
    if others := {key: name for name, key in keys.items() if key != name}:
        content[NAMES] = others
    if metadata:
        content[METADATA] = {key: metadata[name] for name, key in _keys([*metadata]).items()}
    with path.open("wb") as file:
        savemat(file, content, long_field_names=True, do_compression=True, oned_as="column")


def _keys(names: Sequence[str]) -> dict[str, str]:
    """Return a name that MATLAB allows for each name, each once."""
    found: dict[str, str] = {}
    taken = {UNITS, NAMES, METADATA}
    for name in names:
        letters = re.sub(r"\W", "_", name, flags=re.ASCII)
        bare = (letters if letters[:1].isalpha() else f"x{letters}")[:LONGEST_NAME]
        found[name] = next(
            key for key in chain([bare], (f"{bare}_{number}" for number in count(2))) if key not in taken
        )
        taken.add(found[name])
    return found

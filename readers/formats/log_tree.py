"""Columns of files that have trees: groups or structs, arrays with their units, strings.

A struct with an array named data or values is a signal. Its name is its string `name` or `label`, otherwise that of the
struct, and its unit is its string `unit`. A time in it is its own. Other structs are groups. In a group `units` and
`names` are structs with a string for each array, and `speed_unit` beside `speed` is a string too. A matrix with a row
for each time is read as its columns, numbered from 1.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

from numpy.typing import NDArray

from readers.log_arrays import RawColumn, Values
from readers.log_words import FAMILIES

DATA, NAME, UNIT = ("data", "values", "value", "signal", "y"), ("name", "label", "signalname"), ("unit", "units")
TIME = {*FAMILIES[("time",)], "x"}
UNITS, NAMES, METADATA = "units", "names", "metadata"
#: Most columns of a matrix, and groups inside each other.
MOST_OF_MATRIX, DEEPEST = 32, 16


@dataclass(frozen=True)
class Leaf:
    """An array of a file.

    shape: rows, and columns of a matrix. read: returns the values of a column, or the first of them. unusable: why it
    cannot be a column; "": it can.
    """

    shape: tuple[int, ...]
    read: Callable[[int, int | None], Values] = field(repr=False)
    unit: str = ""
    unusable: str = ""


#: A node: a group, an array, or a string.
Node = Mapping[str, Any] | Leaf | str


def leaf_of(array: NDArray[Any]) -> Leaf:
    """Return an array in memory; a row is a column of it."""
    table = array.reshape(-1) if array.ndim == 2 and array.shape[0] == 1 else array
    unusable = "" if table.dtype.kind in "biuf" else f"array of {array.dtype}"[:60]

    def read(column: int, count: int | None) -> Values:
        values = table[:count] if table.ndim == 1 else table[:count, column]
        return [str(value) for value in values] if unusable else values

    return Leaf(table.shape, read, unusable=unusable)


def columns_of(tree: Mapping[str, Node]) -> list[RawColumn]:
    """Return the columns of a file in their order."""
    return list(_of_group(tree, ()))


def _of_group(group: Mapping[str, Any], path: tuple[str, ...]) -> Iterator[RawColumn]:
    units, names = (_texts(group.get(key)) for key in (UNITS, NAMES))
    for key, node in group.items():
        unit = units.get(key) or next((text for end in UNIT if (text := _text(group.get(f"{key}_{end}")))), "")
        name = names.get(key) or key
        if isinstance(node, Leaf):
            yield from _of_leaf(node, name, unit, path)
        elif isinstance(node, Mapping) and key not in (UNITS, NAMES, METADATA) and len(path) < DEEPEST:
            yield from _of_struct(node, name, unit, path)


def _of_struct(struct: Mapping[str, Any], name: str, unit: str, path: tuple[str, ...]) -> Iterator[RawColumn]:
    """Yield the columns of a signal, or of a group."""
    of_small = {key.casefold(): node for key, node in struct.items()}
    arrays = {key: node for key, node in of_small.items() if isinstance(node, Leaf)}
    strings = {key: text for key, node in of_small.items() if (text := _text(node))}
    data = next((arrays[word] for word in DATA if word in arrays), None)
    time = next((arrays[word] for word in arrays if word in TIME and arrays[word] is not data), None)
    others = [
        node for node in arrays.values() if data and node not in (data, time) and node.shape[:1] == data.shape[:1]
    ]
    if data is None or others or (time is None and not strings.keys() & {*NAME, *UNIT}):
        yield from _of_group(struct, (*path, name))
        return
    inner = path
    if time is not None and time.shape[:1] == data.shape[:1]:
        inner = (*path, name)
        yield from _of_leaf(time, "time", "", inner)
    label = next((strings[word] for word in NAME if word in strings), name)
    yield from _of_leaf(data, label, next((strings[word] for word in UNIT if word in strings), unit), inner)


def _of_leaf(leaf: Leaf, name: str, unit: str, path: tuple[str, ...]) -> Iterator[RawColumn]:
    """Yield the columns of an array; a single number is none."""
    shape = leaf.shape
    if len(shape) == 2 and shape[1] == 1:
        shape = shape[:1]
    size = shape[0] if shape else 1
    if leaf.unusable or len(shape) > 2 or (len(shape) == 2 and not 1 < shape[1] <= min(MOST_OF_MATRIX, size)):
        kind = leaf.unusable or f"array of {' x '.join(map(str, shape))}"
        yield RawColumn(name, "", 0, partial(leaf.read, 0), path, kind)
    elif size > 1:
        base = RawColumn(name, unit or leaf.unit, size, partial(leaf.read, 0), path)
        if len(shape) == 1:
            yield base
            return
        for at in range(shape[1]):
            yield replace(base, name=f"{name}_{at + 1}", read=partial(leaf.read, at))


def _text(node: Any) -> str:
    return node.strip() if isinstance(node, str) else ""


def _texts(node: Any) -> dict[str, str]:
    return {key: _text(value) for key, value in node.items()} if isinstance(node, Mapping) else {}

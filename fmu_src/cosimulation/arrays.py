"""Named arrays as tables: mappings, data frames, data sets and structured arrays, without their packages."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np

from fmu_src.cosimulation.recording import Recording
from readers.column_names import NUMBERED
from readers.columns import TableError
from readers.log_arrays import ArrayLog, RawColumn
from readers.log_columns import COMMON, ColumnMap, Head, head_of
from readers.logs import log_of
from readers.text import quoted, shown


def named_arrays(given: Any, source: str) -> dict[str, np.ndarray] | None:
    """Return columns by `name [unit]`, shape (rows,); None if it has no named columns.

    Units are in the names, or in `attrs` of a data frame or data set. A named index is a column. Raises TableError.
    """
    if isinstance(given, Recording):
        columns: dict[Any, Any] = {f"{name} [{given.units[name]}]": values for name, values in given.items()}
    elif isinstance(given, np.ndarray) and given.dtype.names:
        columns = {name: given[name] for name in given.dtype.names}
    elif hasattr(given, "data_vars") and hasattr(given, "coords"):
        named = {**given.coords, **given.data_vars}
        columns = {_with_unit(name, one.attrs.get("units")): one for name, one in named.items()}
    elif hasattr(given, "columns") and hasattr(given, "__getitem__"):
        units, index = getattr(given, "attrs", {}).get("units", {}), getattr(given, "index", None)
        label = getattr(index, "name", None)
        columns = {} if label is None else {_with_unit(label, units.get(label)): index}
        columns |= {_with_unit(name, units.get(name)): given[name] for name in given.columns}
    elif isinstance(given, Mapping):
        columns = dict(given)
    else:
        return None
    return _checked(columns, source)


def _with_unit(name: Any, unit: Any) -> str:
    """Return a name with its unit, if that is beside it."""
    text = str(name)
    return f"{text} [{unit}]" if unit and (not head_of(0, text).unit or NUMBERED.fullmatch(text)) else text


def _checked(columns: Mapping[Any, Any], source: str) -> dict[str, np.ndarray]:
    """Return columns as arrays of one length. Raises TableError."""
    if not columns:
        raise TableError(f"{source} must have at least one column; got none.")
    found = {}
    for name, values in columns.items():
        if not isinstance(name, str):
            raise TableError(f"{source} must have names of columns; got {shown(name)}. Write them as text.")
        if np.ma.is_masked(values):
            raise TableError(f"{source}: {quoted(name)} must have all its values; some are masked. Write NaN there.")
        try:
            array = np.asarray(values)
        except ValueError:  # rows of different lengths
            array = np.empty((0, 0))
        if array.ndim != 1:
            raise TableError(f"{source}: {quoted(name)} must be a column; got an array of shape {array.shape}.")
        found[name] = array
    if len(sizes := {array.size for array in found.values()}) > 1:
        raise TableError(f"{source} must have columns of one length; got {', '.join(map(str, sorted(sizes)))} values.")
    return found


def heads_of(arrays: Mapping[str, np.ndarray]) -> dict[str, Head]:
    """Return name and unit of each column, by its name. Raises TableError if two have one name."""
    heads = [head_of(at, name) for at, name in enumerate(arrays)]
    found = {head.name: head for head in heads}
    if twice := next((head for head in heads if found[head.name] is not head), None):
        raise TableError(f"{twice.name} must be one column; got {twice.cell} and {found[twice.name].cell}. Leave one.")
    return found


def recording_of(arrays: Mapping[str, np.ndarray], units: Mapping[str, str], source: str) -> Recording:
    """Return named arrays of numbers as a table; units: by name, of columns that state none. Raises TableError."""
    found = {name: head.unit or units.get(name, "1") for name, head in heads_of(arrays).items()}
    for name, values in arrays.items():
        if values.dtype.kind not in "biuf":
            raise TableError(f"{source}: {quoted(name)} must have numbers; got {shown(values[:1])}. Leave it out.")
    return Recording(found, np.column_stack([*arrays.values()]))


def log_from(
    arrays: Mapping[str, np.ndarray], variables: Mapping[str, str] | None, columns: ColumnMap | None, source: str
) -> Recording:
    """Return named arrays as a log, by the rules for files of logs; source: its name in messages. Raises TableError."""
    known = {"time": "s"} | dict(COMMON if variables is None else variables)
    raw = [RawColumn(name, "", values.size, partial(_first, values)) for name, values in arrays.items()]
    log = log_of(ArrayLog(source, "columns", raw), known, columns, variables is None)
    return Recording(log.units, np.column_stack(list(log.numbers.values())), log.messages)


def _first(values: np.ndarray, count: int | None) -> np.ndarray | list[str]:
    """Return the first values of a column, all if `count` is None; objects as text."""
    some = values[:count]
    return [_cell(value) for value in some.tolist()] if some.dtype.kind not in "biufmM" else some


def _cell(value: Any) -> str:
    if value is None or value != value:
        return ""
    return str(value.isoformat()) if hasattr(value, "isoformat") else str(value)

"""HDF5 by h5py: datasets with the attribute units, in groups (`log_tree.py`); so are .mat files of MATLAB 7.3."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from readers.formats.log_tree import DEEPEST, Leaf, columns_of
from readers.log_arrays import RawColumn, Values
from readers.text import FileError

#: Longest text of an attribute or a MATLAB char array, and most elements of a struct array or a cell array.
LONGEST, MOST_ELEMENTS = 1000, 1000
MATLAB_CLASS = "MATLAB_class"
OF_MATLAB = "#"
#: Attributes of the netCDF conventions.
FILL, SCALE, OFFSET = ("_FillValue", "missing_value"), "scale_factor", "add_offset"


@contextmanager
def opened(path: Path) -> Iterator[list[RawColumn]]:
    """Yield the columns of a file."""
    with h5py.File(path, "r") as file:
        yield columns_of(_group(file, ()))


def _group(group: Any, around: tuple[Any, ...]) -> dict[str, Any]:
    """Return the groups and datasets of a group; links to other files and to groups around it are left out."""
    inner = (*around, group)
    if MATLAB_CLASS in group.attrs and (size := _struct_array(group)):
        rows = [{name: _node(group.file[group[name][()].flat[at]], inner) for name in group} for at in range(size)]
        return {f"({number})": row for number, row in enumerate(rows, 1)}
    found = {}
    for name in group:
        is_inside = not isinstance(group.get(name, getlink=True), h5py.ExternalLink)
        node = group.get(name) if is_inside and not name.startswith(OF_MATLAB) else None
        if isinstance(node, h5py.Group | h5py.Dataset) and node not in inner and len(inner) <= DEEPEST:
            found[name] = _node(node, inner)
    return found


def _struct_array(group: Any) -> int:
    """Return the number of structs in a struct array of MATLAB; 0: it is none."""
    fields = [group.get(name) for name in group]
    sizes = {field.size if isinstance(field, h5py.Dataset) and field.dtype == h5py.ref_dtype else 0 for field in fields}
    is_cell = any(MATLAB_CLASS in field.attrs for field in fields)
    return sizes.pop() if len(sizes) == 1 and not is_cell and max(sizes) <= MOST_ELEMENTS else 0


def _node(dataset: Any, around: tuple[Any, ...]) -> Any:
    """Return a group, an array, a string, or the columns of a table."""
    if isinstance(dataset, h5py.Group):
        return _group(dataset, around)
    kind = _text(dataset.attrs.get(MATLAB_CLASS, ""))
    if dataset.attrs.get("MATLAB_empty", 0):
        return ""
    if kind == "char" and dataset.dtype.kind == "u" and dataset.size <= LONGEST:
        return dataset[()].tobytes().decode("utf-16-le" if dataset.dtype.itemsize == 2 else "latin-1", "replace")
    if dataset.dtype == h5py.ref_dtype:
        return _cells(dataset, around)
    if h5py.check_string_dtype(dataset.dtype) and dataset.shape == ():
        return _text(dataset[()])
    if dataset.dtype.names and len(dataset.shape) == 1:
        return {name: _leaf(dataset, dataset.dtype[name], name) for name in dataset.dtype.names}
    return _leaf(dataset, dataset.dtype, None)


def _cells(dataset: Any, around: tuple[Any, ...]) -> Any:
    """Return the elements of a cell array."""
    if dataset.size > MOST_ELEMENTS or len(around) > DEEPEST:
        return Leaf((0,), lambda at, count: [], unusable="cell array")
    nodes = [dataset.file[reference] for reference in dataset[()].ravel() if reference]
    parts = [_node(node, (*around, dataset)) for node in nodes if node not in around]
    return parts[0] if len(parts) == 1 else {f"({number})": part for number, part in enumerate(parts, 1)}


def _leaf(dataset: Any, dtype: Any, member: str | None) -> Leaf:
    """Return a dataset as an array; those of MATLAB have their columns first. member: of a table."""
    is_turned = MATLAB_CLASS in dataset.attrs and len(dataset.shape) == 2
    shape = dataset.shape[::-1] if is_turned else dataset.shape
    is_row = len(shape) == 2 and shape[0] == 1
    is_text = bool(h5py.check_string_dtype(dtype))
    unit = next((_text(dataset.attrs[name]) for name in dataset.attrs if name.casefold() in ("unit", "units")), "")

    def read(column: int, count: int | None) -> Values:
        rows = slice(count)
        source = dataset.fields(member) if member is not None else dataset
        if len(shape) < 2:
            values = source[rows]
        elif is_row:
            values = source[rows, 0] if is_turned else source[0, rows]
        else:
            values = source[column, rows] if is_turned else source[rows, column]
        return [_text(value) for value in values] if is_text else _unpacked(np.asarray(values), dataset.attrs)

    unusable = "" if is_text or dtype.kind in "biuf" else f"array of {dtype}"[:60]
    return Leaf(shape[::-1] if is_row else shape, read, unit if member is None else "", unusable)


def _unpacked(values: Any, about: Any) -> Any:
    """Return values as the netCDF conventions state them: NaN where they are missing, scaled and shifted."""
    fills = [np.asarray(about[name]).ravel() for name in FILL if name in about]
    if not fills and SCALE not in about and OFFSET not in about:
        return values
    numbers = values.astype(float)
    for fill in fills:
        numbers[np.isin(values, fill)] = np.nan
    return numbers * float(np.ravel(about.get(SCALE, 1.0))[0]) + float(np.ravel(about.get(OFFSET, 0.0))[0])


def _text(value: Any) -> str:
    first = np.ravel(value)[0] if isinstance(value, np.ndarray) and value.size else value
    text = first.decode("utf-8", "replace") if isinstance(first, bytes) else str(first)
    return text[:LONGEST].strip("\0 ")


def write(
    path: Path, columns: Mapping[str, Sequence[Any]], units: Mapping[str, str], metadata: Mapping[str, str]
) -> None:
    """Write each column as a dataset with the attribute units, and metadata as attributes of the file."""
    for name in columns:
        if "/" in name or name in ("", "."):
            raise FileError(f"names of HDF5 must not have a slash; got {name!r}. Rename the column.")
    with h5py.File(path, "w") as file:
        for name, text in metadata.items():
            file.attrs[name] = text
        for name, values in columns.items():
            file.create_dataset(name, data=np.asarray(values, float)).attrs["units"] = units[name]

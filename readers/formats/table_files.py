"""Tables written by the end of a file's name: CSV, Parquet, MATLAB, MDF4 and HDF5, each with units; logs read them."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from readers.column_names import HEAD_SQUARE
from readers.formats.logs import FORMATS
from readers.storage import whole_file
from readers.text import BLANK, REMARKS, FileError, quoted

CSV, PARQUET = ".csv", ".parquet"
#: Ends of names of files that are written.
ENDS = (CSV, PARQUET, ".mat", ".mf4", ".h5")


def check_end(path: Path) -> None:
    """Raise FileError if a table is not written by the end of a name, MissingExtraError if its package is missing."""
    end = path.suffix.lower()
    if end not in ENDS:
        raise FileError(
            f"{path} must end in one of {', '.join(ENDS)}; got {quoted(path.suffix or path.name)}. Rename it."
        )
    if end != CSV:
        FORMATS[end].load()


def write_columns(
    path: Path,
    columns: Mapping[str, Sequence[Any] | np.ndarray],
    units: Mapping[str, str],
    metadata: Mapping[str, str] | None = None,
) -> Path:
    """Write named columns whole or not at all, with all digits, in the format of the path's end.

    Columns with a unit have numbers, where NaN and None mean that there is no value. Others have strings, which CSV and
    Parquet alone can have. Raises FileError, MissingExtraError, StorageError.
    """
    check_end(path)
    end, about = path.suffix.lower(), dict(metadata or {})
    texts = [name for name in columns if name not in units]
    if texts and end not in (CSV, PARQUET):
        raise FileError(f"{path}: columns must have numbers and a unit; got {quoted(texts[0])}. Write a .csv.")
    write = _write_csv if end == CSV else FORMATS[end].load().write
    with whole_file(path) as partial:
        try:
            write(partial, columns, units, about)
        except FileError as error:
            raise FileError(f"{path}: {error}") from None
    return path


def _write_csv(
    path: Path, columns: Mapping[str, Sequence[Any] | np.ndarray], units: Mapping[str, str], metadata: Mapping[str, str]
) -> None:
    """Write remarks, names with units, and rows; an empty cell where a value is missing. Raises FileError."""
    for name in columns:
        match = HEAD_SQUARE.fullmatch(f"{name} [1]")
        is_whole = match is not None and match["name"].strip(BLANK) == name
        if not (is_whole and name and name.isprintable()) or name.startswith(REMARKS):
            limit = "a name must be printable, without brackets, and not begin as a remark"
            raise FileError(f"{limit}; got {quoted(name)}. Rename the column.")
    with path.open("w", newline="", encoding="utf-8") as file:
        for name, text in metadata.items():
            file.writelines(f"# {name}: {line}\n" for line in text.splitlines() or [""])
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([f"{name} [{units[name]}]" if name in units else name for name in columns])
        writer.writerows(zip(*map(_cells, columns.values()), strict=True))


def _cells(values: Sequence[Any] | np.ndarray) -> list[Any]:
    """Return cells, numbers with the digits that give them back."""
    plain = values.tolist() if isinstance(values, np.ndarray) else values
    return ["" if isinstance(one, float) and math.isnan(one) else one for one in plain]

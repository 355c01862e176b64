"""The table of a sweep: CSV with units in its heads, Parquet with units in its fields, and one JSON beside them."""

import csv
import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from products.study.points import Outcome, Point
from readers.documents import document_text
from readers.storage import remove_partial, write_whole

FILES = ("table.csv", "table.parquet", "summary.json")
#: Name of the last column: why a point has no results.
FAILURE = "failure"
Column = Sequence[float | str | None]


def write_table(
    folder: Path,
    units: Mapping[str, str],
    points: Sequence[Point],
    outcomes: Sequence[Outcome],
    summary: Mapping[str, Any],
) -> list[str]:
    """Write the files and return their names; without pyarrow there is no Parquet. units: of the columns, by name.

    Rows have parameters and results only: the same sweep gives the same bytes. Each file is there as a whole or
    not at all, and summary.json, by which a report finds the table, last.
    """
    rows = [{**(outcome.results or {}), **point} for point, outcome in zip(points, outcomes, strict=True)]
    columns: dict[str, Column] = {name: [row.get(name) for row in rows] for name in units}
    columns[FAILURE] = [outcome.failure for outcome in outcomes]
    contents = (_csv(units, columns), _parquet(units, columns), document_text(summary).encode())
    written = {name: content for name, content in zip(FILES, contents, strict=True) if content is not None}
    remove_table(folder)
    for name, content in written.items():
        write_whole(folder / name, content)
    return list(written)


def remove_table(folder: Path) -> None:
    """Delete a table of an earlier sweep, and partial files of a killed one, before another event log begins."""
    for name in reversed(FILES):
        (folder / name).unlink(missing_ok=True)
    remove_partial(folder)


def _csv(units: Mapping[str, str], columns: Mapping[str, Column]) -> bytes:
    """Return the table as CSV: floats with all their digits (repr); an empty cell if a value is missing."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([*(f"{name} [{unit}]" for name, unit in units.items()), FAILURE])
    writer.writerows(zip(*columns.values(), strict=True))
    return text.getvalue().encode()


def _parquet(units: Mapping[str, str], columns: Mapping[str, Column]) -> bytes | None:
    """Return columns of doubles, each with its unit in the metadata of its field; None without pyarrow."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        return None
    fields = [pyarrow.field(name, pyarrow.float64(), metadata={"unit": unit}) for name, unit in units.items()]
    schema = pyarrow.schema([*fields, pyarrow.field(FAILURE, pyarrow.string())])
    sink = pyarrow.BufferOutputStream()
    pyarrow.parquet.write_table(pyarrow.table(list(columns.values()), schema=schema), sink)
    return bytes(sink.getvalue().to_pybytes())

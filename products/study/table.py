"""The table of a sweep: CSV with units in its heads, Parquet with units in its fields, and one JSON beside them."""

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from products.study.points import Outcome, Point
from readers.documents import document_text
from readers.storage import remove_partial, write_whole

FILES = ("table.csv", "table.parquet", "summary.json")
#: Name of the last column: why a point has no results.
FAILURE = "failure"
Rows = Sequence[tuple[Point, Outcome]]


def write_table(folder: Path, units: Mapping[str, str], rows: Rows, summary: Mapping[str, Any]) -> list[str]:
    """Writes the files and returns their names; without pyarrow there is no Parquet.

    units: of the columns, by their names.
    Rows come in the order of the grid and hold nothing but parameters and results: the same sweep gives the same bytes.
    Each file is there as a whole or not at all, and summary.json, by which a report knows the table, last.
    """
    columns = {name: [_value(name, *row) for row in rows] for name in units}
    failures = [outcome.failure for _, outcome in rows]
    contents = {"table.csv": _csv(units, columns, failures), "table.parquet": _parquet(units, columns, failures)}
    contents["summary.json"] = document_text(summary).encode()
    written = {name: content for name, content in contents.items() if content is not None}
    remove_table(folder)
    for name, content in written.items():
        write_whole(folder / name, content)
    return list(written)


def remove_table(folder: Path) -> None:
    """Delete a table of an earlier sweep, and partial files of a killed one, before another log begins."""
    for name in reversed(FILES):
        (folder / name).unlink(missing_ok=True)
    remove_partial(folder)


def _value(name: str, point: Point, outcome: Outcome) -> float | None:
    return point[name] if name in point else (outcome.results or {}).get(name)


def _csv(
    units: Mapping[str, str], columns: Mapping[str, Sequence[float | None]], failures: Iterable[str | None]
) -> bytes:
    """Return the table as CSV: floats with all their digits (repr); an empty cell if a value is missing."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([*(f"{name} [{unit}]" for name, unit in units.items()), FAILURE])
    for *values, failure in zip(*columns.values(), failures, strict=True):
        writer.writerow([*("" if value is None else repr(value) for value in values), failure or ""])
    return text.getvalue().encode()


def _parquet(
    units: Mapping[str, str], columns: Mapping[str, Sequence[float | None]], failures: Sequence[str | None]
) -> bytes | None:
    """Return columns of doubles, each with its unit in the metadata of its field; None without pyarrow."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        return None
    fields = [pyarrow.field(name, pyarrow.float64(), metadata={"unit": unit}) for name, unit in units.items()]
    fields.append(pyarrow.field(FAILURE, pyarrow.string()))
    table = pyarrow.table([*columns.values(), failures], schema=pyarrow.schema(fields))
    sink = pyarrow.BufferOutputStream()
    pyarrow.parquet.write_table(table, sink)
    return bytes(sink.getvalue().to_pybytes())

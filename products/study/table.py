"""The table of a sweep: CSV with units in its heads, Parquet with units in its fields, and one JSON beside them."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from fmu_src.cosimulation.provenance_text import KEY, metadata_of
from products.study.points import Outcome, Point
from readers.documents import document_text
from readers.extras import MissingExtraError
from readers.formats.table_files import write_columns
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
    provenance: Mapping[str, Any],
) -> list[str]:
    """Write the files and return their names; without pyarrow there is no Parquet. units: of the columns, by name.

    Rows have parameters and results only: the same sweep gives the same bytes. Each file is there as a whole or
    not at all, and summary.json, by which a report finds the table, last.
    """
    rows = [{**(outcome.results or {}), **point} for point, outcome in zip(points, outcomes, strict=True)]
    columns: dict[str, Column] = {name: [row.get(name) for row in rows] for name in units}
    columns[FAILURE] = [outcome.failure for outcome in outcomes]
    remove_table(folder)
    written = []
    for name in FILES[:-1]:
        with suppress(MissingExtraError):
            written.append(write_columns(folder / name, columns, units, metadata_of(provenance, name)).name)
    document = dict(summary) | ({KEY: dict(provenance)} if provenance else {})
    write_whole(folder / FILES[-1], document_text(document).encode())
    return [*written, FILES[-1]]


def remove_table(folder: Path) -> None:
    """Delete a table of an earlier sweep, and partial files of a killed one, before another event log begins."""
    for name in reversed(FILES):
        (folder / name).unlink(missing_ok=True)
    remove_partial(folder)

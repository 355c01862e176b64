"""Parquet by pyarrow: columns with units in the metadata of their fields, as here, or in `attrs["units"]` of pandas."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
from pyarrow import types

from readers.log_arrays import RawColumn, Values

#: Name by which pandas writes an index that has none.
NAMELESS_INDEX = "__index_level_0__"


@contextmanager
def opened(path: Path) -> Iterator[list[RawColumn]]:
    """Yield the columns of a file."""
    with pq.ParquetFile(path) as file:
        schema = file.schema_arrow
        units = _units_of_pandas(schema.metadata or {})
        yield [_column(file, field, units) for field in schema]


def _column(file: Any, field: Any, units: Mapping[str, Any]) -> RawColumn:
    is_time = types.is_timestamp(field.type) or types.is_duration(field.type)
    name = "time" if field.name == NAMELESS_INDEX and is_time else field.name
    unit = (field.metadata or {}).get(b"unit", str(units.get(field.name, "")).encode()).decode("utf-8", "replace")
    unusable = f"column of {field.type}"[:60] if types.is_nested(field.type) or types.is_binary(field.type) else ""
    return RawColumn(name, unit, file.metadata.num_rows, partial(_values, file, field), unusable=unusable)


def _units_of_pandas(metadata: Mapping[bytes, bytes]) -> Mapping[str, Any]:
    try:
        units = json.loads(metadata.get(b"PANDAS_ATTRS", b"{}")).get("units", {})
    except (ValueError, AttributeError):
        return {}
    return units if isinstance(units, dict) else {}


def _values(file: Any, field: Any, count: int | None) -> Values:
    """Return values of a column: text, times, integers without gaps, or numbers."""
    if count is None:
        column = file.read(columns=[field.name]).column(0)
    else:
        column = pa.chunked_array([next(file.iter_batches(batch_size=count, columns=[field.name])).column(0)])
    if types.is_dictionary(column.type):
        column = column.cast(column.type.value_type)
    kind = column.type
    if types.is_string(kind) or types.is_large_string(kind) or types.is_null(kind):
        return [cell or "" for cell in column.to_pylist()]
    if types.is_timestamp(kind) or types.is_duration(kind) or (types.is_integer(kind) and not column.null_count):
        return column.to_numpy()
    if types.is_date(kind):
        return column.cast(pa.timestamp("ms")).to_numpy()
    if types.is_time(kind):
        return [str(cell.as_py() or "") for cell in column]
    return column.cast(pa.float64()).to_numpy()


def write(
    path: Path, columns: Mapping[str, Sequence[Any]], units: Mapping[str, str], metadata: Mapping[str, str]
) -> None:
    """Write columns; those without a unit are text."""
    fields = [
        pa.field(name, pa.float64(), metadata={"unit": units[name]}) if name in units else pa.field(name, pa.string())
        for name in columns
    ]
    schema = pa.schema(fields, dict(metadata) or None)
    pq.write_table(pa.table(list(columns.values()), schema=schema), path)

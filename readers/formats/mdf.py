"""MDF of versions 2 to 4 by asammdf: channel groups, each with its own times and physical values."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from traceback import walk_tb
from typing import Any
from xml.sax.saxutils import escape

import numpy as np
from asammdf import MDF, Signal

from readers.log_arrays import RawColumn, Values
from readers.text import FileError

VERSION = "4.10"
#: Types of channels that have no place in a record: times and values by the number of the record.
VIRTUAL = (3, 6)
#: Name of the times in the message about a table without them.
TIME = "time"


@contextmanager
def opened(path: Path) -> Iterator[list[RawColumn]]:
    """Yield the channels of a file, each group with its times."""
    try:
        file = MDF(path)
    except Exception as error:
        _close_half_made(error)
        raise
    with file:
        names = [_name_of(group.channel_group) for group in file.groups]
        paths = [f"{name or 'group'} {at}" if names.count(name) > 1 else name for at, name in enumerate(names, 1)]
        yield [
            column
            for number, group in enumerate(file.groups)
            for column in _of_group(file, number, group, (paths[number],) if len(paths) > 1 else ())
        ]


def _name_of(group: Any) -> str:
    """Return the name of a channel group, or the comment that stands for it."""
    return str(getattr(group, "acq_name", "") or getattr(group, "comment", "") or "").strip()[:40]


def _close_half_made(error: Exception) -> None:
    """Close objects that could not be made: their destructors would print an exception of their own."""
    for frame, _ in walk_tb(error.__traceback__):
        half_made = frame.f_locals.get("self")
        if half_made is not None and hasattr(half_made, "_closed"):
            half_made._closed = True
            if (temporary := getattr(half_made, "_tempfile", None)) is not None:
                temporary.close()


def _of_group(file: Any, number: int, group: Any, path: tuple[str, ...]) -> Iterator[RawColumn]:
    _check_places(group)
    rows = int(group.channel_group.cycles_nr)
    master = file.masters_db.get(number)
    is_timed = master is not None or getattr(group.channel_group, "cg_master_index", None) is not None
    if is_timed:
        yield RawColumn(TIME, "s", rows, partial(_times, file, number), path)
    for index, channel in enumerate(group.channels):
        if index != master:
            read = partial(_values, file, number, index)
            unit = channel.unit or getattr(channel.conversion, "unit", "") or ""
            beside = "beside the times of its group" if is_timed and channel.name == TIME else ""
            yield RawColumn(channel.name, str(unit), rows, read, path, beside)


def _check_places(group: Any) -> None:
    """Check that all channels are within their records, as asammdf does not. Raises ValueError."""
    size = int(group.channel_group.samples_byte_nr)
    for channel in group.channels:
        place = getattr(channel, "byte_offset", None)  # of version 4
        if place is None:
            place = channel.start_offset // 8 + getattr(channel, "additional_byte_offset", 0)
        is_stored = channel.channel_type not in VIRTUAL
        if is_stored and not (0 <= place < size and channel.bit_count <= 8 * (size - place)):
            raise ValueError(f"the channel {channel.name[:40]} is not within its record of {size} bytes")


def _times(file: Any, group: int, count: int | None) -> Values:
    return np.asarray(file.get_master(group, record_count=count), float)


def _values(file: Any, group: int, index: int, count: int | None) -> Values:
    """Return physical values; those that the file marks as invalid are NaN. Arrays and structures are text."""
    raw = file.get(group=group, index=index, record_count=count, raw=True, ignore_invalidation_bits=True)
    signal = raw.physical(copy=False, ignore_value2text_conversions=True)
    values = signal.samples
    if values.dtype.names or values.ndim > 1 or values.dtype.kind not in "biuf":
        return [_cell(value) for value in values]
    if signal.invalidation_bits is not None and np.any(invalid := np.asarray(signal.invalidation_bits, bool)):
        values = np.where(invalid, np.nan, values.astype(float))
    return values


def _cell(value: Any) -> str:
    return value.decode("utf-8", "replace").strip("\0 ") if isinstance(value, bytes) else str(value)


def write(
    path: Path, columns: Mapping[str, Sequence[Any]], units: Mapping[str, str], metadata: Mapping[str, str]
) -> None:
    """Write a channel group with the column time as its times. Raises FileError without it."""
    if TIME not in columns or units[TIME] != "s" or not np.all(np.isfinite(np.asarray(columns[TIME], float))):
        raise FileError("an MDF file must have the times of its rows, time [s]; got none. Write a .parquet.")
    times = np.asarray(columns[TIME], float)
    signals = [
        Signal(np.asarray(values, float), times, name=name, unit=units[name])
        for name, values in columns.items()
        if name != TIME
    ]
    with MDF(version=VERSION) as file:
        text = escape("\n".join(f"{name}: {value}" for name, value in metadata.items()))
        file.header.comment = f"<HDcomment><TX>{text}</TX></HDcomment>"
        file.append(signals, common_timebase=True)
        ended = path.with_name(f"{path.name}.mf4")  # asammdf writes to no other end
        try:
            file.save(ended, overwrite=True)
            ended.replace(path)
        finally:
            ended.unlink(missing_ok=True)

"""Slices files of CONTACT, .slcs and .slcw: profiles that change along a rail or around a wheel."""

from __future__ import annotations

import re
from pathlib import Path

from readers.columns import TableError
from readers.contours import Rows

SLICE = re.compile(r"^\s*([-+.\dEe]+)\s+(['\"])([^'\"]+)\2")
COUNT = re.compile(r"^\s*\d+\s+NSLC\b")


def is_slices(rows: Rows) -> bool:
    """Return whether rows are those of a slices file: one states the number of slices."""
    return any(COUNT.match(row) for _, row in rows)


def slice_of(rows: Rows, source: str, number: int | None) -> tuple[Path, str]:
    """Return the path of one slice, and a note; slices are numbered from 1."""
    names = [(found[1], found[3]) for _, row in rows if (found := SLICE.match(row))]
    if number is None or not 1 <= number <= len(names):
        one = f"one of its {len(names)} slices, as in {source}#1" if names else "one slice"
        raise TableError(
            f"{source} must hold one profile; it holds profiles that change along the rail or around the wheel. Give "
            f"{one}."
        )
    place, name = names[number - 1]
    return Path(
        source
    ).parent / name, f"slice {number} of {len(names)} was read, that at {place} of {Path(source).name}"

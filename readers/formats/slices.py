"""Slices files of CONTACT, .slcs and .slcw: profiles that change along a rail or around a wheel."""

from __future__ import annotations

import re

from readers.contours import Rows
from readers.tables import TableError
from readers.text import quoted

SLICE = re.compile(r"^\s*[-+.\dEe]+\s+(['\"])([^'\"]+)\1")
COUNT = re.compile(r"^\s*\d+\s+NSLC\b")


def is_slices(rows: Rows) -> bool:
    """Return whether rows are those of a slices file: one states the number of slices."""
    return any(COUNT.match(row) for _, row in rows)


def refusal_of(rows: Rows, source: str) -> TableError:
    """Return the error of a slices file: a vehicle runs on profiles that are the same everywhere."""
    names = [found[2] for _, row in rows if (found := SLICE.match(row))]
    one = f"one of its {len(names)} slices, such as {quoted(names[0])}" if names else "one slice"
    return TableError(
        f"{source} must hold one profile; it holds profiles that change along the rail or around the wheel. Give {one}."
    )

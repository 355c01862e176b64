"""Contours of wheels and rails from files: tables of y and z, files of SIMPACK and of the MiniProf.

`readers.formats` has a module for each format. Keys of a header that change the meaning of the numbers are applied or
refused; what has no effect is stated in the contour's notes.
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

from readers.columns import TableError
from readers.contours import FEWEST_POINTS as FEWEST_POINTS
from readers.contours import LARGEST_BREADTH as LARGEST_BREADTH
from readers.contours import Contour, check_one_contour, other_kind
from readers.formats import columns, miniprof, simpack, slices
from readers.outliers import outliers
from readers.text import rows_of, text_of

#: Largest file [bytes].
LARGEST_FILE = 20_000_000
#: Kind of profile by the ending of a file's name.
KINDS = dict.fromkeys((".prw", ".whl", ".whe", ".slcw"), "wheel") | dict.fromkeys(
    (".prr", ".ban", ".rail", ".rai", ".slcs"), "rail"
)
#: A path and the number of a profile behind it.
PART = re.compile(r"(.+)#(\d{1,4})")


def read_contour(path: str | Path, kind: str = "", drop_outliers: bool = False) -> Contour:
    """Read the points of a profile."""
    name, part = str(path), None
    if not Path(path).exists() and (found := PART.fullmatch(name)) and Path(found[1]).exists():
        name, part = found[1], int(found[2])
    ending = KINDS.get(Path(name).suffix.lower(), "")
    return contour_of(text_of(name, LARGEST_FILE), name, kind, ending, part, drop_outliers)


def contour_of(
    text: str, source: str, kind: str = "", ending: str = "", part: int | None = None, drop_outliers: bool = False
) -> Contour:
    """Read the points of a profile from a file's text, as `read_contour` does."""
    rows = list(rows_of(text, source))
    if kind and ending not in ("", kind) and not simpack.is_simpack(rows):
        raise other_kind(source, kind, ending, f"its name ends in {Path(source).suffix}")
    if slices.is_slices(rows):
        path, note = slices.slice_of(rows, source, part)
        found = read_contour(path, kind or ending, drop_outliers)
        return replace(found, notes=(note, *found.notes))
    if part is not None and not miniprof.is_mpt(text):
        raise TableError(f"{source} must have several profiles if one is chosen; it has one. Leave #{part} out.")
    if simpack.is_simpack(rows):
        found = simpack.read(rows, source, kind or ending)
    elif miniprof.is_mpt(text):
        found = miniprof.read_mpt(rows, source, kind, part, columns.key_and_value)
    else:
        found = columns.read(rows, text, source, kind)
    if not (found.kind or ending):
        raise TableError(f"{source} must be known as the profile of a wheel or of a rail. Give kind.")
    found = replace(found, kind=found.kind or ending)
    if len(found.points) < FEWEST_POINTS:
        raise TableError(f"{source} must have at least {FEWEST_POINTS} points after its header's changes.")
    check_one_contour(source, 1e3 * found.points, found.places)
    return _without_outliers(found, drop_outliers)


def _without_outliers(contour: Contour, drop: bool) -> Contour:
    """Return a contour without outliers if they are to be dropped."""
    found = outliers(1e3 * contour.points)
    if not found:
        return contour
    worst, off = max(found, key=lambda one: one[1])
    y, z = 1e3 * contour.points[worst]
    where = f"y = {y:.6g} mm, z = {z:.6g} mm"
    more = f"; {len(found)} points do so, the first in row {contour.places[found[0][0]]}" if len(found) > 1 else ""
    if not drop:
        raise TableError(
            f"{contour.source}, row {contour.places[worst]}: points must lie on the contour of their neighbours; "
            f"{where} lies {off:.3g} mm off it{more}. Correct or remove them, or drop outliers (--drop-outliers)."
        )
    out = {index for index, _ in found}
    kept = [i for i in range(len(contour.points)) if i not in out]
    rows = ", ".join(str(contour.places[i]) for i in sorted(out)[:8]) + (" and more" if len(out) > 8 else "")
    note = f"outliers were dropped, up to {off:.3g} mm off at {where}: rows {rows}"
    return replace(contour, points=contour.points[kept], places=contour.places[kept], notes=(*contour.notes, note))

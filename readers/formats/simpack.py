"""Profiles of SIMPACK, .prw and .prr: a header, a block `spline` with changes of the points, a block `point`.

The changes are made in the order that the comments of the files number: least distance of points, shift, rotation about
the origin, bounds, mirrors, units. Meaning of the keys: comments in public files, and the reader of CONTACT.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from readers.contours import (
    Contour,
    ContourRows,
    Points,
    Rows,
    check_without_effect,
    read_points,
    refusal,
    unit_of,
    unknown_keys,
)
from readers.decimal_numbers import is_decimal, number_of
from readers.text import quoted

TYPES = {0.0: "rail", 1.0: "wheel"}
VERSION = 1.0
BLOCKS = ("header", "spline", "point")
#: Keys of numbers that are applied, and their values if they are missing.
NUMBERS = {
    "point.dist.min": 0.0,
    "shift.y": 0.0,
    "shift.z": 0.0,
    "rotate": 0.0,
    "bound.y.min": 1.0,
    "bound.y.max": 0.0,
    "bound.z.min": 1.0,
    "bound.z.max": 0.0,
    "mirror.y": 0.0,
    "mirror.z": 0.0,
    "approx.smooth": 0.0,
    "inversion": 0.0,
}
FLAGS = ("mirror.y", "mirror.z", "inversion")
#: Keys of the spline block that name the origin of the points; `meas.pos` is where an instrument measures.
SILENT = ("file", "file.mtime", "comment", "type", "meas.pos.e", "meas.pos.qr")
UNITS = ("units.len", "units.len.f", "units.ang", "units.ang.f")
ANGLES = {"rad": 1.0, "deg": 180 / math.pi, "degree": 180 / math.pi, "degrees": 180 / math.pi, "grad": 180 / math.pi}


def is_simpack(rows: Rows) -> bool:
    """Return whether rows are those of a SIMPACK profile: one begins a block."""
    return any(row.split("!")[0].strip() in [f"{block}.begin" for block in BLOCKS] for _, row in rows)


@dataclass
class _File:
    """Values of the header by key, with their rows, and the rows of points."""

    source: str
    values: dict[str, tuple[int, str]] = field(default_factory=dict)
    body: Rows = field(default_factory=list)
    unknown: list[str] = field(default_factory=list)

    def number(self, key: str, default: float) -> float:
        """Return the number of a key; an empty value is the default."""
        at, value = self.values.get(key, (0, ""))
        if not value:
            return default
        if not is_decimal(value) or not math.isfinite(number_of(value)):
            raise refusal(self.source, at, f"{key} must be a finite number; got {quoted(value)}. Correct or remove it.")
        return number_of(value)


def read(rows: Rows, source: str, kind: str) -> Contour:
    """Return the contour of a SIMPACK profile."""
    file = _blocks(rows, source)
    found = _check_header(file, kind)
    scale, angle, notes = _units(file)
    body = ContourRows(source, found, file.body, ("x", "y", "weight"), scale)
    points, places, told = read_points(body)
    per_mm = 1e3 if scale is None and any("metres" in note for note in told) else (scale or (1.0, 1.0))[0]
    to_mm = per_mm / (scale or (1.0, 1.0))[1]
    points, places, changed = _changed(file, points, places, to_mm, angle)
    notes += told + _weights(file) + changed + unknown_keys(file.unknown)
    return Contour(source, points / 1e3, places, tuple(notes), kind=found)


def _blocks(rows: Rows, source: str) -> _File:
    """Return the content of the blocks, which begin with NAME.begin and end with NAME.end."""
    file, blocks, seen = _File(source), [], set()
    for at, row in rows:
        line = row.split("!")[0].strip()
        word, _, what = line.partition(".")
        if what == "begin":
            if word in seen:
                raise refusal(source, at, f"a second block {word} begins; a file must hold one profile. Split it.")
            seen.add(word)
            blocks.append(word)
        elif what == "end" and blocks:
            blocks.pop()
        elif blocks and blocks[-1] == "point":
            if line:
                file.body.append((at, line))
        elif line:
            _take(file, at, blocks[-1] if blocks else "", line)
    if blocks:
        raise refusal(
            source, rows[-1][0], f"the block {blocks[-1]} must end with {blocks[-1]}.end; the file ends. Complete it."
        )
    return file


def _take(file: _File, at: int, block: str, line: str) -> None:
    """Keep the value of a known key; note one without effect, refuse one that would change the points."""
    key, _, value = line.partition("=")
    key, value = key.strip().lower(), value.strip().strip("'\"").strip()
    if block == "header":
        file.values[f"header.{key}"] = at, value
        if key not in ("version", "type", *SILENT):
            file.unknown.append(key)
    elif key in NUMBERS or key in UNITS:
        file.values[key] = at, value
    elif key not in SILENT:
        check_without_effect(file.source, at, key, value)
        file.unknown.append(key)


def _check_header(file: _File, kind: str) -> str:
    """Check type and version; return the kind."""
    at, value = file.values.get("header.type", (0, ""))
    found = TYPES.get(number_of(value)) if value and is_decimal(value) else None
    if value and (found is None or kind not in ("", found)):
        wanted = f"that of a {kind}" if kind else "known"
        raise refusal(file.source, at, f"type must be {wanted} (0: rail, 1: wheel); got {quoted(value)}.")
    version = file.number("header.version", VERSION)
    if version != VERSION:
        file.unknown.append(f"version = {version:g}, read as version {VERSION:g}")
    for key in FLAGS:
        if file.number(key, 0.0) not in (0.0, 1.0):
            at, value = file.values[key]
            raise refusal(file.source, at, f"{key} must be 0 or 1; got {quoted(value)}. Correct it.")
    return found or kind


def _units(file: _File) -> tuple[tuple[float, float] | None, float, list[str]]:
    """Return the factor of lengths to mm as a fraction, or None if unknown, angle units a radian, and notes."""
    lengths = _per_si(file, "units.len.f", "1000 for mm")
    at, name = file.values.get("units.len", (0, ""))
    named = unit_of(file.source, at, "units.len", name) if name else None
    if lengths and named and not math.isclose(named[0] / named[1], 1e3 / lengths, rel_tol=1e-9):
        raise refusal(
            file.source,
            at,
            f"units.len must be the unit of units.len.f = {lengths:g} a metre; got {name}. Correct one.",
        )
    scale = (1e3, lengths) if lengths else named
    turned = file.number("rotate", 0.0)
    angles = _per_si(file, "units.ang.f", "1 for rad")
    at, name = file.values.get("units.ang", (0, ""))
    if turned and name and name.lower() not in ANGLES:
        raise refusal(file.source, at, f"units.ang must be rad or deg; got {quoted(name)}. Correct it.")
    known = ANGLES.get(name.lower())
    if turned and angles and known and not math.isclose(angles, known, rel_tol=1e-3):
        raise refusal(
            file.source,
            at,
            f"units.ang must be the unit of units.ang.f = {angles:g} a radian; got {name}. Correct one.",
        )
    notes = [] if scale or not file.body else ["the header has no unit of length"]
    return scale, angles or known or 1.0, notes


def _per_si(file: _File, key: str, example: str) -> float | None:
    """Return a factor of the user's unit to SI, above 0, or None if the key is missing."""
    if key not in file.values or not file.values[key][1]:
        return None
    at, value = file.values[key]
    number = number_of(value) if is_decimal(value) else math.nan
    if not 0.0 < number < math.inf:
        raise refusal(file.source, at, f"{key} must be above 0, {example}; got {quoted(value)}. Correct it.")
    return number


def _changed(
    file: _File, points: Points, places: NDArray[np.int64], to_mm: float, angle: float
) -> tuple[Points, NDArray[np.int64], list[str]]:
    """Return points [mm] after the changes of the header, their rows, and a note for each change."""
    value = {key: file.number(key, default) for key, default in NUMBERS.items()}
    notes = []
    if value["point.dist.min"] > 0.0:
        kept = _apart(points, value["point.dist.min"] * to_mm)
        if removed := len(points) - len(kept):
            notes.append(f"point.dist.min = {value['point.dist.min']:g} was applied: it removed {removed} points")
        points, places = points[kept], places[kept]
    for axis, key in enumerate(("shift.y", "shift.z")):
        if value[key]:
            points = points + to_mm * value[key] * np.eye(2)[axis]
            notes.append(f"{key} = {value[key]:g} was applied")
    if value["rotate"]:
        turn = value["rotate"] / angle
        cosine, sine = math.cos(turn), math.sin(turn)
        points = points @ np.array([[cosine, sine], [-sine, cosine]])
        notes.append(f"rotate = {value['rotate']:g} was applied, {turn:.6g} rad about the origin from y to z")
    points, places, cut = _bounded(file, points, places, to_mm, value)
    signs = [1.0 - 2.0 * value["mirror.y"], 1.0 - 2.0 * value["mirror.z"]]
    notes += cut + [f"{key} = 1 was applied" for key in FLAGS[:2] if value[key]]
    if value["approx.smooth"]:
        notes.append(
            f"approx.smooth = {value['approx.smooth']:g} has no effect: the smoothing is that of this project's spline"
        )
    return points * signs, places, notes


def _apart(points: Points, least: float) -> NDArray[np.int64]:
    """Return the indices of points that are `least` or more from the one kept before."""
    kept = [0]
    for i in range(1, len(points)):
        if np.hypot(*(points[i] - points[kept[-1]])) >= least:
            kept.append(i)
    return np.array(kept)


def _bounded(
    file: _File, points: Points, places: NDArray[np.int64], to_mm: float, value: dict[str, float]
) -> tuple[Points, NDArray[np.int64], list[str]]:
    """Cut points beyond the bounds of y; bounds are on if min is below max.

    Programs differ in what they do beyond the bounds of z: some cut, some move the points to the bound. Points there
    are refused.
    """
    notes = []
    for column, axis in enumerate("yz"):
        low, high = (to_mm * value[f"bound.{axis}.{end}"] for end in ("min", "max"))
        if not low < high:
            continue
        inside = (points[:, column] >= low) & (points[:, column] <= high)
        beyond = int(np.count_nonzero(~inside))
        if not beyond:
            continue
        at = file.values.get(f"bound.{axis}.min", file.values.get(f"bound.{axis}.max", (0, "")))[0]
        if axis == "z":
            raise refusal(
                file.source,
                at,
                f"bound.z must include all points; {beyond} points, the first in row {places[~inside][0]}, lie beyond "
                f"{low / to_mm:g} to {high / to_mm:g}. Remove the points or the bounds.",
            )
        points, places = points[inside], places[inside]
        notes.append(f"bound.y = {low / to_mm:g} to {high / to_mm:g} was applied: it cut {beyond} points")
    return points, places, notes


def _weights(file: _File) -> list[str]:
    """Return a note if a point has a weight other than 1."""
    cells = [re.split(r"[;,\s]+" if "." in row else r"[;\s]+", row.strip()) for _, row in file.body]
    odd = sum(len(cell) > 2 and is_decimal(cell[2]) and number_of(cell[2]) != 1.0 for cell in cells)
    return [f"weights of {odd} points have no effect: the spline weighs all points equally"] * bool(odd)

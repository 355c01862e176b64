"""Contours of wheels and rails in common forms: tables of y and z, MiniProf and SIMPACK files.

A file holds rows of two numbers, by the rules of `readers.tables`, and may begin with a header. Keys of the header that
change the meaning of the numbers are applied or refused: units, numbers of points, columns, mirrors, offsets, turns.
The rest of MiniProf (.whl, .ban) and SIMPACK (.prw, .prr) files is ignored.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from readers.tables import (
    BLANKS,
    Column,
    TableError,
    cells_of,
    number_in,
    number_of,
    separator_of_numbers,
    table_of,
)
from readers.text import REMARKS, lines_of, quoted, rows_of, text_of
from readers.units import factor, spellings_for

#: Largest file [bytes], fewest and most points.
LARGEST_FILE, FEWEST_POINTS, MOST_POINTS = 20_000_000, 20, 100_000
#: Largest coordinate, and limits of the breadth [mm]: wheels are 140 mm wide, heads of rails 75 mm.
LARGEST, LEAST_BREADTH, LARGEST_BREADTH = 1000.0, 20.0, 500.0
#: Rows by which the separator is found.
SAMPLE = 50
#: Share of a contour's breadth by which its ends are apart at least, and that no step from point to point exceeds.
ENDS_APART, LONGEST_STEP = 0.25, 0.5
#: A key of a header, and the sign before its value.
KEY, ASSIGNS = re.compile(r"[A-Za-z][\w .()/-]*"), re.compile("[=:]")
#: Keys that change what points mean, unless their value is neutral.
CHANGES = re.compile(r"scal|factor|mirror|flip|inver|swap|offset|shift|rotat|tilt|zoom|bound|axis|axes|coord", re.I)
COUNTS = ("xypoints", "points", "npoints", "numpoints", "numberofpoints", "pointcount")
NEUTRAL = ("", "no", "none", "off", "false", "n")
#: Words of a free text that indicate another unit or a change.
TELLING = re.compile(r"\b(inch(es)?|met(er|re)s?|microns?|feet|mirrored|scaled|rotated|shifted)\b", re.I)
SIMPACK_TYPES = {0.0: "rail", 1.0: "wheel"}
MINIPROF = re.compile(r"miniprof|wheelprof|railprof|^[^\S\n]*(ColumnDef|XYPoints)\s*=", re.I | re.M)
TRAILING = re.compile("[#%!]|//")
CELLS = re.compile(r"[^\s;,\"]+")
HEAD = re.compile(r"[A-Za-z]\w*\s*([\[(][^\[\]()]*[\])])?")


@dataclass(frozen=True, eq=False)
class Contour:
    """The points of a file in its own order and directions.

    Attributes
    ----------
    source : str
        The path, for messages.
    points : array, shape (points, 2)
        y and z [m].
    places : array of int, shape (points,)
        Row of each point.
    """

    source: str
    points: NDArray[np.float64]
    places: NDArray[np.int64] = field(repr=False)


@dataclass
class _Header:
    """Content of a header: factor to mm, numbers of points, columns, mirrors of y and z."""

    source: str
    unit: tuple[float, float] = (1.0, 1.0)
    count: tuple[int, int] | None = None  # points, row
    columns: Sequence[str] = ()
    mirrors: tuple[float, float] = (1.0, 1.0)

    def refusal(self, row: int, text: str) -> TableError:
        return TableError(f"{self.source}, row {row}: {text}")

    def take(self, row: int, key: str, value: str) -> None:
        """Apply a key, ignore one without effect, or refuse it."""
        tidy = re.sub(r"[^a-z]", "", key.lower())
        value = value.strip().strip("'\"").strip()
        if tidy in COUNTS:
            self.count = self._whole(row, key, value), row
        elif tidy == "columndef":
            self.columns = [one.strip().lower() for one in value.split(",")]
        elif tidy.startswith("unit") or tidy.endswith(("unit", "units")):
            self._take_unit(row, key, value)
        elif CHANGES.search(tidy) and not _neutral(value, tidy):
            raise self.refusal(
                row, f"{key} must be {_nothing(tidy)}; got {quoted(value)}. Apply it to the points, and remove it."
            )

    def _take_unit(self, row: int, key: str, value: str) -> None:
        if "ang" in key.lower() or not value:
            return
        found = factor(value, "mm")
        if found is None:
            units = ", ".join(spellings_for("mm"))
            raise self.refusal(row, f"{key} must be one of {units}; got {quoted(value)}. Give y and z in mm.")
        self.unit = found

    def _whole(self, row: int, key: str, value: str) -> int:
        if not value.isdecimal() or len(value) > 9:
            raise self.refusal(row, f"{key} must be an integer; got {quoted(value)}. Correct or remove it.")
        return int(value)

    def check_count(self, found: int) -> None:
        """Compare the number of points with that in the header."""
        if self.count and self.count[0] != found:
            raise self.refusal(
                self.count[1],
                f"the header announces {self.count[0]} points; the file has {found}. Complete the file, or correct the "
                "number.",
            )


def _neutral(value: str, key: str) -> bool:
    if value.lower() in NEUTRAL:
        return True
    numbers = [value] if number_in(value) else [one for one in re.split(r"[\s;,]+", value) if one]
    same = 1.0 if re.search("scal|factor|zoom", key) else 0.0
    return all(number_of(one) == same for one in numbers)


def _nothing(key: str) -> str:
    return "1" if re.search("scal|factor|zoom", key) else "0"


def read_contour(path: str | Path, kind: str) -> Contour:
    """Read the points of a profile.

    Parameters
    ----------
    path : str or Path
        The file.
    kind : str
        "wheel" or "rail".

    Raises
    ------
    FileError
        If it is not the contour of one profile; the message names file, row, value and remedy.
    """
    return contour_of(text_of(path, LARGEST_FILE), str(path), kind)


def contour_of(text: str, source: str, kind: str) -> Contour:
    """Read the points of a profile from a file's text, as `read_contour` does; source: its name in messages."""
    rows = list(rows_of(text, source))
    if any(re.match(r"\s*(header|spline|point)\.begin", row) for _, row in rows):
        header, body = _simpack(rows, source, kind)
    else:
        header, body = _plain(rows, source, text)
    if len(body) < FEWEST_POINTS:
        count = sum(separator_of_numbers([row]) is not None for _, row in body)
        raise TableError(
            f"{source} has {count} points; a {kind} profile needs at least {FEWEST_POINTS} rows of y, z in mm."
        )
    points, places = _points(header, body)
    header.check_count(len(points))
    _check_one_contour(source, points, places)
    return Contour(source, points * header.mirrors / 1e3, places)


Rows = list[tuple[int, str]]


def _plain(rows: Rows, source: str, text: str) -> tuple[_Header, Rows]:
    """Return header and body of a table with or without keys before it, such as those of the MiniProf."""
    header = _Header(source)
    of_miniprof = MINIPROF.search("\n".join(lines_of(text)))
    taken_out = sum(map(_is_taken_out, (row for _, row in rows))) if of_miniprof else 0
    if taken_out:
        rows = [one for one in rows if not _is_taken_out(one[1])]
    first = next((place for place, (_, row) in enumerate(rows) if separator_of_numbers([_bare(row)])), len(rows))
    before, body = rows[:first], [(at, bare) for at, row in rows[first:] if CELLS.search(bare := _bare(row))]
    keys = {at: found for at, row in before if (found := _key_and_value(row))}
    for at, row in _remarks(text):
        if found := _key_and_value(row):
            header.take(at, *found)
    for at, found in keys.items():
        header.take(at, *found)
    for place, (at, row) in enumerate(before):
        if at in keys:
            continue
        if row.strip().isdecimal() and place == len(before) - 1 and body:
            header.count = int(row.strip()[:9]), at
        elif TELLING.search(row):
            raise header.refusal(
                at, f"the text {quoted(row)} may change the points. Give y and z in mm, and remove it."
            )
    if header.count and header.count[0] == len(body) + taken_out:
        header.count = len(body), header.count[1]
    if before and body and before[-1][0] not in keys and _is_head(before[-1][1], body[0][1]):
        body = [before[-1], *body]
    return header, body


def _remarks(text: str) -> list[tuple[int, str]]:
    """Return the remarks of a text with their rows, without the marks."""
    return [
        (at, row.lstrip().lstrip("#%!/").strip())
        for at, row in enumerate(lines_of(text), 1)
        if row.lstrip().startswith(REMARKS)
    ]


def _is_taken_out(row: str) -> bool:
    """Return whether a MiniProf has taken a row out, by one quote before it; its number of points counts them."""
    return row.lstrip().startswith('"') and row.count('"') == 1


def _bare(row: str) -> str:
    """Return a row without the remark behind its numbers."""
    found = TRAILING.search(row)
    return row[: found.start()].rstrip() if found else row


def _key_and_value(row: str) -> tuple[str, str] | None:
    """Return key and value of a row of a header, or None; dots and blanks may lead from one to the other."""
    key, *value = ASSIGNS.split(row, maxsplit=1)
    key = key.lstrip().rstrip("." + "".join(filter(str.isspace, set(key))))
    return (key, value[0].strip()) if value and KEY.fullmatch(key) else None


def _is_head(row: str, first: str) -> bool:
    """Return whether a row names the columns of the row of numbers behind it."""
    separator = separator_of_numbers([first]) or BLANKS
    cells = [cell for cell in cells_of(row.replace('"', ""), separator, "") if cell]
    count = len([cell for cell in cells_of(first.replace('"', ""), separator, "") if cell])
    return len(cells) == count and all(HEAD.fullmatch(cell) for cell in cells)


def _simpack(rows: Rows, source: str, kind: str) -> tuple[_Header, Rows]:
    """Return header and body of a file of SIMPACK, whose blocks begin with NAME.begin and end with NAME.end."""
    header, body, block, values = _Header(source, columns=("x", "y", "weight")), [], "", {}
    seen: list[str] = []
    for at, row in rows:
        line = row.split("!")[0].strip()
        word, _, what = line.partition(".")
        if what in ("begin", "end"):
            if what == "begin" and word in seen:
                raise header.refusal(at, f"a second block {word} begins; a file must hold one profile. Split it.")
            seen, block = ([*seen, word], word) if what == "begin" else (seen, "")
        elif block == "point":
            body.append((at, line))
        elif line:
            key, _, value = line.partition("=")
            values[f"{block}.{key.strip().lower()}"] = at, value.strip().strip("'\"").strip()
    _take_simpack(header, values, kind)
    return header, [(at, row) for at, row in body if row]


def _take_simpack(header: _Header, values: dict[str, tuple[int, str]], kind: str) -> None:
    numbers = {}
    for key, (at, value) in values.items():
        name = key.partition(".")[2]
        if number_in(value):
            numbers[key] = number_of(value)
        if key == "header.type" and SIMPACK_TYPES.get(numbers.get(key, math.nan)) != kind:
            raise header.refusal(at, f"type must be that of a {kind} (0: rail, 1: wheel); got {quoted(value)}.")
        if name in ("mirror.y", "mirror.z") and numbers.get(key) in (0.0, 1.0):
            sign, (y, z) = 1.0 - 2.0 * numbers[key], header.mirrors
            header.mirrors = (sign, z) if name == "mirror.y" else (y, sign)
        elif name == "units.len.f":
            if not 0.0 < numbers.get(key, math.nan) < math.inf:
                raise header.refusal(at, f"units.len.f must be above 0, 1000 for mm; got {quoted(value)}. Correct it.")
            header.unit = 1000.0, numbers[key]
        elif name.startswith("bound.") or name in ("inversion", "units.len", "units.ang", "units.ang.f"):
            pass
        else:
            header.take(at, name, value)
    for axis in "yz":
        low, high = (numbers.get(f"spline.bound.{axis}.{end}", 0.0) for end in ("min", "max"))
        if not low >= high:
            at = values.get(f"spline.bound.{axis}.min", values.get(f"spline.bound.{axis}.max", (0, "")))[0]
            raise header.refusal(
                at, f"bound.{axis} must be off, min above max; got {low:g} to {high:g}. Cut the points, and remove it."
            )


def _points(header: _Header, body: Rows) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return points [mm] and their rows, by the rules of all tables."""
    named = separator_of_numbers([body[0][1]]) is None
    second = next((at for at, row in body[1:] if not any(map(number_in, CELLS.findall(row)))), None)
    if second is not None:
        row = dict(body)[second]
        raise header.refusal(
            second,
            f"between points a row must hold y and z; got {quoted(row)}. Give one profile a file, and its text first.",
        )
    data = [row for _, row in body[named:]]
    separator = separator_of_numbers(data[:SAMPLE])
    if separator == "," and not any("." in row for row in data):
        raise header.refusal(
            body[named][0],
            f"commas must separate columns or mark decimals; in {quoted(data[0])} they can do both. Separate columns "
            "by semicolons, or write decimals with points.",
        )
    last = body[-1][0]
    lines = [""] * last
    for at, row in body:
        lines[at - 1] = "\t".join(row.split()) if separator == BLANKS else row
    y, z, columns = _columns(header, body[0][1] if named else "")
    both = header.unit
    limit = LARGEST * both[1] / both[0]
    cells = [
        Column(one, "mm", -limit, limit, required=True) if one in (y, z) else Column(one, "mm", filled=False)
        for one in columns
    ]
    table = table_of("\n".join(lines), header.source, cells, by_position=True, most_rows=MOST_POINTS)
    points = np.column_stack([table.numbers[y], table.numbers[z]]) * both[0] / both[1]
    return points, table.places


def _columns(header: _Header, head: str) -> tuple[str, str, list[str]]:
    """Return the names of y, of z and of all columns: as ColumnDef or the head has them, or y and z."""
    if header.columns:
        if "x" not in header.columns or "y" not in header.columns or len(set(header.columns)) < len(header.columns):
            raise TableError(
                f"{header.source}: ColumnDef must name X and Y, and each column once; "
                f"got {quoted(','.join(header.columns))}. Correct it."
            )
        return "x", "y", list(header.columns)
    words = [
        re.sub(r"[^a-z]", "", re.split(r"[\[(]", one)[0].lower()) for one in re.split(r"[\t;,]|\s+(?![\[(])", head)
    ]
    y, z = ("x", "y") if {"x", "y"} <= set(words) else ("x", "z") if {"x", "z"} <= set(words) else ("y", "z")
    return y, z, [y, z]


def _check_one_contour(source: str, points: NDArray[np.float64], places: NDArray[np.int64]) -> None:
    """Check that points run from one side of one contour to its other side."""
    y = points[:, 0]
    breadth = float(np.ptp(y))
    if not LEAST_BREADTH <= breadth <= LARGEST_BREADTH:
        raise TableError(
            f"{source}: y must span {LEAST_BREADTH:g} to {LARGEST_BREADTH:g} mm; got {breadth:.4g} mm. Give y and z in "
            "mm, or name the columns with their unit, as in y [m]."
        )
    steps = np.diff(y)
    far = np.flatnonzero(np.abs(steps) > LONGEST_STEP * breadth)
    if far.size:
        row = int(far[0])
        raise TableError(
            f"{source}, row {places[row + 1]}: a file must hold one profile, point by point; y jumps from "
            f"{y[row]:.6g} to {y[row + 1]:.6g} mm. Split the file, or remove the points that are wrong."
        )
    if abs(y[-1] - y[0]) < ENDS_APART * breadth:
        turn = int(np.argmax(np.abs(y - y[0])))
        raise TableError(
            f"{source}, row {places[turn]}: a file must hold one profile, from one side to the other; y turns back at "
            f"{y[turn]:.6g} mm and ends at {y[-1]:.6g} mm, near its begin. Split the file, or cut the contour open."
        )

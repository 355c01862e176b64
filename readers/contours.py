"""Points of a wheel's or a rail's contour, by the rules that are common to all formats of profile files."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from readers.columns import Column, TableError
from readers.decimal_numbers import is_decimal, number_of
from readers.tables import BLANKS, cells_of, separator_of_numbers, table_of
from readers.text import quoted
from readers.units import different_units, factor

#: Fewest and most points.
FEWEST_POINTS, MOST_POINTS = 20, 100_000
#: Largest coordinate, and limits of the breadth [mm]: wheels are 140 mm wide, heads of rails 75 mm.
LARGEST, LEAST_BREADTH, LARGEST_BREADTH = 1000.0, 20.0, 500.0
#: Rows by which the separator is found.
SAMPLE = 50
#: Share of a contour's breadth by which its ends are apart at least, and that no step from point to point exceeds.
ENDS_APART, LONGEST_STEP = 0.25, 0.5
#: Keys that change what points mean, unless their value is neutral.
CHANGES = re.compile(r"scal|factor|mirror|flip|inver|swap|offset|shift|rotat|tilt|zoom|bound|axis|axes|coord", re.I)
FACTORS = re.compile("scal|factor|zoom")
NEUTRAL = ("", "no", "none", "off", "false", "n")
CELLS = re.compile(r"[^\s;,\"]+")
#: A name with its unit, as in y [m], y (mm) or y_mm.
WITH_UNIT = re.compile(r"[A-Za-z]\s*[\[(_]")
#: Most names that a note lists.
LISTED = 12

Rows = list[tuple[int, str]]
Points = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Contour:
    """The points of a file in its own order and directions.

    Attributes
    ----------
    source : str
        The path, for messages.
    points : array, shape (points, 2)
        y and z [m], after the changes that the header states.
    places : array of int, shape (points,)
        Row of each point.
    notes : tuple of str
        Sentences: what was applied, found or left without effect.
    facts : mapping
        Numbers of the header for a pair [m]: `gauge`, `diameter` (at the tape circle), `tape_circle` (its distance from
        the flange's back).
    kind : str
        "wheel" or "rail".
    """

    source: str
    points: Points
    places: NDArray[np.int64] = field(repr=False)
    notes: tuple[str, ...] = ()
    facts: Mapping[str, float] = field(default_factory=dict)
    kind: str = ""


@dataclass
class ContourRows:
    """Rows of numbers as a format found them.

    `columns`: their names, or () if the first row may name them. `unit`: factor to mm as a fraction, or None: mm or m,
    by the breadth. `count`: the number of points in the header, and its row.
    """

    source: str
    kind: str
    rows: Rows
    columns: Sequence[str] = ()
    unit: tuple[float, float] | None = None
    count: tuple[int, int] | None = None


def refusal(source: str, row: int, text: str) -> TableError:
    """Return the error of a row of a file."""
    return TableError(f"{source}, row {row}: {text}")


def read_points(body: ContourRows) -> tuple[Points, NDArray[np.int64], list[str]]:
    """Return the points y, z [mm] of a body, their rows, and notes."""
    if len(body.rows) < FEWEST_POINTS:
        count = sum(separator_of_numbers([row]) is not None for _, row in body.rows)
        raise TableError(
            f"{body.source} has {count} points; a {f'{body.kind} ' * bool(body.kind)}profile needs at least "
            f"{FEWEST_POINTS} rows of y, z in mm."
        )
    points, places, notes = _numbers(body)
    if body.count and body.count[0] != len(points):
        raise refusal(
            body.source,
            body.count[1],
            f"the header announces {body.count[0]} points; the file has {len(points)}. Complete the file, or correct "
            "the number.",
        )
    if (
        body.unit is None
        and not WITH_UNIT.search(body.rows[0][1])
        and LEAST_BREADTH <= 1e3 * float(np.ptp(points[:, 0])) <= LARGEST_BREADTH
    ):
        points = points * 1e3
        notes.append(f"y spans {np.ptp(points[:, 0]):.4g} mm if the file is in metres: y and z were read as metres")
    return points, places, notes


def _numbers(body: ContourRows) -> tuple[Points, NDArray[np.int64], list[str]]:
    """Return points in the body's unit, or mm if it has a head with units, their rows, and notes."""
    named = separator_of_numbers([body.rows[0][1]]) is None
    second = next((at for at, row in body.rows[1:] if not any(map(is_decimal, CELLS.findall(row)))), None)
    if second is not None:
        row = dict(body.rows)[second]
        raise refusal(
            body.source,
            second,
            f"between points a row must hold y and z; got {quoted(row)}. Give one profile a file, and its text first.",
        )
    data = [row for _, row in body.rows[named:]]
    separator = separator_of_numbers(data[:SAMPLE])
    if separator == "," and not any("." in row for row in data):
        raise refusal(
            body.source,
            body.rows[named][0],
            f"commas must separate columns or mark decimals; in {quoted(data[0])} they can do both. Separate columns "
            "by semicolons, or write decimals with points.",
        )
    lines = [""] * body.rows[-1][0]
    for at, row in body.rows:
        lines[at - 1] = "\t".join(row.split()) if separator == BLANKS else row
    y, z, columns = _columns(body, body.rows[0][1] if named else "", data[0], separator)
    unit = body.unit or (1.0, 1.0)
    limit = LARGEST * unit[1] / unit[0]
    cells = [
        Column(column, "mm", -limit, limit, required=True) if column in (y, z) else Column(column, "mm", filled=False)
        for column in columns
    ]
    table = table_of(
        "\n".join(lines), body.source, cells, by_position=True, others=named and not body.columns, most_rows=MOST_POINTS
    )
    points = np.column_stack([table.numbers[y], table.numbers[z]]) * unit[0] / unit[1]
    notes = [] if body.columns else _check_others(body, table.numbers, points, table.places)
    return points, table.places, notes


def _columns(body: ContourRows, head: str, first: str, separator: str | None) -> tuple[str, str, list[str]]:
    """Return the names of y, of z and of all columns: as the format or the head has them, or y, z and more."""
    if body.columns:
        if len(set(body.columns)) < len(body.columns) or not {"x", "y"} <= set(body.columns):
            raise TableError(
                f"{body.source}: ColumnDef must name X and Y, and each column once; "
                f"got {quoted(','.join(body.columns))}. Correct it."
            )
        return "x", "y", list(body.columns)
    words = [
        re.sub(r"[^a-z]", "", re.split(r"[\[(]", one)[0].lower()) for one in re.split(r"[\t;,]|\s+(?![\[(])", head)
    ]
    y, z = ("x", "y") if {"x", "y"} <= set(words) else ("x", "z") if {"x", "z"} <= set(words) else ("y", "z")
    count = 2 if head or separator is None else len(cells_of(first.replace('"', ""), separator, ""))
    return y, z, [y, z, *(f"column {number}" for number in range(3, count + 1))]


#: Largest median error of a column that holds the contour's angle [rad], and its share of rows that are compared.
ANGLE_ERROR = 0.02


def _check_others(
    body: ContourRows, numbers: Mapping[str, Points], points: Points, places: NDArray[np.int64]
) -> list[str]:
    """Check that unnamed columns behind y and z are constant or the contour's angle, and return a note for each."""
    notes: list[str] = []
    for name, values in numbers.items():
        if not name.startswith("column ") or (name != "column 3" and notes):
            continue
        if np.ptp(values) == 0.0:
            notes.append(f"{name} is {values[0]:g} throughout, and has no effect")
        elif is_angle(points, values):
            notes.append(f"{name} is the angle of the contour, and has no effect")
        else:
            raise refusal(
                body.source,
                int(places[0]),
                f"behind y and z a column must be the contour's angle or a constant; {name} begins with {values[0]:g}."
                " Name the columns, as in ColumnDef=X,Y,A, or remove it.",
            )
    return notes


def is_angle(points: Points, values: Points) -> bool:
    """Return whether values are the angles of a contour at its points, in radians or degrees, of either sign."""
    step = points[2:] - points[:-2]
    slope = np.arctan2(step[:, 1], step[:, 0])
    for scale in (1.0, np.pi / 180):
        for sign in (1.0, -1.0):
            off = np.mod(sign * scale * values[1:-1] - slope + np.pi / 2, np.pi) - np.pi / 2
            if np.median(np.abs(off)) < ANGLE_ERROR and np.ptp(values) * scale > ANGLE_ERROR:
                return True
    return False


def check_one_contour(source: str, points: Points, places: NDArray[np.int64]) -> None:
    """Check that points [mm] run from one side of one contour to its other side."""
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
        raise refusal(
            source,
            int(places[row + 1]),
            f"a file must hold one profile, point by point; y jumps from {y[row]:.6g} to {y[row + 1]:.6g} mm. Split "
            "the file, or remove the points that are wrong.",
        )
    if abs(y[-1] - y[0]) < ENDS_APART * breadth:
        turn = int(np.argmax(np.abs(y - y[0])))
        raise refusal(
            source,
            int(places[turn]),
            f"a file must hold one profile, from one side to the other; y turns back at {y[turn]:.6g} mm and ends at "
            f"{y[-1]:.6g} mm, near its begin. Split the file, or cut the contour open.",
        )


def check_without_effect(source: str, row: int, key: str, value: str) -> None:
    """Refuse an unknown key whose name says that it changes the points, unless its value changes nothing."""
    tidy = re.sub(r"[^a-z]", "", key.lower())
    if CHANGES.search(tidy) and not _neutral(value, tidy):
        nothing = "1" if FACTORS.search(tidy) else "0"
        raise refusal(
            source, row, f"{key} must be {nothing}; got {quoted(value)}. Apply it to the points, and remove it."
        )


def _neutral(value: str, key: str) -> bool:
    if value.lower() in NEUTRAL:
        return True
    numbers = [value] if is_decimal(value) else [one for one in re.split(r"[\s;,]+", value) if one]
    same = 1.0 if FACTORS.search(key) else 0.0
    return all(number_of(number) == same for number in numbers)


def unit_of(source: str, row: int, key: str, value: str) -> tuple[float, float]:
    """Return the factor of a unit of length to mm, as a fraction."""
    found = factor(value, "mm")
    if found is None:
        units = ", ".join(different_units("mm"))
        raise refusal(source, row, f"{key} must be one of {units}; got {quoted(value)}. Give y and z in mm.")
    return found


def unknown_keys(keys: Sequence[str]) -> list[str]:
    """Return a note about keys without a known meaning, or no note if there are none."""
    names = list(dict.fromkeys(keys))
    more = f" and {len(names) - LISTED} more" if len(names) > LISTED else ""
    return [f"keys of the header that are unknown and have no effect: {', '.join(names[:LISTED])}{more}"] * bool(names)


def other_kind(source: str, wanted: str, found: str, why: str) -> TableError:
    """Return the error for a profile of the other kind, as of a wheel that is given as a rail."""
    return TableError(
        f"{source} must be the profile of a {wanted}; it is that of a {found}: {why}. Exchange wheel and rail, or "
        "correct the file."
    )

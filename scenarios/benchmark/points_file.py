"""Points of a case: tables in its file, or rows of a CSV file next to it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from fmu_src.suggestion import suggestion
from readers.documents import is_number
from readers.tables import Column, names_of, read_table, tidy
from readers.text import FileError, shown
from scenarios.benchmark.case import Answer, Point
from scenarios.benchmark.entries import check_names, flat, input_at, quantity_at
from scenarios.benchmark.quantities import Input, si_unit

#: Largest number of points of a case.
MOST_POINTS = 20_000


def points_of(
    given: Any, path: Path, inputs: dict[str, Input], units: dict[str, str], answers: dict[str, Answer]
) -> tuple[Point, ...]:
    """Return the points of a case. Raises FileError."""
    if isinstance(given, str):
        rows = rows_of(path, given, inputs, units, answers)
    elif isinstance(given, list) and all(isinstance(one, dict) for one in given):
        rows = [
            (f"{path}, point {number}", point_of(one, f"{path}, point {number}", inputs, units, answers))
            for number, one in enumerate(given, 1)
        ]
    else:
        raise FileError(f"{path} must have [[points]], or points as the name of a CSV file; got {shown(given)}.")
    if not 0 < len(rows) <= MOST_POINTS:
        raise FileError(f"{path} must have from 1 to {MOST_POINTS} points; got {len(rows)}.")
    found = []
    for place, row in rows:
        published = {name: value for name, value in row.items() if name in answers}
        own = tuple(name for name in row if name in inputs)
        if not published:
            raise FileError(f"{place} must have a published answer, one of {', '.join(answers)}; got none. Add it.")
        found.append(Point(inputs | {name: row[name] for name in own}, published, own))
    return tuple(found)


def point_of(
    table: dict[str, Any], place: str, inputs: dict[str, Input], units: dict[str, str], answers: dict[str, Answer]
) -> dict[str, Any]:
    """Return the inputs and published answers of a point in SI units."""
    found: dict[str, Any] = {}
    for name, given in flat(table, place).items():
        check_names({name: given}, (*answers, *inputs), place)
        if name in answers:
            if is_number(given):
                found[name] = float(given) * answers[name].scale
            else:
                found[name] = quantity_at(f"{place}, {name}", given, si_unit(answers[name].unit))
            continue
        found[name], unit = input_at(f"{place}, {name}", given)
        if unit != units[name]:
            raise FileError(f"{place}: {name} must have the unit of inputs.{name}; got {shown(given)}.")
    return found


def rows_of(
    path: Path, name: str, inputs: dict[str, Input], units: dict[str, str], answers: dict[str, Answer]
) -> list[tuple[str, dict[str, Any]]]:
    """Return place and values of the rows of a CSV file next to the case, in SI units."""
    if Path(name).name != name:
        raise FileError(f"{path}: points must be the name of a file in the folder of the case; got {shown(name)}.")
    table, known = path.parent / name, {tidy(one): one for one in (*answers, *inputs)}
    columns = []
    for head in names_of(table):
        own = known.get(head)
        if own is None:
            raise FileError(
                f"{table}: the column {shown(head)} must be an input or an answer; {suggestion(head, known)}"
            )
        if own in answers:
            columns.append(Column(own, answers[own].unit, filled=False))
        elif isinstance(inputs[own], tuple):
            raise FileError(f"{table}: {own} must have one list for all points; got a column. Remove it.")
        else:
            columns.append(Column(own, units[own] or "1", text=not units[own]))
    read = read_table(table, columns, most_rows=MOST_POINTS)
    rows = []
    for row, at in enumerate(read.places.tolist()):
        values: dict[str, Any] = {one: texts[row] for one, texts in read.words.items()}
        for one, column in read.numbers.items():
            if not np.isnan(column[row]):
                values[one] = float(column[row]) * (answers[one].scale if one in answers else 1.0)
        rows.append((f"{table}, row {at}", values))
    return rows


def check_percent(answers: Mapping[str, Answer], points: Iterable[Point], place: str) -> None:
    """Check that no published value is 0 where its error is in percent. Raises FileError."""
    for number, point in enumerate(points, 1):
        for name, value in point.published.items():
            if answers[name].relative and value == 0.0:
                raise FileError(
                    f"{place}, point {number}: {name} must not be 0 where its error is in percent. Give answers.{name} "
                    "an absolute bound, within."
                )

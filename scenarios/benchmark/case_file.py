"""Files of cases: inputs with units, a question, published answers, and where they are from.

A case is a TOML file. `[inputs]` has every input once, with its unit. `[answers.NAME]` defines each answer.
`[[points]]` have the published answers, and the inputs in which a point differs from `[inputs]`; they may be rows of a
CSV file next to it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from fmu_src.suggestion import suggestion
from readers.documents import is_number
from readers.tables import Column, names_of, read_table, tidy
from readers.text import FileError, shown
from readers.toml_files import toml_of
from scenarios.benchmark.case import AnswerQuantity, BenchmarkCase, CasePoint, Unknown
from scenarios.benchmark.entries import (
    NAME,
    Input,
    check_names,
    flat,
    input_at,
    quantity_at,
    si_unit,
    table_at,
    text_at,
    valid_name,
)

#: Cases of the package.
CASES = Path(__file__).parent / "cases"
#: Largest number of points of a case.
MOST_POINTS = 20_000
#: Entries of a case that are strings; of these all but `note` are required.
TEXTS = ("title", "question", "description", "source", "licence", "sureness", "note")
TABLES = ("inputs", "answers", "points", "unknown")
#: Entries of an answer.
OF_ANSWER = ("what", "unit", "judged", "within", "within_percent")
DISTRIBUTIONS = ("uniform", "normal", "list")


def read_case(path: str | Path) -> BenchmarkCase:
    """Return a case from its file."""
    path = Path(path)
    read = toml_of(path)
    if not NAME.fullmatch(path.stem) or path.suffix != ".toml":
        raise FileError(
            f"{path} must be named in small letters, digits and hyphens, with .toml; got {shown(path.name)}. Rename it."
        )
    check_names(read, (*TEXTS, *TABLES), str(path))
    texts = {name: text_at(read, name, str(path)) for name in TEXTS if name != "note" or name in read}
    inputs, units = inputs_of(table_at(read, "inputs", str(path)), f"{path}, inputs")
    answers = {
        name: answer_of(name, one, f"{path}, answers.{name}")
        for name, one in table_at(read, "answers", str(path)).items()
        if valid_name(name, f"{path}, answers", inputs)
    }
    if not answers:
        raise FileError(f"{path} must have at least one table [answers.NAME]; got none. Add one.")
    points = points_of(read.get("points"), path, inputs, units, answers)
    unknown = {
        name: unknown_of(name, one, units, inputs, f"{path}, unknown.{name}")
        for name, one in flat(read.get("unknown", {}), f"{path}, unknown", DISTRIBUTIONS).items()
    }
    check_percent(answers, points, str(path))
    return BenchmarkCase(
        path.stem, path, **{"note": "", **texts}, units=units, answers=answers, points=points, unknown=unknown
    )


def cases_in(places: Iterable[Path]) -> dict[str, Path]:
    """Return the files of cases by name; a place is a folder, or the file of one case."""
    found: dict[str, Path] = {}
    for place in places:
        files = [place] if place.is_file() else sorted(place.glob("*.toml"))
        if not files:
            raise FileError(f"{place} must be a case, NAME.toml, or a folder with cases; got none. Check the path.")
        for path in files:
            if path.stem in found:
                raise FileError(f"{path} must have a name of its own; {found[path.stem]} has it. Rename it.")
            found[path.stem] = path
    return found


def inputs_of(table: dict[str, Any], place: str) -> tuple[dict[str, Input], dict[str, str]]:
    """Return inputs and their SI units by name. Raises FileError."""
    values: dict[str, Input] = {}
    units: dict[str, str] = {}
    for name, given in flat(table, place).items():
        valid_name(name, place)
        values[name], units[name] = input_at(f"{place}.{name}", given)
    return values, units


def answer_of(name: str, table: Any, place: str) -> AnswerQuantity:
    """Return what a case needs from a program. Raises FileError."""
    if not isinstance(table, dict):
        raise FileError(f"{place} must be a table; got {shown(table)}.")
    check_names(table, OF_ANSWER, place)
    what, unit = text_at(table, "what", place), text_at(table, "unit", place)
    try:
        own = si_unit(unit)
    except FileError as error:
        raise FileError(f"{place}: {error}") from None
    judged, percent = table.get("judged"), table.get("within_percent")
    if not isinstance(judged, bool):
        raise FileError(f"{place}: judged must be true or false; got {shown(judged)}. Write judged = false to show it.")
    if "within" in table and percent is not None:
        raise FileError(f"{place} must have within or within_percent; got both. Remove one.")
    if judged and "within" not in table and percent is None:
        raise FileError(f"{place} must have within or within_percent where it is judged; got none. Add one.")
    if percent is not None and not (is_number(percent) and percent > 0.0):
        raise FileError(f"{place}: within_percent must be a number above 0; got {shown(percent)}.")
    bound = None if percent is None else float(percent) / 100.0
    if "within" in table:
        bound = quantity_at(f"{place}.within", table["within"], own)
        if bound <= 0.0:
            raise FileError(f"{place}: within must be above 0; got {shown(table['within'])}.")
    return AnswerQuantity(name, what, unit, judged, bound, "within" not in table)


def unknown_of(name: str, table: Any, units: Mapping[str, str], inputs: Mapping[str, Input], place: str) -> Unknown:
    """Return the distribution of an input. Raises FileError."""
    if not isinstance(inputs.get(name), float):
        raise FileError(f"{place} must be the name of an input that is a number; {suggestion(name, units)}")
    if not isinstance(table, dict):
        raise FileError(f"{place} must be a table; got {shown(table)}.")
    check_names(table, (*DISTRIBUTIONS, "source"), place)
    kinds = [distribution for distribution in DISTRIBUTIONS if distribution in table]
    if len(kinds) != 1:
        raise FileError(f"{place} must have one of {', '.join(DISTRIBUTIONS)}; got {' and '.join(kinds) or 'none'}.")
    values = table[kinds[0]]
    if not isinstance(values, list) or not values or (kinds[0] != "list" and len(values) != 2):
        need = "values" if kinds[0] == "list" else "two values"
        raise FileError(f"{place}: {kinds[0]} must be a list of {need}; got {shown(values)}.")
    numbers = tuple(quantity_at(f"{place}.{kinds[0]}", value, units[name]) for value in values)
    if kinds[0] == "uniform" and not numbers[0] < numbers[1]:
        raise FileError(f"{place}: uniform must have its lower value first; got {shown(values)}. Exchange them.")
    if kinds[0] == "normal" and not numbers[1] > 0.0:
        raise FileError(f"{place}: normal must have mean and deviation, above 0; got {shown(values)}.")
    return Unknown(kinds[0], numbers, text_at(table, "source", place))


def points_of(
    given: Any, path: Path, inputs: dict[str, Input], units: dict[str, str], answers: dict[str, AnswerQuantity]
) -> tuple[CasePoint, ...]:
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
        found.append(CasePoint(inputs | {name: row[name] for name in own}, published, own))
    return tuple(found)


def point_of(
    table: dict[str, Any],
    place: str,
    inputs: dict[str, Input],
    units: dict[str, str],
    answers: dict[str, AnswerQuantity],
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
    path: Path, name: str, inputs: dict[str, Input], units: dict[str, str], answers: dict[str, AnswerQuantity]
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


def check_percent(answers: Mapping[str, AnswerQuantity], points: Iterable[CasePoint], place: str) -> None:
    """Check that no published value is 0 where its error is in percent. Raises FileError."""
    for number, point in enumerate(points, 1):
        for name, value in point.published.items():
            if answers[name].relative and value == 0.0:
                raise FileError(
                    f"{place}, point {number}: {name} must not be 0 where its error is in percent. Give answers.{name} "
                    "an absolute bound, within."
                )

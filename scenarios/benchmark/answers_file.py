"""Files of answers: a program's results in a CSV file, as a program of the benchmark."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from fmu_src.suggestion import suggestion
from readers.tables import Column, Table, read_table
from readers.text import BadInputError, FileError, shown
from scenarios.benchmark.case import BenchmarkCase
from scenarios.benchmark.case_file import read_case
from scenarios.benchmark.entries import scale_of, si_unit
from scenarios.benchmark.programs import Answers, Program

#: Columns of a file of answers.
COLUMNS = (
    Column("case", text=True, required=True),
    Column("point", minimum=1, maximum=1e9, whole=True, required=True),
    Column("answer", text=True, required=True),
    Column("value", required=True),
    Column("unit", text=True, required=True),
)


def program_of_answers(path: Path, files: Mapping[str, Path]) -> Program:
    """Return a CSV file of answers as a program: case, number of the point from 1, answer, value, unit."""
    found: dict[tuple[str, int], dict[str, float]] = {}
    try:
        read, cases = read_table(path, COLUMNS), dict[str, BenchmarkCase]()
        for row, at in enumerate(read.places.tolist()):
            try:
                name, point, answer, value = _row_of(read, row, files, cases)
            except FileError as error:
                raise FileError(f"{path}, row {at}: {error}") from None
            own = found.setdefault((name, point), {})
            if answer in own:
                raise FileError(f"{path}, row {at}: {answer} must be there once for a point; got it twice. Remove one.")
            own[answer] = value
    except FileError as error:
        raise BadInputError(str(error)) from None

    def ask(case: BenchmarkCase, point: int) -> Answers:
        return found.get((case.name, point), {})

    return Program(path.stem, f"answers in {path.name}", ask, computes=False)


def _row_of(
    read: Table, row: int, files: Mapping[str, Path], cases: dict[str, BenchmarkCase]
) -> tuple[str, int, str, float]:
    """Return case, point from 0, answer and value in SI units of a row; cases: those that were read before."""
    name, answer, unit = (read.words[one][row] for one in ("case", "answer", "unit"))
    point = int(read.numbers["point"][row])
    if name not in files:
        raise FileError(f"case must be the name of a case; got {shown(name)}; {suggestion(name, files)}")
    case = cases[name] = cases.get(name) or read_case(files[name])
    if point > len(case.points):
        raise FileError(f"point must be from 1 to {len(case.points)}, those of {name}; got {point}.")
    if answer not in case.answers:
        raise FileError(f"answer must be one of {', '.join(case.answers)}; got {shown(answer)}.")
    if si_unit(unit) != si_unit(case.answers[answer].unit):
        raise FileError(f"unit must convert to {case.answers[answer].unit}; got {shown(unit)}.")
    return name, point - 1, answer, float(read.numbers["value"][row]) * scale_of(unit)

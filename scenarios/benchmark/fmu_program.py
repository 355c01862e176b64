"""An FMU as a program of the benchmark: a file maps inputs and answers of a question to its variables."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from fmu_src.cosimulation.slave import CosimulationError, FmuInstance
from readers.documents import is_number
from readers.text import BadInputError, FileError, shown
from readers.toml_files import toml_of
from readers.units import factor, quantity_of
from scenarios.benchmark.case import BenchmarkCase
from scenarios.benchmark.entries import check_names, quantity_at, si_unit, table_at, text_at
from scenarios.benchmark.programs import Answers, CannotAnswerError, Program

#: Entries of a map, of its run, of a mapped name, and of the end of a run.
ENTRIES = ("question", "run", "inputs", "ignore", "values", "answers")
OF_RUN, OF_NAME, OF_END = ("duration", "step", "until"), ("variable", "factor", "values"), ("variable", "below")
#: Answer that is the time at the end of the run.
TIME = "time"
#: Largest number of steps of a run.
MOST_STEPS = 10_000_000


@dataclass(frozen=True)
class Mapped:
    """A variable, the factor on a number, and numbers in place of strings."""

    variable: str
    factor: float = 1.0
    values: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Map:
    """A map: its question, duration and step [s], end of a run, inputs and answers by the names of the case.

    values: of further variables, in their units. until: variable at or below whose value a run ends.
    """

    question: str
    duration: float
    step: float
    until: tuple[str, float] | None
    inputs: Mapping[str, Mapped]
    ignore: tuple[str, ...]
    values: Mapping[str, float]
    answers: Mapping[str, Mapped]


def read_map(path: Path) -> Map:
    """Return a map from its TOML file. Raises FileError."""
    read, place = toml_of(path), str(path)
    check_names(read, ENTRIES, place)
    run = table_at(read, "run", place)
    check_names(run, OF_RUN, f"{place}, run")
    duration, step = (quantity_at(f"{place}, run.{name}", run.get(name), "s") for name in ("duration", "step"))
    if not 0.0 < step <= duration <= MOST_STEPS * step:
        raise FileError(
            f"{place}, run: step must be above 0 and at most the duration; got {step:g} and {duration:g} s."
        )
    ignore, values = read.get("ignore", []), read.get("values", {})
    if not (isinstance(ignore, list) and all(isinstance(one, str) for one in ignore)):
        raise FileError(f"{place}: ignore must be a list of names of inputs; got {shown(ignore)}.")
    if not (isinstance(values, dict) and all(map(is_number, values.values()))):
        raise FileError(f"{place}: values must be a table of numbers; got {shown(values)}.")
    return Map(
        text_at(read, "question", place),
        duration,
        step,
        _until(run, place),
        _mapped(read, "inputs", place),
        tuple(ignore),
        {name: float(value) for name, value in values.items()},
        _mapped(read, "answers", place),
    )


def _until(run: Mapping[str, Any], place: str) -> tuple[str, float] | None:
    if "until" not in run:
        return None
    end = table_at(run, "until", f"{place}, run")
    check_names(end, OF_END, f"{place}, run.until")
    below = end.get("below")
    if below is None or not is_number(below):
        raise FileError(f"{place}, run.until: below must be a number in the unit of the variable; got {shown(below)}.")
    return text_at(end, "variable", f"{place}, run.until"), float(below)


def _mapped(read: Mapping[str, Any], name: str, place: str) -> dict[str, Mapped]:
    found = {}
    for key, given in table_at(read, name, place).items():
        at = f"{place}, {name}.{key}"
        table = {"variable": given} if isinstance(given, str) else given
        if not isinstance(table, dict):
            raise FileError(f"{at} must be the name of a variable, or a table with it; got {shown(given)}.")
        check_names(table, OF_NAME, at)
        times, values = table.get("factor", 1.0), table.get("values", {})
        if not is_number(times) or not isinstance(values, dict) or not all(map(is_number, values.values())):
            raise FileError(f"{at}: factor must be a number, and values a table of numbers; got {shown(table)}.")
        found[key] = Mapped(text_at(table, "variable", at), float(times), values)
    return found


def program_of_fmu(path: Path, map_path: Path) -> Program:
    """Return an FMU as a program. It is loaded for the first question in the map."""
    if not path.is_file():
        raise BadInputError(f"--fmu must be an FMU; got {path}, which does not exist. Check the path.")
    try:
        mapped = read_map(map_path)
    except FileError as error:
        raise BadInputError(str(error)) from None
    loaded: list[FmuInstance] = []

    def ask(case: BenchmarkCase, point: int) -> Answers:
        if case.question != mapped.question:
            return {}
        try:
            if not loaded:
                loaded.append(FmuInstance(path))
            return _run(loaded[0], mapped, case, point)
        except CosimulationError as error:
            raise CannotAnswerError(str(error)) from error

    return Program(path.stem, f"{path.name}, mapped by {map_path.name}", ask)


def _run(fmu: FmuInstance, mapped: Map, case: BenchmarkCase, point: int) -> Answers:
    """Return the answers of a run with the inputs of a point; none if the run does not come to its end."""
    fmu.restart({**mapped.values, **_values_of(fmu, mapped, case, point)})
    for number in range(round(mapped.duration / mapped.step)):
        fmu.step(number * mapped.step, mapped.step)
        if mapped.until and fmu[mapped.until[0]] <= mapped.until[1]:
            break
    else:
        number = round(mapped.duration / mapped.step) - 1
        if mapped.until:
            return {}
    ends = {}
    for name, one in mapped.answers.items():
        if name in case.answers:
            own = si_unit(case.answers[name].unit)
            value = (number + 1) * mapped.step if one.variable == TIME else fmu[one.variable]
            unit = "s" if one.variable == TIME else fmu.units[one.variable]
            ends[name] = one.factor * value / _scale(own, unit, one.variable)
    if not ends:
        asked, got = ", ".join(case.answers), ", ".join(mapped.answers)
        raise CannotAnswerError(f"the answers of the map must have one of {asked}; got {shown(got)}.")
    return ends


def _values_of(fmu: FmuInstance, mapped: Map, case: BenchmarkCase, point: int) -> dict[str, float]:
    """Return values of variables in their units. Raises CannotAnswerError for an input without a variable."""
    found = {}
    for name, value in case.points[point].inputs.items():
        one = mapped.inputs.get(name)
        if one is None:
            if name not in mapped.ignore:
                raise CannotAnswerError(f"the map must have a variable for {name}, or ignore it.")
            continue
        if isinstance(value, str):
            if value not in one.values:
                raise CannotAnswerError(f"the map must have a number for {name} = {shown(value)} in its values.")
            found[one.variable] = float(one.values[value])
        elif isinstance(value, tuple):
            raise CannotAnswerError(f"{name} is a list, which no variable takes.")
        else:
            if one.variable not in fmu.units:
                raise CannotAnswerError(f"the FMU has no variable {one.variable}, to which {name} is mapped.")
            unit = fmu.units[one.variable]
            found[one.variable] = one.factor * value * _scale(case.units[name], unit, one.variable)
    return found


def _scale(own: str, unit: str, variable: str) -> float:
    """Return the factor from an SI unit to that of a variable; 1 if the variable has none that is known."""
    if unit == "1" or quantity_of(unit) is None or own == unit:
        return 1.0
    both = factor(own, unit)
    if both is None:
        raise CannotAnswerError(f"{variable} has the unit {unit}, which {own} does not convert to.")
    return both[0] / both[1]

"""Programs of the benchmark: this project, published formulas, peers, and what a user gives.

A program is a function of a case and the number of its point, which returns answers in SI units by name. A missing
answer is shown as a dash.
"""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import redirect_stdout
from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from pkgutil import iter_modules
from types import ModuleType
from typing import Any

from readers.documents import is_number
from readers.text import BadInputError, shown
from scenarios.benchmark import own
from scenarios.benchmark.case import BenchmarkCase
from scenarios.benchmark.elsewhere import OtherPython, other_python

Answers = Mapping[str, float]


class CannotAnswerError(Exception):
    """A program failed at a point, or returned what is not an answer; the message states the reason."""


#: Package of the adapters of other programs; a wheel has none.
PEERS = "evidence.benchmark_peers"


@dataclass(frozen=True)
class Program:
    """A program: its name, its version, its answers to a point of a case (numbered from 0), and whether it computes."""

    name: str
    version: str
    ask: Callable[[BenchmarkCase, int], Answers]
    computes: bool = True


def own_program() -> Program:
    """Return this project."""
    return of_module(own)


def programs() -> tuple[list[Program], dict[str, str]]:
    """Return this project, the published formulas and the peers, and the reason of each peer that is missing.

    Peers run in the Python that BOGIE_BRAKING_PEERS names, if it is set. A wheel has no peers.
    """
    found, missing = [own_program(), *map(of_module, _modules(f"{__package__}.methods"))], dict[str, str]()
    for module in _modules(PEERS) if find_spec(PEERS.partition(".")[0]) else ():
        try:
            other = other_python()
            found.append(of_adapter(module, other) if other else of_module(module))
        except ImportError as error:
            missing[str(module.NAME)] = str(error)
    return found, missing


def _modules(package: str) -> Iterator[ModuleType]:
    for module in iter_modules(import_module(package).__path__):
        yield import_module(f"{package}.{module.name}")


def of_adapter(module: ModuleType, other: OtherPython) -> Program:
    """Return the program of an adapter in another Python."""
    place = str(module.__file__)

    def ask(case: BenchmarkCase, point: int) -> Answers:
        try:
            found = other.answer(place, case.question, case.points[point].inputs)
        except RuntimeError as error:
            raise CannotAnswerError(str(error)) from error
        return checked(found, case)

    return Program(str(module.NAME), str(other.call(place, "version")), ask)


def of_module(module: ModuleType, strict: bool = False) -> Program:
    """Return the program of an adapter, a module with NAME, `version()` and `answer(question, inputs)`.

    Its output goes to the standard error. strict: answers of which the case needs none are an error.
    """

    def ask(case: BenchmarkCase, point: int) -> Answers:
        try:
            with redirect_stdout(sys.stderr):
                found = module.answer(case.question, dict(case.points[point].inputs))
        except KeyError as error:
            raise CannotAnswerError(f"it needs the input {error}, which the case lacks.") from error
        except (Exception, SystemExit) as error:
            raise CannotAnswerError(f"{type(error).__name__}: {error}") from error
        return checked(found, case, strict)

    return Program(str(module.NAME), str(module.version()), ask)


def checked(found: Any, case: BenchmarkCase, strict: bool = False) -> Answers:
    """Return what a program returned as answers. Raises CannotAnswerError if it is not valid."""
    if found is None:
        return {}
    if not isinstance(found, Mapping):
        raise CannotAnswerError(f"answer must return a dictionary or None; got {shown(found)}.")
    for name, value in found.items():
        if name in case.answers and not is_number(value):
            raise CannotAnswerError(f"{name} must be a finite number; got {shown(value)}. Or leave it out.")
    if strict and found and not set(found) & case.answers.keys():
        asked, got = ", ".join(case.answers), ", ".join(map(str, found))
        raise CannotAnswerError(f"the answers must have one of {asked}; got {shown(got)}.")
    return {name: float(value) for name, value in found.items() if name in case.answers}


def of_file(path: Path) -> Program:
    """Return a user's program, a Python file with `answer(question, inputs)`, and NAME and VERSION if it has them."""
    if not path.is_file():
        raise BadInputError(f"--program must be a Python file; got {path}, which does not exist. Check the path.")
    about = importlib.util.spec_from_file_location(f"program_in_{path.stem}", path)
    if about is None or about.loader is None:
        raise BadInputError(f"--program must be a Python file, NAME.py; got {path}.")
    module = sys.modules[about.name] = importlib.util.module_from_spec(about)
    try:
        with redirect_stdout(sys.stderr):
            about.loader.exec_module(module)
    except (Exception, SystemExit) as error:
        raise BadInputError(f"Cannot import {path}: {type(error).__name__}: {error}.") from error
    if not callable(getattr(module, "answer", None)):
        raise BadInputError(f"{path} must have a function answer(question, inputs); got none. Add it.")
    module.NAME = str(getattr(module, "NAME", path.stem))  # type: ignore[attr-defined]
    version = str(getattr(module, "VERSION", "no version stated"))
    module.version = getattr(module, "version", lambda: version)  # type: ignore[attr-defined]
    return of_module(module, strict=True)

"""What the command line names as controllers: Python classes, shared libraries, C files."""

from __future__ import annotations

import importlib.util
from collections.abc import Sequence
from pathlib import Path

from brake_controller.wheel_slide import SlideProtection
from fmu_src.compile import CompilerError
from products.protection.braked_machine import bogie
from products.protection.forms import Form, InC, compiled
from scenarios.scenario import BadInputError

#: Of every comparison, ahead of what is given.
ALWAYS: dict[str, Form] = {"none": None, "protection": SlideProtection}
LIBRARIES = (".so", ".dll", ".dylib")


def forms_of(given: Sequence[str]) -> dict[str, Form]:
    """Controllers by their names, those of every comparison first. Raises BadInputError, CompilerError."""
    forms = dict(ALWAYS)
    for text in given:
        name, form = form_of(text)
        if name in forms:
            raise BadInputError(f"Two controllers are called {name}; give each another name.")
        forms[name] = form
    return forms


def form_of(text: str) -> tuple[str, Form]:
    """The name of a controller, and what it is. Raises BadInputError, CompilerError."""
    file, _, name = text.rpartition(":")
    if file.endswith(".py"):
        return name, class_in(Path(file), name)
    path = Path(text)
    if path.suffix not in (*LIBRARIES, ".c"):
        raise BadInputError(f"Give FILE.py:CLASS, a shared library or a C file as a controller: it was {text}.")
    if not path.is_file():
        raise BadInputError(f"There is no file {path}; give the path of a controller.")
    try:
        form = compiled(path) if path.suffix == ".c" else InC(path.resolve())
        form.functions(len(bogie().numbers))
    except CompilerError as error:
        raise BadInputError(f"{path} does not compile. {error}") from None
    except (OSError, AttributeError, ValueError) as error:
        raise BadInputError(
            f"{path} is no controller ({error}); it needs the functions of wheel_slide.h, which "
            "bogie-braking controllers header prints."
        ) from None
    return path.stem, form


def class_in(file: Path, name: str) -> type:
    """A class of a Python file. Raises BadInputError."""
    if not file.is_file():
        raise BadInputError(f"There is no file {file}; give FILE.py:CLASS.")
    about = importlib.util.spec_from_file_location(file.stem, file)
    assert about is not None
    assert about.loader is not None
    module = importlib.util.module_from_spec(about)
    try:
        about.loader.exec_module(module)
    except Exception as error:
        raise BadInputError(f"{file} cannot be imported ({type(error).__name__}: {error}); mend it.") from error
    found = getattr(module, name, None)
    if not isinstance(found, type) or not callable(getattr(found, "step", None)):
        raise BadInputError(f"{file} has no class {name} with a method step(time, wheel_speeds); give one that has.")
    try:
        found()
    except (Exception, SystemExit) as error:
        raise BadInputError(
            f"{name} of {file} cannot be made without arguments ({type(error).__name__}: {error}); give its gains "
            "default values, or write a class below it that sets them."
        ) from None
    return found

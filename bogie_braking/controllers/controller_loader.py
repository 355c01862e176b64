"""Controllers named on the command line: Python classes, shared libraries, C files, FMUs."""

from __future__ import annotations

import ast
import importlib.util
import inspect
import re
import sys
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bogie_braking.reporting.scenario import BadInputError
from brake_controller.wheel_spin import SpinProtection
from fmu_src.archive import ArchiveError
from fmu_src.compile import CompilerError
from products.controller_kinds import PUBLIC, Arrays, Form, InC, compiled
from products.protection.own_process import Apart
from products.protection.rig_in_c import slide_protection
from readers.text import FileError
from readers.toml_files import toml_of

if TYPE_CHECKING:
    from products.protection.in_fmu import Names

#: Controllers of a comparison: in this process, or in a separate one.
Given = Form | Apart
#: Controllers of every comparison, before the given ones.
ALWAYS = ("none", "protection")
LIBRARIES = (".so", ".dll", ".dylib")
KINDS = (*LIBRARIES, ".c", ".fmu")
#: FILE.py:CLASS, with or without the gains of the class.
IN_PYTHON = re.compile(r"(?P<file>.+\.py):(?P<name>\w+)(?P<gains>\(.*\))?", re.DOTALL)


def controllers_of(given: Sequence[str], wheelsets: int, driven: bool = False) -> dict[str, Given]:
    """Return controllers by their names, those of every comparison first."""
    found: dict[str, Given] = dict(zip(ALWAYS, (None, SpinProtection if driven else slide_protection()), strict=True))
    for text in given:
        name, controller = controller_of(text, wheelsets)
        if name in found and Path(text).suffix in KINDS:
            name = Path(text).name  # names are those of files: libpi.so next to pi.c, pi.fmu next to it
        if name in found:
            raise BadInputError(f"Two controllers are called {name}; give each another name.")
        found[name] = controller
    return found


def controller_of(text: str, wheelsets: int) -> tuple[str, Given]:
    """Return the name of a controller and its form."""
    in_python = IN_PYTHON.fullmatch(text)
    if in_python:
        name, make = maker_in(Path(in_python["file"]), in_python["name"], in_python["gains"] or "")
        return name, form_of(make)
    path = PUBLIC.get(text, Path(text))
    if path.suffix not in KINDS:
        kinds = f"FILE.py:CLASS, a shared library, a C file, an FMU or {' or '.join(PUBLIC)}"
        raise BadInputError(f"A controller must be {kinds}; got {text}.")
    if not path.is_file():
        raise BadInputError(f"There is no file {path}; give the path of a controller.")
    if path.suffix == ".fmu":
        from products.protection.in_fmu import InFmu  # with FMPy, an optional dependency

        return path.stem, Apart(partial(InFmu, path.resolve(), fmu_names(path, wheelsets)))
    try:
        library = compiled(path) if path.suffix == ".c" else InC(path.resolve())
    except CompilerError as error:
        raise BadInputError(f"{path} does not compile. {error}") from None
    return text if text in PUBLIC else path.stem, Apart(library.checked)


def fmu_names(path: Path, wheelsets: int) -> Names:
    """Return the names in an FMU: those of the table next to it, NAME.toml, or those of the project's FMUs."""
    from fmu_src.cosimulation.opening import description_of
    from products.protection.in_fmu import Names

    table = path.with_suffix(".toml")
    try:
        about = [variable.name for variable in description_of(path).modelVariables]
        if not table.is_file():
            own = sum(bool(re.fullmatch(r"wheel_speed_\d+", name)) for name in about)
            if own not in (0, wheelsets):
                words = f"give one for the {wheelsets} of this machine, as build_fmu.py --wheelsets {wheelsets} makes"
                raise BadInputError(f"{path} is for {own} wheelsets; {words}.")
            speeds, valves = (
                tuple(f"{name}_{n}" for n in range(1, wheelsets + 1)) for name in ("wheel_speed", "valve")
            )
            return Names(speeds, valves, "period" if "period" in about else "")
        read = toml_of(table)
        values = tuple((name, float(value)) for name, value in read.get("values", {}).items())
        return Names(tuple(read["wheel_speed"]), tuple(read["valve"]), read.get("period", ""), values)
    except BadInputError:
        raise
    except (ArchiveError, FileError) as error:
        raise BadInputError(str(error)) from None
    except (KeyError, TypeError, ValueError) as error:
        raise BadInputError(
            f"{table} lacks or mistakes {error}; it names wheel_speed and valve, wheelset by wheelset."
        ) from None


def maker_in(file: Path, name: str, gains: str = "") -> tuple[str, Callable[[], Any]]:
    """Return the name of a class with its gains, such as (0.3, limit=2), and a function that makes a controller."""
    try:
        call = ast.parse(name + (gains or "()"), mode="eval").body
        if not isinstance(call, ast.Call) or any(one.arg is None for one in call.keywords):
            raise ValueError
        values = [ast.literal_eval(one) for one in call.args]
        named = {str(keyword.arg): ast.literal_eval(keyword.value) for keyword in call.keywords}
    except (SyntaxError, ValueError):
        words = f"Gains must be numbers or texts, as in {file}:{name}(0.3, limit=2)"
        raise BadInputError(f"{words}; got {gains}.") from None
    make = partial(class_in(file, name), *values, **named)
    try:
        make()
    except (Exception, SystemExit) as error:
        words, why = f"{name} of {file} cannot be made", f"({type(error).__name__}: {error})"
        usual = f"give its gains default values, or give them here, as in {file}:{name}(0.3, limit=2)."
        raise BadInputError(
            f"{words} with {gains} {why}; give it others." if gains else f"{words} without arguments {why}; {usual}"
        ) from None
    return ast.unparse(call) if gains else name, make


def form_of(make: Callable[[], Any]) -> Form:
    """Return the form of a controller of one vehicle, or of many at once, which has a method `start`.

    The forms are those of products/protection/controller_kinds.py.
    """
    one = make()
    return Arrays(one) if _begins_many(getattr(one, "start", None)) else make


def _begins_many(start: object) -> bool:
    """Return whether `start` takes rows, count, wheelsets and period; other classes may have another `start`."""
    try:
        return callable(start) and inspect.signature(start).bind(*range(4)) is not None
    except TypeError:
        return False


def class_in(file: Path, name: str) -> type:
    """Return a class of a Python file."""
    if not file.is_file():
        raise BadInputError(f"There is no file {file}; give FILE.py:CLASS.")
    about = importlib.util.spec_from_file_location(f"controllers_in_{file.stem}", file)
    assert about is not None
    assert about.loader is not None
    module = sys.modules[about.name] = importlib.util.module_from_spec(about)  # dataclasses look up their module there
    try:
        about.loader.exec_module(module)
    except Exception as error:
        raise BadInputError(f"{file} cannot be imported ({type(error).__name__}: {error}); mend it.") from error
    found = getattr(module, name, None)
    if not isinstance(found, type) or not callable(getattr(found, "step", None)):
        raise BadInputError(f"{file} has no class {name} with a method step(time, wheel_speeds); give one that has.")
    return found

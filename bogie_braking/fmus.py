"""FMUs as files: those that there are, and systems of equations of one's own."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from fmpy.validation import validate_fmu

from fmu_src.native_fmu import build_native_fmu, build_native_fmu3
from fmu_src.python_fmu import build_python_fmu
from fmu_src.suggestion import suggestion
from fmu_src.system import Model, System, model_of
from products.building import up_to_date
from products.registry import FMUS

BUILD = {"native": build_native_fmu, "fmi3": build_native_fmu3, "python": build_python_fmu}
#: Error of an integration step in nominal values of the states, unless a model says another.
TOLERANCE = 1e-6


def fmu(name: str, kind: str = "native") -> Path:
    """Path of an FMU by its name, such as "bogie", built now unless it is there.

    kind: "native" for FMI 2.0, "fmi3" for FMI 3.0, "python" for pythonfmu. Raises KeyError for another name or kind.
    """
    return up_to_date(known(name, FMUS), known(kind, BUILD, "kind of FMU"))


def known(name: str, those: Iterable[str] = tuple(FMUS), what: str = "FMU") -> str:
    """The name, if it is one of those. Raises KeyError with a sentence."""
    if name not in those:
        raise KeyError(f"There is no {what} {name}; {suggestion(name, those)}")
    return name


def write_fmu(model: Model | System, path: str | Path, kind: str = "native") -> Path:
    """Builds the FMU of a system of one's own, or of a model of several; its path.

    kind: as of `fmu`. Raises KeyError for another kind, CompilerError where no C compiler works, ValueError with what
    fmpy finds wrong in the FMU.
    """
    path = Path(path)
    BUILD[known(kind, BUILD, "kind of FMU")](model_of(model, TOLERANCE) if isinstance(model, System) else model, path)
    problems = validate_fmu(str(path))
    if problems:
        raise ValueError(f"{path} is no valid FMU: {' '.join(map(str, problems))}")
    return path

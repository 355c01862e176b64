"""FMUs as files: those that there are, and vehicles and systems of equations of one's own."""

from __future__ import annotations

from pathlib import Path

from fmpy.validation import validate_fmu

from bogie_braking.checks import known
from bogie_braking.machines import LEVELS, model_from
from fmu_src.chain import ONE_WRITES
from fmu_src.native_fmu import build_native_fmu, build_native_fmu3
from fmu_src.python_fmu import build_python_fmu
from fmu_src.system import Model, System
from products.building import up_to_date
from products.registry import FMUS
from rbd_model.levels.models import places_of
from rbd_model.vehicle.description import Vehicle

BUILD = {"native": build_native_fmu, "fmi3": build_native_fmu3, "python": build_python_fmu}


def fmu(name: str, kind: str = "native") -> Path:
    """Path of an FMU by its name, such as "bogie", built now unless it is there.

    kind: "native" for FMI 2.0, "fmi3" for FMI 3.0, "python" for pythonfmu. Raises KeyError for another name or kind.
    """
    return up_to_date(known(name, FMUS, "FMU"), known(kind, BUILD, "kind of FMU"))


def write_fmu(what: Vehicle | System | Model, path: str | Path, kind: str = "native", level: int | None = None) -> Path:
    """Builds the FMU of a vehicle, a system or a model of one's own; its path.

    kind: as of `fmu`. level: of a vehicle, the only level of detail that its FMU has; None: all, behind the parameter
    `level`, which compile for a minute. Raises KeyError for another kind, TypeError for what no FMU can be made of,
    CompilerError where no C compiler works, OSError for a path that cannot be written, ValueError for another level and
    with what fmpy finds wrong in the FMU.
    """
    build, path = BUILD[known(kind, BUILD, "kind of FMU")], Path(path)
    if isinstance(what, str):
        raise TypeError(
            f"{what} is a name: fmu gives the FMUs of the list; write_fmu takes a Vehicle, a System or a Model."
        )
    if level not in (None, *LEVELS):
        raise ValueError(f"Give level 1, 2 or 3, or leave it out for all of them: it was {level!r}.")
    if path.suffix != ".fmu":
        raise ValueError(f"{path} must end with .fmu, the only name under which hosts take an FMU.")
    with ONE_WRITES:
        build(model_from(what, places_of(level)), path)
    problems = validate_fmu(str(path))
    if problems:
        raise ValueError(f"{path} is no valid FMU: {' '.join(map(str, problems))}")
    return path

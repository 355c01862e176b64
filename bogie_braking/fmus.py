"""FMUs as files: the built-in ones, and FMUs of your vehicles and equations."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from fmpy.validation import validate_fmu

from bogie_braking.checks import known
from bogie_braking.machines import LEVELS, model_from
from fmu_src.chain import ONE_WRITES
from fmu_src.native_fmu import build_native_fmu, build_native_fmu3
from fmu_src.python_fmu import build_python_fmu
from fmu_src.start_values import with_start_values
from fmu_src.system import Model, System
from products.building import up_to_date
from products.registry import FMUS
from products.vehicle_file import DataSheet
from rbd_model.levels.models import places_of
from rbd_model.vehicle.description import Vehicle
from readers.storage import write_whole
from readers.text import text_of

#: Contact table among the resources of an FMU.
PAIR = "pair.csv"
BUILD = {"native": build_native_fmu, "fmi3": build_native_fmu3, "python": build_python_fmu}


def fmu(name: str, kind: str = "native") -> Path:
    """Return the path of a built-in FMU; build it if needed.

    Parameters
    ----------
    name : str
        Name of the FMU, such as "bogie".
    kind : str
        "native" for FMI 2.0, "fmi3" for FMI 3.0, "python" for pythonfmu.

    Returns
    -------
    Path
        Path of the FMU.

    Raises
    ------
    KeyError
        If the name or the kind is unknown.
    """
    return up_to_date(known(name, FMUS, "FMU"), known(kind, BUILD, "kind of FMU"))


def write_fmu(
    what: DataSheet | Vehicle | System | Model, path: str | Path, kind: str = "native", level: int | None = None
) -> Path:
    """Build the FMU of your own vehicle, system or model, and validate it.

    A vehicle from a file with 2 or 4 axles, and without tables of forces, needs no compiler: its FMU is the built-in
    one with the file's values as start values.

    Parameters
    ----------
    what : DataSheet, Vehicle, System or Model
        Contents of the FMU; a DataSheet is a vehicle from a file (`read_vehicle`).
    path : str or Path
        File to write; it must end with .fmu.
    kind : str
        As in `fmu`.
    level : int, optional
        For a vehicle: the only level of detail of its FMU. If omitted, the FMU has all levels and the parameter
        `level`; they compile for a minute.

    Returns
    -------
    Path
        Path of the FMU.

    Raises
    ------
    KeyError
        If the kind is unknown.
    TypeError
        If no FMU can be made of `what`.
    CompilerError
        If no C compiler works.
    OSError
        If the path cannot be written.
    ValueError
        If the level does not exist, if the path does not end with .fmu, or if fmpy finds faults in the FMU.
    """
    build, path = BUILD[known(kind, BUILD, "kind of FMU")], Path(path)
    if isinstance(what, str):
        raise TypeError(
            f"{what} is a name: fmu gives the FMUs of the list; write_fmu takes a Vehicle, a System or a Model."
        )
    if level not in (None, *LEVELS):
        raise ValueError(f"level must be 1, 2 or 3, or left out for all of them; got {level!r}.")
    if path.suffix != ".fmu":
        raise ValueError(f"{path} must end with .fmu, the only name under which hosts take an FMU.")
    if isinstance(what, DataSheet):
        _of_a_sheet(what, path, kind, level)
    else:
        with ONE_WRITES:
            build(model_from(what, places_of(level)), path)
    problems = validate_fmu(str(path))
    if problems:
        raise ValueError(f"{path} is not a valid FMU: {' '.join(map(str, problems))}")
    return path


def _of_a_sheet(sheet: DataSheet, path: Path, kind: str, level: int | None) -> None:
    """Write the FMU of a vehicle from a file: the built-in one, or that of its equations, with its values and tables.

    Raises ValueError if `kind` is "python" and there are values: it reads none.
    """
    data = {PAIR: one_table(sheet.profile_files)} if sheet.profile_files else {}
    values = sheet.values | ({} if level is None else {"level": float(level)}) if sheet.fmu else dict(sheet.resistance)
    if kind == "python" and (sheet.fmu or values or data):
        raise ValueError(
            "kind must be native or fmi3 for a vehicle from a file; got python. Its values are read by native FMUs."
        )
    if sheet.fmu is not None:
        made = fmu(sheet.fmu, kind)
    else:
        with ONE_WRITES:
            BUILD[kind](model_from(sheet.vehicle, places_of(level)), path)
        made = path
    write_whole(path, with_start_values(made, values, data, sheet.name))


def one_table(paths: Sequence[Path]) -> bytes:
    """Return files of contact tables as one, which has the tables one after the other."""
    return paths[0].read_bytes() if len(paths) == 1 else "".join(f"{text_of(path)}\n" for path in paths).encode()

"""FMUs as files: the built-in ones, and FMUs of your vehicles and equations."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

from bogie_braking.checks import known, line_or_none
from bogie_braking.line_in_file import file_of
from bogie_braking.machines import LEVELS, model_from
from fmu_src.chain import ONE_WRITES
from fmu_src.native_fmu import build_native_fmu, build_native_fmu3
from fmu_src.python_fmu import build_python_fmu
from fmu_src.start_values import with_start_values
from fmu_src.system import Model, System
from products.building import up_to_date, validation
from products.registry import FMUS, fmu_named
from products.vehicle_sheet import DataSheet
from rbd_model.levels.models import places_of
from rbd_model.track.line import Line
from rbd_model.track.line_table import LINE
from rbd_model.vehicle.description import Vehicle
from readers.extras import need
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
    what: str | DataSheet | Vehicle | System | Model,
    path: str | Path,
    kind: str = "native",
    level: int | None = None,
    line: Line | None = None,
) -> Path:
    """Build the FMU of a vehicle, system or model, and validate it.

    A built-in vehicle needs no compiler: the FMU is the built-in one with its own start values. The same is true of a
    vehicle from a file with 2 or 4 axles and no connections or bodies of its own. Start values, contact table and line
    are files in its resources, from which its GUID follows. A host must pass it the location of its resources.

    Parameters
    ----------
    what : str, DataSheet, Vehicle, System or Model
        Contents of the FMU. A str names a built-in one. A DataSheet is a vehicle from a file (`read_vehicle`).
    path : str or Path
        File to write; it must end with .fmu.
    kind : str
        As in `fmu`.
    level : int, optional
        For a vehicle: the only level of detail of its FMU. If omitted, the FMU has all levels and the parameter
        `level`; they compile for a minute. A built-in FMU keeps all levels, and starts with this one.
    line : Line, optional
        The line on which the FMU starts.

    Returns
    -------
    Path
        Path of the FMU.

    Raises
    ------
    KeyError
        If the name or the kind is unknown.
    TypeError
        If no FMU can be made of `what`.
    CompilerError
        If no C compiler works.
    MissingExtraError
        If FMPy is not installed, or pythonfmu for the kind python, or CasADi for equations that no wheel has compiled.
    OSError
        If the path cannot be written.
    ValueError
        If the level does not exist, if the path does not end with .fmu, if a pythonfmu FMU should have start values or
        a line, or if fmpy finds faults in the FMU.
    """
    known(kind, BUILD, "kind of FMU")
    need("fmpy", *(["pythonfmu"] if kind == "python" else []))
    path, line = Path(path), line_or_none(line)
    if level not in (None, *LEVELS):
        raise ValueError(f"level must be 1, 2 or 3, or left out for all of them; got {level!r}.")
    if path.suffix != ".fmu":
        raise ValueError(f"{path} must end with .fmu, the only name under which hosts take an FMU.")
    sheet = what if isinstance(what, DataSheet) else None
    data = {PAIR: one_table(sheet.profile_files)} if sheet and sheet.profile_files else {}
    if line is not None:
        data[LINE.resource] = _bytes_of(line)
    made, values = _made(what, path, kind, level)
    if values or data or sheet:
        if kind == "python":
            raise ValueError(
                "kind must be native or fmi3 for a vehicle from a file, a level or a line; got python. Native FMUs"
                " alone read such values."
            )
        write_whole(path, with_start_values(made, values, data, sheet.name if sheet else ""))
    elif made != path:
        write_whole(path, made.read_bytes())
    problems = validation.validate_fmu(str(path))
    if problems:
        raise ValueError(f"{path} is not a valid FMU: {' '.join(map(str, problems))}")
    return path


def _made(
    what: str | DataSheet | Vehicle | System | Model, path: Path, kind: str, level: int | None
) -> tuple[Path, dict[str, float]]:
    """Return the FMU with the equations, a built-in one or that which is built at a path, and its start values."""
    name = what if isinstance(what, str) else what.fmu if isinstance(what, DataSheet) else None
    values = {} if level is None else {"level": float(level)}
    if name is not None:
        own = what.values if isinstance(what, DataSheet) else {}
        return fmu(fmu_named(name), kind), own | values
    equations = what.vehicle if isinstance(what, DataSheet) else what
    with ONE_WRITES:
        BUILD[kind](model_from(equations, places_of(level)), path)  # type: ignore[arg-type]
    return path, dict(what.resistance) if isinstance(what, DataSheet) else {}


def _bytes_of(line: Line) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        return Path(str(file_of(line, folder))).read_bytes()


def one_table(paths: Sequence[Path]) -> bytes:
    """Return files of contact tables as one, which has the tables one after the other."""
    return paths[0].read_bytes() if len(paths) == 1 else "".join(f"{text_of(path)}\n" for path in paths).encode()

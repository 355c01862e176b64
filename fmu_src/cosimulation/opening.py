"""FMUs as they come from anywhere: description and binary, looked at before anything is loaded."""

from __future__ import annotations

import io
import re
from collections.abc import Sequence
from pathlib import Path
from zipfile import ZipFile

from fmu_src.archive import ArchiveError, files_in, opened, unpack
from fmu_src.cosimulation.faces import FACES, ModelDescription
from fmu_src.shared_library import fault_of
from readers.extras import named_extras

with named_extras():
    import fmpy
    from fmpy.model_description import ValidationError, read_model_description

DESCRIPTION, BUILD = "modelDescription.xml", "sources/buildDescription.xml"
#: Largest description [bytes], and the most values of a variable that is an array.
LARGEST_DESCRIPTION, MOST_VALUES = 1 << 26, 10_000_000
#: Folder in binaries/ for this platform, by the version of FMI.
FOLDERS = {"2.0": fmpy.platform, "3.0": fmpy.platform_tuple}
IDENTIFIER = re.compile(r"[A-Za-z_]\w*", re.ASCII)


def description_of(path: Path) -> ModelDescription:
    """Return the model description of an FMU, without unpacking it. Raises ArchiveError."""
    with opened(path) as archive:
        return description_in(archive)


def description_in(archive: ZipFile) -> ModelDescription:
    """Return the description in an archive. Raises ArchiveError."""
    files = files_in(archive, (DESCRIPTION, BUILD).__contains__, LARGEST_DESCRIPTION)
    if DESCRIPTION not in files:
        raise ArchiveError(f"it has no {DESCRIPTION}")
    if any(b"<!DOCTYPE" in data.replace(b"\0", b"") for data in files.values()):  # in UTF-16 too
        raise ArchiveError(f"its {DESCRIPTION} declares a document type, with which entities can be sized at will")
    alone = io.BytesIO()
    with ZipFile(alone, "w") as made:
        for name, data in files.items():
            made.writestr(name, data)
    try:
        return read_model_description(alone)
    except ValidationError as error:
        reason = str(error.problems[0]) if error.problems else str(error)
    except Exception as error:  # of many kinds, from lxml, Python and FMPy
        reason = str(error) or type(error).__name__
    raise ArchiveError(f"{DESCRIPTION} cannot be read: {reason.rstrip('.')}")


def unpacked(path: Path, folder: Path) -> ModelDescription:
    """Return the description of an FMU for co-simulation; unpack its resources and its binary for this platform."""
    with opened(path) as archive:
        about = description_in(archive)
        fault = fault_of_description(about) or fault_of_names(about, archive.namelist())
        if not fault:
            unpack(archive, folder, is_needed)
    fault = fault or fault_of_libraries(folder)
    if fault:
        raise ArchiveError(f"{path} {fault}.")
    return about


def is_needed(name: str) -> bool:
    """Return whether an instance may need an entry: not sources, documentation and binaries of other platforms."""
    first, second, *_ = *name.split("/"), ""
    return second in FOLDERS.values() if first == "binaries" else first not in ("sources", "documentation")


def fault_of_description(about: ModelDescription) -> str:
    """Return the reason why an FMU is not usable for co-simulation here; empty if it is."""
    if about.fmiVersion not in FACES:
        return f"is of FMI {about.fmiVersion}; this master knows {' and '.join(FACES)}"
    if about.coSimulation is None:
        return "is for model exchange only; export it for co-simulation"
    if not IDENTIFIER.fullmatch(about.coSimulation.modelIdentifier or ""):
        return f"is not a valid FMU: its modelIdentifier {about.coSimulation.modelIdentifier!r} is not a name in C"
    for modelvariable in about.modelVariables:
        count = 1
        for size in modelvariable.shape:
            count *= size
        if not 0 <= count <= MOST_VALUES:
            return f"is not a valid FMU: {modelvariable.name} has {count} values; at most {MOST_VALUES} are read"
    return ""


def fault_of_names(about: ModelDescription, names: Sequence[str]) -> str:
    """Return the platforms for which an FMU has binaries, if this is not one of them."""
    platform = FOLDERS[about.fmiVersion]
    if f"binaries/{platform}/{about.coSimulation.modelIdentifier}{fmpy.sharedLibraryExtension}" in names:
        return ""
    others = sorted({name.split("/")[1] for name in names if name.startswith("binaries/") and name.count("/") > 1})
    return f"has no binary for {platform}, but for {', '.join(others) or 'no platform'}"


def fault_of_libraries(folder: Path) -> str:
    """Return the reason why a library of an unpacked FMU cannot be loaded here; empty if all can."""
    for one in sorted(folder.rglob(f"*{fmpy.sharedLibraryExtension}")):
        if one.is_file() and (fault := fault_of(one.read_bytes())):
            return f"is not a valid FMU: {one.relative_to(folder).as_posix()} {fault}"
    return ""

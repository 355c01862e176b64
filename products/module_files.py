"""The source files of an FMU: those of the modules that its makers import, and the files that these may read."""

import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from products.sources import HOUSE, KINDS, PREBUILT, ROOT, digest

#: An import from a module of the packages, in their only form.
IMPORT = re.compile(r"^[ \t]*from ([\w.]+) import (\([^)]*\)|[^\n]*)", re.MULTILINE)


#: The list imports all FMUs: the product of one depends on the list, not on the others.
LIST = ROOT / "products" / "registry.py"
#: Sources of this room travel in FMUs, and some are read as text: all of it counts for each.
WHOLE = ROOT / "fmu_src"


@cache
def digest_of(*modules: str) -> str:
    """Return a digest of the files of modules, which are given by their dotted names; computed once in a process."""
    return digest(*(path.relative_to(ROOT).as_posix() for path in sorted(files_of(*modules))))


def files_of(*modules: str) -> set[Path]:
    """Return the files that modules are made from, all of `fmu_src`, and the list of FMUs without its imports.

    A module may read files other than Python in its folder, and in the folders below that hold no Python. Modules of an
    entry of the list are to be given in addition.
    """
    found = {path for path in WHOLE.rglob("*") if path.suffix in KINDS} | {LIST}
    followed: set[Path] = set()
    waiting = [path for module in modules for path in _files_of(module)]
    while waiting:
        path = waiting.pop()
        if path not in followed:
            followed.add(path)
            waiting += imports_of(path) if path != LIST else ()
    found |= followed
    return found | {path for folder in {one.parent for one in found} for path in _read_in(folder)}


def imports_of(path: Path) -> set[Path]:
    """Return the files of the packages that a module imports, also below a condition or within a function."""
    found: set[Path] = set()
    for module, names in IMPORT.findall(path.read_text(encoding="utf-8")):
        for name in (module, *(f"{module}.{one}" for one in re.findall(r"(\w+)(?: as \w+)?", names))):
            found.update(_files_of(name))
    return found


@cache
def _files_of(module: str) -> tuple[Path, ...]:
    """Return the file of a module of the packages, and those of the packages that contain it."""
    parts = module.split(".")
    if parts[0] == HOUSE[-1] and not (ROOT / parts[0]).is_dir():  # in a wheel all rooms are below the one name
        parts = parts[1:] or [""]
    place = ROOT.joinpath(*parts)
    own = [path for path in (place.with_suffix(".py"), place / "__init__.py") if path.is_file()]
    if not own or parts[0] not in HOUSE:
        return ()
    packages = (ROOT.joinpath(*parts[:length], "__init__.py") for length in range(1, len(parts)))
    return (*own, *(path for path in packages if path.is_file()))


def _read_in(folder: Path) -> Iterator[Path]:
    for path in folder.iterdir():
        if path.is_dir() and path != PREBUILT and not any(path.glob("*.py")):
            yield from _read_in(path)
        elif path.is_file() and path.suffix in KINDS - {".py"}:
            yield path

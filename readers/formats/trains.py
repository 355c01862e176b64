"""Trains of other programs by the names of their files."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path

from readers.import_account import Imported
from readers.text import FileError, shown

#: Program, module and function by the end of a file's name, in small letters.
FORMATS = {
    ".con": ("Open Rails and MSTS", "open_rails", "read_open_rails"),
    ".eng": ("Open Rails and MSTS", "open_rails", "read_open_rails"),
    ".wag": ("Open Rails and MSTS", "open_rails", "read_open_rails"),
    ".json": ("OSRD", "osrd", "read_osrd"),
    ".yaml": ("ALTRIOS", "altrios", "read_altrios"),
    ".yml": ("ALTRIOS", "altrios", "read_altrios"),
    ".dat": ("OpenBVE", "openbve", "read_openbve"),
    ".xml": ("railML", "railml", "read_railml"),
    ".railml": ("railML", "railml", "read_railml"),
}


def is_foreign(path: Path) -> bool:
    """Return whether a file is of another program, by the end of its name."""
    return path.suffix.lower() in FORMATS


def program_of(path: Path) -> str:
    """Return the program of a file, by the end of its name."""
    return FORMATS[path.suffix.lower()][0]


def read_foreign(path: Path) -> Imported:
    """Return the train in a file of another program."""
    found = FORMATS.get(path.suffix.lower())
    if found is None:
        raise FileError(
            f"{path} must end in one of {', '.join(FORMATS)}; got {shown(path.suffix or path.name)}. Rename it."
        )
    module = import_module(f"{__package__}.{found[1]}")
    reader: Callable[[Path], Imported] = getattr(module, found[2])
    return reader(path)

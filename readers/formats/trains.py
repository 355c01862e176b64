"""Trains of other programs: the reader of a file by the end of its name, built-in or of an installed package.

A package adds a format by an entry point of the group `bogie_braking.trains`. Its name is the end of the file's name
without the dot; it loads a function of the path that returns an `Imported`.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path

from readers.import_account import Imported
from readers.text import FileError, shown

GROUP = "bogie_braking.trains"
#: Built-in formats: program, ends of names, module and function.
BUILT_IN = (
    ("Open Rails and MSTS", ("con", "eng", "wag"), "open_rails:read_open_rails"),
    ("OSRD", ("json",), "osrd:read_osrd"),
    ("ALTRIOS", ("yaml", "yml"), "altrios:read_altrios"),
    ("OpenBVE", ("dat",), "openbve:read_openbve"),
    ("railML", ("xml", "railml"), "railml:read_railml"),
)


def formats() -> dict[str, tuple[str, EntryPoint]]:
    """Return program and reader by the end of a file's name, in small letters; built-in ones come first."""
    found = {
        f".{end}": (program, EntryPoint(end, f"{__package__}.{reader}", GROUP))
        for program, ends, reader in BUILT_IN
        for end in ends
    }
    others = {
        f".{entry_point.name}": (entry_point.dist.name if entry_point.dist else entry_point.module, entry_point)
        for entry_point in entry_points(group=GROUP)
    }
    return found | {end: one for end, one in others.items() if end not in found}


FORMATS = formats()


def is_foreign(path: Path) -> bool:
    """Return whether a file is of another program, by the end of its name."""
    return path.suffix.lower() in FORMATS


def program_of(path: Path) -> str:
    """Return the program of a file, by the end of its name."""
    return FORMATS[path.suffix.lower()][0]


def read_foreign(path: Path) -> Imported:
    """Return the train in a file of another program."""
    if not is_foreign(path):
        raise FileError(
            f"{path} must end in one of {', '.join(FORMATS)}; got {shown(path.suffix or path.name)}. Rename it."
        )
    reader: Callable[[Path], Imported] = FORMATS[path.suffix.lower()][1].load()
    return reader(path)

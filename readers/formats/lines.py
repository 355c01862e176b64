"""Lines of other programs by the content of their files."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path

from readers.alignment import Alignment
from readers.text import FileError, shown
from readers.xml_files import xml_of

#: Modules and functions by the end of a file's name; XML by its root.
FORMATS = {
    ".json": ("osrd_line", "read_osrd_line"),
    ".yaml": ("altrios_line", "read_altrios_line"),
    ".yml": ("altrios_line", "read_altrios_line"),
    ".railml": ("railml_line", "read_railml_line"),
}
ROOTS = {
    "LandXML": ("landxml", "read_landxml"),
    "railml": ("railml_line", "read_railml_line"),
    "railML": ("railml_line", "read_railml_line"),
    "infrastructure": ("railml_line", "read_railml_line"),
}
XML = ".xml"


def is_foreign_line(path: Path) -> bool:
    """Return whether a file is of another program, by the end of its name."""
    return path.suffix.lower() in FORMATS or path.suffix.lower() == XML


def read_foreign_line(path: Path, tracks: Sequence[str] = ()) -> Alignment:
    """Return the line in a file of OSRD, ALTRIOS, railML or LandXML."""
    suffix = path.suffix.lower()
    if suffix == XML:
        root = xml_of(path).tag
        if root not in ROOTS:
            raise FileError(f"{path} must be railML, LandXML, GPX, KML or OSM; got {shown(root)}. Give another file.")
        found = ROOTS[root]
    elif suffix in FORMATS:
        found = FORMATS[suffix]
    else:
        raise FileError(f"{path} must end in one of {', '.join([*FORMATS, XML])}; got {shown(suffix)}. Rename it.")
    reader: Callable[[Path, Sequence[str]], Alignment] = getattr(import_module(f"{__package__}.{found[0]}"), found[1])
    return reader(path, tracks)

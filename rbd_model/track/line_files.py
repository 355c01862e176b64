"""Lines from files of any known form, found by the end of a file's name or by the names of its columns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from rbd_model.track.line import Line, read_line
from rbd_model.track.line_elements import line_from_elements
from rbd_model.track.line_pieces import SourcedLine, line_of_alignment
from rbd_model.track.line_points import line_from_points, line_of_course
from rbd_model.track.point_files import NAMES
from readers.column_words import column_meant
from readers.formats.lines import read_foreign_line
from readers.formats.ways import Course
from readers.import_account import Account
from readers.tables import names_of
from readers.text import BadInputError

#: Columns by which a table is one of elements, or of points; every other table is a line.
OF_ELEMENTS = {"type", "length"}
ELEMENTS, POINTS, FOREIGN, LINE = "elements", "points", "a file of another program", "a line"
MAP = "a course in degrees"
#: Options, and the kinds of file that they belong to.
OPTIONS = {
    "profile": (ELEMENTS,),
    "start": (ELEMENTS, POINTS, MAP),
    "noise": (POINTS, MAP),
    "tracks": (FOREIGN, MAP),
}


def kind_of(path: Path) -> str:
    """Return what a table holds: ELEMENTS, POINTS or LINE. Raises FileError if it cannot be read."""
    names = {column_meant(name, OF_ELEMENTS | NAMES) or name for name in names_of(path)}
    return ELEMENTS if names >= OF_ELEMENTS else POINTS if names & NAMES else LINE


def line_from_file(
    path: str | Path,
    *,
    profile: str | Path | None = None,
    start: float | None = None,
    noise: float | None = None,
    tracks: Sequence[str] = (),
    mirror: bool = False,
) -> Line:
    """Return the line in a file: a line, points, elements, a map, or an infrastructure of another program.

    Parameters
    ----------
    path : str or Path
        The file: a table; OSRD, railML, LandXML, ALTRIOS; GPX, KML, KMZ, GeoJSON, JSON of Overpass, XML of
        OpenStreetMap.
    profile : str or Path, optional
        Table of the vertical profile, for elements.
    start : float, optional
        Distance at the start [m], for elements, points and maps.
    noise : float, optional
        Standard deviation of a point [m], for points and maps.
    tracks : sequence of str
        Tracks of the route, for files of other programs and maps; `-` behind one that is run backwards.
    mirror : bool
        Whether left and right are exchanged.

    Returns
    -------
    Line
        A `SourcedLine` with its `account`, unless the file is a line.

    Raises
    ------
    BadInputError
        If an option does not belong to the file, or points are not a line.
    FileError
        If the file cannot be read.
    """
    path = Path(path)
    found = read_foreign_line(path, tracks)
    kind = kind_of(path) if found is None else MAP if isinstance(found, Course) else FOREIGN
    given = {"profile": profile, "start": start, "noise": noise, "tracks": tracks or None}
    for name, kinds in OPTIONS.items():
        if given[name] is not None and kind not in kinds:
            raise BadInputError(f"{name} must be given for {' or '.join(kinds)} alone; {path} is {kind}. Leave it out.")
    line: Line
    if kind == ELEMENTS:
        line = line_from_elements(path, profile, start)
    elif kind == POINTS:
        line = line_from_points(path, noise, start or 0.0)
    elif found is None:
        line = read_line(path)
    elif isinstance(found, Course):
        line = line_of_course(found, noise, start or 0.0)
    else:
        line = line_of_alignment(found)
    return mirrored(line) if mirror else line


def mirrored(line: Line) -> Line:
    """Return a line with left and right exchanged, and a sentence about it in its account."""
    if not isinstance(line, SourcedLine):
        return line.mirrored()
    account = replace(line.account, converted=[*line.account.converted, "left and right are exchanged (--mirror)"])
    return SourcedLine(line.mirrored().rows, account)


def account_of(line: Line) -> Account:
    """Return the account of a line; empty if it has none."""
    return line.account if isinstance(line, SourcedLine) else Account()

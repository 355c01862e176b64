"""Profiles of the MiniProf: .whl, .ban, .rail with one profile, .mpt with one or more.

A header of `key=value` rows precedes the points. A row whose text begins with one quote is taken out. An .mpt file has
blocks [Profile1Info], [Profile1Points], [Profile2Info] and so on. Wheels have their y = 0 at the back of the flange
(manual of the GENSYS converter). Meaning of the keys: public files, and the reader of CONTACT.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from readers.columns import TableError
from readers.contours import (
    Contour,
    ContourRows,
    Rows,
    check_without_effect,
    other_kind,
    read_points,
    refusal,
    unit_of,
    unknown_keys,
)
from readers.decimal_numbers import is_decimal, number_of
from readers.text import quoted

MARKS = re.compile(r"miniprof|wheelprof|railprof|^[^\S\n]*(ColumnDef|XYPoints)\s*=|^\[Profile\d+Info\]", re.I | re.M)
#: Numbers of points, by the names that programs give them.
COUNTS = ("xypoints", "points", "npoints", "numpoints", "numberofpoints", "pointcount")
BLOCK = re.compile(r"\[(?:Profile(\d+)(Info|Points)|FileInfo)\]", re.I)
#: Keys that were measured, and that describe a pair: name of the fact, least and most [mm].
FACTS = {
    "gauge": ("gauge", 500.0, 2000.0),
    "diametertaperline": ("diameter", 200.0, 2000.0),
    "wheeldiametertaperline": ("tape_circle", 40.0, 100.0),
}
#: Angle of the rail that the instrument measured [deg]; the points stand as they were measured.
ANGLE = "railangle"
#: Keys that describe the measurement and not the points.
SILENT = re.compile(
    r"(uof|mpd|refpoint|w)\d*|mp(cal)?(date|time|dn|dc|typeno|serno)|program(name|ver|date)|filename|date|time|chars|"
    r"area(ref|gain|loss)|axleno|bogie|carno|comment|crownradius|curve|direction|elr|emplacement|flag|gauge(rodlength|"
    r"sensordistance|sensorsamples|sensorstddev)|grade|graderatio|instrument\w*|kp|line|location\w*|mileage|offsetmp|"
    r"originalheader|position|profile(alignment|shaping)|rail|railaligntype|railgaugepoint|railrodlength|rodlength|rcf|"
    r"referenceprofile|sd|sh|qr|sectionno|side|stock|superelevation(height)?|surfacecondition|temperature|track|"
    r"tracksection|transform(ation|state)|username|wheeladjustpoint|wheelid|windows\w*|diameterflange|\w*alarm\w*|"
    r"caliber|rollradius|vehicleno|wheelno|setno|unitno|operator|measuredby|axlenumber|carnumber"
)
OFFSETS = {"xoffset": 0, "yoffset": 1}
#: Kinds of instruments by their type number: 1xx measures wheels, 2xx rails.
KINDS = {"1": "wheel", "2": "rail"}


@dataclass
class Header:
    """Keys of a header: those that change the points, facts, and those without effect."""

    source: str
    count: tuple[int, int] | None = None
    columns: Sequence[str] = ()
    unit: tuple[float, float] | None = None
    offset: list[float] = field(default_factory=lambda: [0.0, 0.0])
    facts: dict[str, float] = field(default_factory=dict)
    unknown: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    kind: str = ""
    of_miniprof: bool = False

    def take(self, row: int, key: str, value: str) -> None:
        """Apply a key, ignore one without effect, or refuse one that would change the points."""
        tidy = re.sub(r"[^a-z0-9]", "", key.lower())
        value = value.strip().strip("'\"").strip()
        if tidy in COUNTS:
            self.count = self._whole(row, key, value), row
        elif tidy == "columndef":
            self.columns = [one.strip().lower() for one in value.split(",")]
        elif tidy.startswith("unit") or tidy.endswith(("unit", "units")):
            self.unit = unit_of(self.source, row, key, value) if value and "ang" not in tidy else self.unit
        elif self.of_miniprof and tidy in OFFSETS:
            self._offset(row, key, value, OFFSETS[tidy])
        elif self.of_miniprof and (tidy in FACTS or tidy == ANGLE or tidy == "mptypeno"):
            self._fact(key, value, tidy)
        elif self.of_miniprof and SILENT.fullmatch(tidy):
            pass
        else:
            check_without_effect(self.source, row, key, value)
            self.unknown += [key] * bool(value)

    def _whole(self, row: int, key: str, value: str) -> int:
        if not value.isdecimal() or len(value) > 9:
            raise refusal(self.source, row, f"{key} must be an integer; got {quoted(value)}. Correct or remove it.")
        return int(value)

    def _offset(self, row: int, key: str, value: str, axis: int) -> None:
        number = number_of(value.replace(" ", "")) if value else 0.0
        if not abs(number) < 1e3:
            raise refusal(self.source, row, f"{key} must be a number of mm; got {quoted(value)}. Correct or remove it.")
        self.offset[axis] = number
        if number:
            self.notes.append(f"{key} = {number:g} mm was added to the points, as CONTACT does")

    def _fact(self, key: str, value: str, tidy: str) -> None:
        if tidy == "mptypeno":
            self.kind = KINDS.get(value[:1], "") if len(value) == 3 else ""
            return
        number = number_of(value) if is_decimal(value) else float("nan")
        if tidy == ANGLE:
            if number:
                self.notes.append(f"{key} = {value} has no effect: the points stand as they were measured")
            return
        name, least, most = FACTS[tidy]
        if least <= number <= most:
            self.facts[name] = number / 1e3
        elif value:
            self.notes.append(f"{key} = {value} has no effect: it is not from {least:g} to {most:g} mm")


KeyAndValue = Callable[[str], "tuple[str, str] | None"]


def is_mpt(text: str) -> bool:
    """Return whether a text has blocks of several profiles."""
    return re.search(r"^\[Profile\d+(Info|Points)\]", text, re.I | re.M) is not None


def read_mpt(rows: Rows, source: str, kind: str, part: int | None, key_and_value: KeyAndValue) -> Contour:
    """Return one profile of an .mpt file."""
    headers, bodies = _parts(rows, source, key_and_value)
    numbers = sorted(bodies)
    if not numbers:
        raise TableError(f"{source} must have a block of points, such as [Profile1Points]; it has none. Complete it.")
    if part is None:
        fitting = [number for number in numbers if not kind or headers[number].kind in ("", kind)]
        if len(fitting) != 1:
            raise TableError(
                f"{source} must have one {kind or 'profile'}, or its number be given; it has the profiles "
                f"{', '.join(map(str, numbers))}. Give one of them, as in {source}#{numbers[0]}."
            )
        part = fitting[0]
    elif part not in bodies:
        raise TableError(f"{source} must have profile {part}; it has {', '.join(map(str, numbers))}. Give one of them.")
    header = headers[part]
    found = kind or header.kind
    if header.kind not in ("", found):
        raise other_kind(source, found, header.kind, f"profile {part} has the type of this instrument")
    contour = contour_of(header, bodies[part], found)
    note = (f"profile {part} of {len(numbers)} was read",) if len(numbers) > 1 else ()
    return Contour(source, contour.points, contour.places, note + contour.notes, contour.facts, found)


def _parts(rows: Rows, source: str, key_and_value: KeyAndValue) -> tuple[dict[int, Header], dict[int, Rows]]:
    headers: dict[int, Header] = {}
    bodies: dict[int, Rows] = {}
    number, what = 0, ""
    for at, row in rows:
        line = row.strip()
        if found := BLOCK.match(line):
            number, what = int(found[1] or 0), (found[2] or "").lower()
            if number:
                headers.setdefault(number, Header(source, of_miniprof=True))
            if what == "points":
                bodies[number] = []
        elif what == "points":
            if not is_taken_out(line):
                bodies[number].append((at, line))
        elif number and (pair := key_and_value(line)):
            headers[number].take(at, *pair)
    return headers, bodies


def contour_of(header: Header, body: Rows, kind: str) -> Contour:
    """Return the contour of a header and its rows of points."""
    unit = header.unit or ((1.0, 1.0) if header.of_miniprof else None)
    points, places, notes = read_points(ContourRows(header.source, kind, body, header.columns, unit, header.count))
    notes = header.notes + notes + unknown_keys(header.unknown)
    return Contour(header.source, (points + header.offset) / 1e3, places, tuple(notes), header.facts, kind)


def is_taken_out(row: str) -> bool:
    """Return whether a MiniProf has taken a row out, by one quote before it; its number of points counts them."""
    return row.lstrip().startswith('"') and row.count('"') == 1

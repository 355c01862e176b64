"""Files of contact tables: a pair of profiles as data of an instance, which FMUs and kernels read (`profile_file`).

The file is text. Its first rows are remarks that name the pair. Then each row is one item of `pair_table.PAIR`: a
number (`radius,0.46`), the head of a table (`table,nearest,322`) with its rows of a breakpoint and the coefficients of
the polynomial from there on, or the head of a list (`list,treads,2`) with its records. The last row is the checksum of
all numbers, so that a digit that was changed is found. Another table may follow: that of the next wheelset. Numbers
are written with as many digits as they have, so that a table that is read is the one that was written.
`fmu_src/runtime/record_file.c` reads the same files.
"""

from __future__ import annotations

import math
import struct
from array import array
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path

from fmu_src.records import LARGEST_NUMBER, MOST_PIECES, Pieces, Record, RecordKind, TableOfRecord
from fmu_src.system import Variable
from fmu_src.user_files import RecordFile
from rbd_model.contact.geometry import GAUGE_DEPTH, Side, Sides, gauge_face
from rbd_model.contact.pair_table import PAIR, PATCH, SIDE, pair_record
from readers.decimal_numbers import is_decimal, number_of
from readers.storage import write_whole
from readers.text import BadInputError, rows_of, shown, text_of

#: Format of the file, in its first row after the remarks.
VERSION = 2
#: Name of the last row; constants of its hash (sealed.h).
CHECKSUM, SEAL_BEGIN, FACTOR, WHOLE = "checksum", 14695981039346656037, 1099511628211, 2**64 - 1
#: Largest difference of cosine^2 + sine^2 from 1.
UNIT = 1e-9
#: How to mend a damaged file.
MAKE_AGAIN = "Make the file again with bogie-braking profile"
#: The contact table as data of an instance.
PAIR_FILE = RecordFile(
    Variable(
        "profile_file",
        "parameter",
        "1",
        "Path of a contact table, the profiles of wheels and rails at level 3 with contact model 2 (docs/profiles.md), "
        "read when it is set, or paths for wheelsets 1, 2, 3... with semicolons between them; empty: pair.csv in the "
        "resources of the FMU where there is one, else the vehicle's own",
        kind="string",
    ),
    noun="contact table",
    resource="pair.csv",
    remedy=MAKE_AGAIN,
    version=VERSION,
    kind=PAIR,
    owner="wheelset",
    source=f"static const double UNIT = {UNIT};\n{(Path(__file__).parent / 'pair.c').read_text(encoding='utf-8')}",
)


def write_pair(sides: Sides, path: str | Path) -> Path:
    """Write the contact table of a pair of profiles (section 4.3), for the parameter `profile_file`."""
    record = pair_record(sides)
    rows = list(rows_of_record(record))
    numbers = [float(cell) for row in rows for cell in row.split(",") if is_decimal(cell)]
    rows = [*remarks(sides), f"{PAIR.name},{VERSION}", *rows, f"{CHECKSUM},{checksum(numbers)}"]
    target = Path(path)
    write_whole(target, "".join(f"{row}\n" for row in rows).encode())
    return target


def checksum(numbers: Iterable[float]) -> str:
    """Return the hash of numbers as the runtime computes it (sealed.h), in the manner of Fowler, Noll and Vo (1991)."""
    found = SEAL_BEGIN
    for (word,) in struct.iter_unpack("<Q", array("d", numbers).tobytes()):
        found = (found ^ word) * FACTOR & WHOLE
        found ^= found >> 29
    return f"{found:016x}"


def remarks(sides: Sides) -> Iterator[str]:
    """Yield the rows that tell what pair it is (section 4.3)."""
    yield "# Contact table of wheels and rails for the parameter profile_file of bogie-braking. Units: metres, radians."
    equal = sides.left == sides.right
    for word, one in (("Both sides", sides.left),) if equal else (("Left", sides.left), ("Right", sides.right)):
        yield f"# {word}: wheel {_name(one.wheel.name)} on rail {_name(one.rail.name)}, {_places(one)}."
    gauge = sum(one.rail_half_distance + gauge_face(one.rail) for one in sides.both)
    yield (
        f"# Gauge {1e3 * gauge:.2f} mm, {1e3 * GAUGE_DEPTH:g} mm below the top; radius of the wheels at y = 0: "
        f"{1e3 * sides.mean_radius:g} mm."
    )


def _name(name: str) -> str:
    return "".join(letter if letter.isprintable() else " " for letter in name)[:200]


def _places(side: Side) -> str:
    return (
        f"y = 0 of the wheel {1e3 * side.wheel_half_distance:.6g} mm and of the rail "
        f"{1e3 * side.rail_half_distance:.6g} mm from the middle"
    )


def rows_of_record(record: Record) -> Iterator[str]:
    """Yield the rows of a record: numbers, tables, lists (section 4.3)."""
    for number, value in zip(record.kind.numbers, record.numbers, strict=True):
        yield f"{number.name},{value!r}"
    for about, (breakpoints, coefficients) in zip(record.kind.tables, record.tables, strict=True):
        yield f"table,{about.name},{len(coefficients)}"
        for place, row in zip(breakpoints, coefficients, strict=False):
            yield ",".join(map(repr, (place, *row)))
        yield repr(breakpoints[-1])
    for one, records in zip(record.kind.lists, record.lists, strict=True):
        yield f"list,{one.name},{len(records)}"
        for each in records:
            yield from rows_of_record(each)


def read_pairs(path: str | Path) -> tuple[Record, ...]:
    """Return the contact tables in a file: those of `write_pair`, one after the other (section 4.3)."""
    reader = _Reader(str(path), rows_of(text_of(path), str(path)))
    found = [reader.root()]
    while reader.goes_on():
        found.append(reader.root())
    return tuple(found)


def joined(paths: Sequence[Path]) -> str:
    """Return the paths of contact tables as a value of `profile_file` (section 4.3)."""
    return (
        str(paths[0]) if len(paths) == 1 else ";".join(f'"{path}"' if ";" in str(path) else str(path) for path in paths)
    )


@dataclass
class _Reader:
    path: str
    rows: Iterator[tuple[int, str]]
    row: int = 0
    numbers: list[float] = field(default_factory=list)

    def root(self) -> Record:
        """Return the next contact table."""
        self.numbers.clear()
        [version] = self.cells(PAIR.name, 1)
        if version != str(VERSION):
            raise self.refused(f"the format must be {VERSION}; got {shown(version)}")
        record = self.record(PAIR)
        wanted = checksum(self.numbers)
        [found] = self.cells(CHECKSUM, 1)
        if found != wanted:
            raise self.refused(f"the checksum must be {wanted}, that of the numbers above; got {shown(found)}")
        return record

    def goes_on(self) -> bool:
        """Return whether another row follows."""
        found = next(self.rows, None)
        self.rows = self.rows if found is None else chain([found], self.rows)
        return found is not None

    def refused(self, problem: str) -> BadInputError:
        """Return the error for the row that was read last."""
        return BadInputError(f"Contact table {self.path}, row {self.row}: {problem}. {MAKE_AGAIN}.")

    def next_row(self, wanted: str) -> list[str]:
        """Return the cells of the next row."""
        found = next(self.rows, None)
        self.row = found[0] if found else self.row + 1
        if found is None:
            raise self.refused(f"the row must be {wanted}; the file ends")
        return [cell.strip() for cell in found[1].split(",")]

    def cells(self, name: str, count: int) -> list[str]:
        """Return the cells after the name at the beginning of the next row."""
        found = self.next_row(f"'{name}'")
        if found[0] != name or len(found) != 1 + count:
            raise self.refused(f"the row must be '{name}' with {count} more cells; got {shown(','.join(found))}")
        return found[1:]

    def record(self, kind: RecordKind) -> Record:
        numbers = tuple(
            self.number(one.name, self.cells(one.name, 1)[0], one.minimum, one.maximum) for one in kind.numbers
        )
        tables = tuple(self.table(one) for one in kind.tables)
        self.check(Record(kind, numbers))
        lists = tuple(
            tuple(self.record(one.kind) for _ in range(self.count("list", one.name, one.least, one.most)))
            for one in kind.lists
        )
        return Record(kind, numbers, tables, lists)

    def check(self, found: Record) -> None:
        """Refuse a record whose numbers do not fit each other; the twin in C is pair.c."""
        if found.kind is PATCH:
            cosine, sine = found.number("cosine"), found.number("sine")
            if not abs(cosine**2 + sine**2 - 1) <= UNIT:
                raise self.refused(f"cosine and sine above must be those of one angle; got {cosine:g} and {sine:g}")
        if found.kind is SIDE:
            for word in ("wheel", "rail"):
                begins, ends = (found.number(f"{word}_{end}") for end in ("begins", "ends"))
                if not begins < ends:
                    raise self.refused(f"{word}_begins above must be below {word}_ends; got {begins:g} and {ends:g}")

    def number(self, name: str, cell: str, minimum: float, maximum: float) -> float:
        value = number_of(cell)
        if not minimum <= value <= maximum:
            raise self.refused(f"{name} must be a number from {minimum:g} to {maximum:g}; got {shown(cell)}")
        self.numbers.append(value)
        return value

    def count(self, word: str, name: str, least: int, most: int) -> int:
        own, number = self.cells(word, 2)
        if own != name:
            raise self.refused(f"the {word} must be {name}; got {shown(own)}")
        count = self.number(f"the length of {name}", number, least, most)
        if count != math.floor(count):
            raise self.refused(f"the length of {name} must be a whole number; got {shown(number)}")
        return int(count)

    def table(self, about: TableOfRecord) -> Pieces:
        breakpoints: list[float] = []
        rows: list[tuple[float, ...]] = []
        for left in range(self.count("table", about.name, 1, MOST_PIECES), -1, -1):
            cells = self.next_row(f"one of {about.name}")
            terms = 2 + about.degree if left else 1
            if len(cells) != terms:
                raise self.refused(f"a row of {about.name} must have {terms} numbers here; got {len(cells)}")
            place = self.number("a breakpoint", cells[0], about.minimum, about.maximum)
            if breakpoints and not place > breakpoints[-1]:
                raise self.refused(f"breakpoints of {about.name} must grow; got {cells[0]} after {breakpoints[-1]!r}")
            breakpoints.append(place)
            row = tuple(self.number("a coefficient", cell, -LARGEST_NUMBER, LARGEST_NUMBER) for cell in cells[1:])
            rows += [row] if left else []
        return tuple(breakpoints), tuple(rows)

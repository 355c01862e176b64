"""Check that the C reader inside FMUs and the Python reader accept the same files, with bit-identical numbers."""

from __future__ import annotations

import os
import random
import struct
import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from unicodedata import normalize

import numpy as np
import pytest

from fmu_src import compile as compiling
from fmu_src.codegen import RUNTIME
from fmu_src.table_file import table_file_source
from rbd_model.track.line import NAMES, read_line
from rbd_model.track.line_table import LARGEST_TURN, LINE
from readers.column_words import COLUMN_WORDS, plain
from readers.text import FileError
from readers.units import SPELLINGS, factor, twins_of
from tests.fmu_src.fmi.sanitized import SANITIZERS
from tests.readers.mutations import LINES, mutated

COUNT = 2000
READER = ("decimal.c", "text_rows.c", "table_pieces.c", "table_file.c")
#: Rows of a table, shape (rows, columns), or the message of a refusal.
Found = np.ndarray | str


@pytest.fixture(scope="module")
def folder() -> Iterator[Path]:
    """A folder in memory if the system has one: 2000 small files take seconds on some disks."""
    memory = Path("/dev/shm")
    with tempfile.TemporaryDirectory(dir=memory if os.access(memory, os.W_OK) else None) as made:
        yield Path(made)


@pytest.fixture(scope="module")
def host(folder: Path) -> Path:
    """The runtime's reader of lines as a program, with sanitizers if the compiler supports them."""
    (folder / "given.h").write_text(f"#include <math.h>\n{table_file_source(LINE, 0)}", encoding="utf-8")
    sources = [*(RUNTIME / name for name in READER), Path(__file__).with_name("table_host.c")]
    words = [*compiling.compiler(), *compiling.FLAGS, "-O1", f"-I{RUNTIME}", f"-I{folder}", *map(str, sources)]
    for more in (SANITIZERS, []):
        done = subprocess.run([*words, *more, "-o", str(folder / "host"), "-lm"], capture_output=True, text=True)
        if done.returncode == 0 and subprocess.run([str(folder / "host")], input=b"").returncode == 0:
            return folder / "host"
    pytest.fail(done.stderr)


def read_in_c(host: Path, paths: Sequence[Path], **environment: str) -> list[Found]:
    """Return the program's result for each file."""
    given = "".join(f"{path}\n" for path in paths).encode()
    done = subprocess.run([str(host)], input=given, capture_output=True, env=os.environ | environment)
    assert done.returncode == 0, done.stderr.decode()[-2000:]
    found: list[Found] = []
    at = 0
    for _ in paths:
        (rows,) = struct.unpack_from("i", done.stdout, at)
        size = 8 * rows * len(NAMES) if rows >= 0 else 4 + struct.unpack_from("i", done.stdout, at + 4)[0]
        data = done.stdout[at + 4 : at + 4 + size]
        found.append(np.frombuffer(data).reshape(rows, -1) if rows >= 0 else data[4:].decode(errors="replace"))
        at += 4 + size
    assert at == len(done.stdout)
    return found


def read_in_python(path: Path) -> Found:
    try:
        rows = read_line(path).rows
    except FileError as error:
        return str(error)
    return np.column_stack([rows.get(name, np.zeros(rows["distance"].size)) for name in NAMES])


def composed_not(word: str) -> str:
    """Return a word whose letters have their marks behind them."""
    return normalize("NFD", word)


def check_twins(host: Path, paths: Sequence[Path]) -> int:
    """Check that both readers give the same; return how many files were read."""
    taken = 0
    for path, found in zip(paths, read_in_c(host, paths), strict=True):
        wanted = read_in_python(path)
        refused = isinstance(wanted, str)
        assert isinstance(found, str) == refused, f"{path.read_bytes()!r}: {found!r}, {wanted!r}"
        if isinstance(found, np.ndarray) and isinstance(wanted, np.ndarray):
            assert found.tobytes() == wanted.tobytes(), f"{path.read_bytes()!r}: {found - wanted}"
            taken += 1
    return taken


@pytest.mark.study
def test_spoilt_lines_are_read_and_refused_alike(host: Path, folder: Path) -> None:
    paths = []
    for number, data in enumerate(mutated(LINES, COUNT, seed=147)):
        paths.append(folder / f"{number}.csv")
        paths[-1].write_bytes(data)
    assert COUNT / 10 < check_twins(host, paths) < COUNT


def numbers() -> Iterator[str]:
    """Yield numbers that are hard to round, and others, all within the limits of a friction factor, 0 to 10."""
    chance = random.Random(5)
    for _ in range(4000):
        yield repr(chance.uniform(0, 10) * 10 ** chance.randint(-30, 0))
        yield f"{chance.randrange(10 ** chance.randint(1, 25))}e-{chance.randint(25, 340)}"
    for _ in range(1000):  # halfway between two doubles, and as little above or below as digits can express
        value = chance.uniform(0.1, 9.9) * 2.0 ** -chance.randint(0, 90)
        above = np.nextafter(value, 10.0)
        digits = f"{int(value * 2**160) + int(above * 2**160):d}"  # over 2^161
        whole, rest = divmod(int(digits), 2**161)
        half = f"{whole}.{rest * 10**161 // 2**161:0161d}"
        yield from (half, half + "0" * 700 + "1", half[:-1] + "0" + "9" * 700, half[:19], half[:25])


def test_german_and_french_names_are_read_alike(host: Path, folder: Path) -> None:
    """As people write them: in capitals, composed or not, in Windows-1252, with two letters for an umlaut."""
    paths, wrong = list[Path](), 0
    for column in NAMES:
        for word in (word for words in COLUMN_WORDS[column] for word in words):
            right = {form(one) for one in (word, word.upper()) for form in (str, composed_not, plain)}
            for name in (*right, f"{word}x"):
                names = [name if one == column else one for one in dict.fromkeys((*NAMES[:4], column))]
                zeros = ";0" * (len(names) - 1)
                text = f"{';'.join(names)}\n0{zeros}\n1{zeros}\n"
                for encoding in ("utf-8", "cp1252") if name.isascii() or name in (word, word.upper()) else ("utf-8",):
                    paths.append(folder / f"words{len(paths)}.csv")
                    paths[-1].write_bytes(text.encode(encoding))
                    wrong += name not in right
    assert check_twins(host, paths) == len(paths) - wrong


@pytest.mark.study
def test_numbers_have_the_same_bits(host: Path, folder: Path) -> None:
    """The locale of the host has no effect: Python's float rounds correctly."""
    found = list(numbers())
    path = folder / "numbers.csv"
    rows = (f"{place},0,0,0,{number}\n" for place, number in enumerate(found))
    path.write_text("distance,curvature,cant,gradient,left_friction\n" + "".join(rows), encoding="utf-8")
    wanted = np.array([float(one) for one in found])
    for language in ("C", "de_DE.UTF-8"):
        [read] = read_in_c(host, [path], LC_ALL=language)
        assert isinstance(read, np.ndarray), read
        assert read[:, NAMES.index("left_friction")].tobytes() == wanted.tobytes()
    assert isinstance(read_in_python(path), np.ndarray)


@pytest.mark.study
def test_rows_are_added_where_a_line_turns_far_from_row_to_row(host: Path, folder: Path) -> None:
    """A clothoid of 400 m to 500 m by its end rows turns by 0.4 rad, an arc of 300 m by 1.1 rad, a loop by 6.28 rad."""
    head, paths = "distance,curvature,cant,gradient,left_friction\n", list[Path]()
    for rows in ("0,0,0,0,1\n400,0.002,0.1,0.01,0.3\n700,0.002,0.1,0,1\n", "0,0.02,0,0,1\n314.159,0.02,0,0,1\n"):
        paths.append(folder / f"far{len(paths)}.csv")
        paths[-1].write_text(head + rows, encoding="utf-8")
    assert check_twins(host, paths) == 2
    clothoid, loop = (read_line(path) for path in paths)
    at = np.array([0.0, 100.0, 250.0, 400.0, 550.0, 700.0])
    for name, wanted in (("curvature", [0.0, 0.002, 0.002]), ("cant", [0.0, 0.1, 0.1]), ("gradient", [0.0, 0.01, 0.0])):
        found = np.interp(at, clothoid.rows["distance"], clothoid.rows[name])
        assert found == pytest.approx(np.interp(at, [0, 400, 700], wanted), abs=1e-15)
    assert np.max(np.diff(loop.rows["distance"])) <= LARGEST_TURN * 50.0
    assert loop.rows["distance"].size == 27


def test_each_unit_converts_alike(host: Path, folder: Path) -> None:
    """Check all known units; both readers refuse those of another quantity."""
    paths = []
    for unit in (twin for units in SPELLINGS.values() for one in units for twin in twins_of(one)):
        for column, target in (("curvature", "1/m"), ("cant", "m"), ("gradient", "1")):
            both = factor(unit, target)
            heads = [
                f"{one} [{unit}]" if one == column else one for one in ("distance", "curvature", "cant", "gradient")
            ]
            size = 0.0123456789 if both is None else 0.0123456789 * both[1] / both[0]
            paths.append(folder / f"unit{len(paths)}.csv")
            values = (
                f"{place}," + ",".join(f"{size!r}" if column in one else "0" for one in heads[1:]) for place in (0, 1)
            )
            paths[-1].write_text(",".join(heads) + "\n" + "\n".join(values) + "\n", encoding="utf-8")
    known = sum(len(SPELLINGS[one]) for one in ("per length", "length", "ratio")) + 1  # micrometres with a Greek letter
    assert check_twins(host, paths) == known


#: A file, and parts of the message that both readers give.
SAID = {
    "distance,curvature,gradiant,cant\n0,0,0,0\n": ("row 1: the column 'gradiant' is unknown. Did you mean gradient?",),
    "distance,curvature,cant\n0,0,0\n1,0,0\n": ("row 1: the column gradient is missing", "Add it."),
    "distance,cant,Cant,gradient\n0,0,0,0\n": ("row 1: the column cant must be there once; it is there twice.",),
    "distance,curvature,cant [kPa],gradient\n0,0,0,0\n": ("row 1: the unit 'kPa' of cant is", "Use m, km, cm, mm"),
    "0,0,0,0\n1,0,0,0\n": ("row 1: the first row must have names; got '0'. Add them, as in distance",),
    "\n\ndistance;curvature;cant;gradient\n0;0;0;0\n\n;;;\n1;x;0;0\n": (
        "row 7, column curvature: the value must be a number; got 'x'. Write it as 0.015 or 1.5e-2.",
    ),
    "distance,curvature,cant,gradient\n0,0,0,0\n1,0,,0\n": (
        "row 3, column cant: the value must be a number; the cell is empty.",
    ),
    "distance,curvature,cant,gradient\n0,0,0,0\n1,0.03,0,0\n": (
        "row 3, column curvature: the value must be from -0.02 to 0.02 1/m; got '0.03' 1/m. Check value and unit.",
    ),
    "distance,curvature [1/km],cant,gradient\n0,0,0,0\n1,30,0,0\n": (
        "row 3, column curvature: the value must be from -0.02 to 0.02 1/m; got '30', in the file's unit,",
        " 1 of which is 0.001 1/m. Check value and unit.",
    ),
    "distance,curvature,cant,gradient\n0,0,0,0\n1,5,0,0,0\n": (
        "row 3: a row must have at most 4 values",
        "semicolons.",
    ),
    "distance;curvature;cant;gradient\n0;0;0;0\n1,5;0.01;0;0\n": (
        "row 3, column curvature: numbers must have one decimal",
    ),
    "distance,curvature,cant,gradient\n5,0,0,0\n\n4,0,0,0\n": (
        "row 4, column distance: values must grow by at least 0.001 m; got 4 m after 5 m. Sort the rows, or remove",
    ),
    "distance,curvature,cant,gradient\n0,0.01,0,0\n700,0.01,0,0\n": (
        "row 3",
        "the line turns by 7 rad over the 700 m",
    ),
    "distance,curvature,cant,gradient\n0,0,0,0\n": ("must have at least 2 rows of values; it has 1. Add rows.",),
    'distance,curvature,cant,gradient\n0,"0,0,0\n': ("row 2: quotes must close within the row. Remove the quotes.",),
    "distance,curvature,cant,gradient\n0,0,0,\0\n": ("row 2: the character 0 is not text.",),
    "distance,curvature,cant,gradient\n" + "0" * 20_001: ("row 2: a row must have at most 20000 characters",),
    "# nothing\n\n": ("must have a row of names and rows of values; it is empty. Give a table.",),
}


def test_both_say_the_same_with_row_and_column_of_the_spreadsheet(host: Path, folder: Path) -> None:
    paths = []
    for number, text in enumerate(SAID):
        paths.append(folder / f"said{number}.csv")
        paths[-1].write_text(text, encoding="utf-8")
    for path, parts, in_c in zip(paths, SAID.values(), read_in_c(host, paths), strict=True):
        for said in (in_c, read_in_python(path)):
            assert isinstance(said, str)
            assert str(path) in said
            for part in parts:
                assert part in said


def test_a_million_empty_rows_are_nothing(host: Path, folder: Path) -> None:
    path = folder / "empty.csv"
    path.write_text(
        "distance,curvature,cant,gradient\n0,0,0,0\n" + "\r\n,,,\n" * 500_000 + "9,0,0,0\n", encoding="utf-8"
    )
    assert check_twins(host, [path]) == 1

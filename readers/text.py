"""The text of a user's file: its encoding, its size, its rows.

`fmu_src/runtime/text_rows.c` is its twin in C.
"""

from __future__ import annotations

import codecs
import json
import re
import stat
from collections.abc import Iterator, Sequence
from pathlib import Path

#: Largest file that is read [bytes], unless a caller sets another limit.
LARGEST = 1_000_000_000
#: Longest row [characters].
LONGEST_ROW = 20_000
#: Marks at the beginning of a file, and the encodings they mean; without a mark it is UTF-8 or Windows-1252.
MARKS = ((codecs.BOM_UTF8, "utf-8"), (codecs.BOM_UTF16_LE, "utf-16-le"), (codecs.BOM_UTF16_BE, "utf-16-be"))
#: Blanks: space, tab, form feed and the two spaces that hold numbers together.
BLANK = " \t\f\u00a0\u202f"
#: Characters that text does not have; DOS ends files with \x1a.
ODD = re.compile(r"[\x00-\x08\x0b\x0e-\x19\x1b-\x1f]")
#: Longest value that a message quotes [characters].
QUOTED = 40
#: Characters that begin a remark. A semicolon does not: it separates columns.
REMARKS = ("#", "%", "!", "//")


class BadInputError(ValueError):
    """An input of the user that cannot be used; the text states the reason and the remedy."""


class FileError(ValueError):
    """A user's file that cannot be read; the message names file, place, value and remedy."""


class MissingFileError(FileError, FileNotFoundError):
    """A user's file that does not exist."""


def shown(value: object, longest: int = QUOTED) -> str:
    """Return a value for a message, as in files: unchanged if it is short and on one line, otherwise quoted."""
    of_json = value is None or isinstance(value, bool | list | dict)
    try:
        text = json.dumps(value, default=str) if of_json else str(value)
    except (TypeError, ValueError, RecursionError):  # keys of no text, circles, numbers of thousands of digits
        text = f"a {type(value).__name__}"
    return text if text.isprintable() and 0 < len(text) <= longest else quoted(text, longest)


def quoted(text: str, longest: int = QUOTED) -> str:
    """Return a text for a message, cut where it is long."""
    return repr(text) if len(text) <= longest else f"{text[:longest]!r}... ({len(text)} characters)"


def text_of(path: str | Path, largest: int = LARGEST, *, unmarked: bool = False) -> str:
    """Return the text of a file.

    Takes largest [bytes].
    """
    data = first_bytes(Path(path), None, largest)
    mark, encoding = next(((mark, name) for mark, name in MARKS if data.startswith(mark)), (b"", "utf-8"))
    if unmarked and not mark and len(data) > 1 and data[:2].count(0) == 1:
        encoding = "utf-16-le" if data[1] == 0 else "utf-16-be"
    try:
        text = _decoded(data[len(mark) :], encoding)
    except UnicodeDecodeError as error:
        raise FileError(f"{path} is not text in {encoding} ({error.reason}). Save it as text in UTF-8.") from None
    if odd := ODD.search(text):
        row = len(lines_of(text[: odd.start()]))
        raise FileError(f"{path}, row {row}: the character {ord(odd[0])} is not text. Save the file as text in UTF-8.")
    return text.removeprefix("\ufeff").rstrip("\x1a")


def first_bytes(path: Path, count: int | None, largest: int = LARGEST) -> bytes:
    """Return the first bytes of a file, or all of them. Raises FileError if it is none, or too large."""
    try:
        about = path.stat()
        regular, size = stat.S_ISREG(about.st_mode), about.st_size
        data = b""
        if regular and size <= largest:
            with path.open("rb") as file:
                data = file.read(count)
    except FileNotFoundError:
        raise MissingFileError(f"The file {path} does not exist. Check the path.") from None
    except (OSError, ValueError) as error:  # ValueError: a zero byte in the path
        raise FileError(f"{path} cannot be read ({getattr(error, 'strerror', error)}). Check the path.") from error
    if not regular:
        raise FileError(f"{path} must be a file; it is a folder, a pipe or a device. Give the path of a file.")
    if size > largest:
        raise FileError(f"{path} must have at most {largest} bytes; it has {size}. Split it, or leave out rows.")
    return data


def _decoded(data: bytes, encoding: str) -> str:
    """Return text in an encoding; each row that is not UTF-8 as spreadsheets on Windows write it."""
    try:
        return data.decode(encoding)
    except UnicodeDecodeError:
        if encoding != "utf-8":
            raise
    return "".join(_row_decoded(row) for row in re.split(rb"([\r\n])", data))


def _row_decoded(row: bytes) -> str:
    try:
        return row.decode("utf-8")
    except UnicodeDecodeError:
        return row.decode("cp1252", errors="replace")


def lines_of(text: str) -> list[str]:
    """Return all lines of a text, numbered as in an editor or a spreadsheet."""
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


def rows_of(text: str, source: str) -> Iterator[tuple[int, str]]:
    """Yield number and text of each row with content, numbered from 1 as in an editor or a spreadsheet.

    Empty rows and remarks are ignored.
    """
    return rows_in(lines_of(text), source)


def rows_in(lines: Sequence[str], source: str, behind: int = 0) -> Iterator[tuple[int, str]]:
    """Yield the same as `rows_of` for lines after the first `behind` lines."""
    for number in range(behind + 1, len(lines) + 1):
        row = lines[number - 1]
        if len(row) > LONGEST_ROW:
            raise FileError(
                f"{source}, row {number}: a row must have at most {LONGEST_ROW} characters; it has {len(row)}. "
                "Check that this is a table."
            )
        if (bare := row.lstrip(BLANK)) and not bare.startswith(REMARKS):
            yield number, row

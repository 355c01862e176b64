"""The text of a user's file: its encoding, its size, its rows."""

from __future__ import annotations

import codecs
import stat
from collections.abc import Iterator
from pathlib import Path

#: Largest file that is read [bytes], unless a caller sets another limit.
LARGEST = 1_000_000_000
#: Longest row [characters].
LONGEST_ROW = 20_000
#: What a file may begin with, and the encoding that this means; without a mark it is UTF-8 or Windows-1252.
MARKS = ((codecs.BOM_UTF8, "utf-8"), (codecs.BOM_UTF16_LE, "utf-16-le"), (codecs.BOM_UTF16_BE, "utf-16-be"))
#: Characters that begin a remark. A semicolon does not: it separates columns.
REMARKS = ("#", "%", "!", "//")


class FileError(ValueError):
    """A user's file that cannot be read as it is meant; the message names file, place, value and remedy."""


def text_of(path: str | Path, largest: int = LARGEST) -> str:
    """Return the text of a file.

    Parameters
    ----------
    path : str or Path
        A regular file.
    largest : int
        Largest size [bytes].

    Raises
    ------
    FileError
        If it is not a regular file, is too large, or is not text.
    """
    data = _bytes_of(Path(path), largest)
    mark, encoding = next(((mark, name) for mark, name in MARKS if data.startswith(mark)), (b"", ""))
    try:
        text = _decoded(data[len(mark) :], encoding)
    except UnicodeDecodeError as error:
        raise FileError(f"{path} is not text in {encoding} ({error.reason}). Save it as text in UTF-8.") from None
    odd = next((one for one in text if one < " " and one not in "\t\r\n\f\x1a"), "")
    if odd:
        row = text.count("\n", 0, text.index(odd)) + 1
        raise FileError(f"{path}, row {row}: the character {ord(odd)} is not text. Save the file as text in UTF-8.")
    return text.removeprefix("\ufeff").rstrip("\x1a")


def _bytes_of(path: Path, largest: int) -> bytes:
    try:
        about = path.stat()
        if not stat.S_ISREG(about.st_mode):
            raise FileError(f"{path} must be a file; it is a folder, a pipe or a device. Give the path of a file.")
        if about.st_size > largest:
            raise FileError(
                f"{path} must have at most {largest} bytes; it has {about.st_size}. Split it, or leave out rows."
            )
        return path.read_bytes()
    except FileNotFoundError:
        raise FileError(f"The file {path} does not exist. Check the path.") from None
    except (OSError, ValueError) as error:  # ValueError: a zero byte in the path
        raise FileError(f"{path} cannot be read ({getattr(error, 'strerror', error)}). Check the path.") from error


def _decoded(data: bytes, encoding: str) -> str:
    """Return text in its marked encoding; otherwise UTF-8, or what spreadsheets on Windows write."""
    if encoding:
        return data.decode(encoding)
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError:
        return data.decode("cp1252", errors="replace")


def rows_of(text: str, source: str) -> Iterator[tuple[int, str]]:
    """Yield number and text of each row that holds something, numbered from 1 as an editor or a spreadsheet does.

    Empty rows and remarks are passed over.

    Raises
    ------
    FileError
        If a row is longer than LONGEST_ROW.
    """
    for number, row in enumerate(text.replace("\r\n", "\n").replace("\r", "\n").split("\n"), 1):
        if len(row) > LONGEST_ROW:
            raise FileError(
                f"{source}, row {number}: a row must have at most {LONGEST_ROW} characters; it has {len(row)}. "
                "Check that this is a table."
            )
        if row.strip() and not row.lstrip().startswith(REMARKS):
            yield number, row

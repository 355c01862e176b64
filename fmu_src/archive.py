"""FMU archives: byte-identical for equal contents, and read within limits from any source."""

from __future__ import annotations

import io
import stat
import struct
import xml.etree.ElementTree as ET
import zipfile
import zlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import BinaryIO

from readers import text
from readers.storage import ANOTHER_TEMPORARY, StorageError, write_whole, writing

#: The earliest date a zip archive can hold.
FIXED_DATE = (1980, 1, 1, 0, 0, 0)
#: Largest size of an entry and of all together [bytes], most entries, and longest name.
LARGEST_ENTRY, LARGEST_TOTAL, MOST_ENTRIES, LONGEST_NAME = 1 << 30, 1 << 31, 20_000, 1000
#: Largest ratio of size to packed size of an entry above the size LARGE [bytes]; zeros pack 1000 to 1.
LARGE, LARGEST_RATIO = 1 << 26, 200
#: FMI 2.0.4, section 2.3, and FMI 3.0, section 2.5.1, allow these methods of compression.
METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
#: Errors that Python's reader raises for damaged archives.
FAULTS = (
    *(zipfile.BadZipFile, zlib.error, struct.error, EOFError),
    *(ValueError, KeyError, NotImplementedError, RuntimeError, OverflowError, MemoryError),
)
#: Of zlib: the highest, 9, takes 3.5 times as long and saves 1.4 % of the largest FMU.
COMPRESSION = 6
CHUNK = 1 << 20
#: Names of entries are longer than other values that messages show.
shown = partial(text.shown, longest=100)


class ArchiveError(ValueError):
    """An archive is damaged or unsafe; the message names the file and the reason."""


def write_archive(path: Path, contents: Mapping[str, bytes]) -> None:
    """Write the archive in one go: a failed build leaves the old file."""
    with writing(path):
        path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, archive_bytes(contents))


def archive_bytes(contents: Mapping[str, bytes]) -> bytes:
    """Return the archive itself."""
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED, compresslevel=COMPRESSION) as archive:
        for name in sorted(contents):
            entry = zipfile.ZipInfo(name, FIXED_DATE)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, contents[name])
    return made.getvalue()


@contextmanager
def opened(path: Path) -> Iterator[zipfile.ZipFile]:
    """Yield an archive whose entries were checked. Errors while it is read are reported too."""
    try:
        with zipfile.ZipFile(path) as archive:
            check_entries(archive.infolist())
            yield archive
    except ArchiveError as error:
        raise ArchiveError(f"{path} is not a valid FMU: {error}.") from error
    except FAULTS as error:
        raise ArchiveError(f"{path} is not a valid FMU: {error or 'it ends early'}.") from error
    except OSError as error:
        if isinstance(error, StorageError):
            raise
        raise ArchiveError(f"Cannot read {path}: {error.strerror or error}.") from error


def check_entries(entries: Sequence[zipfile.ZipInfo]) -> None:
    """Raise ArchiveError if entries are too many, too large, encrypted, links, or would have one place."""
    if len(entries) > MOST_ENTRIES:
        raise ArchiveError(f"it has {len(entries)} entries; at most {MOST_ENTRIES} are read")
    total = sum(entry.file_size for entry in entries)
    if total > LARGEST_TOTAL:
        raise ArchiveError(f"it unpacks to {total / 1e6:.0f} MB; at most {LARGEST_TOTAL / 1e6:.0f} MB are read")
    files: set[str] = set()
    folders: set[str] = set()
    for entry in entries:
        check_entry(entry)
        parts = parts_of(entry.filename)
        whole = "/".join(parts)
        if whole in files or (whole in folders and not entry.is_dir()):
            raise ArchiveError(f"it has {shown(entry.filename)} twice")
        folders.update("/".join(parts[:count]) for count in range(1, len(parts)))
        (folders if entry.is_dir() else files).add(whole)
    if both := files & folders:
        raise ArchiveError(f"{shown(min(both))} is a file and a folder")


def check_entry(entry: zipfile.ZipInfo) -> None:
    """Raise ArchiveError if an entry is too large, cannot be read, or has a name that leaves the folder."""
    name, size = shown(entry.filename), entry.file_size
    parts_of(entry.filename)
    if size > LARGEST_ENTRY:
        raise ArchiveError(f"{name} unpacks to {size / 1e6:.0f} MB; at most {LARGEST_ENTRY / 1e6:.0f} MB are read")
    if size > LARGE and size > LARGEST_RATIO * entry.compress_size:
        raise ArchiveError(f"{name} unpacks to more than {LARGEST_RATIO} times its packed size")
    if entry.flag_bits & 1:
        raise ArchiveError(f"{name} is encrypted")
    if entry.compress_type not in METHODS:
        raise ArchiveError(f"{name} is compressed with method {entry.compress_type}; FMI allows deflate")
    if stat.S_ISLNK(entry.external_attr >> 16):
        raise ArchiveError(f"{name} is a link")


def parts_of(name: str) -> list[str]:
    """Return the parts of an entry's name."""
    parts = [part for part in name.split("/") if part]
    control = any(ord(letter) < 32 for letter in name)
    if not parts or name.startswith("/") or any(part in (".", "..") for part in parts) or control:
        raise ArchiveError(f"{shown(name)} is not a valid name of an entry")
    if "\\" in name or ":" in name:
        raise ArchiveError(f"{shown(name)} has a backslash or a colon in its name")
    if len(name) > LONGEST_NAME or max(len(part.encode(errors="replace")) for part in parts) > 255:
        raise ArchiveError(f"{shown(name)} has a name that is too long")
    return parts


def read_entry(archive: zipfile.ZipFile, name: str, take: Callable[[bytes], object]) -> None:
    """Pass an entry's bytes to `take` in chunks."""
    found, claimed = 0, archive.getinfo(name).file_size
    with archive.open(name) as packed, suppress(EOFError):
        while chunk := packed.read(CHUNK):
            found += len(chunk)
            take(chunk)
    if found != claimed:
        raise ArchiveError(f"{shown(name)} ends at {found} of {claimed} bytes")


def files_in(
    archive: zipfile.ZipFile, wanted: Callable[[str], bool] = bool, largest: int = LARGEST_TOTAL
) -> dict[str, bytes]:
    """Return the wanted files of an archive by name.

    Takes largest [bytes].
    """
    asked = [one for one in archive.infolist() if not one.is_dir() and wanted(one.filename)]
    if sum(one.file_size for one in asked) > largest:
        names = ", ".join(shown(one.filename) for one in asked[:3])
        raise ArchiveError(f"{names} unpack to more than {largest / 1e6:.0f} MB")
    found: dict[str, bytes] = {}
    for one in asked:
        chunks: list[bytes] = []
        read_entry(archive, one.filename, chunks.append)
        found[one.filename] = b"".join(chunks)
    return found


def contents_of(path: Path) -> dict[str, bytes]:
    """Return all files of an archive by name. Raises ArchiveError."""
    with opened(path) as archive:
        return files_in(archive)


def unpack(archive: zipfile.ZipFile, folder: Path, wanted: Callable[[str], bool]) -> None:
    """Unpack the wanted entries into an empty folder."""
    for entry in archive.infolist():
        if not wanted(entry.filename):
            continue
        place = folder.joinpath(*parts_of(entry.filename))
        with writing(folder, ANOTHER_TEMPORARY):
            (place if entry.is_dir() else place.parent).mkdir(parents=True, exist_ok=True)
            if entry.is_dir():
                continue
            file = place.open("xb")
        with file:
            read_entry(archive, entry.filename, partial(_write, file, folder))


def _write(file: BinaryIO, folder: Path, chunk: bytes) -> None:
    with writing(folder, ANOTHER_TEMPORARY):
        file.write(chunk)
        file.flush()  # a full disk raises an error here


def xml_file(root: ET.Element) -> bytes:
    """Return the content of an XML file with this root."""
    ET.indent(root)
    return ('<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n").encode()

"""Files are written whole or not at all; a failure is reported with place, reason and remedy."""

from __future__ import annotations

import errno
import os
import secrets
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

#: Ending of the name of a file that is being written.
PARTIAL = ".partial"
#: Windows locks bytes, which nobody else can read then: this one is behind all that a locked file says.
LOCKED_BYTE = 2_000_000_000
#: Error numbers of a full disk, quota or limit.
FULL = {errno.ENOSPC, errno.EFBIG, getattr(errno, "EDQUOT", errno.ENOSPC)}
#: Default remedy if a place cannot be written.
ANOTHER_FOLDER = "choose another folder"
ANOTHER_TEMPORARY = "name another folder for temporary files in the environment, TMPDIR"


class StorageError(OSError):
    """A file cannot be written; the text names the place, the reason and the remedy. full: for want of space."""

    full = False


def is_full(error: BaseException | None) -> bool:
    """Return whether an error, or its cause, is that of a full disk."""
    while error is not None:
        if getattr(error, "full", False) or (isinstance(error, OSError) and error.errno in FULL):
            return True
        error = error.__cause__
    return False


def cannot_write(place: Path, error: OSError, remedy: str = ANOTHER_FOLDER) -> StorageError:
    """Return the error for a place that cannot be written. remedy: advice to choose another place."""
    if isinstance(error, StorageError) and isinstance(error.__cause__, OSError):
        error = error.__cause__
    advice = f"free space on its disk, or {remedy}" if is_full(error) else remedy
    told = StorageError(f"Cannot write {place}: {error.strerror or error}. {sentence(advice)}")
    told.full = is_full(error)
    return told


def sentence(words: str) -> str:
    """Return words with a capital and a full stop."""
    return f"{words[:1].upper()}{words[1:]}."


@contextmanager
def writing(place: Path, remedy: str = ANOTHER_FOLDER) -> Iterator[None]:
    """Convert an OSError to StorageError with the written place."""
    try:
        yield
    except StorageError:
        raise
    except OSError as error:
        raise cannot_write(place, error, remedy) from error


@contextmanager
def whole_file(path: Path, remedy: str = ANOTHER_FOLDER, *, synced: bool = True) -> Iterator[Path]:
    """Yield the place to write a file to, which then takes the place of `path`; if anything fails, `path` stays.

    A link stays one. A device is written to directly. synced: the file is on disk, not on its way to it, when this
    ends. Raises StorageError.
    """
    target = path.resolve()
    direct = target.exists() and not target.is_file()
    partial = target if direct else target.with_name(f".{secrets.token_hex(8)}{PARTIAL}")
    try:
        with writing(path, remedy):
            yield partial
            if synced and not direct:
                with partial.open("rb+") as file:
                    os.fsync(file.fileno())
            if not direct:
                partial.replace(target)
            if synced and not direct:
                sync_folder(target.parent)
    except BaseException:
        if not direct:
            with suppress(OSError):
                partial.unlink()
        raise


def write_whole(path: Path, data: bytes, remedy: str = ANOTHER_FOLDER, *, synced: bool = True) -> None:
    """Write a file as `whole_file` does. Raises StorageError."""
    with whole_file(path, remedy, synced=synced) as partial:
        partial.write_bytes(data)


def sync_folder(folder: Path) -> None:
    """Write the names in a folder to disk, if the system can; Windows does so itself.

    Raises OSError if the disk is full or broken. Some file systems refuse (EINVAL), some folders cannot be read.
    """
    if sys.platform == "win32":
        return
    try:
        place = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(place)
        finally:
            os.close(place)
    except OSError as error:
        if is_full(error) or error.errno == errno.EIO:
            raise


def remove_partial(folder: Path, age: float = 0.0) -> None:
    """Remove partial files of killed processes; age: least age of the last write [s]."""
    for partial in folder.glob(f".*{PARTIAL}"):
        with suppress(OSError):
            if time.time() - partial.lstat().st_mtime >= age:
                partial.unlink()


def hold(file: int, *, wait: bool) -> None:
    """Lock an open file until it is closed, or its process ends; Windows waits for ten seconds at most."""
    if sys.platform == "win32":
        place = os.lseek(file, 0, os.SEEK_CUR)
        os.lseek(file, LOCKED_BYTE, os.SEEK_SET)
        try:
            msvcrt.locking(file, msvcrt.LK_LOCK if wait else msvcrt.LK_NBLCK, 1)
        except PermissionError as error:
            raise BlockingIOError(error.errno, error.strerror) from None
        finally:
            os.lseek(file, place, os.SEEK_SET)
    else:
        fcntl.flock(file, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))

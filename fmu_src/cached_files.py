"""Files that stay on disk between runs, and are checked before they are used.

The checksum of a kept file is in a file next to it, NAME.sha256, as `sha256sum --check` reads it.
"""

from __future__ import annotations

import hashlib
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from readers.storage import ANOTHER_FOLDER, StorageError, hold, remove_partial, sentence, write_whole, writing

#: Ending of the names of checksums and of locks.
CHECKSUM, LOCK = ".sha256", ".lock"
#: Age from which a partial file is abandoned [s]: its process was killed.
STALE = 86400.0
#: Write permissions of others than the owner.
OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH
#: Files whose checksum this process has compared, each with its file status at that time.
_compared: dict[Path, tuple[int, ...]] = {}


def keep(data: bytes, path: Path, remedy: str = ANOTHER_FOLDER) -> None:
    """Write a file with its checksum. Raises StorageError."""
    with writing(path, remedy):
        path.parent.mkdir(parents=True, exist_ok=True)
        if path.is_symlink():
            path.unlink()  # the target of the link is not ours
        write_whole(path, data, remedy, synced=False)  # a checksum reveals a file cut by a power failure
        path.chmod(0o644)  # independent of the umask
        write_whole(checksum_file(path), checksum_line(path.name, data).encode(), remedy, synced=False)


def checksum_file(path: Path) -> Path:
    """Return the place of a file's checksum."""
    return path.with_name(path.name + CHECKSUM)


def checksum_line(name: str, data: bytes) -> str:
    """Return a line of `sha256sum` for a file of this name."""
    return f"{hashlib.sha256(data).hexdigest()}  {name}\n"


def whole(path: Path) -> bool:
    """Return whether a kept file is unchanged, a regular file, and can be written by its owner alone, who is us.

    The checksum is compared once per process, and again if the file has changed since.
    """
    try:
        about = path.lstat()
        state = (about.st_ino, about.st_mtime_ns, about.st_ctime_ns, about.st_size, about.st_mode, about.st_uid)
        if _compared.get(path) == state:
            return True
        good = (
            stat.S_ISREG(about.st_mode)
            and not of_others(about)
            and checksum_file(path).read_text(encoding="utf-8") == checksum_line(path.name, path.read_bytes())
        )
    except (OSError, ValueError):
        return False
    if good:
        _compared[path] = state
    return good


def of_others(about: os.stat_result) -> str:
    """Return the reason why a file or folder is not ours alone; empty if it is. Always empty on Windows."""
    if os.name != "posix":
        return ""
    if about.st_uid not in (os.geteuid(), 0):
        return f"it belongs to user {about.st_uid}, and this is user {os.geteuid()}"
    if about.st_mode & OTHERS_WRITE:
        return f"others can write to it (mode {stat.S_IMODE(about.st_mode):04o})"
    return ""


@contextmanager
def missing(path: Path, remedy: str = ANOTHER_FOLDER) -> Iterator[bool]:
    """Yield whether a kept file has to be made; one process at a time makes it.

    The system releases the lock of a process that ends, in any manner. A file system without locks blocks nobody.
    Raises StorageError.
    """
    if whole(path):
        yield False
        return
    lock = path.with_name(path.name + LOCK)
    with writing(lock, remedy):
        path.parent.mkdir(parents=True, exist_ok=True)
        file = _held(lock)
    try:
        remove_partial(path.parent, STALE)
        yield not whole(path)
    finally:
        with suppress(OSError):  # Windows removes no open file
            lock.unlink()
        os.close(file)


def _held(lock: Path) -> int:
    """Open and lock a file; the one before may remove it while others wait for it: they take a new one."""
    while True:
        file = os.open(lock, os.O_RDWR | os.O_CREAT, 0o600)
        try:
            with suppress(OSError):
                hold(file, wait=True)
            if os.name != "posix" or os.path.samestat(os.fstat(file), lock.stat()):
                return file
        except FileNotFoundError:
            pass
        except BaseException:
            os.close(file)
            raise
        os.close(file)


def kept_files(folder: Path) -> Iterator[Path]:
    """Yield the kept files in a folder and in those below, whole or not."""
    for one in sorted(folder.rglob(f"*{CHECKSUM}")):
        yield one.with_name(one.name.removesuffix(CHECKSUM))


def own_folder(folder: Path, remedy: str) -> Path:
    """Return a folder to which nobody else can write, created if missing. Raises StorageError."""
    with writing(folder, remedy):
        folder.parent.mkdir(parents=True, exist_ok=True)
        folder.mkdir(mode=0o700, exist_ok=True)
        wrong = of_others(folder.stat())
    if wrong:
        advice = f"run chmod -R go-w {folder}, or {remedy}" if "others" in wrong else remedy
        raise StorageError(f"{folder} must be yours alone; {wrong}. {sentence(advice)}")
    return folder

"""One writer a folder: a lock of the operating system, which ends with its process, also when that is killed."""

from __future__ import annotations

import json
import os
import platform
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from readers.documents import integer_in, read_document, text_in
from readers.storage import hold
from readers.text import BadInputError

#: The file that is locked; it says who holds it and stays behind.
LOCK = ".lock"


@contextmanager
def only_writer(folder: Path) -> Iterator[None]:
    """Make a folder, and hold it for one process until the end. Raises BadInputError while another one has it."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / LOCK
    with path.open("a+b") as file:
        try:
            hold(file.fileno(), wait=False)
        except BlockingIOError:
            raise BadInputError(
                f"{folder} must have one sweep at a time; got a second one while {_holder(path)}. Wait for its end, or "
                "give another --out."
            ) from None
        except OSError as error:
            print(f"{folder} cannot be locked ({error.strerror}); start no second sweep there.", file=sys.stderr)
        file.truncate(0)
        file.write(json.dumps(_about_us()).encode())
        file.flush()
        yield


def _about_us() -> dict[str, object]:
    since = time.strftime("%Y-%m-%d %H:%M:%S %z")
    return {"process": os.getpid(), "host": platform.node(), "since": since}


def _holder(path: Path) -> str:
    """Return the holder of a lock, as the end of a message."""
    try:
        about = read_document(path)
        process, host = integer_in(about, "process", "", 1), text_in(about, "host", "")
        return f"process {process} on {host} has held it since {text_in(about, 'since', '')}"
    except (OSError, ValueError):  # it has only just begun
        return "another process holds it"

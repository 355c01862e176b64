"""A line as a temporary file, which kernels read."""

from __future__ import annotations

from pathlib import Path

from rbd_model.track.line import Line
from readers.storage import ANOTHER_TEMPORARY, writing


def file_of(line: Line | None, folder: str) -> str | None:
    """Write a line into a temporary folder and return the path of its file. Raises StorageError."""
    if line is None:
        return None
    with writing(Path(folder), ANOTHER_TEMPORARY):
        return str(line.write(Path(folder) / "line.csv"))

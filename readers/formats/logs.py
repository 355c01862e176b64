"""Logs and tables in binary files: the reader and the writer of a format by the end of the file's name.

A format is a module with `opened`, a context manager of a path that yields its `RawColumn`s, and `write`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

from readers.extras import need
from readers.log_arrays import ArrayLog, damaged
from readers.log_text import TextLog
from readers.text import ODD, FileError, first_bytes


@dataclass(frozen=True)
class LogFormat:
    """A binary format: its name, the package that reads it, and the module here.

    begins: the first bytes of its files, one of these; an empty one allows any.
    """

    name: str
    package: str
    module: str
    begins: tuple[bytes, ...] = (b"",)

    def load(self) -> Any:
        """Return the module. Raises MissingExtraError."""
        need(self.package)
        return import_module(f"{__package__}.{self.module}")


HDF5_BEGINS = b"\x89HDF\r\n\x1a\n"
PARQUET = LogFormat("Parquet", "pyarrow", "parquet", (b"PAR1",))
MATLAB = LogFormat("a MATLAB file", "scipy", "matlab")
MDF = LogFormat("MDF", "asammdf", "mdf", (b"MDF ", b"UnFinMF "))  # the second: a logger did not close it
HDF5 = LogFormat("HDF5", "h5py", "hdf5", (HDF5_BEGINS,))
#: Version 7.3 is HDF5 after a block of MATLAB of this length [bytes].
MATLAB_7_3, MATLAB_BLOCK = LogFormat("a MATLAB file", "h5py", "hdf5"), 512
#: Formats by the end of a file's name.
FORMATS = {
    ".parquet": PARQUET,
    ".pq": PARQUET,
    ".mat": MATLAB,
    ".mf4": MDF,
    ".mdf": MDF,
    ".dat": MDF,
    ".h5": HDF5,
    ".hdf5": HDF5,
    ".hdf": HDF5,
}


def format_of(path: Path) -> LogFormat | None:
    """Return the binary format of a file by its name and its first bytes; None: it is text. Raises FileError."""
    found = FORMATS.get(path.suffix.lower())
    if found is None:
        return None
    begin = first_bytes(path, MATLAB_BLOCK + len(HDF5_BEGINS))
    if found is MATLAB and begin[MATLAB_BLOCK:] == HDF5_BEGINS:
        return MATLAB_7_3
    is_text = not ODD.search(begin.decode("latin-1"))
    if begin.startswith(found.begins) and not is_text:
        return found
    if path.suffix.lower() == ".dat":
        return None
    got = "it is text. Rename it, as .csv" if is_text else "it does not. Export it again"
    got = got if begin else "it is empty. Export it again"
    raise FileError(f"{path} must begin as {found.name} does, by the end of its name; {got}.")


@contextmanager
def opened_log(path: Path, by_position: Sequence[str] = ()) -> Iterator[TextLog | ArrayLog]:
    """Yield the log in a file: text, or binary by the end of its name. Raises FileError, MissingExtraError."""
    found = format_of(path)
    if found is None:
        yield TextLog(path, by_position)
        return
    opened = found.load().opened(path)
    try:
        columns = opened.__enter__()
    except FileError:
        raise
    except Exception as error:
        raise damaged(str(path), found.name, error) from error
    try:
        yield ArrayLog(str(path), found.name, columns)
    finally:
        opened.__exit__(None, None, None)

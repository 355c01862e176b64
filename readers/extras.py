"""Packages that come with an extra of this project: the message if one is missing, and the import at its first use."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cached_property
from importlib import import_module
from importlib.util import find_spec
from types import ModuleType
from typing import Any

from readers.text import BadInputError

#: Extra of each optional package, and the words of its message.
EXTRAS = {
    "asammdf": ("formats", "an MDF file needs asammdf"),
    "casadi": ("build", "equations that are not compiled need CasADi"),
    "distributed": ("sweep", "--scheduler needs Dask"),
    "fmpy": ("fmu", "FMUs need FMPy"),
    "gymnasium": ("gym", "environments need gymnasium"),
    "matplotlib": ("plots", "figures need Matplotlib"),
    "pandas": ("tables", "a data frame needs pandas"),
    "plotly": ("pages", "a page of results needs Plotly"),
    "h5py": ("formats", "an HDF5 file, and a .mat of MATLAB 7.3, need h5py"),
    "pyarrow": ("formats", "a .parquet needs pyarrow"),
    "pythonfmu": ("pythonfmu", "the kind python needs pythonfmu"),
    "xarray": ("tables", "a data set needs xarray"),
    "ziglang": ("compiler", "a computer without a C compiler needs zig"),
}


class MissingExtraError(ImportError, BadInputError):
    """A package of an extra that is not installed; the text names the extra."""


def install(extra: str) -> str:
    """Return the command that installs an extra."""
    return f"pip install 'bogie-braking[{extra}]'"


def missing(*packages: str) -> MissingExtraError:
    """Return the error of missing packages of EXTRAS, one message for all."""
    extras, words = zip(*(EXTRAS[package] for package in packages), strict=True)
    text = f"{', '.join(words)}: {install(','.join(dict.fromkeys(extras)))}."
    return MissingExtraError(text[0].upper() + text[1:], name=packages[0])


def has(package: str) -> bool:
    """Return whether a package is installed, without importing it."""
    return find_spec(package) is not None


def need(*packages: str) -> None:
    """Raise MissingExtraError before any work if packages of EXTRAS are not installed."""
    if absent := [package for package in packages if not has(package)]:
        raise missing(*absent)


@contextmanager
def named_extras() -> Iterator[None]:
    """Replace the error of an import of a missing package of EXTRAS by MissingExtraError."""
    try:
        yield
    except ModuleNotFoundError as error:
        package = (error.name or "").partition(".")[0]
        if package not in EXTRAS or isinstance(error, MissingExtraError):
            raise
        raise missing(package) from error


class OptionalModule:
    """A module of a package of EXTRAS, imported when the first of its names is read. Raises MissingExtraError.

    begin: called with the module once it is imported.
    """

    def __init__(self, name: str, begin: Callable[[ModuleType], None] | None = None) -> None:
        self._name, self._begin = name, begin

    @cached_property
    def module(self) -> Any:
        """The module itself."""
        with named_extras():
            module = import_module(self._name)
        if self._begin:
            self._begin(module)
        return module

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):  # looked for by pickle and others
            raise AttributeError(name)
        value = self.__dict__[name] = getattr(self.module, name)
        return value

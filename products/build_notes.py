"""Notes on products of the current sources: their files are found in the cache without writing the equations again."""

import hashlib
import inspect
from collections.abc import Callable, Sequence
from importlib.metadata import version
from pathlib import Path

from fmu_src import compile as compiling
from fmu_src.compile import cache, compiler, here, path_from
from products.module_files import digest_of
from products.prebuilt import SOURCES, sources_here
from products.registry import FMUS
from products.sources import ROOT
from readers.extras import has

Makers = Sequence[Callable[..., object]]


def remembered(
    name: str, what: str, makers: Makers, make: Callable[[], str], good: Callable[[str], bool] = bool
) -> str:
    """Return the text that `make` gave for an FMU of the registry with the same sources, compiler and packages.

    makers: functions that make it from the FMU's model; its sources are those of their modules and of the model's.
    `make` is called again if the text is no longer `good`, and each time for a model from other sources.
    """
    if not written_here(name):
        return make()
    one = FMUS[name]
    functions = [function for function in (one.model, one.vehicle) if function]
    modules = (function.__module__ for function in (*makers, *functions))
    said = " and ".join(function.__qualname__ for function in functions)
    return noted(f"{what} of {name}, {said}", make, good, digest_of(*modules))


def noted(what: str, make: Callable[[], str], good: Callable[[str], bool] = bool, sources: str = "") -> str:
    """Return the same for any functions of this project; sources: a digest of their sources, by default of all."""
    words = [
        sources or sources_here(),
        what,
        here(),
        *compiler(),
        *(version(name) for name in ("casadi", "fmpy") if has(name)),
    ]
    return compiling.noted(f"{hashlib.sha256(repr(words).encode()).hexdigest()[:24]}.made", make, good)


def noted_path(what: str, make: Callable[[], Path]) -> Path:
    """The file in the cache that `make` made, while it is there and whole."""
    return cache() / noted(what, lambda: place_of(make()), is_there)


def remembered_path(name: str, what: str, makers: Makers, make: Callable[[], Path]) -> Path:
    """The file in the cache that `make` made, while it is there and whole."""
    return cache() / remembered(name, what, makers, lambda: place_of(make()), is_there)


def place_of(path: Path) -> str:
    """Return the path of a file relative to the cache's folder: a copied or moved cache stays valid."""
    return path.relative_to(cache()).as_posix()


def is_there(text: str) -> bool:
    """Return whether a text is the path of a complete file of the cache."""
    return path_from(text) is not None


def written_here(name: str) -> bool:
    """Return whether the function of an FMU is in the watched sources."""
    function = FMUS[name].model
    if not inspect.isfunction(function):
        return False
    file = Path(inspect.getfile(function)).resolve()
    return any(file.is_relative_to(ROOT / place) for place in SOURCES)

"""What was made from the sources as they are: equations are not written again only to find their files in the cache."""

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

Makers = Sequence[Callable[..., object]]


def remembered(
    name: str, what: str, makers: Makers, make: Callable[[], str], good: Callable[[str], bool] = bool
) -> str:
    """The text that `make` gave for an FMU of the registry when the same sources, compiler and packages were here.

    makers: functions that make it of the FMU's model; sources are all that their modules and the model's are made
    from. It is asked again where that text is not `good` any more, and each time for a model that other sources write.
    """
    if not written_here(name):
        return make()
    one = FMUS[name]
    functions = [function for function in (one.model, one.vehicle) if function]
    modules = (function.__module__ for function in (*makers, *functions))
    said = " and ".join(function.__qualname__ for function in functions)
    return noted(f"{what} of {name}, {said}", make, good, digest_of(*modules))


def noted(what: str, make: Callable[[], str], good: Callable[[str], bool] = bool, sources: str = "") -> str:
    """The same for whatever functions of this project make; sources: a digest of them, by default of all."""
    words = [sources or sources_here(), what, here(), *compiler(), *map(version, ("casadi", "fmpy"))]
    return compiling.noted(f"{hashlib.sha256(repr(words).encode()).hexdigest()[:24]}.made", make, good)


def noted_path(what: str, make: Callable[[], Path]) -> Path:
    """The file in the cache that `make` made, while it is there and whole."""
    return cache() / noted(what, lambda: place_of(make()), is_there)


def remembered_path(name: str, what: str, makers: Makers, make: Callable[[], Path]) -> Path:
    """The file in the cache that `make` made, while it is there and whole."""
    return cache() / remembered(name, what, makers, lambda: place_of(make()), is_there)


def place_of(path: Path) -> str:
    """A file's place from the cache's folder on: a cache that is copied or moved serves its own files."""
    return path.relative_to(cache()).as_posix()


def is_there(text: str) -> bool:
    """Whether a text is the place of a file of the cache that is whole."""
    return path_from(text) is not None


def written_here(name: str) -> bool:
    """Whether the function behind an FMU is among the sources that are looked at."""
    function = FMUS[name].model
    if not inspect.isfunction(function):
        return False
    file = Path(inspect.getfile(function)).resolve()
    return any(file.is_relative_to(ROOT / place) for place in SOURCES)

"""What was made from the sources as they are: equations are not written again only to find their files in the cache."""

import hashlib
import inspect
import os
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path

from fmu_src.compile import cache, compiler
from products.prebuilt import SOURCES, sources_here
from products.registry import FMUS
from products.sources import ROOT


def remembered(name: str, what: str, make: Callable[[], str], good: Callable[[str], bool] = bool) -> str:
    """The text that `make` gave for an FMU of the registry when the same sources, compiler and packages were here.

    It is asked again where that text is not `good` any more, and each time for a model that other sources write.
    """
    return noted(f"{what} of {name}", make, good) if written_here(name) else make()


def noted(what: str, make: Callable[[], str], good: Callable[[str], bool] = bool) -> str:
    """The same for whatever functions of this project make."""
    words = [sources_here(), what, *compiler(), *map(version, ("casadi", "fmpy"))]
    note = cache() / f"{hashlib.sha256(repr(words).encode()).hexdigest()[:24]}.made"
    text = note.read_text(encoding="utf-8") if note.exists() else ""
    if not good(text):
        text = make()
        whole = note.with_suffix(f".{os.getpid()}")
        whole.write_text(text, encoding="utf-8")
        whole.replace(note)
    return text


def noted_path(what: str, make: Callable[[], Path]) -> Path:
    """The file that `make` made, while it is there."""
    return Path(noted(what, lambda: str(make()), is_there))


def remembered_path(name: str, what: str, make: Callable[[], Path]) -> Path:
    """The file that `make` made, while it is there."""
    return Path(remembered(name, what, lambda: str(make()), is_there))


def is_there(text: str) -> bool:
    """Whether a text is the path of a file."""
    return bool(text) and Path(text).exists()


def written_here(name: str) -> bool:
    """Whether the function behind an FMU is among the sources that are looked at."""
    function = FMUS[name].model
    if not inspect.isfunction(function):
        return False
    file = Path(inspect.getfile(function)).resolve()
    return any(file.is_relative_to(ROOT / place) for place in SOURCES)

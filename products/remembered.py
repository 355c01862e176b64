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
    if not written_here(name):
        return make()
    words = [sources_here(), what, name, *compiler(), *map(version, ("casadi", "fmpy"))]
    note = cache() / f"{hashlib.sha256(repr(words).encode()).hexdigest()[:24]}.made"
    text = note.read_text(encoding="utf-8") if note.exists() else ""
    if not good(text):
        text = make()
        whole = note.with_suffix(f".{os.getpid()}")
        whole.write_text(text, encoding="utf-8")
        whole.replace(note)
    return text


def remembered_path(name: str, what: str, make: Callable[[], Path]) -> Path:
    """The file that `make` made, while it is there."""
    return Path(remembered(name, what, lambda: str(make()), lambda text: bool(text) and Path(text).exists()))


def written_here(name: str) -> bool:
    """Whether the function behind an FMU is among the sources that are looked at."""
    function = FMUS[name].model
    if not inspect.isfunction(function):
        return False
    file = Path(inspect.getfile(function)).resolve()
    return any(file.is_relative_to(ROOT / place) for place in SOURCES)

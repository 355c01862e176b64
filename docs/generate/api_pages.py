"""The reference of the public face: a page for each row of the table in docs/public.md, and for what its names give."""

import inspect
import re
import sys
from collections.abc import Iterator
from types import ModuleType
from typing import Any

from pages import DOCS

import bogie_braking as bb
from products.sources import HOUSE

#: A row of the table of names: the names, and what they are.
ROW = re.compile(r"^\| (`\w+`(?:, `\w+`)*) \| (.+) \|$", re.MULTILINE)


def api_pages() -> dict[str, str]:
    """Pages by their names on the site, in the order of the table. The version has none: its row says all of it."""
    rows = ROW.findall((DOCS / "public.md").read_text(encoding="utf-8"))
    named = [(re.findall(r"\w+", names), what) for names, what in rows]
    return {f"api/{names[0]}.md": api_page(names, what) for names, what in named if names != ["__version__"]}


def api_page(names: list[str], what: str) -> str:
    """A row as a page: its sentence, each name with its doc string, and the classes that it gives."""
    sentence = what[0].upper() + what[1:].replace("](", "](../") + "."
    places = [place for name in names for place in places_of(name)]
    return "\n\n".join([f"# {', '.join(names)}", sentence, *(f"::: {place}" for place in places)]) + "\n"


def places_of(name: str) -> Iterator[str]:
    """Dotted names of a public name, or of what a module holds, and of the class of ours that a function gives."""
    found, place = getattr(bb, name), f"{bb.__name__}.{name}"
    if isinstance(found, ModuleType):
        yield from (f"{place}.{inner}" for inner in classes_in(found))
        return
    yield place
    given = class_given_by(found)
    public = [getattr(bb, other) for other in bb.__all__] + list(classes_in(bb.parts).values())
    if given and given not in public:
        yield f"{given.__module__}.{given.__name__}"


def classes_in(module: ModuleType) -> dict[str, type]:
    """What a module names."""
    return {name: found for name, found in vars(module).items() if inspect.isclass(found)}


def class_given_by(found: Any) -> type | None:
    """Class of ours that a function gives; None where it gives none, or is none."""
    if not inspect.isfunction(found):
        return None
    given = inspect.signature(found).return_annotation
    given = vars(sys.modules[found.__module__]).get(given) if isinstance(given, str) else given
    return given if inspect.isclass(given) and given.__module__.partition(".")[0] in HOUSE else None

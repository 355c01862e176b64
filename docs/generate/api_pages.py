"""Pages of the API: one for each row of the table in docs/public.md, with the classes that its functions return."""

import inspect
import re
import sys
from collections.abc import Iterator
from types import ModuleType
from typing import Any

from pages import DOCS

import bogie_braking as bb
from products.sources import HOUSE

#: A row of the table of names: the names, and their description.
ROW = re.compile(r"^\| (`\w+`(?:, `\w+`)*) \| (.+) \|$", re.MULTILINE)


def api_pages() -> dict[str, str]:
    """Return pages by their names on the site, in the order of the table. The version has no page: its row suffices."""
    rows = ROW.findall((DOCS / "public.md").read_text(encoding="utf-8"))
    named = [(re.findall(r"\w+", names), what) for names, what in rows]
    return {f"api/{names[0]}.md": api_page(names, what) for names, what in named if names != ["__version__"]}


def api_page(names: list[str], what: str) -> str:
    """Return a row as a page: its description, each name with its docstring, and the classes that functions return."""
    sentence = what[0].upper() + what[1:].replace("](", "](../") + "."
    places = [place for name in names for place in places_of(name)]
    return "\n\n".join([f"# {', '.join(names)}", sentence, *(f"::: {place}" for place in places)]) + "\n"


def places_of(name: str) -> Iterator[str]:
    """Yield the dotted names of a public name, or of a module's contents, and of our class that a function returns."""
    found, place = getattr(bb, name), f"{bb.__name__}.{name}"
    if isinstance(found, ModuleType):
        yield from (f"{place}.{inner}" for inner in members_of(found))
        return
    yield place
    given = class_given_by(found)
    public = [getattr(bb, other) for other in bb.__all__] + list(members_of(bb.parts).values())
    if given and given not in public:
        yield f"{given.__module__}.{given.__name__}"


def members_of(module: ModuleType) -> dict[str, Any]:
    """Return the classes and functions in a module by name."""
    kinds = inspect.isclass, inspect.isfunction
    return {name: found for name, found in vars(module).items() if any(is_kind(found) for is_kind in kinds)}


def class_given_by(found: Any) -> type | None:
    """Return our class that a function returns, or None."""
    if not inspect.isfunction(found):
        return None
    given = inspect.signature(found).return_annotation
    given = vars(sys.modules[found.__module__]).get(given) if isinstance(given, str) else given
    return given if inspect.isclass(given) and given.__module__.partition(".")[0] in HOUSE else None

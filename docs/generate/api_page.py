"""The page of the API: every public name with its docstring, in the order of the table in docs/public.md."""

import inspect
import re
import sys
from collections.abc import Iterator
from types import ModuleType
from typing import Any

from pages import DOCS

import bogie_braking as bb
from products.sources import HOUSE

#: A row of the table of names: the heading of a group, or names with their purpose.
ROW = re.compile(r"^\| (?:\*\*(.+)\*\*|((?:`\w+`(?:, )?)+)) \| (.*?) *\|$", re.MULTILINE)
HEAD = """# API

All public names by task, in the order of a user's work. `import bogie_braking as bb` gives them as `bb.run`, `bb.train`
and so on. The [guide](public.md) has an example of each task.
"""


def generated() -> str:
    """Return the page."""
    shown: set[str] = set()
    parts = [HEAD]
    for group, names, purpose in ROW.findall((DOCS / "public.md").read_text(encoding="utf-8")):
        parts += [f"## {group}"] if group else list(row(re.findall(r"\w+", names), purpose, shown))
    return "\n\n".join(parts) + "\n"


def row(names: list[str], purpose: str, shown: set[str]) -> Iterator[str]:
    """Yield a row of the table: its purpose, then each name with its docstring, unless it is `shown` already."""
    if names == ["__version__"]:  # a text without a docstring
        yield f"`bb.__version__`: {purpose}."
        return
    yield f"{purpose[0].upper()}{purpose[1:]}.".replace("](#", "](public.md#")
    for place, heading in [entry for name in names for entry in entries(name)]:
        if place not in shown:
            shown.add(place)
            alone = ", members: false" if isinstance(getattr(bb, place.rpartition(".")[2], None), ModuleType) else ""
            yield f"::: {place}\n    options: {{ heading: '{heading}'{alone} }}"


def entries(name: str) -> Iterator[tuple[str, str]]:
    """Yield dotted name and heading: of a public name, or of those in a public module, and of our class it returns."""
    found, place = getattr(bb, name), f"{bb.__name__}.{name}"
    if isinstance(found, ModuleType):
        yield place, f"bb.{name}, a module"
        yield from ((f"{place}.{inner}", f"bb.{name}.{inner}") for inner in public_in(found))
        return
    yield place, f"bb.{name}"
    given = class_given_by(found)
    public = [getattr(bb, other) for other in bb.__all__] + list(public_in(bb.parts).values())
    if given and given not in public:
        yield f"{given.__module__}.{given.__name__}", f"{given.__name__}, which bb.{name} returns"


def public_in(module: ModuleType) -> dict[str, Any]:
    """Return the classes and functions of a public module by name."""
    found = {name: getattr(module, name) for name in getattr(module, "__all__", vars(module))}
    return {name: held for name, held in found.items() if inspect.isclass(held) or inspect.isfunction(held)}


def class_given_by(found: Any) -> type | None:
    """Return our class that a function returns, or None."""
    if not inspect.isfunction(found):
        return None
    given = inspect.signature(found).return_annotation
    given = vars(sys.modules[found.__module__]).get(given) if isinstance(given, str) else given
    return given if inspect.isclass(given) and given.__module__.partition(".")[0] in HOUSE else None

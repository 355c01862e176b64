"""Suggestions for unknown names."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

from readers.renamed import present_name

#: The most names that a message lists.
MOST_NAMES = 12


def suggestion(name: str, known: Iterable[str], otherwise: str = "", likeness: float = 0.6) -> str:
    """Return the end of a message: the nearest name; if no name is near, `otherwise`, or the first names.

    likeness: from which a name is near, as `difflib` has it.
    """
    names = list(known)
    if new := present_name(str(name), names):
        return f"its name is {new} now."
    near = difflib.get_close_matches(str(name), names, 1, likeness)
    more = f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
    return f"did you mean {near[0]}?" if near else otherwise or f"there are {', '.join(names[:MOST_NAMES])}{more}."

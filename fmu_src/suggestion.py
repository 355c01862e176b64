"""What to say after a name that there is not."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

#: The most names that a sentence lists.
MOST_NAMES = 12


def suggestion(name: str, known: Iterable[str], otherwise: str = "") -> str:
    """The end of the sentence: the name that is nearest; where none is near `otherwise`, or the first names."""
    names = list(known)
    near = difflib.get_close_matches(str(name), names, 1)
    more = f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
    return f"did you mean {near[0]}?" if near else otherwise or f"there are {', '.join(names[:MOST_NAMES])}{more}."

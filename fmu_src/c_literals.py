"""Python's values as C writes them."""

from __future__ import annotations

import math
from collections.abc import Iterable


def c_number(value: float) -> str:
    """A number to its last digit."""
    if math.isnan(value):
        return "NAN"
    if math.isinf(value):
        return "INFINITY" if value > 0 else "-INFINITY"
    return repr(float(value))


def c_text(value: str) -> str:
    """A C string of plain letters; all others are written as the bytes of their UTF-8, and no two question marks are a
    trigraph.
    """
    plain = (chr(byte) if 32 <= byte < 127 and chr(byte) not in '"\\?' else f"\\{byte:03o}" for byte in value.encode())
    return f'"{"".join(plain)}"'


def c_array(kind: str, name: str, values: Iterable[str]) -> str:
    """A constant array at the scope of its file; nothing where it would have no entries."""
    entries = list(values)
    return f"static const {kind} {name}[] = {{{', '.join(entries)}}};" if entries else ""

"""Python's values as C writes them."""

from __future__ import annotations

import math
from collections.abc import Iterable


def c_number(value: float) -> str:
    """Return C of a number, with all digits."""
    if math.isnan(value):
        return "NAN"
    if math.isinf(value):
        return "INFINITY" if value > 0 else "-INFINITY"
    return repr(float(value))


def c_text(value: str) -> str:
    """Return a C string of plain letters; all others are written as the bytes of their UTF-8, without trigraphs."""
    plain = (chr(byte) if 32 <= byte < 127 and chr(byte) not in '"\\?' else f"\\{byte:03o}" for byte in value.encode())
    return f'"{"".join(plain)}"'


def c_array(kind: str, name: str, values: Iterable[str]) -> str:
    """Return a constant array at the scope of its file; empty if it would have no entries."""
    entries = list(values)
    return f"static const {kind} {name}[] = {{{', '.join(entries)}}};" if entries else ""

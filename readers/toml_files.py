"""TOML files that users bring: read within limits on size, depth and numbers."""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

from readers.tables import shown
from readers.text import FileError, lines_of, text_of

#: The reader of TOML that this Python has: its own from 3.11 on, before that a package.
_tomllib = import_module("tomllib" if sys.version_info >= (3, 11) else "tomli")

#: Largest file [bytes], deepest brackets, and the whole numbers that doubles hold all of.
LARGEST, DEEPEST, LARGEST_WHOLE = 4_000_000, 64, 2**53


def toml_of(path: str | Path) -> dict[str, Any]:
    """Return what a TOML file holds: finite numbers, brackets at most DEEPEST deep.

    Raises
    ------
    FileError
        If the file cannot be read, or is not TOML within the limits.
    """
    text = "\n".join(lines_of(text_of(path, LARGEST)))
    try:
        found: dict[str, Any] = _tomllib.loads(text)
    except _tomllib.TOMLDecodeError as error:
        raise FileError(f"{path} must be TOML; got a fault: {str(error).rstrip('.')}. Correct it.") from None
    except RecursionError:
        raise _too_deep(path) from None
    except ValueError:  # a whole number of thousands of digits, or a day that no month has
        raise FileError(f"{path} must have numbers and dates that can be; got another. Correct it.") from None
    _check(found, path)
    return found


def _check(found: Mapping[str, Any], path: str | Path) -> None:
    layer: list[Any] = list(found.values())
    for _ in range(DEEPEST):
        for one in layer:
            large = (
                abs(one) > LARGEST_WHOLE if isinstance(one, int) else isinstance(one, float) and not math.isfinite(one)
            )
            if large:
                raise FileError(
                    f"{path} must have finite numbers, and whole ones up to 2^53; got {shown(one)}. Correct it."
                )
        inside = [one.values() if isinstance(one, dict) else one for one in layer if isinstance(one, dict | list)]
        layer = [one for several in inside for one in several]
        if not layer:
            return
    raise _too_deep(path)


def _too_deep(path: str | Path) -> FileError:
    return FileError(f"{path} must nest brackets at most {DEEPEST} deep; it nests deeper. Take brackets out.")

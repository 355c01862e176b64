"""TOML files that users bring: read within limits on size, depth and numbers."""

from __future__ import annotations

import sys
from importlib import import_module
from pathlib import Path
from typing import Any

from readers.documents import check_tree, too_deep
from readers.text import FileError, lines_of, text_of

#: The reader of TOML that this Python has: its own from 3.11 on, before that a package.
_tomllib = import_module("tomllib" if sys.version_info >= (3, 11) else "tomli")

#: Largest file [bytes].
LARGEST = 4_000_000
#: Remedy for text that is not TOML.
REMEDY = "Put text, and numbers with a unit, in quotes; write numbers with a decimal point."


def toml_of(path: str | Path) -> dict[str, Any]:
    """Return the content of a TOML file: finite numbers, brackets not too deep."""
    text = "\n".join(lines_of(text_of(path, LARGEST)))
    try:
        found: dict[str, Any] = _tomllib.loads(text)
    except _tomllib.TOMLDecodeError as error:
        raise FileError(f"{path} must be TOML; got a fault: {str(error).rstrip('.')}. {REMEDY}") from None
    except RecursionError:
        raise too_deep(str(path)) from None
    except ValueError:  # an integer of thousands of digits, or a day that no month has
        raise FileError(f"{path} must have numbers and dates that can be; got another. Correct it.") from None
    check_tree(found, str(path))
    return found

"""JSON documents: read within limits, and checked value by value."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from numbers import Real
from pathlib import Path
from typing import Any

from readers.text import FileError, shown

#: Largest document, or line of a log [bytes]. The head of a sweep over a million values has 27 MB.
LARGEST = 64_000_000
#: Deepest nesting of brackets. Documents of this project have six levels.
DEEPEST = 64
#: Largest integer up to which doubles hold every integer.
LARGEST_INTEGER = 2**53


def read_document(path: Path, what: str = "") -> Any:
    """Return the content of a JSON file; `what` is its name in messages, by default its path."""
    what = what or str(path)
    if path.exists() and not path.is_file():  # reading a pipe would not end
        raise FileError(f"{what} must be a file; got a folder or a device.")
    with path.open("rb") as file:
        return document(file.read(LARGEST + 1), what)


def document(text: bytes, what: str) -> Any:
    """Return the content of a JSON text: finite numbers, each name once, brackets at most DEEPEST deep.

    Raises FileError. Its message begins with `what`.
    """
    if len(text) > LARGEST:
        raise FileError(f"{what} must have at most {LARGEST // 10**6} MB; got more.")
    try:
        found = json.loads(
            text.decode("utf-8-sig"),
            parse_int=_integer,
            parse_float=_double,
            parse_constant=_double,
            object_pairs_hook=_once,
        )
    except UnicodeDecodeError as error:
        raise FileError(f"{what} must be text in UTF-8; got the byte {text[error.start]:#04x}.") from None
    except json.JSONDecodeError as error:
        place = f"line {error.lineno}, column {error.colno}"
        raise FileError(f"{what} must be JSON; got a fault in {place} ({error.msg}).") from None
    except _LimitError as error:
        raise FileError(f"{what} must {error}") from None
    except RecursionError:
        raise too_deep(what) from None
    check_tree(found, what)
    return found


def mapping_in(found: Any, name: str, what: str) -> dict[str, Any]:
    """Return the object of a name in an object. Raises FileError."""
    value = member(found, name, what)
    if not isinstance(value, dict):
        raise FileError(f"{what}: {name} must be an object; got {shown(value)}.")
    return value


def list_in(found: Any, name: str, what: str) -> list[Any]:
    """Return the list of a name in an object. Raises FileError."""
    value = member(found, name, what)
    if not isinstance(value, list):
        raise FileError(f"{what}: {name} must be a list; got {shown(value)}.")
    return value


def text_in(found: Any, name: str, what: str) -> str:
    """Return the text of a name in an object. Raises FileError."""
    value = member(found, name, what)
    if not isinstance(value, str):
        raise FileError(f"{what}: {name} must be a text; got {shown(value)}.")
    return value


def number_in(found: Any, name: str, what: str, least: float = -math.inf, most: float = math.inf) -> float:
    """Return the number of a name in an object, within limits; `true` is not one. Raises FileError."""
    value = member(found, name, what)
    if not (is_number(value) and least <= value <= most):
        limits = "" if math.isinf(least) and math.isinf(most) else f" from {least:g} to {most:g}"
        raise FileError(f"{what}: {name} must be a number{limits}; got {shown(value)}.")
    return float(value)


def integer_in(found: Any, name: str, what: str, least: int, most: int = LARGEST_INTEGER) -> int:
    """Return the integer of a name in an object, within limits; `true` is not one. Raises FileError."""
    value = member(found, name, what)
    if not (isinstance(value, int) and is_number(value) and least <= value <= most):
        raise FileError(f"{what}: {name} must be an integer from {least} to {most}; got {shown(value)}.")
    return value


def member(found: Any, name: str, what: str) -> Any:
    """Return the value of a name in an object. Raises FileError."""
    if not isinstance(found, dict):
        raise FileError(f"{what} must be an object; got {shown(found)}.")
    if name not in found:
        raise FileError(f"{what} must have {name}; got {shown(', '.join(found)) if found else 'nothing'}.")
    return found[name]


def is_number(value: Any) -> bool:
    """Return whether a value is a finite number that a double holds, of NumPy's kinds too; `true` is not one."""
    try:
        return isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value)
    except OverflowError:
        return False


# -- writing ---------------------------------------------------------------------------------------------------------


def document_text(value: Any) -> str:
    """Return the text of a document. Raises ValueError for numbers that are not finite."""
    return json.dumps(value, indent=2, allow_nan=False) + "\n"


def finite(value: Any) -> Any:
    """Return a document with null in the place of numbers that are not finite."""
    if isinstance(value, Mapping):
        return {name: finite(one) for name, one in value.items()}
    if isinstance(value, list | tuple):
        return [finite(one) for one in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


# -- limits ----------------------------------------------------------------------------------------------------------


class _LimitError(ValueError):
    """A value beyond a limit; the text is the end of a message."""


def _integer(text: str) -> int:
    if len(text) > 17 or abs(int(text)) > LARGEST_INTEGER:
        raise _LimitError(f"have integers up to 2^53; got {shown(text)}, of {len(text)} digits.")
    return int(text)


def _double(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise _LimitError(f"have finite numbers; got {shown(text)}.")
    return value


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, value in pairs:
        if name in found:
            raise _LimitError(f"name each value once; got {shown(name)} again.")
        found[name] = value
    return found


def check_tree(found: Any, what: str) -> None:
    """Check the values of a document: brackets at most DEEPEST deep, finite numbers, text that a file can hold.

    Raises FileError. Its message begins with `what`.
    """
    layer, depth = [found], 0
    while layer:
        inside: list[Any] = []
        for one in layer:
            if isinstance(one, dict):
                inside += [*one, *one.values()]
            elif isinstance(one, list):
                inside += one
            elif isinstance(one, str) and not one.isascii():
                _check_text(one, what)
            elif isinstance(one, int | float) and not -LARGEST_INTEGER <= one <= LARGEST_INTEGER:
                _check_number(one, what)
        depth += any(isinstance(one, dict | list) for one in layer)
        if depth > DEEPEST:
            raise too_deep(what)
        layer = inside


def _check_number(number: float, what: str) -> None:
    if isinstance(number, int):
        raise FileError(f"{what} must have integers up to 2^53; got {shown(number)}.")
    if not math.isfinite(number):
        raise FileError(f"{what} must have finite numbers; got {shown(number)}.")


def _check_text(text: str, what: str) -> None:
    try:
        text.encode()
    except UnicodeEncodeError as error:
        half = f"\\u{ord(text[error.start]):04x}"
        raise FileError(f"{what} must hold Unicode text; got {half}, half of a letter.") from None


def too_deep(what: str) -> FileError:
    """Return the error for brackets that are too deep."""
    return FileError(f"{what} must nest brackets at most {DEEPEST} deep; got more.")

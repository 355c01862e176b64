"""XML files that users bring: read without entities, within limits on size, depth and number of elements.

A document type is refused before anything of it is expanded. Text that grows from entities (billion laughs) and files
that a document names (external entities) are therefore never read.
"""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path
from xml.parsers import expat

from readers.text import FileError, shown, text_of

NUMBER = re.compile(r"[+-]?(\d{1,30}(\.\d{0,30})?|\.\d{1,30})([eE][+-]?\d{1,3})?", re.ASCII)


def name_of(element: ET.Element) -> str:
    """Return an element for a message: its tag and, if it has one, its name or id."""
    own = element.get("name") or element.get("id")
    return f"{element.tag} {shown(own)}" if own else element.tag


def value_of(text: str, what: str, most: float) -> float:
    """Return the number in a text. Raises FileError if it is not one, or its size is above `most`."""
    tidy = text.strip()
    if not NUMBER.fullmatch(tidy) or not math.isfinite(float(tidy)) or not abs(float(tidy)) <= most:
        raise FileError(f"{what} must be a number up to {most:g}; got {shown(text)}. Correct it.")
    return float(tidy)


def attribute(element: ET.Element, name: str, source: str, most: float) -> float | None:
    """Return the number of an attribute, None if it is missing. Raises FileError."""
    text = element.get(name)
    if text is None or not text.strip():
        return None
    return value_of(text, f"{source}: {name} of {name_of(element)}", most)


def required(element: ET.Element, name: str, source: str, most: float) -> float:
    """Return the number of an attribute. Raises FileError if it is missing or not a number."""
    found = attribute(element, name, source, most)
    if found is None:
        raise FileError(f"{source}: {name_of(element)} must have {name}; it is missing. Add it.")
    return found


#: Largest file [bytes], most elements, deepest nesting.
LARGEST = 64_000_000
MOST_ELEMENTS = 2_000_000
DEEPEST = 64
#: Characters between parts of a name in the parser.
SEPARATOR = "}"


def _local(name: str) -> str:
    return name.rpartition(SEPARATOR)[2]


class _XmlLimitError(ValueError):
    """A document beyond a limit; the text is the end of a message."""


class _Builder:
    """Builds the tree of a document, within limits."""

    def __init__(self) -> None:
        self.tree = ET.TreeBuilder()
        self.depth = 0
        self.count = 0

    def start(self, name: str, given: dict[str, str]) -> None:
        """Add the start of an element. Raises _LimitError."""
        self.depth += 1
        self.count += 1
        if self.depth > DEEPEST:
            raise _XmlLimitError(f"nest elements at most {DEEPEST} deep; got more.")
        if self.count > MOST_ELEMENTS:
            raise _XmlLimitError(f"have at most {MOST_ELEMENTS} elements; got more. Leave out what is not needed.")
        self.tree.start(
            name.rpartition(SEPARATOR)[2], {key.rpartition(SEPARATOR)[2]: one for key, one in given.items()}
        )

    def end(self, name: str) -> None:
        """Add the end of an element."""
        self.depth -= 1
        self.tree.end(_local(name))

    def document_type(self, name: str, *_: object) -> None:
        """Refuse a document type. Raises _LimitError."""
        raise _XmlLimitError(f"have no document type; got <!DOCTYPE {shown(name)}. Take that line away.")


def xml_of(path: str | Path, largest: int = LARGEST) -> ET.Element:
    """Return the root of an XML file, with the names of elements and attributes without their namespaces.

    Takes largest [bytes].
    """
    return xml_in(text_of(path, largest), path)


def xml_in(text: str, path: str | Path) -> ET.Element:
    """Return the root of an XML text as `xml_of` does; path: its name in messages."""
    builder = _Builder()
    parser = expat.ParserCreate("utf-8", SEPARATOR)
    parser.buffer_text = True
    parser.StartElementHandler = builder.start
    parser.EndElementHandler = builder.end
    parser.CharacterDataHandler = builder.tree.data
    parser.StartDoctypeDeclHandler = builder.document_type
    try:
        parser.Parse(text.encode(), True)
    except expat.ExpatError as error:
        place = f"row {error.lineno}, column {error.offset + 1}"
        raise FileError(f"{path} must be XML; got a fault in {place} ({expat.ErrorString(error.code)}).") from None
    except UnicodeEncodeError:
        raise FileError(f"{path} must hold Unicode text; got half of a letter.") from None
    except _XmlLimitError as error:
        raise FileError(f"{path} must {error}") from None
    return builder.tree.close()


def child_text(element: ET.Element, name: str) -> str:
    """Return the text of the first child of a name, "" if it is missing."""
    return (element.findtext(name) or "").strip()


def inside(element: ET.Element, *names: str) -> Iterator[ET.Element]:
    """Yield the elements of the given names inside an element, at any depth, in their order."""
    return (one for one in element.iter() if one.tag in names and one is not element)

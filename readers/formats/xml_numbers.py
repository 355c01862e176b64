"""Numbers in attributes and texts of XML elements."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET

from readers.text import FileError, shown

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

"""Unique names for given C, so that one unit may contain it together with the runtime and other files."""

from __future__ import annotations

import re
from collections.abc import Sequence

#: In front of every name that given C has at the scope of its file. The runtime has none that begins so.
PREFIX = "in_c_"


def with_own_names(sources: Sequence[str], prefix: str = PREFIX) -> list[str]:
    """Return the sources with `prefix` before each name that one of them has at file scope.

    Two files of one unit may have the same static name only if they are compiled separately; FMI 2.0 requires one file.
    """
    names = set().union(*(names_at_file_scope(source) for source in sources)) if sources else set()
    if not names:
        return list(sources)
    known = re.compile(rf"\b({'|'.join(sorted(names))})\b")
    return [known.sub(rf"{prefix}\1", source) for source in sources]


def names_at_file_scope(source: str) -> set[str]:
    """Return the functions, constants, types, tags, enumerators and macros of a C file.

    It may find more, such as an argument that is a pointer: a name that is changed in all places has the same meaning.
    """
    text = re.sub(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"', " ", source, flags=re.DOTALL)
    names = set(re.findall(r"^[ \t]*#[ \t]*define[ \t]+(\w+)", text, flags=re.MULTILINE))
    text = re.sub(r"^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", "", text, flags=re.MULTILINE)
    for body in re.findall(r"\benum\b[^{};]*\{([^{}]*)\}", text):
        names |= set(re.findall(r"(?:^|,)\s*([A-Za-z_]\w*)", body))
    text = _without_insides(text, r"\{[^{}]*\}", "@")
    names |= set(re.findall(r"\(\s*\*\s*([A-Za-z_]\w*)", text))  # pointers to functions
    text = _without_insides(text, r"\([^()]*\)", "~")
    names |= set(re.findall(r"\b([A-Za-z_]\w*)\s*~\s*[@;]", text))
    names |= set(re.findall(r"\b([A-Za-z_]\w*)\s*(?:\[[^\]]*\]\s*)*[=;]", text))
    return names | set(re.findall(r"\b(?:struct|union|enum)\s+([A-Za-z_]\w*)", text))


def _without_insides(text: str, pair: str, sign: str) -> str:
    """Return the text with a sign instead of each pair of brackets and its content, from the innermost outwards."""
    found = 1
    while found:
        text, found = re.subn(pair, sign, text)
    return text

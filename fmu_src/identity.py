"""GUIDs: a function of all that decides an answer, so that equal builds are equal and others differ.

The GUID of a binary follows from equations, description and runtime. An FMU with data of its own (start values, line,
contact table, train) has another one, which follows from these data and from its description too. Its resources then
hold `identity.csv`, from which the binary finds data that are missing or changed: runtime/identity.h.
"""

from __future__ import annotations

import hashlib
import re
import zlib
from collections.abc import Iterable, Mapping
from xml.sax.saxutils import escape

#: File with both tokens, and size and CRC-32 of the data.
FILE = "resources/identity.csv"
#: Attribute of modelDescription.xml: `guid` in FMI 2.0, `instantiationToken` in FMI 3.0.
TOKEN = re.compile(r'\b(?:guid|instantiationToken)="([^"]*)"')


def identifier(parts: Iterable[str | bytes]) -> str:
    """Return a GUID that changes with the parts, which are joined to one text, and with nothing else."""
    digest = hashlib.sha256()
    for part in parts:
        digest.update(part.encode() if isinstance(part, str) else part)
    h = digest.hexdigest()
    return f"{{{h[:8]}-{h[8:12]}-{h[12:16]}-{h[16:20]}-{h[20:32]}}}"


def token_in(description: str) -> str:
    """Return the GUID or token of a modelDescription.xml."""
    found = TOKEN.search(description)
    assert found
    return found[1]


def with_data(contents: Mapping[str, bytes], data: Mapping[str, bytes], title: str = "") -> dict[str, bytes]:
    """Return the files of a native FMU with data that decide its answers, and with a GUID of its own."""
    about = contents["modelDescription.xml"].decode()
    if title:
        shown = escape(title, {'"': "&quot;"})
        about = re.sub(r'(?<=\bmodelName=")[^"]*', lambda _: shown, about, count=1)
    old, binary, names = token_in(about), token_in(about), set(data)
    if FILE in contents:
        rows = [row.split(",") for row in contents[FILE].decode().splitlines()]
        binary = {row[0]: row[1] for row in rows}["binary"]
        names |= {row[0] for row in rows} - {"token", "binary"}
    files = dict(contents) | {f"resources/{name}": text for name, text in data.items()}
    own = {name: files[f"resources/{name}"] for name in sorted(names)}
    sums = [f"{name},{len(one)},{zlib.crc32(one):08x}" for name, one in own.items()]
    digests = [hashlib.sha256(one).digest() for one in own.values()]
    new = identifier([binary, about.replace(old, ""), *own, *digests])
    files[FILE] = "\n".join([f"token,{new}", f"binary,{binary}", *sums, ""]).encode()
    for place, text in files.items():
        if place == "modelDescription.xml" or place.startswith("documentation/host"):
            files[place] = (about.encode() if place == "modelDescription.xml" else text).replace(
                old.encode(), new.encode()
            )
    return files

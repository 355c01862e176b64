"""GUID of modelDescription.xml and of a binary: a function of the content, so that equal builds are equal."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable


def identifier(parts: Iterable[str | bytes]) -> str:
    """Return a GUID that changes with the parts, which are joined to one text, and with nothing else."""
    digest = hashlib.sha256()
    for part in parts:
        digest.update(part.encode() if isinstance(part, str) else part)
    h = digest.hexdigest()
    return f"{{{h[:8]}-{h[8:12]}-{h[12:16]}-{h[16:20]}-{h[20:32]}}}"

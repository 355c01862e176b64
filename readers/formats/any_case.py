"""Files by names that were written on Windows: separators of both kinds, letters of any case."""

from __future__ import annotations

from pathlib import Path

#: Most parts of a name.
MOST_PARTS = 32


def in_any_case(folder: Path, name: str) -> Path | None:
    """Return the file of a name in a folder, with letters of any case and slashes of both kinds, or None."""
    parts = name.replace("\\", "/").split("/")
    if len(parts) > MOST_PARTS or "\0" in name or not any(parts):
        return None
    place = folder
    for part in parts:
        if part in ("", "."):
            continue
        found = place / part if part == ".." or (place / part).exists() else _alike(place, part)
        if found is None:
            return None
        place = found
    return place if place.is_file() else None


def _alike(folder: Path, name: str) -> Path | None:
    """Return the entry of a folder whose name differs in the case of letters alone, or None."""
    try:
        return next((one for one in sorted(folder.iterdir()) if one.name.casefold() == name.casefold()), None)
    except OSError:
        return None

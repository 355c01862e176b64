"""Provenance in files: comment lines at the head of a CSV file, metadata of a Parquet file, an entry of a JSON file."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from itertools import takewhile
from pathlib import Path
from typing import Any

from readers.documents import document, read_document
from readers.extras import named_extras
from readers.text import FileError

#: Begin of its lines, their length without it, and key in metadata and JSON files.
BEGIN, LENGTH, KEY = "# provenance: ", 1000, "provenance"


def metadata_of(provenance: Mapping[str, Any], name: str) -> dict[str, str]:
    """Return the metadata of a table, by name; each line is a comment of a CSV. name: of its file."""
    if not provenance:
        return {}
    text = json_of(provenance)
    about = {KEY: "\n".join(text[at : at + LENGTH] for at in range(0, len(text), LENGTH))}
    if "function" not in provenance:  # a user's own
        return about
    made = f"{provenance['function']} of version {provenance['version']}"
    return {"bogie-braking": f"{made}; repeat it by bogie_braking.repeat({name!r})"} | about


def json_of(provenance: Mapping[str, Any]) -> str:
    """Return provenance as one line of ASCII."""
    return json.dumps(provenance, allow_nan=False)


def provenance_in(path: Path) -> dict[str, Any]:
    """Return the provenance in a .csv, .parquet or .json file; empty if it has none. Raises FileError."""
    if not path.is_file():
        raise FileError(f"The file {path} must exist; got none. Check the path.")
    if path.suffix not in (".csv", ".parquet", ".json"):
        raise FileError(f"{path} must be a .csv, .parquet or .json file for its provenance. Write one of these.")
    if path.suffix == ".json":
        summary = read_document(path)
        found = summary.get(KEY, {}) if isinstance(summary, dict) else {}
    else:
        text = _metadata(path) if path.suffix == ".parquet" else "".join(_head_of(path))
        found = document(text.encode(), f"The provenance in {path}") if text else {}
    if not isinstance(found, dict):
        raise FileError(f"The provenance in {path} must be an object; got a {type(found).__name__}.")
    return found


def _head_of(path: Path) -> Iterator[str]:
    with path.open(encoding="utf-8", errors="replace") as file:
        for line in takewhile(lambda line: line.startswith("#"), file):
            if line.startswith(BEGIN):
                yield line.removeprefix(BEGIN).rstrip("\r\n")


def _metadata(path: Path) -> str:
    with named_extras():
        import pyarrow.parquet

    return (pyarrow.parquet.read_schema(path).metadata or {}).get(KEY.encode(), b"").decode().replace("\n", "")

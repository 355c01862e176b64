"""FMU archives that are equal byte for byte when their contents are equal."""

from __future__ import annotations

import io
import os
import xml.etree.ElementTree as ET
import zipfile
from collections.abc import Mapping
from pathlib import Path

#: The earliest date a zip archive can hold.
FIXED_DATE = (1980, 1, 1, 0, 0, 0)


def write_archive(path: Path, contents: Mapping[str, bytes]) -> None:
    """Writes the archive in one go: a failed build leaves the old file, and two processes do not meet in one."""
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f"{path.name}.{os.getpid()}.partial")
    partial.write_bytes(archive_bytes(contents))
    partial.replace(path)


def archive_bytes(contents: Mapping[str, bytes]) -> bytes:
    """The archive itself."""
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name in sorted(contents):
            entry = zipfile.ZipInfo(name, FIXED_DATE)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, contents[name])
    return made.getvalue()


def xml_file(root: ET.Element) -> bytes:
    """What an XML file with this root holds."""
    ET.indent(root)
    return ('<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n").encode()

"""A native FMU with its own start values, for masters that set none: the same binary, files in its resources."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Mapping
from pathlib import Path

from fmu_src.archive import archive_bytes, contents_of, xml_file
from fmu_src.identity import with_data
from fmu_src.parameter_file import text_of

#: File of start values among the resources, rows NAME,VALUE, that the binary reads instead of its own, face.c.
FILE = "start_values.csv"
#: File that marks an archive whose binary reads FILE; that of pythonfmu does not.
NATIVE = "sources/start_values.c"


def with_start_values(
    fmu: Path, values: Mapping[str, float], data: Mapping[str, bytes] | None = None, title: str = ""
) -> bytes:
    """Return the archive of a native FMU that starts with these values, in its description too, with its own GUID."""
    contents = contents_of(fmu)
    if not (values or data or title) or NATIVE not in contents:
        return fmu.read_bytes()
    about = ET.fromstring(contents["modelDescription.xml"])
    variables = {str(element.get("name")): element for element in about.iterfind("ModelVariables/*")}
    rows = dict(row.split(",") for row in contents.get(f"resources/{FILE}", b"").decode().splitlines())
    for name, value in values.items():
        if name not in variables:
            raise ValueError(f"{fmu.name} has no variable {name}; its modelDescription.xml lists them.")
        # In FMI 2.0 the type is an element within the variable.
        typed = next(iter(variables[name]), variables[name])
        text = text_of(name, value, typed.tag in ("Real", "Float64"))
        typed.set("start", text)
        rows[name] = text
    described = contents | {"modelDescription.xml": xml_file(about)}
    table = "".join(f"{name},{text}\n" for name, text in rows.items()).encode()
    return archive_bytes(with_data(described, {FILE: table} | dict(data or {}), title))

"""A native FMU with its own start values, for masters that set none: the same binary, a file in its resources."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Mapping
from pathlib import Path

from fmu_src.archive import archive_bytes, contents_of, xml_file
from fmu_src.parameter_file import text_of

#: File of start values, rows NAME,VALUE, that the binary reads instead of its own, face.c.
FILE = "resources/start_values.csv"
#: File that marks an archive whose binary reads FILE; that of pythonfmu does not.
NATIVE = "sources/model.c"


def with_start_values(fmu: Path, values: Mapping[str, float]) -> bytes:
    """Return the archive of a native FMU of FMI 2.0 that starts with these values, in its description too.

    Parameters
    ----------
    fmu : Path
        The FMU. An archive that is not native is returned as it is.
    values : mapping of str to float
        Start values by name, in SI units.

    Raises
    ------
    ValueError
        If the FMU has no variable of a name, or an integer is not whole.
    """
    contents = contents_of(fmu)
    if not values or NATIVE not in contents:
        return fmu.read_bytes()
    about = ET.fromstring(contents["modelDescription.xml"])
    variables = {str(element.get("name")): element[0] for element in about.iter("ScalarVariable")}
    rows = []
    for name, value in values.items():
        if name not in variables:
            raise ValueError(f"{fmu.name} has no variable {name}; its modelDescription.xml lists them.")
        text = text_of(name, value, variables[name].tag == "Real")
        variables[name].set("start", text)
        rows.append(f"{name},{text}\n")
    return archive_bytes(contents | {"modelDescription.xml": xml_file(about), FILE: "".join(rows).encode()})

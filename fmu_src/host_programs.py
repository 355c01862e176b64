"""Programs in C, C++, C# and Python that run an FMU, in its archive: templates in hosts/, with its names filled in."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from fmu_src.system import Model

#: Templates with placeholders, such as @MODEL@. A line that begins with @2@ or @3@ is of that version of FMI alone.
HOSTS = Path(__file__).parent / "hosts"
#: Names in the archive and here, by version of FMI.
HOST_FILES = {
    2: {"host.c": "host.c", "host.cpp": "host2.cpp", "host.py": "host.py"},
    3: {"host.c": "host.c", "host.py": "host.py"},
}
#: Those in C#, which read names from modelDescription.xml: the same for every FMU of FMI 2.0.
CSHARP = {"host.cs": "host2.cs", "FmuBehaviour.cs": "FmuBehaviour.cs"}


@dataclass(frozen=True)
class HostVariable:
    """A number that a program sets or prints: value reference of its first element, and number of elements."""

    name: str
    causality: str
    reference: int
    whole: bool
    count: int = 1


def host_variables(model: Model) -> list[HostVariable]:
    """Return the numbers of a model; a Boolean or a string is none."""
    numbers = [(n, one) for n, one in enumerate(model.variables) if one.kind in ("real", "integer")]
    return [HostVariable(one.name, one.causality, n, one.kind == "integer") for n, one in numbers]


def hosts(model: str, guid: str, version: int, variables: Sequence[HostVariable], units: str) -> dict[str, bytes]:
    """Return the programs of an FMU by their places in the archive; version: of FMI; units: its C files."""
    places = {"MODEL": model, "GUID": guid, "N": str(version), "UNITS": units}
    for name, causalities in (("SETTABLE", ("parameter", "input")), ("OUTPUT", ("output",))):
        places[name] = in_rows(one for one in variables if one.causality in causalities and one.count)
    places["MOST"] = str(max((one.count for one in variables), default=1))
    found = {name: filled(template, version, places) for name, template in HOST_FILES[version].items()}
    if version == 2:
        found |= {name: (HOSTS / template).read_bytes() for name, template in CSHARP.items()}
    return {f"documentation/{name}": text for name, text in found.items()}


def in_rows(variables: Iterable[HostVariable]) -> str:
    """Return the rows of a table in C: name, reference, r or i for its type, number of elements."""
    entries = [f"{{\"{v.name}\",~{v.reference},~'{'ri'[v.whole]}',~{v.count}}}" for v in variables]
    lines = textwrap.fill(", ".join(entries), 118, initial_indent="    ", subsequent_indent="    ")
    return lines.replace("~", " ")


def filled(template: str, version: int, places: Mapping[str, str]) -> bytes:
    """Return a program from its template."""
    lines = (HOSTS / template).read_text(encoding="utf-8").splitlines(keepends=True)
    own = [line.removeprefix(f"@{version}@") for line in lines if not line.startswith(f"@{5 - version}@")]
    text = "".join(own)
    for place, value in places.items():
        text = text.replace(f"@{place}@", value)
    return text.encode()

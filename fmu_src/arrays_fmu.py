"""FMUs (FMI 2.0 and 3.0, co-simulation) around an object in C whose variables are arrays: runtime/arrays.h.

One binary works for arrays of all lengths; modelDescription.xml and the resources of the object contain the lengths. In
FMI 3.0 an array is a variable, in FMI 2.0 each of its elements is.
"""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from fmu_src.archive import write_archive, xml_file
from fmu_src.c_literals import c_array, c_number, c_text
from fmu_src.compile import plain_library
from fmu_src.host_programs import HostVariable, hosts
from fmu_src.identity import identifier, with_data
from fmu_src.model_description import (
    DISPLAY_UNITS,
    NOMINAL,
    TYPES,
    TYPES3,
    UNITS,
    add_experiment,
    description_root,
    number_text,
)
from fmu_src.native_fmu import binary_for
from fmu_src.objects import ARRAYS, FACES, OF_BOTH, OF_SLAVES, READERS, RUNTIME, START_VALUES, able
from fmu_src.pages import BESIDE, ENDS_OF_ARRAYS, page
from fmu_src.standard_headers import standard_headers
from fmu_src.start_values import FILE as START_FILE
from readers.usual import LEAST_PRESSURE

#: Elements of an array at most; the value reference in FMI 2.0 is array * ELEMENTS + element.
ELEMENTS = 65536


@dataclass(frozen=True)
class ArrayVariable:
    """An array: its causality, unit, meaning and limits, and whether its numbers are integers or may be NaN (lost)."""

    name: str
    causality: str
    unit: str
    description: str
    minimum: float = -math.inf
    maximum: float = math.inf
    whole: bool = False
    may_be_lost: bool = False


@dataclass(frozen=True)
class ArraysInC:
    """An object in C that implements arrays.h: its C files by name, and its arrays in the order of their numbers.

    stride: between value references of FMI 2.0 from array to array. starts_alone: True if outputs at the start do not
    depend on inputs and parameters. foreign: those of the files that are a user's, which may have warnings. ships:
    whether a wheel may have the binary.
    """

    name: str
    description: str
    arrays: tuple[ArrayVariable, ...]
    sources: Mapping[str, str]
    stride: int = ELEMENTS
    starts_alone: bool = False
    foreign: Collection[str] = ()
    ships: bool = True


def token_of(given: ArraysInC) -> str:
    """Return the token that modelDescription.xml and the binary have in common."""
    texts = _with_headers(dict(given.sources) | _faces())
    return identifier([repr((given.name, given.description, given.arrays, sorted(texts.items())))])


def _faces() -> dict[str, str]:
    return {name: (RUNTIME / name).read_text(encoding="utf-8") for name in (ARRAYS, START_VALUES, *READERS, *FACES)}


def all_sources(given: ArraysInC) -> dict[str, str]:
    """Return C files by name: the object, both faces, the runtime's headers, and the table of arrays."""
    return _with_headers(dict(given.sources) | _faces() | {"arrays_about.c": _about(given)})


def _about(given: ArraysInC) -> str:
    rows = []
    for array in given.arrays:
        lost = 0.0 if array.may_be_lost else math.nan
        numbers = ", ".join(c_number(number) for number in (0.0, array.minimum, array.maximum, lost))
        kind, causality = "KIND_INTEGER" if array.whole else "KIND_REAL", f"CAUSALITY_{array.causality.upper()}"
        rows.append(f"{{{c_text(array.name)}, {c_text(array.unit)}, {kind}, {causality}, {numbers}}}")
    table = c_array("variable_description", "ARRAYS_ABOUT", rows).replace("static ", "", 1)
    texts = {"TOKEN": token_of(given), "NAME": given.name}
    return "\n".join(
        [
            *("#include <math.h>", '#include "arrays.h"', table),
            f"const unsigned ARRAYS = {len(given.arrays)}, ARRAYS_STRIDE = {given.stride};",
            f"const double ARRAYS_LEAST_PRESSURE = {c_number(LEAST_PRESSURE)};",
            *(f"const char ARRAYS_{name}[] = {c_text(text)};" for name, text in texts.items()),
            "",
        ]
    )


def binary_of_arrays(given: ArraysInC, targets: Sequence[str] = ()) -> bytes:
    """Return the binary for targets of zig, one file for two; none: for this platform. Raises CompilerError."""
    texts = all_sources(given)
    ours = {name: text for name, text in texts.items() if name not in given.foreign or name.endswith(".h")}
    theirs = {name: texts[name] for name in given.foreign}
    return binary_for(targets, lambda target: plain_library(ours, theirs, target))


@dataclass(frozen=True)
class ArraysFmu:
    """Content of an FMU: the object, lengths of its arrays, and start values of parameters and inputs in their order.

    data: files that the object reads, by their names in resources/. title: name of the model for people; empty: that of
    the object. extras: further files of the archive.
    """

    given: ArraysInC
    lengths: Sequence[int]
    starts: Sequence[Sequence[float]]
    step_size: float
    stop_time: float
    data: Mapping[str, bytes] = field(default_factory=dict)
    title: str = ""
    extras: Mapping[str, bytes] = field(default_factory=dict)


def with_starts(fmu: ArraysFmu, values: Mapping[str, float | Sequence[float]]) -> ArraysFmu:
    """Return the FMU that starts with these values of arrays by name, in its resources too. Raises KeyError."""
    places = {array.name: number for number, array in enumerate(fmu.given.arrays)}
    starts, rows = list(fmu.starts), list[str]()
    for name, value in values.items():
        place = places[name]
        numbers = [value] if isinstance(value, (int, float)) else list(value)
        starts[place] = numbers
        names = [name] if len(numbers) == 1 else [f"{name}[{number}]" for number in range(1, len(numbers) + 1)]
        texts = [number_text(number, not fmu.given.arrays[place].whole) for number in numbers]
        rows += [f"{element},{text}\n" for element, text in zip(names, texts, strict=True)]
    return replace(fmu, starts=starts, data={**fmu.data, START_FILE: "".join(rows).encode()})


def build_arrays_fmu(fmu: ArraysFmu, path: Path, version: int, binaries: Mapping[str, bytes]) -> None:
    """Write the FMU of an object with arrays; binaries: by their places in binaries/."""
    given = fmu.given
    about = (description2 if version == 2 else description3)(fmu)
    files = {"modelDescription.xml": about.encode()}
    files |= {f"binaries/{place}": data for place, data in binaries.items()}
    texts = sources_for(given, version)
    files |= {f"sources/{name}": text.encode() for name, text in texts.items()}
    files |= {f"sources/{name}": text for name, text in standard_headers(version).items()}
    if version == 3:
        files["sources/buildDescription.xml"] = build_description(given).encode()
    files |= hosts(given.name, token_of(given), version, _numbered(fmu, version), "?*.c")
    files["documentation/index.html"] = documentation(fmu, version).encode()
    files |= fmu.extras
    write_archive(path, with_data(files, fmu.data, fmu.title) if fmu.data else files)


def _numbered(fmu: ArraysFmu, version: int) -> list[HostVariable]:
    """Return the arrays with the value references of a version of FMI."""
    stride = {2: fmu.given.stride, 3: 1}[version]
    return [
        HostVariable(array.name, array.causality, number * stride, array.whole, fmu.lengths[number])
        for number, array in enumerate(fmu.given.arrays)
    ]


def documentation(fmu: ArraysFmu, version: int) -> str:
    """Return the page about the FMU: its description, and a row for each array."""
    given = fmu.given
    rows = [
        _cells(array, starts, {2: TYPES, 3: TYPES3}[version])
        for array, starts in zip(given.arrays, fmu.starts, strict=True)
        if len(starts)
    ]
    return page(given.name, given.description, ENDS_OF_ARRAYS[version] + BESIDE, rows)


def _cells(array: ArrayVariable, starts: Sequence[float], types: Mapping[str, str]) -> dict[str, str]:
    """Return the cells of an array by the heads of their columns; one start value stands for equal ones."""
    given, equal = array.causality != "output", len(set(starts)) == 1
    between, shown = _limits(array), starts[:1] if equal else starts
    return {
        "name": array.name,
        "elements": str(len(starts)),
        "type": types["integer" if array.whole else "real"],
        "causality": array.causality,
        "variability": _nature(array)["variability"],
        "unit": "" if array.whole else array.unit,
        "start": " ".join(f"{value:g}" for value in shown) if given else "",
        **{name: f"{float(between[name]):g}" if name in between else "" for name in ("min", "max")},
        "meaning": array.description,
    }


def sources_for(given: ArraysInC, version: int) -> dict[str, str]:
    """Return C files by name, without the face of the other version."""
    other = {2: ("fmi3.c",), 3: ("fmi2.c",)}[version]
    return {name: text for name, text in all_sources(given).items() if name not in other}


def _with_headers(texts: Mapping[str, str]) -> dict[str, str]:
    """Return C files by name with the headers of the runtime that they include, and that these include."""
    found, waiting = dict(texts), list(texts.values())
    while waiting:
        for name in re.findall(r'#include "(\w+\.h)"', waiting.pop()):
            if name not in found and (RUNTIME / name).exists():
                found[name] = (RUNTIME / name).read_text(encoding="utf-8")
                waiting.append(found[name])
    return found


def _listed(given: ArraysInC, version: int) -> list[str]:
    """Return the names of the sources that are compiled."""
    return [name for name in sources_for(given, version) if name.endswith(".c")]


def build_description(given: ArraysInC) -> str:
    """Return buildDescription.xml of FMI 3.0: how sources/ are compiled."""
    root = ET.Element("fmiBuildDescription", {"fmiVersion": "3.0"})
    configuration = ET.SubElement(root, "BuildConfiguration", {"modelIdentifier": given.name})
    files = ET.SubElement(configuration, "SourceFileSet", {"language": "C11"})
    for name in _listed(given, 3):
        ET.SubElement(files, "SourceFile", name=name)
    ET.SubElement(configuration, "Library", name="m")
    return xml_file(root).decode()


def _claims(given: ArraysInC, version: int) -> dict[str, str]:
    """Return the capability attributes that differ from the defaults of the standard."""
    own = {"modelIdentifier": given.name, "canHandleVariableCommunicationStepSize": "true"}
    return own | able(ARRAYS, OF_BOTH[version] | OF_SLAVES[version])


def _units(root: ET.Element, given: ArraysInC) -> None:
    found = ET.SubElement(root, "UnitDefinitions")
    for unit in sorted({array.unit for array in given.arrays} | {"s"}):
        element = ET.SubElement(found, "Unit", name=unit)
        ET.SubElement(element, "BaseUnit", {name: str(power) for name, power in UNITS[unit].items()})
        for shown, (of, factor) in DISPLAY_UNITS.items():
            if of == unit:
                ET.SubElement(element, "DisplayUnit", name=shown, factor=repr(factor))


def _limits(array_variable: ArrayVariable) -> dict[str, str]:
    pairs = (("min", array_variable.minimum), ("max", array_variable.maximum))
    return {name: number_text(limit, not array_variable.whole) for name, limit in pairs if math.isfinite(limit)}


def _nature(array_variable: ArrayVariable) -> dict[str, str]:
    found = {"causality": array_variable.causality}
    found["variability"] = (
        "fixed" if array_variable.causality == "parameter" else "discrete" if array_variable.whole else "continuous"
    )
    if array_variable.causality == "output":
        found["initial"] = "calculated"
    return found


def description2(fmu: ArraysFmu) -> str:
    """Return modelDescription.xml of FMI 2.0: a variable for each element."""
    given = fmu.given
    attributes = {"fmiVersion": "2.0", "guid": token_of(given), "modelName": given.name}
    root = description_root(attributes, given.description, "structured")
    slave = ET.SubElement(root, "CoSimulation", _claims(given, 2) | {"canNotUseMemoryManagementFunctions": "true"})
    files = ET.SubElement(slave, "SourceFiles")
    for name in _listed(given, 2):
        ET.SubElement(files, "File", name=name)
    _units(root, given)
    add_experiment(root, fmu.stop_time, fmu.step_size)
    variables, outputs = ET.SubElement(root, "ModelVariables"), []
    for number, array in enumerate(given.arrays):
        for element in range(fmu.lengths[number]):
            name = array.name if fmu.lengths[number] == 1 else f"{array.name}[{element + 1}]"
            attributes = {
                "name": name,
                "valueReference": str(number * given.stride + element),
                "description": array.description,
            }
            variable = ET.SubElement(variables, "ScalarVariable", attributes | _nature(array))
            kind = {} if array.whole else _unit(array)
            if array.causality != "output":
                kind["start"] = number_text(fmu.starts[number][element], not array.whole)
            ET.SubElement(variable, "Integer" if array.whole else "Real", kind | _limits(array))
            if array.causality == "output":
                outputs.append(str(len(variables)))
    structure = ET.SubElement(root, "ModelStructure")
    for place, known in _dependencies(given, ("Outputs", "InitialUnknowns")):
        element_of = ET.SubElement(structure, place)
        for index in outputs:
            ET.SubElement(element_of, "Unknown", {"index": index} | known)
    return xml_file(root).decode()


def _unit(array_variable: ArrayVariable) -> dict[str, str]:
    """Return the unit, and nominal value if its unit has one."""
    nominal = {"nominal": repr(NOMINAL[array_variable.unit])} if array_variable.unit in NOMINAL else {}
    return {"unit": array_variable.unit} | nominal


def _dependencies(given: ArraysInC, places: tuple[str, str]) -> Iterator[tuple[str, dict[str, str]]]:
    """Yield the dependencies of outputs: between steps (none, since they change only in steps) and at the start.

    Without a list they depend on all inputs and parameters.
    """
    none = {"dependencies": ""}
    yield places[0], none
    yield places[1], none if given.starts_alone else {}


def description3(fmu: ArraysFmu) -> str:
    """Return modelDescription.xml of FMI 3.0: a variable for each array."""
    given = fmu.given
    attributes = {"fmiVersion": "3.0", "instantiationToken": token_of(given), "modelName": given.name}
    root = description_root(attributes, given.description, "structured")
    ET.SubElement(root, "CoSimulation", _claims(given, 3))
    _units(root, given)
    add_experiment(root, fmu.stop_time, fmu.step_size)
    variables, outputs = ET.SubElement(root, "ModelVariables"), []
    for number, array in enumerate(given.arrays):
        length = fmu.lengths[number]
        if length == 0:
            continue
        attributes = {"name": array.name, "valueReference": str(number), "description": array.description} | _nature(
            array
        )
        if not array.whole:
            attributes |= _unit(array)
        if array.causality != "output":
            attributes["start"] = " ".join(number_text(value, not array.whole) for value in fmu.starts[number])
        variable = ET.SubElement(variables, "Int32" if array.whole else "Float64", attributes | _limits(array))
        if length > 1:
            ET.SubElement(variable, "Dimension", start=str(length))
        if array.causality == "output":
            outputs.append(str(number))
    time = {"name": "time", "valueReference": str(len(given.arrays)), "causality": "independent"}
    ET.SubElement(variables, "Float64", time | {"variability": "continuous", "unit": "s"})
    structure = ET.SubElement(root, "ModelStructure")
    for place, known in _dependencies(given, ("Output", "InitialUnknown")):
        for reference in outputs:
            ET.SubElement(structure, place, {"valueReference": reference} | known)
    return xml_file(root).decode()

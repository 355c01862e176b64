"""System Structure and Parameterization 1.0: FMUs, how they are connected, and their parameters, in one archive.

The archive is written so that FMPy, ecos and libcosim accept it, which is tested, and OMSimulator, which is not. The
system itself has no connectors. Only connected inputs are listed, since FMPy sets the others to zero. The parameters
are written three times: within the system structure, as a file, and as the start values of the FMUs in the archive.
FMPy reads neither of the first two by itself.
"""

from __future__ import annotations

import io
import xml.etree.ElementTree as ET
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from fmu_src import parameter_file
from fmu_src.archive import write_archive, xml_file
from fmu_src.c_literals import c_text
from fmu_src.host_programs import filled
from fmu_src.identity import token_in
from fmu_src.parameter_file import add_parameter
from fmu_src.start_values import with_start_values

NAMESPACES = parameter_file.NAMESPACES | {
    "xmlns:ssd": "http://ssp-standard.org/SSP1/SystemStructureDescription",
    "xmlns:oms": "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd",
}
PARAMETERS_FILE = "resources/{}.ssv"


@dataclass(frozen=True)
class Component:
    """An FMU in the system: its name there, the file, parameters and start values, and outputs to show besides.

    archived: name of its file in the archive; empty: that of `fmu`.
    """

    name: str
    fmu: Path
    parameters: Mapping[str, float]
    shown: Sequence[str] = ()
    archived: str = ""

    @property
    def file(self) -> str:
        """Name of its file in the archive."""
        return self.archived or self.fmu.name


@dataclass(frozen=True)
class Wire:
    """(component, output) -> (component, input)"""

    source: tuple[str, str]
    target: tuple[str, str]


def write_ssp(
    path: Path,
    name: str,
    components: Sequence[Component],
    connections: Sequence[Wire],
    experiment: tuple[float, float],
) -> None:
    """Write the archive.

    Takes experiment [s].
    """
    components = _with_own_files(components)
    fmus = {one.name: with_start_values(one.fmu, one.parameters) for one in components}
    contents = {f"resources/{one.file}": fmus[one.name] for one in components}
    contents["documentation/host.c"] = _host(name, components, connections, experiment[1], fmus)
    contents["SystemStructure.ssd"] = xml_file(_structure(name, components, connections, experiment))
    root = ET.Element("ssv:ParameterSet", {"version": "1.0", "name": name, "xmlns:ssv": NAMESPACES["xmlns:ssv"]})
    parameters = ET.SubElement(root, "ssv:Parameters")
    for component in components:
        _parameters(parameters, component, f"{component.name}.")
    contents[PARAMETERS_FILE.format(name)] = xml_file(root)
    write_archive(path, contents)


def _host(
    name: str, components: Sequence[Component], wires: Sequence[Wire], step: float, fmus: Mapping[str, bytes]
) -> bytes:
    """Return the program in C that runs the system; fmus: archives by component."""
    about = {one.name: _variables(one) for one in components}
    number = {one.name: place for place, one in enumerate(components)}

    def place(of: tuple[str, str]) -> str:
        return f"{{{number[of[0]]}, {about[of[0]][of[1]].valueReference}}}"

    def letter(of: tuple[str, str]) -> str:
        return f"'{about[of[0]][of[1]].type[0]}'"

    rows = [[one.name, _identifier(one), _token(fmus[one.name])] for one in components]
    outputs = [(one.name, output) for one in components for output in _outputs(one, wires)]
    connected = [f"{{{place(one.source)}, {place(one.target)}, {letter(one.source)}}}" for one in wires]
    tables = {
        "COMPONENTS": [f"{{{', '.join(map(c_text, row))}}}" for row in rows],
        "WIRES": [*connected, "{{0, 0}, {0, 0}, 0}"],
        "OUTPUTS": [f"{{{place(of)}, {letter(of)}, {c_text('.'.join(of))}}}" for of in outputs],
    }
    unpack = [f" *   python -m zipfile -e resources/{one.file} {one.name}" for one in components]
    places = {key: ",\n".join(f"    {entry}" for entry in entries) for key, entries in tables.items()}
    places |= {"SYSTEM": name, "STEP": repr(step), "FIRST": components[0].name, "UNPACK": "\n".join(unpack)}
    return filled("system2.c", 2, places)


def _token(fmu: bytes) -> str:
    """Return the GUID of an archive."""
    with zipfile.ZipFile(io.BytesIO(fmu)) as archive:
        return token_in(archive.read("modelDescription.xml").decode())


def _outputs(component: Component, wires: Sequence[Wire]) -> list[str]:
    """Return the outputs of a component that are connected or shown."""
    connected = [wire.source[1] for wire in wires if wire.source[0] == component.name]
    return list(dict.fromkeys([*connected, *component.shown]))


def _with_own_files(components: Sequence[Component]) -> list[Component]:
    """Return components whose files have names of their own: FMUs of one name in different folders differ."""
    names = [component.fmu.name for component in components]
    return [replace(one, archived=f"{one.name}.fmu") if names.count(one.fmu.name) > 1 else one for one in components]


def _structure(
    name: str,
    components: Sequence[Component],
    connections: Sequence[Wire],
    experiment: tuple[float, float],
) -> ET.Element:
    root = ET.Element("ssd:SystemStructureDescription", NAMESPACES | {"name": name, "version": "1.0"})
    system = ET.SubElement(root, "ssd:System", name=name)
    elements = ET.SubElement(system, "ssd:Elements")
    for component in components:
        _component(elements, name, component, connections)
    wires = ET.SubElement(system, "ssd:Connections") if connections else system
    for connection in connections:
        attributes = {"startElement": connection.source[0], "startConnector": connection.source[1]}
        attributes |= {"endElement": connection.target[0], "endConnector": connection.target[1]}
        ET.SubElement(wires, "ssd:Connection", attributes)
    stop, step = experiment
    annotations = ET.SubElement(system, "ssd:Annotations")
    annotation = ET.SubElement(annotations, "ssc:Annotation", type="org.openmodelica")
    information = ET.SubElement(ET.SubElement(annotation, "oms:Annotations"), "oms:SimulationInformation")
    ET.SubElement(information, "oms:FixedStepMaster", description="oms-ma", stepSize=repr(step))
    ET.SubElement(root, "ssd:DefaultExperiment", startTime="0.0", stopTime=repr(stop))
    return root


def _component(elements: ET.Element, system: str, component: Component, connections: Sequence[Wire]) -> None:
    element = ET.SubElement(
        elements,
        "ssd:Component",
        name=component.name,
        type="application/x-fmu-sharedlibrary",
        source=f"resources/{component.file}",
    )
    connectors = ET.SubElement(element, "ssd:Connectors")
    inputs = [c.target[1] for c in connections if c.target[0] == component.name]
    variables = _variables(component)
    for kind, names in (("input", inputs), ("output", _outputs(component, connections))):
        for variable in dict.fromkeys(names):
            connector = ET.SubElement(connectors, "ssd:Connector", name=variable, kind=kind)
            ET.SubElement(connector, f"ssc:{variables[variable].type}")
    binding = ET.SubElement(ET.SubElement(element, "ssd:ParameterBindings"), "ssd:ParameterBinding")
    values = ET.SubElement(binding, "ssd:ParameterValues")
    # ecos selects a set of parameters by name: all components share one.
    inline = ET.SubElement(values, "ssv:ParameterSet", version="1.0", name=system)
    _parameters(ET.SubElement(inline, "ssv:Parameters"), component)


def _variables(component: Component) -> dict[str, Any]:
    """Return the variables of a component's FMU by name, as FMPy has them. Raises MissingExtraError."""
    from fmu_src.cosimulation.opening import description_of  # with FMPy, an optional dependency

    return {variable.name: variable for variable in description_of(component.fmu).modelVariables}


def _identifier(component: Component) -> str:
    """Return the name of the library of a component's FMU."""
    from fmu_src.cosimulation.opening import description_of  # with FMPy, an optional dependency

    return str(description_of(component.fmu).coSimulation.modelIdentifier)


def _parameters(parent: ET.Element, component: Component, prefix: str = "") -> None:
    variables = _variables(component)
    for key, value in component.parameters.items():
        if key not in variables:
            raise ValueError(f"{component.fmu.name} has no variable {key}; its modelDescription.xml lists them.")
        add_parameter(parent, f"{prefix}{key}", value, variables[key].type == "Real")

"""System Structure and Parameterization 1.0: FMUs, how they are connected, and their parameters, in one archive.

The archive is written so that FMPy, ecos and libcosim accept it, which is tested, and OMSimulator, which is not. The
system itself has no connectors. Only connected inputs are listed, since FMPy sets the others to zero. The parameters
are written three times: within the system structure, as a file, and as the start values of the FMUs in the archive.
FMPy reads neither of the first two by itself.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from fmu_src import parameter_file
from fmu_src.archive import write_archive, xml_file
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
    contents = {f"resources/{one.file}": with_start_values(one.fmu, one.parameters) for one in components}
    contents["SystemStructure.ssd"] = xml_file(_structure(name, components, connections, experiment))
    root = ET.Element("ssv:ParameterSet", {"version": "1.0", "name": name, "xmlns:ssv": NAMESPACES["xmlns:ssv"]})
    parameters = ET.SubElement(root, "ssv:Parameters")
    for component in components:
        _parameters(parameters, component, f"{component.name}.")
    contents[PARAMETERS_FILE.format(name)] = xml_file(root)
    write_archive(path, contents)


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
    outputs = [*(c.source[1] for c in connections if c.source[0] == component.name), *component.shown]
    types = _types(component)
    for kind, names in (("input", inputs), ("output", outputs)):
        for variable in dict.fromkeys(names):
            connector = ET.SubElement(connectors, "ssd:Connector", name=variable, kind=kind)
            ET.SubElement(connector, f"ssc:{types[variable]}")
    binding = ET.SubElement(ET.SubElement(element, "ssd:ParameterBindings"), "ssd:ParameterBinding")
    values = ET.SubElement(binding, "ssd:ParameterValues")
    # ecos selects a set of parameters by name: all components share one.
    inline = ET.SubElement(values, "ssv:ParameterSet", version="1.0", name=system)
    _parameters(ET.SubElement(inline, "ssv:Parameters"), component)


def _types(component: Component) -> dict[str, str]:
    """Return the types of the variables of a component's FMU. Raises MissingExtraError."""
    from fmu_src.cosimulation.opening import description_of  # with FMPy, an optional dependency

    return {v.name: v.type for v in description_of(component.fmu).modelVariables}


def _parameters(parent: ET.Element, component: Component, prefix: str = "") -> None:
    types = _types(component)
    for key, value in component.parameters.items():
        if key not in types:
            raise ValueError(f"{component.fmu.name} has no variable {key}; its modelDescription.xml lists them.")
        add_parameter(parent, f"{prefix}{key}", value, types[key] == "Real")

"""Parameter sets as files of System Structure and Parameterization 1.0 (.ssv)."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable, Mapping

from fmu_src.archive import xml_file
from fmu_src.model_description import UNITS, number_text
from fmu_src.system import Variable

_NAMESPACE = "http://ssp-standard.org/SSP1/SystemStructure"
NAMESPACES = {"xmlns:ssc": f"{_NAMESPACE}Common", "xmlns:ssv": f"{_NAMESPACE}ParameterValues"}


def parameter_file(
    name: str, description: str, values: Mapping[str, float | str], variables: Iterable[Variable]
) -> bytes:
    """Return a set of values in SI units for an FMU.

    Takes values [SI].
    """
    known = {variable.name: variable for variable in variables}
    root = ET.Element("ssv:ParameterSet", {"version": "1.0", "name": name, "description": description} | NAMESPACES)
    parameters = ET.SubElement(root, "ssv:Parameters")
    for key, value in values.items():
        if key not in known:
            raise ValueError(f"The parameter set {name} has {key}, which is not a variable of the FMU.")
        real, text = known[key].kind == "real", known[key].kind == "string"
        if text != isinstance(value, str):
            raise ValueError(f"The parameter set {name} must have a {known[key].kind} for {key}; got {value!r}.")
        add_parameter(parameters, key, value, real, {"unit": known[key].unit} if real else {})
    used = {known[key].unit for key in values if known[key].kind == "real"}
    units = ET.SubElement(root, "ssv:Units")
    for unit, exponents in UNITS.items():
        if unit in used:
            powers = {base: str(exponent) for base, exponent in exponents.items()}
            ET.SubElement(ET.SubElement(units, "ssc:Unit", name=unit), "ssc:BaseUnit", powers)
    return xml_file(root)


def add_parameter(
    parent: ET.Element, name: str, value: float | str, real: bool, more: Mapping[str, str] | None = None
) -> None:
    """Add one parameter to a set; a number that is not real is an integer. Raises ValueError if it is not whole."""
    parameter = ET.SubElement(parent, "ssv:Parameter", name=name)
    if isinstance(value, str):
        ET.SubElement(parameter, "ssv:String", {"value": value})
        return
    ET.SubElement(
        parameter, "ssv:Real" if real else "ssv:Integer", {"value": text_of(name, value, real)} | dict(more or {})
    )


def text_of(name: str, value: float, real: bool) -> str:
    """Return a number as XML has it, real or an integer. Raises ValueError if an integer is not whole."""
    if not real and value != int(value):
        raise ValueError(f"{name} must be an integer; got {value!r}. Round it.")
    return number_text(value, real)

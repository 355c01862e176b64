"""Model -> modelDescription.xml of FMI 3.0, from the same table as that of FMI 2.0."""

from __future__ import annotations

import xml.etree.ElementTree as ET

from fmu_src import __version__
from fmu_src.dependencies import start_dependencies, step_dependencies
from fmu_src.exchange import derivatives, exchanged_states, first_reference, indicators, reset_at_events
from fmu_src.model_description import (
    NOMINAL,
    add_categories_and_experiment,
    add_units,
    limits,
    number_text,
    variability,
)
from fmu_src.objects import KERNEL, OF_BOTH, OF_SLAVES, able, order_of_rates
from fmu_src.system import Model, Variable
from fmu_src.variables import state_variable

TIME = Variable("time", "output", "s", "Simulation time")
TYPES = {"real": "Float64", "integer": "Int32", "boolean": "Boolean", "string": "String"}


def model_description3(model: Model, token: str) -> str:
    """Return the XML text; value references are those of FMI 2.0, and the time has the one after the table's last."""
    root = ET.Element(
        "fmiModelDescription",
        fmiVersion="3.0",
        modelName=model.name,
        instantiationToken=token,
        description=model.description,
        version=__version__,
        license="MIT",
        generationTool="bogie-braking",
        variableNamingConvention="flat",
    )
    both = {"modelIdentifier": model.name} | able(KERNEL, OF_BOTH[3])
    exchange = [*derivatives(model), *indicators(model)]
    if exchange:
        ET.SubElement(root, "ModelExchange", both | {"needsCompletedIntegratorStep": "true"})
    slave = {"canHandleVariableCommunicationStepSize": "true"} | able(KERNEL, OF_SLAVES[3])
    ET.SubElement(root, "CoSimulation", both | slave | {"maxOutputDerivativeOrder": order_of_rates(KERNEL)})
    add_units(root, (*model.variables, TIME, *exchange))
    add_categories_and_experiment(root, model)
    variables = ET.SubElement(root, "ModelVariables")
    for reference, variable in enumerate(model.variables):
        element = ET.SubElement(variables, TYPES[variable.kind], _attributes(reference, variable))
        if variable.kind == "string":
            ET.SubElement(element, "Start", value="")
    time = {"name": TIME.name, "valueReference": str(len(model.variables)), "description": TIME.description}
    kind = {"causality": "independent", "variability": "continuous", "unit": TIME.unit}
    ET.SubElement(variables, "Float64", time | kind)
    for reference, variable in enumerate(exchange, first_reference(model)):
        ET.SubElement(variables, "Float64", _attributes(reference, variable))
    _mark_states(variables, model)
    _structure(root, model)
    ET.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def _attributes(reference: int, variable: Variable) -> dict[str, str]:
    real = variable.kind == "real"
    found = {"name": variable.name, "valueReference": str(reference), "description": variable.description}
    found |= {"causality": variable.causality, "variability": variability(variable)}
    if variable.causality in ("output", "local"):
        found["initial"] = "calculated"
    if real:
        found["unit"] = variable.unit
        if variable.display_unit:
            found["displayUnit"] = variable.display_unit
        if variable.unit in NOMINAL:
            found["nominal"] = repr(NOMINAL[variable.unit])
    found |= limits(variable)
    if variable.causality not in ("output", "local") and variable.kind != "string":
        found["start"] = number_text(variable, variable.start)
    return found


def _mark_states(variables: ET.Element, model: Model) -> None:
    """Mark each derivative with its state, by value reference, and each state that an event may set to a new value."""
    for number, state in enumerate(exchanged_states(model), len(model.variables) + 1):
        reference = model.index(state_variable(state.name))
        variables[number].set("derivative", str(reference))
        if state.name in reset_at_events(model):
            variables[reference].set("reinit", "true")


def _structure(root: ET.Element, model: Model) -> None:
    in_step, at_start = step_dependencies(model), start_dependencies(model)
    outputs = [variable.name for variable in model.variables if variable.causality == "output"]
    states = [state_variable(state.name) for state in exchanged_states(model)]
    slopes = [variable.name for variable in derivatives(model)]
    exchange = [*derivatives(model), *indicators(model)]
    reference = {variable.name: number for number, variable in enumerate(exchange, first_reference(model))}
    reference |= {variable.name: number for number, variable in enumerate(model.variables)}
    structure = ET.SubElement(root, "ModelStructure")
    for kind, unknowns, dependencies in (
        ("Output", outputs, in_step),
        ("ContinuousStateDerivative", slopes, in_step),
        ("InitialUnknown", [*outputs, *states, *slopes], at_start),
    ):
        for unknown in unknowns:
            known = " ".join(str(number) for number in sorted(reference[one] for one in dependencies[unknown]))
            ET.SubElement(structure, kind, valueReference=str(reference[unknown]), dependencies=known)
    for indicator in indicators(model):
        ET.SubElement(structure, "EventIndicator", valueReference=str(reference[indicator.name]))

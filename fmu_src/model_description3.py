"""Model -> modelDescription.xml of FMI 3.0 co-simulation, from the same table as that of FMI 2.0."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET

from fmu_src import __version__
from fmu_src.dependencies import start_dependencies, step_dependencies
from fmu_src.model_description import (
    NOMINAL,
    add_categories_and_experiment,
    add_units,
    number_text,
)
from fmu_src.system import Model, Variable

TIME = Variable("time", "output", "s", "Simulation time")
TYPES = {"real": "Float64", "integer": "Int32", "boolean": "Boolean", "string": "String"}


def model_description3(model: Model, token: str) -> str:
    """The XML text; value references are those of FMI 2.0, the time has the one behind the last."""
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
    ET.SubElement(
        root,
        "CoSimulation",
        modelIdentifier=model.name,
        canGetAndSetFMUState="true",
        canSerializeFMUState="true",
        providesDirectionalDerivatives="true",
        canHandleVariableCommunicationStepSize="true",
        mightReturnEarlyFromDoStep="true",
        maxOutputDerivativeOrder="1",
    )
    add_units(root, (*model.variables, TIME))
    add_categories_and_experiment(root, model)
    variables = ET.SubElement(root, "ModelVariables")
    for reference, variable in enumerate(model.variables):
        element = ET.SubElement(variables, TYPES[variable.kind], _attributes(reference, variable))
        if variable.kind == "string":
            ET.SubElement(element, "Start", value="")
    time = {"name": TIME.name, "valueReference": str(len(model.variables)), "description": TIME.description}
    kind = {"causality": "independent", "variability": "continuous", "unit": TIME.unit}
    ET.SubElement(variables, "Float64", time | kind)
    _structure(root, model)
    ET.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def _attributes(reference: int, variable: Variable) -> dict[str, str]:
    real = variable.kind == "real"
    found = {"name": variable.name, "valueReference": str(reference), "description": variable.description}
    found["causality"] = variable.causality
    if variable.causality == "parameter":
        found["variability"] = "fixed"
    else:
        found["variability"] = "continuous" if real else "discrete"
    if variable.causality in ("output", "local"):
        found["initial"] = "calculated"
    if real:
        found["unit"] = variable.unit
        if variable.display_unit:
            found["displayUnit"] = variable.display_unit
        if variable.unit in NOMINAL:
            found["nominal"] = repr(NOMINAL[variable.unit])
    if variable.kind not in ("boolean", "string"):
        for name, limit in (("min", variable.minimum), ("max", variable.maximum)):
            if math.isfinite(limit):
                found[name] = number_text(variable, limit)
    if variable.causality not in ("output", "local") and variable.kind != "string":
        found["start"] = number_text(variable, variable.start)
    return found


def _structure(root: ET.Element, model: Model) -> None:
    structure = ET.SubElement(root, "ModelStructure")
    for kind, dependencies in (("Output", step_dependencies(model)), ("InitialUnknown", start_dependencies(model))):
        for variable in model.variables:
            if variable.causality == "output":
                known = sorted(model.index(source) for source in dependencies[variable.name])
                reference = str(model.index(variable.name))
                ET.SubElement(structure, kind, valueReference=reference, dependencies=" ".join(map(str, known)))

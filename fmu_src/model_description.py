"""Model -> modelDescription.xml of FMI 2.0: interfaces, variables, units, dependencies, initial unknowns."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Mapping, Sequence

from fmu_src import __version__
from fmu_src.dependencies import input_dependencies, start_dependencies, step_dependencies
from fmu_src.exchange import derivatives, exchanged_states, first_reference, indicators, rate_unit, reset_at_events
from fmu_src.objects import KERNEL, OF_BOTH, OF_SLAVES, PYTHON, able, members, order_of_rates
from fmu_src.system import Model, Variable
from fmu_src.variables import state_variable

#: Unit -> exponents of the SI base units.
UNITS: dict[str, dict[str, int]] = {
    "1": {},
    "s": {"s": 1},
    "m": {"m": 1},
    "rad": {"rad": 1},
    "kg": {"kg": 1},
    "K": {"K": 1},
    "m2": {"m": 2},
    "m3": {"m": 3},
    "s/m": {"m": -1, "s": 1},
    "kg/s": {"kg": 1, "s": -1},
    "1/m": {"m": -1},
    "1/s": {"s": -1},
    "m/s": {"m": 1, "s": -1},
    "m/s2": {"m": 1, "s": -2},
    "rad/s": {"rad": 1, "s": -1},
    "N": {"kg": 1, "m": 1, "s": -2},
    "N.m": {"kg": 1, "m": 2, "s": -2},
    "J": {"kg": 1, "m": 2, "s": -2},
    "J/m": {"kg": 1, "m": 1, "s": -2},
    "W": {"kg": 1, "m": 2, "s": -3},
    "Pa": {"kg": 1, "m": -1, "s": -2},
    "N/Pa": {"m": 2},
    "N.m/rad": {"kg": 1, "m": 2, "s": -2, "rad": -1},
    "N.m.s/rad": {"kg": 1, "m": 2, "s": -1, "rad": -1},
    "N/m": {"kg": 1, "s": -2},
    "N.s/m": {"kg": 1, "s": -1},
    "N.s2/m2": {"kg": 1, "m": -1},
    "kg.m2": {"kg": 1, "m": 2},
    "kg/m": {"kg": 1, "m": -1},
    "N.m/Pa": {"m": 3},
    "1/K": {"K": -1},
    "J/(kg.K)": {"m": 2, "s": -2, "K": -1},
    "W/K": {"kg": 1, "m": 2, "s": -3, "K": -1},
    "W.s/(K.m)": {"kg": 1, "m": 1, "s": -2, "K": -1},
}
#: Display unit -> (its unit, display value of one unit).
DISPLAY_UNITS: dict[str, tuple[str, float]] = {
    "km/h": ("m/s", 3.6),
    "kPa": ("Pa", 1e-3),
    "kN": ("N", 1e-3),
    "deg": ("rad", 180.0 / math.pi),
}
#: Typical sizes by unit, for hosts that scale their tolerances.
NOMINAL: dict[str, float] = {
    "m/s": 10.0,
    "rad/s": 10.0,
    "N": 1e4,
    "N.m": 1e3,
    "J": 1e6,
    "W": 1e5,
    "Pa": 1e5,
    "kg": 1e3,
    "N/m": 1e6,
    "N.s/m": 1e4,
    "kg.m2": 1e3,
}
TYPES = {"real": "Real", "integer": "Integer", "boolean": "Boolean", "string": "String"}
LOG_CATEGORIES = {
    "events": "What happened inside, as sentences with the time",
    "logStatusWarning": "Values that were replaced or have no effect",
    "logStatusDiscard": "The run ended: an end condition was reached",
    "logStatusError": "Refused values and failed steps",
}


def model_description(model: Model, guid: str, binary: str = KERNEL, source_files: Iterable[str] = ()) -> str:
    """Return the XML text. binary: the C file of the object, one of those in objects.py.

    source_files: C files in sources/ that a host may compile.
    """
    root = ET.Element(
        "fmiModelDescription",
        fmiVersion="2.0",
        modelName=model.name,
        guid=guid,
        description=model.description,
        version=__version__,
        license="MIT",
        generationTool="bogie-braking",
        variableNamingConvention="flat",
    )
    both = {
        "modelIdentifier": model.name,
        "needsExecutionTool": str(binary == PYTHON).lower(),
        "canNotUseMemoryManagementFunctions": "true",
        **able(binary, OF_BOTH[2], all_of_them=True),
    }
    exchange = derivatives(model) if "exchange" in members(binary) else []
    if exchange:
        root.set("numberOfEventIndicators", str(len(indicators(model))))
        ET.SubElement(root, "ModelExchange", both)
    slave = {"canHandleVariableCommunicationStepSize": "true", **able(binary, OF_SLAVES[2], all_of_them=True)}
    ET.SubElement(root, "CoSimulation", both | slave | {"maxOutputDerivativeOrder": order_of_rates(binary)})
    for interface in root if binary != PYTHON else []:
        files = ET.SubElement(interface, "SourceFiles")
        for name in source_files:
            ET.SubElement(files, "File", name=name)
    add_units(root, (*model.variables, *exchange))
    add_categories_and_experiment(root, model)
    variables = ET.SubElement(root, "ModelVariables")
    for reference, variable in enumerate(model.variables):
        _variable(variables, reference, variable)
    for reference, variable in enumerate(exchange, first_reference(model)):
        _variable(variables, reference, variable)
    if exchange:
        _mark_states(variables, model)
    _structure(root, model, exchange)
    ET.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def add_categories_and_experiment(root: ET.Element, model: Model) -> None:
    """Add log categories and default experiment; those of FMI 2.0 and 3.0 are the same."""
    categories = ET.SubElement(root, "LogCategories")
    for name, description in LOG_CATEGORIES.items():
        ET.SubElement(categories, "Category", name=name, description=description)
    experiment = {"startTime": "0.0", "stopTime": repr(model.stop_time), "stepSize": repr(model.step_size)}
    for variable in model.variables:
        if variable.name == "tolerance":  # a model around an object with a step has none
            experiment["tolerance"] = repr(variable.start)
    ET.SubElement(root, "DefaultExperiment", experiment)


def add_units(root: ET.Element, variables: Iterable[Variable]) -> None:
    """Add unit definitions with display units; those of FMI 2.0 and 3.0 are the same."""
    used = {variable.unit for variable in variables if variable.kind == "real"}
    displayed = {variable.display_unit for variable in variables if variable.display_unit}
    definitions = ET.SubElement(root, "UnitDefinitions")
    rates = {rate_unit(name): exponents | {"s": exponents.get("s", 0) - 1} for name, exponents in UNITS.items()}
    known = UNITS | {name: exponents for name, exponents in rates.items() if name not in UNITS}
    for name, exponents in known.items():
        if name not in used:
            continue
        unit = ET.SubElement(definitions, "Unit", name=name)
        ET.SubElement(unit, "BaseUnit", {base: str(exponent) for base, exponent in exponents.items()})
        for display, (of, factor) in DISPLAY_UNITS.items():
            if of == name and display in displayed:
                ET.SubElement(unit, "DisplayUnit", name=display, factor=repr(factor))
    unknown = used - set(known)
    if unknown:
        raise ValueError(f"Add the units {', '.join(sorted(unknown))} to UNITS in model_description.py.")


def _variable(parent: ET.Element, reference: int, variable: Variable) -> None:
    attributes = {
        "name": variable.name,
        "valueReference": str(reference),
        "description": variable.description,
        "causality": variable.causality,
        "variability": variability(variable),
    }
    if variable.causality == "parameter":
        attributes["initial"] = "exact"
    if variable.causality in ("output", "local"):
        attributes["initial"] = "calculated"
    element = ET.SubElement(parent, "ScalarVariable", attributes)
    of_type: dict[str, str] = {}
    if variable.kind == "real":
        of_type["unit"] = variable.unit
        if variable.display_unit:
            of_type["displayUnit"] = variable.display_unit
        if variable.unit in NOMINAL:
            of_type["nominal"] = repr(NOMINAL[variable.unit])
    of_type |= limits(variable)
    if variable.causality not in ("output", "local"):
        of_type["start"] = number_text(variable, variable.start)
    ET.SubElement(element, TYPES[variable.kind], of_type)


def variability(variable: Variable) -> str:
    """Return the variability of a variable: when its value may change, in the words of FMI."""
    if variable.causality == "parameter":
        return "fixed"
    return "continuous" if variable.kind == "real" else "discrete"


def limits(variable: Variable) -> dict[str, str]:
    """Return the attributes min and max that its type has."""
    if variable.kind in ("boolean", "string"):
        return {}
    both = {"min": variable.minimum, "max": variable.maximum}
    return {name: number_text(variable, limit) for name, limit in both.items() if math.isfinite(limit)}


def number_text(variable: Variable, value: float) -> str:
    """Return a value as its type is written in XML."""
    if variable.kind == "string":
        return ""
    return repr(float(value)) if variable.kind == "real" else str(int(value))


def cells(variable: Variable) -> dict[str, str]:
    """Return the cells of a variable in tables for people, by the heads of their columns."""
    given = variable.causality in ("parameter", "input") and variable.kind != "string"
    between = limits(variable)
    return {
        "name": variable.name,
        "type": TYPES[variable.kind],
        "causality": variable.causality,
        "variability": variability(variable),
        "unit": variable.unit if variable.kind == "real" else "",
        "start": f"{variable.start:g}" if given else "",
        **{name: f"{float(between[name]):g}" if name in between else "" for name in ("min", "max")},
        "meaning": variable.description,
    }


def variable_table(model: Model) -> str:
    """Return the variables as Markdown: a table of the inputs, one of the outputs, one of the parameters."""
    parts = []
    for causality in ("input", "output", "parameter"):
        rows = [cells(variable) for variable in model.variables if variable.causality == causality]
        if rows:
            parts.append(f"### {causality.capitalize()}s of {model.name}\n\n{_markdown(rows)}")
    return "\n".join(parts)


def _markdown(rows: Sequence[Mapping[str, str]]) -> str:
    """Return a table of these rows, without columns that are empty in all of them."""
    heads = [head for head in rows[0] if any(row[head] for row in rows)]
    lines = [heads, ["---"] * len(heads)]
    lines += [[f"`{row[head]}`" if head == "name" else row[head] for head in heads] for row in rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines) + "\n"


def _mark_states(variables: ET.Element, model: Model) -> None:
    """Mark each derivative with its state, by their places, and each state that an event may set to a new value."""
    for state, derivative in zip(exchanged_states(model), variables[len(model.variables) :], strict=True):
        place = model.index(state_variable(state.name))
        derivative[0].set("derivative", str(place + 1))
        if state.name in reset_at_events(model):
            variables[place][0].set("reinit", "true")


def _structure(root: ET.Element, model: Model, exchange: Sequence[Variable]) -> None:
    """Write the dependencies; variables are named by their places, counted from 1."""
    in_step = step_dependencies(model) if exchange else input_dependencies(model)
    at_start = start_dependencies(model)
    place = {variable.name: number for number, variable in enumerate((*model.variables, *exchange), start=1)}
    outputs = [variable.name for variable in model.variables if variable.causality == "output"]
    slopes = [variable.name for variable in exchange]
    states = [state_variable(state.name) for state in exchanged_states(model)] if exchange else []
    structure = ET.SubElement(root, "ModelStructure")
    lists = [("Outputs", outputs, in_step), ("InitialUnknowns", [*outputs, *states, *slopes], at_start)]
    if exchange:
        lists.insert(1, ("Derivatives", slopes, in_step))
    for name, unknowns, dependencies in lists:
        parent = ET.SubElement(structure, name)
        for unknown in sorted(unknowns, key=place.__getitem__):
            known = sorted(place[one] for one in dependencies[unknown])
            ET.SubElement(parent, "Unknown", index=str(place[unknown]), dependencies=" ".join(map(str, known)))

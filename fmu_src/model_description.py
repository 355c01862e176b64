"""Model -> modelDescription.xml of FMI 2.0 and 3.0: interfaces, variables, units, dependencies, initial unknowns."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator, Mapping, Sequence

from fmu_src import __version__
from fmu_src.archive import xml_file
from fmu_src.dependencies import input_dependencies, start_dependencies, step_dependencies
from fmu_src.model_exchange import (
    derivatives,
    exchanged_states,
    first_reference,
    indicators,
    rate_unit,
    reset_at_events,
)
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
TYPES3 = {"real": "Float64", "integer": "Int32", "boolean": "Boolean", "string": "String"}
#: The independent variable of FMI 3.0.
TIME = Variable("time", "output", "s", "Simulation time")
LOG_CATEGORIES = {
    "events": "What happened inside, as sentences with the time",
    "logStatusWarning": "Values that were replaced or have no effect",
    "logStatusDiscard": "The run ended: an end condition was reached",
    "logStatusError": "Refused values and failed steps",
}


def model_description(model: Model, guid: str, binary: str = KERNEL, source_files: Iterable[str] = ()) -> str:
    """Return the XML text of FMI 2.0. binary: the C file of the object, one of those in objects.py.

    source_files: C files in sources/ that a host may compile.
    """
    root = description_root({"fmiVersion": "2.0", "modelName": model.name, "guid": guid}, model.description, "flat")
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
    _add_units(root, (*model.variables, *exchange))
    _add_experiment_of(root, model)
    variables = ET.SubElement(root, "ModelVariables")
    for reference, variable in _numbered(model, exchange):
        initial = {"initial": "exact"} if variable.causality == "parameter" else {}
        element = ET.SubElement(variables, "ScalarVariable", _nature(reference, variable) | initial)
        ET.SubElement(element, TYPES[variable.kind], _of_type(variable))
    if exchange:
        _mark_states(model, [element[0] for element in variables], len(model.variables), first_place=1)
    structure = ET.SubElement(root, "ModelStructure")
    place = {variable.name: number for number, variable in enumerate((*model.variables, *exchange), start=1)}
    names = ("Outputs", "Derivatives", "InitialUnknowns")
    for name, (unknowns, known) in zip(names, _unknowns(model, exchange), strict=True):
        parent = ET.SubElement(structure, name) if unknowns or name != "Derivatives" else structure
        for unknown in sorted(unknowns, key=place.__getitem__):
            dependencies = _numbers(place[one] for one in known[unknown])
            ET.SubElement(parent, "Unknown", index=str(place[unknown]), dependencies=dependencies)
    return xml_file(root).decode()


def model_description3(model: Model, token: str) -> str:
    """Return the XML text of FMI 3.0.

    Value references are those of FMI 2.0, and the time has the one after the table's last.
    """
    attributes = {"fmiVersion": "3.0", "modelName": model.name, "instantiationToken": token}
    root = description_root(attributes, model.description, "flat")
    both = {"modelIdentifier": model.name} | able(KERNEL, OF_BOTH[3])
    exchange = [*derivatives(model), *indicators(model)]
    if exchange:
        ET.SubElement(root, "ModelExchange", both | {"needsCompletedIntegratorStep": "true"})
    slave = {"canHandleVariableCommunicationStepSize": "true"} | able(KERNEL, OF_SLAVES[3])
    ET.SubElement(root, "CoSimulation", both | slave | {"maxOutputDerivativeOrder": order_of_rates(KERNEL)})
    _add_units(root, (*model.variables, TIME, *exchange))
    _add_experiment_of(root, model)
    variables = ET.SubElement(root, "ModelVariables")
    for reference, variable in _numbered(model, exchange):
        attributes = _nature(reference, variable) | _of_type(variable)
        start = attributes.pop("start") if variable.kind == "string" else None
        element = ET.SubElement(variables, TYPES3[variable.kind], attributes)
        if start is not None:
            ET.SubElement(element, "Start", value=start)
    count = len(model.variables)
    time = {"name": TIME.name, "valueReference": str(count), "description": TIME.description}
    kind = {"causality": "independent", "variability": "continuous", "unit": TIME.unit}
    variables.insert(count, ET.Element("Float64", time | kind))
    _mark_states(model, list(variables), count + 1, first_place=0)
    structure = ET.SubElement(root, "ModelStructure")
    reference_of = {variable.name: reference for reference, variable in _numbered(model, exchange)}
    names = ("Output", "ContinuousStateDerivative", "InitialUnknown")
    for name, (unknowns, known) in zip(names, _unknowns(model, exchange), strict=True):
        for unknown in unknowns:
            dependencies = _numbers(reference_of[one] for one in known[unknown])
            ET.SubElement(structure, name, valueReference=str(reference_of[unknown]), dependencies=dependencies)
    for indicator in indicators(model):
        ET.SubElement(structure, "EventIndicator", valueReference=str(reference_of[indicator.name]))
    return xml_file(root).decode()


def description_root(attributes: dict[str, str], description: str, naming: str) -> ET.Element:
    """Return the root of a description; naming: convention of the names of variables."""
    common = {"description": description, "version": __version__, "license": "MIT", "generationTool": "bogie-braking"}
    return ET.Element("fmiModelDescription", attributes | common | {"variableNamingConvention": naming})


def _numbered(model: Model, exchange: Sequence[Variable]) -> Iterator[tuple[int, Variable]]:
    """Yield the variables with their value references, those of model exchange last."""
    yield from enumerate(model.variables)
    yield from enumerate(exchange, first_reference(model))


def _numbers(numbers: Iterable[int]) -> str:
    return " ".join(map(str, sorted(numbers)))


def _add_experiment_of(root: ET.Element, model: Model) -> None:
    """Add the default experiment of a model; one around an object with a step has no tolerance."""
    tolerance = next((variable.start for variable in model.variables if variable.name == "tolerance"), None)
    add_experiment(root, model.stop_time, model.step_size, tolerance)


def add_experiment(root: ET.Element, stop_time: float, step_size: float, tolerance: float | None = None) -> None:
    """Add log categories and the default experiment."""
    categories = ET.SubElement(root, "LogCategories")
    for name, description in LOG_CATEGORIES.items():
        ET.SubElement(categories, "Category", name=name, description=description)
    experiment = {"startTime": "0.0", "stopTime": repr(stop_time), "stepSize": repr(step_size)}
    ET.SubElement(root, "DefaultExperiment", experiment | ({} if tolerance is None else {"tolerance": repr(tolerance)}))


def _add_units(root: ET.Element, variables: Iterable[Variable]) -> None:
    """Add unit definitions with display units."""
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


def _nature(reference: int, variable: Variable) -> dict[str, str]:
    attributes = {
        "name": variable.name,
        "valueReference": str(reference),
        "description": variable.description,
        "causality": variable.causality,
        "variability": variability(variable),
    }
    return attributes | ({"initial": "calculated"} if variable.causality in ("output", "local") else {})


def _of_type(variable: Variable) -> dict[str, str]:
    """Return the attributes of a variable that depend on its type: unit, nominal value, limits, start value."""
    attributes: dict[str, str] = {}
    if variable.kind == "real":
        attributes["unit"] = variable.unit
        if variable.display_unit:
            attributes["displayUnit"] = variable.display_unit
        if variable.unit in NOMINAL:
            attributes["nominal"] = repr(NOMINAL[variable.unit])
    attributes |= limits(variable)
    if variable.causality not in ("output", "local"):
        attributes["start"] = "" if variable.kind == "string" else number_text(variable.start, variable.kind == "real")
    return attributes


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
    return {name: number_text(limit, variable.kind == "real") for name, limit in both.items() if math.isfinite(limit)}


def number_text(value: float, real: bool) -> str:
    """Return a number as its type is written in XML: real or an integer."""
    return repr(float(value)) if real else str(int(value))


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


def variable_table(name: str, variables: Sequence[Variable]) -> str:
    """Return the variables of an FMU as Markdown: tables of inputs, outputs, parameters."""
    parts = []
    for causality in ("input", "output", "parameter"):
        rows = [cells(variable) for variable in variables if variable.causality == causality]
        if rows:
            parts.append(f"### {causality.capitalize()}s of {name}\n\n{_markdown(rows)}")
    return "\n".join(parts)


def _markdown(rows: Sequence[Mapping[str, str]]) -> str:
    """Return a table of these rows, without columns that are empty in all of them."""
    heads = [head for head in rows[0] if any(row[head] for row in rows)]
    lines = [heads, ["---"] * len(heads)]
    lines += [[f"`{row[head]}`" if head == "name" else row[head] for head in heads] for row in rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines) + "\n"


def _mark_states(model: Model, typed: Sequence[ET.Element], first: int, first_place: int) -> None:
    """Mark each derivative with its state, and each state that an event may set to a new value.

    typed: elements of the variables; first: number of the first derivative; first_place: number that names the first.
    """
    for number, state in enumerate(exchanged_states(model), first):
        place = model.index(state_variable(state.name))
        typed[number].set("derivative", str(place + first_place))
        if state.name in reset_at_events(model):
            typed[place].set("reinit", "true")


def _unknowns(model: Model, exchange: Sequence[Variable]) -> list[tuple[list[str], Mapping[str, set[str]]]]:
    """Return the outputs, derivatives and initial unknowns, each with the known variables of its members."""
    in_step = step_dependencies(model) if exchange else input_dependencies(model)
    outputs = [variable.name for variable in model.variables if variable.causality == "output"]
    slopes = [variable.name for variable in derivatives(model)] if exchange else []
    states = [state_variable(state.name) for state in exchanged_states(model)] if exchange else []
    return [(outputs, in_step), (slopes, in_step), ([*outputs, *states, *slopes], start_dependencies(model))]

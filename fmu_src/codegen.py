"""From a `Model` to plain C: equations, exact Jacobian, and the constant description that the runtime reads."""

from __future__ import annotations

import math
import re
from bisect import bisect_left
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache

from fmu_src.c_literals import c_array, c_number, c_text
from fmu_src.elimination import Elimination, elimination, elimination_source
from fmu_src.equations import Generated, functions, table_ranks
from fmu_src.equations_in_c import TABLE_FILE, equations_in_c
from fmu_src.identity import identifier
from fmu_src.idle_parameters import without_effect
from fmu_src.model_description import model_description
from fmu_src.model_exchange import exchanged, serves_exchange
from fmu_src.objects import FACES, KERNEL, RUNTIME, START_VALUES
from fmu_src.progress import counting
from fmu_src.record_file import own_name, own_records, record_file_source, record_in_c
from fmu_src.states import SteadyStart
from fmu_src.system import Model, System
from fmu_src.table_file import table_file_source
from fmu_src.user_files import OfRecord
from fmu_src.variables import integration_variables, state_variable
from readers.usual import LEAST_PRESSURE, rows_for_c, usual_range

#: Each calls only those before it; faces belong to FMUs, studies to the library for kernel.py.
KERNEL_SOURCES = (
    "message.c",
    "decimal.c",
    "text_rows.c",
    "table_pieces.c",
    "table_file.c",
    "record_file.c",
    "evaluate.c",
    "variables.c",
    "experiment.c",
    "linear.c",
    "rosenbrock.c",
    "algebraic.c",
    "reuse.c",
    "runge_kutta.c",
    "outputs.c",
    "reported.c",
    "modes.c",
    "locate.c",
    "record.c",
    "fixed.c",
    "integrate.c",
    "steady.c",
    "initialise.c",
    "explicit_host.c",
    "exchange.c",
    "derivatives.c",
    "step.c",
    "text.c",
    "saved.c",
    "instance.c",
)
FACE_SOURCES = (START_VALUES, KERNEL, *FACES)
STUDY_SOURCES = ("study.c", "other_methods.c")
#: Sources of runs in lanes, with the number of lanes as a macro.
BATCH_SOURCES = ("batch_lanes.c", "batch.c")
RUNTIME_SOURCES = (*KERNEL_SOURCES, *FACE_SOURCES, *STUDY_SOURCES)
RUNTIME_HEADERS = (
    "variable.h",
    "model.h",
    "table_file.h",
    "record_file.h",
    "records.h",
    "text_rows.h",
    "lanes.h",
    "lanes_end.h",
    "lanes_math.h",
    "lanes_names.h",
    "lanes_pairs.h",
    "lanes_scalar.h",
    "lanes_table.h",
    "lanes_records.h",
    "piecewise.h",
    "readable.h",
    "resources.h",
    "start_values.h",
    "identity.h",
    "print_text.h",
    "traps.h",
    "sealed.h",
    "duration.h",
    "stepper.h",
    "tableau.h",
    "known.h",
    "own_functions.h",
    "batch.h",
    "batch_lanes.h",
    "rosenbrock_stages.h",
    "lanes_vector.h",
    "lanes_widest.h",
    "kernel.h",
    "status.h",
    "state.h",
    "workspace.h",
    "instance.h",
    "method.h",
    "studies.h",
    "object.h",
    "face.h",
)

#: Functions of a system in the order of `system_description` in model.h.
FUNCTIONS = (
    "derive",
    "start",
    "ode",
    "jacobian",
    "output",
    "drive",
    "capacity",
    "condition_margin",
    "warning_margin",
    "largest_change",
    "reported",
    "output_along",
    "residual_along",
)
#: Those of its steady start, in the order of `steady_start` there.
STEADY_FUNCTIONS = ("course", "pace")
#: Longest path of a number of a record, as in model.h.
LONGEST_PATH = 2
KINDS = {"real": "KIND_REAL", "integer": "KIND_INTEGER", "boolean": "KIND_BOOLEAN", "string": "KIND_STRING"}


def generate(model: Model) -> dict[str, str]:
    """Return C sources by file name: equations and their elimination, a file of each for each system, and model.c,
    the description; made once for each model.
    """
    return dict(_sources(model))


@lru_cache(maxsize=32)
def _sources(model: Model) -> dict[str, str]:
    generated: list[dict[str, Generated]] = []
    solving: dict[str, Elimination] = {}
    sources: dict[str, str] = {}
    for system in counting(model.systems, "generating C", unit="system"):
        generated.append(functions(system))
        solving[system.name] = elimination(system)
        sources |= equations_in_c(system.name, generated[-1])
        sources[f"elimination_{system.name}.c"] = elimination_source(system.name, solving[system.name])
        own = own_records(system.records)
        sources |= {f"{TABLE_FILE}{name}.c": record_in_c(name, record) for name, record in own.items()}
    description = _description(model, generated, solving)
    # The GUID is a function of everything a host can see: equations, description, words and units.
    guid = content_guid([*sources.values(), description, model_description(model, "")])
    sources["model.c"] = description.replace("@GUID@", guid)
    return sources


@lru_cache(maxsize=256)
def _idle(model: Model, name: str) -> list[str]:
    """Return the parameters without an effect in the system of this name."""
    return without_effect(model, next(system for system in model.systems if system.name == name))


def guid_of(sources: Mapping[str, str]) -> str:
    """Return the GUID in generated sources; changes with the content of the model and with nothing else."""
    found = re.search(r"\{[0-9a-f-]{36}\}", sources["model.c"])
    assert found
    return found.group()


def content_guid(texts: Iterable[str]) -> str:
    """Return a GUID that is a function of the content, the runtime included, so that equal builds are equal."""
    return identifier([*texts, *((RUNTIME / name).read_bytes() for name in (*RUNTIME_SOURCES, *RUNTIME_HEADERS))])


def _system_arrays(model: Model, system: System, solving: Elimination) -> Iterable[str]:
    """Return the constants of a system."""
    prefix = system.name
    outputs = [variable.name for variable in system.variables if variable.causality == "output"]
    for suffix, names in (
        ("input", list(system.input_symbols)),
        ("parameter", list(system.parameter_symbols)),
        ("output", outputs),
    ):
        yield c_array("int", f"{prefix}_{suffix}_variable", [str(model.index(name)) for name in names])
    shown = [-1 if s.algebraic else model.index(state_variable(s.name)) for s in system.states.values()]
    yield c_array("int", f"{prefix}_state_variable", map(str, shown))
    yield c_array("int", f"{prefix}_idle", [str(model.index(name)) for name in _idle(model, system.name)])
    yield c_array("double", f"{prefix}_nominal", [c_number(state.nominal) for state in system.states.values()])
    yield c_array("int", f"{prefix}_order", map(str, solving.order))
    yield c_array("int", f"{prefix}_position", map(str, solving.position))
    columns = [column for _, column in solving.nonzeros]
    starts = (bisect_left(columns, column) for column in range(1 + len(solving.order)))
    yield c_array("int", f"{prefix}_column_start", map(str, starts if system.states else ()))
    yield c_array("int", f"{prefix}_row", (str(row) for row, _ in solving.nonzeros))
    position = {name: number for number, name in enumerate(system.states)}
    limited = [[position[name] for name in names] for names, _ in system.largest_changes]
    yield c_array("limited_change", f"{prefix}_limited", [f"{{{one[0]}, {[*one, -1][1]}}}" for one in limited])
    algebraic = [number for number, state in enumerate(system.states.values()) if state.algebraic]
    yield c_array("int", f"{prefix}_algebraic", map(str, algebraic))
    inside = _algebraic_nonzeros(system, solving)
    yield c_array("int", f"{prefix}_algebraic_nonzero", map(str, inside))
    where = [tuple(map(algebraic.index, solving.nonzeros[number])) for number in inside]
    yield c_array("int", f"{prefix}_algebraic_place", (str(column * len(algebraic) + row) for row, column in where))
    wholes = [friction.whole for friction in system.frictions]
    yield c_array(
        "friction_description",
        f"{prefix}_friction",
        [
            f"{{{c_text(f.whole or f.label)}, {c_text(f.stuck_word)}, {c_text(f.sliding_word)}, "
            f"{position[f.states[0]]}, {position[f.states[1]] if f.states[1:] else -1}, "
            f"{wholes.index(f.whole) if f.whole else -1}, {int(f.reported is not None)}}}"
            for f in system.frictions
        ],
    )
    entries: list[str] = []
    place = 0
    for table in system.ranked_tables:
        name = f"{prefix}_{table.name}_piece"
        yield c_array("int", name, [str(table.file.pieces.index(piece)) for piece in table.pieces])
        entries.append(f"{{{table.rank}, {place}, {len(table.pieces)}, {name}}}")
        place += table.symbols.numel()
    yield c_array("table_description", f"{prefix}_table", entries)
    yield c_array("value_of_record", f"{prefix}_record", map(_value_of_record, system.records))
    ranks = [f"{prefix}_table_argument_{rank}" for rank in range(table_ranks(system))]
    yield c_array("generated_function", f"{prefix}_table_argument", ranks)
    if system.steady_start:
        yield from _steady_arrays(system, system.steady_start)
    sentences = [c_text(condition.sentence) for condition in (*system.end_conditions, *system.warnings)]
    yield c_array("char *const", f"{prefix}_sentence", sentences)


def _value_of_record(of_record: OfRecord) -> str:
    """Return a number of a record, its members by position."""
    kind, steps = of_record.file.kind, []
    for place, entry in of_record.path:
        steps.append((place, entry, int(kind.lists[place].shared)))
        kind = kind.lists[place].kind
    steps += [(0, 0, 0)] * (LONGEST_PATH - len(steps))
    places = ", ".join(f"{{{place}, {entry}, {shared}}}" for place, entry, shared in steps)
    return f"{{&{own_name(of_record.own)}, {of_record.root}, {len(of_record.path)}, {{{places}}}, {of_record.number}}}"


def _algebraic_nonzeros(system: System, solving: Elimination) -> list[int]:
    """Return the nonzeros of the Jacobian that are derivatives of residuals by algebraic states."""
    algebraic = [state.algebraic for state in system.states.values()]
    return [number for number, (row, column) in enumerate(solving.nonzeros) if algebraic[row] and algebraic[column]]


def _steady_arrays(system: System, start: SteadyStart) -> Iterable[str]:
    """Return the description of a steady start, its members by position."""
    prefix = f"{system.name}_steady"
    states, inputs, parameters = list(system.states), list(system.input_symbols), list(system.parameter_symbols)
    places = {
        "kept": [states.index(name) for name in start.kept],
        "last": [states.index(name) for name in start.last],
        "drive": [inputs.index(name) for name in start.drives],
        "place": [parameters.index(name) for name in start.places],
    }
    for name, numbers in places.items():
        yield c_array("int", f"{prefix}_{name}", map(str, numbers))
    fields = {"speed": str(states.index(start.speed))} | {f"{name}s": str(len(some)) for name, some in places.items()}
    fields |= {name: f"{prefix}_{name}" if numbers else "0" for name, numbers in places.items()}
    fields |= {"sentence": c_text(start.sentence)} | {name: f"{system.name}_{name}" for name in STEADY_FUNCTIONS}
    members = ", ".join(f"/* {name} */ {value}" for name, value in fields.items())
    yield f"static const steady_start {prefix}_start = {{{members}}};"


def _system_entry(model: Model, system: System, made: dict[str, Generated], solving: Elimination) -> str:
    """Return a system_description, its members by position: C++ before 2020 has no named members."""
    prefix = system.name
    outputs = [variable.name for variable in system.variables if variable.causality == "output"]
    counts = {
        "states": len(system.states),
        "algebraics": sum(state.algebraic for state in system.states.values()),
        "algebraic_nonzeros": len(_algebraic_nonzeros(system, solving)),
        "nonzeros": made["jacobian"].function.nnz_out(made["jacobian"].ranks),
        "factors": len(solving.place),
        "lower_factors": solving.lower,
        "inputs": len(system.input_symbols),
        "parameters": len(system.parameter_symbols),
        "derived": len(system.derived_symbols),
        "frictions": len(system.frictions),
        "outputs": len(outputs),
        "tables": len(system.tables),
        "table_ranks": table_ranks(system),
        "table_coefficients": sum(table.symbols.numel() for table in system.tables) + len(system.records),
        "records": len(system.records),
        "limits": len(system.largest_changes),
        "ends": len(system.end_conditions),
        "conditions": len(system.end_conditions) + len(system.warnings),
        "exchanged": int(serves_exchange(model, system)),
        "idles": len(_idle(model, system.name)),
    }
    arrays = {
        "input_variable": "inputs",
        "parameter_variable": "parameters",
        "output_variable": "outputs",
        "state_variable": "states",
        "idle": "idles",
        "nominal": "states",
        "order": "states",
        "position": "states",
        "column_start": "states",
        "row": "nonzeros",
        "algebraic": "algebraics",
        "algebraic_nonzero": "algebraic_nonzeros",
        "algebraic_place": "algebraic_nonzeros",
        "limited": "limits",
        "friction": "frictions",
        "table": "tables",
        "record": "records",
        "sentence": "conditions",
    }
    fields = {"name": c_text(system.name)} | {name: str(count) for name, count in counts.items()}
    fields |= {name: f"{prefix}_{name}" if counts[count] else "0" for name, count in arrays.items()}
    fields |= {name: made[name].function.name() if name in made else "0" for name in FUNCTIONS}
    fields |= {name: f"{prefix}_{name}" for name in ("factorise", "substitute")}
    fields["refuses_records"] = c_text(system.refuses_records) if system.refuses_records else "0"
    fields["steady"] = f"&{prefix}_steady_start" if system.steady_start else "0"
    fields["table_argument"] = f"{prefix}_table_argument" if counts["tables"] else "0"
    return "    {" + ",\n     ".join(f"/* {name} */ {value}" for name, value in fields.items()) + "}"


def _relations(model: Model) -> list[str]:
    """Return the relations between parameters as arrays."""
    arrays, rows = [], []
    for number, relation in enumerate(model.relations):
        places, factors = ([pair[side] for pair in relation.terms] for side in (0, 1))
        arrays.append(c_array("int", f"RELATION_VARIABLE_{number}", [str(model.index(str(name))) for name in places]))
        arrays.append(c_array("double", f"RELATION_FACTOR_{number}", [c_number(float(value)) for value in factors]))
        names = f"RELATION_VARIABLE_{number}, RELATION_FACTOR_{number}"
        rows.append(f"{{{len(relation.terms)}, {names}, {c_number(relation.constant)}, {c_text(relation.sentence)}}}")
    return [*arrays, c_array("relation_description", "RELATION", rows)] if rows else []


def _description(model: Model, generated: Sequence[dict[str, Generated]], solving: Mapping[str, Elimination]) -> str:
    lines = ["#include <math.h>", '#include "model.h"', ""]
    for function in dict.fromkeys(one.function.name() for made in generated for one in made.values()):
        lines.append(f"RUNTIME_LOCAL int {function}(const double **, double **, long long int *, double *, int);")
    for system in model.systems:
        lines.append(f"RUNTIME_LOCAL void {system.name}_factorise(const double *, const double *, double *);")
        lines.append(f"RUNTIME_LOCAL void {system.name}_substitute(const double *, double *);")
        lines += [line for line in _system_arrays(model, system, solving[system.name]) if line]
    names = dict.fromkeys(name for system in model.systems for name in own_records(system.records))
    own = [f"extern const record {name};" for name in names]
    lines[2:2] = ['#include "records.h"', "#ifndef ONE_UNIT", *own, "#endif"] if own else []
    lines += _relations(model)
    readings = [
        f"{{{c_text(unit)}, {c_text(other)}, {', '.join(map(c_number, numbers))}}}"
        for unit, other, *numbers in rows_for_c()
    ]
    lines.append(c_array("reading_description", "READING", readings))
    if model.table_file:
        lines.append(table_file_source(model.table_file, model.index(model.table_file.variable.name)))
    if model.record_file:
        roots = max((1 + record.root for system in model.systems for record in system.records), default=0)
        lines.append(record_file_source(model.record_file, model.index(model.record_file.variable.name), roots))
    lines.append("static const variable_description VARIABLE[] = {")
    for v in model.variables:
        lost = math.nan if v.when_lost is None else v.when_lost
        numbers = ", ".join(c_number(x) for x in (v.start, v.minimum, v.maximum, lost))
        lines.append(
            f"    {{{c_text(v.name)}, {c_text(v.unit)}, {KINDS[v.kind]}, CAUSALITY_{v.causality.upper()}, {numbers}}},"
        )
    lines += ["};", "static const system_description SYSTEM[] = {"]
    systems = zip(model.systems, generated, strict=True)
    lines.append(",\n".join(_system_entry(model, s, made, solving[s.name]) for s, made in systems))
    chosen_by = [model.index(name) for name in model.selectors]
    lines.insert(2, f"static const int CHOICE[] = {{{', '.join(map(str, model.choice))}}};")
    if chosen_by:
        values = [str(int(model.variables[index].maximum)) for index in chosen_by]
        lines.insert(2, c_array("int", "SELECTOR", map(str, chosen_by)) + "\n" + c_array("int", "SELECTABLE", values))
    selectors = "SELECTOR, SELECTABLE" if chosen_by else "0, 0"
    table_file = "&TABLE_FILE" if model.table_file else "0"
    record_file = "&RECORD_FILE" if model.record_file else "0"
    exchange = exchanged(model)
    integrated = model.systems.index(exchange) if exchange else -1
    integration = ", ".join(str(model.index(variable.name)) for variable in integration_variables(1e-6))
    lines += [
        "};",
        f"RUNTIME_LOCAL const model_description MODEL = {{{c_text(model.name)}, {c_text('@GUID@')}, "
        f"{len(model.variables)}, {len(model.systems)}, {len(chosen_by)}, {selectors}, CHOICE, "
        f"{integrated}, {integration}, VARIABLE, SYSTEM, {table_file}, {record_file}, "
        f"{len(model.relations)}, {'RELATION' if model.relations else '0'}, {len(readings)}, READING, "
        f"{c_number(LEAST_PRESSURE)}, {c_number(usual_range('Pa')[0])}}};",
        "",
    ]
    return "\n".join(lines)

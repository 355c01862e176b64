"""From a `Model` to plain C: equations, exact Jacobian, and the constant description that the runtime reads."""

from __future__ import annotations

import hashlib
import math
import re
import tempfile
from bisect import bisect_left
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import casadi as ca
from tqdm import tqdm

from fmu_src.c_literals import c_array, c_number, c_text
from fmu_src.chain import Call, Chain, Part, shared, symbols_in
from fmu_src.effects import without_effect
from fmu_src.elimination import Elimination, elimination, elimination_source
from fmu_src.exchange import exchanged, serves_exchange
from fmu_src.model_description import model_description
from fmu_src.own_names import PREFIX, with_own_names
from fmu_src.pieces import in_pieces
from fmu_src.progress import PATIENCE
from fmu_src.system import Model, SteadyStart, System, integration_variables, state_variable
from fmu_src.table_file import table_file_source

RUNTIME = Path(__file__).parent / "runtime"
#: Each calls only those before it; faces belong to FMUs, studies to the library for kernel.py.
KERNEL_SOURCES = (
    "message.c",
    "decimal.c",
    "table_pieces.c",
    "table_file.c",
    "piecewise.c",
    "evaluate.c",
    "variables.c",
    "experiment.c",
    "linear.c",
    "rosenbrock.c",
    "algebraic.c",
    "reuse.c",
    "runge_kutta.c",
    "outputs.c",
    "modes.c",
    "locate.c",
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
FACE_SOURCES = ("face.c", "face_exchange.c", "fmi2.c", "fmi3.c")
STUDY_SOURCES = ("study.c", "other_methods.c")
RUNTIME_SOURCES = (*KERNEL_SOURCES, *FACE_SOURCES, *STUDY_SOURCES)
RUNTIME_HEADERS = (
    "model.h",
    "table_file.h",
    "kernel.h",
    "status.h",
    "state.h",
    "workspace.h",
    "instance.h",
    "method.h",
    "studies.h",
    "face.h",
    "fmi2Functions.h",
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
    "output_along",
    "residual_along",
)
#: Those of its steady start, in the order of `steady_start` there.
STEADY_FUNCTIONS = ("course", "pace")
KINDS = {"real": "KIND_REAL", "integer": "KIND_INTEGER", "boolean": "KIND_BOOLEAN", "string": "KIND_STRING"}


@dataclass(frozen=True)
class Generated:
    """A function as the runtime calls it: `function` takes the arguments of the system and the results of its `calls`.

    Its first results are what the calls of each rank are given; with `differentiated`, each call leaves its slopes
    behind its results.
    """

    function: ca.Function
    calls: list[Call]
    differentiated: bool

    @property
    def ranks(self) -> int:
        """How many results come before those of the function itself."""
        return 1 + max((call.rank for call in self.calls), default=-1)

    def sizes(self, call: Call) -> tuple[int, int]:
        """Numbers that a call is given and that it leaves."""
        left = call.symbols.numel() + (call.slopes.numel() if self.differentiated else 0)
        return call.taken.numel(), left


def functions(system: System) -> dict[str, Generated]:
    """The generated functions of a system; all take its `arguments`, those along a direction one more, the seed."""
    arguments = system.arguments
    time, states, inputs, rates = arguments[:4]
    ode = system.ode
    # Exact: d/dx, its structural nonzeros only, and along the given rates of the inputs d/dt.
    jacobian = system.jacobian(ode, states)
    time_slope = ca.densify(system.along(ode, ca.vertcat(time, inputs), ca.vertcat(1, rates)))
    costly = any(warning.candidate is not None for warning in system.warnings)
    results: dict[str, list[ca.SX]] = {
        "derive": [ca.vertcat(*system.derived_expressions.values())],
        "start": [_start(system)],
        "ode": [ode],
        "jacobian": [jacobian.nz[:], time_slope, ode],
        "output": [ca.vertcat(*system.outputs.values())],
        "drive": [ca.vertcat(*[friction.drive for friction in system.frictions])],
        "capacity": [ca.vertcat(*[f.capacity for f in system.frictions], *[f.still for f in system.frictions])],
        "condition_margin": [ca.vertcat(*[c.first_look for c in (*system.end_conditions, *system.warnings)])],
        "warning_margin": [ca.vertcat(*[c.margin for c in system.warnings])] if costly else [],
        "largest_change": [ca.vertcat(*[largest for _, largest in system.largest_changes])],
    }
    if system.steady_start:
        given = system.parameter_symbols[system.steady_start.given]
        start = system.without_waists(_start(system))
        results |= {"course": [system.steady_start.course], "pace": [ca.densify(ca.jacobian(start, given))]}
    for rank in range(_table_ranks(system)):
        asked = [table.argument for table in system.ranked_tables if table.rank == rank]
        results[f"table_argument_{rank}"] = [ca.vertcat(*asked)]
    made = {}

    def make(name: str, expressions: list[ca.SX], given: list[ca.SX]) -> None:
        if any(expression.numel() for expression in expressions):
            plain = [ca.densify(system.without_waists(expression)) for expression in expressions]
            made[name] = function_of(system, f"{system.name}_{name}", plain, given)

    for name, expressions in results.items():
        make(name, expressions, arguments)
    along = ca.vertcat(time, states, inputs)
    seed = ca.SX.sym("seed", along.numel())
    residuals = ca.vertcat(*[system.derivatives[state.name] for state in system.states.values() if state.algebraic])
    for name, expression in (("output_along", results["output"][0]), ("residual_along", residuals)):
        make(name, [system.along(expression, along, seed)] if expression.numel() else [], [*arguments, seed])
    return made


def function_of(chain: Chain, name: str, expressions: list[ca.SX], given: list[ca.SX]) -> Generated:
    """A function with the calls that its expressions need, in the order of their ranks."""
    needed: list[Call] = []
    users = symbols_in(ca.vertcat(*[ca.vec(expression) for expression in expressions]))
    for call in reversed(chain.calls):
        if not users.isdisjoint(call.own | call.own_slopes):
            needed.insert(0, call)
            users |= symbols_in(call.plain)
    needed.sort(key=lambda call: call.rank)
    differentiated = any(not users.isdisjoint(call.own_slopes) for call in needed)
    left = [ca.vertcat(call.symbols, call.slopes) if differentiated else call.symbols for call in needed]
    given_to: dict[int, list[ca.SX]] = {}
    for call in needed:
        given_to.setdefault(call.rank, []).append(call.plain)
    asked = [ca.vertcat(*one) for one in given_to.values()]
    results = [*[ca.densify(one) for one in asked], *expressions]
    taken = [*given, ca.vertcat(*left)] if needed else given
    return Generated(shared(name, taken, results), needed, differentiated)


def _table_ranks(system: System) -> int:
    return 1 + max((table.rank for table in system.tables), default=-1)


def _start(system: System) -> ca.SX:
    return ca.vertcat(*[state.start for state in system.states.values()])


def generate(model: Model) -> dict[str, str]:
    """C sources by file name: equations from CasADi and their elimination, a file of each for each system, and model.c,
    the description; made once for each model.
    """
    return dict(_sources(model))


@lru_cache(maxsize=32)
def _sources(model: Model) -> dict[str, str]:
    generated, solving, sources = [], {}, {}
    for system in tqdm(model.systems, "generating C", delay=PATIENCE, leave=False, unit="system"):
        generated.append(functions(system))
        solving[system.name] = elimination(system)
        sources[f"equations_{system.name}.c"] = equations_in_c(system.name, generated[-1])
        sources[f"elimination_{system.name}.c"] = elimination_source(system.name, solving[system.name])
    description = _description(model, generated, solving)
    # The GUID is a function of everything a host can see: equations, description, texts and units.
    guid = content_guid([*sources.values(), description, model_description(model, "")])
    sources["model.c"] = description.replace("@GUID@", guid)
    return sources


def guid_of(sources: Mapping[str, str]) -> str:
    """GUID in generated sources; changes with the content of the model and with nothing else."""
    found = re.search(r"\{[0-9a-f-]{36}\}", sources["model.c"])
    assert found
    return found.group()


def content_guid(texts: Iterable[str]) -> str:
    """A GUID that is a function of the content, the runtime included, so that equal builds are equal."""
    digest = hashlib.sha256()
    for text in texts:
        digest.update(text.encode())
    for name in (*RUNTIME_SOURCES, *RUNTIME_HEADERS):
        digest.update((RUNTIME / name).read_bytes())
    h = digest.hexdigest()
    return f"{{{h[:8]}-{h[8:12]}-{h[12:16]}-{h[16:20]}-{h[20:32]}}}"


def equations_in_c(name: str, made: Mapping[str, Generated]) -> str:
    """C of all functions, those of the parts before those that call them.

    `name` begins the names of what is seen in this file alone, so that files of several systems may become one unit.
    """
    own = list(made.values())
    inside, in_c = _functions_of_parts(own)
    called = [one for one in (*inside, *own) if one.calls]
    every = [one.function for one in (*inside, *own)]
    generator = ca.CodeGenerator("equations", {"with_export": False})
    for function in every:
        generator.add(function)
    with tempfile.TemporaryDirectory() as folder:
        generator.generate(folder + "/")
        text = (Path(folder) / "equations.c").read_text()
    # CasADi's squares, absolute values and minima are functions; inlined, a right-hand side takes 5 to 14 % less.
    text = re.sub(r"^casadi_real (?=casadi_\w+\()", "static inline casadi_real ", text, flags=re.MULTILINE)
    # Those of C are calls, since they take the other number in place of NaN; here NaN in the second place stays.
    for call, sign in (("fmin", "<"), ("fmax", ">")):
        text = text.replace(f"return {call}(x, y);", f"return x{sign}y ? x : y;")
    text = _without_questions(text, {function.name() for function in every})
    for one in called:
        text = _with_calls(text, one)
    text = in_pieces(_without_guards(text))
    for one in inside:
        text = re.sub(rf"^(?=int {one.function.name()}\()", "static ", text, flags=re.MULTILINE)
    text = _with_own_names(text, name, {one.function.name() for one in inside})
    # The interface of CasADi has arguments that these functions do not use; everything else stays a warning.
    common = list(dict.fromkeys(part.common for part in in_c))
    given = with_own_names([*common, *(part.source for part in in_c)])
    behind = (f"{source}{_calls_of(part)}" for part, source in zip(in_c, given[len(common) :], strict=True))
    return '#pragma GCC diagnostic ignored "-Wunused-parameter"\n' + "\n".join(
        [*map(_once, given[: len(common)]), *map(_once, behind), text]
    )


def _with_own_names(text: str, name: str, parts: set[str]) -> str:
    """CasADi's C in which helpers and generated parts have names that begin with `name`."""
    text = re.sub(r"^#define casadi_\w+ CASADI_PREFIX\(.*\n", "", text, flags=re.MULTILINE)

    def own(found: re.Match[str]) -> str:
        return f"{name}_{found[0]}" if found[0] in parts or found[0].startswith("casadi") else found[0]

    return re.sub(r"\b(?:casadi_(?!real\b|int\b)|part_)\w+", own, text)


def _once(text: str) -> str:
    """C that several files have, for where these become one unit."""
    name = f"GIVEN_{hashlib.sha256(text.encode()).hexdigest()[:16].upper()}"
    return f"#ifndef {name}\n#define {name}\n{text}\n#endif" if text else ""


def _functions_of_parts(own: Sequence[Generated]) -> tuple[list[Generated], list[Part]]:
    """Of each part that is called, also by other parts, the functions that are needed, before those that call them.

    And the parts that are given in C.
    """
    made: dict[str, Generated] = {}
    parts: dict[str, Part] = {}

    def make(part: Part, slopes: bool) -> None:
        if parts.setdefault(part.name, part) is not part:
            raise ValueError(f"Two parts have one name, {part.name}; give each part a name of its own.")
        if part.source or _name_of(part, slopes) in made:
            return
        one = _part_function(part, slopes)
        for call in one.calls:
            make(call.part, one.differentiated)
        made[_name_of(part, slopes)] = one

    for one in own:
        for call in one.calls:
            make(call.part, one.differentiated)
    return list(made.values()), [part for part in parts.values() if part.source]


def _calls_of(part: Part) -> str:
    """A part that is given in C, under the names and with the arguments of the generated ones."""
    behind, name = part.results.numel(), PREFIX + part.name
    given = "const double **arg, double **res, long long int *iw, double *w, int mem"
    return f"""
static inline int {_name_of(part, False)}({given}) {{
  {name}(arg[0], arg[1], res[0], 0);
  return 0;
}}
static inline int {_name_of(part, True)}({given}) {{
  {name}(arg[0], arg[1], res[0], res[0] + {behind});
  return 0;
}}
"""


def _part_function(part: Part, slopes: bool) -> Generated:
    """A part's results of its arguments and constants, and with `slopes` the nonzeros of these behind them."""
    results = ca.vertcat(part.results, part.slope.nz[:]) if slopes else part.results
    plain = ca.densify(part.chain.without_waists(results))
    return function_of(part.chain, _name_of(part, slopes), [plain], [part.arguments, part.constants])


def _name_of(part: Part, slopes: bool) -> str:
    return f"part_{part.name}_with_slopes" if slopes else f"part_{part.name}"


def _with_calls(text: str, one: Generated) -> str:
    """The C of a function in which each rank of calls stands behind the last number that it is given.

    CasADi computes results in their order and reads arguments when they are first needed, so nothing that follows from
    a call comes before it.
    """
    found = re.compile(r"return (\w+)\(").search(text, text.index(f"\nint {one.function.name()}("))
    assert found
    begin = text.index("{\n", text.index(f"\nstatic int {found[1]}(")) + 2
    end = text.index("\n}\n", begin)
    body, last = text[begin:end], one.function.n_in() - 1
    body = re.sub(rf"arg\[{last}\]\? arg\[{last}\]\[(\d+)\] : 0", r"left_\1", body)
    body = re.sub(
        r"(?:if \(res\[(\d+)\]!=0\) )res\[\d+\]\[(\d+)\]",
        lambda m: (
            f"given_{m[1]}[{m[2]}]"
            if int(m[1]) < one.ranks
            else f"if (res[{int(m[1]) - one.ranks}]!=0) res[{int(m[1]) - one.ranks}][{m[2]}]"
        ),
        body,
    )
    used = set(re.findall(r"\bleft_\d+\b", body))
    room = [f"  double given_{rank}[{one.function.numel_out(rank)}];" for rank in range(one.ranks)]
    start = 0
    for rank in range(one.ranks):
        lines = [""]
        offset = 0
        for call in one.calls:
            if call.rank != rank:
                continue
            taken, leaves = one.sizes(call)
            when = ""
            if not call.when.is_constant():
                # Cleared before: a call that is left out leaves 0.
                when = (
                    f"for (int i = 0; i < {leaves}; ++i) r[0][i] = 0.0; if (given_{rank}[{offset + taken - 1}] > 0.0) "
                )
            lines.append(
                f"  {{const double *a[] = {{given_{rank} + {offset}, given_{rank} + {offset + call.given.numel()}}}; "
                f"double *r[] = {{left + {start}}}; {when}"
                f"{_name_of(call.part, one.differentiated)}(a, r, 0, 0, 0);}}"
            )
            names = ", ".join(f"left_{n} = left[{n}]" for n in range(start, start + leaves) if f"left_{n}" in used)
            lines.append(f"  const double {names};")
            offset, start = offset + taken, start + leaves
        place = body.rindex(f"given_{rank}[")
        place = body.index(";", place) + 1
        body = body[:place] + "\n".join(lines) + body[place:]
    room.append(f"  double left[{start}];")
    return text[:begin] + "\n".join(room) + "\n" + body + text[end:]


def _without_questions(text: str, kept: set[str]) -> str:
    """CasADi's C with the `kept` functions alone: not those about their arguments and sparsity, which the runtime never
    asks; in plain linkage; and with one meaning in C and C++, which has no __STDC_VERSION__.
    """
    function = r"^(?!static)\w[\w* ]*?(\w+)\([^)]*\) ?\{(?:[^\n]*\}|.*?^\})\n+"
    text = re.sub(function, lambda m: m[0] if m[1] in kept else "", text, flags=re.MULTILINE | re.DOTALL)
    text = re.sub(r"^(static const casadi_int|#define) casadi_s\d+\b.*\n", "", text, flags=re.MULTILINE)
    text = re.sub(r'#ifdef __cplusplus\n.*extern "C".*\n#endif\n', "", text)
    return re.sub(r"/\* Pre-c99 .*\n#if .*\n.*\n#else\n(.*\n)#endif\n", r"\1", text)


def _without_guards(text: str) -> str:
    """The C without the questions whether a caller left out an argument or a result, which neither the runtime nor a
    part does: a branch for each number takes a compiler up to twice as long.
    """
    text = re.sub(r"\barg\[(\d+)\]\? (arg\[\1\]\[\d+\]) : 0", r"\2", text)
    return re.sub(r"\bif \(res\[(\d+)\]!=0\) (?=res\[\1\]\[)", "", text)


def _system_arrays(model: Model, system: System, solving: Elimination) -> Iterable[str]:
    """The constants of a system; what equal wheels have in common, the tables of their profile, is stored once."""
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
    yield c_array("int", f"{prefix}_idle", [str(model.index(name)) for name in without_effect(model, system)])
    yield c_array("double", f"{prefix}_nominal", [c_number(state.nominal) for state in system.states.values()])
    yield c_array("int", f"{prefix}_order", map(str, solving.order))
    yield c_array("int", f"{prefix}_position", map(str, solving.position))
    columns = [column for _, column in solving.nonzeros]
    starts = (bisect_left(columns, column) for column in range(1 + len(solving.order)))
    yield c_array("int", f"{prefix}_column_start", map(str, starts if system.states else ()))
    yield c_array("int", f"{prefix}_row", (str(row) for row, _ in solving.nonzeros))
    yield c_array("int", f"{prefix}_factor", map(str, solving.factor_of_nonzero))
    position = {name: number for number, name in enumerate(system.states)}
    limited = [[position[name] for name in names] for names, _ in system.largest_changes]
    yield c_array("limited_change", f"{prefix}_limited", [f"{{{one[0]}, {[*one, -1][1]}}}" for one in limited])
    algebraic = [number for number, state in enumerate(system.states.values()) if state.algebraic]
    yield c_array("int", f"{prefix}_algebraic", map(str, algebraic))
    inside = _algebraic_nonzeros(system, solving)
    yield c_array("int", f"{prefix}_algebraic_nonzero", map(str, inside))
    where = [tuple(map(algebraic.index, solving.nonzeros[number])) for number in inside]
    yield c_array("int", f"{prefix}_algebraic_place", (str(column * len(algebraic) + row) for row, column in where))
    yield c_array(
        "friction_description",
        f"{prefix}_friction",
        [
            f"{{{c_text(f.label)}, {c_text(f.stuck_word)}, {c_text(f.sliding_word)}, "
            f"{position[f.states[0]]}, {position[f.states[1]] if f.states[1:] else -1}}}"
            for f in system.frictions
        ],
    )
    stored: dict[tuple[bytes, bytes], str] = {}
    entries: list[str] = []
    place = 0
    for table in system.ranked_tables:
        first = place
        place += table.symbols.numel()
        if table.file:
            name = f"{prefix}_{table.name}"
            yield c_array("int", f"{name}_piece", [str(table.file.pieces.index(piece)) for piece in table.pieces])
            entries.append(f"{{0, 0, {table.rank}, {first}, {len(table.pieces)}, {name}_piece, 0, 0}}")
            continue
        content = table.breakpoints.tobytes(), table.coefficients.tobytes()
        if content not in stored:
            stored[content] = name = f"{prefix}_{table.name}"
            yield c_array("double", f"{name}_breakpoint", map(c_number, table.breakpoints))
            yield c_array("double", f"{name}_coefficient", map(c_number, table.coefficients.ravel()))
        pieces, degree, name = table.coefficients.shape[0], table.coefficients.shape[1] - 1, stored[content]
        entries.append(f"{{{pieces}, {degree}, {table.rank}, {first}, 0, 0, {name}_breakpoint, {name}_coefficient}}")
    yield c_array("table_description", f"{prefix}_table", entries)
    ranks = [f"{prefix}_table_argument_{rank}" for rank in range(_table_ranks(system))]
    yield c_array("generated_function", f"{prefix}_table_argument", ranks)
    if system.steady_start:
        yield from _steady_arrays(system, system.steady_start)
    sentences = [c_text(condition.sentence) for condition in (*system.end_conditions, *system.warnings)]
    yield c_array("char *const", f"{prefix}_sentence", sentences)


def _algebraic_nonzeros(system: System, solving: Elimination) -> list[int]:
    """Which nonzeros of the Jacobian are derivatives of residuals by algebraic states."""
    algebraic = [state.algebraic for state in system.states.values()]
    return [number for number, (row, column) in enumerate(solving.nonzeros) if algebraic[row] and algebraic[column]]


def _steady_arrays(system: System, start: SteadyStart) -> Iterable[str]:
    """The description of a steady start, its members by position."""
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
    """A system_description, its members by position: C++ before 2020 knows no other way."""
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
        "table_ranks": _table_ranks(system),
        "table_coefficients": sum(table.symbols.numel() for table in system.tables),
        "limits": len(system.largest_changes),
        "ends": len(system.end_conditions),
        "conditions": len(system.end_conditions) + len(system.warnings),
        "exchanged": int(serves_exchange(model, system)),
        "idles": len(without_effect(model, system)),
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
        "factor": "nonzeros",
        "algebraic": "algebraics",
        "algebraic_nonzero": "algebraic_nonzeros",
        "algebraic_place": "algebraic_nonzeros",
        "limited": "limits",
        "friction": "frictions",
        "table": "tables",
        "sentence": "conditions",
    }
    fields = {"name": c_text(system.name)} | {name: str(count) for name, count in counts.items()}
    fields |= {name: f"{prefix}_{name}" if counts[count] else "0" for name, count in arrays.items()}
    fields |= {name: f"{prefix}_{name}" if name in made else "0" for name in FUNCTIONS}
    fields |= {name: f"{prefix}_{name}" for name in ("factorise", "substitute")}
    fields["steady"] = f"&{prefix}_steady_start" if system.steady_start else "0"
    fields["table_argument"] = f"{prefix}_table_argument" if counts["tables"] else "0"
    return "    {" + ",\n     ".join(f"/* {name} */ {value}" for name, value in fields.items()) + "}"


def _description(model: Model, generated: Sequence[dict[str, Generated]], solving: Mapping[str, Elimination]) -> str:
    lines = ["#include <math.h>", '#include "model.h"', ""]
    for made in generated:
        for one in made.values():
            lines.append(
                f"RUNTIME_LOCAL int {one.function.name()}(const double **, double **, long long int *, double *, int);"
            )
    for system in model.systems:
        lines.append(f"RUNTIME_LOCAL void {system.name}_factorise(double *);")
        lines.append(f"RUNTIME_LOCAL void {system.name}_substitute(const double *, double *);")
        lines += [line for line in _system_arrays(model, system, solving[system.name]) if line]
    if model.table_file:
        lines.append(table_file_source(model.table_file, model.index(model.table_file.variable.name)))
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
    exchange = exchanged(model)
    integrated = model.systems.index(exchange) if exchange else -1
    integration = ", ".join(str(model.index(variable.name)) for variable in integration_variables(1e-6))
    lines += [
        "};",
        f"RUNTIME_LOCAL const model_description MODEL = {{{c_text(model.name)}, {c_text('@GUID@')}, "
        f"{len(model.variables)}, {len(model.systems)}, {len(chosen_by)}, {selectors}, CHOICE, "
        f"{integrated}, {integration}, VARIABLE, SYSTEM, {table_file}}};",
        "",
    ]
    return "\n".join(lines)

"""C of functions by the instructions of CasADi: a statement for each, equal ones once, and calls of parts between."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate, count

import casadi as ca

from fmu_src.chain import Part
from fmu_src.equations import Generated, part_function, part_name
from fmu_src.own_names import PREFIX, with_own_names

#: A function with more statements than WHOLE is cut into pieces of LONGEST: the coach's FMU takes 25 s to compile, with
#: pieces of 3000 statements 31 s. With pieces of 700 it takes 24 s, and steps of 1 ms are 6 % slower.
WHOLE, LONGEST = 4500, 1500

_CALLED = (
    *("exp", "log", "expm1", "log1p", "sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh"),
    *("asinh", "acosh", "atanh", "floor", "ceil", "fabs", "erf"),
)
_CALLED_WITH_TWO = ("pow", "atan2", "fmod", "remainder", "copysign", "hypot")
#: C of each operation. Minima and maxima are not fmin and fmax, which take the other number in place of NaN and are
#: therefore calls; here NaN in the second place stays.
OPERATIONS: Mapping[int, str] = {
    **{getattr(ca, f"OP_{name.upper()}"): f"{name}({{}})" for name in _CALLED},
    **{getattr(ca, f"OP_{name.upper()}"): f"{name}({{}}, {{}})" for name in _CALLED_WITH_TWO},
    ca.OP_CONSTPOW: "pow({}, {})",
    ca.OP_ADD: "{} + {}",
    ca.OP_SUB: "{} - {}",
    ca.OP_MUL: "{} * {}",
    ca.OP_DIV: "{} / {}",
    ca.OP_NEG: "-{}",
    ca.OP_SQ: "{0} * {0}",
    ca.OP_TWICE: "2.0 * {}",
    ca.OP_INV: "1.0 / {}",
    ca.OP_LT: "{} < {}",
    ca.OP_LE: "{} <= {}",
    ca.OP_EQ: "{} == {}",
    ca.OP_NE: "{} != {}",
    ca.OP_NOT: "!{}",
    ca.OP_AND: "{} && {}",
    ca.OP_OR: "{} || {}",
    ca.OP_FMIN: "{0} < {1} ? {0} : {1}",
    ca.OP_FMAX: "{0} > {1} ? {0} : {1}",
    ca.OP_SIGN: "{0} < 0 ? -1 : {0} > 0 ? 1 : {0}",
    ca.OP_IF_ELSE_ZERO: "{} ? {} : 0",
}
_UNCHANGED = (ca.OP_ASSIGN, ca.OP_LIFT)


@dataclass(frozen=True)
class Face:
    """How a function is declared and how its pieces are given what it is given; C of its inputs and results."""

    head: str
    parameters: str
    given: str
    inputs: Sequence[str]
    results: Sequence[str]
    end: str = ""


@dataclass(frozen=True)
class Statement:
    """C that reads its operands, numbers of values or C of constants, in the braces of `form`.

    value: the number of the value that the form gives; None: it gives none.
    """

    form: str
    operands: tuple[int | str, ...] = ()
    value: int | None = None

    @property
    def reads(self) -> list[int]:
        """Numbers of the values that it reads."""
        return [operand for operand in self.operands if isinstance(operand, int)]

    def text(self, names: Mapping[int, str]) -> str:
        """The statement, or what stands on the right of it, with the names of values."""
        return self.form.format(*(names[one] if isinstance(one, int) else one for one in self.operands)) + ";"


def equations_in_c(name: str, made: Mapping[str, Generated]) -> str:
    """C of all functions, those of the parts before those that call them.

    `name` begins the names of what is seen in this file alone, so that files of several systems may become one unit.
    Raises ValueError where two parts have one name and where there is no C for an operation.
    """
    own = list(made.values())
    inside, in_c = _functions_of_parts(own)
    common = list(dict.fromkeys(part.common for part in in_c))
    given = with_own_names([*common, *(part.source for part in in_c)])
    # The runtime gives all generated functions some arguments that none needs; everything else stays a warning.
    head = ['#pragma GCC diagnostic ignored "-Wunused-parameter"', "#include <math.h>", '#include "model.h"']
    functions = [_function(name, one, _face_of_part(name, one)) for one in inside]
    functions += [_function(name, one, _face(one)) for one in own]
    return "\n".join([*head, *map(_once, given), *functions, ""])


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
        if part.source or part_name(part, slopes) in made:
            return
        one = part_function(part, slopes)
        for call in one.calls:
            make(call.part, one.differentiated)
        made[part_name(part, slopes)] = one

    for one in own:
        for call in one.calls:
            make(call.part, one.differentiated)
    return list(made.values()), [part for part in parts.values() if part.source]


def _face(one: Generated) -> Face:
    """As the runtime calls it, `generated_function` in model.h."""
    parameters, name = "const double **arg, double **res", one.function.name()
    inputs = [f"arg[{number}]" for number in range(one.function.n_in())]
    results = [f"res[{number}]" for number in range(one.function.n_out() - one.ranks)]
    head = f"RUNTIME_LOCAL int {name}({parameters}, long long int *iw, double *w, int mem)"
    return Face(head, parameters, "arg, res", inputs, results, "  return 0;\n")


def _face_of_part(name: str, one: Generated) -> Face:
    """As `_calls` calls it."""
    parameters = "const double *arguments, const double *constants, double *results"
    head = f"static void {name}_{one.function.name()}({parameters})"
    return Face(head, parameters, "arguments, constants, results", ["arguments", "constants"], ["results"])


def _function(name: str, one: Generated, face: Face) -> str:
    """C of a function; what is long, in pieces that have in `kept` what they leave to each other."""
    bodies, kept = _bodies(_statements(name, one, face))
    rooms = {"kept": kept} | {f"given_{rank}": one.function.numel_out(rank) for rank in range(one.ranks)}
    rooms |= {"left": sum(one.sizes(call)[1] for call in one.calls)}
    rooms = {room: size for room, size in rooms.items() if size}
    room = "".join(f"  double {room}[{size}];\n" for room, size in rooms.items())
    if len(bodies) == 1:
        return f"{face.head} {{\n{room}{bodies[0]}{face.end}}}\n"
    piece = f"{name}_piece_of_{one.function.name()}"
    parameters = ", ".join([face.parameters, *(f"double *{room}" for room in rooms)])
    pieces = "".join(f"static void {piece}_{n}({parameters}) {{\n{body}}}\n" for n, body in enumerate(bodies))
    given = ", ".join([face.given, *rooms])
    calls = "".join(f"  {piece}_{n}({given});\n" for n in range(len(bodies)))
    return f"{pieces}{face.head} {{\n{room}{calls}{face.end}}}\n"


def _statements(name: str, one: Generated, face: Face) -> list[Statement]:
    """The instructions in their order, equal ones once, and behind the last number that calls are given, the calls.

    CasADi computes results in their order and reads inputs when they are first needed, so nothing that follows from
    a call comes before it.
    """
    function, made = one.function, list[Statement]()
    inputs = [*face.inputs[: function.n_in() - 1], "left"] if one.calls else face.inputs
    results = [*(f"given_{rank}" for rank in range(one.ranks)), *face.results]
    missing = [function.numel_out(number) for number in range(function.n_out())]
    known: dict[tuple[str, tuple[int | str, ...]], int] = {}
    in_place: dict[int, int | str] = {}  # the value, or C of the constant, at each place of CasADi's work vector
    for number in range(function.n_instructions()):
        operation, source = function.instruction_id(number), function.instruction_input(number)
        target = function.instruction_output(number)
        if operation == ca.OP_OUTPUT:
            result, place = target
            made.append(Statement(f"{results[result]}[{place}] = {{}}", (in_place[source[0]],)))
            missing[result] -= 1
            if result < one.ranks and not missing[result]:
                made += _calls(name, one, result)
        elif operation == ca.OP_CONST:
            in_place[target[0]] = _constant(function.instruction_constant(number))
        elif operation in _UNCHANGED:
            in_place[target[0]] = in_place[source[0]]
        else:
            if operation == ca.OP_INPUT:
                form, operands = f"{inputs[source[0]]}[{source[1]}]", list[int | str]()
            else:
                form, operands = _form(function, operation), [in_place[place] for place in source]
            key = form, tuple(operands)
            if key not in known:
                known[key] = len(known)
                made.append(Statement(*key, known[key]))
            in_place[target[0]] = known[key]
    return made


def _form(function: ca.Function, operation: int) -> str:
    if operation not in OPERATIONS:
        raise ValueError(
            f"{function.name()} has the operation {operation} of CasADi, which is none of those that are written in C "
            "(OPERATIONS in fmu_src/equations_in_c.py); write the equation with these."
        )
    return OPERATIONS[operation]


def _constant(value: float) -> str:
    """C of a number, one that stays a number behind any sign."""
    if math.isnan(value):
        return "NAN"
    text = "INFINITY" if math.isinf(value) else repr(abs(value))
    return f"(-{text})" if math.copysign(1.0, value) < 0 else text


def _calls(name: str, one: Generated, rank: int) -> list[Statement]:
    """The calls of a rank: what they are given is in `given_RANK`, what they leave in `left`."""
    ends = accumulate((one.sizes(call)[1] for call in one.calls), initial=0)
    made, offset = [], 0
    for call, start in zip(one.calls, ends, strict=False):
        if call.rank != rank:
            continue
        taken, leaves = one.sizes(call)
        when = ""
        if not call.when.is_constant():
            # Cleared before: a call that is left out leaves 0.
            when = f"for (int i = {start}; i < {start + leaves}; ++i) left[i] = 0.0;\n  "
            when += f"if (given_{rank}[{offset + taken - 1}] > 0.0) "
        vectors = f"given_{rank} + {offset}, given_{rank} + {offset + call.given.numel()}, left + {start}"
        if call.part.source:
            slopes = f"left + {start + call.symbols.numel()}" if one.differentiated else "0"
            made.append(Statement(f"{when}{PREFIX}{call.part.name}({vectors}, {slopes})"))
        else:
            made.append(Statement(f"{when}{name}_{part_name(call.part, one.differentiated)}({vectors})"))
        offset += taken
    return made


def _locals(statements: Sequence[Statement]) -> dict[int, str]:
    """A local for each value; one whose value is no longer read is used again."""
    last = {value: number for number, one in enumerate(statements) for value in one.reads}
    names: dict[int, str] = {}
    free: list[str] = []
    new = (f"a{number}" for number in count())
    for number, one in enumerate(statements):
        free += [names[value] for value in dict.fromkeys(one.reads) if last[value] == number]
        if one.value is not None:
            names[one.value] = free.pop() if free else next(new)
    return names


def _bodies(statements: Sequence[Statement]) -> tuple[list[str], int]:
    """C of the statements as a whole or in pieces, and how many numbers the pieces leave to those behind them.

    A number that is left is kept as soon as it is known, and taken where it is first needed: a processor has few
    registers, and a compiler takes 1.6 times as long to distribute them if all are taken at the beginning.
    """
    longest = LONGEST if len(statements) > WHOLE else WHOLE
    pieces = [statements[start : start + longest] for start in range(0, len(statements), longest)]
    born = {one.value: n for n, piece in enumerate(pieces) for one in piece}
    left = {value for n, piece in enumerate(pieces) for one in piece for value in one.reads if born[value] < n}
    names = _locals(statements)
    places = {
        name: f"kept[{number}]" for number, name in enumerate(dict.fromkeys(names[value] for value in sorted(left)))
    }
    bodies = []
    for n, piece in enumerate(pieces):
        read = {value for one in piece for value in one.reads}
        taken = {value for value in read if born[value] < n}
        lines = [f"double {', '.join(sorted({names[value] for value in read}))};"] if read else []
        for one in piece:
            lines += [f"{names[value]} = {places[names[value]]};" for value in one.reads if value in taken]
            taken.difference_update(one.reads)
            targets = [names[one.value]] if one.value in read else []
            targets += [places[names[one.value]]] if one.value in left else []
            lines.append(" = ".join([*targets, one.text(names)]))
        bodies.append("".join(f"  {line}\n" for line in lines))
    return bodies, len(places)

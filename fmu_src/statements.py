"""C of CasADi's instructions of a function: statements on a `real`, of one number or of several (lanes.h)."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property

from fmu_src.symbols import ca

_CALLED = (
    *("exp", "log", "expm1", "log1p", "sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh"),
    *("asinh", "acosh", "atanh", "floor", "ceil", "fabs", "erf"),
)
_CALLED_WITH_TWO = ("pow", "atan2", "fmod", "remainder", "copysign", "hypot")
#: C of each operation, by CasADi's name without OP_. Minima and maxima return the second number if one is NaN.
OPERATIONS: Mapping[str, str] = {
    **{name.upper(): f"real_{name}({{}})" for name in _CALLED},
    **{name.upper(): f"real_{name}({{}}, {{}})" for name in _CALLED_WITH_TWO},
    "CONSTPOW": "real_pow({}, {})",
    "ADD": "{} + {}",
    "SUB": "{} - {}",
    "MUL": "{} * {}",
    "DIV": "{} / {}",
    "NEG": "-{}",
    "SQ": "{0} * {0}",
    "TWICE": "{0} + {0}",
    "INV": "real_of(1.0) / {}",
    "LT": "{} < {}",
    "LE": "{} <= {}",
    "EQ": "{} == {}",
    "NE": "{} != {}",
    "NOT": "real_not({})",
    "AND": "{} & {}",
    "OR": "{} | {}",
    "FMIN": "real_select({0} < {1}, {0}, {1})",
    "FMAX": "real_select({0} > {1}, {0}, {1})",
    "SIGN": "real_select({0} < 0.0, real_of(-1.0), real_select({0} > 0.0, real_of(1.0), {0}))",
    "IF_ELSE_ZERO": "real_where({}, {})",
}
#: Operations whose result is a mask, and those that take one, with how many.
_MASKS = {"LT", "LE", "EQ", "NE", "NOT", "AND", "OR"}
_TAKES_MASKS = {"NOT": 1, "AND": 2, "OR": 2, "IF_ELSE_ZERO": 1}
#: Powers that are made of a third root, and how.
_THIRD = "real_of(0.3333333333333333)"
_OF_THIRD_ROOT = {
    _THIRD: "{}",
    "real_of(0.6666666666666666)": "{0} * {0}",
    "real_of(-0.6666666666666667)": "real_of(1.0) / ({0} * {0})",
}


@cache
def _names() -> Mapping[int, str]:
    """Return the names of the operations that are written in C, by CasADi's numbers."""
    return {getattr(ca, f"OP_{name}"): name for name in OPERATIONS}


@dataclass(frozen=True)
class Statement:
    """C that reads its operands, numbers of values or C of constants, in the braces of `form`.

    values: numbers of the values that the form gives. written: it writes them itself, in the braces after those of the
    operands; otherwise it is an expression. mask: whether its value is a mask.
    """

    form: str
    operands: tuple[int | str, ...] = ()
    values: tuple[int, ...] = ()
    written: bool = False
    mask: bool = False

    @cached_property
    def reads(self) -> tuple[int, ...]:
        """Return the numbers of the values that it reads."""
        return tuple(operand for operand in self.operands if isinstance(operand, int))

    def text(self, names: Mapping[int, str]) -> str:
        """Return the statement, with the names of values."""
        targets = [names[value] for value in self.values]
        text = self.form.format(
            *(names[operand] if isinstance(operand, int) else operand for operand in self.operands),
            *(targets if self.written else ()),
        )
        return f"{text};" if self.written or not targets else f"{targets[0]} = {text};"


@dataclass
class Values:
    """The statements until now, and the value of each expression: equal ones are computed once."""

    made: list[Statement] = field(default_factory=list)
    known: dict[tuple[str, tuple[int | str, ...]], int] = field(default_factory=dict)
    masks: set[int] = field(default_factory=set)

    def of(self, form: str, operands: Sequence[int | str] = (), mask: bool = False) -> int:
        """Return the value that the form gives."""
        key = form, tuple(operands)
        if key not in self.known:
            self.known[key] = len(self.known)
            self.made.append(Statement(*key, (self.known[key],), mask=mask))
            if mask:
                self.masks.add(self.known[key])
        return self.known[key]

    def as_mask(self, one: int | str) -> int:
        """Return a number as a mask, true if it is not 0."""
        return one if one in self.masks and isinstance(one, int) else self.of("real_is({})", (one,), mask=True)

    def as_number(self, one: int | str) -> int | str:
        """Return a mask as a number, 1 if it is true."""
        return self.of("real_of_mask({})", (one,)) if one in self.masks else one


@dataclass(frozen=True)
class Memory:
    """C of a number that is read and of one that is written: of an input or a result by its number, at a place."""

    read: Callable[[int, int], str]
    write: Callable[[int, int], list[str]]  # forms with the value in their braces


def statements_of(
    function: ca.Function, memory: Memory, behind: Callable[[int], Sequence[Statement]] | None = None
) -> list[Statement]:
    """Return the instructions of a function in their order.

    `behind`: statements that follow the last number of a result, by its number. CasADi computes results in their order
    and reads inputs when they are first needed, so nothing that follows from them comes before. If several divisions
    have one divisor, they multiply with its reciprocal, with every compiler, so that all results are bit-identical.
    """
    values, shared = Values(), _divisors(function)
    missing = [function.numel_out(number) for number in range(function.n_out())]
    in_place: dict[int, int | str] = {}  # the value, or C of the constant, at each place of CasADi's work vector
    for number in range(function.n_instructions()):
        operation, source = function.instruction_id(number), function.instruction_input(number)
        target = function.instruction_output(number)
        if operation == ca.OP_OUTPUT:
            result, place = target
            written = values.as_number(in_place[source[0]])
            values.made += [Statement(form, (written,)) for form in memory.write(result, place)]
            missing[result] -= 1
            if behind and not missing[result]:
                values.made += behind(result)
        elif operation == ca.OP_CONST:
            in_place[target[0]] = constant(function.instruction_constant(number))
        elif operation in (ca.OP_ASSIGN, ca.OP_LIFT):
            in_place[target[0]] = in_place[source[0]]
        elif operation == ca.OP_INPUT:
            in_place[target[0]] = values.of(memory.read(*source[:2]))
        else:
            operands = [in_place[place] for place in source]
            in_place[target[0]] = _computed(function, operation, operands, values, number in shared)
    return _with_sines_beside_cosines(values.made)


def called(name: str) -> str:
    """Return the form of a function of one number."""
    return f"real_{name}({{}})"


#: Sine and cosine of an angle, which cost little more than one of them.
SIN_COS = "real_sin_cos({0}, &{1}, &{2})"


def _with_sines_beside_cosines(statements: Sequence[Statement]) -> list[Statement]:
    """Compute sine and cosine of one angle by one statement, at the place of the first of them."""
    forms = called("sin"), called("cos")
    found: dict[tuple[int | str, ...], dict[str, int]] = {}
    for one in statements:
        if one.form in forms:
            found.setdefault(one.operands, {})[one.form] = one.values[0]
    made, done = list[Statement](), set[tuple[int | str, ...]]()
    for one in statements:
        both = found[one.operands] if one.form in forms else {}
        if len(both) < len(forms):
            made.append(one)
        elif one.operands not in done:
            made.append(Statement(SIN_COS, one.operands, (both[forms[0]], both[forms[1]]), written=True))
            done.add(one.operands)
    return made


def _computed(
    function: ca.Function, operation: int, operands: Sequence[int | str], values: Values, shared: bool
) -> int:
    name = _names().get(operation, "")
    if not name:
        raise ValueError(
            f"{function.name()} has the operation {operation} of CasADi, which is none of those that are written in C "
            "(OPERATIONS in fmu_src/statements.py); write the equation with these."
        )
    masks = _TAKES_MASKS.get(name, 0)
    taken = [values.as_mask(operand) if n < masks else values.as_number(operand) for n, operand in enumerate(operands)]
    if name == "CONSTPOW" and operands[1] in _OF_THIRD_ROOT:
        root = values.of("real_cbrt({})", taken[:1])
        return root if operands[1] == _THIRD else values.of(_OF_THIRD_ROOT[operands[1]], (root,))
    if name == "DIV" and shared:
        inverse = values.of(OPERATIONS["INV"], taken[1:])
        return values.of(OPERATIONS["MUL"], [taken[0], inverse])
    return values.of(OPERATIONS[name], taken, name in _MASKS)


def _divisors(function: ca.Function) -> set[int]:
    """Return the instructions that divide by a constant, or by a divisor that others use too."""
    written: dict[int, int] = {}  # which instruction wrote each place of the work vector last
    divide: dict[int, list[int]] = {}
    for number in range(function.n_instructions()):
        operation, source = function.instruction_id(number), function.instruction_input(number)
        if operation in (ca.OP_DIV, ca.OP_INV):
            divide.setdefault(written[source[-1]], []).append(number)
        if operation != ca.OP_OUTPUT:
            written[function.instruction_output(number)[0]] = number
    constants = {by for by in divide if function.instruction_id(by) == ca.OP_CONST}
    return {number for by, some in divide.items() if len(some) > 1 or by in constants for number in some}


def constant(value: float) -> str:
    """Return C of a number that remains a number after any sign."""
    if math.isnan(value):
        return "real_of(NAN)"
    text = "INFINITY" if math.isinf(value) else repr(abs(value))
    return f"real_of({'-' if math.copysign(1.0, value) < 0 else ''}{text})"

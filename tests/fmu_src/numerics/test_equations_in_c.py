"""C code of equations: values of CasADi, common subexpressions, and long functions in pieces."""

from __future__ import annotations

import ctypes
import math
import re
from collections.abc import Sequence
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from fmu_src import compile as compiling
from fmu_src import equations_in_c as printing
from fmu_src.chain import Chain, Part
from fmu_src.equations import Generated, function_of
from fmu_src.statements import OPERATIONS

#: Differences of two mathematical libraries, and of 1 / x instead of a division.
ROUND_OFF = 1e-14


def generated(expressions: list[ca.SX], given: ca.SX, chain: Chain | None = None) -> Generated:
    return function_of(chain or Chain(), "law", [ca.vertcat(*expressions)], [given])


def values(one: Generated, at: list[float], folder: Path, lanes: int = 1, more: Sequence[str] = ()) -> list[float]:
    """Return the results of the compiled C; lanes: lanes of the processor; more: compiler flags."""
    own = folder / f"law{len(list(folder.iterdir()))}"
    own.mkdir()
    files = printing.equations_in_c("x", {"law": one})
    for name, text in files.items():
        (own / name).write_text(text)
    flags = [flag for flag in compiling.FLAGS if flag != "-fvisibility=hidden"]
    units = [name for name in files if name.endswith(".c")]
    command = [*flags, *more, "-O1", f"-I{compiling.RUNTIME}", "-shared", "-o", "law", *units, "-lm"]
    compiling.run(command, None, own)
    given, found = (ctypes.c_double * len(at))(*at), (ctypes.c_double * one.function.numel_out(one.ranks))()
    array = ctypes.POINTER(ctypes.c_double) * 1
    ctypes.CDLL(str(own / "law")).law(array(given), array(found), None, None, lanes)
    return list(found)


def widest(folder: Path) -> int:
    """Return the number of lanes of this processor."""
    if not (folder / "widest").exists():
        (folder / "widest.c").write_text(
            '#include "lanes_widest.h"\nint widest(void) { return lanes_of_processor(); }\n'
        )
        compiling.run(["-fPIC", f"-I{compiling.RUNTIME}", "-shared", "-o", "widest", "widest.c"], None, folder)
    return int(ctypes.CDLL(str(folder / "widest")).widest())


def of_every_operation(x: ca.SX, y: ca.SX) -> list[ca.SX]:
    """Return an expression for each operation; x is between 1 and 2, y between 0 and 1."""
    made = [getattr(ca, name)(y) for name in ("exp", "log", "sqrt", "sin", "cos", "tan", "asin", "acos", "atan")]
    made += [getattr(ca, name)(y) for name in ("sinh", "cosh", "tanh", "asinh", "atanh", "erf", "expm1", "log1p")]
    made += [ca.acosh(x), ca.floor(-x), ca.ceil(y), ca.fabs(-x), ca.sign(y - x), ca.sign(0 * x), ca.sign(x)]
    made += [x + y, x - y, x * y, x / y, -x, x**2, 2 * x, 1 / x, x**y, x**3.5, ca.if_else(x < y, 1, y)]
    made += [x < y, x <= y, y <= x, x == y, x != y, ca.logic_and(x - 1.5, y), ca.logic_or(x, y), ca.logic_not(x - 1.5)]
    made += [ca.fmin(x, y), ca.fmax(x, y), ca.if_else(x > y, x, -y), ca.atan2(x, y), ca.fmod(x, y)]
    return [*made, ca.copysign(x, -y), ca.hypot(x, y), ca.remainder(x, y)]


def test_every_operation_has_the_values_of_casadi(tmp_path: Path) -> None:
    given = ca.SX.sym("given", 2)
    one = generated(of_every_operation(given[0], given[1]), given)
    instructions = range(one.function.n_instructions())
    written = {one.function.instruction_id(number) for number in instructions}
    assert {name for name in OPERATIONS if getattr(ca, f"OP_{name}") not in written} == set()
    for at in ([1.7, 0.3], [1.5, 0.9]):
        found, expected = values(one, at, tmp_path), one.function(at).full().ravel()
        assert found == pytest.approx(expected, rel=ROUND_OFF, abs=0.0)


#: Places of the calls below, more than there are lanes; each pair is valid for `of_every_operation`.
PLACES = [
    (1.7, 0.3),
    (1.5, 0.9),
    (1.1, 0.05),
    (1.9, 0.5),
    (1.25, 0.75),
    (1.5, 0.25),
    (1.01, 0.99),
    (1.6, 0.6),
    (1.3, 0.1),
]


@pytest.mark.study
@pytest.mark.parametrize("count", [1, 2, 3, 9])
@pytest.mark.parametrize("inner", [False, True], ids=["called", "called by a part"])
def test_every_operation_has_the_values_of_casadi_in_lanes(tmp_path: Path, count: int, inner: bool) -> None:
    """A part is called at several places: in any number of lanes, and with only one lane compiled."""
    given, own, chain, outer = ca.SX.sym("given", 2 * count), ca.SX.sym("own", 2), Chain(), Chain()
    part = Part("every", own, ca.SX.sym("none", 0), ca.vertcat(*of_every_operation(*ca.vertsplit(own))))
    if inner:
        part = Part("outer", own, ca.SX.sym("none", 0), outer.call(part, own, ca.SX(0, 1)), outer)
    places = PLACES[:count]
    one = generated([chain.call(part, pair, ca.SX(0, 1)) for pair in ca.vertsplit(given, 2)], given, chain)
    at = [number for place in places for number in place]
    expected = np.concatenate([part.function(place, [])[0].full().ravel() for place in places])
    scalar = values(one, at, tmp_path, more=["-DLANES_WIDEST=1"])
    assert scalar == pytest.approx(expected, rel=ROUND_OFF, abs=0.0)
    for lanes in (2, 4, 8):
        if lanes <= widest(tmp_path):
            assert values(one, at, tmp_path, lanes) == scalar


@pytest.mark.study
@pytest.mark.parametrize("conditions", [(1.0, 0.0, 1.0), (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), (-1.0, math.nan, 1.0)])
def test_lanes_that_are_not_asked_for_leave_0(tmp_path: Path, conditions: tuple[float, ...]) -> None:
    given, own, chain = ca.SX.sym("given", 6), ca.SX.sym("own"), Chain()
    part = Part("half", own, ca.SX.sym("none", 0), ca.vertcat(own / 2, 1 + own))
    calls = [chain.call(part, given[n], ca.SX(0, 1), given[3 + n]) for n in range(3)]
    one, at = generated(calls, given, chain), [2.0, 4.0, 6.0, *conditions]
    pairs = zip([(1.0, 3.0), (2.0, 5.0), (3.0, 7.0)], conditions, strict=True)
    expected = [number for pair, condition in pairs for number in (pair if condition > 0 else (0.0, 0.0))]
    assert values(one, at, tmp_path, more=["-DLANES_WIDEST=1"]) == expected
    for lanes in (2, 4, 8):
        if lanes <= widest(tmp_path):
            assert values(one, at, tmp_path, lanes) == expected


def test_minima_and_maxima_keep_nan_in_the_second_place(tmp_path: Path) -> None:
    given = ca.SX.sym("given", 2)
    one = generated([ca.fmin(given[0], given[1]), ca.fmax(given[0], given[1]), ca.fmin(given[1], given[0])], given)
    found = values(one, [1.0, math.nan], tmp_path)
    assert [math.isnan(number) for number in found] == [True, True, False]


def test_constants_keep_sign_and_last_digit(tmp_path: Path) -> None:
    given, constants = ca.SX.sym("given"), [-0.1, 1e-300, -1e22, math.inf, -math.inf, 3.0]
    found = values(generated([ca.SX(one) for one in constants], given), [0.0], tmp_path)
    assert found == constants
    assert math.isnan(values(generated([ca.SX(math.nan), given - -0.5], given), [0.0], tmp_path)[0])


def test_equal_expressions_are_computed_once() -> None:
    """CasADi makes two expressions of an expression that is written twice."""
    x = ca.SX.sym("x", 3)
    one = generated([ca.sin(x[0] * x[1]) + x[2], ca.sin(x[0] * x[1]) - x[2]], x)
    [text] = printing.equations_in_c("x", {"law": one}).values()
    assert text.count("sin(") == 1


def test_an_operation_without_c_is_refused() -> None:
    x = ca.SX.sym("x")
    with pytest.raises(ValueError, match=r"law has the operation 86 of CasADi, which is none"):
        printing.equations_in_c("x", {"law": generated([ca.erfinv(x)], x)})


#: Number of steps. Each step uses the previous value and a value from far before.
COUNT = 60


def long_function() -> Generated:
    """Return a function with a part in the middle; one of its two results is used at the end."""
    given, way = ca.SX.sym("given", 2), ca.SX.sym("way")
    part = Part("spring", way, ca.SX.sym("none", 0), ca.vertcat(ca.sin(way), 0.3 * way))
    chain, first = Chain(), ca.exp(given[0])
    number = first
    for n in range(COUNT):
        number = first / (number + n) + given[1]
    left = chain.call(part, number, ca.SX(0, 1))
    for n in range(COUNT):
        number = (number + n) * left[0] * first
    return generated([number, number * left[1]], given, chain)


def test_a_function_in_pieces_gives_the_numbers_of_the_whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    one = long_function()
    whole = printing.equations_in_c("x", {"law": one})["equations_x.c"]
    found = values(one, [0.7, 0.2], tmp_path)
    monkeypatch.setattr(printing, "WHOLE", 7)
    monkeypatch.setattr(printing, "LONGEST", 7)
    divided = printing.equations_in_c("x", {"law": one})["equations_x.c"]
    assert "_piece_" not in whole
    assert len(re.findall(r"static void x_piece_\d+_of_law\(", divided)) > 6 * COUNT / 7
    assert values(one, [0.7, 0.2], tmp_path) == found

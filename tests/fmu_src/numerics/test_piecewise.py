"""Table look-ups (fmu_src/runtime/lanes_table.h) find the same piece as NumPy's search, in any number of lanes."""

from __future__ import annotations

import ctypes
from functools import lru_cache
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from numpy.polynomial.polynomial import polyval

from fmu_src import compile as compiling
from fmu_src.chain import Chain
from fmu_src.codegen import RUNTIME
from fmu_src.piecewise import interpolation, look_up, polynomials, rows_of
from fmu_src.unique_names_in_c import PREFIX, with_own_names

WIDTHS = (1, 2, 4, 8)
ROUND_OFF = 1e-14
#: Breakpoints with pieces of equal width, of equal width except for rounding errors, of any width, and a single piece.
BREAKPOINTS = {
    "equal": np.arange(-3.0, 5.0, 0.5),
    "nearly equal": 0.1 * np.arange(12) - 0.3,
    "unequal": np.array([-3.0, -2.5, -2.4, 0.0, 1e-3, 7.0]),
    "one piece": np.array([1.0, 2.0]),
}
AT = ca.SX.sym("at")


def coefficients(name: str, terms: int = 3) -> np.ndarray:
    """Return coefficients of discontinuous pieces, so that the test detects a neighbouring piece."""
    return np.random.default_rng(len(name)).uniform(1.0, 2.0, (BREAKPOINTS[name].size - 1, terms))


def by_numpy(name: str, at: np.ndarray) -> np.ndarray:
    """Return rows of origin and coefficients of the piece that begins next below; outside, those of the end value."""
    breakpoints, of = BREAKPOINTS[name], coefficients(name)
    piece = np.clip(np.searchsorted(breakpoints, at, "right") - 1, 0, len(of) - 1)
    found = np.column_stack([breakpoints[piece], of[piece]])
    found[at < breakpoints[0]] = [breakpoints[0], of[0, 0], 0.0, 0.0]
    end = polyval(breakpoints[-1] - breakpoints[-2], of[-1])
    found[at >= breakpoints[-1]] = [breakpoints[-1], end, 0.0, 0.0]
    return found


def places(name: str) -> np.ndarray:
    """Return places inside, at and next to breakpoints, and far outside, in random order."""
    breakpoints = BREAKPOINTS[name]
    inside = np.random.default_rng(3).uniform(breakpoints[0] - 1, breakpoints[-1] + 1, 400)
    # If pieces are found by a division, both neighbours are correct within rounding errors of a breakpoint.
    beside = [] if name == "nearly equal" else [breakpoints]
    if name == "unequal":
        beside += [np.nextafter(breakpoints, -9), np.nextafter(breakpoints, 9)]
    return np.random.default_rng(4).permutation(np.concatenate([inside, *beside, [-1e300, 1e300, -np.inf, np.inf]]))


@lru_cache
def library(folder: Path) -> ctypes.CDLL:
    """Compile functions for each table at each width: NAME_WIDTH(count, places, rows by LANES)."""
    text = '#include "lanes_widest.h"\n#include "model.h"\n#include "piecewise.h"\n#include <math.h>\n'
    text += '#define SHOWN __attribute__((visibility("default")))\n'
    text += "SHOWN int widest(void) { return lanes_of_processor(); }\n"
    names = {}
    for name in BREAKPOINTS:
        chain = Chain()
        look_up(chain, name, BREAKPOINTS[name], coefficients(name), AT)
        part = chain.calls[0].part
        names[name] = f"{PREFIX}{part.name}"
        text += (
            with_own_names([part.source])[0] + f"SHOWN int equal_{len(names)}(void) {{ return {names[name]}.equal; }}\n"
        )
    for width in WIDTHS:
        text += f'#if LANES_WIDEST >= {width}\n#define LANES {width}\n#include "lanes.h"\n'
        for number, table in enumerate(names.values(), 1):
            loop = f"for (int i = 0; i < n; i += LANES) real_look_up(&{table}, at + i, row + 4 * i); LANES_LEAVE;"
            head = f"SHOWN void LANES_NAME(table_{number})(int n, const double *at, double *row)"
            text += f"{head} {{ {loop} }}\n"
        text += '#include "lanes_end.h"\n#endif\n'
    (folder / "tables.c").write_text(text)
    flags = [*compiling.FLAGS, "-O1", f"-I{RUNTIME}", "-shared"]
    compiling.run([*flags, "-o", "tables", "tables.c", "-lm"], None, folder)
    return ctypes.CDLL(str(folder / "tables"))


@pytest.fixture(scope="module")
def tables(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    return library(tmp_path_factory.mktemp("tables"))


def found(tables: ctypes.CDLL, name: str, width: int, at: np.ndarray) -> np.ndarray:
    """Return the rows at places, looked up in lanes."""
    padded = np.concatenate([at, np.zeros(-at.size % width)])
    rows = np.empty((padded.size // width, 4, width))
    pointers = [array.ctypes.data_as(ctypes.POINTER(ctypes.c_double)) for array in (padded, rows)]
    number = 1 + list(BREAKPOINTS).index(name)
    getattr(tables, f"table_{number}_{width}")(padded.size, *pointers)
    return rows.transpose(0, 2, 1).reshape(-1, 4)[: at.size]


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("name", BREAKPOINTS)
def test_a_look_up_finds_the_piece_of_numpys_search(tables: ctypes.CDLL, name: str, width: int) -> None:
    if width > tables.widest():
        pytest.skip("this processor has fewer lanes")
    at = places(name)
    np.testing.assert_allclose(found(tables, name, width, at), by_numpy(name, at), rtol=ROUND_OFF, atol=0.0)


@pytest.mark.parametrize("name", BREAKPOINTS)
def test_what_is_no_number_comes_out_as_none(tables: ctypes.CDLL, name: str) -> None:
    """A NaN affects its own lane only."""
    at = np.array([np.nan, BREAKPOINTS[name][0]] * 4)
    for width in (width for width in WIDTHS if width <= tables.widest()):
        rows = found(tables, name, width, at)
        values = [polyval(x - row[0], row[1:]) for x, row in zip(at, rows, strict=True)]
        assert np.isnan(values).tolist() == [True, False] * 4


def test_pieces_that_are_equally_wide_are_not_searched_for(tables: ctypes.CDLL) -> None:
    equal = [bool(getattr(tables, f"equal_{number}")()) for number in range(1, 1 + len(BREAKPOINTS))]
    assert dict(zip(BREAKPOINTS, equal, strict=True)) == {
        **{"equal": True, "nearly equal": True, "unequal": False, "one piece": True},
    }


@pytest.mark.parametrize("name", BREAKPOINTS)
def test_equations_written_out_have_the_rows_of_the_table(name: str) -> None:
    """CasADi evaluates these expressions for dependencies and elimination."""
    chain = Chain()
    piece = look_up(chain, name, BREAKPOINTS[name], coefficients(name), AT)
    written = ca.Function("written", [AT], [ca.densify(chain.expand(piece))])
    at = places(name)
    rows = np.array([written(x).full().ravel() for x in at])
    np.testing.assert_allclose(rows, by_numpy(name, at), rtol=ROUND_OFF, atol=0.0)
    assert rows_of(BREAKPOINTS[name], coefficients(name)).shape == (BREAKPOINTS[name].size + 1, 4)


def test_polynomials_have_their_derivatives_and_interpolation_its_points() -> None:
    piece = [0.5, 1.0, -2.0, 3.0]
    values = [float(one) for one in map(ca.evalf, polynomials(ca.SX(piece), ca.SX(0.9), 2))]
    d = 0.4
    assert values == pytest.approx([1 - 2 * d + 3 * d**2, -2 + 6 * d, 6.0], rel=ROUND_OFF)
    x, lines = interpolation([0.0, 1.0, 3.0], [2.0, 4.0, 3.0])
    assert lines.tolist() == [[2.0, 2.0], [4.0, -0.5]]
    assert x.tolist() == [0.0, 1.0, 3.0]


@pytest.mark.parametrize(("breakpoints", "rows"), [([0.0, 0.0, 1.0], 2), ([0.0, 2.0, 1.0], 2), ([0.0, 1.0], 2)])
def test_a_table_that_is_none_is_refused(breakpoints: list[float], rows: int) -> None:
    with pytest.raises(ValueError, match="Table friction must have increasing breakpoints and one row of coefficients"):
        look_up(Chain(), "friction", np.array(breakpoints), np.ones((rows, 2)), AT)

"""Lanes (fmu_src/runtime/lanes.h): bit-identical at every width and for every compiler; errors; special values."""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from fmu_src.codegen import RUNTIME
from fmu_src.compile import FLAGS, OPTIMISE_GENERATED, library_suffix, run

Array = NDArray[np.float64]


def third_power(x: Array) -> Array:
    """Return x to the power of a third, NaN if x is negative."""
    return np.where(x < 0, np.nan, np.abs(np.cbrt(x)))


#: Functions of one and of two arguments, each with NumPy's function and the largest error [units in the last place]
#: that lanes_math.h states.
ONE: dict[str, tuple[float, Callable[..., Array]]] = {
    "exp": (0.95, np.exp),
    "log": (0.85, np.log),
    "sin": (0.8, np.sin),
    "cos": (0.8, np.cos),
    "tan": (1.4, np.tan),
    "asin": (1.2, np.arcsin),
    "acos": (1.2, np.arccos),
    "atan": (0.8, np.arctan),
    "cbrt": (0.97, third_power),
    "sqrt": (0.501, np.sqrt),
    "floor": (0, np.floor),
    "ceil": (0, np.ceil),
    "fabs": (0, np.fabs),
}
TWO: dict[str, tuple[float, Callable[..., Array]]] = {
    "pow": (0.97, np.power),
    "atan2": (1.5, np.arctan2),
    "copysign": (0, np.copysign),
}
#: Functions that the C library computes lane by lane.
BY_LIBRARY = ("sinh", "cosh", "tanh", "asinh", "acosh", "atanh", "expm1", "log1p", "erf")
BY_LIBRARY_TWO = ("fmod", "remainder", "hypot")
#: Expressions of x and z other than one function.
EXPRESSIONS = {
    "mixed": "(x * 2.0 - 1.0 / z) / 3.0 + -x",
    "select": "real_select(x < z, x, z)",
    "where": "real_where(((x < z) & (z > 0.0)) | (x == 1.0), x)",
    "not_both": "real_of_mask(real_not(x < z) & real_is(z))",
    "any": "real_of(real_any(x < 0.0))",
}
SPECIAL = [0.0, 0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 1e-300, 5e-324, 2.3e-308, 1e15, 2.0**53, 1e300, 1.7e308, 709.78, 745.14]
COUNT = 100_000
ZIG = f"{sys.executable} -m ziglang cc -mcpu=baseline"


def source() -> str:
    """Return C code that evaluates all of them over arrays, at each width that the compiler supports."""
    loop = "for (long long i = 0; i < n; i += LANES) {{ const real x = real_load(a + i), z = real_load(b + i); "
    loop += "(void)z; real_store(y + i, {}); }} LANES_LEAVE; "
    called = {name: f"real_{name}(x)" for name in (*ONE, *BY_LIBRARY)}
    called |= {name: f"real_{name}(x, z)" for name in (*TWO, *BY_LIBRARY_TWO)}
    arguments = "long long n, const double *a, const double *b, double *y"
    functions = "".join(
        f"SHOWN void LANES_NAME(lanes_of_{name})({arguments}) {{ {loop.format(expression)} }}\n"
        for name, expression in (called | EXPRESSIONS).items()
    )
    text = '#include "lanes_widest.h"\n#define SHOWN __attribute__((visibility("default")))\n'
    text += "SHOWN int widest(void) { return lanes_of_processor(); }\n"
    for width in (1, 2, 4, 8, 4):  # one file may contain the same width twice
        again = functions if f"LANES {width}\n" not in text else ""
        text += f'#if LANES_WIDEST >= {width}\n#define LANES {width}\n#include "lanes.h"\n{again}'
        text += '#include "lanes_end.h"\n#endif\n'
    return text


def compiled(folder: Path) -> ctypes.CDLL:
    """Return the compiled library of `source`, by the current compiler."""
    (folder / "lanes.c").write_text(source())
    flags = [*FLAGS, OPTIMISE_GENERATED, f"-I{RUNTIME}", "-shared"]
    run([*flags, "-o", f"lanes{library_suffix()}", "lanes.c", "-lm"], None, folder)
    return ctypes.CDLL(str(folder / f"lanes{library_suffix()}"))


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    return compiled(tmp_path_factory.mktemp("lanes"))


@pytest.fixture(scope="module")
def other_library(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ctypes.CDLL]:
    if find_spec("ziglang") is None:
        pytest.skip("install the extra: pip install -e .[compiler]")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CC", ZIG)
        yield compiled(tmp_path_factory.mktemp("lanes_of_zig"))


def widths(library: ctypes.CDLL) -> list[int]:
    return [width for width in (1, 2, 4, 8) if width <= library.widest()]


def evaluate(library: ctypes.CDLL, name: str, width: int, x: Array, z: Array) -> Array:
    """Evaluate one function over arrays, padded with ones to whole vectors."""
    padding = np.ones(-len(x) % 8)
    arguments = [np.concatenate([array, padding]) for array in (x, z)]
    y = np.empty_like(arguments[0])
    pointers = [array.ctypes.data_as(ctypes.POINTER(ctypes.c_double)) for array in (*arguments, y)]
    getattr(library, f"lanes_of_{name}_{width}")(ctypes.c_longlong(len(y)), *pointers)
    return y[: len(x)]


def of_all_magnitudes(generator: np.random.Generator) -> Array:
    """Return random numbers of every exponent and sign, and special values: infinities, NaN, zeros and more."""
    special = np.array([*SPECIAL, np.inf])
    random = generator.integers(0, 2**64, COUNT, dtype=np.uint64).view(np.float64)
    return np.concatenate([random, generator.uniform(-5, 5, COUNT), special, -special, [np.nan]])


def same_bits(a: Array, b: Array) -> bool:
    return bool(np.all((a.view(np.uint64) == b.view(np.uint64)) | (np.isnan(a) & np.isnan(b))))


EVERY = (*ONE, *TWO, *BY_LIBRARY, *BY_LIBRARY_TWO, *EXPRESSIONS)


@pytest.mark.study
@pytest.mark.parametrize("name", [name for name in EVERY if name != "any"])
def test_bits_are_the_same_at_every_width_and_of_both_compilers(
    name: str, library: ctypes.CDLL, other_library: ctypes.CDLL
) -> None:
    generator = np.random.default_rng(31)
    x = of_all_magnitudes(generator)
    z = generator.permutation(x)
    expected = evaluate(library, name, 1, x, z)
    for one in (library, other_library):
        for width in widths(one):
            assert same_bits(evaluate(one, name, width, x, z), expected), width


def test_a_wrong_bit_is_seen() -> None:
    x = np.array([0.0, 1.0])
    assert same_bits(x, x)
    assert not same_bits(x, np.array([-0.0, 1.0]))
    assert not same_bits(x, np.nextafter(x, 2))


def arguments_of(name: str) -> Sequence[tuple[Array, Array]]:
    """Return arguments where a function is difficult: ends of its range, ends of its pieces, cancellation."""
    g = np.random.default_rng(47)
    near_one, wide, turns = g.uniform(0.5, 2, COUNT), g.uniform(-1e6, 1e6, COUNT), g.integers(-600_000, 600_000, COUNT)
    angles = [g.uniform(-4, 4, COUNT), wide, turns * (np.pi / 2), g.uniform(-1e-3, 1e-3, COUNT)]
    slopes = [g.uniform(-1, 1, COUNT), g.uniform(-4, 4, COUNT), np.tan(g.uniform(-1.57, 1.57, COUNT))]
    sines = [g.uniform(-1, 1, COUNT), np.cos(g.uniform(0, 0.01, COUNT)), g.uniform(-0.51, 0.51, COUNT)]
    one = {
        "exp": [g.uniform(-744, 709.7, COUNT), g.uniform(-1, 1, COUNT)],
        "log": [near_one, g.uniform(0, 1000, COUNT), g.uniform(0, 1e-307, COUNT), np.exp(g.uniform(-700, 700, COUNT))],
        **dict.fromkeys(("sin", "cos", "tan"), angles),
        **dict.fromkeys(("asin", "acos"), sines),
        "atan": slopes,
        **{key: [near_one, np.exp(wide / 2e3), g.uniform(0, 1e-307, COUNT)] for key in ("sqrt", "cbrt")},
        **{key: [wide, turns * 0.5, wide * 1e10] for key in ("floor", "ceil", "fabs")},
    }
    if name in one:
        return [(x, x) for x in one[name]]
    if name == "pow":
        base, largest = np.exp(g.uniform(-690, 690, COUNT)), g.uniform(-690, 690, COUNT)
        constant = g.choice([0.286, 0.5, 2 / 3, 1.5, 3.0], COUNT)
        return [(x, largest / np.log(x)) for x in (base, near_one)] + [(g.uniform(0, 10, COUNT), constant)]
    return [(wide, g.uniform(-1e6, 1e6, COUNT)), (np.sin(wide), np.cos(wide)), (wide * 1e-300, wide[::-1] * 1e-305)]


@pytest.mark.study
@pytest.mark.skipif(np.finfo(np.longdouble).nmant < 63, reason="NumPy has no longer numbers here")
@pytest.mark.parametrize("name", [*ONE, *TWO])
def test_errors_are_as_small_as_promised(name: str, library: ctypes.CDLL) -> None:
    allowed, exact = (ONE | TWO)[name]
    for x, z in arguments_of(name):
        long = [array.astype(np.longdouble) for array in ((x,) if name in ONE else (x, z))]
        expected = exact(*long)
        error = np.abs(evaluate(library, name, 1, x, z) - expected) / np.spacing(np.abs(expected.astype(np.float64)))
        assert np.max(error) <= allowed, x[np.argmax(error)]


@pytest.mark.parametrize("name", [*ONE, *TWO])
def test_special_values_are_those_of_c(name: str, library: ctypes.CDLL) -> None:
    special = np.array([*SPECIAL, np.inf])
    special = np.concatenate([special, -special, [np.nan]])
    x, z = (array.ravel() for array in np.meshgrid(special, special))
    with np.errstate(all="ignore"):
        expected = ONE[name][1](x) if name in ONE else TWO[name][1](x, z)
    y = evaluate(library, name, 1, x, z)
    np.testing.assert_allclose(y, expected, rtol=1e-15, atol=5e-324)
    known = ~np.isnan(expected)
    np.testing.assert_array_equal(np.signbit(y[known]), np.signbit(expected[known]))


def test_masks_choose_lanes(library: ctypes.CDLL) -> None:
    generator = np.random.default_rng(3)
    x, z = (generator.choice([-1.0, 0.0, 0.5, 1.0, np.inf, np.nan], 1000) for _ in range(2))
    expected = {
        "select": np.where(x < z, x, z),
        "where": np.where((x < z) & (z > 0) | (x == 1), x, 0.0),
        "not_both": np.where(~(x < z) & (z != 0), 1.0, 0.0),
    }
    for name, value in expected.items():
        for width in widths(library):
            assert same_bits(evaluate(library, name, width, x, z), value), (name, width)


def test_any_sees_each_lane(library: ctypes.CDLL) -> None:
    x = np.where(np.eye(8) > 0, -1.0, 1.0).ravel()
    for width in widths(library):
        found = evaluate(library, "any", width, x, x).reshape(-1, width)
        np.testing.assert_array_equal(found, np.repeat((x.reshape(-1, width) < 0).any(1)[:, None], width, 1))


@pytest.mark.skipif(not os.path.exists("/proc/cpuinfo"), reason="Linux says what the processor has")
def test_the_width_is_one_that_the_processor_has(library: ctypes.CDLL) -> None:
    known = Path("/proc/cpuinfo").read_text().split()
    if "sse2" in known:
        wide = {"avx512f", "avx512dq", "avx512vl"} <= set(known)
        assert library.widest() == (8 if wide else 4 if "avx2" in known else 2)

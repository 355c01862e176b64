"""Long C functions in pieces give the bits of the whole."""

from __future__ import annotations

import ctypes
from pathlib import Path

import pytest

from fmu_src import compile as compiling
from fmu_src import pieces

#: A chain in which each number needs one just before it and one from far before, and a call leaves two in the middle.
COUNT = 60


def long_function() -> str:
    lines = ["double given_0[1];", "double left[2];", "casadi_real a00, a01, a02;"]
    lines += ["a00=arg[0][0];", "a01=(a00+1.5);", "a02=0.25;", "given_0[0]=a01;"]
    lines += ["{left[0]=given_0[0]*2.0; left[1]=given_0[0]*3.0;}", "const double left_0 = left[0], left_1 = left[1];"]
    lines += [f"a0{n % 2}=(a0{(n + 1) % 2}*a02+left_{n % 2});" for n in range(COUNT)]
    lines += ["res[0][0]=a00;", "res[0][1]=a01;", "return 0;"]
    arguments = "const casadi_real** arg, casadi_real** res, int mem"
    body = "".join(f"  {line}\n" for line in lines)
    wrapper = f"int whole({arguments}){{\n  return casadi_f0(arg, res, mem);\n}}\n"
    return f"#define casadi_real double\nstatic int casadi_f0({arguments}) {{\n{body}}}\n{wrapper}"


def values(text: str, folder: Path) -> list[float]:
    folder.mkdir()
    (folder / "long.c").write_text(text)
    flags = [flag for flag in compiling.FLAGS if flag not in ("-Wextra", "-fvisibility=hidden")]
    compiling.run([*flags, "-O1", "-shared", "-o", "long", "long.c"], None, folder)
    given, found = (ctypes.c_double * 1)(0.7), (ctypes.c_double * 2)()
    array = ctypes.POINTER(ctypes.c_double) * 1
    library = ctypes.CDLL(str(folder / "long"))
    library.whole(array(given), array(found), 0)
    return list(found)


def test_a_function_in_pieces_gives_the_numbers_of_the_whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = long_function()
    monkeypatch.setattr(pieces, "WHOLE", 7)
    monkeypatch.setattr(pieces, "LONGEST", 7)
    divided = pieces.in_pieces(text)
    assert divided.count("static void casadi_f0_") == (COUNT + 7) // 7 + 1
    assert values(divided, tmp_path / "divided") == values(text, tmp_path / "whole")


def test_a_short_function_stays_as_it_is() -> None:
    assert pieces.in_pieces(long_function()) == long_function()

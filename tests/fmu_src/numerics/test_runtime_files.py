"""The files of the C runtime: one direction of calls, functions that fit a screen, and the same interface in Python."""

from __future__ import annotations

import ctypes
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from fmu_src import kernel
from fmu_src.codegen import BATCH_SOURCES, RUNTIME, RUNTIME_HEADERS, RUNTIME_SOURCES, generate
from fmu_src.objects import ARRAYS
from products.registry import model_of

#: Lines of a function that fit a screen.
SCREEN = 60
#: Functions for FMI interfaces only: early return, checks before values are set, and model exchange.
OF_FACES = {
    "kernel_stop_at_events",
    "kernel_set_time",
    "kernel_check_exchange",
    "kernel_find_modes",
    "kernel_listen",
} | {
    f"kernel_{name}"
    for name in (
        *("exchange_states", "exchange_indicators", "exchanged_number", "get_exchanged", "complete_step"),
        *("check_set", "check_rate", "set_states", "get_states", "get_nominals", "get_slopes", "get_indicators"),
    )
}
#: Types of the headers and their types in ctypes; an instance is an address, a saved state is bytes.
NUMBERS = {
    "int": ctypes.c_int,
    "kernel_status": ctypes.c_int,
    "bool": ctypes.c_bool,
    "unsigned": ctypes.c_uint,
    "double": ctypes.c_double,
    "size_t": ctypes.c_size_t,
    "long long int": ctypes.c_longlong,
}
POINTERS = {
    "kernel": ctypes.c_void_p,
    "void": ctypes.c_char_p,
    "char": ctypes.c_char_p,
    "char *": ctypes.POINTER(ctypes.c_char_p),
    "int": ctypes.POINTER(ctypes.c_int),
    "bool": ctypes.POINTER(ctypes.c_bool),
    "double": ctypes.POINTER(ctypes.c_double),
    "kernel_counters": ctypes.POINTER(ctypes.c_longlong),
    "kernel_sentence": ctypes.POINTER(kernel._Sentence),
}


def code_of(path: Path) -> str:
    """Return the text without comments and strings."""
    return re.sub(r'/\*.*?\*/|"(\\.|[^"\\])*"', "", path.read_text(), flags=re.DOTALL)


def functions_of(path: Path) -> Iterator[tuple[str, int]]:
    """Yield the head and the number of lines of each function; all begin and end in the first column."""
    lines = code_of(path).split("\n")
    begin = 0
    for number, line in enumerate(lines):
        if re.match(r"\w[^;=]*\w\(", line):
            begin = number
        if line == "}" or re.match(r"\w[^;=]*\) \{.*\}$", line):
            yield " ".join(lines[begin : number + 1]).split("(")[0], number + 1 - begin


@pytest.fixture(scope="module")
def bogie_sources() -> dict[str, str]:
    return generate(model_of("bogie"))


SOURCES = (*RUNTIME_SOURCES, *BATCH_SOURCES)
FILES = [RUNTIME / name for name in SOURCES]


def test_every_file_of_the_runtime_is_listed() -> None:
    others = (ARRAYS, "step_object.c")  # for objects other than kernels
    assert sorted((*SOURCES, *others)) == sorted(path.name for path in RUNTIME.glob("*.c"))
    assert sorted((*RUNTIME_HEADERS, "arrays.h")) == sorted(path.name for path in RUNTIME.glob("*.h"))


def test_calls_run_from_later_files_to_earlier_ones() -> None:
    """No function calls one of a later file in the list, so there are no cycles."""
    heads = [(head, path.name) for path in FILES for head, _ in functions_of(path)]
    home = {head.split()[-1].lstrip("*"): name for head, name in heads if not head.startswith("static")}
    assert {"kernel_step", "integrate", "modes_margin", "fmi2DoStep", "face_get"} <= set(home)
    for path in FILES:
        for word in re.findall(r"\w+(?=\()", code_of(path)):
            if word in home:
                called = home[word]
                assert SOURCES.index(called) <= SOURCES.index(path.name), f"{path.name} calls {word}"


def test_faces_see_no_more_than_the_public_header() -> None:
    for name in ("face.h", "face.c", "fmi2.c", "fmi3.c"):
        assert "instance.h" not in (RUNTIME / name).read_text()
    assert "instance.h" not in (RUNTIME / "kernel.h").read_text().split("#define KERNEL_H")[1]


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_functions_fit_a_screen(path: Path) -> None:
    sizes = dict(functions_of(path))
    assert sizes
    assert {name: size for name, size in sizes.items() if size > SCREEN} == {}


def python_type(text: str) -> object:
    """Return the ctypes type of an argument or a result that kernel.h declares (without its name)."""
    words = text.replace("const ", "").strip()
    return POINTERS[words[:-1].strip()] if words.endswith("*") else None if words == "void" else NUMBERS[words]


def declared() -> dict[str, tuple[object, list[object]]]:
    """Return results and arguments of the public functions."""
    found: dict[str, tuple[object, list[object]]] = {}
    pattern = r"KERNEL_EXPORT ([\w ]+?\**) ?\b(kernel_\w+)\(([^)]*)\);"
    for result, name, arguments in re.findall(pattern, code_of(RUNTIME / "kernel.h") + code_of(RUNTIME / "studies.h")):
        each = [re.sub(r"\w+$", "", " ".join(part.split())) for part in arguments.split(",") if part != "void"]
        found[name] = (python_type(result), [python_type(part) for part in each])
    return found


def test_python_calls_the_functions_as_the_header_declares_them() -> None:
    assert {name: (result, list(arguments)) for name, (result, arguments) in kernel._SIGNATURES.items()} == {
        name: types for name, types in declared().items() if name not in OF_FACES
    }
    assert set(declared()) >= OF_FACES


def test_python_numbers_statuses_and_counters_as_the_header_does() -> None:
    text = code_of(RUNTIME / "status.h") + code_of(RUNTIME / "kernel.h")
    statuses = {name: int(number) for name, number in re.findall(r"KERNEL_(\w+) = (\d)", text)}
    assert statuses == {name: getattr(kernel, name) for name in ("OK", "WARNING", "DISCARD", "ERROR")}
    [fields] = re.findall(r"long long int ([\w, ]+);\s*\} kernel_counters;", text)
    assert tuple(fields.split(", ")) == kernel.COUNTERS


def members_of(type_name: str) -> list[str]:
    """Return the names of the members of a struct in model.h, in their order."""
    [body] = re.findall(rf"typedef struct \{{([^}}]*)\}} {type_name};", code_of(RUNTIME / "model.h"))
    return [name for line in body.split(";") for name in re.findall(r"\w+(?=,|$)", line.strip())]


@pytest.mark.study
def test_description_of_a_system_has_the_order_of_its_type(bogie_sources: dict[str, str]) -> None:
    """The members are given by position. A displaced member would have the value of another."""
    members = members_of("system_description")
    entries = re.findall(r"^    \{(/\* name \*/ .*?)\}(?=,?$)", bogie_sources["model.c"], re.M | re.S)
    assert len(entries) == 8  # straight track: point, planar, three contact models; line: point, planar, one
    for entry in entries:
        assert re.findall(r"/\* (\w+) \*/", entry) == members
    starts = re.findall(r"^static const steady_start \w+ = \{(.*)\};$", bogie_sources["model.c"], re.M)
    assert len(starts) == 3  # planar, and both systems with a suspension on a line
    for entry in starts:
        assert re.findall(r"/\* (\w+) \*/", entry) == members_of("steady_start")

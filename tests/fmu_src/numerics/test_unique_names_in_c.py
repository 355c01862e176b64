"""File-scope names of C code that is given for a part, next to those of the runtime in one unit."""

from __future__ import annotations

import re
from pathlib import Path

from fmu_src.codegen import RUNTIME, RUNTIME_HEADERS, RUNTIME_SOURCES
from fmu_src.unique_names_in_c import PREFIX, names_at_file_scope, with_own_names
from rbd_model.contact import strips_in_c
from rbd_model.contact.creep import tabulated

SOURCE = """#include <math.h>
#define ROUNDS 3 /* not other_name(1) { */
enum { MOST = 2, LEAST };
typedef struct { double solve, inside; } stand_of;
static const double PI = 3.14, E[] = {2.7, 1.0};
static double table[MOST][3];
static double before(double x);
static double (*law)(double) = before;
static int solve(const stand_of *stand, double matrix[MOST][MOST]) {
    const char *text = "solve(it) {";
    int local = 0;
    if (fmin(stand->solve, PI) > ROUNDS) { local = LEAST; }
    return local + (text != 0) + (matrix != 0);
}
static double before(double x) { return x * E[1] + table[0][0]; }
"""


def test_names_of_a_file_are_found_and_those_inside_are_not() -> None:
    assert names_at_file_scope(SOURCE) == {
        *("ROUNDS", "MOST", "LEAST", "stand_of", "PI", "E", "table", "before", "law", "solve"),
    }


def test_renamed_sources_know_each_other_and_none_of_the_names_of_the_runtime() -> None:
    """Renamed built-in parts share no name with the runtime."""
    common, own = with_own_names([SOURCE, "static void use(void) { (void)solve(0, 0); }"])
    assert f"static void {PREFIX}use(void) {{ (void){PREFIX}solve(0, 0); }}" == own
    assert "fmin(stand->in_c_solve, in_c_PI) > in_c_ROUNDS" in common
    files = [*RUNTIME_SOURCES, *RUNTIME_HEADERS]
    runtime = {word for name in files for word in re.findall(r"\w+", (RUNTIME / name).read_text())}
    texts = [
        (Path(str(module.__file__)).parent / name).read_text()
        for module, name in ((strips_in_c, "strips.c"), (tabulated, "table.c"))
    ]
    assert set().union(*map(names_at_file_scope, texts)) & runtime  # so renaming is necessary
    for renamed in with_own_names(texts):
        assert not names_at_file_scope(renamed) & runtime

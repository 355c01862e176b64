"""Habits of hosts: decimal commas, unmasked floating-point exceptions, clocks of game engines, parameters set again."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from fmpy import platform

from fmu_src.compile import FLAGS, compiler
from fmu_src.objects import RUNTIME
from products.building import write_in_c
from products.train.consist import block_train
from products.train.fmu import train_fmu
from tests.fmu_src.fmi.hosting import ERROR, OK, host

NATIVE = ["native", "fmi3"]
#: Formats with their values, in C and in Python.
TEXTS = [
    ("t = %.6g s, %d of %zu; %s%c", '0.313411, 3, (size_t)5, "a", 66', (0.313411, 3, 5, "a", "B")),
    ("%.*s|%5.2f|%-8.3g|%+g|%%", '2, "abc", 3.14159, 1e-7, 2.5', None),
    (
        "%lld %llu %ld %lu %u %016llx",
        "-5LL, 18446744073709551615ULL, -7L, 8UL, 9U, 255ULL",
        (-5, 2**64 - 1, -7, 8, 9, 255),
    ),
    ("%g %g %.17g", "1.0 / 3.0, 1e300, 0.1", (1 / 3, 1e300, 0.1)),
]
EXPECTED = ["ab| 3.14|1e-07   |+2.5|%"]
#: A C library whose locale has a decimal comma of two bytes.
COMMA = r"""
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
static int comma(char *text, size_t size, const char *format, ...) {
    char whole[800] = "", *to = whole, plain[800];
    va_list list;
    va_start(list, format);
    vsnprintf(plain, sizeof plain, format, list);
    va_end(list);
    const bool number = strpbrk(format, "gef") != NULL;
    for (const char *c = plain; *c; ++c)
        if (number && *c == '.') *to++ = '\xD9', *to++ = '\xAB';
        else *to++ = *c;
    *to = 0;
    if (size) strncpy(text, whole, size - 1), text[size - 1] = 0;
    return (int)strlen(whole);
}
"""
#: Run an FMU in a process that invalid operations, divisions by zero and overflows end (glibc's feenableexcept).
TRAPS = """
import ctypes, sys
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave
path, level = sys.argv[1:]
about = read_model_description(path)
refs = {v.name: v.valueReference for v in about.modelVariables}
one = FMU2Slave(guid=about.guid, unzipDirectory=extract(path), instanceName="a",
                modelIdentifier=about.coSimulation.modelIdentifier)
libm = ctypes.CDLL("libm.so.6")
libm.feenableexcept(1 | 4 | 8)
one.instantiate()
if level != "0":
    one.setInteger([refs["level"]], [int(level)])
one.setupExperiment(), one.enterInitializationMode(), one.exitInitializationMode()
for number in range(50):
    one.doStep(0.01 * number, 0.01)
kept = libm.fegetexcept()
libm.fedisableexcept(31)
assert kept == 13, kept
"""


def trapped(path: Path, level: int) -> int:
    """Return the exit status of a process that floating-point exceptions end; level 0: the FMU has none."""
    return subprocess.run([sys.executable, "-c", TRAPS, str(path), str(level)]).returncode


def test_numbers_in_texts_have_a_point_in_every_locale(tmp_path: Path) -> None:
    calls = "".join(f'print_text(text, sizeof text, "{form}", {values}); puts(text);\n' for form, values, _ in TEXTS)
    program = f'#include <stdbool.h>\n{COMMA}#define snprintf comma\n#include "print_text.h"\n#undef snprintf\n'
    program += f"int main(void) {{ char text[200];\n{calls}"
    program += 'printf("%d", print_text(text, 6, "%s %g", "abc", 0.25)); puts(text); return 0; }\n'
    (tmp_path / "texts.c").write_text(program)
    subprocess.run(
        [*compiler(), *FLAGS, f"-I{RUNTIME}", "texts.c", "-o", "texts"], cwd=tmp_path, check=True, capture_output=True
    )
    found = subprocess.run([tmp_path / "texts"], capture_output=True, text=True, check=True).stdout.splitlines()
    python = [form.replace("%zu", "%d").replace("ll", "l") % values for form, _, values in TEXTS if values]
    assert found == [python[0], *EXPECTED, *python[1:], "8abc 0"]


@pytest.mark.skipif(platform != "linux64", reason="feenableexcept is glibc's, and the masks are those of x86")
@pytest.mark.parametrize("level", [1, 3])
def test_unmasked_floating_point_exceptions_do_not_end_a_host(level: int, fmus: dict) -> None:
    """1/0 is "no limit" in the equations. The host's masks are its own again after each call."""
    assert trapped(fmus["bogie", "native"], level) == 0


@pytest.mark.skipif(platform != "linux64", reason="feenableexcept is glibc's, and the masks are those of x86")
def test_unmasked_floating_point_exceptions_do_not_end_the_host_of_a_train(tmp_path: Path) -> None:
    write_in_c(train_fmu(block_train(3)), tmp_path / "train.fmu", 2)
    assert trapped(tmp_path / "train.fmu", 0) == 0


def at_clock(path: Path, clock: np.ndarray, step: float) -> list[float]:
    """Return the motion of a stop whose steps begin at these times, all of which must be taken."""
    with host(path) as one:
        one.start(float(clock[0]), brake_torque_1=20e3, brake_torque_2=45e3)
        for time in clock:
            assert one.step(float(time), step) == OK, one.said
        return [one[name] for name in ("speed", "distance", "angular_velocity_1")]


@pytest.mark.parametrize("kind", NATIVE)
@pytest.mark.parametrize("step", [0.004, 1 / 60])
def test_a_clock_in_single_precision_is_a_clock(step: float, kind: str, fmus: dict) -> None:
    """Unity's `Time.time` after an hour has steps of 0.24 ms. The motion follows the steps, not the round-off."""
    double = 3600.0 + step * np.arange(250)
    summed = np.cumsum(np.float32([3600.0, *[step] * 249]), dtype=np.float32)
    expected = at_clock(fmus["bogie", kind], double, step)
    for clock in (np.float32(double), summed):
        assert at_clock(fmus["bogie", kind], clock, step) == pytest.approx(expected, rel=1e-9)
    assert abs(summed[-1] - double[-1]) > 1e-3  # of 1 s to 4 s


@pytest.mark.parametrize("kind", NATIVE)
@pytest.mark.parametrize("step", [0.001, 0.004, 1 / 60])
def test_a_step_out_of_its_turn_is_refused(step: float, kind: str, fmus: dict) -> None:
    """The clock of a game after an hour: a step again, a step left out, a clock that runs on during a pause."""
    clock = [float(np.float32(3600.0 + number * step)) for number in range(4)]
    with host(fmus["brake", kind]) as one:
        one.start(clock[0])
        for number, turn in ((0, OK), (0, ERROR), (2, ERROR), (1, OK), (0, ERROR), (2, OK), (3, OK)):
            assert one.step(clock[number], step) == turn, one.said
        assert one.step(clock[3] + 5.0, step) == ERROR
        assert "After a pause, pass the time that the FMU has reached" in one.said[-1]


@pytest.mark.parametrize("kind", NATIVE)
def test_a_parameter_may_be_set_again_to_its_value(kind: str, fmus: dict) -> None:
    """OpenModelica sets all parameters once more after the initialisation. Another value is refused, as before."""
    with host(fmus["brake", kind]) as one:
        one.start(application_time=3.0)
        assert one.set("application_time", 3.0) == OK
        assert one.step(0.0) == OK
        assert one.set("application_time", 3.0) == OK
        assert one.set("application_time", 2.0) == ERROR
        assert "fixed once the run has begun" in one.said[-1]

"""Hosts neither crash nor get wrong values by foreign strings, outdated values, forbidden calls or invalid numbers."""

from __future__ import annotations

import math
import os
import signal
import sys
import unicodedata
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from ctypes import c_double, c_uint32
from pathlib import Path

import casadi as ca
import pytest

from fmu_src.compile import build_library
from fmu_src.kernel import Kernel, Library, SimulationError
from fmu_src.system import Model, System, Variable, model_of
from rbd_model.track.friction import low
from rbd_model.track.line import arc, line_of, straight
from rbd_model.track.line_table import along_line
from tests.fmu_src.fmi.hosting import ERROR, OK, STEP, host

sys.path.insert(0, str(Path(__file__).parent))
from sled import MASS, build_sled, sled

NATIVE = ["native", "fmi3"]
GRAVITY = 9.81
#: Relative tolerance of algebraic states, which are solved to rounding errors.
SOLVED = 1e-9


@pytest.fixture(scope="module")
def sleds(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    return build_sled(tmp_path_factory.mktemp("sleds"))


# ---- texts of anyone ---------------------------------------------------------------------------------------------


#: Invalid file names: with line breaks, control characters, Cyrillic letters, invalid UTF-8 or conversions, or very
#: long.
TEXTS = [
    b"a\n\x10x",
    "Strecke\n\u0441\u0435\u0432\u0435\u0440.csv".encode(),
    b"\xff\xfe\x80",
    b"%s%n%d%1000000s",
    "é".encode() * 300,
    b"x" + "\N{RAILWAY CAR}".encode() * 200,
    b"3 a\n1 b\n2 c",
]


@pytest.mark.parametrize("kind", NATIVE)
def test_a_text_of_the_host_is_quoted_on_one_line_with_the_status_of_its_refusal(fmus: dict, kind: str) -> None:
    """Messages are compared as bytes: invalid UTF-8 would stop a host's callback. Only the status marks an error."""
    with host(fmus["bogie", kind]) as one:
        for text in TEXTS:
            one.heard.clear()
            assert one.set_text("line_file", text) == ERROR
            [(status, sentence)] = one.heard
            assert status == ERROR
            shown = sentence.decode()  # or this raises
            assert not any(unicodedata.category(letter) == "Cc" for letter in shown)
            assert shown.startswith("Line ")
            assert shown.endswith("The line before it stays in force.")


def test_a_text_is_no_format_in_an_fmu_of_pythonfmu_either(fmus: dict) -> None:
    """pythonfmu passes a message to the logger as a format. Formatted without values, it must contain the string."""
    with host(fmus["bogie", "python"]) as one:
        one.set_text("line_file", b"%s%n 30 %\n\x10.csv")
        one.raw("SetupExperiment", 0, 0.0, 0.0, 0, 0.0)
        one.raw("EnterInitializationMode")
        one.raw("ExitInitializationMode")
        assert one.step(0.0) != OK
        said = [text.decode() % () for _, text in one.heard]
        assert any(text.startswith("Line %s%n 30 %??.csv: it cannot be opened") for text in said)


def saying(sentence: str, ends: bool = False) -> Kernel:
    """Return a model that warns, or ends, with this message when its state reaches 0.5."""
    system = System("warning", "x' = 1")
    x = system.state("x", "1", 0.0, 1.0)
    system.derivative(x, 1 + 0 * x)
    (system.end_when_negative if ends else system.warn_when_negative)(0.5 - x, sentence)
    system.output(Variable("x", "output", "1", "x"), x)
    return Kernel(Library(build_library(model_of(system, 1e-6))))


@pytest.mark.parametrize("ends", [True, False])
@pytest.mark.parametrize("sentence", ["30 % at %s s.", '%n and %d, 100 %% at %s s, "??/" in Düren \\o/.'])
def test_a_sentence_of_a_model_is_no_format(sentence: str, ends: bool) -> None:
    """An end is located at 0.5 s. A warning comes at the end of an integration step."""
    kernel = saying(sentence, ends)
    with suppress(SimulationError):
        kernel.advance(1.0)
    before, behind = sentence.split("%s")
    [said] = kernel.messages
    assert said.startswith(before)
    assert said.endswith(behind)
    time = float(said[len(before) : len(said) - len(behind)])
    assert time == pytest.approx(0.5, rel=1e-9) if ends else 0.5 <= time <= 1.0


def test_a_sentence_without_a_place_for_its_time_is_refused() -> None:
    for sentence in ("No time.", "%s and %s."):
        with pytest.raises(ValueError, match="one %s, for the time"):
            saying(sentence)


@pytest.mark.study
def test_a_sentence_that_is_too_long_is_cut_between_letters() -> None:
    """The lengths before the cut vary, so that the cut would fall on each byte of a character."""
    for extra in range(4):
        kernel = saying("x" * extra + "\N{RAILWAY CAR}" * 200 + " at %s s.")
        kernel.advance(1.0)
        [sentence] = kernel.messages
        assert sentence == "x" * extra + "\N{RAILWAY CAR}" * ((508 - extra) // 4) + "..."


def test_the_journal_keeps_its_newest_sentences_the_error_among_them() -> None:
    """The host does not read messages for some time, as during a step with many events."""
    library = Library(build_library(sled()))
    kernel, call, brake = Kernel(library), library.functions, library.index["brake"]
    count = 1000
    for number in range(count):
        assert call.kernel_set(kernel.handle, brake, -1.0 - number) == ERROR
    with pytest.raises(SimulationError, match=f"got -{count + 1} N"):
        kernel.set(brake=-1.0 - count)
    lost, *kept = kernel.messages
    assert lost == f"{count + 1 - len(kept)} earlier messages were lost: they were not read."
    assert [sentence.split("got ")[1].split(" N")[0] for sentence in kept] == [
        f"{-1.0 - number:g}" for number in range(count + 1 - len(kept), count + 1)
    ]
    kernel.messages.clear()
    kernel.advance(0.1)
    assert kernel.messages == []


# ---- values after a change of inputs ------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", NATIVE)
def test_an_output_follows_an_input_through_an_algebraic_state(sleds: dict, kind: str) -> None:
    """N = m g - lift holds once the lift is set, before any step. Reading the output does not change the motion."""
    with host(sleds[kind]) as one, host(sleds[kind]) as unread:
        for machine in (one, unread):
            machine.start()
            assert machine.step(0.0) == OK
        for lift in (10.0, -35.0):
            for machine in (one, unread):
                assert machine.set("lift", lift) == OK
            assert one["load"] == pytest.approx(MASS * GRAVITY - lift, rel=SOLVED)
        for machine in (one, unread):
            assert machine.step(STEP) == OK
        assert [one[name] for name in ("load", "distance", "speed")] == [
            unread[name] for name in ("load", "distance", "speed")
        ]


@pytest.mark.parametrize("level", [1, 2, 3])
def test_outputs_that_are_read_after_friction_changed_have_the_slope_that_is_told(bogie: Library, level: int) -> None:
    """Contact model 1 has normal forces as algebraic states. Compare differences with the directional derivative."""
    kernel = Kernel(bogie, level=level, contact_model=1, initial_speed=20.0, brake_torque_1=8e3)
    kernel.set(**{name: value for name, value in low().values(2).items() if name.startswith("friction")})
    kernel.advance(3.0)
    names = ["axle_load_1", "creep_force_1", "acceleration"]
    start, change = kernel["friction_1"], 1e-5
    slope = kernel.directional(names, {"friction_1": 1.0})
    found = []
    for sign in (-1, 1):
        kernel.set(friction_1=start + sign * change)
        found.append([kernel[name] for name in names])
    difference = [(up - down) / (2 * change) for down, up in zip(*found, strict=True)]
    assert any(abs(one) > 1.0 for one in difference)
    assert difference == pytest.approx(slope, rel=1e-4, abs=1e-4 * max(map(abs, slope)))


def root(outputs: Callable[[ca.SX], ca.SX]) -> Kernel:
    """Return a model with an output that depends on its input alone."""
    system = System("root", "x' = 1")
    level = system.input(Variable("level", "input", "1", "Level", 4.0))
    x = system.state("x", "1", 0.0, 1.0)
    system.derivative(x, 1 + 0 * x)
    system.output(Variable("root", "output", "1", "Root"), outputs(level))
    return Kernel(Library(build_library(model_of(system, 1e-6))))


def test_a_value_that_is_no_number_is_refused_at_every_reading() -> None:
    kernel = root(ca.sqrt)
    with pytest.raises(SimulationError, match="root has a value from the initialisation on"):
        print(kernel["root"])
    kernel.advance(1.0)
    kernel.set(level=-1.0)
    for _ in range(3):
        with pytest.raises(SimulationError, match="The output root is not a finite number at these inputs"):
            print(kernel["root"])
    kernel.set(level=9.0)
    assert kernel["root"] == 3.0


def test_a_start_that_fails_leaves_no_value_behind() -> None:
    kernel = root(ca.sqrt)
    kernel.set(level=-1.0)
    for _ in range(2):
        with pytest.raises(SimulationError, match="root is not a finite number at the start"):
            kernel.initialise()
        with pytest.raises(SimulationError, match="root has a value from the initialisation on"):
            print(kernel["root"])


# ---- saved states ---------------------------------------------------------------------------------------------------


def test_a_state_from_before_the_start_remembers_its_line(bogie: Library, tmp_path: Path) -> None:
    curve = line_of([arc(300, 400, 0.1)]).write(tmp_path / "curve.csv")
    level = line_of([straight(400)]).write(tmp_path / "straight.csv")
    kernel = Kernel(bogie)
    without = kernel.save()
    kernel.set(line_file=str(curve))
    on_curve = kernel.save()
    kernel.restore(on_curve)
    for other in ("", str(level)):
        kernel.set(line_file=other)
        with pytest.raises(SimulationError, match=r"one on another line\. Set line_file to that of the saved state"):
            kernel.restore(on_curve)
        assert kernel.get_text(bogie.index["line_file"]) == other  # nothing was restored
    kernel.restore(without)  # which needs no file
    assert kernel.get_text(bogie.index["line_file"]) == ""


# ---- forbidden calls and bad numbers ---------------------------------------------------------------------------------


def test_event_mode_of_cosimulation_takes_neither_time_nor_states(fmus: dict) -> None:
    """FMI 3.0, table of section 4: both belong to model exchange."""
    with host(fmus["bogie", "fmi3"], events=True, early=True) as one:
        one.start()
        before = one.state()
        assert one.raw("SetTime", 3.0) == ERROR
        states = (c_double * 64)()
        assert one.raw("SetContinuousStates", states, 14) == ERROR
        assert one.state() == before
        assert one.raw("EnterStepMode") == OK


@pytest.mark.parametrize("kind", NATIVE)
@pytest.mark.parametrize("start", [math.nan, math.inf, -math.inf])
def test_a_start_that_is_no_time_is_refused(sleds: dict, kind: str, start: float) -> None:
    with host(sleds[kind]) as one:
        assert one.experiment(start) == ERROR
        assert one.said[-1].startswith("The start time must be a finite number")
        one.start(1.0)
        assert one.step(1.0) == OK


@pytest.mark.parametrize("kind", NATIVE)
@pytest.mark.parametrize("step", [1e-300, 1e-9, 9.99e-8])
def test_an_integration_step_that_would_take_for_ever_is_refused(sleds: dict, kind: str, step: float) -> None:
    with host(sleds[kind]) as one:
        assert one.set("integration_step", step) == ERROR
        assert "integration_step must be 0 s or at least 1e-07 s" in one.said[-1]
        assert one["integration_step"] == 0.0
        assert one.set("integration_step", 1e-7) == OK
        one.start()
        assert one.step(0.0, 10.0) == ERROR
        assert one.said[-1].startswith("The step must be at most 0.5 s; got")
        assert one.step(0.0, 1e-3) == OK


@contextmanager
def ringing(seconds: int) -> Iterator[None]:
    """End the process after some seconds, even if it waits in C code."""
    signal.alarm(seconds)
    yield
    signal.alarm(0)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
def test_a_pipe_or_a_folder_is_no_line(bogie: Library, tmp_path: Path) -> None:
    """Nothing is written into the pipe: opening it would block until the alarm."""
    os.mkfifo(tmp_path / "pipe")
    with ringing(20):
        for path in (tmp_path / "pipe", tmp_path, Path(os.devnull)):
            with pytest.raises(SimulationError, match=r"it is a folder, a pipe or a device\. Give the path of a file"):
                Kernel(bogie, line_file=str(path))


@pytest.mark.parametrize("kind", NATIVE)
def test_no_reference_is_too_large_to_be_refused(fmus: dict, kind: str) -> None:
    values = (c_double * 1)()
    with host(fmus["brake", kind]) as one:
        one.start()
        for reference in (2**31 - 1, 2**31, 2**31 + 1, 2**32 - 1):
            given = (c_uint32 * 1)(reference)
            sizes = [1] if one.three else []
            reading = "GetFloat64" if one.three else "GetReal"
            assert one.raw(reading, given, 1, values, *sizes) == ERROR, reference
            more = (given, 1, given, 1, values, 1, values, 1) if one.three else (given, 1, given, 1, values, values)
            assert one.raw("GetDirectionalDerivative", *more) == ERROR, reference


def test_a_model_on_a_line_names_its_file() -> None:
    """Without it, instances would search for a variable that does not exist."""
    with pytest.raises(ValueError, match="strings name table files; have line_file in the table, not none"):
        Model("nameless", "", model_of(root_system(), 1e-6).variables, (system_on_a_line(),), (), (0, 0))
    with pytest.raises(ValueError, match="strings name table files; have none in the table, not line_file"):
        Model("idle", "", model_of(system_on_a_line(), 1e-6).variables, (root_system(),))
    with pytest.raises(ValueError, match="give a system for each of 1 choices"):
        Model("none", "No system", model_of(root_system(), 1e-6).variables, (root_system(),), (), (-1,))


def system_on_a_line() -> System:
    system = System("on_line", "A point on a line")
    x = system.state("x", "m", 0.0, 1.0)
    [rise] = along_line(system, "rise", x)
    system.derivative(x, 1 + 0 * rise)
    return system


def root_system() -> System:
    system = System("root", "x' = 1")
    x = system.state("x", "1", 0.0, 1.0)
    system.derivative(x, 1 + 0 * x)
    return system


def test_a_model_without_a_line_asks_for_the_one_it_needs(tmp_path: Path) -> None:
    """The model has a line variable and no selector. The message names the variable, and not the missing selector."""
    kernel = Kernel(Library(build_library(model_of(system_on_a_line(), 1e-6))))
    with pytest.raises(SimulationError, match="line_file must be the path of a file with a line"):
        kernel.initialise()

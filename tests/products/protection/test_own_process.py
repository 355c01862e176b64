"""Controllers in C and in FMUs, in a separate process: the same stops; crashes, hangs and false values."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from zipfile import ZipFile

import pytest

import build_fmu
from bogie_braking.controllers.controller_loader import fmu_names
from bogie_braking.reporting.scenario import BadInputError
from brake_controller.wheel_slide import NOT_JUDGED
from evidence.measuring.protected_throughput import SHARE, SOURCE, LetGo
from fmu_src.cosimulation.slave import FmuInstance
from fmu_src.kernel import SimulationError
from products.controller_kinds import InC, compiled
from products.machine import bogie, coach
from products.protection import in_fmu as in_fmu_module
from products.protection.in_fmu import InFmu, Names
from products.protection.own_process import Apart, Limits, NoControllerError, Order, called_apart, runs_apart
from products.protection.rails import RAILS
from products.protection.rig import Rig
from products.protection.runs import Run
from products.protection.settings import Settings

NAMES = {
    count: Names(
        tuple(f"wheel_speed_{number}" for number in range(1, count + 1)),
        tuple(f"valve_{number}" for number in range(1, count + 1)),
        "period",
    )
    for count in (2, 4)
}


def let_go(folder: Path, name: str = "let_go", step: str = "") -> Path:
    """Write the trivial controller in C; step: C code at the beginning of its step function."""
    path = folder / f"{name}.c"
    text = SOURCE.replace("double fastest = 0.0;", f"double fastest = 0.0;\n    {step}")
    path.write_text(f"#define SHARE {SHARE}\n#include <math.h>\n#include <stdlib.h>\n#include <unistd.h>\n{text}")
    return path


def made_of(source: Path) -> Apart:
    return Apart(compiled(source).checked)


@pytest.mark.study
@pytest.mark.parametrize("machine", [bogie(), coach()], ids=["bogie", "coach"])
def test_a_library_and_an_fmu_make_the_stops_of_the_class(machine, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    count = len(machine.numbers)
    source, runs = let_go(tmp_path), [Run(RAILS[number].values(count), speed=12.0) for number in (1, 2)]
    given = ["--controller", str(source), "--out", str(tmp_path), "--wheelsets", str(count)]
    assert build_fmu.main(given) == 0
    fmu = tmp_path / "native" / ("let_go.fmu" if count == 2 else "let_go4.fmu")
    forms = [made_of(source), Apart(partial(InFmu, fmu, NAMES[count]))]
    settings = Settings(period=10e-3)
    whole = Rig(machine, LetGo, settings, by_flow=True).runs(runs)
    assert all(stop.distance for stop in whole)
    for form in forms:
        assert runs_apart(Order(machine, form, settings), runs) == whole


@pytest.mark.study
def test_an_fmu_that_needs_python_makes_the_stops_of_its_class(tmp_path: Path) -> None:
    text = (
        "class LetGo:\n    def step(self, time, speeds):\n"
        f"        return [2 if speed < {SHARE} * max(speeds) else 0 for speed in speeds]\n"
    )
    (tmp_path / "let_go.py").write_text(text)
    assert build_fmu.main(["--controller", f"{tmp_path / 'let_go.py'}:LetGo", "--out", str(tmp_path)]) == 0
    form = Apart(partial(InFmu, tmp_path / "python" / "LetGo.fmu", NAMES[2]))
    runs = [Run(RAILS[number].values(), speed=12.0) for number in (1, 2)]
    assert runs_apart(Order(bogie(), form, Settings()), runs) == Rig(bogie(), LetGo, Settings(), by_flow=True).runs(
        runs
    )


@pytest.mark.study
@pytest.mark.parametrize(
    ("step", "words", "limits"),
    [
        ("if (time > 6.0) abort();", "ended its process (SIGABRT); the brake stays applied.", Limits()),
        ("if (time > 6.0) *(volatile int *)8 = 1;", "ended its process (SIGSEGV); the brake stays applied.", Limits()),
        (
            "while (time > 6.0) pause();",
            f"gave no answer within 2 s of wall time {NOT_JUDGED}",
            Limits(guard=2.0),
        ),
        (
            "while (time > 6.0) {}",
            "used more than 0.5 s of processor time without an answer; the brake stays applied.",
            Limits(used=0.5),
        ),
    ],
    ids=["abort", "crash", "wait", "hang"],
)
def test_what_ends_its_process_ends_no_comparison(step: str, words: str, limits: Limits, tmp_path: Path) -> None:
    """The fault occurs in a stop from 12 m/s on a low rail; a stop from 5 m/s on a dry rail ends before it."""
    low, soon = Run(RAILS[2].values(), speed=12.0), Run(RAILS[0].values(), speed=5.0)
    form, runs = made_of(let_go(tmp_path, "bad", step)), [soon, low, *[soon] * ("abort" in step)]
    found = runs_apart(Order(bogie(), form, Settings()), runs, limits)
    [good] = Rig(bogie(), LetGo, Settings(), by_flow=True).runs([soon])
    [none] = Rig(bogie(), None, Settings(), by_flow=True).runs([low])
    assert found[0] == found[-1 if len(runs) == 3 else 0] == good
    assert found[1].distance is None
    assert found[1].message == f"The controller {words}"
    assert found[1].judged is ("not judged" not in words)
    assert found[1].time == none.time


@pytest.mark.study
def test_what_always_ends_its_process_is_not_asked_for_ever(tmp_path: Path) -> None:
    form = made_of(let_go(tmp_path, "bad", "abort();"))
    found = runs_apart(Order(bogie(), form, Settings()), [Run(RAILS[0].values(), speed=5.0)] * 5)
    assert [stop.distance for stop in found] == [None] * 5
    assert found[2].message == "The controller ended its process (SIGABRT); the brake stays applied."
    assert found[3].message == "The controller ended its process (SIGABRT) in 3 runs before; it was not asked again."


@pytest.mark.study
def test_what_is_no_controller_is_told(tmp_path: Path) -> None:
    (tmp_path / "libtext.so").write_text("no library")
    (tmp_path / "nothing.c").write_text("int nothing;\n")
    whole = compiled(tmp_path / "nothing.c").path.read_bytes()
    (tmp_path / "cut.so").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(OSError, match=r"cut\.so is cut off at \d+ of \d+ bytes"):  # a bus error terminated Python
        InC(tmp_path / "cut.so").functions(2)
    for path in (tmp_path / "libtext.so", compiled(tmp_path / "nothing.c").path):
        with pytest.raises(NoControllerError):
            runs_apart(Order(bogie(), Apart(InC(path).checked), Settings()), [Run(RAILS[0].values())])


@pytest.mark.parametrize(
    ("names", "words"),
    [
        (Names(("wheel_speed_1", "v"), ("valve_1", "valve_2")), "it has no variable v, but wheel_speed_1, wheel_"),
        (Names(("wheel_speed_1",), ("valve_1",)), "name a wheel speed and a valve for each of 2 wheelsets"),
    ],
)
def test_an_fmu_without_a_variable_is_refused(names: Names, words: str, tmp_path: Path) -> None:
    assert build_fmu.main(["--controller", str(let_go(tmp_path)), "--out", str(tmp_path)]) == 0
    with pytest.raises(ValueError, match=words):
        InFmu(tmp_path / "native" / "let_go.fmu", names, 2, 5e-3)


def test_an_fmu_for_a_coach_is_refused_on_a_bogie_and_a_table_names_other_variables(tmp_path: Path) -> None:
    source = let_go(tmp_path)
    assert build_fmu.main(["--controller", str(source), "--out", str(tmp_path), "--wheelsets", "4"]) == 0
    path = tmp_path / "native" / "let_go4.fmu"
    with pytest.raises(BadInputError, match=r"let_go4\.fmu is for 4 wheelsets; give one for the 2 of this machine"):
        fmu_names(path, 2)
    assert fmu_names(path, 4) == NAMES[4]
    path.with_suffix(".toml").write_text(
        'wheel_speed = ["wheel_speed_1", "wheel_speed_2"]\nvalve = ["valve_2", "valve_1"]\n[values]\nperiod = 0.01\n'
    )
    named = fmu_names(path, 2)
    assert named == Names(("wheel_speed_1", "wheel_speed_2"), ("valve_2", "valve_1"), "", (("period", 0.01),))


@pytest.mark.study
def test_an_fmu_that_allows_one_instance_never_has_two(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Four runs wait for each other."""
    made: list[Path] = []

    class Noted(FmuInstance):
        def __init__(self, path: Path) -> None:
            made.append(path)
            super().__init__(path)

    monkeypatch.setattr(in_fmu_module, "FmuInstance", Noted)
    assert build_fmu.main(["--controller", str(let_go(tmp_path)), "--out", str(tmp_path)]) == 0
    form = InFmu(tmp_path / "native" / "let_go.fmu", NAMES[2], 2, 5e-3)
    form.at_once = 1
    runs = [Run(RAILS[number].values(), speed=8.0) for number in (0, 2, 0, 2)]
    assert Rig(bogie(), form, Settings()).runs(runs) == Rig(bogie(), LetGo, Settings()).runs(runs)
    assert len(made) == 1


def test_an_fmu_without_a_binary_is_no_controller(tmp_path: Path) -> None:
    assert build_fmu.main(["--controller", str(let_go(tmp_path)), "--out", str(tmp_path)]) == 0
    whole, bare = tmp_path / "native" / "let_go.fmu", tmp_path / "bare.fmu"
    with ZipFile(whole) as source, ZipFile(bare, "w") as copy:
        for name in source.namelist():
            if not name.startswith("binaries"):
                copy.writestr(name, source.read(name))
    with pytest.raises(NoControllerError):
        Apart(partial(InFmu, bare, NAMES[2])).made(2, 5e-3)


def fails() -> None:
    raise RuntimeError("the simulation is at fault")


@pytest.mark.study
def test_what_fails_otherwise_is_not_called_no_controller() -> None:
    with pytest.raises(SimulationError, match=r"the simulation is at fault \(RuntimeError\)"):
        called_apart(fails)

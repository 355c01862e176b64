"""State machines of both FMI standards, tested with random calls on every kind of FMU, under sanitizers."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest

from tests.fmu_src.fmi.objects import OBJECTS

MACHINE = Path(__file__).with_name("machine.c")
#: Numbers of the interfaces in machine.c. Model exchange is tested with objects that support it.
FACES = {
    "co-simulation of FMI 2.0": "0",
    "model exchange of FMI 2.0": "1",
    "co-simulation of FMI 3.0": "2",
    "model exchange of FMI 3.0": "3",
}
RUNS = [(name, face) for name, one in OBJECTS.items() for face in FACES if one.exchange or "exchange" not in face]
SHORT, LONG = 20_000, 200_000
#: Least shares of all calls; about half of the random calls are allowed.
LEAST_SHARE = {"allowed": 0.4, "forbidden": 0.25, "insane": 0.08}


@pytest.fixture(scope="module")
def command_of(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], list[str]]:
    """Return a function that builds the program for an object: its command, the object's folder and its variables."""

    @cache
    def linked(name: str) -> list[str]:
        one, folder, files = OBJECTS[name], *(tmp_path_factory.mktemp(part) for part in (name, "files"))
        program, words = one.linked(MACHINE, folder), one.files(files)
        return [str(program), str(files) if one.reads_files else "", *one.words.split(), *words]

    return linked


def rare(name: str, face: str) -> set[str]:
    """Return events that must occur in addition to steps: new states, ends of runs, discarded steps, early returns."""
    one = OBJECTS[name]
    if "exchange" in face:
        return {"places"}
    if not one.ends:
        return set()
    if "2.0" in face:
        return {"ends", "discarded"}
    return {"ends", "discarded", "early"} if one.kernel else {"ends"}


def play(command: list[str], name: str, face: str, seed: int, calls: int) -> None:
    program, *rest = command
    calls = round(calls * OBJECTS[name].calls)
    given = [program, FACES[face], str(seed), str(calls), *rest]
    done = subprocess.run(given, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    assert done.stderr == ""
    found = {name: int(number) for number, name in (part.split() for part in done.stdout.split(", "))}
    assert found["broken"] == 0
    assert found["allowed"] + found["forbidden"] + found["insane"] == calls
    for kind, share in LEAST_SHARE.items():
        assert found[kind] > share * calls, kind
    assert found["refused"] >= found["forbidden"]
    assert {kind for kind in rare(name, face) if not found[kind]} == set()
    assert found["restored"] > calls / 500
    assert found["steps"] > calls / 100 or "exchange" in face


@pytest.mark.study
@pytest.mark.parametrize(("name", "face"), RUNS)
def test_allowed_calls_succeed_and_all_others_are_refused(command_of: Callable, name: str, face: str) -> None:
    """The tables of the standards define the allowed calls. A refused call leaves the state; a value that was set is
    read.
    """
    play(command_of(name), name, face, 1, SHORT)


@pytest.mark.long
@pytest.mark.parametrize(("name", "face"), RUNS)
@pytest.mark.parametrize("seed", range(10, 15))
def test_two_hundred_thousand_calls_keep_to_the_state_machines(
    command_of: Callable, name: str, face: str, seed: int
) -> None:
    play(command_of(name), name, face, seed, LONG)

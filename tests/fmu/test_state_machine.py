"""The state machines of both standards: a host that knows them, and the FMUs' answers to it, under sanitizers."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from fmu_src.codegen import generate
from rbd_model.track.line import arc, line_of, straight
from tests.fmu.sanitized import driver, sanitized
from tests.fmu.sled import sled

MACHINE = Path(__file__).with_name("machine.c")
#: As the program numbers them.
FACES = {
    "co-simulation of FMI 2.0": "0",
    "model exchange of FMI 2.0": "1",
    "co-simulation of FMI 3.0": "2",
    "model exchange of FMI 3.0": "3",
}
#: The sled has an algebraic state, hence no model exchange.
RUNS = [("sled", "0"), ("sled", "2"), *(("bogie", face) for face in FACES.values())]
SHORT, LONG = 20_000, 200_000
#: Of all calls; at random half are allowed.
LEAST_SHARE = {"allowed": 0.4, "forbidden": 0.25, "insane": 0.08}


@pytest.fixture(scope="module")
def programs(objects: dict, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    linked = {"sled": sanitized(generate(sled())), "bogie": objects["sanitized"]}
    return {name: driver(of, MACHINE, tmp_path_factory.mktemp(name)) for name, of in linked.items()}


@pytest.fixture(scope="module")
def lines(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Two lines, one of them at a second place whose name is a format, and two files that are none."""
    folder = tmp_path_factory.mktemp("lines")
    curve = line_of([arc(300, 250, 0.1, 0.02)]).write(folder / "curve.csv")
    copy = Path(shutil.copy(curve, folder / "copy, 100 %s.csv"))
    (folder / "bad.csv").write_bytes(b"%s%n,\xff\xfe\n1,2,3\n")
    (folder / "bad_empty.csv").write_text("")
    return [curve, copy, line_of([straight(9000)]).write(folder / "straight.csv"), *sorted(folder.glob("bad*"))]


def play(program: Path, face: str, seed: int, calls: int, lines: list[Path]) -> None:
    done = subprocess.run([program, face, str(seed), str(calls), *lines], capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    assert done.stderr == ""
    found = {name: int(number) for number, name in (part.split() for part in done.stdout.split(", "))}
    assert found["broken"] == 0
    assert found["allowed"] + found["forbidden"] + found["insane"] == calls
    for name, share in LEAST_SHARE.items():
        assert found[name] > share * calls, name
    assert found["restored"] > calls / 500


@pytest.mark.parametrize(("model", "face"), RUNS)
@pytest.mark.parametrize("seed", [1, 2])
def test_allowed_calls_succeed_and_all_others_are_refused(
    programs: dict, lines: list[Path], model: str, face: str, seed: int
) -> None:
    """By the standards' tables of calls and states; what is refused leaves the state, what is set is read."""
    play(programs[model], face, seed, SHORT, lines if model == "bogie" else [])


@pytest.mark.long
@pytest.mark.parametrize(("model", "face"), RUNS)
@pytest.mark.parametrize("seed", range(10, 15))
def test_two_hundred_thousand_calls_keep_to_the_state_machines(
    programs: dict, lines: list[Path], model: str, face: str, seed: int
) -> None:
    play(programs[model], face, seed, LONG, lines if model == "bogie" else [])

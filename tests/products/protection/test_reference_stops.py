"""The built-in protection as a C library: it compiles as C and C++, and its reference stops show an altered port."""

import re
import subprocess
from pathlib import Path

import pytest

from bogie_braking.__main__ import main
from bogie_braking.controllers import reference
from brake_controller.slide_protection import one_file, slide_sources
from products.controller_kinds import InC, compiled
from products.protection.reference_stops import STOPS, looks_of
from tests.needed import needed

ROOT = Path(__file__).parents[3]
STRICT = ["-Wall", "-Wextra", "-Wconversion", "-pedantic", "-Werror", "-O1", "-fPIC", "-shared", "-ffp-contract=off"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    into = tmp_path_factory.mktemp("protection")
    reference.write_folder(into, {"wheel_slide.h": slide_sources()["wheel_slide.h"], "wheel_slide.c": one_file()})
    (into / "reference.csv").write_text(reference.table())
    return into


def differences(controller: InC) -> dict[str, str]:
    """Return the stops in which a library differs, and the first difference in each."""
    named = dict.fromkeys((1, 2, 4), ("port", controller))
    looks = [looks_of(stop) for stop in STOPS]
    answers = reference.answered(named, STOPS, looks)
    found = map(reference.first_difference, STOPS, looks, answers)
    return {stop.name: words for stop, words in zip(STOPS, found, strict=True) if words}


@pytest.mark.study
@pytest.mark.parametrize("words", [["gcc", "-std=c99"], ["g++", "-xc++", "-std=c++17"]])
def test_the_library_compiles_as_c_and_as_cpp_and_passes_its_stops(folder: Path, words: list[str]) -> None:
    library = folder / f"lib{words[0]}.so"
    done = subprocess.run(
        [*words, *STRICT, "wheel_slide.c", "-o", library, "-lm"], cwd=folder, capture_output=True, text=True
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert differences(InC(library)) == {}


@pytest.mark.study
@pytest.mark.parametrize(
    ("old", "new", "stop"),
    [
        ("STEADY = 0.4", "STEADY = 0.45", "low"),
        ("if (!isfinite(wheel_speed[i])) {", "if (0) {", "invalid"),
        ("BLIND = 1.0", "BLIND = 2.0", "blind"),
        ("SIZE_MOST = 0.05", "SIZE_MOST = 0.0", "radius"),
    ],
)
def test_an_altered_port_differs_in_its_stop(tmp_path: Path, old: str, new: str, stop: str) -> None:
    text = one_file()
    assert text.count(old) == 1
    port = tmp_path / "port.c"
    port.write_text(text.replace(old, new))
    found = differences(compiled(port))
    assert found[stop].startswith(f"Stop {stop}, ")
    assert "instead of" in found[stop]


@pytest.mark.study
def test_a_table_is_compared_look_by_look(folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mine = tmp_path / "mine.csv"
    lines = (folder / "reference.csv").read_text().splitlines(keepends=True)
    mine.write_text("".join(lines))
    assert main(["controllers", "reference", "--check", str(mine)]) == 0
    assert capsys.readouterr().out == f"{mine}: the same commands in all {len(STOPS)} stops.\n"
    cells = lines[499].split(",")
    cells[7] = "1" if cells[7] != "1" else "2"
    mine.write_text("".join([*lines[:499], ",".join(cells), *lines[500:]]))
    assert main(["controllers", "reference", "--check", str(mine)]) == 1
    found = capsys.readouterr().out
    assert f"Stop {cells[0]}, {float(cells[2]):g} s, wheelset 1: command {cells[7]} instead of" in found
    broken = tmp_path / "broken.c"
    broken.write_text(one_file().replace("SIZE_MOST = 0.05", "SIZE_MOST = 0.0"))
    assert main(["controllers", "reference", "--check", str(broken)]) == 1
    assert "instead of" in capsys.readouterr().out
    mine.write_text("".join(lines[:-1]))
    assert main(["controllers", "reference", "--check", str(mine)]) == 2
    assert f"must have {len(lines)} lines" in capsys.readouterr().err


@pytest.mark.study
def test_numbers_of_the_table_are_read_back_exactly(folder: Path) -> None:
    stop = STOPS[2]
    rows = [line.split(",") for line in (folder / "reference.csv").read_text().splitlines()]
    read = [tuple(map(float, row[3:5])) for row in rows if row[0] == stop.name]
    assert read == [look.speeds for look in looks_of(stop)]
    assert any(speed != round(speed, 12) for speeds in read for speed in speeds)


def test_all_commands_occur_with_each_number_of_wheelsets() -> None:
    for stop in STOPS:
        commands = {valve for look in looks_of(stop) for valve in look.valves}
        assert commands == ({0} if stop.name == "dry" else {0, 1, 2}), stop.name
    assert {stop.wheelsets for stop in STOPS} == {1, 2, 4}


@pytest.mark.study
def test_the_linter_finds_the_documented_deviations_only(folder: Path) -> None:
    linter = needed("cppcheck", packages="cppcheck")
    words = ["--addon=misra", "--std=c99", "--suppress=missingIncludeSystem", "wheel_slide.c"]
    done = subprocess.run([linter, *words], cwd=folder, capture_output=True, text=True, check=True)
    found = set(re.findall(r"misra-c2012-([0-9.]+)", done.stderr))
    page = (ROOT / "docs/library.md").read_text()
    rows = re.findall(r"^\| ((?:\d+\.\d+(?:, )?)+) \|", page, re.MULTILINE)
    assert found == {rule for row in rows for rule in row.split(", ")}

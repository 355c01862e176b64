"""Output of the command line for people, programs and shells."""

from __future__ import annotations

import contextlib
import io
import json
import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

from bogie_braking.__main__ import main
from bogie_braking.commands import COMMANDS, doctor
from bogie_braking.exit_status import FAILED, NOBODY_READS
from bogie_braking.reporting import progress, report
from bogie_braking.reporting.saved import wall_seconds
from brake_controller.cylinder import brake_cylinder
from fmu_src import codegen
from fmu_src import compile as compiling
from fmu_src import progress as fmu_progress
from fmu_src.progress import counting, without_bars
from products import prebuilt
from products.registry import FMUS, IN_C
from products.sources import HOUSE, digest
from scenarios.catalogue import SCENARIOS
from scenarios.commands import run as run_command

ROOT = Path(__file__).parents[2]


def test_quiet_says_nothing_but_writes_the_results(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "critical-speed", "--quiet", "--out", str(tmp_path)]) == 0
    assert capfd.readouterr() == ("", "")
    assert (tmp_path / "critical-speed" / "figure.png").exists()


def test_all_prints_what_is_else_left_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(report, "FEW", 1)
    for extra, whole in ([], False), (["--all"], True):
        assert main(["run", "critical-speed", "--out", str(tmp_path), *extra]) == 0
        shown = capsys.readouterr().out
        assert ("more rows that are not judged" in shown) is not whole
        rows = json.loads((tmp_path / "critical-speed" / "summary.json").read_text())["rows"]
        assert all(row["quantity"] in shown for row in rows) is whole


def test_json_is_the_summary_and_nothing_else(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "critical-speed", "--json", "--out", str(tmp_path)]) == 0
    shown = json.loads(capfd.readouterr().out)
    assert shown == json.loads((tmp_path / "critical-speed" / "summary.json").read_text())
    assert {row["holds"] for row in shown["rows"]} <= {True, None}


def test_a_refusal_is_said_also_where_quiet_is_asked_for(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "critical-spee", "--quiet"]) == 2
    assert capsys.readouterr().err == "There is no scenario critical-spee; did you mean critical-speed?\n"


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["build", "bogey"], "got bogey. Did you mean bogie?"),
        (["build", "coahc"], "got coahc. Did you mean coach?"),
        (["controllers", "compare", "--vehicle", "coahc"], "got coahc. Did you mean coach?"),
        (["build", "--help"], "  bogie-braking build all --kind native "),
        (["run", "line-from-file", "--line", "nothing.csv"], "The file nothing.csv does not exist. Check the path."),
    ],
)
def test_what_is_said_is_right_without_the_sources(
    arguments: list[str], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """The message names no file of a checkout."""
    with contextlib.suppress(SystemExit):
        main(arguments)
    shown = "".join(capsys.readouterr())
    assert sentence in shown
    assert not re.search(r"build_fmu\.py|docs/|tests/|\bmake ", shown)


def test_the_first_words_say_what_to_do_and_help_fits_a_screen(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 2
    said = capsys.readouterr().err
    assert len(said.splitlines()) == 3
    assert "bogie-braking run demo" in said
    with contextlib.suppress(SystemExit):
        main(["--help"])
    shown = capsys.readouterr().out.splitlines()
    assert len(shown) <= 48
    assert max(map(len, shown)) <= 90
    assert {line.split()[0] for line in shown[shown.index("commands:") + 1 :] if line} >= COMMANDS.keys()


def test_build_without_a_name_lists_and_builds_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["build"]) == 0
    assert {line.split()[0] for line in capsys.readouterr().out.splitlines()} == {*FMUS, *IN_C, "ssp", "all"}
    assert main(["build", "--kind", "native"]) == 2
    assert capsys.readouterr().err == "--kind must be with an FMU; got none. Name one, or all.\n"
    assert not list(tmp_path.iterdir())


def test_list_for_programs(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list", "--quiet"]) == 0
    assert capsys.readouterr().out.split() == [scenario.name for scenario in SCENARIOS]
    assert main(["list", "--json"]) == 0
    listed = {one["name"]: one for one in json.loads(capsys.readouterr().out)}
    assert "torque_csv" in listed["qr30-180kpa"]["options"]
    assert listed["qr30-180kpa"]["summary"]
    assert listed["braking-distance"]["group"] == "trains"


def test_list_for_people_stands_in_groups(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list"]) == 0
    groups = [line for line in capsys.readouterr().out.splitlines() if line and not line.startswith(" ")]
    assert groups == [f"{group}:" for group in dict.fromkeys(scenario.group for scenario in SCENARIOS)]


class Terminal(io.StringIO):
    """A terminal that records its output."""

    def isatty(self) -> bool:
        return True


def test_bars_are_on_terminals_alone_and_hidden_within(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fmu_progress, "PATIENCE", 0.0)

    def bar(shown: io.StringIO) -> str:
        monkeypatch.setattr(sys, "stderr", shown)
        list(counting([1], "working"))
        return shown.getvalue()

    assert bar(io.StringIO()) == ""
    with without_bars():
        assert bar(Terminal()) == ""
    assert "working:" in bar(Terminal())


def test_every_bar_is_one_that_no_file_gets() -> None:
    """tqdm writes into files by default; `counting` and `disable=None` prevent it."""
    rooms = (*HOUSE, "docs/generate")
    sources = [*ROOT.glob("*.py"), *(path for room in rooms for path in (ROOT / room).rglob("*.py"))]
    calls = {
        f"{path.relative_to(ROOT)}: {call}"
        for path in sources
        for call in re.findall(r"(?<!def )\btqdm\(.*", path.read_text(encoding="utf-8"))
        if "disable=" not in call
    }
    assert calls == set()


def test_a_bar_moves_with_the_clock_where_nothing_else_does(monkeypatch: pytest.MonkeyPatch) -> None:
    """It advances towards the last run's duration, or shows the elapsed time if that is unknown."""
    for name in ("PATIENCE", "TICK"):
        monkeypatch.setattr(progress, name, 0.01)
    for expected, words in ((90.0, "00:00 of about 01:30"), (0.4, "###"), (None, "working: 00:00")):
        monkeypatch.setattr(sys, "stderr", Terminal())
        with progress.ticking("working", expected):
            time.sleep(0.3)
        assert words in sys.stderr.getvalue()


def test_nothing_ticks_in_files_and_where_it_is_quiet(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("PATIENCE", "TICK"):
        monkeypatch.setattr(progress, name, 0.01)
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    with progress.ticking("working", 90.0):
        time.sleep(0.1)
    assert sys.stderr.getvalue() == ""
    monkeypatch.setattr(sys, "stderr", Terminal())
    with without_bars(), progress.ticking("working", 90.0):
        time.sleep(0.1)
    assert sys.stderr.getvalue() == ""


@pytest.mark.parametrize(
    "text", ["{", "[]", "{}", *(f'{{"wall_seconds": {one}}}' for one in ("null", "true", "1e999", "-1", "9" * 5000))]
)
def test_results_that_cannot_be_read_promise_no_time(text: str, tmp_path: Path) -> None:
    assert wall_seconds(tmp_path) is None
    (tmp_path / "summary.json").write_text(text)
    assert wall_seconds(tmp_path) is None


def test_generating_and_compiling_show_how_far_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fmu_progress, "PATIENCE", 0.0)
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    sources = codegen.generate(brake_cylinder())
    compiling.objects_of(sources, compiling.FLAGS)
    shown = terminal.getvalue()
    assert "generating C:" in shown
    assert "compiling:" in shown


@pytest.mark.skipif(shutil.which("bash") is None, reason="there is no bash")
@pytest.mark.parametrize(
    ("typed", "offered"),
    [
        ("run qr30-18", "qr30-180kpa"),
        ("sweep lev", "levels"),
        ("com", "completion"),
        ("run --coup", "--coupling-tolerance"),
        ("completion po", "powershell"),
        ("pace coa", "coach coal-wagon"),
        ("build coac", "coach"),
        ("build --consi", "--consist"),
    ],
)
def test_bash_completes(typed: str, offered: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["completion", "bash"]) == 0
    words = ["bogie-braking", *typed.split()]
    (tmp_path / "script").write_text(
        capsys.readouterr().out + f"COMP_WORDS=({' '.join(words)}) COMP_CWORD={len(words) - 1}\n"
        f'_shtab_bogie_braking bogie-braking "{words[-1]}" "{words[-2]}"\nprintf "%s\\n" "${{COMPREPLY[@]}}"\n'
    )
    done = subprocess.run(["bash", "script"], cwd=tmp_path, capture_output=True, text=True)
    assert sorted(done.stdout.split()) == offered.split(), done.stderr


@pytest.mark.study
def test_a_reader_who_goes_is_no_failure(tmp_path: Path) -> None:
    empty = os.environ | {"BOGIE_BRAKING_CACHE": str(tmp_path)}
    for command in ("list", "doctor"):
        call = [sys.executable, "-m", "bogie_braking", command]
        with subprocess.Popen(call, cwd=ROOT, env=empty, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as running:
            assert running.stdout
            running.stdout.close()
            assert running.stderr
            assert running.stderr.read() == b""
        assert running.returncode == NOBODY_READS


def test_a_fault_of_the_program_is_no_row_that_does_not_hold(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(run_command, "run", lambda _: [].pop())
    assert main(["run", "levels", "--out", str(tmp_path)]) == FAILED
    assert "IndexError" in capsys.readouterr().err


def test_a_folder_that_cannot_be_is_told_before_the_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setattr(run_command, "save", lambda *_: pytest.fail("It ran."))
    assert main(["run", "critical-speed", "--out", str(tmp_path / "file" / "results")]) == 2
    assert "Choose another folder with --out.\n" in capsys.readouterr().err


# -- doctor --------------------------------------------------------------------------------------------------------


def said(capsys: pytest.CaptureFixture[str]) -> dict[str, str]:
    """Return the verdict by the first words of each line."""
    lines = [line for line in capsys.readouterr().out.splitlines() if not line.startswith(" ")]
    return {line[9:].split(":")[0]: line[:8].strip() for line in lines}


@pytest.fixture
def empty_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Doctor reads every file of the cache; that of the tests has thousands."""
    monkeypatch.setattr(compiling, "CACHE", tmp_path / "cache")


@pytest.mark.usefixtures("empty_cache")
def test_all_that_is_needed_is_there(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["doctor"]) == 0
    verdicts = said(capsys)
    assert {verdicts[name] for name in ("packages", "C compiler", "cache")} == {"ok"}
    assert verdicts["prebuilt FMUs"] == "without"


def test_doctor_works_where_packages_are_missing(tmp_path: Path) -> None:
    """Without any package, it names the packages to install before it imports one of them."""
    command = [sys.executable, "-S", "-m", "bogie_braking", "doctor"]
    done = subprocess.run(command, cwd=ROOT, env={"PATH": ""}, capture_output=True, text=True)
    assert done.returncode == 1, done.stderr
    assert "MISSING  bogie-braking: not installed\n         -> Install its wheel" in done.stdout


def test_wrong_and_missing_packages_are_named_with_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    installed = {"numpy": "1.26.0"}

    def version(name: str) -> str:
        if name not in installed:
            raise doctor.PackageNotFoundError
        return installed[name]

    from packaging.specifiers import SpecifierSet

    monkeypatch.setattr(doctor, "version", version)
    found = doctor.group("", {"numpy": SpecifierSet(">=2.2"), "casadi": SpecifierSet("==3.8.2")})
    assert found.verdict == doctor.MISSING
    assert found.text == "packages: numpy 1.26.0 is not >=2.2, casadi is missing"
    assert found.advice == "pip install 'bogie-braking', in a checkout with -e ."
    assert doctor.group("sweep", {"pyarrow": SpecifierSet(">=18")}).verdict == doctor.WITHOUT
    installed["numpy"] = "2.4.6"
    assert doctor.group("", {"numpy": SpecifierSet(">=2.2")}).verdict == doctor.OK


def test_without_compiler_or_cache_doctor_tells(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "taken").write_text("")
    monkeypatch.setattr(compiling, "CACHE", tmp_path / "taken")
    monkeypatch.setenv("CC", "no-such-compiler")
    assert main(["doctor"]) == 1
    verdicts = said(capsys)
    assert (verdicts["C compiler"], verdicts["cache"]) == ("MISSING", "MISSING")


@pytest.mark.usefixtures("empty_cache")
def test_with_prebuilt_fmus_a_compiler_is_spared(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    about = {"platform": "here", "sources": digest(*prebuilt.SOURCES), "contents": {"brake": "x"}, "files": {}}
    (tmp_path / prebuilt.CONTENTS).write_text(json.dumps(about))
    monkeypatch.setattr(prebuilt, "PREBUILT", tmp_path)
    monkeypatch.setenv("CC", "no-such-compiler")
    assert main(["doctor"]) == 0
    verdicts = said(capsys)
    assert (verdicts["prebuilt FMUs"], verdicts["C compiler"]) == ("ok", "without")
    (tmp_path / prebuilt.CONTENTS).write_text(json.dumps(about | {"sources": "before"}))
    assert main(["doctor"]) == 1
    assert said(capsys)["prebuilt FMUs"] == "without"

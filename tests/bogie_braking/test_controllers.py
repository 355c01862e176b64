"""The comparison of wheel-slide controllers from the command line: forms, table, failures, refusals."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

import build_fmu
from bogie_braking.__main__ import main
from brake_controller.slide_protection import RIG
from products.protection.criteria import CRITERIA
from products.protection.programme import OWN

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "controller.md").read_text(encoding="utf-8")
#: LetGo's row for the low rail on the page, with all digits shown.
LETS_GO = re.search(r"^low +LetGo +([0-9.]+)", PAGE, re.MULTILINE)


#: One stop of each case with the friction and load of the case.
ONE = ["--draws", "1", "--friction-spread", "0", "--load-spread", "0"]
LITERAL = "Gains must be numbers or texts, as in gains.py:Gains(0.3, limit=2); got"
GAINS = """
from __future__ import annotations
from dataclasses import dataclass

@dataclass
class Gains:
    share: float
    mode: str = "a:b"

    def __post_init__(self):
        if self.share == 1:
            raise TypeError("a share below 1 is due")

    def step(self, time, speeds):
        return [2 if speed < self.share * max(speeds) else 0 for speed in speeds]
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Change to a folder with the page's controllers in Python and in C, and a failing one."""
    (tmp_path / "let_go.py").write_text(block("python", "# let_go.py"))
    (tmp_path / "let_go.c").write_text(block("c", "/* let_go.c */"))
    (tmp_path / "bad.py").write_text("class Bad:\n    def step(self, time, speeds):\n        return 1 / 0\n")
    (tmp_path / "gains.py").write_text(GAINS)
    (tmp_path / "nothing.c").write_text("int nothing;\n")
    (tmp_path / "libtext.so").write_text("no library")
    (tmp_path / "wrong.c").write_text("int wrong(;\n")
    third = "fault = [{ wheelset = 3, sensor = 'zero' }]\n"
    (tmp_path / "third.toml").write_text(f"[[case]]\nname = 'a'\nrail = 'dry'\n{third}")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def block(language: str, first: str) -> str:
    """Return the code of the page whose first line is this."""
    return next(text for text in re.findall(rf"```{language}\n(.*?)```", PAGE, re.DOTALL) if text.startswith(first))


@pytest.mark.study
def test_the_controllers_of_the_page_make_the_same_stop(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    given, earlier = ["let_go.py:LetGo", "let_go.c"], folder / "results/controllers/compare.html"
    earlier.parent.mkdir(parents=True, exist_ok=True)
    earlier.write_text("of another comparison")
    assert main(["controllers", "compare", "--rails", "low", "--draws", "8", "--json", *given]) == 0
    assert not earlier.exists()
    runs = {run["controller"]: run for run in json.loads(capsys.readouterr().out)["runs"]}
    assert runs["LetGo"]["distance"] == runs["let_go"]["distance"]
    assert LETS_GO is not None
    assert f"{runs['LetGo']['estimate']['mean']:.1f}" == LETS_GO[1]
    assert len(set(runs["LetGo"]["distances"])) == 8
    assert runs["LetGo"]["distances"] == runs["let_go"]["distances"]
    assert 0.5 < runs["LetGo"]["estimate"]["half"] < 0.02 * runs["LetGo"]["distance"]
    assert runs["none"]["estimate"]["half"] < 0.5  # no sensor is involved
    assert runs["protection"]["over_ideal"] < runs["LetGo"]["over_ideal"] < runs["none"]["over_ideal"]
    assert json.loads((folder / "results/controllers/compare.json").read_text())["vehicle"] == "bogie"
    assert (folder / "results/controllers/compare.png").exists()


@pytest.mark.study
def test_a_class_of_arrays_makes_the_stops_of_the_class(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "many.py").write_text(block("python", "# many.py"))
    given = "compare --rails low --draws 2 --json let_go.py:LetGo many.py:LetAllGo"
    assert main(["controllers", *given.split()]) == 0
    runs = {run["controller"]: run for run in json.loads(capsys.readouterr().out)["runs"]}
    del runs["LetGo"]["controller"], runs["LetAllGo"]["controller"]
    assert runs["LetGo"] == runs["LetAllGo"] != runs["none"]


def test_a_controller_that_fails_does_not_end_the_comparison(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["controllers", "compare", "--rails", "dry,wet", *ONE, "bad.py:Bad"]) == 1
    shown = capsys.readouterr().out
    assert len(re.findall(r"^(dry|wet) .* no stop ", shown, re.MULTILINE)) == 2
    assert "Bad, dry: The controller Bad failed at 0 s (ZeroDivisionError: division by zero, bad.py, line 3)" in shown
    assert len(re.findall(r"^(dry|wet) +(none|protection) +259.[56] ", shown, re.MULTILINE)) == 4


@pytest.mark.study
def test_a_class_with_two_choices_of_its_gains_is_two_controllers(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    given = ["let_go.py:LetGo", "gains.py:Gains(share=0.8)", "gains.py:Gains(0.9, mode='c')"]
    assert main(["controllers", "compare", "--rails", "low", "--draws", "1", "--json", *given]) == 0
    found = {run["controller"]: run["distance"] for run in json.loads(capsys.readouterr().out)["runs"]}
    assert list(found)[2:] == ["LetGo", "Gains(share=0.8)", "Gains(0.9, mode='c')"]
    assert found["Gains(share=0.8)"] == found["LetGo"] != found["Gains(0.9, mode='c')"]


@pytest.mark.study
@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        (["bad.py:Good"], "bad.py has no class Good with a method step(time, wheel_speeds); give one that has."),
        (["none.py:Good"], "There is no file none.py; give FILE.py:CLASS."),
        (["libnone.so"], "There is no file libnone.so; give the path of a controller."),
        (["LetGo"], "A controller must be FILE.py:CLASS, a shared library, a C file, an FMU or dump-valve; got LetGo."),
        (["let_go.py:LetGo", "--rails", "slow"], "There is no rail slow; give some of dry, wet, low, changing."),
        (
            ["let_go.py:LetGo", "--speed", "25knots"],
            "--speed must be above 0 and at most 100 m/s; got 25knots. Give a number in m/s, km/h,",
        ),
        (["gains.py:Gains"], "Gains of gains.py cannot be made without arguments (TypeError: "),
        (
            ["nothing.c", "--rails", "dry", "--draws", "1"],
            "nothing is no controller (it has no function wheel_slide_size); ",
        ),
        (["libtext.so", "--rails", "dry", "--draws", "1"], "libtext is no controller"),
        (["wrong.c"], "wrong.c does not compile. The C compiler ("),
        (["let_go.c", "--programme", "third.toml"], "The case a has a fault of wheelset 3; there are 2 here."),
        (["let_go.py:LetGo", "--pulses", "0"], "--pulses must be an integer from 1 to 10000; got 0."),
        (["let_go.c", "--draws", "1000000000"], "--draws must be an integer from 1 to 10000; got 1000000000."),
        (["let_go.c", "--load-spread", "-1"], "--load-spread must be from 0 to 0.5; got -1."),
        (["let_go.py:LetGo", "--draws", "0"], "--draws must be an integer from 1 to 10000; got 0."),
        (["let_go.py:LetGo", "--jitter", "nan"], "--jitter must be from 0 to 0.5; got nan."),
        (["let_go.py:LetGo", "--jitter", "2"], "--jitter must be from 0 to 0.5; got 2."),
        (["let_go.py:LetGo", "--brake-ratio", "6"], "--brake-ratio must be above 0 and at most 5; got 6."),
        (["let_go.py:LetGo", "--rails", "low,low"], "Each of --rails must be given once; got low 2 times."),
        (["gains.py:Gains(2 * 3)"], f"{LITERAL} (2 * 3)."),
        (["gains.py:Gains(**{'gain': 1})"], LITERAL),
        (
            ["gains.py:Gains(1"],
            "A controller must be FILE.py:CLASS, a shared library, a C file, an FMU or dump-valve; got ",
        ),
        (["gains.py:Gains(1, 2)"], "Gains of gains.py cannot be made with (1, 2) (TypeError: "),
        (["gains.py:Gains(share=1)"], "Gains of gains.py cannot be made with (share=1) (TypeError: "),
        (["let_go.py:LetGo", "let_go.py:LetGo"], "Two controllers are called LetGo; give each another name."),
    ],
)
def test_what_cannot_be_is_refused_in_a_sentence(
    given: list[str], sentence: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["controllers", "compare", *given]) == 2
    assert sentence in capsys.readouterr().err  # preceded by a progress bar if compiling takes long


@pytest.mark.parametrize(
    ("action", "path"),
    [
        ("header", RIG / "wheel_slide.h"),
        ("programme", OWN),
        ("criteria", CRITERIA),
        ("client c", RIG / "udp_client.c"),
        ("client python", RIG / "udp_client.py"),
    ],
)
def test_files_to_begin_with_are_printed(action: str, path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["controllers", *action.split()]) == 0
    assert capsys.readouterr().out == path.read_text(encoding="utf-8")


@pytest.mark.study
def test_a_programme_of_ones_own_is_run(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case = '[[case]]\nname = "slow, one sensor lost"\nrail = "wet"\nspeed = "36km/h"\n'
    (folder / "my.toml").write_text(case + 'fault = [{ wheelset = 2, sensor = "zero", sensor_from = 2.0 }]\n')
    assert main(["controllers", "compare", "--programme", "my.toml", "--draws", "1", "let_go.c"]) == 0
    shown = capsys.readouterr().out
    distances = dict(re.findall(r"^slow, one sensor lost +(\w+) +([0-9.]+)", shown, re.MULTILINE))
    assert distances.keys() == {"none", "protection", "let_go"}
    # The controller releases a wheel that seems to stand still.
    assert float(distances["let_go"]) > 1.2 * float(distances["none"])
    (folder / "my.toml").write_text(case + "values = { nothing = 1.0 }\n")
    assert main(["controllers", "compare", "--programme", "my.toml", "let_go.c"]) == 2
    assert (
        capsys.readouterr().err
        == "The case slow, one sensor lost sets nothing, which this machine has not; give one of docs/variables.md.\n"
    )


@pytest.mark.study
def test_starts_are_compared_with_a_protection_of_their_own(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    case = '[[case]]\nname = "low"\nrail = "low"\nspeed = "20km/h"\nbrake_ratio = 2.0\nequipment = ["traction"]\n'
    (folder / "my.toml").write_text(case)
    assert main(["controllers", "compare", "--programme", "my.toml", "--draws", "1", "--html"]) == 0
    shown = capsys.readouterr().out
    assert shown.startswith("protection is best: it arrives in every case, after 1.")
    assert "controller  arrives  no arrival" in shown
    assert "bogie: full traction from 1 to 25 m/s unless the case says otherwise" in shown
    distances = {name: float(of) for name, of in re.findall(r"^low +(\w+) +([0-9.]+)", shown, re.MULTILINE)}
    assert distances["protection"] < 0.8 * distances["none"]
    page = (folder / "results/controllers/compare.html").read_text()
    assert "below it the torque of its motor" in page
    monkeypatch.setattr("products.protection.rig.LONGEST", 20.0)  # instead of 300 s
    (folder / "slow.toml").write_text(case.replace("low", "very_low").replace("20km/h", "300km/h"))
    assert main(["controllers", "compare", "--programme", "slow.toml", "--draws", "1"]) == 1
    assert re.search(
        r"none, very_low: It did not come to 83\.3333 m/s: \d+\.\d m/s after 20 s\.", capsys.readouterr().out
    )


@pytest.mark.parametrize(
    ("case", "words"),
    [
        ("values = { initial_speed = 9.0 }", "The case b may not set initial_speed: give speed."),
        ("values = { brake_torque_1 = 9.0 }", "The case b may not set brake_torque_1: what it gives is no input."),
        ('equipment = ["disks"]', "Equipment must be one of discs, dynamic brake, sanders, traction; got 'disks'."),
        ('equipment = "discs"', "give equipment a list of names, some of discs, dynamic brake, sanders, traction."),
        ('equipment = ["traction"]', "mixes starts such as b with stops; give each a file of its own."),
        (
            'values = { sand_rate_1 = -1.0 }\nequipment = ["sanders"]',
            "sand_rate_1 of the case b must be a finite value from 0 to 1 kg/s; got -1.",
        ),
        (
            "values = { friction_1 = 1.99 }",
            "friction_1 of the case b must be a finite value from 0 to 1.94175; got",
        ),
        ("values = { gradient = nan }", "my.toml must have finite numbers; got nan."),
        ("values = { sand_rate_1 = 0.03 }", "The case b sets sand_rate_1; give it equipment = ['sanders'] too."),
    ],
)
def test_equipment_that_cannot_be_is_refused(
    case: str, words: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "my.toml").write_text(f'[[case]]\nname = "a"\nrail = "dry"\n[[case]]\nname = "b"\nrail = "dry"\n{case}\n')
    assert main(["controllers", "compare", "--programme", "my.toml"]) == 2
    assert words in capsys.readouterr().err


@pytest.mark.study
def test_a_class_with_a_start_of_its_own_is_a_class(folder: Path) -> None:
    (folder / "own.py").write_text(
        "class Own:\n    def start(self):\n        pass\n\n    def step(self, time, speeds):\n        return [0, 0]\n"
    )
    assert main(["controllers", "compare", "--rails", "dry", "--draws", "1", "own.py:Own", "let_go.c", "--json"]) == 0


@pytest.mark.study
def test_two_forms_of_one_name_are_told_apart_by_their_files(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert build_fmu.main(["--controller", "let_go.c", "--out", "."]) == 0
    given = "compare --rails dry --draws 1 let_go.c native/let_go.fmu --json"
    assert main(["controllers", *given.split()]) == 0
    text = capsys.readouterr().out
    runs = json.loads(text[text.index("{") :])["runs"]
    distances = {run["controller"]: run["distance"] for run in runs}
    assert distances["let_go"] == distances["let_go.fmu"]

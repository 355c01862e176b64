"""FMUs around Python objects: user-defined controllers, and objects that fail."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

import build_fmu
from brake_controller.protection_fmu import wheel_slide_in_python
from brake_controller.wheel_slide import APPLY, VENT
from fmu_src.cosimulation.slave import CosimulationError, FmuInstance
from products.building import build_protection
from tests.fmu_src.fmi.hosting import THREES, answers_of_a_counter

ROOT = Path(__file__).parents[3]
PERIOD = 5e-3


def protection(out: Path, file: Path, name: str) -> Path:
    return build_protection(out, wheel_slide_in_python(file, name))


def test_outputs_hold_between_the_periods(tmp_path: Path) -> None:
    text = "class Counts:\n    n = 0\n    def step(self, t, v):\n        self.n += 1\n        return [self.n % 3, 0]\n"
    file = tmp_path / "counts.py"
    file.write_text(text)
    assert answers_of_a_counter(protection(tmp_path, file, "Counts")) == THREES


@pytest.mark.study
@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("raise RuntimeError('lost its mind')", "lost its mind"),
        ("return [5, 0]", "5"),
        ("return None", "gave"),
        ("\n        while True: pass", "used more than 1 s of processor time"),
    ],
)
def test_failing_controller_leaves_the_brake_applied_and_ends_the_run_with_a_sentence(
    tmp_path: Path, body: str, words: str
) -> None:
    file = tmp_path / "bad.py"
    file.write_text(
        f"class Bad:\n    def step(self, time, speeds):\n        if time < 0.1: return [2, 2]\n        {body}\n"
    )
    with FmuInstance(protection(tmp_path, file, "Bad")) as slave:
        slave.start(wheel_speed_1=10.0, wheel_speed_2=10.0)
        for number in range(20):  # up to 0.1 s
            slave.step(number * PERIOD, PERIOD)
        assert slave["valve_1"] == VENT
        with pytest.raises(CosimulationError, match=words) as failed:
            slave.step(0.1, PERIOD)
        assert "the brake stays applied" in str(failed.value)
        assert slave.get(("valve_1", "valve_2")) == [APPLY, APPLY]


def test_lost_sensor_applies_the_brake(tmp_path: Path) -> None:
    file = tmp_path / "vents.py"
    file.write_text("class Vents:\n    def step(self, time, speeds):\n        return [2, 2]\n")
    with FmuInstance(protection(tmp_path, file, "Vents")) as slave:
        slave.start(wheel_speed_1=10.0, wheel_speed_2=10.0)
        slave.step(0.0, PERIOD)
        assert slave["valve_1"] == VENT
        slave.set(wheel_speed_2=math.nan)
        slave.step(PERIOD, PERIOD)
        assert slave["valve_1"] == APPLY
        assert any("not a finite number" in line for line in slave.messages)


def test_one_command_makes_the_fmu_of_a_class(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    own = ROOT / "scenarios" / "bench" / "own_controller.py"
    assert build_fmu.main(["--controller", f"{own}:FixedSlip", "--out", str(tmp_path)]) == 0
    assert "valid" in capsys.readouterr().out
    with FmuInstance(tmp_path / "python" / "FixedSlip.fmu") as slave:
        slave.start(wheel_speed_1=20.0, wheel_speed_2=10.0)
        slave.step(0.0, PERIOD)
        assert slave.get(("valve_1", "valve_2")) == [APPLY, VENT]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("nowhere.py:Class", "The file nowhere.py does not exist. Check the path."),
        ("no-class-at-all", "does not become an FMU"),
    ],
)
def test_a_class_that_is_not_there_is_refused_with_a_sentence(
    text: str, words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert build_fmu.main(["--controller", text]) == 2
    assert words in capsys.readouterr().err


def test_a_file_without_the_class_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "empty.py"
    file.write_text("")
    assert build_fmu.main(["--controller", f"{file}:Mine"]) == 2
    assert "There is no class Mine" in capsys.readouterr().err


def test_the_protection_that_comes_with_the_brake_stays_out_of_a_class(tmp_path: Path) -> None:
    file, own = tmp_path / "mine.py", "from brake_controller.wheel_slide import"
    file.write_text(f"{own} APPLY\nclass Mine:  # no SlideProtection\n    pass\n")
    assert protection(tmp_path, file, "Mine").exists()
    here, broken = "from products.protection.slide_protection import", "(\n  VENT,\n  SlideProtection,\n)"
    for words in (f"{here} SlideProtection", f"{own} VENT, SlideProtection", f"{own} {broken}"):
        file.write_text(f"{words}\nclass Mine: ...\n")
        with pytest.raises(ValueError, match=r"SlideProtection must stay out of .*; it is C"):
            protection(tmp_path, file, "Mine")

"""Replay of a log: expected commands, forms of a controller, refusals."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

import bogie_braking as bb
from bogie_braking.__main__ import main
from bogie_braking.controllers.replay import read_log, replay
from products.controller_kinds import compiled
from products.protection.slide_protection import SlideProtection

LET_GO = "class LetGo:\n    def step(self, time, v):\n        return [2 if one < 0.8 * max(v) else 0 for one in v]\n"
OF_MANY = """
import numpy as np

class Many:
    def start(self, rows, count, wheelsets, period):
        pass

    def step(self, time, v):
        return np.where(v < 0.8 * v.max(axis=1, keepdims=True), 2, 0)
"""
IN_C = """
#include "wheel_slide.h"
typedef struct { int n, asked; double period; } own;
size_t wheel_slide_size(int wheelsets) { return sizeof(own) * (size_t)(wheelsets > 0); }
void wheel_slide_start(void *memory, int wheelsets, double period) { *(own *)memory = (own){wheelsets, 0, period}; }
void wheel_slide_step(void *memory, double time, const double *v, int *valve)
{
    own *self = (own *)memory;
    const int late = time > (self->asked + 0.5) * self->period || time < (self->asked - 0.5) * self->period;
    double most = 0.0;
    ++self->asked;
    for (int i = 0; i < self->n; ++i) most = v[i] > most ? v[i] : most;
    for (int i = 0; i < self->n; ++i) valve[i] = late ? 1 : v[i] < 0.8 * most ? 2 : 0;
}
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Change to a folder with a log of 4 s, a row every 10 ms; from 1 to 2.5 s wheelset 2 has half of wheelset 1's
    speed.
    """
    time = 0.01 * np.arange(401)
    slides = (time > 0.995) & (time < 2.495)
    rows = np.column_stack([time, np.full(401, 20.0), np.where(slides, 10.0, 20.0), 2.0 * slides])
    units = {"time": "s", "wheel_speed_1": "m/s", "wheel_speed_2": "m/s", "valve_2": "1"}
    bb.Recording(units, rows).write(tmp_path / "log.csv")
    (tmp_path / "let_go.py").write_text(LET_GO)
    (tmp_path / "many.py").write_text(OF_MANY)
    (tmp_path / "let_go.c").write_text(IN_C)
    (tmp_path / "bad.py").write_text(
        "class Bad:\n    def step(self, time, v):\n        return [0, int(1 / (time < 3))]\n"
    )
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.study
@pytest.mark.parametrize("given", ["let_go.py:LetGo", "many.py:Many", "let_go.c"])
@pytest.mark.parametrize("period", ["10ms", "4ms", "25ms", ""])
def test_a_valve_vents_while_its_wheel_slides(
    given: str, period: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    more = ["--period", period] if period else []
    assert main(["controllers", "replay", "log.csv", given, "--json", *more]) == 0
    told = json.loads(capsys.readouterr().out)
    step = float(period.removesuffix("ms") or 10) / 1e3
    first, second = told["wheelsets"]
    assert told["questions"] == told["answers"] == round(4.0 / step) + 1
    assert (first["apply"], first["first_command"], first["longest_vent"], first["as_in_log"]) == (1, None, 0, None)
    # The steps from 1 s to 2.5 s; the row at 2.5 s is the first that rolls.
    begin, end = np.ceil(1.0 / step - 1e-9) * step, np.ceil(2.5 / step - 1e-9) * step
    assert second["first_command"] == pytest.approx(begin)
    assert second["longest_vent"] == pytest.approx(end - begin)
    assert second["vent"] == pytest.approx(round((end - begin) / step) / told["questions"])
    assert (second["changes"], second["as_in_log"]) == (2, 1.0)
    assert (folder / "results/controllers/replay.png").exists()


def test_the_log_of_a_protected_stop_shows_the_commands_that_were_given(tmp_path: Path) -> None:
    """The log contains the sensor readings; the true speeds of the recording would give other commands."""
    seen: list[list[float]] = []

    class Heard(SlideProtection):
        def step(self, time: float, speeds: Sequence[float]) -> list[int]:
            seen.append(list(speeds))
            return list(super().step(time, speeds))

    stop = bb.protected_stop(Heard, "low", speed=8.0)
    true = replay(read_log(stop.write(tmp_path / "true.csv")), "Heard", SlideProtection, None)
    for place in range(2):
        stop[f"wheel_speed_{place + 1}"][:] = [row[place] for row in seen]
    shown = replay(stop, "Heard", SlideProtection, None)
    assert shown.as_in_log == (1.0, 1.0)
    assert max(one or 0.0 for one in true.as_in_log) < 1.0
    assert (shown.wheelsets[0]["vent"] or 0.0) > 0.05


def test_a_controller_that_fails_shows_what_it_did_before(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["controllers", "replay", "log.csv", "bad.py:Bad"]) == 1
    shown = capsys.readouterr().out
    assert "The controller Bad failed at 3 s (ZeroDivisionError: division by zero, bad.py, line 3).\n" in shown
    assert "no answer" not in shown


def test_a_controller_in_c_that_gives_no_command_is_named(folder: Path) -> None:
    (folder / "three.c").write_text(IN_C.replace("late ? 1", "time > 2.0 ? 3 : late ? 1"))
    found = replay(read_log(Path("log.csv")), "three", compiled(Path("three.c")), None)
    assert found.message.startswith("The controller three gave [3, 3] at 2.01 s where 2 commands")
    assert len(found.valves) == 201


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("time [s],speed [m/s]\n0,1\n1,1\n", "log.csv has 0 columns wheel_speed_1 [m/s] and so on; give it 1 to 16."),
        (
            "time [s],wheel_speed_2 [m/s]\n0,1\n1,1\n",
            "log.csv: the column wheel_speed_1 [m/s] is missing; there are 'time, wheel_speed_2'. Add it.",
        ),
        (
            "time [s],wheel_speed_1 [kPa]\n0,1\n1,1\n",
            "log.csv, row 1: the unit 'kPa' of wheel_speed_1 is of another quantity. Use m/s,",
        ),
        (
            "time [s],wheel_speed_1 [rpm]\n0,1\n1,1\n",
            "log.csv, row 1: the column 'wheel_speed_1 [rpm]' in rpm needs the diameter of its wheel",
        ),
        (
            "time [s],wheel_speed_1 [m/s]\n\n0,1\n1,1\n1,2\n1,3\n",
            "log.csv, row 5, column time: values must grow from row to row; got 1 s after 1 s.",
        ),
        (
            "time [s],wheel_speed_1 [m/s]\n0,1\n1,two\n",
            "log.csv, row 3, column wheel_speed_1: the value must be a number; got 'two'.",
        ),
        (
            "time [s],wheel_speed_1 [m/s]\n0,1\n1,1\n2,nan\n3,nan\n4,nan\n99,1\n",
            "log.csv: wheel_speed_1 must have no gap above 10 s, as it drives the run; got one of 98 s after 1 s.",
        ),
        ("time [s],wheel_speed_1 [m/s]\n", "log.csv must have at least 2 rows of values; it has 0."),
        (
            "time [s],wheel_speed_1 [m/s],wheel_speed_1 [m/s]\n0,1,1\n",
            "log.csv, row 1: the column wheel_speed_1 must be there once; it is there twice.",
        ),
        (
            "time [s],wheel_speed_1 [m/s],wheel_spede_2 [m/s]\n0,1,1\n1,1,1\n",
            "log.csv, row 1: the column wheel_spede_2 is unknown. Did you mean wheel_speed_2?",
        ),
        (
            "time [s],wheel_speed_1 [m/s]\n0,-1\n1,1\n",
            "log.csv: wheel_speed_1 must be from 0 to 200 m/s; got -1 to 1 m/s. Check its unit.",
        ),
        ("speed [m/s],wheel_speed_1 [m/s]\n0,1\n", "log.csv, row 1: the column time is missing"),
    ],
)
def test_a_log_that_cannot_be_replayed_is_refused(
    text: str, sentence: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "log.csv").write_text(text)
    assert main(["controllers", "replay", "log.csv", "let_go.py:LetGo"]) == 2
    assert capsys.readouterr().err.startswith(sentence)


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16"])
def test_a_log_from_a_spreadsheet_is_read(encoding: str, folder: Path) -> None:
    """It has decimal commas, and the logger's units and names."""
    text = "Time [ms];Wheel speed 1 [km/h];valve 1;cabin (degC)\r\n0;72,0;0;21,5\r\n10;36,0;2;21,5\r\n;;;\r\n"
    (folder / "log.csv").write_text(text, encoding=encoding)
    log = read_log(Path("log.csv"))
    assert log.units == {"time": "s", "wheel_speed_1": "m/s", "valve_1": "1"}
    assert log.messages == ["log.csv: left out 'cabin (degC)' (no variable)."]
    assert log["time"].tolist() == [0.0, 0.01]
    assert log["wheel_speed_1"].tolist() == [20.0, 10.0]


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["none.csv", "let_go.py:LetGo"], "The file none.csv does not exist. Check the path."),
        (["log.csv", "let_go.py:Other"], "let_go.py has no class Other"),
        (["log.csv", "let_go.py:LetGo", "--period", "2s"], "--period must be from 0.0001 to 1 s; got 2s."),
    ],
)
def test_a_replay_that_cannot_be_is_refused(
    words: list[str], sentence: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["controllers", "replay", *words]) == 2
    assert capsys.readouterr().err.startswith(sentence)

"""Runs in real time, and their reports."""

from __future__ import annotations

import json
import time
from pathlib import Path

import numpy as np
import pytest

from bogie_braking.__main__ import main
from bogie_braking.commands import pace
from bogie_braking.commands.pace import Paced
from fmu_src.cosimulation.slave import FmuInstance
from tests.conftest import Fmus


def test_a_run_takes_as_long_as_it_says_and_reports_its_steps(capsys: pytest.CaptureFixture[str]) -> None:
    main(["pace", "point", "--step", "10ms", "--seconds", "0.01", "--quiet"])  # built if necessary
    begin = time.perf_counter()
    status = main(["pace", "point", "--step", "10ms", "--seconds", "0.5", "--json"])
    assert 0.49 <= time.perf_counter() - begin < 5.0
    found = json.loads(capsys.readouterr().out)
    assert (found["steps"], found["step"], found["integration_step"]) == (50, 0.01, 0.01)
    assert status == (1 if found["overruns"] else 0)
    assert 0.0 < found["took"]["median"] <= found["took"]["99 %"] <= found["took"]["longest"]
    assert found["share"]["longest"] == pytest.approx(found["took"]["longest"] / 0.01)
    assert found["took"]["median"] < 1e-3  # 10 ms of a bogie at the point level take some microseconds


def test_a_host_that_is_too_slow_overruns(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    kept = FmuInstance.step

    def slow(self: FmuInstance, at: float, size: float) -> None:
        kept(self, at, size)
        time.sleep(3e-3)

    monkeypatch.setattr(FmuInstance, "step", slow)
    assert main(["pace", "point", "--step", "1ms", "--seconds", "0.02"]) == 1
    assert "Overruns: 20 of 20." in capsys.readouterr().out


def test_overruns_are_counted_by_the_end_of_a_step() -> None:
    found = Paced(took=np.array([0.5, 0.2, 1.1, 0.4]), late=np.array([0.0, 0.9, 0.0, 0.1]), step=1.0)
    assert found.overruns == 2
    assert found.shares()["share"]["longest"] == 1.1


def test_a_file_and_values_of_ones_own_are_run(fmus: Fmus, capsys: pytest.CaptureFixture[str]) -> None:
    for kind in ("native", "fmi3"):
        file = str(fmus["brake", kind])
        main(["pace", file, "--set", "pressure_demand=2e5", "--step", "5ms", "--seconds", "0.05", "--json"])
        assert json.loads(capsys.readouterr().out)["steps"] == 10


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        (["spatail"], "There is no FMU spatail; did you mean spatial?"),
        (["none.fmu"], "The file none.fmu does not exist."),
        (["--step", "1 hour"], "--step must be from 2e-05 to 1 s; got 1 hour."),
        (["--step", "2"], "--step must be from 2e-05 to 1 s; got 2."),
        (["--seconds", "1e-9"], "--seconds must be at least one step of 0.001 s"),
        (["--set", "level"], "--set must be NAME=NUMBER"),
        (["--set", "initial_spede=1"], "did you mean initial_speed?"),
        (["point", "--level", "planar"], "--level has no effect on point"),
    ],
)
def test_what_cannot_be_run_is_refused_with_a_sentence(
    given: list[str], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["pace", *given]) == 2
    assert sentence in capsys.readouterr().err


def test_a_run_that_fails_says_so(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["pace", "point", "--seconds", "0.1", "--set", "level=9"]) == 3
    assert "level" in capsys.readouterr().err


@pytest.mark.study
def test_the_fmu_of_a_stop_is_the_list_s(tmp_path: Path) -> None:
    """Every listed vehicle makes a stop, so that no FMU is paced at a standstill by mistake."""
    from products.registry import FMUS, model_of

    names = {name: {v.name for v in model_of(name).variables} for name in FMUS}
    assert set(pace.VEHICLES) == {name for name, of in names.items() if {"level", "brake_torque_2"} <= of} - {
        "braked-vehicle"
    }


def test_a_pace_that_is_interrupted_ends_with_a_sentence(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted(_: object) -> bool:
        raise KeyboardInterrupt("Interrupted after 7 of 9 steps.")

    monkeypatch.setattr(pace, "run", interrupted)
    assert main(["pace", "bogie"]) == 130
    assert capsys.readouterr().err == "Interrupted after 7 of 9 steps.\n"

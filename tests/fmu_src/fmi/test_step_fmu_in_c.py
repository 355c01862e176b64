"""FMUs around a controller in C without Python: outputs, saved states and refused inputs."""

from __future__ import annotations

from pathlib import Path

import pytest
from fmpy import read_model_description, simulate_fmu
from fmpy.validation import validate_fmu

import build_fmu
from brake_controller.protection_fmu import wheel_slide_protection
from brake_controller.wheel_slide import APPLY, VENT
from fmu_src.cosimulation.slave import CosimulationError, FmuInstance
from products.building import build_protection
from products.protection.slide_protection import SlideProtection
from tests.fmu_src.fmi.hosting import THREES, answers_of_a_counter
from tests.fmu_src.fmi.objects import COUNTS

PERIOD = 5e-3


@pytest.fixture(scope="module", params=["native", "fmi3"])
def counts(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("counts")
    (folder / "counts.c").write_text(COUNTS)
    given = ["--controller", str(folder / "counts.c"), "--out", str(folder), "--kind", request.param]
    assert build_fmu.main(given) == 0
    return folder / request.param / "counts.fmu"


def test_it_needs_no_python_and_is_valid(counts: Path) -> None:
    assert validate_fmu(str(counts)) == []
    about = read_model_description(str(counts))
    assert not about.coSimulation.needsExecutionTool
    assert about.coSimulation.canGetAndSetFMUstate
    result = simulate_fmu(str(counts), stop_time=0.05, start_values={"wheel_speed_1": 1.0}, output=["valve_2"])
    assert set(result["valve_2"]) == {0, 1, 2}


def test_it_is_asked_once_a_period_whatever_the_host_step(counts: Path) -> None:
    assert answers_of_a_counter(counts) == THREES


def test_a_saved_state_goes_back_with_the_memory_of_the_controller(counts: Path) -> None:
    with FmuInstance(counts) as slave:
        slave.start(wheel_speed_1=1.0, wheel_speed_2=1.0)
        slave.step(0.0, PERIOD)
        state = slave.save()
        ways = []
        for _ in range(2):
            slave.restore(state)
            way = []
            for number in range(1, 6):
                slave.step(number * PERIOD, PERIOD)
                way.append(slave["valve_1"])
            ways.append(way)
        assert ways[0] == ways[1] == [2, 0, 1, 2, 0]


def test_nonsense_leaves_the_brake_applied_and_ends_with_a_sentence(counts: Path) -> None:
    with FmuInstance(counts) as slave:
        slave.start(wheel_speed_1=1.0, wheel_speed_2=1.0)
        slave.step(0.0, PERIOD)
        slave.set(wheel_speed_2=-7.0)
        with pytest.raises(CosimulationError, match=r"gave 7 for output 2 at 0\.005 s where 0 to 2 was due"):
            slave.step(PERIOD, PERIOD)
        assert (slave["valve_1"], slave["valve_2"]) == (0, 0)
        slave.restart({}, wheel_speed_1=1.0, wheel_speed_2=1.0)
        slave.step(0.0, PERIOD)
        assert slave["valve_1"] == 1


def test_an_input_that_is_no_number_applies_the_brake(counts: Path) -> None:
    with FmuInstance(counts) as slave:
        slave.start(wheel_speed_1=1.0, wheel_speed_2=1.0)
        slave.step(0.0, PERIOD)
        slave.set(wheel_speed_1=float("nan"))
        slave.step(PERIOD, PERIOD)
        assert slave["valve_2"] == 0
        assert "Input 1 must be a finite number; got nan at 0.005 s. The outputs are 0." in slave.messages


@pytest.mark.parametrize("period", [0.0, 2.0, float("nan")])
def test_a_period_that_cannot_be_is_refused(counts: Path, period: float) -> None:
    with (
        FmuInstance(counts, period=period) as slave,
        pytest.raises(CosimulationError, match="period must be from 1e-06 to 1 s"),
    ):
        slave.start()


def test_the_period_is_fixed_once_it_runs(counts: Path) -> None:
    with FmuInstance(counts) as slave:
        slave.start(wheel_speed_1=1.0, wheel_speed_2=1.0)
        with pytest.raises(CosimulationError, match="period is a parameter and fixed once the run has begun"):
            slave.set(period=0.01)


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("p-i.c", COUNTS, "The name of the file, and of its FMU, must be of letters, digits and _; got p-i.c."),
        ("pi.c", "int wrong(;", "pi.c does not compile. The C compiler ("),
        (
            "pi.c",
            '#include "wheel_slide.h"\n',
            "pi.c must have all functions of wheel_slide.h; it lacks "
            "wheel_slide_size, wheel_slide_start, wheel_slide_step. Add them.",
        ),
    ],
)
def test_what_becomes_no_fmu_is_refused(
    name: str, text: str, words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / name).write_text(text)
    assert build_fmu.main(["--controller", str(tmp_path / name), "--out", str(tmp_path)]) == 2
    assert words in capsys.readouterr().err


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (["train"], "--controller builds an FMU of its own; got train too."),
        (["--platforms", "all"], "--controller builds for this platform; got --platforms all."),
        (["--kind", "python"], "--kind must be native or fmi3 for pi.c; got python."),
    ],
)
def test_an_option_without_effect_on_a_controller_is_refused(
    more: list[str], words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert build_fmu.main(["--controller", "pi.c", *more]) == 2
    assert words in capsys.readouterr().err


def test_the_protection_that_comes_with_the_brake_gives_the_commands_of_its_class(tmp_path: Path) -> None:
    path = build_protection(tmp_path, wheel_slide_protection())
    assert not validate_fmu(str(path))
    assert read_model_description(str(path)).modelName == "WheelSlideProtection"
    direct, seen = SlideProtection(), set()
    with FmuInstance(path) as slave:
        slave.start(wheel_speed_1=20.0, wheel_speed_2=20.0)
        for number in range(800):
            time = number * PERIOD
            speeds = [20.0 - 0.8 * time, (20.0 - 0.8 * time) * (1.0 - 0.2 * min(1.0, max(0.0, time - 1.0)))]
            slave.set(wheel_speed_1=speeds[0], wheel_speed_2=speeds[1])
            slave.step(time, PERIOD)
            commands = [int(slave["valve_1"]), int(slave["valve_2"])]
            assert commands == direct.step(time, speeds)
            seen.update(commands)
    assert {APPLY, VENT} <= seen


def test_a_coach_has_four_of_each(tmp_path: Path) -> None:
    (tmp_path / "counts.c").write_text(COUNTS)
    given = ["--controller", str(tmp_path / "counts.c"), "--out", str(tmp_path), "--wheelsets", "4"]
    assert build_fmu.main(given) == 0
    about = read_model_description(str(tmp_path / "native" / "counts4.fmu"))
    assert [v.name for v in about.modelVariables] == [
        *(f"wheel_speed_{number}" for number in range(1, 5)),
        "period",
        *(f"valve_{number}" for number in range(1, 5)),
    ]

"""Driver.fmu, and SupervisedTrain.ssp: a train under its braking curves stops alike in all masters."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from fmpy.ssp.simulation import simulate_ssp

import build_fmu
from bogie_braking.supervised import supervised_train
from fmu_src.cosimulation.slave import FmuInstance
from products.building import write_in_c
from products.etcs_files.train_file import write_train
from products.supervised_train import STEP
from products.train.driver_fmu import BELOW, BRAKES_AT, MOVED, PERIOD, SHORT, driver_fmu
from products.train.imported_consist import consist_from
from tests.fmu_src.fmi.masters import MASTERS, contents, master

#: Target [m], permitted speed [m/s], time in which the train has stopped [s].
TARGET, SPEED, LONG = 1500.0, 80.0 / 3.6, 160.0
COUNT = round(LONG / STEP)
CONSIST = """[[vehicle]]
kind = "locomotive"
vigilance_time = 30
traction_force = 300
traction_power = 5600

[[vehicle]]
kind = "coach"
count = 3
"""
#: The stop differs by less between masters by docs/checking.md [m].
BAND = 1e-6
OUTPUTS = (("driver", "distance_to_target"), ("train", "speed[1]"), ("curves", "V_P"))


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Return a consist, and its train data as bogie-braking etcs writes them."""
    folder = tmp_path_factory.mktemp("supervised")
    consist, data = folder / "consist.toml", folder / "etcs-consist.json"
    consist.write_text(CONSIST)
    train = supervised_train(consist_from(consist)[0], SPEED).train
    write_train(data, replace(train, maximum_speed=SPEED))
    return consist, data


def build(files: tuple[Path, Path], out: Path, *more: str) -> int:
    consist, data = files
    given = ["ssp", "--consist", str(consist), "--train", str(data), "--target", "1500", "--speed", "80km/h"]
    return build_fmu.main([*given, "--out", str(out), *more])


@pytest.fixture(scope="module")
def system(files: tuple[Path, Path], tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("systems")
    assert build(files, out) == 0
    return out / "SupervisedTrain.ssp"


@pytest.fixture(scope="module")
def run(system: Path) -> np.ndarray:
    """Return the run of FMPy, which reads no parameters of a system: the FMUs have them."""
    return simulate_ssp(str(system), stop_time=(COUNT - 0.5) * STEP, step_size=STEP)


@pytest.fixture(scope="module")
def driver(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("driver") / "Driver.fmu"
    write_in_c(driver_fmu(), path)
    return path


def test_a_train_runs_below_the_permitted_speed_and_stops_before_the_target(run: np.ndarray) -> None:
    speed, permitted, left = run["train.speed[1]"], run["curves.V_P"], run["driver.distance_to_target"]
    known = run["time"] > 3 * STEP  # the first limits
    assert (speed[known] <= permitted[known]).all()
    assert not run["curves.service_brake"].any()
    assert not run["curves.emergency_brake"].any()
    assert speed[-1] == 0.0
    assert 0.0 < left[-1] < MOVED * SHORT
    assert left.min() == left[-1]
    assert speed.max() == pytest.approx(SPEED - BELOW, abs=0.3)
    assert permitted.min() < 0.2 * SPEED


def test_brakes_follow_the_share_that_stops_the_train(run: np.ndarray) -> None:
    """The mean deceleration to 5 m/s is that which stops the train before the target, within a third."""
    speed, left = run["train.speed[1]"], run["driver.distance_to_target"]
    begins, slow = int(np.argmax(run["driver.driver_position"] == 3)), int(np.flatnonzero(speed > 5.0)[-1])
    mean = (speed[begins] ** 2 - speed[slow] ** 2) / (2.0 * (left[begins] - left[slow]))
    assert mean == pytest.approx(speed[begins] ** 2 / (2.0 * (left[begins] - SHORT)), rel=1.0 / 3.0)


@pytest.mark.parametrize("name", [name for name in MASTERS if name != "fmpy"])
def test_other_masters_and_the_program_in_c_give_the_same_stop(system: Path, run: np.ndarray, name: str) -> None:
    found = master(name)(system, STEP, COUNT, OUTPUTS)
    assert found == pytest.approx([run[f"{component}.{name}"][-1] for component, name in OUTPUTS], abs=BAND)


def test_values_are_in_the_structure_in_the_file_and_in_the_fmus(system: Path, files: tuple[Path, Path]) -> None:
    folder = contents(system)
    with FmuInstance(folder / "resources" / "BrakingCurves.fmu") as curves:
        assert curves["V_MRSP"] == pytest.approx(SPEED)
        own = curves["A_brake_service[1]"]
        assert curves["length"] == pytest.approx(consist_from(files[0])[0].length)
    for file in ("SystemStructure.ssd", "resources/SupervisedTrain.ssv"):
        assert f'value="{own!r}"' in (folder / file).read_text()


# ---- the driver's law ----


def acted(path: Path, speed: float, left: float, deceleration: float, **more: float) -> dict[str, float]:
    """Return what the driver does under the curve P of a constant deceleration, 3 s of build-up."""
    time = 3.0
    with FmuInstance(path, brake_time=time, front=0.0, **more) as driver:
        ahead = speed**2 / (2.0 * deceleration) + speed * (time + 4.0)
        driver.start(speed=speed, distance=2000.0 - left, V_P=60.0, distance_P=ahead)
        driver.step(0.0, PERIOD)
        assert driver["driver_position"] == 1.0
        driver.step(PERIOD, PERIOD)
        return {name: driver[name] for name in ("driver_position", "driver_step", "traction")}


@pytest.mark.parametrize("deceleration", [0.08, 0.8, 1.3])
def test_a_driver_has_braked_wherever_the_train_meets_the_permitted_speed(driver: Path, deceleration: float) -> None:
    """On P with 8 A b / (1 - b) before the target all speeds are braked; with less, that of the touch is not."""
    touches = 4.0 * deceleration * BRAKES_AT / (1.0 - BRAKES_AT)
    short = 8.0 * deceleration * BRAKES_AT / (1.0 - BRAKES_AT)

    def position(speed: float, short: float) -> float:
        on_p = speed**2 / (2.0 * deceleration) + 7.0 * speed
        return acted(driver, speed, on_p, deceleration, short=short)["driver_position"]

    for speed in (0.5 * touches, touches, 2.0 * touches, 40.0):
        assert position(speed, 1.001 * short) == 3.0
    assert position(touches, 0.98 * short) == 1.0


def test_a_driver_brakes_with_the_share_that_the_stop_needs(driver: Path) -> None:
    for share in (0.45, 0.7, 0.95):
        left = 20.0**2 / 2.0 / share + 3.0 * 20.0 + SHORT
        step = acted(driver, 20.0, left, 1.0)["driver_step"]
        assert 0.4 / 1.5 + step * (1.0 - 0.4 / 1.5) == pytest.approx(share, rel=1e-9)
    assert acted(driver, 20.0, 700.0, 1.0) == {"driver_position": 1.0, "driver_step": 0.0, "traction": 1.0}


def test_commands_of_the_on_board_unit_go_before_the_driver(driver: Path) -> None:
    """At once, not at the driver's next action; and they end with the command."""
    with FmuInstance(driver) as own:
        own.start(V_P=20.0, distance_P=10.0)
        names = ("driver_position", "driver_step", "traction")
        found = []
        time = 0.0
        for command in ({}, {"traction_cut_off": 1}, {"service_brake": 1}, {"emergency_brake": 1}, {}):
            for one in ("traction_cut_off", "service_brake", "emergency_brake"):
                own.set(**{one: command.get(one, 0)})
            own.step(time, PERIOD)
            time += PERIOD
            found.append(tuple(own.get(names)))
        assert [one[0] for one in found] == [1.0, 1.0, 3.0, 4.0, 1.0]
        assert found[2][1] == 1.0
        assert [one[2] for one in found] == [0.0, 0.0, 0.0, 0.0, 1.0]
        assert own["distance_to_target"] == pytest.approx(2000.0 - 8.0)


# ---- refusals ----


@pytest.mark.parametrize(
    ("more", "change", "message"),
    [
        (["--start-speed", "90km/h"], None, "--start-speed must be below --speed, 80 km/h; got 90 km/h"),
        (["--speed", "100km/h"], None, "--speed must be at most V_MAXTRAIN of the train data, 80 km/h"),
        ([], ("count = 3", "count = 4"), "--train must be the data of the consist"),
        (
            [],
            ("traction_force = 300\ntraction_power = 5600", ""),
            "--start-speed must be above 0 for a train without motors",
        ),
        (
            [],
            ('kind = "coach"', 'kind = "coach"\ndistributor = "aar"'),
            "needs brakes that release in part; got vehicle 2",
        ),
    ],
)
def test_what_the_driver_cannot_drive_is_refused_before_a_build(
    files: tuple[Path, Path],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    more: list[str],
    change: tuple[str, str] | None,
    message: str,
) -> None:
    _, data = files
    (tmp_path / "consist.toml").write_text(CONSIST.replace(*change) if change else CONSIST)
    assert build((tmp_path / "consist.toml", data), tmp_path / "out", *more) == 2
    assert message in capsys.readouterr().err
    assert not [*tmp_path.glob("out/**/*.fmu")]


@pytest.mark.parametrize(
    "command", [["ssp", "--target", "9"], ["ssp", "--speed", "50km/h"], ["curves", "--target", "9"]]
)
def test_an_ssp_of_a_train_needs_its_data_and_its_target(
    command: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert build_fmu.main(command) == 2
    assert "--target" in capsys.readouterr().err

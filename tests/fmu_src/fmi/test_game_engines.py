"""The component for Unity, in a small game under Mono, gives what FMPy gives with the same steps.

The game has frames of random length, slow motion, pauses, a component that is switched off, and scripts that are
compiled during play. None of these may change the motion. The page's script shows it.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import zipfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fmu_src.cosimulation.slave import FmuInstance
from tests.fmu_src.fmi.programs import MONO
from tests.needed import needed

PAGE = Path(__file__).parents[3] / "docs" / "hosts" / "game-engines.md"
#: Round-off of the time of a step, which decides how long a Jacobian is kept; relative to the size of each value.
ROUND_OFF = 1e-9
#: Interruptions of a game, all of which occur in a long one.
INTERRUPTIONS = {"hitches", "compilations", "switched_off", "pauses"}
MOTION = ("speed", "distance", "rotation_1", "slip_2", "locked_2", "brake_torque_3")
POSE = ("body_lateral", "body_bounce", "body_roll", "body_pitch", "body_yaw")
ROUGH = {"level": 3, "lateral_irregularity": 0.006, "vertical_irregularity": 0.01, "cross_level": 0.03}
#: Axes of Unity (x right, y up, z forward) from those here (x forward, y left, z up).
TO_UNITY = np.array([[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
#: Single precision of positions and angles, and products of two angles, whose order is not the same [rad].
SINGLE, SECOND_ORDER = 1e-6, 1e-5


@pytest.fixture(scope="module")
def assets(fmus: Mapping, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a compiled game, and StreamingAssets with the unpacked FMU, in a folder whose URI needs escapes."""
    project = tmp_path_factory.mktemp("50% Züge #1")
    with zipfile.ZipFile(fmus["braked-vehicle", "native"]) as archive:
        archive.extractall(project / "StreamingAssets" / "BrakedVehicle")
    [view] = re.findall(r"```csharp\n// CoachView.cs\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    (project / "CoachView.cs").write_text(view)
    shutil.copy(Path(__file__).parent / "unity.cs", project)
    scripts = [f"StreamingAssets/BrakedVehicle/documentation/{name}" for name in ("host.cs", "FmuBehaviour.cs")]
    command = [needed("mcs", packages=MONO["mcs"]), "-warnaserror", "-main:Game", "-out:game.exe", "unity.cs"]
    subprocess.run([*command, "CoachView.cs", *scripts], cwd=project, check=True)
    return project


def play(project: Path, seconds: float, start: Mapping[str, float]) -> tuple[dict[str, float], str]:
    """Return the numbers at the end of a game, and its log."""
    values = [f"{name}={value}" for name, value in start.items()]
    command = [needed("mono", packages=MONO["mono"]), "game.exe", "StreamingAssets", str(seconds), *values]
    done = subprocess.run(command, cwd=project, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr
    return {name: float(value) for name, value in map(str.split, done.stdout.splitlines())}, done.stderr


def without_interruption(fmu: Path, steps: int, start: Mapping[str, float]) -> dict[str, float]:
    """Return the outputs after these steps by FMPy. The script of the page sets its demand after a step."""
    time = 0.0
    with FmuInstance(fmu, **start) as coach:
        coach.start()
        for number in range(steps):
            step = 0.005 if number // 500 % 5 == 4 else 0.02
            brakes, slippery = number % 3000 >= 2000, number // 3000 % 2 == 1
            traction = {f"traction_torque_{i}": 0.0 if brakes else 2e3 for i in range(1, 5)}
            coach.set(friction_2=0.05 if slippery else 0.3, **traction)
            coach.step(time, step)
            coach.set(**{f"pressure_demand_{i}": 380e3 if brakes else 0.0 for i in range(1, 5)})
            time += step
        return {name: float(coach[name]) for name in (*MOTION, *POSE)}


@pytest.mark.parametrize(
    ("seconds", "start"),
    [
        (200.0, {"level": 1}),
        (200.0, {"level": 2}),
        (12.0, ROUGH),
        pytest.param(3600.0, {"level": 2}, marks=pytest.mark.study),
    ],
)
def test_a_game_with_interruptions_has_the_motion_of_a_run_without(
    seconds: float, start: dict[str, float], assets: Path, fmus: Mapping
) -> None:
    found, log = play(assets, seconds, start | {"initial_speed": 20.0})
    assert "error" not in log
    assert seconds < 100.0 or found.keys() >= INTERRUPTIONS
    expected = without_interruption(
        fmus["braked-vehicle", "native"], int(found["steps"]), start | {"initial_speed": 20.0}
    )
    assert {name: found[name] for name in expected} == pytest.approx(expected, rel=ROUND_OFF, abs=ROUND_OFF)


def test_the_scene_turns_the_axes(assets: Path) -> None:
    """A body turns by Rz(yaw) Rx(roll) Ry(pitch); Unity turns about z, then x, then y, in left-handed axes."""
    found, _ = play(assets, 3.5, ROUGH | {"initial_speed": 20.0})
    x, y, z, *angles = (found[f"place_{i}"] for i in range(6))
    place = TO_UNITY @ [found["distance"], found["body_lateral"], found["body_bounce"]]
    assert [x, y, z] == pytest.approx(place, rel=SINGLE, abs=SINGLE)
    body = Rotation.from_euler("ZXY", [found["body_yaw"], found["body_roll"], found["body_pitch"]]).as_matrix()
    unity = Rotation.from_euler("YXZ", [angles[1], angles[0], angles[2]], degrees=True).as_matrix()
    assert min(abs(found[name]) for name in ("body_yaw", "body_roll", "body_pitch")) > 10.0 * SECOND_ORDER
    assert np.abs(unity - TO_UNITY @ body @ TO_UNITY.T).max() < SECOND_ORDER


def test_a_refusal_is_logged_once_and_disables_the_component(assets: Path) -> None:
    shown, log = play(assets, 1.0, {"level": 9})
    assert shown == {}
    assert log.splitlines() == [
        "error coach: level=9 was refused with status 3. level must be at most 3; got 9. 2 stays in force. The "
        "component is disabled.",
        "refused coach: FmuBehaviour must be enabled; enable it to use its FMU.",
    ]


def test_the_end_of_a_run_is_logged_and_its_values_stay(assets: Path) -> None:
    shown, log = play(assets, 60.0, {"level": 3, "initial_speed": 30.0, "cross_level": 0.15})
    assert "Derailed" in log.splitlines()[-1]
    assert shown["distance"] == pytest.approx(30.0 * 0.02 * shown["steps"], rel=0.02)

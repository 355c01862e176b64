"""Every option of the FMU writers, set to more than its default, gives an FMU that starts and steps."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from pathlib import Path

import pytest

import bogie_braking as bb
import build_fmu
from bogie_braking import fmus
from brake_controller.protection_fmu import MOST_WHEELSETS
from fmu_src import compile as compiling
from fmu_src.cosimulation.slave import CosimulationError, FmuInstance
from products.building import build_all
from products.registry import IN_C
from products.train.layout import BRAKE_MODELS
from rbd_model.levels.models import places_of
from rbd_model.track.line import arc, line_of, straight
from rbd_model.train.coupler import COUPLERS
from tests.fmu_src.fmi.objects import COUNTS

#: Of the systems at level 3, the one that compiles fastest: contact model 1 on straight track.
SOONEST = places_of(3, 1, False)


def goes(path: Path) -> dict[str, float]:
    """Start an FMU and make steps; steps above one day are refused. Return its level and contact model."""
    with FmuInstance(path) as one:
        shown = {name: one[name] for name in ("level", "contact_model") if name in one.units}
        one.start()
        one.step(0.0, 0.01)
        for size in (86401.0, 1e300):
            with pytest.raises(CosimulationError, match="at most 86400 s"):
                one.step(0.01, size)
        one.step(0.01, 0.01)
    return shown


@pytest.fixture
def tiny(monkeypatch: pytest.MonkeyPatch) -> bb.Vehicle:
    """Return a wheelset under a frame that moves vertically only; it compiles quickly."""
    monkeypatch.setattr(compiling, "OPTIMISE_GENERATED", "-O0")
    whole = bb.vehicle("wheelset")
    frame = replace(whole.bodies[0], held=frozenset({"roll", "pitch", "yaw"}))
    return replace(whole, name="Tiny", bodies=(frame,))


@pytest.mark.study
@pytest.mark.parametrize(
    ("level", "kind"), [(1, "native"), (1, "fmi3"), (1, "python"), (2, "native"), (2, "fmi3"), (3, "native")]
)
def test_a_vehicle_at_one_level_starts_at_it_and_takes_no_other(
    level: int, kind: str, tiny: bb.Vehicle, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A refusal names the available systems: at level 3 here contact model 1 only."""
    if level == 3:
        monkeypatch.setattr(fmus, "places_of", lambda asked: SOONEST)
    path = bb.write_fmu(tiny, tmp_path / "Tiny.fmu", kind, level=level)
    assert goes(path)["level"] == level
    if kind == "python":  # pythonfmu reports refusals in its log only
        return
    other, limit = (level - 1, "least") if level > 1 else (level + 1, "most")
    with (
        FmuInstance(path, level=other) as one,
        pytest.raises(CosimulationError, match=f"level must be at {limit} {level}"),
    ):
        one.start()
    if level == 3:
        words = r"Tiny has no system for level 3, contact_model 2\. Set contact_model to 1\."
        with FmuInstance(path, contact_model=2) as one, pytest.raises(CosimulationError, match=words):
            one.start()


@pytest.mark.long
@pytest.mark.parametrize("level", [3, None])
def test_a_vehicle_with_all_depths_starts_as_well(level: int | None, tiny: bb.Vehicle, tmp_path: Path) -> None:
    path = bb.write_fmu(tiny, tmp_path / "Tiny.fmu", level=level)
    assert goes(path) == {"level": level or 2, "contact_model": 2}
    for asked, depth in product([level or 1, 3], (1, 2, 3)):
        with FmuInstance(path, level=asked, contact_model=depth) as one:
            one.start()
            one.step(0.0, 0.01)


@pytest.mark.study
@pytest.mark.parametrize("coupler", COUPLERS)
@pytest.mark.parametrize("kind", ["native", "fmi3"])
def test_each_coupler_goes(coupler: str, kind: str, tmp_path: Path) -> None:
    given = ["coupler", "--coupler", coupler, "--kind", kind, "--out", str(tmp_path)]
    assert build_fmu.main(given) == 0
    goes(tmp_path / kind / "Coupler.fmu")


@pytest.mark.study
@pytest.mark.parametrize("kind", ["native", "fmi3"])
def test_a_train_goes_at_each_depth_with_any_number_of_cells_on_a_line(kind: str, tmp_path: Path) -> None:
    (tmp_path / "consist.csv").write_text("kind,count\nlocomotive,1\nwagon,3\n")
    line = line_of([straight(200), arc(500, 400, 0.1)]).write(tmp_path / "line.csv")
    cells_of = (0.5, 1.0, 3.0)
    for brake_model, cells in (
        product(BRAKE_MODELS, cells_of) if kind == "fmi3" else zip(BRAKE_MODELS, cells_of, strict=True)
    ):
        options = {"consist": tmp_path / "consist.csv", "line": line, "brake_model": brake_model, "cells": cells}
        assert not build_all(["train"], [kind], tmp_path, **options)
        goes(tmp_path / kind / "TrainDynamics.fmu")


@pytest.mark.parametrize("wheelsets", [1, MOST_WHEELSETS])
def test_controllers_go_for_any_number_of_wheelsets(wheelsets: int, tmp_path: Path) -> None:
    (tmp_path / "counts.c").write_text(COUNTS)
    (tmp_path / "own.py").write_text(
        "class Own:\n"
        "    def __init__(self, wheelsets=2):\n        self.wheelsets = wheelsets\n"
        "    def step(self, time, speeds):\n        return [0] * len(speeds)\n"
    )
    for file in ("counts.c", "own.py:Own"):
        given = ["--controller", str(tmp_path / file), "--wheelsets", str(wheelsets), "--out", str(tmp_path)]
        assert build_fmu.main(given) == 0
    for path in tmp_path.rglob("*.fmu"):
        goes(path)


@pytest.mark.study
def test_fmus_in_c_are_built_with_all_others_and_are_native_only(tmp_path: Path) -> None:
    assert build_all([*IN_C], ["python"], tmp_path) == []
    assert not list(tmp_path.rglob("*.fmu"))
    assert build_all([*IN_C], ["native"], tmp_path) == []
    assert {path.stem for path in (tmp_path / "native").iterdir()} == {
        *("TrainDynamics", "Coupler", "WheelSpeedSensor", "BrakingCurves", "Driver")
    }

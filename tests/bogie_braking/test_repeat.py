"""A result states what was run, its file repeats it, and what cannot be repeated is refused with the reason."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.stats import truncnorm

import bogie_braking as bb
from products.sources import sources
from rbd_model.contact.creep.shen_hedrick_elkins import shen_hedrick_elkins

SCENE: dict[str, Any] = {"level": 1, "initial_speed": 25.0, "brake_torque_1": 20e3}
FRICTION = 0.15 + 0.02 * np.random.default_rng(1).standard_normal(4)


class LetGo:
    def step(self, time: float, wheel_speeds: list[float]) -> list[int]:
        return [2 if speed < 0.8 * max(wheel_speeds) else 0 for speed in wheel_speeds]


def pulled(time: float) -> float:
    return 5e3 * time


def own_vehicle(mass: float = 3e3) -> Any:
    bogie = bb.vehicle("bogie")
    return replace(bogie, name="Own", parameters=replace(bogie.parameters, frame_mass=mass))


def sheet(folder: Path) -> bb.Recording:
    (folder / "own.toml").write_text('name = "own"\nlike = "coach"\ntare = 64000\n')
    return bb.run(bb.read_vehicle(folder / "own.toml"), 2.0, names=["distance"], level=1, initial_speed=30.0)


def late() -> bb.Recording:
    """Return the first second of a Simulation whose torque begins later."""
    return bb.Simulation("bogie", **SCENE | {"brake_torque_1": ([5.0, 6.0], [2e3, 9e3])}).advance(1.0, ["speed"])


def in_pieces() -> bb.Recording:
    """Return the last piece of a run on a line, with values set between the pieces."""
    line = bb.line_of([bb.straight(80.0), bb.arc(300.0, 500.0, 0.05, 0.004)])
    bogie = bb.Simulation("bogie", line, **SCENE)
    bogie.set(brake_torque_2=([0.0, 2.0], [0.0, 9e3]))
    bogie.advance(1.0, ["speed"])
    bogie.set(brake_torque_1=0.0)
    return bogie.advance(1.5, ["speed", "distance"], 0.25)


def driven(folder: Path) -> bb.Recording:
    """Return a train of a file whose brakes are applied after a second, with one slippery vehicle."""
    (folder / "train.csv").write_text("kind,count\nlocomotive,1\nwagon,3\n")
    train = bb.train(folder / "train.csv", speed=20.0)
    train.advance(1.0)
    train.drive("service", 0.5)
    train.inputs["friction"][2] = 0.08
    train.record(2.0)
    train.drive("emergency")
    return train.record(5.0)


def tail(folder: Path) -> bb.Recording:
    vary = {("friction_1", "friction_2"): truncnorm(-np.inf, 4.0, 0.15, scale=0.02)}
    both = {**SCENE, "brake_torque_2": 20e3}
    return bb.rare("bogie", 60.0, "distance", 300.0, vary, particles=10, moves=1, **both).tail


#: Results by the names of their functions, and the arguments that their files cannot hold.
RESULTS: dict[str, tuple[Callable[[Path], bb.Recording], dict[str, Any]]] = {
    "run": (lambda folder: bb.run("bogie", 3.0, interval=0.1, **SCENE), {}),
    "run of a file": (sheet, {}),
    "run of data": (lambda folder: bb.run(own_vehicle(), 1.0, names=["speed"], **SCENE), {"what": own_vehicle()}),
    "run of a function": (
        lambda folder: bb.run("bogie", 1.0, **SCENE, brake_torque_2=pulled),
        {"brake_torque_2": pulled},
    ),
    "run of a late input": (lambda folder: late(), {}),
    "Simulation": (lambda folder: in_pieces(), {}),
    "sweep": (lambda folder: bb.sweep("bogie", 60.0, ["distance"], {"friction_1": FRICTION}, **SCENE), {}),
    "batch": (lambda folder: bb.batch("bogie", 60.0, ["distance"], friction_1=FRICTION, **SCENE).table, {}),
    "rare": (tail, {}),
    "train": (driven, {}),
    "protected_stop": (lambda folder: bb.protected_stop("protection", "low", speed=10.0), {}),
    "protected_stops": (
        lambda folder: bb.protected_stops(LetGo, rails=["dry", "low"], speed=10.0, pulses=80),
        {"controller": LetGo},
    ),
}


@pytest.mark.parametrize("name", RESULTS)
def test_a_file_repeats_its_run(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The values are those of the first run to their last bit."""
    make, absent = RESULTS[name]
    first = make(tmp_path)
    path = first.write(tmp_path / "result.csv")
    again = bb.repeat(path, **absent)
    assert first == again
    assert again.messages[-1] == f"Equal to {path} in {len(first)} columns of {first.rows} rows."
    assert again.provenance == first.provenance
    assert first.provenance["function"] == name.partition(" ")[0]
    assert first.provenance["sources"] == sources()
    for argument in absent:
        with pytest.raises(ValueError, match=rf"result\.csv cannot hold {argument}, which was .*{argument}=\.\.\."):
            bb.repeat(path)
    if not absent:
        with pytest.raises(ValueError, match=r"other must be an argument that .* cannot hold"):
            bb.repeat(path, other=1.0)


def test_a_folder_of_a_sweep_repeats_it(tmp_path: Path) -> None:
    kept = bb.sweep("bogie", 60.0, ["distance"], {"friction_1": FRICTION}, folder=tmp_path / "kept", **SCENE)
    for file in ("", "table.csv", "summary.json"):
        assert bb.repeat(tmp_path / "kept" / file) == kept


def test_files_and_equations_must_be_those_of_the_run(tmp_path: Path) -> None:
    path = sheet(tmp_path).write(tmp_path / "result.csv")
    toml, consist = tmp_path / "own.toml", tmp_path / "train.csv"
    train = driven(tmp_path)
    for file, result in ((toml, path), (consist, train)):
        file.write_text(file.read_text() + "# changed\n")
        with pytest.raises(ValueError, match=rf"{file.name} must have the content that it had in the run of"):
            bb.repeat(result)
    own = toml.rename(tmp_path / "moved.toml")
    with pytest.raises(ValueError, match=r"needs the file .*own\.toml, which does not exist here"):
        bb.repeat(path)
    own.write_text(own.read_text().removesuffix("# changed\n"))
    assert bb.repeat(path, what=own) == bb.repeat(path, what=bb.read_vehicle(own))
    with pytest.raises(ValueError, match=r"needs the file none\.toml, which does not exist here"):
        bb.repeat(path, what="none.toml")
    path = bb.run(own_vehicle(), 0.1, names=["speed"], **SCENE).write(tmp_path / "own.csv")
    with pytest.raises(ValueError, match="The equations or vehicles must be those of the run"):
        bb.repeat(path, what=own_vehicle(4e3))


@pytest.mark.parametrize("result", ["distance", "maximum(speed)"])
def test_a_creep_law_must_be_that_of_the_run(result: str) -> None:
    def law(share: float) -> Callable[[Any], tuple[Any, Any]]:
        return lambda patch: tuple(share * force for force in shen_hedrick_elkins(patch))

    table = bb.batch("bogie", 0.1, [result], creep_law=law(0.5), friction_1=FRICTION, **SCENE).table
    assert bb.repeat(table, creep_law=law(0.5)) == table
    with pytest.raises(ValueError, match="The equations or vehicles must be those of the run"):
        bb.repeat(table, creep_law=law(0.6))


def test_other_sources_are_refused_or_told(tmp_path: Path) -> None:
    path = bb.run("bogie", 0.1, names=["speed"], **SCENE).write(tmp_path / "result.csv")
    path.write_text(path.read_text().replace(f'"sources": "{sources()}"', '"sources": "older"'))
    with pytest.raises(ValueError, match=r"must be repeated by its own sources, version .* with digest older; got"):
        bb.repeat(path)
    assert "instead of" in bb.repeat(path, other_sources=True).messages[-2]


def test_a_changed_value_is_told(tmp_path: Path) -> None:
    path = bb.run("bogie", 0.1, names=["speed", "distance"], **SCENE).write(tmp_path / "result.csv")
    text = path.read_text()
    path.write_text(re.sub(r"\n0\.05,([\d.]+),", lambda row: f"\n0.05,{float(row[1]) + 0.5},", text))
    assert f"Differs from {path}: speed by up to 0.5 m/s." in bb.repeat(path).messages
    path.write_text(re.sub(r"\n0\.05,[\d.]+,", "\n0.05,,", text))
    assert f"Differs from {path}: speed by up to nan m/s." in bb.repeat(path).messages


@pytest.mark.parametrize(
    ("make", "reason"),
    [
        (lambda: bb.Recording({"time": "s"}, [[0.0]]), "must have a provenance to be repeated; it has none"),
        (lambda: restored(), "it was restored from a saved state"),
        (lambda: many_steps(), "it has more than"),
        (lambda: state_of_train(), "a saved state was restored"),
    ],
)
def test_what_cannot_be_repeated_is_refused_with_the_reason(make: Callable[[], bb.Recording], reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        bb.repeat(make())


def restored() -> bb.Recording:
    bogie = bb.Simulation("bogie", **SCENE)
    bogie.advance(0.1)
    bogie.restore(bogie.save())
    return bogie.advance(0.1)


def many_steps() -> bb.Recording:
    brake = bb.Simulation("brake")
    for _ in range(5_001):
        found = brake.advance(1e-3, ["cylinder_pressure"], 1e-3)
    return found


def state_of_train() -> bb.Recording:
    train = bb.train(2, speed=10.0)
    train.state = train.state
    return train.record(0.1)


@pytest.mark.parametrize("text", ["[]", '{"function": 3', '{"function": "run", "version": 1}', '{"function": "run"}'])
def test_a_damaged_provenance_is_refused(text: str, tmp_path: Path) -> None:
    path = tmp_path / "result.csv"
    path.write_text(f"# provenance: {text}\ntime [s]\n0\n")
    with pytest.raises(ValueError, match=r"result\.csv"):
        bb.repeat(path, other_sources=True)


def test_logs_and_tables_are_read_over_the_head(tmp_path: Path) -> None:
    stop = bb.run("bogie", 1.0, names=["speed"], **SCENE)
    log = bb.measured_from(stop.write(tmp_path / "stop.csv"))
    assert np.array_equal(log["time"], stop["time"])
    bare = stop.write(tmp_path / "bare.csv", provenance=False).read_text()
    assert bare.startswith("time [s],speed [m/s]\n")
    stop.provenance = {"source": "a test ride"}
    assert stop.write(tmp_path / "own.csv").read_text().startswith('# provenance: {"source": "a test ride"}\n')
    assert json.dumps(stop.provenance)

"""Couplers by their numbers: force over travel, slack, strength; and values without an effect."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from products.train.brake_model import select_brake_model
from products.train.consist import Consist
from products.train.consist_file import consist_of, read_consist
from products.train.consist_writer import write_consist
from products.train.numbers import Settings, numbers_of
from products.train.train import Train
from rbd_model.train.coupler import COUPLERS, Coupler, coupling

DATA: dict[str, Any] = {
    "coupler_stiffness": 8.0,
    "coupler_preload": 25.0,
    "coupler_slack": 10.0,
    "coupler_damping": 0.6,
}
COUPLING = coupling()


def of(**row: Any) -> Coupler:
    """Return the coupler behind a wagon of a row."""
    return consist_of([{"kind": "wagon", "valve": "head"} | row]).vehicles[0].coupler


def forces(one: Coupler, ways: np.ndarray) -> np.ndarray:
    """Return the forces over a course of travels from rest [N]."""
    rest, found = 0.0, []
    for way in ways:
        force, rest = np.ravel(np.asarray(COUPLING(way, 0.0, rest, one.constants())))
        found.append(force)
    return np.array(found)


@pytest.mark.study
def test_a_coupler_loads_by_its_stiffness_and_unloads_below_by_its_damping() -> None:
    """F = P + K (s - slack) while it loads, that times 1 - damping while it unloads (Hooke)."""
    one = of(**DATA)
    up = np.linspace(0.0, 0.09, 9_001)
    course = forces(one, np.r_[up, up[::-1]])
    reached = 25e3 / one.sticking_stiffness
    for way, share, at in ((0.05, 1.0, 5_000), (0.08, 1.0, 8_000), (0.05, 0.4, 2 * 9_001 - 1 - 5_000)):
        assert course[at] == pytest.approx(share * (25e3 + 8e6 * (way - 0.01 - reached)), rel=1e-9)
    assert np.all(course[:999] == 0.0)
    assert forces(one, -up) == pytest.approx(-forces(one, up))


def test_numbers_that_are_not_given_are_those_of_the_built_in_coupler() -> None:
    for name, made in COUPLERS.items():
        assert of(coupler=name) == made()
        assert replace(of(coupler=name, coupler_strength=850.0), strength=made().strength) == made()
    ways = np.linspace(0.0, 0.1, 1001)
    gear, wider = of(coupler="draft-gear"), of(coupler="draft-gear", coupler_slack=21.9)
    assert forces(wider, ways)[100:] == pytest.approx(forces(gear, ways)[:-100], abs=1e-3)
    screw, loose = of(), of(coupler_slack=15.0)
    assert forces(loose, ways)[:150] == pytest.approx(np.zeros(150), abs=1e-6)
    assert forces(loose, ways)[200:] == pytest.approx(forces(screw, ways)[50:-150], rel=1e-9)
    assert np.array_equal(forces(loose, -ways), forces(screw, -ways))


@pytest.mark.parametrize("row", [{"coupler": "rigid"}, {"coupler_stiffness": 60.0}, {"coupler_stiffness": 50.0}])
def test_a_damping_without_effect_is_refused(row: dict[str, Any]) -> None:
    """Friction that sticks at the slope of loading never slides: the force returns on the line on which it came."""
    one, up = of(**row), np.linspace(0.0, 0.09, 901)
    assert not one.dissipates
    for way in (up, -up):
        course = forces(one, np.r_[way, way[::-1]])
        assert course[901:] == pytest.approx(course[:901][::-1], rel=1e-9, abs=1e-3)
    with pytest.raises(ValueError, match=r"coupler_damping must come with a coupler_stiffness below (50|1000) MN/m"):
        of(coupler_damping=0.3, **row)
    assert of(coupler_damping=0.0, **row).sticking_stiffness == one.sticking_stiffness


@pytest.mark.parametrize(
    "row", [{"coupler": "draft-gear"}, {"coupler_stiffness": 8.0}, {"coupler_stiffness": 8.0, "coupler_slack": 9.0}]
)
def test_a_damping_takes_its_share_of_the_force(row: dict[str, Any]) -> None:
    up = np.linspace(0.0, 0.09, 451)
    for damping in (0.2, 0.6):
        one = of(coupler_damping=damping, **row)
        assert one.dissipates
        course = forces(one, np.r_[up, up[::-1]])
        assert course[2 * 451 - 1 - 150] == pytest.approx((1 - damping) * course[150], rel=1e-9)


def torn(model: str = "whole", **row: Any) -> Train:
    """Return a train whose locomotive pulls with 300 kN at two braked wagons."""
    strength = {"coupler_strength": 200.0, **row}
    rows = [{"kind": "locomotive", **strength}, {"kind": "wagon", "count": 2, **strength}]
    train = Train(consist_of(rows), speed=5.0, settings=Settings(model, cells=1.0))
    train.inputs["pull"] = np.array([400e3, -200e3, -200e3])
    train.inputs["friction"] = 2.0
    return train


@pytest.mark.parametrize("model", ["whole", "empirical"])
def test_a_coupler_above_its_strength_breaks_and_parts_the_pipe(model: str) -> None:
    train = torn(model)
    train.advance(2.0)
    assert 200e3 < train.largest_tension < 230e3  # it breaks after the step in which it is exceeded
    assert train.largest_tension_at == 1.0
    assert train.coupler_force[0] == 0.0
    (told,) = train.messages
    assert told.startswith("The rear coupler of vehicle 1 broke at 0.")
    train.inputs["pull"] = 0.0
    train.advance(20.0)
    assert train.messages == [told]
    assert train.pipe_pressure[1:] == pytest.approx([0.0] * 2, abs=2e3)
    assert train.pipe_pressure[0] < 3.5e5  # the driver's valve feeds a hose that is open
    assert train.cylinder_pressure[1] > 3.5e5
    assert torn(model, coupler_strength=9000.0).largest_tension == 0.0


def test_a_broken_coupler_is_saved_restored_and_joined_again() -> None:
    train = torn()
    train.advance(2.0)
    state, own = train.state, []
    for one in (train, torn()):
        one.state = state
        one.inputs["pull"] = 0.0
        one.advance(5.0)
        own.append(np.r_[one.speed, one.pipe_pressure, one.coupler_force])
    assert np.array_equal(*own)
    assert one.messages == train.messages != []
    train.inputs["coupling_closed"] = 0.0
    train.advance(0.1)
    train.inputs["coupling_closed"] = 1.0
    train.advance(30.0)
    assert train.pipe_pressure[1:].max() < 1e3  # far apart
    motion = train.motion
    motion[0, 1:] += motion[0, 0] - motion[0, 1]
    motion[1:3] = 0.0
    train.motion = motion
    train.advance(30.0)
    assert np.all(train.pipe_pressure > 4.5e5)  # a new request joins the hose of vehicles that touch


@pytest.mark.parametrize("name", ["a.toml", "a.csv"])
def test_couplers_are_written_and_read(name: str, tmp_path: Path) -> None:
    rows = [{"kind": "locomotive", **DATA}, {"kind": "wagon", "coupler": "draft-gear", "coupler_strength": 850.0}]
    own = consist_of([*rows, {"kind": "wagon", "coupler": "rigid", "coupler_slack": 3.0}, {"kind": "wagon"}])
    write_consist([*rows, {"kind": "wagon"}], tmp_path / name)
    assert read_consist(tmp_path / name) == consist_of([*rows, {"kind": "wagon"}])
    write_consist(Consist(own.vehicles[:2]), tmp_path / name)
    for one, again in zip(own.vehicles, read_consist(tmp_path / name).vehicles, strict=False):
        assert again.coupler.values() == pytest.approx(one.coupler.values(), rel=1e-9)
        assert again.coupler.strength == pytest.approx(one.coupler.strength)


UNUSED: dict[str, tuple[dict[str, Any], Settings]] = {
    "auxiliary": ({"auxiliary": 150.0}, Settings("empirical", cells=1.0)),
    "coupler_strength": ({"coupler_strength": 850.0}, Settings("empirical", cells=0.5)),
    "pipe_diameter": ({"pipe_diameter": 25.0}, Settings("delay", cells=1.0)),
    "leak": ({"leak": 2.0}, Settings("delay", cells=1.0)),
    "branch": ({"branch": 2.0}, Settings("delay", cells=1.0)),
}


@pytest.mark.parametrize("name", UNUSED)
def test_a_brake_model_that_does_not_use_a_value_is_refused_and_not_chosen(name: str) -> None:
    row, settings = UNUSED[name]
    consist = consist_of([{"kind": "locomotive", **row}, {"kind": "wagon", "count": 2, **row}])
    with pytest.raises(ValueError, match=f"{name} of vehicle 1 has no effect with brake_model = "):
        numbers_of(consist, settings, None)
    chosen = select_brake_model(consist, distance=0.1, force=0.5)
    assert numbers_of(consist, chosen, None).size
    assert chosen != settings


def test_a_preload_without_a_stiffness_is_refused() -> None:
    with pytest.raises(ValueError, match="coupler_preload must come with coupler_stiffness"):
        of(coupler_preload=20.0)

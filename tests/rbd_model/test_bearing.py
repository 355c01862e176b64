"""Test the contact of model 2 over its breadth: closed forms, conservation of energy, strips, and measured wheels."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.polynomial import Polynomial

import bogie_braking as bb
from fmu_src.system import System
from rbd_model.body.kinematics import direction_cosines
from rbd_model.contact.bearing import APPROACHES, DEEPEST, IN_CONTACT, PartContour, bearing_of, overlaps_at
from rbd_model.contact.distance import Stand
from rbd_model.contact.geometry import Pair, Side, Sides, european_pair, synthetic_pair
from rbd_model.contact.normal import Steel
from rbd_model.contact.normal import patches as strips_of
from rbd_model.contact.pair_file import write_pair
from rbd_model.contact.pair_table import patch_records
from rbd_model.contact.patches import parts_of, patches_of
from rbd_model.contact.profiles import Profile, from_points
from rbd_model.vehicle.ready import two_axle_bogie
from rbd_model.wheelset.touching_patch import InNumbers, TouchingPatch, part_of_patch

DATA = Path(__file__).parents[1] / "data" / "contact"
STEEL, MODULUS = Steel(82e9, 0.25), 82e9 / 0.75
#: Error of the quadrature of an overlap by points 0.04 mm apart, as a share of depth and curvature: 0.5 mm of breadth.
QUADRATURE = 5e-3
#: Work over a closed cycle as a share of the largest energy; the quadrature of the work has 2e-5.
CLOSED = 1e-4
#: Error of central differences over 1e-7 of a coordinate, as a share of the largest force or moment.
DIFFERENCES = 1e-5
#: Load at a height compared with that of strips, the largest error on treads and root of S1002 and of A of EN 15302.
OF_STRIPS = 0.07
#: Largest wheel load in a curve entry and steps, over those of the synthetic pair, which bears on arcs alone.
LOADS, STEPS = 1.1, 2.0


@lru_cache
def measured(name: str) -> Sides:
    """Return a reference wheel of EN 15302 on its rail."""
    return bb.pair(DATA / f"en15302_RUIC519{name}.csv", DATA / "en15302_SUIC519A.csv")


PAIRS = {"synthetic": synthetic_pair, "S1002": european_pair, "A": lambda: measured("A"), "H": lambda: measured("H")}


def flat_rail() -> Profile:
    """Return a rail that is a line, so that a gap is the contour of its wheel."""
    y = np.linspace(-30e-3, 30e-3, 601)
    return from_points("line", "closed form", y, np.zeros_like(y))


def contour(height: np.ndarray, place: np.ndarray) -> PartContour:
    return PartContour(0.0, place, place, height, height, flat_rail(), 0.46)


@pytest.mark.parametrize("curvature", [0.3, 5.0, 60.0])
def test_a_parabola_keeps_its_depth_and_its_curvature(curvature: float) -> None:
    place = np.arange(-20e-3, 20e-3, 0.04e-3)
    found = overlaps_at(contour(curvature * (place - 3e-3) ** 2, place), 0.0)
    assert found is not None
    for one in found:
        assert one.height == pytest.approx(0.0, abs=QUADRATURE * APPROACHES[0])
        assert one.curvature == pytest.approx(curvature, rel=QUADRATURE)
        assert one.place == pytest.approx(3e-3, abs=1e-6)


def test_two_equal_places_have_a_quarter_of_the_curvature_and_lie_between() -> None:
    """F doubles at the same depth, and F is proportional to B^-0.5. A ridge of 0.2 mm parts them."""
    place, apart = np.arange(-20e-3, 20e-3, 0.04e-3), 5e-3
    found = overlaps_at(contour(8.0 * np.minimum((place - apart) ** 2, (place + apart) ** 2), place), 0.0)
    assert found is not None
    for one in found:
        assert one.curvature == pytest.approx(2.0, rel=QUADRATURE)
        assert one.place == pytest.approx(0.0, abs=1e-5)


def test_a_deep_overlap_is_limited() -> None:
    """A hollow of the least breadth, as at the end of a profile, ends the search."""
    place = np.arange(-1e-3, 1e-3, 0.04e-3)
    found = overlaps_at(contour(np.where(np.abs(place) < 0.1e-3, 0.0, 10 * DEEPEST), place), 0.0)
    assert found is not None
    assert all(math.isfinite(one.curvature) and abs(one.height) < DEEPEST for one in found)


def test_a_wall_at_the_end_of_a_rail_bears_one_point() -> None:
    """A wall of 24:1 is so steep that all depths are DEEPEST."""
    y, place = np.linspace(-30e-3, 30e-3, 601), np.arange(29.1e-3, 40e-3, 0.04e-3)
    rail = from_points("wall", "closed form", y, 24.0 * np.maximum(29e-3 - y, -1e-3))
    found = overlaps_at(PartContour(0.0, place, place, 0 * place, 0 * place, rail, 0.46), 0.0)
    assert found is not None
    assert all(math.isfinite(one.height) and one.stiffness > 0.0 for one in found)


@lru_cache
def functions_of(one: Side) -> tuple[ca.Function, ...]:
    """Return the `TouchingPatch` of each patch of a left wheel as a function of lateral position, height, yaw, roll."""
    found, place = [], ca.SX.sym("place", 4)
    wheel = ca.SX([1.0, one.radius, one.wheel_half_distance, one.rail_half_distance])
    fixed = ca.vertcat(direction_cosines(place[2], place[3]), wheel, MODULUS)
    for number, record in enumerate(patch_records(one)):
        system = System("patch", "one patch")
        part = part_of_patch(f"own_{number}", InNumbers(record))
        found.append(ca.Function("touch", [place], [system.expand(system.call(part, place, fixed))]))
    return tuple(found)


def pressed(one: Side, place: np.ndarray) -> tuple[float, np.ndarray, float]:
    """Return energy [J], elastic forces and moments by the coordinates, and the largest approach [m] of all patches."""
    found = [TouchingPatch.of(ca.SX(touch(place))) for touch in functions_of(one)]
    forces = np.sum([np.array(ca.evalf(patch.push)).ravel() for patch in found], axis=0)
    return sum(float(patch.stored) for patch in found), forces, max(float(patch.approach) for patch in found)


def pressed_place(one: Side, rng: np.random.Generator, approach: float) -> np.ndarray:
    """Return a random position at which the wheel is pressed by an approach [m]."""
    place = np.array([rng.uniform(-8e-3, 8e-3), one.radius, rng.uniform(-8e-3, 8e-3), rng.uniform(-2e-3, 2e-3)])
    for _ in range(4):
        place[1] += pressed(one, place)[2] - approach
    return place


@pytest.mark.study
@pytest.mark.parametrize("pair", PAIRS)
def test_elastic_forces_are_the_derivatives_of_the_energy(pair: str) -> None:
    one, rng = PAIRS[pair]().left, np.random.default_rng(1)
    for approach in (30e-6, 80e-6):
        place = pressed_place(one, rng, approach)
        forces = pressed(one, place)[1]
        steps = 1e-7 * np.eye(4)
        slopes = [(pressed(one, place + step)[0] - pressed(one, place - step)[0]) / 2e-7 for step in steps]
        assert np.abs(forces + slopes).max() < DIFFERENCES * np.abs(forces).max()
        assert forces[1] > 1e3


@pytest.mark.study
@pytest.mark.parametrize("pair", PAIRS)
def test_no_work_is_done_over_a_closed_cycle_without_friction(pair: str) -> None:
    """Ellipses of 1 to 100 um and urad in lateral position, height, yaw and roll, about random positions."""
    one, rng = PAIRS[pair]().left, np.random.default_rng(2)
    turn = 2 * np.pi * np.arange(48) / 48
    for _ in range(4):
        middle, size = pressed_place(one, rng, 60e-6), 10 ** rng.uniform(-6, -4)
        ahead, aside = size * rng.normal(size=(2, 4))
        places = middle + np.outer(np.cos(turn), ahead) + np.outer(np.sin(turn), aside)
        along = -np.outer(np.sin(turn), ahead) + np.outer(np.cos(turn), aside)
        found = [pressed(one, place) for place in places]
        work = sum(forces @ way for (_, forces, _), way in zip(found, along, strict=True)) * 2 * np.pi / turn.size
        assert abs(work) < CLOSED * max(energy for energy, _, _ in found)


@pytest.mark.study
@pytest.mark.parametrize("pair", ["S1002", "A"])
def test_loads_are_those_of_strips_from_the_tread_to_the_root(pair: str) -> None:
    """Strips solve for the pressure (Knothe 1984, Kalker 1982). Places merge, part and jump between these shifts.

    Beyond them S1002 bears on two patches with a ridge of 37 um, which carry up to a third more (docs/limits.md).
    """
    sides = PAIRS[pair]()
    one = sides.left
    alone = Pair(one.wheel, one.rail, one.radius, one.wheel_half_distance, one.rail_half_distance)
    for shift in np.arange(-4e-3, 4.5e-3, 0.75e-3):
        place = np.array([shift, one.radius, 0.0, 0.0])
        place[1] += pressed(one, place)[2]
        for approach in (40e-6, 80e-6):
            at = place - [0.0, approach, 0.0, 0.0]
            strips = strips_of(alone, Stand(shift, float(at[1]), 0.0, 0.0), STEEL)
            up = sum(float(np.sum(patch.loads * np.cos(patch.strips.angle))) for patch in strips)
            assert pressed(one, at)[1][1] == pytest.approx(up, rel=OF_STRIPS)


@pytest.mark.study
def test_tables_of_a_jump_are_smooth() -> None:
    """Contact of S1002 jumps by 10 mm near the centre. Its place moves by less than a millimetre in a tenth of one."""
    one = european_pair().left
    jumps = [np.nanmax(np.abs(np.diff(part.nearest))) for part in patches_of(one)]
    assert max(jumps) > 3e-3
    assert len(parts_of(one)) > len(patches_of(one))
    for record in patch_records(one)[:1]:
        breakpoints, rows = record.tables[3]
        offsets, place = np.array(breakpoints), IN_CONTACT.index("place")
        bears = (offsets[:-1] > -12e-3) & (offsets[:-1] < -6e-3)
        usual = np.array(rows)[bears][:, 4 * (len(IN_CONTACT) + place)]
        assert np.abs(np.diff(usual)).max() < 1e-3


def entry(**values: float | str) -> tuple[float, float, int]:
    """Return the largest and the least wheel load [N] of the coach that enters a curve of 300 m, and the steps."""
    before, curve = bb.straight(30), bb.arc(length=120, radius=300, cant=0.12)
    line = bb.line_of([before, bb.clothoid(72, before, curve), curve])
    names = [f"wheel_load_{number}_{side}" for number in (1, 2, 3, 4) for side in ("left", "right")]
    found = bb.run("coach", 12.0, line, names, interval=2e-3, level=3, initial_speed=60 / 3.6, **values)
    loads = np.array([found[name] for name in names])
    return float(loads.max()), float(loads.min()), int(found.counts["steps"])


@pytest.mark.study
def test_measured_wheels_run_calmly_into_a_curve(tmp_path: Path) -> None:
    most, least, steps = entry()
    for name, pair in PAIRS.items():
        largest, smallest, own = entry(profile_file=str(write_pair(pair(), tmp_path / f"{name}.csv")))
        assert largest < LOADS * most
        assert smallest > least / LOADS
        assert own < STEPS * steps


#: A straight run on which no pair hunts.
SLOW: dict[str, Any] = {"level": 3, "initial_speed": 8.0, "initial_lateral": 3e-3}


@pytest.mark.long
@pytest.mark.parametrize("pair", ["S1002", "H"])
def test_loads_on_measured_wheels_are_those_of_strips_over_time(pair: str) -> None:
    """Straight track from 3 mm aside, contact models 2 and 3. The start of model 3 is left out (docs/limits.md)."""
    bogie, most = two_axle_bogie(), []
    vehicle = replace(bogie, wheelsets=tuple(replace(one, pair=PAIRS[pair]()) for one in bogie.wheelsets))
    names = [f"wheel_load_{number}_{side}" for number in (1, 2) for side in ("left", "right")]
    for model in (2, 3):
        found = bb.run(vehicle, 2.0, names=names, interval=1e-3, contact_model=model, **SLOW)
        most.append(max(np.max(found[name][found["time"] > 0.5]) for name in names))
    assert most[0] == pytest.approx(most[1], rel=0.03)


def test_a_table_ends_without_stiffness() -> None:
    """Beyond the searched offsets the first quantity of a packed table is constant and the others are 0."""
    one = european_pair().left
    place = np.arange(-20e-3, 20e-3, 0.04e-3)
    offsets = np.arange(-2e-3, 2e-3, 0.1e-3)
    depth = np.asarray(one.wheel.height(place))
    found = bearing_of(PartContour(0.0, place, place, depth, depth, one.rail, one.radius), offsets)
    for breakpoints, rows in (found.at_first, found.in_contact):
        assert breakpoints.size == len(rows) + 1 == offsets.size - 2
    stiffness = [Polynomial(row[4:8])(0.0) for row in found.in_contact[1]]
    assert min(stiffness) > 0.0

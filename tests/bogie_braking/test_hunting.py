"""Critical speeds of vehicles: eigenvalues against runs, with drag; large motions above and below their speed."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import bogie_braking as bb
from bogie_braking import hunting
from bogie_braking.hunting import (
    FASTEST,
    FRICTION,
    START,
    LargeMotion,
    Subject,
    large_speed_of,
    linear_speed_of,
    modes_of,
    start_of,
)
from bogie_braking.vehicle_files.check import Hunting, VehicleCheck
from bogie_braking.vehicle_files.page import critical_table
from products.vehicle_sheet import DataSheet
from products.vehicle_toml import built_in_sheet
from rbd_model.contact.pair_file import write_pair

DATA = Path(__file__).parents[1] / "data" / "contact"
#: Linear critical speed of the coach [m/s], and its change by ten times the drag of section 8.3 on each wheelset [N.m]:
#: 650 N.m is 1.5 % of the friction of its wheels.
COACH, DRAG, CHANGE = 96.66, 650.0, 0.1
#: Relative error of a growth from a run: round-off and other motions at its ends.
GROWTH = 0.02
#: Relative error of the bounce: its formula has no contacts.
BOUNCE = 0.01
#: Relative distance from the lowest speed of a large motion at which runs persist or end, and their length [s].
AWAY, LENGTH = 0.02, 15.0


@lru_cache
def coach() -> Subject:
    return Subject.of(built_in_sheet("coach"))


@lru_cache
def linear_speed(drag: float = 0.0) -> float:
    return linear_speed_of(coach(), rolling_resistance_torque=drag)


@lru_cache
def large_speed() -> float:
    return large_speed_of(coach(), START)


def with_profiles(folder: Path) -> DataSheet:
    pair = bb.pair(DATA / "en15302_RUIC519B.csv", DATA / "en15302_SUIC519A.csv")
    return replace(built_in_sheet("coach"), profile_files=(write_pair(pair, folder / "pair.csv"),))


@pytest.mark.study
def test_a_steady_drag_hardly_moves_the_linear_critical_speed() -> None:
    """At zero creepage Polach's law has no slope: with it the same drags give 96.7 and 101.6 m/s."""
    assert linear_speed() == pytest.approx(COACH, abs=0.01)
    assert linear_speed(DRAG) == pytest.approx(linear_speed(), abs=CHANGE)


@pytest.mark.study
@pytest.mark.parametrize("speed", [93.0, 100.0])
def test_a_small_motion_in_a_run_with_linear_creep_grows_as_its_eigenvalue(speed: float) -> None:
    values: Any = {f"friction_{number}": FRICTION for number in (1, 2, 3, 4)}
    values |= {"initial_speed": speed, "initial_lateral": 1e-5, "constant_speed": 1.0, "tolerance": 1e-9}
    run = bb.Simulation("coach", level=3, contact_model=2, creep_law="kalker-linear", **values)
    run.advance(10.0)  # until other motions have decayed
    sizes = [np.square(run.advance(5.0, ["lateral_1"])["lateral_1"]).mean() for _ in range(2)]
    growth = float(np.log(sizes[1] / sizes[0]) / (2 * 5.0))
    assert growth == pytest.approx(max(mode.growth for mode in modes_of(coach(), speed)), rel=GROWTH)


@pytest.mark.study
@pytest.mark.parametrize(("ratio", "stays"), [(1 + AWAY, True), (1 - AWAY, False)])
def test_a_large_motion_persists_above_the_reported_speed_and_ends_below(ratio: float, stays: bool) -> None:
    speed = {"initial_speed": ratio * large_speed(), "initial_lateral": START, "constant_speed": 1.0}
    values: Any = coach().values(**speed)
    seen = bb.run("coach", LENGTH, None, ["lateral_1"], **values)
    last = np.abs(seen["lateral_1"][-100:]).max()
    assert last > START if stays else last < START / 10
    assert large_speed() < 0.95 * linear_speed()


@pytest.mark.study
def test_a_motion_that_slowed_down_persists_at_the_reported_speed() -> None:
    run = LargeMotion(coach(), 1.05 * large_speed(), START)
    assert run.persists()
    assert run.last_speed() == pytest.approx(large_speed(), rel=5e-3)


@pytest.mark.study
def test_critical_speeds_are_those_of_the_profiles_of_the_file(tmp_path: Path) -> None:
    sheet = Subject.of(with_profiles(tmp_path))
    assert abs(linear_speed_of(sheet) - linear_speed()) > 0.5
    start = start_of(sheet)
    assert 6e-3 < start < START  # the flange bears at 6.5 mm
    assert abs(large_speed_of(sheet, start) - large_speed()) > 1.0


def test_the_bounce_of_a_coach_is_that_of_two_masses_on_two_springs() -> None:
    """Car body and both frames move vertically on springs and dampers; wheels stand on rigid rails."""
    modes, vehicle = bb.modes("coach", 30.0), bb.vehicle("coach")

    def size(name: str) -> float:
        return vehicle.number(name)

    masses = np.diag([size("body_mass"), 2 * size("frame_mass")])
    matrices = []
    for kind in ("stiffness", "damping"):
        upper, lower = 4 * size(f"secondary_vertical_{kind}"), 8 * size(f"vertical_{kind}")
        matrices.append(np.linalg.solve(masses, np.array([[upper, -upper], [-upper, upper + lower]])))
    state = np.block([[np.zeros((2, 2)), np.eye(2)], [-matrices[0], -matrices[1]]])
    expected = min((one for one in np.linalg.eigvals(state) if one.imag > 0.0), key=abs)
    row = modes.messages.index("bounce of the body")
    assert modes["frequency"][row] == pytest.approx(expected.imag / (2 * np.pi), rel=BOUNCE)
    assert modes["growth"][row] == pytest.approx(expected.real, rel=BOUNCE)


@pytest.mark.study
def test_a_vehicle_of_its_own_hunts_as_the_built_in_one_with_the_same_numbers() -> None:
    own = replace(bb.vehicle("coach"), name="Own")
    assert bb.critical_speed(own) == pytest.approx(linear_speed(), rel=1e-6)
    assert bb.critical_speed("coach", START) == pytest.approx(large_speed(), rel=1e-6)


def test_speeds_amplitudes_and_names_without_meaning_are_refused() -> None:
    with pytest.raises(ValueError, match="speed must be above 0 and at most 150 m/s; got 160"):
        bb.modes("coach", 160.0)
    with pytest.raises(ValueError, match=r"amplitude must be 0\.003 to 0\.011 m, or left out for small motions; got 8"):
        bb.critical_speed("coach", 8)
    with pytest.raises(KeyError, match="There is no variable friction_9"):
        bb.critical_speed("coach", friction_9=0.3)


@pytest.mark.study
def test_a_search_that_ends_below_the_hunting_finds_no_speed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(hunting, "FASTEST", 0.9 * large_speed())
    assert math.isinf(linear_speed_of(coach()))
    assert math.isinf(large_speed_of(coach(), START))


@pytest.mark.study
def test_the_table_names_speeds_profiles_and_dampers_and_says_up_to_which_speed_nothing_hunts(tmp_path: Path) -> None:
    sheet = replace(with_profiles(tmp_path), assumed={"lateral_damping": "as the coach"})
    check = VehicleCheck(sheet, (), (), Hunting(linear_speed(), math.inf, START), None)
    assert check.hunting
    _, _, rows = critical_table(check, check.hunting)
    cells = {row[0]: row[1:] for row in rows}
    assert cells["small motion grows above"][:2] == ("348", "96.7")
    assert cells["large motion persists from"][:2] == (f"none up to {3.6 * FASTEST:.0f}", f"none up to {FASTEST:g}")
    assert cells["profiles"][2] == "pair.csv"
    assert cells["dampers"][2] == "1 of 7 assumed, as the coach"
    assert cells["between both speeds"][2] == "a large motion decays below 3 mm, a small one grows"
    _, _, rows = critical_table(check, Hunting(linear_speed(), 0.94 * linear_speed(), START))
    assert rows[-1][-1] == "a disturbance, such as a switch, can start lasting hunting"
    _, _, rows = critical_table(check, Hunting(math.inf, math.inf, START))
    assert rows[-1][0] == "dampers"

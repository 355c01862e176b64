"""Test laws of shoe friction, as functions and in the kernel, and the torque's rate from an empty cylinder."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest

from brake_controller.cylinder import brake_cylinder
from brake_controller.parameters import qr30
from brake_controller.shoe_friction import (
    CAST_IRON_P6,
    CAST_IRON_P10,
    COMPOSITE,
    COMPOSITE_BLOCKS,
    COMPOSITE_BY_FORCE,
    CONSTANT,
    EXAMPLE_TABLE,
    FALLING,
    P10,
    REST_SPEED,
    TABULATED,
    Fractions,
    FrictionTable,
    cast_iron_p6,
    composite,
)
from fmu_src.compile import build_library
from fmu_src.kernel import Kernel, Library

#: Rounding of the numbers below, which have four decimals.
PRINTED = 5e-5
#: Shoe force [kN], speed [km/h], friction: the formula with N in kN and V in km/h, calculated by hand.
P6_NUMBERS = [
    *((5, 0, 0.4629), (5, 10, 0.3394), (5, 50, 0.1984), (5, 100, 0.1543)),
    *((20, 0, 0.3046), (20, 10, 0.2234), (20, 50, 0.1305), (20, 100, 0.1015)),
    *((40, 0, 0.2343), (40, 10, 0.1718), (40, 50, 0.1004), (40, 100, 0.0781)),
]
SPEEDS = (0.0, 1.0, 5.0, 10.0, 20.0, 40.0)


def friction_at(brake: Library, law: int, speed: float, **values: float) -> float:
    kernel = Kernel(brake, friction_law=law, pressure_demand=180e3, **values)
    kernel.advance(20.0)
    kernel.set(angular_velocity=speed / 0.398)
    return kernel["shoe_friction"]


@pytest.mark.parametrize(("force", "speed", "friction"), P6_NUMBERS)
def test_cast_iron_gives_the_published_numbers(force: float, speed: float, friction: float) -> None:
    assert float(cast_iron_p6(1e3 * force, speed / 3.6)) == pytest.approx(friction, abs=PRINTED)
    # A speed in m/s or a force in N would give a very different value.
    assert speed == 0 or float(cast_iron_p6(1e3 * force, speed)) != pytest.approx(friction, abs=PRINTED)
    assert float(cast_iron_p6(force, speed / 3.6)) != pytest.approx(friction, abs=PRINTED)


def test_cast_iron_in_the_kernel_is_that_of_the_force_of_one_shoe(brake: Library) -> None:
    one_shoe = 180e3 * 0.082 * 0.85 / 2
    for speed in SPEEDS:
        expected = float(cast_iron_p6(one_shoe, max(speed - REST_SPEED, 0.0)))
        assert friction_at(brake, CAST_IRON_P6, speed) == pytest.approx(expected, rel=1e-4)


def test_composite_falls_slightly_and_is_held_beyond_the_fit(brake: Library) -> None:
    """0.3 - 0.00081 V [km/h], a third party's fit."""
    assert float(composite(100 / 3.6)) == pytest.approx(0.219, abs=PRINTED)
    assert friction_at(brake, COMPOSITE, 100 / 3.6) == pytest.approx(0.219, abs=PRINTED)
    assert friction_at(brake, COMPOSITE, 0.0) == pytest.approx(0.3, abs=PRINTED)
    assert friction_at(brake, COMPOSITE, 1e3) == pytest.approx(0.138, abs=PRINTED)


#: Shoe force [kN], speed [km/h], friction, calculated by hand from 0.05 (F + 62.5) / (F + 31.25) (V + 100) / (V + 20).
P10_NUMBERS = [(10, 0, 0.4394), (10, 60, 0.1758), (20, 120, 0.1265)]
#: 0.44 (K + 20) / (4 K + 20) (V + 150) / (2 V + 150), K in tf of 10 kN.
COMPOSITE_NUMBERS = [(10, 0, 0.3850), (10, 60, 0.2994), (20, 120, 0.2393)]


@pytest.mark.parametrize(("law", "numbers"), [(P10, P10_NUMBERS), (COMPOSITE_BLOCKS, COMPOSITE_NUMBERS)])
def test_iron_p10_and_composite_give_the_numbers_of_their_formulas(
    law: Fractions, numbers: list[tuple[float, float, float]]
) -> None:
    for force, speed, friction in numbers:
        assert float(law.friction(1e3 * force, speed / 3.6)) == pytest.approx(friction, abs=PRINTED)


@pytest.mark.parametrize(("law", "form"), [(CAST_IRON_P10, P10), (COMPOSITE_BY_FORCE, COMPOSITE_BLOCKS)])
def test_laws_of_trains_are_those_of_the_brake_fmu(brake: Library, law: int, form: Fractions) -> None:
    one_shoe = 180e3 * 0.082 * 0.85 / 2
    for speed in SPEEDS:
        expected = float(form.friction(one_shoe, max(speed - REST_SPEED, 0.0)))
        assert friction_at(brake, law, speed) == pytest.approx(expected, rel=2e-4)


def test_falling_law_halves_at_the_speed_that_its_constant_says(brake: Library) -> None:
    """Section 2.5.2, in the exponential form."""
    for constant in (0.01, 0.05):
        half = math.log(2.0) / constant
        found = friction_at(brake, FALLING, half, falling_friction_constant=constant)
        assert found == pytest.approx(0.125, rel=2e-3)
        assert friction_at(brake, FALLING, 0.0, falling_friction_constant=constant) == pytest.approx(0.25, rel=1e-9)
    assert friction_at(brake, FALLING, 30.0, falling_friction_constant=0.0) == 0.25


@pytest.mark.parametrize("law", [CAST_IRON_P6, COMPOSITE, FALLING, TABULATED, CAST_IRON_P10, COMPOSITE_BY_FORCE])
def test_friction_falls_with_speed_alike_in_both_directions(brake: Library, law: int) -> None:
    found = [friction_at(brake, law, speed) for speed in SPEEDS]
    assert all(a >= b > 0.0 for a, b in pairwise(found))
    assert found[0] > 1.2 * found[-1]
    assert [friction_at(brake, law, -speed) for speed in SPEEDS] == found


@pytest.mark.parametrize("law", [CAST_IRON_P6, COMPOSITE, FALLING, TABULATED, CAST_IRON_P10, COMPOSITE_BY_FORCE])
def test_friction_has_no_corner_at_rest(brake: Library, law: int) -> None:
    kernel = Kernel(brake, friction_law=law, pressure_demand=180e3)
    kernel.advance(20.0)
    slopes = []
    for speed in (-1e-9, 0.0, 1e-9, 1.0):
        kernel.set(angular_velocity=speed)
        slopes += kernel.directional(["brake_torque"], {"angular_velocity": 1.0})
    assert slopes[1] == 0.0
    assert abs(slopes[0] - slopes[2]) < 1e-5 * abs(slopes[3])


def test_constant_law_does_not_see_speed(brake: Library) -> None:
    assert {friction_at(brake, CONSTANT, speed) for speed in SPEEDS} == {0.25}


def test_cast_iron_falls_with_force() -> None:
    found = [float(cast_iron_p6(1e3 * force, 10.0)) for force in range(0, 60, 5)]
    assert all(a > b > 0.0 for a, b in pairwise(found))


def test_table_of_the_user_is_met_at_its_points_and_held_outside() -> None:
    table = FrictionTable([0.0, 10.0, 30.0], [0.4, 0.3, 0.2])
    library = Library(build_library(brake_cylinder(table=table)))
    for speed, friction in ((0.0, 0.4), (5.0, 0.35), (10.0, 0.3), (20.0, 0.25), (30.0, 0.2), (100.0, 0.2)):
        assert friction_at(library, TABULATED, speed + REST_SPEED) == pytest.approx(friction, abs=1e-3)


def test_table_of_the_fmu_is_cast_iron_at_20_kilonewtons() -> None:
    for speed, friction in zip(EXAMPLE_TABLE.speeds, EXAMPLE_TABLE.frictions, strict=True):
        assert float(cast_iron_p6(20e3, speed)) == pytest.approx(friction, abs=PRINTED)


@pytest.mark.parametrize(
    ("speeds", "frictions", "sentence"),
    [([0.0], [0.3], "at least two speeds"), ([0.0, 1.0], [0.3], "as many"), ([0.0, 1.0], [0.3, -0.1], "at least 0")],
)
def test_table_that_cannot_be_one_is_refused(speeds: list[float], frictions: list[float], sentence: str) -> None:
    with pytest.raises(ValueError, match=sentence):
        FrictionTable(speeds, frictions)


# -- from an empty cylinder -----------------------------------------------------------------------------------------


def test_torque_of_an_empty_cylinder_grows_at_the_rate_of_filling(brake: Library) -> None:
    """The one-sided derivative of eqs (2.4) to (2.7) during filling; half of it was returned before."""
    kernel = Kernel(brake, pressure_demand=180e3)
    kernel.initialise()
    assert kernel["cylinder_pressure"] == 0.0
    told = kernel.rates(["shoe_force", "brake_torque"])
    rate = 180e3 * math.log(20.0) / 0.8
    force = 0.164 * 0.5 * 0.85 * rate
    assert told == pytest.approx([force, 0.25 * 0.398 * force], rel=1e-12)
    kernel.advance(1e-6)
    assert told[1] == pytest.approx(kernel["brake_torque"] / 1e-6, rel=1e-5)


def test_counter_force_keeps_the_rate_at_zero_until_the_shoes_press(brake: Library) -> None:
    kernel = Kernel(brake, **qr30(180).values() | {"slack_adjuster_force": 1000.0}, pressure_demand=180e3)
    kernel.initialise()
    assert kernel.rates(["shoe_force"]) == [0.0]

"""Test sand on the rail against closed forms at constant speed: amount, place, delay and effect."""

from __future__ import annotations

import math

import pytest

from fmu_src.compile import build_library
from fmu_src.kernel import Kernel, Library
from fmu_src.system import model_of
from rbd_model.track.sand import common_sand, sanders

PLACES = (7.0, 4.4, -4.4, -7.0)
SPEED, RATE, POOR = 12.0, 0.03, 0.02
SAND = common_sand()


@pytest.fixture(scope="module")
def library() -> Library:
    return Library(build_library(model_of(sanders(PLACES), 1e-9)))


def sanded(library: Library, seconds: float, **values: float) -> list[float]:
    """Return the friction under each wheelset `seconds` after sand starts to fall."""
    frictions = {f"friction_{number}": POOR for number in range(1, 5)}
    kernel = Kernel(library, **frictions | {"speed": SPEED} | values)
    kernel.initialise()
    kernel.advance(SAND.sand_start + SAND.sand_delay)
    if seconds:
        kernel.advance(seconds)
    return [kernel[f"sanded_friction_{number}"] for number in range(1, 5)]


def law(sand: float) -> float:
    return POOR + (SAND.sanded_friction - POOR) * (1.0 - math.exp(-sand / SAND.sand_scale))


def test_sand_on_a_metre_is_the_rate_over_the_speed(library: Library) -> None:
    for rate in (0.1 * RATE, RATE, 10 * RATE):
        assert sanded(library, 10.0, sand_rate_1=rate) == pytest.approx([law(rate / SPEED)] * 4)


def test_it_reaches_a_wheelset_once_the_train_has_come_that_far(library: Library) -> None:
    """The distance from wheelset 2 to wheelset 3 is 8.8 m. Wheelset 1 is ahead of the sander and meets no sand."""
    early, late = (sanded(library, way / SPEED, sand_rate_2=RATE) for way in (8.7, 9.4))
    assert early == pytest.approx([POOR, law(RATE / SPEED), POOR, POOR])
    assert late == pytest.approx([POOR, law(RATE / SPEED), law(RATE / SPEED), POOR])


def test_sand_of_two_sanders_adds(library: Library) -> None:
    found = sanded(library, 10.0, sand_rate_1=RATE, sand_rate_3=2 * RATE)
    assert found == pytest.approx([law(RATE / SPEED)] * 2 + [law(3 * RATE / SPEED)] * 2)


def test_a_sander_of_variable_rate_gives_so_much_for_each_metre(library: Library) -> None:
    assert sanded(library, 10.0, sand_rate_1=1.0, sand_limit=1e-3) == pytest.approx([law(1e-3)] * 4)


def test_no_sand_falls_before_its_delay_and_none_without_a_rate(library: Library) -> None:
    assert sanded(library, 0.0, sand_rate_1=RATE) == pytest.approx([POOR] * 4)
    assert sanded(library, 20.0) == pytest.approx([POOR] * 4)


def test_a_good_rail_stays_as_it_is(library: Library) -> None:
    good = {f"friction_{number}": 0.3 for number in range(1, 5)}
    assert sanded(library, 10.0, sand_rate_1=RATE, **good) == pytest.approx([0.3] * 4)

"""Readings of numbers in another unit, and the widest limits."""

from __future__ import annotations

import math

import pytest

from readers.usual import READINGS, WIDEST, almost_0, is_almost_0, likely_unit, note, reading_of, widest


@pytest.mark.parametrize(
    ("value", "unit", "least", "most", "meant"),
    [
        (3.8, "Pa", 5e3, 1e7, "3.8 bar"),
        (380.0, "Pa", 5e3, 1e7, "380 kPa"),
        (3800.0, "Pa", 5e3, 1e7, "3800 mbar"),
        (120.0, "m/s", 0.0, 112.0, "120 km/h"),
        (2.5, "kW", 10.0, 20e3, "2.5 MW"),
        (2.5e6, "kW", 10.0, 20e3, "2.5e+06 W"),
        (1.15, "%", 5.0, 250.0, "1.15 = 115 %"),
        (9.5, "N/m", 100.0, 1e12, "9.5 kN/mm"),
        (920.0, "m", 0.02, 1.5, "920 mm"),
        (5.0, "s", 1e-5, 0.1, "5 ms"),
        (60.0, "kg", 100.0, 1e6, "60 t"),
        (20.0, "K", 100.0, 1e4, "20 degC"),
        (800.0, "s", 1e-3, 300.0, "800 ms"),
    ],
)
def test_the_hint_is_the_reading_nearest_to_usual_sizes(
    value: float, unit: str, least: float, most: float, meant: str
) -> None:
    assert likely_unit(value, unit, least, most).startswith(f" Did you mean {meant}")


@pytest.mark.parametrize("value", [0.0, math.nan, math.inf, -1e99])
def test_a_number_without_another_reading_has_no_hint(value: float) -> None:
    assert likely_unit(value, "Pa", 5e3, 1e7) == ""


def test_every_reading_converts_and_every_size_has_limits() -> None:
    assert all(reading_of(other, unit) for unit, others in READINGS.items() for other in others)
    for unit, most in WIDEST.items():
        assert widest(unit, -math.inf, math.inf) == (-most, most)
    assert widest("N", 0.0, 5.0) == (0.0, 5.0)
    assert widest("sacks", -math.inf, math.inf) == (-math.inf, math.inf)


def test_pressures_below_those_of_any_brake_are_found_in_each_unit() -> None:
    assert is_almost_0(3800.0, "Pa")
    assert is_almost_0(0.01, "bar")
    assert not any(is_almost_0(*one) for one in ((0.0, "Pa"), (38e3, "Pa"), (3.8, "bar"), (3.8, "m")))
    assert almost_0("cut_out", 0.0048, "bar", 4.8) == "cut_out must be 0 or reach 0.05 bar; got 0.0048 bar."


def test_rare_numbers_are_noted() -> None:
    assert note("speed", 120.0, "m/s") == "speed is 120 m/s = 432 km/h. Did you mean 120 km/h = 33.33 m/s?"
    assert note("spring", 3.9, "N/m") == "spring is 3.9 N/m. Did you mean 3.9 kN/mm = 3.9e+06 N/m?"
    assert note("spring", 0.0, "N/m") == ""
    assert note("speed", 33.0, "m/s") == note("length", 120.0, "m") == ""

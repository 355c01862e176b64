"""Running resistance of vehicles whose rows state none: published formulas, written out here."""

from __future__ import annotations

from typing import Any

import pytest

from products.train.consist_file import consist_of
from products.train.summary import summary_of

#: Standard gravity [m/s2] (ISO 80000-3).
G = 9.80665


def resisted(row: dict[str, Any], speed: float, count: int = 1) -> float:
    """Return the running resistance of equal vehicles behind a driver's valve [N] at a speed [km/h]."""
    own = consist_of([{"valve": "head"} | row] + [row] * (count - 1)).vehicles
    v = speed / 3.6
    return sum(a + b * v + c * v**2 for a, b, c in (one.resistance for one in own))


@pytest.mark.parametrize(("mass", "k"), [(20.0, 1000.0), (80.0, 4000.0)])
def test_a_wagon_has_the_resistance_of_strahl(mass: float, k: float) -> None:
    """w = 2.5 + V^2 / k permille (Strahl 1913), k of an empty and of a loaded wagon."""
    for speed in (0.0, 80.0, 120.0):
        kilonewtons = (2.5 + speed**2 / k) * mass * G / 1e3
        assert resisted({"kind": "wagon", "mass": mass}, speed) == pytest.approx(1e3 * kilonewtons, rel=1e-12)


@pytest.mark.parametrize("row", [{"kind": "wagon"}, {"kind": "wagon", "distributor": "aar"}, {"kind": "coach"}])
def test_a_load_adds_rolling_resistance_only(row: dict[str, Any]) -> None:
    *_, empty = (one.resistance for one in consist_of([row | {"valve": "head", "mass": 45.0}]).vehicles)
    *_, loaded = (one.resistance for one in consist_of([row | {"valve": "head", "mass": 90.0}]).vehicles)
    assert loaded[2] == empty[2] > 0.0
    assert 1.0 < loaded[0] / empty[0] <= 2.0


@pytest.mark.parametrize("distributor", ["aar", "ecp"])
def test_an_american_wagon_has_the_modified_davis_resistance(distributor: str) -> None:
    """0.6 + 20 / w + 0.01 V + 0.07 V^2 / (w n) lb/ton (AREMA): 14 N/t of a hopper of 126 t at 80 km/h."""
    tons, mile_an_hour = 126e3 / 907.18474, 80.0 / 1.609344
    axle = tons / 4
    pounds = (0.6 + 20 / axle + 0.01 * mile_an_hour + 0.07 * mile_an_hour**2 / tons) * tons
    found = resisted({"kind": "wagon", "mass": 126.0, "distributor": distributor}, 80.0)
    assert found == pytest.approx(pounds * 4.4482216152605, rel=1e-6)
    assert found / 126.0 == pytest.approx(14.3, abs=0.05)


def test_ten_coaches_have_the_resistance_of_sauthoff() -> None:
    """w = 1.9 + 0.0025 V + 0.0048 (n + 2.7) 1.45 (V + 15)^2 / G permille (Sauthoff 1932)."""
    for speed in (40.0, 120.0):
        permille = 1.9 + 0.0025 * speed + 0.0048 * (10 + 2.7) * 1.45 * (speed + 15) ** 2 / 460.0
        assert resisted({"kind": "coach"}, speed, 10) == pytest.approx(permille * 460.0 * G, rel=1e-12)
    assert resisted({"kind": "coach"}, 120.0, 10) == pytest.approx(25.7e3, abs=50.0)


def test_a_locomotive_has_the_resistance_of_davis() -> None:
    """1.3 + 29 / w + 0.03 V + 0.0024 A V^2 / (w n) lb/ton with 10 m2 and four axles (Davis 1926)."""
    tons, mile_an_hour, feet = 84e3 / 907.18474, 100.0 / 1.609344, 10.0 / 0.3048**2
    pounds = 1.3 * tons + 29 * 4 + 0.03 * mile_an_hour * tons + 0.0024 * feet * mile_an_hour**2
    assert resisted({"kind": "locomotive"}, 100.0) == pytest.approx(pounds * 4.4482216152605, rel=1e-6)


def test_a_check_shows_the_stated_resistance_beside_the_formula() -> None:
    rows: list[dict[str, Any]] = [{"kind": "wagon", "valve": "head"}, {"kind": "wagon", "resistance_a": 1000.0}]
    usual, stated = summary_of(consist_of(rows), []).kinds
    by_formula = (2.5 + 80.0**2 / 4000.0) * G
    assert (usual.resistance, usual.formula) == (pytest.approx(by_formula), "Strahl")
    assert (stated.resistance, stated.resistance_by_formula) == (12.5, pytest.approx(by_formula))

"""Couplers of [[coupler]] tables: forces and energies of an impact in closed form; bad tables."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from products.train.consist_file import read_consist
from products.train.consist_writer import write_consist
from products.train.coupler_tables import coupler_named, coupler_of
from products.train.summary import couplings_of
from rbd_model.train.coupler import COUPLERS, Coupler, coupling, draft_gear, screw_coupler
from rbd_model.train.impact import impact
from tests.products.train.chains import MASS
from tests.products.train.test_couplers import CLOSED, ROUNDING, collide, works_of_cycles

#: The buffers and draw gear of the built-in screw coupler, of one buffer and of one vehicle's draw gear.
BUFFERS: dict[str, Any] = {
    "name": "buffers",
    "buffer_travel": [25, 60, 105],
    "buffer_preload": 30,
    "buffer_loading": [80, 250, 675],
    "buffer_damping": 0.5,
    "draw_travel": [0, 60],
    "draw_loading": [20, 400],
    "draw_damping": 0.5,
}
#: A draft gear of twelve points, F = 8 s + s^2 / 10 [kN, mm]; it gives back 0.3 of it from 20 mm on.
WAYS = [0, 2, 5, 10, 15, 20, 30, 40, 50, 60, 70, 80]
GEAR: dict[str, Any] = {
    "name": "gear",
    "gear_travel": WAYS,
    "gear_loading": [8 * s + s**2 / 10 for s in WAYS],
    "gear_unloading_travel": [0, 20, 40, 80],
    "gear_unloading": [0, 0, 0.3 * 480, 0.3 * 1280],
    "sticking_stiffness": 60,
}


def without(table: dict[str, Any], *names: str, **more: Any) -> dict[str, Any]:
    return {name: value for name, value in (table | more).items() if name not in names}


def toml(couplers: list[dict[str, Any]], behind: str, last: str = "screw") -> str:
    tables = ["[[coupler]]\n" + "\n".join(f"{key} = {json.dumps(one[key])}" for key in one) for one in couplers]
    rows = [("locomotive", behind, 1), ("wagon", behind, 2), ("wagon", last, 1)]
    tables += [f"[[vehicle]]\nkind = '{kind}'\ncoupler = '{name}'\ncount = {count}" for kind, name, count in rows]
    return "\n\n".join(tables) + "\n"


def test_two_buffers_side_by_side_and_two_in_series_are_the_screw_coupler() -> None:
    """The travel of a coupling is that of two devices, its force that of two buffers or of one draw gear."""
    assert replace(coupler_of(BUFFERS), name="screw") == screw_coupler()
    gear = coupler_of(GEAR).compression[0]
    assert gear.ways[-1] == pytest.approx(0.16)
    assert gear.forces[-1] == pytest.approx(1280e3)


@pytest.mark.parametrize("speed", [0.5, 1.5, 3.5])
@pytest.mark.parametrize("table", [BUFFERS, GEAR, BUFFERS | {"buffer_stroke": 130}])
def test_an_impact_reaches_the_force_and_loses_the_energy_of_its_curves(table: dict[str, Any], speed: float) -> None:
    """int F ds = m v^2 / 2 up to the largest travel; the area below unloading is the energy afterwards."""
    one = coupler_of(table)
    train, due = collide(one, speed), impact(one, (MASS, MASS), speed)
    assert due.taken == MASS * speed**2 / 4
    assert 0.0 < due.returned < due.taken
    assert train.largest_compression == pytest.approx(due.force, rel=CLOSED)
    assert train.speed[0] - train.speed[1] == pytest.approx(due.rebound, rel=CLOSED)


@pytest.mark.parametrize("sense", ["tension", "compression"])
@pytest.mark.parametrize("one", [coupler_of(BUFFERS), coupler_of(GEAR), draft_gear()], ids=lambda one: one.name)
def test_areas_of_an_impact_are_those_of_its_course(one: Coupler, sense: str) -> None:
    """The closed forms against the function that trains compute, integrated over 2000 pieces."""
    due = impact(one, (MASS, 20e3), 2.0, sense)
    side, play, given = 1.0 if sense == "tension" else -1.0, coupling(), one.constants()
    up = side * np.linspace(0.0, due.travel, 1001)
    rest, forces = 0.0, []
    for way in np.r_[up, up[::-1]]:
        force, rest = np.ravel(np.asarray(play(way, 0.0, rest, given)))
        forces.append(force)
    assert np.trapezoid(forces[:1001], up) == pytest.approx(due.taken, rel=2e-3)
    assert -np.trapezoid(forces[1001:], up[::-1]) == pytest.approx(due.returned, rel=2e-3)


@pytest.mark.parametrize("table", [BUFFERS | {"slack": 15, "buffer_stroke": 130}, GEAR | {"slack": 10}])
def test_a_closed_cycle_of_a_table_never_gives_energy(table: dict[str, Any]) -> None:
    work = works_of_cycles(coupler_of(table))
    assert np.all(work > -ROUNDING)
    assert work.max() > 1e3 * ROUNDING


def test_slack_shifts_the_draw_gear_and_buffers_touch() -> None:
    loose, plain = coupler_of(BUFFERS | {"slack": 15}), coupler_of(BUFFERS)
    assert loose.compression == plain.compression
    assert loose.tension[0].ways == pytest.approx((0.0, 0.015, 0.015 + 20e3 / 50e6, 0.135))
    both = coupler_of(GEAR | {"slack": 10})
    assert both.tension == both.compression
    with pytest.raises(
        ValueError, match="slack must be left out with curves of loading that begin without a force; got 3 mm"
    ):
        coupler_of(GEAR | {"slack": 3, "gear_loading": [0] * 6 + [330] * 6, "gear_unloading": [0] * 4})
    assert both.tension[1].ways == pytest.approx((0.0, 0.01, 0.05, 0.09, 0.17))


def test_a_consist_with_tables_is_read_written_and_summed_up(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "a.toml"
    path.write_text(toml([GEAR, BUFFERS], "gear", "rigid").replace("'gear'", "'buffers'", 1))
    own = read_consist(path)
    assert [one.coupler.name for one in own.vehicles] == ["buffers", "gear", "gear", "rigid"]
    write_consist(own, tmp_path / "b.toml")
    for one, again in zip(own.vehicles, read_consist(tmp_path / "b.toml").vehicles, strict=True):
        assert again.coupler.values() == pytest.approx(one.coupler.values(), rel=1e-12)
    with pytest.raises(ValueError, match=r"must end in \.toml, as its couplers are tables"):
        write_consist(own, tmp_path / "b.csv")
    press, pull = couplings_of(own)[:2]
    assert (press.name, press.count) == ("buffers", 1)
    assert (press.stroke, press.force) == pytest.approx((210, 1350))
    assert press.energy == pytest.approx(4 * (1.375 + 5.775 + 20.8125), rel=0.01)  # areas of one buffer [kJ]
    assert pull.energy == pytest.approx((20 + 400) / 2 * 0.12, rel=0.01)


BAD: dict[str, tuple[dict[str, Any], str]] = {
    "not monotone": (BUFFERS | {"buffer_loading": [80, 60, 675]}, "buffer_loading must never fall; got 60 after 80 kN"),
    "travel": (BUFFERS | {"draw_travel": [0, 0]}, "draw_travel must grow; got 0 after 0 mm"),
    "unloading above": (
        without(GEAR, "gear_unloading_travel", gear_unloading=[0, 10, *[50] * 9, 2000]),
        r"gear_unloading must be at most gear_loading, 42\.5 kN at 5 mm; got 50 kN",
    ),
    "metres": (
        BUFFERS | {"buffer_travel": [0.025, 0.06, 0.105]},
        "curves of the coupling must rise by at most 1000 MN/m",
    ),
    "newtons": (
        BUFFERS | {"draw_loading": [20e3, 400e3]},
        "draw_loading, number 2, must be a number from 0 to 20000 kN",
    ),
    "preload": (without(BUFFERS, "buffer_preload"), "buffer_travel must come with a buffer_preload"),
    "preload twice": (BUFFERS | {"draw_preload": 20}, "draw_travel must begin above 0 mm with a draw_preload"),
    "no unloading": (without(BUFFERS, "draw_damping"), "must come with draw_unloading or draw_damping; got neither"),
    "no tension": (
        without(BUFFERS, *[n for n in BUFFERS if "draw" in n]),
        "tension must be stated once, by .* got none",
    ),
    "both": (BUFFERS | GEAR, "tension must be stated once, by draw, gear or tension; got draw and gear"),
    "lengths": (
        BUFFERS | {"draw_loading": [20, 30, 400]},
        "draw_loading must have a number for each of draw_travel, 2",
    ),
    "stroke": (BUFFERS | {"buffer_stroke": 100}, "buffer_stroke must be at least the last travel, 105 mm; got 100 mm"),
    "sticking": (BUFFERS | {"sticking_stiffness": 3}, r"steepest slope of the coupling, 9\.444 MN/m; got 3 MN/m"),
    "name": (BUFFERS | {"name": "screw"}, "name must not be that of a built-in coupler"),
    "unknown": (BUFFERS | {"buffer_force": 3}, "the name 'buffer_force' is unknown"),
    "text": (BUFFERS | {"draw_travel": [0, "60 kN"]}, "draw_travel, number 2, must be a number from 0 to 1000 mm"),
    "many": (
        BUFFERS | {"draw_travel": list(range(40))},
        "draw_travel must be a list of 2 to 16 numbers; got 40 of them",
    ),
    "alone": (BUFFERS | {"gear_damping": 0.3}, "gear_damping must come with gear_travel"),
    "slack twice": (BUFFERS | {"slack": 5, "draw_loading": [0, 0]}, "draw_loading must end above 0 kN"),
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_table_is_refused_by_its_names(name: str, tmp_path: Path) -> None:
    table, message = BAD[name]
    path = tmp_path / "a.toml"
    path.write_text(toml([table], str(table["name"])))
    with pytest.raises(ValueError, match=message) as caught:
        read_consist(path)
    assert str(caught.value).startswith(f"{path}, coupler 1: ")
    assert "\n" not in str(caught.value)


def test_a_coupler_is_found_by_its_name_in_a_file(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text(toml([BUFFERS, GEAR], "buffers"))
    assert coupler_named("rigid") == COUPLERS["rigid"]()
    assert coupler_named(f"{path}:gear") == coupler_of(GEAR)
    for text in (str(path), f"{path}:rubber"):
        with pytest.raises(ValueError, match=r"a\.toml must have the coupler that is named, .* got buffers, gear\."):
            coupler_named(text)
    with pytest.raises(
        ValueError, match=r"coupler must be one of screw, draft-gear, rigid, or FILE\.toml:NAME; got bar"
    ):
        coupler_named("bar")


def test_a_table_without_an_effect_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text(toml([BUFFERS], "screw", "buffers"))
    with pytest.raises(ValueError, match="the coupler 'buffers' must be behind a vehicle, other than the last one"):
        read_consist(path)
    path.write_text(toml([BUFFERS], "buffers").replace("count = 2", "count = 2\ncoupler_slack = 3"))
    with pytest.raises(ValueError, match=r"coupler_slack must be left out with a \[\[coupler\]\]"):
        read_consist(path)
    path.write_text(toml([BUFFERS, BUFFERS], "buffers"))
    with pytest.raises(ValueError, match="coupler 2: name must be that of one coupler; got 'buffers' again"):
        read_consist(path)

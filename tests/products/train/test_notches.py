"""Notches of driver's valves: every name of the table, what its notch does to the pipe, and what is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import bogie_braking as bb
from brake_controller.drivers_valve import POSITIONS, drivers_valve
from brake_controller.vacuum_valve import vacuum_valve
from products.train.consist_file import consist_of, read_consist
from products.train.consist_writer import write_consist
from products.train.notches import handles, notch_named
from readers.column_words import plain

LOCOMOTIVE, PSI = {"kind": "locomotive"}, 6894.757


def train(handle: str, wagons: int = 4, **more: Any) -> bb.Train:
    """Return a short train whose driver's valve has a handle."""
    return bb.train([{**LOCOMOTIVE, "handle": handle, **more}, {"kind": "wagon", "count": wagons}])


@pytest.mark.parametrize("handle", list(handles()))
def test_each_name_means_one_notch_and_no_other_position_than_it_says(handle: str) -> None:
    own = handles()[handle]
    names = [plain(name) for notch in own.notches for name in notch.names]
    assert len(set(names)) == len(names)
    valve = vacuum_valve(71e3) if own.pipe == "vacuum" else drivers_valve()
    for notch in own.notches:
        assert notch.position in POSITIONS
        assert 0.0 <= notch.step_of(valve) <= 1.0
        assert notch.is_service <= (notch.position == "service")
        for name in notch.names:
            assert notch_named(name.upper().replace(" ", "_"), handle) in (notch, notch_named(name, handle))
            assert POSITIONS.get(name, POSITIONS[notch.position]) == POSITIONS[notch.position]


@pytest.mark.parametrize(
    ("handle", "notch", "fallen"),
    [
        ("UIC", "Vollbremsung", 150e3),
        ("UIC", "1a", 40e3),
        ("26-L", "minimum reduction", 7 * PSI),
        ("26-L", "15 psi", 15 * PSI),
        ("26-L", "Suppression", 150e3),
        ("PBL2", "serrage maximal", 150e3),
        ("British air", "initial", 40e3),
    ],
)
def test_a_service_notch_lowers_the_pipe_by_what_it_says(handle: str, notch: str, fallen: float) -> None:
    own = train(handle)
    own.drive(notch)
    own.advance(60.0)
    assert 500e3 - own.pipe_pressure[0] == pytest.approx(fallen, abs=2e3)


def test_a_vacuum_notch_destroys_inches_of_it() -> None:
    own = bb.train(
        [{**LOCOMOTIVE, "brake": "none", "handle": "British vacuum"}, {"kind": "coach", "distributor": "vacuum"}]
    )
    own.drive("10 inches")
    own.advance(60.0)
    assert own.pipe_pressure[0] == pytest.approx(-11 * 3386.389, abs=1e3)


def test_service_until_lap_goes_on_and_lap_neither_feeds_nor_vents() -> None:
    """The pressure of the equalising reservoir falls by 0.5 bar/s; in lap leaks lower the pipe, and hold feeds it."""
    lapped, held = (train("H-6", wagons=10, service_rate=0.1) for _ in range(2))
    for own in (lapped, held):
        own.drive("service until lap")
        own.advance(5.0)
    lapped.drive("lap")
    held.drive("hold")
    for own in (lapped, held):
        own.advance(60.0)
    assert held.pipe_pressure == pytest.approx(450e3, abs=3e3)
    assert lapped.pipe_pressure.max() - lapped.pipe_pressure.min() < 1e3
    own = train("26-L")
    own.drive("handle off")
    own.advance(60.0)
    assert own.pipe_pressure.max() < 15e3
    assert own.cylinder_pressure == pytest.approx(380e3, rel=0.01)


def test_hold_keeps_the_demand_of_a_brake_by_wire_and_a_wire_that_keeps_the_pipe_has_none() -> None:
    metro = bb.train([{**LOCOMOTIVE, "brake": "ep-direct"}])
    metro.drive("service", 0.5)
    metro.advance(5.0)
    before = metro.cylinder_pressure[0]
    metro.drive("hold")
    metro.advance(5.0)
    assert metro.cylinder_pressure[0] == pytest.approx(before, rel=1e-3)
    assert before > 1e5
    wired = bb.train([{**LOCOMOTIVE, "brake": "none"}, {"kind": "wagon", "distributor": "ecp"}])
    wired.drive("continuous-service")
    with pytest.raises(ValueError, match=r"must be from 0 to 4, as service is by wire; got 6\. Write service"):
        wired.advance(1.0)


def test_unknown_notches_are_refused_with_those_that_there_are() -> None:
    own = train("26-L")
    with pytest.raises(ValueError, match=r"one of release, minimum reduction, service, .*; got stop. Choose one"):
        own.drive("stop")
    with pytest.raises(ValueError, match="'Vollbremsung' is a notch of UIC: give handle = UIC"):
        own.drive("Vollbremsung")
    with pytest.raises(ValueError, match=r"got Vollbremse\. Did you mean Vollbremsung"):
        own.drive("Vollbremse", handle="UIC")
    with pytest.raises(ValueError, match="step must be left out with the notch '15 psi'"):
        own.drive("15 psi", 0.3)
    with pytest.raises(ValueError, match=r"handle must be of a pipe that holds air, .*; got British vacuum"):
        own.drive("lap", handle="British vacuum")
    with pytest.raises(ValueError, match="handle must be one of UIC"):
        own.drive("lap", handle="Knorr")
    with pytest.raises(ValueError, match="handle must be one of UIC"):
        train("Knorr")
    with pytest.raises(ValueError, match="handle must be of a vehicle with a driver's valve"):
        consist_of([LOCOMOTIVE, {"kind": "wagon", "handle": "UIC"}])
    own.drive("Schnellbremsung", handle="UIC")
    assert own.inputs["driver_position"][0] == POSITIONS["emergency"]


def test_a_file_states_the_handle(tmp_path: Path) -> None:
    write_consist(train("PBL2").consist, tmp_path / "train.csv")
    own = bb.train(read_consist(tmp_path / "train.csv"))
    own.drive("urgence")
    assert own.inputs["driver_position"][0] == POSITIONS["emergency"]

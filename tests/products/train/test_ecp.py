"""The ECP brake: one command to all cars, graduated release, reservoirs that charge, and emergency by the pipe."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from brake_controller.air import AMBIENT
from brake_controller.distributors.aar import ready
from brake_controller.distributors.ecp import ECP
from products.train.consist_file import consist_of, read_consist
from products.train.consist_writer import write_consist
from products.train.numbers import Settings
from products.train.pipe import EndConditions, Pipe
from products.train.train import Train
from tests.products.train.chains import without_added_kinds

#: Boyle with 2500, 3500 and 1000 cubic inches at 5 bar: full service, and emergency [Pa].
FULL, EMERGENCY = 500e3 * 2500 / 3500, 500e3 * 6000 / 7000
#: Pressure that the return spring of a cylinder takes: 1500 N on a piston of 406 mm [Pa].
SPRING = 1500.0 / (np.pi / 4 * 0.406**2)
#: Difference in which a relay shuts [Pa].
RELAY = 5e3


def train(cars: int, kind: str = "ecp", **columns: object) -> Train:
    rows = [{"kind": "locomotive", "brake": "none"}, {"kind": "wagon", "length": 15, "count": cars}]
    return Train(consist_of([rows[0], rows[1] | {"distributor": kind} | columns]), settings=Settings(cells=1))


def test_a_command_fills_all_cylinders_at_once_and_the_pipe_stays_charged() -> None:
    """Head and end have one pressure at any time, after the dead time; the AAR valve's last car begins after a wave."""
    wired, plain = train(80, dead_time=1.0), train(80, "aar")
    for one in (wired, plain):
        one.drive("service", 1.0)
    wired.advance(0.9)
    assert wired.cylinder_pressure.max() < 1.0
    wired.advance(2.1)
    plain.advance(3.0)
    assert wired.cylinder_pressure[1] > 50e3
    assert np.ptp(wired.cylinder_pressure[1:]) < 1e-3 * wired.cylinder_pressure[1]
    assert plain.cylinder_pressure[-1] < 1e3 < 50e3 < plain.cylinder_pressure[1]
    wired.advance(40.0)
    assert wired.cylinder_pressure[1:] == pytest.approx(FULL, abs=RELAY)
    assert wired.pipe_pressure.min() > 450e3


def test_it_releases_by_steps_both_ways() -> None:
    """First step 0.4 bar of 1.5 bar of the whole force, full service all of it: linear above the cylinder's spring."""
    one = train(2, cylinder_diameter=406, rigging_ratio=5.65)
    for step in (0.6, 0.2, 0.8):
        one.drive("service", step)
        one.advance(40.0)
        share = (0.4 + step * 1.1) / 1.5
        assert one.cylinder_pressure[1:] == pytest.approx(SPRING + share * (FULL - SPRING), abs=RELAY / 2)
    one.drive("running")
    one.advance(40.0)
    assert one.cylinder_pressure.max() < RELAY


def test_a_parted_hose_applies_it_to_the_balance_and_it_stays_applied() -> None:
    """Without a command, behind the hose: both reservoirs and the cylinder balance, 1.2 times full service (Boyle)."""
    one = train(10)
    one.inputs["hose_state"][5] = 2.0
    for seconds in (60.0, 200.0):
        one.advance(seconds)
        assert one.cylinder_pressure[6:] == pytest.approx(EMERGENCY, rel=0.01)
    one.drive("emergency")
    one.advance(60.0)
    assert one.cylinder_pressure[1:].min() > 0.8 * EMERGENCY  # reservoirs near the head have braked before


def test_a_mixed_train_keeps_the_pipe_as_the_command_of_its_other_cars() -> None:
    rows = [{"kind": "locomotive", "brake": "none"}, {"kind": "wagon", "distributor": "ecp"}]
    one = Train(consist_of([*rows, {"kind": "wagon", "distributor": "aar"}]))
    one.drive("service", 1.0)
    one.advance(60.0)
    assert one.pipe_pressure.max() < 360e3
    assert one.cylinder_pressure[1:] == pytest.approx(FULL, rel=0.05)


def test_the_pipe_gives_the_air_that_charges_both_reservoirs() -> None:
    """V dp of both reservoirs is R T times the mass from the pipe, isothermal; the cylinder is empty."""
    valve = replace(ECP.ready("P"), low_pressure=0.0)
    pipe = Pipe(2, pressure=350e3 + AMBIENT, length=7.5, diameter=0.03175)
    pipe.connect([1], [valve], 350e3 + AMBIENT)
    pipe.open_to(0, EndConditions(2e-4, 500e3 + AMBIENT))
    pipe.advance(90.0)
    rises = {name: float(pipe.vehicle_pressures(name)[0]) - 350e3 - AMBIENT for name in ("auxiliary", "reservoir")}
    assert rises == pytest.approx(dict.fromkeys(rises, 150e3), rel=0.01)
    stored = rises["auxiliary"] * valve.auxiliary_volume + rises["reservoir"] * valve.reservoir_volume
    assert 287.05287 * 293.15 * pipe.passed.vehicle_mass == pytest.approx(stored, rel=1e-6)


def test_each_of_its_parameters_has_an_effect() -> None:
    """Structure of the Jacobian of rates and flows with respect to the parameters: no column is empty."""
    structure = np.array(ca.DM(ECP.function("whole").jac_sparsity(0, 2), 1.0))
    assert [name for name, column in zip(ECP.fields(), structure.T, strict=True) if not column.any()] == []


@pytest.mark.study
@pytest.mark.parametrize(("fill", "release"), [(3.0, 20.0), (20.0, 3.0), (1.0, 1.0), (60.0, 120.0)])
def test_it_fills_and_releases_in_the_times_of_a_row(fill: float, release: float, tmp_path: Path) -> None:
    """To 95 % of a full service by wire, and from it to 0.4 bar; both looks are every 10 ms."""
    rows = [{"kind": "wagon", "valve": "head", "distributor": "ecp", "fill_time": fill, "release_time": release}]
    consist = consist_of(rows)
    one, full = Train(consist), consist.vehicles[0].distributor.full_pressure
    found = []
    for step, ends in ((1.0, lambda p: p >= 0.95 * full), (None, lambda p: p <= 40e3)):
        one.drive("service" if step else "running", step or 0.0)
        begin = one.time
        while not ends(one.cylinder_pressure[0]) and one.time < begin + 200.0:
            one.advance(0.01)
        found.append(one.time - begin)
        one.advance(200.0)
    assert found == pytest.approx([fill, release], rel=0.01, abs=0.02)
    write_consist(consist, tmp_path / "again.toml")
    own, again = consist.vehicles[0].distributor, read_consist(tmp_path / "again.toml").vehicles[0].distributor
    assert list(again.values().values()) == pytest.approx(list(own.values().values()), rel=1e-6)


def test_a_consist_states_it_and_is_written_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    without_added_kinds(monkeypatch)
    rows = [{"kind": "locomotive"}, {"kind": "wagon", "distributor": "ecp", "dead_time": 0.5}]
    consist = consist_of(rows)
    write_consist(consist, tmp_path / "again.toml")
    again = read_consist(tmp_path / "again.toml").vehicles[1]
    assert (again.distributor, again.electric) == (consist.vehicles[1].distributor, consist.vehicles[1].electric)
    assert again.distributor.full_pressure == pytest.approx(ready("P").full_pressure)
    for name, value, words in (
        ("position", "G", "has no effect with distributor = ecp"),
        ("retainer", "low", "must be of the distributor aar; got ecp"),
        ("full_pressure", 3, "must be of the distributor uic, ep_uic or twin_pipe; got ecp"),
    ):
        with pytest.raises(ValueError, match=f"{name} {words}"):
            consist_of([rows[0], rows[1] | {name: value}])
    with pytest.raises(ValueError, match="dead_time has no effect with distributor = aar"):
        consist_of([rows[0], rows[1] | {"distributor": "aar"}])

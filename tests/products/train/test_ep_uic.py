"""Electro-pneumatic assistance of the UIC brake: the pipe falls and rises at every vehicle."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from products.train.consist_file import consist_of, read_consist
from products.train.consist_writer import write_consist
from products.train.numbers import Settings
from products.train.train import Train

#: Cylinder at full service [Pa], and error of a pipe within the bands of its valves: 10 kPa of 150 kPa.
FULL, BANDS = 380e3, 0.07


def train(kind: str, vehicles: int = 40, **columns: object) -> Train:
    rows = [{"kind": "locomotive"}, {"kind": "coach", "count": vehicles, "distributor": kind} | columns]
    return Train(consist_of(rows), settings=Settings(cells=1))


def test_the_pipe_falls_at_the_end_as_at_the_head_and_rises_so() -> None:
    """After 4 s, cylinders of 40 coaches (1.1 km) differ by less than a quarter of those of the UIC brake."""
    both = [train("ep_uic"), train("uic")]
    for one in both:
        one.drive("service", 1.0)
        one.advance(4.0)
    spread = [np.ptp(one.cylinder_pressure[1:]) for one in both]
    assert spread[0] < 0.25 * spread[1]
    assert both[0].cylinder_pressure[-1] > 2.0 * both[1].cylinder_pressure[-1] > 0.0
    for one in both:
        one.advance(60.0)
        assert one.cylinder_pressure[1:] == pytest.approx(FULL, rel=BANDS)
        one.drive("running")
        one.advance(10.0)
    assert both[0].pipe_pressure[-1] > both[1].pipe_pressure[-1] + 30e3


def test_a_parted_hose_applies_it_although_nothing_is_ordered() -> None:
    """Its valves do not feed a pipe that falls farther than in service."""
    one = train("ep_uic", 10)
    one.inputs["hose_state"][5] = 2.0
    one.advance(40.0)
    assert one.pipe_pressure[6:].max() < 20e3
    assert one.cylinder_pressure[6:] == pytest.approx(FULL, rel=BANDS)


def test_the_balance_of_air_closes() -> None:
    """Air that valves feed from the main pipe is negative in the vehicles' sum."""
    one = train("ep_uic", 6)
    mass = one.air.mass
    for position in ("service", "running", "emergency"):
        one.drive(position, 0.5)
        one.advance(8.0)
    gone = one.air.passed
    assert one.air.mass + gone.valve_mass + gone.leak_mass + gone.vehicle_mass == pytest.approx(mass, rel=1e-12)


def test_air_that_valves_feed_brings_its_mass_and_its_enthalpy() -> None:
    """Air at 293 K fills the pipe: compression warms it by less than 20 K. Either one alone changes it by 60 K."""
    one = train("ep_uic", 10)
    one.drive("service", 1.0)
    one.advance(30.0)
    one.drive("running")
    one.advance(1.5)
    assert one.pipe_pressure.min() > 480e3
    assert 290.0 < one.air.temperature.min() < one.air.temperature.max() < 313.0


def test_valves_do_not_vent_an_overcharge_that_nobody_brakes() -> None:
    """Control chambers follow slowly: the pipe is above them, with no order to lower it."""
    one = train("ep_uic", 10)
    one.drive("overcharge")
    one.advance(4.0)
    assert one.pipe_pressure.min() > 530e3


def test_a_consist_states_it_and_a_model_without_flow_refuses_it(tmp_path: Path) -> None:
    rows = [{"kind": "locomotive"}, {"kind": "coach", "distributor": "ep_uic", "position": "G", "dead_time": 0.5}]
    consist = consist_of(rows)
    write_consist(consist, tmp_path / "again.toml")
    again = read_consist(tmp_path / "again.toml").vehicles[1]
    assert (again.distributor, again.electric) == (consist.vehicles[1].distributor, consist.vehicles[1].electric)
    with pytest.raises(ValueError, match="distributor of vehicle 2 has no effect with brake_model = delay"):
        Train(consist, settings=Settings(brake_model="delay"))

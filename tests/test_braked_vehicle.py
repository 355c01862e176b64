"""BrakedVehicle with the brakes of the test rig: by flow of air, on treads and on discs; and on a line."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import bogie_braking as bb
from fmu_src.kernel import KernelError
from products.braked_vehicle import BY_FLOW, DISCS, TIMED
from products.machine import coach
from products.protection.rails import RAILS
from products.protection.rig import Rig
from products.protection.runs import Run
from products.protection.settings import BRAKE_START, STANDING, Settings

#: Between two integrations of one system whose tolerances are 1e-6.
SAME = 1e-5


def stop_of(brake: int, line: bb.Line | None = None, **values: Any) -> bb.Recording:
    """Full brake from 25 m/s at BRAKE_START, as on the rig."""
    times, pressure = np.array([0.0, BRAKE_START, BRAKE_START + 1e-6]), coach().full_pressure
    demand = {f"pressure_demand_{n}": (times, np.array([0.0, 0.0, pressure])) for n in coach().numbers}
    names = ["speed", "distance", "disc_temperature_1", "reservoir_pressure", "brake_torque_1"]
    rail = RAILS[0].values(len(coach().numbers))
    return bb.run(
        "braked-vehicle", 30.0, line, names, 0.01, brake_kind=brake, initial_speed=25.0, **rail, **demand, **values
    )


@pytest.mark.parametrize(("brake", "equipment"), [(BY_FLOW, ()), (DISCS, ("discs",))], ids=["treads", "discs"])
def test_its_stop_is_that_of_the_rig(brake: int, equipment: tuple[str, ...]) -> None:
    """One machine in both: the same distance, and the same air from the reservoir."""
    stop = stop_of(brake)
    run = Run(RAILS[0].values(len(coach().numbers)), equipment=equipment)
    [same] = Rig(coach(), None, Settings(), by_flow=True).runs([run])
    assert same.distance is not None
    stands = int(np.argmax(stop["speed"] < STANDING))
    assert stop["distance"][stands] == pytest.approx(same.distance, rel=SAME)
    assert stop["reservoir_pressure"].min() == pytest.approx(same.lowest_reservoir, rel=SAME)
    assert abs(stop_of(TIMED)["distance"][-1] / same.distance - 1.0) > 0.01


def test_discs_take_their_share_of_the_energy_and_treads_warm_none() -> None:
    """m v^2 / 2 of the coach, without what cooling takes: 95 % of it in 800 kg of iron of 510 J/(kg.K)."""
    warm = stop_of(DISCS)["disc_temperature_1"].max() - 293.15
    assert warm == pytest.approx(0.95 * coach().mass * 25.0**2 / 2 / (4 * 200.0 * 510.0), rel=0.07)
    assert np.ptp(stop_of(BY_FLOW)["disc_temperature_1"]) < 1e-9


@pytest.mark.parametrize("brake", [TIMED, DISCS])
def test_it_runs_on_a_line(brake: int) -> None:
    """Down 10 per mille a stop is longer by the share that the slope takes of 1.2 m/s2."""
    down = stop_of(brake, bb.line_of([bb.straight(1000.0, gradient=-0.01)]))["distance"][-1]
    assert down / stop_of(brake)["distance"][-1] == pytest.approx(1.2 / (1.2 - 0.01 * 9.81), rel=0.02)


def test_what_there_is_not_is_refused_with_what_there_is() -> None:
    with pytest.raises(
        KernelError, match=r"no system for level 1, contact_depth 2, brake_kind 2.*Set level to 2.*brake_kind to 1"
    ):
        bb.run("braked-vehicle", 1.0, level=1, brake_kind=BY_FLOW)

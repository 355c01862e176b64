"""BrakedVehicle with the brakes of the test rig (flow of air; treads and discs), and on a line."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import bogie_braking as bb
from fmu_src.kernel import SimulationError
from products.braked_vehicle import BY_FLOW, DISCS, TIMED
from products.machine import coach
from products.protection.rails import RAILS
from products.protection.rig import Rig
from products.protection.runs import Run
from products.protection.settings import BRAKE_START, STANDING, Settings

#: Difference between two integrations of one system with tolerances of 1e-6.
SAME = 1e-5


def stop_of(brake: int, line: bb.Line | None = None, **values: Any) -> bb.Recording:
    """Run a full brake application from 25 m/s at BRAKE_START, as the rig does."""
    times, pressure = np.array([0.0, BRAKE_START, BRAKE_START + 1e-6]), coach().full_pressure
    demand = {f"pressure_demand_{n}": (times, np.array([0.0, 0.0, pressure])) for n in coach().numbers}
    names = ["speed", "distance", "reservoir_pressure", "brake_torque_1"]
    names += [f"disc_temperature_{n}" for n in coach().numbers]
    rail = RAILS[0].values(len(coach().numbers))
    return bb.run(
        "braked-vehicle", 30.0, line, names, 0.01, brake_kind=brake, initial_speed=25.0, **rail, **demand, **values
    )


@pytest.mark.study
@pytest.mark.parametrize(("brake", "equipment"), [(BY_FLOW, ()), (DISCS, ("discs",))], ids=["treads", "discs"])
def test_its_stop_is_that_of_the_rig(brake: int, equipment: tuple[str, ...]) -> None:
    """The rig and the FMU simulate one vehicle: the same distance, and the same air from the reservoir."""
    stop = stop_of(brake)
    run = Run(RAILS[0].values(len(coach().numbers)), equipment=equipment)
    [same] = Rig(coach(), None, Settings(), by_flow=True).runs([run])
    assert same.distance is not None
    stands = int(np.argmax(stop["speed"] < STANDING))
    assert stop["distance"][stands] == pytest.approx(same.distance, rel=SAME)
    assert stop["reservoir_pressure"].min() == pytest.approx(same.lowest_reservoir, rel=SAME)
    assert abs(stop_of(TIMED)["distance"][-1] / same.distance - 1.0) > 0.01


@pytest.mark.study
@pytest.mark.parametrize(("share", "mass"), [(0.95, 200.0), (0.3, 2000.0)])
def test_discs_take_their_share_of_the_energy_and_treads_warm_none(share: float, mass: float) -> None:
    """Without cooling, discs take this share of (m + 4 I / r^2) v^2 / 2, less 1 % for rolling resistance and creep."""
    cold = {"disc_cooling_at_rest": 0.0, "disc_cooling_over_speed": 0.0}
    stop = stop_of(DISCS, disc_heat_share=share, disc_mass=mass, **cold)
    warm = sum(stop[f"disc_temperature_{n}"].max() - 293.15 for n in coach().numbers)
    assert warm * mass * 510.0 == pytest.approx(share * moving(25.0), rel=0.01)
    assert np.ptp(stop_of(BY_FLOW)["disc_temperature_1"]) < 1e-9


def moving(speed: float) -> float:
    """Return the energy of the coach rolling at a speed [J]."""
    p, wheelsets = coach().parameters, len(coach().numbers)
    return (coach().mass + wheelsets * p.wheelset_pitch_inertia / p.wheel_radius**2) * speed**2 / 2


@pytest.mark.study
def test_discs_of_another_radius_brake_as_their_radius_has_it() -> None:
    """T = mu F r, and the friction falls with the speed at r; parameters of the shoes have no effect on discs."""
    fixed = {"pad_friction_over_speed": 0.0, "pad_friction_over_temperature": 0.0}

    def torque(**values: float) -> float:
        return float(stop_of(DISCS, **fixed, **values)["brake_torque_1"].max())

    assert torque(friction_radius=0.5) / torque(friction_radius=0.25) == pytest.approx(2.0, rel=1e-6)
    assert torque(constant_shoe_friction=0.9) == torque()
    slope, least = 4e-3, {"pad_friction_over_temperature": 0.0, "least_pad_friction": 0.0}
    for radius in (0.25, 0.5):
        given = {"friction_radius": radius} | least
        falls, same = (stop_of(DISCS, **given, pad_friction_over_speed=one) for one in (slope, 0.0))
        at = int(np.searchsorted(falls["time"], 6.0))
        share = 1.0 - slope * falls["speed"][at] * radius / coach().parameters.wheel_radius / 0.38
        assert falls["brake_torque_1"][at] / same["brake_torque_1"][at] == pytest.approx(share, rel=2e-3)
    treads = [stop_of(BY_FLOW, constant_shoe_friction=one)["brake_torque_1"].max() for one in (0.25, 0.5)]
    assert treads[1] / treads[0] == pytest.approx(2.0, rel=1e-4)


@pytest.mark.study
@pytest.mark.parametrize("brake", [TIMED, DISCS])
def test_it_runs_on_a_line(brake: int) -> None:
    """Down 10 per mille a full brake decelerates less, by g i over the factor of rotating masses."""
    line, slope = bb.line_of([bb.straight(1500.0, gradient=-0.01)]), 0.01 * 9.81
    runs = {"down": stop_of(brake, line), "level": stop_of(brake)}
    full = 4.0 + BRAKE_START
    slowing = {}
    for name, run in runs.items():
        speed = np.interp([full, full + 4.0], run["time"], run["speed"])
        slowing[name] = (speed[0] - speed[1]) / 4.0
    rotating = moving(1.0) * 2 / coach().mass
    assert slowing["level"] - slowing["down"] == pytest.approx(slope / rotating, rel=0.02)


@pytest.mark.study
@pytest.mark.parametrize("level", [1, 2])
def test_locked_wheels_stop_where_a_map_of_friction_has_taken_their_energy(level: int) -> None:
    """v^2 / 2 = g mu0 times the integral of the factor over the travel of the axles; frames rock at level 2."""
    ends, factors, mu = np.array([-30.0, 60.0, 110.0, 400.0, 3000.0]), np.array([1.0, 0.3, 2.0, 0.8]), 0.08
    line = bb.line_of([bb.straight(3030.0)], -30.0)
    line = line.with_friction(np.repeat(ends, 2)[1:-1], np.repeat(factors, 2))
    wheels = {f"friction_{n}": mu for n in coach().numbers}
    brakes = {f"pressure_demand_{n}": coach().full_pressure for n in coach().numbers} | {"force_per_pressure": 0.5}
    names = ["distance", "speed", *(f"locked_{n}" for n in coach().numbers)]
    stop = bb.run(
        "braked-vehicle", 60.0, line, names, 0.01, level=level, initial_speed=20.0, tolerance=1e-8, **wheels, **brakes
    )
    begin = np.argmax(np.all([stop[f"locked_{n}"] for n in coach().numbers], axis=0)) + 200
    vehicle, taken = coach().vehicle, []
    assert stop["speed"][-1] < 1e-9
    for wheelset in vehicle.wheelsets:
        along = vehicle.number(wheelset.along) + np.array([stop["distance"][begin], stop["distance"][-1]])
        within = np.clip(along[:, None] - ends[:-1], 0.0, np.diff(ends))  # of each piece [m]
        taken.append(float(np.diff(within @ factors)[0]))
    expected = stop["speed"][begin] ** 2 / 2
    assert 9.81 * mu * np.mean(taken) == pytest.approx(expected, rel={1: 1e-4, 2: 0.01}[level])


def test_demands_in_bar_are_noticed() -> None:
    demands = {f"pressure_demand_{n}": 3.8 for n in coach().numbers}
    with pytest.raises(
        SimulationError, match=r"pressure_demand_1 must be 0 or reach 5000 Pa; got 3.8 Pa. Did you.*bar"
    ):
        bb.run("braked-vehicle", 1.0, None, ["speed"], 1.0, **demands)
    with pytest.raises(SimulationError, match=r"pressure_demand_1 must be 0 or reach 5000 Pa; got 3.8 Pa. Did you"):
        bb.run("braked-vehicle", 1.0, pressure_demand_1=([0.0, 1.0], [0.0, 3.8]))
    with pytest.raises(SimulationError, match=r"supply_pressure must be at least 20000 Pa.*Did you mean 3\.8 bar"):
        bb.run("braked-vehicle", 1.0, supply_pressure=3.8)
    with pytest.raises(SimulationError, match=r"body_mass must be at least 100 kg.*Did you mean 32 t = 3.2e.04 kg"):
        bb.run("braked-vehicle", 1.0, body_mass=32.0)


def test_what_there_is_not_is_refused_with_what_there_is() -> None:
    with pytest.raises(
        SimulationError, match=r"no system for level 1, contact_model 2, brake_kind 2.*Set level to 2.*brake_kind to 1"
    ):
        bb.run("braked-vehicle", 1.0, level=1, brake_kind=BY_FLOW)

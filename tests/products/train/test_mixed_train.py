"""A train with one detailed vehicle: FMUs coupled by the master, the same in one process, and stable macro steps."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from fmu_src.cosimulation.master import Connection, Coupling
from fmu_src.cosimulation.slave import FmuInstance
from products.building import up_to_date, write_in_c
from products.coach import COACH, NUMBERS
from products.train.fmu import train_fmu
from products.train.train import Train
from rbd_model.train.coupler import screw_coupler
from scenarios.bench.mixed_train import (
    MASS,
    NEUTRAL,
    PLACE,
    ROTATING,
    SPEED,
    boundary,
    consist_of,
    found_boundary,
    growth,
    growth_of_run,
    linear_vehicle,
    mixed,
)

STEP, LONG = 1e-3, 3.0
#: Tolerances: force and distance [m] against the train as one system; stability boundary.
FORCE, DISTANCE, BOUNDARY = 0.01, 0.01, 0.05


@pytest.mark.study
def test_the_default_way_is_the_train_as_one_system() -> None:
    one, whole = mixed(screw_coupler(), 1, "corrected"), Train(consist_of(screw_coupler()), speed=SPEED)
    one.train.drive("emergency")
    whole.drive("emergency")
    for _ in range(round(8.0 / STEP)):
        one.step(STEP)
        whole.advance(STEP)
    assert whole.largest_compression > 20e3
    assert one.train.largest_compression == pytest.approx(whole.largest_compression, rel=FORCE)
    assert one.train.distance[0] == pytest.approx(whole.distance[0], abs=DISTANCE)


@pytest.mark.study
def test_fmus_coupled_by_the_master_give_the_numbers_of_one_process(tmp_path: Path) -> None:
    """The connections are those of docs/train-couplers.md; the train is stepped first (Gauss-Seidel)."""
    path = tmp_path / "train.fmu"
    write_in_c(train_fmu(consist_of(screw_coupler())), path, 2)
    one = mixed(screw_coupler(), 2, "corrected")
    one.train.drive("emergency")
    for _ in range(round(LONG / STEP)):
        one.step(STEP)
    place = PLACE + 1
    with (
        FmuInstance(path, start_speed=SPEED) as train,
        FmuInstance(up_to_date("vehicle", "native"), level=2, initial_speed=SPEED) as vehicle,
    ):
        train.start(driver_position=4, **{f"external_vehicle[{place}]": 2, f"external_vehicle_speed[{place}]": SPEED})
        vehicle.start()
        torque = COACH.wheel_radius / len(NUMBERS)
        coupling = Coupling(
            [train, vehicle],
            [
                Connection(vehicle, "state_body_speed", train, f"external_vehicle_speed[{place}]"),
                Connection(train, f"mean_coupler_force[{place - 1}]", vehicle, "coupler_force_front"),
                Connection(train, f"mean_coupler_force[{place}]", vehicle, "coupler_force_rear", -1.0),
                *(Connection(train, f"brake_force[{place}]", vehicle, f"brake_torque_{n}", torque) for n in NUMBERS),
            ],
        )
        for n in range(round(LONG / STEP)):
            coupling.advance(n * STEP, STEP)
        assert train["largest_compression"] == pytest.approx(one.train.largest_compression, rel=1e-6)
        assert train["distance[1]"] == pytest.approx(float(one.train.distance[0]), abs=1e-6)
        assert vehicle["speed"] == pytest.approx(one.vehicle["speed"], abs=1e-7)


@pytest.mark.study
def test_the_largest_stable_step_of_a_held_speed_is_that_of_paper() -> None:
    stiffness, vehicle = 198e6, linear_vehicle(1)
    paper = boundary("held", stiffness, vehicle)
    assert found_boundary("held", 1, stiffness, paper) == pytest.approx(paper, rel=BOUNDARY)
    # With a twentieth of the stiffness, steps longer by the square root of 20 are stable.
    assert boundary("held", stiffness / 20, vehicle) == pytest.approx(paper * 20**0.5, rel=0.02)


@pytest.mark.study
@pytest.mark.parametrize("beyond", [1.2, 1.3, 1.4])
def test_a_corrected_copy_grows_by_the_eigenvalue_of_paper(beyond: float) -> None:
    """By less than a thousandth in a step; it decays below the boundary."""
    stiffness, vehicle = 198e6, linear_vehicle(1)
    paper = boundary("corrected", stiffness, vehicle)
    expected = growth("corrected", beyond * paper, stiffness, vehicle) - 1.0
    assert growth_of_run("corrected", 1, stiffness, beyond * paper, 12000) == pytest.approx(expected, rel=0.05)
    assert growth_of_run("corrected", 1, stiffness, 0.95 * paper, 12000) < 0.0


@pytest.mark.parametrize("level", [1, 2])
@pytest.mark.parametrize("stiffness", [50e6, 198e6, 1e9])
def test_steps_that_the_fmu_takes_are_stable(level: int, stiffness: float) -> None:
    """The FMU refuses steps beyond 1 / omega with a held speed and half of it with a corrected copy."""
    vehicle, omega = linear_vehicle(level), (2 * stiffness / MASS / (1 + ROTATING)) ** 0.5
    for way, share in (("held", 1.0), ("corrected", 0.5)):
        assert growth(way, share / omega, stiffness, vehicle) < 1.0 + NEUTRAL


@pytest.mark.study
def test_a_copy_of_another_mass_is_corrected_and_a_brake_that_is_left_out_is_seen() -> None:
    """The copy is corrected each millisecond, so twice its mass has little effect. A missing brake makes it push."""
    errors = []
    for heavier, braked in ((2.0, True), (1.0, False)):
        one, consist = mixed(screw_coupler(), 1, "corrected"), consist_of(screw_coupler())
        brake = consist.vehicles[PLACE].brake if braked else replace(consist.vehicles[PLACE].brake, efficiency=0.0)
        copy = replace(consist.vehicles[PLACE], mass=heavier * consist.vehicles[PLACE].mass, brake=brake)
        vehicles = tuple(copy if n == PLACE else v for n, v in enumerate(consist.vehicles))
        one.train = Train(replace(consist, vehicles=vehicles), speed=SPEED, settings=one.train.settings)
        whole = Train(consist, speed=SPEED)
        for train in (one.train, whole):
            train.drive("emergency")
        for _ in range(8000):
            one.step(STEP)
            whole.advance(STEP)
        errors.append(abs(one.train.largest_compression / whole.largest_compression - 1.0))
    assert errors[0] < FORCE < errors[1]

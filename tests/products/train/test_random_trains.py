"""Random mixed trains: short runs with any distributors, hoses, commands, speeds and gradients stay finite."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from brake_controller.distributors import keeps_pipe, kind_of
from brake_controller.distributors.aar import RETAINERS
from brake_controller.distributors.vacuum import VACUUM
from brake_controller.drivers_valve import POSITIONS
from products.train.consist_file import consist_of
from products.train.numbers import Settings
from products.train.train import Train, idle_inputs
from rbd_model.track.line import Line

#: Highest gauge pressures [Pa]: supply of the driver's valves, with which a pipe may be filled.
SUPPLY = 800e3
#: Pressure by which air in motion swings beyond that of its surroundings [Pa]: rho c u at 30 m/s. The most in 20 000
#: runs was 8.3 kPa; steps without the limit of wall friction had 52 kPa.
SWING = 12e3
#: Pressure by which steps of a wide choke miss that of the surroundings [Pa].
NEAR = 100.0
#: Temperature of the surroundings [K].
COLD = 293.15
#: Brakes by compressed air, and columns that a vehicle in detail has no use for.
BY_AIR = ("uic", "aar", "ecp", "ep_uic", "twin_pipe")
NOT_IN_DETAIL = ("length", "magnetic_attraction", "eddy_force")
#: Runs of the short and of the long form.
FEW, MANY = 40, 20000


def row_of(draw: np.random.Generator, brakes: Sequence[str]) -> dict[str, Any]:
    """Return a vehicle with a random brake."""
    kind = str(draw.choice(["wagon", "wagon", "coach", "locomotive"]))
    row: dict[str, Any] = {"kind": kind, "valve": "none", "length": draw.uniform(5.0, 30.0)}
    row |= {"mass": draw.uniform(22.0, 100.0)} if kind == "wagon" else {}
    row |= {"coupler": str(draw.choice(["screw", "draft-gear", "rigid"]))}
    row |= {"leak": draw.uniform(0.0, 3.0)} if draw.random() < 0.2 else {}
    most = {"dynamic_force": 300.0, "magnetic_attraction": 100.0, "eddy_force": 20.0}
    most |= {"parking_force": 40.0}
    row |= {name: draw.uniform(10.0, limit) for name, limit in most.items() if draw.random() < 0.2}
    row |= {"traction_table": "0:300 50:200 120:0", "adhesion": "curtius-kniffler"} if draw.random() < 0.2 else {}
    brake = str(draw.choice([*brakes, "ep-direct", "none"]))
    if kind == "coach" and draw.random() < 0.2:
        row = {name: value for name, value in row.items() if name not in NOT_IN_DETAIL} | {
            "detail": "coach",
            "level": 1,
        }
    elif brake not in ("none", "vacuum") and draw.random() < 0.3:
        row |= {"protection": "built-in", "sample_time": draw.uniform(2.0, 50.0), "valve_time": draw.uniform(0.0, 0.2)}
        row |= {"friction_ratio": 0.4, "friction_decay": 0.6}
    if brake not in ("none", "vacuum") and draw.random() < 0.3:
        row |= {"direct_pressure": draw.uniform(0.5, 6.0), "direct_volume": 10.0 ** draw.uniform(-0.3, 2.3)}
        row |= {f"direct_{way}_time": 10.0 ** draw.uniform(-0.3, 1.7) for way in ("fill", "release")}
    if "dynamic_force" in row and brake in ("uic", "aar", "ep_uic", "twin_pipe"):
        row |= {"blending": "interlock"} if draw.random() < 0.5 else {}
    if brake == "none":
        return row | {"brake": brake}
    row |= heat_of(draw, kind) if draw.random() < 0.3 else {}
    if brake == "ep-direct":
        return row | {"brake": brake}
    row |= {"distributor": brake}
    if brake == "vacuum":
        return row | {"lambda": draw.uniform(30.0, 120.0), "direct_admission": str(draw.choice(["yes", "no"]))}
    if brake == "aar":
        row |= {"retainer": str(draw.choice(RETAINERS)), "accelerated_release": str(draw.choice(["yes", "no"]))}
        return row | ({"empty_load": draw.uniform(0.3, 0.9)} if row.get("mass", 99.0) < 40.0 else {})
    if brake in ("uic", "ep_uic", "twin_pipe"):
        row |= {"position": str(draw.choice(["P", "G"]))}
    return row | ({"dead_time": draw.uniform(0.0, 2.0)} if brake in ("ecp", "ep_uic") else {})


def heat_of(draw: np.random.Generator, kind: str) -> dict[str, Any]:
    """Return the heat of a random brake: wheels, or discs if it has no blocks, with a surface, blocks and a table."""
    row: dict[str, Any] = {"wheel_mass": draw.uniform(200.0, 500.0)}
    if kind != "wagon" and draw.random() < 0.5:
        row = {"disc_mass": draw.uniform(50.0, 150.0), "discs": int(draw.integers(1, 17))}
    if draw.random() < 0.5:
        row |= {"thickness": draw.uniform(2.0, 50.0), "rubbed_area": draw.uniform(0.05, 0.13)}
    row |= {"block_mass": 10 ** draw.uniform(-1.0, 2.0)} if draw.random() < 0.5 else {}
    return row | ({"fade_table": "30:1.2 60:0.3 90:2 400:0"} if draw.random() < 0.5 else {})


def train_of(draw: np.random.Generator) -> Train:
    """Return a random train on a random line."""
    vacuum = draw.random() < 0.15
    brakes = ("vacuum",) if vacuum else BY_AIR
    rows = [row_of(draw, brakes) | {"valve": "head"}, *(row_of(draw, brakes) for _ in range(draw.integers(0, 9)))]
    delayed = draw.random() < 0.2 and not vacuum  # a delay has no flow of air
    rows[0] |= {"vigilance_time": 2.0, "warning_time": 1.0}
    if not (delayed or vacuum):
        cut_out = draw.uniform(6.5, 8.0)
        rows[0] |= {"main_reservoir": 10.0 ** draw.uniform(1.4, 4.0), "compressor": 10.0 ** draw.uniform(2.0, 4.0)}
        rows[0] |= {"cut_in": cut_out - 1.0, "cut_out": cut_out}
    if len(rows) > 1 and draw.random() < 0.3:
        rows[-1] |= {"valve": "second", "delay": draw.uniform(0.0, 2.0)}
    places = np.cumsum(draw.uniform(1.0, 800.0, 5)) - 1000.0
    line = Line({"distance": places, "gradient": draw.uniform(-0.05, 0.05, 5)})
    assisted = any(row.get("distributor") == "ep_uic" for row in rows)
    leaks = any("leak" in row for row in rows)
    models = ["whole", "whole", "empirical", *(["delay"] * 3 if delayed and not (assisted or leaks) else [])]
    # One cell in all would be a resonator without friction: its air swings far above the supply.
    cells = [1.0, 1.0, 2.0, *([0.5] if len(rows) > 2 else [])]
    settings = Settings("whole" if vacuum else str(draw.choice(models)), cells=float(draw.choice(cells)))
    start = {"pipe": draw.choice([0.0, 500e3, draw.uniform(5e3, SUPPLY)]), "cylinder": draw.choice([0.0, 380e3])}
    consist = consist_of(rows)
    if consist.charged_pressure < 0.0:
        start = {"pipe": -draw.choice([0.0, VACUUM, draw.uniform(5e3, VACUUM)])}
    return Train(consist, speed=draw.uniform(-10.0, 60.0), line=line, settings=settings, **start)


def disturb(train: Train, draw: np.random.Generator) -> None:
    """Set random commands of the driver, of protection, motors and other brakes; shut or part hoses."""
    by_wire = keeps_pipe(kind_of(vehicle.distributor) for vehicle in train.consist.vehicles)
    positions = list(POSITIONS)[: 5 if by_wire else None]  # without hold and continuous service
    for valve in range(train.inputs["driver_position"].size):
        train.drive(str(draw.choice(positions)), draw.random(), valve)
    vehicles = len(train.consist.vehicles)
    by_hand = [not vehicle.protection.controller for vehicle in train.consist.vehicles]
    train.inputs["protection"] = by_hand * draw.choice([0.0, 0.0, 0.0, 1.0, 2.0], vehicles)
    train.inputs["friction"] = draw.uniform(0.02, 0.6, vehicles)
    train.inputs["pull"] = draw.choice([0.0, 0.0, 1.0], vehicles) * draw.uniform(-2e5, 3e5, vehicles)
    train.inputs["penalty"] = draw.choice([0.0, 0.0, 0.0, 1.0, 2.0])
    train.inputs["bail_off"] = (
        0.0 if "bail_off" in idle_inputs(train.consist) else draw.choice([0.0, 0.0, 1.0], vehicles)
    )
    for name in ("dynamic_brake", "traction", "track_brake", "parking_brake", "direct_brake"):
        shares = draw.choice([0.0, 0.0, 1.0], vehicles) * draw.random(vehicles)
        train.inputs[name] = 0.0 if name in idle_inputs(train.consist) else shares
    if vehicles > 1 and train.settings.cells >= 1.0 and draw.random() < 0.5:
        train.inputs["hose_state"] = draw.choice([0.0, 0.0, 0.0, 1.0, 2.0], vehicles - 1)


def faults(seed: int) -> str:
    """Return what is wrong with a random run, empty if nothing: numbers not finite, pressures, lost air."""
    draw = np.random.default_rng(seed)
    train = train_of(draw)
    mass = train.air.mass
    for time in draw.uniform(0.05, 4.0, 3):
        disturb(train, draw)
        before, after = train.state, list[bytes]()
        try:
            for _ in range(2):
                train.state = before
                train.advance(float(time))
                after.append(train.state.tobytes())
        except ValueError as error:
            return str(error)
        if after[0] != after[1]:
            return "a saved state does not continue alike"
    if not all(
        np.isfinite(getattr(train, name)).all() for name in ("speed", "distance", "coupler_force", "brake_force")
    ):
        return "a number is not finite"
    for name in ("brake_temperature", "surface_temperature", "block_temperature"):
        found = getattr(train, name)
        if not (found.min() > COLD - 1e-6 and np.isfinite(found).all()):
            return f"the {name} is {found.min():g} to {found.max():g} K"
    for pressures, least in (
        (train.cylinder_pressure, -NEAR),
        (train.pipe_pressure, min(train.consist.charged_pressure, 0.0) - SWING),
    ):
        if not (pressures.min() > least and pressures.max() < SUPPLY + SWING):
            return f"pressures are {pressures.min():.0f} to {pressures.max():.0f} Pa"
    gone = train.air.passed
    left = train.air.mass + gone.valve_mass + gone.leak_mass + gone.vehicle_mass + sum(gone.end_mass)
    if train.settings.brake_model != "delay" and abs(left - mass) > 1e-9 * (mass + abs(gone.valve_mass)):
        return f"{left - mass:g} kg of air are lost"
    return ""


def count_faults(seeds: range) -> dict[int, str]:
    """Return faults by seed."""
    return {seed: fault for seed in seeds if (fault := faults(seed))}


def test_random_mixed_trains_stay_finite_and_lose_no_air() -> None:
    assert count_faults(range(FEW)) == {}


@pytest.mark.long
@pytest.mark.timeout(7200)
def test_many_random_mixed_trains_stay_finite_and_lose_no_air() -> None:
    assert count_faults(range(FEW, MANY)) == {}

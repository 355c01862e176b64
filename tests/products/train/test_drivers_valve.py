"""Driver's valves, cocks and parted hoses: regulated pressures, balances, and effects at the end of a train."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
import pytest

from brake_controller.distributors.uic import freight
from brake_controller.drivers_valve import drivers_valve
from products.train.consist import Consist, block_train, locomotive, wagon
from products.train.numbers import Settings
from products.train.train import Train

#: Gauge pressures [Pa]: running position; largest pressure of the cylinder.
RUNNING, FULL = 500e3, 380e3
#: Largest control error of a relay [Pa]: half of its dead band.
HELD = 5e3
MASS, ENERGY = 1e-12, 1e-9


def train(wagons: int = 10, **settings: object) -> Train:
    return Train(block_train(wagons), settings=Settings(**settings))  # type: ignore[arg-type]


def settled(one: Train, position: str, step: float = 0.0, time: float = 60.0) -> np.ndarray:
    one.drive(position, step)
    one.advance(time)
    return np.asarray(one.pipe_pressure)


@pytest.mark.parametrize(("step", "fall"), [(0.0, 40e3), (0.5, 95e3), (1.0, 150e3)])
def test_service_holds_the_pipe_at_its_step(step: float, fall: float) -> None:
    """First step 4.6 bar (UIC 540: 4.6 to 4.8), full service 3.5 bar, in the whole train; cylinders follow."""
    one = train()
    pressure = settled(one, "service", step)
    assert pressure == pytest.approx(np.full(11, RUNNING - fall), abs=HELD)
    due = FULL * min(fall / 150e3, 1.0)
    assert one.cylinder_pressure == pytest.approx(np.full(11, due), abs=0.04 * FULL)


def test_a_release_brings_the_pipe_back_and_cylinders_to_nothing() -> None:
    one = train()
    settled(one, "service", 1.0, 30.0)
    pressure = settled(one, "running", time=90.0)
    assert pressure == pytest.approx(np.full(11, RUNNING), abs=HELD)
    assert one.cylinder_pressure.max() < 20e3
    assert one.air_used > 0.0


def test_an_overcharge_falls_in_three_minutes_without_braking() -> None:
    one = train(4)
    assert settled(one, "overcharge", time=30.0) == pytest.approx(np.full(5, 540e3), abs=HELD)
    one.drive("running")
    one.advance(90.0)
    assert one.pipe_pressure == pytest.approx(np.full(5, 520e3), abs=HELD)
    one.advance(120.0)
    assert one.pipe_pressure == pytest.approx(np.full(5, RUNNING), abs=HELD)
    assert one.cylinder_pressure.max() < 1e3


def test_a_valve_that_is_shut_off_lets_leaks_empty_the_pipe_and_an_open_one_feeds_them() -> None:
    leaky = Consist(tuple(replace(one, leak=1e-7) for one in block_train(5).vehicles))
    fed, closed = Train(leaky), Train(leaky)
    fed.drive("running")
    closed.drive("shut-off")
    for one in (fed, closed):
        one.advance(60.0)
    assert fed.pipe_pressure == pytest.approx(np.full(6, RUNNING), abs=2 * HELD)
    assert (closed.pipe_pressure < RUNNING - 20e3).all()
    assert closed.air_used == 0.0 < fed.air_used


def test_an_emergency_empties_the_pipe_and_fills_all_cylinders() -> None:
    one = train()
    pressure = settled(one, "emergency", time=30.0)
    assert pressure.max() < 50e3
    assert one.cylinder_pressure == pytest.approx(np.full(11, FULL), rel=0.01)


def test_a_shut_cock_keeps_the_brake_from_what_is_behind_it() -> None:
    one = train()
    one.inputs["hose_state"][4] = 1.0
    one.drive("emergency")
    one.advance(20.0)
    assert (one.cylinder_pressure[:5] > 0.99 * FULL).all()
    assert one.cylinder_pressure[5:].max() < 1e3
    assert one.pipe_pressure[5:] == pytest.approx(np.full(6, RUNNING), rel=1e-3)


def test_a_hose_that_parts_brakes_both_parts() -> None:
    one = train()
    one.inputs["hose_state"][4] = 2.0
    one.inputs["coupling_closed"][4] = 0.0
    one.advance(20.0)
    assert (one.cylinder_pressure[5:] > 0.9 * FULL).all()
    assert one.cylinder_pressure[4] > 0.9 * FULL
    # The valve at the head still feeds the pipe.
    assert one.pipe_pressure[0] > one.pipe_pressure[4]


def parted_by(gap: float, *, hose: float = 0.0, faster: float = 0.0) -> Train:
    """Return a train whose first five vehicles are ahead by a gap [m], and faster [m/s], with a shut driver's valve."""
    one, motion = train(), train().motion
    one.drive("shut-off")
    one.inputs["coupling_closed"][4], one.inputs["hose_state"][4] = 0.0, hose
    motion[0, :5] += gap
    motion[1:3] += 5.0
    motion[1:3, :5] += faster
    one.motion = motion
    return one


def closed_up(one: Train, **inputs: float) -> None:
    """Let the parts touch at rest, set inputs of the coupling between them, and charge the pipe for a minute."""
    motion = one.motion
    motion[0, :5] += motion[0, 5] - motion[0, 4]
    motion[1:3], motion[3] = 0.0, train().motion[3]
    one.motion = motion
    for name, value in inputs.items():
        one.inputs[name][4] = value
    one.drive("running")
    one.advance(60.0)


def test_a_hose_parts_where_vehicles_separate_by_more_than_its_reach() -> None:
    """At a difference of 2 m/s a gap of 1 m is there after 0.5 s; both pipes end at the air outside."""
    one, again = parted_by(0.0, faster=2.0), train()
    one.advance(0.45)
    assert one.messages == []
    assert one.pipe_pressure == pytest.approx(np.full(11, RUNNING), rel=1e-3)
    one.advance(0.15)
    [told] = one.messages
    assert re.fullmatch(r"The rear hose of vehicle 5 parted at 0\.5\d s\.", told)
    again.state = one.state
    for each in (one, again):
        each.inputs["hose_state"][4] = 0.0
        each.advance(60.0)
    assert np.array_equal(one.pipe_pressure, again.pipe_pressure)
    assert again.messages == one.messages == [told]
    assert np.abs(one.pipe_pressure).max() < 1e3
    closed_up(one, coupling_closed=1.0)
    assert one.pipe_pressure[5:].max() < 1e3  # no one has joined the hoses
    one.inputs["hose_state"][4] = 2.0
    one.advance(1.0)
    closed_up(one, hose_state=0.0)
    assert one.pipe_pressure[5:].min() > 0.5 * RUNNING


@pytest.mark.parametrize("hose", [1.0, 2.0])
def test_hoses_across_a_gap_are_joined_once_the_vehicles_touch(hose: float) -> None:
    """A shut cock keeps the air of both parts; opened 10 m apart, it lets it out."""
    one = parted_by(10.0, hose=hose)
    one.advance(30.0)
    assert one.pipe_pressure[5:].max() == pytest.approx(RUNNING if hose == 1.0 else 0.0, abs=1e3)
    kept = one.state
    one.inputs["hose_state"][4], one.inputs["coupling_closed"][4] = 0.0, 1.0
    one.drive("running")
    one.advance(30.0)
    assert one.pipe_pressure[5:].max() < 5e3
    one.state = kept
    closed_up(one, coupling_closed=1.0, hose_state=0.0)
    assert one.pipe_pressure[5:].min() > 0.5 * RUNNING
    assert one.messages == []


@lru_cache
def fed(*joints: float) -> Train:
    """Return three vehicles with open valves after half a minute with these joints."""
    one = Train(Consist(tuple(replace(wagon(), valve=drivers_valve()) for _ in range(3))))
    for valve in range(3):
        one.drive("running", valve=valve)
    one.inputs["hose_state"] = joints
    one.advance(30.0)
    return one


class Hose:
    """A hose as people see it: joined, torn, or loose, which hands can join where the vehicles touch."""

    def __init__(self) -> None:
        self.state, self.wanted, self.coupled, self.told = "joined", 0.0, True, False

    def handled(self, wanted: float, closed: bool, apart: float) -> float:
        """Return the gap [m] after hands changed hose and coupling, and vehicles moved apart if they can."""
        gap = 0.0 if closed and self.coupled else apart
        self.coupled = closed and gap == 0.0
        if self.state == "torn" and wanted != self.wanted:
            self.state = "loose"
        self.wanted = wanted
        if gap == 0.0 and self.state == "loose":
            self.state = "joined"
        if gap > 1.0 and self.state == "joined":
            self.state = "loose" if wanted else "torn"
            self.told |= not wanted
        return gap

    @property
    def joint(self) -> float:
        """What is between the pipes: 0 a hose, 1 shut cocks, 2 the air outside."""
        return self.wanted if self.wanted or self.state == "joined" else 2.0


@pytest.mark.parametrize("seed", range(4))
def test_random_gaps_couplings_and_cocks_leave_the_joints_of_a_plain_state_machine(seed: int) -> None:
    """Two gaps; each section between cocks is fed by its own valve, so that pressures show the joints."""
    draw, hoses, one, joints = np.random.default_rng(seed), (Hose(), Hose()), Train(fed(0, 0).consist), set()
    for valve in range(3):
        one.drive("running", valve=valve)
    for _ in range(20):
        wanted, closed, motion = draw.integers(3, size=2), draw.integers(2, size=2), one.motion
        apart = draw.choice([0.0, 0.0, 0.9, 1.1], 2)
        gaps = [hose.handled(*given) for hose, *given in zip(hoses, wanted, closed == 1, apart, strict=True)]
        motion[0], motion[1:] = (sum(gaps), gaps[1], 0.0), 0.0
        one.motion, one.inputs["hose_state"], one.inputs["coupling_closed"] = motion, wanted, closed
        one.advance(30.0)
        joints.add(tuple(float(hose.joint) for hose in hoses))
        assert one.pipe_pressure == pytest.approx(fed(*(hose.joint for hose in hoses)).pipe_pressure, abs=HELD)
        assert [f"hose of vehicle {n} " in " ".join(one.messages) for n in (1, 2)] == [hose.told for hose in hoses]
    assert len(joints) > 5


@pytest.mark.parametrize("where", [5, 10])
def test_a_second_valve_helps_as_soon_as_its_radio_lets_it(where: int) -> None:
    """Until it receives the command, a second valve feeds the pipe; at mid-train this delays the brake."""
    vehicles = list(block_train(10).vehicles)
    begun = []
    for delay in (None, 0.0, 1.0):
        own = list(vehicles)
        if delay is not None:
            own[where] = replace(wagon(), valve=drivers_valve(), valve_delay=delay)
        one = Train(Consist(tuple(own)))
        one.drive("emergency")
        time = 0.0
        while one.cylinder_pressure[where] < 10e3:
            one.advance(0.01)
            time += 0.01
        begun.append(time)
    alone, at_once, later = begun
    assert at_once < alone <= later <= at_once + 1.05


def test_a_valve_in_the_middle_brakes_both_halves_alike() -> None:
    equal = replace(wagon(), distributor_at=0.5)
    vehicles = [equal] * 4 + [replace(equal, valve=drivers_valve())] + [equal] * 4
    one = Train(Consist((replace(equal, valve=drivers_valve()), *vehicles)), settings=Settings(cells=3))
    one.drive("shut-off", valve=0)
    one.drive("emergency", valve=1)
    one.advance(2.0)
    pressure = one.pipe_pressure
    assert pressure[5] == pytest.approx(pressure[4], rel=0.02)
    assert pressure[9] == pytest.approx(pressure[0], rel=0.02)
    assert pressure[9] < RUNNING - 20e3


def test_mass_and_energy_close_with_valves_cocks_and_parted_hoses() -> None:
    """Balance of the air in the pipe: flow through valves, hoses and vehicles, and heat from walls."""
    vehicles = list(block_train(6).vehicles)
    for place in (3, 5):  # at the parted hose and behind the shut cock
        vehicles[place] = replace(wagon(), valve=drivers_valve())
    one = Train(Consist(tuple(vehicles)))
    one.inputs["hose_state"][2] = 2.0
    one.inputs["hose_state"][4] = 1.0
    mass, energy = one.air.mass, one.air.energy
    for position in ("emergency", "running", "service", "overcharge"):
        for valve in range(3):
            one.drive(position, 0.3, valve)
        one.advance(3.0)
    gone = one.air.passed
    left = gone.valve_mass + gone.leak_mass + gone.vehicle_mass
    assert one.air.mass + left == pytest.approx(mass, rel=MASS)
    carried = gone.valve_energy + gone.leak_energy + gone.vehicle_energy - gone.heat
    assert one.air.energy + carried == pytest.approx(energy, rel=ENERGY)
    assert gone.let_in > 0.0
    assert gone.leak_mass > 0.0


@pytest.mark.parametrize("name", ["full", 3, None])
def test_a_drivers_position_out_of_range_is_refused(name: Any) -> None:
    one = train(1)
    with pytest.raises(
        ValueError, match=f"A driver's valve must be set to one of shut-off, running, .*; got {name}. Choose one."
    ):
        one.drive(name)
    with pytest.raises(
        ValueError, match=r"A step of service, 0 the first and 1 full, must be a number from 0 to 1; got 1.2."
    ):
        one.drive("service", 1.2)


def test_a_train_in_position_g_brakes_later_than_in_p() -> None:
    times = []
    for position in ("P", "G"):
        vehicles = (locomotive(0.0, position), *[wagon(60e3, position)] * 5)
        one = Train(Consist(vehicles))
        one.drive("emergency")
        time = 0.0
        while one.cylinder_pressure[-1] < 0.95 * FULL:
            one.advance(0.05)
            time += 0.05
        times.append(time)
    assert 3.0 < times[0] < 6.0
    assert 18.0 < times[1] < 30.0
    assert freight("G").filling_choke < freight("P").filling_choke


@pytest.mark.parametrize(
    ("name", "value", "sentence"),
    [
        ("driver_position", 2.5, r"inputs\['driver_position'\]\[0\] must be an integer from 0 to 6; got 2.5."),
        ("protection", 3.0, r"inputs\['protection'\]\[0\] must be an integer from 0 to 2; got 3."),
        ("friction", float("nan"), r"inputs\['friction'\]\[0\] must be a number from 0 to 2; got nan."),
        ("friction", -0.3, r"inputs\['friction'\]\[0\] must be a number from 0 to 2; got -0.3."),
        ("hose_state", 3.0, r"inputs\['hose_state'\]\[0\] must be an integer from 0 to 2; got 3."),
    ],
)
def test_an_input_that_cannot_be_is_refused_and_the_train_stays_as_it_was(
    name: str, value: float, sentence: str
) -> None:
    one = train(3)
    one.advance(1.0)
    before = one.motion
    one.inputs[name][0] = value
    with pytest.raises(ValueError, match=sentence):
        one.advance(1.0)
    assert np.array_equal(one.motion, before)


def test_an_input_is_set_as_a_whole() -> None:
    """A pull can be set by one number for all vehicles, or by one for each."""
    each, whole, one_by_one = (train(2, brake_model="delay") for _ in range(3))
    whole.inputs["pull"] = 2e3
    each.inputs["pull"] = [2000, 2000, 2000]
    one_by_one.inputs["pull"][:] = 2e3
    for one in (each, whole, one_by_one):
        one.drive("running")
        one.advance(2.0)
    assert whole.speed[0] != 0.0
    assert np.array_equal(whole.speed, one_by_one.speed)
    assert np.array_equal(each.speed, one_by_one.speed)


@pytest.mark.parametrize(
    ("name", "value", "error", "sentence"),
    [
        ("frction", 0.1, KeyError, r"A train has no input frction; did you mean friction\?"),
        ("friction", [0.1, 0.2], ValueError, r"must be one number, or 3 of them, .* array of shape \(2,\)"),
        (
            "friction",
            [0.1, 0.2, np.nan],
            ValueError,
            r"inputs\['friction'\]\[2\] must be a number from 0 to 2; got nan",
        ),
        ("position", 1.0, KeyError, "no input position; its name is driver_position now"),
        ("driver_position", 2.5, ValueError, r"inputs\['driver_position'\]\[0\] must be an integer"),
        ("pull", "5", ValueError, r"inputs\['pull'\] must be numbers; got '5'"),
        ("pull", [[1.0], 2.0], ValueError, r"inputs\['pull'\] must be numbers"),
        ("pull", np.ma.array([1.0] * 3, mask=[0, 1, 0]), ValueError, "none of them masked"),
    ],
)
def test_an_input_that_cannot_be_set_keeps_its_values(
    name: str, value: object, error: type[Exception], sentence: str
) -> None:
    one = train(2)
    before = {own: values.copy() for own, values in one.inputs.items()}
    with pytest.raises(error, match=sentence):
        one.inputs[name] = value  # type: ignore[assignment]
    assert all(np.array_equal(one.inputs[own], values) for own, values in before.items())


def test_what_is_no_number_place_or_state_is_refused() -> None:
    one, other = train(3), train(5)
    with pytest.raises(ValueError, match=r"The time must be a number from 0 to 86400 s; got 1."):
        one.advance("1")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"The number of a valve must be an integer from 0 to 0; got 3."):
        one.drive("service", 0.5, 3)
    with pytest.raises(ValueError, match=r"The number of a vehicle must be an integer from 0 to 3; got -1."):
        one.lead(-1, 1.0)
    with pytest.raises(ValueError, match="The state must be one that this train has saved"):
        one.state = other.state
    with pytest.raises(ValueError, match=r"speed must be a number from -150 to 150 m/s; got nan."):
        Train(block_train(3), speed=float("nan"))


@pytest.mark.parametrize(
    ("settings", "remedy"),
    [({"cells": 0.5}, "one cell"), ({"brake_model": "delay", "cells": 1.0}, "another brake model")],
)
def test_a_cock_where_a_pipe_has_none_is_refused(settings: dict[str, Any], remedy: str) -> None:
    one = train(6, **settings)
    one.inputs["hose_state"][0] = 1.0
    with pytest.raises(ValueError, match=f"there is no cock or hose; take {remedy}"):
        one.advance(1.0)


def test_a_second_valve_follows_until_it_has_a_position_of_its_own() -> None:
    vehicles = list(block_train(10).vehicles)
    vehicles[-1] = replace(wagon(), valve=drivers_valve(), valve_delay=0.0)
    one = Train(Consist(tuple(vehicles)))
    one.drive("emergency", valve=1)
    one.advance(1.0)
    assert one.pipe_pressure[-1] < 250e3
    assert one.pipe_pressure[0] > 450e3

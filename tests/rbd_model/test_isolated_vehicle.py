"""Test a free vehicle: only its weight changes its momentum, and only dissipation changes its energy.

The tests use the whole compiled right-hand side of level 3, with the wheelsets lifted off their rails and the brakes
on. Newton's third law, in its strong form, is valid for any law of a spring. A connection whose opposite forces act at
two different points keeps momentum and energy, but not angular momentum.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest

from rbd_model.vehicle.description import (
    BumpStop,
    ForceLaw,
    FrictionSlider,
    RigidBody,
    SeriesDamper,
    Springs,
    TableDamper,
    TableSpring,
    Torsion,
    Vehicle,
)
from rbd_model.vehicle.ready import two_axle_bogie
from tests.balance import parts, pushed
from tests.evidence.maximal.correspondence import bodies_of, rates_of
from tests.evidence.maximal.machine import ENERGIES, POWERS, Machine
from tests.evidence.maximal.oracle import Scene
from tests.evidence.maximal.rails import STRAIGHT
from tests.evidence.maximal.states import random_course

#: Tolerance of sums that cancel, as a share of the terms; velocities of 10 m/s are differenced over 1e-6 s: 2e-11.
MOMENTUM_BAND = 1e-10
#: Tolerance of energies differenced over 1e-6 s, as a share of the powers in them; measured 3e-9.
ENERGY_BAND, MOMENT = 1e-7, 1e-6
#: Lift of the wheelsets [m], largest displacement from rest [m], [rad], and largest velocity.
LIFTED, AWAY, MOVING = 0.2, 0.05, 0.2
STATES = 5
#: Straight track, and in the long run also lines.
TRACKS = [False, pytest.param(True, marks=pytest.mark.long)]
#: Tolerance, of the largest acceleration: connections of the oracle are differenced over 10 um; measured 5e-11.
ORACLE_BAND = 1e-9


def own_force(travel: Any, rate: Any, stiffness: Any) -> Any:
    """Return a progressive spring and a damper that stiffens with it, for numbers and for symbols."""
    return stiffness * travel * (1 + 9 * travel**2) + 1e4 * (1 + travel**2) * rate


def everything() -> Vehicle:
    """Return the loaded bogie of chapter 5 with every connection: body to body, body to wheelset, wheelset to body."""
    bogie = two_axle_bogie()
    inertia = (3e3, 5e3, 6e3)
    ends = {"upper": "load", "lower": "frame"}, {"upper": "frame", "lower": "wheelset_1"}
    boxed = {"upper": "wheelset_2", "lower": "frame"}
    stiff, soft = (3e6, 2e6, 1e6), (3e4, 2e4, 1e4)
    connections = [
        *bogie.connections,
        Springs("ahead", **ends[0], place=(0.5, 0.6, 1.0), both_sides=True, stiffness=stiff, damping=soft),
        Springs("behind", **ends[0], place=(-0.5, 0.6, 1.0), both_sides=True, stiffness=stiff, damping=soft),
        Springs("link", **boxed, place=(-0.4, 0.7, 0.3), both_sides=True, stiffness=(1e6, 2e6, 0.0), damping=soft),
    ]
    inclined = {"stiffness": (1e6, 2e6, 0.0), "damping": soft, "inclination": 0.3}
    connections.append(Springs("arm", **ends[1], place=(-0.4, 0.7, 0.1), both_sides=True, **inclined))
    # Its mean slope is the stiffness of the springs beside it, so that all carry the same.
    under = {"travel": (0.0, 0.05, 0.1), "force": (0.0, 2e4, 1e5)}
    connections.append(TableSpring("progressive", **ends[0], place=(0.0, 0.6, 1.0), both_sides=True, **under))
    for number, both in enumerate((*ends, boxed)):
        at = {"place": (0.2 - 0.4 * number, 0.3, 0.4), "both_sides": False, **both}
        # Axle boxes pitch with the body at the other end.
        for angle in ("roll", "yaw") if number else ("roll", "pitch", "yaw"):
            twist = {"angle": angle, "stiffness": 1e6, "damping": 1e4}
            connections.append(Torsion(f"{angle}_{number}", **at, **twist))
        sizes = {"stiffness": 1e6, "damping": 1e4}
        rubbing = {"capacity": 500.0, "slider_mass": 5.0}
        connections += [
            BumpStop(f"stop_{number}", **at, direction="lateral", travel=(0.01, 0.02, 0.2), force=(0.0, 2e4, 4e5)),
            TableDamper(f"saturating_{number}", **at, direction="lateral", rate=(0.0, 0.1, 0.2), force=(0.0, 1e3, 1e3)),
            SeriesDamper(f"damper_{number}", **at, direction="longitudinal", **sizes),
            FrictionSlider(f"slider_{number}", **at, direction="vertical", **sizes, **rubbing),
            FrictionSlider(f"wedge_{number}", **at, direction="lateral", **sizes, **rubbing, capacity_slope=1e3),
            ForceLaw(f"law_{number}", **at, direction="longitudinal", force=own_force, sizes=(2e5,)),
        ]
    load = RigidBody("load", "load", 20e3, inertia, 0.0, 1.6)
    return replace(bogie, name="Everything", bodies=(*bogie.bodies, load), connections=tuple(connections))


@cache
def machine(on_line: bool) -> Machine:
    return Machine(everything(), on_line)


class Flying:
    """The vehicle off its rails in a random state, with its modes settled there."""

    def __init__(self, on_line: bool, seed: int, folder: Path) -> None:
        self.machine, self.rng = machine(on_line), Random(f"{on_line} {seed}")
        self.course = random_course(self.rng) if on_line else STRAIGHT
        brakes = {f"brake_torque_{number}": self.rng.uniform(0.0, 2e4) for number in (1, 2)}
        self.kernel = self.machine.kernel(brakes, self.course, folder)
        self.value = {name: self.drawn(name) for name in self.machine.names}
        self.arrive(self.value)
        # Sliders move in the direction in which they are driven.
        for name, slope in self.slope.items():
            if name.endswith("_travel_rate"):
                self.value[name] = float(np.sign(slope)) * MOVING
        self.arrive(self.value)

    def drawn(self, name: str) -> float:
        first = self.machine.vehicle.bodies[0].name
        near = {f"{first}_speed": 10.0, f"{first}_distance": 1.0, "rise_1": LIFTED, "rise_2": LIFTED}
        near |= {f"angular_velocity_{number}": 24.0 for number in (1, 2)}
        if name.endswith("_travel_rate"):
            return 0.0
        moving = "rate" in name or "speed" in name or "velocity" in name
        return near.get(name, 0.0) + self.rng.uniform(-1.0, 1.0) * (MOVING if moving else AWAY)

    def arrive(self, value: dict[str, float]) -> None:
        self.kernel.arrive(0.0, [value[name] for name in self.machine.names])

    @property
    def slope(self) -> dict[str, float]:
        place = [self.value[name] for name in self.machine.names]
        return dict(zip(self.machine.names, self.kernel.slopes_at(0.0, place), strict=True))

    def energy(self, time: float) -> float:
        """Return the energy of the vehicle a moment later [J]."""
        slope = self.slope
        self.arrive({name: start + time * slope[name] for name, start in self.value.items()})
        return sum(self.kernel[name] for name in ENERGIES)


@pytest.mark.study
@pytest.mark.parametrize("on_line", TRACKS)
def test_momentum_changes_by_the_weight_alone(on_line: bool, tmp_path: Path) -> None:
    """Linear and angular momentum of the whole, with every connection deflected and every brake applied."""
    vehicle = everything()
    for seed in range(STATES):
        flying = Flying(on_line, seed, tmp_path)
        bodies = bodies_of(vehicle, flying.course, flying.value)
        rates = rates_of(vehicle, flying.course, flying.value, flying.slope)
        gravity = vehicle.number("gravity")
        every = [
            pushed(bodies[name], *part, rates[name].acceleration, gravity) for name, part in parts(vehicle).items()
        ]
        sums, sizes = np.sum(every, axis=0), np.sum(np.abs(every), axis=0)
        for three in (slice(0, 3), slice(3, 6)):
            assert np.max(np.abs(sums[three])) < MOMENTUM_BAND * np.max(sizes[three]), (seed, sums, sizes)


@pytest.mark.study
@pytest.mark.parametrize("on_line", TRACKS)
def test_energy_goes_into_heat_alone(on_line: bool, tmp_path: Path) -> None:
    for seed in range(STATES):
        flying = Flying(on_line, seed, tmp_path)
        powers = {name: flying.kernel[name] for name in POWERS}
        gained = (flying.energy(MOMENT) - flying.energy(-MOMENT)) / (2 * MOMENT)
        assert powers["damping_power"] > 0.0
        assert powers["brake_power"] > 0.0
        lost = sum(powers.values())
        assert abs(gained + lost) < ENERGY_BAND * sum(map(abs, powers.values())), (seed, gained, powers)


@pytest.mark.study
@pytest.mark.parametrize("on_line", TRACKS)
def test_every_connection_pushes_each_body_as_its_potential_and_its_dampers_say(on_line: bool, tmp_path: Path) -> None:
    """Momentum does not depend on the body that carries a connection's directions; compare with maximal coordinates."""
    vehicle = everything()
    for seed in range(STATES):
        flying = Flying(on_line, seed, tmp_path)
        oracle = flying.machine.oracle(flying.course, 0.0)
        bodies = bodies_of(vehicle, flying.course, flying.value)
        brakes = [flying.kernel[f"brake_torque_{number}"] for number in (1, 2)]
        scene = Scene([0.0, 0.0], brakes, [0.0, 0.0])
        asked = oracle.answer(bodies, scene, flying.value)[0]
        rates = rates_of(vehicle, flying.course, flying.value, flying.slope)
        largest = max(np.max(np.abs(one)) for one in asked.values())
        for name, acceleration in asked.items():
            away = np.max(np.abs(rates[name].acceleration - acceleration))
            assert away < ORACLE_BAND * largest, (seed, name, away / largest)

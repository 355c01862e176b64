"""The traction rods of the coach: how its body swings along the track as the brakes bite, and how that dies out."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest
from scipy.linalg import eigvals, expm

from fmu_src.kernel import Kernel
from fmu_src.system import model_of
from rbd_model.levels.planar import planar_vehicle
from rbd_model.vehicle.parameters import VehicleParameters, coach_with_traction_rods, manchester_vehicle_1
from rbd_model.vehicle.ready import passenger_coach
from scenarios.bench.drive import prepare, system_of
from tests.quick_library import quick_library

PLANAR, SPATIAL = 2, 3
NUMBERS = (1, 2, 3, 4)
TORQUE, SPEED, DURATION, INTERVAL = 8e3, 50.0, 10.0, 0.01
WITHOUT_RODS = {"traction_rod_stiffness": 0.0, "traction_rod_damping": 0.0}
#: From then on the body must be calm [s]: six times what the slower motion, its pitch, takes to fall to 1/e.
CALM = 4.5
#: Of the load that moves between the bogies: rigid statics, which do not know the weights that stand ahead of their
#: springs (0.6 %), and what may still swing when all is calm, three times exp(-6).
STATICS_BAND, CALM_BAND = 0.01, 0.0075
#: Of the swing at this speed [m/s]: its frequency and its decay, in which creep has a part that grows with speed (6e-4,
#: 1.6 % at 25 m/s). Of the largest load: the same creep lets the brakes bite a hundredth of a second later at 50 m/s.
SLOW, FREQUENCY_BAND, DECAY_BAND, LOAD_BAND = 1.0, 5e-5, 1e-3, 0.015
#: What is lost beside the work of dampers, creep and brakes.
ENERGY_BAND = 1e-8


@cache
def front_less_rear(level: int, rods: bool) -> tuple[np.ndarray, np.ndarray, float]:
    """Time [s], load of the front wheels less that of the rear ones [N], deceleration at the end [m/s2]."""
    brakes = {f"brake_torque_{number}": TORQUE for number in NUMBERS}
    kernel = prepare("vehicle", level=level, initial_speed=SPEED, **brakes, **({} if rods else WITHOUT_RODS))
    kernel.initialise()
    names = [f"axle_load_{number}" for number in NUMBERS]
    table = kernel.record(DURATION, INTERVAL, names)
    return np.array(table["time"]), np.array([1, 1, -1, -1]) @ [table[name] for name in names], -kernel["acceleration"]


@dataclass(frozen=True)
class Swing:
    """Linear motion in the vehicle's plane that mirrors from front to rear: mass, damping, stiffness, pull of brakes.

    Coordinates: body along the track and in pitch, frames along it at the height of the axles and in pitch, front frame
    up as the rear one goes down, wheelsets along the track, which roll. vertical: row of the load that moves.
    """

    mass: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray
    brakes: np.ndarray
    vertical: np.ndarray

    @classmethod
    def of(cls, p: VehicleParameters) -> Swing:
        below, arm, half_base = p.body_height - p.secondary_height, p.pivot_distance / 2, p.wheel_base / 2
        rolling = 4 * (p.wheelset_mass + p.wheelset_pitch_inertia / p.wheel_radius**2)
        inertia = 2 * p.frame_pitch_inertia
        mass = np.diag([p.body_mass, p.body_pitch_inertia, 0.0, inertia, 2 * p.frame_mass, rolling])
        centre = np.array([0.0, 0.0, 1.0, p.frame_height, 0.0, 0.0])
        mass += 2 * p.frame_mass * np.outer(centre, centre)
        along = 2 * p.secondary_longitudinal_stiffness + p.traction_rod_stiffness
        lost_along = 2 * p.secondary_longitudinal_damping + p.traction_rod_damping
        # Each kind of spring: its stretch by the coordinates, stiffness and damping of all that are in the vehicle.
        rows = np.array(
            [
                [1, -below, -1, -p.secondary_height, 0, 0, 2 * along, 2 * lost_along],
                [0, arm, 0, 0, 1, 0, 4 * p.secondary_vertical_stiffness, 4 * p.secondary_vertical_damping],
                [0, 0, 1, 0, 0, -1, 8 * p.longitudinal_stiffness, 8 * p.longitudinal_damping],
                [0, 0, 0, half_base, 0, 0, 8 * p.vertical_stiffness, 8 * p.vertical_damping],
                [0, 0, 0, 0, 1, 0, 8 * p.vertical_stiffness, 8 * p.vertical_damping],
                [0, 1, 0, -1, 0, 0, 4 * p.secondary_bending_stiffness, 0],
            ]
        )
        stretch = rows[:, :6]
        damping, stiffness = (stretch.T @ (rows[:, column, None] * stretch) for column in (7, 6))
        stiffness += leaning(p, below)
        brakes = 4 * TORQUE * np.array([0, 0, 0, 1, 0, -1 / p.wheel_radius])
        vertical = -np.concatenate([rows[4, 6] * stretch[4], rows[4, 7] * stretch[4]])
        return cls(mass, damping, stiffness, brakes, vertical)

    @property
    def matrix(self) -> np.ndarray:
        """Of the first-order equations of coordinates and their rates."""
        slopes = [-np.linalg.solve(self.mass, one) for one in (self.stiffness, self.damping)]
        return np.block([[np.zeros((6, 6)), np.eye(6)], slopes])

    def load(self, times: np.ndarray) -> np.ndarray:
        """Front less rear [N] at equidistant times from rest under brakes that bite at once."""
        pushed = np.zeros((13, 13))
        pushed[:12, :12] = self.matrix
        pushed[6:12, 12] = np.linalg.solve(self.mass, self.brakes)
        step, state, found = expm(pushed * (times[1] - times[0])), np.eye(13)[12], []
        for _ in times:
            found.append(self.vertical @ state[:12])
            state = step @ state
        return np.array(found)

    @property
    def along(self) -> complex:
        """Eigenvalue of the swing along the track [1/s]: next to that of body and running gear alone on the rods."""
        body, gear = self.mass[0, 0], self.mass[2, 2] + self.mass[5, 5]
        alone = np.sqrt(self.stiffness[0, 0] * (1 / body + 1 / gear))
        return complex(min(np.linalg.eigvals(self.matrix), key=lambda one: abs(one - 1j * alone)))


def leaning(p: VehicleParameters, below: float) -> np.ndarray:
    """Stiffness of weights on springs that pitch with the frames under them, to the second order of their potential."""
    body = p.body_mass * p.gravity
    frames = body + 2 * p.frame_mass * p.gravity
    pitch = 2 * body * p.frame_height + body * (p.secondary_height - p.frame_height) - frames * p.frame_height
    found = np.zeros((6, 6))
    found[3] = [-body, body * below, body - frames, pitch / 2, 0.0, frames]
    found += found.T
    found[1, 1] = -body * below
    return found


COACH = coach_with_traction_rods()


@pytest.mark.parametrize("level", [PLANAR, SPATIAL])
def test_a_braked_coach_carries_what_statics_say_once_its_body_is_calm(level: int) -> None:
    """What slows the body pulls below its centre. As published it swings on and on, by more than what moves."""
    times, load, deceleration = front_less_rear(level, rods=True)
    statics = 2 * COACH.body_mass * deceleration * (COACH.body_height - COACH.secondary_height) / COACH.pivot_distance
    calm = load[times > CALM]
    assert np.max(load) > 1.5 * statics
    assert np.mean(calm) == pytest.approx(statics, rel=STATICS_BAND)
    assert np.ptp(calm) < CALM_BAND * statics
    assert np.ptp(front_less_rear(level, rods=False)[1][times > CALM]) > 2 * statics


@pytest.mark.parametrize("level", [PLANAR, SPATIAL])
def test_load_moves_between_the_bogies_as_masses_on_springs_swing(level: int) -> None:
    times, load, _ = front_less_rear(level, rods=True)
    expected, softer = (
        Swing.of(replace(COACH, traction_rod_stiffness=share * COACH.traction_rod_stiffness)).load(times)
        for share in (1.0, 0.9)
    )
    assert np.max(np.abs(load - expected)) < LOAD_BAND * np.max(expected)
    assert np.max(np.abs(load - softer)) > LOAD_BAND * np.max(expected)


@pytest.mark.parametrize("level", [PLANAR, SPATIAL])
def test_the_swing_along_the_track_has_the_frequency_and_decay_of_masses_on_rods(level: int) -> None:
    values = {"level": level, "contact_model": 1, "initial_speed": SLOW}
    kernel = prepare("vehicle", **values)
    kernel.initialise()
    moving = np.diag([0.0 if state.algebraic else 1.0 for state in system_of("vehicle", **values).states.values()])
    found = eigvals(np.array(kernel.linearise().jacobian), moving)
    expected = Swing.of(COACH).along
    swing = min(found[np.isfinite(found)], key=lambda one: abs(one - expected))
    assert swing.imag == pytest.approx(expected.imag, rel=FREQUENCY_BAND)
    assert swing.real == pytest.approx(expected.real, rel=DECAY_BAND)
    assert Swing.of(manchester_vehicle_1()).along.real > 0.5 * expected.real


def test_what_rods_turn_to_heat_is_lost() -> None:
    """At level 2, until the coach stands; at level 3 `test_four_axles.py` has the same. Dampers lose 1e-3 of it."""
    energies, powers = ["kinetic_energy", "potential_energy"], ["brake_power", "creep_power", "damping_power"]
    model = model_of(planar_vehicle(passenger_coach()).with_integrals(powers).with_outputs(energies), 1e-9)
    brakes = {f"brake_torque_{number}": TORQUE for number in NUMBERS}
    kernel = Kernel(quick_library(model), initial_speed=15.0, tolerance=1e-9, **brakes)
    kernel.initialise()
    begin = sum(kernel[name] for name in energies)
    kernel.advance(15.0)
    lost = begin - sum(kernel[name] for name in energies)
    work = [kernel[f"integral_{name}"] for name in powers]
    assert kernel["speed"] == pytest.approx(0.0, abs=1e-6)
    assert sum(work) == pytest.approx(lost, rel=ENERGY_BAND)
    assert work[2] > 1e3 * ENERGY_BAND * lost

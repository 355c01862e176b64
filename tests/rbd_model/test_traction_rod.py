"""Test the traction rods of the coach: the body's motion along the track when the brakes apply, and its decay."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest
from scipy.linalg import eigvals, expm

from fmu_src.kernel import Kernel
from fmu_src.system import model_of
from products.kernel_runs import prepare, system_of
from rbd_model.levels.planar import planar_vehicle
from rbd_model.vehicle.parameters import VehicleParameters, coach_with_traction_rods, manchester_vehicle_1
from rbd_model.vehicle.ready import passenger_coach
from tests.fmu_src.quick_library import quick_library

PLANAR, SPATIAL = 2, 3
NUMBERS = (1, 2, 3, 4)
TORQUE, SPEED, DURATION, INTERVAL = 8e3, 50.0, 10.0, 0.01
WITHOUT_RODS = {"traction_rod_stiffness": 0.0, "traction_rod_damping": 0.0}
#: Time after which the body must be at rest [s]: six time constants (1/e) of the slower motion, its pitch.
CALM = 4.5
#: Tolerances of the load transfer between the bogies. Rigid statics neglect that weights move ahead of their springs
#: (0.6 %). The remaining oscillation at rest is three times exp(-6).
STATICS_BAND, CALM_BAND = 0.01, 0.0075
#: Speed of the oscillation test [m/s], and its tolerances of frequency and decay. Creep contributes to them with a part
#: that grows with speed (6e-4, 1.6 % at 25 m/s). LOAD_BAND: of the largest load; the same creep delays the brake force
#: at 50 m/s by a hundredth of a second.
SLOW, FREQUENCY_BAND, DECAY_BAND, LOAD_BAND = 1.0, 5e-5, 1e-3, 0.015
#: Energy lost in addition to the work of dampers, creep and brakes.
ENERGY_BAND = 1e-8


@cache
def front_less_rear(level: int, rods: bool) -> tuple[np.ndarray, np.ndarray, float]:
    """Return time [s], load of the front wheels less that of the rear ones [N], deceleration at the end [m/s2]."""
    brakes = {f"brake_torque_{number}": TORQUE for number in NUMBERS}
    kernel = prepare("vehicle", level=level, initial_speed=SPEED, **brakes, **({} if rods else WITHOUT_RODS))
    kernel.initialise()
    names = [f"axle_load_{number}" for number in NUMBERS]
    table = kernel.record(DURATION, INTERVAL, names)
    return np.array(table["time"]), np.array([1, 1, -1, -1]) @ [table[name] for name in names], -kernel["acceleration"]


@dataclass(frozen=True)
class Swing:
    """Linear motion in the vehicle's plane, antisymmetric from front to rear: mass, damping, stiffness, brake forces.

    Coordinates: body along the track and in pitch; frames along it at axle height and in pitch; front frame up and rear
    one down; rolling wheelsets along the track. `vertical`: row of the load transfer.
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
        # For each kind of spring: its elongation by the coordinates, stiffness and damping of all of them in the
        # vehicle.
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
        """Return the matrix of the first-order equations of coordinates and their rates."""
        slopes = [-np.linalg.solve(self.mass, one) for one in (self.stiffness, self.damping)]
        return np.block([[np.zeros((6, 6)), np.eye(6)], slopes])

    def load(self, times: np.ndarray) -> np.ndarray:
        """Return the load front less rear [N] at equidistant times from rest, with brake forces that act at once."""
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
        """Return the eigenvalue of the longitudinal oscillation [1/s]: the closest to that of body and running gear on
        the rods.
        """
        body, gear = self.mass[0, 0], self.mass[2, 2] + self.mass[5, 5]
        alone = np.sqrt(self.stiffness[0, 0] * (1 / body + 1 / gear))
        return complex(min(np.linalg.eigvals(self.matrix), key=lambda one: abs(one - 1j * alone)))


def leaning(p: VehicleParameters, below: float) -> np.ndarray:
    """Return the stiffness due to weights on springs that pitch with the frames: second order of the potential."""
    body = p.body_mass * p.gravity
    frames = body + 2 * p.frame_mass * p.gravity
    pitch = 2 * body * p.frame_height + body * (p.secondary_height - p.frame_height) - frames * p.frame_height
    found = np.zeros((6, 6))
    found[3] = [-body, body * below, body - frames, pitch / 2, 0.0, frames]
    found += found.T
    found[1, 1] = -body * below
    return found


COACH = coach_with_traction_rods()


@pytest.mark.study
@pytest.mark.parametrize("level", [PLANAR, SPATIAL])
def test_a_braked_coach_carries_what_statics_say_once_its_body_is_calm(level: int) -> None:
    """The longitudinal force acts below the body's centre. Without rods the load oscillates by more than that."""
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


@pytest.mark.study
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


@pytest.mark.study
def test_what_rods_turn_to_heat_is_lost() -> None:
    """Level 2, until the coach stands; for level 3 see `test_four_axles.py`. Dampers dissipate 1e-3 of the energy."""
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

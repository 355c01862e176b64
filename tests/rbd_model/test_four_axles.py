"""Test the complete vehicle: modes and loads against closed forms, mirror images, energy, and the bogie in it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fmu_src.kernel import Kernel, Library
from fmu_src.system import System, model_of
from products.building import kernel_of
from rbd_model.levels.models import levels
from rbd_model.levels.spatial import spatial_vehicle
from rbd_model.linear import oscillations
from rbd_model.track.irregularity import irregular_track, section_5_3
from rbd_model.vehicle.parameters import VehicleParameters, coach_with_traction_rods, coal_wagon, manchester_vehicle_1
from rbd_model.vehicle.ready import passenger_coach
from scenarios.bench.four_axles import rigid_axle_loads
from tests.fmu_src.quick_library import quick_library

PLANAR, SPATIAL = 2, 3
NUMBERS = (1, 2, 3, 4)
#: Tolerances of frequencies and loads against closed forms, and of the lost energy against the work of dampers and
#: brakes.
CLOSED_FORM, ENERGY_BAND, MIRROR_BAND = 1e-3, 1e-8, 1e-9
#: Tolerance of axle loads against statics of first order in the pitch of the frames, 5 mrad; measured 1.4e-4.
STATICS_BAND = 2e-4


@pytest.fixture(scope="module")
def vehicle() -> Library:
    return Library(kernel_of("vehicle"))


@pytest.fixture(scope="module")
def systems() -> tuple[System, ...]:
    return levels(passenger_coach())


def frequencies(vehicle: Library, systems: tuple[System, ...], level: int, **values: float) -> np.ndarray:
    kernel = Kernel(vehicle, level=level, contact_model=1, initial_speed=0.0, tolerance=1e-10, **values)
    kernel.initialise()
    modes = oscillations(systems[level - 1], np.array(kernel.linearise().jacobian))
    return np.array([mode.frequency for mode in modes])


#: Only vertical springs, no damping, all centres and springs at one height, so that weight causes no moments.
VERTICAL_ALONE = {
    **{f"{direction}_stiffness": 1.0 for direction in ("longitudinal", "lateral")},
    **{f"secondary_{direction}_stiffness": 1.0 for direction in ("longitudinal", "lateral")},
    **{f"{direction}_damping": 0.0 for direction in ("longitudinal", "lateral", "vertical")},
    **{f"secondary_{direction}_damping": 0.0 for direction in ("longitudinal", "lateral", "vertical")},
    **{f"{name}_height": 0.0 for name in ("frame", "body", "secondary")},
    "secondary_bending_stiffness": 0.0,
    "anti_roll_stiffness": 0.0,
    "traction_rod_stiffness": 0.0,
    "traction_rod_damping": 0.0,
}


def two_masses(upper: float, lower: float, secondary: float, primary: float) -> list[float]:
    """Return the frequencies of a mass on a mass on the ground [Hz]."""
    stiffness = np.array([[secondary, -secondary], [-secondary, secondary + primary]])
    values = np.linalg.eigvals(np.diag([1 / upper, 1 / lower]) @ stiffness)
    return sorted(np.sqrt(values.real) / (2 * math.pi))


def closed_forms(p: VehicleParameters) -> dict[str, float]:
    """Return bounce, pitch and frame pitch of the Manchester vehicle 1 on its vertical springs [Hz]."""
    arm = p.pivot_distance / 2
    secondary, primary = 4 * p.secondary_vertical_stiffness, 8 * p.vertical_stiffness
    bounce = two_masses(p.body_mass, 2 * p.frame_mass, secondary, primary)
    pitch = two_masses(p.body_pitch_inertia, 2 * p.frame_mass * arm**2, secondary * arm**2, primary * arm**2)
    frame = math.sqrt(4 * p.vertical_stiffness * (p.wheel_base / 2) ** 2 / p.frame_pitch_inertia) / (2 * math.pi)
    return dict(zip(("bounce", "frames bounce", "pitch", "frames pitch"), (*bounce, *pitch), strict=True)) | {
        "frame pitch": frame
    }


def test_closed_forms_are_the_published_frequencies() -> None:
    """Manchester vehicle 1: 1.0739 and 7.4705, 1.2991 and 7.4772, 11.714 Hz."""
    expected = (1.0739, 7.4705, 1.2991, 7.4772, 11.714)
    assert list(closed_forms(manchester_vehicle_1()).values()) == pytest.approx(list(expected), rel=1e-4)


@pytest.mark.study
@pytest.mark.parametrize("level", [PLANAR, SPATIAL])
def test_frequencies_on_vertical_springs_are_the_closed_forms(
    vehicle: Library, systems: tuple[System, ...], level: int
) -> None:
    found = frequencies(vehicle, systems, level, **VERTICAL_ALONE)
    for expected in closed_forms(manchester_vehicle_1()).values():
        assert np.min(np.abs(found - expected)) < CLOSED_FORM * expected


@pytest.mark.study
def test_bending_of_the_air_springs_stiffens_the_frames_pitch(vehicle: Library, systems: tuple[System, ...]) -> None:
    """11.729 Hz: both secondary springs of a bogie add to the primary ones; body and frames move in opposition."""
    p = manchester_vehicle_1()
    bent = VERTICAL_ALONE | {"secondary_bending_stiffness": p.secondary_bending_stiffness}
    stiffness = 4 * p.vertical_stiffness * (p.wheel_base / 2) ** 2 + 2 * p.secondary_bending_stiffness
    expected = math.sqrt(stiffness / p.frame_pitch_inertia) / (2 * math.pi)
    assert expected == pytest.approx(11.729, rel=1e-4)
    found = frequencies(vehicle, systems, PLANAR, **bent)
    assert np.min(np.abs(found - expected)) < 1e-4 * expected
    assert np.min(np.abs(frequencies(vehicle, systems, PLANAR, **VERTICAL_ALONE) - expected)) > 1e-3 * expected


@pytest.mark.study
def test_static_axle_load_is_a_quarter_of_the_weight(vehicle: Library) -> None:
    """109.1 kN at every level."""
    for level in (1, PLANAR, SPATIAL):
        kernel = Kernel(vehicle, level=level, contact_model=1)
        kernel.initialise()
        for number in NUMBERS:
            assert kernel[f"axle_load_{number}"] == pytest.approx(109.1e3, rel=5e-4)
            weight = 32000.0 / 4 + 2615.0 / 2 + 1813.0
            assert kernel[f"axle_load_{number}"] == pytest.approx(weight * 9.81, rel=1e-9)


@pytest.mark.parametrize("level", [PLANAR, SPATIAL])
@pytest.mark.parametrize("reaction", [1.0, 0.0])
def test_braking_moves_load_as_rigid_statics_say(vehicle: Library, level: int, reaction: float) -> None:
    """Between the axles of each bogie and between the bogies; brake with and without reaction on the frame."""
    torque, p = 5e3, coach_with_traction_rods()
    brakes = {f"brake_torque_{number}": torque for number in NUMBERS}
    kernel = Kernel(
        vehicle,
        level=level,
        initial_speed=50.0,
        torque_reaction=reaction,
        secondary_bending_stiffness=0.0,
        secondary_vertical_damping=60e3,
        **brakes,
    )
    kernel.advance(12.0)
    expected = rigid_axle_loads(p, -kernel["acceleration"], torque, reaction)
    for number, load in zip(NUMBERS, expected, strict=True):
        assert kernel[f"axle_load_{number}"] == pytest.approx(load, rel=STATICS_BAND)
    assert expected[0] > 1.01 * expected[2] or reaction == 0.0


# -- mirrors and energy -------------------------------------------------------------------------------------------

ENERGIES = ["kinetic_energy", "potential_energy"]
POWERS = ["brake_power", "creep_power", "damping_power"]


@pytest.fixture(scope="module")
def observed() -> Library:
    system = spatial_vehicle(passenger_coach(), irregular_track(section_5_3()))
    return quick_library(model_of(system.with_integrals(POWERS).with_outputs(ENERGIES), 1e-9))


LEFT_RIGHT = (*(f"lateral_{n}" for n in NUMBERS), *(f"yaw_{n}" for n in NUMBERS), "body_roll", "front_frame_yaw")


@pytest.mark.study
def test_a_vehicle_mirrored_left_to_right_gives_the_mirrored_answer(observed: Library) -> None:
    braked = {"brake_torque_1": 8e3, "brake_torque_4": 4e3, "initial_speed": 20.0, "tolerance": 1e-10}
    sides = []
    for sign in (1, -1):
        kernel = Kernel(observed, initial_lateral=sign * 4e-3, yaw_torque_2=sign * 500.0, **braked)
        kernel.advance(2.0)
        sides.append(kernel)
    left, right = sides
    for name in LEFT_RIGHT:
        assert abs(left[name]) > 1e-7
        assert left[name] == pytest.approx(-right[name], rel=1e-6, abs=MIRROR_BAND)
    for number in NUMBERS:
        loads = left[f"wheel_load_{number}_left"], right[f"wheel_load_{number}_right"]
        assert loads[0] == pytest.approx(loads[1], rel=MIRROR_BAND)


@pytest.mark.study
def test_a_vehicle_mirrored_front_to_back_gives_the_mirrored_answer(observed: Library) -> None:
    ways = []
    for sign in (1, -1):
        brakes = {f"brake_torque_{n}": 2e3 * (n if sign > 0 else 5 - n) for n in NUMBERS}
        kernel = Kernel(observed, initial_speed=sign * 20.0, tolerance=1e-10, **brakes)
        kernel.advance(2.0)
        ways.append(kernel)
    ahead, back = ways
    assert ahead["distance"] == pytest.approx(-back["distance"], rel=MIRROR_BAND)
    assert ahead["body_pitch"] == pytest.approx(-back["body_pitch"], rel=1e-6)
    for number in NUMBERS:
        loads = ahead[f"axle_load_{number}"], back[f"axle_load_{5 - number}"]
        assert loads[0] == pytest.approx(loads[1], rel=MIRROR_BAND)
        assert ahead[f"angular_velocity_{number}"] == pytest.approx(
            -back[f"angular_velocity_{5 - number}"], rel=MIRROR_BAND
        )


@pytest.mark.study
def test_lost_energy_is_the_work_of_brakes_creep_and_dampers(observed: Library) -> None:
    """Two wheelsets lock, the body rocks and rolls; an error of 1e-6 in the creep work would be detected."""
    brakes = {"brake_torque_1": 9e3, "brake_torque_2": 20e3, "brake_torque_3": 9e3, "brake_torque_4": 20e3}
    kernel = Kernel(observed, initial_lateral=3e-3, initial_speed=25.0, tolerance=1e-9, **brakes)
    kernel.initialise()
    begin = sum(kernel[name] for name in ENERGIES)
    kernel.advance(6.0)
    lost = begin - sum(kernel[name] for name in ENERGIES)
    work = {name: kernel[f"integral_{name}"] for name in POWERS}
    assert kernel["locked_4"] == 1.0
    assert lost > 1e6
    assert abs(lost - sum(work.values())) < ENERGY_BAND * lost
    wrong = work | {"creep_power": (1 + 1e-6) * work["creep_power"]}
    assert abs(lost - sum(wrong.values())) > ENERGY_BAND * lost


# -- the bogie in it ----------------------------------------------------------------------------------------------


def test_a_wagon_on_rigid_secondary_springs_moves_as_its_bogies(vehicle: Library, bogie: Library) -> None:
    """Secondary springs 1e4 times stiffer than a bogie's: motion and weight of two bogies of chapter 5.

    The long body moves load between the bogies. Loads and slip differ due to it, by 3e-5 of the distance.
    """
    wagon = coal_wagon().values()
    stiff = {
        f"secondary_{d}_stiffness": 1e4 * wagon["vertical_stiffness"] for d in ("longitudinal", "lateral", "vertical")
    }
    of_fmu = {name: value for name, value in (wagon | stiff).items() if name in vehicle.index}
    torques = {f"brake_torque_{n}": 15e3 for n in NUMBERS}
    whole = Kernel(vehicle, level=PLANAR, initial_speed=25.0, **of_fmu, **torques)
    half = Kernel(bogie, level=PLANAR, initial_speed=25.0, brake_torque_1=15e3, brake_torque_2=15e3)
    for kernel in (whole, half):
        kernel.advance(10.0)
    assert whole["speed"] == pytest.approx(half["speed"], rel=1e-4)
    assert whole["distance"] == pytest.approx(half["distance"], rel=1e-4)
    loads = sum(whole[f"axle_load_{n}"] for n in NUMBERS)
    assert loads == pytest.approx(2 * (half["axle_load_1"] + half["axle_load_2"]), rel=1e-4)

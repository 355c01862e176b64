"""Test the 3D level: energy, constraints, symmetry, limits, and the results of chapters 4, 5 and 9."""

from __future__ import annotations

import itertools
import re
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fmu_src.compile import build_library
from fmu_src.kernel import DISCARD, Kernel, Library, SimulationError
from fmu_src.system import model_of
from rbd_model.contact.geometry import contact_at, equivalent_conicity, flange_of, thesis_pair
from rbd_model.contact.hertz import ellipse_fit, ellipse_shape, moving_ellipse
from rbd_model.levels.models import DEPTH_ON_LINE, levels, recommend_level, wheelset_in_frame
from rbd_model.levels.spatial import spatial_vehicle
from rbd_model.linear import critical_speed, oscillations
from rbd_model.track.irregularity import (
    Track,
    derivatives_along,
    irregular_track,
    section_5_3,
    track_from_file,
    track_from_points,
)
from rbd_model.vehicle.parameters import AS_PRINTED, tables_5_1_and_5_2
from rbd_model.vehicle.ready import two_axle_bogie, wheelset_under_frame
from rbd_model.vehicle.variables import LARGEST_LATERAL, LARGEST_YAW
from rbd_model.wheelset.in_space import END_MARGIN
from rbd_model.wheelset.rigid_part import nadal_limit
from rbd_model.wheelset.touch import SIDES
from tests.fmu_src.quick_library import quick_library

ENERGIES = ("kinetic_energy", "potential_energy")
POWERS = ("brake_power", "creep_power", "damping_power")
#: Tolerances of docs/checking.md: energy relative to the loss, gap of the constraints, mirrored answer.
ENERGY_BAND, GAP_BAND, MIRROR_BAND = 1e-8, 1e-9, 1e-9
#: Tolerance of the wavelength of the kinematic wave. The profiles' splines give its conicity to 1e-3; creep at 1 m/s
#: has a smaller effect.
KLINGEL_BAND = 1e-3


@pytest.fixture(scope="module")
def observed() -> Library:
    """The bogie of chapter 5 with its energies, powers and gap as outputs."""
    system = spatial_vehicle(two_axle_bogie(), irregular_track(section_5_3()))
    return quick_library(model_of(system.with_integrals(POWERS).with_outputs((*ENERGIES, "largest_gap")), 1e-7))


@pytest.fixture(scope="module")
def wheelset() -> Library:
    return Library(build_library(model_of(wheelset_in_frame(), 1e-7)))


def spatial(library: Library, **values: float) -> Kernel:
    return Kernel(library, **{"level": 3, "contact_model": 1} | values)


@pytest.mark.study
def test_lost_energy_equals_brake_creep_and_damper_work(observed: Library) -> None:
    """A lateral wave without flange contact, then braking to a stop."""
    kernel = Kernel(observed, tolerance=1e-10, lateral_irregularity=0.01)
    kernel.advance(2.5)
    kernel.set(brake_torque_1=20e3, brake_torque_2=20e3, yaw_torque_1=5e3)
    table = kernel.record(14.0, 0.1, [*ENERGIES, *(f"integral_{name}" for name in POWERS), "speed", "lateral_1"])
    assert 1e-3 < np.abs(table["lateral_1"]).max() < 9e-3
    energy = np.sum([table[name] for name in table if name.endswith(("energy", "power"))], axis=0)
    lost = table["kinetic_energy"][0] - table["kinetic_energy"][-1]
    assert lost > 1e7
    assert np.ptp(energy) < ENERGY_BAND * lost


@pytest.mark.study
@pytest.mark.parametrize("at_rail", [0.0, 1.0])
@pytest.mark.parametrize("reaction", [0.0, 1.0])
def test_energy_is_kept_wherever_brake_and_flange_react(observed: Library, reaction: float, at_rail: float) -> None:
    """Uneven brake shoes and loaded flanges; the energy balance includes the energy of their springs."""
    kernel = Kernel(observed, tolerance=1e-10, torque_reaction=reaction, flange_at_rail=at_rail)
    kernel.set(brake_torque_1=20e3, brake_torque_2=20e3, yaw_torque_1=6e4)
    names = [*ENERGIES, *(f"integral_{name}" for name in POWERS)]
    table = {name: np.array(column) for name, column in kernel.record(6.0, 0.02, [*names, "flange_force_1"]).items()}
    energy, lost = sum(table[name] for name in names), -np.ptp(table["kinetic_energy"])
    assert lost < -1e7
    assert np.ptp(energy) < -ENERGY_BAND * lost
    in_spring = table["flange_force_1"] ** 2 / (2 * tables_5_1_and_5_2().flange_stiffness)
    assert np.ptp(energy - in_spring) > -1e2 * ENERGY_BAND * lost


#: Tolerance of the height of the flange force from moments [m]: contact positions have an error of 1 mm of 500, loads
#: are exact.
HEIGHT_BAND = 4e-3


@pytest.mark.study
@pytest.mark.parametrize("at_rail", [0.0, 1.0])
def test_flange_is_pushed_at_the_rail_or_at_the_axle(bogie: Library, at_rail: float) -> None:
    """Eq. (3.106). The height of the force follows from the moments of all loads about the forward axis."""
    p, pair = tables_5_1_and_5_2(), thesis_pair()
    values = {"initial_speed": 15.0, "constant_speed": 1, "yaw_torque_1": 9e4, "flange_at_rail": at_rail}
    kernel = spatial(bogie, **values)
    kernel.advance(20.0)
    state = dict(zip(levels(two_axle_bogie(p))[2].states, kernel.linearise().state, strict=True))
    moment = -p.frame_mass * p.gravity * kernel["frame_lateral"]
    for number, (side, word) in itertools.product((1, 2), SIDES.items()):
        position, lateral, roll = state[f"contact_{number}_{word}"], state[f"lateral_{number}"], state[f"roll_{number}"]
        radius = p.wheel_radius - float(pair.wheel.height(np.array(position)))
        place = lateral + side * (pair.wheel_half_distance + position) * np.cos(roll) + radius * np.sin(roll)
        moment += place * kernel[f"wheel_load_{number}_{word}"] - p.wheelset_mass * p.gravity * lateral / 2
    force = kernel["flange_force_1"] + kernel["flange_force_2"]
    assert force < -1e5  # the rail is on the left
    expected = -flange_of(pair).depth if at_rail else p.wheel_radius
    assert moment / force == pytest.approx(expected, abs=HEIGHT_BAND)
    loads = kernel["wheel_load_1_left"], kernel["wheel_load_1_right"]
    assert (loads[0] > loads[1]) == bool(at_rail)


def test_derailment_quotient_of_a_wheel_is_that_of_all_forces_of_its_rail(bogie: Library) -> None:
    """In steady flange contact the Y of the four wheels add up to zero; without friction Y/Q is that of the cone."""
    kernel = spatial(bogie, initial_speed=15.0, constant_speed=1, yaw_torque_1=9e4)
    kernel.advance(20.0)
    pushes = {}
    for number, (side, word) in itertools.product((1, 2), SIDES.items()):
        name = f"{number}_{word}"
        pushes[name] = side * kernel[f"derailment_quotient_{name}"] * kernel[f"wheel_load_{name}"]
    assert pushes["1_left"] > 5e4
    assert abs(sum(pushes.values())) < 1e-2 * pushes["1_left"]
    still = spatial(bogie, initial_speed=15.0, friction_1=0.0, friction_2=0.0)
    still.initialise()
    assert still["derailment_quotient_2_right"] == pytest.approx(1 / 20, abs=1e-3)


@pytest.mark.parametrize("friction", [0.0, 0.3, 0.6])
def test_nadal_limit_is_that_of_a_flange_that_slides_down(friction: float) -> None:
    """The normal force N of the flange and friction mu N up the rail, resolved into Y and Q."""
    angle = flange_of(thesis_pair()).angle
    sideways = np.sin(angle) - friction * np.cos(angle)
    down = np.cos(angle) + friction * np.sin(angle)
    assert float(nadal_limit(angle, ca.SX(friction))) == pytest.approx(sideways / down, rel=1e-12)


def test_flange_above_nadal_limit_warns_once_with_wheel_and_time(bogie: Library) -> None:
    """At a yaw torque of 100 kN.m the flanging wheel of the thesis loses load and climbs at friction 0.3, not at 0.15.

    With the flange force at the rail it gains load and stays below the limit. It also stays below it with a lubricated
    gauge face.
    """
    found = {}
    for friction, at_rail, gauge_face in ((0.3, 0.0, 1.0), (0.15, 0.0, 1.0), (0.3, 1.0, 1.0), (0.3, 0.0, 0.5)):
        values = {"initial_speed": 15.0, "constant_speed": 1, "yaw_torque_1": 1e5, "flange_at_rail": at_rail}
        values["gauge_face_friction"] = gauge_face
        kernel = spatial(bogie, friction_1=friction, friction_2=friction, **values)
        quotient = kernel.record(2.0, 1e-3, ["derailment_quotient_1_left"])["derailment_quotient_1_left"]
        found[friction, at_rail, gauge_face] = [line for line in kernel.messages if line.startswith("Flange climb")]
        limit = float(nadal_limit(flange_of(thesis_pair()).angle, ca.SX(gauge_face * friction)))
        assert (max(quotient) > limit) == bool(found[friction, at_rail, gauge_face])
        assert max(quotient) > 0.5
    (warning,) = found[0.3, 0.0, 1.0]
    assert not found[0.3, 0.0, 0.5]
    assert re.match(
        r"Flange climb: Y/Q of the left wheel of wheelset 1 rose above Nadal's limit .* at 0\.\d+ s;", warning
    )


def test_half_spacings_give_yaw_and_roll_each_its_stiffness(bogie: Library) -> None:
    """4 k b^2 over the sprung mass's inertia; longitudinal springs for yaw, vertical ones for roll."""
    p = tables_5_1_and_5_2()
    names = list(levels(two_axle_bogie(p))[2].states)

    def turning(name: str, **values: float) -> float:
        kernel = spatial(bogie, initial_speed=10.0, **values)
        kernel.initialise()
        return float(np.array(kernel.linearise().jacobian)[names.index(f"{name}_rate"), names.index(name)])

    for angle, spacing, direction in (("frame_yaw", "longitudinal", "yaw"), ("frame_roll", "vertical", "roll")):
        stiffness, inertia = getattr(p, f"{spacing}_stiffness"), getattr(p, f"frame_{direction}_inertia")
        added = 4 * stiffness * (0.9**2 - 0.7**2) / inertia
        other = "vertical" if spacing == "longitudinal" else "longitudinal"
        found, kept = (turning(angle, **{f"{name}_half_spacing": 0.9}) - turning(angle) for name in (spacing, other))
        assert found == pytest.approx(-added, rel=1e-6)
        assert abs(kept) < 1e-6 * added


@pytest.mark.parametrize("irregularity", ["lateral_irregularity", "vertical_irregularity", "cross_level"])
def test_wheels_stay_on_their_rails(observed: Library, irregularity: str) -> None:
    kernel = Kernel(observed, initial_speed=20.0, constant_speed=1, **{irregularity: 0.02})
    gaps, motions = [], []
    for _ in range(500):
        kernel.advance(0.01)
        gaps.append(kernel["largest_gap"])
        motions.append(max(abs(kernel[name]) for name in ("frame_roll", "lateral_1", "bounce")))
    assert max(motions) > 1e-3
    assert max(gaps) < GAP_BAND


@pytest.mark.parametrize("yaw_torque", [1e4, 6e4])
def test_mirrored_scene_gives_the_mirrored_answer(bogie: Library, yaw_torque: float) -> None:
    """Without flange contact and, with the larger torque, with it."""
    names = ["lateral_1", "lateral_2", "yaw_1", "frame_roll", "speed", "wheel_load_1_left", "wheel_load_1_right"]
    found = []
    for sign in (1.0, -1.0):
        values = {"lateral_irregularity": 0.015, "cross_level": 0.01, "yaw_torque_1": yaw_torque}
        kernel = spatial(bogie, tolerance=1e-12, **{name: sign * value for name, value in values.items()})
        found.append(kernel.record(3.0, 0.01, names))
    one, other = found
    assert max(np.abs(one["lateral_1"])) > 1e-3
    for name in ("lateral_1", "lateral_2", "yaw_1", "frame_roll"):
        assert np.array(other[name]) == pytest.approx(-np.array(one[name]), abs=MIRROR_BAND)
    assert np.array(other["wheel_load_1_right"]) == pytest.approx(np.array(one["wheel_load_1_left"]), rel=MIRROR_BAND)
    assert other["speed"] == pytest.approx(one["speed"], rel=MIRROR_BAND)


def test_straight_symmetric_stop_is_that_of_the_planar_level(bogie: Library) -> None:
    """The contact ellipse moves by micrometres only; the distances differ by 0.4 mm."""
    stops = []
    for level in (2, 3):
        kernel = Kernel(bogie, level=level, contact_model=1, brake_torque_1=20e3, brake_torque_2=20e3)
        kernel.advance(22.9)
        stops.append((kernel["distance"], kernel["lateral_1"], kernel["frame_roll"]))
    assert stops[1][0] == pytest.approx(stops[0][0], abs=1e-3)
    assert max(abs(stops[1][1]), abs(stops[1][2])) < 1e-9


#: Tolerances of docs/checking.md against a reference by another method.
STOP_TIME_BAND, STOP_DISTANCE_BAND = 1e-3, 10e-3


@pytest.mark.study
def test_stop_is_that_of_another_method(bogie: Library) -> None:
    """Brake with 20 kN.m from 25 m/s until both wheelsets stand; SciPy's Radau is 100 times tighter."""
    system = levels(two_axle_bogie())[2]
    names = [name for name, state in system.states.items() if not state.algebraic]
    peer = spatial(bogie, brake_torque_1=20e3, brake_torque_2=20e3)
    peer.initialise()
    differential = np.array([not state.algebraic for state in system.states.values()])
    start = np.array(peer.linearise().state)[differential]
    wheels = [names.index(f"angular_velocity_{number}") for number in (1, 2)]

    def turning(time: float, y: np.ndarray) -> float:
        return float(y[wheels].min())

    turning.terminal = True  # type: ignore[attr-defined]
    found = solve_ivp(
        *(peer.slopes_at, (0.0, 22.9), start, "Radau"),
        jac=lambda time, y: np.array(peer.jacobian_at(time, y)),
        events=turning,
        rtol=1e-8,
        atol=1e-10,
    )
    kernel = spatial(bogie, brake_torque_1=20e3, brake_torque_2=20e3)
    table = kernel.record(22.9, 1e-4, ["distance", "angular_velocity_1"])
    locked = int(np.argmin(table["angular_velocity_1"]))
    assert found.t[-1] > 16.0
    assert table["time"][locked] == pytest.approx(found.t[-1], abs=STOP_TIME_BAND)
    end = dict(zip(names, found.y[:, -1], strict=True))
    moved = end["frame_distance"] + (end["shift_1"] + end["shift_2"]) / 2
    assert table["distance"][locked] == pytest.approx(moved, abs=STOP_DISTANCE_BAND)
    assert kernel["distance"] == pytest.approx(moved, abs=STOP_DISTANCE_BAND)  # the vehicle stands
    assert not any("locked" in sentence for sentence in kernel.messages)
    assert kernel["locked_1"] == kernel["locked_2"] == 0.0


#: Round-off of slopes [1/s2]: slip is a difference of 25 m/s in double precision, and its coefficient is 2200 1/s.
ROUND_OFF = 1e-11


def test_equations_without_algebraic_states_have_their_exact_jacobian(bogie: Library) -> None:
    """The implicit-function theorem is compared with central differences over a wave."""
    kernel = spatial(bogie, lateral_irregularity=0.01, tolerance=1e-10)
    kernel.advance(1.0)
    states = levels(two_axle_bogie())[2].states.values()
    place = np.array(kernel.linearise().state)[[not state.algebraic for state in states]]
    exact = np.array(kernel.jacobian_at(1.0, place))
    for column in range(place.size):
        shift = np.zeros(place.size)
        shift[column] = 1e-6 * max(1e-3, abs(place[column]))
        ahead, back = (np.array(kernel.slopes_at(1.0, place + sign * shift)) for sign in (1.0, -1.0))
        difference = (ahead - back) / (2 * shift[column])
        allowed = 1e-5 * max(1.0, np.abs(exact[:, column]).max()) + ROUND_OFF / shift[column]
        assert np.abs(difference - exact[:, column]).max() < allowed


@pytest.mark.parametrize("reaction", [0.0, 1.0])
def test_pitch_of_the_frame_is_that_of_the_planar_level(bogie: Library, reaction: float) -> None:
    """Traction, then braking; with the torque on the wheelsets only, and with its reaction on the sprung mass."""
    found = []
    for level in (2, 3):
        kernel = Kernel(
            bogie, level=level, contact_model=1, initial_speed=10.0, torque_reaction=reaction, traction_torque_1=2e4
        )
        pitch = kernel.record(2.0, 0.01, ["pitch", "axle_load_1"])
        kernel.set(traction_torque_1=0.0, brake_torque_2=2e4)
        more = kernel.record(2.0, 0.01, ["pitch", "axle_load_1"])
        found.append({name: np.array([*pitch[name], *more[name]]) for name in ("pitch", "axle_load_1")})
    assert np.ptp(found[0]["pitch"]) > 2e-3
    assert np.abs(found[1]["pitch"] - found[0]["pitch"]).max() < 1e-5
    assert np.abs(found[1]["axle_load_1"] - found[0]["axle_load_1"]).max() < 1e-3 * found[0]["axle_load_1"].max()


def test_signs_follow_x_forward_y_left_z_up(bogie: Library) -> None:
    """A torque about the upward axis turns the nose to the left; a higher left rail rolls all bodies to the right."""
    turned = spatial(bogie, initial_speed=15.0, constant_speed=1, yaw_torque_1=5e3, yaw_torque_2=5e3)
    turned.advance(0.03)
    assert turned["yaw_1"] > 1e-5
    turned.advance(1.0)  # the wheelset rolls to the left until its conicity balances the torque
    assert turned["lateral_1"] > 1e-4
    raised = spatial(bogie, initial_speed=15.0, constant_speed=1, cross_level=0.02)
    roll = np.array(raised.record(8.0, 0.01, ["frame_roll"])["frame_roll"])
    assert roll[np.abs(roll).argmax()] > 0.01  # about the forward axis: the left side goes up
    shifted = spatial(bogie, initial_speed=15.0, constant_speed=1, lateral_irregularity=0.01)
    table = shifted.record(1.0, 0.01, ["distance", "lateral_1"])
    first = np.flatnonzero(np.abs(table["lateral_1"]) > 1e-4)[0]
    assert table["lateral_1"][first] < 0.0  # the track moves to the left, away from under the wheelset


@pytest.mark.parametrize(("torque", "side"), [(10e3, "right"), (-10e3, "left"), (100e3, "right")])
def test_wheelset_that_turns_ever_further_derails_where_its_wheel_falls_off_the_rail(
    wheelset: Library, torque: float, side: str
) -> None:
    """A wheelset of chapter 4 without a restoring moment. At a yaw of 0.4 rad its wheels are 2 b (1 - cos yaw) closer.

    The wheel on the far side then stands on the end of its tread, s = 55 mm from the nominal contact. The yaw follows
    from (b + s) cos(yaw) = b + lateral. This neglects the curved profiles and the offset of the contact along the
    track.
    """
    kernel = Kernel(wheelset, initial_speed=15.0, yaw_torque_1=torque)
    sentence = rf"Derailed: the {side} wheel of wheelset 1 ran off the end of its tread or of the rail's head at \d\."
    with pytest.raises(SimulationError, match=sentence) as refusal:
        kernel.advance(20.0)
    assert refusal.value.status == DISCARD
    assert kernel["derailed"] == 1.0
    half = thesis_pair().rail_half_distance
    narrowed = (half + abs(kernel["lateral_1"])) / (half + thesis_pair().wheel.limits[1] - END_MARGIN)
    assert abs(kernel["yaw_1"]) == pytest.approx(np.arccos(narrowed), rel=0.1)


@pytest.mark.parametrize("yaw", [-LARGEST_YAW, 0.0, LARGEST_YAW])
@pytest.mark.parametrize("lateral", [-LARGEST_LATERAL, 3e-3, LARGEST_LATERAL])
def test_vehicle_starts_where_it_is_put_with_both_wheels_on_the_rails(
    observed: Library, lateral: float, yaw: float
) -> None:
    kernel = Kernel(observed, initial_speed=5.0, initial_lateral=lateral, initial_yaw=yaw)
    kernel.initialise()
    assert [kernel[f"{name}_{n}"] for name in ("lateral", "yaw") for n in (1, 2)] == [lateral, lateral, yaw, yaw]
    assert kernel["frame_lateral"] == lateral
    assert kernel["largest_gap"] < GAP_BAND
    assert kernel.rates(["lateral_1", "frame_lateral"]) == [0.0, 0.0]
    kernel.advance(1e-2)


@pytest.mark.parametrize("values", [{"initial_lateral": 0.011}, {"initial_yaw": -0.06}])
def test_vehicle_that_would_start_beside_its_rails_is_refused(bogie: Library, values: dict[str, float]) -> None:
    with pytest.raises(SimulationError, match=r"initial_(lateral|yaw) must be at (most|least) -?0\.0"):
        spatial(bogie, **values)


def test_wave_of_a_free_wheelset_that_starts_off_centre_is_klingels_with_the_equivalent_conicity(
    wheelset: Library,
) -> None:
    """Eq. (2.1) at walking pace, without springs, dampers or flange; the conicity includes the effect of roll."""
    softest = {f"{axis}_stiffness": 1.0 for axis in ("longitudinal", "lateral")}
    undamped = {f"{axis}_damping": 0.0 for axis in ("longitudinal", "lateral")}
    free = softest | undamped | {"flange_stiffness": 0.0, "constant_speed": 1}
    amplitude, pair = 3e-3, thesis_pair()
    kernel = Kernel(wheelset, initial_speed=1.0, initial_lateral=amplitude, **free)
    table = kernel.record(60.0, 0.05, ["distance", "lateral_1"])
    distance, lateral = np.array(table["distance"]), np.array(table["lateral_1"])
    before = np.flatnonzero((lateral[:-1] > 0.0) & (lateral[1:] <= 0.0))
    share = lateral[before] / (lateral[before] - lateral[before + 1])
    wavelength = np.diff(distance[before] + share * np.diff(distance)[before])
    scale = pair.wheel_half_distance * pair.radius
    conicity = float(equivalent_conicity(pair, np.array([amplitude]))[0])
    assert wavelength == pytest.approx(2 * np.pi * np.sqrt(scale / conicity), rel=KLINGEL_BAND)
    # Without the effect of roll the wave would be shorter.
    shift = contact_at(pair, amplitude).radius_difference / (2 * amplitude)
    assert wavelength != pytest.approx(2 * np.pi * np.sqrt(scale / shift), rel=10 * KLINGEL_BAND)


def test_yaw_torque_is_square_to_the_axle(observed: Library) -> None:
    """Like the couple of shoe forces (9.1) it does not turn the wheels, at any roll of the wheelset.

    A torque about the vertical of the track would, by the sine of the roll times the torque.
    """
    kernel = Kernel(observed, initial_speed=5.0, initial_lateral=9e-3, constant_speed=1)
    kernel.initialise()
    found = []
    for torque in (0.0, 50e3):
        kernel.set(yaw_torque_1=torque)
        found.append(kernel.rates(["angular_velocity_1"])[0])
    assert found[0] == found[1]
    kernel.advance(0.01)
    assert kernel["yaw_1"] > 1e-4


def test_hunting_above_the_critical_speed_grows_to_a_bounded_cycle(wheelset: Library) -> None:
    """Section 4.4, 30 m/s: growth by the eigenvalue, then a limit cycle at the flange."""
    kernel = Kernel(wheelset, initial_speed=30.0, constant_speed=1, lateral_irregularity=1e-5, tolerance=1e-9)
    lateral = np.abs(kernel.record(40.0, 0.005, ["lateral_1"])["lateral_1"])
    early, late = lateral[4000:5000].max(), lateral[6000:7000].max()  # 20 to 25 s, 30 to 35 s
    rate = growth(wheelset, 30.0)
    assert rate > 0.05
    assert np.log(late / early) / 10.0 == pytest.approx(rate, rel=0.1)
    strong = Kernel(wheelset, initial_speed=30.0, constant_speed=1, lateral_irregularity=4e-3, lateral_wave_number=0.2)
    strong.advance(80.0)
    cycles = [np.abs(strong.record(10.0, 0.005, ["lateral_1"])["lateral_1"]).max() for _ in range(2)]
    assert cycles[0] == pytest.approx(cycles[1], rel=0.01)
    assert 9e-3 < cycles[1] < 11e-3


def test_hunting_in_time_has_the_frequency_of_the_eigenvalue() -> None:
    """The linearisation predicts the growth of a small disturbance; the frequency of its mode is measured in time."""
    system = wheelset_in_frame()
    library = Library(build_library(model_of(system, 1e-10)))
    kernel = Kernel(library, initial_speed=25.0, constant_speed=1, lateral_irregularity=1e-6)
    slowest = oscillations(system, np.array(linearised(kernel, 1.0)))[0]
    y = np.array(kernel.record(8.0, 0.001, ["lateral_1"])["lateral_1"])[3000:]
    peaks = [i for i in range(1, len(y) - 1) if y[i] > y[i - 1] and y[i] >= y[i + 1]]
    assert np.diff(peaks).mean() * 1e-3 == pytest.approx(1 / slowest.frequency, rel=5e-3)


def linearised(kernel: Kernel, seconds: float) -> list[list[float]]:
    kernel.advance(seconds)
    return kernel.linearise().jacobian


def growth(library: Library, speed: float, **values: float) -> float:
    kernel = Kernel(library, initial_speed=speed, constant_speed=1, **values)
    return max(mode.growth for mode in oscillations(wheelset_in_frame(), np.array(linearised(kernel, 1.0))))


@pytest.mark.study
def test_wheelset_of_chapter_4_hunts_as_printed(wheelset: Library) -> None:
    """Section 4.4: wavelength 13.25 m (VAMPIRE 14) at 15 m/s; 1.89 Hz (1.79) at 25 m/s; critical speed 27 m/s."""

    def hunting(speed: float) -> float:
        kernel = Kernel(wheelset, initial_speed=speed, constant_speed=1)
        modes = oscillations(wheelset_in_frame(), np.array(linearised(kernel, 1.0)))
        return max(modes, key=lambda mode: abs(mode.shape["lateral_1"]) * (1.0 < mode.frequency < 3.0)).frequency

    assert 13.1 < 15.0 / hunting(15.0) < 14.0
    assert 1.75 < hunting(25.0) < 1.92
    assert critical_speed(lambda v: growth(wheelset, v), 15.0, 40.0) == pytest.approx(27.0, abs=0.5)
    printed = critical_speed(
        lambda v: growth(wheelset, v, longitudinal_half_spacing=0.35, vertical_half_spacing=0.35), 15.0, 40.0
    )
    assert printed == pytest.approx(22.1, abs=0.2)  # below the thesis's 27: docs/fitted.md


def test_lateral_wave_of_chapter_5(bogie: Library) -> None:
    """Section 5.3.1: 9.5 mm (VAMPIRE 10) at 17 m, at 15 m/s."""
    kernel = spatial(bogie, initial_speed=15.0, constant_speed=1, lateral_irregularity=0.025)
    table = kernel.record(3.0, 0.002, ["lateral_1", "distance"])
    peak = int(np.argmax(np.abs(table["lateral_1"])))
    assert 9.5e-3 <= abs(table["lateral_1"][peak]) <= 10.5e-3
    assert 16.0 <= table["distance"][peak] + tables_5_1_and_5_2().wheel_base / 2 <= 17.5


def test_asymmetric_braking_derails_at_the_fold_and_says_so(bogie: Library) -> None:
    """Section 9.4.1, 75 % error, brake applied in 1 s: derailed at 6.1 m/s, with the thesis's interpretation."""
    kernel = spatial(bogie, yaw_torque_rotates=1, tolerance=1e-6, **AS_PRINTED)
    kernel.advance(1.0)
    kernel.set_rate(brake_torque_1=20e3, brake_torque_2=20e3, yaw_torque_1=131.76e3)
    kernel.advance(1.0)
    with pytest.raises(
        SimulationError, match=r"Derailed: the \w+ wheel of wheelset 1 lost its tread contact at 1\d\."
    ) as end:
        kernel.advance(20.0)
    assert end.value.status == DISCARD
    assert kernel["derailed"] == 1.0
    assert 5.7 < kernel["speed"] < 6.5
    assert 11e-3 < abs(kernel["lateral_1"]) < 12e-3


def test_lifted_wheel_ends_the_run_or_warns(bogie: Library) -> None:
    values = {"initial_speed": 15.0, "constant_speed": 1, "yaw_torque_rotates": 1, "yaw_torque_1": 2.5e5}
    with pytest.raises(SimulationError, match=r"Wheel lift: the .* carried no load at .* s; results up to"):
        spatial(bogie, **values).advance(1.0)
    held = spatial(bogie, wheel_lift_ends=0, **values)
    held.advance(0.2)
    assert any("from there on the rail pulls it down where needed" in line for line in held.messages)


def test_locked_wheelsets_slide_with_the_friction_of_their_loads(bogie: Library) -> None:
    kernel = spatial(bogie)
    kernel.initialise()
    kernel.set_rate(brake_torque_1=1e5, brake_torque_2=1e5)
    kernel.advance(1.0)
    kernel.set_rate(brake_torque_1=0.0, brake_torque_2=0.0)
    kernel.advance(1.0)
    assert kernel["locked_1"] == kernel["locked_2"] == 1.0
    kernel.advance(1.0)
    mean = np.mean(kernel.record(1.0, 0.01, ["acceleration"])["acceleration"])
    assert mean == pytest.approx(-0.3 * 9.81, rel=0.01)  # Polach's force is 1.5 % below mu N at full slip


def test_fitted_ellipse_is_the_exact_one() -> None:
    for across in (0.2, 1.18, 1.67, 6.0, 30.0):
        along, load, modulus = 0.5 / 0.425, 1.5e5, 82e9
        exact = ellipse_shape(0.425, 0.0, 1 / (2 * across), modulus)
        logarithm, mean = (float(x) for x in moving_ellipse(ca.SX(along), ca.SX(across), ca.SX(load), ca.SX(modulus)))
        assert abs(logarithm) < ellipse_fit().limit
        assert logarithm == pytest.approx(float(ca.log(exact.axis_ratio)), abs=2e-4)
        assert mean == pytest.approx(float(ca.sqrt(exact.longitudinal * exact.lateral)) * load ** (1 / 3), rel=2e-4)


def wheelset_on(track: Track, **values: float) -> Kernel:
    """Return the kernel of the wheelset of chapter 4 on another track."""
    system = spatial_vehicle(wheelset_under_frame(), track)
    return Kernel(quick_library(model_of(system, 1e-7)), **values)


@pytest.mark.study
def test_track_from_points_is_the_track_of_the_formula(tmp_path) -> None:  # type: ignore[no-untyped-def]
    """The wave (5.3) as a file with a point every 0.1 m causes the same motion as its formula, here vertically."""
    parameters = replace(section_5_3(), vertical_irregularity=0.01)
    distance = np.arange(0.0, 60.0, 0.1)
    along = distance - 5.0
    share = np.clip(along, 0, 1), np.clip(2 / 0.07 - along, 0, 1)
    window = np.prod([s**3 * (10 - 15 * s + 6 * s**2) for s in share], axis=0)
    height = 0.01 * np.sin(np.pi * 0.07 * along) * window
    zero = 0.0 * distance
    path = tmp_path / "track.csv"
    rows = np.column_stack([distance, zero, height, height, zero + 1.0])
    path.write_text("distance,lateral,left,right,friction\n" + "\n".join(",".join(map(str, row)) for row in rows))
    found = []
    for track in (irregular_track(parameters), track_from_file(path)):
        kernel = wheelset_on(track)
        found.append(np.array(kernel.record(2.0, 0.01, ["bounce"])["bounce"]))
    assert np.abs(found[0]).max() > 1e-3
    assert np.abs(found[0] - found[1]).max() < 1e-5
    rows[distance >= 20.0, 4] = 0.5  # rails are slippery from 20 m on: 12 kN.m lock the wheelset there
    path.write_text("distance,lateral,left,right,friction\n" + "\n".join(",".join(map(str, row)) for row in rows))
    kernel = wheelset_on(track_from_file(path), initial_speed=10.0, brake_torque_1=1.2e4)
    table = kernel.record(4.0, 0.01, ["distance", "locked_1", "speed"])
    locked = int(np.argmax(table["locked_1"]))
    assert 20.0 < table["distance"][locked] < 30.0
    assert table["speed"][locked] > 2.0
    path.write_text("0,0,0,0,1\n1,0,0\n")
    with pytest.raises(ValueError, match=r"row 2, column right: the value must be a number; the cell is empty\."):
        track_from_file(path)
    assert track_from_points(*rows.T)


def test_wave_and_plateau_are_those_printed() -> None:
    """Eqs (5.3), (5.4) outside the blends, and their derivatives compared with differences."""
    parameters = replace(section_5_3(), lateral_irregularity=0.025, vertical_irregularity=0.03, cross_level=0.02)
    track = derivatives_along(parameters)
    lateral, left, right = track(15.0)[0]
    assert lateral == pytest.approx(0.025 * np.sin(np.pi * 0.045 * 10.0), rel=1e-12)
    across = 0.02 / np.sqrt(1 + (0.07 * (15.0 - parameters.cross_level_centre)) ** 8)
    assert left - right == pytest.approx(across, rel=1e-9)
    assert (left + right) / 2 == pytest.approx(0.03 * np.sin(np.pi * 0.07 * 10.0), rel=1e-12)
    for distance in (5.3, 15.0, 60.0):
        before, at, after = (track(distance + h) for h in (-1e-4, 0.0, 1e-4))
        assert np.abs((after - before)[:2] / 2e-4 - at[1:]).max() < 1e-6


@pytest.mark.study
@pytest.mark.parametrize(
    ("driven", "read", "level", "word"),
    [
        (["brake_torque_1"], ["speed", "rotation_1"], 1, "static loads"),
        (["brake_torque_1"], ["speed", "locked_1"], 2, "locked_1 asks for level 2, planar"),
        (["traction_torque_2"], ["pitch"], 2, "pitch asks for level 2"),
        (["yaw_torque_1"], ["speed"], 3, "yaw_torque_1 asks for level 3, spatial"),
        (["lateral_irregularity"], ["speed"], 3, "lateral_irregularity"),
        ([], ["derailed"], 3, "derailed"),
        ([], ["wheel_rise_1_left"], 3, "wheel_rise_1_left asks for contact model 2"),
        (["line_file"], ["speed"], 1, "static loads"),
        (["line_file"], ["axle_load_1"], 2, "axle_load_1 asks for level 2"),
        (["line_file"], ["lateral_1"], 3, "line_file asks for contact model 2: no other knows a line."),
        (["line_file"], ["flange_force_1"], 3, "flange_force_1 asks for contact model 2"),
        (["line_file"], ["body_roll"], 3, "body_roll belongs to the complete vehicle"),
        (["brake_torque_3"], ["speed"], 1, "brake_torque_3 belongs to the complete vehicle; speed and rotation"),
        (["brake_torque_1"], ["axle_load_1", "front_frame_pitch"], 2, "front_frame_pitch belongs to the complete"),
        (["brake_torque_4"], ["body_roll"], 3, "vehicle; body_roll asks for level 3"),
    ],
)
def test_smallest_level_says_why(driven: list[str], read: list[str], level: int, word: str) -> None:
    choice = recommend_level(driven, read)
    assert choice.level == level
    assert word in choice.reason
    assert choice.whole == ("complete vehicle" in choice.reason)
    assert (choice.level == 3 and choice.contact_model == 1) == ("contact_model 1 serves" in choice.reason)
    assert choice.level < 3 or "line_file" not in driven or choice.contact_model == DEPTH_ON_LINE


@pytest.mark.study
@pytest.mark.parametrize(
    ("read", "words"),
    [
        (["speeed"], "VehicleDynamics.* has no variable speeed"),
        (["body_roll", "pitch"], "body_roll .* no variable pitch"),
    ],
)
def test_smallest_level_refuses_names_that_do_not_exist(read: list[str], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        recommend_level([], read)

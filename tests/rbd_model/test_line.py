"""Test vehicles on a line: limits, symmetry, energy and closed forms of curves, cant and gradients."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from scipy.signal import fftconvolve

from fmu_src.kernel import Kernel, Library
from fmu_src.system import System, model_of
from rbd_model.contact.creep.kalker import kalker_coefficients
from rbd_model.contact.creep.kalker_linear import kalker_linear
from rbd_model.contact.depth import Contact
from rbd_model.contact.geometry import (
    equivalent_conicity,
    flange_of,
    rolling_radius_difference,
    thesis_pair,
)
from rbd_model.contact.hertz import ellipse_shape
from rbd_model.levels.planar import planar_vehicle
from rbd_model.levels.point import point_vehicle
from rbd_model.levels.resistance import curve_share
from rbd_model.levels.spatial import spatial_vehicle
from rbd_model.track.irregularity import ballasted_track, irregular_track, section_5_3
from rbd_model.track.line import NAMES, Line, Segment, arc, clothoid, line_of, read_line, straight
from rbd_model.track.line_table import GAUGE
from rbd_model.track.spectra import ERRI_HIGH, ERRI_LOW, Spectrum, irregular
from rbd_model.vehicle.description import HOLDABLE, RigidBody, Springs, Vehicle, Wheelset
from rbd_model.vehicle.ready import two_axle_bogie
from tests.fmu_src.quick_library import quick_library

SIDES = (("left", "right"), ("right", "left"))
ENERGIES = ("kinetic_energy", "potential_energy")
POWERS = ("brake_power", "creep_power", "damping_power")
#: Tolerances of docs/checking.md: the same line in another form, mirrored answers, and energy.
SAME_BAND, MIRROR_BAND, ENERGY_BAND = 1e-9, 1e-9, 1e-8
#: Energy tolerance for the 3D model with loaded flanges and second tread contacts. These contacts begin where the rail
#: changes from R300 to R80, and Hertz' force has a potential at one stiffness only. A joule in 15 MJ; measured 4e-8 and
#: 6e-8.
BORN_BAND = 1e-7
#: Tolerance for mirrored irregularities. Their third derivative jumps at each row, every 11 ms, and round-off leads to
#: other steps. With a tolerance of 1e-9 the difference at the end was 1.1e-8.
IRREGULAR_BAND = 1e-7
#: Tolerances of closed forms: speed on gradients (2e-7 in 3D, where wheels roll on the radius at the contact), cant
#: balance.
GRADIENT_BAND, BALANCE_BAND = 1e-6, 1e-6
#: Tolerances for a free wheelset: rolling line, as the mean over complete waves, and wavelength about it with the
#: conicity at the centre; measured 1.1e-5 and 1e-6.
ROLLING_BAND, KLINGEL_BAND = 1e-4, 1e-5
GRAVITY = 9.81
#: Tolerance of the closed forms of steering, which neglect gravity and spin.
STEERING_BAND = 0.02
#: Step of the central differences [m], and their tolerance as a share of the largest slope; measured 4e-7 and less.
MOVED, JACOBIAN_BAND = 1e-3, 1e-6
#: Tolerance of a body's position and heading after a full circle of 1257 m [m], [rad]; measured 2e-11 m and 7e-13 rad.
CIRCLE_BAND = 1e-9
#: Tolerance of a wave given as curvature against the same one given as irregularity. The contacts use the yaw relative
#: to the track, not to the deviating rails; measured 2.4e-3 of the largest value.
TOLD_BAND = 5e-3
#: Tolerance of the flange in a wider track: its force, and with it its own deflection, changes by 1 %.
WIDENING_BAND = 0.01
#: Tolerance of the roll on rails of unequal height: springs deflect under a leaning body, 4 %.
LEANING_BAND = 0.06
#: Tolerance for locked wheels on rails of unequal friction. Flanges guide them, and their normal forces add to those of
#: the treads.
SLIDING_BAND = 0.03
#: Tolerances for a stop on locked wheels over a map of friction, by level. The first one is for the energy: the frame
#: rocks on its springs. The second one is for the friction under each wheelset: in 3D a cone of 1 : 20 leans, 1.25e-3.
MAPPED_BANDS = {"point": (1e-6, 1e-7), "planar": (0.02, 1e-7), "patched": (0.02, 2e-3)}


def on_line(system: System) -> Library:
    """Compile a system that runs on a line, with its energies and the positions of its bodies as outputs."""
    powers = [name for name in POWERS if name in system.observables]
    shown = [name for name in system.observables if name.endswith(("energy", "ahead", "aside", "above", "heading"))]
    return quick_library(model_of(system.with_outputs(shown).with_integrals(powers), 1e-7))


def bogie_in_space(contact: Contact) -> System:
    return spatial_vehicle(two_axle_bogie(), irregular_track(section_5_3()), contact, True)


@pytest.fixture(scope="module")
def patched() -> Library:
    return on_line(bogie_in_space(Contact(2)))


@pytest.fixture(scope="module")
def planar() -> Library:
    return on_line(planar_vehicle(two_axle_bogie(), True))


@pytest.fixture(scope="module")
def point() -> Library:
    return on_line(point_vehicle(two_axle_bogie(), True))


@pytest.fixture(scope="module")
def wheelset() -> Library:
    """One wheelset alone, pulled along at its centre."""
    carriage = RigidBody("frame", "carriage", 100.0, (1.0, 1.0, 1.0), held=frozenset(HOLDABLE))
    pull = Springs("pull", "frame", "wheelset_1", (0.0, 0.0, 0.0), False, (1e5, 0.0, 0.0), (2e4, 0.0, 0.0))
    alone = Vehicle("alone", two_axle_bogie().parameters, (carriage,), (Wheelset(0.0, "frame"),), (pull,))
    return on_line(spatial_vehicle(alone, irregular_track(section_5_3()), Contact(2), True))


def winding() -> list[Segment]:
    """Return two curves with transitions, cant, gradients and vertical curves."""
    first, left, right, last = straight(40), arc(150, 400, 0.1, 0.02), arc(100, -500, -0.08, -0.01), straight(200)
    ramps = [
        clothoid(length, *pair) for length, pair in ((60, (first, left)), (90, (left, right)), (60, (right, last)))
    ]
    return [first, ramps[0], left, ramps[1], right, ramps[2], last]


def curving() -> Line:
    """Return the first curve from its transition on, with straight track under the wheels that start behind it."""
    return line_of([straight(10), *winding()[1:]], -10.0)


def with_columns(line: Line, **columns: np.ndarray | float) -> Line:
    """Return the line with further columns; a number fills its column."""
    length = line.rows["distance"].size
    return Line(line.rows | {name: np.broadcast_to(values, length) for name, values in columns.items()})


def cut(segment: Segment, count: int) -> list[Segment]:
    """Split a segment into several that make up the same piece of line."""
    ends = segment.ends[0] + np.outer(np.linspace(0.0, 1.0, count + 1), segment.ends[1] - segment.ends[0])
    pairs = [np.array([ends[i], ends[i + 1]]).T.tolist() for i in range(count)]
    return [Segment(segment.length / count, *(tuple(one) for one in pair)) for pair in pairs]


@pytest.fixture
def written(tmp_path: Path):  # type: ignore[no-untyped-def]
    """Return a function that writes a line and returns its path."""
    count = iter(range(100))
    return lambda line: str(line.write(tmp_path / f"line_{next(count)}.csv"))


SEEN = ("speed", "distance", "lateral_1", "yaw_1", "wheel_load_1_left", "wheel_load_2_right", "frame_roll")


@pytest.mark.study
def test_a_line_of_many_segments_is_the_same_line(written, patched: Library) -> None:  # type: ignore[no-untyped-def]
    found = []
    for segments in (winding(), [piece for segment in winding() for piece in cut(segment, 7)]):
        line = line_of(segments, -35.0)
        kernel = Kernel(patched, line_file=written(line), initial_speed=22.0, tolerance=1e-10)
        kernel.advance(3.2)  # into the first curve
        found.append([kernel[name] for name in SEEN])
    assert found[0] == pytest.approx(found[1], rel=SAME_BAND, abs=1e-10)


#: Quantities of the mirrored run: these have the other sign, and wheel loads belong to the other side.
ODD = ("lateral_1", "lateral_2", "yaw_1", "yaw_2", "frame_roll", "guiding_force_1", "guiding_force_2")
OTHERS = {f"wheel_load_{n}_{one}": f"wheel_load_{n}_{other}" for n in (1, 2) for one, other in SIDES}


def mirror_errors(library: Library, line: Line, written, tolerance: float, seconds: float) -> dict[str, float]:  # type: ignore[no-untyped-def]
    """Return the differences of a run and its mirror image at the end, over the largest value of each quantity in the
    run.
    """
    names = [*ODD, *OTHERS, "speed"]
    one, other = (
        Kernel(library, line_file=written(way), initial_speed=22.0, tolerance=tolerance).record(seconds, 0.1, names)
        for way in (line, line.mirrored())
    )
    assert np.ptp(one["lateral_1"]) > 5e-3
    expected = {name: other[OTHERS.get(name, name)][-1] * (-1 if name in ODD else 1) for name in names}
    return {name: abs(one[name][-1] - expected[name]) / float(np.max(np.abs(one[name]))) for name in names}


@pytest.mark.study
def test_a_mirrored_line_gives_a_mirrored_answer(written, patched: Library) -> None:  # type: ignore[no-untyped-def]
    """Through a transition with cant ramp and gradient into a curve, flanges against the rails; 1.3e-9 at 1e-10."""
    errors = mirror_errors(patched, curving(), written, 1e-11, 3.0)
    assert max(errors.values()) < MIRROR_BAND, errors


@pytest.mark.study
def test_mirrored_irregularities_give_a_mirrored_answer(written, patched: Library) -> None:  # type: ignore[no-untyped-def]
    """Irregularities grow in over 10 m: a vehicle starts as on perfect rails."""
    line = irregular(curving(), ERRI_LOW, seed=3)
    grown = blend_in(line.rows["distance"], 2.0, 12.0)
    names = [name for name in line.rows if name.startswith(("left", "right"))]
    line = with_columns(line, **{name: grown * line.rows[name] for name in names})
    errors = mirror_errors(patched, line, written, 1e-9, 1.2)
    assert max(errors.values()) < IRREGULAR_BAND, errors


def blend_in(distance: np.ndarray, first: float, last: float) -> np.ndarray:
    """Blend smoothly from 0 to 1 between two distances [m]."""
    share = np.clip((distance - first) / (last - first), 0.0, 1.0)
    return np.asarray(share**3 * (10 - 15 * share + 6 * share**2))


@pytest.mark.study
@pytest.mark.parametrize("level", ["planar", "patched"])
@pytest.mark.parametrize("braked", [0.0, 8e3])
def test_energy_closes_over_curves_and_hills(level, braked, written, request) -> None:  # type: ignore[no-untyped-def]
    """The line has height, twist and cant ramps; flanges bear on the rails. Relative to the kinetic energy."""
    library = request.getfixturevalue(level)
    kernel = Kernel(library, line_file=written(line_of(winding())), initial_speed=22.0, tolerance=1e-9)
    kernel.set(brake_torque_1=braked, brake_torque_2=braked)
    kernel.set(davis_constant=500.0, davis_linear=20.0, davis_quadratic=5.0)
    if level == "planar":
        kernel.set(curve_resistance=1.0, drive_inertia=50.0)
    names = [*ENERGIES, *(f"integral_{name}" for name in POWERS)]
    table = kernel.record(18.0, 0.2, names)
    energy = np.sum([table[name] for name in names], axis=0)
    assert np.ptp(table["potential_energy"]) > 1e4
    assert np.ptp(energy) < (BORN_BAND if level == "patched" else ENERGY_BAND) * np.max(table["kinetic_energy"])


@pytest.mark.study
def test_energy_closes_while_a_flange_pushes_rails_aside(written, patched) -> None:  # type: ignore[no-untyped-def]
    """The balance includes potential and kinetic energy of the rails and their losses. Without those of the dampers it
    fails.
    """
    distance = np.arange(-10.0, 60.0, 0.25)
    aside = 0.015 * blend_in(distance, 10.0, 15.0)
    line = Line({name: np.zeros_like(distance) for name in NAMES[:4]} | {"distance": distance})
    line = with_columns(line, left_lateral=aside, right_lateral=aside)
    rails = {f"state_track_{number}{side}_speed": side for number in (1, 2) for side in ("", "_left", "_right")}
    names = [*ENERGIES, *(f"integral_{name}" for name in POWERS)]
    kernel = Kernel(patched, line_file=written(line), initial_speed=20.0, tolerance=1e-9)
    table = kernel.record(2.0, 1e-3, [*names, *rails])
    band = BORN_BAND * np.max(table["kinetic_energy"])
    assert np.ptp(np.sum([table[name] for name in names], axis=0)) < band
    track = ballasted_track()
    dampings = {"": track.track_lateral_damping, "_left": track.track_vertical_damping}
    lost = [dampings.get(side, track.track_vertical_damping) * np.square(table[name]) for name, side in rails.items()]
    assert np.sum(lost) * 1e-3 > 10 * band


def test_a_curve_of_a_million_kilometres_is_straight(written, patched: Library) -> None:  # type: ignore[no-untyped-def]
    """All agrees except the rolling line, r0 l / (conicity R) = 4.5 nm at 1e9 m, which is proportional to the
    curvature.
    """
    found = {}
    for radius in (1e9, 1e12, math.inf):
        line = written(line_of([arc(400, radius) if radius < math.inf else straight(400)]))
        kernel = Kernel(patched, line_file=line, initial_speed=20.0, initial_lateral=0.003, tolerance=1e-8)
        kernel.set(brake_torque_1=10e3, brake_torque_2=10e3)
        kernel.advance(5.0)
        found[radius] = np.array([kernel[name] for name in ("speed", "distance", "axle_load_1", "lateral_1")])
    away = {radius: np.abs(values - found[math.inf]) for radius, values in found.items()}
    assert np.all(away[1e9][:3] <= SAME_BAND * found[math.inf][:3])
    assert away[1e9][3] < 20e-9
    # The load depends on the penetration, a difference of heights that are 1e4 times as large.
    assert np.all(away[1e12] <= np.array([1e-12, 1e-12, 1e-11, 1e-12]) * found[math.inf] + 20e-12)


@pytest.mark.study
@pytest.mark.parametrize("level", ["patched", "planar"])
def test_derivatives_by_places_on_the_line_are_exact(level, written, request) -> None:  # type: ignore[no-untyped-def]
    """Compare with central differences in a transition with cant and gradient. The relative position of two places on
    the line is differentiated by a formula.
    """
    system = bogie_in_space(Contact(2)) if level == "patched" else planar_vehicle(two_axle_bogie(), True)
    places = [n for n, name in enumerate(system.states) if name in ("frame_distance", "shift_1", "shift_2")]
    kernel = Kernel(request.getfixturevalue(level), line_file=written(curving()), initial_speed=20.0, tolerance=1e-9)
    kernel.advance(1.3)
    state = np.array(kernel.linearise().state)
    exact = np.array(kernel.jacobian_at(kernel.time, state))
    assert len(places) == 3
    for column in places:
        shift = np.zeros(state.size)
        shift[column] = MOVED
        ahead, back = (np.array(kernel.slopes_at(kernel.time, state + sign * shift)) for sign in (1.0, -1.0))
        error = np.abs((ahead - back) / (2 * MOVED) - exact[:, column]).max()
        assert error < JACOBIAN_BAND * np.abs(exact[:, column]).max()


def test_a_closed_circle_leads_back(written, patched: Library) -> None:  # type: ignore[no-untyped-def]
    """In the steady state each body returns to its position, with its heading a full turn further."""
    radius, circle = 200.0, 2 * math.pi * 200.0
    curve = arc(4 * circle, radius)
    line = line_of([straight(5), clothoid(60, straight(1), curve), curve], -3.0)
    kernel = Kernel(patched, line_file=written(line), constant_speed=1.0)
    kernel.set(initial_speed=20.0, tolerance=1e-8)
    kernel.initialise()
    kernel.advance(1.5 * circle / 20.0)
    bodies = ("frame", "wheelset_1", "wheelset_2")
    names = [f"{body}_{what}" for body in bodies for what in ("ahead", "aside", "above", "heading")]
    before, start = np.array([kernel[name] for name in names]), kernel["state_frame_distance"]
    kernel.advance(1.0)
    # A full circle is measured along the line: the frame follows its own path beside the centre line.
    kernel.advance(circle / (kernel["state_frame_distance"] - start) - 1.0)
    assert kernel["state_frame_distance"] - start == pytest.approx(circle, rel=SAME_BAND)
    after = np.array([kernel[name] for name in names])
    for place, name in enumerate(names):
        turn = 2 * math.pi if name.endswith("heading") else 0.0
        assert after[place] - before[place] == pytest.approx(turn, abs=CIRCLE_BAND), name


@pytest.mark.study
def test_a_free_wheelset_follows_its_rolling_line(wheelset: Library, written) -> None:  # type: ignore[no-untyped-def]
    """Redtenbacher (1855): y = r0 l / (conicity R), as the mean over the waves of Klingel (1883) about it."""
    pair, radius_of_wheel = thesis_pair(), two_axle_bogie().parameters.wheel_radius
    for radius in (600.0, 1000.0, 3000.0):
        line = written(line_of([straight(20), clothoid(60, straight(1), arc(1, radius)), arc(400, radius)]))
        kernel = Kernel(wheelset, flexible_track=0.0, line_file=line, initial_speed=3.0)
        kernel.advance(60.0)
        wave = wavelength()
        mean = float(np.mean(kernel.record(2 * wave / 3.0, wave / 3.0 / 60, ["lateral_1"])["lateral_1"][:-1]))
        difference = rolling_radius_difference(pair, np.array([-mean]))[0]
        spacing = pair.wheel_half_distance
        assert abs(difference) / (2 * radius_of_wheel) == pytest.approx(spacing / radius, rel=ROLLING_BAND)
        assert mean < 0.0


def wavelength() -> float:
    """Return the length of the kinematic wave with the profiles' equivalent conicity [m], Klingel (1883), eq. (2.1)."""
    pair, parameters = thesis_pair(), two_axle_bogie().parameters
    conicity = float(equivalent_conicity(pair, np.array([1e-3]))[0])
    return 2 * math.pi * math.sqrt(parameters.wheel_radius * pair.wheel_half_distance / conicity)


@pytest.mark.study
def test_a_free_wheelset_swings_about_its_rolling_line_with_klingels_wavelength(wheelset: Library, written) -> None:  # type: ignore[no-untyped-def]
    """At walking pace from 1 mm beside its rolling line. In the wide curve the middle of its motion is within 0.1 mm of
    that line. On straight track it is the centre.
    """
    spacing, radius = thesis_pair().wheel_half_distance, two_axle_bogie().parameters.wheel_radius
    conicity = abs(rolling_radius_difference(thesis_pair(), np.array([1e-3]))[0]) / 2e-3
    for curvature in (0.0, 1 / 3000, -1 / 2000):
        line = line_of([Segment(60, (curvature, curvature))], -1.0)
        rolling = -radius * spacing * curvature / conicity
        kernel = Kernel(
            wheelset, flexible_track=0.0, line_file=written(line), initial_speed=1.0, initial_lateral=rolling + 1e-3
        )
        table = kernel.record(43.0, 0.1, ["distance", "lateral_1"])
        distance, lateral = np.array(table["distance"]), np.array(table["lateral_1"]) - rolling
        before = np.flatnonzero((lateral[:-1] > 0.0) & (lateral[1:] <= 0.0))
        share = lateral[before] / (lateral[before] - lateral[before + 1])
        found = np.diff(distance[before] + share * np.diff(distance)[before])
        assert found == pytest.approx(np.full(2, wavelength()), rel=KLINGEL_BAND)
        assert (np.max(lateral) + np.min(lateral)) / 2 == pytest.approx(0.0, abs=1e-4)


@pytest.mark.study
def test_cant_that_balances_loads_both_rails_alike(wheelset: Library, written) -> None:  # type: ignore[no-untyped-def]
    """V^2 = R g tan(cant): apparent gravity is square to the track. At 2 % more speed the loads differ.

    The wheelset runs without friction, which would steer it aside, and without gyroscopic moments. The couple (I_z -
    I_y) W^2 sin(cant) cos(cant) turns an inclined body in a curve upright; it is 1e-7 here.
    """
    radius, cant = 3000.0, 0.02
    # Radius of the centre of mass, which leans towards the middle of the curve.
    own_radius = radius - two_axle_bogie().parameters.wheel_radius * cant / GAUGE
    speed = math.sqrt(own_radius * GRAVITY * math.tan(math.asin(cant / GAUGE)))
    for share in (1.0, 1.02):
        kernel = Kernel(
            wheelset,
            flexible_track=0.0,
            line_file=written(line_of([arc(400, radius, cant)])),
            initial_speed=share * speed,
        )
        # The start is given, because a wheelset without friction has no steady state to start in.
        kernel.set(friction_1=0.0, rolling_resistance_torque=0.0, tolerance=1e-9, initial_lateral=1e-9)
        kernel.set(wheelset_pitch_inertia=1e-6)
        kernel.advance(0.5)
        left, right = kernel["wheel_load_1_left"], kernel["wheel_load_1_right"]
        assert (abs(right - left) < BALANCE_BAND * left) == (share == 1.0), (share, right / left - 1)


@pytest.fixture(scope="module")
def linear() -> Library:
    """The bogie with Kalker's linear creep, for comparison with a closed form."""
    contact = Contact(2, creep_law=kalker_linear)
    return on_line(spatial_vehicle(two_axle_bogie(), irregular_track(section_5_3()), contact, True))


@pytest.mark.study
@pytest.mark.parametrize("stiffness", [1e5, 9.5e6, 1e9])
def test_a_bogie_steers_as_linear_theory_says(linear: Library, stiffness: float, written) -> None:  # type: ignore[no-untyped-def]
    """Lateral shift of both wheelsets and the difference of their yaw, with the soft springs of Table 5.1 and rigid in
    yaw.

    With Polach's law, whose spin reduces its stiffness, a rigid bogie is 7 % further out.
    """
    radius, speed = 5000.0, 4.0
    line = line_of([straight(20), clothoid(300, straight(1), arc(1, radius)), arc(900, radius)])
    kernel = Kernel(linear, flexible_track=0.0, line_file=written(line), initial_speed=speed, constant_speed=1.0)
    kernel.set(longitudinal_stiffness=stiffness)
    kernel.advance(230.0)
    names = ("lateral_1", "lateral_2", "yaw_1", "yaw_2")
    table = kernel.record(50.0, 0.05, names)
    found = [float(np.mean(table[name])) for name in names]
    expected = steering(radius, stiffness)
    assert found[:2] == pytest.approx(expected[:2].tolist(), rel=STEERING_BAND)
    smallest = 1e-3 * abs(expected[0])  # with soft springs both wheelsets are radial
    assert found[3] - found[2] == pytest.approx(expected[3] - expected[2], rel=STEERING_BAND, abs=smallest)


def steering(radius: float, stiffness: float) -> np.ndarray:
    """Return lateral shift [m] and yaw [rad] of both wheelsets of a bogie in a wide curve, Boocock (1969).

    Conicity and creep turn and push each wheelset, against springs to a frame on the chord. Gravity and spin, which
    shift the yaw of both alike, are neglected.
    """
    p, pair = two_axle_bogie().parameters, thesis_pair()
    sizes = (p.wheel_radius, p.wheel_profile_curvature, p.rail_head_radius, p.shear_modulus)
    shape = ellipse_shape(*map(ca.SX, sizes))
    kalker = kalker_coefficients(shape.axis_ratio)
    load = (p.frame_mass + 2 * p.wheelset_mass) * GRAVITY / 4
    area = p.shear_modulus * float(shape.longitudinal) * float(shape.lateral) * load ** (2 / 3)
    ahead, aside = area * float(kalker.c11), area * float(kalker.c22)
    conicity = abs(rolling_radius_difference(pair, np.array([1e-3]))[0]) / 2e-3
    spacing, base = pair.rail_half_distance, p.wheel_base / 2
    yawing, across = 2 * stiffness * p.longitudinal_half_spacing**2, 2 * p.lateral_stiffness
    matrix, right = np.zeros((6, 6)), np.zeros(6)  # of y1, y2, yaw1, yaw2, and of the frame's y and yaw
    turning, versine = 2 * ahead * spacing, base**2 / (2 * radius)
    for i, sign in ((0, 1), (1, -1)):
        matrix[i, i], matrix[i, 2 + i], matrix[i, 5] = turning * conicity / p.wheel_radius, yawing, -yawing
        right[i] = -turning * spacing / radius - yawing * sign * base / radius
        matrix[2 + i, [2 + i, i, 4, 5]] = 2 * aside, -across, across, across * sign * base
        right[2 + i] = across * versine
    matrix[4, [0, 1, 4]], right[4] = (1, 1, -2), -2 * versine
    matrix[5, :4] = base * across, -base * across, yawing, yawing
    matrix[5, 5] = -2 * base**2 * across - 2 * yawing
    return np.linalg.solve(matrix, right)


def test_a_flange_meets_its_rail_half_of_the_widening_further_out(written, patched: Library) -> None:  # type: ignore[no-untyped-def]
    """A curve of 150 m, whose outer rail guides the leading wheelset. A widening w of the gauge moves each rail by w /
    2.

    A displacement rolls the wheelset. Its flange is below the axle by the arm and so moves further than its centre.
    """
    flange = flange_of(thesis_pair())
    line = line_of([straight(20), clothoid(30, straight(1), arc(1, 150)), arc(100, 150)])
    arm = two_axle_bogie().parameters.wheel_radius + flange.depth
    for_each = 1 / (1 + arm * flange.roll_by_shift)
    found = {}
    for wide in (0.0, 0.006):
        told = {"gauge_widening": wide}, {"left_lateral": wide / 2, "right_lateral": -wide / 2}
        answers = []
        for columns in told[: 2 if wide else 1]:
            kernel = Kernel(patched, line_file=written(with_columns(line, **columns)), initial_speed=10.0)
            kernel.set(constant_speed=1.0)
            kernel.advance(10.0)
            answers.append([kernel[name] for name in SEEN])
        assert answers[0] == answers[-1]
        found[wide] = kernel["lateral_1"]
    assert found[0.0] < -0.009
    assert found[0.0] - found[0.006] == pytest.approx(0.003 * for_each, rel=WIDENING_BAND)


@pytest.mark.parametrize("way", ["lateral", "vertical"])
def test_a_wave_of_both_rails_is_one_of_the_line(way, written, patched: Library) -> None:  # type: ignore[no-untyped-def]
    """A lateral wave by curvature, a hump by gradient: bodies are where they are if both rails are shifted as much."""
    distance, length = np.arange(0.0, 160.0, 0.125), 40.0
    place = math.pi * np.clip((distance - 20) / length, 0.0, 1.0)
    sine, cosine, number = np.sin(place), np.cos(place), math.pi / length
    shift = 5e-3 * sine**4
    gradient = 5e-3 * number * 4 * sine**3 * cosine
    curvature = 5e-3 * number**2 * (12 * sine**2 * cosine**2 - 4 * sine**4)
    level = Line({name: np.zeros_like(distance) for name in NAMES[:4]} | {"distance": distance})
    of_line = {"lateral": {"curvature": curvature}, "vertical": {"gradient": gradient}}[way]
    of_rails = {f"left_{way}": shift, f"right_{way}": shift}
    names = {
        "lateral": ("wheelset_1_aside", "frame_aside", "frame_heading", "lateral_1", "lateral_2", "guiding_force_1"),
        "vertical": ("wheelset_1_above", "frame_above", "wheel_load_2_right"),
    }[way]
    one, other = (
        Kernel(
            patched,
            line_file=written(with_columns(level, **columns)),
            initial_speed=15.0,
            tolerance=1e-9,
        )
        for columns in (of_line, of_rails)
    )
    names += ("wheel_load_1_left",)
    there, here = (kernel.record(5.0, 0.1, names) for kernel in (one, other))
    for name in names:
        differences = np.abs(np.array(there[name]) - np.array(here[name]))
        assert np.max(differences) < TOLD_BAND * np.ptp(here[name]), name
    assert np.ptp(here[names[0]]) > 0.9 * 5e-3


@pytest.mark.parametrize(("side", "sign"), [("left", 1.0), ("right", -1.0)])
def test_a_vehicle_leans_away_from_the_higher_rail(side, sign, written, patched: Library) -> None:  # type: ignore[no-untyped-def]
    """The roll is half the height over the distance of the contacts; the other rail carries more weight."""
    height, spacing = 8e-3, thesis_pair().wheel_half_distance
    line = line_of([straight(100)])
    line = with_columns(line, **{f"{side}_vertical": height * blend_in(line.rows["distance"], 0.0, 20.0)})
    kernel = Kernel(patched, line_file=written(line), initial_speed=3.0, constant_speed=1.0)
    kernel.advance(25.0)
    other = {"left": "right", "right": "left"}[side]
    sunk = (kernel[f"wheel_load_1_{other}"] - kernel[f"wheel_load_1_{side}"]) / kernel["track_vertical_stiffness"]
    assert kernel["frame_roll"] == pytest.approx(sign * (height + sunk) / (2 * spacing), rel=LEANING_BAND)
    assert kernel["wheelset_1_above"] - two_axle_bogie().parameters.wheel_radius == pytest.approx(height / 2, rel=0.01)
    assert kernel[f"wheel_load_1_{other}"] > 1.02 * kernel[f"wheel_load_1_{side}"]


def test_locked_wheels_slide_as_the_friction_of_each_rail_says(written, patched: Library) -> None:  # type: ignore[no-untyped-def]
    """g mu (f_left + f_right) / 2, and a couple towards the rail with more friction, balanced by the flanges."""
    p, spacing, left, right, friction = two_axle_bogie().parameters, thesis_pair().rail_half_distance, 0.5, 0.9, 0.1
    line = with_columns(line_of([straight(200)]), left_friction=left, right_friction=right)
    kernel = Kernel(patched, line_file=written(line), initial_speed=30.0)
    kernel.set(brake_torque_1=40e3, brake_torque_2=40e3, friction_1=friction, friction_2=friction)
    kernel.advance(2.0)
    seen = kernel.record(3.0, 0.01, ["speed"])
    assert [kernel[f"locked_{number}"] for number in (1, 2)] == [1, 1]
    # The mean, because sliding wheelsets oscillate along the track on their springs.
    slowed = -np.polyfit(seen["time"], seen["speed"], 1)[0]
    assert slowed == pytest.approx(GRAVITY * friction * (left + right) / 2, rel=SLIDING_BAND)
    assert max(kernel["yaw_1"], kernel["yaw_2"]) < -5e-3  # to the right
    weight = (p.frame_mass + 2 * p.wheelset_mass) * GRAVITY
    couple = friction * (right - left) / 2 * weight * spacing
    held = (kernel["guiding_force_1"] - kernel["guiding_force_2"]) * p.wheel_base / 2
    assert held == pytest.approx(couple, rel=2 * SLIDING_BAND)


@pytest.mark.study
@pytest.mark.parametrize("level", MAPPED_BANDS)
def test_locked_wheels_stop_where_friction_along_the_line_has_taken_their_energy(level, written, request) -> None:  # type: ignore[no-untyped-def]
    """v^2 / 2 = g mu0 times the integral of the factor over the travel of the axles. No step skips 1 m of sand."""
    library, mu, factors = request.getfixturevalue(level), 0.1, np.array([1.0, 0.25, 2.0, 0.6, 3.0, 0.6])
    begins = np.array([-50.0, 40.0, 80.0, 95.0, 250.0, 251.0])
    rows = np.sort([*begins, *(begins[1:] - 0.01), 900.0])
    of_row = factors[np.searchsorted(begins, rows, "right") - 1]
    skew = 0.0 if level == "patched" else 0.2  # in 3D, unequal rails turn the bogie
    columns = {"left_friction": (1 - skew) * of_row, "right_friction": (1 + skew) * of_row}
    line = Line({"distance": rows} | {name: np.zeros(rows.size) for name in NAMES[1:4]} | columns)
    kernel = Kernel(library, line_file=written(line), initial_speed=20.0)
    kernel.set(brake_torque_1=60e3, brake_torque_2=60e3, friction_1=mu, friction_2=mu)
    kernel.advance(0.5)
    begin, speed = kernel["distance"], kernel["speed"]
    names = ["distance", "speed", "creep_force_1", "axle_load_1", "creep_force_2", "axle_load_2"]
    seen = {name: np.array(column) for name, column in kernel.record(45.0, 0.1, names).items()}
    way_band, friction_band = MAPPED_BANDS[level]
    half = two_axle_bogie().parameters.wheel_base / 2
    whole = np.r_[0.0, np.cumsum(np.diff(rows) * (of_row[1:] + of_row[:-1]) / 2)]

    def gained(at: float) -> float:
        """Return the integral of the factor over the travel of an axle [m]."""
        first, last = np.interp([begin + at, kernel["distance"] + at], rows, whole)
        return float(last - first)

    assert kernel["speed"] == 0.0
    assert GRAVITY * mu * (gained(half) + gained(-half)) / 2 == pytest.approx(speed**2 / 2, rel=way_band)
    slides = seen["speed"] > 1.0
    for number, at in ((1, half), (2, -half)):
        found = -seen[f"creep_force_{number}"] / seen[f"axle_load_{number}"]
        expected = mu * np.interp(seen["distance"] + at, rows, of_row)
        assert found[slides] == pytest.approx(expected[slides], rel=friction_band)


def test_a_map_of_friction_keeps_the_line_and_refuses_what_is_no_map() -> None:
    """Equal places are a jump within 10 mm; all other columns keep their values at the rows."""
    own = curving()
    mapped = own.with_friction([40.0, 40.0, 90.0], [1.0, 0.2, 0.7], right=[1.0, 0.4, 0.7])
    places = np.array([-10.0, 39.0, 40.0, 40.01, 65.005, 90.0, 150.0])
    assert mapped.value("left_friction", places) == pytest.approx([1, 1, 1, 0.2, 0.45, 0.7, 0.7], abs=1e-12)
    assert mapped.value("right_friction", places)[3:5] == pytest.approx([0.4, 0.55], abs=1e-12)
    rows = own.rows["distance"]
    for name in NAMES[1:4]:
        assert np.interp(rows, mapped.rows["distance"], mapped.rows[name]) == pytest.approx(own.rows[name], abs=1e-15)
    for places, factors, words in (
        ([40.0, 30.0], [1.0, 0.2], "got 30 m after 40 m. Sort them"),
        ([40.0, 40.0, 40.0], [1.0, 0.2, 0.3], "at most two equal ones"),
        ([-11.0, 30.0], [1.0, 0.2], "from -10 to .* got -11 to 30 m"),
        ([30.0], [1.0, 0.2], "got 1 places, and 2 and 2 factors"),
        ([30.0], [float("nan")], "Factors of friction must be from 0 to 10; got nan as number 1"),
        ([30.0, 40.0], [1.0, -0.1], "Factors of friction must be from 0 to 10; got -0.1 as number 2"),
        ([30.0, float("inf")], [1.0, 1.0], "Places of friction must be finite; got inf as number 2"),
        ([], [], "at least one place"),
        (["a"], [1.0], "must be numbers"),
    ):
        with pytest.raises(ValueError, match=words):
            own.with_friction(places, factors)


@pytest.mark.study
@pytest.mark.parametrize("level", ["point", "planar", "patched"])
def test_a_rolling_vehicle_gains_speed_as_its_masses_say(level, written, request) -> None:  # type: ignore[no-untyped-def]
    """a = g i m / (m + J / r^2); J includes the drive."""
    library, gradient = request.getfixturevalue(level), -0.03
    p = two_axle_bogie().parameters
    kernel = Kernel(library, line_file=written(line_of([straight(5000, gradient)])), initial_speed=5.0)
    drive = 60.0
    kernel.set(rolling_resistance_torque=0.0, drive_inertia=drive, tolerance=1e-9)
    kernel.advance(28.0)  # until all oscillations have decayed
    mass = p.frame_mass + 2 * p.wheelset_mass
    rolling = mass + 2 * (p.wheelset_pitch_inertia + drive) / p.wheel_radius**2
    before = kernel["speed"]
    kernel.advance(10.0)
    assert (kernel["speed"] - before) / 10.0 == pytest.approx(-gradient * GRAVITY * mass / rolling, rel=GRADIENT_BAND)


@pytest.mark.parametrize("level", ["point", "planar"])
def test_terminal_speed_is_where_resistance_balances_the_gradient(level, written, request) -> None:  # type: ignore[no-untyped-def]
    """Davis: m g i = a + b V + c V^2 at constant speed; without rolling resistance of the axle boxes."""
    library, gradient = request.getfixturevalue(level), -0.01
    p = two_axle_bogie().parameters
    a, b, c = 800.0, 30.0, 8.0
    kernel = Kernel(library, line_file=written(line_of([straight(120000, gradient)])), initial_speed=20.0)
    kernel.set(davis_constant=a, davis_linear=b, davis_quadratic=c, rolling_resistance_torque=0.0, tolerance=1e-9)
    kernel.advance(4000.0)
    pull = (p.frame_mass + 2 * p.wheelset_mass) * GRAVITY * -gradient
    terminal = (-b + math.sqrt(b**2 + 4 * c * (pull - a))) / (2 * c)
    assert kernel["speed"] == pytest.approx(terminal, rel=GRADIENT_BAND)


def test_curve_resistance_is_that_of_von_roeckl(point: Library, written) -> None:  # type: ignore[no-untyped-def]
    assert float(curve_share(1 / 500)) == pytest.approx(0.650 / (500 - 55), rel=1e-12)
    assert float(curve_share(1 / 200)) == pytest.approx(0.500 / (200 - 30), rel=1e-12)
    p = two_axle_bogie().parameters
    kernel = Kernel(point, line_file=written(line_of([arc(2000, 500)])), initial_speed=10.0, curve_resistance=1.0)
    kernel.set(rolling_resistance_torque=0.0)
    kernel.advance(1.0)
    mass = p.frame_mass + 2 * p.wheelset_mass
    rolling = mass + 2 * p.wheelset_pitch_inertia / p.wheel_radius**2
    braked = mass * GRAVITY * 0.650 / 445 / rolling
    assert kernel["acceleration"] == pytest.approx(-braked, rel=1e-5)


def test_a_host_that_knows_the_gradient_needs_no_line(point: Library, planar: Library, written) -> None:  # type: ignore[no-untyped-def]
    """The input and a line of the same gradient give the same answer at both levels."""
    for make, line in ((point_vehicle, point), (planar_vehicle, planar)):
        library = quick_library(model_of(make(two_axle_bogie()), 1e-9))
        told = Kernel(library, initial_speed=20.0, gradient=-0.04, brake_torque_1=8e3, tolerance=1e-9)
        found = Kernel(line, line_file=written(line_of([straight(2000, -0.04)])), initial_speed=20.0, tolerance=1e-9)
        found.set(brake_torque_1=8e3)
        for kernel in (told, found):
            kernel.advance(10.0)
        for name in ("speed", "distance", "axle_load_1", "angular_velocity_1"):
            assert told[name] == pytest.approx(found[name], rel=1e-8), (make, name)


def test_places_far_from_the_start_are_as_exact_as_near_it(written, patched: Library) -> None:  # type: ignore[no-untyped-def]
    """The same curve at the start and after 100 km of another line: wheel loads differ by round-off only."""
    found = []
    for before in (60.0, 100e3):
        lead = [arc(before - 60.0, 3000.0)] if before > 60.0 else []
        ramp = [clothoid(30.0, lead[0], straight(1))] if lead else []
        line = line_of([*lead, *ramp, straight(60 if not lead else 30), *winding()[1:]], -before)
        kernel = Kernel(patched, line_file=written(line), initial_speed=20.0, tolerance=1e-8)
        kernel.advance(6.0)
        found.append([kernel[name] for name in SEEN])
    assert found[0] == pytest.approx(found[1], rel=1e-7, abs=1e-9)


def test_a_line_is_read_as_it_was_written(tmp_path: Path) -> None:
    line = irregular(line_of(winding()), ERRI_LOW, seed=5)
    again = read_line(line.write(tmp_path / "line.csv"))
    assert list(again.rows) == list(line.rows)
    for name, values in line.rows.items():
        assert np.array_equal(values, again.rows[name]), name
    twice = line.mirrored().mirrored()
    assert all(np.array_equal(values, twice.rows[name]) for name, values in line.rows.items())


def test_a_spectrum_gives_its_own_variance() -> None:
    """Mean square of a long track against the integral of the density over both signs of the wave number, over 2 pi.

    For class 6 the integral is that of the one-sided density in cm2/(rad/m).
    """
    numbers = np.linspace(2 * math.pi / 100, 2 * math.pi / 3, 20001)
    of_class_6 = 1e-4 * 0.25 * 0.0339 * 0.8245**2 / (numbers**2 * (numbers**2 + 0.8245**2))
    for name, density in (("erri-low", ERRI_LOW.of_centre(2.119e-7, numbers) / math.pi), ("fra-6", of_class_6)):
        rails = [irregular(line_of([straight(4000)]), name, seed).rows["left_lateral"] for seed in range(8)]
        variance = float(np.sum(density) * (numbers[1] - numbers[0]))
        assert np.mean(np.square(rails)) == pytest.approx(variance, rel=0.05)
    with pytest.raises(ValueError, match=r"spectrum must be one of erri-low, .*; got 'erri'"):
        irregular(line_of([straight(100)]), "erri")
    with pytest.raises(ValueError, match="lateral of a spectrum must be a number of at least 0; got -1"):
        Spectrum(-1.0, 1.0)
    one, other = (irregular(line_of([straight(100)]), ERRI_LOW, seed).rows["left_lateral"] for seed in (1, 2))
    assert not np.array_equal(one, other)


def test_rails_of_a_spectrum_do_not_repeat() -> None:
    """The correlation with themselves some way further, from 300 m on: 1 on rails that repeat."""
    rails = irregular(line_of([straight(6000)]), ERRI_LOW, seed=1).rows["left_lateral"]
    overlap = np.arange(rails.size, 0, -1)
    alike = fftconvolve(rails, rails[::-1])[rails.size - 1 :] / overlap / np.var(rails)
    assert np.max(np.abs(alike[1200:12000])) < 0.4


def test_irregularities_leave_the_rails_in_place_where_a_vehicle_starts() -> None:
    line = irregular(line_of([straight(200)], -30.0), ERRI_HIGH, seed=1)
    for name in ("left_lateral", "left_vertical", "right_vertical"):
        size = np.abs(line.rows[name])
        assert np.all(size[line.rows["distance"] <= -15.0] == 0.0)
        assert np.all(size[line.rows["distance"] <= -10.0] < 0.05 * np.max(size))


def test_lines_that_cannot_be_built_are_refused() -> None:
    with pytest.raises(ValueError, match="at least one segment"):
        line_of([])
    with pytest.raises(ValueError, match="rounded over 2 m"):
        line_of([straight(1.0), arc(100, 300)])
    with pytest.raises(ValueError, match="rows every"):
        irregular(line_of([straight(100)]), ERRI_LOW, seed=1, waves=(0.5, 10.0))
    with pytest.raises(ValueError, match="waves must be two lengths above 0 m, the shorter one first; got"):
        irregular(line_of([straight(100)]), ERRI_LOW, seed=1, waves=(3.0, math.inf))
    for seed in (-1, 1.5, None):
        with pytest.raises(ValueError, match="seed must be an integer from 0 on; got"):
            irregular(line_of([straight(100)]), ERRI_LOW, seed)  # type: ignore[arg-type]
    turning = RigidBody("frame", "frame", 1.0, (1.0, 1.0, 1.0), held=frozenset({"pitch", "lateral"}))
    held = replace(two_axle_bogie(), bodies=(replace(two_axle_bogie().bodies[0], held=turning.held),))
    with pytest.raises(ValueError, match="hold all angles or none"):
        spatial_vehicle(held, irregular_track(section_5_3()), Contact(2), True)


def test_the_contact_of_the_thesis_runs_on_straight_track_alone() -> None:
    with pytest.raises(ValueError, match="Contact model 1 runs on straight track alone"):
        bogie_in_space(Contact(1))


def test_empty_columns_are_left_out(tmp_path: Path) -> None:
    rows = line_of([straight(100)]).rows
    assert Line(rows).write(tmp_path / "line.csv").read_text().splitlines()[0] == "distance,curvature,cant,gradient"

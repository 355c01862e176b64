"""Test contact models 2 and 3, elastic patches of tread and flange, against closed forms and the rigid contact."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise

import casadi as ca
import numpy as np
import pytest
from scipy.special import ellipe, ellipk

from fmu_src.kernel import Kernel, Library
from fmu_src.system import System, model_of
from rbd_model.contact.creep.kalker_linear import kalker_linear
from rbd_model.contact.creep.kalker_to_coulomb import kalker_to_coulomb
from rbd_model.contact.creep.law import CreepLaw
from rbd_model.contact.creep.polach import polach
from rbd_model.contact.depth import DEPTHS, Contact
from rbd_model.contact.elastic import damped, elastic_force
from rbd_model.contact.geometry import Sides, european_pair, synthetic_pair, thesis_pair
from rbd_model.contact.hertz import POISSON_RATIO
from rbd_model.contact.patches import parts_of, patches_of, positions_of, stand_on_treads
from rbd_model.levels.spatial import spatial_vehicle
from rbd_model.track.irregularity import irregular_track, section_5_3
from rbd_model.vehicle.description import as_sum
from rbd_model.vehicle.ready import two_axle_bogie, wheelset_under_frame
from scenarios.bench.climbing_wheelset import INTERVAL, climbing_wheelset, push
from scenarios.contact import contact_manchester as manchester
from tests.fmu_src.quick_library import quick_library

STEEL = 82e9
#: Tolerance of the friction force of locked wheels: yaw and lateral sliding turn it slightly away from the track axis.
SLID = 0.01
#: Tolerance of the profile's radius where a wheel touches at rest, S1002 8 mm beside its tape circle [m].
STANDS = 0.2e-3
#: Tolerance of the polynomial for Hertz' force; a hundredth of the error of Hertz' theory itself at a rail.
FIT_BAND = 5e-4
ENERGIES = ("kinetic_energy", "potential_energy")
POWERS = ("brake_power", "creep_power", "damping_power")
#: Energy error as a share of all energy: acceptance limit in docs/checking.md.
ENERGY_BAND = 1e-6
#: Tolerance between an elastic and a rigid tread: the approach, 0.13 mm, over a lateral displacement of some mm.
DEPTH_BAND = 0.02
#: Tolerance of the place of a contact [m]; the squared overlap of exact theory is that of deformed surfaces.
PLACE_BAND = 0.05e-3
#: Difference of forces from exact theory, as a share of mu N. It is the known error of the flange's creep law
#: (`contact-manchester`) and detects any increase.
FORCE_BAND = 0.09
#: Least distance from the cut between two parts of a wheel to the contact of each [m].
CLEAR = 1e-3
#: Wheel load of the chapter 5 bogie [N], and relative deviation at its start: spin reduces the load slightly.
STATIC_LOAD, AT_REST = (60000 / 2 + 1200) * 9.81 / 2, 1e-4
#: Load error of 8 strips at the approach of an ellipse, as in test_strips_in_c.py; tolerances of numerical derivatives.
STRIP_ERROR, SLOPE_BANDS = 0.03, {2: 1e-4, 3: 1e-3}


def elastic(approach: float, along: float, across: float) -> float:
    return float(elastic_force(ca.SX(approach), ca.SX(along), ca.SX(across), ca.SX(STEEL)))


@pytest.mark.parametrize("slenderness", [1.0, 1.001, 2.0, 10.0, 25.0])
def test_force_by_approach_is_hertz_with_scipys_elliptic_integrals(slenderness: float) -> None:
    """Johnson (1985), section 4.2: 3 N K / (2 pi a E*) is the approach of an ellipse with the semi-axes a > b."""
    g, along, approach = 1 / slenderness, 1.2, 1.1e-4
    k, e = ellipk(1 - g**2), ellipe(1 - g**2)
    ratio = (e / g**2 - k) / (k - e) if slenderness > 1.0 else 1.0
    modulus = STEEL / (1 - POISSON_RATIO)
    exact = 2 * math.pi / 3 * modulus * (approach / k) ** 1.5 * math.sqrt(e / (g**2 * along * (1 + ratio)))
    assert elastic(approach, along, along * ratio) == pytest.approx(exact, rel=FIT_BAND)
    assert elastic(approach, along * ratio, along) == pytest.approx(exact, rel=FIT_BAND)
    assert abs(elastic(1.001 * approach, along, along * ratio) / exact - 1) > FIT_BAND


def test_bodies_that_are_apart_do_not_press_and_damping_does_not_pull() -> None:
    assert elastic(-1e-3, 1.2, 1.6) < 1e-6
    assert float(damped(ca.SX(1e5), ca.SX(-10.0), ca.SX(1.0))) == 0.0
    assert float(damped(ca.SX(1e5), ca.SX(0.1), ca.SX(1.0))) == pytest.approx(1.1e5)


@pytest.mark.parametrize("pair", [thesis_pair, synthetic_pair])
def test_synthetic_wheel_bears_on_its_tread_and_on_its_flange(pair) -> None:  # type: ignore[no-untyped-def]
    """R300 of the 60 kg rail under the tread. A ridge of 19 um on the tread lies within a contact."""
    one = pair().left
    tread, flange = patches_of(one)
    assert (tread.direction, tread.flange, flange.flange) == (0.0, False, True)
    assert tread.radius == pytest.approx(0.300, rel=0.1)
    assert math.degrees(flange.direction) == pytest.approx(70.3, abs=0.5)
    assert -36e-3 < positions_of(one)[tread.first] < -30e-3
    assert len(parts_of(one)) == 3


def test_no_part_touches_at_its_cut() -> None:
    """The nearest places of neighbouring parts are apart, and none is at the cut: a nearer place belongs to the next
    part.
    """
    for one in (synthetic_pair().left, european_pair().left):
        s = positions_of(one)
        for outer, inner in pairwise(patches_of(one)):
            cut = s[inner.last]
            assert np.nanmin(outer.nearest) > cut + CLEAR
            assert np.nanmax(inner.nearest) < cut - CLEAR


@pytest.mark.study
@pytest.mark.parametrize("shift", [1.0, 3.0, 7.0, 10.0])
def test_patch_presses_where_exact_theory_has_it(shift: float) -> None:
    """The left wheel while the right one climbs. The roll of up to 11 mrad alone moves the nearest point by 2 mm."""
    pressed = max(manchester.bearings(*manchester.case("left", shift)), key=lambda one: one.load)
    assert pressed.on_rail == pytest.approx(manchester.exact("left")[shift].place, abs=PLACE_BAND)
    # The benchmark's wheelset is also yawed; its vertical force is the load.
    assert pressed.up == pytest.approx(manchester.LOAD, rel=1e-6)


@pytest.mark.study
def test_flange_and_tread_slide_by_the_law_of_elastic_patches_or_by_their_own() -> None:
    """Right wheel of the Manchester benchmark: flange contact at 7 mm, tread contact at 3 mm."""
    exact = manchester.exact("right")
    by_default, by_user = Contact(2), Contact(2, creep_law=kalker_linear)
    own, others = Contact(2, kalker_to_coulomb, kalker_to_coulomb), Contact(2, polach, polach)

    def outwards(shift: float, contact: Contact) -> float:
        return -sum(one.outwards for one in manchester.bearings(*manchester.case("right", shift), contact))

    for shift in (3.0, 7.0):
        assert outwards(shift, by_default) == outwards(shift, own)
    assert outwards(7.0, by_user) == pytest.approx(outwards(7.0, by_default), rel=1e-6)
    limit = manchester.FRICTION * manchester.LOAD
    assert abs(outwards(7.0, by_default) - exact[7.0].outwards) < FORCE_BAND * limit
    assert abs(outwards(7.0, others) - exact[7.0].outwards) > 2 * FORCE_BAND * limit
    assert abs(outwards(3.0, by_default) - outwards(3.0, others)) > 1e-3 * limit


def test_wheelset_stands_on_its_treads_beyond_the_flanges_contact_too() -> None:
    stand = stand_on_treads(thesis_pair(), 9.7e-3)
    assert stand.position[0] > -15e-3
    mirrored = stand_on_treads(thesis_pair(), -9.7e-3)
    assert mirrored.roll == pytest.approx(-stand.roll, abs=1e-6)
    assert mirrored.height == pytest.approx(stand.height, abs=1e-7)


def test_depth_that_is_not_there_is_refused_in_a_sentence() -> None:
    with pytest.raises(ValueError, match=f"no contact model 7; give one of 1: {DEPTHS[1][:8]}"):
        Contact(7)


@pytest.mark.parametrize(
    ("depth", "laws"), [(1, {"flange_law": polach}), (3, {"flange_law": polach}), (3, {"creep_law": kalker_linear})]
)
def test_law_that_the_depth_would_not_use_is_refused(depth: int, laws: dict[str, CreepLaw]) -> None:
    with pytest.raises(ValueError, match=f"Contact model {depth} does not use a {next(iter(laws))}; leave it out"):
        Contact(depth, **laws)


def bogie_on(depth: int) -> System:
    """Return the equations of the bogie of chapter 5 with patch contact and the integrals of its powers."""
    return spatial_vehicle(two_axle_bogie(), irregular_track(section_5_3()), Contact(depth)).with_integrals(POWERS)


@pytest.fixture(scope="module", params=[2, 3])
def depth(request: pytest.FixtureRequest) -> int:
    """Contact model: 2 (ellipses) or 3 (strips)."""
    return int(request.param)


@pytest.fixture(scope="module")
def patched(depth: int) -> Library:
    """The bogie of chapter 5 with this contact model, its energies and powers."""
    return quick_library(model_of(bogie_on(depth).with_outputs(ENERGIES), 1e-7))


@pytest.fixture(scope="module")
def rigid() -> Library:
    """The bogie of chapter 5 with one rigid contact per wheel."""
    return quick_library(model_of(spatial_vehicle(two_axle_bogie(), irregular_track(section_5_3())), 1e-7))


@pytest.mark.study
def test_wheelset_at_rest_stands_still_with_its_weight_on_the_rails(patched: Library, depth: int) -> None:
    """It starts at the static approach of Hertz' ellipse, which suits strips within their error, and comes to rest."""
    kernel = Kernel(patched, initial_speed=10.0)
    kernel.initialise()
    for band in ({2: AT_REST, 3: STRIP_ERROR}[depth], AT_REST, AT_REST):
        loads = [kernel[f"wheel_load_{n}_{side}"] for n in (1, 2) for side in ("left", "right")]
        assert loads == pytest.approx([STATIC_LOAD] * 4, rel=band)
        kernel.advance(0.5)


@pytest.mark.study
def test_wave_on_the_treads_is_that_of_the_rigid_contact(patched: Library, rigid: Library) -> None:
    values = {"lateral_irregularity": 5e-3, "tolerance": 1e-7}
    peaks = []
    for library in (patched, rigid):
        kernel = Kernel(library, **values)
        peak = 0.0
        for _ in range(40):
            kernel.advance(0.05)
            peak = max(peak, abs(kernel["lateral_1"]))
        peaks.append(peak)
    assert peaks[0] == pytest.approx(peaks[1], rel=DEPTH_BAND)
    assert peaks[1] > 2e-3


@pytest.mark.study
@pytest.mark.parametrize("yaw_torque", [20e3, 43.92e3])
def test_energy_closes_through_tread_and_flange_contact(patched: Library, yaw_torque: float) -> None:
    kernel = Kernel(patched, tolerance=1e-7)
    kernel.advance(0.01)

    def energy() -> float:
        return sum(kernel[name] for name in ENERGIES) + sum(kernel[f"integral_{name}"] for name in POWERS)

    before = energy()
    kernel.set(brake_torque_1=20e3, brake_torque_2=20e3, yaw_torque_1=yaw_torque)
    pushed = 0.0
    for _ in range(20):
        kernel.advance(0.1)
        pushed = max(pushed, abs(kernel["flange_force_1"]))
    assert pushed > 5e3
    assert energy() == pytest.approx(before, rel=ENERGY_BAND)
    assert kernel["integral_brake_power"] > 1e3 * ENERGY_BAND * before


@pytest.mark.study
def test_mirrored_scene_on_patches_gives_the_mirrored_answer(patched: Library, depth: int) -> None:
    """Strips start and stop touching, which makes kinks in their forces: a tolerance of 1e-9 would need tiny steps."""
    found = []
    for sign in (1.0, -1.0):
        kernel = Kernel(patched, tolerance={2: 1e-9, 3: 1e-7}[depth])
        kernel.set(brake_torque_1=20e3, brake_torque_2=20e3, yaw_torque_1=sign * 43.92e3)
        kernel.advance(1.0)
        loads = [kernel[f"wheel_load_1_{side}"] for side in ("left", "right")]
        found.append([sign * kernel["lateral_1"], sign * kernel["flange_force_1"], *loads[:: int(sign)]])
    assert found[0] == pytest.approx(found[1], rel={2: 1e-6, 3: 1e-3}[depth])
    assert abs(found[0][1]) > 1e4


@pytest.mark.study
def test_jacobian_of_patches_is_that_of_differences_in_tread_and_flange_contact(patched: Library, depth: int) -> None:
    """At 9.6 mm both treads and a flange bear. Compare with differences along random directions of the states."""
    kernel = Kernel(patched, tolerance=1e-7)
    kernel.set(brake_torque_1=20e3, brake_torque_2=20e3, yaw_torque_1=43.92e3)
    kernel.advance(2.0)
    assert abs(kernel["flange_force_1"]) > 1e4
    state = np.array(kernel.linearise().state)
    jacobian = np.array(kernel.jacobian_at(kernel.time, state))
    random = np.random.default_rng(1)
    nominal = np.array([one.nominal for one in bogie_on(depth).states.values()])
    for _ in range(5):
        direction = random.uniform(-1, 1, state.size) * nominal * 1e-6
        forward, backward = (np.array(kernel.slopes_at(kernel.time, state + sign * direction)) for sign in (1, -1))
        along = jacobian @ direction
        assert np.abs((forward - backward) / 2 - along).max() < SLOPE_BANDS[depth] * np.abs(along).max()


@pytest.mark.study
@pytest.mark.parametrize("asked", [0.0, 1.0])
def test_limits_of_en_14363_are_told_where_they_are_asked_for(patched: Library, asked: float) -> None:
    """A yaw torque drives wheelset 1 against its rail: the impact exceeds 0.8 and 10 kN + P0 / 3."""
    kernel = Kernel(patched, running_safety_warnings=asked, yaw_torque_1=100e3, brake_torque_1=20e3)
    kernel.advance(0.5)
    told = [sentence for sentence in kernel.messages if sentence.startswith("EN 14363")]
    left, right = kernel["lateral_force_1_left"], kernel["lateral_force_1_right"]
    assert kernel["guiding_force_1"] == pytest.approx(right - left)
    assert kernel["derailment_quotient_1_left"] == pytest.approx(left / kernel["wheel_load_1_left"])
    assert len(told) == 2 * asked, kernel.messages


def test_climb_is_told_as_it_begins_at_5_mm_and_at_its_end() -> None:
    """Check the wheel rise at the time of each message, within its change in one interval. The root of the flange
    raises the wheel by less than 1 mm.
    """
    climb = push(climbing_wheelset(math.radians(70.3), Contact(2)), 0.3, 0.035)
    said = [line for line in climb.messages if "left wheel of wheelset 1" in line]
    asked = ("left its tread and climbed on its flange at", "had risen by 5 mm on its flange at")
    risen = []
    for words, sentence in zip((*asked, "Derailed: .* climbed over its flange at"), said, strict=True):
        found = re.search(rf"{words} (\d+\.\d+) s", sentence)
        assert found
        times = INTERVAL * np.arange(1, climb.wheel_rise.size + 1)
        risen.append(np.interp(float(found[1]), times, climb.wheel_rise))
    near = float(np.abs(np.diff(climb.wheel_rise)).max())
    assert near < 1e-3
    assert 0.0 < risen[0] < 1e-3
    assert risen[1] == pytest.approx(5e-3, abs=near)
    assert risen[2] > 7e-3


def slid(library: Library, weak: str) -> tuple[np.ndarray, np.ndarray]:
    """Slide locked wheels for 2 s on rails of friction 0.1, and half of that on the side `weak`.

    Return the rail force of each wheelset over the friction force of its wheel loads, and the lateral displacement and
    yaw of the leading one.
    """
    factors = {"left": 1.0, "right": 1.0, weak: 0.5}
    less = {f"{side}_rail_friction": factor for side, factor in factors.items()}
    kernel = Kernel(library, tolerance=1e-7, friction_1=0.1, friction_2=0.1, **less)
    kernel.set(brake_torque_1=40e3, brake_torque_2=40e3)
    kernel.advance(2.0)
    held = []
    for number in (1, 2):
        assert kernel[f"locked_{number}"] == 1
        friction = sum(0.1 * factor * kernel[f"wheel_load_{number}_{side}"] for side, factor in factors.items())
        held.append(-kernel[f"creep_force_{number}"] / friction)
    return np.array(held), np.array([kernel["lateral_1"], kernel["yaw_1"]])


@pytest.mark.study
def test_rails_of_unequal_friction_hold_by_their_own(patched: Library, rigid: Library, depth: int) -> None:
    """At each contact model. The rail with more friction turns the wheelsets; mirrored runs agree."""
    for library in {2: (rigid, patched), 3: (patched,)}[depth]:
        (held, moved), (held_mirrored, moved_mirrored) = slid(library, "left"), slid(library, "right")
        assert np.abs(np.array([held, held_mirrored]) - 1).max() < SLID
        assert moved_mirrored == pytest.approx(-moved, rel=1e-3)
        assert moved[1] < -1e-4  # to the right, whose rail holds more


@pytest.mark.study
def test_wheels_on_the_head_brake_by_its_friction_whatever_the_gauge_face_has(patched: Library) -> None:
    """Locked wheels use the full friction of the rail head: the answers are bit-identical."""
    found = []
    for gauge_face in (1.0, 0.4):
        kernel = Kernel(patched, friction_1=0.1, friction_2=0.1, gauge_face_friction=gauge_face)
        kernel.set(brake_torque_1=40e3, brake_torque_2=40e3)
        kernel.advance(1.0)
        load = sum(kernel[f"wheel_load_1_{side}"] for side in ("left", "right"))
        found.append((kernel["locked_1"], kernel["creep_force_1"] / load))
    assert found[0] == found[1]
    assert found[0][0] == 1
    assert -found[0][1] == pytest.approx(0.1, rel=SLID)


@lru_cache
def unequal(mirrored: bool, depth: int) -> Library:
    """A wheelset in a frame with a wheel of 850 mm and one of 852 mm, and S1002 on one side."""
    thesis, european = thesis_pair().left, european_pair().left
    other = replace(thesis, wheel=european.wheel, rail=european.rail, radius=thesis.radius + 1e-3)
    distances = {"wheel_half_distance": european.wheel_half_distance, "rail_half_distance": european.rail_half_distance}
    sides = Sides(thesis, replace(other, **distances))
    alone = wheelset_under_frame()
    radius = ("wheel_radius", as_sum("wheel_radius") + 1e-3)
    first = replace(alone.wheelsets[0], pair=sides, radius=radius)
    if mirrored:
        first = replace(first, pair=sides.mirrored, radius=radius[::-1])
    vehicle = replace(alone, wheelsets=(first,))
    return quick_library(model_of(spatial_vehicle(vehicle, irregular_track(section_5_3()), Contact(depth)), 1e-7))


@pytest.mark.study
@pytest.mark.parametrize("depth", [2, 3])
def test_wheelset_with_unequal_sides_steers_to_the_smaller_wheel_and_its_mirror_image_the_other_way(depth: int) -> None:
    found = []
    for sign, mirrored in ((1.0, False), (-1.0, True)):
        kernel = Kernel(unequal(mirrored, depth), initial_speed=10.0, tolerance=1e-8)
        kernel.initialise()
        # Both wheels stand on their treads, although the radius of one is larger by 1 mm.
        assert [kernel[f"wheel_rise_1_{side}"] for side in ("left", "right")] == pytest.approx([0.0, 0.0], abs=STANDS)
        kernel.advance(1.0)
        loads = [kernel[f"wheel_load_1_{side}"] for side in ("left", "right")]
        found.append([sign * kernel["lateral_1"], sign * kernel["yaw_1"], *loads[:: int(sign)], kernel["speed"]])
    assert found[0] == pytest.approx(found[1], rel=1e-5)
    # The larger wheel on the right turns the wheelset to the left, towards the smaller one.
    assert found[0][0] > 1e-3


def test_one_rigid_contact_refuses_unequal_sides_in_a_sentence() -> None:
    bogie = two_axle_bogie()
    sides = Sides(thesis_pair().left, european_pair().left)
    vehicle = replace(bogie, wheelsets=(replace(bogie.wheelsets[0], pair=sides), bogie.wheelsets[1]))
    with pytest.raises(ValueError, match="give a Pair, or take contact model 2 or 3, where each side has its own"):
        spatial_vehicle(vehicle, irregular_track(section_5_3()), Contact(1))

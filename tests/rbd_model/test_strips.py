"""Test contact by strips against Hertz, elements, Kalker's exact theory and the Manchester contact benchmark."""

from __future__ import annotations

import csv
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rbd_model.contact import normal
from rbd_model.contact.creep.kalker import column
from rbd_model.contact.distance import LEFT, RIGHT, Stand, Strips, areas, stand_of, strips_at, touching
from rbd_model.contact.geometry import Pair, contact_at
from rbd_model.contact.normal import ContactArea, Steel, ellipses, patches
from rbd_model.contact.profiles import from_points
from rbd_model.contact.strip_creep import AXIS_RATIOS, C_OF_ELLIPSES, Creepages, c_of_ellipse, creep_forces
from rbd_model.contact.strips import Pressed, creepages_of, motion_of, place_of, pressed, rolling, total, under_load
from scenarios.bench.wheel_on_strips import press_wheel
from scenarios.contact import contact_manchester as manchester
from scenarios.thesis.creep_forces import EXACT, FRICTION, LOAD, SEMI_AXES, SHEAR_MODULUS
from tests.rolling_half_space import Grid, grid_of, pressure, rolling_forces, tractions

STEEL = Steel(82e9, 0.28)
#: Places, angles and creepages of both wheels of the Manchester contact benchmark.
CREEPAGES = Path(__file__).parents[1] / "data" / "manchester_creepages.csv"
#: Error of 24 strips across the overlap against closed forms, measured up to 1.2 %: the edge is inside a strip.
STRIP_ERROR = 0.02
#: Errors against elements: measured up to 1.5 % in load and, for a patch with a shoulder, 0.14 mm in position.
ELEMENT_ERROR, ELEMENT_PLACE = 0.025, 0.2e-3
#: FASTSIM on an ellipse against CONTACT [% of mu N], largest and mean: measured 6.0 and 1.8, without strong spin 2.7.
FASTSIM_ERROR, FASTSIM_MEAN, FASTSIM_CREEP = 6.5, 2.0, 3.0


def crowned(rail_radius: float, wheel_radius: float = 0.5) -> Pair:
    """Return a cylinder on a crown: constant curvatures."""
    y = np.arange(-0.03, 0.03, 0.02e-3)
    wheel = from_points("cylinder", "0", y, 0.0 * y)
    return Pair(wheel, from_points("crown", "arc", y, np.sqrt(rail_radius**2 - y**2) - rail_radius), wheel_radius, 1, 1)


@pytest.mark.parametrize("rail_radius", [0.1, 0.3, 0.5, 2.0])
def test_crowned_bodies_press_as_hertz_says(rail_radius: float) -> None:
    """Load, largest pressure and semi-axes of Johnson (1985), section 4.2, at an approach of 30 um."""
    pair, approach = crowned(rail_radius), 30e-6
    along, across = 1 / (2 * 0.5), 1 / (2 * rail_radius)
    table = ellipses()
    ratio, alpha, kappa = (
        math.exp(np.interp(math.log(across / along), table.curvature_ratio, row))
        for row in (table.axis_ratio, table.alpha, table.kappa)
    )
    a = math.sqrt(approach / (alpha * along))
    top = kappa * along * a * STEEL.plane_modulus
    (patch,) = patches(pair, Stand(0.0, 0.5 - approach, 0.0, 0.0), STEEL)
    assert patch.load == pytest.approx(2 / 3 * math.pi * top * a * a / ratio, rel=STRIP_ERROR)
    assert np.max(patch.pressure) == pytest.approx(top, rel=STRIP_ERROR)
    assert np.max(patch.half_length) == pytest.approx(a, rel=STRIP_ERROR)
    assert patch.centre(patch.strips.on_rail) == pytest.approx(0.0, abs=1e-6)
    # An approach that is a twentieth larger is out of tolerance.
    (more,) = patches(pair, Stand(0.0, 0.5 - 1.05 * approach, 0.0, 0.0), STEEL)
    assert more.load != pytest.approx(patch.load, rel=STRIP_ERROR)


def test_table_of_ellipses_is_round_where_the_curvatures_are_equal() -> None:
    """A sphere: approach a^2 / R, which is 2 A a^2, p = 2 E* a / (pi R), 4 / pi A a E*; Johnson (1985), section 4.2."""
    table = ellipses()
    found = [math.exp(np.interp(0.0, table.axis_ratio, row)) for row in (table.alpha, table.kappa)]
    assert found == pytest.approx([2.0, 4 / math.pi], rel=1e-5)


#: Number of elements of the exact theory.
ELEMENTS = (64, 128)


def held(name: str, shift: float, load: float = 10e3) -> tuple[Stand, list[Pressed]]:
    """Return a wheel of the benchmark under its load."""
    stand, motion = manchester.case(name, shift)
    return under_load(manchester.manchester_pair(), stand, STEEL, 0.3, lambda s: creepages_of(s, motion), load)


@pytest.mark.parametrize(("shift", "patch_count"), [(0.0, 1), (0.5, 1), (2.0, 1), (5.0, 2), (6.0, 1), (8.0, 1)])
def test_load_and_place_are_those_of_elements(shift: float, patch_count: int) -> None:
    """At 0.5 mm the patch has a long shoulder. At 5 mm there are two patches, each of which deforms the surface under
    the other.
    """
    pair = manchester.manchester_pair()
    stand, contacts = held("right", shift)
    overlapping = areas(pair, stand)
    length = 3 * max(float(np.max(contact.patch.half_length)) for contact in contacts)
    grid = grid_of(pair, stand, (overlapping[0][0] - 1e-3, overlapping[-1][1] + 1e-3), length, ELEMENTS)
    loads, on_rail = np.sum(pressure(grid, STEEL), axis=0) * grid.area, grid.strips.on_rail
    ours = sum(contact.patch.load for contact in contacts)
    place = sum(contact.patch.load * contact.patch.centre(contact.patch.strips.on_rail) for contact in contacts) / ours
    assert len(contacts) == patch_count
    assert ours == pytest.approx(np.sum(loads), rel=ELEMENT_ERROR)
    assert place == pytest.approx(on_rail @ loads / np.sum(loads), abs=ELEMENT_PLACE)


def test_patches_that_feel_each_other_carry_less_and_the_smaller_one_loses_most() -> None:
    """The sum is the load of the wheel."""
    pair = manchester.manchester_pair()
    stand, contacts = held("right", 5.0)
    together, alone = patches(pair, stand, STEEL), patches(pair, stand, STEEL, apart=True)
    flange_side, tread_side = (one.load / other.load for one, other in zip(together, alone, strict=True))
    assert 0.5 < tread_side < 0.9 < flange_side < 1.0
    assert total(contacts)[2] == pytest.approx(10e3, rel=1e-4)


@pytest.mark.parametrize("shift", [0.0, 0.5, 3.0, 5.0, 8.0])
def test_a_wheel_that_is_lower_is_pressed_harder(shift: float) -> None:
    pair = manchester.manchester_pair()
    stand, _ = manchester.case("right", shift)
    top, _ = touching(pair, stand)
    depths = np.arange(1e-6, 90e-6, 4e-6)
    loads = [sum(p.load for p in patches(pair, replace(stand, height=top - d), STEEL)) for d in depths]
    assert np.all(np.diff([0.0, *loads]) > 0.0)


def test_everything_is_a_number_from_12_mm_to_the_left_to_12_mm_to_the_right() -> None:
    pair = manchester.manchester_pair()
    for shift in np.arange(-12.0, 12.1, 1.5) / 1e3:
        stand = stand_of(RIGHT, shift, 0.0, 0.002, 0.02)
        motion = rolling(stand, 2.0, 4.35)
        low = replace(stand, height=touching(pair, stand)[0] - 60e-6)
        contacts = pressed(pair, low, STEEL, 0.3, lambda s, m=motion: creepages_of(s, m))
        assert contacts
        assert np.all(np.isfinite(total(contacts)))
        assert all(np.all(np.isfinite(contact.creep)) for contact in contacts)


def test_wheel_that_hangs_over_its_rail_is_not_pressed() -> None:
    stand, motion = manchester.case("right", 3.0)
    pair = manchester.manchester_pair()
    lifted = replace(stand, height=touching(pair, stand)[0] + 1e-6)
    assert total(pressed(pair, lifted, STEEL, 0.3, lambda s: creepages_of(s, motion))).tolist() == [0.0, 0.0, 0.0]


def test_wheel_that_leaves_its_rail_at_an_end_of_its_contour_is_refused() -> None:
    with pytest.raises(ValueError, match="touches at an end of its contour only"):
        touching(manchester.manchester_pair(), stand_of(RIGHT, 0.0, 0.0, 0.9, 0.0))


def test_yaw_to_the_other_side_moves_the_contact_as_far_behind_the_axle() -> None:
    pair = manchester.manchester_pair()
    found = []
    for yaw in (0.02, -0.02):
        stand = stand_of(LEFT, 2e-3, 0.0, 0.001, yaw)
        (patch,) = patches(pair, replace(stand, height=touching(pair, stand)[0] - 30e-6), STEEL)
        found.append((patch.load, patch.centre(patch.strips.on_rail), -patch.centre(patch.strips.arm[0])))
    assert found[0][:2] == pytest.approx(found[1][:2], rel=1e-9)
    assert found[0][2] == pytest.approx(-found[1][2], rel=1e-9)
    assert abs(found[0][2]) > 0.4e-3


def test_both_wheels_are_mirror_images() -> None:
    """For a wheelset mirrored left to right the other wheel has the same forces, in track axes with y reversed."""
    pair = manchester.manchester_pair()
    forces = []
    for side, mirror in ((LEFT, 1), (RIGHT, -1)):
        stand = stand_of(side, mirror * 3e-3, 0.0, mirror * 0.001, mirror * 0.01)
        motion = motion_of(side, (2.0, mirror * 0.003, 0.0), (mirror * 0.01, 4.35, mirror * 0.02))
        low = replace(stand, height=touching(pair, stand)[0] - 30e-6)
        forces.append(total(pressed(pair, low, STEEL, 0.3, lambda s, m=motion: creepages_of(s, m))))
    assert forces[0] == pytest.approx(forces[1], rel=1e-12)


def test_without_yaw_a_light_wheel_touches_where_rigid_profiles_do() -> None:
    """Compare position on the wheel (within its parabola) and angle with the search of section 4.3, without yaw."""
    pair = manchester.manchester_pair()
    for shift in (2e-3, 4e-3):
        rigid = contact_at(pair, shift)
        _, on_wheel = touching(pair, stand_of(LEFT, shift, 0.0, rigid.roll, 0.0))
        strip = strips_at(pair, stand_of(LEFT, shift, 0.0, rigid.roll, 0.0), np.array([on_wheel]))
        assert on_wheel == pytest.approx(rigid.position[0], abs=5e-6)
        assert float(strip.angle[0]) == pytest.approx(rigid.angle[0], abs=1e-4)


@pytest.mark.parametrize("name", ["left", "right"])
def test_creepages_of_the_benchmark_follow_from_its_motion(name: str) -> None:
    """Evaluated at its own positions and angles. The benchmark divides by another speed, up to 2 % from that of the
    axle.

    Near 0 the longitudinal creepage is a difference of speeds; a displacement of 0.01 mm changes it by 2e-6.
    """
    pair = manchester.manchester_pair()
    outwards = -manchester.SIDES[name]
    heads = ("y_ws_mm", "y_wheel_mm", "angle_rad", "creep_x", "creep_y", "spin_1_per_mm")
    with CREEPAGES.open(encoding="utf-8") as text:
        rows = [row for row in csv.DictReader(line for line in text if line[0] != "#") if row["wheel"] == name]
    assert len(rows) >= 11
    for shift, on_wheel, angle, ahead, aside, spin in ([float(row[head]) for head in heads] for row in rows):
        stand, motion = manchester.case(name, float(shift))
        strip = strips_at(pair, stand, np.array([outwards * on_wheel / 1e3]))
        found = creepages_of(replace(strip, angle=np.array([-outwards * angle])), motion)
        given = (-ahead, -outwards * aside, -outwards * 1e3 * spin)
        assert found.ahead[0] == pytest.approx(given[0], rel=0.02, abs=2e-6)
        assert found.aside[0] == pytest.approx(given[1], rel=0.02, abs=1e-5)
        assert found.spin[0] == pytest.approx(given[2], rel=0.02)


def test_place_of_the_exact_theory_lies_between_its_two_patches() -> None:
    _, contacts = held("right", 5.0)
    place, (flange_side, tread_side) = place_of(contacts), (c.patch.centre(c.patch.strips.on_rail) for c in contacts)
    assert flange_side < place.on_rail < tread_side
    assert place.on_rail == pytest.approx(manchester.exact("right")[5.0].place, abs=0.2e-3)


def ellipse(semi_axes: tuple[float, float], load: float, count: int = 40) -> ContactArea:
    """Return a level Hertzian ellipse in strips."""
    a, b = semi_axes
    y = b * ((np.arange(count) + 0.5) / count * 2 - 1)
    zero, half_length = 0.0 * y, a * np.sqrt(1 - (y / b) ** 2)
    strips = Strips(y, y, np.array([zero, y, zero]), zero, zero, zero + 1.0, zero + 1.0)
    pressure = 1.5 * load / (math.pi * a * b) * half_length / a
    return ContactArea(strips, zero + 2 * b / count, half_length, pressure, zero)


def creep_of(creepages: tuple[float, float, float], patch: ContactArea, nu: float = 0.25) -> np.ndarray:
    """Return the force for planar creepages: spin makes the longitudinal creepage vary across the patch."""
    x, y, spin = creepages
    given = Creepages(
        x - spin * patch.strips.on_rail, y + 0.0 * patch.strips.on_rail, spin + 0.0 * patch.strips.on_rail
    )
    return np.sum(creep_forces(patch, given, Steel(SHEAR_MODULUS, nu), FRICTION), axis=1)


def test_fastsim_is_near_kalkers_exact_theory_with_and_without_spin() -> None:
    patch = ellipse(SEMI_AXES, LOAD)
    off = np.array([creep_of((x, y, spin), patch) - (fx, fy) for x, y, spin, fx, fy in EXACT])
    distance = 100 * np.hypot(*off.T) / (FRICTION * LOAD)
    assert np.max(distance) < FASTSIM_ERROR
    assert np.mean(distance) < FASTSIM_MEAN
    assert np.max(distance[EXACT[:, 2] < 0.2]) < FASTSIM_CREEP


@pytest.mark.parametrize(
    ("semi_axes", "row", "nu"),
    [((5e-3, 5e-3), 9, 0.25), ((6e-3, 3e-3), 14, 0.25), ((3e-3, 6e-3), 4, 0.25), ((3e-3, 6e-3), 4, 0.28)],
)
def test_small_creepages_give_kalkers_linear_theory(semi_axes: tuple[float, float], row: int, nu: float) -> None:
    """To 1 %: the table's three digits, and the cells."""
    patch, small = ellipse(semi_axes, LOAD, 200), 1e-7
    a, b = semi_axes
    scale = SHEAR_MODULUS * a * b
    size = math.sqrt(a * b)
    c11, c22, c23 = (column(name, nu)[row] for name in ("c11", "c22", "c23"))
    forces = [creep_of(one, patch, nu) for one in small * np.eye(3)]
    assert forces[0][0] == pytest.approx(-scale * c11 * small, rel=0.01)
    assert forces[1][1] == pytest.approx(-scale * c22 * small, rel=0.01)
    assert forces[2][1] == pytest.approx(-scale * size * c23 * small, rel=0.03)


def test_what_slides_as_a_whole_is_held_by_friction_against_the_sliding() -> None:
    force = creep_of((0.04, 0.03, 0.0), ellipse(SEMI_AXES, LOAD))
    assert np.hypot(*force) == pytest.approx(FRICTION * LOAD, rel=2e-3)
    assert math.degrees(math.atan2(-force[1], -force[0])) == pytest.approx(math.degrees(math.atan2(3, 4)), abs=1.0)


def test_rail_of_the_benchmark_is_its_contour_and_stands_on_its_gauge() -> None:
    contour = np.loadtxt(
        Path(__file__).parents[1] / "data" / "contact" / "rail_60e1_contour.csv", delimiter=",", skiprows=1
    )
    rail = manchester.manchester_pair().rail
    head = (contour[:, 0] > -42.9) & (contour[:, 0] < 28.0) & (contour[:, 1] > -14.5)
    assert np.abs(rail.height(contour[head, 0] / 1e3) - contour[head, 1] / 1e3).max() < 2e-6
    gauge_side = contour[contour[:, 0] < -20.0]
    face = np.interp(-14.0, gauge_side[:, 1], gauge_side[:, 0]) / 1e3
    assert face == pytest.approx(manchester.GAUGE_FACE, abs=1e-7)


#: Error of the exact theory by elements against CONTACT on an ellipse [% of mu N]. Measured 5.4 with 12 x 12 of them
#: and 2.7 with 20 x 20, because the displacement is taken over a whole element. On the patch at 0.5 mm 64 x 96 elements
#: are within 0.4 of 24 x 40.
ELEMENT_CREEP, COARSE, FINE, ROLLING_ELEMENTS = 4.0, 12, 20, (24, 40)
#: Errors of the creep force of a patch with a shoulder [% of mu N]: one equivalent ellipse had up to 21; the limit is
#: that of the whole benchmark, measured up to 4.8. Difference of 24 strips from 96: measured up to 0.6.
SHOULDER_ERROR, LIMIT_ERROR = manchester.FORCE_BAND, 1.0


def rolling_ellipse(count: int, rows: np.ndarray) -> np.ndarray:
    """Return the largest distance of exact theory by count x count elements from rows of CONTACT [% of mu N]."""
    steel, off = Steel(SHEAR_MODULUS, 0.25), []
    size = tuple(2 * axis / count for axis in SEMI_AXES)
    places = np.array(np.meshgrid(np.arange(count), np.arange(count))).reshape(2, -1)
    x, y = ((places[i] + 0.5) * size[i] - SEMI_AXES[i] for i in range(2))
    inside = 1 - (x / SEMI_AXES[0]) ** 2 - (y / SEMI_AXES[1]) ** 2
    touch = inside > 0.0
    limit = np.sqrt(inside[touch])
    limit *= FRICTION * LOAD / (np.sum(limit) * size[0] * size[1])
    for ahead, aside, spin, *force in rows:
        rigid = np.array([ahead - spin * y[touch], aside + spin * x[touch]])
        found = np.sum(tractions(places[:, touch], size, limit, rigid, steel), axis=1) * size[0] * size[1]
        off.append(100 * math.hypot(*(found - force)) / (FRICTION * LOAD))
    return np.max(off)


def test_elements_roll_as_kalkers_program_says_and_more_of_them_are_nearer() -> None:
    coarse, fine = (rolling_ellipse(count, EXACT[::15]) for count in (COARSE, FINE))
    assert fine < ELEMENT_CREEP < coarse


def elements_on(stand: Stand, contacts: list[Pressed]) -> tuple[Grid, np.ndarray]:
    """Return elements over all patches of a wheel of the benchmark, and their pressure [Pa]."""
    overlapping = areas(manchester.manchester_pair(), stand)
    reach = overlapping[0][0] - 0.2e-3, overlapping[-1][1] + 0.2e-3
    length = 2.3 * max(float(np.max(one.patch.half_length)) for one in contacts)
    grid = grid_of(manchester.manchester_pair(), stand, reach, length, ROLLING_ELEMENTS)
    return grid, pressure(grid, STEEL)


def creep_of_elements(stand: Stand, contacts: list[Pressed], motion: manchester.Motion) -> np.ndarray:
    """Return the creep force on the benchmark's right wheel, ahead, outwards and up, over its friction times load."""
    grid, found = elements_on(stand, contacts)
    ahead, aside = rolling_forces(grid, found, creepages_of(grid.strips, motion), STEEL, manchester.FRICTION)
    return in_track(grid.strips.angle, ahead, aside) / (manchester.FRICTION * np.sum(found) * grid.area)


def in_track(angle: np.ndarray, ahead: np.ndarray, aside: np.ndarray) -> np.ndarray:
    """Return the sum of creep forces, ahead, outwards and up."""
    return np.array([np.sum(ahead), np.cos(angle) @ aside, np.sin(angle) @ aside])


def creep_by_strips(stand: Stand, motion: manchester.Motion) -> np.ndarray:
    """Return the same as `creep_of_elements`, by the study tool."""
    pair = manchester.manchester_pair()
    contacts = pressed(pair, stand, STEEL, manchester.FRICTION, lambda s: creepages_of(s, motion))
    creep = sum(in_track(one.patch.strips.angle, *one.creep) for one in contacts)
    return np.asarray(creep) / (manchester.FRICTION * sum(one.patch.load for one in contacts))


def creep_of_level(stand: Stand, motion: manchester.Motion) -> np.ndarray:
    """Return the same as `creep_of_elements`, by contact model 3."""
    pair = manchester.manchester_pair()
    sliding, smooth = (press_wheel(pair, STEEL, mu, stand, motion).force for mu in (manchester.FRICTION, 0.0))
    return np.asarray(sliding - smooth) / (manchester.FRICTION * float(np.hypot(*smooth[1:])))


@pytest.mark.study
@pytest.mark.parametrize("shift", [0.25, 0.5, 0.75])
def test_patch_with_a_shoulder_creeps_as_elements_do(shift: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """The patch is up to 16 mm wide, three quarters of it flat; compare several numbers of strips, which converge."""
    stand, contacts = held("right", shift)
    _, motion = manchester.case("right", shift)
    exact = creep_of_elements(stand, contacts, motion)
    found = {0: creep_of_level(stand, motion)}
    for count in (8, 24, 96):
        monkeypatch.setattr(normal, "STRIPS", count)
        found[count] = creep_by_strips(stand, motion)
    for count, creep in found.items():
        assert 100 * math.hypot(*(creep - exact)) < SHOULDER_ERROR, count
    assert 100 * math.hypot(*(found[24] - found[96])) < LIMIT_ERROR


#: Tolerances, of friction times load: elements in one plane against the benchmark, measured up to 1.6 %. Model 3
#: against elements with the slip and the normal of each place, measured up to 0.9 %. APART: least difference of the two
#: kinds of elements, measured 4.0 and 3.3 %.
PLANE_ERROR, PLACE_ERROR, APART = 0.02, 0.0125, 0.03


@pytest.mark.study
@pytest.mark.parametrize("shift", [0.0, 5.0])
def test_what_depth_3_misses_most_of_the_benchmark_is_that_it_puts_contact_in_one_plane(shift: float) -> None:
    """A patch 16 mm wide, and two patches 0.16 rad apart. In one plane the slip is linear about one place, with one
    normal.
    """
    stand, contacts = held("right", shift)
    _, motion = manchester.case("right", shift)
    grid, found = elements_on(stand, contacts)
    loads, own = np.sum(found, axis=0) * grid.area, creepages_of(grid.strips, motion)
    y = grid.size[1] * (np.arange(grid.count[1]) - np.argmin(np.abs(grid.strips.on_rail - place_of(contacts).on_rail)))
    middle = np.argmin(np.abs(y))
    plane = Creepages(own.ahead[middle] - own.spin[middle] * y, *(0 * y + one[middle] for one in (own.aside, own.spin)))

    def forces(creepages: Creepages, angle: np.ndarray) -> np.ndarray:
        """Return the force on the wheel, ahead and outwards, over friction times load of the wheel."""
        ahead, aside = rolling_forces(grid, found, creepages, STEEL, manchester.FRICTION)
        outwards = np.sum(np.cos(angle) * aside - np.sin(angle) * loads)
        return np.array([np.sum(ahead), outwards]) / (manchester.FRICTION * manchester.LOAD)

    truth, level = manchester.exact("right")[shift], manchester.depth_3(stand, motion)
    benchmark, ours = (
        -np.array([one.ahead, one.outwards]) / (manchester.FRICTION * manchester.LOAD) for one in (truth, level)
    )
    each, flat = forces(own, grid.strips.angle), forces(plane, np.full_like(y, place_of(contacts).angle))
    assert np.linalg.norm(flat - benchmark) < PLANE_ERROR
    assert np.linalg.norm(each - ours) < PLACE_ERROR
    assert np.linalg.norm(each - flat) > APART


def test_the_ellipses_of_kalkers_table_are_those_that_strips_make() -> None:
    made = [c_of_ellipse(float(ratio)) for ratio in AXIS_RATIOS[::6]]
    assert made == pytest.approx(C_OF_ELLIPSES[::6], rel=1e-11, abs=0.0)  # all digits of the stored values

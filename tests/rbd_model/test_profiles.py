"""Test profiles and their contact: smoothness, sources, closed forms and the EN 15302 reference."""

from __future__ import annotations

import itertools
import math
import re
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest

from rbd_model.contact.geometry import (
    STANDARD_GAUGE,
    ContactAtShift,
    Guidance,
    Pair,
    Side,
    Sides,
    centred_shift,
    contact_at,
    equivalent_conicity,
    european_pair,
    flange_contact_shift,
    flange_of,
    gauge_face,
    last_tread_contact,
    rolling_radius_difference,
    thesis_pair,
)
from rbd_model.contact.measured import read_profile
from rbd_model.contact.profiles import (
    INCLINATION,
    JOINTS_60KG,
    Profile,
    from_points,
    inclined,
    rail_60e1,
    rail_60kg,
    rail_head,
    wheel_cone_120,
    wheel_s1002,
)
from rbd_model.vehicle.ready import wheelset_under_frame

#: Data from published sources; README.md there names them.
REFERENCE = Path(__file__).parents[1] / "data" / "contact"
#: Digits and sampling error of the published contour of 60E1 [m].
CONTOUR_ERROR = 0.01e-3


def test_crown_of_the_rail_has_its_radius_and_the_slope_of_the_cone() -> None:
    rail = rail_60kg()
    assert rail.height(np.array([0.0]), 1)[0] == pytest.approx(1 / 20, rel=1e-5)
    curvature = rail.height(np.array([0.0]), 2)[0] / (1 + (1 / 20) ** 2) ** 1.5
    assert curvature == pytest.approx(-1 / 0.3, rel=1e-4)


def test_synthetic_wheel_is_a_cone_on_its_tread_and_70_degrees_on_its_flange() -> None:
    wheel = wheel_cone_120()
    assert wheel.height(np.linspace(-0.009, 0.050, 50), 1) == pytest.approx(1 / 20, abs=1e-5)
    assert math.degrees(math.atan(wheel.height(np.array([wheel.limits[0] + 2e-3]), 1)[0])) == pytest.approx(
        70.3, abs=0.2
    )


@pytest.mark.parametrize("profile", [wheel_cone_120(), rail_60kg(), wheel_s1002()], ids=lambda p: p.name)
def test_third_derivative_is_continuous(profile: Profile) -> None:
    """Eq. (3.72) requires it; across a knot its change is explained by its own slope."""
    knots = np.unique(profile.spline.t)[1:-1]
    jump = profile.height(knots + 1e-12, 3) - profile.height(knots - 1e-12, 3)
    assert np.abs(jump).max() < 1e-4 * np.abs(profile.height(knots, 3)).max()


def test_pieces_for_the_kernel_are_the_spline() -> None:
    profile = wheel_s1002()
    edges, coefficients = profile.pieces
    assert coefficients.shape == (edges.size - 1, 6)
    for y in np.linspace(*profile.limits, 97)[1:-1]:
        piece = int(np.searchsorted(edges, y, "right")) - 1
        value = np.polyval(coefficients[piece][::-1], y - edges[piece])
        assert value == pytest.approx(float(profile.height(np.array([y]))[0]), abs=1e-15)


def test_s1002_is_the_published_contour() -> None:
    """Within 1 um on the tread; at corners of the flange root the knots round by up to 8 um."""
    points = reference("mbench_s1002.csv") / 1e3
    y, z = -points[:, 0], -points[:, 1]
    deviation = np.abs(wheel_s1002().height(y) - z)
    assert deviation[(y > -0.034) & (y < 0.055)].max() < 1e-6
    assert deviation[(y > -0.047) & (y < 0.055)].max() < 8e-6


def reference(name: str) -> np.ndarray:
    """Return the numbers of a table of reference data, without its first line."""
    return np.loadtxt(REFERENCE / name, delimiter=",", skiprows=1)


@lru_cache
def en_15302_profile(name: str) -> Profile:
    return from_points(name, "EN 15302", *(reference(f"en15302_{name}.csv") / 1e3).T)


def en_15302_side(wheel: str, radius: float = 0.46) -> Side:
    """Return one of the standard's wheels on its rail, tape circles 1500 mm apart."""
    return Side(en_15302_profile(f"RUIC519{wheel}"), en_15302_profile("SUIC519A"), radius, 0.75, 0.75)


def en_15302_pair(wheel: str) -> Pair:
    """Return two of the standard's wheels, r0 = 460 mm."""
    side = en_15302_side(wheel)
    return Pair(side.wheel, side.rail, side.radius, side.wheel_half_distance, side.rail_half_distance)


def en_15302_conicity(case: str) -> np.ndarray:
    """Return columns amplitude [mm], tan(gamma_e), its upper and lower limit, of one case."""
    lines = (REFERENCE / "en15302_conicity.csv").read_text().splitlines()
    return np.array([[float(x) for x in line.split(",")[1:]] for line in lines if line.startswith(case)]).T


@lru_cache
def conicity_of_equal_sides(wheel: str) -> np.ndarray:
    """Return the conicity at the amplitudes of case E1, which are those of all cases."""
    return equivalent_conicity(en_15302_pair(wheel), en_15302_conicity("E1")[0] / 1e3, rolls=False)


@pytest.mark.study
@pytest.mark.parametrize(("wheel", "case"), [("A", "E1"), ("B", "E2"), ("H", "E3"), ("I", "E4")])
def test_equivalent_conicity_is_that_of_en_15302_at_every_amplitude(wheel: str, case: str) -> None:
    """Within the standard's limits, without roll. Up to 1.7 mm the wheels I are not guided (E4)."""
    amplitude, value, upper, lower = en_15302_conicity(case)
    found = conicity_of_equal_sides(wheel)
    assert amplitude == pytest.approx(en_15302_conicity("E1")[0])
    assert amplitude.size == 66
    assert np.all((found <= upper) & (found >= lower))
    assert np.median(np.abs(found - value)) < 0.005
    # Values that are a fifth larger are outside of the limits.
    assert not np.all((1.2 * found <= upper) & (1.2 * found >= lower))


#: Cases of annex E with different sides: wheel and radius [m] of the left and of the right one.
UNEQUAL = {
    "E5": (("A", 0.459), ("A", 0.460)),
    "E6": (("B", 0.459), ("B", 0.460)),
    "E7": (("H", 0.459), ("H", 0.460)),
    "E8": (("I", 0.459), ("I", 0.460)),
    "E9": (("B", 0.460), ("A", 0.460)),
}


@pytest.mark.study
@pytest.mark.parametrize("case", UNEQUAL)
def test_conicity_of_unequal_sides_is_that_of_en_15302_at_every_amplitude(case: str) -> None:
    """Wheels of 918 and 920 mm, or of two profiles, on one axle: within the limits about the shifted centre."""
    amplitude, value, upper, lower = en_15302_conicity(case)
    left, right = UNEQUAL[case]
    found = equivalent_conicity(Sides(en_15302_side(*left), en_15302_side(*right)), amplitude / 1e3, rolls=False)
    assert amplitude.size == 66
    assert np.all((found <= upper) & (found >= lower))
    assert np.median(np.abs(found - value)) < 0.005
    # The same wheels on equal radii, or wheel A alone, are outside of the limits.
    equal = conicity_of_equal_sides(right[0])
    assert not np.all((equal <= upper) & (equal >= lower))


def test_published_radius_difference_of_wheels_of_918_and_920_mm_vanishes_where_ours_does() -> None:
    """Annex E, case E5: Dr is -0.0376 mm at 2.7 mm and 0.0465 mm at 2.6 mm to the side of the smaller wheel."""
    published = 2.6e-3 + 0.1e-3 * 0.046522 / (0.046522 + 0.037631)
    smaller_left = Sides(en_15302_side("A", 0.459), en_15302_side("A", 0.460))
    assert centred_shift(smaller_left, rolls=False) == pytest.approx(published, abs=0.02e-3)


def on_needle(name: str, y: np.ndarray, z: np.ndarray, radius: float = 0.46) -> Side:
    """Return a wheel on an arc of 10 mm, with nearly the same contact at any displacement."""
    needle = from_points("needle", "R10", (u := np.linspace(-9e-3, 9e-3, 900)), np.sqrt(0.01**2 - u**2) - 0.01)
    return Side(from_points(name, "closed form", y, z), needle, radius, 0.75, 0.75)


def cone(slope: float, radius: float = 0.46) -> Side:
    return on_needle("cone", (y := np.linspace(-0.06, 0.06, 600)), slope * y, radius)


@pytest.mark.parametrize(("difference", "rolls"), [(1e-3, False), (-0.4e-3, True)])
def test_cones_of_unequal_radius_run_off_the_middle_with_the_conicity_of_the_cone(
    difference: float, rolls: bool
) -> None:
    """The shift is (dr / 2) / gamma towards the smaller wheel, where 2 gamma y is dr; on equal radii the axle is level.

    There the wave is that of equal cones: gamma (1 + R gamma / b) where it rolls.
    """
    slope = 1 / 20
    pair = Sides(cone(slope, 0.46 - difference / 2), cone(slope, 0.46 + difference / 2))
    assert centred_shift(pair, rolls) == pytest.approx(difference / 2 / slope, rel=2e-4)
    found = equivalent_conicity(pair, np.array([1e-3, 3e-3, 7e-3]), rolls, points=20)
    assert found == pytest.approx(slope * (1 + 0.01 * slope / 0.75 * rolls), rel=2e-4)


def test_cones_of_unequal_slope_and_radius_have_the_mean_conicity_about_the_shift_of_equal_radii() -> None:
    """Dr = (gamma_l + gamma_r) y + dr + R (gamma_l^2 - gamma_r^2): the contact is R gamma from the top of the arc."""
    left, right = 1 / 20, 1 / 40
    for difference in (0.0, 0.5e-3):
        pair = Sides(cone(left), cone(right, 0.46 + difference))
        centre = (difference - 0.01 * (left**2 - right**2)) / (left + right)
        assert centred_shift(pair, rolls=False) == pytest.approx(centre, rel=2e-3)
        found = equivalent_conicity(pair, np.array([1e-3, 7e-3]), rolls=False, points=20)
        assert found == pytest.approx((left + right) / 2, rel=2e-4)


def test_wave_is_made_of_its_two_half_waves() -> None:
    """Dr = 2 g y to the left, 2 h y to the right: half waves of pi sqrt(b r0 / g) and pi sqrt(b r0 / h).

    Both ends have the same S, g y^2 and h y^2, so that the wave extends further to the side of smaller conicity.
    """
    left, right = 1 / 10, 1 / 40
    y = np.linspace(-0.02, 0.02, 401)
    slope = np.where(y > 0.0, left, right)
    along = Guidance(y, y, 2 * slope * y, slope * y**2)
    closed = (0.5 / math.sqrt(left) + 0.5 / math.sqrt(right)) ** -2
    assert closed < 0.8 * (left + right) / 2
    for amplitude in (1e-3, 8e-3):
        # Phases are measured from the middle of the wave, where Dr has no kink; 1e-5 is the error of the midpoint rule.
        assert along.conicity(amplitude) == pytest.approx(closed, rel=1e-5)
        assert along.middle(amplitude) == pytest.approx(-amplitude / 3, rel=1e-9)


#: Tolerance of two searches on a grid, mirror images of each other; parabolas refine it to better than 1 um.
MIRROR = 1e-6


@pytest.mark.parametrize("case", ["E5", "E9"])
def test_wheelset_turned_round_runs_off_the_middle_to_the_other_side_with_the_same_conicity(case: str) -> None:
    pair = Sides(*(en_15302_side(*one) for one in UNEQUAL[case]))
    amplitudes, points = np.array([1e-3, 3e-3, 7e-3]), 30
    assert centred_shift(pair, False) == pytest.approx(-centred_shift(pair.mirrored, False), abs=MIRROR)
    assert abs(centred_shift(pair, False)) > 500 * MIRROR
    found = equivalent_conicity(pair, amplitudes, False, points)
    assert found == pytest.approx(equivalent_conicity(pair.mirrored, amplitudes, False, points), rel=5e-3)
    left, right = contact_at(pair, 2e-3), contact_at(pair.mirrored, -2e-3)
    assert left.radius == pytest.approx(right.radius[::-1], abs=1e-9)
    assert left.roll == pytest.approx(-right.roll, abs=1e-10)


def test_sides_that_are_equal_are_a_pair() -> None:
    pair, side = en_15302_pair("A"), en_15302_side("A")
    amplitudes = np.array([1e-3, 5e-3])
    assert (pair.left, pair.right) == (side, side)
    found = equivalent_conicity(Sides(side, side), amplitudes, False, 40)
    assert found == pytest.approx(equivalent_conicity(pair, amplitudes, False, 40), rel=1e-12)
    # A very small difference of the radii has an effect below the pitch of the search.
    nearly = Sides(en_15302_side("A", 0.46 + 1e-8), side)
    assert equivalent_conicity(nearly, amplitudes, False, 40) == pytest.approx(found, rel=2e-3)


@pytest.mark.study
def test_every_two_of_the_reference_wheels_of_918_and_920_mm_have_a_conicity() -> None:
    """No NaN and no negative conicity, also with wheels I, which are not guided near the middle (E4)."""
    amplitudes = np.linspace(1e-3, 7e-3, 7)
    of_two_radii = [((left, 0.459), (right, 0.460)) for left, right in itertools.product("ABHI", "ABHI")]
    of_one = [((left, 0.460), (right, 0.460)) for left, right in itertools.combinations("ABHI", 2)]
    for left, right in of_two_radii + of_one:
        pair = Sides(en_15302_side(*left), en_15302_side(*right))
        found = equivalent_conicity(pair, amplitudes, rolls=False, points=8)
        assert np.all((found > 0.01) & (found < 1.0)), (left, right)


def test_unequal_hollow_wheels_have_a_conicity_where_the_radius_difference_turns() -> None:
    """Dr = 2 c (y^3 / w^2 - y) + dr: unstable about the zero near the middle, guided beyond sqrt(2) w."""
    slope, turn = 1e-3, 2e-3
    y = np.linspace(-0.04, 0.04, 1600)
    near = np.clip(y, -8e-3, 8e-3)
    hollow = slope * (near**3 / turn**2 - near)
    pair = Sides(on_needle("hollow", y, hollow, 0.46 + 0.2e-6), on_needle("hollow", y, hollow))
    found = equivalent_conicity(pair, np.array([0.5e-3, 1e-3, 2e-3, 3e-3, 5e-3]), rolls=False)
    assert np.all(found[:2] < 0.0)
    assert 0.0 < found[3] < found[4]
    assert np.all(np.isfinite(found))


def test_wheels_that_nowhere_roll_on_equal_radii_are_refused() -> None:
    with pytest.raises(ValueError, match="the wheels nowhere roll on equal radii: they differ by -10 mm there"):
        centred_shift(Sides(cone(1 / 20, 0.45), cone(1 / 20)), rolls=False)


def test_wheel_beside_its_rail_is_refused() -> None:
    with pytest.raises(ValueError, match="a wheel stands beside its rail"):
        contact_at(Pair(cone(1 / 20).wheel, rail_60kg(), 0.46, 0.75, 0.9), 0.0, rolls=False)


def test_conicity_of_a_cone_the_wrong_way_round_is_minus_its_slope() -> None:
    """No motion crosses the centre; the linear fit to Dr is the cone."""
    wheel = from_points("cone", "-1:40", (y := np.linspace(-0.04, 0.04, 400)), -y / 40)
    pair = Pair(wheel, rail_60kg(), 0.425, 0.57, 0.57)
    assert equivalent_conicity(pair, np.array([1e-3, 5e-3]), rolls=False) == pytest.approx(-1 / 40, rel=1e-3)


def test_where_the_radius_difference_turns_near_the_centre_only_wide_waves_cross_it() -> None:
    """Dr = 2 c (y^3 / w^2 - y) is unstable up to w and guides a wave that starts beyond sqrt(2) w.

    Within it, the linear fit to Dr up to a has the slope 2 c (3/5 a^2 / w^2 - 1), a regression over both sides.
    """
    slope, turn = 1e-3, 2e-3
    y = np.linspace(-0.04, 0.04, 1600)
    near = np.clip(y, -8e-3, 8e-3)
    wheel = from_points("hollow", "cubic", y, slope * (near**3 / turn**2 - near))
    needle = from_points("needle", "R10", (u := np.linspace(-9e-3, 9e-3, 900)), np.sqrt(0.01**2 - u**2) - 0.01)
    pair = Pair(wheel, needle, 0.425, 0.75, 0.75)
    amplitudes = np.array([1e-3, 2e-3, 2.8e-3, 2.9e-3, 5e-3])
    found = equivalent_conicity(pair, amplitudes, rolls=False)
    line = slope * (0.6 * (amplitudes / turn) ** 2 - 1)
    assert found[:3] == pytest.approx(line[:3], rel=0.02)
    assert 0.0 < found[3] < found[4]
    assert not np.allclose(found[3:], line[3:], rtol=0.1)


def test_amplitude_of_nothing_is_refused() -> None:
    with pytest.raises(ValueError, match="All amplitudes must be above 0 m; got 0 m"):
        equivalent_conicity(thesis_pair(), np.array([0.0, 1e-3]))


def test_centred_wheelset_touches_at_the_nominal_points() -> None:
    contact = contact_at(thesis_pair(), 0.0)
    assert np.abs(contact.position).max() < 1e-6
    assert contact.radius == pytest.approx((0.425, 0.425), abs=1e-7)
    assert contact.angle == pytest.approx((math.atan(0.05), math.atan(0.05)), abs=1e-4)


@pytest.mark.parametrize("shift", [1e-3, 4e-3, 8e-3])
def test_shift_to_the_other_side_is_the_mirror_image(shift: float) -> None:
    left, right = contact_at(thesis_pair(), shift), contact_at(thesis_pair(), -shift)
    assert left.radius == pytest.approx(right.radius[::-1], abs=1e-9)
    assert left.roll == pytest.approx(-right.roll, abs=1e-10)


def test_cone_without_roll_gives_its_own_conicity_and_with_roll_a_larger_radius_difference() -> None:
    """On a cone the contact moves by the shift: Dr = 2 (1/20) u; the roll adds R gamma / b of crown and cone."""
    pair = thesis_pair()
    shifts = np.array([1e-3, 3e-3, 6e-3])
    assert rolling_radius_difference(pair, shifts, rolls=False) / (2 * shifts) == pytest.approx(0.05, rel=1e-3)
    rolling = rolling_radius_difference(pair, shifts) / (2 * shifts)
    crown, half, radius, cone = 0.3, 0.57, 0.425, 0.05
    assert rolling == pytest.approx(cone * (half + crown * cone) / (half - radius * cone), rel=3e-3)


def test_wave_of_a_rolling_cone_is_that_of_its_contacts_and_not_of_its_axle() -> None:
    """gamma (1 + R gamma / b): contacts and radius difference move by b / (b - r0 gamma) of the shift."""
    pair = thesis_pair()
    amplitudes = np.array([1e-3, 3e-3, 6e-3])
    wave = equivalent_conicity(pair, amplitudes, points=30)
    assert wave == pytest.approx(0.05 * (1 + 0.3 * 0.05 / 0.57), rel=3e-3)
    assert np.all(wave < 0.98 * rolling_radius_difference(pair, amplitudes) / (2 * amplitudes))
    assert equivalent_conicity(pair, amplitudes, rolls=False, points=30) == pytest.approx(0.05, rel=1e-3)


def test_flange_touches_where_the_gauge_face_is_as_steep() -> None:
    """Compare with the arcs of the rail and the sections of the wheels, not their splines; a chord averages ripples."""
    for pair, angle in ((thesis_pair(), 70.3), (european_pair(), 70.0)):  # section 4.3; EN 13715
        assert np.degrees(flange_of(pair).angle) == pytest.approx(angle, abs=0.05)
    y, z = inclined(rail_head(JOINTS_60KG) * [-1, 1], INCLINATION).T
    steepness = np.degrees(np.arctan(np.diff(z) / np.diff(y)))
    assert flange_of(thesis_pair()).depth == pytest.approx(-np.interp(70.3, steepness, z[1:]), abs=0.1e-3)


def test_wheelset_on_its_treads_rolls_with_its_shift() -> None:
    """For a cone on cylinders, contacts stay 2 b apart, so the roll is conicity x shift over b less r x conicity.

    The rails' heads are round: contacts move with the roll, and the closed form is accurate to 5 %.
    """
    pair = thesis_pair()
    closed = INCLINATION / (pair.wheel_half_distance - INCLINATION * pair.radius)
    assert flange_of(pair).roll_by_shift == pytest.approx(closed, rel=0.05)
    assert contact_at(pair, 8e-3).roll == pytest.approx(8e-3 * flange_of(pair).roll_by_shift, rel=1e-3)


@lru_cache
def last_of_thesis_pair() -> ContactAtShift:
    return last_tread_contact(thesis_pair())


@pytest.mark.study
def test_flange_contact_and_loss_of_tread_contact_are_where_the_thesis_says() -> None:
    assert flange_contact_shift(thesis_pair()) == pytest.approx(9.5e-3, abs=0.1e-3)
    assert last_of_thesis_pair().shift == pytest.approx(11.5e-3, abs=0.1e-3)


def test_tread_contact_is_lost_where_the_curvatures_of_wheel_and_rail_sum_to_zero() -> None:
    pair = thesis_pair()

    def gap_curvature(contact: ContactAtShift) -> float:
        on_wheel = np.array([contact.position[0]])
        on_rail = on_wheel + contact.shift + pair.radius * contact.roll
        return float(pair.wheel.height(on_wheel, 2)[0] - pair.rail.height(on_rail, 2)[0])

    at_centre = gap_curvature(contact_at(pair, 0.0))
    assert at_centre == pytest.approx(1 / 0.3, rel=0.01)  # the crown against a cone
    # Close to the fold the curvature falls like a square root: half of the rest vanishes within the step of 20 um.
    assert 0.0 < gap_curvature(last_of_thesis_pair()) < 0.2 * at_centre


def test_head_of_60e1_is_the_published_contour() -> None:
    """Its highest point is 7.5 mm to the field side of its middle, where the rail's own slope is 1:40."""
    y, z = reference("rail_60e1_contour.csv").T / 1e3
    rail = rail_60e1()
    top = 0.3 * math.sin(math.atan(1 / 40))
    highest = float(rail.height(np.array([top]))[0])
    head = z > -5e-3
    assert np.abs(rail.height(y[head] + top) - highest - z[head]).max() < CONTOUR_ERROR
    gauge_side = y < -20e-3
    face = np.interp(-14e-3, z[gauge_side], y[gauge_side])
    assert gauge_face(rail) == pytest.approx(face + top, abs=CONTOUR_ERROR)


def test_european_pair_stands_on_a_gauge_of_1435_mm_and_has_its_usual_clearance() -> None:
    """Rails are 1435 mm apart 14 mm below their top; new wheels have 5 to 8 mm of play to each side."""
    pair = european_pair()
    assert 2 * (pair.rail_half_distance + gauge_face(pair.rail)) == pytest.approx(1.435, abs=1e-6) == STANDARD_GAUGE
    assert flange_contact_shift(pair) == pytest.approx(6.19e-3, abs=CONTOUR_ERROR)


@pytest.mark.parametrize(("suffix", "y_sign", "z_sign"), [(".txt", 1, 1), (".whl", 1, -1), (".whl", -1, 1)])
def test_wheel_from_a_file_is_the_wheel_whichever_way_its_axes_point(
    tmp_path: Path, suffix: str, y_sign: int, z_sign: int
) -> None:
    wheel = wheel_cone_120()
    y = np.arange(-0.045, 0.050, 0.2e-3)
    rows = [f"{y_sign * 1e3 * a:.5f}  {z_sign * 1e3 * b:.6f}" for a, b in zip(y, wheel.height(y), strict=True)]
    path = tmp_path / f"measured{suffix}"
    path.write_text(f"ProgramName=MiniProf\nXYPoints={y.size}\n\n" + "\n".join(rows) + "\n")
    tread = np.linspace(-0.010, 0.045, 100)
    assert np.abs(read_profile(path, "wheel").height(tread) - wheel.height(tread)).max() < 1e-6


@pytest.mark.parametrize(
    ("name", "head", "why"),
    [
        ("own.whl", "", "its name ends in .whl"),
        ("own.txt", "MPTypeNo=101\n", "its header has the type of this instrument"),
        ("own.mpt", "[Profile1Info]\nMPTypeNo=101\n[Profile1Points]\n", None),
    ],
)
def test_a_wheel_that_is_given_as_a_rail_is_refused(tmp_path: Path, name: str, head: str, why: str | None) -> None:
    y = np.arange(-0.045, 0.050, 0.2e-3)
    rows = [f"{1e3 * a:.5f}  {1e3 * b:.6f}" for a, b in zip(y, wheel_cone_120().height(y), strict=True)]
    path = tmp_path / name
    path.write_text(("ProgramName=MiniProf\n" if why else "") + head + "\n".join(rows) + "\n")
    refused = "must have one rail" if why is None else f"that of a wheel: {re.escape(why)}"
    with pytest.raises(ValueError, match=refused):
        read_profile(path, "rail")


@pytest.mark.parametrize("z_sign", [1, -1])
def test_rail_from_a_file_is_the_rail_whichever_way_up(tmp_path: Path, z_sign: int) -> None:
    rail = rail_60kg()
    y = np.arange(-0.034, 0.034, 0.2e-3)
    path = tmp_path / "measured.ban"
    path.write_text("\n".join(f"{1e3 * a:.5f}, {z_sign * 1e3 * b:.6f}" for a, b in zip(y, rail.height(y), strict=True)))
    top = np.linspace(-0.020, 0.020, 100)
    assert np.abs(read_profile(path, "rail").height(top) - rail.height(top)).max() < 1e-6


def test_file_without_enough_points_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "empty.txt"
    path.write_text("1 2\nx y\n")
    with pytest.raises(ValueError, match=r"empty\.txt has 1 points; a rail profile needs at least 20"):
        read_profile(path, "rail")


def test_a_profile_in_millimetres_is_refused_before_its_knots_are_laid() -> None:
    """72 mm as 72 m would be 144 000 knots, and one point at 1e5 two hundred million."""
    y = np.linspace(-36.0, 36.0, 145)
    for own in (y, np.append(y, 1e5)):
        with pytest.raises(ValueError, match=r"Profile mine: y must span at most 0.5 m; got .* m. Give metres."):
            from_points("mine", "test", own, np.zeros_like(own))


def test_profiles_sides_and_vehicles_are_equal_by_what_they_hold() -> None:
    """Equality is by content, not identity: two equal files give equal profiles; one moved point changes it."""
    (y, z), name = (reference("en15302_RUIC519A.csv") / 1e3).T, "A"
    same, moved = from_points(name, "EN 15302", y, z), from_points(name, "EN 15302", y, z + 1e-9 * (y == y[500]))
    assert same == from_points(name, "EN 15302", y, z) != moved
    assert hash(same) == hash(from_points(name, "EN 15302", y, z))
    own = wheelset_under_frame()
    pairs = [Pair(one, rail_60e1(), 0.46, 0.75, 0.75) for one in (same, moved, from_points(name, "EN 15302", y, z))]
    first, other, equal = (replace(own, wheelsets=(replace(own.wheelsets[0], pair=pair),)) for pair in pairs)
    assert first == equal != other
    assert hash(first) == hash(equal)
    assert own == wheelset_under_frame() != first

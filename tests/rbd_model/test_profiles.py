"""Profiles and their contact: smooth, true to their sources, and against closed forms and the EN 15302 reference."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from rbd_model.contact_geometry import (
    Contact,
    Pair,
    contact_at,
    equivalent_conicity,
    european_pair,
    flange_contact_shift,
    flange_of,
    last_tread_contact,
    rolling_radius_difference,
    thesis_pair,
)
from rbd_model.profiles import (
    INCLINATION,
    Profile,
    from_points,
    inclined,
    rail_60kg,
    rail_head,
    read_profile,
    wheel_cone_120,
    wheel_s1002,
)

DATA = Path(__file__).parents[3] / "shared" / "data"
with_data = pytest.mark.skipif(not DATA.exists(), reason="published tables lie beside the development checkout only")


def published(name: str) -> np.ndarray:
    """Rows of numbers of a published table."""
    lines = (DATA / name).read_text().splitlines()
    return np.array([[float(x) for x in line.split(",")[:4]] for line in lines if line[0] in "-0123456789"])


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
    """Eq. (3.72) needs it; across every knot it changes by no more than its own slope explains."""
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


@with_data
def test_s1002_is_the_published_contour() -> None:
    """Within 1 um on the tread; the knots round the corners of the flange root by up to 8 um."""
    points = published("profile_MBench_S1002.csv")[:, :2] / 1e3
    y, z = -points[:, 0], -points[:, 1]
    deviation = np.abs(wheel_s1002().height(y) - z)
    assert deviation[(y > -0.034) & (y < 0.055)].max() < 1e-6
    assert deviation[(y > -0.047) & (y < 0.055)].max() < 8e-6


@with_data
@pytest.mark.parametrize(("wheel", "case"), [("A", 1), ("B", 2), ("H", 3)])
def test_equivalent_conicity_is_that_of_en_15302(wheel: str, case: int) -> None:
    """Within the standard's tolerance at nearly all amplitudes; the standard leaves the roll out."""

    def profile(name: str) -> Profile:
        return from_points(name, "EN 15302", *(published(f"profile_EN15302_{name}.csv")[:, :2] / 1e3).T)

    pair = Pair(profile(f"RUIC519{wheel}"), profile("SUIC519A"), 0.46, 0.75, 0.75)
    table = published(f"eqconicity_EN15302_E{case}.csv")
    amplitude, reference, upper, lower = table.T
    found = equivalent_conicity(pair, amplitude / 1e3, rolls=False, points=301)
    assert np.mean((found <= upper) & (found >= lower)) > 0.95
    assert np.median(np.abs(found - reference)) < 0.005


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


def test_cone_without_roll_gives_its_own_conicity_and_with_roll_more() -> None:
    """Contact moves by the shift on a cone, so Dr = 2 (1/20) u; the roll adds R gamma / b of the crown and the cone."""
    pair = thesis_pair()
    shifts = np.array([1e-3, 3e-3, 6e-3])
    assert rolling_radius_difference(pair, shifts, rolls=False) / (2 * shifts) == pytest.approx(0.05, rel=1e-3)
    rolling = rolling_radius_difference(pair, shifts) / (2 * shifts)
    assert np.all((rolling > 0.052) & (rolling < 0.055))
    assert equivalent_conicity(pair, shifts) == pytest.approx(rolling, rel=5e-3)


def test_flange_touches_where_the_gauge_face_is_as_steep() -> None:
    """By the arcs of the rail and the sections of the wheels, not by their splines; a chord passes over ripples."""
    for pair, angle in ((thesis_pair(), 70.3), (european_pair(), 70.0)):  # section 4.3; EN 13715
        assert np.degrees(flange_of(pair).angle) == pytest.approx(angle, abs=0.05)
    y, z = inclined(rail_head() * [-1, 1], INCLINATION).T
    steepness = np.degrees(np.arctan(np.diff(z) / np.diff(y)))
    assert flange_of(thesis_pair()).depth == pytest.approx(-np.interp(70.3, steepness, z[1:]), abs=0.1e-3)


def test_wheelset_on_its_treads_rolls_with_its_shift() -> None:
    """A cone on cylinders: contacts stay 2 b apart, so that the roll is conicity x shift over b less r x conicity.

    The rails' heads are round: the contacts move with the roll, and the closed form is within 5 %.
    """
    pair = thesis_pair()
    closed = INCLINATION / (pair.wheel_half_distance - INCLINATION * pair.radius)
    assert flange_of(pair).roll_by_shift == pytest.approx(closed, rel=0.05)
    assert contact_at(pair, 8e-3).roll == pytest.approx(8e-3 * flange_of(pair).roll_by_shift, rel=1e-3)


def test_flange_contact_and_loss_of_tread_contact_are_where_the_thesis_says() -> None:
    assert flange_contact_shift(thesis_pair()) == pytest.approx(9.5e-3, abs=0.1e-3)
    assert last_tread_contact(thesis_pair()).shift == pytest.approx(11.5e-3, abs=0.1e-3)


def test_tread_contact_is_lost_where_the_curvatures_of_wheel_and_rail_sum_to_zero() -> None:
    pair = thesis_pair()

    def gap_curvature(contact: Contact) -> float:
        on_wheel = np.array([contact.position[0]])
        on_rail = on_wheel + contact.shift + pair.radius * contact.roll
        return float(pair.wheel.height(on_wheel, 2)[0] - pair.rail.height(on_rail, 2)[0])

    at_centre = gap_curvature(contact_at(pair, 0.0))
    assert at_centre == pytest.approx(1 / 0.3, rel=0.01)  # the crown against a cone
    # Half of what is left at the fold goes within the 20 um of a step: the curvature falls like a square root.
    assert 0.0 < gap_curvature(last_tread_contact(pair)) < 0.2 * at_centre


def test_european_pair_has_its_usual_clearance() -> None:
    """Gauge 1435 mm with new wheels: 5 to 8 mm of play to each side."""
    assert 5e-3 < flange_contact_shift(european_pair()) < 8e-3


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

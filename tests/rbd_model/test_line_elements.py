"""Lines from tables of elements and profiles, against closed forms."""

from __future__ import annotations

import itertools
import math
from pathlib import Path

import numpy as np
import pytest
from scipy.special import fresnel

from rbd_model.track.line import arc, line_of, straight
from rbd_model.track.line_elements import line_from_elements
from rbd_model.track.line_pieces import SourcedLine, end_of
from readers.text import FileError

#: Tolerance of places, heights [m] and angles [rad] against closed forms, before corners are rounded.
BAND = 1e-6
HEAD = "type,length,radius,cant [mm]\n"


def line_of_text(folder: Path, elements: str, profile: str = "", start: float | None = None) -> SourcedLine:
    (folder / "elements.csv").write_text(elements, encoding="utf-8")
    if profile:
        (folder / "profile.csv").write_text(profile, encoding="utf-8")
    return line_from_elements(folder / "elements.csv", folder / "profile.csv" if profile else None, start)


@pytest.mark.parametrize("side", [1, -1])
def test_a_clothoid_ends_at_fresnels_integrals_and_an_arc_on_its_circle(tmp_path: Path, side: int) -> None:
    """x = a C(L / a), y = a S(L / a), a = sqrt(pi R L), heading L / 2 R (Fresnel's integrals)."""
    length, radius = 80.0, 400.0
    line = line_of_text(tmp_path, HEAD + f"straight,50,,\nclothoid,{length},,\narc,200,{side * radius},\n")
    scale = math.sqrt(math.pi * radius * length)
    sine, cosine = fresnel(length / scale)
    rows = {name: values[line.rows["distance"] <= 50.0 + length + 1e-9] for name, values in line.rows.items()}
    end = end_of(rows)
    assert end["ahead"] == pytest.approx(50.0 + scale * cosine, abs=BAND)
    assert end["aside"] == pytest.approx(side * scale * sine, abs=BAND)
    assert end["turn"] == pytest.approx(side * length / (2 * radius), abs=BAND)
    first, turn = length / (2 * radius), 200.0 / radius
    whole = end_of(line.rows)
    across = radius * (math.cos(first) - math.cos(first + turn))
    assert whole["ahead"] == pytest.approx(
        50.0 + scale * cosine + radius * (math.sin(first + turn) - math.sin(first)), abs=BAND
    )
    assert whole["aside"] == pytest.approx(side * (scale * sine + across), abs=BAND)


def test_a_bloss_transition_has_its_closed_form(tmp_path: Path) -> None:
    """Curvature (3 t^2 - 2 t^3) / R, heading (t^3 - t^4 / 2) L / R (Bloss 1936); chords are up to 0.02 % off."""
    line = line_of_text(tmp_path, HEAD + "straight,50,,\nbloss,80,,\narc,100,400,120\n")
    for share in (0.1, 0.37, 0.5, 0.9):
        form = 3 * share**2 - 2 * share**3
        assert line.value("curvature", 50.0 + 80.0 * share) == pytest.approx(form / 400.0, abs=2.1e-4 / 400.0)
        assert line.value("cant", 50.0 + 80.0 * share) == pytest.approx(form * 0.12, abs=2.1e-4 * 0.12)
    assert end_of(line.rows)["turn"] == pytest.approx(80.0 / 800.0 + 100.0 / 400.0, abs=BAND)


PROFILE = "chainage,height,radius\n0,100,\n150,101.5,2000\n400,91.5,5000\n600,91.5,\n"


def test_heights_are_those_of_the_tangents_and_parabolas(tmp_path: Path) -> None:
    """Gradients 10, -40 and 0 per mille; a parabola of radius R is x^2 / 2 R below its tangent. Lengths are roots."""
    line = line_of_text(tmp_path, HEAD + "straight,600,,\n", PROFILE)
    half = 2000.0 * 0.05 / 2.0
    way = np.linspace(0.0, 600.0, 240_001)
    slope = np.interp(way, [0.0, 150 - half, 150 + half, 300, 500, 600], [0.01, 0.01, -0.04, -0.04, 0.0, 0.0])
    step = np.sqrt(1.0 + ((slope[1:] + slope[:-1]) / 2.0) ** 2) * (way[1] - way[0])
    along = np.concatenate([[0.0], np.cumsum(step)])
    assert line.length == pytest.approx(along[-1], abs=BAND)
    exact = {75.0: 100.75, 200.0: 99.5, 250.0: 97.5, 600.0: 91.5}
    exact[150.0] = 101.5 - half**2 / (2 * 2000.0)
    exact[400.0] = 91.5 + 100.0**2 / (2 * 5000.0)
    for place, height in exact.items():
        reached = float(np.interp(place, way, along))
        places = np.append(line.rows["distance"][line.rows["distance"] < reached - 1e-9], reached)
        gradient = np.interp(places, line.rows["distance"], line.rows["gradient"])
        rows = {"distance": places, "curvature": 0.0 * places, "gradient": gradient}
        assert 100.0 + end_of(rows)["height"] == pytest.approx(height, abs=BAND), place
    assert "-8.500 m in height" in str(line.account)


def test_cant_suits_its_curve_and_ramps_over_the_transitions(tmp_path: Path) -> None:
    head, ramp = "type;length;radius;side;cant [mm]\ntangent;100;;;\n", "spiral;60;;;\n"
    line = line_of_text(tmp_path, f"{head}{ramp}curve;150;500;right;90\n{ramp}line;100;;;\n")
    assert line.value("cant", 220.0) == pytest.approx(-0.09)
    assert line.value("cant", 130.0) == pytest.approx(-0.045)
    assert line.value("curvature", 220.0) == pytest.approx(-1 / 500.0)
    assert line.value("cant", 400.0) == 0.0


def test_adverse_cant_is_told_in_a_table_and_refused_in_an_arc_unless_it_is_meant(tmp_path: Path) -> None:
    line = line_of_text(tmp_path, HEAD + "straight,50,,\narc,100,-300,120\nstraight,50,,\narc,100,-300,-60\n")
    assert "cant of 1 arcs, the first in row 5, is negative: adverse in its curve" in line.account.assumed
    assert line.value("cant", np.array([100.0, 250.0])) == pytest.approx([-0.12, 0.06])
    with pytest.raises(ValueError, match=r"sign of its radius, -300 m, .* got 0\.12 m\. Give -0\.12 m, or adverse"):
        arc(100.0, -300.0, 0.12)
    assert arc(100.0, -300.0, 0.12, adverse=True).cant == (0.12, 0.12)
    assert arc(100.0, math.inf, -0.12).cant == (-0.12, -0.12)


def test_a_value_beyond_its_limit_is_told_as_given_although_rows_at_joints_have_means(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"gradient must be from -0\.5 to 0\.5; got 6\.5 in segment 2\. Check"):
        line_of([straight(1000.0), straight(500.0, 6.5)])
    with pytest.raises(ValueError, match=r"curvature .* got -0\.05 1/m \(a radius of -20 m\) in segment 2"):
        line_of([straight(100.0), arc(100.0, -20.0)])
    path = line_of([straight(100.0)]).write(str(tmp_path / "line.csv"))
    assert path == tmp_path / "line.csv"
    with pytest.raises(OSError, match=r"Cannot write .*missing"):
        line_of([straight(100.0)]).write(tmp_path / "missing" / "line.csv")


def test_jumps_and_a_short_profile_are_told(tmp_path: Path) -> None:
    line = line_of_text(tmp_path, HEAD + "straight,100,,\narc,100,300,\n", "chainage,height\n0,0\n150,1.5\n")
    told = str(line.account)
    assert "curvature jumps by 0.003333 1/m at 100.0 m: spread over 1 m to both sides" in told
    assert "the profile reaches from 0.000 to 150.000 m, the elements from 0.000 to 200.000 m" in told
    assert line.value("gradient", 190.0) == pytest.approx(0.01, rel=1e-4)
    later = line_of_text(tmp_path, HEAD + "straight,100,,\n", "chainage,height\n1200,0\n1400,2\n", 1250.0)
    assert later.rows["distance"][0] == 1250.0
    assert "the line is level: no profile was given" in line_of_text(tmp_path, HEAD + "arc,50,300,\n").account.assumed


REFUSED = {
    "an unknown type": (HEAD + "curved,10,,\n", "", "row 2, column type: .*curved"),
    "no radius": (HEAD + "arc,10,,\n", "", "row 2, column radius: an arc must have a radius of 50 m or more; got none"),
    "a hairpin": (HEAD + "arc,10,-30,\n", "", "row 2, column radius: .* of 50 m or more; got -30 m"),
    "a straight with a radius": (HEAD + "straight,10,300,\n", "", "a straight must have no radius; got 300 m"),
    "two signs": (
        "type,length,radius,side\narc,10,-300,left\n",
        "",
        "a radius with a side must be above 0; got -300 m",
    ),
    "two transitions": (
        HEAD + "clothoid,10,,\nclothoid,10,,\n",
        "",
        "row 3, column type: a transition must lie between",
    ),
    "cant in metres": ("type,length,radius,cant\narc,10,300,120\n", "", "row 2, column cant: .* 0.3 m; got '120' m"),
    "no length": (HEAD + "straight,0,,\n", "", "row 2, column length: .* at least 0.01|from 0.01"),
    "curves that overlap": (
        HEAD + "straight,600,,\n",
        PROFILE.replace("2000", "30000"),
        "row 3, column radius: vertical curves must not overlap; got 600.000 m",
    ),
    "a curve at the end": (
        HEAD + "straight,600,,\n",
        PROFILE.replace("100,\n", "100,5000\n"),
        "have no vertical curve",
    ),
    "chainages that turn back": (HEAD + "straight,9,,\n", "chainage,height\n9,1\n3,2\n", "row 3, column chainage"),
    "a wall": (HEAD + "straight,9,,\n", "chainage,height\n0,0\n9,9\n", "gradient must be from -0.5 to 0.5; got 0.707"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_tables_that_do_not_fit_are_refused_with_one_sentence(tmp_path: Path, case: str) -> None:
    elements, profile, message = REFUSED[case]
    with pytest.raises(FileError, match=message):
        line_of_text(tmp_path, elements, profile)


def test_circles_of_a_survey_touch_and_two_points_at_one_place_are_one(tmp_path: Path) -> None:
    """Circles of 2000 m between slopes of 0, 4 and -3 per cent touch; parabolas of this radius overlap by 0.1 m."""
    angles = [math.atan(slope) for slope in (0.0, 0.04, -0.03)]
    reaches = [2000.0 * math.tan(abs(b - a) / 2.0) for a, b in itertools.pairwise(angles)]
    first, second = 100.0, 100.0 + sum(reaches) * math.cos(angles[1])
    top, end = 0.04 * (second - first), second + 100.0
    rows = f"0,0,\n{first},0,2000\n{second:.6f},{top:.6f},2000\n{end},{top - 3.0:.6f},\n"
    line = line_of_text(
        tmp_path, HEAD + f"straight,{end},,\n", f"chainage,height,radius\n{rows}{end + 0.004},{top - 3:.6f},\n"
    )
    assert end_of(line.rows)["height"] == pytest.approx(top - 3.0, abs=1e-5)
    assert "vertical curves overlap by up to 0.1" in str(line.account)


def test_a_huge_radius_is_straight(tmp_path: Path) -> None:
    line = line_of_text(tmp_path, HEAD + "straight,50,,\narc,100,99999999,\n")
    assert end_of(line.rows)["turn"] == pytest.approx(1e-6, rel=0.02)

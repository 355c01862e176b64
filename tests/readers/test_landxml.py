"""LandXML as surveyors' programs write it: circles that touch, elements of no length, missing lengths, large radii."""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path

import pytest

from rbd_model.track.line_files import line_from_file
from rbd_model.track.line_pieces import SourcedLine, end_of
from readers.alignment import Alignment
from readers.formats.lines import read_foreign_line
from readers.text import FileError

BAND = 1e-6
LEVEL = "<PVI>0 0</PVI><PVI>900 0</PVI>"


def landxml(folder: Path, elements: str, profile: str = LEVEL, more: str = "") -> Path:
    path = folder / "land.xml"
    path.write_text(
        '<LandXML version="1.2"><Units><Metric linearUnit="meter"/></Units><Alignments><Alignment name="A" '
        f'staStart="0"{more}><CoordGeom>{elements}</CoordGeom><Profile><ProfAlign name="P">{profile}</ProfAlign>'
        "</Profile></Alignment></Alignments></LandXML>",
        encoding="utf-8",
    )
    return path


def line_of(folder: Path, elements: str, profile: str = LEVEL, more: str = "") -> SourcedLine:
    line = line_from_file(landxml(folder, elements, profile, more))
    assert isinstance(line, SourcedLine)
    return line


def test_circles_touch_where_their_tangents_end(tmp_path: Path) -> None:
    """A circle from slope a to b reaches R (sin b - sin a) along the plan; two that touch have no straight between."""
    radius, slopes = 2000.0, [math.atan(one) for one in (0.0, 0.04, -0.03)]
    points, place, height = [(0.0, 0.0)], 0.0, 0.0
    bends = [radius * math.tan(abs(b - a) / 2.0) for a, b in pairwise(slopes)]
    for slope, along in zip(slopes, (bends[0], sum(bends), bends[1]), strict=True):
        place, height = place + along * math.cos(slope), height + along * math.sin(slope)
        points.append((place, height))
    inner = "".join(f'<CircCurve length="1" radius="{radius}">{x:.9f} {y:.9f}</CircCurve>' for x, y in points[1:3])
    ends = [f"<PVI>{x:.9f} {y:.9f}</PVI>" for x, y in (points[0], points[3])]
    path = landxml(tmp_path, f'<Line length="{place}"/>', ends[0] + inner + ends[1])
    alignment = read_foreign_line(path)
    assert isinstance(alignment, Alignment)
    pieces = alignment.gradient
    reach = radius * math.sin(slopes[1]), radius * (2.0 * math.sin(slopes[1]) - math.sin(slopes[2]))
    assert [(one.end, one.last) for one in pieces if one.end in (pieces[1].end, pieces[3].end)] == [
        (pytest.approx(reach[0], abs=BAND), pytest.approx(0.04)),
        (pytest.approx(reach[1], abs=BAND), pytest.approx(-0.03)),
    ]
    line = line_from_file(path)
    assert end_of(line.rows)["height"] == pytest.approx(height, abs=1e-5)


def test_circles_that_overlap_by_rounding_touch_and_others_are_refused(tmp_path: Path) -> None:
    inner = '<CircCurve radius="{}">100 0</CircCurve><CircCurve radius="10000">200 1</CircCurve>'
    circles = f"<PVI>0 0</PVI>{inner}<PVI>300 1</PVI>"
    line = line_of(tmp_path, '<Line length="300"/>', circles.format(10010))
    assert end_of(line.rows)["height"] == pytest.approx(1.0, abs=BAND)
    assert "vertical curves overlap by up to 0.042 m, as rounded numbers do: they touch" in line.account.assumed
    with pytest.raises(FileError, match=r"must not overlap; got 1\.4\d\d m"):
        line_of(tmp_path, '<Line length="300"/>', circles.format(10300))


def test_elements_of_no_length_and_points_at_one_place_are_left_out(tmp_path: Path) -> None:
    none = '<Curve rot="cw" radius="300" length="0.000"/>'
    profile = "<PVI>0 0</PVI><PVI>99.996 1</PVI><PVI>100 1</PVI><PVI>300 1</PVI><PVI>300 1</PVI>"
    line = line_of(tmp_path, f'{none}<Line length="100"/>{none}<Line length="199.996"/><Line length="0.004"/>', profile)
    end = end_of(line.rows)
    assert (end["plan"], end["height"], end["turn"]) == pytest.approx((300.0, 1.0, 0.0), abs=BAND)
    assert "3 elements shorter than 0.01 m, together 0.004 m" in line.account.left
    assert "2 points of the profile within 0.01 m of another one" in line.account.left
    with pytest.raises(FileError, match=r"must have one height; got 99\.998 m, 2 m after 99\.996 m, 1 m"):
        line_of(tmp_path, '<Line length="300"/>', profile.replace(">100 1", ">99.998 2"))
    with pytest.raises(FileError, match="stations must grow"):
        line_of(tmp_path, '<Line length="300"/>', profile.replace(">100 1", ">90 1"))
    with pytest.raises(FileError, match=r"an element of 0\.01 m or more; got none"):
        line_of(tmp_path, none)


def test_a_vertical_curve_at_an_end_is_left_out(tmp_path: Path) -> None:
    profile = '<PVI>0 0</PVI><ParaCurve length="50">300 3</ParaCurve>'
    line = line_of(tmp_path, '<Line length="300"/>', profile)
    assert end_of(line.rows)["height"] == pytest.approx(3.0, abs=BAND)
    assert "the vertical curve at 300.000 m: one of its tangents is missing" in line.account.left


ARC = "<Start>100 50</Start><Center>{} 50</Center><End>{}</End>"


@pytest.mark.parametrize(("side", "rot"), [(-1.0, "cw"), (1.0, "ccw")])
def test_lengths_and_radii_that_are_missing_follow_from_the_points(tmp_path: Path, side: float, rot: str) -> None:
    """By hand: points are north, east; a quarter of a circle from the north of its centre to west or east."""
    west = "<Start>100 150</Start><End>100 50</End>"
    other = f"{100.0 - 200.0:g} {50.0 - side * 200.0:g}"
    quarter = ARC.format(-100, other)
    line = line_of(tmp_path, f'<Line>{west}</Line><Curve rot="{rot}">{quarter}</Curve>')
    end = end_of(line.rows)
    assert end["length"] == pytest.approx(100.0 + math.pi * 100.0, abs=BAND)
    assert end["turn"] == pytest.approx(side * math.pi / 2.0, abs=BAND)
    back = line_of(tmp_path, f'<Curve rot="{"cw" if rot == "ccw" else "ccw"}" radius="200">{quarter}</Curve>')
    assert back.length == pytest.approx(math.pi * 300.0, abs=BAND)
    with pytest.raises(FileError, match=r"element 1: Line must have length, or coordinates .* got none as Start"):
        line_of(tmp_path, "<Line/>")


def test_a_huge_radius_is_straight_and_a_stated_length_is_compared(tmp_path: Path) -> None:
    spiral = '<Spiral rot="cw" radiusStart="99999999" radiusEnd="500" length="60" spiType="clothoid"/>'
    line = line_of(tmp_path, f'<Curve rot="cw" radius="99999999" length="90"/>{spiral}', more=' length="180"')
    assert end_of(line.rows)["turn"] == pytest.approx(-60.0 / 1000.0, abs=2e-6)
    assert "the length is that of the elements, 150.000 m; 180.000 m is stated" in line.account.assumed

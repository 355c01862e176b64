"""Lines of other programs, against numbers by hand from files that these tests write; damaged files."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from rbd_model.track.line_pieces import SourcedLine, end_of, line_of_alignment
from readers.alignment import Alignment
from readers.formats.lines import read_foreign_line
from readers.text import FileError

#: Tolerance of lengths and heights [m]. Jumps are spread over 1 m to both sides, which keeps their integrals.
BAND = 1e-6


def line_of(path: Path, text: str, *tracks: str) -> SourcedLine:
    path.write_text(text, encoding="utf-8")
    alignment = read_foreign_line(path, tracks)
    assert isinstance(alignment, Alignment)
    return line_of_alignment(alignment)


OSRD = {
    "track_sections": [
        {
            "id": "TA0",
            "length": 2000.0,
            "slopes": [{"begin": 0, "end": 500, "gradient": 10.0}, {"begin": 500, "end": 1000, "gradient": -4.0}],
            "curves": [{"begin": 800.0, "end": 1200.0, "radius": 500.0}],
            "geo": {"type": "LineString", "coordinates": [[0, 0], [1, 1]]},
        },
        {"id": "TB0", "length": 1000.0, "slopes": [], "curves": [{"begin": 0.0, "end": 250.0, "radius": -400.0}]},
    ],
    "track_section_links": [
        {"src": {"endpoint": "END", "track": "TA0"}, "dst": {"endpoint": "BEGIN", "track": {"id": "TB0"}}}
    ],
}


def test_osrd_route_has_its_lengths_curves_and_slopes(tmp_path: Path) -> None:
    """By hand: 3000 m; 10 x 0.5 - 4 x 0.5 = 3 m up; 400 / 500 - 250 / 400 rad."""
    line = line_of(tmp_path / "infra.json", json.dumps(OSRD), "TA0", "TB0")
    end = end_of(line.rows)
    assert line.length == pytest.approx(3000.0, abs=BAND)
    assert end["height"] == pytest.approx(3.0, abs=BAND)
    assert end["turn"] == pytest.approx(400 / 500 - 250 / 400, abs=BAND)
    assert line.value("curvature", [1000.0, 1500.0, 2100.0]) == pytest.approx([1 / 500, 0.0, -1 / 400])
    assert line.value("gradient", [250.0, 750.0, 1500.0]) == pytest.approx([0.01, -0.004, 0.0])
    told = str(line.account)
    assert "geo: its points are positions on a map" in told
    assert "although the file does not link" not in told


def test_a_route_runs_backwards(tmp_path: Path) -> None:
    line = line_of(tmp_path / "infra.json", json.dumps(OSRD), "TB0", "TA0-")
    assert line.value("curvature", [100.0, 1000.0 + 2000.0 - 1000.0]) == pytest.approx([-1 / 400, -1 / 500])
    assert line.value("gradient", 1000.0 + 2000.0 - 250.0) == pytest.approx(-0.01)
    assert "TB0 and TA0 follow each other, although the file does not link these ends" in line.account.assumed


ALTRIOS = """---
- max_grade: 0.06
- - {idx_curr: 0, idx_next: 0, idx_next_alt: 0, length_meters: 0.0, elevs: [], headings: []}
  - idx_curr: 1
    idx_next: 2
    idx_next_alt: 0
    length_meters: 1000.0
    elevs: [{offset_meters: 0.0, elev_meters: 100.0}, {offset_meters: 1000.0, elev_meters: 105.0}]
    headings: [{offset_meters: 0.0, heading_radians: 0.1}, {offset_meters: 400.0, heading_radians: 6.2831853071795862}]
    speed_set: {speed_limits: []}
  - idx_curr: 2
    idx_next: 0
    idx_next_alt: 0
    length: 500.0
    elevs: [{offset: 0.0, elev: 105.0}, {offset: 500.0, elev: 105.0}]
    headings: [{offset: 0.0, heading: 0.0}, {offset: 500.0, heading: 0.25}]
"""


def test_altrios_links_have_the_slopes_and_turns_of_their_points(tmp_path: Path) -> None:
    """By hand: 5 per mille; 0.1 rad to the left over 400 m, the shorter way; 0.25 rad to the right over 500 m."""
    line = line_of(tmp_path / "network.yaml", ALTRIOS, "1", "2")
    assert line.length == pytest.approx(1500.0, abs=BAND)
    assert line.value("gradient", [500.0, 1300.0]) == pytest.approx([0.005, 0.0])
    assert line.value("curvature", [200.0, 700.0, 1300.0]) == pytest.approx([0.1 / 400, 0.0, -0.25 / 500])
    assert end_of(line.rows)["height"] == pytest.approx(5.0, abs=BAND)
    assert "speed_set: speed limits do not belong to the line" in line.account.left


RAILML2 = """<?xml version="1.0"?>
<railml xmlns="https://www.railml.org/schemas/2018" version="2.4"><infrastructure id="i"><tracks>
<track id="t1" name="main"><trackTopology><trackBegin id="b" pos="0"/><trackEnd id="e" pos="1000"/></trackTopology>
<trackElements>
<gradientChanges><gradientChange id="g1" pos="0" slope="0"/>
<gradientChange id="g2" pos="400" slope="10" transitionLength="100"/>
<gradientChange id="g2d" pos="400" slope="-10" dir="down"/></gradientChanges>
<radiusChanges><radiusChange id="r1" pos="0" radius="0"/>
<radiusChange id="r2" pos="200" radius="0" geometryElementDescription="clothoid"/>
<radiusChange id="r3" pos="260" radius="-500" superelevation="120"/>
<radiusChange id="r4" pos="600" radius="-500" superelevation="120" geometryElementDescription="clothoid"/>
<radiusChange id="r5" pos="660" radius="0"/></radiusChanges>
<speedChanges><speedChange id="s" pos="0" vMax="100"/></speedChanges>
</trackElements></track></tracks></infrastructure></railml>
"""


def test_railml_2_changes_become_transitions_arcs_and_vertical_curves(tmp_path: Path) -> None:
    """By hand: 1 / 500 to the left from 260 to 600 m, half of it at 230 m; 10 per mille over 600 m behind 400 m."""
    line = line_of(tmp_path / "infra.xml", RAILML2)
    assert line.length == pytest.approx(1000.0, abs=BAND)
    assert line.value("curvature", [100.0, 230.0, 400.0, 630.0, 800.0]) == pytest.approx(
        [0.0, 1 / 1000, 1 / 500, 1 / 1000, 0.0], abs=1e-12
    )
    assert line.value("cant", [230.0, 400.0]) == pytest.approx([0.06, 0.12])
    assert line.value("gradient", [300.0, 400.0, 500.0]) == pytest.approx([0.0, 0.005, 0.01])
    assert end_of(line.rows)["height"] == pytest.approx(6.0, abs=BAND)
    assert end_of(line.rows)["turn"] == pytest.approx((340 + 60) / 500, abs=BAND)
    assert "speedChanges: speed limits do not belong to the line" in line.account.left


@pytest.mark.parametrize("tag", ["gradientChange", "radiusChange"])
def test_a_change_against_the_track_stands_beside_one_along_it(tag: str, tmp_path: Path) -> None:
    alone = RAILML2.replace('id="g2" pos="400"', 'id="g2" pos="300"')
    if tag == "radiusChange":
        alone = RAILML2.replace('id="r5" pos="660"', 'id="r5" pos="660" dir="down"')
    with pytest.raises(FileError, match=f"track t1: {tag} with dir down must stand beside one with dir up; got it alo"):
        line_of(tmp_path / "infra.xml", alone)
    with pytest.raises(FileError, match="dir of gradientChange must be up or down; got sideways"):
        line_of(tmp_path / "infra.xml", RAILML2.replace('dir="down"', 'dir="sideways"'))
    line = line_of(tmp_path / "infra.xml", RAILML2)
    assert "gradientChange with dir down, 1 in number: those with dir up are read" in line.account.left
    both = RAILML2.replace('id="g2d" pos="400"', 'id="g2d" pos="1000"').replace('id="g1" pos="0"', 'id="g1" pos="50"')
    line = line_of(tmp_path / "infra.xml", both)
    assert line.value("gradient", 900.0) == pytest.approx(0.01)
    assert "track t1 is level before its first gradientChange, at 50 m" in line.account.assumed


def test_a_curve_of_railml_3_against_its_net_element_has_the_other_sign(tmp_path: Path) -> None:
    text = railml3().replace('posBegin="160" posEnd="400"/>', 'posBegin="400" posEnd="160" keepsOrientation="false"/>')
    text = text.replace('posBegin="300" posEnd="500"/>', 'posBegin="300" posEnd="500" keepsOrientation="false"/>')
    line = line_of(tmp_path / "infra.railml", text)
    assert line.value("curvature", [130.0, 300.0]) == pytest.approx([1 / 1200, 1 / 600], abs=1e-12)
    assert line.value("cant", 300.0) == pytest.approx(0.09)
    assert line.value("gradient", [100.0, 400.0]) == pytest.approx([0.005, 0.003])
    text = railml3().replace('id="lgradientCurve0"', 'id="lgradientCurve0" applicationDirection="reverse"')
    with pytest.raises(FileError, match="applicationDirection of gradientCurve gradientCurve0 must be both or normal"):
        line_of(tmp_path / "infra.railml", text)
    with pytest.raises(FileError, match="keepsOrientation must be true or false; got perhaps"):
        line_of(tmp_path / "infra.railml", railml3().replace("posBegin", 'keepsOrientation="perhaps" posBegin'))


def test_a_vertical_curve_of_railml_2_that_has_no_room_is_told(tmp_path: Path) -> None:
    near = '<gradientChange id="g9" pos="410" slope="9"/></gradientChanges>'
    line = line_of(tmp_path / "infra.xml", RAILML2.replace("</gradientChanges>", near))
    assert any("the vertical curve at 400.0 m is shortened from 100.0 to 20.0 m" in one for one in line.account.assumed)


def curve_of_3(tag: str, begin: float, end: float, **more: object) -> str:
    given = " ".join(f'{name}="{value}"' for name, value in more.items())
    place = f'<associatedNetElement netElementRef="ne1" posBegin="{begin}" posEnd="{end}"/>'
    return f'<{tag} id="{tag}{begin:g}" {given}><linearLocation id="l{tag}{begin:g}">{place}</linearLocation></{tag}>'


def railml3() -> str:
    curves = [
        curve_of_3("horizontalCurve", 0, 100, curveType="straight", azimuth=0),
        curve_of_3("horizontalCurve", 100, 160, curveType="clothoide"),
        curve_of_3("horizontalCurve", 160, 400, curveType="arc", radius=600),
        curve_of_3("gradientCurve", 0, 200, curveType="straight", gradient=5),
        curve_of_3("gradientCurve", 200, 300, curveType="arc", deltaGradient=-8, radius=12500),
        curve_of_3("gradientCurve", 300, 500, curveType="straight", gradient=-3),
        curve_of_3("superelevationCurve", 160, 400, superelevation=90),
    ]
    net = '<topology><netElements><netElement id="ne1" length="500"/></netElements></topology>'
    geometry = "".join(f"<{one[1 : one.index(' ')]}s>{one}</{one[1 : one.index(' ')]}s>" for one in curves)
    return f"<railML><infrastructure>{net}<geometry>{geometry}</geometry></infrastructure></railML>"


def test_railml_3_curves_lie_on_their_net_element(tmp_path: Path) -> None:
    """By hand: to the right with 1 / 600; 5 x 0.2 + 1 x 0.1 - 3 x 0.2 = 0.5 m up."""
    line = line_of(tmp_path / "infra.railml", railml3())
    assert line.length == pytest.approx(500.0, abs=BAND)
    assert line.value("curvature", [50.0, 130.0, 300.0, 450.0]) == pytest.approx(
        [0.0, -1 / 1200, -1 / 600, 0.0], abs=1e-12
    )
    assert line.value("cant", 300.0) == pytest.approx(-0.09)
    assert line.value("gradient", [100.0, 250.0, 400.0]) == pytest.approx([0.005, 0.001, -0.003])
    assert end_of(line.rows)["height"] == pytest.approx(0.5, abs=BAND)


def test_curves_of_no_length_and_points_at_one_place_are_left_out(tmp_path: Path) -> None:
    none = curve_of_3("horizontalCurve", 250, 250, curveType="arc", radius=600)
    line = line_of(tmp_path / "infra.railml", railml3().replace("<gradientCurves>", f"{none}<gradientCurves>", 1))
    assert line.length == pytest.approx(500.0, abs=BAND)
    assert "horizontalCurve horizontalCurve250: it is shorter than 0.01 m" in line.account.left
    again = "{offset: 0.0, heading: 0.0}, {offset: 0.004, heading: 0.0}"
    line = line_of(tmp_path / "net.yaml", ALTRIOS.replace("{offset: 0.0, heading: 0.0}", again), "2")
    assert end_of(line.rows)["turn"] == pytest.approx(-0.25, abs=BAND)


def landxml(units: str = '<Metric linearUnit="meter"/>', spiral: str = "clothoid", more: str = "") -> str:
    return f"""<?xml version="1.0"?>
<LandXML xmlns="http://www.landxml.org/schema/LandXML-1.2" version="1.2"><Units>{units}</Units><Alignments>
<Alignment name="A" length="510" staStart="1000"><CoordGeom>
<Line length="100"><Start>0 0</Start><End>100 0</End></Line>
<Spiral length="80" radiusStart="INF" radiusEnd="400" rot="cw" spiType="{spiral}"><Start>100 0</Start></Spiral>
<Curve rot="cw" radius="400" length="200" crvType="arc"><Start>0 0</Start></Curve>
<Spiral length="80" radiusStart="400" radiusEnd="INF" rot="cw" spiType="{spiral}"/>
<Line length="50"/></CoordGeom>
<Profile><ProfAlign name="P"><PVI>1000 10.0</PVI><ParaCurve length="100">1200 12.0</ParaCurve>
<CircCurve radius="5000" length="50">1400 12.0</CircCurve><PVI>1510 10.9</PVI></ProfAlign></Profile>
<Cant name="C" gauge="1.435" rotationPoint="insideRail"><CantStation station="1100" appliedCant="0" curvature="cw"/>
<CantStation station="1180" appliedCant="100" curvature="cw"/><CantStation station="1380" appliedCant="100"/>
<CantStation station="1460" appliedCant="0" curvature="cw"/></Cant>{more}</Alignment></Alignments></LandXML>
"""


def test_a_landxml_alignment_has_the_elements_cant_and_heights_of_its_file(tmp_path: Path) -> None:
    """By hand: 280 / 400 rad to the right; heights +0.9 m; at the first point the parabola lies 0.125 m below it."""
    line = line_of(tmp_path / "land.xml", landxml())
    end = end_of(line.rows)
    assert (end["plan"], end["height"]) == pytest.approx((510.0, 0.9), abs=BAND)
    # the turn is an integral over the plan, whose gradients lengthen the line by up to 5e-5
    assert end["turn"] == pytest.approx(-280 / 400, abs=BAND)
    first = line.rows["distance"][0]
    assert first == 1000.0
    assert line.value("curvature", [1050.0, 1140.0, 1300.0]) == pytest.approx(
        [0.0, -1 / 800, -1 / 400], rel=4e-4, abs=1e-9
    )
    assert line.value("cant", [1140.0, 1300.0]) == pytest.approx([-0.05, -0.1], rel=2e-4)
    assert line.value("gradient", [1050.0, 1200.0, 1300.0]) == pytest.approx([0.01, 0.005, 0.0], abs=2e-6)
    assert "appliedCant is in mm (the schema has no unit): up to 100 mm" in line.account.assumed


def test_what_a_line_lacks_is_told(tmp_path: Path) -> None:
    line = line_of(tmp_path / "land.xml", landxml("").replace("<Units></Units>", ""))
    assert "lengths are in m: the file has no Units" in line.account.assumed
    bare = {"track_sections": [{"id": "T", "length": 100.0}]}
    line = line_of(tmp_path / "infra.json", json.dumps(bare))
    assert "track sections T are level: they have no slopes" in line.account.assumed
    line = line_of(tmp_path / "net.yaml", "- idx_curr: 0\n  length_meters: 100.0\n")
    assert "links 0 are level: they have no elevs" in line.account.assumed


def test_landxml_in_feet_and_with_bloss_curves(tmp_path: Path) -> None:
    line = line_of(tmp_path / "land.xml", landxml('<Imperial linearUnit="USSurveyFoot"/>').replace('"100"', '"4"'))
    foot = 1200 / 3937
    assert end_of(line.rows)["plan"] == pytest.approx(414.0 * foot, abs=BAND)
    assert "lengths: USSurveyFoot to m" in str(line.account)
    bloss = line_of(tmp_path / "land.xml", landxml(spiral="bloss"))
    share = 0.25
    assert bloss.value("curvature", 1120.0) == pytest.approx(-(3 * share**2 - 2 * share**3) / 400, rel=1e-2)


BOMB = '<!DOCTYPE l [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]><LandXML>&b;</LandXML>'
OTHER = json.dumps(OSRD)
DAMAGED = {
    "an entity": ("a.xml", BOMB, (), "must have no document type; got <!DOCTYPE l"),
    "half a file": ("a.xml", RAILML2[:600], (), "must be XML; got a fault in row"),
    "another root": ("a.xml", "<svg/>", (), "must be railML, LandXML, GPX, KML or OSM; got svg"),
    "no alignment": ("a.xml", "<LandXML/>", (), "must be LandXML with an Alignment"),
    "an unknown spiral": (
        "a.xml",
        landxml(spiral="sineHalfWave"),
        (),
        "spiType must be one of clothoid, bloss; got sineHalf",
    ),
    "a name twice": (
        "a.xml",
        landxml(more='</Alignment><Alignment name="A">'),
        (),
        "the alignment A must be there once; got 2",
    ),
    "no rotation": (
        "a.xml",
        landxml().replace('Curve rot="cw"', "Curve"),
        (),
        "element 3: rot of Curve must be cw or ccw",
    ),
    "a radius of words": (
        "a.xml",
        landxml().replace('radius="400"', 'radius="wide"'),
        (),
        "radius of Curve must be a number",
    ),
    "no unit": ("a.xml", landxml("<Imperial/>"), (), "linearUnit must be one of meter"),
    "an unknown unit": ("a.xml", landxml('<Metric linearUnit="league"/>'), (), "linearUnit must be one of meter"),
    "a parabola too long": (
        "a.xml",
        landxml().replace('"100">1200', '"700">1200'),
        (),
        "vertical curves must not overlap",
    ),
    "a tight curve": ("a.xml", landxml().replace('"400"', '"30"'), (), r"curvature must be from .*a radius of -30 m\)"),
    "a huge length": ("a.xml", landxml().replace('length="200"', 'length="1e300"'), (), "must be a number up to 1e.07"),
    "a change beyond its track": ("a.xml", RAILML2.replace('pos="660"', 'pos="6600"'), (), "0 to 1000 m; got 6600 m"),
    "no end": ("a.xml", RAILML2.replace("trackEnd", "end"), (), "track t1 must have a trackEnd"),
    "several tracks": ("a.json", OTHER, (), "must be named, as --tracks TA0; the file has TA0, TB0"),
    "an unknown track": ("a.json", OTHER, ("TC0",), "must have the track TC0; it has TA0, TB0"),
    "a slope of words": ("a.json", OTHER.replace("10.0", '"up"'), ("TA0",), "gradient must be a number"),
    "curves that overlap": (
        "a.json",
        OTHER.replace("[]", "[]").replace('"end": 500', '"end": 700'),
        ("TA0",),
        "must not overlap",
    ),
    "a range beyond its end": (
        "a.json",
        OTHER.replace("1200.0", "9200.0"),
        ("TA0",),
        "end must be a number from 0 to 2000",
    ),
    "no network": ("a.yaml", "a: 1", (), "must have a list of links"),
    "offsets that turn back": (
        "a.yaml",
        ALTRIOS.replace("offset: 500.0, elev", "offset: -5.0, elev"),
        ("2",),
        "must grow",
    ),
    "an anchor": ("a.yaml", "a: &x 1\nb: *x", (), "anchors"),
    "no number": (
        "a.yaml",
        ALTRIOS.replace("elev_meters: 105.0", "elev_meters: .nan"),
        ("1",),
        "must have finite numbers",
    ),
}


@pytest.mark.parametrize("case", DAMAGED)
def test_damaged_files_are_refused_with_one_sentence(tmp_path: Path, case: str) -> None:
    name, text, tracks, message = DAMAGED[case]
    with pytest.raises(FileError, match=message) as error:
        line_of(tmp_path / name, text, *tracks)
    assert "\n" not in str(error.value)
    assert len(str(error.value)) < 400

"""Files of maps and receivers: one course in all formats, routes over ways, tags, and files that are refused."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import bogie_braking as bb
from rbd_model.track.line_points import LineFromPoints
from readers.text import BadInputError, FileError

#: Latitude, longitude [degrees] and height [m] of a curve of about 1000 m to the north and then to the east.
ANGLES = np.linspace(0.0, 1.2, 41)
PLACES = np.round(
    np.column_stack([50.0 + 9e-3 * np.sin(ANGLES), 8.0 + 14e-3 * (1.0 - np.cos(ANGLES)), 100.0 + 4.0 * ANGLES]), 7
).tolist()


def gpx(places: Sequence[Sequence[Any]], name: str = "ride") -> str:
    points = "".join(f'<trkpt lat="{a}" lon="{b}"><ele>{h}</ele><time>x</time></trkpt>' for a, b, h in places)
    return (
        f'<gpx xmlns="http://www.topografix.com/GPX/1/1"><trk><name>{name}</name><trkseg>{points}</trkseg></trk></gpx>'
    )


def kml(places: Sequence[Sequence[Any]]) -> str:
    text = "\n".join(f"{b},{a},{h}" for a, b, h in places)
    line = f"<LineString><coordinates>{text}</coordinates></LineString>"
    return f'<kml xmlns="http://www.opengis.net/kml/2.2"><Document><Placemark>{line}</Placemark></Document></kml>'


def track() -> str:
    text = "".join(f"<when>x</when><g:coord>{b} {a} {h}</g:coord>" for a, b, h in PLACES)
    line = f"<Placemark><g:Track>{text}</g:Track></Placemark>"
    return f'<kml xmlns="http://www.opengis.net/kml/2.2" xmlns:g="http://www.google.com/kml/ext/2.2">{line}</kml>'


def geojson(places: Sequence[Sequence[Any]], **more: Any) -> str:
    return json.dumps({"type": "LineString", "coordinates": [[b, a, h] for a, b, h in places]} | more)


def way(number: int, places: Sequence[Sequence[Any]], **tags: str) -> dict[str, Any]:
    points = [{"lat": one[0], "lon": one[1]} for one in places]
    return {"type": "way", "id": number, "geometry": points, "tags": {"railway": "rail"} | tags}


def overpass(*elements: dict[str, Any]) -> str:
    return json.dumps({"version": 0.6, "elements": elements})


def osm() -> str:
    nodes = "".join(f'<node id="{n}" lat="{a}" lon="{b}"/>' for n, (a, b, _) in enumerate(PLACES))
    refs = "".join(f'<nd ref="{n}"/>' for n in range(len(PLACES)))
    return f'<osm version="0.6">{nodes}<way id="7">{refs}<tag k="railway" v="rail"/></way></osm>'


def of_nodes() -> str:
    nodes = [{"type": "node", "id": n, "lat": a, "lon": b} for n, (a, b, _) in enumerate(PLACES)]
    return overpass({"type": "way", "id": 7, "nodes": list(range(len(PLACES)))}, *nodes)


def table() -> str:
    return "Lon;Lat;Ele\n" + "".join(f"{b};{a};{h}\n" for a, b, h in PLACES).replace(".", ",")


def line_of(tmp_path: Path, text: str, name: str, *tracks: str) -> LineFromPoints:
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    line = bb.line_from_file(path, tracks=tracks)
    assert isinstance(line, LineFromPoints)
    return line


FORMATS = {
    "ride.gpx": gpx(PLACES),
    "line.kml": kml(PLACES),
    "line.xml": kml(PLACES),
    "track.kml": track(),
    "line.geojson": geojson(PLACES),
    "points.csv": table(),
    "ways.json": overpass(way(7, PLACES)),
    "nodes.json": of_nodes(),
    "map.osm": osm(),
}


@pytest.mark.parametrize("name", FORMATS)
def test_a_course_is_the_same_line_in_each_format(name: str, tmp_path: Path) -> None:
    """Heights are in the first six; 100 m of height lengthen 1 km by 0.016 m."""
    known = name in list(FORMATS)[:6]
    places = PLACES if known else [(a, b, 0.0) for a, b, _ in PLACES]
    line, other = line_of(tmp_path, FORMATS[name], name), line_of(tmp_path, gpx(places), "other.gpx")
    for column in ("distance", "curvature", "gradient"):
        assert line.rows[column] == pytest.approx(other.rows[column], abs=1e-9), column
    assert ("the gradient is 0: the points have no heights" in line.account.assumed) != known
    assert bb.line_from_points(tmp_path / name) == line


def test_a_kmz_archive_is_its_kml(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "line.kmz", "w") as archive:
        archive.writestr("doc.kml", kml(PLACES))
    assert bb.line_from_file(tmp_path / "line.kmz") == line_of(tmp_path, kml(PLACES), "line.kml")


#: Ways 1, 2 (drawn backwards) and 3 of the course; way 9 leaves it at a switch and returns at another one; a platform.
WAYS = (
    way(1, PLACES[:15], maxspeed="80"),
    way(2, PLACES[14:30][::-1], maxspeed="50 mph", **{"maxspeed:backward": "90"}, incline="-1.5%"),
    way(3, PLACES[29:], maxspeed="signals", incline="up"),
)
BESIDE = way(9, [PLACES[10], *([a + 1e-4, b, h] for a, b, h in PLACES[12:20]), PLACES[22]])
PLATFORM = way(10, [PLACES[5], [50.01, 7.99]]) | {"tags": {"railway": "platform"}}


def test_ways_are_joined_and_their_tags_are_read_in_the_direction_of_the_route(tmp_path: Path) -> None:
    line = line_of(tmp_path, overpass(WAYS[2], PLATFORM, *WAYS[:2]), "ways.json", "1", "3")
    whole = line_of(tmp_path, overpass(way(7, PLACES)), "whole.json")
    assert line.length == pytest.approx(whole.length * (1.0 + 0.5 * 0.015**2 * 15 / 40), rel=1e-6)
    (begin, middle, slow), (again, end, fast) = line.speed_limits
    assert (begin, again) == (0.0, middle)
    assert (slow, fast) == pytest.approx((80 / 3.6, 90 / 3.6))
    assert line.value("gradient", [middle - 20.0, middle + 20.0, end - 20.0, end + 20.0]) == pytest.approx(
        [0.0, 0.015, 0.015, 0.0], rel=2e-4
    )
    assert {"maxspeed = signals", "incline = up"} <= set(line.account.left)
    assert any("ways without railway" in one and one.endswith(": 1") for one in line.account.left)
    assert any("the gradient is that of the tags incline, on" in one for one in line.account.assumed)
    back = line_of(tmp_path, overpass(*WAYS), "ways.json", "3", "1")
    assert back.value("gradient", back.length - middle - 20.0) == pytest.approx(-0.015, rel=2e-4)
    assert back.value("curvature", 500.0) == pytest.approx(-whole.value("curvature", whole.length - 500.0), rel=1e-3)


def test_of_a_relation_its_members_are_read_without_platforms(tmp_path: Path) -> None:
    members = [{"type": "way", "ref": one["id"], "role": ""} for one in WAYS]
    members.append({"type": "way", "ref": 10, "role": "platform"})
    relation = {"type": "relation", "id": 1, "members": members}
    line = line_of(tmp_path, overpass(relation, PLATFORM, BESIDE, *WAYS), "relation.json")
    assert line == line_of(tmp_path, overpass(*WAYS), "ways.json")


def test_a_branch_is_refused_until_ways_are_named(tmp_path: Path) -> None:
    everything = overpass(*WAYS, BESIDE)
    with pytest.raises(FileError, match=r"must be one line without branches; 3 meet at latitude 50.0\d+, longitude"):
        line_of(tmp_path, everything, "ways.json")
    straight = line_of(tmp_path, everything, "ways.json", "1", "3")
    assert straight == line_of(tmp_path, overpass(*WAYS), "through.json")
    with pytest.raises(FileError, match="no way leads on to 9 without turning back"):
        line_of(tmp_path, everything, "ways.json", "1", "9")
    siding = overpass(*WAYS, BESIDE | {"tags": {"railway": "rail", "service": "siding"}})
    assert line_of(tmp_path, siding, "siding.json") == straight


def test_a_route_takes_a_crossover_only_where_the_way_around_is_five_times_longer(tmp_path: Path) -> None:
    around = way(12, [PLACES[14], *([a + 2e-4, b, h] for a, b, h in PLACES[16:28]), PLACES[29]])
    crossover = WAYS[1] | {"tags": {"railway": "rail", "service": "crossover"}}
    line = line_of(tmp_path, overpass(WAYS[0], crossover, WAYS[2], around), "ways.json", "1", "3")
    assert line.account.taken[0] == "ways 1, 12, 3: latitude, longitude"


def test_a_gap_is_refused_with_its_size_and_bridged_where_ways_are_named(tmp_path: Path) -> None:
    """The gap is one step of the course, 25 m, or a whole way."""
    apart = overpass(way(1, PLACES[:15]), way(3, PLACES[15:]))
    with pytest.raises(FileError, match=r"must join end to end; it has 2 lines, the nearest ends 3\d\.\d+ m apart at"):
        line_of(tmp_path, apart, "gap.json")
    line = line_of(tmp_path, apart, "gap.json", "1", "3")
    assert line.length == pytest.approx(line_of(tmp_path, overpass(way(7, PLACES)), "whole.json").length, rel=1e-6)
    assert any(one.startswith("a gap of 3") for one in line.account.assumed)
    with pytest.raises(FileError, match="no way leads on to 3"):
        line_of(tmp_path, overpass(WAYS[0], WAYS[2]), "gap.json", "1", "3")


def test_halts_and_jumps_of_a_receiver_are_told(tmp_path: Path) -> None:
    chance = np.random.default_rng(1)
    halt = [[PLACES[20][0] + a, PLACES[20][1] + b, 102.4] for a, b in 3e-5 * chance.standard_normal((300, 2))]
    jump = [[PLACES[30][0] + 2e-3, PLACES[30][1] + 2e-3, 0.0]]
    line = line_of(tmp_path, gpx([*PLACES[:21], *halt, *PLACES[21:31], *jump, *PLACES[31:]]), "ride.gpx")
    assert line.length == pytest.approx(line_of(tmp_path, gpx(PLACES), "plain.gpx").length, abs=2.0)
    assert any("turn back and are averaged" in one for one in line.account.converted)
    assert "points that jump by more than 40 m and back are left out: 1" in line.account.assumed
    with pytest.raises(FileError, match=r"ride.gpx, point \d\d: points must follow the line; got a turn by 180"):
        line_of(tmp_path, gpx([*PLACES, *PLACES[-2::-1]]), "ride.gpx")


TURNED = [[b, a, h] for a, b, h in [[-33.8 - 1e-4 * n, 151.2, 0.0] for n in range(20)]]
REFUSED = {
    "latitude first": (
        "a.geojson",
        geojson(TURNED),
        "latitude must be from -89 to 89 degrees; got 151.2. Check the or",
    ),
    "other system": ("a.geojson", geojson(PLACES, crs="EPSG:25832"), "crs must be WGS 84 with longitude first"),
    "a decimal comma": ("a.gpx", gpx([["50,1", "8,2", 0]]), "lat of trkpt must be a number up to 180; got 50,1"),
    "not a number": ("a.gpx", gpx([["NaN", 8, 0]]), "lat of trkpt must be a number up to 180; got NaN"),
    "minutes": ("a.csv", "lat,lon\n52 31.2,13.4\n", "column lat: the value must be a number; got '52 31.2'"),
    "two points": ("a.gpx", gpx(PLACES[:2]), "must have 8 to 200000 different points; got 2"),
    "one place": (
        "a.gpx",
        gpx(PLACES[:1] * 50),
        "must have 1 to 10000 lines with at most 200000 different points; got 0",
    ),
    "far apart": ("a.gpx", gpx([*PLACES, [51.0, 8.0, 0]]), "at most 10 km apart; got .* km behind point 41"),
    "a document type": ("a.gpx", "<!DOCTYPE gpx []><gpx/>", "must have no document type; got <!DOCTYPE gpx"),
    "no track": ("a.gpx", '<gpx><wpt lat="1" lon="2"/></gpx>', "must have a track .trk. or route .rte. with points"),
    "two tracks": (
        "a.gpx",
        gpx(PLACES).replace("</gpx>", gpx(PLACES).partition('1/1">')[2]),
        "must be named, as --tracks ride; the file",
    ),
    "another root": ("a.kml", "<html/>", "must be railML, LandXML, GPX, KML or OSM; got html"),
    "no lines": (
        "a.geojson",
        '{"type": "FeatureCollection", "features": []}',
        "must have a LineString or MultiLineStr",
    ),
    "no positions": (
        "a.geojson",
        '{"type": "MultiLineString", "coordinates": [1, 2]}',
        "MultiLineString must be a list; got 1",
    ),
    "no map": ("a.json", "{}", r"must be JSON of OSRD \(track_sections\), Overpass \(elements\) or GeoJSON \(type\)"),
    "part of a map": (
        "a.json",
        '{"elements": [], "remark": "timed out"}',
        "must be whole; the query ended with timed out",
    ),
    "no points": (
        "a.json",
        '{"elements": [{"type": "way", "id": 1, "nodes": [1, 2]}]}',
        "2 are missing. Ask for the po",
    ),
    "no archive": ("a.kmz", "kml", "must be a KMZ archive; it cannot be read"),
    "ground": (
        "a.kml",
        kml(PLACES).replace(",", " "),
        "coordinates must be longitude,latitude,height with decimal poi",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_files_that_are_no_course_are_refused_with_one_sentence(case: str, tmp_path: Path) -> None:
    name, text, message = REFUSED[case]
    with pytest.raises(FileError, match=message):
        line_of(tmp_path, text, name)


def test_options_of_other_files_are_refused(tmp_path: Path) -> None:
    (tmp_path / "ride.gpx").write_text(gpx(PLACES))
    with pytest.raises(BadInputError, match=r"profile must be given for elements alone; .* is a course in degrees"):
        bb.line_from_file(tmp_path / "ride.gpx", profile="profile.csv")

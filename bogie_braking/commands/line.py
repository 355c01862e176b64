"""The command `line`: checks a line and draws it, or makes one of points, elements and files of other programs."""

from __future__ import annotations

import argparse
import json
from functools import partial
from pathlib import Path
from typing import Any

from bogie_braking.common_options import add_out, add_speech, describe
from bogie_braking.exit_status import HOLDS
from readers.command_line import check_folder, check_out, make_folder_of, quantity
from readers.storage import write_whole
from readers.text import BadInputError, FileError

ABOUT = """Check a line and draw it, or make a line of points, surveys, maps, receivers or other programs' files.

  bogie-braking line check line.csv --speed 120km/h              numbers, and a picture in results/line.png
  bogie-braking line import points.csv --out line.csv            points: x, y, z or latitude, longitude
  bogie-braking line import elements.csv --profile profile.csv   straights, transitions, arcs; points of the profile
  bogie-braking line import ride.gpx --out line.csv              GPX, KML, KMZ, GeoJSON, Overpass JSON, .osm
  bogie-braking line import infra.json --tracks TA0 TA6          tracks of OSRD, railML, LandXML or ALTRIOS
"""
FILE = (
    "a line, points, elements, a map or track of a receiver (.gpx, .kml, .kmz, .geojson, .osm, .json of Overpass), "
    "or a file of OSRD (.json), ALTRIOS (.yaml), railML or LandXML (.xml)"
)
#: Speed of the cant deficiency if none is given [m/s].
SPEED = 100 / 3.6


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the actions `check` and `import`."""
    describe(parser, ABOUT)
    actions = parser.add_subparsers(dest="action", required=True)
    check = actions.add_parser("check", help="print what a line demands, and draw it")
    check.add_argument("file", type=Path, metavar="FILE", help=FILE)
    speed = quantity("--speed", "m/s", 0.1, 200.0)
    text = "speed of the cant deficiency, as 120km/h or 33.3 in m/s (default: 100km/h)"
    check.add_argument("--speed", type=speed, metavar="SPEED", default=SPEED, help=text)
    friction = quantity("--friction", "1", 0.0, 2.0, above=True)
    text = "friction of the rail, which the line's factors multiply (default: the factors alone)"
    check.add_argument("--friction", type=friction, metavar="MU", help=text)
    add_out(check, "folder of the picture")
    make = actions.add_parser("import", help="write the line of a file as a line file, and draw it")
    make.add_argument("file", type=Path, metavar="FILE", help=FILE)
    text = "line file to write; its picture lies next to it (default: line.csv)"
    make.add_argument("--out", type=Path, default=Path("line.csv"), metavar="FILE", help=text)
    for action in (check, make):
        _add_options(action)
        add_speech(action, "the numbers", "no text, only the exit status")


def _add_options(action: argparse.ArgumentParser) -> None:
    text = "for elements: table with chainage, height, radius of the vertical curve"
    action.add_argument("--profile", type=Path, metavar="FILE", help=text)
    text = "for elements, points and maps: distance at the start [m] (default: that of the profile, or 0)"
    action.add_argument("--start", type=quantity("--start", "m", -1e7, 1e7), metavar="DISTANCE", help=text)
    text = "for points and maps: standard deviation of a point, as 5mm (default: estimated)"
    action.add_argument("--noise", type=quantity("--noise", "m", 0.0, 20.0, above=True), metavar="LENGTH", help=text)
    text = (
        "for other programs: tracks of the route in their order, - behind one that is run backwards; for maps: first "
        "and last way, between them the shortest route"
    )
    action.add_argument("--tracks", nargs="+", action="extend", default=[], metavar="NAME", help=text)
    action.add_argument("--mirror", action="store_true", help="exchange left and right")


def run(chosen: argparse.Namespace) -> int:
    """Check or import a line. Raises BadInputError for files that cannot be read."""
    from rbd_model.track.line_files import line_from_file

    if chosen.action == "check":
        check_folder(chosen.out)
    else:
        check_out(chosen.out, chosen.file, picture=True)
        check_folder(chosen.out.parent)
    try:
        line = line_from_file(
            chosen.file,
            profile=chosen.profile,
            start=chosen.start,
            noise=chosen.noise,
            tracks=chosen.tracks,
            mirror=chosen.mirror,
        )
    except FileError as error:
        raise BadInputError(str(error)) from None
    if chosen.action == "check" and chosen.friction is not None and not line.has_friction:
        raise BadInputError(
            f"--friction must be given for a line with columns of friction alone; {chosen.file} has neither "
            "left_friction nor right_friction. Leave it out, or add them."
        )
    return _check(chosen, line) if chosen.action == "check" else _import(chosen, line)


def _check(chosen: argparse.Namespace, line: Any) -> int:
    place = chosen.out / f"{chosen.file.stem}.png"
    check, pictures, account = _drawn(line, chosen.speed, place, chosen.friction)
    if chosen.json:
        found = {"picture": str(pictures[0]) if pictures else None}
        print(json.dumps(document_of(check, chosen.speed) | found, indent=2))
    elif not chosen.quiet:
        drawn = (f"picture: {picture}" for picture in pictures)
        print("\n".join(filter(None, [str(account), text_of(check, chosen.speed), *drawn])))
    return HOLDS


def _import(chosen: argparse.Namespace, line: Any) -> int:
    from bogie_braking.reporting.line_picture import figure_of_points
    from bogie_braking.reporting.plots import saved
    from rbd_model.track.line import NAMES
    from rbd_model.track.line_points import LineFromPoints

    rows = line.lines_of([name for name in NAMES if name in line.rows])
    make_folder_of(chosen.out)
    write_whole(chosen.out, ("\n".join(rows) + "\n").encode(), "name another file with --out")
    check, pictures, account = _drawn(line, SPEED, chosen.out.with_suffix(".png"))
    limits = {}
    if isinstance(line, LineFromPoints):
        limits = {"speed_limits": line.speed_limits}
        place = chosen.out.with_name(f"{chosen.out.stem}-points.png")
        pictures += saved(partial(figure_of_points, line), place, dpi=130)
    if chosen.json:
        found = {"line": str(chosen.out), "pictures": [str(picture) for picture in pictures], **limits, **vars(account)}
        print(json.dumps(found | document_of(check, SPEED), indent=2))
    elif not chosen.quiet:
        text = f"line:     {chosen.out}, {check.rows} rows, {check.end - check.begin:.3f} m"
        print("\n".join(filter(None, [str(account), text, *(f"picture:  {one}" for one in pictures)])))
    return HOLDS


def _drawn(line: Any, speed: float, place: Path, friction: float | None = None) -> tuple[Any, list[Path], Any]:
    """Return the check of a line at a speed [m/s], the paths of its figures, and the account of its import.

    friction: that of the rail, which the line's factors multiply [1].
    """
    from bogie_braking.reporting.line_picture import figure_of_check
    from bogie_braking.reporting.plots import saved
    from rbd_model.track.line_check import check_line
    from rbd_model.track.line_files import account_of

    check = check_line(line, speed, friction)
    pictures = saved(partial(figure_of_check, line, check, speed, friction), place, dpi=130)
    return check, pictures, account_of(line)


def text_of(check: Any, speed: float) -> str:
    """Return the numbers of a line as lines of text."""
    from rbd_model.track.line_check import TWIST_BASE, radius_of

    bend, side = check.tightest, "left" if check.tightest.value > 0.0 else "right"
    tightest = "straight" if bend.value == 0.0 else f"{radius_of(bend.value):.1f} m to the {side} at {bend.place:.1f} m"
    numbers = {
        "length": f"{check.end - check.begin:.3f} m, from {check.begin:.3f} to {check.end:.3f} m, {check.rows} rows",
        "smallest radius": tightest,
        "largest cant": f"{1e3 * check.cant.value:.1f} mm at {check.cant.place:.1f} m",
        f"deficiency at {3.6 * speed:.4g} km/h": f"up to {1e3 * check.deficiency.value:.1f} mm at "
        f"{check.deficiency.place:.1f} m, down to {1e3 * check.excess.value:.1f} mm at {check.excess.place:.1f} m",
        "steepest gradient": f"{1e3 * check.gradient.value:.2f} per mille at {check.gradient.place:.1f} m",
        "height of the end": f"{check.height:+.3f} m over the start",
        "largest twist": f"{1e3 * check.twist.value:.2f} mm/m over {TWIST_BASE:g} m at {check.twist.place:.1f} m",
    }
    units = {"curvature": (1.0, "1/m"), "cant": (1e3, "mm"), "gradient": (1e3, "per mille")}
    for name, jumps in check.jumps.items():
        scale, unit = units[name]
        places = ", ".join(f"{scale * jump.value:+.3g} {unit} at {jump.place:.1f} m" for jump in jumps[:3])
        more = f" and {len(jumps) - 3} more" if len(jumps) > 3 else ""
        numbers[f"jumps of {name}"] = f"{places}{more}" if jumps else "none"
    if check.adhesion:
        numbers |= _friction_text(check.adhesion)
    return "\n".join(f"{name + ':':<26}{text}" for name, text in numbers.items())


def _friction_text(map_: Any) -> dict[str, str]:
    """Return the lines of a map of friction."""
    low, high, sides = map_.lowest, map_.highest, map_.sides
    places = ", ".join(f"{begin:.1f} to {end:.1f} m" for begin, end in map_.stretches[:3])
    more = f" and {len(map_.stretches) - 3} more" if len(map_.stretches) > 3 else ""
    name = "factor on friction" if map_.below is None else "friction"
    said = {
        name: f"{low.value:.3f} at {low.place:.1f} m to {high.value:.3f} at {high.place:.1f} m, "
        f"mean {map_.mean:.3f}; the rails differ by up to {abs(sides.value):.3f}",
    }
    if map_.below is not None:
        said[f"friction below {map_.below:g}"] = f"{map_.slippery:.1f} m: {places}{more}" if places else "none"
    return said


def document_of(check: Any, speed: float) -> dict[str, Any]:
    """Return the numbers of a line as a document, in SI units."""
    from dataclasses import asdict

    return {"speed": speed, **asdict(check)}

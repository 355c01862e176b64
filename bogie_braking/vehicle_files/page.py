"""Text and page of a checked vehicle."""

from __future__ import annotations

import base64
import html
import math
import textwrap
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from bogie_braking.hunting import FASTEST, FRICTION, HIGHEST, LARGE, TOLERANCE, motion_of
from bogie_braking.reporting.plots import saved
from bogie_braking.reporting.text_table import text_table
from bogie_braking.vehicle_files.check import (
    KILOMETRES_PER_HOUR,
    OVERDAMPED,
    RAILS,
    SPEEDS,
    Hunting,
    VehicleCheck,
)
from bogie_braking.vehicle_files.picture import picture
from products.vehicle_connections import table_of
from rbd_model.contact.creep.laws import DEFAULT_LAW
from readers.storage import write_whole

#: Speed of the stop in the first sentences [km/h].
LEAD_SPEED = 120
#: Ratio of both critical speeds below which the table has a note.
MUCH_BELOW = 0.95
#: A table: its title, names of its columns, rows.
Table = tuple[str, Sequence[str], Sequence[Sequence[str]]]


def tables_of(check: VehicleCheck) -> list[Table]:
    """Return the tables of a check: loads, stops, modes, critical speeds, connections, assumed values."""
    sheet = check.sheet
    found: list[Table] = [
        (
            f"{sheet.name}: {sheet.mass / 1e3:.2f} t on {sheet.axles} axles",
            ("axle", *map(str, range(1, sheet.axles + 1))),
            [("load [kN]", *(f"{load / 1e3:.1f}" for load in check.loads))],
        )
    ]
    if check.distances is not None:
        rows = [
            (f"{speed:g}", *("does not stop" if math.isnan(value) else f"{value:.0f}" for value in row))
            for speed, row in zip(SPEEDS, check.distances.tolist(), strict=True)
        ]
        rails = [f"{name} ({rail().friction:g})" for name, rail in RAILS.items()]
        title = "Stopping distance [m], full brake without wheel-slide protection, rails with their friction at rest"
        found.append((title, ("km/h", *rails), rows))
    if check.modes is not None:
        shown = [mode for mode in check.modes if mode.damping_ratio < OVERDAMPED]
        rows = [
            (f"{one.frequency:.2f}", f"{100 * one.damping_ratio:.0f} %", motion_of(one, sheet.vehicle)) for one in shown
        ]
        found.append((f"Natural modes at 36 km/h, up to {HIGHEST:g} Hz", ("Hz", "damping", "motion"), rows))
    if check.hunting is not None:
        found.append(critical_table(check, check.hunting))
    if sheet.parts.first:
        title = "Connections; places are ahead of the middle, to the left, above the rail [m]"
        found.append((title, ("name", "kind", "upper on lower", "place"), table_of(sheet.vehicle)))
    found.append(("Assumed, as the file does not give them", ("value", "source"), grouped(check)))
    return found


def critical_table(check: VehicleCheck, hunting: Hunting) -> Table:
    """Return the table of critical speeds, how they were computed, and a note if they differ much."""
    sheet = check.sheet
    dampers = [name for name in sheet.parameters.values() if name.endswith("_damping") and name != "contact_damping"]
    assumed = sum(name in sheet.assumed for name in dampers)
    large = f"runs from {1e3 * hunting.start:.1f} mm, creep law {DEFAULT_LAW}, tolerance {TOLERANCE:g}"
    rows = [
        ("small motion grows above", *speed_cells(hunting.linear), "eigenvalues, Kalker's linear creep"),
        ("large motion persists from", *speed_cells(hunting.large), large),
        ("profiles", "", "", ", ".join(path.name for path in sheet.profile_files) or "built-in synthetic pair"),
        ("dampers", "", "", f"{assumed} of {len(dampers)} assumed, as the {sheet.like}" if assumed else "of the file"),
    ]
    if hunting.large < MUCH_BELOW * hunting.linear:
        rows.append(("between both speeds", "", "", "a disturbance, such as a switch, can start lasting hunting"))
    elif hunting.linear < hunting.large:
        words = f"a large motion decays below {1e3 * LARGE:g} mm, a small one grows"
        rows.append(("between both speeds", "", "", words))
    title = f"Critical speeds on straight smooth track, friction {FRICTION:g}"
    return title, ("motion", "km/h", "m/s", "computed with"), rows


def speed_cells(speed: float) -> tuple[str, str]:
    """Return a critical speed in km/h and m/s; above the largest speed that is searched, this limit."""
    if math.isinf(speed):
        return f"none up to {FASTEST * KILOMETRES_PER_HOUR:.0f}", f"none up to {FASTEST:g}"
    return f"{speed * KILOMETRES_PER_HOUR:.0f}", f"{speed:.1f}"


def grouped(check: VehicleCheck) -> list[tuple[str, str]]:
    """Return the assumed values, those with one source in one row."""
    sources: dict[str, list[str]] = {}
    for name, source in check.sheet.assumed.items():
        sources.setdefault(source, []).append(name)
    return [(", ".join(names), source) for source, names in sources.items()]


def lead_of(check: VehicleCheck) -> str:
    """Return the first sentences of the page: readers, mass, a stop, what to compare, number of assumed values."""
    sheet = check.sheet
    said = ["For the author of the vehicle file, before its FMU is used or handed on."]
    said.append(f"Simulated from the file: {sheet.mass / 1e3:.1f} t on {sheet.axles} axles.")
    if check.distances is not None:
        metres = float(check.distances[SPEEDS.index(LEAD_SPEED), list(RAILS).index("dry")])
        stop = "does not stop" if math.isnan(metres) else f"stops in {metres:.0f} m"
        said.append(f"With full brake and no wheel-slide protection it {stop} from {LEAD_SPEED:g} km/h on dry rails.")
    said.append("Compare loads and distances with your data first.")
    count = len(sheet.assumed)
    said.append(f"{count or 'No'} value{' is' if count < 2 else 's are'} assumed{': the last table' if count else ''}.")
    return " ".join(said)


def text_of(check: VehicleCheck) -> str:
    """Return the tables as text."""
    rows: list[str] = []
    for title, names, cells in tables_of(check):
        lines = [names, *cells]
        if title.startswith("Assumed"):
            lines = [(f"{source}:", values) for values, source in cells]
            rows += [title, *(wrapped(f"{first} {second}") for first, second in lines), ""]
            continue
        rows += [title, *(f"  {line}" for line in text_table(lines, range(len(names)))), ""]
    return "\n".join(rows)


def wrapped(text: str) -> str:
    """Return a long row as lines of at most 100 letters."""
    return textwrap.fill(text, 100, initial_indent="  ", subsequent_indent="    ", break_on_hyphens=False)


def write_results(check: VehicleCheck, folder: Path) -> list[Path]:
    """Write the picture and the page of a check into a folder, and return their paths. Raises OSError."""
    folder.mkdir(parents=True, exist_ok=True)
    images, page = saved(partial(picture, check), folder / "vehicle.png"), folder / "vehicle.html"
    write_page(check, page, [image.read_bytes() for image in images])
    return [*images, page]


def write_page(check: VehicleCheck, path: Path, images: Sequence[bytes]) -> None:
    """Write the page of a check with its picture, one file. Raises OSError."""
    body = [f"<p>{html.escape(lead_of(check))}</p>"]
    body += [f'<img alt="the vehicle" src="data:image/png;base64,{base64.b64encode(png).decode()}">' for png in images]
    for title, names, cells in tables_of(check):
        head = "".join(f"<th>{html.escape(name)}</th>" for name in names)
        rows = "".join("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>\n" for row in cells)
        body.append(f"<h2>{html.escape(title)}</h2>\n<table>\n<tr>{head}</tr>\n{rows}</table>")
    name = html.escape(check.sheet.name)
    style = "body{font:16px sans-serif;max-width:62rem;margin:2rem auto;padding:0 1rem}img{max-width:100%}"
    style += "h2{font-size:1.2rem}"
    style += "td,th{text-align:left;padding:.2rem 1rem .2rem 0;vertical-align:top;border-bottom:1px solid #ddd}"
    style += "td,th{overflow-wrap:anywhere}"
    page = '<!doctype html>\n<html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width">'
    page += f"<title>{name}</title><style>{style}</style>\n<h1>{name}</h1>\n" + "\n".join(body) + "\n</html>\n"
    write_whole(path, page.encode())

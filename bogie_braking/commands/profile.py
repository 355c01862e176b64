"""The command `profile`: makes a contact table from files of a wheel and a rail, and draws the pair as it runs."""

from __future__ import annotations

import argparse
import json
import math
from pathlib import Path
from typing import Any

import numpy as np

from bogie_braking.common_options import add_speech, add_track, describe
from bogie_braking.exit_status import HOLDS
from bogie_braking.profiles.pair_picture import draw_pair
from bogie_braking.profiles.pair_running import COMPARED, FILE_AMPLITUDES, FILE_SHIFTS, WORDS, Running, running_of
from bogie_braking.profiles.profile_files import sides_from_files
from bogie_braking.profiles.smoothing_picture import draw_smoothing
from bogie_braking.reporting.plots import saved
from bogie_braking.reporting.scenario import Options
from rbd_model.contact.geometry import Side, Sides, contact_at
from rbd_model.contact.measured_pair import fault_at, gauge_of
from rbd_model.contact.pair_file import write_pair
from rbd_model.contact.pair_table import LARGEST_SHIFT
from rbd_model.contact.patches import patches_of, positions_of
from rbd_model.contact.profiles import Profile
from readers.command_line import check_folder, check_out, make_folder_of
from readers.text import BadInputError

ABOUT = """Make a contact table from the profiles of a wheel and a rail: tables of y and z, SIMPACK (.prw, .prr),
MiniProf (.whl, .ban, .mpt). The table is the value of profile_file of vehicles and FMUs. The command prints what it
applied, found and assumed, and draws contacts, patches, radius difference and conicity (EN 15302). A second picture
shows the smoothing of the profiles.

  bogie-braking profile wheel.prw rail.prr                       writes pair.csv, pair.png, pair-smoothing.png
  bogie-braking profile worn.whl 60e1.ban --inclination 40       a rail that stands upright in its file
  bogie-braking profile left.whl rail.ban --right-wheel right.whl --diameter 918 920
"""
#: Shifts at which the ends of the profiles are looked at [m].
EVERY = 0.5e-3


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of `profile`."""
    describe(parser, ABOUT)
    parser.add_argument("wheel", type=Path, help="profile of both wheels, or of the left one")
    parser.add_argument("rail", type=Path, help="profile of both rails, or of the left one")
    parser.add_argument("--right-wheel", type=Path, metavar="FILE", help="profile of the right wheel, if it differs")
    parser.add_argument("--right-rail", type=Path, metavar="FILE", help="profile of the right rail, if it differs")
    text = "contact table; the picture is beside it (default: pair.csv)"
    parser.add_argument("--out", type=Path, default=Path("pair.csv"), metavar="FILE", help=text)
    add_track(parser)
    add_speech(parser, "the findings", "no findings, only files and exit status")


def run(chosen: argparse.Namespace) -> int:
    """Write the contact table and the picture of a pair, and print the findings."""
    given = [one for one in (chosen.wheel, chosen.rail, chosen.right_wheel, chosen.right_rail) if one is not None]
    check_out(chosen.out, *given, *(Path(str(one).rsplit("#", 1)[0]) for one in given), picture=True)
    check_folder(chosen.out.parent)
    sides = sides_from_files(options_of(chosen))
    found = running_of(sides, FILE_SHIFTS, FILE_AMPLITUDES)
    patches = patches_by_side(sides)
    picture = chosen.out.with_suffix(".png")
    smoothing = picture.with_stem(f"{picture.stem}-smoothing")
    make_folder_of(picture)
    pictures = saved(lambda: draw_pair(found, patches, message(found, patches)), picture, dpi=110)
    pictures += saved(lambda: draw_smoothing(profiles_of(sides)), smoothing, dpi=110)
    about = findings(found, patches)
    if chosen.json:
        files = dict(zip(("picture", "picture of smoothing"), map(str, pictures), strict=False))
        print(json.dumps({**about, **files, "table": str(chosen.out)}, indent=2))
    elif not chosen.quiet:
        show(about)
        if pictures:
            print(f"Pictures: {', '.join(map(str, pictures))}")
    write_table(sides, chosen.out)
    if not (chosen.json or chosen.quiet):
        print(f"Contact table: {chosen.out}")
    return HOLDS


def write_table(sides: Sides, path: Path) -> None:
    """Write the contact table of a pair."""
    try:
        with np.errstate(invalid="ignore"):
            write_pair(sides, path)
    except BadInputError:
        raise
    except ValueError as error:
        names = " and ".join(dict.fromkeys(f"{one.wheel.name} on {one.rail.name}" for one in sides.both))
        raise BadInputError(
            f"Wheels must stay on the heads of their rails at shifts up to {1e3 * LARGEST_SHIFT:g} mm; {names} cannot "
            f"({error}). Give longer profiles, or check gauge and tape circle."
        ) from error


def options_of(chosen: argparse.Namespace) -> Options:
    """Return the options as those of scenarios, with the files of both sides."""
    wheels, rails = [chosen.wheel, chosen.right_wheel or chosen.wheel], [chosen.rail, chosen.right_rail or chosen.rail]
    names = ("diameter", "gauge", "flange_back", "inclination", "gauge_side", "tape_circle", "drop_outliers")
    return Options(wheel=wheels, rail=rails, **{name: getattr(chosen, name) for name in names})


Limits = dict[str, list[tuple[float, float]]]


def patches_by_side(sides: Sides) -> Limits:
    """Return the limits of each wheel's patches [m], from the field side to the flange."""
    found = {}
    for word, side in zip(WORDS, sides.both, strict=True):
        try:
            found[word] = limits_of(side)
        except ValueError as error:
            raise BadInputError(f"{side.wheel.name} on {side.rail.name}: {error}") from error
        if all(part.flange for part in patches_of(side)):
            low, high = 1e3 * found[word][-1][0], 1e3 * found[word][0][1]
            names = f"{side.wheel.name} on {side.rail.name}"
            raise BadInputError(
                f"The {word} wheel must bear on its tread; {names} bears only where it "
                f"is steeper than 20 degrees, y = {low:.4g} to {high:.4g} mm. Check gauge, tape circle and profiles."
            )
    return found


def limits_of(side: Side) -> list[tuple[float, float]]:
    """Return the limits of the patches of a wheel [m]."""
    places = positions_of(side)
    return [(float(places[part.first]), float(places[part.last - 1])) for part in patches_of(side)]


def profiles_of(sides: Sides) -> list[Profile]:
    """Return the different profiles of a pair, wheels first."""
    return list(dict.fromkeys([one.wheel for one in sides.both] + [one.rail for one in sides.both]))


def message(found: Running, patches: Limits) -> str:
    """Return the one message of the picture."""
    count = max(map(len, patches.values()))
    conicity = f"{found.conicity_at(COMPARED):.3f} at {1e3 * COMPARED:g} mm"
    return f"Conicity {conicity}, contact on {count} patch{'es' * (count > 1)} a wheel"


def findings(found: Running, patches: Limits) -> dict[str, Any]:
    """Return what was found, with units in the names."""
    gauge = gauge_of(found.sides)
    flanges = [None if math.isinf(flange) else round(1e3 * flange, 3) for flange in found.flanges]
    notes = found.notes_at(COMPARED)
    return {
        "equivalent conicity at 3 mm [1]": round(found.conicity_at(COMPARED), 5),
        "gauge [mm]": None if gauge is None else round(1e3 * gauge, 3),
        "shift of equal radii [mm]": round(1e3 * found.centre, 3),
        "flange contact, left and right [mm]": flanges,
        "patches, left and right": [len(patches[word]) for word in WORDS],
        "ends": ends(found),
        "notes": [*found.sides.notes, *(f"equivalent conicity at {1e3 * COMPARED:g} mm: {note}" for note in notes)],
    }


def ends(found: Running) -> list[str]:
    """Return a sentence for each side on which a contact reaches the end of a profile before the flange touches."""
    sentences = []
    for sign, flange, word in ((1, found.flanges[0], "left"), (-1, found.flanges[1], "right")):
        limit = min(flange, 1e-3 * math.floor(1e3 * float(found.series["shift"].max())))
        for shift in np.arange(0.0, limit, EVERY):
            fault = fault_at(found.sides, contact_at(found.sides, sign * shift, rolls=False))
            if fault and "flange" not in fault:
                sentences.append(f"{1e3 * shift:g} mm to the {word} {fault}: the profile must reach further")
                break
    return sentences


def show(about: dict[str, Any]) -> None:
    """Print findings and notes."""
    for name, value in about.items():
        if isinstance(value, list) and name in ("notes", "ends"):
            for sentence in value:
                print(f"  {sentence[0].upper()}{sentence[1:]}.")
        elif isinstance(value, list):
            values = " and ".join("none" if one is None else f"{one:g}" for one in value)
            print(f"{name:38s}{values}")
        else:
            print(f"{name:38s}{'unknown' if value is None else f'{value:g}'}")

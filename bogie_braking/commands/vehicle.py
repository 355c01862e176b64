"""Your own vehicle from a file with the numbers of its data sheet (TOML).

  bogie-braking vehicle check mine.toml                 axle loads, modes, critical speeds, stopping distances; page
  bogie-braking vehicle check mine.toml --quick         without modes and critical speeds
  bogie-braking vehicle fmu mine.toml --out mine.fmu    the FMU of the vehicle; no compiler for 2 and 4 axles
  bogie-braking vehicle parameters mine.toml            its parameters as mine.ssv, for an FMU that you have
  bogie-braking vehicle export coach --out coach.toml   a built-in vehicle as a file: coach, coal-wagon or bogie
  bogie-braking vehicle export eas-wagon                a vehicle from public data: also bpmz-coach, metro-car,
                                                        t3-tram, vectron-locomotive
  bogie-braking vehicle entries                         all entries of a file, with units and limits

A number without a unit is in SI units; "44 t" and "920 mm" are converted. Values that a file does not give are those of
the built-in vehicle that `like` names, and are listed as assumed.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping
from pathlib import Path

from bogie_braking.common_options import describe
from bogie_braking.exit_status import HOLDS
from fmu_src.suggestion import suggestion
from readers.command_line import check_folder, check_out, make_folder_of, whole
from readers.extras import need
from readers.quantity import Quantity
from readers.storage import write_whole
from readers.text import BadInputError, shown


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the actions of `vehicle` and their options."""
    describe(parser, __doc__)
    actions = parser.add_subparsers(dest="action", required=True, metavar="{check,fmu,parameters,export,entries}")
    check = actions.add_parser("check", help="loads, modes, critical speeds and stops of a file, with a page")
    check.add_argument("file", type=Path, help="the vehicle")
    check.add_argument("--quick", action="store_true", help="without modes and critical speeds")
    text = "folder of the page and its picture (default: results)"
    check.add_argument("--out", type=Path, default=Path("results"), help=text)
    fmu = actions.add_parser("fmu", help="write the FMU of a file")
    fmu.add_argument("file", type=Path, help="the vehicle")
    fmu.add_argument("--out", type=Path, help="the FMU (default: name of the file with .fmu)")
    level, text = whole("--level", 1, 3), "level of detail at the start (default: 2)"
    fmu.add_argument("--level", type=level, metavar="LEVEL", help=text)
    parameters = actions.add_parser("parameters", help="write the parameters of a file for an FMU (.ssv)")
    parameters.add_argument("file", type=Path, help="the vehicle")
    parameters.add_argument("--out", type=Path, help="the set (default: name of the file with .ssv)")
    export = actions.add_parser("export", help="write a built-in vehicle as a file")
    export.add_argument("name", help="coach, coal-wagon, bogie, or a vehicle from public data")
    export.add_argument("--out", type=Path, help="the file (default: NAME.toml)")
    actions.add_parser("entries", help="list the entries of a file")


def run(chosen: argparse.Namespace) -> int:
    """Run an action; return the exit status."""
    {
        "check": check,
        "fmu": write_fmu_of,
        "parameters": write_parameters,
        "export": export,
        "entries": lambda _: print(entries_text()),
    }[chosen.action](chosen)
    return HOLDS


def check(chosen: argparse.Namespace) -> None:
    """Print the numbers of a vehicle, and write its page and picture."""
    check_folder(chosen.out)
    need(*([] if chosen.quick else ["casadi"]))  # its modes are equations of its own
    from bogie_braking.vehicle_files import check as checking
    from bogie_braking.vehicle_files.page import text_of, write_results
    from products.vehicle_file import read_vehicle

    sheet = read_vehicle(chosen.file)
    found = checking.check_of(sheet, not chosen.quick, lambda text: print(f"{text} ...", file=sys.stderr))
    print(text_of(found))
    for path in write_results(found, chosen.out / f"vehicle-{chosen.file.stem}"):
        print(path)


def write_fmu_of(chosen: argparse.Namespace) -> None:
    """Write the FMU of a vehicle."""
    from bogie_braking.fmus import write_fmu
    from products.vehicle_file import read_vehicle

    sheet, path = read_vehicle(chosen.file), chosen.out or chosen.file.with_suffix(".fmu")
    if path.suffix != ".fmu":
        raise BadInputError(f"--out must end with .fmu; got {path}.")
    check_folder(path.parent)
    level = chosen.level or (None if sheet.fmu else 2)
    make_folder_of(path)
    print(f"{write_fmu(sheet, path, level=level)}  {sheet.name}, {sheet.mass / 1e3:.2f} t, {fmu_words(sheet.fmu)}")
    if sheet.brake and sheet.fmu != "braked-vehicle":
        torque = sheet.brake.full_torque
        print(f"Its inputs are brake torques: the full brake of the file is {torque:.0f} N.m on each wheelset.")
    print(f"{len(sheet.assumed)} values are assumed; 'bogie-braking vehicle check {chosen.file}' lists them.")


def fmu_words(name: str | None) -> str:
    """Return the source of an FMU in words."""
    return "its equations compiled" if name is None else f"the values of the file in the FMU {name}"


def write_parameters(chosen: argparse.Namespace) -> None:
    """Write the parameter set of a vehicle."""
    from fmu_src.parameter_file import parameter_file
    from products.building import variables_of
    from products.vehicle_file import read_vehicle
    from rbd_model.contact.pair_file import PAIR_FILE, joined

    sheet = read_vehicle(chosen.file)
    if sheet.parts.first:
        own = sheet.parts.first
        raise BadInputError(f"{own} must be left out for a parameter set; got one. Write its FMU: vehicle fmu.")
    if sheet.fmu is None:
        raise BadInputError(f"axles must be 2 or 4 for a parameter set; got {sheet.axles}. Write its FMU: vehicle fmu.")
    path = chosen.out or chosen.file.with_suffix(".ssv")
    check_out(path, chosen.file)
    check_folder(path.parent)
    text = f"{sheet.name}: {sheet.mass / 1e3:.2f} t, like the {sheet.like}"
    values: dict[str, float | str] = {**sheet.values}
    if sheet.profile_files:
        values[PAIR_FILE.variable.name] = joined(sheet.profile_files)
    make_folder_of(path)
    write_whole(path, parameter_file(sheet.name, text, values, variables_of(sheet.fmu).values()))
    print(f"{path}  for the FMU {sheet.fmu}")
    if sheet.profile_files:
        print(f"It names {joined(sheet.profile_files)}, which must stay there, for level 3.")


def export(chosen: argparse.Namespace) -> None:
    """Write a built-in vehicle as a file."""
    from products.vehicle_entries import LIKE
    from products.vehicle_toml import export_vehicle, names_of_examples

    names = [*LIKE, *names_of_examples()]
    if chosen.name not in names:
        near = suggestion(chosen.name, names)
        raise BadInputError(f"The vehicle must be one of {', '.join(names)}; got {shown(chosen.name)}, {near}")
    path = chosen.out or Path(f"{chosen.name}.toml")
    check_folder(path.parent)
    make_folder_of(path)
    print(export_vehicle(chosen.name, path))


#: Lines of the list for entries that are strings, by their table.
TEXTS = {
    "[brake]": ["acts_on            treads or discs"],
    "[[body]]": ["name               of its variables", "held               motions that it lacks, such as pitch"],
    "[[connection]]": [
        "name               of its variables; a built-in connection of this name is replaced",
        "kind               one of those below",
        "upper, lower       body, frame, leading_wheelset, front_frame, wheelset_1, a [[body]] and so on",
        "direction          longitudinal, lateral or vertical; of a torsion: angle, roll, pitch or yaw",
    ],
}


def entries_text() -> str:
    """Return the list of entries, with units and limits."""
    from products.vehicle_bodies import INERTIA, NUMBERS
    from products.vehicle_brakes import BRAKE_ENTRIES
    from products.vehicle_connections import KINDS, PLACE, SHORT, short_entries
    from products.vehicle_entries import ENTRIES, LIKE, RESISTANCE

    rows = [
        "name      any text",
        "connections  built-in (default), or file: without those of the built-in vehicle",
        "profile_file  contact table of 'bogie-braking profile', or a list with one for each wheelset, for level 3",
        *(f"like      {name}: {about}" for name, (about, _) in LIKE.items()),
    ]
    tables: dict[str, Mapping[str, Quantity]] = {"": ENTRIES}
    tables |= {"[resistance]": {key: entry for key, (_, entry) in RESISTANCE.items()}}
    tables |= {"[brake]": BRAKE_ENTRIES}
    tables |= {f"[{table}]": short_entries(table) for table in SHORT}
    tables |= {"[[body]]": {**NUMBERS, "inertia": INERTIA}, "[[connection]]": PLACE}
    tables |= {f'[[connection]] kind = "{name}": {kind.text}': kind.numbers for name, kind in KINDS.items()}
    for table, entries in tables.items():
        rows += ["", table] if table else [""]
        rows += TEXTS.get(table, [])
        for key, entry in entries.items():
            words = (
                entry.text if key == "friction_law" else f"{entry.text}, {entry.least:g} to {entry.most:g} {entry.unit}"
            )
            rows.append(f"{key.ljust(18)} {words.removesuffix(' 1')}")
    rows += ["", "[parameters]", "any parameter of the FMU's vehicle by its name; 'vehicle export coach' lists them"]
    return "\n".join(rows)

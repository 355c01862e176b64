"""Import trains of other programs, and check a consist: masses, brake weights, resistances, stopping distances.

  bogie-braking consist import freight.con                  what is read of an Open Rails train, and what is left
  bogie-braking consist import freight.con --out train.toml writes it as a consist
  bogie-braking consist check train.toml                    its vehicles, and stops from three speeds
  bogie-braking consist check train.csv --speeds 60 90 120  from other speeds [km/h]

`import` reads Open Rails and MSTS (.con, .eng, .wag), OSRD rolling stock (.json), ALTRIOS (.yaml), OpenBVE
(train.dat) and railML rolling stock (.xml, .railml). `check` and `bb.train` read these files too.

Exit status: 0 the file is a consist; 2 it is not, with one sentence; 3 the consist cannot be written or simulated.
"""

from __future__ import annotations

import argparse
import json
import textwrap
from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from bogie_braking.common_options import add_speech, describe
from bogie_braking.exit_status import HOLDS
from bogie_braking.reporting.text_table import text_table
from rbd_model.train.coupler import COUPLERS
from readers.command_line import quantity
from readers.formats.trains import FORMATS, is_foreign, program_of
from readers.import_account import Imported
from readers.text import BadInputError, shown

if TYPE_CHECKING:
    from products.train.summary import Summary

#: Speeds from which a train stops [km/h].
SPEEDS = (40.0, 80.0, 120.0)
#: Endings of consists.
OWN = (".toml", ".csv")
#: Width of sentences, and headings of the account of an import.
WIDTH = 110
HEADINGS = {"taken": "taken", "converted": "converted", "left": "left out", "assumed": "assumed"}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the actions `import` and `check`."""
    describe(parser, __doc__)
    actions = parser.add_subparsers(dest="action", required=True)
    one = actions.add_parser("import", help="read a train of another program, and account for its fields")
    one.add_argument("file", type=Path, metavar="FILE", help=f"a file in {', '.join(FORMATS)}")
    one.add_argument("--out", type=Path, metavar="FILE", help="write the consist, TOML or CSV by the end of the name")
    add_speech(one, "rows and sentences", "no account of the fields")
    one = actions.add_parser("check", help="print masses, brake weights, resistances and stopping distances")
    one.add_argument("file", type=Path, metavar="FILE", help="a consist (TOML, CSV), or a file that import reads")
    text = "speeds from which the train stops, as 80 or 22m/s (default: 40 80 120 km/h)"
    speed = quantity("--speeds", "km/h", 1.0, 300.0)
    one.add_argument("--speeds", type=speed, nargs="+", metavar="SPEED", default=list(SPEEDS), help=text)
    add_speech(one, "the numbers", "no table, only the exit status")


def run(chosen: argparse.Namespace) -> int:
    """Run an action; return its exit status."""
    return import_train(chosen) if chosen.action == "import" else check(chosen)


def import_train(chosen: argparse.Namespace) -> int:
    """Import a train, print the account of its fields, write it with --out."""
    from products.train.consist_writer import write_consist
    from products.train.imported_consist import imported_consist

    if chosen.file.suffix.lower() in OWN:
        raise BadInputError(
            f"{chosen.file} must be a train of another program; got a {chosen.file.suffix} file, as a consist is. Read "
            f"it by: bogie-braking consist check {chosen.file}"
        )
    if not is_foreign(chosen.file):
        raise BadInputError(
            f"{chosen.file} must end in one of {', '.join(FORMATS)}; got {shown(chosen.file.name)}. Rename it."
        )
    if chosen.out is not None and chosen.out.suffix.lower() not in OWN:
        raise BadInputError(f"--out must end in .toml or .csv; got {shown(chosen.out.name)}. Rename it.")
    try:
        consist, found = imported_consist(chosen.file)
    except ValueError as error:
        raise BadInputError(str(error)) from error
    if chosen.out is not None:
        write_consist(found.rows, chosen.out)
    if chosen.json:
        print(json.dumps(asdict(found), indent=2, ensure_ascii=False))
        return HOLDS
    if chosen.quiet:
        return HOLDS
    program, count = program_of(chosen.file), len(consist.vehicles)
    print(f"{chosen.file} ({program}): {_vehicles(count)}, {1e-3 * consist.mass:.1f} t, {consist.length:.1f} m\n")
    print("\n".join(account(found)))
    if chosen.out is None:
        print("\nNothing is written; --out train.toml writes the consist.")
    else:
        print(f"\nWritten: {chosen.out}. bogie-braking consist check {chosen.out} prints its brakes.")
    return HOLDS


def account(found: Imported) -> list[str]:
    """Return lines with what an import took, converted, left out and assumed."""
    lines = []
    for name, heading in HEADINGS.items():
        for number, sentence in enumerate(getattr(found, name)):
            start = f"{heading if number == 0 else '':<11}"
            lines += textwrap.wrap(sentence, WIDTH, initial_indent=start, subsequent_indent=" " * 13)
    return lines


def check(chosen: argparse.Namespace) -> int:
    """Print the numbers of a consist."""
    from products.train.imported_consist import consist_from
    from products.train.summary import summary_of

    try:
        consist, imported = consist_from(chosen.file)
        found = summary_of(consist, chosen.speeds)
    except ValueError as error:
        raise BadInputError(str(error)) from error
    if chosen.json:
        print(json.dumps(asdict(found), indent=2, ensure_ascii=False))
    elif not chosen.quiet:
        print(f"{chosen.file}: {_summary(found)}")
        if imported is not None:
            print(f"\n{len(imported.assumed)} assumptions: bogie-braking consist import {chosen.file} prints them.")
    return HOLDS


def _summary(found: Summary) -> str:
    """Return the lines about a train behind the name of its file."""
    head = ("vehicle", "kind", "count", "mass [t]", "length [m]", "lambda [%]", "N/t at 80 km/h", "by formula")
    rows = [
        (
            *(kind.name or "-", kind.kind, f"{kind.count}", f"{kind.mass:.2f}", f"{kind.length:.2f}"),
            *(f"{kind.percentage:.0f}", f"{kind.resistance:.1f}", f"{kind.resistance_by_formula:.1f} {kind.formula}"),
        )
        for kind in found.kinds
    ]
    names = ("speed [km/h]", "running resistance [kN]", "brake force [kN]", "emergency stop on level track [m]")
    numbers = [
        (
            f"{speed.speed:g}",
            f"{speed.resistance:.2f}",
            f"{speed.brake_force:.1f}",
            "does not stop" if speed.distance is None else f"{speed.distance:.0f}",
        )
        for speed in found.speeds
    ]
    first = (
        f"{_vehicles(found.vehicles)}, {found.mass:.1f} t, {found.length:.1f} m, "
        f"brake weight {found.brake_weight:.1f} t, lambda {found.percentage:.0f} %"
    )
    parts = [first, "", *text_table([head, *rows], (0, 1)), "", *text_table([names, *numbers])]
    return "\n".join([*parts, *_couplings(found), *_wrapped(found.remarks)])


def _wrapped(remarks: Iterable[str]) -> list[str]:
    return [line for remark in remarks for line in ("", *textwrap.wrap(remark, WIDTH))]


def _couplings(found: Summary) -> list[str]:
    """Return the lines about couplings; built-in ones are left out."""
    own = [coupling for coupling in found.couplings if coupling.name not in COUPLERS]
    if not own:
        return []
    head = (
        "coupler",
        "sense",
        "count",
        "stroke [mm]",
        "force [kN]",
        "energy [kJ]",
        "absorbed [%]",
        "reached at [km/h]",
    )
    rows = [
        (
            *(one.name, one.sense, f"{one.count}", f"{one.stroke:.0f}", f"{one.force:.0f}", f"{one.energy:.1f}"),
            *(f"{one.absorbed:.0f}", f"{one.speed:.1f}"),
        )
        for one in own
    ]
    return ["", *text_table([head, *rows], (0, 1))]


def _vehicles(count: int) -> str:
    return f"{count} vehicle{'' if count == 1 else 's'}"

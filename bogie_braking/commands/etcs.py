"""Braking curves of ETCS for a train: its data from own stops, all limits before a target, and stops that begin there.

  bogie-braking etcs train.toml --target 2000                        level line, end of authority at 2000 m
  bogie-braking etcs train.toml --target 2000 --line line.csv --speed 140km/h
  bogie-braking etcs train.toml --target 2000 --target-speed 40km/h  a lower speed instead of a stop
  bogie-braking etcs train.toml --target 2000 --dry 0.85 --wet 0.9   with the factors of its confidence level
  bogie-braking etcs train.toml --target 2000 --failure 0.1% --spread 5% --common 3% --level 9
                                                                     and with Kdry_rst of these failures and spreads
  bogie-braking etcs train.toml --target 2000 --tolerances brake.toml
                                                                     and with named ones, and which of them decides
  bogie-braking etcs train.toml --target 2000 --position "passenger P"
                                                                     by its brake percentage, not its decelerations
  bogie-braking etcs train.toml --target 2000 --national country.toml --level 7 --rounded
                                                                     in a country, as packets hold the numbers
  bogie-braking etcs train.json --target 2000                        train data, or an OSRD rolling stock: curves alone
  bogie-braking etcs train.toml --target 2000 --page out.html        all curves over the line, train data, settings
  bogie-braking etcs train.toml --target 2000 --json | jq .train     for a program

A train is a consist (TOML, CSV) or a file of another program (bogie-braking consist import). It stops twice on level
track, in emergency and in full service braking; these stops give deceleration by speed and build-up time. Its own stops
then begin where the emergency brake intervenes (EBI). Train data that this command writes (JSON), and an OSRD rolling
stock with etcs_brake_params, are read too. They have no vehicles, and so no own stops.

Exit status: 0 all own stops end before the target; 1 one does not; 2 bad input; 3 the simulation failed.
"""

from __future__ import annotations

import argparse
import json

from bogie_braking.braking_curves.options import add_all
from bogie_braking.common_options import describe
from bogie_braking.exit_status import DOES_NOT_HOLD, HOLDS


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    describe(parser, __doc__)
    add_all(parser)


def run(chosen: argparse.Namespace) -> int:
    """Compute, draw and print; return the exit status."""
    from bogie_braking.braking_curves.compute import compute
    from bogie_braking.braking_curves.files import check_files, write
    from bogie_braking.braking_curves.words import document, text

    check_files(chosen)
    found = compute(chosen)
    paths = write(found)
    if chosen.json:
        print(json.dumps(document(found) | {name: str(path) for name, path in paths.items()}, indent=2))
    elif not chosen.quiet:
        print("\n".join(text(found)), end="\n\n")
        for name, path in paths.items():
            print(f"{name.replace('_', ' ') + ':':<11} {path}")
    return HOLDS if all(stop.ends <= found.ends for stop in found.stops) else DOES_NOT_HOLD

"""Commands of the command line: a table, and a module for each.

The module of a command is imported only if that command is given. It has two functions, and may have a third:

  add_arguments(parser)   adds options; also the description
  run(chosen)             runs the command, returns its exit status
  names()                 returns what a shell completes as the argument `name`

A new command needs a line of the table and its module. Errors of `run` are handled for all (`failures.py`).
"""

from __future__ import annotations

import argparse
from collections.abc import Collection
from importlib import import_module
from typing import Any

from fmu_src import __name__ as place_of_a_room
from fmu_src import __version__
from readers.command_line import CommandLine

#: Prefix of the other packages: empty in a checkout, this package in a wheel.
BELOW = place_of_a_room.removesuffix("fmu_src")
#: Commands by name: help, and module.
COMMANDS = {
    "list": ("list all scenarios", "scenarios.commands.listing"),
    "doctor": ("say what is installed and what is missing, each with what to do", "bogie_braking.commands.doctor"),
    "completion": ("print a script with which a shell completes this command", "bogie_braking.commands.completion"),
    "run": ("run one scenario", "scenarios.commands.run"),
    "report": ("join all results into one page", "scenarios.commands.report"),
    "sweep": ("run one scenario over a grid of parameters", "scenarios.commands.sweep"),
    "pace": ("run an FMU in real time on this machine: longest step, overruns, jitter", "bogie_braking.commands.pace"),
    "controllers": (
        "compare wheel-slide controllers, a Python class, C or a library, on the test rig",
        "bogie_braking.commands.controllers",
    ),
    "consist": (
        "import a train of another program, or check a consist: masses, brakes, stops",
        "bogie_braking.commands.consist",
    ),
    "line": (
        "check a line and draw it; import points, elements, OSRD, railML, LandXML, ALTRIOS",
        "bogie_braking.commands.line",
    ),
    "profile": (
        "make a contact table from files of a wheel and a rail, and draw the pair",
        "bogie_braking.commands.profile",
    ),
    "live": ("write pages that brake a coach, a bogie or a train in any browser", "bogie_braking.commands.live"),
    "vehicle": ("check your own vehicle from a file, write its FMU", "bogie_braking.commands.vehicle"),
    "etcs": ("braking curves of ETCS for a train, and its own stops that begin there", "bogie_braking.commands.etcs"),
    "benchmark": (
        "answer published cases, beside other programs or yours: errors, cost, a page",
        "scenarios.commands.benchmark",
    ),
    "build": ("build FMUs", "bogie_braking.commands.build"),
}


def module_of(name: str) -> Any:
    """Import the module of a command."""
    place = COMMANDS[name][1]
    return import_module(place if place.startswith("bogie_braking.") else BELOW + place)


def parser_of(loaded: Collection[str], about: str | None = None) -> argparse.ArgumentParser:
    """Return the command line."""
    shape = argparse.RawDescriptionHelpFormatter
    parser = CommandLine(prog="bogie-braking", description=about, formatter_class=shape)
    parser.add_argument("--version", action="version", version=f"bogie-braking {__version__}")
    commands = parser.add_subparsers(dest="command", required=True)
    for name, (text, _) in COMMANDS.items():
        of_command = commands.add_parser(name, help=text)
        if name in loaded:
            module_of(name).add_arguments(of_command)
    return parser

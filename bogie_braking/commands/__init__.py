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
    "run": ("run a scenario: table, data, figure", "scenarios.commands.run"),
    "list": ("list all scenarios", "scenarios.commands.listing"),
    "consist": ("check a train, or import it from another program", "bogie_braking.commands.consist"),
    "controllers": ("score wheel-slide controllers on the test rig", "bogie_braking.commands.controllers"),
    "etcs": ("braking curves of ETCS for a train", "bogie_braking.commands.etcs"),
    "vehicle": ("check your vehicle from a file, write its FMU", "bogie_braking.commands.vehicle"),
    "line": ("check and draw a line, or import it", "bogie_braking.commands.line"),
    "profile": ("contact table of a measured wheel and rail", "bogie_braking.commands.profile"),
    "build": ("list or build FMUs", "bogie_braking.commands.build"),
    "live": ("write pages that brake in any browser", "bogie_braking.commands.live"),
    "sweep": ("run a scenario over a grid of parameters", "scenarios.commands.sweep"),
    "report": ("join all results into one page", "scenarios.commands.report"),
    "benchmark": ("published cases, by this and other programs", "scenarios.commands.benchmark"),
    "pace": ("run an FMU in real time: longest step, overruns", "bogie_braking.commands.pace"),
    "doctor": ("say what is installed, and what is missing", "bogie_braking.commands.doctor"),
    "completion": ("print a script for completion in a shell", "bogie_braking.commands.completion"),
}


def module_of(name: str) -> Any:
    """Import the module of a command."""
    place = COMMANDS[name][1]
    return import_module(place if place.startswith("bogie_braking.") else BELOW + place)


def parser_of(loaded: Collection[str], about: str | None = None) -> argparse.ArgumentParser:
    """Return the command line; about: its description, to which the commands are added; None: each has its own help."""
    listed = "\n".join(f"  {name:<12} {text}" for name, (text, _) in COMMANDS.items())
    described: dict[str, Any] = {"description": f"{about.rstrip()}\n{listed}"} if about else {}
    shape = argparse.RawDescriptionHelpFormatter
    parser = CommandLine(prog="bogie-braking", formatter_class=shape, **described)
    parser.add_argument("--version", action="version", version=f"bogie-braking {__version__}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND", help="one of the above")
    for name, (text, _) in COMMANDS.items():
        own: dict[str, Any] = {} if about else {"help": text}
        of_command = commands.add_parser(name, **own)
        if name in loaded:
            module_of(name).add_arguments(of_command)
    return parser

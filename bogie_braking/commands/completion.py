"""The command `completion`: prints a script with which a shell completes the command line."""

from __future__ import annotations

import argparse

from bogie_braking.commands import COMMANDS, module_of, parser_of
from bogie_braking.completion import SHELLS, completion
from bogie_braking.exit_status import HOLDS


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the name of the shell."""
    parser.add_argument("shell", choices=SHELLS)


def run(chosen: argparse.Namespace) -> int:
    """Print the script."""
    modules = {name: module_of(name) for name in COMMANDS}
    names = {name: module.names() for name, module in modules.items() if hasattr(module, "names")}
    print(completion(parser_of(COMMANDS), names, chosen.shell))
    return HOLDS

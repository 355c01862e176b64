"""The command `completion`: prints a script with which a shell completes the command line."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import shtab

from bogie_braking.commands import COMMANDS, module_of, parser_of
from bogie_braking.exit_status import HOLDS
from readers.extras import MissingExtraError

SHELLS = shtab.SUPPORTED_SHELLS
#: Name of the entry point in pyproject.toml; shells cannot complete `python -m`.
COMMAND = "bogie-braking"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the name of the shell."""
    parser.add_argument("shell", choices=SHELLS)


def run(chosen: argparse.Namespace) -> int:
    """Print the script."""
    modules: dict[str, Any] = {}
    for name in COMMANDS:
        with suppress(MissingExtraError):  # scenarios need packages that may be missing
            modules[name] = module_of(name)
    names = {name: module.names() for name, module in modules.items() if hasattr(module, "names")}
    parser = parser_of(modules)
    parser.prog = COMMAND
    complete(parser, names, "")
    print(shtab.complete(parser, chosen.shell))
    return HOLDS


def complete(parser: argparse.ArgumentParser, names: Mapping[str, Sequence[str]], command: str) -> None:
    """Let a shell complete names and files in a command and in the commands below it."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for name, below in action.choices.items():
                complete(below, names, command or name)
        elif action.dest == "name" and command in names:
            action.choices = names[command]
        elif action.type is Path:
            action.complete = shtab.FILE  # type: ignore[attr-defined]

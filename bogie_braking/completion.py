"""Completion of the command `bogie-braking` in a shell."""

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path

import shtab

SHELLS = shtab.SUPPORTED_SHELLS
#: Name of the entry point in pyproject.toml; shells cannot complete `python -m`.
COMMAND = "bogie-braking"


def completion(parser: argparse.ArgumentParser, names: Mapping[str, Sequence[str]], shell: str) -> str:
    """Return the completion script of a shell.

    The parser is changed and must not be used afterwards: its error messages would list all names.
    """
    parser.prog = COMMAND
    complete(parser, names, "")
    return shtab.complete(parser, shell)


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

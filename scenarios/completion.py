"""Completion of the command `bogie-braking` in a shell."""

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path

import shtab

SHELLS = shtab.SUPPORTED_SHELLS
#: Name of the entry point in pyproject.toml; shells cannot complete `python -m`.
COMMAND = "bogie-braking"


def completion(
    parser: argparse.ArgumentParser,
    commands: Mapping[str, argparse.ArgumentParser],
    names: Mapping[str, Sequence[str]],
    shell: str,
) -> str:
    """Return the completion script of a shell.

    The parser is changed and must not be used afterwards: its error messages would list all names.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        The command line.
    commands : mapping of str to argparse.ArgumentParser
        Its commands, whose options and files are completed.
    names : mapping of str to sequence of str
        Scenarios that each command takes.
    shell : str
        Name of the shell.
    """
    parser.prog = COMMAND
    for command, subparser in commands.items():
        for action in subparser._actions:
            if action.dest == "name":
                action.choices = names[command]
            elif action.type is Path:
                action.complete = shtab.FILE  # type: ignore[attr-defined]
    return shtab.complete(parser, shell)

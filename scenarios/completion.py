"""Completion of the command `bogie-braking` in a shell."""

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path

import shtab

SHELLS = shtab.SUPPORTED_SHELLS
#: What pip makes of the entry point in pyproject.toml; no shell completes what stands behind `python -m`.
COMMAND = "bogie-braking"


def completion(
    parser: argparse.ArgumentParser,
    commands: Mapping[str, argparse.ArgumentParser],
    names: Mapping[str, Sequence[str]],
    shell: str,
) -> str:
    """A script for a shell: commands, their options, files, and the `names` of scenarios that a command takes.

    The parser serves for nothing else afterwards: it would list all names where it refuses one.
    """
    parser.prog = COMMAND
    for command, subparser in commands.items():
        for action in subparser._actions:
            if action.dest == "name":
                action.choices = names[command]
            elif action.type is Path:
                action.complete = shtab.FILE  # type: ignore[attr-defined]
    return shtab.complete(parser, shell)

"""The command `controllers`: compares wheel-slide controllers, replays logs, runs the rig behind a socket."""

from __future__ import annotations

import argparse

from bogie_braking.common_options import add_speech, bars, describe
from bogie_braking.controllers import command
from bogie_braking.exit_status import DOES_NOT_HOLD, HOLDS
from readers.command_line import check_folder

#: Actions that write into the folder of --out.
WRITING = {"compare", "report", "replay", "loop"}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the actions on controllers."""
    describe(parser, command.__doc__)
    command.add_commands(parser, lambda action: add_speech(action, "the comparison"))


def run(chosen: argparse.Namespace) -> int:
    """Run an action; return DOES_NOT_HOLD if a controller did not stop, was not accepted, or missed a period."""
    if chosen.action in WRITING:
        check_folder(chosen.out)
    with bars(chosen):
        return HOLDS if command.run(chosen) else DOES_NOT_HOLD

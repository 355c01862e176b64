"""The command `sweep`: runs a scenario over a grid of parameters."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from bogie_braking.common_options import add_out, add_speech, bars, describe
from bogie_braking.exit_status import DOES_NOT_HOLD, HOLDS
from readers.command_line import check_folder
from scenarios.catalogue import SCENARIOS
from scenarios.commands import sweeping as sweep


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of `sweep`."""
    describe(parser, sweep.__doc__)
    sweep.add_arguments(parser)
    add_out(parser)
    add_speech(parser)


def names() -> Sequence[str]:
    """Return the names of scenarios that can be swept."""
    return [scenario.name for scenario in SCENARIOS if scenario.sweep]


def run(chosen: argparse.Namespace) -> int:
    """Run or resume a sweep; return DOES_NOT_HOLD if a point failed."""
    check_folder(chosen.out)
    with bars(chosen):
        return HOLDS if sweep.run(chosen) else DOES_NOT_HOLD

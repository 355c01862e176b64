"""The command `pace`: runs an FMU in real time."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from bogie_braking import pace
from bogie_braking.common_options import add_speech, bars, describe
from bogie_braking.exit_status import DOES_NOT_HOLD, HOLDS
from products.registry import ALIASES, FMUS


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of `pace`."""
    describe(parser, pace.__doc__)
    pace.add_arguments(parser)
    add_speech(parser)


def names() -> Sequence[str]:
    """Return the names of FMUs, their aliases, and the levels of the bogie."""
    return [*FMUS, *ALIASES, *pace.LEVELS]


def run(chosen: argparse.Namespace) -> int:
    """Run in real time; return DOES_NOT_HOLD if a step overran."""
    with bars(chosen):
        return HOLDS if pace.run(chosen) else DOES_NOT_HOLD

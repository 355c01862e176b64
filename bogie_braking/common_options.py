"""Options that several commands have."""

from __future__ import annotations

import argparse
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Any

from fmu_src.progress import without_bars
from readers.command_line import quantity

#: Help of --quiet.
QUIET = "no progress and no table, only the exit status"


def describe(parser: argparse.ArgumentParser, text: str | None) -> None:
    """Set the description of a command, whose lines are kept."""
    parser.description, parser.formatter_class = text, argparse.RawDescriptionHelpFormatter


def add_speech(parser: argparse.ArgumentParser, document: str = "the summary", quiet: str = QUIET) -> None:
    """Add --quiet and --json to a command; document: what --json prints."""
    group = parser.add_mutually_exclusive_group()
    group.add_argument("--quiet", action="store_true", help=quiet)
    group.add_argument("--json", action="store_true", help=f"{document} as one JSON document")


def add_out(parser: argparse.ArgumentParser, text: str = "folder of the results") -> None:
    """Add --out to a command."""
    parser.add_argument("--out", type=Path, default=Path("results"), help=f"{text} (default: results)")


def add_track(group: argparse._ActionsContainer) -> None:
    """Add options that lay wheels and rails from files."""
    sides: dict[str, Any] = {"nargs": "+", "action": "extend"}
    text = "diameter of both wheels at the tape circle, or left and right, as 920 or 0.92m (default: 920 mm)"
    group.add_argument("--diameter", type=quantity("--diameter", "mm"), metavar="MM", help=text, **sides)
    text = "gauge, measured 14 mm below the top (default: that of the file, or 1435 mm)"
    group.add_argument("--gauge", type=quantity("--gauge", "mm"), metavar="MM", help=text)
    text = "distance between the backs of the flanges (default: 1360 mm)"
    group.add_argument("--flange-back", type=quantity("--flange-back", "mm"), metavar="MM", help=text)
    text = "inclines the rails by 1:N, for files in which they stand upright (default: as in the files)"
    group.add_argument("--inclination", type=quantity("--inclination"), metavar="N", help=text)
    text = "side of y in the rails' files that is turned to the middle of the track (default: found by lean or wear)"
    group.add_argument("--gauge-side", choices=("y-", "y+"), help=text, **sides)
    text = "y of the tape circle in the wheels' files (default: found from the back of the flange)"
    group.add_argument("--tape-circle", type=quantity("--tape-circle", "mm"), metavar="MM", help=text, **sides)
    text = "leave out points off the contour, and name them (default: refused)"
    group.add_argument("--drop-outliers", action="store_true", default=None, help=text)


def bars(chosen: argparse.Namespace) -> AbstractContextManager[object]:
    """Return a context that hides progress bars with --quiet."""
    return without_bars() if chosen.quiet else nullcontext()

"""Options that several commands have."""

from __future__ import annotations

import argparse
from contextlib import AbstractContextManager, nullcontext
from importlib.util import find_spec
from pathlib import Path

from fmu_src.progress import without_bars
from readers.text import BadInputError

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


def bars(chosen: argparse.Namespace) -> AbstractContextManager[object]:
    """Return a context that hides progress bars with --quiet."""
    return without_bars() if chosen.quiet else nullcontext()


def look_for_plotly() -> None:
    """Raise BadInputError before a run if Plotly, an optional dependency, is not installed."""
    if find_spec("plotly") is None:
        raise BadInputError("A page of results needs Plotly: pip install 'bogie-braking[pages]'.")

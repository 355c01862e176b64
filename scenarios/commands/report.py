"""The command `report`: joins the results of a folder into one page."""

from __future__ import annotations

import argparse
import sys

from bogie_braking.common_options import add_out, look_for_plotly
from bogie_braking.exit_status import HOLDS
from readers.command_line import check_folder


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of `report`."""
    add_out(parser)


def run(chosen: argparse.Namespace) -> int:
    """Join all results of a folder into one page, and print which are left out."""
    check_folder(chosen.out)
    look_for_plotly()
    from scenarios.commands.results_page import write_index

    page, skipped = write_index(chosen.out)
    for sentence in skipped:
        print(sentence, file=sys.stderr)
    print(f"Index: {page}")
    return HOLDS

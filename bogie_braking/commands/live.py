"""The command `live`: writes the pages that simulate in a browser."""

from __future__ import annotations

import argparse

from bogie_braking.common_options import add_out
from bogie_braking.exit_status import HOLDS
from bogie_braking.live.page import write_page
from bogie_braking.live.train_page import PAGE as TRAIN_PAGE
from bogie_braking.live.train_page import write_train_page
from products.prebuilt import PAGE
from readers.command_line import check_folder


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of `live`."""
    add_out(parser, "folder of both pages")


def run(chosen: argparse.Namespace) -> int:
    """Write both pages and print their addresses."""
    check_folder(chosen.out)
    pages = write_page(chosen.out / PAGE), write_train_page(chosen.out / TRAIN_PAGE)
    print("Open in a browser:", *(page.resolve().as_uri() for page in pages), sep="\n")
    return HOLDS

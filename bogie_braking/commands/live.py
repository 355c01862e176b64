"""Write the pages that simulate in a browser: a vehicle, and a train.

  bogie-braking live                                           both pages
  bogie-braking live --consist mytrain.toml --line line.csv    the train's page with a train and a line of yours

The page is one file that needs no network. Its *copy link* gives an address with the same train and run, which opens on
any page of this version.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from bogie_braking.common_options import add_out, describe
from bogie_braking.exit_status import HOLDS
from bogie_braking.live.carried_train import carried_from
from bogie_braking.live.page import write_page
from bogie_braking.live.train_page import PAGE as TRAIN_PAGE
from bogie_braking.live.train_page import write_train_page
from products.prebuilt import PAGE
from readers.command_line import check_folder
from readers.text import BadInputError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of `live`."""
    describe(parser, __doc__)
    add_out(parser, "folder of the pages")
    text = "of the train: CSV, TOML, or a file of another program (default with --line: a locomotive and 20 wagons)"
    parser.add_argument("--consist", type=Path, metavar="FILE", help=text)
    text = "of the train: a line, points, elements or a map (default: straight and level)"
    parser.add_argument("--line", type=Path, metavar="FILE", help=text)


def run(chosen: argparse.Namespace) -> int:
    """Write the pages and print their addresses."""
    check_folder(chosen.out)
    if chosen.consist or chosen.line:
        try:
            own = carried_from(chosen.consist, chosen.line)
        except ValueError as error:
            raise BadInputError(str(error)) from error
        pages = [write_train_page(chosen.out / TRAIN_PAGE, own)]
    else:
        pages = [write_page(chosen.out / PAGE), write_train_page(chosen.out / TRAIN_PAGE)]
    print("Open in a browser:", *(page.resolve().as_uri() for page in pages), sep="\n")
    return HOLDS

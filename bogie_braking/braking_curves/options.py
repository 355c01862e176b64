"""Options of the command `etcs`."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

from bogie_braking.common_options import add_out, add_speech
from readers.command_line import quantity, whole

BASELINES, POSITIONS = ("3.3.0", "4.0.0"), ("passenger P", "freight P", "freight G")
KINDS = ("EOA", "LOA", "MRSP")


def share(name: str) -> Callable[[str], float]:
    """Return the reader of a share of 0 to 50 %, whose result is a number from 0 to 0.5; it must state its unit."""
    read = quantity(name, "%", 0.0, 50.0)

    def with_unit(text: str) -> float:
        found = read(text)
        if not text.strip().endswith("%"):
            raise argparse.ArgumentTypeError(f"{name} must have its unit, %; got {text}. Write {found:g}%, or another.")
        return found / 100.0

    return with_unit


def add_all(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    parser.add_argument(
        "file", type=Path, metavar="FILE", help="a consist, a file that consist import reads, or train data"
    )
    _add_target(parser)
    _add_train(parser)
    _add_factors(parser)
    _add_country(parser)
    _add_files(parser)
    add_speech(parser, "train data, limits and stops", "no table, only the exit status")


def _add_target(parser: argparse.ArgumentParser) -> None:
    place = quantity("--target", "m", 0.0, 1e6)
    parser.add_argument(
        "--target", type=place, required=True, metavar="PLACE", help="place of the target, as 2000 or 2km"
    )
    speed = quantity("--speed", "km/h", 5.0, 400.0)
    text = "largest speed of the train, as 140 or 38.9m/s (default: V_MAXTRAIN of train data, else 120 km/h)"
    parser.add_argument("--speed", type=speed, metavar="SPEED", help=text)
    speed = quantity("--target-speed", "km/h", 0.0, 400.0)
    text = "speed at the target (default: 0, an end of authority); own stops need an end of authority"
    parser.add_argument("--target-speed", type=speed, metavar="SPEED", default=0.0, help=text)
    text = (
        "kind of target: end of authority, limit of authority, lower permitted speed of --target-speed, 0 without it "
        "(default: EOA, or LOA if it moves)"
    )
    parser.add_argument("--kind", choices=KINDS, help=text)
    beyond = quantity("--beyond", "m", 0.0, 1e4)
    text = "distance of the supervised location behind the end of authority (default: 0)"
    parser.add_argument("--beyond", type=beyond, metavar="LENGTH", default=0.0, help=text)
    text = "line whose gradients act on limits and own stops, and its friction on own stops (default: level)"
    parser.add_argument("--line", type=Path, metavar="FILE", help=text)


def _add_train(parser: argparse.ArgumentParser) -> None:
    text = "take the conversion model of the train's brake percentage, in this brake position"
    parser.add_argument("--position", choices=POSITIONS, help=text)
    parser.add_argument("--service", action="store_true", help="the on-board unit commands the service brake too")


def _add_factors(parser: argparse.ArgumentParser) -> None:
    for name, words in (("--dry", "Kdry_rst"), ("--wet", "Kwet_rst")):
        factor = quantity(name, "1", 0.05, 1.55)
        parser.add_argument(name, type=factor, metavar="FACTOR", default=1.0, help=f"{words} (default: 1, no margin)")
    text = "probability that the brake of a vehicle does not act, as 0.1%% (default: 0)"
    parser.add_argument("--failure", type=share("--failure"), metavar="SHARE", default=0.0, help=text)
    text = "standard deviation of a vehicle's brake force over its nominal force, as 5%% (default: 0)"
    parser.add_argument("--spread", type=share("--spread"), metavar="SHARE", default=0.0, help=text)
    text = "standard deviation that all vehicles share, of friction for example, as 3%% (default: 0)"
    parser.add_argument("--common", type=share("--common"), metavar="SHARE", default=0.0, help=text)
    text = "Kdry_rst and T_brake_emergency by the table [tolerances] of a TOML file"
    parser.add_argument("--tolerances", type=Path, metavar="FILE", help=text)
    text = "confidence level of Kdry_rst, M_NVEBCL (default: that of the country, 9, a weaker brake once in 1e9)"
    parser.add_argument("--level", type=whole("--level", 0, 9), metavar="LEVEL", help=text)


def _add_country(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--baseline", choices=BASELINES, default=BASELINES[0], help="default: %(default)s")
    text = "national values by the names of packet 3, a TOML file (default: those of SUBSET-026, A.3.2)"
    parser.add_argument("--national", type=Path, metavar="FILE", help=text)
    parser.add_argument("--slippery", action="store_true", help="limit the deceleration to that of reduced adhesion")
    text = "round train data and national values as their packets hold them, to the safe side"
    parser.add_argument("--rounded", action="store_true", help=text)


def _add_files(parser: argparse.ArgumentParser) -> None:
    add_out(parser)
    parser.add_argument("--page", type=Path, metavar="FILE", help="also write a page (.html) that needs no other file")
    text = "also write the ETCS brake as OSRD has it, length and etcs_brake_params (.json)"
    parser.add_argument("--osrd", type=Path, metavar="FILE", help=text)

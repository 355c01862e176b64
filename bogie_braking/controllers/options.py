"""Options that several actions on controllers share: draws, cases, settings of all stops."""

from __future__ import annotations

import argparse
import difflib
from collections.abc import Mapping
from dataclasses import fields, replace
from pathlib import Path

from bogie_braking.controllers.controller_loader import Given
from bogie_braking.controllers.scoring import FEW, LOOKS, DrawsPlan
from bogie_braking.reporting.scenario import BadInputError
from products.controller_kinds import InC
from products.machine import MACHINES, Machine
from products.protection.own_process import Apart
from products.protection.programme import PROGRAMMES, Case, four_rails, read_programme
from products.protection.rails import RAILS
from products.protection.settings import (
    FASTEST,
    LONGEST_PERIOD,
    MOST_BRAKE_RATIO,
    MOST_JITTER,
    MOST_PULSES,
    SHORTEST_PERIOD,
    Settings,
)
from products.protection.spread import LARGEST_SPREAD, Spread
from products.protection.vehicle_of_file import ENDING, vehicle_of_file, with_own_brake
from products.registry import ALIASES, fmu_named
from readers.command_line import quantity, whole
from readers.text import FileError, shown

#: Largest number of draws of a case.
MOST_DRAWS = 10_000


def add_draws(parser: argparse.ArgumentParser) -> None:
    """Add the options of the draws."""
    text = f"most draws of a case, 1 to {MOST_DRAWS} (default: {LOOKS[-1]}; {FEW} with a controller in Python)"
    parser.add_argument("--draws", type=whole("--draws", 1, MOST_DRAWS), metavar="N", help=text)
    text = "seed of the draws, from 0 (default: 1)"
    parser.add_argument("--seed", type=whole("--seed", 0, 2**31 - 1), default=1, metavar="N", help=text)
    for name in ("friction", "load"):
        usual = getattr(Spread(), name)
        text = f"half width of the spread of {name}, 0 to {LARGEST_SPREAD:g} (default: {usual:g})"
        one = quantity(f"--{name}-spread", least=0.0, most=LARGEST_SPREAD)
        parser.add_argument(f"--{name}-spread", type=one, default=usual, metavar="SHARE", help=text)


def plan_of(chosen: argparse.Namespace, controllers: Mapping[str, Given]) -> tuple[DrawsPlan, str]:
    """Return the requested draws, and the controller because of which they are few."""
    slow = next((name for name, one in controllers.items() if not (one is None or isinstance(one, InC | Apart))), "")
    spread = Spread(chosen.friction_spread, chosen.load_spread, chosen.jitter)
    if chosen.draws:
        return DrawsPlan(spread, chosen.seed, chosen.draws), ""
    return DrawsPlan(spread, chosen.seed, FEW if slow else LOOKS[-1]), slow


def add_case(parser: argparse.ArgumentParser) -> None:
    """Add the options of a single stop."""
    text = f"one of {','.join(rail.name for rail in RAILS)}, or a case of the programme (default: low)"
    parser.add_argument("--rail", default="low", metavar="NAME", help=text)
    parser.add_argument("--programme", metavar="FILE", help="a TOML file with cases, full or starts")
    parser.set_defaults(rails="")
    add_settings(parser)


def add_settings(parser: argparse.ArgumentParser, jitter: float = 0.0) -> None:
    """Add the options of all stops; jitter: its default."""
    own = " and ".join(f"{own} = {name}" for own, name in ALIASES.items())
    text = f"{', '.join(MACHINES)} ({own}), or a vehicle file, FILE.toml (default: bogie)"
    parser.add_argument("--vehicle", type=vehicle_named, default="bogie", metavar="VEHICLE", help=text)
    speed = quantity("--speed", "m/s", 0.0, FASTEST, above=True)
    text = "at the start, as 25 or 90km/h (default: 25 m/s)"
    parser.add_argument("--speed", type=speed, default=25.0, metavar="SPEED", help=text)
    brake_ratio = quantity("--brake-ratio", least=0.0, most=MOST_BRAKE_RATIO, above=True)
    text = "torque over that of the full brake (default: 1)"
    parser.add_argument("--brake-ratio", type=brake_ratio, default=1.0, metavar="RATIO", help=text)
    period = quantity("--period", "s", SHORTEST_PERIOD, LONGEST_PERIOD)
    text = "of the controllers, as 5ms or 0.005 (default: 5ms)"
    parser.add_argument("--period", type=period, default=5e-3, metavar="TIME", help=text)
    text = f"of each speed sensor in a revolution, 1 to {MOST_PULSES} (default: {Settings.pulses})"
    pulses = whole("--pulses", 1, MOST_PULSES)
    parser.add_argument("--pulses", type=pulses, default=Settings.pulses, metavar="COUNT", help=text)
    words = f"0 to {MOST_JITTER:g} (default: {jitter:g})"
    text = f"standard deviation of the pulses' places, as a share of the pitch, {words}"
    one = quantity("--jitter", least=0.0, most=MOST_JITTER)
    parser.add_argument("--jitter", type=one, default=jitter, metavar="SHARE", help=text)
    parser.add_argument("--out", type=Path, default=Path("results"), help="folder of the results (default: results)")


def vehicle_named(text: str) -> str:
    """Return the name of a built-in vehicle, or the path of a vehicle file. Raises argparse.ArgumentTypeError."""
    name = fmu_named(text)
    if name not in MACHINES and not text.endswith(ENDING):
        known = [*MACHINES, *ALIASES]
        words = f"--vehicle must be one of {', '.join(known)}, or FILE{ENDING}; got {shown(text)}."
        near = difflib.get_close_matches(text, known, 1)
        raise argparse.ArgumentTypeError(f"{words} Did you mean {near[0]}?" if near else words)
    return name


def rigged(chosen: argparse.Namespace) -> tuple[Machine, Settings, list[Case]]:
    """Return the requested vehicle, the settings of its stops, and its cases; a vehicle file has its own brake."""
    settings, cases = settings_of(chosen), cases_of(chosen)
    if chosen.vehicle in MACHINES:
        return MACHINES[chosen.vehicle](), settings, cases
    try:
        machine, brake = vehicle_of_file(Path(chosen.vehicle))
    except FileError as error:
        raise BadInputError(str(error)) from None
    return machine, replace(settings, application_time=brake.application_time), with_own_brake(cases, brake)


def cases_of(chosen: argparse.Namespace) -> list[Case]:
    """Return the requested cases."""
    if chosen.programme:
        path = PROGRAMMES.get(chosen.programme) or Path(chosen.programme)
        try:
            return read_programme(path)
        except OSError:
            raise BadInputError(f"There is no file {path}; give a case file, or {' or '.join(PROGRAMMES)}.") from None
        except ValueError as error:
            raise BadInputError(str(error)) from None
    known = {case.name: case for case in four_rails()}
    names = [name.strip() for name in chosen.rails.split(",") if name.strip()] or list(known)
    for name in names:
        if name not in known:
            raise BadInputError(f"There is no rail {name}; give some of {', '.join(known)}.")
        if names.count(name) > 1:
            raise BadInputError(f"Each of --rails must be given once; got {name} {names.count(name)} times.")
    return [known[name] for name in names]


def settings_of(chosen: argparse.Namespace) -> Settings:
    """Return the settings that the command line requests. Raises BadInputError."""
    given = {field.name: getattr(chosen, field.name) for field in fields(Settings) if hasattr(chosen, field.name)}
    try:
        return Settings(**given)
    except ValueError as error:
        raise BadInputError(str(error)) from None

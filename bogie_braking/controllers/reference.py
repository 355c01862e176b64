"""Write the built-in protection as a C library with reference stops, or check a port of it by these stops.

  bogie-braking controllers reference -o protection       C files, and reference.csv: readings in, commands out
  bogie-braking controllers reference --check libmine.so  a port as a controller: a library, C, a class, an FMU
  bogie-braking controllers reference --check mine.csv    the table again, with the commands that a port computed

reference.csv has a row for each sample: stop, period, time [s], wheel speeds [m/s], commands (0 apply, 1 hold, 2 vent).
Cells of wheelsets that a stop does not have are empty. Each stop starts with a new controller. Numbers have as many
digits as a double needs to be read back exactly; nan is a reading that is not a number. A port must give the same
command at each sample. This needs doubles without contraction of a * b + c (-ffp-contract=off).

An FMU has one number of wheelsets: it is checked by the stops of two.

Exit status: 0 all commands are the same; 1 one differs, or the controller failed; 2 bad input; 130 interrupted.
"""

from __future__ import annotations

import argparse
import csv
import io
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from bogie_braking.controllers.controller_loader import Given, controller_of
from bogie_braking.controllers.replay import commands_of
from bogie_braking.reporting.scenario import BadInputError
from brake_controller.slide_protection import OWN_HEADER, one_file, slide_sources
from brake_controller.wheel_slide import Supervised
from products.controller_kinds import single
from products.protection.own_process import Apart, NoControllerError, ProcessEndedError, called_apart
from products.protection.reference_stops import MOST, STOPS, Look, ReferenceStop, looks_of
from readers.storage import write_whole

#: Name of the table, and its columns.
TABLE = "reference.csv"
SPEEDS = [f"wheel_speed_{number} [m/s]" for number in range(1, MOST + 1)]
VALVES = [f"valve_{number} [1]" for number in range(1, MOST + 1)]
HEAD = ["stop", "period [s]", "time [s]", *SPEEDS, *VALVES]
#: Number of wheelsets of an FMU: the stops with other numbers are left out.
OF_FMU = 2
#: Place of the first command in a row.
COMMANDS_AT = HEAD.index(VALVES[0])


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    group = parser.add_mutually_exclusive_group()
    text = "folder of the library and of the table (default: protection)"
    group.add_argument("-o", "--into", type=Path, default=Path("protection"), metavar="DIR", help=text)
    text = "a controller, or reference.csv with the commands of a port"
    group.add_argument("--check", metavar="PORT", help=text)


def run(chosen: argparse.Namespace) -> bool:
    """Write or check; return whether all commands are the same. Raises BadInputError, CompilerError."""
    if chosen.check:
        found = check_table(Path(chosen.check)) if chosen.check.endswith(".csv") else check_controller(chosen.check)
        if not chosen.quiet:
            print(found or f"{chosen.check}: the same commands in all {len(stops_for(chosen.check))} stops.")
        return not found
    header = slide_sources()[OWN_HEADER]
    files = {OWN_HEADER: header, "wheel_slide.c": one_file(), TABLE: table()}
    write_folder(chosen.into, files)
    if not chosen.quiet:
        looks = files[TABLE].count("\n") - 1
        print(f"{chosen.into}: {', '.join(files)} with {len(STOPS)} stops, {looks} looks.")
    return True


def write_folder(folder: Path, files: Mapping[str, str]) -> None:
    """Write files into a folder, which is made. Raises BadInputError."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in files.items():
            write_whole(folder / name, text.encode())
    except OSError as error:
        raise BadInputError(f"{folder} cannot be written ({error}); give another folder.") from None


def table() -> str:
    """Return the table of all stops. Raises CompilerError."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(HEAD)
    writer.writerows(row for stop in STOPS for row in rows_of(stop, looks_of(stop)))
    return text.getvalue()


def rows_of(stop: ReferenceStop, looks: Sequence[Look]) -> Iterator[list[str]]:
    """Yield the rows of a stop."""
    empty = [""] * (MOST - stop.wheelsets)
    for look in looks:
        speeds = [*map(repr, look.speeds), *empty]
        yield [stop.name, repr(stop.period), repr(look.time), *speeds, *map(str, look.valves), *empty]


def check_table(path: Path) -> str:
    """Return the first difference of the commands of a table, or ""."""
    try:
        given = list(csv.reader(io.StringIO(path.read_text(encoding="utf-8-sig"))))
    except FileNotFoundError:
        raise BadInputError(f"There is no file {path}; give {TABLE} with the commands of a port.") from None
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise BadInputError(f"{path} cannot be read ({error}); give {TABLE} with the commands of a port.") from None
    due = list(csv.reader(io.StringIO(table())))
    for line, (own, other) in enumerate(zip(due, given, strict=False), 1):
        if line == 1 and own != other:
            raise BadInputError(f"{path} must have the columns of {TABLE}; write the table again and fill it in.")
        if len(own) != len(other) or not all(map(_same, own[:COMMANDS_AT], other[:COMMANDS_AT])):
            raise BadInputError(
                f"{path}, line {line}: stop, times and speeds must be those of {TABLE} of this version; write it again."
            )
        for place, (expected, found) in enumerate(zip(own[COMMANDS_AT:], other[COMMANDS_AT:], strict=True)):
            if found.strip() != expected:
                return (
                    _difference(own[0], float(own[2]), place, expected, found.strip() or "nothing") + f" Line {line}."
                )
    if len(given) != len(due):
        raise BadInputError(f"{path} must have {len(due)} lines as {TABLE}; it has {len(given)}.")
    return ""


def _same(own: str, other: str) -> bool:
    """Return whether two cells are the same text or the same double."""
    if own == other:
        return True
    try:
        return np.array_equal(float(own), float(other), equal_nan=True)
    except ValueError:
        return False


def stops_for(text: str) -> list[ReferenceStop]:
    """Return the stops by which a controller or table is checked."""
    return [stop for stop in STOPS if not text.endswith(".fmu") or stop.wheelsets == OF_FMU]


def check_controller(text: str) -> str:
    """Return the first difference of the commands of a controller, or "". Raises BadInputError."""
    stops = stops_for(text)
    named = {count: controller_of(text, count) for count in sorted({stop.wheelsets for stop in stops})}
    looks = [looks_of(stop) for stop in stops]
    apart = any(isinstance(one, Apart) for _, one in named.values())
    try:
        answers = called_apart(answered, named, stops, looks) if apart else answered(named, stops, looks)
    except NoControllerError as error:
        raise BadInputError(f"{text} is no controller ({error}); give one.") from None
    except ProcessEndedError as error:
        return f"{text}: the controller {error}."
    found = (first_difference(*one) for one in zip(stops, looks, answers, strict=True))
    return next(filter(None, found), "")


def first_difference(stop: ReferenceStop, looks: Sequence[Look], answer: tuple[np.ndarray, str]) -> str:
    """Return the first difference of the commands in a stop, or the message of the controller's failure, or ""."""
    valves, message = answer
    for look, row in zip(looks, valves.tolist(), strict=False):
        for place, (expected, found) in enumerate(zip(look.valves, row, strict=True)):
            if expected != found:
                return _difference(stop.name, look.time, place, str(expected), str(found))
    return message and f"Stop {stop.name}: {message}"


def answered(
    named: Mapping[int, tuple[str, Given]], stops: Sequence[ReferenceStop], looks: Sequence[Sequence[Look]]
) -> list[tuple[np.ndarray, str]]:
    """Return for each stop the commands of a new controller, and the message of its failure.

    named: controllers and their names by the number of wheelsets. Raises NoControllerError.
    """
    found = []
    for stop, due in zip(stops, looks, strict=True):
        name, one = named[stop.wheelsets]
        form = one.made(stop.wheelsets, stop.period) if isinstance(one, Apart) else one
        controller = Supervised(single(name, form, stop.wheelsets, stop.period), stop.wheelsets)
        times, speeds = np.array([look.time for look in due]), np.array([look.speeds for look in due])
        found.append(commands_of(controller, times, speeds))
    return found


def _difference(stop: str, time: float, place: int, expected: str, found: str) -> str:
    """Return the message of a difference."""
    return f"Stop {stop}, {time:.6g} s, wheelset {place + 1}: command {found} instead of {expected}."

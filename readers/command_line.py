"""Command lines: options with units and limits, and one message for each refused input."""

from __future__ import annotations

import argparse
import difflib
import errno
import math
import re
import secrets
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, NoReturn

from readers.quantity import decimal_comma, number_in
from readers.renamed import present_name
from readers.storage import PARTIAL, writing
from readers.text import BadInputError, shown
from readers.units import different_units
from readers.usual import likely_unit, usual_range

#: An argument that begins so is a negative value, not an option.
NEGATIVE = re.compile(r"-(\d|\.\d)")
#: Share of letters in common from which an option is suggested.
NEAR = 0.7
#: Messages of argparse, and their replacements, functions of the groups of the pattern.
SENTENCES: tuple[tuple[str, Callable[..., str]], ...] = (
    (r"the following arguments are required: (.*)", lambda names: f"{names} must be given; got nothing."),
    (r"argument (\S+): expected (?:one argument|\d+ arguments?)", lambda name: f"{name} must have a value; got none."),
    (r"argument (\S+): expected at least one argument", lambda name: f"{name} must have a value; got none."),
    (
        r"argument (\S+): not allowed with argument (\S+)",
        lambda one, other: f"{other} and {one} must not be given together; got both. Leave one out.",
    ),
    (
        r"ambiguous option: (\S+) could match (.*)",
        lambda name, those: f"{name} must be the name of one option; got the start of {those}. Write it in full.",
    ),
    (
        r"argument (\S+): ignored explicit argument (.*)",
        lambda name, value: f"{name} must have no value; got {value}. Leave the value out.",
    ),
    (r"argument \S+: (.*)", lambda sentence: str(sentence)),
)


class CommandLine(argparse.ArgumentParser):
    """An `ArgumentParser` that raises BadInputError with one message, without its usage."""

    def __init__(self, *given: Any, **named: Any) -> None:
        super().__init__(*given, **named)
        self._negative_number_matcher = NEGATIVE  # argparse's own pattern allows no unit

    def error(self, message: str) -> NoReturn:
        """Raise BadInputError with the replacement of a message of argparse."""
        for pattern, sentence in SENTENCES:
            if found := re.fullmatch(pattern, message, re.DOTALL):
                message = sentence(*found.groups())
                break
        if not message.endswith((".", "?")):
            message += f". See {self.prog} --help."
        elif message.endswith(("got nothing.", "got none.")):
            message += f" See {self.prog} --help."
        raise BadInputError(message)

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Parse; refuse unknown arguments, also if this parser belongs to a command of another parser."""
        found, left = super().parse_known_args(args, namespace)
        if left:
            self.error(self._unknown(left[0]))
        return found, left

    def _unknown(self, given: str) -> str:
        option = given.partition("=")[0]
        known = [option_string for action in self._actions for option_string in action.option_strings]
        if not given.startswith("-"):
            return f"{self.prog} must have no argument {shown(given)} here. Leave it out."
        if new := present_name(option, known):
            return f"There is no option {option}; its name is {new} now."
        near = difflib.get_close_matches(option, known, 1, NEAR)
        return f"There is no option {option}; " + (f"did you mean {near[0]}?" if near else f"see {self.prog} --help.")

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        if action.choices is None or value in action.choices:
            return
        name = "/".join(action.option_strings) or str(action.metavar or action.dest)
        choices = [str(choice) for choice in action.choices]
        near = difflib.get_close_matches(str(value), choices, 1)
        end = f" Did you mean {near[0]}?" if near else ""
        text = f"{name} must be one of {', '.join(choices)}; got {shown(value)}.{end}"
        raise argparse.ArgumentError(None, text)


def quantity(
    name: str, unit: str = "1", least: float = -math.inf, most: float = math.inf, *, above: bool = False
) -> Callable[[str], float]:
    """Return the reader of an option's value: a number in `unit`, or with a unit that converts to it.

    Takes least, most [unit]; returns [unit].
    """

    def read(text: str) -> float:
        value = number_in(text, unit)
        inside = value is not None and math.isfinite(value) and (least < value if above else least <= value)
        if value is not None and inside and value <= most:
            if unit == "m/s" and value > usual_range(unit)[1] and not text.strip()[-1:].isalpha():
                said = f"{name} {text} is read as {value:g} m/s = {3.6 * value:g} km/h. For km/h write {text}km/h."
                print(said, file=sys.stderr)
            return value
        limit = f"{name} must be {_limits(unit, least, most, above)}; got {shown(text)}."
        if value is None:
            raise argparse.ArgumentTypeError(limit + (decimal_comma(text, unit) or _units(unit)))
        own = text.strip()[-1:].isalpha()
        raise argparse.ArgumentTypeError(limit + ("" if own else likely_unit(value, unit, least, most)))

    return read


def whole(name: str, least: int, most: int | None = None) -> Callable[[str], int]:
    """Return the reader of an option's value that is an integer from `least` to `most`, as `quantity` does."""

    def read(text: str) -> int:
        with suppress(ValueError):
            if least <= int(text) <= (int(text) if most is None else most):
                return int(text)
        limit = f"of at least {least}" if most is None else f"from {least} to {most}"
        raise argparse.ArgumentTypeError(f"{name} must be an integer {limit}; got {shown(text)}.")

    return read


def _limits(unit: str, least: float, most: float, above: bool) -> str:
    in_unit = "" if unit == "1" else f" {unit}"
    from_, to = f"{'above' if above else 'at least'} {least:g}", f"at most {most:g}"
    if math.isinf(least) and math.isinf(most):
        return "a finite number" if unit == "1" else f"a finite number of {unit}"
    if math.isinf(most):
        return f"{from_}{in_unit}"
    if math.isinf(least):
        return f"{to}{in_unit}"
    return f"{from_} and {to}{in_unit}" if above else f"from {least:g} to {most:g}{in_unit}"


def _units(unit: str) -> str:
    those = different_units(unit)
    return " Give a number without a unit." if unit == "1" else f" Give a number in {', '.join(those[:6])}."


def check_out(out: Path, *given: Path, picture: bool = False) -> None:
    """Refuse to write over a file that is read, or over the figure beside the file."""
    if any(out.resolve() == one.resolve() for one in given):
        raise BadInputError(f"--out must be another file than FILE; got {out} twice. Name another.")
    if picture and out.suffix.lower() == ".png":
        raise BadInputError(f"--out must not end in .png, as the picture beside it does; got {out}. Rename it.")


def check_folder(folder: Path, option: str = "--out") -> None:
    """Refuse a folder that cannot be written, before the work for it starts. The check leaves nothing behind."""
    places = (folder.absolute(), *folder.absolute().parents)
    remedy = f"Choose another folder with {option}."
    try:
        place = next(one for one in places if one.exists() or one.is_symlink())
        is_folder = place.is_dir()
    except OSError as error:  # a name that is too long, or a folder that may not be entered
        said = f"{option} must be a folder that can be written; got {shown(folder)} ({error.strerror}). {remedy}"
        raise BadInputError(said) from None
    if not is_folder:
        kind = "a link to nothing" if place.is_symlink() and not place.exists() else "a file"
        raise BadInputError(f"{option} must be a folder; got {folder}, and {place} is {kind}. {remedy}")
    probe = place / f".{secrets.token_hex(8)}{PARTIAL}"
    try:
        probe.mkdir()
        probe.rmdir()
    except OSError as error:
        reason = "it takes no new folder" if error.errno == errno.ENOENT else error.strerror
        said = f"{option} must be a folder that can be written; got {folder} ({place}: {reason}). {remedy}"
        raise BadInputError(said) from None


def make_folder_of(out: Path) -> None:
    """Make the folder of a file that `--out` names. Raises StorageError."""
    with writing(out, "choose another folder with --out"):
        out.parent.mkdir(parents=True, exist_ok=True)

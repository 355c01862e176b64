"""Test the messages with which command lines refuse inputs, and the units that they read."""

from __future__ import annotations

import argparse
from pathlib import Path

import pytest

from bogie_braking.commands import COMMANDS, parser_of
from readers.command_line import CommandLine, check_folder, quantity, whole
from readers.quantity import number_in
from readers.text import BadInputError


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("1ms", "s", 1e-3),
        ("500 us", "s", 5e-4),
        ("0.001", "s", 1e-3),
        ("2e-3s", "s", 2e-3),
        ("160km/h", "m/s", 1600 / 36),
        ("0.92m", "mm", 920.0),
        (".5", "1", 0.5),
        ("5 %", "1", None),
        ("1h2", "s", None),
        ("3 kg", "s", None),
    ],
)
def test_a_number_is_read_in_its_unit_or_in_that_of_the_option(text: str, unit: str, value: float | None) -> None:
    assert number_in(text, unit) == value


def parser() -> CommandLine:
    top = CommandLine("top")
    one = top.add_subparsers(dest="command", required=True).add_parser("one")
    one.add_argument("name")
    one.add_argument("--step", type=quantity("--step", "s", 1e-5, 0.1))
    one.add_argument("--pulses", type=whole("--pulses", 1))
    one.add_argument("--kind", choices=("native", "fmi3"))
    either = one.add_mutually_exclusive_group()
    either.add_argument("--quiet", action="store_true")
    either.add_argument("--json", action="store_true")
    return top


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ("", "command must be given; got nothing. See top --help."),
        ("two", "command must be one of one; got two."),
        ("one", "name must be given; got nothing. See top one --help."),
        ("one a --step 5", "--step must be from 1e-05 to 0.1 s; got 5. Did you mean 5 ms = 0.005 s?"),
        ("one a --step 5h", "--step must be from 1e-05 to 0.1 s; got 5h."),
        ("one a --step -5ms", "--step must be from 1e-05 to 0.1 s; got -5ms."),
        ("one a --step x", "--step must be from 1e-05 to 0.1 s; got x. Give a number in s, ms, us, min, h."),
        ("one a --step 0,01s", "--step must be from 1e-05 to 0.1 s; got 0,01s. Write a decimal point: 0.01s."),
        ("one a --step", "--step must have a value; got none. See top one --help."),
        ("one a --pulses 1.5", "--pulses must be an integer of at least 1; got 1.5."),
        ("one a --teeth 80", "There is no option --teeth; its name is --pulses now."),
        ("one a --stepp 1", "There is no option --stepp; did you mean --step?"),
        ("one a --kind fmi", "--kind must be one of native, fmi3; got fmi. Did you mean fmi3?"),
        ("one a --quiet --json", "--quiet and --json must not be given together; got both. Leave one out."),
        ("one a --quiet=1", "--quiet must have no value; got '1'. Leave the value out."),
        ("one a b", "top one must have no argument b here. Leave it out."),
    ],
)
def test_a_refusal_is_one_sentence_without_usage(given: str, sentence: str) -> None:
    with pytest.raises(BadInputError) as caught:
        parser().parse_args(given.split())
    assert str(caught.value) == sentence


@pytest.mark.parametrize(
    ("given", "value", "said"),
    [
        ("80", 80.0, "--speed 80 is read as 80 m/s = 288 km/h. For km/h write 80km/h.\n"),
        ("25", 25.0, ""),
        ("80 m/s", 80.0, ""),
        ("180km/h", 50.0, ""),
    ],
)
def test_a_speed_that_may_be_in_kmh_is_reported(
    given: str, value: float, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert quantity("--speed", "m/s", 0.1, 200.0)(given) == value
    assert capsys.readouterr().err == said


def test_a_folder_is_looked_at_and_left_as_it_was(tmp_path: Path) -> None:
    check_folder(tmp_path / "a" / "b")
    assert not list(tmp_path.iterdir())
    (tmp_path / "file").write_text("")
    with pytest.raises(BadInputError, match=r"--out must be a folder; got .*file.* is a file\. Choose another folder"):
        check_folder(tmp_path / "file" / "below")
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    with pytest.raises(BadInputError, match=r"link is a link to nothing\. Choose another folder"):
        check_folder(tmp_path / "link" / "below")
    with pytest.raises(BadInputError, match=r"--out must be a folder that can be written; got .*too long"):
        check_folder(tmp_path / ("n" * 300))


def test_every_parser_and_option_of_the_program_refuses_so() -> None:
    """No option is parsed by plain `float` or `int`, which check neither limits nor units."""

    def parsers(one: argparse.ArgumentParser) -> list[argparse.ArgumentParser]:
        below = [action.choices for action in one._actions if isinstance(action, argparse._SubParsersAction)]
        return [one, *(found for choices in below for sub in choices.values() for found in parsers(sub))]

    for one in parsers(parser_of(COMMANDS)):
        assert isinstance(one, CommandLine)
        assert all(action.type not in (float, int) for action in one._actions)

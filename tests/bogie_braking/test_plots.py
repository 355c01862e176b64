"""Every figure has a short message, and a report contains it."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from bogie_braking.reporting.plots import MOST_WORDS, message_of, one_word, plt, titled, widen
from bogie_braking.reporting.report import Report, Row, save, value_of
from fmu_src.cosimulation.recording import Recording

MESSAGE = "The trailing wheelset locks first above 0.7 of the adhesion"


@pytest.fixture(autouse=True)
def closed() -> Iterator[None]:
    yield
    plt.close("all")


def test_a_message_of_more_than_twelve_words_is_refused() -> None:
    titled(plt.figure(), " ".join(MOST_WORDS * ["word"]))
    with pytest.raises(ValueError, match="at most 12 words; got 13"):
        titled(plt.figure(), " ".join((MOST_WORDS + 1) * ["word"]))


def test_a_name_of_the_users_is_one_word() -> None:
    name = "PI(0.3, limit=2, " + "a b c d e f g h i j)"
    assert message_of(titled(plt.figure(), f"{one_word(name)} stops")) == f"{name} stops"


def test_a_long_message_has_two_lines_of_like_length_and_is_one_text() -> None:
    message = " ".join(MOST_WORDS * ["lettered"])
    figure = titled(plt.figure(figsize=(8.0, 4.0)), message)
    first, second = figure.get_suptitle().split("\n")
    assert abs(len(first) - len(second)) < 20
    assert message_of(figure) == message


def test_a_report_tells_the_message_of_each_picture(tmp_path: Path) -> None:
    report = Report([], Recording({"time": "s"}, [[0.0], [1.0]]), lambda: titled(plt.figure(), MESSAGE), {}, 0.0)
    report.other_figures["more"] = lambda: titled(plt.figure(), "Another one")
    summary = json.loads((save(report, "short", tmp_path, 1.0) / "summary.json").read_text(encoding="utf-8"))
    assert summary["pictures"] == {"figure.png": MESSAGE, "more.png": "Another one"}


def test_a_picture_without_a_message_is_refused_and_nothing_is_left(tmp_path: Path) -> None:
    report = Report([], Recording({"time": "s"}, [[0.0], [1.0]]), plt.figure, {}, 0.0)
    with pytest.raises(ValueError, match="must have a message"):
        save(report, "short", tmp_path, 1.0)
    assert list(tmp_path.iterdir()) == []


def test_a_value_of_a_table_that_is_not_there_is_refused() -> None:
    rows = [Row("distance", "m", None, 2.0, None, ""), Row("lock", "s", None, None, None, "")]
    assert value_of(rows, "distance") == 2.0
    for quantity in ("lock", "speed"):
        with pytest.raises(LookupError, match=quantity):
            value_of(rows, quantity)


def test_rounding_errors_of_a_constant_are_not_magnified() -> None:
    axis = plt.figure().add_subplot()
    axis.plot([0.0, 1.0], [2.0, 2.0 + 1e-11])
    widen(axis, 0.1)
    assert axis.get_ylim() == pytest.approx((1.95, 2.05))
    axis.plot([0.0, 1.0], [0.0, 3.0])
    axis.autoscale()
    widen(axis, 0.1)
    assert axis.get_ylim()[1] > 3.0

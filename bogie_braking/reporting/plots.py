"""One style for all figures; the title of each is its one message of a few words."""

from __future__ import annotations

import io
import math
import re
import sys
import textwrap
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np

from readers.extras import OptionalModule, has, missing
from readers.storage import write_whole, writing

if TYPE_CHECKING:
    from matplotlib import pyplot as plt
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Leading, trailing, bogie, thesis; distinguishable without colour vision.
LEADING, TRAILING, BOGIE, THESIS = "#0072b2", "#d55e00", "#333333", "#009e73"
THREE = ("#0072b2", "#e69f00", "#d55e00")
#: Wheelsets 1 to 4.
FOUR = ("#0072b2", "#56b4e9", "#e69f00", "#d55e00")
#: Dashes of three or four lines in addition to their colours: the second and third of FOUR are alike in grey print.
LINES = ("-", "--", "-.", ":")

STYLE = {
    "axes.grid": True,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlelocation": "left",
    "axes.titlesize": 11,
    "figure.titlesize": 15,
    "font.size": 11,
    "grid.alpha": 0.3,
    "legend.frameon": False,
    "lines.linewidth": 1.8,
}


def _begin(pyplot: ModuleType) -> None:
    """Draw into files, in this style."""
    pyplot.switch_backend("Agg")
    pyplot.rcParams.update(STYLE)


if not TYPE_CHECKING:
    plt = OptionalModule("matplotlib.pyplot", _begin)

#: Largest number of words of a message, and letters of a title in an inch of its line.
MOST_WORDS, LETTERS = 12, 8.9
NO_BREAK = "\u00a0"


def panels(message: str, labels: Sequence[str], height: float = 2.0) -> tuple[Figure, list[Axes]]:
    """Return a figure of panels above each other that share the time axis; `labels` are the titles of the panels."""
    figure, axes = charts(message, labels, (8.0, height * len(labels) + 0.8), columns=1, sharex=True)
    axes[-1].set_xlabel("time [s]")
    return figure, axes


def single(message: str, x_label: str, y_label: str) -> tuple[Figure, Axes]:
    """Return a figure of one chart."""
    figure, axis = plt.subplots(figsize=(8.0, 5.2))
    axis.set(xlabel=x_label, ylabel=y_label)
    return titled(figure, message), axis


def charts(
    message: str,
    titles: Mapping[str, str] | Sequence[str],
    size: tuple[float, float],
    x_label: str = "",
    columns: int = 2,
    **options: Any,
) -> tuple[Figure, list[Any]]:
    """Return a figure of charts in rows of some `columns`."""
    figure, grid = plt.subplots(math.ceil(len(titles) / columns), columns, figsize=size, squeeze=False, **options)
    for axis, title in zip(grid.flat, titles, strict=True):
        axis.set(title=title, xlabel=titles[title] if isinstance(titles, Mapping) else x_label)
    return titled(figure, message), list(grid.flat)


def titled(figure: Figure, message: str) -> Figure:
    """Return the figure with its message as title, and space for its contents.

    Raises ValueError as `message_of` does.
    """
    lines = math.ceil(len(message) / (figure.get_figwidth() * LETTERS))
    figure.suptitle(textwrap.fill(message, len(message) // max(lines, 1) + 8), x=0.02, ha="left")
    figure.set_layout_engine("constrained")
    message_of(figure)
    return figure


def one_word(name: str) -> str:
    """Return a user's name as one word of a message, regardless of its blanks."""
    return name.replace(" ", NO_BREAK)


def message_of(figure: Figure) -> str:
    """Return the message of a figure in one line."""
    words = [word.replace(NO_BREAK, " ") for word in re.split("[ \n]+", figure.get_suptitle()) if word]
    if not words:
        raise ValueError("A figure must have a message. Set it with bogie_braking.reporting.plots.titled.")
    if len(words) > MOST_WORDS:
        raise ValueError(f"A message must have at most {MOST_WORDS} words; got {len(words)}: {' '.join(words)}")
    return " ".join(words)


def png_of(figure: Figure, dpi: int = 110) -> bytes:
    """Return a figure as a PNG file, and close it."""
    memory = io.BytesIO()
    figure.savefig(memory, format="png", dpi=dpi)
    plt.close(figure)
    return memory.getvalue()


def saved(draw: Callable[[], Figure], path: Path, dpi: int = 100) -> list[Path]:
    """Draw a figure into a PNG file; return its path in a list, empty without Matplotlib. Raises OSError."""
    if not can_draw():
        return []
    with writing(path.parent):
        path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, png_of(draw(), dpi))
    return [path]


@cache
def can_draw() -> bool:
    """Return whether Matplotlib is installed; if not, write its extra to standard error, once."""
    if not has("matplotlib"):
        print(f"No picture. {missing('matplotlib')}", file=sys.stderr)
    return has("matplotlib")


def widen(axis: Axes, least: float) -> None:
    """Widen the y axis to a least range about its middle, so that rounding errors of a constant are not magnified."""
    low, high = axis.get_ylim()
    if high - low < least:
        axis.set_ylim((low + high - least) / 2.0, (low + high + least) / 2.0)


def label_edges(grid: np.ndarray, x_label: str, y_label: str) -> None:
    """Label a grid of axes whose columns share `x_label`, below the last row, and rows `y_label`, on the left."""
    for axis in grid[-1]:
        axis.set_xlabel(x_label)
    for axis in grid[:, 0]:
        axis.set_ylabel(y_label)


def legend_above(axis: Axes, columns: int = 2) -> None:
    """Place the legend in the line of the title, where it hides nothing."""
    axis.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=columns, fontsize=8, borderaxespad=0.1)


def write_at(axis: Axes, place: tuple[float, float], text: str, colour: str, **options: Any) -> None:
    """Write the name of a line in its colour at a place."""
    axis.annotate(text, place, **{"color": colour, "fontsize": "large", "va": "center"} | options)


def mark(axis: Axes, time: float | None, text: str) -> None:
    """Draw a thin vertical line with a word for an event; None: no line."""
    if time is None:
        return
    axis.axvline(time, color="#999999", linewidth=0.8)
    axis.annotate(
        text,
        (time, 0.97),
        xycoords=("data", "axes fraction"),
        fontsize=10,
        va="top",
        xytext=(3, 0),
        textcoords="offset points",
    )

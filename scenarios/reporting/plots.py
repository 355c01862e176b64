"""One style for all figures."""

from collections.abc import Sequence

import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

#: Leading, trailing, bogie, thesis; distinguishable without colour vision.
LEADING, TRAILING, BOGIE, THESIS = "#0072b2", "#d55e00", "#333333", "#009e73"
THREE = ("#0072b2", "#e69f00", "#d55e00")
#: Wheelsets 1 to 4.
FOUR = ("#0072b2", "#56b4e9", "#e69f00", "#d55e00")

plt.rcParams.update(
    {
        "axes.grid": True,
        "axes.spines.right": False,
        "axes.spines.top": False,
        "axes.titlelocation": "left",
        "axes.titlesize": 10,
        "figure.titlesize": 12,
        "font.size": 9,
        "grid.alpha": 0.3,
        "legend.frameon": False,
        "lines.linewidth": 1.6,
    }
)


def panels(title: str, labels: Sequence[str], height: float = 2.0) -> tuple[Figure, list[Axes]]:
    """A figure of panels above each other that share the time axis; `labels` are the titles of the panels."""
    figure, grid = plt.subplots(len(labels), 1, sharex=True, figsize=(8.0, height * len(labels) + 0.8), squeeze=False)
    axes = list(grid[:, 0])
    for axis, label in zip(axes, labels, strict=True):
        axis.set_title(label)
    axes[-1].set_xlabel("time [s]")
    return titled(figure, title), axes


def single(title: str, x_label: str, y_label: str) -> tuple[Figure, Axes]:
    figure, axis = plt.subplots(figsize=(8.0, 5.2))
    axis.set(xlabel=x_label, ylabel=y_label)
    return titled(figure, title), axis


def titled(figure: Figure, title: str) -> Figure:
    """The figure with its title, and room for what is on it."""
    figure.suptitle(title, x=0.02, ha="left")
    figure.set_layout_engine("constrained")
    return figure


def label_edges(grid: np.ndarray, x_label: str, y_label: str) -> None:
    """What all columns and all rows of a grid of axes share, below the last row and left of the first column."""
    for axis in grid[-1]:
        axis.set_xlabel(x_label)
    for axis in grid[:, 0]:
        axis.set_ylabel(y_label)


def legend_above(axis: Axes, columns: int = 2) -> None:
    """The legend in the line of the title, where it hides nothing."""
    axis.legend(loc="lower right", bbox_to_anchor=(1.0, 0.96), ncols=columns, fontsize=8, borderaxespad=0.1)


def mark(axis: Axes, time: float | None, text: str) -> None:
    """A thin vertical line with a word, for an event."""
    if time is None:
        return
    axis.axvline(time, color="#999999", linewidth=0.8)
    axis.annotate(
        text,
        (time, 0.97),
        xycoords=("data", "axes fraction"),
        fontsize=8,
        va="top",
        xytext=(3, 0),
        textcoords="offset points",
    )

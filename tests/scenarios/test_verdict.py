"""What a comparison of controllers says, in a table, a sentence and a picture, of scores that are written here."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure
from scipy.integrate import solve_ivp

from products.protection.runs import Stop
from scenarios.controllers.picture import draw, message
from scenarios.controllers.scoring import CONTACT, WORN, Scored
from scenarios.controllers.verdict import lines, sentences, verdicts
from scenarios.reporting.plots import plt

STOP = Stop(100.0, 0.01, 20.0, 0.5, 1.0, 1.0, 0.1, (1e3, 1e3), 400e3, 7, "")
#: Distances over the ideal, None for no stop.
RATIOS = {
    "none": (1.0, 2.0, 1.9, 1.8),
    "protection": (1.0, 1.1, 1.15, 1.5),
    "PI": (1.0, 1.3, 1.1, None),
    "PD": (1.0, 1.1, 1.15, 1.2),
}


def scored(case: str, controller: str, ratio: float | None, ideal: float | None = 100.0) -> Scored:
    distance = None if ratio is None else 100.0 * ratio
    return Scored(case, controller, replace(STOP, distance=distance), 0.46, ideal, None)


def scores(*names: str, cases: int = 4) -> list[Scored]:
    return [scored(f"case {n}", name, RATIOS[name][n]) for n in range(cases) for name in names]


def shown(figure: Figure) -> list[tuple[float, bool]]:
    """Places of all markers along the axis, and which are hollow."""
    [axis] = figure.axes
    found = [
        (float(place), line.get_markerfacecolor() == "none")
        for line in axis.lines
        if line.get_marker() not in (None, "None", "")
        for place in line.get_xdata()
    ]
    plt.close(figure)
    return found


def test_the_best_has_the_fewest_failures_then_the_smallest_median_then_the_smallest_worst() -> None:
    best = "PD is best: it stops in every case, after 1.12 of the ideal distance in the median."
    where = "Where each is worst: PD 1.20 (case 3); protection 1.50 (case 3); PI no stop (case 3)."
    assert sentences(verdicts(scores(*RATIOS))) == [best, where]
    [first, _] = sentences(verdicts(scores("none", "PI")))
    assert first == "none is best: it stops in every case, after 1.85 of the ideal distance in the median."


def test_wheels_that_lock_count_before_the_distance() -> None:
    """A flat costs more than some metres: 0.5 s is a lock, 0.3 s is none."""
    rolls = [replace(one, stop=replace(one.stop, longest_lock=0.3)) for one in scores("protection")]
    [first, _] = sentences(verdicts([*rolls, *scores("none", "PD")]))
    assert first == "protection is best: it stops in every case, after 1.12 of the ideal distance in the median."


def test_controllers_that_are_alike_are_told_so() -> None:
    alike = "All controllers are alike: they stop in every case, after 1.00 of the ideal distance."
    assert sentences(verdicts(scores(*RATIOS, cases=1))) == [alike]
    [said, _] = sentences(verdicts(scores("none", "protection", "PD", cases=3)))
    assert (
        said == "protection and PD are best: they stop in every case, after 1.10 of the ideal distance in the median."
    )
    nothing = [scored("a", name, None) for name in ("none", "PI")]
    assert sentences(verdicts(nothing)) == ["No controller stops in any case."]


def test_the_table_has_a_row_for_each_controller() -> None:
    table = list(lines(verdicts(scores(*RATIOS))))
    rows = {row.split()[0]: row.split() for row in table[-len(RATIOS) :]}
    assert rows["none"] == ["none", "4", "0", "4", "1.85", "2.00", "case", "1", "0.50", "83"]
    assert rows["PI"] == ["PI", "3", "1", "4", "1.10", "1.30", "case", "3", "0.50", "83"]
    assert max(map(len, table)) <= 120


@pytest.mark.parametrize(
    ("given", "title"),
    [
        (scores(*RATIOS), "PD stops within 1.2 of the ideal in 4 of 4 cases"),
        (scores("none", "protection", "PI"), "PI stops within 1.2 of the ideal in 2 of 4 cases"),
        (scores("none", "PI", cases=2)[2:], "PI takes 1.30 of the ideal distance"),
        ([scored("a", "PI", None)], "PI does not stop"),
        ([scored("a", "PI", 1.0, ideal=None)], "PI stops"),
    ],
)
def test_the_title_is_the_message_in_twelve_words(given: list[Scored], title: str) -> None:
    figure = draw(given)
    assert figure.get_suptitle() == message(given) == title
    assert len(title.split()) <= 12
    plt.close(figure)


def test_every_stop_is_a_marker_and_no_stop_one_at_the_edge() -> None:
    found = shown(draw(scores(*RATIOS)))
    assert len(found) == 16
    assert sorted(place for place, hollow in found if not hollow) == pytest.approx(
        sorted(ratio for own in RATIOS.values() for ratio in own if ratio)
    )
    [edge] = [place for place, hollow in found if hollow]
    assert edge > 2.0


def test_a_name_that_begins_with_an_underscore_stands_in_the_legend() -> None:
    figure = draw([scored("a", name, 1.5) for name in ("none", "_PI")])
    [legend] = figure.legends
    assert [text.get_text().strip() for text in legend.get_texts()] == ["none: 1.50", "_PI: 1.50"]
    plt.close(figure)


def test_the_axis_is_logarithmic_where_distances_lie_far_apart() -> None:
    for ratio, scale in ((3.9, "linear"), (9.0, "log")):
        figure = draw([scored("a", "PI", 1.0), scored("a $b$", "PD", ratio), scored("a", "none", None)])
        figure.canvas.draw()
        assert figure.axes[0].get_xscale() == scale
        plt.close(figure)


@pytest.mark.parametrize("skid", [1.0, 100.0, 900.0])
def test_a_flat_grows_as_its_own_contact_wears(skid: float) -> None:
    """dV = WORN w L ds with V = w L^3 / (12 R), integrated step by step; without a skid there is none."""
    radius, width = 0.46, 0.015

    def growth(way: float, length: np.ndarray) -> np.ndarray:
        lost = WORN * width * length
        return lost / (width * length**2 / (4 * radius))

    found = solve_ivp(growth, (0.0, skid), [CONTACT], rtol=1e-10, atol=1e-12)
    one = Scored("low", "none", replace(STOP, longest_skid=skid), radius, None, None)
    assert one.flat == pytest.approx(found.y[0, -1], rel=1e-7)
    assert one.flat != pytest.approx(math.sqrt(CONTACT**2 + 8.1 * radius * WORN * skid), rel=1e-7)
    assert replace(one, stop=replace(STOP, longest_skid=0.0)).flat == 0.0

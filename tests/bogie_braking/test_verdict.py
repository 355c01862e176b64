"""The verdict on a comparison of controllers, as a table, a message and a figure, from scores written here."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure
from scipy.integrate import solve_ivp

from bogie_braking.controllers.picture import draw, message
from bogie_braking.controllers.scoring import CONTACT, WORN, ScoredController, together
from bogie_braking.controllers.table import cells, rows_of
from bogie_braking.controllers.verdict import document, lines, messages, verdicts
from bogie_braking.reporting.plots import plt
from products.protection.runs import Stop

STOP = Stop(100.0, 0.01, 20.0, 0.5, 1.0, 1.0, 0.1, (1e3, 1e3), 400e3, 7, "")
#: Distances over the ideal, None for no stop.
RATIOS = {
    "none": (1.0, 2.0, 1.9, 1.8),
    "protection": (1.0, 1.1, 1.15, 1.5),
    "PI": (1.0, 1.3, 1.1, None),
    "PD": (1.0, 1.1, 1.15, 1.2),
}


def scored(case: str, controller: str, ratio: float | None, ideal: float | None = 100.0) -> ScoredController:
    distance = None if ratio is None else 100.0 * ratio
    return ScoredController(case, controller, replace(STOP, distance=distance), 0.46, ideal, None)


def scores(*names: str, cases: int = 4) -> list[ScoredController]:
    return [scored(f"case {n}", name, RATIOS[name][n]) for n in range(cases) for name in names]


def shown(figure: Figure) -> list[tuple[float, bool]]:
    """Return the positions of all markers along the axis, and whether they are hollow."""
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
    assert messages(verdicts(scores(*RATIOS))) == [best, where]
    [first, _] = messages(verdicts(scores("none", "PI")))
    assert first == "none is best: it stops in every case, after 1.85 of the ideal distance in the median."


def test_distances_count_where_a_wheel_slides() -> None:
    """On three dry rails nothing slides, so a brake without protection has the ideal distance there."""
    dry = [scored(f"dry {n}", name, 1.0) for n in range(3) for name in RATIOS]
    rolls = [replace(one, stop=replace(one.stop, longest_lock=0.0)) for one in dry]
    found = verdicts([*rolls, *scores("none", "PD")])
    assert [one.median and one.median.mean for one in found if one.controller == "none"] == [pytest.approx(1.85)]
    assert [one.sliding for one in found] == [4] * len(found)
    [first, _] = messages(verdicts([*rolls[::4], *rolls[3::4], *scores("none", "PD")]))
    assert first.endswith("after 1.12 of the ideal distance in the median of the 4 where wheels slide.")
    given = [*rolls[::4], *rolls[3::4], *scores("none", "PD")]
    assert message(given) == "PD stops within 1.2 of ideal in 4 of 4 sliding cases"
    assert messages(verdicts(rolls))[0].startswith("No controller is best: they stop in every case, after 1.00 of")


def test_the_worst_case_is_one_of_all_cases() -> None:
    """A controller that wastes the brake where nothing slides is not best for its median alone."""
    dry = [scored("dry", name, ratio) for name, ratio in (("none", 1.0), ("Timid", 1.8), ("Bold", 1.0))]
    rolls = [replace(one, stop=replace(one.stop, longest_lock=0.0)) for one in dry]
    low = [scored("low", name, ratio) for name, ratio in (("none", 2.0), ("Timid", 1.2), ("Bold", 1.2))]
    found = {one.controller: one for one in verdicts([*rolls, *low])}
    assert found["Timid"].worst
    assert found["Timid"].worst.mean == pytest.approx(1.8)
    assert found["Timid"].worst_case == "dry"
    assert messages([*found.values()])[0].startswith("Bold is best")


def test_a_controller_that_fails_where_alone_wheels_slide_is_said_to_fail() -> None:
    rolls = [replace(one, stop=replace(one.stop, longest_lock=0.0)) for one in [scored("dry", "Mine", 1.0)]]
    assert message([*rolls, scored("low", "Mine", None)]) == "Mine stops in 1 of 2 cases"


def drawn(case: str, controller: str, *ratios: float) -> ScoredController:
    stops = [replace(STOP, distance=100.0 * ratio) for ratio in ratios]
    return ScoredController(case, controller, together(stops), 0.46, 100.0, None, stops=tuple(stops))


def test_controllers_whose_difference_is_within_its_interval_cannot_be_told_apart() -> None:
    """PD is 1 % shorter on average than PI; their draws differ by 0.02 or 0.001. Common scatter does not count."""
    scatter = (0.01, -0.01, 0.0, 0.005)
    pd = [drawn(case, "PD", *(1.20 + one for one in scatter)) for case in ("a", "b", "c")]
    assert document(verdicts(scores("PI", "PD")))["differences"][0]["told_apart"] is False  # type: ignore[index]
    for own, said in (
        (0.02, "No controller is best: they stop in every case, after 1.20 to 1.21 of"),
        (0.001, "PD is best: it stops"),
    ):
        more = (own, -own, own / 2, -own / 2)
        ratios = [1.212 + one + other for one, other in zip(scatter, more, strict=True)]
        found = verdicts([*pd, *(drawn(one.case, "PI", *ratios) for one in pd)])
        assert messages(found)[0].startswith(said)
        assert found[0].median is not None
        assert found[0].median.mean == pytest.approx(1.20125)
        told = document(found)["differences"][0]  # type: ignore[index]
        assert told["median"]["mean"] == pytest.approx(-0.012)
        assert told["told_apart"] == said.startswith("PD")


def test_a_spread_that_moves_the_cases_against_each_other_is_not_that_of_the_median() -> None:
    """Controllers are ranked by their median, so the interval is that of the median over the draws."""
    [found] = verdicts([drawn("a", "PI", 1.0, 1.2), drawn("b", "PI", 1.1, 1.1), drawn("c", "PI", 1.2, 1.0)])
    assert found.median is not None
    assert (found.median.mean, found.median.half) == pytest.approx((1.1, 0.0))


def test_stops_of_all_draws_are_one_in_the_table() -> None:
    draws = [replace(STOP, distance=d, longest_lock=lock) for d, lock in ((100.0, 0.5), (104.0, 0.1), (99.0, 0.2))]
    one = together(draws)
    assert (one.distance, one.longest_lock, one.air) == (101.0, 0.5, pytest.approx(0.1))
    scored = ScoredController("a", "PI", one, 0.46, 100.0, None, stops=tuple(draws))
    half = 4.302653 * math.sqrt(7.0 / 3)  # of Student's t with 2 degrees of freedom, variance 7
    assert scored.distance
    assert scored.distance.half == pytest.approx(half)
    assert cells(scored)[2:6] == ("101.0", f"±{half:.1f}", "-", "1.010")
    other = replace(scored, controller="PD", stops=tuple(replace(of, distance=of.distance + 2.02) for of in draws))
    assert [row[4] for row in rows_of([scored, other])] == ["shortest", "2.0"]
    once = [replace(scored, controller=name, stop=draws[0], stops=()) for name in ("PI", "PD")]
    assert [row[4] for row in rows_of(once)] == ["shortest", "equal"]
    broken = together([draws[0], replace(STOP, distance=None, message="It did not stop."), draws[2]])
    assert (broken.distance, broken.message) == (None, "It did not stop. (draw 2 of 3)")
    assert together(draws[:1]) is draws[0]


def test_harm_is_told_where_no_wheel_slides() -> None:
    """One controller moves no valve, one moves some, one takes 2 % longer."""
    rolls = replace(STOP, longest_lock=0.0, commands=0)
    kinds = {"none": (1.0, 0), "Still": (1.0, 0), "Busy": (1.0, 5), "Timid": (1.02, 5)}
    dry = [
        replace(scored("dry", name, ratio), stop=replace(rolls, distance=100.0 * ratio, commands=moved))
        for name, (ratio, moved) in kinds.items()
    ]
    found = verdicts([*dry, *(scored("low", name, 2.0) for name in kinds)])
    assert [one.harm and one.harm.words for one in found] == ["none", "none", "valves move", "+2.0 % (dry)"]
    assert [one.harm and one.harm.words for one in verdicts(dry)] == ["none", "none", "valves move", "+2.0 % (dry)"]
    assert verdicts(scores("none", "PD"))[1].harm is None


def test_what_is_not_judged_is_no_score_and_is_told() -> None:
    """It is not counted as a failure, and leaving out a hard case does not make its controller the best."""
    hung = replace(STOP, distance=None, judged=False, message="PI gave no answer.", longest_lock=60.0)
    silent = ScoredController("case 3", "PI", hung, 0.46, 100.0, None)
    given = [*scores("PI", cases=3)[:3], silent, *scores("none")]
    pi, none = verdicts(given)
    assert (pi.stopped, pi.failed, pi.not_judged, pi.locked, pi.longest_lock) == (3, 0, 1, 3, 0.5)
    first, _, last = messages([pi, none])
    assert first.startswith("none is best: it stops in every case")
    assert last == "Not judged, and so not ranked: PI (1 of 4 cases)."
    assert cells(silent)[:4] == ("case 3", "PI", "not judged", "-")
    assert set(cells(silent)[3:]) == {"-"}
    assert sorted(place for place, hollow in shown(draw(given)) if hollow) == []
    alone = verdicts([silent])
    assert messages(alone) == ["Not judged, and so not ranked: PI (1 of 1 cases)."]
    assert message([silent]) == "PI is not judged"
    json.dumps(document(alone), allow_nan=False)


def test_wheels_that_lock_count_before_the_distance() -> None:
    """A flat costs more than some metres. A standstill of 0.5 s is a lock, one of 0.3 s is too short."""
    rolls = [replace(one, stop=replace(one.stop, longest_lock=0.3)) for one in scores("protection")]
    [first, _] = messages(verdicts([*rolls, *scores("none", "PD")]))
    assert first == "protection is best: it stops in every case, after 1.12 of the ideal distance in the median."


def test_controllers_that_are_alike_are_told_so() -> None:
    alike = (
        "No controller is best: they stop in every case, after 1.00 of the ideal distance. They cannot be told apart."
    )
    assert messages(verdicts(scores(*RATIOS, cases=1))) == [alike]
    [said, _] = messages(verdicts(scores("none", "protection", "PD", cases=3)))
    assert (
        said == "protection and PD are best: they stop in every case, after 1.10 of the ideal distance in the median. "
        "They cannot be told apart."
    )
    nothing = [scored("a", name, None) for name in ("none", "PI")]
    assert messages(verdicts(nothing)) == ["No controller stops in any case."]


def test_the_table_has_a_row_for_each_controller() -> None:
    table = list(lines(verdicts(scores(*RATIOS))))
    rows = {row.split()[0]: row.split() for row in table[-len(RATIOS) :]}
    assert rows["none"] == ["none", "4", "0", "4", "1.850", "-", "2.000", "case", "1", "-", "0.50", "83"]
    assert rows["PI"] == ["PI", "3", "1", "4", "1.100", "-", "1.300", "case", "3", "-", "0.50", "83"]
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
def test_the_title_is_the_message_in_twelve_words(given: list[ScoredController], title: str) -> None:
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
    """dV = WORN w L ds with V = w L^3 / (12 R), integrated step by step; without a skid no flat appears."""
    radius, width = 0.46, 0.015

    def growth(way: float, length: np.ndarray) -> np.ndarray:
        lost = WORN * width * length
        return lost / (width * length**2 / (4 * radius))

    found = solve_ivp(growth, (0.0, skid), [CONTACT], rtol=1e-10, atol=1e-12)
    one = ScoredController("low", "none", replace(STOP, longest_skid=skid), radius, None, None)
    assert one.flat == pytest.approx(found.y[0, -1], rel=1e-7)
    assert one.flat != pytest.approx(math.sqrt(CONTACT**2 + 8.1 * radius * WORN * skid), rel=1e-7)
    assert replace(one, stop=replace(STOP, longest_skid=0.0)).flat == 0.0

"""Scores as one picture."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from scenarios.controllers.scoring import Scored
from scenarios.reporting.plots import BOGIE, LEADING, THESIS, TRAILING, plt, titled


def draw(scores: Sequence[Scored]) -> Figure:
    """Distances over the ideal by rail and controller; the title says who stops shortest on the worst rail."""
    cases, names = (list(dict.fromkeys(getattr(one, kind) for one in scores)) for kind in ("case", "controller"))
    figure, axis = plt.subplots(figsize=(9.0, 1.2 + 0.35 * len(scores)))
    colours = dict(zip(names, ("0.75", THESIS, LEADING, TRAILING, BOGIE, "0.5"), strict=False))
    for place, one in enumerate(reversed(scores)):
        ratio, hatch = one.over(one.ideal), "" if one.stop.distance else "///"
        axis.barh(place, ratio or 0.0, color=colours.get(one.controller, "0.5"), hatch=hatch)
        words = "no stop" if one.stop.distance is None else f"{one.stop.distance:.0f} m"
        axis.text((ratio or 0.0) + 0.01, place, words, va="center", fontsize=8)
    axis.set_yticks(range(len(scores)), [f"{one.case}, {one.controller}" for one in reversed(scores)], fontsize=8)
    axis.axvline(1.0, color="0.2", linewidth=0.8)
    axis.set_xlabel("stopping distance over the ideal [1]")
    axis.margins(x=0.08)
    return titled(figure, message(scores, cases))


def message(scores: Sequence[Scored], cases: Sequence[str]) -> str:
    """What the picture says in one sentence."""
    worst = max(cases, key=lambda name: max((one.over(one.ideal) or 0.0) for one in scores if one.case == name))
    stopped = [one for one in scores if one.case == worst and one.stop.distance is not None]
    if not stopped:
        return f"{worst}: nothing stops"
    ratios = {one.controller: one.over(one.ideal) for one in stopped if one.controller != "none"}
    told = [f"{name} {ratio:.2f}" for name, ratio in ratios.items() if ratio]
    return f"{worst}: distance over the ideal, {', '.join(told)}" if told else f"{worst}: no ideal to compare with"

"""Scores as a table and as a document for programs."""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path

from bogie_braking.controllers.estimate import LEVEL, Estimate, less
from bogie_braking.controllers.scoring import LOOKS, DrawsPlan, ScoredController
from bogie_braking.reporting.text_table import text_table
from fmu_src.cosimulation.provenance_text import KEY
from products.protection.rails import LOCK_ABOVE
from products.protection.rig import START_SPEED
from products.protection.settings import Settings
from products.run_history import provenance_of
from readers.documents import document_text, finite
from readers.storage import write_whole

HEADS = (
    *("case", "controller", "distance", "95 %", "longer by", "over ideal", "over dry", "longest lock", "in the band"),
    *("sliding", "flat", "air", "reservoir"),
)
UNITS = ("", "", "m", "m", "%", "1", "1", "s", "1", "kJ", "mm", "l", "kPa")


def lines(vehicle: str, settings: Settings, scores: Sequence[ScoredController], draws: str = "") -> Iterator[str]:
    """Yield the lines of the table, and the messages; draws: as `drawn` returns it."""
    yield about(vehicle, settings, scores)
    yield from [draws] if draws else []
    yield ""
    rows = [HEADS, UNITS, *rows_of(scores)]
    yield from text_table(rows, range(2), [n for n in range(2, len(rows)) if rows[n][0] != rows[n - 1][0]])
    for text in messages(scores):
        yield ""
        yield text


def about(vehicle: str, settings: Settings, scores: Sequence[ScoredController]) -> str:
    """Return the common conditions of all stops, or starts."""
    sensors = f"{settings.pulses} pulses a revolution, every {1e3 * settings.period:g} ms"
    what = "traction" if scores[0].driven else "brake"
    torque = f"full {what}" if settings.brake_ratio == 1.0 else f"{settings.brake_ratio:g} of the full {what}"
    if scores[0].driven:
        way, lock = f"from {START_SPEED:g} to {settings.speed:g} m/s", "lock: wheels turn at more than twice the speed"
    else:
        way, lock = f"from {settings.speed:g} m/s", f"lock counted above {LOCK_ABOVE:g} m/s"
    return f"{vehicle}: {torque} {way} unless the case says otherwise, {sensors}; {lock}"


def drawn(scores: Sequence[ScoredController], plan: DrawsPlan, few: str = "") -> str:
    """Return the number of draws of each case, and their spreads.

    few: the controller because of which the number is limited to FEW.
    """
    counts, spread = [len(score.stops) for score in scores], plan.spread
    count, least = max(counts), min(counts)
    varied = (
        f"friction ±{100 * spread.friction:g} %, load ±{100 * spread.load:g} %, teeth {spread.jitter:g} of the pitch"
    )
    limit = f", the limit{f' because {few} is written in Python' if few else ''}" if count == plan.most else ""
    draws = (
        f"{count if count == least else f'{least} to {count}'} draws a case{limit}"
        if count > 1
        else "1 draw a case, too few for an interval"
    )
    return f"{draws}: phases of the sensors, {varied} (all assumed); seed {plan.seed}"


def shortest(scores: Sequence[ScoredController]) -> dict[str, ScoredController]:
    """Return the score with the shortest mean distance in each case."""
    found: dict[str, ScoredController] = {}
    for score in scores:
        least = found.get(score.case)
        if score.distance and (least is None or not least.distance or score.distance.mean < least.distance.mean):
            found[score.case] = score
    return found


def rows_of(scores: Sequence[ScoredController]) -> list[tuple[str, ...]]:
    """Return the rows of the table, each with its difference to the shortest distance in its case."""
    least = shortest(scores)
    pairs = len({one.case for one in scores}) * math.comb(len({one.controller for one in scores}), 2)
    level = 1.0 - (1.0 - LEVEL) / (max(pairs, 1) * len(LOOKS))  # Bonferroni, as in `level_of`
    return [cells(score, least.get(score.case), level) for score in scores]


def longer_by(scored: ScoredController, least: ScoredController | None, level: float) -> str:
    """Return the paired difference to the shortest distance [%], or that both cannot be told apart."""
    if least is None or scored.distances is None or least.distances is None or least.distance is None:
        return "-"
    if scored is least:
        return "shortest"
    found = less(scored.distances, least.distances).estimate(level).over(least.distance.mean)
    if found.mean == 0.0 and (found.count == 1 or found.half == 0.0):
        return "equal"
    if not found.differs and found.count > 1:
        return "not apart"
    return f"{100 * found.mean:.1f}"


def messages(scores: Sequence[ScoredController]) -> list[str]:
    """Return the messages of the stops that have one."""
    return [f"{score.controller}, {score.case}: {score.stop.message}" for score in scores if score.stop.message]


def cells(scored: ScoredController, least: ScoredController | None = None, level: float = LEVEL) -> tuple[str, ...]:
    """Return a row of the table; of a stop without a verdict only that.

    least: the score with the shortest distance in the case; level: probability of the interval of the difference.
    """

    def number(value: float | None, form: str) -> str:
        return "-" if value is None else format(value, form)

    stop = scored.stop
    if not stop.judged:
        return scored.case, scored.controller, "not judged", *["-"] * (len(HEADS) - 3)
    known = scored.distance
    distance = scored.words.none if known is None else f"{known.mean:.1f}"
    width = "-" if known is None else half(known, 1.0, ".1f")
    ratios = number(scored.over(scored.ideal), ".3f"), number(scored.over(scored.dry), ".3f")
    band = "-" if stop.distance is None else f"{stop.share_in_band:.2f}"
    rest = f"{stop.longest_lock:.2f}", band, f"{scored.tread_energy / 1e3:.0f}"
    air = f"{1e3 * scored.flat:.0f}", f"{scored.air:.0f}", f"{(stop.lowest_reservoir or 0.0) / 1e3:.0f}"
    return scored.case, scored.controller, distance, width, longer_by(scored, least, level), *ratios, *rest, *air


def half(estimate: Estimate, unit: float, form: str) -> str:
    """Return half of the interval in a unit, as ±0.3; - with one draw."""
    return f"±{format(estimate.half / unit, form)}" if math.isfinite(estimate.half) else "-"


def document(
    vehicle: str, settings: Settings, scores: Sequence[ScoredController], plan: DrawsPlan | None = None
) -> dict[str, object]:
    """Return the results for programs; SI units, air in litres."""
    draws = {"plan": asdict(plan)} if plan else {}
    return {"vehicle": vehicle, "settings": asdict(settings), **draws, "runs": runs_document(scores)}


def runs_document(scores: Sequence[ScoredController]) -> list[dict[str, object]]:
    """Return the stops for programs; SI units, air in litres."""
    return [
        {"case": score.case, "controller": score.controller, **asdict(replace(score.stop, history=None))}
        | {"distance": score.distance and score.distance.mean, "estimate": score.distance and asdict(score.distance)}
        | {"distances": [of.distance for of in score.each]}
        | {
            "over_ideal": score.over(score.ideal),
            "over_dry": score.over(score.dry),
            "ideal": score.ideal,
            "litres": score.air,
        }
        | {"tread_energy": score.tread_energy, "flat": score.flat}
        for score in scores
    ]


def show(chosen: argparse.Namespace, text: str, lines: Iterable[str]) -> None:
    """Print a document with --json, nothing with --quiet, and the lines otherwise."""
    if chosen.json:
        print(text, end="")
    elif not chosen.quiet:
        print("\n".join(lines))


def write_document(path: Path, about: Mapping[str, object]) -> str:
    """Write a document for programs as a whole, null for numbers that are not finite; return its text.

    It has a provenance: the command, the version and the digest of the sources.
    """
    provenance = provenance_of(f"controllers {path.stem}", {})
    text = document_text(finite({**about, KEY: provenance}))
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, text.encode())
    return text

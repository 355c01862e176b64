"""Scores as a table and as a document for programs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path

from products.protection.rails import LOCK_ABOVE
from products.protection.rig import START_SPEED
from products.protection.settings import Settings
from readers.documents import document_text, finite
from readers.storage import write_whole
from scenarios.controllers.scoring import Scored
from scenarios.controllers.words import words_of

HEADS = (
    *("case", "controller", "distance", "spread", "over ideal", "over dry", "longest lock", "in the band"),
    *("sliding", "flat", "air", "reservoir"),
)
UNITS = ("", "", "m", "m", "1", "1", "s", "1", "kJ", "mm", "l", "kPa")


def lines(vehicle: str, settings: Settings, scores: Sequence[Scored]) -> Iterator[str]:
    """Yield the lines of the table, and the messages."""
    yield about(vehicle, settings, scores)
    yield ""
    rows = [HEADS, UNITS, *(cells(one) for one in scores)]
    widths = [max(len(row[column]) for row in rows) for column in range(len(HEADS))]
    for number, row in enumerate(rows):
        if number > 1 and row[0] != rows[number - 1][0]:
            yield "-" * (sum(widths) + 2 * (len(widths) - 1))
        texts = [
            text.ljust(width) if column < 2 else text.rjust(width)
            for column, (text, width) in enumerate(zip(row, widths, strict=True))
        ]
        yield "  ".join(texts).rstrip()
    for text in messages(scores):
        yield ""
        yield text


def about(vehicle: str, settings: Settings, scores: Sequence[Scored]) -> str:
    """Return the common conditions of all stops, or starts."""
    sensors = f"{settings.pulses} pulses a revolution, every {1e3 * settings.period:g} ms"
    what = "traction" if scores[0].driven else "brake"
    torque = f"full {what}" if settings.brake_ratio == 1.0 else f"{settings.brake_ratio:g} of the full {what}"
    if scores[0].driven:
        way, lock = f"from {START_SPEED:g} to {settings.speed:g} m/s", "lock: wheels turn at more than twice the speed"
    else:
        way, lock = f"from {settings.speed:g} m/s", f"lock counted above {LOCK_ABOVE:g} m/s"
    phases = max(len(one.stops) for one in scores)
    stops = f"; {phases} phases a case" if phases > 1 else ""
    return f"{vehicle}: {torque} {way} unless the case says otherwise, {sensors}; {lock}{stops}"


def messages(scores: Sequence[Scored]) -> list[str]:
    """Return the messages of the stops that have one."""
    return [f"{one.controller}, {one.case}: {one.stop.message}" for one in scores if one.stop.message]


def cells(one: Scored) -> tuple[str, ...]:
    """Return a row of the table; of a stop without a verdict only that."""

    def number(value: float | None, form: str) -> str:
        return "-" if value is None else format(value, form)

    stop = one.stop
    if not stop.judged:
        return one.case, one.controller, "not judged", *["-"] * (len(HEADS) - 3)
    distance = words_of(one.driven).none if stop.distance is None else f"{stop.distance:.1f}"
    ratios = number(one.over(one.ideal), ".3f"), number(one.over(one.dry), ".3f")
    band = "-" if stop.distance is None else f"{stop.share_in_band:.2f}"
    rest = f"{stop.longest_lock:.2f}", band, f"{one.tread_energy / 1e3:.0f}"
    air = f"{1e3 * one.flat:.0f}", f"{one.air:.0f}", f"{(stop.lowest_reservoir or 0.0) / 1e3:.0f}"
    return one.case, one.controller, distance, number(one.spread, ".1f"), *ratios, *rest, *air


def document(vehicle: str, settings: Settings, scores: Sequence[Scored]) -> dict[str, object]:
    """Return the results for programs; SI units, air in litres."""
    runs = [
        {"case": one.case, "controller": one.controller, **asdict(replace(one.stop, history=None))}
        | {"distances": [of.distance for of in one.stops or [one.stop]], "spread": one.spread}
        | {"over_ideal": one.over(one.ideal), "over_dry": one.over(one.dry), "ideal": one.ideal, "litres": one.air}
        | {"tread_energy": one.tread_energy, "flat": one.flat}
        for one in scores
    ]
    return {"vehicle": vehicle, "settings": asdict(settings), "runs": runs}


def write_document(path: Path, about: Mapping[str, object]) -> str:
    """Write a document for programs as a whole, null for numbers that are not finite; return its text."""
    text = document_text(finite(about))
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, text.encode())
    return text

"""A comparison as one page that plays: a single file, which asks for no other and for no network.

It draws on canvases by some two hundred lines of its own. Plotly would be 5 MB, and knows no machine that brakes.
"""

from __future__ import annotations

import base64
import json
import math
import re
import zlib
from collections.abc import Iterator, Sequence
from html import escape
from itertools import groupby
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from products.protection.braked_machine import Machine
from products.protection.history import History
from products.protection.protected_stop import Settings
from products.protection.rails import LOCK_ABOVE
from scenarios import reporting
from scenarios.controllers import table, verdict
from scenarios.controllers.scoring import Scored
from scenarios.controllers.words import words_of

WEB = Path(__file__).parent / "web"
CANVAS = Path(reporting.__file__).parent / "page" / "canvas.js"
#: In the order in which they use each other.
SCRIPTS = (CANVAS, *(WEB / name for name in ("stops.js", "track.js", "chart.js", "player.js")))
#: Looks of a stop that a page holds at most; of a longer one it has every second look, every third, and so on.
MOST_LOOKS = 600
#: What the whole numbers of a page count: ms, dm, cm/s, kPa or kN.m.
TIME, DISTANCE, SPEED, EFFORT = 1e-3, 0.1, 0.01, 1e3
#: Largest of them that a difference may reach: a sensor that shows more than 327 m/s is shown to show that.
LARGEST = 2**15 - 1


def page(vehicle: str, machine: Machine, settings: Settings, scores: Sequence[Scored]) -> str:
    """Its text, of scores with their histories."""
    found = verdict.verdicts(scores)
    parts = {
        "STYLE": (WEB / "page.css").read_text(encoding="utf-8"),
        "SAID": escape(" ".join(verdict.sentences(found))),
        "VERDICT": "\n".join(rows(verdict.heads(found), verdict.UNITS, [[verdict.cells(one)] for one in found])),
        "ABOUT": escape(table.about(vehicle, settings, scores)),
        "CASES": "".join(options(scores)),
        "SCORES": "\n".join(rows(table.HEADS, table.UNITS, by_case(scores), buttons=True)),
        "SENTENCES": "".join(f"<li>{escape(text)}</li>" for text in table.said(scores)),
        "EFFORT": words_of(scores[0].driven).effort,
        "DATA": json.dumps(data(machine, scores), separators=(",", ":")).replace("<", "\\u003c"),
        "SCRIPT": "\n".join(path.read_text(encoding="utf-8") for path in SCRIPTS),
    }
    # In one go, so that a name of the user's which looks like a mark stays as it is.
    return re.sub(r"@([A-Z]+)@", lambda mark: parts[mark[1]], (WEB / "page.html").read_text(encoding="utf-8"))


def names_of(scores: Sequence[Scored]) -> list[str]:
    """Of the cases, in their order."""
    return list(dict.fromkeys(one.case for one in scores))


def options(scores: Sequence[Scored]) -> Iterator[str]:
    """Of the list of cases; the one in which distances over the ideal lie farthest apart is chosen first."""
    ratios: dict[str, list[float]] = {name: [] for name in names_of(scores)}
    for one in scores:
        ratios[one.case] += [ratio for ratio in [one.over(one.ideal)] if ratio is not None]
    first = max(ratios, key=lambda name: max(ratios[name], default=0.0) - min(ratios[name], default=0.0))
    for number, name in enumerate(ratios):
        yield f'<option value="{number}"{" selected" if name == first else ""}>{escape(name)}</option>'


def by_case(scores: Sequence[Scored]) -> list[list[tuple[str, ...]]]:
    """Rows of the table in groups."""
    return [[table.cells(one) for one in group] for _, group in groupby(scores, lambda one: one.case)]


def rows(
    heads: Sequence[str], units: Sequence[str], groups: Sequence[Sequence[Sequence[str]]], buttons: bool = False
) -> Iterator[str]:
    """A table in HTML, without its outermost mark; buttons: the first cell of each group chooses what is played."""
    kinds = ["number" if unit else "text" for unit in units]
    shown = (f"{head} [{unit}]" if unit not in ("", "1") else head for head, unit in zip(heads, units, strict=True))
    cells = "".join(f"<th scope=col class={kind}>{escape(head)}</th>" for kind, head in zip(kinds, shown, strict=True))
    yield f"<thead><tr>{cells}</tr></thead>"
    for number, group in enumerate(groups):
        yield "<tbody>"
        for place, row in enumerate(group):
            first, *rest = (escape(text) for text in row)
            if buttons:
                first = f'<button type="button" data-case="{number}">{first}</button>'
            head = f"<th scope=rowgroup rowspan={len(group)}>{first}</th>" if place == 0 else ""
            cells = "".join(f"<td class={kind}>{text}</td>" for kind, text in zip(kinds[1:], rest, strict=True))
            yield f"<tr>{head}{cells}</tr>"
        yield "</tbody>"


# -- what the scripts are given ----------------------------------------------------------------------------------------


def data(machine: Machine, scores: Sequence[Scored]) -> dict[str, object]:
    """Numbers of all stops; their histories are one text, 16-bit differences of whole numbers, deflated, in base64."""
    histories, words = [thinned(one.history) for one in scores if one.history], words_of(scores[0].driven)
    numbers = b"".join(packed(one, machine.parameters.wheel_radius) for one in histories)
    return {
        "wheelsets": len(machine.numbers),
        "radius": machine.parameters.wheel_radius,
        "fullEffort": full_effort(machine, scores) / EFFORT,
        "effortUnit": words.unit,
        "noEnd": words.none,
        "notJudged": "not judged",
        "end": "arrives" if scores[0].driven else "stands",
        "lockAbove": LOCK_ABOVE,
        "units": {"time": TIME, "distance": DISTANCE, "speed": SPEED},
        "cases": names_of(scores),
        "stops": [
            {
                "case": one.case,
                "controller": one.controller,
                "ideal": one.ideal,
                "distance": (one.stops or [one.stop])[0].distance,  # of the phase that is drawn
                "judged": one.stop.judged,
                "said": one.stop.said,
                "looks": history.time.size,
            }
            for one, history in zip(scores, histories, strict=True)
        ],
        "histories": base64.b64encode(zlib.compress(numbers, 9)).decode(),
    }


def full_effort(machine: Machine, scores: Sequence[Scored]) -> float:
    """Pressure of the full brake [Pa]; of starts the largest torque of a motor that was seen [N.m]."""
    if not scores[0].driven:
        return machine.full_pressure
    return max(float(one.history.effort.max()) for one in scores if one.history)


def thinned(history: History) -> History:
    """The same with at most MOST_LOOKS looks and the last one."""
    chosen = np.arange(0, history.time.size - 1, math.ceil(history.time.size / MOST_LOOKS))
    chosen = np.append(chosen, history.time.size - 1)
    return History(**{name: values[chosen] for name, values in vars(history).items()})


def packed(history: History, radius: float) -> bytes:
    """Columns one after the other: time, distance, speed; of all wheelsets speed, what is shown, effort, valve."""
    columns = [history.time / TIME, history.distance / DISTANCE, history.speed / SPEED]
    wheel_speed = radius * history.angular_velocity
    for of_each in (wheel_speed / SPEED, history.sensor_speed / SPEED, history.effort / EFFORT, history.valve):
        columns += list(np.clip(of_each, 0.0, LARGEST).T)
    return b"".join(differences(column) for column in columns)


def differences(column: NDArray[np.float64]) -> bytes:
    """From one rounded number to the next, the first from 0."""
    return np.diff(np.rint(column), prepend=0.0).astype("<i2").tobytes()

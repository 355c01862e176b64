"""A comparison as one page that plays: a single file, which asks for no other and for no network.

It draws on canvases by some two hundred lines of its own. Plotly would be 5 MB, and knows no machine that brakes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from products.machine import Machine
from products.protection.history import History
from products.protection.rails import LOCK_ABOVE
from products.protection.settings import Settings
from scenarios.controllers import table, verdict
from scenarios.controllers.scoring import Scored
from scenarios.controllers.words import words_of
from scenarios.web.frame import filled, packed

#: Looks of a stop that a page holds at most; of a longer one it has every second look, every third, and so on.
MOST_LOOKS = 600
#: What the whole numbers of a page count: ms, dm, cm/s, kPa or kN.m.
TIME, DISTANCE, SPEED, EFFORT = 1e-3, 0.1, 0.01, 1e3
#: Largest of them that a difference may reach: a sensor that shows more than 327 m/s is shown to show that.
LARGEST = 2**15 - 1


def page(vehicle: str, machine: Machine, settings: Settings, scores: Sequence[Scored]) -> str:
    """Its text, of scores with their histories."""
    found = verdict.verdicts(scores)
    by_case = [[table.cells(one) for one in group] for _, group in groupby(scores, lambda one: one.case)]
    return filled(
        "comparison.html.jinja",
        title="Wheel-slide controllers side by side",
        said=" ".join(verdict.sentences(found)),
        verdict=(heads(verdict.heads(found), verdict.UNITS), [[verdict.cells(one)] for one in found]),
        about=table.about(vehicle, settings, scores),
        first=first_case(scores),
        scores=(heads(table.HEADS, table.UNITS), by_case),
        sentences=table.said(scores),
        effort=words_of(scores[0].driven).effort,
        data=data(machine, scores),
    )


def names_of(scores: Sequence[Scored]) -> list[str]:
    """Of the cases, in their order."""
    return list(dict.fromkeys(one.case for one in scores))


def first_case(scores: Sequence[Scored]) -> str:
    """The case in which distances over the ideal lie farthest apart; it is chosen first."""
    ratios: dict[str, list[float]] = {name: [] for name in names_of(scores)}
    for one in scores:
        ratios[one.case] += [ratio for ratio in [one.over(one.ideal)] if ratio is not None]
    return max(ratios, key=lambda name: max(ratios[name], default=0.0) - min(ratios[name], default=0.0))


def heads(names: Sequence[str], units: Sequence[str]) -> list[tuple[str, str]]:
    """Of a table: each head with its unit, and whether its column has numbers or texts."""
    shown = (f"{name} [{unit}]" if unit not in ("", "1") else name for name, unit in zip(names, units, strict=True))
    return [(text, "number" if unit else "text") for text, unit in zip(shown, units, strict=True)]


# -- what the scripts are given ----------------------------------------------------------------------------------------


def data(machine: Machine, scores: Sequence[Scored]) -> dict[str, object]:
    """Numbers of all stops; their histories are one text, 16-bit differences of whole numbers, deflated, in base64."""
    histories, words = [thinned(one.history) for one in scores if one.history], words_of(scores[0].driven)
    numbers = b"".join(columns_of(one, machine.parameters.wheel_radius) for one in histories)
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
        "histories": packed(numbers),
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


def columns_of(history: History, radius: float) -> bytes:
    """Columns one after the other: time, distance, speed; of all wheelsets speed, what is shown, effort, valve."""
    columns = [history.time / TIME, history.distance / DISTANCE, history.speed / SPEED]
    wheel_speed = radius * history.angular_velocity
    for of_each in (wheel_speed / SPEED, history.sensor_speed / SPEED, history.effort / EFFORT, history.valve):
        columns += list(np.clip(of_each, 0.0, LARGEST).T)
    return b"".join(differences(column) for column in columns)


def differences(column: NDArray[np.float64]) -> bytes:
    """From one rounded number to the next, the first from 0."""
    return np.diff(np.rint(column), prepend=0.0).astype("<i2").tobytes()

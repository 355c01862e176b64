"""A comparison as one animated page: a single file that loads no other file and needs no network.

It draws on canvases by some two hundred lines of code. Plotly would add 5 MB, and has no animation of vehicles.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from bogie_braking.controllers import table, verdict
from bogie_braking.controllers.scoring import ScoredController
from bogie_braking.web.frame import filled, packed
from products.machine import Machine
from products.protection.history import StopHistory
from products.protection.rails import LOCK_ABOVE
from products.protection.settings import Settings

#: Largest number of samples of a stop on a page; longer stops are thinned to every second sample, every third, and so
#: on.
MOST_SAMPLES = 600
#: Units of the integers of a page: ms, dm, cm/s, kPa or kN.m.
TIME, DISTANCE, SPEED, EFFORT = 1e-3, 0.1, 0.01, 1e3
#: Largest integer of a difference: a sensor value above 327 m/s is limited to that.
LARGEST = 2**15 - 1


def page(vehicle: str, machine: Machine, settings: Settings, scores: Sequence[ScoredController], draws: str) -> str:
    """Return the text of the page, from scores with their histories; draws: as `table.drawn` returns it."""
    found = verdict.verdicts(scores)
    by_case = [list(group) for _, group in groupby(table.rows_of(scores), lambda row: row[0])]
    return filled(
        "comparison.html.jinja",
        title="Wheel-slide controllers side by side",
        headline=" ".join(verdict.messages(found)),
        verdict=(heads(verdict.heads(found), verdict.UNITS), [[verdict.cells(one)] for one in found]),
        about=f"{table.about(vehicle, settings, scores)}; {draws}",
        first=first_case(scores),
        scores=(heads(table.HEADS, table.UNITS), by_case),
        messages=table.messages(scores),
        effort=scores[0].words.effort,
        data=data(machine, scores),
    )


def names_of(scores: Sequence[ScoredController]) -> list[str]:
    """Return the names of the cases, in their order."""
    return list(dict.fromkeys(score.case for score in scores))


def first_case(scores: Sequence[ScoredController]) -> str:
    """Return the case with the largest range of distances over the ideal; it is selected first."""
    ratios: dict[str, list[float]] = {name: [] for name in names_of(scores)}
    for score in scores:
        ratios[score.case] += [ratio for ratio in [score.over(score.ideal)] if ratio is not None]
    return max(ratios, key=lambda name: max(ratios[name], default=0.0) - min(ratios[name], default=0.0))


def heads(names: Sequence[str], units: Sequence[str]) -> list[tuple[str, str]]:
    """Return the heads of a table: each with its unit, and whether its column has numbers or strings."""
    shown = (f"{name} [{unit}]" if unit not in ("", "1") else name for name, unit in zip(names, units, strict=True))
    return [(text, "number" if unit else "text") for text, unit in zip(shown, units, strict=True)]


# -- what the scripts are given ----------------------------------------------------------------------------------------


def data(machine: Machine, scores: Sequence[ScoredController]) -> dict[str, object]:
    """Return the data of all stops.

    Their histories are one string: 16-bit differences of integers, deflated, in base64.
    """
    histories, words = [thinned(score.history) for score in scores if score.history], scores[0].words
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
                "distance": (one.stops or [one.stop])[0].distance,  # of the draw that is shown
                "judged": one.stop.judged,
                "message": one.stop.message,
                "samples": history.time.size,
            }
            for one, history in zip(scores, histories, strict=True)
        ],
        "histories": packed(numbers),
    }


def full_effort(machine: Machine, scores: Sequence[ScoredController]) -> float:
    """Return the pressure of the full brake [Pa]; of starts the largest recorded torque of a motor [N.m]."""
    if not scores[0].driven:
        return machine.full_pressure
    return max(float(score.history.effort.max()) for score in scores if score.history)


def thinned(history: StopHistory) -> StopHistory:
    """Return the history with at most MOST_SAMPLES samples and the last one."""
    chosen = np.arange(0, history.time.size - 1, math.ceil(history.time.size / MOST_SAMPLES))
    chosen = np.append(chosen, history.time.size - 1)
    return StopHistory(**{name: values[chosen] for name, values in vars(history).items()})


def columns_of(history: StopHistory, radius: float) -> bytes:
    """Return the columns in sequence: time, distance, speed; of all wheelsets speed, sensor speed, effort, valve."""
    columns = [history.time / TIME, history.distance / DISTANCE, history.speed / SPEED]
    wheel_speed = radius * history.angular_velocity
    for of_each in (wheel_speed / SPEED, history.sensor_speed / SPEED, history.effort / EFFORT, history.valve):
        columns += list(np.clip(of_each, 0.0, LARGEST).T)
    return b"".join(differences(column) for column in columns)


def differences(column: NDArray[np.float64]) -> bytes:
    """Return the differences of rounded numbers, the first from 0."""
    return np.diff(np.rint(column), prepend=0.0).astype("<i2").tobytes()

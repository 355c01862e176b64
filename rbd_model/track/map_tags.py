"""Gradients and limits of speed that a map states, along the length of a smoothed course."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rbd_model.track.points import Points
from readers.formats.line_tracks import LISTED
from readers.import_account import Account

Numbers = NDArray[np.float64]
#: Largest distance of stretches with equal limits that are one [m].
NEXT = 5.0


def stated_gradient(way: Numbers, given: Points, length: Numbers) -> Numbers:
    """Return the gradient that a map states, 0 where it states none."""
    slope = np.zeros_like(length)
    for first, last, gradient, _ in given.stretches:
        if gradient is not None:
            slope[(length >= _at(way, given, first)) & (length <= _at(way, given, last))] = gradient
    return slope


def level_message(slope: Numbers, given: Points) -> str:
    """Return the message about a line without heights."""
    if not any(gradient is not None for *_, gradient, _ in given.stretches):
        return "the gradient is 0: the points have no heights"
    share = 100.0 * float(np.mean(slope != 0.0))
    return f"the gradient is that of the tags incline, on {share:.3g} % of the line, and 0 elsewhere: no heights"


def stated_limits(
    way: Numbers, given: Points, length: Numbers, distance: Numbers, account: Account
) -> list[tuple[float, float, float]]:
    """Return stretches [m] with the limit of speed that a map states [m/s], equal ones joined."""
    found: list[tuple[float, float, float]] = []
    for first, last, _, speed in given.stretches:
        if speed is not None:
            begin, end = (float(np.interp(_at(way, given, one), length, distance)) for one in (first, last))
            if found and found[-1][2] == speed and begin - found[-1][1] < NEXT:
                begin = found.pop()[0]
            found.append((begin, end, speed))
    if found:
        told = ", ".join(f"{3.6 * one:.4g} km/h from {begin:.0f} to {end:.0f} m" for begin, end, one in found[:LISTED])
        more = f" and {len(found) - LISTED} more" if len(found) > LISTED else ""
        account.taken.append(f"maxspeed, as speed_limits of the line: {told}{more}")
    return found


def _at(way: Numbers, given: Points, place: int) -> float:
    """Return the length at a point of the file [m]."""
    return float(np.interp(place, given.places, way))

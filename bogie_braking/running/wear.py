"""Wear numbers of wheels along a line, or by its curvature."""

from __future__ import annotations

import numpy as np

from bogie_braking.checks import line_or_none, number, shown
from bogie_braking.running.filters import finite
from fmu_src.cosimulation.recording import Recording
from rbd_model.track.line import Line

#: Begin of the columns that are mapped.
WEAR = "wear_number_"
#: Largest number of classes.
MOST_CLASSES = 100_000


def wear_map(recording: Recording, width: float, line: Line | None = None) -> Recording:
    """Return mean wear numbers T-gamma in classes of distance or, with a line, of its curvature.

    A mean is over the distance that the vehicle travels in a class: 1 N is 1 J for each metre.

    Parameters
    ----------
    recording : Recording
        A run with `contact_outputs=True`.
    width : float
        Width of a class. It is a distance [m], or with a line a curvature [1/m].
    line : Line, optional
        Line of the run: classes are then those of its curvature, around multiples of the width.

    Returns
    -------
    Recording
        A row for each class: the `distance` [m] or `curvature` [1/m] in its middle, the `length` [m] that the vehicle
        travels in it, and the mean of each wear number [N].

    Raises
    ------
    KeyError
        If the recording has no distance or no wear number.
    ValueError
        If the width is not above 0, or makes more than 100 000 classes, or the recording has less than 2 rows.
    """
    names = [name for name in recording.names if name.startswith(WEAR)]
    if not names:
        raise KeyError("The recording has no wear number; run with contact_outputs=True at level 3.")
    distance, own, size = finite(recording, "distance"), line_or_none(line), number(width)
    if not 0.0 < size < np.inf:
        raise ValueError(f"width must be a number above 0; got {shown(width)}.")
    if distance.size < 2:
        raise ValueError(f"The recording must have at least 2 rows; got {distance.size}. Run longer.")
    travelled = np.abs(np.diff(distance))  # also of a vehicle that rolls back
    middle = (distance[1:] + distance[:-1]) / 2
    axis, unit = ("distance", "m") if own is None else ("curvature", "1/m")
    values = middle if own is None else own.value("curvature", middle)
    if np.ptp(values) / size > MOST_CLASSES:
        raise ValueError(f"width must make at most {MOST_CLASSES} classes; got {np.ptp(values) / size:.3g}.")
    # Classes of distance begin at multiples of the width. Those of curvature lie around them: one is straight track.
    shift = 0.5 if own is None else 0.0
    number_of = np.floor(values / size + 0.5 - shift).astype(int)
    classes, place = np.unique(number_of, return_inverse=True)
    length = np.bincount(place, travelled)
    columns = [(classes + shift) * size, length]
    for name in names:
        between = finite(recording, name)
        work = (between[1:] + between[:-1]) / 2 * travelled
        columns.append(np.bincount(place, work) / np.where(length > 0.0, length, 1.0))
    units = {axis: unit, "length": "m"} | {name: recording.units[name] for name in names}
    kept = length > 0.0
    return Recording(units, np.column_stack(columns)[kept])

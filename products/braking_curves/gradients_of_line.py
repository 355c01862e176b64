"""Gradients of a line as ETCS has them."""

from __future__ import annotations

import numpy as np

from products.supervision.gradients import STEEPEST, Gradients
from rbd_model.track.line import Line
from readers.text import BadInputError


def gradients_of(line: Line) -> Gradients:
    """Return the gradients of a line as ETCS has them: between rows the lower one of both, then the last [permille]."""
    places = np.asarray(line.rows["distance"], dtype=float)
    values = 1e3 * np.asarray(line.rows.get("gradient", np.zeros(places.size)), dtype=float)
    if np.max(np.abs(values)) > STEEPEST:
        row, most = int(np.argmax(np.abs(values))), STEEPEST / 1e3
        got = f"{values[row] / 1e3:g} at {places[row]:g} m"
        raise BadInputError(f"Gradients must be from -{most:g} to {most:g}; got {got}. Give rise over length.")
    lower = np.append(np.minimum(values[:-1], values[1:]), values[-1])  # a line keeps its last gradient beyond its end
    changes = np.append(True, np.diff(lower) != 0.0)
    return Gradients(places[changes], lower[changes], "permille")

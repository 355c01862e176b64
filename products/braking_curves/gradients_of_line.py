"""Gradients of a line as ETCS has them."""

from __future__ import annotations

import numpy as np

from products.supervision import Gradients
from rbd_model.track.line import Line


def gradients_of(line: Line) -> Gradients:
    """Return the gradients of a line as ETCS has them: between two rows the lower one of both [permille].

    Parameters
    ----------
    line : Line
        The line.

    Returns
    -------
    Gradients
        Steps with their starts.
    """
    places = np.asarray(line.rows["distance"], dtype=float)
    values = 1e3 * np.asarray(line.rows.get("gradient", np.zeros(places.size)), dtype=float)
    lower = np.minimum(values[:-1], values[1:]) if values.size > 1 else values
    starts = places[: lower.size]
    changes = np.append(True, np.diff(lower) != 0.0)
    return Gradients(starts[changes], lower[changes])

"""Release speed towards an end of authority, SUBSET-026, 3.13.9.4."""

from __future__ import annotations

from typing import Any

import numpy as np

from products.supervision.arguments import at_least, finite
from products.supervision.conversion import KMH
from products.supervision.curves import checked_values, predicted_error, supervise
from products.supervision.train import SupervisedTrain
from readers.text import BadInputError

#: Speed up to which a release speed is sought [m/s], and its resolution on board [m/s].
FASTEST, RESOLUTION = 100.0 * KMH, 1.0 * KMH


def release_speed(train: SupervisedTrain, beyond: float, trip: float = 0.0, place: float = 0.0, **others: Any) -> float:
    """Return the release speed that the on-board unit calculates: a train that passes the EOA faster is tripped.

    Its emergency brake then stops the train before the supervised location.

    Takes beyond [m], trip [m], place [m]; returns [m/s].
    """
    if "A_est" in others:
        raise BadInputError("A_est must be left out of a release speed: the standard sets it to 0 (3.13.9.4.8.1).")
    beyond, trip, place = finite("beyond", beyond), finite("trip", trip), finite("place", place)
    if beyond < 0.0:
        raise BadInputError(f"beyond must be at least 0 m, the distance of the SvL behind the EOA; got {beyond:g} m.")
    if not 0.0 <= trip <= beyond:
        raise BadInputError(f"trip must be 0 to {beyond:g} m, the distance of the SvL; got {trip:g} m.")
    speeds = np.arange(0.0, FASTEST + RESOLUTION, RESOLUTION)
    measured = others.pop("V_ura", None)
    national, *_ = checked_values(others.get("national"))
    if measured is None and national.exact_speed:
        measured = 0.0
    least = 0.0 if measured is None else np.max(at_least("V_ura", measured, 0.0, "m/s"))
    error = np.maximum(predicted_error(measured, speeds), least)
    found = supervise(train, place, speeds, kind="EOA", beyond=beyond, V_ura=error, **others).EBI
    safe = np.nonzero(np.ravel(found) >= place + trip)[0]
    return float(speeds[safe[-1]]) if safe.size else 0.0

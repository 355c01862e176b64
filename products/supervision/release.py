"""Release speed towards an end of authority, SUBSET-026, 3.13.9.4."""

from __future__ import annotations

from typing import Any

import numpy as np

from products.supervision.conversion import KMH
from products.supervision.curves import supervise
from products.supervision.train import SupervisedTrain
from readers.text import BadInputError

#: Speed up to which a release speed is sought [m/s], and its resolution on board [m/s].
FASTEST, RESOLUTION = 100.0 * KMH, 1.0 * KMH


def release_speed(train: SupervisedTrain, beyond: float, trip: float = 0.0, **others: Any) -> float:
    """Return the release speed that the on-board unit calculates: a train that passes the EOA faster is tripped.

    Its emergency brake then stops the train before the supervised location.

    Parameters
    ----------
    train : SupervisedTrain
        One train.
    beyond : float
        Distance of the supervised location (SvL) behind the end of authority [m].
    trip : float
        Distance behind the end of authority at which the train is tripped [m].
    **others
        Other arguments of `supervise`: gradients, national, fixed, V_ura.

    Returns
    -------
    float
        Speed, rounded down to 1 km/h [m/s]; 0 if no speed is safe.

    Raises
    ------
    BadInputError
        If the trip lies behind the supervised location.
    """
    if not 0.0 <= trip <= beyond:
        raise BadInputError(f"trip must be 0 to {beyond:g} m, the distance of the SvL; got {trip:g} m.")
    speeds = np.arange(0.0, FASTEST + RESOLUTION, RESOLUTION)
    found = supervise(train, 0.0, speeds, kind="EOA", beyond=beyond, **others).EBI
    safe = np.nonzero(np.ravel(found) >= trip)[0]
    return float(speeds[safe[-1]]) if safe.size else 0.0

"""Which depth of the brake a scene needs: the cheapest whose errors are below what is asked.

Errors are the largest that the scenario `train-depths` found on trains of 300 and 900 m, rounded up; it holds them
against trains of 400 and 1200 m.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from products.train.consist import Consist
from products.train.numbers import Settings
from readers.tables import number_of


@dataclass(frozen=True)
class Depth:
    """A depth with what it errs by at most: of the stopping distance and of the largest compression [1].

    releases: whether it says when brakes are released; longest: train for which this holds [m].
    """

    settings: Settings
    distance: float
    force: float
    releases: bool
    longest: float = 1500.0


#: From the cheapest to the dearest.
DEPTHS_BY_COST = {
    "delay": Depth(Settings("delay", cells=1.0), 0.02, 0.15, False, 300.0),
    "empirical, half a cell": Depth(Settings("empirical", cells=0.5, share=0.8), 0.025, 0.06, False),
    "whole, a cell": Depth(Settings("whole", cells=1.0), 0.0075, 0.05, True),
    "whole, two cells": Depth(Settings("whole", cells=2.0), 0.0025, 0.05, True),
    "whole, four cells": Depth(Settings("whole", cells=4.0), 0.001, 0.02, True),
    "whole, eight cells": Depth(Settings("whole", cells=8.0), 0.0, 0.0, True, math.inf),
}


def smallest(consist: Consist, distance: float = 0.01, force: float = 0.05, releases: bool = False) -> Settings:
    """The cheapest settings for a consist with which distance and largest compression err by no more than asked [1].

    releases: whether the scene looks at brakes that are released and charged again. Raises ValueError.
    """
    for name, value in (("distance", distance), ("force", force)):
        if not 0.0 <= number_of(value) < math.inf or isinstance(value, str):
            raise ValueError(f"Ask for an error of the {name} of at least 0, a share: it was {value!r}.")
    for one in DEPTHS_BY_COST.values():
        if (
            one.distance <= distance
            and one.force <= force
            and one.longest >= consist.length
            and one.releases >= releases
        ):
            return one.settings
    return DEPTHS_BY_COST["whole, eight cells"].settings

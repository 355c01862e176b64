"""Choice of a brake model: the cheapest whose errors are below the required values.

Errors are the largest in the scenario `train-brake-models` for trains of 300 and 900 m, rounded up. The
scenario checks them with trains of 400 and 1200 m.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from products.train.consist import Consist
from products.train.numbers import Settings
from products.train.unused_values import without_effect
from readers.decimal_numbers import number_of
from readers.usual import likely_unit


@dataclass(frozen=True)
class BrakeModel:
    """A brake model with its largest relative errors of the stopping distance and of the largest compression [1].

    releases: whether it models released brakes; longest: longest train for which the errors apply [m].
    """

    settings: Settings
    distance: float
    force: float
    releases: bool
    longest: float = 1500.0


#: Largest error that may be allowed [1].
LARGEST_ERROR = 0.5
#: Least number of cells of a vehicle with which a vacuum has the errors below. With one the distance is 1.8 % wrong.
CELLS_OF_VACUUM = 2.0
#: In the order of their costs.
BRAKE_MODELS_BY_COST = {
    "delay": BrakeModel(Settings("delay", cells=1.0), 0.025, 0.15, False, 300.0),
    "empirical, half a cell": BrakeModel(Settings("empirical", cells=0.5, share=0.8), 0.025, 0.09, False),
    "whole, a cell": BrakeModel(Settings("whole", cells=1.0), 0.0075, 0.05, True),
    "whole, two cells": BrakeModel(Settings("whole", cells=2.0), 0.0025, 0.06, True),
    "whole, four cells": BrakeModel(Settings("whole", cells=4.0), 0.001, 0.02, True),
    "whole, eight cells": BrakeModel(Settings("whole", cells=8.0), 0.0, 0.0, True, math.inf),
}


def select_brake_model(
    consist: Consist, distance: float = 0.01, force: float = 0.05, releases: bool = False
) -> Settings:
    """Return the cheapest settings for a consist within the required relative errors [1]."""
    for name, value in (("distance", distance), ("force", force)):
        number = math.nan if isinstance(value, str) else number_of(value)
        if not 0.0 <= number <= LARGEST_ERROR:
            hint = likely_unit(number, "1", 0.0, LARGEST_ERROR)
            raise ValueError(
                f"The error of the {name} must be a share from 0 to {LARGEST_ERROR:g}; got {value!r}.{hint}"
            )
    for brake_model in BRAKE_MODELS_BY_COST.values():
        if (
            brake_model.distance <= distance
            and brake_model.force <= force
            and brake_model.longest >= consist.length
            and brake_model.releases >= releases
            and (brake_model.settings.cells >= CELLS_OF_VACUUM or consist.charged_pressure > 0.0)
            and not without_effect(consist, brake_model.settings.brake_model, brake_model.settings.cells)
        ):
            return brake_model.settings
    return BRAKE_MODELS_BY_COST["whole, eight cells"].settings

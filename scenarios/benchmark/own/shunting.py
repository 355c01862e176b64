"""Stops with random brakes: the stops of the scenario `braking-distance`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from scenarios.bench.shunting_stop import distances

#: Number of stops, and seed of the random inputs. 0.1 % of the mean is eleven standard errors.
STOPS, SEED = 20_000, 1


def answer(inputs: Mapping[str, Any]) -> dict[str, float]:
    """Return mean and standard deviation of the stopping distance [m], and the share of stops beyond the limit."""
    found = distances(inputs, STOPS, SEED, published_method=True)
    share = np.mean(found > inputs["limit"])
    return {"mean": float(np.mean(found)), "deviation": float(np.std(found)), "share": float(share)}

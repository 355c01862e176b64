"""Random stops for training and tuning: rails and speeds within the limits of the test suite of the thresholds."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from products.protection.runs import Run
from rbd_model.contact.friction import constant_friction
from rbd_model.track.friction import low, wet

#: Speeds [m/s] and friction without leaves, the least and the most, as in tests/products/protection/rail_programme.py.
SPEEDS, FRICTIONS = (15.0, 40.0), (0.04, 0.15)
#: Share of rails whose friction decreases with sliding speed, as Polach's low set does; assumed.
FALLING = 0.5
#: Share of wet rails with leaves (4 of 40 cases of that suite), factors on their friction, and their start [m].
LEAVES, LEAVES_FACTORS, LEAVES_BEGIN, LEAVES_LENGTH = 0.1, (0.15, 0.25), (40.0, 80.0), 100.0
#: Factor on the friction behind a wheelset that cleans the rail: none to that of the changing rail (rails.py).
CLEANED = (1.0, 1.1)


def drawn_run(random: np.random.Generator, wheelsets: int) -> Run:
    """Draw a stop of a vehicle with this number of wheelsets.

    Friction is uniform in its logarithm, the other values between their limits.
    """
    speed, cleaned = random.uniform(*SPEEDS), random.uniform(*CLEANED)
    falls, leaves = random.random() < FALLING, random.random() < LEAVES
    friction = math.exp(random.uniform(*np.log(FRICTIONS)))
    factor, begin = random.uniform(*LEAVES_FACTORS), random.uniform(*LEAVES_BEGIN)
    condition = replace(low(), friction=friction, law=low().law if falls else constant_friction())
    patch = {}
    if leaves:
        condition = wet()
        patch = {"patch_friction": factor, "patch_start": begin, "patch_length": LEAVES_LENGTH}
    return Run(condition.values(wheelsets) | patch | {"cleaned_friction": cleaned}, speed)

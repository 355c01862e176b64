"""Stops drawn from a distribution, for training and tuning: rails and speeds within the programme of the thresholds."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from products.protection.runs import Run
from rbd_model.contact.friction import constant_friction
from rbd_model.track.friction import low, wet

#: Speeds [m/s] and friction without leaves, the least and the most, as in scenarios/bench/rail_programme.py.
SPEEDS, FRICTIONS = (15.0, 40.0), (0.04, 0.15)
#: Share of rails whose friction falls with sliding, as that of Polach's low set does; assumed.
FALLING = 0.5
#: Share of wet rails with leaves (4 of 40 of that programme), factors on their friction, and where they begin [m].
LEAVES, LEAVES_FACTORS, LEAVES_BEGIN, LEAVES_LENGTH = 0.1, (0.15, 0.25), (40.0, 80.0), 100.0
#: Factor on the friction behind a wheelset that cleans the rail: none to that of the changing rail (rails.py).
CLEANED = (1.0, 1.1)


def drawn_run(random: np.random.Generator, wheelsets: int) -> Run:
    """A stop of a machine with so many wheelsets; friction is uniform in its logarithm, the rest between its limits."""
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

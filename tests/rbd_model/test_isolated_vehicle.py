"""A vehicle that nothing touches: its momentum changes by its weight alone, and its energy by what it turns to heat.

By the right-hand side of level 3, whole and compiled, with the wheelsets lifted off their rails, brakes on. Newton's
third law, in its strong form, holds whatever the law of a spring is; a connection that pushes two points beside each
other with opposite forces keeps momentum and energy, and loses moments.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from random import Random

import numpy as np
import pytest

from rbd_model.vehicle import (
    BumpStop,
    FrictionSlider,
    RigidBody,
    SeriesDamper,
    Springs,
    Torsion,
    Vehicle,
    wheelset_name,
)
from rbd_model.vehicles import passenger_coach, two_axle_bogie
from tests.maximal.correspondence import bodies_of, rates_of
from tests.maximal.machine import ENERGIES, POWERS, Machine
from tests.maximal.motion import Moving
from tests.maximal.rails import STRAIGHT, Course
from tests.maximal.states import random_course

#: Sums that cancel, as a share of the sizes that are added; states are differenced over 1e-6 s at 30 m/s.
MOMENTUM_BAND = 1e-9
#: Of energies that are differenced over 1e-6 s, as a share of the powers in them.
ENERGY_BAND, MOMENT = 1e-5, 1e-6
#: How high wheelsets are lifted [m], and by how much everything is away from rest [m], [rad], and moves.
LIFTED, AWAY, MOVING = 0.2, 0.05, 0.2
STATES = 5

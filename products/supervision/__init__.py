"""Supervision of a braking train as ETCS defines it, SUBSET-026, section 3.13: curves of place over speed.

Plain functions of the numbers of a train, a line and a target, exact over arcs, in arrays. No vehicle, brake or FMU of
this project is behind them: both meet in numbers alone, so that each can be checked by itself (docs/etcs.md).
"""

from products.supervision.arcs import Arcs, braking_arcs
from products.supervision.causes import (
    BrakedVehicles,
    Cause,
    OneFailure,
    build_up_of,
    causes_of,
    factors_of,
    one_failure,
)
from products.supervision.conversion import BRAKE_POSITIONS, brake_of_percentage
from products.supervision.curves import Curves, supervise
from products.supervision.effects import without_effect
from products.supervision.gradients import Gradients
from products.supervision.packets import Move, RoundedNational, RoundedTrain, rounded_national, rounded_train
from products.supervision.release import release_speed
from products.supervision.safety import BrakeUnits, dry_factors, rounded_down
from products.supervision.steps import Steps
from products.supervision.tolerances import Tolerances
from products.supervision.train import SupervisedTrain
from products.supervision.values import BASELINES, FixedValues, NationalValues

__all__ = [
    "BASELINES",
    "BRAKE_POSITIONS",
    "Arcs",
    "BrakeUnits",
    "BrakedVehicles",
    "Cause",
    "Curves",
    "FixedValues",
    "Gradients",
    "Move",
    "NationalValues",
    "OneFailure",
    "RoundedNational",
    "RoundedTrain",
    "Steps",
    "SupervisedTrain",
    "Tolerances",
    "brake_of_percentage",
    "braking_arcs",
    "build_up_of",
    "causes_of",
    "dry_factors",
    "factors_of",
    "one_failure",
    "release_speed",
    "rounded_down",
    "rounded_national",
    "rounded_train",
    "supervise",
    "without_effect",
]

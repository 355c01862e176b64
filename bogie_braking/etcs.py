"""Supervision curves of ETCS for a train, SUBSET-026, section 3.13 (docs/etcs.md).

>>> from bogie_braking import etcs
>>> train = etcs.SupervisedTrain.of_percentage(100.0, "passenger P", 200.0)
>>> limits = etcs.supervise(train, place=2000.0, V_est=[10.0, 20.0, 30.0])
>>> limits.P  # places of the front at which the permitted speed is 10, 20 and 30 m/s [m]
"""

from products.supervision import (
    BASELINES,
    BRAKE_POSITIONS,
    Arcs,
    BrakeUnits,
    Curves,
    FixedValues,
    Gradients,
    NationalValues,
    Steps,
    SupervisedTrain,
    brake_of_percentage,
    braking_arcs,
    dry_factors,
    release_speed,
    rounded_down,
    supervise,
)

__all__ = [
    "BASELINES",
    "BRAKE_POSITIONS",
    "Arcs",
    "BrakeUnits",
    "Curves",
    "FixedValues",
    "Gradients",
    "NationalValues",
    "Steps",
    "SupervisedTrain",
    "brake_of_percentage",
    "braking_arcs",
    "dry_factors",
    "release_speed",
    "rounded_down",
    "supervise",
]

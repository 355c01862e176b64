"""Friction between shoe and wheel tread. A further law is one more number and one more branch in `shoe_friction`."""

from __future__ import annotations

import casadi as ca

from brake_controller.experiment import EXPERIMENT, FORCE_PER_PRESSURE, SHOES
from fmu_src.system import System, interpolation

CONSTANT, MEASURED_AGAINST_FORCE = 0, 1

#: Force of one shoe [N] and average shoe friction in the three cases of the experiment.
MEASURED_FORCE = [1e3 * kpa * FORCE_PER_PRESSURE / SHOES * case.rigging_efficiency for kpa, case in EXPERIMENT.items()]
MEASURED_FRICTION = [case.shoe_friction for case in EXPERIMENT.values()]


def shoe_friction(system: System, law: ca.SX, constant: ca.SX, force_of_one_shoe: ca.SX) -> ca.SX:
    """Shoe friction coefficient mu_b.

    Law 0: constant. Law 1: straight lines through the three measured averages; below and above the measured forces the
    end values are held, because nothing was measured there.
    """
    measured = system.table("measured_friction", *interpolation(MEASURED_FORCE, MEASURED_FRICTION), force_of_one_shoe)
    return ca.if_else(law == MEASURED_AGAINST_FORCE, measured, constant)

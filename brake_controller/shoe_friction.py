"""Friction between shoe and wheel tread. A further law is one more number and one more branch in `shoe_friction`."""

from __future__ import annotations

import casadi as ca

from fmu_src.system import System, interpolation

CONSTANT, MEASURED_AGAINST_FORCE = 0, 1

#: Rod force of one shoe [N] and average shoe friction in the three cases of the experiment: 0.164/4 kN per kPa times
#: the printed efficiency (section 6.2.3, chapter 7), and 0.30, 0.27, 0.25 (section 7.5).
MEASURED_FORCE = (41.0 * 130 * 0.82, 41.0 * 150 * 0.81, 41.0 * 180 * 0.85)
MEASURED_FRICTION = (0.30, 0.27, 0.25)


def shoe_friction(system: System, law: ca.SX, constant: ca.SX, force_of_one_shoe: ca.SX) -> ca.SX:
    """Shoe friction coefficient mu_b.

    Law 0: constant. Law 1: straight lines through the three measured averages; below and above the measured forces the
    end values are held, because nothing was measured there.
    """
    measured = system.table("measured_friction", *interpolation(MEASURED_FORCE, MEASURED_FRICTION), force_of_one_shoe)
    return ca.if_else(law == MEASURED_AGAINST_FORCE, measured, constant)

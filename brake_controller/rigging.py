"""Brake rigging: force of the shoes by cylinder pressure, eqs (2.4)-(2.6), and torque, eq. (2.7)."""

from __future__ import annotations

import math

from fmu_src.symbols import ca


def force_per_pressure(piston_diameter: float, rigging_ratio: float) -> float:
    """Return shoe force per cylinder pressure [N/Pa], eq. (2.5) times the rigging ratio i_t of (2.4); diameter in m."""
    return rigging_ratio * math.pi / 4 * piston_diameter**2


def shoe_force(pressure: ca.SX, force_per_pressure: ca.SX, counter_force: ca.SX, efficiency: ca.SX) -> ca.SX:
    """Return the effective normal force of the shoes F_Beff [N], eqs (2.4) and (2.6); never a pull.

    This avoids `fmax`, whose derivative at the corner is the mean of both sides: from an empty cylinder force can only
    grow.
    """
    force = force_per_pressure * pressure - counter_force
    return efficiency * ca.if_else(force >= 0, force, 0)


def torque_capacity(shoe_friction: ca.SX, shoe_force: ca.SX, wheel_radius: ca.SX) -> ca.SX:
    """Return the largest torque of the shoes, T_B = mu_b F_B r_w, eq. (2.7) [N.m]."""
    return shoe_friction * shoe_force * wheel_radius

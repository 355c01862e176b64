"""Tangential contact: Polach's creep force (1999) with Kalker's coefficients, eqs (3.89)-(3.98).

Only the longitudinal part: on straight track, without yaw and spin, xi_t = |xi_x| and c_jj = c_11.
"""

from __future__ import annotations

import math

import casadi as ca

#: Kalker's longitudinal coefficient c11 at Poisson's ratio 0.25: Kalker (1990), Three-Dimensional Elastic Bodies in
#: Rolling Contact, table E.3. First row a/b = 0.1 ... 1.0, second row b/a = 0.9 ... 0.1.
C11_SHORT = (3.31, 3.37, 3.44, 3.53, 3.62, 3.72, 3.81, 3.91, 4.01, 4.12)
C11_LONG = (4.22, 4.36, 4.54, 4.78, 5.10, 5.57, 6.34, 7.78, 11.7)


def kalker_c11(axis_ratio: ca.SX) -> ca.SX:
    """Kalker's c11 of an ellipse with axis ratio a/b from 0.1 to 10, linear in the smaller of a/b and b/a.

    Not a number beyond the table, so that a run with such wheels is refused at its start.
    """
    coordinate = ca.if_else(axis_ratio <= 1, axis_ratio, 2 - 1 / axis_ratio)
    value = ca.pw_lin(coordinate, [0.1 * i for i in range(1, 20)], [*C11_SHORT, *C11_LONG])
    tabulated = ca.logic_and(axis_ratio >= 0.1 - 1e-9, axis_ratio <= 10 + 1e-9)
    return ca.if_else(tabulated, value, math.nan)


def creepage(sliding_speed: ca.SX, forward_speed: ca.SX, creepage_speed: ca.SX) -> ca.SX:
    """Longitudinal creepage (xi_x): sliding speed over forward speed.

    Differs from the thesis: sqrt(V^2 + v_eps^2) instead of V, which is 0 at rest.
    """
    return sliding_speed / ca.sqrt(forward_speed**2 + creepage_speed**2)


def polach_force(
    creepage: ca.SX, load: ca.SX, friction: ca.SX, semi_axes: tuple[ca.SX, ca.SX], shear_modulus: ca.SX, c11: ca.SX
) -> ca.SX:
    """Creep force of one wheel along the track, eqs (3.94) and (3.97); opposes the sliding.

    load [N] (Q), semi_axes [m] (a_e, b_e), shear_modulus [Pa] (G). For small creepage it is -G a b c11 xi (Kalker), for
    large creepage -mu Q. Odd in the creepage, so that no absolute value is needed.
    Differs from the thesis: the last factor of (3.94) is printed as nu and is the creepage.
    """
    a, b = semi_axes
    limit = friction * load
    gradient = 0.25 * shear_modulus * ca.pi * a * b * c11 / limit * creepage
    return -2 / ca.pi * limit * (gradient / (1 + gradient**2) + ca.atan(gradient))

"""The default law of elastic patches: from Kalker's forces to friction against a sliding about a displaced pole."""

from __future__ import annotations

import math

from fmu_src.symbols import ca
from rbd_model.contact.creep.law import ContactPatch, Reduction
from rbd_model.contact.creep.shen_hedrick_elkins import saturated_share

#: Linear force of spin alone over mu N at which a patch saturates. The stress of spin is largest where the bound is
#: large, so that its force has no second-order loss.
OF_SPIN = 1.5
#: Mean of (x/a)^2 under Hertz's pressure. Half of the square of 8/(3 pi), the inverse of the slope by which the mean
#: unit vector of sliding about a pole grows with the pole's distance from the middle of a circle.
FAR, NEAR = 0.2, 32 / (9 * math.pi**2)
#: Fitted constants, with two digits: least squares over every second state of `exact_states` with a/b above 0.2. The
#: errors in docs/limits.md are those of the other states. GROWTH, LOSS: growth of the lag with spin. LAG_AT_MOST: lag
#: of large spin, over (a/b)^(1/2). LAG_FALLS: its fall with the linear force. SPIN_SATURATES: weight of spin in the
#: saturation. PARTS: squared distance of the pole at which FAR and NEAR have equal weights. TURNS, SPIN_TURNS: linear
#: force, and weight of spin in it, at which half of the force has the direction of the sliding.
GROWTH, LOSS, LAG_AT_MOST, LAG_FALLS = 5.0, 1.8, 2.8, 0.7
SPIN_SATURATES, PARTS, TURNS, SPIN_TURNS = 2.4, 0.13, 2.0, 25.0
#: Smallest creepage, and smallest force over mu N, that are distinguished from 0.
FLOOR = 1e-12


def kalker_to_coulomb(patch: ContactPatch) -> tuple[ca.SX, ca.SX]:
    """Return the creep forces (F_x, F_y) [N]: those of adhesion and of sliding in series, Kalker (1990), chapter 3.

    A patch with spin slides about a pole at (-xi_y, xi_x) / spin. Because the surfaces are elastic, stress follows the
    sliding with a lag, so that spin acts as an additional lateral creepage. Its linear force is that of Kalker; for
    large spin it is constant. With it, the force of adhesion saturates, without spin as in Vermeulen, Johnson (1964).
    The force of sliding is the mean of the unit vectors of sliding under Hertz's pressure. The inverse squares of both
    add up. The direction turns from that of Kalker's forces to that of sliding. Contamination reduces the adhesion by
    the ratio of Polach (2005). The forms are our own, see GROWTH.
    """
    x, y, spin = patch.creepages
    (a, b), kalker, limit = patch.semi_axes, patch.kalker, patch.friction * patch.load
    area = a * b
    stiffness = patch.shear_modulus * area / limit
    per_y = stiffness * kalker.c22
    ahead, aside, turning = stiffness * kalker.c11 * x, per_y * y, stiffness * ca.sqrt(area) * kalker.c23 * spin
    linear, square = ahead**2 + (aside + turning) ** 2, turning**2
    falls = 1 + square * (LOSS + GROWTH / LAG_AT_MOST**2 * (square * b / a + LAG_FALLS * linear))
    aside_with_lag = aside + turning * ca.sqrt((1 + GROWTH * square) / falls)
    size = ca.sqrt(ahead**2 + aside_with_lag**2 + FLOOR**2)
    of_creepage = ahead**2 + aside**2 + FLOOR**2
    share = of_creepage / (of_creepage + SPIN_SATURATES * square)
    spinning = ca.fmin(size / OF_SPIN, 1)
    spinning = spinning * (3 - spinning**2) / 2
    held = spinning + share * (size * saturated_share(size) - spinning)
    held = held * remaining(size, patch.reduction)

    slides_x, slides_y, mean = mean_sliding(x, aside_with_lag / per_y, spin, (a, b))
    both = limit * held / ca.sqrt(mean + held**2 * (1 - mean))
    ends = (stiffness * spin) ** 2 * ((kalker.c11 * b) ** 2 + (kalker.c22 * a) ** 2)
    turned = linear + SPIN_TURNS * ends
    turned = turned / (turned + TURNS**2)
    by_adhesion, by_sliding = both * (1 - turned) * ca.sqrt(mean) / size, both * turned
    along = by_adhesion * ahead + by_sliding * slides_x
    return -along, -(by_adhesion * aside_with_lag + by_sliding * slides_y)


def remaining(size: ca.SX, reduction: Reduction) -> ca.SX:
    """Return the share of the force that contamination leaves, Polach (2005): 1 on clean surfaces."""
    gradient = ca.pi / 4 * size
    adhesion = reduction.adhesion * gradient
    force = adhesion / (1 + adhesion**2) + ca.atan(reduction.slip * gradient)
    return force / (gradient / (1 + gradient**2) + ca.atan(gradient))


def mean_sliding(x: ca.SX, y: ca.SX, spin: ca.SX, axes: tuple[ca.SX, ca.SX]) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Return the mean unit vector of sliding under Hertz's pressure, and its squared size, Kalker (1990), chapter 3.

    It is right to second order for distant poles, and on a circle to first order for a pole in the middle.
    """
    (a, b), turns = axes, spin**2
    square = x**2 + y**2 + FLOOR**2
    distant = square / (square + PARTS * turns * (a**2 + b**2))
    far = FAR * distant * ((a * x) ** 2 + (b * y) ** 2) / square
    near = NEAR * (1 - distant)
    along, across = (square + turns * (far + near * (a * b + axis**2)) for axis in (b, a))
    mean_x, mean_y = x / ca.sqrt(along), y / ca.sqrt(across)
    return mean_x, mean_y, mean_x**2 + mean_y**2 + FLOOR**2 / square

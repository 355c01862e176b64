"""The default law of flanges: Kalker's forces for small creepages, friction against the sliding for large ones."""

import casadi as ca

from rbd_model.contact.creep.law import ContactPatch
from rbd_model.contact.creep.shen_hedrick_elkins import FORCE_FLOOR, saturated_share

#: Linear force of creepage over mu N at which half of the force has the direction of the sliding. It is the one at
#: which Johnson's and Vermeulen's law saturates.
SATURATES = 3.0
#: Mean of (x'/a)^2 under Hertz's pressure.
SPREAD = 0.2
#: Smallest creepage that is distinguished from 0.
CREEPAGE_FLOOR = 1e-12


def kalker_to_coulomb(patch: ContactPatch) -> tuple[ca.SX, ca.SX]:
    """Return the creep forces (F_x, F_y) [N]: the size of Shen, Hedrick and Elkins (1983), and a direction that turns.

    In their law the lateral force of spin turns the force of a patch that slides everywhere, although spin then has no
    mean: ahead and behind it has opposite signs. Here the direction turns from that of Kalker's linear forces to that
    of the mean sliding, with the square of the linear force of creepage. The mean of the unit vectors of sliding under
    Hertz's pressure is, to second order, xi / (xi^2 + spin^2 (a^2 x^2 + b^2 y^2) / (5 xi^2))^(1/2). The form of the
    transition is our own; none of its constants is fitted. Its authors limit Shen's law to small spin, which holds for
    this one while spin dominates.
    """
    x, y, spin = patch.creepages
    a, b = patch.semi_axes
    kalker, limit = patch.kalker, patch.friction * patch.load
    stiffness = patch.shear_modulus * a * b / limit
    ahead, aside = stiffness * kalker.c11 * x, stiffness * kalker.c22 * y
    with_spin = aside + stiffness * ca.sqrt(a * b) * kalker.c23 * spin
    size = ca.sqrt(ahead**2 + with_spin**2 + FORCE_FLOOR**2)
    share = limit * saturated_share(size)

    creepage = x**2 + y**2 + CREEPAGE_FLOOR**2
    mean = size * ca.sqrt(creepage / (creepage**2 + SPREAD * spin**2 * ((a * x) ** 2 + (b * y) ** 2)))
    linear = ahead**2 + aside**2
    slides = linear / (linear + SATURATES**2)
    along = ahead + slides * (mean * x - ahead)
    return -share * along, -share * (with_spin + slides * (mean * y - with_spin))

"""Friction of a wheel on a rail: its fall with sliding speed, and its change over the rail's profile.

mu = mu0 ((1 - A) exp(-B w) + A), with the sliding speed w [m/s], and the reduction factors k_A, k_S of Polach's creep
law: O. Polach (2005), Creep forces in simulations of traction vehicles running on adhesion limit, Wear 258, 992-1000.
With the start values nothing falls.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from fmu_src.symbols import ca
from fmu_src.system import ParameterSet, quantity
from rbd_model.contact.creep.law import Reduction


@dataclass(frozen=True)
class FallingFriction(ParameterSet):
    """Fall of the friction coefficient with sliding speed, and reduction of the creep law's slope by contamination."""

    friction_ratio: float = quantity(
        "1", "Friction at infinite over that at no sliding speed (A); 1: friction does not fall", 0.0, 1.0
    )
    friction_decay: float = quantity("s/m", "Decay of friction with sliding speed (B)", 0.0)
    adhesion_reduction: float = quantity("1", "Reduction of the creep law in the area of adhesion (k_A)", 1e-3, 1.0)
    slip_reduction: float = quantity("1", "Reduction of the creep law in the area of slip (k_S)", 1e-3, 1.0)


def constant_friction() -> FallingFriction:
    """Return friction as in the thesis, section 3.4: it does not fall, and surfaces are clean."""
    return FallingFriction(friction_ratio=1.0, friction_decay=0.0, adhesion_reduction=1.0, slip_reduction=1.0)


@dataclass(frozen=True)
class Surface:
    """The symbols of a rail's surface: A, B and 1 - A of its falling friction, and its reduction of the gradient."""

    ratio: ca.SX
    decay: ca.SX
    fall: ca.SX
    adhesion: ca.SX
    slip: ca.SX

    @property
    def symbols(self) -> ca.SX:
        """All of them, shape (5, 1)."""
        return ca.vertcat(self.ratio, self.decay, self.fall, self.adhesion, self.slip)

    @property
    def reduction(self) -> Reduction:
        """Reduction of the creep law's gradient by the surface."""
        return Reduction(self.adhesion, self.slip)

    def remaining(self, sliding_speed: ca.SX) -> ca.SX:
        """Return the remaining share of mu0 at a sliding speed w >= 0 [m/s]: (1 - A) exp(-B w) + A."""
        return self.fall * ca.exp(-self.decay * sliding_speed) + self.ratio


#: Sines of the contact angles at which the rail's head ends and at which its gauge face begins: 20 and 40 degrees, on
#: the gauge corner; assumed. Half of the change lies before 29 degrees.
HEAD_ENDS, GAUGE_FACE_BEGINS = math.sin(math.radians(20.0)), math.sin(math.radians(40.0))


def friction_over_angle(sine: ca.SX, of_gauge_face: ca.SX) -> ca.SX:
    """Return the factor on the friction at a contact angle: that of a gauge face beyond the gauge corner [1].

    sine: of the contact angle, positive on the gauge side. In practice, the top of rail is kept at 0.3 to 0.4 and the
    gauge face is lubricated as far as possible: J. Tuzik (2023), Railway Track and Structures, August; 0.15 to 0.2 is
    usual.
    """
    share = (sine - HEAD_ENDS) / (GAUGE_FACE_BEGINS - HEAD_ENDS)
    share = ca.fmin(ca.fmax(share, 0), 1)
    return 1 + (of_gauge_face - 1) * share**2 * (3 - 2 * share)

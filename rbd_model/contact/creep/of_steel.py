"""Creep laws for a Poisson's ratio other than that of all vehicles here."""

from dataclasses import dataclass, replace

import casadi as ca

from rbd_model.contact.creep.kalker import smooth_kalker_coefficients
from rbd_model.contact.creep.law import ContactPatch, CreepLaw
from rbd_model.contact.hertz import POISSON_RATIO

#: Poisson's ratio of steel, as in the Manchester contact benchmark and most programs.
STEEL = 0.28


@dataclass(frozen=True)
class OfSteel:
    """A creep law for a Poisson's ratio of its own, with the coefficients of Kalker (1990), table E.3, at that ratio.

    The ellipse shrinks with (1 - nu)^(1/3), eq. (3.84). Use it for laws that take Kalker's coefficients from the patch:
    Polach, Shen, Hedrick and Elkins, FASTSIM, FaStrip, linear. Levels 1 and 2, contact model 3 and `exact_law` keep the
    ratio of all vehicles, `POISSON_RATIO`; so does the stiffness of a contact at a given approach.
    """

    law: CreepLaw
    poisson_ratio: float = STEEL

    def __call__(self, patch: ContactPatch) -> tuple[ca.SX, ca.SX]:
        """Return the creep forces (F_x, F_y) [N] of a patch whose ellipse is that of `POISSON_RATIO`."""
        a, b = patch.semi_axes
        kalker = smooth_kalker_coefficients(ca.log(a / b), self.poisson_ratio)
        scale = ((1 - self.poisson_ratio) / (1 - POISSON_RATIO)) ** (1 / 3)
        return self.law(replace(patch, semi_axes=(scale * a, scale * b), kalker=kalker))

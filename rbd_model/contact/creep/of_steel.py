"""Creep laws for a Poisson's ratio other than the default."""

from __future__ import annotations

from dataclasses import dataclass, replace

from fmu_src.symbols import ca
from rbd_model.contact.creep.kalker import checked_ratio, smooth_kalker_coefficients
from rbd_model.contact.creep.law import ContactPatch, CreepLaw
from rbd_model.contact.hertz import POISSON_RATIO

#: Poisson's ratio of steel, as in the Manchester contact benchmark and most programs.
STEEL = 0.28


@dataclass(frozen=True)
class OfSteel:
    """A creep law for a Poisson's ratio of its own, with the coefficients of Kalker (1990), table E.3, at that ratio.

    The ellipse shrinks with (1 - nu)^(1/3), eq. (3.84). `Contact.poisson_ratio` wraps its laws in this class. All laws
    that take Kalker's coefficients from the patch follow the ratio. The table of exact theory does so for small
    creepages, because its saturation is stored for 0.25.

    Raises
    ------
    ValueError
        If the ratio is not from 0 to 0.5.
    """

    law: CreepLaw
    poisson_ratio: float = STEEL

    def __post_init__(self) -> None:
        checked_ratio(self.poisson_ratio)

    def __call__(self, patch: ContactPatch) -> tuple[ca.SX, ca.SX]:
        """Return the creep forces (F_x, F_y) [N] of a patch whose ellipse is that of its own `poisson_ratio`."""
        (a, b), nu = patch.semi_axes, self.poisson_ratio
        kalker = smooth_kalker_coefficients(ca.log(a / b), nu)
        scale = ((1 - nu) / (1 - patch.poisson_ratio)) ** (1 / 3)
        return self.law(replace(patch, semi_axes=(scale * a, scale * b), kalker=kalker, poisson_ratio=nu))


def law_of_ratio(law: CreepLaw, poisson_ratio: float) -> CreepLaw:
    """Return a law for a Poisson's ratio, Kalker (1990); at the default one the law itself."""
    return law if poisson_ratio == POISSON_RATIO else OfSteel(law, poisson_ratio)

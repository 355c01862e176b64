"""Shen, Hedrick and Elkins (1983): Kalker's linear forces, saturated together by a cubic."""

from __future__ import annotations

from fmu_src.symbols import ca
from rbd_model.contact.creep.kalker_linear import kalker_linear
from rbd_model.contact.creep.law import ContactPatch

#: Smallest force that is distinguished from 0, as a share of friction times load.
FORCE_FLOOR = 1e-12


def saturated_share(size: ca.SX) -> ca.SX:
    """Return saturated over linear force, for a linear force of `size` times mu N: 1 - s/3 + s^2/27 up to 3, then 1/s.

    Vermeulen and Johnson (1964): the cubic is 1 - (1 - s/3)^3 over s.
    """
    within = ca.fmin(size, 3)
    return (1 - within / 3 + within**2 / 27) * within / size


def shen_hedrick_elkins(patch: ContactPatch) -> tuple[ca.SX, ca.SX]:
    """Return the creep forces (F_x, F_y) [N] by Shen, Hedrick and Elkins (1983).

    Source: A comparison of alternative creep force models.

    They are Kalker's linear forces with spin, both times the same factor, so that their sum saturates as in Johnson's
    and Vermeulen's law. The authors limit it to small spin: the moment of spin does not take part in the saturation,
    and pure spin saturates at the whole of mu N, which no contact reaches.
    """
    x, y = kalker_linear(patch)
    limit = patch.friction * patch.load
    share = saturated_share(ca.sqrt((x / limit) ** 2 + (y / limit) ** 2 + FORCE_FLOOR**2))
    return share * x, share * y

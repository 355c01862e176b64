"""Friction of the rail: its fall with sliding speed, and its change along the track.

mu = mu0 ((1 - A) exp(-B w) + A), with the sliding speed w [m/s], and the reduction factors k_A, k_S of Polach's creep
law: O. Polach (2005), Creep forces in simulations of traction vehicles running on adhesion limit, Wear 258, 992-1000.
mu0 are the inputs friction_1, friction_2. With the start values nothing falls and nothing changes along the track.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from fmu_src.symbols import ca
from fmu_src.system import ParameterSet, System, quantity
from rbd_model.contact.friction import FallingFriction, Surface, constant_friction


@dataclass(frozen=True)
class FrictionAlongTrack(ParameterSet):
    """Friction along the track: a patch such as leaves, and a rail cleaned by the first wheelset.

    Distances are those of each wheelset from the middle of the bogie at the start, so that the leading one is first.
    A patch shorter than two blends does not reach its factor.
    """

    cleaned_friction: float = quantity(
        "1", "Factor on the friction under each wheelset, whose rail the one before it has cleaned", 0.0, 1e3
    )
    patch_friction: float = quantity("1", "Factor on friction within the patch; 1: there is none", 0.0, 1e3)
    patch_start: float = quantity("m", "Distance at which the patch begins")
    patch_length: float = quantity("m", "Length of the patch", 1e-3)
    patch_blend: float = quantity("m", "Length over which friction changes at each end of the patch, within it", 1e-3)


@dataclass(frozen=True)
class RailCondition:
    """A rail with a name: mu0 of all wheelsets, and the law of its fall, Polach (2005).

    source: of the numbers. verified: true if they were found in more than one source; otherwise check them before use.
    """

    friction: float
    law: FallingFriction
    verified: bool
    source: str = "of one's own"

    def values(self, wheelsets: int = 2) -> dict[str, float]:
        """Return inputs and parameters by name."""
        return {f"friction_{number}": self.friction for number in range(1, wheelsets + 1)} | self.law.values()


def even_rail() -> FrictionAlongTrack:
    """Return constant friction, as in section 4.4; the length of a patch of leaves and its blend are assumed."""
    return FrictionAlongTrack(
        cleaned_friction=1.0,
        patch_friction=1.0,
        patch_start=50.0,
        patch_length=50.0,
        patch_blend=1.0,
    )


def dry() -> RailCondition:
    """Polach (2005), Table 2, dry."""
    return RailCondition(0.55, FallingFriction(0.40, 0.60, 1.00, 0.40), True, "Polach (2005), Table 2, dry")


def wet() -> RailCondition:
    """Polach (2005), Table 2, wet."""
    return RailCondition(0.30, FallingFriction(0.40, 0.20, 0.30, 0.10), True, "Polach (2005), Table 2, wet")


def low() -> RailCondition:
    """Low adhesion on which protection is tried, by the law of Polach (2005). UNVERIFIED: check before use."""
    return _slippery(0.08, 0.20, "friction assumed, fall as that of slippery")


def slippery() -> RailCondition:
    """Low adhesion by the law of Polach (2005). UNVERIFIED: numbers from secondary literature; check before use."""
    return _slippery(0.06, 0.20, "secondary literature on the law of Polach (2005), low adhesion")


def extremely_low() -> RailCondition:
    """Between `slippery` and `very_low`, by the law of Polach (2005). UNVERIFIED: assumed."""
    return _slippery(0.045, 0.10, "friction assumed, fall as that of very_low")


def very_low() -> RailCondition:
    """Very low adhesion, same law, Polach (2005). UNVERIFIED: numbers from secondary literature; check before use."""
    return _slippery(0.03, 0.10, "secondary literature on the law of Polach (2005), very low adhesion")


def _slippery(friction: float, decay: float, source: str) -> RailCondition:
    """Return a rail with the creep curve of a dry rail, k_A and k_S of Polach (2005)."""
    return RailCondition(friction, FallingFriction(0.40, decay, 1.00, 0.40), False, source)


#: The rails that have a name, for all uses. A rail with another friction or another fall must not use such a name.
CONDITIONS = {
    "dry": dry,
    "wet": wet,
    "low": low,
    "slippery": slippery,
    "extremely_low": extremely_low,
    "very_low": very_low,
}


@dataclass(frozen=True)
class Rail:
    """The symbols of the rail's friction while a System is written; all except the parameters are computed once."""

    parameter: dict[str, ca.SX]
    surface: Surface
    patch_change: ca.SX
    patch_middle: ca.SX
    per_blend: ca.SX

    def factor(self, number: int, distance: ca.SX) -> ca.SX:
        """Return the factor on mu0 at a wheelset's distance [m]: that of the patch within it, and of the cleaned
        rail.
        """
        inside = self.parameter["patch_length"] / 2 - ca.fabs(distance - self.patch_middle)
        share = inside * self.per_blend
        # From 0 to 1 and no further, in absolute values: they cost less than minimum and maximum.
        share = (1 + ca.fabs(share) - ca.fabs(share - 1)) / 2
        factor = 1 + self.patch_change * share**2 * (3 - 2 * share)
        for _ in range(1, number):
            factor = factor * self.parameter["cleaned_friction"]
        return factor


def add_rail(system: System, wheelsets: int) -> Rail:
    """Return the rail below this number of wheelsets: falling friction, Polach (2005), and its change along it, 2.5.2.

    Each wheelset cleans the rail for the next one. A single wheelset runs on a rail that is not cleaned.
    """
    variables = [law.variable(name) for law in (constant_friction(), even_rail()) for name in law.values()]
    p = {v.name: system.parameter(v) for v in variables if v.name != "cleaned_friction" or wheelsets > 1}
    fall = system.derived("friction_fall", 1 - p["friction_ratio"])
    law = p["friction_ratio"], p["friction_decay"], fall, p["adhesion_reduction"], p["slip_reduction"]
    return Rail(
        p,
        Surface(*law),
        system.derived("patch_change", p["patch_friction"] - 1),
        system.derived("patch_middle", p["patch_start"] + p["patch_length"] / 2),
        system.derived("per_patch_blend", 1 / p["patch_blend"]),
    )


def follow_patch(system: System, rail: Rail, distance: ca.SX, places: Sequence[ca.SX]) -> None:
    """Limit steps so that none passes an end of the patch of section 2.5.2, or more than half of the patch.

    distance: the state that carries all places along; places [m]: of the wheelsets.
    """
    p = rail.parameter
    end = ca.fmin(p["patch_blend"], p["patch_length"] / 2)
    # Distances from each wheelset to the nearer end of the patch; below 0 within it.
    ways = [ca.fabs(ca.fabs(place - rail.patch_middle) - (p["patch_length"] - end) / 2) - end / 2 for place in places]
    largest = end / 2 + ca.fmax(ca.mmin(ca.vertcat(*ways)), 0)
    system.limit_change(ca.if_else(p["patch_friction"] == 1, ca.inf, largest), distance)

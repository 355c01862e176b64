"""Net braking ratio of North American freight cars: force of all shoes over the weight, in full service.

AAR S-401 limits it for new cars: 8.5, later 11, to 14 % loaded, and 15 to 38 % empty. The standard was not read; a
secondary source has these numbers, from US patent 5927822 and Railinc's UMLER release notes of 2017. AAR states the
ratio for a full service from 90 psi (64 psi in the cylinder). Here it is that of a full service from the pipe's 5 bar.
"""

from __future__ import annotations

#: Ratio of a loaded and of an empty car that states no force [%]: those of ALTRIOS' car (NREL), within the limits.
LOADED, EMPTY = 11.0, 25.0
#: Least and largest ratio of a loaded and of an empty car [%] (AAR S-401).
LOADED_LIMITS, EMPTY_LIMITS = (8.5, 14.0), (15.0, 38.0)
#: Shoes of a car, one for each of eight wheels (AAR S-400). Their friction is that of the composite blocks of a wagon,
#: assumed.
SHOES = 8


def shoe_force(percentage: float, weight: float) -> float:
    """Return the force of all shoes [N] of a net braking ratio [%] and a weight [N] (AAR S-401)."""
    return percentage / 100.0 * weight

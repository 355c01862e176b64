"""Net braking ratio of North American freight cars: force of all shoes over the weight, in full service.

AAR S-401 limits it for new cars, as secondary sources have it (US patent 5927822; Railinc, UMLER release notes of 2017;
the standard itself was not read): 8.5, later 11, to 14 % loaded, and 15 to 38 % empty. AAR states it for a full service
from 90 psi (64 psi in the cylinder). Here it is that of a full service from the 5 bar of the pipe.
"""

from __future__ import annotations

#: Ratio of a loaded and of an empty car that states no force [%]: those of ALTRIOS' car (NREL), within the limits.
LOADED, EMPTY = 11.0, 25.0
#: Shoes of a car, one for each of eight wheels (AAR S-400). Their friction is that of the composite blocks of a wagon,
#: assumed.
SHOES = 8


def shoe_force(percentage: float, weight: float) -> float:
    """Return the force of all shoes [N] of a net braking ratio [%] and a weight [N] (AAR S-401)."""
    return percentage / 100.0 * weight

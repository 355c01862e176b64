"""Distributors by the names that consists use, one file each: add a file with a `Distributor`, and a line here."""

from collections.abc import Iterable, Mapping
from functools import lru_cache

from brake_controller.distributors.aar import AAR
from brake_controller.distributors.distributor import Distributor
from brake_controller.distributors.ecp import ECP
from brake_controller.distributors.ep_direct import EP_DIRECT
from brake_controller.distributors.ep_uic import EP_UIC
from brake_controller.distributors.piped import PIPED
from brake_controller.distributors.registered import check_kinds
from brake_controller.distributors.twin_pipe import TWIN_PIPE
from brake_controller.distributors.uic import UIC
from brake_controller.distributors.vacuum import VACUUM_BRAKE

#: All distributors in the C code of trains; a test may add to them.
DISTRIBUTORS: dict[str, Distributor] = {
    UIC.name: UIC,
    AAR.name: AAR,
    ECP.name: ECP,
    EP_UIC.name: EP_UIC,
    TWIN_PIPE.name: TWIN_PIPE,
    EP_DIRECT.name: EP_DIRECT,
    PIPED.name: PIPED,
    VACUUM_BRAKE.name: VACUUM_BRAKE,
}
#: Those whose C a release compiles.
BUILT_IN = tuple(DISTRIBUTORS.values())
#: Kinds of brakes in consists, with the name of a distributor; a pneumatic one has any other.
BRAKES = {"pneumatic": "", "ep-direct": EP_DIRECT.name, "none": PIPED.name}


def pneumatic() -> tuple[str, ...]:
    """Return the names of the distributors that the brake pipe controls."""
    return tuple(name for name in DISTRIBUTORS if name not in BRAKES.values())


def keeps_pipe(kinds: Iterable[Distributor]) -> bool:
    """Return whether service is by wire alone, and the pipe stays charged: it feeds some vehicles and controls none."""
    own = {kind.name: kind.wired for kind in kinds}
    fed = any(wired and name in pneumatic() for name, wired in own.items())
    return fed and all(wired or name == PIPED.name for name, wired in own.items())


def distributors() -> Mapping[str, Distributor]:
    """Return DISTRIBUTORS, checked. Raises ValueError for a kind that cannot be used, or two that are alike."""
    _by_parameters(tuple(DISTRIBUTORS.items()))
    return DISTRIBUTORS


@lru_cache
def _by_parameters(kinds: tuple[tuple[str, Distributor], ...]) -> dict[type, Distributor]:
    check_kinds(kinds)
    return {kind.parameters: kind for _, kind in kinds}


def kind_of(parameters: object) -> Distributor:
    """Return the kind of a vehicle's distributor by its parameters.

    Raises ValueError for parameters of no kind, or if DISTRIBUTORS cannot be used.
    """
    found = _by_parameters(tuple(DISTRIBUTORS.items())).get(type(parameters))
    if found is not None:
        return found
    raise ValueError(
        f"The distributor of a vehicle must be parameters of {', '.join(DISTRIBUTORS)}; got {parameters!r}. Take one "
        "of these, or add its kind to DISTRIBUTORS."
    )

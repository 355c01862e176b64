"""Distributors by the names that consists use, one file each: add a file with a `Distributor`, and a line here."""

from brake_controller.distributors.distributor import Distributor
from brake_controller.distributors.uic import UIC

#: All distributors in the C code of trains; a test may add to them.
DISTRIBUTORS: dict[str, Distributor] = {
    UIC.name: UIC,
}


def kind_of(parameters: object) -> Distributor:
    """Return the kind of a vehicle's distributor by its parameters. Raises ValueError for parameters of no kind."""
    for one in DISTRIBUTORS.values():
        if type(parameters) is one.parameters:
            return one
    raise ValueError(
        f"The distributor of a vehicle must be parameters of {', '.join(DISTRIBUTORS)}; got {parameters!r}. Take one "
        "of these, or add its kind to DISTRIBUTORS."
    )

"""How deep contact is modelled: a choice of its own beside the level of detail."""

from __future__ import annotations

from dataclasses import dataclass

from rbd_model.contact.creep.law import CreepLaw
from rbd_model.contact.creep.polach import polach

#: Depths by their number: what the parameter contact_depth chooses.
DEPTHS = {
    1: "one rigid contact a wheel, the flange a spring as printed (3.106)",
    2: "tread and flange as two elastic patches at their places",
}


@dataclass(frozen=True)
class Contact:
    """How wheels touch rails: `depth`, a key of DEPTHS, and the creep law. Raises ValueError for another depth."""

    depth: int = 1
    creep_law: CreepLaw = polach

    def __post_init__(self) -> None:
        if self.depth not in DEPTHS:
            known = "; ".join(f"{number}: {text}" for number, text in DEPTHS.items())
            raise ValueError(f"There is no contact depth {self.depth}; give one of {known}.")


#: That of the thesis.
ONE_RIGID_CONTACT = Contact()

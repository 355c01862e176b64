"""The choice of the contact model, independent of the level of detail."""

from dataclasses import dataclass

from rbd_model.contact.creep.kalker import checked_ratio
from rbd_model.contact.creep.kalker_to_coulomb import kalker_to_coulomb
from rbd_model.contact.creep.law import CreepLaw
from rbd_model.contact.creep.of_steel import law_of_ratio
from rbd_model.contact.creep.polach import polach
from rbd_model.contact.hertz import POISSON_RATIO

#: Contact models by their number, the value of the parameter contact_model.
DEPTHS = {
    1: "one rigid contact a wheel, the flange a spring as printed (3.106)",
    2: "tread and flange as two elastic patches at their places",
    3: "as many patches of any shape as the profiles have, by strips",
}
#: Creep laws that a contact model does not use.
UNUSED: dict[int, tuple[str, ...]] = {1: ("flange_law",), 2: (), 3: ("creep_law", "flange_law")}


@dataclass(frozen=True)
class Contact:
    """The contact of wheels and rails: `depth`, a key of DEPTHS, the creep laws, and Poisson's ratio of the steel.

    The `flange_law` is that of the patches of a flange at model 2; model 1 has no such patches. A flange spins while it
    slides everywhere. In Polach's law spin then reduces the lateral force. In that of Shen, Hedrick and Elkins it turns
    the force. With `kalker_to_coulomb` the force opposes the mean sliding. contact-manchester computes the distance of
    each law from exact theory: docs/limits.md, Creep laws. The default of treads is the law of the thesis. At model 3
    neither law is used: each strip creeps by FASTSIM with flexibilities of its own.

    Raises
    ------
    ValueError
        If `depth` is not a key of DEPTHS, a law is given that the contact model does not use, or Poisson's ratio is not
        from 0 to 0.5.
    """

    depth: int = 1
    creep_law: CreepLaw = polach
    flange_law: CreepLaw = kalker_to_coulomb
    poisson_ratio: float = POISSON_RATIO

    def __post_init__(self) -> None:
        if self.depth not in DEPTHS:
            known = "; ".join(f"{number}: {text}" for number, text in DEPTHS.items())
            raise ValueError(f"There is no contact model {self.depth}; give one of {known}.")
        for name in UNUSED[self.depth]:
            if getattr(self, name) is not getattr(Contact, name):  # the law by default
                raise ValueError(f"Contact model {self.depth} does not use a {name}; leave it out, or take model 2.")
        checked_ratio(self.poisson_ratio)

    def law_of(self, flange: bool) -> CreepLaw:
        """Return the creep law of a patch of a flange or, otherwise, of a tread."""
        return law_of_ratio(self.flange_law if flange else self.creep_law, self.poisson_ratio)


#: The contact of the thesis.
ONE_RIGID_CONTACT = Contact()

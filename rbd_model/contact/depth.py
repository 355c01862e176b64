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
#: The creep law of a contact model by default: that of the thesis, and one that is right with spin.
DEFAULT_LAWS: dict[int, CreepLaw] = {1: polach, 2: kalker_to_coulomb}
#: Creep laws that a contact model does not use.
UNUSED: dict[int, tuple[str, ...]] = {1: ("flange_law",), 2: (), 3: ("creep_law", "flange_law")}


@dataclass(frozen=True)
class Contact:
    """The contact of wheels and rails: `depth`, a key of DEPTHS, the creep laws, and Poisson's ratio of the steel.

    The `creep_law` is that of treads, the `flange_law` that of the patches of a flange at model 2; model 1 has no such
    patches. None: that of DEFAULT_LAWS. At model 3 neither law is used: each strip creeps by FASTSIM with flexibilities
    of its own. Spin reduces the lateral force in Polach's law and turns it in that of Shen, Hedrick and Elkins; with
    `kalker_to_coulomb` the force is near that of exact theory (docs/limits.md, Creep laws).

    Raises
    ------
    ValueError
        If `depth` is not a key of DEPTHS, a law is given that the contact model does not use, or Poisson's ratio is not
        from 0 to 0.5.
    """

    depth: int = 1
    creep_law: CreepLaw | None = None
    flange_law: CreepLaw | None = None
    poisson_ratio: float = POISSON_RATIO

    def __post_init__(self) -> None:
        if self.depth not in DEPTHS:
            known = "; ".join(f"{number}: {text}" for number, text in DEPTHS.items())
            raise ValueError(f"There is no contact model {self.depth}; give one of {known}.")
        for name in UNUSED[self.depth]:
            if getattr(self, name) is not None:
                raise ValueError(f"Contact model {self.depth} does not use a {name}; leave it out, or take model 2.")
        checked_ratio(self.poisson_ratio)

    def law_of(self, flange: bool) -> CreepLaw:
        """Return the creep law of a patch of a flange or, otherwise, of a tread."""
        own = self.flange_law if flange else self.creep_law
        return law_of_ratio(own or DEFAULT_LAWS[self.depth], self.poisson_ratio)


#: The contact of the thesis.
ONE_RIGID_CONTACT = Contact()

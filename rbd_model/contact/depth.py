"""How deep contact is modelled: a choice of its own beside the level of detail."""

from dataclasses import dataclass

from rbd_model.contact.creep.law import CreepLaw
from rbd_model.contact.creep.polach import polach
from rbd_model.contact.creep.shen_hedrick_elkins import shen_hedrick_elkins

#: Depths by their number: what the parameter contact_model chooses.
DEPTHS = {
    1: "one rigid contact a wheel, the flange a spring as printed (3.106)",
    2: "tread and flange as two elastic patches at their places",
    3: "as many patches of any shape as the profiles have, by strips",
}
#: Laws that a depth does not use.
UNUSED: dict[int, tuple[str, ...]] = {1: ("flange_law",), 2: (), 3: ("creep_law", "flange_law")}


@dataclass(frozen=True)
class Contact:
    """How wheels touch rails: `depth`, a key of DEPTHS, and the creep laws.

    Raises ValueError for another depth, and for a law that the depth would not use.

    flange_law: of the patches of a flange at model 2; model 1 has none. A flange spins, which takes lateral force from
    Polach's law: the Y/Q at which a wheel climbs comes out 12 % above Nadal's limit, on the unsafe side, with Shen,
    Hedrick and Elkins under 2 % (scenario flange-climb). How far each is from exact theory on the Manchester contact
    benchmark is measured by contact-manchester: docs/limits.md, Creep laws. FASTSIM, 5 x 5, is nearest at ten times the
    cost. On a tread, which spins without sliding much, Shen, Hedrick and Elkins are no better than Polach (creep-laws).
    Neither is used at model 3, where every strip creeps by FASTSIM with flexibilities of its own.
    """

    depth: int = 1
    creep_law: CreepLaw = polach
    flange_law: CreepLaw = shen_hedrick_elkins

    def __post_init__(self) -> None:
        if self.depth not in DEPTHS:
            known = "; ".join(f"{number}: {text}" for number, text in DEPTHS.items())
            raise ValueError(f"There is no contact model {self.depth}; give one of {known}.")
        for name in UNUSED[self.depth]:
            if getattr(self, name) is not getattr(Contact, name):  # the law by default
                raise ValueError(f"Contact model {self.depth} does not use a {name}; leave it out, or take model 2.")

    def law_of(self, flange: bool) -> CreepLaw:
        """The creep law of a patch of a flange or, otherwise, of a tread."""
        return self.flange_law if flange else self.creep_law


#: That of the thesis.
ONE_RIGID_CONTACT = Contact()

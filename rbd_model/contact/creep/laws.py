"""The creep laws by name: the choices of `Vehicle.creep_law`.

A new law is a file of this folder, a function from a `ContactPatch` to (F_x, F_y) as defined in `law.py`, and one line
in LAWS. A law in your own script needs this line alone, before the vehicle is made: LAWS["mine"] = mine.
"""

from rbd_model.contact.creep.exact_table import exact_law
from rbd_model.contact.creep.fastrip import fastrip
from rbd_model.contact.creep.fastsim import fastsim
from rbd_model.contact.creep.johnson_vermeulen import johnson_vermeulen
from rbd_model.contact.creep.kalker_linear import kalker_linear
from rbd_model.contact.creep.kalker_to_coulomb import kalker_to_coulomb
from rbd_model.contact.creep.law import CreepLaw
from rbd_model.contact.creep.polach import polach
from rbd_model.contact.creep.polach_2005 import polach_2005
from rbd_model.contact.creep.shen_hedrick_elkins import shen_hedrick_elkins
from rbd_model.contact.creep.strip_theory import strip_theory

#: The name for the law of a contact model, see `Contact`; at levels 1 and 2 that of the thesis.
DEFAULT_LAW = "default"
#: Error and cost of each: scenario `creep-laws`. FASTSIM, FaStrip and strips have the grid with an error below 5 % of
#: mu N at its published rows; at random states it is 10 to 20 % (docs/limits.md, Creep laws).
LAWS: dict[str, CreepLaw] = {
    "polach": polach,
    "polach-2005": polach_2005,
    "shen-hedrick-elkins": shen_hedrick_elkins,
    "kalker-to-coulomb": kalker_to_coulomb,
    "johnson-vermeulen": johnson_vermeulen,
    "kalker-linear": kalker_linear,
    "fastsim": fastsim(14),
    "fastrip": fastrip(12),
    "strip-theory": strip_theory(8),
    "exact-table": exact_law,
}

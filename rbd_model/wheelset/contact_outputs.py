"""Outputs of the contacts of each wheel: creepages, creep forces, place, angle, area and wear number.

They are equations beside those of the motion, for a vehicle with `contact_outputs`. Each of them is a sum over the
patches of a tread or a flange. Creepages, places and angles are means weighted with the normal force: with one patch
that bears, they are its own.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

from fmu_src.chain import Bundle, Chain, Each, Part, rows
from fmu_src.symbols import ca
from rbd_model.contact.creep.law import SMALLEST_LOAD, at_least
from rbd_model.contact.creep_of_wheel import creep_of_wheel
from rbd_model.contact.depth import Contact
from rbd_model.contact.hertz import moving_ellipse
from rbd_model.vehicle.assembly import Assembly
from rbd_model.vehicle.variables import OF_CONTACT
from rbd_model.wheelset.pressing_patch import (
    TurningTrack,
    creep_on_patch,
    find_patch,
    law_name,
)
from rbd_model.wheelset.touch import Wheel
from rbd_model.wheelset.touching_patch import touching_patch
from rbd_model.wheelset.wheel_on_record import (
    FLANGES,
    TREADS,
    Feeling,
    asked_of_record,
    given_of,
    symbols_of_feeling,
)

#: Places of the patches of a wheel, and whether they belong to its flange.
PLACES = {"tread": False, "flange": True}


@dataclass(frozen=True)
class ContactSums(Bundle):
    """Sums over patches: forces [N], area [m2], wear number [N], and the normal force times each weighted quantity."""

    normal_force: ca.SX = rows(1)
    creep_force_along: ca.SX = rows(1)
    creep_force_aside: ca.SX = rows(1)
    contact_area: ca.SX = rows(1)
    wear_number: ca.SX = rows(1)
    creepage_along: ca.SX = rows(1)
    creepage_aside: ca.SX = rows(1)
    creepage_spin: ca.SX = rows(1)
    contact_position: ca.SX = rows(1)
    rail_position: ca.SX = rows(1)
    contact_angle: ca.SX = rows(1)

    def outputs(self) -> Mapping[str, ca.SX]:
        """Return all quantities of OF_CONTACT by name; the weighted ones are 0 without contact."""
        load = at_least(self.normal_force, SMALLEST_LOAD)
        return {
            one.name: getattr(self, one.name) / load if one.weighted else getattr(self, one.name) for one in OF_CONTACT
        }


@lru_cache
def contact_of_patch(flange: bool, contact: Contact, on_line: bool) -> Part:
    """Return the part for the `ContactSums` of the patch in a record, (3.82)-(3.105); arguments of `pressing_patch`.

    Wear number: T-gamma, creep forces times creepages (Pearce and Sherratt 1991, Wear 144, 343-351), without spin: the
    creep laws here have no moment of spin. Times the speed it is the power that the creep dissipates.
    """
    place = "flange" if flange else "tread"
    (feeling, record), chain = symbols_of_feeling(on_line), Chain()
    state, fixed, track = feeling.state, feeling.fixed, feeling.track or TurningTrack.straight()
    patch = find_patch(chain, state, fixed, touching_patch(flange), contact.poisson_ratio, record)
    creeping = creep_of_wheel(contact.law_of(flange), place)
    creep = creep_on_patch(chain, state, track, fixed, patch, creeping)
    load, wheel = creep.normal, Wheel(*ca.vertsplit(fixed.wheel))
    along, aside, spin, slowness = ca.vertsplit(creep.slides)
    creepages = along * slowness, aside * slowness, spin * slowness
    curvatures = patch.curvature_along, patch.curvature_across
    _, axis = moving_ellipse(*curvatures, at_least(load, SMALLEST_LOAD), fixed.shear_modulus, contact.poisson_ratio)
    on_rail = wheel.side * (state.offset + (creep.axes @ patch.arm)[1]) - wheel.rail_half_distance
    angle = ca.atan2(-wheel.side * patch.across[0], patch.across[1])
    weighted = [load * value for value in (*creepages, patch.position, on_rail, angle)]
    wear = -creep.creep_along * creepages[0] - creep.creep_aside * creepages[1]
    sums = ContactSums(load, creep.creep_along, creep.creep_aside, ca.pi * axis**2, wear, *weighted)
    name = f"contact_{place}_{law_name(contact.law_of(flange))}{'_on_line' if on_line else ''}"
    return Part(name, *given_of(feeling, record), sums.vector, chain)


@lru_cache
def contacts_of_wheel(contact: Contact, on_line: bool) -> Part:
    """Return the part for the `ContactSums` of tread and flange of a wheel; arguments of `wheel_on_record`."""
    (feeling, record), chain = symbols_of_feeling(on_line), Chain()
    whole, sums = given_of(feeling, record), []
    for flange in PLACES.values():
        each = Each(FLANGES if flange else TREADS, asked_of_record(flange, on_line), always=not flange)
        sums.append(chain.call(contact_of_patch(flange, contact, on_line), *whole, each=each))
    words = [law_name(contact.law_of(flange)) for flange in PLACES.values()]
    name = f"contacts_{words[0]}_{words[1]}{'_on_line' if on_line else ''}"
    return Part(name, *whole, ca.vertcat(*sums), chain)


def add_contact_outputs(assembly: Assembly, wheel: str, feeling: Feeling, record: ca.SX) -> None:
    """Add the outputs of the contacts of a wheel, such as 1_left, with the record of its side (3.82)-(3.105)."""
    part, wear = contacts_of_wheel(assembly.contact, assembly.on_line), ca.SX(0)
    found = assembly.system.call(part, *given_of(feeling, record))
    for place, own in zip(PLACES, ca.vertsplit(found, found.numel() // len(PLACES)), strict=True):
        sums = ContactSums.of(own)
        for name, value in sums.outputs().items():
            assembly.system.output(assembly.outputs[f"{name}_{place}_{wheel}"], value)
        wear += sums.wear_number
    assembly.system.output(assembly.outputs[f"wear_number_{wheel}"], wear)

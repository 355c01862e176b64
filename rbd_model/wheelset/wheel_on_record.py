"""A wheel on the patches of a contact table, as one part for any pair: the record of its side is data of an instance.

Each patch of the table is a call of the part of a tread or of a flange. Patches that a pair lacks, and patches that
cannot touch, cost nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

from fmu_src.chain import Chain, Each, Part
from fmu_src.symbols import ca
from rbd_model.contact.depth import Contact
from rbd_model.contact.pair_table import SIDE
from rbd_model.wheelset.pressing_patch import (
    PatchConstants,
    PatchState,
    TurningTrack,
    law_name,
    pressing_patch,
)
from rbd_model.wheelset.touch import Placement, Wheel
from rbd_model.wheelset.touching_patch import InRecord, Nearest, Stands, find_nearest, near_rail

#: Places of the lists of a `pair_table.SIDE`.
TREADS, FLANGES = (
    next(place for place, one in enumerate(SIDE.lists) if one.name == name) for name in ("treads", "flanges")
)
#: Largest distance from the rail at which a patch is evaluated [m]; roll and yaw above which it is in any case [rad].
MAY_TOUCH, ROLLED, YAWED = 0.6e-3, 2e-3, 15e-3


@dataclass(frozen=True)
class Feeling:
    """Arguments of a wheel on its rail, and its inputs that are not differentiated."""

    state: PatchState
    fixed: PatchConstants
    track: TurningTrack | None  # None: straight

    @property
    def given(self) -> tuple[ca.SX, ca.SX]:
        """Arguments and constants of `pressing_patch`, except for the record."""
        track = [] if self.track is None else [self.track.vector]
        return ca.vertcat(self.state.vector, *track), self.fixed.vector


def symbols_of_feeling(on_line: bool) -> tuple[Feeling, ca.SX]:
    """Return a wheel on its rail in symbols of a part, and the symbol of a record of a contact table, (3.77)."""
    state, fixed = PatchState.symbols("state"), PatchConstants.symbols("constants")
    return Feeling(state, fixed, TurningTrack.symbols("track") if on_line else None), ca.SX.sym("record")


def nearest_of(chain: Chain, feeling: Feeling, record: ca.SX, flange: bool) -> Nearest:
    """Return the point of the patch in a record that is nearest to the rail, (3.77), (3.78)."""
    state, wheel = feeling.state, Wheel(*ca.vertsplit(feeling.fixed.wheel))
    placement = Placement(state.yaw, state.roll, feeling.fixed.cosines, state.offset)
    return near_rail(chain, InRecord(record), flange, Stands.of(placement, wheel, state.height))


@lru_cache
def asked_of_record(flange: bool, on_line: bool) -> Part:
    """Return the part whose result is above 0 if the patch in a record may touch, (3.78); as `pressing_patch`.

    Up to ROLLED and YAWED, roll, yaw and the slope of the rail change the gap by less than MAY_TOUCH.
    """
    (feeling, record), chain = symbols_of_feeling(on_line), Chain()
    near = nearest_of(chain, feeling, record, flange)
    yaw, roll = ca.fabs(feeling.fixed.cosines[1]), ca.fabs(feeling.fixed.cosines[3])
    asked = ca.fmax(MAY_TOUCH + near.approach, ca.fmax(roll - ROLLED, yaw - YAWED))
    name = f"asked_of_{'flange' if flange else 'tread'}{'_on_line' if on_line else ''}"
    return Part(name, *given_of(feeling, record), asked, chain)


def given_of(feeling: Feeling, record: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Return arguments and constants of these parts, (3.77)."""
    given, constants = feeling.given
    return given, ca.vertcat(constants, record)


@lru_cache
def wheel_on_record(contact: Contact, on_line: bool) -> Part:
    """Return the part for a `WheelPress`, (3.77)-(3.105), from `Feeling.given` and the record of the wheel's side."""
    (feeling, record), chain = symbols_of_feeling(on_line), Chain()
    given, constants = given_of(feeling, record)

    def press(flange: bool) -> ca.SX:
        each = Each(FLANGES if flange else TREADS, asked_of_record(flange, on_line), always=not flange)
        return chain.call(pressing_patch(flange, contact, on_line), given, constants, each=each)

    pressed = press(False) + press(True)
    words = [law_name(contact.law_of(flange)) for flange in (False, True)]
    name = f"wheel_{words[0]}_{words[1]}{'_on_line' if on_line else ''}"
    return Part(name, given, constants, pressed, chain)


@lru_cache
def watched_patch(flange: bool) -> Part:
    """Return the part for approaches of the patch in a record [m] (section 9.4.1), for `watched_wheel`.

    Arguments: lateral position, height, yaw and roll; constants: direction cosines, the wheel, and the record. Results:
    the approach of a patch that is nearest beside the steepest part of the flange; that of one that is nearest on it;
    the position on the wheel with the opposite sign. The approaches are -1 where they are those of another place.
    """
    given, constants = ca.SX.sym("given", 4), ca.SX.sym("constants", 9)
    chain = Chain()
    placement = Placement(given[2], given[3], constants[:4], given[0])
    patch, stands = InRecord(constants[8]), Stands.of(placement, Wheel(*ca.vertsplit(constants[4:8])), given[1])
    near = find_nearest(chain, patch, stands)
    steep = near.position < patch.number(chain, "steep_begins")
    results = ca.if_else(steep, -1, near.approach), ca.if_else(steep, near.approach, -1), -near.position
    return Part(f"watched_{'flange' if flange else 'tread'}", given, constants, ca.vertcat(*results), chain)


#: Gap of a tread [m] beyond which it does not bear soon, and how much room a larger gap adds [m/m].
BEARS_SOON, ROOM_OF_GAP = 0.3e-3, 100.0


def room_on(
    near: Nearest, flange: ca.SX, wheel_end: ca.SX | float, rail_ends: tuple[ca.SX | float, ca.SX | float]
) -> ca.SX:
    """Return the distance of a patch of a tread from the field side of its wheel and from both ends of its rail [m].

    Section 9.4.1. A patch that does not bear soon has more: its nearest point may be at an end of the rail. A contact
    on the flange lies at the rail's gauge face, where the profile may end. flange [m]: place where it begins.
    """
    room = ca.fmin(wheel_end - near.position, rail_ends[1] - near.on_rail)
    room = ca.if_else(near.position > flange, ca.fmin(room, near.on_rail - rail_ends[0]), room)
    return room + ROOM_OF_GAP * ca.fmax(-near.approach - BEARS_SOON, 0)


@lru_cache
def room_of_patch() -> Part:
    """Return the part for the negative `room_on` of the tread's patch in a record (section 9.4.1).

    Arguments as for `watched_patch`; constants: direction cosines, the wheel, end of the wheel, both ends of the rail
    [m], and the record.
    """
    given, constants, chain = ca.SX.sym("given", 4), ca.SX.sym("constants", 12), Chain()
    placement = Placement(given[2], given[3], constants[:4], given[0])
    stands = Stands.of(placement, Wheel(*ca.vertsplit(constants[4:8])), given[1])
    patch = InRecord(constants[11])
    near, flange = find_nearest(chain, patch, stands), patch.number(chain, "flange_begins")
    return Part(
        "room_of_patch", given, constants, -room_on(near, flange, constants[8], (constants[9], constants[10])), chain
    )


@lru_cache
def room_of_tread() -> Part:
    """Return the part for the negative of the least room of all patches of a tread (section 9.4.1).

    The record is that of its side.
    """
    given, constants, chain = ca.SX.sym("given", 4), ca.SX.sym("constants", 12), Chain()
    found = chain.call(room_of_patch(), given, constants, each=Each(TREADS, largest=True))
    return Part("room_of_tread", given, constants, found, chain)


@lru_cache
def watched_wheel() -> Part:
    """Return the part for the largest of each result of `watched_patch` on a wheel (section 9.4.1).

    The record is that of its side.
    """
    given, constants, chain = ca.SX.sym("given", 4), ca.SX.sym("constants", 9), Chain()
    found = [
        chain.call(watched_patch(flange), given, constants, each=Each(place, largest=True))
        for place, flange in {TREADS: False, FLANGES: True}.items()
    ]
    return Part("watched_wheel", given, constants, ca.fmax(*found), chain)

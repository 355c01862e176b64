"""A wheel on the patches of a contact table, as one part for any pair: the record of its side is data of an instance.

Each patch of the table is a call of the part of a tread or of a flange. Patches that a pair lacks, and patches that
cannot touch, cost nothing.
"""

from __future__ import annotations

import hashlib
from dataclasses import replace
from functools import lru_cache

import casadi as ca

from fmu_src.chain import Chain, Each, Part
from fmu_src.piecewise import look_up_in, numbers_in, polynomials
from rbd_model.contact.creep.law import CreepLaw
from rbd_model.contact.creep.of_steel import OfSteel
from rbd_model.contact.depth import Contact
from rbd_model.contact.pair_table import PATCH, SIDE
from rbd_model.wheelset.pressing_patch import PatchConstants, PatchState, Press, TurningTrack, pressing_patch
from rbd_model.wheelset.touch import Placement, Wheel, follow_cosines
from rbd_model.wheelset.touching_patch import (
    PROFILE_TERMS,
    LineOfRecord,
    Nearest,
    Outline,
    find_nearest_in,
)
from rbd_model.wheelset.wheel_on_patches import Feeling, WheelPress

#: Places of the lists of a `pair_table.SIDE`, and of the last number of a `pair_table.PATCH`.
TREADS, FLANGES = (
    next(place for place, one in enumerate(SIDE.lists) if one.name == name) for name in ("treads", "flanges")
)
NUMBERS_OF_PATCH = len(PATCH.numbers)
#: Place of its number `middle`, and of its table `gap`, which is straight between offsets.
MIDDLE, GAP, LINE_TERMS = [one.name for one in PATCH.numbers].index("middle"), len(PATCH.tables) - 1, 2
#: Largest distance from the rail at which a patch is evaluated [m], and roll above which it is in any case [rad].
MAY_TOUCH, ROLLED = 0.6e-3, 2e-3


def symbols_of_feeling(on_line: bool) -> tuple[Feeling, ca.SX]:
    """Return a wheel on its rail in symbols of a part, and the symbol of a record of a contact table, (3.77)."""
    state, fixed = PatchState.symbols("state"), PatchConstants.symbols("constants")
    state, fixed = replace(state, nearest=ca.SX(0)), replace(fixed, direction=ca.SX.zeros(2))
    return Feeling(state, fixed, TurningTrack.symbols("track") if on_line else None), ca.SX.sym("record")


def near_of(chain: Chain, feeling: Feeling, record: ca.SX, flange: bool) -> Nearest:
    """Return the point of the patch in a record that is nearest to the rail, (3.77), (3.78)."""
    state, wheel = feeling.state, Wheel(*ca.vertsplit(feeling.fixed.wheel))
    placement = Placement(state.yaw, state.roll, feeling.fixed.cosines, state.offset)
    return find_nearest_in(chain, record, flange, (placement, wheel, state.height))


@lru_cache
def patch_of_record(flange: bool, contact: Contact, on_line: bool) -> Part:
    """Return the part for a `WheelPress` of the patch in a record, (3.77)-(3.105), from `Feeling.given` and record."""
    (feeling, record), chain = symbols_of_feeling(on_line), Chain()
    state, fixed = feeling.state, feeling.fixed
    follow_cosines(chain, fixed.cosines, ca.vertcat(state.yaw, state.roll))
    near, line = near_of(chain, feeling, record, flange), LineOfRecord.of(chain, record, flange)
    part = pressing_patch(PROFILE_TERMS, PROFILE_TERMS, flange, contact, on_line)
    fixed = replace(fixed, direction=ca.vertcat(*line.cosine_and_sine))
    track = [] if feeling.track is None else [feeling.track.vector]
    given = ca.vertcat(replace(state, nearest=near.position).vector, *track)
    pressed = Press.of(chain.call(part, given, ca.vertcat(fixed.vector, near.pieces.vector)))
    results = WheelPress.of_patches([pressed], [flange]).vector
    return Part(
        f"patch_of_{_word(flange, contact.law_of(flange), on_line)}", *given_of(feeling, record), results, chain
    )


@lru_cache
def asked_of_record(flange: bool, on_line: bool) -> Part:
    """Return the part whose result is above 0 if the patch in a record may touch, (3.78); as `patch_of_record`.

    It takes the gap by the offset from a table. With the roll the wheel rises at the patch's middle. Up to ROLLED, the
    places beside it and the slope of the rail change the gap by less than the difference of MAY_TOUCH and NEAR.
    """
    (feeling, record), chain = symbols_of_feeling(on_line), Chain()
    state, wheel = feeling.state, Wheel(*ca.vertsplit(feeling.fixed.wheel))
    placement = Placement(state.yaw, state.roll, feeling.fixed.cosines, state.offset)
    line, middle = LineOfRecord.of(chain, record, flange), numbers_in(chain, record, MIDDLE + 1)[MIDDLE]
    outline = Outline.of(line, placement, wheel, state.height)
    offset = outline.along + line.radius * outline.sine
    gap = polynomials(look_up_in(chain, record, GAP, LINE_TERMS, offset), offset, 0)[0] + outline.square
    margin = MAY_TOUCH - gap - outline.sine * middle
    asked = ca.fmax(margin, ca.fabs(outline.sine) - ROLLED)
    name = f"asked_of_{'flange' if flange else 'tread'}{'_on_line' if on_line else ''}"
    return Part(name, *given_of(feeling, record), asked, chain)


def given_of(feeling: Feeling, record: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Return arguments and constants of these parts, (3.77)."""
    given, constants = feeling.given
    return given, ca.vertcat(constants, record)


def _word(flange: bool, law: CreepLaw, on_line: bool) -> str:
    own = hashlib.sha256(_name_of(law).encode()).hexdigest()[:8]
    return f"{'flange' if flange else 'tread'}_{own}{'_on_line' if on_line else ''}"


def _name_of(law: CreepLaw) -> str:
    if isinstance(law, OfSteel):
        return f"{_name_of(law.law)} {law.poisson_ratio!r}"
    return f"{law.__module__}.{getattr(law, '__qualname__', type(law).__qualname__)}"


@lru_cache
def wheel_on_record(contact: Contact, on_line: bool) -> Part:
    """Return the part for a `WheelPress`, (3.77)-(3.105), from `Feeling.given` and the record of the wheel's side."""
    (feeling, record), chain = symbols_of_feeling(on_line), Chain()
    given, constants = given_of(feeling, record)

    def press(flange: bool) -> ca.SX:
        each = Each(FLANGES if flange else TREADS, asked_of_record(flange, on_line), always=not flange)
        return chain.call(patch_of_record(flange, contact, on_line), given, constants, each=each)

    pressed = press(False) + press(True)
    words = _word(False, contact.law_of(False), False), _word(True, contact.law_of(True), on_line)
    name = f"wheel_{words[0]}_{words[1]}"
    return Part(name, given, constants, pressed, chain)


@lru_cache
def watched_patch(flange: bool) -> Part:
    """Return the part for approaches of the patch in a record [m] (section 9.4.1), for `watched_wheel`.

    Arguments: lateral position, height, yaw and roll; constants: direction cosines, the wheel, and the record. Results:
    the approach of a patch that is not the steepest one of its wheel; that of the steepest one; its position on the
    wheel with the opposite sign. They are -1 where they are those of another patch.
    """
    given, constants = ca.SX.sym("given", 4), ca.SX.sym("constants", 9)
    chain = Chain()
    placement = Placement(given[2], given[3], constants[:4], given[0])
    near = find_nearest_in(chain, constants[8], flange, (placement, Wheel(*ca.vertsplit(constants[4:8])), given[1]))
    steepest = numbers_in(chain, constants[8], NUMBERS_OF_PATCH)[-1] > 0.5 if flange else ca.SX(0)
    results = [ca.if_else(steepest, -1, near.approach)]
    results += [ca.if_else(steepest, one, -1) for one in (near.approach, -near.position)]
    return Part(f"watched_{'flange' if flange else 'tread'}", given, constants, ca.vertcat(*results), chain)


#: Gap of a tread [m] beyond which it does not bear soon, and how much room a larger gap adds [m/m].
BEARS_SOON, ROOM_OF_GAP = 0.3e-3, 100.0


def room_on(near: Nearest, wheel_end: ca.SX | float, rail_ends: tuple[ca.SX | float, ca.SX | float]) -> ca.SX:
    """Return the distance of a patch of a tread from the field side of its wheel and from both ends of its rail [m].

    Section 9.4.1. A patch that does not bear soon has more: its nearest point may be at an end of the rail.
    """
    room = ca.fmin(wheel_end - near.position, ca.fmin(near.on_rail - rail_ends[0], rail_ends[1] - near.on_rail))
    return room + ROOM_OF_GAP * ca.fmax(-near.approach - BEARS_SOON, 0)


@lru_cache
def room_of_patch() -> Part:
    """Return the part for the negative `room_on` of the tread's patch in a record (section 9.4.1).

    Arguments as for `watched_patch`; constants: direction cosines, the wheel, end of the wheel, both ends of the rail
    [m], and the record.
    """
    given, constants, chain = ca.SX.sym("given", 4), ca.SX.sym("constants", 12), Chain()
    placement = Placement(given[2], given[3], constants[:4], given[0])
    at = placement, Wheel(*ca.vertsplit(constants[4:8])), given[1]
    near = find_nearest_in(chain, constants[11], False, at)
    return Part("room_of_patch", given, constants, -room_on(near, constants[8], (constants[9], constants[10])), chain)


@lru_cache
def room_of_tread() -> Part:
    """Return the part for the negative of the least room of all patches of a tread (section 9.4.1).

    The record is that of its side.
    """
    given, constants, chain = ca.SX.sym("given", 4), ca.SX.sym("constants", 12), Chain()
    found = chain.call(room_of_patch(), given, constants, each=Each(TREADS, largest=True))
    return Part("room_of_tread", given, constants, found, chain)


@lru_cache
def watched_wheel(flange_alone: bool) -> Part:
    """Return the part for the largest of each result of `watched_patch` on a wheel (section 9.4.1).

    The record is that of its side.

    flange_alone: of the patches of its flange alone.
    """
    given, constants, chain = ca.SX.sym("given", 4), ca.SX.sym("constants", 9), Chain()
    lists = {FLANGES: True} if flange_alone else {TREADS: False, FLANGES: True}
    found = [
        chain.call(watched_patch(flange), given, constants, each=Each(place, largest=True))
        for place, flange in lists.items()
    ]
    results = found[0] if flange_alone else ca.fmax(*found)
    return Part(f"watched_{'flanges' if flange_alone else 'wheel'}", given, constants, results, chain)

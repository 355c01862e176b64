"""Where a run in space ends, and what is said of wheels that climb or lift (section 9.4.1)."""

from collections.abc import Sequence

import casadi as ca

from rbd_model.contact.geometry import flange_of
from rbd_model.vehicle.assembly import Assembly
from rbd_model.wheelset.elastic import ElasticWheelset
from rbd_model.wheelset.in_space import WheelsetOnRails
from rbd_model.wheelset.rigid import ENDINGS, RigidWheelset
from rbd_model.wheelset.rigid_part import nadal_limit
from rbd_model.wheelset.touch import SIDES


def watch_rigid(assembly: Assembly, wheelsets: Sequence[RigidWheelset]) -> None:
    """Ends and warnings of rigid contacts (section 9.4.1), and an observable of how well their constraints hold."""
    system = assembly.system
    gaps = [wheelset.rolled.gap for wheelset in wheelsets]
    system.observe("largest_gap", "m", ca.mmax(ca.fabs(ca.vertcat(*gaps))))
    add_ends(assembly, wheelsets)
    warn_of_climbing(assembly, wheelsets)


def add_ends(assembly: Assembly, wheelsets: Sequence[RigidWheelset]) -> None:
    """Where the model ends: a tread contact reaches its fold (section 9.4.1) or an end, or a wheel carries nothing."""
    system = assembly.system
    for wheelset in wheelsets:
        share = assembly.resting_on(wheelset.number) / 2
        for index, side in enumerate(SIDES.values()):
            name = f"{side} wheel of wheelset {wheelset.number}"
            for margin, word in zip(ca.vertsplit(wheelset.ends[index]), ENDINGS, strict=True):
                system.end_when_negative(margin, f"Derailed: the {name} {word} at %s s; results up to there are kept.")
            load = wheelset.normal_forces[index] / share
            ends = assembly.parameter["wheel_lift_ends"]
            system.end_when_negative(
                ca.if_else(ends, load, 1),
                f"Wheel lift: the {name} carried no load at %s s; results up to there are kept.",
            )
            system.warn_when_negative(
                ca.if_else(ends, 1, load),
                f"Wheel lift: the {name} carried no load at %s s; from there on the rail pulls it down where needed.",
            )


def warn_of_climbing(assembly: Assembly, wheelsets: Sequence[RigidWheelset]) -> None:
    """Limit of Y/Q after Nadal (1896) for a wheel whose flange touches, with the friction of the gauge face.

    As a margin of forces, which needs no load to divide by.
    """
    of_face = assembly.parameter["gauge_face_friction"]
    for wheelset in wheelsets:
        share, angle = assembly.resting_on(wheelset.number) / 2, flange_of(wheelset.data.equal_sides).angle
        for index, (push, side) in enumerate(zip(wheelset.flange.push, SIDES.values(), strict=True)):
            rolled = wheelset.rolled
            limit = nadal_limit(angle, of_face * rolled.frictions[index])
            margin = limit * rolled.loads[index] - rolled.thrusts[index] - push
            # The creep forces in it cost as much as half of a right-hand side: only where the flange touches.
            assembly.system.warn_when_negative(
                ca.if_else(push > 0, margin / share, 1),
                f"Flange climb: Y/Q of the {side} wheel of wheelset {wheelset.number} rose above Nadal's limit for its "
                "flange and friction at %s s; a real wheel may climb the rail from there on, this one stays on it.",
                candidate=-push / share,
            )


#: Rise of a wheel that is told of as it climbs or as its vehicle tips over [m]: more than a flange's root gives, less
#: than the end of its steep face.
CLIMBED = 5e-3
#: Approach by which margins of patches are counted [m]: that of a loaded tread.
COUNTED = 1e-4


def wheel_rise(assembly: Assembly, wheelset: WheelsetOnRails, index: int) -> ca.SX:
    """How much higher over its rail the left (0) or right wheel (1) stands than on its tread at rest [m], (3.1).

    Told by where the nominal radius has its lowest point: how far the wheel has climbed or lifted (section 9.4.1).
    """
    outwards = list(SIDES)[index] * wheelset.data.pair.both[index].wheel_half_distance
    up = wheelset.body.axes[2, :]
    lowest = up[1] * outwards - up[2] * assembly.value(wheelset.data.radius[index])
    return wheelset.body.position[2] + lowest - wheelset.rail_heights[index]


def watch_patches(assembly: Assembly, wheelsets: Sequence[ElasticWheelset]) -> None:
    """A wheel that runs off its profile ends the run; one that climbs or lifts goes on, and is told of (section 9.4.1).

    It climbs while the steepest part of its flange bears on the rail and nothing else does, which is told as it begins
    and again at a height; and is lifted while nothing bears. The root of a flange that parts from it, as that of S1002,
    still runs on the gauge corner.
    """
    system = assembly.system
    for index in range(len(SIDES)):
        warn_of_tipping(assembly, wheelsets, index)
    for wheelset in wheelsets:
        for index, side in enumerate(SIDES.values()):
            name = f"{side} wheel of wheelset {wheelset.number}"
            end_on_patches(assembly, wheelset, index)
            *others, steepest = (near.approach / COUNTED for near in wheelset.nearest[index])
            tread, flange = ca.mmax(ca.vertcat(*others)), steepest
            climbing = f"Flange climb: the {name} left its tread and climbed on its flange at %s s."
            system.warn_when_negative(ca.if_else(flange > 0, tread, 1), climbing)
            risen = f"Flange climb: the {name} had risen by {1e3 * CLIMBED:g} mm on its flange at %s s."
            room = (CLIMBED - wheel_rise(assembly, wheelset, index)) / COUNTED
            system.warn_when_negative(ca.if_else(flange > 0, room, 1), risen)
            lifted = f"Wheel lift: the {name} carried no load at %s s, and came off its rail."
            system.warn_when_negative(ca.if_else(flange > 0, 1, tread), lifted)


def end_on_patches(assembly: Assembly, wheelset: ElasticWheelset, index: int) -> None:
    """Where the profiles of the left (0) or right wheel (1) and its rail end (section 9.4.1).

    The tip of a flange comes up to the rail's head in two ways: towards that rail, where the wheel has climbed, or away
    from it, where it hangs in the air because its wheelset tips over the other wheel.
    """
    side, other = list(SIDES.values())[index], list(SIDES.values())[1 - index]
    name, kept = f"the {side} wheel of wheelset {wheelset.number}", "at %s s; results up to there are kept."
    tread, flange = ca.vertsplit(wheelset.lost[index])
    towards = list(SIDES)[index] * wheelset.on.offset > 0
    tipped = f"wheelset {wheelset.number} tipped over its {other} wheel and lifted the {side} one off its rail"
    endings = {
        f"Derailed: {name} ran off the end of its tread or of the rail's head {kept}": tread,
        f"Derailed: {name} climbed over its flange {kept}": ca.if_else(towards, flange, 1),
        f"Overturned: {tipped} {kept}": ca.if_else(towards, 1, flange),
    }
    for sentence, margin in endings.items():
        assembly.system.end_when_negative(margin, sentence)


def warn_of_tipping(assembly: Assembly, wheelsets: Sequence[ElasticWheelset], index: int) -> None:
    """Says when all left (0) or right wheels (1) are CLIMBED above their rails and none bears: the vehicle tips over.

    Statics, as in EN 14067-6 (2018): it does where the resultant of weight and lateral forces passes outside of the
    other wheels, and the wheels on this side are unloaded.
    """
    side, other = list(SIDES.values())[index], list(SIDES.values())[1 - index]
    rooms = []
    for wheelset in wheelsets:
        approach = ca.mmax(ca.vertcat(*[near.approach for near in wheelset.nearest[index]]))
        rooms.append(ca.if_else(approach > 0, CLIMBED, CLIMBED - wheel_rise(assembly, wheelset, index)))
    sentence = (
        f"Overturning: all {side} wheels were {1e3 * CLIMBED:g} mm off their rails at %s s; the vehicle tips over its "
        f"{other} wheels."
    )
    assembly.system.warn_when_negative(ca.mmax(ca.vertcat(*rooms)) / COUNTED, sentence)


#: EN 14363:2016, running safety: limit of Y/Q of a guiding wheel, and of the sum of both Y by the static load of the
#: axle P0: 10 kN and a third of it, for a vehicle in its ordinary state.
QUOTIENT_LIMIT, GUIDING_LIMIT, GUIDING_SHARE = 0.8, 10e3, 1 / 3


def warn_of_limits(assembly: Assembly, wheelsets: Sequence[WheelsetOnRails]) -> None:
    """Limits of EN 14363 (2016) as warnings, where running_safety_warnings asks for them.

    Of instantaneous values: the standard takes them over 2 m of track and in percentiles, which are milder.
    """
    system, asked = assembly.system, assembly.parameter["running_safety_warnings"] - 0.5
    for wheelset in wheelsets:
        number = wheelset.number
        weight = assembly.value(wheelset.data.mass) * assembly.parameter["gravity"]
        static = assembly.resting_on(number) + weight
        for index, side in enumerate(SIDES.values()):
            margin = QUOTIENT_LIMIT * wheelset.loads[index] - wheelset.thrusts[index]
            sentence = f"EN 14363: Y/Q of the {side} wheel of wheelset {number} rose above {QUOTIENT_LIMIT} at %s s."
            system.warn_when_negative(ca.if_else(asked > 0, margin / static, 1), sentence, candidate=-asked)
        guiding = wheelset.thrusts[1] - wheelset.thrusts[0]
        room = GUIDING_LIMIT + GUIDING_SHARE * static - ca.fabs(guiding)
        sentence = (
            f"EN 14363: the guiding forces of wheelset {number} rose above 10 kN and a third of its load at %s s."
        )
        system.warn_when_negative(ca.if_else(asked > 0, room / static, 1), sentence, candidate=-asked)

"""End conditions of a spatial run, and warnings of wheels that climb or lift (section 9.4.1)."""

from __future__ import annotations

from collections.abc import Sequence

from fmu_src.symbols import ca
from rbd_model.contact.geometry import flange_of
from rbd_model.vehicle.assembly import Assembly
from rbd_model.wheelset.elastic import ElasticWheelset
from rbd_model.wheelset.in_space import WheelsetOnRails
from rbd_model.wheelset.rigid import ENDINGS, RigidWheelset
from rbd_model.wheelset.rigid_part import nadal_limit
from rbd_model.wheelset.touch import SIDES


def watch_rigid(assembly: Assembly, wheelsets: Sequence[RigidWheelset]) -> None:
    """Add ends and warnings of rigid contacts (section 9.4.1), and an observable of the error of their constraints."""
    system = assembly.system
    gaps = [wheelset.rolled.gap for wheelset in wheelsets]
    system.observe("largest_gap", "m", ca.mmax(ca.fabs(ca.vertcat(*gaps))))
    add_ends(assembly, wheelsets)
    warn_of_climbing(assembly, wheelsets)


def add_ends(assembly: Assembly, wheelsets: Sequence[RigidWheelset]) -> None:
    """Add the ends of the model: a tread contact reaches its fold (section 9.4.1) or an end, or a wheel is unloaded."""
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
    """Add the limit of Y/Q after Nadal (1896) for a wheel whose flange touches, with the friction of the gauge face.

    It is a margin of forces, so that no division by a load is needed.
    """
    of_face = assembly.parameter["gauge_face_friction"]
    for wheelset in wheelsets:
        share, angle = assembly.resting_on(wheelset.number) / 2, flange_of(wheelset.data.equal_sides).angle
        for index, (push, side) in enumerate(zip(wheelset.flange.push, SIDES.values(), strict=True)):
            rolled = wheelset.rolled
            limit = nadal_limit(angle, of_face * rolled.frictions[index])
            margin = limit * rolled.loads[index] - rolled.thrusts[index] - push
            # The creep forces in it cost as much as half of a right-hand side: computed only while the flange touches.
            assembly.system.warn_when_negative(
                ca.if_else(push > 0, margin / share, 1),
                f"Flange climb: Y/Q of the {side} wheel of wheelset {wheelset.number} rose above Nadal's limit for its "
                "flange and friction at %s s; a real wheel may climb the rail from there on, this one stays on it.",
                candidate=-push / share,
            )


#: Rise of a wheel at which it is reported as climbing, or its vehicle as tipping over [m]. It is more than a flange's
#: root gives, less than the end of its steep face.
CLIMBED = 5e-3
#: Scale of the approach in margins of patches [m]: that of a loaded tread.
COUNTED = 1e-4


def wheel_rise(assembly: Assembly, wheelset: WheelsetOnRails, index: int) -> ca.SX:
    """Return the rise of the left (0) or right wheel (1) over its height on its tread at rest [m], (3.1).

    It is measured at the lowest point of the nominal radius and shows how far the wheel has climbed or lifted
    (section 9.4.1).
    """
    outwards = list(SIDES)[index] * wheelset.wheel_half_distance(index)
    up = wheelset.body.axes[2, :]
    lowest = up[1] * outwards - up[2] * assembly.value(wheelset.data.radius[index])
    return wheelset.body.position[2] + lowest - wheelset.rail_heights[index]


def watch_patches(assembly: Assembly, wheelsets: Sequence[ElasticWheelset]) -> None:
    """End a run if a wheel runs off its profile, and warn of a wheel that climbs or lifts (section 9.4.1).

    A wheel climbs while the steepest part of its flange bears on the rail and nothing else does. This is reported at
    its beginning and again at a height. A wheel is lifted while nothing bears. A wheel still runs on the gauge corner
    if it touches at a root that is a patch apart from the flange, as that of S1002.
    """
    system = assembly.system
    for index in range(len(SIDES)):
        warn_of_tipping(assembly, wheelsets, index)
    for wheelset in wheelsets:
        for index, side in enumerate(SIDES.values()):
            name = f"{side} wheel of wheelset {wheelset.number}"
            end_on_patches(assembly, wheelset, index)
            tread, flange = (approach / COUNTED for approach in wheelset.approaches[index])
            climbing = f"Flange climb: the {name} left its tread and climbed on its flange at %s s."
            system.warn_when_negative(ca.if_else(flange > 0, tread, 1), climbing)
            risen = f"Flange climb: the {name} had risen by {1e3 * CLIMBED:g} mm on its flange at %s s."
            room = (CLIMBED - wheel_rise(assembly, wheelset, index)) / COUNTED
            system.warn_when_negative(ca.if_else(flange > 0, room, 1), risen)
            lifted = f"Wheel lift: the {name} carried no load at %s s, and came off its rail."
            system.warn_when_negative(ca.if_else(flange > 0, 1, tread), lifted)


def end_on_patches(assembly: Assembly, wheelset: ElasticWheelset, index: int) -> None:
    """Add the ends of the profiles of the left (0) or right wheel (1) and its rail (section 9.4.1).

    The tip of a flange reaches the height of the rail's head in two ways. It moves towards that rail if the wheel has
    climbed. It moves away from it if the wheel hangs in the air, because its wheelset tips over the other wheel.
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
    """Warn when all left (0) or right wheels (1) are CLIMBED above their rails without contact: the vehicle tips over.

    Statics, as in EN 14067-6 (2018): this happens if the resultant of weight and lateral forces passes outside of the
    other wheels, and the wheels on this side are unloaded.
    """
    side, other = list(SIDES.values())[index], list(SIDES.values())[1 - index]
    rooms = []
    for wheelset in wheelsets:
        approach = ca.fmax(*wheelset.approaches[index])
        rooms.append(ca.if_else(approach > 0, CLIMBED, CLIMBED - wheel_rise(assembly, wheelset, index)))
    sentence = (
        f"Overturning: all {side} wheels were {1e3 * CLIMBED:g} mm off their rails at %s s; the vehicle tips over its "
        f"{other} wheels."
    )
    assembly.system.warn_when_negative(ca.mmax(ca.vertcat(*rooms)) / COUNTED, sentence)


#: EN 14363:2016, running safety: limit of Y/Q of a guiding wheel. Limit of the sum of both Y by the static load P0 of
#: the axle: 10 kN and a third of P0, for a vehicle in its ordinary state.
QUOTIENT_LIMIT, GUIDING_LIMIT, GUIDING_SHARE = 0.8, 10e3, 1 / 3


def warn_of_limits(assembly: Assembly, wheelsets: Sequence[WheelsetOnRails]) -> None:
    """Add limits of EN 14363 (2016) as warnings if running_safety_warnings is 1.

    The limits apply to instantaneous values. The standard uses means over 2 m of track and percentiles, which are less
    strict.
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

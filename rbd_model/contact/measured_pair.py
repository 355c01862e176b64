"""A wheelset on its track from measured profiles: gauge, flange back and radius are given, found or assumed.

Each decision is a note of the pair (`Sides.notes`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from rbd_model.contact.geometry import (
    GAUGE_DEPTH,
    ON_FLANGE,
    STANDARD_GAUGE,
    ContactAtShift,
    Pair,
    Side,
    Sides,
    centred_shift,
    contact_at,
    gauge_face,
)
from rbd_model.contact.measured import TAPE_CIRCLE
from rbd_model.contact.profiles import Profile

#: Default radius of the wheels at the tape circle and distance of the flanges' backs [m] (EN 13715, EN 15302).
RADIUS, FLANGE_BACK = 0.460, 1.360
#: Distance of the y = 0 of the reference rails of EN 15302 [m]. It is used if a rail lacks its gauge face, and if it
#: gives a gauge within SAME of the usual one.
RAILS_APART, SAME = 1.5, 0.5e-3
#: Limits of gauges and distances of backs, and of radii [m].
DISTANCES, RADII = (0.5, 2.0), (0.1, 1.0)
#: Least reach of a profile to both sides of y = 0 [m]; a shorter one has lost its tread or is in metres.
LEAST_REACH = 20e-3
#: A contact closer to the end of a profile than this is on its end [m].
LEAST_MARGIN = 1e-3
WORDS = ("left", "right")


def pair_of(
    wheels: Sequence[Profile],
    rails: Sequence[Profile],
    radii: Sequence[float | None] = (None,),
    gauge: float | None = None,
    flange_back: float | None = None,
) -> Sides:
    """Return wheels on rails, at the gauge of EN 13848-1 and the flange back of EN 13715.

    Takes radii [m], gauge [m], flange_back [m].
    """
    notes: list[str] = []
    wheel_pair, rail_pair = _both(wheels), _both(rails)
    for word, one in _differing(wheel_pair):
        check_reach(one, "wheel")
        notes += [f"{word}wheel {one.source}: {note}" for note in one.notes]
    for word, one in _differing(rail_pair):
        check_reach(one, "rail")
        notes += [f"{word}rail {one.source}: {note}" for note in one.notes]
    places = _rail_places(rail_pair, gauge, notes)
    back = FLANGE_BACK if flange_back is None else within("flange_back", flange_back, DISTANCES)
    notes.append(f"flange back: {1e3 * back:g} mm, {'assumed (EN 13715)' if flange_back is None else 'given'}")
    sides = [
        Side(
            wheel,
            rail,
            radius + float(wheel.height(np.array(0.0))),
            back / 2 + wheel.facts.get("tape_circle", TAPE_CIRCLE),
            place,
        )
        for wheel, rail, radius, place in zip(
            wheel_pair, rail_pair, _radii(wheel_pair, radii, notes), places, strict=True
        )
    ]
    found = _sides(sides[0], sides[1], tuple(notes))
    check_running(found)
    return found


def _both(given: Sequence[Profile]) -> tuple[Profile, Profile]:
    return given[0], given[-1]


def _sides(left: Side, right: Side, notes: tuple[str, ...]) -> Sides:
    """Return equal sides as a `Pair`, which more functions take."""
    if left != right:
        return Sides(left, right, notes)
    return Pair(left.wheel, left.rail, left.radius, left.wheel_half_distance, left.rail_half_distance, notes)


def _differing(pair: tuple[Profile, Profile]) -> Iterator[tuple[str, Profile]]:
    """Yield each profile that differs from the other with the word of its side, or one without a word."""
    if pair[0] == pair[1]:
        yield "", pair[0]
    else:
        yield from zip(("left ", "right "), pair, strict=True)


def _radii(wheels: tuple[Profile, Profile], given: Sequence[float | None], notes: list[str]) -> list[float]:
    """Return the radii at the tape circles [m], and note their origin."""
    found = []
    for word, wheel, one in zip(WORDS, wheels, (given[0], given[-1]), strict=True):
        fact = wheel.facts.get("diameter")
        radius = within("radius", one, RADII) if one is not None else fact / 2 if fact else RADIUS
        reason = "given" if one is not None else "from the wheel's file" if fact else "assumed"
        found.append(radius)
        note = f"radius at the tape circle: {1e3 * radius:g} mm, {reason}"
        if word == "left":
            notes.append(note)
        elif notes[-1] != note:
            notes[-1] = f"left {notes[-1]}; right {1e3 * radius:g} mm, {reason}"
    return found


def _rail_places(rails: tuple[Profile, Profile], gauge: float | None, notes: list[str]) -> tuple[float, float]:
    """Return the distances of the rails' y = 0 from the middle of the track [m], and note their origin."""
    short = next((rail for rail in rails if not reaches_gauge_depth(rail)), None)
    given = None if gauge is None else within("gauge", gauge, DISTANCES)
    if short and given is not None:
        raise ValueError(
            f"{short.source} ends at y = {1e3 * short.limits[0]:.4g} mm, less than {1e3 * GAUGE_DEPTH:g} mm below its"
            " top, where the gauge is measured: leave the gauge out, or give its gauge face too, at negative y."
        )
    if short:
        notes.append(
            f"gauge: unknown, as {short.source} ends less than {1e3 * GAUGE_DEPTH:g} mm below its top at y = "
            f"{1e3 * short.limits[0]:.4g} mm; the y = 0 of both rails are {1e3 * RAILS_APART:g} mm apart"
        )
        return RAILS_APART / 2, RAILS_APART / 2
    faces = [gauge_face(rail) for rail in rails]
    fact = next((rail.facts["gauge"] for rail in rails if "gauge" in rail.facts), None)
    own = RAILS_APART + sum(faces)
    if given is None and fact is None and abs(own - STANDARD_GAUGE) <= SAME:
        notes.append(
            f"gauge: {1e3 * own:.2f} mm, as the rails' y = 0 are {1e3 * RAILS_APART:g} mm apart (EN 15302), "
            f"{1e3 * GAUGE_DEPTH:g} mm below the tops (EN 13848-1)"
        )
        return RAILS_APART / 2, RAILS_APART / 2
    chosen = given or fact or STANDARD_GAUGE
    reason = "given" if given else "from the rail's file" if fact else "assumed"
    notes.append(f"gauge: {1e3 * chosen:g} mm, {reason}, {1e3 * GAUGE_DEPTH:g} mm below the tops (EN 13848-1)")
    return chosen / 2 - faces[0], chosen / 2 - faces[1]


def within(name: str, value: float, limits: tuple[float, float]) -> float:
    """Return a length [m] that is within limits (EN 13848-1, EN 13715)."""
    if not (math.isfinite(value) and limits[0] <= value <= limits[1]):
        raise ValueError(f"{name} must be from {limits[0]:g} to {limits[1]:g} m; got {value:g} m. Give metres.")
    return value


def check_reach(profile: Profile, kind: str) -> None:
    """Check that a profile has its tread or head on both sides of y = 0 (EN 13715)."""
    low, high = (1e3 * limit for limit in profile.limits)
    # A rail may have any origin: it is laid by its gauge face.
    if kind == "rail" and high - low >= 2e3 * LEAST_REACH and reaches_gauge_depth(profile):
        return
    if low > -1e3 * LEAST_REACH or high < 1e3 * LEAST_REACH:
        origin = "the tape circle, 70 mm from the flange's back" if kind == "wheel" else "the middle of the head"
        raise ValueError(
            f"{profile.source} reaches from y = {low:.4g} to {high:.4g} mm; a {kind} profile needs "
            f"{1e3 * LEAST_REACH:g} mm to both sides of y = 0, {origin}. Give y and z in mm, from there."
        )


def reaches_gauge_depth(rail: Profile) -> bool:
    """Return whether the profile includes its gauge face (EN 13848-1)."""
    if "gauge_face" in rail.facts:
        return True
    height = rail.height(np.linspace(*rail.limits, 10001))
    return bool(height[0] < np.max(height) - GAUGE_DEPTH)


def gauge_of(sides: Sides) -> float | None:
    """Return the distance between the gauge faces [m] (EN 13848-1); None if a rail lacks its gauge face."""
    if not all(reaches_gauge_depth(side.rail) for side in sides.both):
        return None
    return sum(side.rail_half_distance + gauge_face(side.rail) for side in sides.both)


def on_rail(side: Side, on_wheel: float, outwards: float) -> float:
    """Return the place on the rail [m] that a level wheel touches after a displacement `outwards` (section 4.3)."""
    return on_wheel + side.wheel_half_distance - side.rail_half_distance + outwards


def check_running(sides: Sides) -> None:
    """Check that a centred wheelset rests on its treads and on the rails' heads, not on an end (section 4.3)."""
    centre = centred_shift(sides, rolls=False)
    contact = contact_at(sides, centre, rolls=False)
    if fault := fault_at(sides, contact):
        raise ValueError(
            f"A centred wheelset must stand on its treads; with a shift of {1e3 * centre:.3g} mm {fault}. Change the "
            "gauge, the flange back, the tape circle, or where the profiles have y = 0."
        )


def fault_at(sides: Sides, contact: ContactAtShift) -> str:
    """Return where a wheel touches on its flange or at an end of a profile, or an empty string (section 4.3)."""
    for word, one, place, angle, sign in zip(WORDS, sides.both, contact.position, contact.angle, (1, -1), strict=True):
        on = on_rail(one, place, sign * contact.shift)
        for kind, profile, y in (("wheel", one.wheel, place), ("rail", one.rail, on)):
            low, high = profile.limits
            if not low + LEAST_MARGIN < y < high - LEAST_MARGIN:
                return (
                    f"the {word} {kind} is touched at the end of its profile, y = {1e3 * y:.4g} mm of "
                    f"{1e3 * low:.4g} to {1e3 * high:.4g} mm"
                )
        if angle > ON_FLANGE:
            return f"the {word} wheel stands on its flange, y = {1e3 * place:.4g} mm, at {math.degrees(angle):.3g} deg"
    return ""

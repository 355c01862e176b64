"""A contact table: what equations read of a pair of profiles, as records of a user's file.

A pair has two sides, a side has the patches of its wheel (patches.py). The equations take numbers, nearest points and
contours from these records, so that one kernel runs any pair.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from fmu_src.records import ListOfRecord, NumberOfRecord, Pieces, Record, RecordKind, TableOfRecord
from rbd_model.contact.bearing import APPROACHES, AT_FIRST, CUBIC, IN_CONTACT, bearing_of, rigid_lines
from rbd_model.contact.geometry import Side, Sides
from rbd_model.contact.patches import (
    AT_MODEL_3,
    TABLE_PITCH,
    TREAD_SLOPE,
    WheelPart,
    contour_of,
    in_direction,
    offsets_of,
    patches_of,
    stand_on_treads,
)
from readers.text import BadInputError

#: Largest shift of a wheelset at its start [m], and the pitch of the table of its position on its treads [m].
LARGEST_SHIFT, STAND_PITCH = 0.010, 0.25e-3
#: Breadth of the pieces with the end slopes beside that table [m]: a rail above the other adds to the shift.
BESIDE = 0.1
#: Largest place in a profile and offset of a wheel [m]; limits of half distances of wheels and rails, and of radii [m].
FARTHEST, HALF_DISTANCES, RADII = 1.0, (0.2, 1.2), (0.1, 1.0)
#: Largest slope [1] and curvature [1/m] of a contour, and largest radius of a rail's arc [m].
STEEPEST, MOST_CURVED, LARGEST_RADIUS = 1e3, 1e5, 1e3


def _place(name: str) -> NumberOfRecord:
    return NumberOfRecord(name, "m", -FARTHEST, FARTHEST)


def _table(name: str, degree: int) -> TableOfRecord:
    return TableOfRecord(name, "m", degree, -FARTHEST, FARTHEST)


#: Angle below the largest one of a flange up to which it is its steepest part [rad].
STEEP = math.radians(10.0)
#: Most patches of a tread or of a flange.
MOST_PATCHES = 64
#: A patch of a wheel. `cosine` and `sine` are those of the direction along which the patch is described. The flange
#: lies below `flange_begins`, its steepest part, on which a wheel climbs, below `steep_begins`. `gap` is the distance
#: of wheel and rail square to it, by the offset, without roll, and `nearest` its place on the wheel; `middle` is a
#: place along it on the wheel. `at_first` and `in_contact` are those of a `bearing.Bearing`, for wheels of
#: `wheel_radius` at y = 0.
PATCH = RecordKind(
    "patch",
    (
        NumberOfRecord("radius", "m", 0.0, LARGEST_RADIUS),
        NumberOfRecord("cosine", "1", 0.0, 1.0),
        NumberOfRecord("sine", "1", -1.0, 1.0),
        _place("middle"),
        _place("flange_begins"),
        _place("steep_begins"),
        NumberOfRecord("wheel_radius", "m", *RADII),
    ),
    (
        _table("gap", 1),
        _table("nearest", 1),
        _table("at_first", CUBIC * len(AT_FIRST) - 1),
        _table("in_contact", CUBIC * len(IN_CONTACT) * len(APPROACHES) - 1),
    ),
)
#: A wheel on its rail. `depth` and `slope` of the wheel and `curvature`, B of eq. (3.83), are those where a centred
#: wheelset stands.
SIDE = RecordKind(
    "side",
    (
        NumberOfRecord("wheel_half_distance", "m", *HALF_DISTANCES),
        NumberOfRecord("rail_half_distance", "m", *HALF_DISTANCES),
        *(_place(f"{word}_{end}") for word in ("wheel", "rail") for end in ("begins", "ends")),
        _place("depth"),
        NumberOfRecord("slope", "1", -STEEPEST, STEEPEST),
        NumberOfRecord("curvature", "1/m", -MOST_CURVED, MOST_CURVED),
    ),
    lists=(
        ListOfRecord("treads", PATCH, 1, MOST_PATCHES),
        ListOfRecord("flanges", PATCH, 0, MOST_PATCHES - 1),
    ),
)
#: A pair: `mean_radius` of the wheels, and `lift` of a centred wheelset over it. By the shift of a wheelset on its
#: treads its `height` over the centred one and its `roll`. Left and right; one record serves both if they are equal.
PAIR = RecordKind(
    "contact_pair",
    (NumberOfRecord("mean_radius", "m", *RADII), _place("lift")),
    (_table("height", 1), _table("roll", 1)),
    (ListOfRecord("sides", SIDE, 1, 2, shared=True),),
)


@lru_cache(maxsize=32)
def pair_record(pair: Sides) -> Record:
    """Return the contact table of a pair (section 4.3)."""
    shifts = np.arange(-LARGEST_SHIFT, LARGEST_SHIFT + STAND_PITCH / 2, STAND_PITCH).tolist()
    stands = [stand_on_treads(pair, shift) for shift in shifts]
    middle = stand_on_treads(pair, 0.0)
    height = lines(shifts, [stand.height - middle.height for stand in stands])
    both = zip(pair.both, middle.position, strict=True)
    sides = tuple(side_record(one, place) for one, place in both)
    numbers = (pair.mean_radius, middle.height - pair.mean_radius)
    kept = sides[:1] if sides[0] == sides[1] else sides
    return Record(PAIR, numbers, (height, lines(shifts, [one.roll for one in stands])), (kept,))


def lines(places: list[float], values: list[float]) -> Pieces:
    """Return straight lines through points, which go on BESIDE the first and the last one (section 4.3)."""
    x, y = np.array(places), np.array(values)
    slopes = np.diff(y) / np.diff(x)
    rows = np.column_stack([np.append(y[:-1], y[-1]), np.append(slopes, slopes[-1])])
    first = [y[0] - BESIDE * slopes[0], slopes[0]]
    return pieces_of(np.array([x[0] - BESIDE, *x, x[-1] + BESIDE]), np.vstack([first, rows]))


def pieces_of(breakpoints: np.ndarray, coefficients: np.ndarray) -> Pieces:
    """Return a table as tuples, which compare and hash (section 4.3)."""
    return tuple(breakpoints.tolist()), tuple(map(tuple, coefficients.tolist()))


def side_record(side: Side, stands: float) -> Record:
    """Return the record of a wheel on its rail (section 4.3).

    stands: place where the wheel of a centred wheelset touches [m].
    """
    try:
        patches = patches_of(side)
    except ValueError as error:
        raise BadInputError(str(error)) from None
    if max(patch.slopes[1] for patch in patches) < TREAD_SLOPE:
        raise BadInputError(
            f"A wheel of a contact table must have a flange; {side.wheel.name} on {side.rail.name} touches on its "
            "tread alone at all shifts. Check gauge, flange back and the side of y that is turned to the middle of the "
            "track."
        )
    limits = *side.wheel.limits, *side.rail.limits
    numbers = side.wheel_half_distance, side.rail_half_distance, *limits, *shape_at(side, stands)
    every = list(zip(patches, patch_records(side), strict=True))
    lists = tuple(tuple(record for patch, record in every if patch.flange == asked) for asked in (False, True))
    return Record(SIDE, numbers, (), lists)


def shape_at(side: Side, on_wheel: float) -> tuple[float, float, float]:
    """Return depth [m] and slope of a wheel at a place [m], and half the curvature of wheel and rail there, eq. (3.83).

    The rail's place is that of the wheel.
    """
    place = np.array(on_wheel)
    depth, slope, bend = (float(side.wheel.height(place, n)) for n in range(3))
    return depth, slope, (bend - float(side.rail.height(place, 2))) / (2 * math.sqrt(1 + slope**2) ** 3)


@lru_cache(maxsize=64)
def patch_records(side: Side) -> tuple[Record, ...]:
    """Return the records of all patches of a wheel (section 9.4.1)."""
    return tuple(patch_record(side, patch) for patch in patches_of(side))


def patch_record(side: Side, part: WheelPart) -> Record:
    """Return the record of a patch (section 9.4.1)."""
    if part.direction < 0.0:
        angle = math.degrees(part.direction)
        raise BadInputError(
            f"At contact model 2 a tread must bear where it slopes by more than -20 degrees; {side.wheel.name} on "
            f"{side.rail.name} bears at {angle:.0f} degrees. Change where they have y = 0, or {AT_MODEL_3}."
        )
    rigid = line_record(side, part)
    bearing = bearing_of(contour_of(side, part), offsets_of(side))
    tables = *rigid.tables[:2], pieces_of(*bearing.at_first), pieces_of(*bearing.in_contact)
    return Record(PATCH, rigid.numbers, tables)


def line_record(side: Side, part: WheelPart) -> Record:
    """Return the same of any part, with its rigid distance and nearest place alone (section 3.3.2)."""
    offsets, contour = offsets_of(side), contour_of(side, part)
    turned = math.cos(part.direction), math.sin(part.direction)
    gap, nearest = rigid_lines(contour, offsets)
    middle = float(np.median(in_direction(nearest, side.wheel.height(nearest), part.direction)[0]))
    nothing: Pieces = ((0.0, 1.0), ((0.0,),))
    tables = lines_over(offsets, gap), lines_over(offsets, nearest), nothing, nothing
    return Record(PATCH, (part.radius, *turned, middle, *flange_of_wheel(side), side.radius), tables)


@lru_cache
def flange_of_wheel(side: Side) -> tuple[float, float]:
    """Return the places on a wheel [m] where its flange begins and where its steepest part begins (section 9.4.1).

    The flange is steeper than TREAD_SLOPE, its steepest part is within STEEP of its largest angle.
    """
    place = np.arange(*side.wheel.limits, TABLE_PITCH)
    angle = np.arctan(side.wheel.height(place, 1))
    steepest = int(np.argmax(np.where(place < 0.0, angle, -np.inf)))

    def begins(least: float) -> float:
        flatter = np.flatnonzero(angle[steepest:] < least)
        return float(place[steepest + (flatter[0] if flatter.size else 0)])

    return begins(TREAD_SLOPE), begins(float(angle[steepest]) - STEEP)


def lines_over(offsets: np.ndarray, values: np.ndarray) -> Pieces:
    """Return straight lines through values at all searched offsets (section 3.3.2), and constants beside them."""
    ends = offsets[0] - TABLE_PITCH, offsets[-1] + TABLE_PITCH
    whole = np.array([values[0], *values, values[-1]])
    return pieces_of(
        np.array([ends[0], *offsets, ends[1]]), np.column_stack([whole[:-1], np.diff(whole) / TABLE_PITCH])
    )

"""A contact table: what equations read of a pair of profiles, as records of a user's file.

A pair has two sides, a side has the patches of its wheel (patches.py). The equations take numbers, nearest points and
contours from these records, so that one kernel runs any pair.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from fmu_src.records import ListOfRecord, NumberOfRecord, Pieces, Record, RecordKind, TableOfRecord
from rbd_model.contact.geometry import Side, Sides
from rbd_model.contact.patches import (
    AT_MODEL_3,
    MOST_PATCHES,
    TABLE_PITCH,
    Patch,
    check_ellipses,
    in_direction,
    offsets_of,
    patches_of,
    stand_on_treads,
)
from rbd_model.contact.profiles import DEGREE
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


#: A patch of a wheel. `steepest` is 1 for the last part of a flange, on which a wheel climbs. `cosine` and `sine` are
#: those of the direction along which the patch is described; of a tread it is level. `gap` is the distance of wheel and
#: rail square to it, by the offset as the nearest point, without roll; `middle` is a place along it on the wheel.
PATCH = RecordKind(
    "patch",
    (
        NumberOfRecord("radius", "m", 0.0, LARGEST_RADIUS),
        _place("square"),
        NumberOfRecord("cosine", "1", 0.0, 1.0),
        NumberOfRecord("sine", "1", -1.0, 1.0),
        _place("middle"),
        NumberOfRecord("steepest", "1", 0.0, 1.0),
    ),
    (
        _table("nearest", 3),
        _table("along", 3),
        _table("wheel", DEGREE),
        _table("rail", DEGREE),
        _table("gap", 1),
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
    """Return the contact table of a pair (section 4.3).

    Raises
    ------
    BadInputError
        If contact model 2 cannot follow the contact: it jumps on too many parts of a wheel, or a wheel bears on a
        steep part of its field side.
    """
    shifts = np.arange(-LARGEST_SHIFT, LARGEST_SHIFT + STAND_PITCH / 2, STAND_PITCH).tolist()
    stands = [stand_on_treads(pair, shift) for shift in shifts]
    middle = stand_on_treads(pair, 0.0)
    height = lines(shifts, [one.height - middle.height for one in stands])
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


def side_record(one: Side, stands: float) -> Record:
    """Return the record of a wheel on its rail (section 4.3).

    stands: place where the wheel of a centred wheelset touches [m].
    """
    try:
        check_ellipses(one)
        patches = patches_of(one)
    except ValueError as error:
        raise BadInputError(str(error)) from None
    if not patches[-1].flange:
        raise BadInputError(
            f"A wheel of a contact table must have a flange; {one.wheel.name} on {one.rail.name} touches on its tread "
            "alone at all shifts. Check gauge, flange back and the side of y that is turned to the middle of the track."
        )
    limits = *one.wheel.limits, *one.rail.limits
    numbers = one.wheel_half_distance, one.rail_half_distance, *limits, *shape_at(one, stands)
    steepest = patches[-1]
    every = [(patch.flange, patch_record(one, patch, patch is steepest)) for patch in patches]
    lists = tuple(tuple(record for flange, record in every if flange == asked) for asked in (False, True))
    return Record(SIDE, numbers, (), lists)


def shape_at(one: Side, on_wheel: float) -> tuple[float, float, float]:
    """Return depth [m] and slope of a wheel at a place [m], and half the curvature of wheel and rail there, eq. (3.83).

    The rail's place is that of the wheel.
    """
    place = np.array(on_wheel)
    depth, slope, bend = (float(one.wheel.height(place, n)) for n in range(3))
    return depth, slope, (bend - float(one.rail.height(place, 2))) / (2 * math.sqrt(1 + slope**2) ** 3)


def patch_record(one: Side, patch: Patch, steepest: bool) -> Record:
    """Return the record of a patch (section 9.4.1); steepest: whether it is the last part of a flange."""
    if not patch.flange and patch.direction != 0.0:
        angle = math.degrees(patch.direction)
        raise BadInputError(
            f"At contact model 2 a tread must bear where it slopes by more than -20 degrees; {one.wheel.name} on "
            f"{one.rail.name} bears at {angle:.0f} degrees. Change where they have y = 0, or {AT_MODEL_3}."
        )
    tables = [pieces_of(*each) for each in (patch.nearest, patch.along, one.wheel.pieces, patch.rail.pieces)]
    turned = math.cos(patch.direction), math.sin(patch.direction)
    middle = float(np.mean(patch.along[1][:, 0]))
    return Record(PATCH, (patch.radius, patch.square, *turned, middle, float(steepest)), (*tables, gap_of(one, patch)))


def gap_of(one: Side, patch: Patch) -> Pieces:
    """Return the distance of a patch from the rail by the offset [m] (section 3.3.2), straight from one to the next.

    Beside the offsets of the nearest points, and beside the rail, it is that of the last ones, as in the equations.
    Beyond all searched offsets it is -FARTHEST, as if the patch touched.
    """
    known, rows = patch.nearest
    x = offsets_of(one)
    last = np.polynomial.polynomial.polyval(known[-1] - known[-2], rows[-1])
    places = np.interp(x, known, np.append(rows[:, 0], last))
    along, square = in_direction(places, one.wheel.height(places), patch.direction)
    y = square - patch.rail.height(np.clip(along + x, *patch.rail.limits))
    ends = [-FARTHEST, 0.0]
    coefficients = np.column_stack([y[:-1], np.diff(y) / np.diff(x)])
    return pieces_of(np.array([x[0] - TABLE_PITCH, *x, x[-1] + TABLE_PITCH]), np.vstack([ends, coefficients, ends]))

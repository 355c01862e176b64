"""Profiles from files: which side is which, where y = 0 lies, how far the contour can be used.

Instruments and programs differ in the directions of their axes and in their origin. Every decision is a note of the
profile.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from rbd_model.contact.gauge_side import LAID, LEAST_LEAN, SIDES, GaugeSide, gauge_side, upright
from rbd_model.contact.profiles import GAUGE_DEPTH, Profile, from_points, inclined
from readers.contours import Contour
from readers.profiles import read_contour

#: Reason of a gauge side that the user gives.
GIVEN = "given"
#: Largest median distance of a contour's points from the spline through them [m]. If two contours are mixed, the
#: distance is larger; corners and noise do not affect the median.
SCATTER = 0.1e-3
#: Distance of the tape circle from the back of the flange [m] (EN 13715, EN 15302).
TAPE_CIRCLE = 70e-3
#: Least distance of a rail's y = 0 from the ends of its profile [m].
BESIDE = 5e-3
#: The back of a flange: points within BACK of the contour's end that span FACE or more in height [m].
BACK, FACE = 0.6e-3, 5e-3
#: Places of a flange's flank, FLANK below most of the wheel [m], if y = 0 is the tape circle, and if it is the back of
#: the flange: flanges are 20 to 36 mm thick there, worn to new (EN 13715, EN 15313).
FLANK = 10e-3
FLANK_FROM_TAPE_CIRCLE, FLANK_FROM_BACK = (-52e-3, -30e-3), (16e-3, 40e-3)


def read_profile(
    path: str | Path,
    kind: str = "",
    inclination: float = 0.0,
    side: str | None = None,
    *,
    tape_circle: float | None = None,
    drop_outliers: bool = False,
) -> Profile:
    """Read a measured contour: a table of y and z, a file of the MiniProf or of SIMPACK (`readers.profiles`).

    A contour that is upside down is turned, as is one whose gauge side is at positive y. Points below an overhang, as
    of the head of a rail, are ignored. Noise is smoothed once, by `profiles.smoothed`: EN 15302 leaves the method
    open and uses the conicity as the criterion.

    Takes tape_circle [m].
    """
    if kind not in ("", "wheel", "rail") or side not in (None, *SIDES):
        raise ValueError(f"kind must be wheel or rail and side y- or y+; got {kind!r} and {side!r}. Correct them.")
    contour = read_contour(path, kind, drop_outliers)
    kind = contour.kind
    points = upright(contour.points, kind)
    faces = _facing(contour.source, points, kind, inclination, side)
    points = points * [-1.0, 1.0] if faces.side == "y+" else points
    notes = [*contour.notes, f"gauge side in the file: {faces}"]
    if kind == "wheel":
        zero, note = _tape_circle(contour, points, faces, tape_circle)
        points, notes = points - [zero, 0.0], [*notes, note]
    else:
        notes.append(_laid(faces, inclination))
    points = _function_of_y(inclined(points, inclination), kind)
    if kind == "rail":
        points, moved = _about_its_head(points)
        notes += moved
    name = Path(contour.source).stem
    found = replace(
        from_points(f"{kind} {name}", Path(contour.source).name, points[:, 0], points[:, 1], measured=True),
        gauge_side=faces,
        notes=tuple(notes),
        facts={**contour.facts, **({} if kind == "wheel" else _gauge_face(points))},
    )
    _check_smooth(contour.source, found, points, kind)
    return found


def _gauge_face(points: np.ndarray) -> dict[str, float]:
    """Return y of the gauge face in the points (EN 13848-1) [m], or nothing if they end above it.

    The face is a wall, which the spline through the points does not follow.
    """
    depth = points[:, 1].max() - points[:, 1]
    last = int(np.argmin(depth))
    deep = np.flatnonzero(depth[:last] >= GAUGE_DEPTH)
    if not deep.size:
        return {}
    at = int(deep[-1])
    return {"gauge_face": float(np.interp(GAUGE_DEPTH, depth[[at + 1, at]], points[[at + 1, at], 0]))}


def _check_smooth(source: str, found: Profile, points: np.ndarray, kind: str) -> None:
    """Check that the points lie near the spline, and say where they are farthest from it."""
    slope = found.height(points[:, 0], 1)
    off = np.abs(found.height(points[:, 0]) - points[:, 1]) / np.sqrt(1 + slope**2)
    scatter = float(np.median(off))
    if scatter > SCATTER:
        y, z = 1e3 * points[int(np.argmax(off))]
        raise ValueError(
            f"{source}: points must lie within {1e3 * SCATTER:g} mm of one smooth contour; half of them are more than "
            f"{1e3 * scatter:.3g} mm off, farthest at y = {y:.4g} mm, z = {z:.4g} mm. Give the points of one {kind} in "
            "their order."
        )


def _function_of_y(points: np.ndarray, kind: str) -> np.ndarray:
    """Return rows (y, z) with increasing y, from the top of a rail or the tape circle of a wheel outwards."""
    start = int(np.argmax(points[:, 1]) if kind == "rail" else np.argmin(np.abs(points[:, 0])))
    if points[0, 0] > points[-1, 0]:
        points, start = points[::-1], len(points) - 1 - start
    left, right = points[: start + 1][::-1] * [-1, 1], points[start:]
    return np.concatenate([_without_overhang(left)[:0:-1] * [-1, 1], _without_overhang(right)])


def _without_overhang(points: np.ndarray) -> np.ndarray:
    """Return the rows (y, z) whose y is larger than all before."""
    y = points[:, 0]
    return points[np.concatenate([[True], y[1:] > np.maximum.accumulate(y)[:-1]])]


def _tape_circle(contour: Contour, points: np.ndarray, faces: GaugeSide, given: float | None) -> tuple[float, str]:
    """Return y of the tape circle in points whose flange is at negative y [m], and a note."""
    turn = -1.0 if faces.side == "y+" else 1.0
    y, z = points.T
    if given is not None:
        if not y.min() < turn * given < y.max():
            raise ValueError(
                f"{contour.source}: the tape circle must lie on the contour, from {1e3 * min(turn * y):.4g} to "
                f"{1e3 * max(turn * y):.4g} mm; got {1e3 * given:.4g} mm. Correct it."
            )
        return turn * given, f"tape circle: given, at y = {1e3 * given:.4g} mm of the file"
    apart = contour.facts.get("tape_circle", TAPE_CIRCLE)
    beside = y < y.min() + BACK
    if np.ptp(z[beside]) >= FACE:
        back = float(np.median(y[beside]))
        where = f"y = {1e3 * turn * (back + apart):.5g} mm of the file"
        return back + apart, f"tape circle: {1e3 * apart:g} mm from the back of the flange, {where}"
    flank = float(np.max(y[(z < np.median(z) - FLANK) & (y < np.median(y))], initial=y.min()))
    if faces.reason == GIVEN or FLANK_FROM_TAPE_CIRCLE[0] < flank < FLANK_FROM_TAPE_CIRCLE[1]:
        return 0.0, "tape circle: y = 0 of the file, as the contour ends before the back of the flange"
    if FLANK_FROM_BACK[0] < flank < FLANK_FROM_BACK[1]:
        return apart, f"tape circle: {1e3 * apart:g} mm from y = 0 of the file, where the back of the flange is"
    raise ValueError(
        f"{contour.source}: y = 0 must be the tape circle or the back of the flange if the contour ends before this "
        f"back; the flange's flank lies at y = {1e3 * turn * flank:.4g} mm. Give the tape circle's y (--tape-circle)."
    )


def _about_its_head(points: np.ndarray) -> tuple[np.ndarray, list[str]]:
    """Return a rail's points with y = 0 on its head, and a note if it lay beside: origins of check rails do."""
    low, high = float(points[0, 0]), float(points[-1, 0])
    if low + BESIDE < 0.0 < high - BESIDE:
        return points, []
    middle = (low + high) / 2
    return points - [middle, 0.0], [f"y = 0: moved by {1e3 * middle:.5g} mm to the middle of the head"]


def _laid(faces: GaugeSide, inclination: float) -> str:
    """Return the note on the inclination of a rail."""
    if inclination:
        return f"inclination: given, 1:{1 / inclination:.4g} more than in the file"
    if faces.lean is None:
        return "inclination: as in the file; its shape does not determine it"
    if faces.lean < LEAST_LEAN:
        return "inclination: none, the rail stands upright in the file; lines have 1:20 to 1:60 (--inclination)"
    return f"inclination: 1:{1 / faces.lean:.3g}, found in the file"


def _facing(source: str, points: np.ndarray, kind: str, inclination: float, side: str | None) -> GaugeSide:
    """Return the gauge side of a file's contour, as it is given or found."""
    found = gauge_side(points, kind)
    if found is None and side is None:
        without = "it has no flange" if kind == "wheel" else "its head is neither symmetric nor worn enough to tell"
        raise ValueError(
            f"{source}: the side of y that is turned to the middle of the track must be known; {without}. Give y- or y+"
            f" as --gauge-side, or as side in Python."
        )
    if side is None or found is None:
        faces = found or GaugeSide(side or "", GIVEN)
    elif kind == "wheel" and found.side != side:
        raise ValueError(f"{source}: the side must be that of the flange, {found.side}; got {side}. Leave it out.")
    else:
        lean = found.lean if found.lean is None or found.side == side else -found.lean
        faces = GaugeSide(side, GIVEN, lean)
    if faces.lean is not None:
        _check_lean(source, faces, faces.lean, inclination)
    return faces


def _check_lean(source: str, faces: GaugeSide, lean: float, inclination: float) -> None:
    """Check that a rail leans inwards or is upright, and that it is not inclined twice without a message."""
    if inclination and lean >= LAID and faces.reason != GIVEN:
        raise ValueError(
            f"{source}: a rail that is to be inclined must stand upright in its file; it leans 1:{1 / lean:.3g} towards"
            f" {faces.side} there. Leave the inclination out, or, if wear makes an upright rail look so, give its gauge"
            f" side too."
        )
    if lean + inclination <= -LEAST_LEAN:
        other = SIDES[faces.side == SIDES[0]]
        raise ValueError(
            f"{source}: a rail must lean towards the middle of the track; with its gauge side at {faces.side} it leans "
            f"1:{-1 / (lean + inclination):.3g} outwards. Give the side {other}, or the rail's inclination."
        )

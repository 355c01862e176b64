"""A wheelset on its track from files of profiles, one for each side or one for both (EN 15302)."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TypeVar

import numpy as np

from rbd_model.contact.geometry import GAUGE_DEPTH, Side, Sides, gauge_face
from rbd_model.contact.measured import read_profile
from rbd_model.contact.profiles import Profile
from scenarios.scenario import BadInputError, Options

#: Default diameter of the wheels, default distance of the flanges' backs, and distance of the nominal contact, the tape
#: circle, from the back [mm] (EN 13715, EN 15302).
DIAMETER, FLANGE_BACK, TAPE_CIRCLE = 920.0, 1360.0, 70.0
#: Default distance of the rails' y = 0 [mm], as for the reference rails of EN 15302.
RAILS_APART = 1500.0
#: Least reach of a profile to both sides of y = 0 [mm]; a shorter one has lost its tread or is in metres.
LEAST_REACH = 20.0

Given = TypeVar("Given")


def sides_from_files(options: Options) -> Sides:
    """Return the wheelset and track that the options describe.

    Raises
    ------
    BadInputError
        If a profile is missing, or if an option is out of its limits.
    """
    if not options.wheel or not options.rail:
        missing = "--rail" if options.wheel else "--wheel"
        raise BadInputError(
            f"{missing} FILE must be given too, because conicity needs a wheel on a rail; got no {missing}."
        )
    lean = 0.0 if options.inclination is None else 1 / within("--inclination", options.inclination, "", 5.0, 1000.0)
    wheels = profiles("--wheel", options.wheel)
    rails = profiles("--rail", options.rail, lean, options.gauge_side or [None])
    diameters = left_and_right("--diameter", options.diameter or [DIAMETER])
    given = FLANGE_BACK if options.flange_back is None else options.flange_back
    backs = within("--flange-back", given, " mm", 500.0, 2000.0)
    left, right = (
        Side(
            wheel,
            rail,
            # The diameter is that of the tape circle, regardless of the file's z = 0.
            within("--diameter", diameter, " mm", 200.0, 2000.0) / 2e3 + float(wheel.height(np.array(0.0))),
            (backs / 2 + TAPE_CIRCLE) / 1e3,
            half_distance(rail, options.gauge),
        )
        for wheel, rail, diameter in zip(wheels, rails, diameters, strict=True)
    )
    return Sides(left, right)


def left_and_right(option: str, given: Sequence[Given]) -> tuple[Given, Given]:
    """Return two values, or one for both sides.

    Raises
    ------
    BadInputError
        If there are more than two values.
    """
    if len(given) > 2:
        raise BadInputError(
            f"{option} must be given once for both sides or twice, left and right; got it {len(given)} times."
        )
    return given[0], given[-1]


def within(option: str, value: float, unit: str, least: float, most: float) -> float:
    if not (math.isfinite(value) and least <= value <= most):
        raise BadInputError(f"{option} must be from {least:g} to {most:g}{unit}; got {value:g}{unit}.")
    return value


def profiles(
    option: str, paths: Sequence[Path], inclination: float = 0.0, gauge_sides: Sequence[str | None] = (None,)
) -> tuple[Profile, Profile]:
    """Return the profiles of the left and of the right side; the same object if they come from one file."""
    files, kind = left_and_right(option, paths), option.removeprefix("--")
    left, right = zip(files, left_and_right("--gauge-side", gauge_sides), strict=True)
    read = {one: profile(one[0], kind, inclination, one[1]) for one in {left: None, right: None}}
    return read[left], read[right]


def profile(path: Path, kind: str, inclination: float = 0.0, gauge_side: str | None = None) -> Profile:
    try:
        found = read_profile(path, kind, inclination, gauge_side)
    except ValueError as error:
        raise BadInputError(str(error)) from error
    low, high = (1e3 * limit for limit in found.limits)
    if low > -LEAST_REACH or high < LEAST_REACH:
        origin = "the tape circle, 70 mm from the flange's back" if kind == "wheel" else "the middle of the head"
        raise BadInputError(
            f"{path} reaches from y = {low:.4g} to {high:.4g} mm; a {kind} profile needs {LEAST_REACH:g} mm to both"
            f" sides of y = 0, {origin}. Give y and z in mm, from there."
        )
    return found


def half_distance(rail: Profile, gauge: float | None) -> float:
    """Return the distance from the middle of the track to the rail's y = 0 [m].

    Parameters
    ----------
    rail : Profile
    gauge : float, optional
        Gauge [mm]; None: the default distance.

    Raises
    ------
    BadInputError
        If the profile ends above the depth at which the gauge is measured.
    """
    if gauge is None:
        return RAILS_APART / 2e3
    half = within("--gauge", gauge, " mm", 500.0, 2000.0) / 2e3
    if not reaches_gauge_depth(rail):
        raise BadInputError(
            f"{rail.source} ends at y = {1e3 * rail.limits[0]:.4g} mm, less than {1e3 * GAUGE_DEPTH:g} mm below its"
            " top, where the gauge is measured: leave --gauge out, or give its gauge face too, at negative y."
        )
    return half - gauge_face(rail)


def reaches_gauge_depth(rail: Profile) -> bool:
    """Return whether the profile includes its gauge face (EN 13848-1)."""
    height = rail.height(np.linspace(*rail.limits, 10001))
    return bool(height[0] < np.max(height) - GAUGE_DEPTH)


def gauge_of(sides: Sides) -> float | None:
    """Return the distance between the gauge faces [m]; None if a rail lacks its gauge face."""
    both = sides.both
    if not all(reaches_gauge_depth(side.rail) for side in both):
        return None
    return sum(side.rail_half_distance + gauge_face(side.rail) for side in both)

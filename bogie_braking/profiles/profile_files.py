"""A wheelset on its track from options that name files of profiles, one for each side or one for both (EN 15302)."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TypeVar

from bogie_braking.pairs import profile
from bogie_braking.reporting.scenario import BadInputError, Options
from rbd_model.contact.geometry import Sides
from rbd_model.contact.measured_pair import pair_of
from rbd_model.contact.profiles import Profile

Given = TypeVar("Given")


def sides_from_files(options: Options) -> Sides:
    """Return the wheelset and track that the options describe (`pair_of`)."""
    if not options.wheel or not options.rail:
        missing = "--rail" if options.wheel else "--wheel"
        raise BadInputError(
            f"{missing} FILE must be given too, because conicity needs a wheel on a rail; got no {missing}."
        )
    lean = 0.0 if options.inclination is None else 1 / within("--inclination", options.inclination, "", 5.0, 1000.0)
    drop = bool(options.drop_outliers)
    wheels = profiles("--wheel", options.wheel, tape_circles=options.tape_circle or [None], drop_outliers=drop)
    rails = profiles("--rail", options.rail, lean, options.gauge_side or [None], drop_outliers=drop)
    diameters = left_and_right("--diameter", options.diameter or [None])
    radii = [
        None if diameter is None else within("--diameter", diameter, " mm", 200.0, 2000.0) / 2e3
        for diameter in diameters
    ]
    track, backs = (
        None if one is None else within(option, one, " mm", 500.0, 2000.0) / 1e3
        for option, one in (("--gauge", options.gauge), ("--flange-back", options.flange_back))
    )
    try:
        return pair_of(wheels, rails, radii, track, backs)
    except ValueError as error:
        raise BadInputError(str(error)) from error


def left_and_right(option: str, given: Sequence[Given]) -> tuple[Given, Given]:
    """Return two values, or one for both sides."""
    if len(given) > 2:
        raise BadInputError(
            f"{option} must be given once for both sides or twice, left and right; got it {len(given)} times."
        )
    return given[0], given[-1]


def within(option: str, value: float, unit: str, least: float, most: float) -> float:
    """Return the value of an option within its limits. Raises BadInputError."""
    if not (math.isfinite(value) and least <= value <= most):
        raise BadInputError(f"{option} must be from {least:g} to {most:g}{unit}; got {value:g}{unit}.")
    return value


def profiles(
    option: str,
    paths: Sequence[Path],
    inclination: float = 0.0,
    gauge_sides: Sequence[str | None] = (None,),
    tape_circles: Sequence[float | None] = (None,),
    drop_outliers: bool = False,
) -> tuple[Profile, Profile]:
    """Return the profiles of the left and of the right side; the same object if they come from one file.

    inclination: slope. tape_circles [mm].
    """
    kind = option.removeprefix("--")
    files, turned = left_and_right(option, paths), left_and_right("--gauge-side", gauge_sides)
    asked = list(zip(files, turned, left_and_right("--tape-circle", tape_circles), strict=True))
    read = {}
    for path, side, tape_circle in dict.fromkeys(asked):
        zero = None if tape_circle is None else within("--tape-circle", tape_circle, " mm", -500.0, 500.0) / 1e3
        read[path, side, tape_circle] = profile(
            path, kind, inclination=inclination, gauge_side=side, tape_circle=zero, drop_outliers=drop_outliers
        )
    return read[asked[0]], read[asked[1]]

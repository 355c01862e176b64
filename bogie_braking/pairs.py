"""Profiles of wheels and rails from files, and pairs of them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from numbers import Real
from pathlib import Path
from typing import Any

from rbd_model.contact.geometry import Sides
from rbd_model.contact.measured import read_profile
from rbd_model.contact.measured_pair import pair_of
from rbd_model.contact.profiles import Profile
from readers.text import BadInputError, shown

#: A profile, or the path of its file.
Given = Profile | str | Path
#: Largest inclination of a rail [1]; lines have 1:20 to 1:60.
STEEPEST = 0.2


def profile(
    path: str | Path,
    kind: str = "",
    *,
    inclination: float = 0.0,
    gauge_side: str | None = None,
    tape_circle: float | None = None,
    drop_outliers: bool = False,
) -> Profile:
    """Read the profile of a wheel or of a rail from a file: a table, SIMPACK, or MiniProf.

    Parameters
    ----------
    path : str or Path
        The file. `#2` behind its name chooses the second profile of an .mpt file.
    kind : str
        "wheel" or "rail"; by default that of the file's header or ending.
    inclination : float
        Slope by which a rail that stands upright in its file is laid towards the middle of the track, as 1 / 40.
    gauge_side : str, optional
        Side of the file's y towards the middle of the track, "y-" or "y+"; by default it is found.
    tape_circle : float, optional
        y of a wheel's tape circle in the file [m]; by default it is found.
    drop_outliers : bool
        Whether points off the contour are left out, with a note; by default they are refused.

    Returns
    -------
    Profile
        The profile. Its `notes` are sentences on what was applied, found or assumed.

    Raises
    ------
    BadInputError
        If the file is not such a profile; the message names file, row, value and remedy.
    """
    _check_number("inclination", inclination)
    if not 0.0 <= inclination <= STEEPEST:
        raise BadInputError(
            f"inclination must be from 0 to {STEEPEST:g}; got {inclination!r}. Give a slope, as 1 / 40."
        )
    try:
        return read_profile(path, kind, inclination, gauge_side, tape_circle=tape_circle, drop_outliers=drop_outliers)
    except ValueError as error:
        raise BadInputError(str(error)) from error


def pair(
    wheel: Given | Sequence[Given],
    rail: Given | Sequence[Given],
    *,
    radius: float | Sequence[float] | None = None,
    gauge: float | None = None,
    flange_back: float | None = None,
    inclination: float = 0.0,
) -> Sides:
    """Return wheels on rails, for the `pair` of a vehicle's wheelsets.

    Parameters
    ----------
    wheel, rail : Profile, str or Path, or two of them
        Profiles or files; two are left and right.
    radius : float or two, optional
        Radii at the tape circles [m]; by default that of the wheel's file, or 0.46 m.
    gauge : float, optional
        Distance of the gauge faces, 14 mm below the tops [m]; by default that of the rail's file, or 1.435 m. The y = 0
        of both rails are 1.5 m apart, as in EN 15302, if this gives a gauge within 0.5 mm of 1.435 m.
    flange_back : float, optional
        Distance of the backs of the flanges [m]; by default 1.36 m.
    inclination : float
        As `profile`, for rails that are files.

    Returns
    -------
    Sides
        The pair. Its `notes` are sentences on what was given, found or assumed.

    Raises
    ------
    BadInputError
        If a profile or a number is not as required, or the wheels do not stand on the rails' heads.
    """
    wheels = [_read(one, "wheel", 0.0) for one in _one_or_two("wheel", wheel)]
    rails = [_read(one, "rail", inclination) for one in _one_or_two("rail", rail)]
    radii: list[Any] = list(radius) if isinstance(radius, Iterable) and not isinstance(radius, str) else [radius]
    if len(radii) not in (1, 2):
        raise BadInputError(f"radius must be one or two numbers, left and right; got {len(radii)}. Correct it.")
    for name, one in (*(("radius", each) for each in radii), ("gauge", gauge), ("flange_back", flange_back)):
        _check_number(name, one)
    try:
        return pair_of(wheels, rails, radii, gauge, flange_back)
    except ValueError as error:
        raise BadInputError(str(error)) from error


def _one_or_two(name: str, given: Given | Sequence[Given]) -> Sequence[Given]:
    if not isinstance(given, Profile | str | Path | list | tuple):
        raise BadInputError(f"{name} must be a profile, a path, or two of them; got {shown(given)}. Correct it.")
    found = [given] if isinstance(given, Profile | str | Path) else list(given)
    if len(found) not in (1, 2):
        raise BadInputError(f"{name} must be one profile or two, left and right; got {len(found)}. Correct it.")
    return found if len(found) == 1 or found[0] != found[1] else found[:1]


def _check_number(name: str, value: object) -> None:
    if value is not None and (isinstance(value, bool) or not isinstance(value, Real)):
        raise BadInputError(f"{name} must be a number or None; got {shown(value)}. Correct it.")


def _read(given: Given, kind: str, inclination: float) -> Profile:
    return given if isinstance(given, Profile) else profile(given, kind, inclination=inclination)

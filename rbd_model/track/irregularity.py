"""The straight track: lateral position and height of both rails along it, eqs (5.3), (5.4), and friction.

Each wheelset meets the rails' section at its own distance, shifted by the irregularity there. Near the wheelset the
rails are treated as straight along the track. This approximation has an error of first order in the slope of the
irregularity: a wheelset that follows a wave yaws relative to the axes of the track, not to the rails.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path

import numpy as np
from scipy.interpolate import BPoly, PPoly

from fmu_src.chain import Part
from fmu_src.symbols import ca
from fmu_src.system import ParameterSet, System, quantity
from rbd_model.track.line import Line
from rbd_model.track.line_table import along_line
from readers.columns import Column
from readers.tables import read_table

#: Exponent of the plateau, eq. (5.4).
PLATEAU_POWER = 8


@dataclass(frozen=True)
class TrackParameters(ParameterSet):
    """Irregularities of the track; an amplitude of 0 is a perfect track.

    Reported: the waves (5.3) begin at 5 m (sections 5.3.1, 5.3.2); wave numbers 0.045, 0.07 and 0.07 1/m.
    Assumed: irregularity_blend, because a sine that begins with a corner would be an impact. Also cross_level_centre,
    far enough from the start for the plateau, which has no ends; and half of the cross level on each rail.
    """

    lateral_irregularity: float = quantity("m", "Lateral wave of the track, amplitude (Delta_ir)", -1.0, 1.0)
    lateral_wave_number: float = quantity("1/m", "Lateral wave, k_ir: the wave is 2 / k_ir long", 1e-6)
    vertical_irregularity: float = quantity("m", "Vertical wave of both rails, amplitude (Delta_ir)", -1.0, 1.0)
    vertical_wave_number: float = quantity("1/m", "Vertical wave, k_ir", 1e-6)
    cross_level: float = quantity("m", "Plateau of the left rail's height above the right one's (Delta_ir)", -1.0, 1.0)
    cross_level_wave_number: float = quantity("1/m", "Plateau of cross level, k_ir: it is 2 / k_ir long", 1e-6)
    cross_level_centre: float = quantity("m", "Distance of the middle of the plateau from the start")
    cross_level_left_share: float = quantity("1", "Share of the cross level that raises the left rail", 0.0, 1.0)
    irregularity_start: float = quantity("m", "Distance at which the lateral and the vertical wave begin")
    irregularity_blend: float = quantity("m", "Length over which a wave grows in at its ends", 1e-3)


def section_5_3() -> TrackParameters:
    """Return a perfect track with the places and wave numbers of section 5.3."""
    return TrackParameters(
        lateral_irregularity=0.0,
        lateral_wave_number=0.045,
        vertical_irregularity=0.0,
        vertical_wave_number=0.07,
        cross_level=0.0,
        cross_level_wave_number=0.07,
        cross_level_centre=65.0,
        cross_level_left_share=0.5,
        irregularity_start=5.0,
        irregularity_blend=1.0,
    )


@dataclass(frozen=True)
class TrackSupport(ParameterSet):
    """Support of the rails below a wheelset in 3D on a line, see `yielding_track`."""

    flexible_track: float = quantity(
        "1", "On a line, rails yield below each wheelset in space (1), or are rigid (0)", 0.0, 1.0, "integer"
    )
    track_rail_mass: float = quantity("kg", "Track below a wheelset, mass of each rail that moves with it", 1.0)
    track_vertical_stiffness: float = quantity("N/m", "Track below a wheelset, vertical stiffness of each rail", 0.0)
    track_vertical_damping: float = quantity("N.s/m", "Track below a wheelset, vertical damping of each rail", 0.0)
    track_lateral_stiffness: float = quantity("N/m", "Track below a wheelset, lateral stiffness of both rails", 0.0)
    track_lateral_damping: float = quantity("N.s/m", "Track below a wheelset, lateral damping of both rails", 0.0)


def ballasted_track() -> TrackSupport:
    """Return track on ballast below one wheelset.

    Assumed: 43 MN/m and 240 kN.s/m, for each rail vertically and for both together sideways. They represent a rail of
    60 kg/m on the pads, ballast and ground of Zhai, Wang and Lin (2004), J. Sound Vib. 270, 673-683. This is a beam on
    an elastic foundation with 81 MN/m and, slowly, 45 kN.s/m. Its bend decays over 0.87 m, and its moving mass is
    equivalent to 79 kg at the wheel; the set has 80 kg. The effect of the other values is in `flexible-track`.
    """
    return TrackSupport(
        flexible_track=1.0,
        track_rail_mass=80.0,
        track_vertical_stiffness=43e6,
        track_vertical_damping=240e3,
        track_lateral_stiffness=43e6,
        track_lateral_damping=240e3,
    )


@dataclass(frozen=True)
class Section:
    """The track at one distance.

    rails: rows, lateral position of both, height of the left and of the right one [m]; columns, value and derivatives
    along the track.
    """

    rails: ca.SX
    friction: ca.SX  # factor on the friction coefficient
    density: ca.SX  # 1/m: steps resolve what is as short as its reciprocal; 0: level track
    spread: ca.SX = field(default_factory=lambda: ca.SX(1, 2))  # of each rail, outwards, and its derivative


#: Adds the track to a System (parameters or tables). Returns its section as a function of a wheelset's number, a
#: distance and the number of derivatives.
Track = Callable[[System], "Callable[[int, ca.SX, int], Section]"]


def blend(share: ca.SX) -> ca.SX:
    """Return a step from 0 to 1 over 0 to 1 with two continuous derivatives, 10 s^3 - 15 s^4 + 6 s^5.

    Assumed, for the ends of the waves of sections 5.3.1 and 5.3.2, which have corners in the thesis.
    """
    s = ca.fmin(ca.fmax(share, 0), 1)
    return s**3 * (10 - 15 * s + 6 * s**2)


def wave(distance: ca.SX, amplitude: ca.SX, wave_number: ca.SX, blend_length: ca.SX) -> ca.SX:
    """Return one period of a sine from distance 0, eq. (5.3), zero before and after, blended in and out."""
    window = blend(distance / blend_length) * blend((2 / wave_number - distance) / blend_length)
    return amplitude * ca.sin(ca.pi * wave_number * distance) * window


def plateau(distance: ca.SX, amplitude: ca.SX, wave_number: ca.SX) -> ca.SX:
    """Return a smooth plateau around distance 0, eq. (5.4)."""
    return amplitude / ca.sqrt(1 + (wave_number * distance) ** PLATEAU_POWER)


@lru_cache
def irregular_rails(order: int) -> Part:
    """Return the part for the `rails` of a `Section`, column by column, by the waves (5.3) and the plateau (5.4).

    Argument: the distance. Constants: the parameters in the order of `TrackParameters`.
    """
    names = list(section_5_3().values())
    distance, constants = ca.SX.sym("distance"), ca.SX.sym("constants", len(names))
    p = dict(zip(names, ca.vertsplit(constants), strict=True))
    along, length = distance - p["irregularity_start"], p["irregularity_blend"]
    lateral = wave(along, p["lateral_irregularity"], p["lateral_wave_number"], length)
    vertical = wave(along, p["vertical_irregularity"], p["vertical_wave_number"], length)
    across = plateau(distance - p["cross_level_centre"], p["cross_level"], p["cross_level_wave_number"])
    left = p["cross_level_left_share"] * across
    columns = [ca.vertcat(lateral, vertical + left, vertical + left - across)]
    for _ in range(order):
        columns.append(ca.jacobian(columns[-1], distance))
    return Part(f"irregular_rails_{order}", distance, constants, ca.densify(ca.vertcat(*columns)))


#: Amplitudes. If all of them are 0, rails are straight.
AMPLITUDES = ("lateral_irregularity", "vertical_irregularity", "cross_level")


def irregular_track(defaults: TrackParameters) -> Track:
    """Return a track with the waves (5.3) and the plateau (5.4), all of them parameters."""

    def add(system: System) -> Callable[[int, ca.SX, int], Section]:
        p = {name: system.parameter(defaults.variable(name)) for name in defaults.values()}

        def density() -> ca.SX:
            """Return the wave number of the shortest wave or plateau with a height above 0."""
            numbers = [
                ca.if_else(p[kind] == 0, 0, p[f"{kind.removesuffix('_irregularity')}_wave_number"])
                for kind in AMPLITUDES
            ]
            return ca.mmax(ca.vertcat(*numbers))

        def section(number: int, distance: ca.SX, order: int) -> Section:
            there_are = sum(ca.fabs(p[kind]) for kind in AMPLITUDES)
            rails = system.call(irregular_rails(order), distance, ca.vertcat(*p.values()), there_are)
            return Section(ca.reshape(rails, 3, order + 1), ca.SX(1), density())

        return section

    return add


def with_line(track: Track) -> Track:
    """Return the same track on the line of an instance, with that line's widening, friction and irregularities
    added.
    """

    def add(system: System) -> Callable[[int, ca.SX, int], Section]:
        own = track(system)

        def section(number: int, distance: ca.SX, order: int) -> Section:
            def of_line(*columns: str, derivatives: int = 0) -> ca.SX:
                rows = [ca.horzcat(*along_line(system, column, distance, derivatives)) for column in columns]
                return ca.vertcat(*rows)

            there = own(number, distance, order)
            return Section(
                there.rails + of_line("lateral", "left", "right", derivatives=order),
                there.friction * of_line("left_friction", "right_friction"),
                ca.fmax(there.density, 1 / of_line("shortest")),
                of_line("spread", derivatives=1),
            )

        return section

    return add


def derivatives_along(parameters: TrackParameters) -> Callable[[float], np.ndarray]:
    """Return the track with (5.3), (5.4) in plain numbers: a function of distance [m], shape (3, 3).

    Rows: value and two derivatives. Columns: lateral position of both rails, height of the left and of the right one
    [m].
    """
    system = System("track", "its parameters become numbers")
    distance = ca.SX.sym("distance")
    rails = system.expand(irregular_track(parameters)(system)(1, distance, 2).rails)
    symbols = ca.vertcat(*system.parameter_symbols.values())
    numbers = ca.DM([variable.start for variable in system.variables])
    function = ca.Function("track", [distance], [ca.densify(ca.substitute(rails.T, symbols, numbers))])
    return lambda at: np.array(function(at))


#: Points of a measured track in the shortest feature that steps resolve.
POINTS_FELT = 8
#: Least distance of two of its points [m]; steps are as long as the time for passing some of them.
LEAST_DISTANCE = 1e-3
#: Columns of a track file; lateral is of both rails, left and right are heights, friction a factor.
COLUMNS = (
    Column("distance", "m", -1e7, 1e7, required=True),
    *(Column(name, "m", -1.0, 1.0, required=True) for name in ("lateral", "left", "right")),
    Column("friction", "1", 0.0, 10.0, required=True),
)


def track_from_file(path: Path) -> Track:
    """Return a measured track from a file of COLUMNS; the row of names may be missing.

    Between points it is interpolated as a line file is between its rows (docs/line.md). Beyond the ends the first and
    last values apply.
    """
    table = read_table(path, COLUMNS, by_position=True)
    table.check_rows(6)
    table.check_growth("distance", LEAST_DISTANCE)
    return track_from_points(*(table.numbers[column.name] for column in COLUMNS))


def track_from_points(
    distance: np.ndarray, lateral: np.ndarray, left: np.ndarray, right: np.ndarray, friction: np.ndarray
) -> Track:
    """Return a track through points.

    Takes distance [m] (n,), lateral, left, right [m] (n,), friction [1] (n,).
    """
    names = ("left_lateral", "left_vertical", "right_vertical", "left_friction")
    line = Line.of_any_size({"distance": distance} | dict(zip(names, (lateral, left, right, friction), strict=True)))
    places = line.breaks()

    def pieces(name: str) -> tuple[np.ndarray, np.ndarray]:
        straight = name == "left_friction"
        at = distance if straight else places
        ends = np.stack([line.value(name, at, order) for order in range(1 if straight else 3)], axis=1)
        return at, PPoly.from_bernstein_basis(BPoly.from_derivatives(at, ends)).c[::-1].T

    closest = float(np.min(np.diff(distance)))
    if not closest >= LEAST_DISTANCE:
        raise ValueError(
            f"Points of a track must be at least {LEAST_DISTANCE:g} m apart; got {closest:.3g} m. Leave points out: "
            "steps resolve what lies between them."
        )
    density = 1 / (POINTS_FELT * closest)

    def add(system: System) -> Callable[[int, ca.SX, int], Section]:
        def section(number: int, along: ca.SX, order: int) -> Section:
            def table(name: str, derivatives: int) -> ca.SX:
                return ca.horzcat(*system.curve(f"track_{name}_{number}", *pieces(name), along, derivatives))

            rails = [table(name, order) for name in names[:3]]
            return Section(ca.vertcat(*rails), table(names[3], 0), ca.SX(density))

        return section

    return add

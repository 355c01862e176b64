"""Numbers by which a line is checked: radii, cant, cant deficiency at a speed, gradients, twist, jumps."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rbd_model.track.line import FRICTIONS, Line
from rbd_model.track.line_pieces import end_of
from rbd_model.track.line_table import GAUGE, ROUNDING

Numbers = NDArray[np.float64]
#: Acceleration of free fall [m/s2], and length over which twist is measured [m] (EN 13848-1).
GRAVITY, TWIST_BASE = 9.81, 3.0
#: Friction below which a rail is slippery: the adhesion that brakes may use up to 250 km/h (TSI, secondary
#: source).
SLIPPERY = 0.15
#: Changes over 2 ROUNDING that are jumps, assumed: a curve of 5000 m, 5 mm of cant, 2 per mille.
JUMPS = {"curvature": 2e-4, "cant": 5e-3, "gradient": 2e-3}


@dataclass(frozen=True)
class Extreme:
    """A value and its place on the line [m]."""

    value: float
    place: float


@dataclass(frozen=True)
class AdhesionCheck:
    """A map of friction along a line, or of the factors on it.

    Values are means of both rails.

    Attributes
    ----------
    lowest, highest : Extreme
        Smallest and largest value.
    mean : float
        Mean over the line.
    sides : Extreme
        Largest difference by size, left rail less right.
    below : float or None
        Limit of slippery stretches; None for factors.
    stretches : list
        First and last distance of each stretch below the limit [m].
    """

    lowest: Extreme
    highest: Extreme
    mean: float
    sides: Extreme
    below: float | None
    stretches: list[tuple[float, float]]

    @property
    def slippery(self) -> float:
        """Length below the limit [m]."""
        return sum(end - begin for begin, end in self.stretches)


@dataclass(frozen=True)
class LineCheck:
    """Extremes of a line at a speed.

    Attributes
    ----------
    begin, end, rows : float
        First and last distance [m], number of rows.
    tightest : Extreme
        Largest curvature by size, with its sign [1/m].
    cant, deficiency, excess : Extreme
        Largest cant by size [m]; largest and smallest cant deficiency at the speed [m], positive outwards.
    gradient, height : Extreme, float
        Steepest gradient with its sign; height of the end over the start [m].
    twist : Extreme
        Largest change of cant and cross level over TWIST_BASE, a metre.
    jumps : dict
        For each quantity the places where it jumps [m], with the change.
    adhesion : Adhesion or None
        The map of friction; None if the line has no columns of friction.
    """

    begin: float
    end: float
    rows: int
    tightest: Extreme
    cant: Extreme
    deficiency: Extreme
    excess: Extreme
    gradient: Extreme
    height: float
    twist: Extreme
    jumps: dict[str, list[Extreme]]
    adhesion: AdhesionCheck | None = None


def deficiency_of(curvature: Numbers, cant: Numbers, speed: float) -> Numbers:
    """Return the cant deficiency of curves at a speed [m], to the outside of each: v^2 / (R g) of GAUGE, less the cant.

    EN 13803 rounds GAUGE / g to 11.8 mm.m.h2/km2. On straight track the sign is that of the cant to the left.
    """
    side = np.where(curvature == 0.0, 1.0, np.sign(curvature))
    return np.asarray(side * (GAUGE * speed**2 * curvature / GRAVITY - cant))


def check_line(line: Line, speed: float, friction: float | None = None) -> LineCheck:
    """Return the numbers of a line at a speed [m/s]; values are linear between rows, as in EN 13803.

    friction: that of the rail, which the factors of the line multiply [1]; None: unknown.
    """
    rows = line.rows
    at, zeros = rows["distance"], np.zeros_like(rows["distance"])
    curvature, cant, gradient = (rows.get(name, zeros) for name in ("curvature", "cant", "gradient"))
    lacking = deficiency_of(curvature, cant, speed)
    return LineCheck(
        float(at[0]),
        float(at[-1]),
        at.size,
        _largest(curvature, at),
        _largest(cant, at),
        Extreme(float(lacking.max()), float(at[np.argmax(lacking)])),
        Extreme(float(lacking.min()), float(at[np.argmin(lacking)])),
        _largest(gradient, at),
        end_of({"distance": at, "curvature": curvature, "gradient": gradient})["height"],
        _twist(line),
        {name: _jumps(at, rows.get(name, zeros), least) for name, least in JUMPS.items()},
        adhesion_of(line, friction) if line.has_friction else None,
    )


def adhesion_of(line: Line, friction: float | None) -> AdhesionCheck:
    """Return the map of friction of a line, whose factors multiply a friction [1], or of the factors alone.

    The mean of both rails is that of `mean_friction` of line_table.py: Coulomb's law, end of (3.97).
    """
    at = line.rows["distance"]
    scale = 1.0 if friction is None else friction
    left, right = (scale * line.rows.get(name, np.ones_like(at)) for name in FRICTIONS)
    both = (left + right) / 2.0
    return AdhesionCheck(
        Extreme(float(both.min()), float(at[np.argmin(both)])),
        Extreme(float(both.max()), float(at[np.argmax(both)])),
        float(np.trapezoid(both, at) / (at[-1] - at[0])) if at.size > 1 else float(both[0]),
        _largest(left - right, at),
        None if friction is None else SLIPPERY,
        [] if friction is None else _stretches(at, both, SLIPPERY),
    )


def _stretches(at: Numbers, values: Numbers, limit: float) -> list[tuple[float, float]]:
    """Return where values that are linear between places are below a limit."""
    over = values - limit
    crossed = np.flatnonzero(over[:-1] * over[1:] < 0.0)
    ways = over[crossed] / (over[crossed] - over[crossed + 1])
    places = np.union1d(at, at[crossed] + ways * np.diff(at)[crossed])
    low = np.interp((places[1:] + places[:-1]) / 2.0, at, values) < limit
    turns = np.flatnonzero(np.diff(np.concatenate([[False], low, [False]])))
    return [(float(places[begin]), float(places[end])) for begin, end in turns.reshape(-1, 2)]


def _largest(values: Numbers, at: Numbers) -> Extreme:
    row = int(np.argmax(np.abs(values)))
    return Extreme(float(values[row]), float(at[row]))


def _twist(line: Line) -> Extreme:
    rows = line.rows
    at = rows["distance"]
    level = rows.get("cant", 0.0) + rows.get("right_vertical", 0.0) - rows.get("left_vertical", 0.0) + 0.0 * at
    begins = np.union1d(at, at - TWIST_BASE)
    begins = begins[(begins >= at[0]) & (begins <= at[-1] - TWIST_BASE)]
    if not begins.size:
        return Extreme(0.0, float(at[0]))
    twist = (np.interp(begins + TWIST_BASE, at, level) - np.interp(begins, at, level)) / TWIST_BASE
    return _largest(twist, begins)


def _jumps(at: Numbers, values: Numbers, least: float) -> list[Extreme]:
    """Return changes of at least `least` within 2 ROUNDING, one for those that are close together."""
    middles = np.union1d(at, (at[1:] + at[:-1]) / 2.0)
    change = np.interp(middles + ROUNDING, at, values) - np.interp(middles - ROUNDING, at, values)
    found: list[Extreme] = []
    for place in np.flatnonzero(np.abs(change) >= least).tolist():
        extreme = Extreme(float(change[place]), float(middles[place]))
        if found and extreme.place - found[-1].place <= 4.0 * ROUNDING:
            found[-1] = max(found[-1], extreme, key=lambda each: abs(each.value))
        else:
            found.append(extreme)
    return found


def radius_of(curvature: float) -> float:
    """Return the radius of a curvature by size [m], infinite for straight track."""
    return math.inf if curvature == 0.0 else 1.0 / abs(curvature)

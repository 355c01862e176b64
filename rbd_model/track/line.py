"""The line as data: curvature, cant, gradient, widening, irregularity and friction of both rails, by rows along it.

A line is built of segments or read from a file. It can be written to a file, which FMUs and kernels read (`line_file`,
line_table.py). Curvature and cant are positive for a curve to the left, whose right rail is the higher one. Distance is
measured along the line; gradient is the rise per metre of it. Values are linear between rows, with rounded corners at
the rows: `Line.value`, and for models fmu_src/runtime/table_pieces.c.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from numbers import Real
from pathlib import Path

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import ArrayLike

from rbd_model.track.line_rows import checked_rows
from rbd_model.track.line_table import LARGEST_TURN, LINE, ROUNDING, WHOLE_TURN
from readers.storage import write_whole
from readers.tables import MOST_ROWS as MOST_OF_FILE
from readers.tables import read_table
from readers.text import FileError

#: Names of the columns of a line file.
NAMES = tuple(column.name for column in LINE.columns)
#: Rows of a line that is built: largest distance between two of them [m], and largest turn between two of them [rad].
ROW_DISTANCE, ROW_TURN = 5.0, 0.02
#: Largest number of rows of a line that is built.
MOST_ROWS = 1_000_000
#: Columns whose corners are rounded by cubics, because their integrals are looked up too. Friction keeps its corners.
#: All other columns have two continuous derivatives.
#: JUMP [m]: length over which a jump of friction is spread.
INTEGRATED, FRICTIONS = ("curvature", "gradient"), ("left_friction", "right_friction")
JUMP = 0.01
#: Corrections of the straight line over a reach of 1, for a slope and for a bend of 1 at a row. They end where the line
#: is met again. A cubic has no bend, a quintic has one.
_AWAY, _LEFT = Polynomial([0.0, 1.0]), Polynomial([1.0, -1.0])
CUBIC = (_AWAY * _LEFT**2, Polynomial([0.0]))
QUINTIC = (_AWAY * _LEFT**3 * Polynomial([1.0, 3.0]), _AWAY**2 * _LEFT**3 / 2)


@dataclass(frozen=True)
class Segment:
    """A piece of line whose curvature, cant and gradient change linearly from a first to a last value.

    Parameters
    ----------
    length : float
        Length [m], above 0.
    curvature : tuple of float
        First and last curvature [1/m].
    cant : tuple of float
        First and last cant [m].
    gradient : tuple of float
        First and last gradient [1].

    Raises
    ------
    ValueError
        If the length is not above 0, or a value is not finite.
    """

    length: float
    curvature: tuple[float, float] = (0.0, 0.0)
    cant: tuple[float, float] = (0.0, 0.0)
    gradient: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        sizes = (self.length, *self.curvature, *self.cant, *self.gradient)
        if not all(isinstance(size, Real) and math.isfinite(size) for size in sizes) or not self.length > 0.0:
            raise ValueError(f"A segment is {self.length!r} m long; give each a length above 0 m, and finite numbers.")

    @property
    def ends(self) -> np.ndarray:
        """Values at both ends, shape (2, 3)."""
        return np.array([self.curvature, self.cant, self.gradient]).T

    @property
    def slopes(self) -> np.ndarray:
        """Changes of the values per metre, shape (3,)."""
        first, last = self.ends
        return np.asarray((last - first) / self.length)


def straight(length: float, gradient: float = 0.0) -> Segment:
    """Return straight track.

    Parameters
    ----------
    length : float
        Length [m], above 0.
    gradient : float
        Rise per metre [1].

    Returns
    -------
    Segment
        The segment.

    Raises
    ------
    ValueError
        If the length is not above 0.
    """
    return Segment(length, gradient=(gradient, gradient))


def arc(length: float, radius: float, cant: float = 0.0, gradient: float = 0.0, *, adverse: bool = False) -> Segment:
    """Return a curve of one radius.

    Parameters
    ----------
    length : float
        Length [m], above 0.
    radius : float
        Radius [m], positive for a curve to the left.
    cant : float
        Cant [m], with the sign of the radius that it suits.
    gradient : float
        Rise per metre [1].
    adverse : bool
        Whether the cant may have the other sign than the radius.

    Returns
    -------
    Segment
        The segment.

    Raises
    ------
    ValueError
        If the radius is 0 m or not a number, the length not above 0, or the cant adverse although not allowed.
    """
    if not isinstance(radius, Real) or radius == 0.0 or math.isnan(radius):
        raise ValueError(f"The radius of an arc must be a number other than 0 m; got {radius!r}. Use straight().")
    if isinstance(cant, Real) and math.isfinite(radius) and cant * radius < 0.0 and not adverse:
        raise ValueError(
            f"The cant of an arc must have the sign of its radius, {radius:g} m, to suit it; got {cant:g} m. Give "
            f"{-cant:g} m, or adverse=True for adverse cant."
        )
    return Segment(length, (1 / radius, 1 / radius), (cant, cant), (gradient, gradient))


def clothoid(length: float, before: Segment, behind: Segment) -> Segment:
    """Return the transition between two segments, with its cant ramp and, if gradients differ, a vertical curve.

    Parameters
    ----------
    length : float
        Length of the transition [m].
    before, behind : Segment
        The segments before and after it.

    Returns
    -------
    Segment
        The segment.

    Raises
    ------
    TypeError
        If `before` or `behind` is not a segment.
    ValueError
        If the length is not above 0.
    """
    if not (isinstance(before, Segment) and isinstance(behind, Segment)):
        raise TypeError("A clothoid must have a length and two segments, that before it and that behind it.")
    (*_, first), (last, *_) = before.ends, behind.ends
    return Segment(length, *(tuple(pair) for pair in zip(first.tolist(), last.tolist(), strict=True)))


@dataclass(frozen=True, eq=False)
class Line:
    """A line by rows. Lines with equal rows are equal.

    Parameters
    ----------
    rows : mapping of str to array, shape (n,)
        Columns of LINE by name, each in its unit. The distance is required. A missing column has its neutral value.

    Raises
    ------
    TypeError, KeyError, ValueError
        If no line file may have these rows (docs/line.md). The message gives column, row from 1, value and limit.
    """

    rows: dict[str, np.ndarray] = field(repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "rows", checked_rows(self.rows))

    @classmethod
    def of_any_size(cls, rows: dict[str, np.ndarray]) -> Line:
        """Return a line of valid rows, without a check of the limits of their columns.

        Parameters
        ----------
        rows : dict of str to array, shape (n,)
            Columns of LINE by name, each in its unit.

        Returns
        -------
        Line
            The line.
        """
        line = object.__new__(cls)
        object.__setattr__(line, "rows", rows)
        return line

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Line) and self._content == other._content

    def __hash__(self) -> int:
        return hash(self._content)

    @property
    def _content(self) -> frozenset[tuple[str, bytes]]:
        return frozenset((name, np.asarray(values, float).tobytes()) for name, values in self.rows.items())

    @property
    def length(self) -> float:
        """Distance from the first row to the last [m]."""
        return float(self.rows["distance"][-1] - self.rows["distance"][0])

    def value(self, name: str, distance: np.ndarray | float, order: int = 0) -> np.ndarray:
        """Return a column at places as models read it (docs/line.md), or one of its derivatives along them.

        The column is linear between rows. Corners are rounded over ROUNDING on either side of a row. A missing column
        has its neutral value.

        Parameters
        ----------
        name : str
            A column of LINE.
        distance : float or array
            Places [m].
        order : int
            Order of the derivative, 0 to 2.

        Returns
        -------
        ndarray
            Values in the shape of `distance`, in the unit of the column over m^order.

        Raises
        ------
        KeyError
            If `name` is not a column.
        ValueError
            If `order` is not 0, 1 or 2.
        """
        if name not in NAMES:
            raise KeyError(f"A line's columns must be of {', '.join(NAMES)}; got {name!r}. Give one of these.")
        if order not in (0, 1, 2):
            raise ValueError(f"The order of a derivative must be 0, 1 or 2; got {order!r}. Give one of these.")
        s, at = self.rows["distance"], np.asarray(distance, float)
        values = self.rows.get(name, np.full(s.size, float(name in FRICTIONS)))
        row = np.clip(np.searchsorted(s, at, "right") - 1, 0, s.size - 2)
        width, gain = np.diff(s)[row], np.diff(values)[row]
        over = np.clip(at - s[row], 0.0, width)
        found = [values[row] + over * gain / width, gain / width, np.zeros_like(over)][order]
        if name not in FRICTIONS:
            reaches, slopes, bends = rounded(s, values, name not in INTEGRATED)
            basis = CUBIC if name in INTEGRATED else QUINTIC
            for end, place, sign in ((row, over, 1.0), (row + 1, width - over, -1.0)):
                reach = reaches[row + 1]
                share = np.minimum(place / reach, 1.0)
                by_slope, by_bend = (part.deriv(order)(share) if order else part(share) for part in basis)
                steeper = sign * (slopes[end] - gain / width) * reach * by_slope
                found = found + (steeper + bends[end] * reach**2 * by_bend) * (sign / reach) ** order
        beyond = (at < s[0]) | (at > s[-1])
        return np.where(beyond & ((order > 0) | (name == "curvature")), 0.0, found)

    @property
    def has_friction(self) -> bool:
        """True if the line has a map of friction."""
        return any(name in self.rows for name in FRICTIONS)

    def with_friction(self, distance: ArrayLike, left: ArrayLike, right: ArrayLike | None = None) -> Line:
        """Return the line with factors on the friction of its rails; before and behind the places they are constant.

        Parameters
        ----------
        distance : array_like, shape (n,)
            Places in ascending order [m]. Factors are linear between them. Two equal places are a jump, which is spread
            over JUMP behind them.
        left, right : array_like, shape (n,)
            Factors on the friction of each rail at the places [1]; right: by default as left.

        Returns
        -------
        Line
            The line with rows at these places too.

        Raises
        ------
        ValueError
            If the places are not in order or not on the line, or if a factor is not finite or outside its limits.
        """
        at, factors = _map_of(distance, left, left if right is None else right)
        own = self.rows["distance"]
        if not (own[0] <= at[0] and at[-1] <= own[-1]):
            raise ValueError(
                f"Places of friction must be on the line, from {own[0]:.12g} to {own[-1]:.12g} m; got {at[0]:.12g} to "
                f"{at[-1]:.12g} m. Lengthen the line, or leave places out."
            )
        behind = np.searchsorted(own, at)
        gaps = np.minimum(np.abs(at - own[behind - 1]), np.abs(own[np.minimum(behind, own.size - 1)] - at))
        rows = np.sort([*own, *at[gaps >= LINE.least_growth]])
        columns = {"distance": rows, **{name: np.zeros_like(rows) for name in ("curvature", "cant", "gradient")}}
        columns |= {name: np.interp(rows, own, values) for name, values in self.rows.items() if name != "distance"}
        return Line(
            columns | {name: np.interp(rows, at, factor) for name, factor in zip(FRICTIONS, factors, strict=True)}
        )

    def breaks(self) -> np.ndarray:
        """Return the places between which every column is one polynomial: rows, and where rounding ends.

        Returns
        -------
        ndarray
            Places in ascending order [m].
        """
        s = self.rows["distance"]
        far = np.diff(s) > 2 * ROUNDING
        return np.sort(np.concatenate([s, s[:-1][far] + ROUNDING, s[1:][far] - ROUNDING]))

    def write(self, path: str | Path) -> Path:
        """Write the file that a kernel reads, with all digits of each number.

        Parameters
        ----------
        path : str or Path
            The file.

        Returns
        -------
        Path
            The file.

        Raises
        ------
        StorageError
            If it cannot be written; an OSError.
        """
        place = Path(path)
        write_whole(place, self.text.encode(), synced=False)
        return place

    @property
    def text(self) -> str:
        """Content of that file, with each column that it must have."""
        level = {column.name: np.zeros(self.rows["distance"].size) for column in LINE.columns if column.required}
        whole = Line.of_any_size(level | self.rows)
        return "\n".join(whole.lines_of([name for name in NAMES if name in whole.rows])) + "\n"

    def lines_of(self, names: Sequence[str]) -> list[str]:
        """Return the lines of that file with only these columns.

        Parameters
        ----------
        names : sequence of str
            Columns that the line has.

        Returns
        -------
        list of str
            The head, then one text for each row.
        """
        table = np.column_stack([self.rows[name] for name in names]).tolist()
        return [",".join(names), *(",".join(map(repr, row)) for row in table)]

    def mirrored(self) -> Line:
        """Return the line with left and right exchanged.

        Returns
        -------
        Line
            The mirrored line.
        """
        rows = {name: -values if name in ("curvature", "cant") else values for name, values in self.rows.items()}
        swapped = dict(rows)
        for name in rows:
            side, _, rest = name.partition("_")
            if side in ("left", "right"):
                other = {"left": "right", "right": "left"}[side]
                sign = -1.0 if rest == "lateral" else 1.0
                swapped.pop(name, None)
                swapped[name] = sign * rows.get(f"{other}_{rest}", np.zeros_like(rows["distance"]))
        return Line({name: swapped[name] for name in NAMES if name in swapped})


def _map_of(distance: ArrayLike, *factors: ArrayLike) -> tuple[np.ndarray, list[np.ndarray]]:
    """Return places with jumps spread over JUMP, and the factors there. Raises ValueError."""
    try:
        at, *values = (np.atleast_1d(np.asarray(one, float)) for one in (distance, *factors))
    except (TypeError, ValueError):
        raise ValueError("Places and factors of friction must be numbers; got others. Correct them.") from None
    if at.ndim != 1 or at.size == 0 or any(one.shape != at.shape for one in values):
        raise ValueError(
            f"Friction along a line must have at least one place, and as many factors for each rail; got {at.size} "
            f"places, and {' and '.join(str(one.size) for one in values)} factors. Correct them."
        )
    [of] = (column for column in LINE.columns if column.name == FRICTIONS[0])
    for name, one in zip(("Places", *("Factors",) * len(values)), (at, *values), strict=True):
        low, high = (-np.inf, np.inf) if one is at else (of.minimum, of.maximum)
        wrong = np.flatnonzero(~(np.isfinite(one) & (one >= low) & (one <= high)))
        if wrong.size:
            limits = "finite" if one is at else f"from {low:g} to {high:g}"
            raise ValueError(
                f"{name} of friction must be {limits}; got {one[wrong[0]]:g} as number {wrong[0] + 1}. Correct it."
            )
    at = at + JUMP * np.r_[False, np.diff(at) == 0.0]
    short = np.flatnonzero(~(np.diff(at) >= LINE.least_growth))
    if short.size:
        raise ValueError(
            f"Places of friction must ascend, with at most two equal ones; got {at[short[0] + 1]:.12g} m after "
            f"{at[short[0]]:.12g} m. Sort them."
        )
    return at, values


def rounded(distance: np.ndarray, values: np.ndarray, bending: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the reach of corners on either side of each row [m], slope [1/m] and bend [1/m2] at each row.

    bending: true for quintics. Cubics need no bends. Reaches have one more value, beyond either end of the line. As in
    table_pieces.c, curves do not leave the values of the neighbouring rows: Fritsch and Carlson (1980), Monotone
    piecewise cubic interpolation, SIAM J. Numer. Anal. 17.
    """
    width = np.diff(distance)
    meets = np.pad(width <= 2 * ROUNDING, 1)
    reach = np.where(meets, np.pad(width, 1), ROUNDING)
    straight = np.pad(np.diff(values) / width, 1)
    (left, right), (before, behind) = (reach[:-1], reach[1:]), (straight[:-1], straight[1:])
    slope = np.where(before * behind > 0.0, (before * right + behind * left) / (left + right), 0.0)
    if not bending:
        most = 3.0 * np.minimum(np.abs(before), np.abs(behind))
        return reach, np.clip(slope, -most, most), np.zeros_like(slope)
    first = np.where(meets, np.append(0.0, slope), straight)[:-1]
    last = np.where(meets, np.append(slope, 0.0), straight)[1:]
    ahead, back = (6 * behind - 4 * slope - 2 * last) / right, (2 * first + 4 * slope - 6 * before) / left
    most, turn = 4.0 * np.abs(behind - before) / (left + right), 4.0 * np.abs(slope)
    low = np.maximum(np.where(behind > 0.0, -turn / right, -most), np.where(before < 0.0, -turn / left, -most))
    high = np.minimum(np.where(behind < 0.0, turn / right, most), np.where(before > 0.0, turn / left, most))
    bend = np.clip((back * right + ahead * left) / (left + right), np.maximum(low, -most), np.minimum(high, most))
    bend[(before == 0.0) | (behind == 0.0)] = 0.0
    share = np.minimum(share_of_end(before, slope, -bend, left), share_of_end(behind, slope, bend, right))
    return reach, share * slope, share * bend


def share_of_end(straight: np.ndarray, slope: np.ndarray, bend: np.ndarray, reach: np.ndarray) -> np.ndarray:
    """Return the share of slope and bend that the end of a quintic may have next to a straight line of another slope.

    Dougherty, Edelman and Hyman (1989), Mathematics of Computation 52.
    """
    m = np.sign(straight) * slope
    n = m + np.sign(straight) * bend * reach / 4
    need = np.maximum.reduce([(m + n) / 5, m / 2.5, (3 * m + 2 * n) / 10, (5 * m + 2 * n) / 15])
    return np.minimum(np.abs(straight) / np.maximum(need, 1e-300), 1.0)


def read_line(path: Path) -> Line:
    """Return the line in a file, by the rules of the kernel that reads it (fmu_src/runtime/table_file.c, line.c)."""
    table = read_table(path, LINE.columns)
    table.check_rows()
    table.check_growth("distance", LINE.least_growth)
    curvature, ways = np.abs(table.numbers["curvature"]), np.diff(table.numbers["distance"])
    turns = (curvature[1:] + curvature[:-1]) / 2.0 * ways
    for row in np.flatnonzero(turns > WHOLE_TURN)[:1].tolist():
        text = f"the line turns by {turns[row]:.3g} rad over the {ways[row]:.6g} m from the row before"
        raise table.refusal(row + 1, "curvature", f"{text}; give rows between, for {WHOLE_TURN:g} rad at most.")
    parts = np.maximum(np.ceil(np.maximum(curvature[1:], curvature[:-1]) * ways / LARGEST_TURN), 1.0).astype(int)
    if not parts.sum() < MOST_OF_FILE:
        raise FileError(f"{path} must have at most {MOST_OF_FILE} rows, with those added in curves. Split it.")
    rows = table.numbers
    return Line({name: _divided(one, parts) for name, one in rows.items()} if parts.max() > 1 else rows)


def _divided(values: np.ndarray, parts: np.ndarray) -> np.ndarray:
    """Return values with linear ones between them, as many parts from row to row as given."""
    part = np.arange(1, parts.sum() + 1) - np.repeat(np.cumsum(parts) - parts, parts)
    many, first, last = np.repeat(parts, parts), np.repeat(values[:-1], parts), np.repeat(values[1:], parts)
    return np.append(values[:1], np.where(part == many, last, first + part / many * (last - first)))


def line_of(segments: Iterable[Segment], start: float = 0.0) -> Line:
    """Return a line of consecutive segments. Joints between segments of equal slopes are removed.

    Corners and jumps are rounded over ROUNDING on either side.

    Parameters
    ----------
    segments : iterable of Segment
        The segments in their order.
    start : float
        Distance at the start of the first one [m].

    Returns
    -------
    Line
        The line, with rows at most ROW_DISTANCE apart.

    Raises
    ------
    TypeError
        If `segments` is not a list of segments.
    ValueError
        If a segment is shorter than the rounding at both its ends, or `start` is not finite.
    """
    given = [] if isinstance(segments, Segment) else list(segments)
    if isinstance(segments, Segment) or not all(isinstance(one, Segment) for one in given):
        raise TypeError("The segments of a line must be a list, such as line_of([straight(100), arc(200, 400)]).")
    if not isinstance(start, Real) or not math.isfinite(start):
        raise ValueError(f"The start of a line must be a finite distance [m]; got {start!r}. Give a number.")
    pieces = joined(given)
    joints = start + np.concatenate([[0.0], np.cumsum([piece.length for piece in pieces])])
    distances, values = [joints[0]], [pieces[0].ends[0]]
    for number, piece in enumerate(pieces):
        first, last = joints[number], joints[number + 1]
        inner = (first + ROUNDING if number else first), (last - ROUNDING if number + 1 < len(pieces) else last)
        steepest = float(np.max(np.abs(piece.ends[:, 0])))
        count = max(math.ceil((inner[1] - inner[0]) / min(ROW_DISTANCE, ROW_TURN / max(steepest, 1e-12))), 1)
        if len(distances) + count > MOST_ROWS:
            raise ValueError(
                f"A line must have at most {MOST_ROWS} rows; this one has more than {len(distances) + count}, one for "
                f"each {ROW_DISTANCE:g} m and {ROW_TURN:g} rad. Give shorter segments, in metres, or larger radii."
            )
        within = np.linspace(*inner, count + 1)[0 if number else 1 :]
        distances += within.tolist()
        values += list(piece.ends[0] + np.outer(within - first, piece.slopes))
        if number + 1 < len(pieces):
            distances.append(last)
            values.append((piece.ends[1] + pieces[number + 1].ends[0]) / 2)
    _check_segments(given)
    curvature, cant, gradient = np.array(values).T
    return Line(dict(zip(NAMES, (np.array(distances), curvature, cant, gradient), strict=False)))


def _check_segments(segments: Sequence[Segment]) -> None:
    """Raise ValueError for the first segment with a value that a line may not have; rows at joints have means."""
    for number, segment in enumerate(segments, 1):
        for column, pair in zip(LINE.columns[1:4], segment.ends.T.tolist(), strict=True):
            value = max(pair, key=abs)
            if not column.minimum <= value <= column.maximum:
                unit = "" if column.unit == "1" else f" {column.unit}"
                tells = f" (a radius of {1 / value:.4g} m)" if column.name == "curvature" else ""
                raise ValueError(
                    f"A line's {column.name} must be from {column.minimum:g} to {column.maximum:g}{unit}; got "
                    f"{value:.6g}{unit}{tells} in segment {number}. Check value and unit."
                )


def joined(segments: Sequence[Segment]) -> list[Segment]:
    """Return the segments, with each one that continues the one before joined to it. ValueError: see `line_of`."""
    if not segments:
        raise ValueError("A line must have at least one segment; got none.")
    found = [segments[0]]
    for before, segment in pairwise(segments):
        meets = np.allclose(before.ends[1], segment.ends[0], rtol=1e-12, atol=1e-15)
        if meets and np.allclose(before.slopes, segment.slopes, rtol=1e-9, atol=1e-15):
            whole = found.pop()
            ends = zip(whole.ends[0].tolist(), segment.ends[1].tolist(), strict=True)
            segment = Segment(whole.length + segment.length, *(tuple(pair) for pair in ends))
        found.append(segment)
    for segment in found:
        if len(found) > 1 and not segment.length > 2 * ROUNDING:
            raise ValueError(f"A segment is {segment.length:g} m long; corners are rounded over {2 * ROUNDING:g} m.")
    return found

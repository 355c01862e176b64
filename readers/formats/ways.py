"""Ways of maps and receivers in degrees, and their points in the order of a route."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from readers.formats.line_tracks import route_of
from readers.import_account import Account
from readers.text import FileError, shown

Numbers = NDArray[np.float64]
#: Ends that are one place [m]. Most points and ways.
JOINED, MOST_POINTS, MOST_WAYS = 1.0, 200_000, 10_000
#: Radius by which small distances are measured [m]. Places of degrees that make two points one: 1 cm.
EARTH, DIGITS = 6.371e6, 7
#: Largest latitude and longitude [degrees]; beyond 180 where a line crosses the date line.
LATITUDE, LONGITUDE = 89.0, 360.0


@dataclass(frozen=True, eq=False)
class Way:
    """A way: its points with latitude and longitude [degrees] and height [m], shape (n, 3); NaN: unknown height."""

    name: str
    places: Numbers
    title: str = ""
    tags: Mapping[str, str] = field(default_factory=dict)

    @property
    def length(self) -> float:
        """Length on a sphere [m]."""
        return float(np.sum(np.linalg.norm(np.diff(on_sphere(self.places), axis=0), axis=1)))

    def __str__(self) -> str:
        """Return the way for a message."""
        return f"{shown(self.name)} ({f'{shown(self.title)}, ' if self.title else ''}{self.length / 1e3:.3g} km)"


@dataclass(frozen=True, eq=False)
class Course:
    """The points of a route in their order, shape (n, 3) as in `Way`.

    Attributes
    ----------
    stretches : list
        First and last point, tags and whether the way is run backwards, for each way.
    recorded : bool
        Whether a receiver recorded the points; otherwise they are drawn on a map.
    """

    source: str
    places: Numbers
    stretches: Sequence[tuple[int, int, Mapping[str, str], bool]]
    recorded: bool
    account: Account


def way_of(
    name: str, points: Sequence[Sequence[float]], source: str, title: str = "", tags: Mapping[str, str] | None = None
) -> Way | None:
    """Return a way, None if it has one place only. Raises FileError for wrong degrees.

    Takes points: latitude, longitude [degrees], height [m]; NaN if unknown.
    """
    places = np.array(points, float).reshape(-1, 3)
    for column, word, most in ((0, "latitude", LATITUDE), (1, "longitude", LONGITUDE)):
        for row in np.flatnonzero(~(np.abs(places[:, column]) <= most))[:1]:
            raise FileError(
                f"{source}, {shown(name)}, point {row + 1}: {word} must be from {-most:g} to {most:g} degrees; got "
                f"{places[row, column]:.10g}. Check the order of latitude and longitude."
            )
    return Way(name, places, title, tags or {}) if np.any(places[1:, :2] != places[:-1, :2]) else None


def without_repetitions(way: Way) -> Way:
    """Return a way without points that repeat the one before."""
    moved = np.any(np.diff(np.round(way.places[:, :2], DIGITS), axis=0) != 0.0, axis=1)
    return replace(way, places=way.places[np.append(True, moved)])


def on_sphere(places: Numbers) -> Numbers:
    """Return points on a sphere [m], shape (n, 3), for distances of some metres."""
    latitude, longitude = np.radians(places[:, :2].T)
    level = np.cos(latitude)
    return EARTH * np.column_stack([level * np.cos(longitude), level * np.sin(longitude), np.sin(latitude)])


def recorded(ways: Sequence[Way], asked: Sequence[str], source: str, account: Account) -> Course:
    """Return the tracks of a receiver one after the other. Raises FileError if none is named of several."""
    check_size(ways, source)
    known = {way.name: way for way in ways}
    route = route_of({way.name: way.length for way in ways}, asked, source)
    return along([(known[name].places, known[name].tags, back) for name, back in route], source, True, account)


def check_size(ways: Sequence[Way], source: str) -> None:
    """Check the number of ways and points."""
    count = sum(len(way.places) for way in ways)
    if not ways or count > MOST_POINTS or len(ways) > MOST_WAYS:
        limit = f"1 to {MOST_WAYS} lines with at most {MOST_POINTS} different points"
        raise FileError(
            f"{source} must have {limit}; got {len(ways)} with {count}. Give another file, or a part of it."
        )


def along(
    runs: Sequence[tuple[Numbers, Mapping[str, str], bool]], source: str, recorded: bool, account: Account
) -> Course:
    """Return points, tags and directions of ways that follow each other as a course; joints are there once."""
    parts: list[Numbers] = []
    stretches, count = [], 0
    for places, tags, back in runs:
        places = places[::-1] if back else places
        joint = on_sphere(np.stack([parts[-1][-1] if parts else places[0], places[0]]))
        joins = bool(parts) and np.linalg.norm(joint[1] - joint[0]) <= JOINED
        parts.append(places[1:] if joins else places)
        stretches.append((count - int(joins), count + len(parts[-1]) - 1, tags, back))
        count += len(parts[-1])
    return Course(source, np.concatenate(parts), stretches, recorded, account)


def unique(names: Iterable[str]) -> list[str]:
    """Return names of which repeated ones have a number behind them."""
    counts: Counter[str] = Counter()
    found = []
    for name in names:
        counts[name] += 1
        found.append(name if counts[name] == 1 else f"{name} {counts[name]}")
    return found

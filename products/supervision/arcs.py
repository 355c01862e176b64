"""Braking curves of place over speed, exact: parabolas between steps of speed and of gradient, SUBSET-026, 3.13.8."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from products.supervision.arguments import at_least, check_shapes, numbers, of_type
from products.supervision.steps import Steps, is_empty, values_at
from readers.text import BadInputError, shown


@dataclass(frozen=True)
class Arcs:
    """Arcs of a braking curve in the order of speed.

    Parameters
    ----------
    places : ndarray
        Where each arc begins, at its lowest speed [m], shape (..., n).
    squares : ndarray
        Squares of these speeds [m2/s2], ascending, shape (..., n).
    decelerations : ndarray
        Decelerations of the arcs [m/s2], shape (..., n). An arc with one of 0 or less reaches no higher speed.
    """

    places: np.ndarray
    squares: np.ndarray
    decelerations: np.ndarray

    def place_at(self, speed: np.ndarray | float) -> np.ndarray:
        """Return the place at which the curve has a speed.

        Takes speed [m/s] (..., m); returns [m] (..., m).
        """
        square = np.atleast_1d(at_least("speed", speed, 0.0, "m/s")) ** 2
        arc = (square[..., :, None] >= self.squares[..., None, :]).sum(axis=-1) - 1
        place, begins, brake = self._at(np.maximum(arc, 0))
        lost = square - begins
        braked = place - np.maximum(lost, 0.0) / np.where(brake > 0.0, 2.0 * brake, 1.0)
        return np.where((brake > 0.0) | (lost <= 0.0), braked, -np.inf)

    def speed_at(self, place: np.ndarray | float) -> np.ndarray:
        """Return the speed of the curve at a place.

        Takes place [m] (..., m); returns [m/s] (..., m).
        """
        where = np.atleast_1d(at_least("place", place, -np.inf, "m"))
        arc = (where[..., :, None] <= self.places[..., None, :]).sum(axis=-1) - 1
        begins, square, brake = self._at(np.maximum(arc, 0))
        square = square + 2.0 * np.maximum(brake, 0.0) * (begins - where)
        return np.where(arc < 0, 0.0, np.sqrt(np.maximum(square, 0.0)))

    def _at(self, arc: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return place, square of speed and deceleration of arcs by their numbers, shape (..., m)."""
        return values_at(self.places, arc), values_at(self.squares, arc), values_at(self.decelerations, arc)


def braking_arcs(
    place: np.ndarray | float,
    speed: np.ndarray | float,
    brake: Steps,
    gradients: tuple[np.ndarray, np.ndarray],
    eased: Eased | None = None,
) -> Arcs:
    """Return the braking curve through a foot, to rest and to all higher speeds.

    Takes place [m] (...), speed [m/s] (...), brake [m/s2], gradients [m] (..., m).
    """
    of_type("brake", brake, Steps, "Give Steps(boundaries, values).")
    edges, slopes = _slopes_of(gradients)
    for name, value in {"place": place, "speed": speed}.items():
        array = numbers(name, value)
        if not np.all(np.isfinite(array)) or (name == "speed" and np.any(array < 0.0)):
            limit = "finite and at least 0" if name == "speed" else "finite"
            raise BadInputError(f"{name} must be {limit}; got {shown(array.tolist())}. Correct it.")
    if eased is not None:
        of_type("eased", eased, Eased, "Give Eased(uphill, downhill, permille), or None.")
    given = {"place": np.shape(place), "speed": np.shape(speed), "brake": brake.values.shape[:-1]}
    shape = check_shapes(given | {"gradients": edges.shape[:-1], "their values": slopes.shape[:-1]})
    known = (brake.boundaries, brake.values, edges, slopes)
    boundaries, brakes, edges, slopes = (np.broadcast_to(one, (*shape, one.shape[-1])) for one in known)
    walk = _Walk(boundaries, brakes, edges, slopes, eased)
    foot = np.broadcast_to(np.asarray(place, dtype=float), shape), np.broadcast_to(np.square(speed), shape)
    slower, faster = walk.from_foot(*foot, -1), walk.from_foot(*foot, +1)
    # Walked to rest, an arc is between its start and the next one: its lowest speed is at the next one.
    ends, arcs = slower[:0:-1], faster[:-1]
    places, squares = (np.stack([arc[n] for arc in (*ends, *arcs)], axis=-1) for n in (0, 1))
    return Arcs(places, squares, np.stack([arc[2] for arc in (*slower[-2::-1], *arcs)], axis=-1))


def _slopes_of(gradients: object) -> tuple[np.ndarray, np.ndarray]:
    """Return places and accelerations by gradients, if there is one acceleration more."""
    remedy = "Give (places, accelerations), such as ([], [0.0]) on level track."
    if not isinstance(gradients, tuple | list) or len(gradients) != 2:
        raise BadInputError(f"gradients must be two arrays; got {shown(gradients)}. {remedy}")
    given = gradients[0]  # empty on level track, also with leading axes of several trains
    places = np.asarray(given, dtype=float) if is_empty(given) else np.atleast_1d(numbers("gradients", given))
    slopes = np.atleast_1d(numbers("gradients", gradients[1]))
    if slopes.shape[-1] != places.shape[-1] + 1 or not (np.all(np.isfinite(places)) and np.all(np.isfinite(slopes))):
        raise BadInputError(
            f"gradients must be finite, one acceleration more than places; got {places.shape[-1]} places and "
            f"{shown(slopes.tolist())}. {remedy}"
        )
    if np.any(np.diff(places, axis=-1) < 0.0):
        raise BadInputError(f"Places of gradients must ascend; got {shown(places.tolist())}. Sort them.")
    return places, slopes


@dataclass(frozen=True)
class Eased:
    """The reduction of a driver's normal service brake on gradients, Kn times gradient: SUBSET-026, 3.13.6.4.

    Parameters
    ----------
    uphill, downhill : Steps
        Kn+ and Kn- by speed [m/s2 a permille], with the boundaries of the brake.
    permille : ndarray
        Gradients between the places of the curve [permille], shape (..., m + 1).
    """

    uphill: Steps
    downhill: Steps
    permille: np.ndarray

    def at(self, step: np.ndarray, part: np.ndarray) -> np.ndarray:
        """Return the deceleration that is missing [m/s2] in steps of speed and parts of the line."""
        gradient = _take(self.permille, part)
        return gradient * np.where(gradient > 0.0, _take(self.uphill.values, step), _take(self.downhill.values, step))


@dataclass(frozen=True)
class _Walk:
    """Steps of speed and of place, for a walk along a curve from one step to the next."""

    boundaries: np.ndarray
    brakes: np.ndarray
    edges: np.ndarray
    slopes: np.ndarray
    eased: Eased | None

    def from_foot(self, place: np.ndarray, square: np.ndarray, way: int) -> list[tuple[np.ndarray, ...]]:
        """Return starts and decelerations of the arcs, and the end of the last one; way 1: to higher speeds, back."""
        place, square = place.copy(), square.copy()
        speed = np.sqrt(square)[..., None]
        bounds = np.square(self.boundaries)
        # Up, a boundary at the speed is passed; down, it is ahead. The train comes from before a place.
        step = (self.boundaries <= speed if way > 0 else self.boundaries < speed).sum(axis=-1)
        part = (self.edges < place[..., None] if way > 0 else self.edges <= place[..., None]).sum(axis=-1)
        found: list[tuple[np.ndarray, ...]] = []
        for _ in range(self.boundaries.shape[-1] + self.edges.shape[-1] + 1):
            deceleration = _take(self.brakes, step) + _take(self.slopes, part)
            if self.eased is not None:
                deceleration = deceleration - self.eased.at(step, part)
            found.append((place.copy(), square.copy(), deceleration))
            to_edge, edge = self._next(self.edges, part, -way, np.inf * -way)
            to_bound, bound = self._next(bounds, step, way, np.inf if way > 0 else 0.0)
            brakes = deceleration > 0.0
            safe = np.where(brakes, deceleration, 1.0)
            with np.errstate(invalid="ignore"):
                by_edge, by_bound = np.abs(edge - place), np.abs(bound - square) / (2.0 * safe)
            first = by_edge < by_bound  # at an edge before a boundary of speed
            far = np.minimum(by_edge, by_bound)
            moves = brakes & np.isfinite(far)
            square = np.where(
                moves, np.where(first, square + way * 2.0 * safe * np.where(moves, far, 0.0), bound), square
            )
            place = np.where(moves, np.where(first, edge, place - way * np.where(moves, far, 0.0)), place)
            part = np.where(moves & first, part - way * to_edge, part)
            step = np.where(moves & ~first, step + way * to_bound, step)
        found.append((place, square, deceleration))
        return found

    def _next(self, bounds: np.ndarray, at: np.ndarray, way: int, end: float) -> tuple[np.ndarray, np.ndarray]:
        """Return 1 where there is a boundary in this direction, else 0, and the boundary, or `end`."""
        count = bounds.shape[-1]
        index = at if way > 0 else at - 1
        inside = (index >= 0) & (index < count)
        if not count:
            return np.zeros(at.shape, dtype=int), np.full(at.shape, end)
        return inside.astype(int), np.where(inside, _take(bounds, np.clip(index, 0, count - 1)), end)


def _take(values: np.ndarray, at: np.ndarray) -> np.ndarray:
    return values_at(values, at[..., None])[..., 0]

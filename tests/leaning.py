"""Check by the tangent stiffness at rest (linear statics) that a vehicle stands on its springs and on both rails."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rbd_model.vehicle.description import SuspensionElement, Vehicle, wheelset_name
from tests.balance import curve, parts
from tests.evidence.maximal.correspondence import bodies_of
from tests.evidence.maximal.joints import End, on_bodies, wrenches
from tests.evidence.maximal.statics import preloads

#: Displacement of the bodies for difference quotients of forces [m], [rad].
AWAY = 1e-4


@dataclass(frozen=True)
class Pushed:
    """Loads on a vehicle: its deceleration, and apparent gravity to the left and beyond g downwards, all in [m/s2].

    torque: brake torque of each wheelset, which reacts on its frame [N.m].
    """

    slowing: float = 0.0
    aside: float = 0.0
    down: float = 0.0
    torque: float = 0.0


class Springs:
    """Linearised forces and moments of all connections on each part, (6,), for small displacements from rest."""

    def __init__(self, vehicle: Vehicle) -> None:
        self.vehicle = vehicle
        zero = _Zero({f"{vehicle.bodies[0].name}_distance": 0.0})
        self.rest = bodies_of(vehicle, curve(), zero)
        self.names = list(self.rest)
        size = 6 * len(self.names)
        self.matrix, self.carried = np.zeros((size, size)), preloads(vehicle)
        for connection in vehicle.connections:
            places = np.concatenate([self.rows(name) for name in (connection.upper, connection.lower)])
            self.matrix[np.ix_(places, places)] += self.stiffness_of(connection)

    def rows(self, name: str) -> np.ndarray:
        """Return the row numbers of a part."""
        return 6 * self.names.index(name) + np.arange(6)

    def stiffness_of(self, connection: SuspensionElement) -> np.ndarray:
        """Return the derivatives of both ends' wrenches by both displacements, signed as a stiffness, (12, 12)."""
        columns = []
        for way in AWAY * np.eye(12):
            columns.append((self.wrench(connection, -way) - self.wrench(connection, way)) / (2 * AWAY))
        return np.column_stack(columns)

    def wrench(self, connection: SuspensionElement, way: np.ndarray) -> np.ndarray:
        """Return the wrenches of a connection on both of its displaced ends, (12,)."""
        bodies = [
            self.rest[name].displaced(part)
            for name, part in zip((connection.upper, connection.lower), (way[:6], way[6:]), strict=True)
        ]
        names = (connection.upper, connection.lower)
        axle = np.array([0.0, 0.0, self.vehicle.number(self.vehicle.wheelsets[0].mean_radius)])
        upper, lower = (
            End(body, self.rest[name].position - axle, name.startswith("wheelset"))
            for name, body in zip(names, bodies, strict=True)
        )
        still = _Zero({})
        carried = self.carried.get(connection.name, 0.0)
        return wrenches(self.vehicle, connection, (upper, lower), on_bodies((upper, lower)), carried, still)

    @property
    def free(self) -> np.ndarray:
        """Return the rows of the bodies that the wheelsets carry."""
        return np.concatenate([self.rows(body.name) for body in self.vehicle.bodies])

    def softest(self) -> float:
        """Return the smallest eigenvalue of the bodies' stiffness [N/m], [N.m/rad]; 0 or less means tipping over."""
        matrix = self.matrix[np.ix_(self.free, self.free)]
        return float(np.linalg.eigvalsh((matrix + matrix.T) / 2)[0])

    def least_load(self, pushed: Pushed) -> float:
        """Return the smallest share of its load at rest that any wheel keeps while the bodies lean."""
        vehicle, number = self.vehicle, self.vehicle.number
        gravity, given = number("gravity"), np.zeros(len(self.matrix))
        for name, (mass, inertia) in parts(vehicle).items():
            given[self.rows(name)[:3]] = mass * np.array([pushed.slowing, pushed.aside, -pushed.down])
            if name.startswith("wheelset"):
                given[self.rows(name)[4]] += inertia[1] * pushed.slowing / number("wheel_radius") - pushed.torque
        for wheelset in vehicle.wheelsets:
            given[self.rows(wheelset.reacts_on)[4]] += pushed.torque
        moved = np.zeros(len(given))
        moved[self.free] = np.linalg.solve(self.matrix[np.ix_(self.free, self.free)], given[self.free])
        on_parts = given - self.matrix @ moved
        least = np.inf
        for index, wheelset in enumerate(vehicle.wheelsets, 1):
            _, aside, up, roll, *_ = on_parts[self.rows(wheelset_name(index))]
            resting = sum(
                self.carried[one.name]
                for one in vehicle.carrying
                for _ in one.sides()
                if one.lower == wheelset_name(index)
            )
            load = resting + number(wheelset.mass) * gravity
            half = wheelset.pair.left.rail_half_distance
            # Moments are about the rails. A wheel carries half of the vertical load, plus or minus the share of the
            # moment.
            moment = abs(roll - aside * number(wheelset.mean_radius))
            least = min(least, ((load - up) / 2 - moment / (2 * half)) / (load / 2))
        return float(least)


class _Zero(dict):  # type: ignore[type-arg]
    """States that are 0 if they are not given."""

    def __missing__(self, name: str) -> float:
        return 0.0

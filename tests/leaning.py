"""Whether a vehicle stands on its springs and on both rails, by its tangent stiffness at rest: linear statics."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rbd_model.vehicle.description import SuspensionElement, Vehicle, wheelset_name
from tests.balance import curve, parts
from tests.maximal.correspondence import bodies_of
from tests.maximal.joints import End, on_bodies, wrenches
from tests.maximal.statics import preloads

#: By which bodies are displaced for differences of forces [m], [rad].
AWAY = 1e-4


@dataclass(frozen=True)
class Pushed:
    """What pushes a vehicle: it slows [m/s2], and apparent gravity pulls to the left and more than g down [m/s2].

    torque [N.m]: of the brake of each wheelset, which hangs in its frame.
    """

    slowing: float = 0.0
    aside: float = 0.0
    down: float = 0.0
    torque: float = 0.0


class Springs:
    """Forces and moments of all connections on all parts, (6,) each, by small displacements from rest, linear."""

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
        """Of a part."""
        return 6 * self.names.index(name) + np.arange(6)

    def stiffness_of(self, connection: SuspensionElement) -> np.ndarray:
        """Slopes of what it does to both ends by displacements of both, with the sign of a stiffness, (12, 12)."""
        columns = []
        for way in AWAY * np.eye(12):
            columns.append((self.wrench(connection, -way) - self.wrench(connection, way)) / (2 * AWAY))
        return np.column_stack(columns)

    def wrench(self, connection: SuspensionElement, way: np.ndarray) -> np.ndarray:
        """What it does to both ends that are displaced, (12,)."""
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
        """Rows of the bodies that wheelsets carry."""
        return np.concatenate([self.rows(body.name) for body in self.vehicle.bodies])

    def softest(self) -> float:
        """Smallest eigenvalue of the bodies' stiffness [N/m], [N.m/rad]: where it is not above 0, they tip over."""
        matrix = self.matrix[np.ix_(self.free, self.free)]
        return float(np.linalg.eigvalsh((matrix + matrix.T) / 2)[0])

    def least_load(self, pushed: Pushed) -> float:
        """Least share of its load at rest that a wheel keeps, as the bodies lean."""
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
            # Counted about the rails; a wheel's load is half of all less or more what the moment takes.
            moment = abs(roll - aside * number(wheelset.mean_radius))
            least = min(least, ((load - up) / 2 - moment / (2 * half)) / (load / 2))
        return float(least)


class _Zero(dict):  # type: ignore[type-arg]
    """States that are 0 but for those that are given."""

    def __missing__(self, name: str) -> float:
        return 0.0

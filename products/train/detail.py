"""A vehicle of a train in detail: which one, and its sizes for the row of the train."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from rbd_model.vehicle.description import Vehicle, size_of

#: Most wheelsets of a vehicle, as in detail.h.
MOST_WHEELSETS = 16


@dataclass(frozen=True)
class Detail:
    """The vehicle, as data and in words, its level of detail and contact model.

    `name`: of a built-in vehicle, or path of a vehicle file.
    `fmu`: name of the FMU with its equations, if they are not its own.
    `parameters`: values of its sizes.
    `resistance`: a, b, c of its file [SI]; None: those of the consist.
    `unused`: message about a part of its file without effect.

    Raises
    ------
    ValueError
        If it has no couplers, or too many wheelsets.
    """

    name: str
    level: int
    contact_model: int
    vehicle: Vehicle = field(repr=False, hash=False)
    fmu: str | None = None
    parameters: Mapping[str, Any] = field(default_factory=dict, repr=False, hash=False)
    resistance: tuple[float, float, float] | None = None
    profile_files: tuple[Path, ...] = ()
    unused: str = ""

    def __post_init__(self) -> None:
        ends = [pull.name for pull in self.vehicle.pulls]
        if ends != ["coupler_force_front", "coupler_force_rear"]:
            raise ValueError(
                f"detail must be a vehicle with a coupler at both ends; got {self.name}. Take another one."
            )
        if len(self.vehicle.wheelsets) > MOST_WHEELSETS:
            got = len(self.vehicle.wheelsets)
            raise ValueError(f"detail must have at most {MOST_WHEELSETS} wheelsets; got {got}. Take another vehicle.")

    def size(self, size: Any) -> float:
        """Return a size of its description [SI]."""
        return float(size_of(size, self.parameters))

    @property
    def radius(self) -> float:
        """Mean nominal radius of its wheels [m]."""
        return float(np.mean([self.size(wheelset.mean_radius) for wheelset in self.vehicle.wheelsets]))

    @property
    def mass(self) -> float:
        """Mass of bodies and wheelsets [kg]."""
        return sum(self.size(part.mass) for part in self.vehicle.parts)

    @property
    def rotating_mass(self) -> float:
        """Rotating mass, reduced to the rims, J / r^2 [kg]."""
        return sum(self.size(one.inertia[1]) / self.size(one.mean_radius) ** 2 for one in self.vehicle.wheelsets)

    @property
    def length(self) -> float:
        """Distance between its couplers [m]."""
        front, rear = (self.size(pull.place[0]) for pull in self.vehicle.pulls)
        return front - rear

    @property
    def coupler_height(self) -> float:
        """Height of the couplers above the centre of the body that carries them [m]; 0 for a point."""
        pull, body = self.vehicle.pulls[0], self.vehicle.bodies[0]
        return 0.0 if self.level == 1 else self.size(pull.place[2]) - self.size(body.height)

    @property
    def pulled_mass(self) -> float:
        """Mass that the couplers accelerate at once [kg]: 1 / (1 / m + h^2 / J) of the body (Newton, Euler)."""
        body = self.vehicle.bodies[0]
        if self.level == 1:
            return self.mass
        return 1.0 / (1.0 / self.size(body.mass) + self.coupler_height**2 / self.size(body.inertia[1]))

    @property
    def content(self) -> tuple[Any, ...]:
        """Return all that determines its answers."""
        return (
            self.level,
            self.contact_model,
            self.vehicle,
            self.fmu,
            sorted(self.parameters.items()),
            self.profile_files,
        )

    def columns(self) -> dict[str, float]:
        """Return the columns of a consist that it determines: mass [t], rotating mass [%], length [m], resistance."""
        found = {
            "mass": 1e-3 * self.mass,
            "rotating": 1e2 * self.rotating_mass / self.mass,
            "length": self.length,
        }
        names = ("resistance_a", "resistance_b", "resistance_c")
        return found | dict(zip(names, self.resistance or (), strict=bool(self.resistance)))

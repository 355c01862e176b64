"""The compiled fast model at level 3, contact model 2, and the oracle of the same vehicle."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fmu_src.kernel import Kernel, Library
from fmu_src.system import model_of
from rbd_model.contact.depth import Contact
from rbd_model.levels.spatial import spatial_vehicle
from rbd_model.track.irregularity import ballasted_track, irregular_track, section_5_3
from rbd_model.vehicle.description import Vehicle
from rbd_model.wheelset.yielding_rails import rows_of
from tests.evidence.maximal.correspondence import file_of, touching_rise
from tests.evidence.maximal.motion import Moving
from tests.evidence.maximal.oracle import Oracle
from tests.evidence.maximal.rails import STRAIGHT, Course, Curve, RailData, Rails, prisms
from tests.evidence.maximal.states import Snapshot
from tests.evidence.maximal.touch import touches
from tests.fmu_src.quick_library import quick_library

SIDES = {1: "left", -1: "right"}
#: Rounds of the search for the height at which a wheel touches its rail.
ROUNDS = 3
ENERGIES = ("kinetic_energy", "potential_energy")
POWERS = ("brake_power", "creep_power", "damping_power")


@dataclass(frozen=True)
class Answer:
    """Results of the fast model.

    `slope`: of the states, by name. `forces` [N], by wheelset and side: force of the rail on a wheel to the left and
    up; side 0: creep force along the track and lateral flange force of the axle. `rails` [N]: forces that accelerate
    the rails below an axle, to the left and each one up.
    """

    slope: dict[str, float]
    forces: dict[tuple[int, int], np.ndarray]
    rails: dict[int, np.ndarray]


class Machine:
    """A vehicle on straight track or on a line; equal wheels on equal rails. depth: contact model."""

    def __init__(self, vehicle: Vehicle, on_line: bool, depth: int = 2) -> None:
        self.vehicle, self.on_line, self.support = vehicle, on_line, ballasted_track()
        system = spatial_vehicle(vehicle, irregular_track(section_5_3()), Contact(depth), on_line)
        seen = [name for name in system.observables if name.startswith("force_") or name.endswith("_above")]
        system = system.with_outputs(list(dict.fromkeys([*ENERGIES, *POWERS, *seen])))
        self.names = list(system.states)
        self.library: Library = quick_library(model_of(system, 1e-7))
        side = vehicle.wheelsets[0].pair.left
        self.half_distance, self.curve = side.rail_half_distance, Curve(side.rail)

    def kernel(self, scene: Mapping[str, float], course: Course, folder: Path) -> Kernel:
        """Return an instance on the course, which is written to the folder."""
        line = {"line_file": file_of(course, folder / "line.csv")} if self.on_line else {}
        kernel = Kernel(self.library, **scene, **line)
        kernel.initialise()
        return kernel

    def answer(self, snapshot: Snapshot, folder: Path) -> Answer:
        """Evaluate the fast model at a state."""
        rows = {"friction": snapshot.scene.friction, "brake_torque": snapshot.scene.brake}
        rows["traction_torque"] = snapshot.scene.traction
        given = {f"{name}_{n}": value for name, row in rows.items() for n, value in enumerate(row, 1)}
        kernel = self.kernel(given, snapshot.course, folder)
        place = [snapshot.value[name] for name in self.names]
        kernel.arrive(0.0, place)
        forces = {}
        for number, _ in self.vehicle.numbered:
            for side, word in SIDES.items():
                aside, up = (kernel[f"{name}_{number}_{word}"] for name in ("lateral_force", "wheel_load"))
                forces[number, side] = np.array([-side * aside, up])
            forces[number, 0] = np.array([kernel[f"creep_force_{number}"], kernel[f"flange_force_{number}"]])
        slope = dict(zip(self.names, kernel.slopes_at(0.0, place), strict=True))
        moving = [self.support.track_rail_mass * count for count in (2, 1, 1)]
        rails = {
            number: moving * np.array([slope[f"{row}_speed"] for row in rows_of(number)])
            for number, _ in self.vehicle.numbered
            if self.on_line
        }
        return Answer(slope, forces, rails)

    def oracle(
        self, course: Course, base: float, rails: Callable[[Course, RailData], Rails] = prisms, **changes: object
    ) -> Oracle:
        """Return the oracle on the course; base [m]: height of level rails; rails: `prisms` or `swept`."""
        both = [self.rails(side, base, course, rails) for side in SIDES]
        held = np.zeros((2, 3))
        if self.on_line:
            lateral, vertical = (
                (getattr(self.support, f"track_{way}_stiffness"), getattr(self.support, f"track_{way}_damping"))
                for way in ("lateral", "vertical")
            )
            held = np.array([lateral, vertical, vertical]).T
        return Oracle(self.vehicle, (both[0], both[1]), course, below=held, **changes)  # type: ignore[arg-type]

    def rails(self, side: int, base: float, course: Course, kind: Callable[[Course, RailData], Rails]) -> Rails:
        """Return one of the two rails."""
        return kind(course, RailData(side, (self.half_distance, base), self.curve))

    def base(self, folder: Path) -> float:
        """Return the height of level rails in track axes [m], at which a centred wheelset begins to touch them."""
        still = {"initial_speed": 0.0, "left_rail_friction": 0.0, "right_rail_friction": 0.0}
        rise = touching_rise(self.kernel(still, STRAIGHT, folder), self.names)
        radius = self.vehicle.number(self.vehicle.wheelsets[0].mean_radius)
        oracle, height = self.oracle(STRAIGHT, 0.0), radius
        for _ in range(ROUNDS):
            body = Moving(np.array([0.0, 0.0, height]), np.eye(3), np.zeros(3), np.zeros(3))
            found = touches(body, oracle.wheel_of(1, 0), oracle.rails[0], oracle.grid)
            height += max(one.approach for one in found)
        return radius + rise - height

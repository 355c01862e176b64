"""Python counterpart of the live page's `Simulation`, with the kernel and the protection of Python."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from bogie_braking.live.lines import line_for
from bogie_braking.live.machines import MACHINES, YAW_PER_BRAKE_TORQUE, model_of
from bogie_braking.live.presets import DEFAULTS, PERIOD
from brake_controller.wheel_slide import APPLY, VENT
from fmu_src.compile import build_library
from fmu_src.kernel import Kernel, Library
from products.machine import FULL_PRESSURE
from products.protection.slide_protection import SlideProtection
from rbd_model.vehicle.description import size_of
from tests.encoder import Encoder

#: LEAVES (distance ahead and length [m], friction [1]) and RESTS [m/s] of the page.
AHEAD, LENGTH, LEAVES, RESTS = 25.0, 100.0, 0.05, 0.01


class Run:
    """One run of the page.

    start: settings as in a link, otherwise those of DEFAULTS; actions: step, control and value; resolution: of the
    timers of the wheel sensors [s].
    """

    def __init__(
        self, start: Mapping[str, Any], actions: Sequence[tuple[int, str, float]], folder: Path, resolution: float
    ) -> None:
        given = {**DEFAULTS, **start}
        machine = MACHINES[given["machine"]]
        vehicle = machine.braked.vehicle
        sizes = vehicle.parameters.values()
        self.along = [float(size_of(wheelset.along, sizes)) for wheelset in vehicle.wheelsets]
        self.radii = [float(size_of(wheelset.mean_radius, sizes)) for wheelset in vehicle.wheelsets]
        self.full_yaw = YAW_PER_BRAKE_TORQUE * machine.braked.full_torque
        self.numbers = range(1, len(self.along) + 1)
        spatial = given["level"] == 3
        slope = given["gradient"] / 1000
        self.gradient = 0.0 if spatial else slope
        self.friction, self.protected, self.uneven = given["friction"], bool(given["protection"]), given["uneven"] / 100
        self.actions = sorted(actions)
        self.kernel = Kernel(Library(build_library(model_of(given["machine"]))))
        self.kernel.set(level=given["level"], initial_speed=given["speed"] / 3.6, gradient=self.gradient)
        if given["mass"] != "":
            self.kernel.set(**{machine.mass[1]: 1e3 * given["mass"]})
        if spatial:
            line = line_for(given["curve"], slope).write(folder / "line.csv")
            self.kernel.set(lateral_irregularity=given["wave"] / 1e3, line_file=str(line))
        self.kernel.set(**{f"pressure_demand_{number}": 0.0 for number in self.numbers})
        self.kernel.initialise()
        self.lever, self.steps, self.vented = 0.0, 0, 0
        self.leaves: list[float] = []
        self.protection = SlideProtection()
        self.encoders = [Encoder(resolution=resolution) for _ in self.numbers]
        self.locked = [0] * len(self.along)
        self.valves: list[int] = [APPLY] * len(self.along)
        self.begun: float | None = None

    def act(self) -> None:
        """Carry out all actions that are due."""
        while self.actions and self.actions[0][0] <= self.steps:
            _, name, value = self.actions.pop(0)
            if name == "leaves":
                self.leaves.append(self.kernel["distance"] + self.along[0] + AHEAD)
            elif name == "lever":
                self.lever = value / 100
            else:
                assert name == "friction", name
                self.friction = value

    def friction_at(self, place: float) -> float:
        covered = any(begin <= place < begin + LENGTH for begin in self.leaves)
        return min(self.friction, LEAVES) if covered else self.friction

    def step(self) -> None:
        self.act()
        kernel, time = self.kernel, self.steps * PERIOD
        turned = [kernel[f"rotation_{number}"] for number in self.numbers]
        seen = [one.angular_velocity(time, angle) for one, angle in zip(self.encoders, turned, strict=True)]
        speeds = [radius * omega for radius, omega in zip(self.radii, seen, strict=True)]
        commands = self.protection.step(time, speeds)
        self.valves = commands if self.protected else [APPLY] * len(commands)
        self.vented += self.valves.count(VENT)
        distance = kernel["distance"]
        if self.begun is None and self.lever > 0:
            self.begun = distance
        elif self.begun is not None:
            self.locked = [
                count + (kernel[f"locked_{n}"] > 0.5) for count, n in zip(self.locked, self.numbers, strict=True)
            ]
        share = kernel["cylinder_pressure_1"] / FULL_PRESSURE
        kernel.set(gradient=self.gradient, yaw_torque_1=self.uneven * self.full_yaw * share)
        for number, along, valve in zip(self.numbers, self.along, self.valves, strict=True):
            inputs = {"pressure_demand": FULL_PRESSURE * self.lever, "valve": valve}
            inputs["friction"] = self.friction_at(distance + along)
            kernel.set(**{f"{one}_{number}": value for one, value in inputs.items()})
        kernel.step(time, PERIOD)
        self.steps += 1

    def stop(self) -> float:
        """Continue to rest and return the distance since braking [m]."""
        while self.begun is None or self.kernel["speed"] >= RESTS:
            self.step()
        return float(self.kernel["distance"] - self.begun)

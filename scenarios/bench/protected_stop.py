"""One stop of the bogie with a brake cylinder, an encoder and a valve on each wheelset, and a controller in between."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from brake_controller.sensors import Encoder
from brake_controller.wheel_slide import APPLY, ControllerError, Supervised, WheelSlideController
from rbd_model.parameters import tables_5_1_and_5_2
from scenarios.bench.braked_bogie import FULL_PRESSURE, FULL_TORQUE, NUMBERS, STANDING, BrakedBogie, brake_values
from scenarios.cosimulation.recording import Recording

#: Start of braking [s], and time [s] after which a run that still moves is ended.
BRAKE_START, LONGEST = 1.0, 300.0
#: Application and release of the cylinder with its dump valve [s]; assumed: common values of passenger stock.
APPLICATION_TIME, RELEASE_TIME = 2.0, 0.6
#: Volume of a cylinder [m3] (AAR, brake_data.csv of the sources) and gas constant times temperature of air [J/kg].
CYLINDER_VOLUME, GAS = 10.3e-3, 287.0 * 293.0


@dataclass(frozen=True)
class Settings:
    """How a stop is run: speed [m/s], controller's period and host step [s], encoder, and the brake.

    strength: torque over that of the full service brake; application_time [s] to 95 % of it.
    """

    speed: float = 25.0
    strength: float = 1.0
    application_time: float = APPLICATION_TIME
    period: float = 5e-3
    host_step: float = 5e-3
    pulses: int = 10000
    jitter: float = 0.0


@dataclass(frozen=True)
class ProtectedStop:
    """What a stop came to. `failure`: the sentence of a controller that failed, whose brake stayed applied."""

    series: Recording
    distance: float
    time: float
    failure: str
    parameters: Mapping[str, float] = field(default_factory=dict)

    def slip(self, number: int) -> np.ndarray:
        """Slip ratio of a wheelset: 0 rolling, 1 locked."""
        speed = np.maximum(self.series["speed"], 1e-9)
        return np.asarray(1.0 - self.series[f"wheel_speed_{number}"] / speed)

    def longest_lock(self, above: float) -> float:
        """Longest time that a wheelset was locked while the bogie ran faster than `above` [m/s], in s."""
        longest = 0.0
        for number in NUMBERS:
            locked = (self.series[f"wheel_speed_{number}"] == 0.0) & (self.series["speed"] > above)
            edges = np.flatnonzero(np.diff(np.concatenate([[0], locked.astype(int), [0]])))
            spans = edges[1::2] - edges[::2]
            longest = max(longest, float(spans.max(initial=0)) * self._interval())
        return longest

    def share_in_band(self, largest: float, above: float) -> float:
        """Share of the braked time above a speed [m/s] in which both wheelsets' slip is at most `largest`."""
        chosen = (self.series["speed"] > above) & (self.series["time"] > BRAKE_START)
        good = np.all([self.slip(number)[chosen] <= largest for number in NUMBERS], axis=0)
        return float(good.mean())

    def air(self) -> float:
        """Air that the cylinders took [kg]: every rise of pressure fills their volume, which is taken as constant."""
        rises = sum(np.maximum(np.diff(self.series[f"pressure_{number}"]), 0.0).sum() for number in NUMBERS)
        return float(rises) * CYLINDER_VOLUME / GAS

    def _interval(self) -> float:
        return float(self.series["time"][1] - self.series["time"][0])


def protected_stop(
    machine: BrakedBogie,
    rail: Mapping[str, float],
    controller: WheelSlideController | None,
    settings: Settings | None = None,
) -> ProtectedStop:
    """A stop on a rail (inputs and parameters of the bogie); without a controller the valves stay applied."""
    run = _Run(machine, rail, controller, settings or Settings())
    run.play()
    return ProtectedStop(Recording(COLUMNS, run.rows), run.distance, run.rows[-1][0], run.failure, dict(rail))


COLUMNS = {"time": "s", "speed": "m/s"} | {
    f"{name}_{number}": unit
    for number in NUMBERS
    for name, unit in (("wheel_speed", "m/s"), ("pressure", "Pa"), ("valve", "1"))
}
READ = ("speed", "rotation_1", "rotation_2", "angular_velocity_1", "angular_velocity_2")


@dataclass
class _Run:
    """One stop: what the controller and the record do at their period, while the master couples the FMUs."""

    machine: BrakedBogie
    rail: Mapping[str, float]
    controller: WheelSlideController | None
    settings: Settings
    rows: list[list[float]] = field(default_factory=list)
    commands: list[int] = field(default_factory=lambda: [APPLY] * len(NUMBERS))
    failure: str = ""
    distance: float = 0.0

    def __post_init__(self) -> None:
        settings = self.settings
        self.supervised = Supervised(self.controller, len(NUMBERS)) if self.controller else None
        self.encoders = [Encoder(settings.pulses, settings.jitter, number) for number in NUMBERS]
        self.radius = tables_5_1_and_5_2().wheel_radius
        self.machine.start(
            {"level": 2.0, "initial_speed": settings.speed} | dict(self.rail), [brake_of(settings)] * len(NUMBERS)
        )

    def play(self) -> None:
        """Host steps until the bogie stands; the controller is asked at its own period."""
        machine, settings = self.machine, self.settings
        every = max(1, round(settings.period / settings.host_step))
        number, braking = 0, False

        def drive(time: float) -> None:
            nonlocal number, braking
            if not braking and time >= BRAKE_START:
                braking = True
                machine.demand(FULL_PRESSURE)
            if number % every == 0:
                self._control(time)
            number += 1

        for _ in machine.coupling().run(LONGEST, settings.host_step, drive):
            speed, self.distance = machine.bogie.get(("speed", "distance"))
            if speed < STANDING:
                return

    def _control(self, time: float) -> None:
        """Asks the controller, and records."""
        speed, *turned = self.machine.bogie.get(READ)
        speeds = self._speeds(time, turned)
        if self.supervised and not self.failure:
            self._ask(self.supervised, time, speeds)
        row = [time, speed]
        for omega, brake, command in zip(turned[2:], self.machine.brakes, self.commands, strict=True):
            row += [self.radius * omega, brake["cylinder_pressure"], command]
        self.rows.append(row)

    def _speeds(self, time: float, turned: Sequence[float]) -> list[float]:
        """Circumferential speeds as the encoders see them [m/s]; at the first look the true one."""
        found = [
            self.radius * encoder.angular_velocity(time, rotation)
            for encoder, rotation in zip(self.encoders, turned[:2], strict=True)
        ]
        return [self.settings.speed] * len(found) if time == 0.0 else found

    def _ask(self, supervised: Supervised, time: float, speeds: Sequence[float]) -> None:
        """Sets the valves as the controller says; one that fails is not asked again, and its brake is applied."""
        try:
            commands = supervised.step(time, speeds)
        except ControllerError as error:
            self.failure, commands = str(error), [APPLY] * len(NUMBERS)
        for brake, before, now in zip(self.machine.brakes, self.commands, commands, strict=True):
            if now != before:
                brake.set(valve=now)
        self.commands = commands


def brake_of(settings: Settings) -> dict[str, float]:
    """Parameters of each cylinder."""
    values = brake_values() | {
        "application_time": settings.application_time,
        "release_time": RELEASE_TIME,
        "tolerance": 1e-6,
    }
    values["force_per_pressure"] *= settings.strength
    return values


def full_deceleration() -> float:
    """Deceleration of the full brake on a dry rail [m/s2], the wheelsets' rotation included."""
    p = tables_5_1_and_5_2()
    mass = p.frame_mass + 2 * p.wheelset_mass + 2 * p.wheelset_pitch_inertia / p.wheel_radius**2
    return 2 * FULL_TORQUE / p.wheel_radius / mass

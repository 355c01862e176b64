"""One stop of a machine with a cylinder, an encoder and a valve on each wheelset, and a controller in between."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from numbers import Real

import numpy as np

from brake_controller.sensors import TEETH
from brake_controller.wheel_slide import APPLY, ControllerError, NotJudgedError, Supervised, WheelSlideController
from fmu_src.cosimulation.recording import Recording
from fmu_src.system import other_unit
from products.protection.braked_machine import APPLICATION_TIME, STANDING, BrakedMachine
from products.protection.encoder import Encoder

#: Start of braking [s], and time [s] after which a run that still moves is ended.
BRAKE_START, LONGEST = 1.0, 300.0
#: A controller is asked at least so often [s], and no part of a run is shorter.
LONGEST_PERIOD, SHORTEST_PERIOD = 1.0, 1e-5
#: At most: speed at the start [m/s], torque over that of the full brake, time to full torque [s], teeth, and standard
#: deviation of a tooth's place, as a share of the pitch: above it teeth change places.
FASTEST, STRONGEST, SLOWEST_BRAKE, MOST_PULSES, MOST_JITTER = 100.0, 5.0, 60.0, 10_000, 0.5
LIMITS = {
    "speed": (FASTEST, "m/s"),
    "strength": (20.0 * STRONGEST, "1"),  # a brake that locks all wheels at once, to look at what they do then
    "application_time": (SLOWEST_BRAKE, "s"),
    "period": (LONGEST_PERIOD, "s"),
    "host_step": (LONGEST_PERIOD, "s"),
}
#: Volume of a cylinder [m3] (AAR, brake_data.csv of the sources) and gas constant times temperature of air [J/kg].
CYLINDER_VOLUME, GAS = 10.3e-3, 287.0 * 293.0


@dataclass(frozen=True)
class Settings:
    """How a stop is run: speed [m/s], controller's period and host step [s], encoder, and the brake.

    strength: torque over that of the full service brake; application_time [s] to 95 % of it. pulses, jitter: as
    `Encoder` has them. Raises ValueError for what cannot be.
    """

    speed: float = 25.0
    strength: float = 1.0
    application_time: float = APPLICATION_TIME
    period: float = 5e-3
    host_step: float = 5e-3
    pulses: int = TEETH
    jitter: float = 0.0

    def __post_init__(self) -> None:
        for name, (most, unit) in LIMITS.items():
            given = getattr(self, name)
            if not (isinstance(given, Real) and 0.0 < float(given) < math.inf):
                raise ValueError(f"Set {name} to a finite number above 0: it was {given!r}.")
            value = float(given)
            in_unit = "" if unit == "1" else f" {unit}"
            if value > most:
                hint = other_unit(value, unit, 0.0, most)
                raise ValueError(f"Set {name} to at most {most:g}{in_unit}: it was {value:g}{in_unit}.{hint}")
            if unit == "s" and value < SHORTEST_PERIOD:
                raise ValueError(f"Set {name} to at least {SHORTEST_PERIOD:g} s: it was {value:g} s.")
        if not (isinstance(self.pulses, Real) and self.pulses >= 1 and self.pulses == int(self.pulses)):
            raise ValueError(f"Set pulses to a whole number of at least 1: it was {self.pulses!r}.")
        if self.pulses > MOST_PULSES:
            raise ValueError(f"Set pulses to at most {MOST_PULSES}: it was {self.pulses}.")
        if not (isinstance(self.jitter, Real) and 0.0 <= float(self.jitter) < math.inf):
            raise ValueError(f"Set jitter to a finite value of at least 0: it was {self.jitter!r}.")
        if self.jitter > MOST_JITTER:
            raise ValueError(f"Set jitter to at most {MOST_JITTER:g} of the pitch: it was {self.jitter:g}.")


@dataclass(frozen=True)
class ProtectedStop:
    """What a stop came to.

    distance [m]: None where the machine still ran after LONGEST; end_speed [m/s] and time [s]: of the end of the run.
    failure: the sentence of a controller that failed, whose brake stayed applied. judged: False where it gave no answer
    for long; then nothing is said of the controller, and what it came to is NaN.
    """

    series: Recording
    numbers: tuple[int, ...]
    distance: float | None
    end_speed: float
    time: float
    failure: str
    parameters: Mapping[str, float] = field(default_factory=dict)
    judged: bool = True

    @property
    def words(self) -> str:
        """The stopping distance, or that there is none; and the sentence of a controller that failed."""
        if not self.judged:
            return f"not judged: {self.failure}"
        moves = f"did not stop: {self.end_speed:.1f} m/s after {self.time:.0f} s"
        found = moves if self.distance is None else f"{self.distance:.0f} m"
        return f"{found}, no stop of this controller: {self.failure}" if self.failure else found

    def note(self, source: str) -> str:
        """The source of a row of a table, which says so where the machine did not stop."""
        return source if self.distance is not None else f"{self.words}; {source}"

    def over(self, distance: float | None) -> float | None:
        """The stopping distance over another [m]; None where one of them is missing."""
        return None if self.distance is None or distance is None else self.distance / distance

    def slip(self, number: int) -> np.ndarray:
        """Slip ratio of a wheelset: 0 rolling, 1 locked."""
        speed = np.maximum(self.series["speed"], 1e-9)
        return np.asarray(1.0 - self.series[f"wheel_speed_{number}"] / speed)

    def longest_lock(self, above: float) -> float:
        """Longest time that a wheelset was locked while the vehicle ran faster than `above` [m/s], in s."""
        longest = 0.0 if self.judged else math.nan
        for number in self.numbers if self.judged else ():
            locked = (self.series[f"wheel_speed_{number}"] == 0.0) & (self.series["speed"] > above)
            edges = np.flatnonzero(np.diff(np.concatenate([[0], locked.astype(int), [0]])))
            spans = edges[1::2] - edges[::2]
            longest = max(longest, float(spans.max(initial=0)) * self._interval())
        return longest

    def count_of_commands(self) -> int:
        """At how many looks a valve was told anything but to apply."""
        return sum(int((self.series[f"valve_{number}"] != APPLY).sum()) for number in self.numbers)

    def locks(self, above: float) -> bool:
        """Whether every wheelset stood for most of the braked time in which the vehicle ran faster than `above`."""
        runs = self.braked(above)
        return all(np.mean(self.series[f"wheel_speed_{number}"][runs] == 0.0) > 0.5 for number in self.numbers)

    def share_in_band(self, largest: float, above: float) -> float:
        """Share of the braked time above a speed [m/s] in which all wheelsets' slip is at most `largest`."""
        if not self.judged:
            return math.nan
        chosen = self.braked(above)
        good = np.all([self.slip(number)[chosen] <= largest for number in self.numbers], axis=0)
        return float(good.mean())

    def braked(self, above: float) -> np.ndarray:
        """At which instants it was braked and faster than `above` [m/s]."""
        return np.asarray((self.series["speed"] > above) & (self.series["time"] > BRAKE_START))

    def air(self) -> float:
        """Air that the cylinders took [kg]: every rise of pressure fills their volume, which is taken as constant."""
        if not self.judged:
            return math.nan
        rises = sum(np.maximum(np.diff(self.series[f"pressure_{number}"]), 0.0).sum() for number in self.numbers)
        return float(rises) * CYLINDER_VOLUME / GAS

    def _interval(self) -> float:
        return float(self.series["time"][1] - self.series["time"][0])


def protected_stop(
    machine: BrakedMachine,
    rail: Mapping[str, float],
    controller: WheelSlideController | None,
    settings: Settings | None = None,
) -> ProtectedStop:
    """A stop on a rail (inputs and parameters of the vehicle); without a controller the valves stay applied."""
    run = _Run(machine, rail, controller, settings or Settings())
    run.play()
    series, numbers = Recording(columns(machine.machine.numbers), run.rows), machine.machine.numbers
    distance = run.distance if run.speed < STANDING and run.judged else None
    return ProtectedStop(series, numbers, distance, run.speed, run.time, run.failure, dict(rail), run.judged)


#: What is read of each wheelset.
READ = ("rotation", "angular_velocity", "creep_force", "axle_load")


def columns(numbers: Sequence[int]) -> dict[str, str]:
    """What is recorded, with units."""
    of_each = (("wheel_speed", "m/s"), ("pressure", "Pa"), ("valve", "1"), ("adhesion", "1"))
    of_all = {"time": "s", "speed": "m/s", "braking_force": "N"}
    return of_all | {f"{name}_{n}": unit for n in numbers for name, unit in of_each}


@dataclass
class _Run:
    """One stop: what the controller and the record do at their period, while the master couples the FMUs."""

    machine: BrakedMachine
    rail: Mapping[str, float]
    controller: WheelSlideController | None
    settings: Settings
    rows: list[list[float]] = field(default_factory=list)
    failure: str = ""
    judged: bool = True
    distance: float = 0.0
    speed: float = math.inf
    seen: Sequence[float] = ()
    time: float = 0.0

    def __post_init__(self) -> None:
        settings, machine = self.settings, self.machine.machine
        count = len(machine.numbers)
        self.commands = [APPLY] * count
        self.read = ("speed", "distance", *(f"{name}_{n}" for name in READ for n in machine.numbers))
        self.supervised = Supervised(self.controller, count) if self.controller else None
        self.encoders = [Encoder(settings.pulses, settings.jitter, number) for number in machine.numbers]
        self.radius = machine.parameters.wheel_radius
        brake = machine.brake_with(settings.application_time, settings.strength)
        self.machine.start({"level": 2.0, "initial_speed": settings.speed} | dict(self.rail), [brake] * count)

    def play(self) -> None:
        """Host steps until the bogie stands; the controller is asked at its own period."""
        machine, settings = self.machine, self.settings
        every = max(1, round(settings.period / settings.host_step))
        number, braking = 0, False
        self.seen = machine.vehicle.get(self.read)

        def drive(time: float) -> None:
            nonlocal number, braking
            if not braking and time >= BRAKE_START:
                braking = True
                machine.demand(machine.machine.full_pressure)
            if number % every == 0:
                self._control(time)
            number += 1

        for self.time in machine.coupling().run(LONGEST, settings.host_step, drive):
            self.seen = machine.vehicle.get(self.read)
            self.speed, self.distance = self.seen[:2]
            if self.speed < STANDING:
                return

    def _control(self, time: float) -> None:
        """Asks the controller, and records."""
        speed, _, *turned = self.seen
        count = len(self.encoders)
        speeds = self._speeds(time, turned[:count])
        if self.supervised and not self.failure:
            self._ask(self.supervised, time, speeds)
        rates, forces, loads = (turned[count * i : count * (i + 1)] for i in (1, 2, 3))
        row = [time, speed, -sum(forces)]
        wheelsets = zip(rates, forces, loads, self.machine.brakes, self.commands, strict=True)
        for omega, force, load, brake, command in wheelsets:
            row += [self.radius * omega, brake["cylinder_pressure"], command, -force / load]
        self.rows.append(row)

    def _speeds(self, time: float, turned: Sequence[float]) -> list[float]:
        """Circumferential speeds as the encoders see them [m/s]."""
        return [
            self.radius * encoder.angular_velocity(time, rotation)
            for encoder, rotation in zip(self.encoders, turned, strict=True)
        ]

    def _ask(self, supervised: Supervised, time: float, speeds: Sequence[float]) -> None:
        """Sets the valves as the controller says; one that fails is not asked again, and its brake is applied."""
        try:
            commands = supervised.step(time, speeds)
        except ControllerError as error:
            self.failure, commands = str(error), [APPLY] * len(self.encoders)
            self.judged = not isinstance(error, NotJudgedError)
        for brake, before, now in zip(self.machine.brakes, self.commands, commands, strict=True):
            if now != before:
                brake.set(valve=now)
        self.commands = commands

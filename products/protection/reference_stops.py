"""Reference stops: readings of sensors and the commands of the built-in protection, by which a port is checked.

Wheels and vehicle are computed with IEEE additions, multiplications and divisions only, so that the results of all
machines are bit-identical. This model exercises branches and does not measure distances; the test rig (rig.py) does.
Its numbers are assumed.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

from products.controller_kinds import OneInC
from products.protection.rig_in_c import slide_protection

#: Largest number of wheelsets of a stop, and of columns of the table.
MOST = 4
#: Acceleration of gravity [m/s2], mass on a wheelset over its rotating mass [1], step of the wheels at most [s].
GRAVITY, ROTATING, STEP = 9.81, 14.0, 1e-3
#: Shares of the full pressure: filled in a second; of the present one, vented in a second [1/s]. Begin of braking [s].
FILLING, VENTING, BRAKES_AT = 0.57, 3.0, 1.0
#: Deceleration of the full brake [m/s2]; slip speed of the best adhesion [m/s].
BRAKE, BEST = 1.3, 0.5


@dataclass(frozen=True)
class ReferenceStop:
    """A stop; adhesion: rows of time from which it holds [s], best value [1], share of it left at large slip [1].

    faults: rows of wheelset, kind (nan, zero, stuck, double), begin and end [s]. noise: half width of a uniform error,
    as a share of the speed. radii: assumed over true wheel radius, one for each wheelset.
    """

    name: str
    wheelsets: int = 2
    period: float = 0.01
    speed: float = 18.0
    lasts: float = 14.0
    adhesion: tuple[tuple[float, float, float], ...] = ((0.0, 0.06, 0.6),)
    faults: tuple[tuple[int, str, float, float], ...] = ()
    noise: float = 0.0
    radii: tuple[float, ...] = (1.0, 1.0, 1.0, 1.0)


@dataclass(frozen=True)
class Look:
    """Time [s], readings of all sensors [m/s], and commands of all valves (0 apply, 1 hold, 2 vent)."""

    time: float
    speeds: tuple[float, ...]
    valves: tuple[int, ...]


#: Adhesion that changes every few seconds, between good and bad rails.
PATCHES = (
    *((0.0, 0.2, 1.0), (3.0, 0.03, 0.3), (6.0, 0.25, 1.0), (10.5, 0.05, 0.7), (13.0, 0.25, 1.0), (17.0, 0.01, 0.9)),
    *((21.0, 0.25, 1.0), (25.0, 0.06, 0.2), (28.0, 0.12, 1.0), (30.0, 0.04, 0.5), (31.0, 0.1, 0.9), (33.0, 0.04, 0.3)),
)
#: Stops that reach the branches of the protection.
STOPS = (
    ReferenceStop("dry", adhesion=((0.0, 0.3, 1.0),), lasts=8.0, period=0.02),
    ReferenceStop("low"),
    ReferenceStop("falling", adhesion=((0.0, 0.07, 0.2),)),
    ReferenceStop("leaves", adhesion=((0.0, 0.02, 0.8),), lasts=16.0),
    ReferenceStop("drop", adhesion=((0.0, 0.15, 0.9), (4.0, 0.03, 0.5), (8.0, 0.2, 1.0))),
    ReferenceStop("slow", speed=4.0, adhesion=((0.0, 0.05, 0.4),), lasts=9.0),
    ReferenceStop("invalid", faults=((0, "nan", 4.0, 7.0),)),
    ReferenceStop("stuck", faults=((1, "stuck", 3.5, 8.0),)),
    ReferenceStop("zero", faults=((0, "zero", 4.0, 99.0),)),
    ReferenceStop("blind", faults=((1, "zero", 0.0, 99.0),)),
    ReferenceStop("double", faults=((0, "double", 4.0, 4.5),)),
    ReferenceStop("all invalid", faults=((0, "nan", 4.0, 6.0), (1, "nan", 4.2, 6.5))),
    ReferenceStop("one wheelset", wheelsets=1),
    ReferenceStop("four wheelsets", wheelsets=4, period=0.02, faults=((2, "nan", 5.0, 99.0),)),
    ReferenceStop("fast looks", period=0.004, lasts=6.0),
    ReferenceStop("slow looks", period=0.04),
    ReferenceStop("patches", speed=45.0, lasts=36.0, adhesion=PATCHES),
    ReferenceStop("noisy patches", wheelsets=4, period=0.02, speed=40.0, lasts=36.0, adhesion=PATCHES, noise=0.002),
    ReferenceStop("teeth", noise=0.012),
    ReferenceStop("radius", radii=(1.03, 1.0, 1.0, 1.0), adhesion=((0.0, 0.3, 1.0), (5.0, 0.05, 0.5))),
)


@lru_cache
def looks_of(stop: ReferenceStop) -> tuple[Look, ...]:
    """Return the looks of a stop with the built-in protection. Raises CompilerError."""
    controller = OneInC(slide_protection(), stop.wheelsets, stop.period)
    errors = _errors()
    speed, wheels = stop.speed, [stop.speed] * stop.wheelsets
    pressures, valves = [0.0] * stop.wheelsets, [0] * stop.wheelsets
    stored = [0.0] * stop.wheelsets
    looks = []
    for number in range(int(stop.lasts / stop.period + 0.5)):
        time = number * stop.period
        readings = []
        for place, wheel in enumerate(wheels):
            reading = wheel * stop.radii[place] * (1.0 + stop.noise * next(errors))
            kind = _fault(stop, place, time)
            stored[place] = stored[place] if kind == "stuck" else reading
            readings.append(_shown(kind, stored[place]))
        valves = controller.step(time, readings)
        looks.append(Look(time, tuple(readings), tuple(valves)))
        speed = _advance(stop, time, speed, wheels, pressures, valves)
    return tuple(looks)


def _errors() -> Iterator[float]:
    """Yield numbers from -1 to 1: a linear congruential generator (Knuth's MMIX)."""
    state = 1
    while True:
        state = (6364136223846793005 * state + 1442695040888963407) % 2**64
        yield (state >> 32) / 2.0**31 - 1.0


def _fault(stop: ReferenceStop, place: int, time: float) -> str:
    """Return the kind of failure of a sensor at a time [s], or ""."""
    found = [kind for one, kind, begin, end in stop.faults if one == place and begin <= time < end]
    return found[0] if found else ""


def _shown(kind: str, reading: float) -> float:
    """Return the reading of a sensor with this kind of failure [m/s]."""
    return {"nan": float("nan"), "zero": 0.0, "double": 2.0 * reading}.get(kind, reading)


def _advance(
    stop: ReferenceStop, time: float, speed: float, wheels: list[float], pressures: list[float], valves: list[int]
) -> float:
    """Advance wheels and pressures by a period; return the new speed of the vehicle [m/s]."""
    steps = int(stop.period / STEP + 0.999)
    size = stop.period / steps
    best, left = [(best, left) for begin, best, left in stop.adhesion if begin <= time][-1]
    demanded = 1.0 if time >= BRAKES_AT else 0.0
    for _ in range(steps):
        total = 0.0
        for place, command in enumerate(valves):
            change = (0.0, 0.0, -VENTING * pressures[place])[command] if command else FILLING
            pressures[place] = max(0.0, min(demanded, pressures[place] + size * change))
            slip = (speed - wheels[place]) / BEST
            share = 2.0 * slip / (1.0 + slip * slip) if slip < 1.0 else left + (1.0 - left) * 2.0 / (1.0 + slip * slip)
            adhesion = best * GRAVITY * share
            total += adhesion
            faster = wheels[place] + size * ROTATING * (adhesion - BRAKE * pressures[place])
            wheels[place] = max(0.0, faster)
        speed = max(0.0, speed - size * total / len(wheels))
    return speed

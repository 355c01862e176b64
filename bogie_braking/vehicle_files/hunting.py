"""Hunting of a vehicle file: modes and linear critical speed, and the lowest speed at which a large motion persists.

Straight smooth track at level 3 with contact model 2, with the profiles, springs and dampers of the file.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from fmu_src.kernel import Kernel, Library
from products.building import linear_kernel_of, linear_model
from products.kernel_runs import SETTLED, prepare
from products.vehicle_file import DataSheet
from rbd_model.contact.pair_file import PAIR_FILE, joined
from rbd_model.linear import Mode, critical_speed, oscillations

#: Speeds between which critical speeds are searched [m/s]: the upper limit is the largest initial speed of a vehicle.
#: Distance of the speeds at which the linear growth is computed [m/s].
SLOWEST, FASTEST, STEP = 10.0, 150.0, 5.0
#: Friction of the rails.
FRICTION = 0.4
#: Frequency above which modes are those of wheelsets on their contacts [Hz]: they stand on rigid rails here.
HIGHEST = 100.0
#: Integration tolerances of the state that is linearised, and of runs with large motions.
LINEAR_TOLERANCE, TOLERANCE = 1e-8, 1e-5
#: Lateral displacement at the start of a run with a large motion, and the steps in which it is reduced until no wheel
#: has more than HEAVIEST times its load at rest [m].
START, LESS, HEAVIEST = 8e-3, 0.25e-3, 2.0
#: Smallest amplitude of a large motion of a wheelset [m], at which equivalent conicity is stated (EN 15302).
LARGE = 3e-3
#: Windows in which amplitudes are compared: time [s], or the time to travel a length that exceeds a wave [m]. Recording
#: interval, longest run at one speed [s]. A motion persists if its amplitude is at least LASTS times that in the window
#: before.
WINDOW, WAVE, INTERVAL, LONGEST, LASTS = 1.0, 30.0, 0.01, 20.0, 0.99
#: Ratios of neighbouring speeds of the runs from START: upwards, and at the end of the bisection.
RATIO, CLOSE = 1.25, 1.03
#: Deceleration of the vehicle while its motion is large [m/s2]; time for which it slows down between runs at constant
#: speed, at the end of the search [s]; acceleration of gravity [m/s2].
DECELERATION, FINE, GRAVITY = 1.0, 0.25, 9.81


def values_of(sheet: DataSheet, **more: float | str) -> dict[str, float | str]:
    """Return the values of a sheet at level 3 with contact model 2 on rails with FRICTION."""
    friction = {f"friction_{number}": FRICTION for number in range(1, sheet.axles + 1)}
    profiles = {PAIR_FILE.variable.name: joined(sheet.profile_files)} if sheet.profile_files else {}
    return {"level": 3.0, "contact_model": 2.0} | sheet.parameters.values() | friction | profiles | more


def modes_of(sheet: DataSheet, speed: float, **more: float) -> list[Mode]:
    """Return the oscillations of the vehicle at a constant speed [m/s] with Kalker's linear creep, the slowest first.

    Polach's law has no slope at zero creepage, so that eigenvalues would depend on the drag of the wheelsets.
    """
    name = "vehicle" if sheet.axles == 4 else "bogie"
    library = _linear_library(name)
    more |= {"initial_speed": speed, "constant_speed": 1.0, "tolerance": LINEAR_TOLERANCE}
    values = values_of(sheet, **more)
    kernel = Kernel(library, **{key: value for key, value in values.items() if key in library.index})
    kernel.advance(SETTLED)
    found = oscillations(_linear_model(name).systems[0], np.array(kernel.linearise().jacobian))
    return sorted((mode for mode in found if mode.frequency < HIGHEST), key=lambda mode: mode.frequency)


_linear_model = lru_cache(linear_model)


@lru_cache
def _linear_library(name: str) -> Library:
    return Library(linear_kernel_of(name))


def linear_speed_of(sheet: DataSheet, **more: float) -> float:
    """Return the lowest speed above which a small motion grows [m/s]; infinite if none does up to FASTEST."""

    def growth(speed: float) -> float:
        return max(mode.growth for mode in modes_of(sheet, speed, **more))

    before = SLOWEST
    if growth(before) > 0.0:
        return SLOWEST
    for speed in np.arange(SLOWEST + STEP, FASTEST + STEP / 2, STEP).tolist():
        if growth(speed) > 0.0:
            return critical_speed(growth, before, speed)
        before = speed
    return float("inf")


class LargeMotion:
    """A run from a speed [m/s] and a lateral displacement of all wheelsets [m]; `told` receives its speed regularly."""

    def __init__(
        self, sheet: DataSheet, speed: float, start: float, told: Callable[[float], None] = lambda speed: None
    ) -> None:
        values = values_of(sheet, initial_speed=speed, initial_lateral=start, tolerance=TOLERANCE)
        self.kernel = prepare("vehicle" if sheet.axles == 4 else "bogie", **values)
        self.kernel.initialise()
        self.told = told
        self.force, self.mass = sheet.vehicle.pulls[0].name, sheet.mass
        self.names = [f"lateral_{number}" for number in range(1, sheet.axles + 1)]

    @property
    def speed(self) -> float:
        """The present speed [m/s]."""
        return self.kernel["speed"]

    def amplitude(self, duration: float) -> float:
        """Advance; return the largest amplitude of a wheelset, half of the distance between its extremes [m]."""
        seen = self.kernel.record(duration, INTERVAL, self.names)
        self.told(self.speed)
        return max(max(seen[name]) - min(seen[name]) for name in self.names) / 2

    def persists(self) -> bool:
        """Advance until the motion has become small, or no longer decays; return whether it persists, or derails."""
        window = max(WINDOW, WAVE / self.speed)
        before = self.amplitude(window)
        for _ in range(round(LONGEST / window)):
            now = self.amplitude(window) if not self.kernel.ended else before
            if now < LARGE or now >= LASTS * before:
                return now >= LARGE
            before = now
        return False

    def last_speed(self) -> float:
        """Slow down until the motion has become small; return the lowest speed at which it then persists [m/s]."""
        states = [self.kernel.save()]
        self.kernel.set(**{self.force: -DECELERATION * self.mass})
        while not self.kernel.ended and self.speed > SLOWEST and self.amplitude(WINDOW) >= LARGE:
            states.append(self.kernel.save())
        while len(states) > 1 and not self.persists_after(states[-1], 0.0):
            states.pop()
        state = states[-1]
        for _ in range(round(WINDOW / FINE)):
            if not self.persists_after(state, FINE):
                break
            state = self.kernel.save()
        self.kernel.restore(state)
        return self.speed

    def persists_after(self, state: bytes, time: float) -> bool:
        """Slow down from a state for a time [s]; return whether the motion persists at the speed then reached."""
        self.kernel.restore(state)
        if time > 0.0:
            self.kernel.set(**{self.force: -DECELERATION * self.mass})
            self.kernel.advance(time)
        self.kernel.set(**{self.force: 0.0})
        return self.persists()


def start_of(sheet: DataSheet) -> float:
    """Return the lateral displacement at which runs with a large motion start [m]: START, or less if a flange bears."""
    rest = HEAVIEST * sheet.mass * GRAVITY / (2 * sheet.axles)
    loads = [f"wheel_load_{number}_{side}" for number in range(1, sheet.axles + 1) for side in ("left", "right")]
    for start in np.arange(START, LARGE, -LESS).tolist():
        kernel = LargeMotion(sheet, SLOWEST, start).kernel
        if max(kernel[name] for name in loads) < rest:
            return float(start)
    return LARGE


def large_speed_of(sheet: DataSheet, start: float, told: Callable[[float], None] = lambda speed: None) -> float:
    """Return the lowest speed at which a large motion persists [m/s]; infinite if none does up to FASTEST.

    Runs from a large displacement are compared at rising speeds, then by bisection. In the slowest run that persists
    the vehicle then slows down until its motion ends.
    """
    speed, below = SLOWEST, 0.0
    run = LargeMotion(sheet, speed, start, told)
    while not run.persists():
        if speed == FASTEST:
            return float("inf")
        below, speed = speed, min(RATIO * speed, FASTEST)
        run = LargeMotion(sheet, speed, start, told)
    while speed > CLOSE * below > 0.0:
        middle = float(np.sqrt(below * speed))
        between = LargeMotion(sheet, middle, start, told)
        if between.persists():
            run, speed = between, middle
        else:
            below = middle
    return run.last_speed()

"""Hunting of a vehicle: modes and linear critical speed, and the lowest speed at which a large motion persists.

Straight smooth track at level 3 with contact model 2, with the vehicle's own profiles, springs and dampers.
"""

from __future__ import annotations

import pickle
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache

import numpy as np

from bogie_braking.checks import known, number, shown
from bogie_braking.machines import described, machine_of, model_from
from fmu_src.chain import ONE_WRITES
from fmu_src.compile import build_library
from fmu_src.cosimulation.recording import Recording
from fmu_src.kernel import Kernel, Library
from fmu_src.system import System
from products.building import LINEAR, linear_kernel_of, linear_model
from products.kernel_runs import SETTLED, prepare
from products.registry import fmu_named
from products.vehicle_sheet import DataSheet
from rbd_model.contact.pair_file import PAIR_FILE, joined
from rbd_model.levels.models import places_of
from rbd_model.linear import Mode, oscillations
from rbd_model.linear import critical_speed as speed_of_growth
from rbd_model.vehicle.description import Pull, Vehicle

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
#: Largest displacement at the start of a run that a caller may give [m].
LARGEST_START = 11e-3
#: Windows in which amplitudes are compared: time [s], or the time to travel a length that exceeds a wave [m]. Recording
#: interval, longest run at one speed [s]. A motion persists if its amplitude is at least LASTS times that in the window
#: before.
WINDOW, WAVE, INTERVAL, LONGEST, LASTS = 1.0, 30.0, 0.01, 20.0, 0.99
#: Ratios of neighbouring speeds of the runs from START: upwards, and at the end of the bisection.
RATIO, CLOSE = 1.25, 1.03
#: Deceleration of the vehicle while its motion is large [m/s2]; time for which it slows down between runs at constant
#: speed, at the end of the search [s]; acceleration of gravity [m/s2].
DECELERATION, FINE, GRAVITY = 1.0, 0.25, 9.81
#: A force that slows down a vehicle without external forces of its own.
TOWING = "towing_force"
#: Motions of bodies in words, by the ends of their states' names.
MOTIONS = ("shift", "lateral", "bounce", "roll", "pitch", "yaw")


@dataclass(frozen=True)
class Subject:
    """A vehicle whose hunting is computed, and the values of its runs.

    fmu: the built-in FMU with its equations; None: its own are compiled. own: its parameters and resistance.
    """

    vehicle: Vehicle
    fmu: str | None = None
    own: Mapping[str, float | str] = field(default_factory=dict)

    @classmethod
    def of(cls, what: str | DataSheet | Vehicle) -> Subject:
        """Return that of a built-in vehicle, of one from a file or of your own. Raises KeyError, TypeError."""
        vehicle = described(what)
        if isinstance(what, str):
            name = fmu_named(what)
            return cls(vehicle, name) if name in LINEAR else cls(vehicle)
        if not isinstance(what, DataSheet):
            forces = vehicle.pulls or (Pull(TOWING, "Forward force", vehicle.bodies[0].name, (0.0, 0.0, 0.0)),)
            return cls(replace(vehicle, pulls=forces))
        own: dict[str, float | str] = {}
        if what.profile_files:
            own[PAIR_FILE.variable.name] = joined(what.profile_files)
        if what.fmu is None:
            return cls(vehicle, None, {**what.resistance, **own})
        return cls(vehicle, "vehicle" if what.axles == 4 else "bogie", {**what.parameters.values(), **own})

    @property
    def axles(self) -> int:
        """Number of wheelsets."""
        return len(self.vehicle.wheelsets)

    @cached_property
    def mass(self) -> float:
        """Mass of all bodies and wheelsets [kg]."""
        return sum(self.vehicle.number(part.mass) for part in self.vehicle.parts)

    def values(self, **more: float | str) -> dict[str, float | str]:
        """Return the values of a run at level 3 with contact model 2 on rails with FRICTION."""
        friction = {f"friction_{number}": FRICTION for number in range(1, self.axles + 1)}
        return {"level": 3.0, "contact_model": 2.0} | dict(self.own) | friction | more

    def prepared(self, **more: float | str) -> Kernel:
        """Return a kernel with these values. Raises SimulationError."""
        values = self.values(**more)
        if self.fmu is not None:
            return prepare(self.fmu, **values)
        chosen = {name: int(float(values.pop(name))) for name in ("level", "contact_model")}
        return Kernel(machine_of(self.vehicle, chosen, on_line=False).library, **values)

    @property
    def linear(self) -> tuple[Library, System]:
        """Its equations with Kalker's linear creep."""
        if self.fmu is not None:
            return _linear_library(self.fmu), _linear_model(self.fmu).systems[0]
        return _own_linear(pickle.dumps(self.vehicle))


_linear_model = lru_cache(linear_model)


@lru_cache
def _linear_library(name: str) -> Library:
    return Library(linear_kernel_of(name))


@lru_cache
def _own_linear(vehicle: bytes) -> tuple[Library, System]:
    linear = replace(pickle.loads(vehicle), creep_law="kalker-linear")
    with ONE_WRITES:
        model = model_from(linear, places_of(3, 2, on_line=False))
        return Library(build_library(model)), model.systems[0]


def modes_of(subject: Subject, speed: float, **more: float) -> list[Mode]:
    """Return the oscillations of the vehicle at a constant speed [m/s] with Kalker's linear creep, the slowest first.

    Polach's law has no slope at zero creepage, so that eigenvalues would depend on the drag of the wheelsets.
    """
    library, system = subject.linear
    for name in more:
        known(name, library.index, "variable")
    more |= {"initial_speed": speed, "constant_speed": 1.0, "tolerance": LINEAR_TOLERANCE}
    values = subject.values(**more)
    kernel = Kernel(library, **{key: value for key, value in values.items() if key in library.index})
    kernel.advance(SETTLED)
    found = oscillations(system, np.array(kernel.linearise().jacobian))
    return sorted((mode for mode in found if mode.frequency < HIGHEST), key=lambda mode: mode.frequency)


def motion_of(mode: Mode, vehicle: Vehicle) -> str:
    """Return the body and motion with the largest displacement in a mode, in words; angles count at half the base."""

    def size(name: str) -> float:
        body, _, motion = name.rpartition("_")
        arm = _half_base(vehicle, body or vehicle.bodies[0].name) if motion in ("pitch", "yaw") else 1.0
        return abs(mode.shape[name]) * arm

    named = [name for name in mode.shape if name.rpartition("_")[2] in MOTIONS]
    wheels = [name for name in mode.shape if name.startswith("lateral_")]
    largest = max([*named, *wheels], key=size)
    if largest in wheels:
        return f"hunting of wheelset {largest.rpartition('_')[2]}"
    body, _, motion = largest.rpartition("_")
    return f"{motion} of the {body.replace('_', ' ')}" if body else f"{motion} of the body"


def _half_base(vehicle: Vehicle, name: str) -> float:
    """Return the largest distance of a body's centre from the wheelsets below it, or from the bodies below [m]."""
    places = {body.name: vehicle.number(body.along) for body in vehicle.bodies}
    axles = [vehicle.number(wheelset.along) for wheelset in vehicle.wheelsets]
    below = [one for one in axles if min(places, key=lambda body: abs(places[body] - one)) == name]
    others = below or [place for body, place in places.items() if body != name]
    return max(abs(place - places[name]) for place in others)


def linear_speed_of(subject: Subject, **more: float) -> float:
    """Return the lowest speed above which a small motion grows [m/s]; infinite if none does up to FASTEST."""

    def growth(speed: float) -> float:
        return max(mode.growth for mode in modes_of(subject, speed, **more))

    before = SLOWEST
    if growth(before) > 0.0:
        return SLOWEST
    for speed in np.arange(SLOWEST + STEP, FASTEST + STEP / 2, STEP).tolist():
        if growth(speed) > 0.0:
            return speed_of_growth(growth, before, speed)
        before = speed
    return float("inf")


class LargeMotion:
    """A run from a speed [m/s] and a lateral displacement of all wheelsets [m]; `told` receives its speed regularly."""

    def __init__(
        self,
        subject: Subject,
        speed: float,
        start: float,
        told: Callable[[float], None] = lambda speed: None,
        more: Mapping[str, float] | None = None,
    ) -> None:
        values = {**(more or {}), "initial_speed": speed, "initial_lateral": start, "tolerance": TOLERANCE}
        self.kernel = subject.prepared(**values)
        self.kernel.initialise()
        self.told = told
        self.force, self.mass = subject.vehicle.pulls[0].name, subject.mass
        self.names = [f"lateral_{number}" for number in range(1, subject.axles + 1)]

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


def start_of(subject: Subject) -> float:
    """Return the lateral displacement at which runs with a large motion start [m]: START, or less if a flange bears."""
    rest = HEAVIEST * subject.mass * GRAVITY / (2 * subject.axles)
    loads = [f"wheel_load_{number}_{side}" for number in range(1, subject.axles + 1) for side in ("left", "right")]
    for start in np.arange(START, LARGE, -LESS).tolist():
        kernel = LargeMotion(subject, SLOWEST, start).kernel
        if max(kernel[name] for name in loads) < rest:
            return float(start)
    return LARGE


def large_speed_of(
    subject: Subject,
    start: float,
    told: Callable[[float], None] = lambda speed: None,
    more: Mapping[str, float] | None = None,
) -> float:
    """Return the lowest speed at which a large motion persists [m/s]; infinite if none does up to FASTEST.

    Runs from a large displacement are compared at rising speeds, then by bisection. In the slowest run that persists
    the vehicle then slows down until its motion ends.
    """
    speed, below = SLOWEST, 0.0
    run = LargeMotion(subject, speed, start, told, more)
    while not run.persists():
        if speed == FASTEST:
            return float("inf")
        below, speed = speed, min(RATIO * speed, FASTEST)
        run = LargeMotion(subject, speed, start, told, more)
    while speed > CLOSE * below > 0.0:
        middle = float(np.sqrt(below * speed))
        between = LargeMotion(subject, middle, start, told, more)
        if between.persists():
            run, speed = between, middle
        else:
            below = middle
    return run.last_speed()


def modes(vehicle: str | DataSheet | Vehicle, speed: float, **values: float) -> Recording:
    """Return the natural modes of a vehicle at a constant speed on straight track, the slowest first.

    They are eigenvalues of the equations of level 3 with contact model 2 and Kalker's linear creep, up to 100 Hz.

    Parameters
    ----------
    vehicle : str, DataSheet or Vehicle
        A built-in vehicle by its name, one from a file (`read_vehicle`), or your own, with its profiles. Equations of
        your own are compiled first.
    speed : float
        Speed [m/s], above 0 and at most 150.
    **values
        Parameters and inputs by name, in SI units. The friction of the rails is 0.4 by default.

    Returns
    -------
    Recording
        A row for each mode: `mode`, `frequency` [Hz], `damping_ratio` [1], `growth` [1/s], which are below and above 0
        for a mode that grows. `messages[row]` names the body and the motion that move most.

    Raises
    ------
    KeyError
        If the vehicle or the name of a value is unknown.
    TypeError
        If `vehicle` is not one.
    ValueError
        If the speed is not in its range.
    SimulationError
        If a value is invalid.
    """
    if not 0.0 < number(speed) <= FASTEST:
        raise ValueError(f"speed must be above 0 and at most {FASTEST:g} m/s; got {shown(speed)}.")
    subject = Subject.of(vehicle)
    found = modes_of(subject, float(speed), **values)
    units = {"mode": "1", "frequency": "Hz", "damping_ratio": "1", "growth": "1/s"}
    rows = [[place, one.frequency, one.damping_ratio, one.growth] for place, one in enumerate(found)]
    return Recording(units, rows, [motion_of(one, subject.vehicle) for one in found])


def critical_speed(vehicle: str | DataSheet | Vehicle, amplitude: float | None = None, **values: float) -> float:
    """Return the critical speed of a vehicle on straight smooth track [m/s].

    Parameters
    ----------
    vehicle : str, DataSheet or Vehicle
        As in `modes`.
    amplitude : float, optional
        None: the linear critical speed, above which a small motion grows. A lateral displacement of all wheelsets at
        the start [m], from 3 to 11 mm: the lowest speed at which the motion that begins there persists.
    **values
        As in `modes`.

    Returns
    -------
    float
        The speed [m/s], searched from 10 to 150 m/s: infinite if it is above, 10 if it is below.

    Raises
    ------
    KeyError
        If the vehicle or the name of a value is unknown.
    TypeError
        If `vehicle` is not one.
    ValueError
        If the amplitude is not in its range.
    SimulationError
        If a value is invalid.
    """
    subject = Subject.of(vehicle)
    if amplitude is None:
        return linear_speed_of(subject, **values)
    if not LARGE <= number(amplitude) <= LARGEST_START:
        raise ValueError(
            f"amplitude must be {LARGE:g} to {LARGEST_START:g} m, or left out for small motions; got "
            f"{shown(amplitude)}. The thresholds of a large motion are those of EN 15302."
        )
    return large_speed_of(subject, float(amplitude), more=values)

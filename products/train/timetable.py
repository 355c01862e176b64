"""A driver who follows a timetable: limits of speed, stops at places and times, a braking curve of one deceleration."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from brake_controller.distributors import kind_of
from fmu_src.cosimulation.recording import Recording
from products.train.driver import LEAST, acknowledge, direct_release, hold, rolls_back
from products.train.driver_forces import SPEEDS, moved_mass, train_forces
from products.train.energy_plan import EnergyPlan, allowed_speed
from products.train.starting import StartWatch
from products.train.stations import LIMITS, StationCall, StationStop, check_limits, check_stops, stopping_rate
from products.train.train import LONGEST, Train, within
from readers.usual import note

#: Time between two actions [s]; times of the correction of a speed, and of the estimate of a gradient [s]. Assumed.
PERIOD, CORRECTS, FEELS = 0.5, 5.0, 4.0
#: Time in which a train that saves energy meets a braking curve [s]: it coasts until then. Assumed.
NEAR = 3.0
#: Time that a profile leaves to the end of the stop [s]: brakes build up, and air ends it. Assumed.
STOPPING = 1.0
#: Time by which braking curves are looked ahead, and of the rise to full service [s], by the pipe and by wire. Assumed.
ANSWERS, MOVES = {False: 3.0, True: 1.5}, {False: 4.0, True: 1.5}
#: Time in which traction that slipping has reduced comes back [s]. Assumed.
RETURNS = 8.0
#: Slip that halves traction: factor of the speed, and added [m/s]. Speed below which air ends a stop [m/s]. Assumed.
SLIPS, ENDS = (1.1, 0.5), 0.3
#: Time between two actions [s], and speed below which air ends a stop [m/s], with a limit of the jerk. Assumed.
QUICK, SOFT = 0.1, 0.02
#: Time by which its brakes answer later [s], and share of the jerk that the curve of a stop uses. Assumed.
BEFORE, SOFTER = 0.4, 0.7
#: Deceleration by brakes below which traction may follow them [m/s2]. Assumed.
BRAKED = 0.02


@dataclass
class TimetableDriver:
    """A driver who knows the forces of a train, and estimates gradient and resistance from its acceleration.

    The speed follows the lowest of three: the limit below the whole train, braking curves, and the steady speed that
    arrives at the due time. Braking curves v^2 = v_1^2 + 2 b s lead to each lower limit and to the next stop. Air
    is applied as long before as the brake takes to answer. Traction uses an adhesion that falls over speed by Curtius
    and Kniffler; a slipping vehicle halves it.

    Parameters
    ----------
    stops : sequence of StationStop
        Stops with rising places; the last one ends the run.
    limits : sequence of (float, float)
        Places [m] with rising distance, and the speed limit from there on [m/s]; the first holds before, too.
    deceleration : float
        Deceleration of braking curves [m/s2], 0.05 to 1.5.
    within : float
        A train that stands short of a stop by more draws up [m].
    adhesion : float
        Adhesion at standstill that traction uses at most [1].
    energy : bool
        Whether the train arrives with the least energy instead of at a steady speed: it follows a profile of full
        power, held speed, coasting and braking (`speed_profile`), with the gradients of the train's line.
    recovery : float
        Share of the electric brake's energy that comes back [1].
    jerk : float
        Largest rate of acceleration and deceleration that the commands lead to [m/s3], at the stop, too; 0: no limit.
        All vehicles must have `brake = "ep-direct"`. Then `act` is to be called each 0.1 s, `period`.

    Raises
    ------
    ValueError
        If stops or limits are missing or do not rise, stops are nearer than 2 `within`, a number is out of its
        limits, or `energy` or `recovery` has no effect.
    """

    stops: Sequence[StationStop]
    limits: Sequence[tuple[float, float]]
    deceleration: float = 0.5
    within: float = 5.0
    adhesion: float = 0.25
    energy: bool = False
    recovery: float = 0.0
    jerk: float = 0.0
    calls: list[StationCall] = field(default_factory=list)
    air: float = 0.0
    load: float = 0.0
    pulling: float = 1.0
    leaves: float = 0.0
    _forces: np.ndarray | None = None
    _train: Train | None = None
    _before: float = 0.0
    _seen: float = 0.0
    _wired: bool = False
    _looks: float = 1.0
    _plan: EnergyPlan | None = field(default=None, init=False, repr=False)
    _rate: float = 0.0
    _stops: bool = False
    _past: list[float] = field(default_factory=list, init=False, repr=False)
    _watch: StartWatch = field(default_factory=StartWatch, init=False, repr=False)

    def __post_init__(self) -> None:
        for name in ("deceleration", "within", "adhesion", "recovery"):
            within(name, getattr(self, name), *LIMITS[name])
        if self.jerk:
            within("jerk", self.jerk, *LIMITS["jerk"])
        check_stops(self.stops, 2 * self.within)
        check_limits(self.limits)
        if not self.stops or not self.limits:
            raise ValueError("A timetable must have at least one stop and one speed limit. Add them.")
        if self.energy and not any(stop.arrival for stop in self.stops):
            raise ValueError("energy must come with a stop that has an arrival; got none. State arrival of a stop.")
        if self.recovery and not self.energy:
            raise ValueError(f"recovery must be 0 without energy; got {self.recovery:g}. Set energy=True.")

    @property
    def period(self) -> float:
        """Time between two calls of `act` [s]."""
        return QUICK if self.jerk else PERIOD

    def target(self, front: float, length: float, time: float, ahead: float) -> tuple[float, float]:
        """Return the speed to drive at [m/s], and its rate [m/s2].

        Parameters
        ----------
        front, length : float
            Place of the train's front, and its length [m].
        time : float
            Time [s].
        ahead : float
            Distance by which braking curves are looked ahead [m].
        """
        stop = self.stops[len(self.calls)]
        places = np.array([place for place, _ in self.limits])
        speeds = np.array([speed for _, speed in self.limits])
        best, rate = allowed_speed(self.limits, front, length), 0.0
        goals = [(p, v) for p, v in zip(places, speeds, strict=True) if p > front and v < best]
        for place, speed in (*goals, *([] if self.jerk else [(stop.place, 0.0)])):
            curve = math.sqrt(speed**2 + 2 * self.deceleration * max(place - front - ahead, 0.0))
            if curve < best:
                best, rate = curve, -self.deceleration
        due = (
            self._due(stop.arrival - time - ANSWERS[self._wired], stop.place - front - ahead)
            if stop.arrival and not self.energy
            else math.inf
        )
        return (due, 0.0) if due < best else (best, rate)

    def _due(self, left: float, way: float) -> float:
        """Return the steady speed that arrives in a time [s]: d / v + v / 2 b = T, with its braking; infinity: none."""
        b = self.deceleration
        if left <= 0.0 or way <= 0.0 or left**2 <= 2 * way / b:
            return math.inf
        return max(b * (left - math.sqrt(left**2 - 2 * way / b)), LIMITS["speed"][0])

    def act(self, train: Train) -> None:
        """Set valve, traction and dynamic brakes of a train; call it once a `period` before the train advances.

        After the last stop the train is held. Raises ValueError for another train, one without motors or with brakes
        that release wholly, one whose front is past the first stop, and one that does not start.
        """
        if self._forces is None:
            self._begin(train)
        if train is not self._train:
            raise ValueError(
                "A driver by timetable must stay with one train; got another one. Make a new driver for it."
            )
        assert self._forces is not None
        acknowledge(train)
        speed, front = float(train.speed[0]), self.front(train)
        if self._holds(train, front):
            self.air, self._before, self._seen, self.load = hold(train), speed, train.time, 0.0
            self._rate, self._stops = 0.0, False
            self._watch.reset()
            return
        self._watch.look(train, self.adhesion)
        if rolls_back(train):
            self.air, self._before, self._seen = hold(train), speed, train.time
            return
        motors, electric, full, grips, every = (float(np.interp(speed, SPEEDS, row)) for row in self._forces)
        electric = every if self.jerk else electric  # the input `dynamic_brake` demands it from vehicles by wire, too
        mass = moved_mass(train.consist)
        self._feel(train, mass, speed)
        allowed = self._allowed(front, speed, train)
        needed = min(mass * allowed - self.load, self._saving(front, speed, mass), self.adhesion * grips)
        needed = self._smooth(train, needed, mass) if self.jerk else needed
        self._set(train, needed, motors, electric, full)

    def _smooth(self, train: Train, needed: float, mass: float) -> float:
        """Return a force [N] whose acceleration changes at the limited rate; traction waits for the brakes' release."""
        change = self.jerk * self.period
        braked = float(np.sum(train.brake_force)) > BRAKED * mass
        rate = min((needed + self.load) / mass, 0.0 if braked else math.inf)
        self._rate = float(np.clip(rate, self._rate - change, self._rate + change))
        return mass * self._rate - self.load

    def _allowed(self, front: float, speed: float, train: Train) -> float:
        """Return the acceleration that leads to limits and stops [m/s2]."""
        length, ahead = train.consist.length, self._looks * speed * self._answers()
        aim, rate = self.target(front, length, train.time, ahead)
        allowed = rate * (speed > 0.9 * aim) + (aim - speed) / CORRECTS
        if self.jerk:
            return min(allowed, self._softly(front, speed))
        if self._plan is None:
            return allowed
        soon, _ = self.target(front, length, train.time, max(ahead, speed * NEAR))
        return max(allowed, (soon - speed) / NEAR) if soon > 0.0 else allowed

    def _softly(self, front: float, speed: float) -> float:
        """Return the acceleration that ends at the next stop with a limited jerk [m/s2]; infinity far from it."""
        way = self.stops[len(self.calls)].place - front
        rising = 0.0 if self._stops else self.deceleration / (2 * self.jerk)
        rate = stopping_rate(way - speed * (BEFORE + rising), speed, SOFTER * self.jerk)
        self._stops = speed > 0.0 and (self._stops or rate >= self.deceleration)
        return -rate if self._stops else math.inf

    def _answers(self) -> float:
        """Return the time by which braking curves are looked ahead [s]: brakes answer, and rise by the jerk."""
        return ANSWERS[self._wired] + (self.deceleration / (2 * self.jerk) if self.jerk else 0.0)

    def _saving(self, front: float, speed: float, mass: float) -> float:
        """Return the force of the profile of least energy [N]; infinity without one."""
        stop = self.stops[len(self.calls)]
        if self._plan is None or not stop.arrival:
            return math.inf
        rate, coasts = self._plan.acceleration(front, speed, stop.place, stop.arrival - STOPPING)
        return 0.0 if coasts else mass * rate - self.load

    def _begin(self, train: Train) -> None:
        """Take the forces of a train. Raises ValueError as `act`."""
        direct = direct_release(train.consist)
        if direct:
            name = kind_of(train.consist.vehicles[direct - 1].distributor).name
            raise ValueError(
                f"A driver by timetable must have brakes that release in part; vehicle {direct} has distributor = "
                f"{name}, which releases wholly. Take ecp or uic."
            )
        forces = train_forces(train.consist)
        self._wired = all(kind_of(vehicle.distributor).wired for vehicle in train.consist.vehicles)
        if not forces[0].any():
            raise ValueError("A driver by timetable must have a train with motors. State traction_force of a vehicle.")
        front, first = self.front(train), self.stops[0].place
        if first < front - self.within:
            raise ValueError(
                f"The first stop must not be behind the front of the train at {front:g} m; got {first:g} m. "
                "Leave it out."
            )
        if self.jerk and any(vehicle.electric.blended_pressure == 0.0 for vehicle in train.consist.vehicles):
            raise ValueError(
                f"jerk must be 0 unless all vehicles have brake = ep-direct; got {self.jerk:g} m/s3. Set jerk=0."
            )
        if self.recovery and not forces[4].any():
            raise ValueError(
                f"recovery must be 0 with a train without electric brakes; got {self.recovery:g}. State dynamic_force "
                "of a vehicle."
            )
        dead = max(vehicle.electric.dead_time for vehicle in train.consist.vehicles)
        self._past = [0.0] * (round(dead / self.period) if self.jerk else 0)
        self._train, self._forces = train, forces
        if self.energy:
            rise = max(vehicle.traction.traction_rise for vehicle in train.consist.vehicles)
            answers = rise / 4 + PERIOD / 2  # motors fall as slowly as they rise, from half of their force as a mean
            numbers = self.deceleration, self.adhesion, self.recovery, answers
            self._plan = EnergyPlan(train, forces, self.limits, *numbers)
        self._before, self._seen = float(train.speed[0]), train.time

    @staticmethod
    def front(train: Train) -> float:
        """Return the place of the front of a train [m]."""
        return float(train.distance[0]) + train.consist.vehicles[0].length / 2

    def _holds(self, train: Train, front: float) -> bool:
        """Return whether a train is to be held at a stop, and note its arrival once all vehicles stand."""
        if len(self.calls) == len(self.stops) or train.time < self.leaves:
            return True
        stop, fastest = self.stops[len(self.calls)], float(np.abs(train.speed).max())
        if front <= stop.place - self.within or fastest >= (SOFT if self.jerk else ENDS):
            return False
        if fastest == 0.0:
            late = train.time - stop.arrival if stop.arrival > 0.0 else 0.0
            self.calls.append(StationCall(stop.place, front - stop.place, train.time, late))
            self.leaves = max(train.time + stop.standing, stop.departure)
        return True

    def _feel(self, train: Train, mass: float, speed: float) -> None:
        """Estimate the force of gradient and resistance [N] from the acceleration and forces since the last call."""
        time = train.time - self._seen
        if speed > 0.0 and time > 0.0:
            applied = float(np.sum(train.traction_force) - np.sum(train.brake_force))
            felt = mass * (speed - self._before) / time - applied
            self.load += (felt - self.load) * min(time / FEELS, 1.0)
        self._before, self._seen = speed, train.time

    def _set(self, train: Train, needed: float, motors: float, electric: float, full: float) -> None:
        """Set the controls for a force [N] by the largest forces [N] of motors, dynamic brake and air."""
        slips = bool(np.any(train.wheel_speed > SLIPS[0] * train.speed + SLIPS[1]))
        self.pulling = max(self.pulling / 2, 0.05) if slips else min(self.pulling + self.period / RETURNS, 1.0)
        pull = min(max(needed / max(motors, 1.0), 0.0), self.pulling)
        brake = max(-needed, 0.0)
        dynamic = min(brake / electric, 1.0) if electric else 0.0
        wanted = min(max(brake - dynamic * electric, 0.0) / max(full, 1.0), 1.0)
        change = self.period / MOVES[self._wired]
        self.air = float(np.clip(wanted, self.air - change, self.air + change))
        brakes = self.air >= LEAST / 2 or dynamic > 0.1
        self._looks = max(self._looks - self.period / (2 * self._answers()), 0.0) if brakes else 1.0
        least = LEAST / 2
        if self.jerk:  # the electric brake begins: the valve's first step is larger
            self.air, dynamic = min(brake / max(full, 1.0), 1.0), min(brake / electric, 1.0) if electric else 0.0
            self._past.append(dynamic)
            dynamic = self._past.pop(0)  # as late as the demand by wire
            least = LEAST if brake < electric else LEAST / 4
        released = self.air < least
        train.inputs["traction"], train.inputs["dynamic_brake"] = pull if released else 0.0, dynamic
        if released:
            train.drive("running")
        else:
            train.drive("service", min(max(self.air - LEAST, 0.0) / (1 - LEAST), 1.0))

    def drive(self, train: Train, seconds: float = LONGEST) -> Recording:
        """Drive a train to the last stop, or for a time [s], and record it each `period`.

        Returns
        -------
        Recording
            Time, place of the front, speed, speed of the fastest wheels, traction and brake force of all vehicles, and
            the energies of motors, electric and friction brakes at the rims. `calls` has the stops.

        Raises
        ------
        ValueError
            If the time is not 0 to a day, or as `act` and `Train.advance`.
        """
        within("The time", seconds, 0.0, LONGEST, "s")
        units = {"time": "s", "distance": "m", "speed": "m/s", "wheel_speed": "m/s", "traction_force": "N"}
        units |= {"brake_force": "N", "traction_energy": "J", "electric_brake_energy": "J", "brake_heat": "J"}
        sums = list(units)[4:]
        rows, end = [self._row(train, sums)], train.time + seconds
        while len(self.calls) < len(self.stops) and train.time < end - self.period / 2:
            self.act(train)
            train.advance(self.period)
            rows.append(self._row(train, sums))
        notes = [note(f"The limit at {place:g} m", speed, "m/s") for place, speed in self.limits]
        return Recording(units, np.array(rows), [said for said in (*notes, *train.messages) if said])

    def _row(self, train: Train, sums: Sequence[str]) -> list[float]:
        own = [train.time, self.front(train), float(train.speed[0]), float(train.wheel_speed.max())]
        return own + [float(np.sum(getattr(train, name))) for name in sums]

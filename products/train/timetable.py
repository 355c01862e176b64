"""A driver who follows a timetable: limits of speed, stops at places and times, a braking curve of one deceleration."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from brake_controller.distributors import kind_of
from brake_controller.electric_brake import blending
from brake_controller.traction import driving
from fmu_src.cosimulation.recording import Recording
from products.train.consist import Consist, TrainVehicle, forces_of
from products.train.driver import LEAST, direct_release, hold, rolls_back
from products.train.train import LONGEST, Train, within
from rbd_model.track.adhesion_laws import at_speed
from rbd_model.train.vehicle import GRAVITY
from readers.usual import note

#: Time between two actions [s]; times of the correction of a speed, and of the estimate of a gradient [s]. Assumed.
PERIOD, CORRECTS, FEELS = 0.5, 5.0, 4.0
#: Time by which braking curves are looked ahead, and of the rise to full service [s], by the pipe and by wire. Assumed.
ANSWERS, MOVES = {False: 3.0, True: 1.5}, {False: 4.0, True: 1.5}
#: Time in which traction that slipping has reduced comes back [s]. Assumed.
RETURNS = 8.0
#: Slip that halves traction: factor of the speed, and added [m/s]. Speed below which air ends a stop [m/s]. Assumed.
SLIPS, ENDS = (1.1, 0.5), 0.3
#: Speeds of the forces that the driver knows [m/s].
SPEEDS = np.linspace(0.0, 150.0, 1501)
#: Lower and upper limits of a driver's numbers, with their units.
LIMITS = {
    "deceleration": (0.05, 1.5, "m/s2"),
    "within": (0.1, 100.0, "m"),
    "adhesion": (0.01, 1.0, ""),
    "place": (-1e7, 1e7, "m"),
    "speed": (0.5, 112.0, "m/s"),  # 400 km/h
}


@dataclass(frozen=True)
class StationStop:
    """A stop of the train's front.

    place: distance along the line [m]. arrival: time at which it is due [s]; 0: as early as possible. standing: least
    time at rest [s]. departure: not before this time [s]; 0: any. Raises ValueError if a number is out of its limits (a
    time: 0 to a day), or if the departure is before the arrival.
    """

    place: float
    arrival: float = 0.0
    standing: float = 30.0
    departure: float = 0.0

    def __post_init__(self) -> None:
        within("place", self.place, *LIMITS["place"])
        for name, value in (("arrival", self.arrival), ("standing", self.standing), ("departure", self.departure)):
            within(name, value, 0.0, LONGEST, "s")
        if 0.0 < self.departure < self.arrival:
            raise ValueError(
                f"departure must be 0 s or not before arrival = {self.arrival:g} s; got {self.departure:g} s. Correct "
                "one of them."
            )


@dataclass(frozen=True)
class StationCall:
    """A stop as it was made: place of the stop [m], overrun of the front (below 0: short) [m], times [s].

    late: arrival behind the timetable [s]; 0 for a stop without a due time.
    """

    place: float
    overrun: float
    arrived: float
    late: float


def _vehicle_forces(train_vehicle: TrainVehicle) -> np.ndarray:
    """Return the largest forces of a vehicle's motors, dynamic brake and air brake over SPEEDS [N], shape (4, n).

    The last row is the weight on driven wheels times the fall of adhesion by Curtius and Kniffler.
    """
    wired = kind_of(train_vehicle.distributor).wired  # the driver's valve demands both brakes of such a vehicle
    motors = list(replace(train_vehicle.traction, traction_rise=0.0).values().values())
    electric = list(replace(train_vehicle.electric, dynamic_rise=0.0, blended_pressure=0.0).values().values())
    speed = SPEEDS[None, :]

    def each(values: list[float]) -> np.ndarray:
        return np.tile(np.array(values)[:, None], SPEEDS.size)

    pulls = driving()(speed, each([1.0, 0.0, 1.0]), each(motors))
    brakes = blending()(
        speed, each([0.0, 1.0, 0.0, 1.0]), each(list(train_vehicle.brake.values().values())), each(electric)
    )
    air = forces_of(train_vehicle.brake, np.full(SPEEDS.size, train_vehicle.distributor.full_pressure), SPEEDS)
    weight = train_vehicle.mass * GRAVITY * train_vehicle.braked_share * (train_vehicle.traction.traction_force > 0.0)
    grips = weight * at_speed(SPEEDS) / at_speed(0.0)
    return np.vstack([np.asarray(pulls)[0], 0.0 * SPEEDS if wired else np.asarray(brakes)[0], air, grips])


def train_forces(consist: Consist) -> np.ndarray:
    """Return the sums of `_vehicle_forces` over a train, shape (4, n)."""
    found: dict[TrainVehicle, np.ndarray] = {}
    total = np.zeros((4, SPEEDS.size))
    for vehicle in consist.vehicles:
        if vehicle not in found:
            found[vehicle] = _vehicle_forces(vehicle)
        total += found[vehicle]
    return total


def _check_stops(stops: Sequence[StationStop], apart: float) -> None:
    """Raise ValueError if places or times of stops do not rise, or two stops are nearer than a distance [m]."""
    if not isinstance(stops, (list, tuple)) or not all(isinstance(one, StationStop) for one in stops):
        raise ValueError(f"stops must be a list of StationStop; got {stops!r}. Make a StationStop of each place.")
    for number, (one, other) in enumerate(pairwise(stops), 2):
        if other.place <= one.place:
            raise ValueError(
                f"stops must have places that rise; stop {number} is at {other.place:g} m, the one before at "
                f"{one.place:g} m. Sort them."
            )
        if other.place - one.place < apart:
            raise ValueError(
                f"stops must be at least 2 within = {apart:g} m apart; stop {number} is at {other.place:g} m, the one "
                f"before at {one.place:g} m. Leave one out, or take a smaller within."
            )
    times = [(n, time) for n, stop in enumerate(stops, 1) for time in (stop.arrival, stop.departure) if time]
    for (before, early), (number, late) in pairwise(times):
        if late < early:
            raise ValueError(
                f"stops must have times that rise; stop {number} has {late:g} s, and stop {before} has {early:g} s. "
                "Correct one of them."
            )


def _check_limits(limits: Sequence[tuple[float, float]]) -> None:
    """Raise ValueError if speed limits are not pairs of numbers, out of their limits, or at places that do not rise."""
    if not isinstance(limits, (list, tuple)) or not all(
        isinstance(limit, (list, tuple)) and len(limit) == 2 for limit in limits
    ):
        raise ValueError(f"limits must be a list of pairs (place, speed); got {limits!r}. Write [(0, 20)] for 20 m/s.")
    for place, speed in limits:
        within("place", place, *LIMITS["place"])
        within("speed", speed, *LIMITS["speed"])
    places = [place for place, _ in limits]
    if any(other <= one for one, other in pairwise(places)):
        raise ValueError(f"limits must have places that rise; got {places}. Sort them.")


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

    Raises
    ------
    ValueError
        If stops or limits are missing or do not rise, stops are nearer than 2 `within`, or a number is out of its
        limits.
    """

    stops: Sequence[StationStop]
    limits: Sequence[tuple[float, float]]
    deceleration: float = 0.5
    within: float = 5.0
    adhesion: float = 0.25
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

    def __post_init__(self) -> None:
        for name in ("deceleration", "within", "adhesion"):
            within(name, getattr(self, name), *LIMITS[name])
        _check_stops(self.stops, 2 * self.within)
        _check_limits(self.limits)
        if not self.stops or not self.limits:
            raise ValueError("A timetable must have at least one stop and one speed limit. Add them.")

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
        first, last = (max(int(np.searchsorted(places, at, "right")) - 1, 0) for at in (front - length, front))
        best, rate = float(speeds[first : last + 1].min()), 0.0
        goals = [(p, v) for p, v in zip(places, speeds, strict=True) if p > front and v < best]
        for place, speed in (*goals, (stop.place, 0.0)):
            curve = math.sqrt(speed**2 + 2 * self.deceleration * max(place - front - ahead, 0.0))
            if curve < best:
                best, rate = curve, -self.deceleration
        due = (
            self._due(stop.arrival - time - ANSWERS[self._wired], stop.place - front - ahead)
            if stop.arrival
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
        """Set valve, traction and dynamic brakes of a train; call it once a PERIOD before the train advances.

        After the last stop the train is held. Raises ValueError for another train, one without motors or with brakes
        that release wholly, and one whose front is past the first stop.
        """
        if self._forces is None:
            self._begin(train)
        if train is not self._train:
            raise ValueError(
                "A driver by timetable must stay with one train; got another one. Make a new driver for it."
            )
        assert self._forces is not None
        speed, front = float(train.speed[0]), self.front(train)
        if self._holds(train, front):
            self.air, self._before, self._seen, self.load = hold(train), speed, train.time, 0.0
            return
        if rolls_back(train):
            self.air, self._before, self._seen = hold(train), speed, train.time
            return
        motors, electric, full, grips = (float(np.interp(speed, SPEEDS, row)) for row in self._forces)
        mass = sum((1 + vehicle.rotating_share) * vehicle.mass for vehicle in train.consist.vehicles)
        self._feel(train, mass, speed)
        aim, rate = self.target(front, train.consist.length, train.time, self._looks * speed * ANSWERS[self._wired])
        needed = mass * (rate * (speed > 0.9 * aim) + (aim - speed) / CORRECTS) - self.load
        self._set(train, min(needed, self.adhesion * grips), motors, electric, full)

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
        self._train, self._forces = train, forces
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
        if front <= stop.place - self.within or fastest >= ENDS:
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
        self.pulling = max(self.pulling / 2, 0.05) if slips else min(self.pulling + PERIOD / RETURNS, 1.0)
        pull = min(max(needed / max(motors, 1.0), 0.0), self.pulling)
        brake = max(-needed, 0.0)
        dynamic = min(brake / electric, 1.0) if electric else 0.0
        wanted = min(max(brake - dynamic * electric, 0.0) / max(full, 1.0), 1.0)
        change = PERIOD / MOVES[self._wired]
        self.air = float(np.clip(wanted, self.air - change, self.air + change))
        brakes = self.air >= LEAST / 2 or dynamic > 0.1
        self._looks = max(self._looks - PERIOD / (2 * ANSWERS[self._wired]), 0.0) if brakes else 1.0
        released = self.air < LEAST / 2
        train.inputs["traction"], train.inputs["dynamic_brake"] = pull if released else 0.0, dynamic
        if released:
            train.drive("running")
        else:
            train.drive("service", max(self.air - LEAST, 0.0) / (1 - LEAST))

    def drive(self, train: Train, seconds: float = LONGEST) -> Recording:
        """Drive a train to the last stop, or for a time [s], and record it each PERIOD.

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
        while len(self.calls) < len(self.stops) and train.time < end - PERIOD / 2:
            self.act(train)
            train.advance(PERIOD)
            rows.append(self._row(train, sums))
        notes = [note(f"The limit at {place:g} m", speed, "m/s") for place, speed in self.limits]
        return Recording(units, np.array(rows), [said for said in (*notes, *train.messages) if said])

    def _row(self, train: Train, sums: Sequence[str]) -> list[float]:
        own = [train.time, self.front(train), float(train.speed[0]), float(train.wheel_speed.max())]
        return own + [float(np.sum(getattr(train, name))) for name in sums]

"""A train and one vehicle in detail: as one system, or coupled by a host, with the predicted stability limits of that.

In each macro step of a host the train is computed first, with the vehicle's speed, and returns the coupler forces; the
vehicle follows.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm
from scipy.optimize import brentq

from fmu_src.kernel import Kernel, SimulationError
from products.coach import COACH, NUMBERS, brakes
from products.kernel_runs import prepare, system_of
from products.train.consist import Consist, coach, locomotive
from products.train.detail_columns import detail_of
from products.train.numbers import Settings
from products.train.train import Train
from rbd_model.train.coupler import Coupler, Curve, rigid

#: Mass of the coach [kg], and mass of its wheelsets' rotation over that [1].
MASS = COACH.body_mass + 2 * COACH.frame_mass + 4 * COACH.wheelset_mass
ROTATING = 4 * COACH.wheelset_pitch_inertia / COACH.wheel_radius**2 / MASS
#: Place of the detailed vehicle, number of vehicles of the train, and speed [m/s].
PLACE, VEHICLES, SPEED = 5, 12, 27.78
#: Speed of the body to which the couplers are attached, by level.
PULLED = {1: "state_speed", 2: "state_body_speed"}
#: Methods of a host, by the values of the input external_vehicle. With 'held' the vehicle's speed is constant in a
#: macro step. With 'corrected' the train contains a vehicle of the same mass, corrected by the detailed one's speed.
WAYS = {"held": 1.0, "corrected": 2.0}
#: Margin above 1 for eigenvalues of the train's free position and speed.
NEUTRAL = 1e-6
SPEED_AT = VEHICLES + PLACE
Matrix = NDArray[np.float64]


def consist_of(coupler: Coupler, level: int = 0, *places: int) -> Consist:
    """Return a locomotive and coaches of one mass; at these places, or at PLACE, in detail of a level (0: none)."""
    detail = detail_of({"detail": "coach", "level": level}) if level else None
    own = replace(coach(), mass=MASS, rotating_share=ROTATING, resistance=(0.0, 0.0, 0.0), coupler=coupler, length=20.0)
    head = replace(locomotive(), coupler=coupler, resistance=(0.0, 0.0, 0.0))
    vehicles = (head, *[own] * (VEHICLES - 1))
    there = places or (PLACE,)
    return Consist(tuple(replace(one, detail=detail) if n in there else one for n, one in enumerate(vehicles)))


@dataclass
class MixedTrain:
    """The train, its detailed vehicle, and their coupling; `forces`: of all couplers after each step [N]."""

    train: Train
    vehicle: Kernel
    level: int
    way: str

    def __post_init__(self) -> None:
        self.forces: list[Matrix] = []

    def step(self, size: float) -> None:
        """Advance by one macro step [s]."""
        train = self.train
        train.inputs["external_vehicle"][PLACE] = WAYS[self.way]
        train.inputs["external_vehicle_speed"][PLACE] = self.vehicle[PULLED[self.level]]
        train.advance(size)
        forces = train.mean_coupler_force if self.way == "corrected" else train.coupler_force
        brake = train.brake_force[PLACE]
        own = {"coupler_force_front": forces[PLACE - 1], "coupler_force_rear": -forces[PLACE]}
        self.vehicle.set(**own, **brakes(brake * COACH.wheel_radius / len(NUMBERS)))
        self.vehicle.advance(size)
        self.forces.append(train.coupler_force)


def mixed(coupler: Coupler, level: int, way: str, share: float = 0.4) -> MixedTrain:
    """Return the train at SPEED, with couplers without force."""
    train = Train(consist_of(coupler), speed=SPEED, settings=Settings(share=share))
    vehicle = prepare("vehicle", level=level, initial_speed=SPEED)
    vehicle.initialise()
    return MixedTrain(train, vehicle, level, way)


# ---- on paper --------------------------------------------------------------------------------------------------------


def _chain(stiffness: float, led: bool) -> Matrix:
    """Return the state matrix of places and speeds of the train without brakes; one vehicle's speed may be given."""
    masses = np.array([vehicle.mass * (1 + vehicle.rotating_share) for vehicle in consist_of(rigid()).vehicles])
    n = len(masses)
    stiff = np.zeros((n, n))
    for i in range(n - 1):
        stiff[i : i + 2, i : i + 2] += stiffness * np.array([[1.0, -1.0], [-1.0, 1.0]])
    slopes = np.zeros((2 * n, 2 * n))
    slopes[:n, n:] = np.eye(n)
    slopes[n:, :n] = -stiff / masses[:, None]
    if led:
        slopes[SPEED_AT] = 0.0
    return slopes


def _ends(stiffness: float) -> Matrix:
    """Return the forward force of both couplers on the vehicle per displacement [N/m]."""
    row = np.zeros(2 * VEHICLES)
    row[PLACE - 1 : PLACE + 2] = stiffness * np.array([1.0, -2.0, 1.0])
    return row


def held_exactly(slopes: Matrix, drive: Matrix, size: float) -> tuple[Matrix, Matrix]:
    """Return the transition matrices over a time, of the state and of inputs that are constant over it (zero-order
    hold).
    """
    n, m = slopes.shape[0], drive.shape[1]
    whole = expm(size * np.block([[slopes, drive], [np.zeros((m, n + m))]]))
    return whole[:n, :n], whole[:n, n:]


@dataclass(frozen=True)
class Linear:
    """The vehicle about a steady run: x' = A x + b F, pulled speed c x."""

    a: Matrix
    b: Matrix
    c: Matrix


def linear_vehicle(level: int) -> Linear:
    """Return the linear vehicle from the exact Jacobian of its kernel; it rolls freely."""
    vehicle = prepare("vehicle", level=level, initial_speed=SPEED)
    vehicle.initialise()
    vehicle.advance(1.0)
    place = vehicle.linearise().state
    a = np.array(vehicle.jacobian_at(vehicle.time, place))

    def slopes(force: float) -> Matrix:
        vehicle.set(coupler_force_front=force)
        return np.array(vehicle.slopes_at(vehicle.time, place))

    b = (slopes(1e3) - slopes(0.0)) / 1e3
    states = list(system_of("vehicle", level=level).states)
    c = np.zeros(len(place))
    c[states.index(PULLED[level].removeprefix("state_"))] = 1.0
    return Linear(a, b[:, None], c)


def growth(way: str, size: float, stiffness: float, vehicle: Linear) -> float:
    """Return the spectral radius of a macro step with linear couplers [1]; 1: disturbances neither grow nor decay.

    Takes size [s], stiffness [N/m].
    """
    n, m = 2 * VEHICLES, len(vehicle.c)
    own, driven = held_exactly(vehicle.a, vehicle.b, size)
    chain = _chain(stiffness, led=way != "corrected")
    both = expm(size * np.block([[chain, np.zeros((n, n))], [np.eye(n), np.zeros((n, n))]]))
    train, mean = both[:n, :n], both[n:, :n] / size
    ends = _ends(stiffness)
    give = np.zeros((n, n + m))  # state: train and vehicle
    give[:, :n] = np.eye(n)
    give[SPEED_AT, :n] = 0.0
    give[SPEED_AT, n:] = vehicle.c
    if way == "corrected":  # it is at the place to which the corrected speed has moved it
        give[PLACE, n:] = size / 2 * vehicle.c
        give[PLACE, SPEED_AT] = -size / 2
    after = train @ give
    pulled = ends @ (mean @ give if way == "corrected" else after)
    follow = driven @ np.atleast_2d(pulled)
    follow[:, n:] += own
    whole = np.vstack([after, follow])
    return float(np.abs(np.linalg.eigvals(whole)).max())


def boundary(way: str, stiffness: float, vehicle: Linear, least: float = 1e-4, most: float = 0.2) -> float:
    """Return the largest stable macro step with linear couplers.

    Takes stiffness [N/m], least, most [s]; returns [s].
    """

    def beyond(size: float) -> float:
        return growth(way, size, stiffness, vehicle) - 1.0 - NEUTRAL

    sizes = np.geomspace(least, most, 40)
    grows = [beyond(size) > 0.0 for size in sizes]
    if grows[0]:
        return 0.0
    if not any(grows):
        return float("inf")
    first = grows.index(True)
    return float(brentq(beyond, sizes[first - 1], sizes[first], rtol=1e-4))


# ---- as it runs ------------------------------------------------------------------------------------------------------

#: Steps of a run that shows whether a disturbance grows, by comparing its last two quarters. The disturbance [m/s];
#: steps of the couplers over their limit [1]; resolution of the boundary [1].
STEPS, DISTURBANCE, FINE, RESOLUTION = 600, 1e-3, 0.05, 0.01


def spring(stiffness: float) -> Coupler:
    """Return a coupler of equal stiffness in both directions, without friction [N/m]."""
    bar = Curve((0.0, 1.0), (0.0, stiffness))
    return Coupler("spring", stiffness, (bar, bar), (bar, bar))


def disturbed(way: str, level: int, stiffness: float) -> MixedTrain:
    """Return a rolling train with a small disturbance; takes stiffness [N/m]."""
    one = mixed(spring(stiffness), level, way, share=FINE)
    state = one.train.motion
    state[1:3, PLACE - 1] += DISTURBANCE
    one.train.motion = state
    return one


def growth_of_run(way: str, level: int, stiffness: float, size: float, steps: int) -> float:
    """Return the growth of a disturbance in a macro step, less 1, from the last half of a run.

    Takes stiffness [N/m], size [s].
    """
    one = disturbed(way, level, stiffness)
    for _ in range(steps):
        one.step(size)
    before, after = np.abs(one.forces).max(axis=1)[-(steps // 2) :].reshape(2, -1).max(axis=1)
    return float(np.expm1(np.log(after / before) / (steps // 4)))


def grows(way: str, level: int, stiffness: float, size: float) -> bool:
    """Return whether a small disturbance of a rolling train grows.

    Takes stiffness [N/m], size [s].
    """
    one = disturbed(way, level, stiffness)
    apart: list[float] = []
    for _ in range(STEPS):
        try:
            one.step(size)
        except (SimulationError, ValueError):  # it has left the range of its level or of the train
            return True
        apart.append(np.abs(one.forces[-1]).max())
        if apart[-1] > 30 * max(apart[:20]) > 0.0:
            return True
    return max(apart[-STEPS // 4 :]) > 1.1 * max(apart[-STEPS // 2 : -STEPS // 4])


def found_boundary(way: str, level: int, stiffness: float, paper: float) -> float:
    """Return the largest step without growth, by bisection from 0.75 to 1.25 of the predicted one.

    Takes stiffness [N/m], paper [s]; returns [s].
    """
    low, high = 0.75 * paper, 1.25 * paper
    if grows(way, level, stiffness, low) or not grows(way, level, stiffness, high):
        return float("nan")
    while high / low > 1.0 + RESOLUTION:
        middle = (low * high) ** 0.5
        low, high = (low, middle) if grows(way, level, stiffness, middle) else (middle, high)
    return (low * high) ** 0.5

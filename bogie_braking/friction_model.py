"""Speed of a vehicle whose wheels slide on a field of friction, from logged wheel speeds and places.

m dV/dt = -sum F_i - m g i - R(V). A wheelset that slides has the force of its creep law, with the friction of the field
at its place. One that rolls has the force that turns it, F r = T + J dw/dt, third line of (2.8), if its brake torque T
was logged. Axle loads follow the braking forces without delay, N = N_0 + M F, by the vehicle's planar model.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bogie_braking.friction_logs import FrictionLog
from bogie_braking.simulation import Simulation
from fmu_src.symbols import ca
from rbd_model.contact.friction import Surface
from rbd_model.track.line import Line
from rbd_model.vehicle.description import Vehicle, size_of
from rbd_model.vehicle.statics import statics
from rbd_model.wheelset.level_rail import CentredContact, centred_creep_force, centred_load, contact_stiffness

Numbers = NDArray[np.float64]
#: Slip ratio from which a wheelset is treated as sliding, and speed from which rows are used [m/s]; assumed. With
#: sensors of 100 teeth a slip of 3 % is certain; on slippery rails it is beyond the peak of adhesion.
SLIDES, LEAST_SPEED = 0.03, 3.0
#: Longest time between two rows over which is integrated, over the median step.
LONGEST_STEP = 5.0
#: Parameters of a rail that a fit takes as values, with the default: friction that neither falls nor is cleaned.
OF_RAIL = {
    "friction_ratio": 1.0,
    "friction_decay": 0.0,
    "adhesion_reduction": 1.0,
    "slip_reduction": 1.0,
    "cleaned_friction": 1.0,
}
#: Speed [m/s], torque [N.m], its rise [s] and length [s] of the runs for the transfer of loads; rounds of N_0 + M F.
SETTLING_SPEED, GENTLE, RAMP, SETTLED, ROUNDS = 30.0, 500.0, 2.0, 12.0, 3
RESISTANCE = ("davis_constant", "davis_linear", "davis_quadratic")


@dataclass(frozen=True)
class Axles:
    """Numbers of a vehicle: p: its parameters; loads [N] at rest, places from that of the vehicle [m], radii [m] and
    inertias [kg.m2] of its wheelsets; mass of all parts [kg].

    transfer: gain of each load by the braking force of each wheelset, shape (wheelsets, wheelsets) [N/N].
    """

    p: Mapping[str, float]
    mass: float
    loads: Numbers
    along: Numbers
    radii: Numbers
    inertias: Numbers
    poisson_ratio: float
    transfer: Numbers

    @classmethod
    def of(cls, vehicle: Vehicle, values: Mapping[str, float], runs: str | Vehicle) -> Axles:
        """Return those of a vehicle with other values of its parameters; runs: the same, or the name of its FMU."""
        p = {**vehicle.parameters.values(), **values}
        symbols = {name: ca.SX(value) for name, value in p.items()}
        resting = statics(vehicle, lambda size: ca.SX(size_of(size, symbols)), symbols["gravity"]).on_wheelset
        own = [float(size_of(wheelset.mass, p)) for wheelset in vehicle.wheelsets]
        above = [float(ca.evalf(ca.SX(force))) for force in resting.values()]
        return cls(
            p,
            sum(own) + sum(float(size_of(body.mass, p)) for body in vehicle.bodies),
            np.array(above) + p["gravity"] * np.array(own),
            np.array([float(size_of(one.along, p)) for one in vehicle.wheelsets]),
            np.array([float(size_of(one.mean_radius, p)) for one in vehicle.wheelsets]),
            np.array([float(size_of(one.inertia[1], p)) for one in vehicle.wheelsets]),
            vehicle.poisson_ratio,
            load_transfer(runs, len(vehicle.wheelsets), tuple(sorted(values.items()))),
        )

    @cached_property
    def force(self) -> ca.Function:
        """Braking force of the rails on a wheelset over its load [1], (3.97), and its derivative by the friction.

        Arguments: friction mu0, sliding speed and speed [m/s], load [N], contact stiffness [N^(1/3)], and A, B, k_A,
        k_S of Polach (2005).
        """
        friction, sliding, forward, load, stiffness = (ca.SX.sym(name) for name in ("mu", "w", "v", "n", "c"))
        ratio, decay, adhesion, slip = (ca.SX.sym(name) for name in ("a", "b", "k_a", "k_s"))
        surface = Surface(ratio, decay, 1 - ratio, adhesion, slip)
        speeds = sliding, forward, ca.SX(self.p["creepage_speed"])
        contact = CentredContact(stiffness)
        used = -centred_creep_force(surface, friction, contact, centred_load(load), speeds) / load
        given = [friction, sliding, forward, load, stiffness, ratio, decay, adhesion, slip]
        return ca.Function("used", given, [used, ca.gradient(used, friction)])

    @cached_property
    def of_size(self) -> dict[int, ca.Function]:
        """`force` for many rows at once, by their number: casadi takes a millisecond to make each."""
        return {}

    @cached_property
    def stiffnesses(self) -> Numbers:
        """Contact stiffness of each wheelset [N^(1/3)], as in (3.94)."""
        symbols = {name: ca.SX(value) for name, value in self.p.items()}
        found = [contact_stiffness(ca.SX(one), symbols, self.poisson_ratio) for one in self.radii.tolist()]
        return np.array([float(ca.evalf(one)) for one in found])

    def loads_under(self, used: Numbers, rolling: Numbers) -> Numbers:
        """Return the loads [N], shape (rows, wheelsets), where forces are `used` times load and those of rolling
        wheels [N].
        """
        loads = self.loads
        for _ in range(ROUNDS):
            loads = self.loads + (used * loads + rolling) @ self.transfer.T
        return loads

    def used(self, friction: Numbers, stretch: LogStretch, rail: Mapping[str, float]) -> list[Numbers]:
        """Return force over load and its derivative by friction, shape (rows, wheelsets); 0 where a wheelset rolls."""
        law = (rail["friction_ratio"], rail["friction_decay"], rail["adhesion_reduction"], rail["slip_reduction"])
        row, place = there = np.nonzero(stretch.ever)
        given = friction[there], stretch.sliding[there], stretch.speed[row], self.loads[place], self.stiffnesses[place]
        found = [np.zeros(friction.shape), np.zeros(friction.shape)]
        if row.size not in self.of_size:
            self.of_size[row.size] = self.force.map(row.size)
        fixed = [np.full((1, row.size), value) for value in law]
        answers = self.of_size[row.size](*(values[None, :] for values in given), *fixed)
        for whole, answer in zip(found, answers, strict=True):
            whole[there] = np.asarray(answer)[0]
        return found


@lru_cache(maxsize=32)
def load_transfer(vehicle: str | Vehicle, wheelsets: int, values: tuple[tuple[str, float], ...]) -> Numbers:
    """Return the gain of each axle load by the braking force of each wheelset, by runs of the planar model.

    In each run one wheelset brakes gently. Loads and forces are means over the time after the vehicle has settled.
    """
    numbers = range(1, wheelsets + 1)
    names = [f"{name}_{number}" for name in ("axle_load", "creep_force") for number in numbers]
    given: dict[str, Any] = {"level": 2.0, "initial_speed": SETTLING_SPEED} | dict(values)
    given |= {f"friction_{number}": 0.5 for number in numbers}
    rows = []
    for braked in (0, *numbers):
        torque = {f"brake_torque_{braked}": ([0.0, RAMP], [0.0, GENTLE])} if braked else {}
        run = Simulation(vehicle, None, **given, **torque).advance(SETTLED, names, 0.05)
        after = run["time"] > SETTLED / 2
        rows.append([float(run[name][after].mean()) for name in names])
    changes = np.array(rows[1:]) - rows[0]
    return np.asarray(np.linalg.solve(-changes[:, wheelsets:], changes[:, :wheelsets]).T)


@dataclass(frozen=True)
class LogStretch:
    """Rows of a log over which the speed is integrated.

    known, by_torque: change of speed in a step [m/s], by gravity, resistance and the inertia of rolling wheelsets, and
    by their brake torques. rolling: braking forces of rolling wheelsets [N].
    """

    log: int
    time: Numbers  # [s]
    speed: Numbers  # logged [m/s], shape (rows,)
    sliding: Numbers  # sliding speeds [m/s], shape (rows, wheelsets)
    slides: NDArray[np.bool_]  # whether a wheelset slides in a step, shape (steps, wheelsets)
    known: Numbers  # shape (steps,)
    by_torque: Numbers  # shape (steps,)
    rolling: Numbers  # shape (rows, wheelsets)
    hats: Numbers  # weight of each knot at each wheelset, shape (rows, wheelsets, knots)

    @cached_property
    def ever(self) -> NDArray[np.bool_]:
        """Rows in which a wheelset slides in the step before or after, shape (rows, wheelsets)."""
        none = np.zeros((1, self.slides.shape[1]), bool)
        return np.asarray(np.vstack([self.slides, none]) | np.vstack([none, self.slides]))

    def model(self, axles: Axles, knots: Numbers, rail: Mapping[str, float], torque: float) -> tuple[Numbers, Numbers]:
        """Return the gain of speed since the first row [m/s], and its derivatives by knots and torque.

        Shapes (rows,) and (rows, knots + 1). torque: factor on the logged torques.
        """
        cleaned = rail["cleaned_friction"] ** np.arange(axles.loads.size)
        friction = np.maximum(self.hats @ knots, 1e-6) * cleaned
        used, slope = axles.used(friction, self, rail)
        share = axles.loads_under(used, torque * self.rolling) / axles.mass
        used, slope = share * used, share * slope
        of_step = self.slides * np.diff(self.time)[:, None] / 2
        gain = self.known + torque * self.by_torque - np.sum(of_step * (used[1:] + used[:-1]), axis=1)
        by_knot = (slope * cleaned)[:, :, None] * self.hats
        slopes = np.c_[-np.einsum("sw,swk->sk", of_step, by_knot[1:] + by_knot[:-1]), self.by_torque]
        return np.r_[0.0, np.cumsum(gain)], np.vstack([np.zeros(slopes.shape[1]), np.cumsum(slopes, axis=0)])


def stretches_of(log: FrictionLog, number: int, axles: Axles, places: Numbers, line: Line | None) -> list[LogStretch]:
    """Return the stretches of a log in which each wheelset slides, or rolls with a logged torque.

    A stretch in which no wheelset slides at all is left out.
    """
    sliding = log.speed[:, None] - log.wheel_speed
    slides = np.abs(sliding) > SLIDES * log.speed[:, None]
    at = log.distance[:, None] + axles.along
    inside = (at >= places[0]) & (at <= places[-1])
    step = np.diff(log.time)
    both = slides[1:] & slides[:-1]
    rolls = np.isfinite(log.torque[1:] + log.torque[:-1] + sliding[1:] + sliding[:-1])
    usable = np.where(both, inside[1:] & inside[:-1], rolls).all(axis=1)
    usable &= (np.minimum(log.speed[1:], log.speed[:-1]) > LEAST_SPEED) & (step <= LONGEST_STEP * np.median(step))
    known = _known(log, axles, line, step)
    turned = axles.inertias * np.diff(log.wheel_speed / axles.radii, axis=0)
    torque = np.where(both, 0.0, np.nan_to_num(log.torque[1:] + log.torque[:-1]) / 2 * step[:, None])
    known = known - np.sum(np.where(both, 0.0, np.nan_to_num(turned)) / axles.radii, axis=1) / axles.mass
    by_torque = -np.sum(torque / axles.radii, axis=1) / axles.mass
    hats = hats_of(np.clip(at, places[0], places[-1]), places)
    edges = np.flatnonzero(np.diff(np.r_[False, usable, False].astype(int)))
    found = []
    for first, last in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        rows, steps = slice(first, last + 1), slice(first, last)
        if both[steps].any():
            row = log.time[rows], log.speed[rows], np.nan_to_num(sliding[rows])
            rolling = np.where(slides[rows], 0.0, np.nan_to_num(log.torque[rows])) / axles.radii
            found.append(LogStretch(number, *row, both[steps], known[steps], by_torque[steps], rolling, hats[rows]))
    return found


def _known(log: FrictionLog, axles: Axles, line: Line | None, step: Numbers) -> Numbers:
    """Return the change of speed by gravity and running resistance (Davis 1926) in each step [m/s]."""
    constant, linear, quadratic = (axles.p.get(name, 0.0) for name in RESISTANCE)
    slowing = (constant + linear * log.speed + quadratic * log.speed**2) / axles.mass
    if line is not None:
        slowing = slowing + axles.p["gravity"] * line.value("gradient", log.distance)
    return np.asarray(-(slowing[1:] + slowing[:-1]) / 2 * step)


def hats_of(at: Numbers, places: Numbers) -> Numbers:
    """Return the weight of each knot at places, shape (*at.shape, knots): a field is linear between knots."""
    behind = np.clip(np.searchsorted(places, at, "right"), 1, places.size - 1)
    share = (at - places[behind - 1]) / (places[behind] - places[behind - 1])
    found = np.zeros((*at.shape, places.size))
    np.put_along_axis(found, (behind - 1)[..., None], (1 - share)[..., None], -1)
    np.put_along_axis(found, behind[..., None], share[..., None], -1)
    return found


def used_adhesion(log: FrictionLog, axles: Axles, over: float) -> tuple[Numbers, Numbers]:
    """Return places [m] of wheelsets and the mean adhesion that they use there, in moments in which none slides.

    It is the deceleration over g, by straight lines through the speed over a time [s].
    """
    slides = np.abs(log.speed[:, None] - log.wheel_speed) > SLIDES * log.speed[:, None]
    known = np.isfinite(log.wheel_speed).all(axis=1) & ~slides.any(axis=1) & (log.speed > LEAST_SPEED)
    places, used = [np.zeros(0)], [np.zeros(0)]
    for begin in np.arange(log.time[0], log.time[-1], over / 2):
        rows = (log.time >= begin) & (log.time <= begin + over)
        if np.sum(rows) < 3 or not known[rows].all():
            continue
        slope = np.polyfit(log.time[rows] - begin, log.speed[rows], 1)[0]
        places.append(np.mean(log.distance[rows]) + axles.along)
        used.append(np.full(axles.along.size, -slope / axles.p["gravity"]))
    return np.concatenate(places), np.concatenate(used)

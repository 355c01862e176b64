"""Largest available deceleration on a rail: a run with the best slip at every instant."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from scipy.integrate import solve_ivp

from brake_controller.discs import MEAN_PAD_FRICTION, pad_friction
from fmu_src.kernel import Kernel
from products.machine import DISCS, SANDERS, TRACTION, Machine, filling_by_flow
from products.protection.compiled_machine import machine_kernel, machine_table, own_values
from products.protection.rails import ABOVE
from products.protection.runs import Stop
from products.protection.settings import BRAKE_START, LONGEST, STANDING
from rbd_model.levels.resistance import curve_share
from rbd_model.track.line import Line


class PeakAdhesion:
    """Largest deceleration that a rail allows, from a vehicle's own equations: the creep force at its best slip.

    The model is planar. With traction it is the largest acceleration.

    rail: inputs and parameters of the vehicle with its cylinders, and equipment, as in `Run`.
    filling: share of the full pressure as a function of the time since the
    demand [s]; by default from the air flow model. line: with its gradient, curvature and friction.
    """

    #: Tested slip ratios, and number of evaluated instants of a stop.
    SLIPS, INSTANTS = np.geomspace(2e-3, 0.4, 28), 50

    def __init__(
        self,
        machine: Machine,
        rail: Mapping[str, float],
        filling: Callable[[float], float] | None = None,
        equipment: tuple[str, ...] = (),
        line: Line | None = None,
    ) -> None:
        self.filling, self.equipment = filling or filling_by_flow(machine.full_pressure), equipment
        body, empty = f"{machine.counted}_mass", machine.parameters.values()
        #: Load of the vehicle [kg]: the mass of its counted body less its own mass.
        self.load = rail.get(body, empty[body]) - empty[body]
        self.mass, self.turning_mass = machine.mass + self.load, machine.turning_mass(self.load)
        self.line, self.rail = line, rail
        self.driven = TRACTION in equipment
        self.machine = replace(machine, by_flow=not self.driven, equipment=equipment)
        on_line = line is not None
        own = own_values(self.machine, on_line=on_line)
        self.kernel = Kernel(machine_kernel(self.machine, on_line), initial_speed=25.0, **{**own, **rail})
        if line is not None:
            with TemporaryDirectory() as folder:  # a kernel reads a line once and keeps it
                self.kernel.set(line_file=str(line.write(Path(folder) / "line.csv")))
        self.kernel.initialise()
        model, self.states = machine_table(self.machine, on_line=on_line)
        self.place = np.array(self.kernel.linearise().state)
        self.sanded_from, self._peak = 0.0, 0
        self.values = {variable.name: variable.start for variable in model.variables} | {**own, **rail}

    def held_back(self, distance: float, speed: float) -> float:
        """Return the deceleration by gradient, curve and running resistance (Davis) at a place and a speed [m/s2]."""
        a, b, c = (self.values[f"davis_{name}"] for name in ("constant", "linear", "quadratic"))
        runs, gravity = (a + b * speed + c * speed**2) / self.mass, self.machine.parameters.gravity
        gradient, curvature = (
            self.rail.get(name, 0.0) if self.line is None else float(self.line.value(name, distance))
            for name in ("gradient", "curvature")
        )
        curve = float(curve_share(abs(curvature)))
        return gravity * (math.sin(math.atan(gradient)) + self.rail.get("curve_resistance", 0.0) * curve) + runs

    def at(self, distance: float, speed: float, slip: float) -> float:
        """Return the deceleration [m/s2] with all wheelsets at a slip ratio and loads at rest; driven, the
        acceleration.
        """
        place, machine, sign = self.place.copy(), self.machine, -1.0 if self.driven else 1.0
        if SANDERS in self.equipment:
            place[self.states.index("sanded_way")] = max(distance - self.sanded_from, 0.0)
        place[self.states.index(f"{machine.counted}_distance")] = distance
        place[self.states.index(f"{machine.counted}_speed")] = speed
        for number in machine.numbers:
            rolling = speed / machine.parameters.wheel_radius
            place[self.states.index(f"angular_velocity_{number}")] = (1.0 - sign * slip) * rolling
        self.kernel.arrive(self.kernel.time, place.tolist())
        return -sign * sum(self.kernel[f"creep_force_{number}"] for number in machine.numbers) / self.mass

    def best(self, distance: float, speed: float) -> tuple[float, float]:
        """Return the largest deceleration [m/s2], and the slip ratio at which it is reached."""
        found = [self.at(distance, speed, slip) for slip in self.SLIPS]
        return max(found), float(self.SLIPS[int(np.argmax(found))])

    def best_near(self, distance: float, speed: float) -> float:
        """Return the largest deceleration [m/s2], climbing along the slips from the best slip of the last call.

        The creep force rises to one peak and falls behind it, so neighbours suffice.
        """
        found: dict[int, float] = {}

        def at(place: int) -> float:
            if place not in found:
                found[place] = self.at(distance, speed, float(self.SLIPS[place]))
            return found[place]

        place, last = self._peak, len(self.SLIPS) - 1
        while place < last and at(place + 1) > at(place):
            place += 1
        while place > 0 and at(place - 1) > at(place):
            place -= 1
        self._peak = place
        return at(place)

    def stopping_distance(self, speed: float, brake_ratio: float = 1.0) -> float:
        """Return the distance [m] of a stop with the best slip, or with the brake's deceleration where that is lower.

        If the brake limits the deceleration everywhere, the result is the brake's distance and independent of the rail:
        see `used`.

        Takes speed [m/s].
        """
        return self._distance(speed, STANDING, brake_ratio)

    def starting_distance(self, start: float, speed: float, brake_ratio: float = 1.0) -> float:
        """Return the distance [m] of a vehicle with traction from `start` to `speed` [m/s], with the best slip."""
        return self._distance(start, speed, brake_ratio)

    def _distance(self, start: float, end: float, brake_ratio: float) -> float:
        sign = 1.0 if self.driven else -1.0
        if SANDERS in self.equipment:
            self.sanded_from = start * (self.values["sand_start"] + self.values["sand_delay"])

        def slope(time: float, state: np.ndarray) -> list[float]:
            speed = max(state[1], STANDING)
            most = self.best_near(state[0], speed)
            held = self.held_back(state[0], speed)
            by_brake = sign * self.asked(time, speed, start, brake_ratio) - held * self.mass / self.turning_mass
            return [state[1], min(by_brake, sign * most - held, key=lambda one: sign * one)]

        def there(time: float, state: np.ndarray) -> float:
            return float(state[1]) - end

        there.terminal = True  # type: ignore[attr-defined]
        found = solve_ivp(slope, (0.0, LONGEST), [0.0, start], events=there, max_step=0.25, rtol=1e-3, atol=1e-2)
        if not found.t_events[0].size:
            does = f"brings the vehicle to {end:g} m/s" if self.driven else f"stops the vehicle from {start:g} m/s"
            raise ValueError(f"The rail must be one that {does} within {LONGEST:g} s; got one that does not.")
        return float(found.y[0, -1])

    def used(self, stop: Stop) -> np.ndarray:
        """Return the braking force over the largest that the rail allows at that speed and place, shape (INSTANTS,).

        The instants span the interval in which the vehicle was braked and faster than ABOVE.
        """
        course = stop.course
        looked_at = np.flatnonzero(course.braked(ABOVE))
        instants = looked_at[np.linspace(0, looked_at.size - 1, self.INSTANTS).astype(int)]
        largest = [self.mass * self.best(course.distance[i], course.speed[i])[0] for i in instants]
        return np.asarray(-course.creep_force[instants].sum(axis=1) / largest)

    def asked(self, time: float, speed: float, start: float, brake_ratio: float) -> float:
        """Return the deceleration, or driven acceleration, that is demanded of brake or motors [m/s2].

        Takes time [s], speed [m/s], start [m/s].
        """
        since, machine = time - BRAKE_START, self.machine
        motor = self.motor_share(speed, since) * self.values.get("motor_torque", 0.0)
        if self.driven:
            return brake_ratio * machine.deceleration(motor, self.load)
        full = brake_ratio * machine.full_torque
        by_motor = min(motor / full, 1.0)
        friction = min(self.filling(since), 1.0 - by_motor)
        if DISCS in self.equipment:
            friction *= self.pad_friction(speed, start) / MEAN_PAD_FRICTION
        return (by_motor + friction) * machine.deceleration(full, self.load)

    def motor_share(self, speed: float, since: float) -> float:
        """Return the torque of a motor over its largest [1], at a time after its full demand [s]; 0 without a motor.

        This is an independent implementation: the rig, whose motors are those of brake_controller/motors.py, is checked
        against it.
        """
        if "motor_torque" not in self.values or since <= 0.0:
            return 0.0
        turning = speed / self.machine.parameters.wheel_radius
        share = min(1.0, self.values["motor_power"] / (self.values["motor_torque"] * turning))
        fades = 1.0 if self.driven else min(1.0, turning / self.values["fade_speed"])
        return share * fades * (1.0 - 20.0 ** (-since / self.values["motor_rise_time"]))

    def pad_friction(self, speed: float, start: float) -> float:
        """Return the friction of pads on discs that absorbed all kinetic energy since the start, without cooling."""
        v, machine = self.values, self.machine
        motion = self.mass * (start**2 - speed**2) / 2 * v["disc_heat_share"]
        warmer = motion / (len(machine.numbers) * v["disc_mass"] * v["disc_heat_capacity"])
        rubbing = speed * v["friction_radius"] / machine.parameters.wheel_radius
        temperature = v["initial_disc_temperature"] + warmer
        return float(pad_friction(v, rubbing, temperature))

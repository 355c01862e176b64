"""Forces that drivers reckon with: the largest ones of a train over speed, and those of gradient and curves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from brake_controller.distributors import kind_of
from brake_controller.electric_brake import blending
from brake_controller.traction import driving
from products.train.consist import Consist, TrainVehicle, forces_of
from rbd_model.levels.resistance import curve_share
from rbd_model.track.adhesion_laws import at_speed
from rbd_model.track.line import Line
from rbd_model.train.vehicle import GRAVITY

#: Speeds of the forces that the driver knows [m/s].
SPEEDS = np.linspace(0.0, 150.0, 1501)
#: Largest curvature of the law of curve resistance, as trains take it [1/m].
TIGHTEST = 1.0 / 60.0


def _vehicle_forces(train_vehicle: TrainVehicle) -> np.ndarray:
    """Return the largest forces of a vehicle over SPEEDS [N], shape (5, n).

    Rows: motors; electric brake that the input `dynamic_brake` controls; air brake; weight on driven wheels times the
    fall of adhesion by Curtius and Kniffler; electric brake, also if the driver's valve controls it.
    """
    wired = kind_of(train_vehicle.distributor).wired  # the driver's valve demands both brakes of such a vehicle
    motors = list(replace(train_vehicle.traction, traction_rise=0.0).values().values())
    brake = list(replace(train_vehicle.electric, dynamic_rise=0.0, blended_pressure=0.0).values().values())
    speed = SPEEDS[None, :]

    def each(values: list[float]) -> np.ndarray:
        return np.tile(np.array(values)[:, None], SPEEDS.size)

    pulls = driving()(speed, each([1.0, 0.0, 1.0]), each(motors))
    brakes = blending()(
        speed, each([0.0, 1.0, 0.0, 1.0]), each(list(train_vehicle.brake.values().values())), each(brake)
    )
    air = forces_of(train_vehicle.brake, np.full(SPEEDS.size, train_vehicle.distributor.full_pressure), SPEEDS)
    weight = train_vehicle.mass * GRAVITY * train_vehicle.braked_share * (train_vehicle.traction.traction_force > 0.0)
    grips = weight * at_speed(SPEEDS) / at_speed(0.0)
    electric = np.asarray(brakes)[0]
    return np.vstack([np.asarray(pulls)[0], 0.0 * SPEEDS if wired else electric, air, grips, electric])


def train_forces(consist: Consist) -> np.ndarray:
    """Return the sums of `_vehicle_forces` over a train, shape (5, n)."""
    found: dict[TrainVehicle, np.ndarray] = {}
    total = np.zeros((5, SPEEDS.size))
    for vehicle in consist.vehicles:
        if vehicle not in found:
            found[vehicle] = _vehicle_forces(vehicle)
        total += found[vehicle]
    return total


def moved_mass(consist: Consist) -> float:
    """Return the mass of a train with its rotating parts [kg]."""
    return sum(vehicle.moved_mass for vehicle in consist.vehicles)


def resistance_of(consist: Consist) -> tuple[float, float, float]:
    """Return a, b, c of the running resistance of a train, a + b v + c v^2 [N]."""
    a, b, c = np.sum([vehicle.resistance for vehicle in consist.vehicles], axis=0)
    return float(a), float(b), float(c)


def _heights(line: Line, places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the height of a line over its first point [m]; gradients are linear between points, constant beyond."""
    at, gradient = line.rows["distance"], line.rows.get("gradient", np.zeros(len(line.rows["distance"])))
    nodes = np.union1d(at, places)
    slopes = np.interp(nodes, at, gradient)
    rises = np.concatenate([[0.0], np.cumsum(np.diff(nodes) * (slopes[1:] + slopes[:-1]) / 2)])
    return np.asarray(np.interp(places, nodes, rises - np.interp(at[0], nodes, rises)))


def line_force(consist: Consist, line: Line | None, fronts: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the force of gradient and curves against a train [N] at places of its front [m], as the train has it.

    Weight is distributed over the length of a vehicle. The resistance of curves is that at its middle.
    """
    total = np.zeros(len(fronts))
    if line is None:
        return total
    back = np.array(fronts, float)
    bend = line.rows.get("curvature")
    for vehicle in consist.vehicles:
        ahead, back, weight = back, back - vehicle.length, vehicle.mass * GRAVITY
        total += weight * (_heights(line, ahead) - _heights(line, back)) / vehicle.length
        if bend is not None and np.any(bend):
            curvature = np.abs(np.interp((ahead + back) / 2, line.rows["distance"], bend, left=0.0, right=0.0))
            total += weight * curve_share(np.minimum(curvature, TIGHTEST))
    return total

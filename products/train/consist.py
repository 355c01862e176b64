"""A consist: the vehicles of a train from head to end, each with its pipe, its brake and the coupler behind it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from brake_controller.air import AMBIENT
from brake_controller.brake_heat import NO_BRAKE_HEAT, BrakeHeat
from brake_controller.brake_weight import (
    FROM_100,
    NOTHING,
    SPEEDS,
    VEHICLE_BUILD_UP,
    braked_weight,
    braking_way,
    force_beside,
    percentage_of_vehicle,
    train_percentage,
)
from brake_controller.direct_brake import NO_DIRECT_BRAKE, DirectBrake
from brake_controller.distributors.aar import FreightCar
from brake_controller.distributors.distributor import DistributorParameters
from brake_controller.distributors.uic import freight
from brake_controller.drivers_valve import DriversValve, drivers_valve
from brake_controller.electric_brake import NO_ELECTRIC_BRAKE, ElectricBrake
from brake_controller.main_reservoir import NO_MAIN_RESERVOIR, MainReservoir
from brake_controller.parking_brake import NO_PARKING_BRAKE, ParkingBrake
from brake_controller.track_brakes import NO_TRACK_BRAKES, TrackBrakes
from brake_controller.traction import NO_TRACTION, Traction
from brake_controller.vacuum_valve import VacuumValve
from brake_controller.vehicle_brake import FRICTIONS, VehicleBrake, brake_force
from brake_controller.vehicle_protection import NO_PROTECTION, VehicleProtection
from brake_controller.vigilance import NO_VIGILANCE, Vigilance
from products.train.detail import Detail
from products.train.running_resistance import Formula, formula_of
from rbd_model.train.coupler import Coupler, screw_coupler
from rbd_model.train.vehicle import GRAVITY, MOTION

#: Hose at each end of a vehicle [m], as train simulators print it.
HOSE = 0.62
#: Mass of rotating parts at the rim, relative to the vehicle's, as in RailProfAC's shunting stops.
ROTATING = 0.04
#: Masses without a load [kg].
WAGON, LOCOMOTIVE, COACH = 20e3, 84e3, 46e3
#: Largest mass of a wagon that brakes as an empty one [kg]. Assumed.
EMPTY_UP_TO = 40e3
#: Brake weight percentage of kinds without data of their cylinders [%]. Assumed.
PERCENTAGE = {"locomotive": 85.0, "coach": 135.0}
#: Length of a vehicle at most [m].
LONGEST_VEHICLE = 31.0


@dataclass(frozen=True)
class TrainVehicle:
    """A vehicle: masses [kg], lengths [m], resistance a + b v + c v^2 [N, N.s/m, N.s2/m2].

    braked_share: share of its weight on braked wheels. distributor_at: position of its distributor, as a share of its
    length. name: any text. valve: driver's valve, at its front end (at its back end in the last vehicle); leads:
    whether it is the head's; valve_delay: delay after the first valve of the train [s], below 0: it does not follow.
    friction_ratio, friction_decay [s/m]: fall of the friction with the sliding speed (Polach (2005)).
    leak: effective area of the leaks of its pipe [m2]; branch: volume of its branches [m3]. adhesion: law by its name.
    controller: of its wheel-slide protection: `none`, `built-in`, or a file.
    handle: that of its driver's valve, whose notches have names (drivers_valves.toml); empty: positions alone.
    detail: the vehicle that is computed in its place.
    """

    kind: str
    mass: float
    length: float
    distributor: DistributorParameters
    brake: VehicleBrake
    coupler: Coupler = field(default_factory=screw_coupler)
    rotating_share: float = ROTATING
    braked_share: float = 1.0
    friction_ratio: float = 1.0
    friction_decay: float = 0.0
    resistance: tuple[float, float, float] = (0.0, 0.0, 0.0)
    distributor_at: float = 0.5
    pipe_diameter: float = 0.03175
    leak: float = 0.0
    branch: float = 0.0
    valve: DriversValve | VacuumValve | None = None
    valve_delay: float = -1.0
    leads: bool = False
    name: str = ""
    electric: ElectricBrake = NO_ELECTRIC_BRAKE
    heat: BrakeHeat = NO_BRAKE_HEAT
    track: TrackBrakes = NO_TRACK_BRAKES
    parking: ParkingBrake = NO_PARKING_BRAKE
    traction: Traction = NO_TRACTION
    adhesion: str = "input"
    protection: VehicleProtection = NO_PROTECTION
    controller: str = "none"
    handle: str = ""
    detail: Detail | None = None
    direct: DirectBrake = NO_DIRECT_BRAKE
    main_reservoir: MainReservoir = NO_MAIN_RESERVOIR
    vigilance: Vigilance = NO_VIGILANCE

    def motion(self) -> dict[str, float]:
        """Constants of its motion, MOTION of rbd_model/train/vehicle.py."""
        weight = self.mass * GRAVITY * self.braked_share
        shape = [self.friction_ratio, self.friction_decay, *self.resistance]
        numbers = [self.mass, self.rotating_share * self.mass, weight, *shape]
        return dict(zip((one.name for one in MOTION), numbers, strict=True))

    @property
    def formula(self) -> Formula:
        """Formula of the running resistance of its kind, with which `resistance` is not stated."""
        return formula_of(self.kind, isinstance(self.distributor, FreightCar))

    @property
    def percentage(self) -> float:
        """Brake weight percentage [%] of its full cylinders from 100 km/h; 0 if the stop is longer than that of 0 %.

        S = T v + int m v / (F + R) dv (EN 14531-1).
        """
        force = forces_of(self.brake, np.full(SPEEDS.size, self.distributor.full_pressure), SPEEDS)
        if not force.any():
            return 0.0
        way = braking_way(force, self.moved_mass, self.resistance)
        stop = VEHICLE_BUILD_UP * FROM_100.speed + way
        return percentage_of_vehicle(stop, FROM_100) if stop < FROM_100.constant / FROM_100.offset else 0.0

    @property
    def moved_mass(self) -> float:
        """Mass with its rotating parts [kg]."""
        return (1 + self.rotating_share) * self.mass

    @property
    def sensors(self) -> int:
        """Number of wheel speeds of its wheel-slide controller: a vehicle in detail has one for each wheelset."""
        return len(self.detail.vehicle.wheelsets) if self.detail else 1

    @property
    def sensed(self) -> VehicleProtection:
        """Its protection; that of a vehicle in detail has its wheelsets and wheels. Raises ValueError."""
        if self.detail is None or not self.protection.controller:
            return self.protection
        if self.direct.direct_pressure:
            raise ValueError(
                "direct_pressure must be left out with detail and protection: valves of wheelsets do not act on direct "
                "brakes. Leave one of them out."
            )
        return replace(self.protection, wheelsets=float(self.sensors), wheel_radius=self.detail.radius)

    @property
    def pipe_length(self) -> float:
        """Length of its pipe with both hoses [m]."""
        return self.length + 2 * HOSE


def forces_of(
    brake: VehicleBrake, pressure: float | NDArray[np.float64], speed: float | NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return brake forces at the rim [N] by gauge pressures [Pa] and speeds [m/s], one of each, eqs (2.4) to (2.7)."""
    return np.asarray(brake_force(pressure + AMBIENT, speed, brake.values()))


def braked_by(
    percentage: float,
    mass: float,
    resistance: Sequence[float] = (0.0, 0.0, 0.0),
    rotating: float = ROTATING,
    pressure: float = 380e3,
    beside: NDArray[np.float64] = NOTHING,
) -> VehicleBrake:
    """Return shoes of constant friction that give a mass [kg] a brake weight percentage [%] (UIC 544-1).

    A resistance (a, b, c) does not change the stopping distance of the percentage: the force of the shoes is reduced by
    it. rotating: share of the rotating masses [1]; pressure: that of the full cylinder [Pa]; beside: further forces of
    the percentage, at SPEEDS [N].
    """
    return braked_with(force_beside(resistance, percentage, (1 + rotating) * mass, beside), pressure)


def braked_with(force: float, pressure: float = 380e3) -> VehicleBrake:
    """Return shoes of constant friction with a force at the rims [N] at a pressure of the full cylinder [Pa]."""
    return VehicleBrake(
        force_per_pressure=force / pressure / 0.3,
        counter_force=0.0,
        efficiency=1.0,
        shoes=8.0,
        friction_law=0.0,
        constant_friction=0.3,
    )


def wagon(load: float = 60e3, position: str = "P", weighing: str = "lever") -> TrainVehicle:
    """Return a four-axle wagon of 20 t and 14 m with 16 composite blocks; load [kg].

    Cylinder of 406 mm, rigging of ratio 5.65 and efficiency 0.83, return force 1500 N, and the friction `composite`:
    those of RailProfAC's shunting stops. Assumed: up to 40 t it brakes with two fifths of that (a lever for empty and
    loaded); with continuous weighing the brake force is in proportion to its mass over 80 t. Without weighing, `none`,
    it is that of a loaded wagon.
    """
    mass = WAGON + load
    by_lever = 1.0 if mass > EMPTY_UP_TO else 0.4
    weighed = {"continuous": mass / 80e3, "none": 1.0}.get(weighing, by_lever)
    area = math.pi / 4 * 0.406**2
    brake = VehicleBrake(
        force_per_pressure=weighed * 5.65 * area,
        counter_force=weighed * 5.65 * 1500.0,
        efficiency=0.83,
        shoes=16.0,
        constant_friction=0.0,
        **FRICTIONS["composite"],
    )
    return TrainVehicle("wagon", mass, 14.0, freight(position), brake, resistance=formula_of("wagon").of(mass))


def locomotive(load: float = 0.0, position: str = "P") -> TrainVehicle:
    """Return a four-axle locomotive of 84 t and 19 m with a driver's valve.

    Assumed: a brake weight percentage of 85 %.
    """
    mass = LOCOMOTIVE + load
    resistance = formula_of("locomotive").of(mass)
    return TrainVehicle(
        "locomotive",
        mass,
        19.0,
        freight(position),
        braked_by(PERCENTAGE["locomotive"], mass, resistance),
        resistance=resistance,
        valve=drivers_valve(),
    )


def coach(load: float = 0.0, position: str = "P") -> TrainVehicle:
    """Return a coach of 46 t and 26.4 m with discs. Assumed: a brake weight percentage of 135 % for any load."""
    mass = COACH + load
    resistance = formula_of("coach").of(mass)
    brake = braked_by(PERCENTAGE["coach"], mass, resistance)
    return TrainVehicle("coach", mass, 26.4, freight(position), brake, resistance=resistance)


#: Functions of load [kg] and position, by the names in consists.
KINDS: dict[str, Callable[..., TrainVehicle]] = {"wagon": wagon, "locomotive": locomotive, "coach": coach}
#: Mass of each without a load [kg].
EMPTY = {"wagon": WAGON, "locomotive": LOCOMOTIVE, "coach": COACH}


@dataclass(frozen=True)
class Consist:
    """Vehicles from head to end; leading is the first. At least one has a driver's valve.

    notes: how names and words of its rows are read, and what is assumed.
    """

    vehicles: tuple[TrainVehicle, ...]
    notes: tuple[str, ...] = field(default=(), compare=False)

    @property
    def length(self) -> float:
        """Length from the front of the first to the back of the last vehicle [m]."""
        return sum(vehicle.length for vehicle in self.vehicles)

    @property
    def mass(self) -> float:
        """Mass of all vehicles [kg]."""
        return sum(vehicle.mass for vehicle in self.vehicles)

    @property
    def unprotected(self) -> Consist:
        """The same vehicles without wheel-slide protection, for stops in which wheels roll."""
        none = {"protection": NO_PROTECTION, "controller": "none"}
        return replace(self, vehicles=tuple(replace(one, **none) for one in self.vehicles))  # type: ignore[arg-type]

    @property
    def charged_pressure(self) -> float:
        """Gauge pressure of the charged pipe [Pa], below 0 if it holds a vacuum."""
        return next(vehicle.valve.running for vehicle in self.vehicles if vehicle.valve is not None)

    @property
    def percentage(self) -> float:
        """Brake weight percentage of the train [%], all braked weights over all masses (UIC 544-1)."""
        masses = [vehicle.mass for vehicle in self.vehicles]
        own = [(one.percentage, one.mass) for one in self.vehicles]
        weights = [braked_weight(percentage, mass) if percentage > 0.0 else 0.0 for percentage, mass in own]
        return train_percentage(weights, masses)


def block_train(wagons: int, load: float = 60e3, position: str = "P", fast_from: int = 0, **changes: object) -> Consist:
    """Return a locomotive and equal wagons.

    fast_from: number of vehicles at the head that brake in position G; changes: of wagons, whose coupler is the
    locomotive's too.
    """
    own = [replace(wagon(load, position), **changes) for _ in range(wagons)]  # type: ignore[arg-type]
    head = locomotive(0.0, position)
    everything = [replace(head, coupler=own[0].coupler) if own else head, *own]
    return Consist(
        tuple(replace(v, distributor=freight("G")) if n < fast_from else v for n, v in enumerate(everything))
    )

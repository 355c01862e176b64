"""A bogie or a vehicle with a brake cylinder on each wheelset: its numbers, and its FMUs coupled."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from types import TracebackType

from fmu_src.cosimulation.master import Connection, Coupling
from fmu_src.cosimulation.slave import Slave
from products import braked_vehicle
from products.bogie import BOGIE, FULL_PRESSURE, FULL_TORQUE, brake_values
from products.building import up_to_date
from products.coach import COACH
from rbd_model.vehicle.parameters import BogieParameters, VehicleParameters

#: Speed at which a machine counts as standing [m/s].
STANDING = 0.02
#: Application and release of a cylinder with its dump valve [s]; assumed: common values of passenger stock.
APPLICATION_TIME, RELEASE_TIME = braked_vehicle.APPLICATION_TIME, braked_vehicle.RELEASE_TIME


@dataclass(frozen=True)
class Machine:
    """What is braked: its FMU, numbers of its wheelsets, mass [kg], and the full brake of one wheelset [Pa], [N.m].

    counted: the body whose distance and speed are states.
    """

    fmu: str
    numbers: tuple[int, ...]
    parameters: BogieParameters
    mass: float
    counted: str
    full_pressure: float
    full_torque: float
    brake: Mapping[str, float]

    def deceleration(self, torque: float) -> float:
        """On a dry rail with this torque on each wheelset [N.m], whose rotation is included [m/s2]."""
        p, count = self.parameters, len(self.numbers)
        rolling = self.mass + count * p.wheelset_pitch_inertia / p.wheel_radius**2
        return count * torque / p.wheel_radius / rolling

    def brake_with(self, application_time: float = APPLICATION_TIME, strength: float = 1.0) -> dict[str, float]:
        """Parameters of each cylinder; strength: torque over that of the full brake."""
        values = {**self.brake, "application_time": application_time, "release_time": RELEASE_TIME, "tolerance": 1e-6}
        return values | {"force_per_pressure": strength * self.brake["force_per_pressure"]}


def bogie() -> Machine:
    """The bogie of chapter 5."""
    mass = BOGIE.frame_mass + 2 * BOGIE.wheelset_mass
    return Machine("bogie", (1, 2), BOGIE, mass, "frame", FULL_PRESSURE, FULL_TORQUE, brake_values())


def coach() -> Machine:
    """The complete vehicle: vehicle 1 of the Manchester benchmarks with traction rods."""
    p: VehicleParameters = COACH
    mass = p.body_mass + 2 * p.frame_mass + 4 * p.wheelset_mass
    full = braked_vehicle.FULL_PRESSURE, braked_vehicle.FULL_TORQUE
    return Machine("vehicle", (1, 2, 3, 4), p, mass, "body", *full, braked_vehicle.coach_brake().values())


class BrakedMachine:
    """The FMUs of a machine, the bogie by default, loaded once for many stops. A context manager."""

    def __init__(self, machine: Machine | None = None, kind: str = "native") -> None:
        self._stack = ExitStack()
        self.machine = machine or bogie()
        self.vehicle = self._stack.enter_context(Slave(up_to_date(self.machine.fmu, kind)))
        path = up_to_date("brake", kind)
        self.brakes = [self._stack.enter_context(Slave(path, f"brake_{n}")) for n in self.machine.numbers]

    def __enter__(self) -> BrakedMachine:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stack.close()

    def start(self, vehicle: Mapping[str, float], brakes: Sequence[Mapping[str, float]]) -> None:
        """Parameters of the vehicle and of each cylinder, which is empty."""
        self.vehicle.restart(vehicle)
        for brake, values in zip(self.brakes, brakes, strict=True):
            brake.restart(values, pressure_demand=0.0)

    def demand(self, pressure: float) -> None:
        """Asks all cylinders for a pressure [Pa]."""
        for brake in self.brakes:
            brake.set(pressure_demand=pressure)

    def coupling(self, further: Sequence[Connection] = ()) -> Coupling:
        """First the cylinders, then the vehicle, each wheelset with the torque of its own; `further` connections."""
        torques = [
            Connection(brake, "brake_torque", self.vehicle, f"brake_torque_{number}")
            for number, brake in zip(self.machine.numbers, self.brakes, strict=True)
        ]
        return Coupling([*self.brakes, self.vehicle], [*torques, *further])

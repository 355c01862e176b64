"""The bogie of chapter 5 with its brake: a cylinder on each wheelset, or one for both."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from types import TracebackType

from brake_controller.parameters import qr30
from rbd_model.parameters import AS_PRINTED, tables_5_1_and_5_2
from scenarios.cosimulation.master import Connection, Coupling
from scenarios.cosimulation.slave import Slave
from scenarios.fmus.building import up_to_date

BOGIE = tables_5_1_and_5_2()
#: Pressure [Pa] and torque capacity on each wheelset [N.m] of the full brake, which slows the bogie at 1.48 m/s2.
FULL_PRESSURE, FULL_TORQUE = 180e3, 20e3
TORQUE_PER_PRESSURE = FULL_TORQUE / FULL_PRESSURE
#: Time in which the cylinder settles on its first pressure before t = 0 [s]; what is left of the way is e^-37.
FILLING = 10.0
#: Of both FMUs in studies of the macro step. It keeps their own errors far below those of the coupling.
TOLERANCE = 1e-10


def brake_values() -> dict[str, float]:
    """The QR30's brake with shoe forces scaled up to FULL_TORQUE; assumed: the thesis does not print this bogie's."""
    brake = qr30(int(FULL_PRESSURE / 1e3))
    per_force = brake.wheelset_share * brake.rigging_efficiency * brake.constant_shoe_friction * brake.wheel_radius
    return brake.values() | {"force_per_pressure": TORQUE_PER_PRESSURE / per_force, "tolerance": TOLERANCE}


def bogie_values(speed: float) -> dict[str, float]:
    """The planar level: straight track, and the torque is the same on both rails.

    Torques on the wheelsets alone, as in (3.36): the closed forms of these studies know no frame that rocks under them.
    """
    return {
        "level": 2,
        "initial_speed": speed,
        "tolerance": TOLERANCE,
        "torque_reaction": AS_PRINTED["torque_reaction"],
    }


def connections(brake: Slave, bogie: Slave) -> list[Connection]:
    """Torque to both wheelsets, and the trailing one's angular velocity back."""
    return [
        Connection(brake, "brake_torque", bogie, "brake_torque_1"),
        Connection(brake, "brake_torque", bogie, "brake_torque_2"),
        Connection(bogie, "angular_velocity_2", brake, "angular_velocity"),
    ]


def start_brake(brake: Slave, pressure: float) -> None:
    """Lets the cylinder stand at a pressure [Pa] at t = 0."""
    brake.restart(brake_values(), time=-FILLING, pressure_demand=pressure)
    brake.step(-FILLING, FILLING)


def acceleration_per_torque() -> float:
    """Deceleration of the rolling bogie by the torque on each wheelset, 2/r / (M + 2 J/r^2) [m/s2/N.m]."""
    mass = BOGIE.frame_mass + 2 * BOGIE.wheelset_mass + 2 * BOGIE.wheelset_pitch_inertia / BOGIE.wheel_radius**2
    return 2 / BOGIE.wheel_radius / mass


#: Wheelsets that are braked, each by its own cylinder.
NUMBERS = (1, 2)
#: Speed at which the bogie counts as standing [m/s].
STANDING = 0.02


class BrakedBogie:
    """The FMUs of a bogie with a brake cylinder on each wheelset, loaded once for many stops. A context manager."""

    def __init__(self, kind: str = "native") -> None:
        self._stack = ExitStack()
        self.bogie = self._stack.enter_context(Slave(up_to_date("bogie", kind)))
        self.brakes = [self._stack.enter_context(Slave(up_to_date("brake", kind), f"brake_{n}")) for n in NUMBERS]

    def __enter__(self) -> BrakedBogie:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stack.close()

    def start(self, bogie: Mapping[str, float], brakes: Sequence[Mapping[str, float]]) -> None:
        """Parameters of the bogie and of each cylinder, which is empty."""
        self.bogie.restart(bogie)
        for brake, values in zip(self.brakes, brakes, strict=True):
            brake.restart(values, pressure_demand=0.0)

    def demand(self, pressure: float) -> None:
        """Asks both cylinders for a pressure [Pa]."""
        for brake in self.brakes:
            brake.set(pressure_demand=pressure)

    def coupling(self, further: Sequence[Connection] = ()) -> Coupling:
        """First the cylinders, then the bogie, each wheelset with the torque of its own; `further` connections."""
        torques = [
            Connection(brake, "brake_torque", self.bogie, f"brake_torque_{number}")
            for number, brake in zip(NUMBERS, self.brakes, strict=True)
        ]
        return Coupling([*self.brakes, self.bogie], [*torques, *further])

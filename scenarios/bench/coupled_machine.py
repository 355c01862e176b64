"""FMUs of a vehicle and of a brake cylinder on each wheelset, which a master couples by FMPy: a worked example."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from types import TracebackType

from fmu_src.cosimulation.master import Connection, Coupling
from fmu_src.cosimulation.slave import FmuInstance
from products.building import up_to_date


class CoupledMachine:
    """The FMU of a vehicle and one brake for each of its wheelsets, loaded once for many runs. A context manager."""

    def __init__(self, fmu: str, numbers: Sequence[int]) -> None:
        self._stack, self.numbers = ExitStack(), numbers
        self.vehicle = self._stack.enter_context(FmuInstance(up_to_date(fmu, "native")))
        path = up_to_date("brake", "native")
        self.brakes = [self._stack.enter_context(FmuInstance(path, f"brake_{number}")) for number in numbers]

    def __enter__(self) -> CoupledMachine:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stack.close()

    def start(self, vehicle: Mapping[str, float], brakes: Sequence[Mapping[str, float]]) -> None:
        """Begin a run with these parameters of the vehicle and of each cylinder, which is empty."""
        self.vehicle.restart(vehicle)
        for brake, values in zip(self.brakes, brakes, strict=True):
            brake.restart(values, pressure_demand=0.0)

    def demand(self, pressure: float) -> None:
        """Set the demand of all cylinders [Pa]."""
        for brake in self.brakes:
            brake.set(pressure_demand=pressure)

    def coupling(self, further: Sequence[Connection] = ()) -> Coupling:
        """Couple cylinders and vehicle: each wheelset gets the torque of its own cylinder; `further` connections."""
        torques = [
            Connection(brake, "brake_torque", self.vehicle, f"brake_torque_{number}")
            for number, brake in zip(self.numbers, self.brakes, strict=True)
        ]
        return Coupling([*self.brakes, self.vehicle], [*torques, *further])

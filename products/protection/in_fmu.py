"""A wheel-slide controller in an FMU, of FMI 2.0 or 3.0, with wheel speeds as inputs and valves as outputs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from fmu_src.cosimulation.opening import description_of
from fmu_src.cosimulation.slave import FmuInstance

#: Instances at once; an FMU may have few of them.
AT_ONCE = 16


@dataclass(frozen=True)
class Names:
    """Names in the FMU of the wheel speeds, wheelset by wheelset, its valves, and the parameter for the period.

    values: of further parameters and inputs. period: empty if the FMU has no such parameter.
    """

    wheel_speed: tuple[str, ...]
    valve: tuple[str, ...]
    period: str = ""
    values: tuple[tuple[str, float], ...] = ()


@dataclass
class InFmu:
    """Makes controllers for vehicles with this number of wheelsets, each an instance of one FMU; ended ones are reused.

    period: sampling period [s]. Raises ValueError if the FMU lacks a variable, CosimulationError if it makes no
    instance.
    """

    path: Path
    names: Names
    wheelsets: int
    period: float
    free: list[FmuInstance] = field(default_factory=list)

    def __post_init__(self) -> None:
        about = description_of(self.path)
        there = [variable.name for variable in about.modelVariables]
        wanted = (*self.names.wheel_speed, *self.names.valve, *(name for name, _ in self.names.values))
        for name in (*wanted, *filter(None, [self.names.period])):
            if name not in there:
                raise ValueError(f"it has no variable {name}, but {', '.join(there)}")
        if not len(self.names.wheel_speed) == len(self.names.valve) == self.wheelsets:
            raise ValueError(f"name a wheel speed and a valve for each of {self.wheelsets} wheelsets")
        if about.coSimulation is None:
            raise ValueError("it is not for co-simulation")
        self.at_once = 1 if about.coSimulation.canBeInstantiatedOnlyOncePerProcess else AT_ONCE
        self.free.append(FmuInstance(self.path))

    def __call__(self) -> InstanceOfFmu:
        """A controller for a new run."""
        return InstanceOfFmu(self, self.free.pop() if self.free else FmuInstance(self.path))


class InstanceOfFmu:
    """One run of the FMU: at a sampling instant it steps to the next one, and its valves are read after that."""

    def __init__(self, fmu: InFmu, slave: FmuInstance) -> None:
        self._fmu, self._slave, self._begun = fmu, slave, False
        self.__name__ = fmu.path.name  # its name in a message

    def __del__(self) -> None:
        self._fmu.free.append(self._slave)

    def step(self, time: float, wheel_speeds: Sequence[float]) -> Sequence[int]:
        """Return valve commands, as in `WheelSlideController`. Raises CosimulationError."""
        names, period = self._fmu.names, self._fmu.period
        speeds = dict(zip(names.wheel_speed, wheel_speeds, strict=True))
        if not self._begun:
            fixed = {names.period: period} if names.period else {}
            self._slave.restart(fixed | dict(names.values), time, **speeds)
            self._begun = True
        self._slave.set(**speeds)
        self._slave.step(time, period)
        return [int(one) if one == int(one) else -1 for one in self._slave.get(names.valve)]

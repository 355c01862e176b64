"""A stop in steps of a fixed size, with lock-up, release and flange contact."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from products.kernel_runs import History


@dataclass(frozen=True)
class DryStop:
    """Steps of one FMU: parameters, inputs over time, step and duration [s], and the variables read after each step."""

    values: Mapping[str, float]
    inputs: Mapping[str, History]
    seconds: float
    read: Sequence[str] = ()
    step: float = 1e-3

    @property
    def steps(self) -> int:
        """Return the number of macro steps."""
        return round(self.seconds / self.step)


def stop_of(wheelsets: int, **values: float) -> DryStop:
    """Return a stop from 8 m/s for an FMU with a number of wheelsets.

    The leading wheelset is locked and released, yaw torques press flanges, all brakes bring the vehicle to rest.
    """
    first, other = [(0.0, 0.0), (0.2, 60e3), (0.8, 60e3), (0.9, 5e3), (2.5, 5e3), (2.8, 24e3)], [(0.0, 5e3), (2.5, 5e3)]
    inputs: dict[str, History] = {"brake_torque_1": first}
    inputs |= {f"brake_torque_{n}": [*other, (2.8, 24e3)] for n in range(2, wheelsets + 1)}
    if values["level"] == 3:
        inputs["yaw_torque_1"] = [(0.0, 0.0), (1.2, 0.0), (1.4, 60e3), (2.0, 60e3), (2.2, 0.0)]
    read = ["speed", *(f"locked_{n}" for n in range(1, wheelsets + 1))]
    read += ["flange_force_1"] if values["level"] == 3 else []
    return DryStop({"initial_speed": 8.0, "integration_step": 1e-3, "tolerance": 1e-4} | values, inputs, 9.0, read)

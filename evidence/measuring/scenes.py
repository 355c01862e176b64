"""Six cases that stress different properties, two more with contact models 2 and 3, and the measures of each."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from fmu_src.kernel import Kernel
from products.kernel_runs import History, in_space, prepare, value_at
from scenarios.bench.asymmetric_shoes import BRAKE_START, BRAKE_TORQUE, YAW_TORQUE

#: Samples of the measured states by name, times [s] included.
Samples = Mapping[str, np.ndarray]


@dataclass(frozen=True)
class Scene:
    """A run: FMU, parameters, inputs, duration [s], samples every `interval` s, and the measures of these.

    Corners of the inputs lie on the samples. `read` are the states that `measure` needs; its values are all of order 1
    m, 1 s or 1 mm and are compared relatively.
    """

    name: str
    stress: str
    fmu: str
    duration: float
    interval: float
    read: tuple[str, ...]
    measure: Callable[[Samples], dict[str, float]]
    values: Mapping[str, float] = field(default_factory=dict)
    inputs: Mapping[str, History] = field(default_factory=dict)
    #: Largest step of other methods [s]: half of a wave, which no step may skip; ours limit the step themselves.
    longest_step: float = math.inf
    #: Tolerances of two references of different methods, CVODE and RODAS5P.
    references: tuple[float, float] = (1e-10, 1e-11)

    @property
    def parameters(self) -> dict[str, float]:
        """Return all parameters that differ from their start values."""
        return {**in_space(self.fmu), **self.values}

    def kernel(self, **values: float) -> Kernel:
        """Return an initialised kernel at the start, in 3D on rigid contacts unless `values` differ."""
        kernel = prepare(self.fmu, **self.parameters | values)
        kernel.set(**{name: history[0][1] for name, history in self.inputs.items()})
        kernel.initialise()
        return kernel

    def segments(self) -> list[tuple[float, float]]:
        """Return the times between the corners of the inputs [s]."""
        corners = {time for history in self.inputs.values() for time, _ in history if 0.0 < time < self.duration}
        return list(pairwise([0.0, *sorted(corners), self.duration]))

    def set_inputs(self, kernel: Kernel, begin: float, end: float) -> None:
        """Set inputs as straight lines from `begin` to `end`."""
        for name, history in self.inputs.items():
            first, last = value_at(history, begin, after=True), value_at(history, end, after=False)
            kernel.set(**{name: first})
            kernel.set_rate(**{name: (last - first) / (end - begin)})

    def times(self) -> np.ndarray:
        return np.arange(round(self.duration / self.interval) + 1) * self.interval


def stopping(samples: Samples) -> dict[str, float]:
    """Return the distance at the end [m], and the time to rest [s], extrapolated from the last samples above walking
    pace.
    """
    time, speed = samples["time"], samples["frame_speed"]
    last = int(np.flatnonzero(speed > WALKING)[-1])
    deceleration = (speed[last - 1] - speed[last]) / (time[last] - time[last - 1])
    return {
        "distance": float(samples["frame_distance"][-1]),
        "stop time": float(time[last] + speed[last] / deceleration),
    }


def moving(samples: Samples) -> dict[str, float]:
    """Return distance [m], speed [m/s] and turns of the leading wheelset [rad] at the end."""
    names = {"distance": "frame_distance", "speed": "frame_speed", "rotation": "rotation_1"}
    return {name: float(samples[state][-1]) for name, state in names.items()}


def lateral_peak(samples: Samples) -> dict[str, float]:
    """Return the largest lateral displacement of the leading wheelset [m], and the distance [m]."""
    peak = float(np.abs(samples["lateral_1"]).max())
    return {"peak lateral": peak, "distance": float(samples["frame_distance"][-1])}


def cycle_peak(samples: Samples) -> dict[str, float]:
    """Return the amplitude of the limit cycle: the largest lateral displacement in the last third [m]."""
    late = samples["time"] >= samples["time"][-1] * 2 / 3
    return {"peak lateral": float(np.abs(samples["lateral_1"][late]).max())}


def peak_and_stop(samples: Samples) -> dict[str, float]:
    return lateral_peak(samples) | stopping(samples)


def difference(one: dict[str, float], other: dict[str, float]) -> float:
    """Return the largest relative difference of two sets of measures."""
    return max(abs(one[name] / value - 1.0) for name, value in other.items())


#: Speed from which a stop is extrapolated to rest: near it, and still above the creep at rest [m/s].
WALKING = 0.5
FULL = 20e3


def both(torque: History) -> dict[str, History]:
    return {"brake_torque_1": torque, "brake_torque_2": torque}


def asymmetric(error: int) -> dict[str, History]:
    """Return the inputs of a brake applied within 1 s, one shoe pressing too hard by `error` %, as in chapter 9."""
    ramp = [(0.0, 0.0), (BRAKE_START, 0.0), (BRAKE_START + 1.0, 1.0)]
    inputs = both([(time, BRAKE_TORQUE * share) for time, share in ramp])
    return inputs | {"yaw_torque_1": [(time, YAW_TORQUE[error] * share) for time, share in ramp]}


STOP = ("frame_distance", "frame_speed")
SMOOTH = Scene(
    "smooth stop", "nothing but stiff creep", "bogie", 16.5, 0.05, STOP, stopping, inputs=both([(0.0, FULL)])
)
LOCK_UP = Scene(
    "lock-up and release",
    "events, sliding",
    "bogie",
    6.0,
    0.05,
    (*STOP, "rotation_1"),
    moving,
    inputs={"brake_torque_1": [(0.0, 0.0), (0.5, 0.0), (1.0, 60e3), (3.0, 60e3), (3.5, 10e3)]},
)
HUNTING = Scene(
    "hunting at 30 m/s",
    "a limit cycle between the flanges",
    "wheelset",
    15.0,
    0.01,
    ("lateral_1",),
    cycle_peak,
    values={"initial_speed": 30.0, "constant_speed": 1, "lateral_irregularity": 4e-3, "lateral_wave_number": 0.2},
    longest_step=1 / (0.2 * 30.0),
)
FLANGE = Scene(
    "lateral wave with flange contact",
    "a spring that comes and goes",
    "bogie",
    4.0,
    0.01,
    (*STOP, "lateral_1"),
    lateral_peak,
    values={"initial_speed": 15.0, "lateral_irregularity": 0.025, "lateral_wave_number": 0.045},
    longest_step=1 / (0.045 * 15.0),
)
ASYMMETRIC = Scene(
    "asymmetric shoes, rotating yaw torque",
    "flange contact once in every turn",
    "bogie",
    18.0,
    0.05,
    (*STOP, "lateral_1"),
    peak_and_stop,
    values={"yaw_torque_rotates": 1, "wheel_lift_ends": 0},
    inputs=asymmetric(25),
)
ON_PATCHES = replace(
    ASYMMETRIC,
    name="asymmetric shoes, fixed yaw torque, on patches",
    stress="model 2",
    values={"contact_model": 2},
)
#: Strips that begin and cease to touch bend their forces; a smaller tolerance would need tiny steps.
ON_STRIPS = replace(
    ON_PATCHES,
    name="asymmetric shoes, fixed yaw torque, on strips",
    stress="model 3",
    duration=4.0,
    measure=lateral_peak,
    values={"contact_model": 3},
    references=(1e-8, 1e-8),
)
STANDING = replace(SMOOTH, name="stop and 10 s of rest", stress="creep without bound on its stiffness", duration=27.0)
SCENES = (SMOOTH, LOCK_UP, HUNTING, FLANGE, ASYMMETRIC, STANDING)

"""Stability of methods on the equations of motion: predicted from eigenvalues, and measured by perturbation."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.optimize import brentq

from evidence.measuring.runs import StateLayout, layout
from fmu_src.kernel import Kernel
from products.kernel_runs import RIGID, prepare

#: Values of integration_method.
RODAS5P, ROS34PW2, RUNGE_KUTTA = 1, 2, 3
#: Time in which the start settles to a steady run [s].
SETTLING = 0.3
#: Steps over which a perturbation along the fastest mode grows or decays, by 60 at the most within 10 % of the limit.
STEPS = 10
#: Size of the perturbation as a share of the speed: far below saturated creep (0.3 %), far above the solution's noise.
PERTURBATION = 3e-6
#: Difference of two runs below which it is noise of the solution, as a share of the speed.
NOISE = 1e-11


#: Light drag braking [N.m on each wheelset], balanced by the drawbar: the law of creep has no unique slope at rest.
DRAG = 2e3


@dataclass(frozen=True)
class DrivenVehicle:
    """A driven vehicle: an FMU's kernel with its parameters, and the wheelsets that drag."""

    name: str
    fmu: str
    values: tuple[tuple[str, float], ...]
    wheelsets: int = 2

    @property
    def drag(self) -> dict[str, float]:
        """Return the inputs that keep a constant speed against the brakes."""
        radius = prepare(self.fmu)["wheel_radius"]
        torques = {f"brake_torque_{number}": DRAG for number in range(1, self.wheelsets + 1)}
        return torques | {"drawbar_force": self.wheelsets * DRAG / radius}

    @property
    def form(self) -> StateLayout:
        """Return the places of its states."""
        return layout(self.fmu, **dict(self.values))


SPATIAL = DrivenVehicle("bogie, spatial", "bogie", tuple(RIGID.items()))
PLANAR = DrivenVehicle("bogie, planar", "bogie", (("level", 2.0),))
WHEELSET = DrivenVehicle("one wheelset in a frame", "wheelset", (), 1)
#: Vehicles whose fastest mode is creep at every speed, so that it decays without oscillating.
MACHINES = (SPATIAL, PLANAR, WHEELSET)
#: With contact models 2 and 3 the wheelsets bounce on their contacts, which limits explicit steps where creep is slow.
PATCHES, STRIPS = (
    DrivenVehicle(f"bogie, {word}", "bogie", (("level", 3.0), ("contact_model", depth)))
    for word, depth in (("patches", 2.0), ("strips", 3.0))
)


def amplification_of_rk4(z: complex | np.ndarray) -> complex | np.ndarray:
    """Return the stability function R(z) of the classical Runge-Kutta method, order 4; Hairer, Wanner 1996, IV.2."""
    return 1 + z + z**2 / 2 + z**3 / 6 + z**4 / 24


def amplification_of_dopri5(z: complex | np.ndarray) -> complex | np.ndarray:
    """Return the stability function of Dormand's and Prince's method of order 5, that of RK45; the same, IV.2."""
    return 1 + z + z**2 / 2 + z**3 / 6 + z**4 / 24 + z**5 / 120 + z**6 / 600


def amplification_of_euler(z: complex | np.ndarray) -> complex | np.ndarray:
    """Return the stability function of the explicit Euler method."""
    return 1 + z


EXPLICIT = {"Euler": amplification_of_euler, "RK4": amplification_of_rk4, "RK45": amplification_of_dopri5}


def largest_stable_step(eigenvalues: np.ndarray, amplification=amplification_of_rk4) -> float:  # type: ignore[no-untyped-def]
    """Return the step [s] at which the first decaying mode begins to grow under the method; other modes are ignored."""
    decaying = eigenvalues[eigenvalues.real < -STILL]

    def growth(size: float) -> float:
        return float(np.abs(amplification(size * decaying)).max() - 1.0)

    first = 0.1 / np.abs(decaying).max()
    while growth(first) < 0.0:
        first *= 1.02
    return float(brentq(growth, first / 1.02, first, rtol=1e-10))


#: Decay below which a mode is ignored [1/s]: distance and rotation, and the slow fall of the speed.
STILL = 0.5


def start_of(machine: DrivenVehicle, inputs: tuple[tuple[str, float], ...]) -> dict[str, float]:
    """Return parameters and initial inputs; `inputs` precede the vehicle's own."""
    return dict(machine.values) | machine.drag | dict(inputs)


@lru_cache(maxsize=256)
def steady(
    machine: DrivenVehicle, speed: float, inputs: tuple[tuple[str, float], ...] = ()
) -> tuple[np.ndarray, np.ndarray]:
    """Return a steady run at a speed [m/s].

    Takes speed [m/s].
    """
    kernel = prepare(machine.fmu, initial_speed=speed, tolerance=1e-10, **start_of(machine, inputs))
    kernel.advance(SETTLING)
    form = machine.form
    place = np.array(kernel.linearise().state)[form.differential]
    return place, np.array(kernel.jacobian_at(kernel.time, place.tolist()))


def limit(
    machine: DrivenVehicle, speed: float, method: str = "RK4", inputs: tuple[tuple[str, float], ...] = ()
) -> float:
    """Return the predicted largest stable step of an explicit method [s].

    Takes speed [m/s].
    """
    return largest_stable_step(np.linalg.eigvals(steady(machine, speed, inputs)[1]), EXPLICIT[method])


@dataclass(frozen=True)
class PerturbationGrowth:
    """Growth of a perturbation in each step: the measured one, and the warning in the log."""

    factor: float
    messages: tuple[str, ...]

    @property
    def stable(self) -> bool:
        return self.factor < 1.0


def growth_of_perturbation(
    machine: DrivenVehicle, speed: float, step: float, method: int, inputs: tuple[tuple[str, float], ...] = ()
) -> PerturbationGrowth:
    """Return the mean growth of a perturbation in each step, until it is lost in noise.

    Two runs with fixed steps begin in a steady state and next to it, along the fastest mode.
    """
    place, jacobian = steady(machine, speed, inputs)
    form = machine.form
    turning = [form.kept.index(name) for name in form.kept if name.startswith("angular_velocity")]
    fast = fastest_mode(jacobian)
    moved = place + PERTURBATION * speed * fast / np.abs(fast[turning]).max()
    kernels = [fixed_kernel(machine, start, speed, step, method, inputs) for start in (place, moved)]
    sizes = [PERTURBATION * speed]
    while len(sizes) <= STEPS and sizes[-1] > NOISE * speed:
        for kernel in kernels:
            kernel.step(kernel.time, step)
        states = [np.array(kernel.linearise().state)[form.differential][turning] for kernel in kernels]
        sizes.append(float(np.abs(states[1] - states[0]).max()))
    messages = tuple(line for kernel in kernels for line in kernel.messages)
    return PerturbationGrowth((sizes[-1] / sizes[0]) ** (1 / (len(sizes) - 1)), messages)


def fastest_mode(jacobian: np.ndarray) -> np.ndarray:
    """Return the real part of the eigenvector of the eigenvalue with the largest magnitude."""
    values, vectors = np.linalg.eig(jacobian)
    vector = vectors[:, np.argmax(np.abs(values))]
    return np.real(vector / vector[np.argmax(np.abs(vector))])


def fixed_kernel(
    machine: DrivenVehicle,
    place: np.ndarray,
    speed: float,
    step: float,
    method: int,
    inputs: tuple[tuple[str, float], ...],
) -> Kernel:
    """Return a kernel with fixed steps in a given state."""
    values = {"initial_speed": speed, "integration_method": method, "integration_step": step, "tolerance": 1e-2}
    kernel = prepare(machine.fmu, **values, **start_of(machine, inputs))
    kernel.initialise()
    kernel.arrive(0.0, place.tolist())
    return kernel


def boundary(
    machine: DrivenVehicle, speed: float, method: int = RUNGE_KUTTA, inputs: tuple[tuple[str, float], ...] = ()
) -> float:
    """Return the largest stable step by bisection on the growth of a perturbation, to 0.2 % [s].

    Takes speed [m/s].
    """
    low, high = 0.7 * limit(machine, speed, "RK4", inputs), 1.4 * limit(machine, speed, "RK4", inputs)
    while high / low > 1.002:
        middle = float(np.sqrt(low * high))
        if growth_of_perturbation(machine, speed, middle, method, inputs).stable:
            low = middle
        else:
            high = middle
    return float(np.sqrt(low * high))

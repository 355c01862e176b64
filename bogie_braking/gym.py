"""Wheel-slide protection as an environment of Gymnasium, bogie_braking/WheelSlide-v0: a stop is an episode.

Needs the extra `gym`. An import of this module makes the environment known:

>>> import gymnasium, bogie_braking.gym
>>> gymnasium.make("bogie_braking/WheelSlide-v0"), gymnasium.make_vec("bogie_braking/WheelSlide-v0", 1024)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from bogie_braking.checks import MOST_INSTANCES, at_most, known
from bogie_braking.protection import settings_from
from brake_controller.wheel_slide import COMMANDS
from products.machine import MACHINES
from products.protection.draws import drawn_run
from products.protection.environment import DrawsRun, Environment
from products.protection.runs import Fault, Run, Stop
from readers.extras import named_extras

with named_extras():
    import gymnasium
    from gymnasium.spaces import Box, MultiDiscrete
    from gymnasium.utils import seeding
    from gymnasium.vector import AutoresetMode, VectorEnv
    from gymnasium.vector.utils import batch_space

__all__ = ["Fault", "Run", "WheelSlide", "WheelSlideVector"]

NAME = "bogie_braking/WheelSlide-v0"
Numbers = np.ndarray


def made(
    vehicle: str, count: int, rails: DrawsRun, privileged: bool, threads: int | None, settings: dict[str, float]
) -> Environment:
    """Return `count` environments.

    Raises KeyError if the vehicle or a setting is unknown, TypeError if `rails` is not a function, ValueError for a
    count.
    """
    if not callable(rails):
        raise TypeError(f"rails must be a function of a generator and a number of wheelsets; got {rails!r}.")
    if not isinstance(count, int | np.integer) or count < 1:
        raise ValueError(f"The number of environments must be a whole number of at least 1; got {count!r}.")
    at_most("environments", int(count), MOST_INSTANCES)
    machine = MACHINES[known(vehicle, MACHINES, "vehicle with brakes")]()
    return Environment(machine, settings_from(settings), int(count), rails, privileged, threads)


def spaces(of: Environment) -> tuple[Box, MultiDiscrete]:
    """Return the spaces of observations and actions of one environment."""
    least, most = of.limits
    return Box(least, most, dtype=np.float64), MultiDiscrete([len(COMMANDS)] * len(of.machine.numbers))


def told(stop: Stop) -> dict[str, Any]:
    """Return a stop as `info`: distance [m] (NaN: no stop), time [s] and other results; `message` after a fault."""
    found = asdict(stop)
    for without in ("history", "lowest_reservoir"):  # histories are not recorded, and cylinders are timed
        del found[without]
    return found | {"distance": np.nan if stop.distance is None else stop.distance, "sliding": np.array(stop.sliding)}


class WheelSlide(gymnasium.Env[Numbers, Numbers]):
    """A bogie or coach that brakes to rest; the page *Train and tune* lists observations, actions and rewards.

    Parameters
    ----------
    vehicle : str
        "bogie" or "coach" (also "vehicle").
    rails : callable
        Draws a `Run` from a random generator and the number of wheelsets.
    privileged : bool
        Whether to observe quantities that a controller cannot measure.
    **settings : float
        As in `bogie_braking.protected_stops`.
    """

    metadata = {"render_modes": []}

    def __init__(
        self, vehicle: str = "bogie", rails: DrawsRun = drawn_run, privileged: bool = False, **settings: float
    ) -> None:
        self._of = made(vehicle, 1, rails, privileged, 1, settings)
        self.observation_space, self.action_space = spaces(self._of)
        self._goes_on = False

    @property
    def run(self) -> Run:
        """The drawn stop."""
        return self._of.runs[0]

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Numbers, dict[str, Any]]:
        """Draw a stop and begin it; the same seed gives the same rails. Raises ValueError for options."""
        super().reset(seed=seed)
        refuse(options)
        self._of.begin([0], [self.np_random])
        self._goes_on = True
        return self._of.observation[0], {}

    def step(self, action: Numbers) -> tuple[Numbers, float, bool, bool, dict[str, Any]]:
        """Advance by one period. Raises ValueError if the commands are invalid, RuntimeError before a reset."""
        if not self._goes_on:
            raise RuntimeError("No stop goes on here; call reset first.")
        of = self._of
        of.turn(np.asarray(action)[None])
        terminated, truncated = bool(of.terminated[0]), bool(of.truncated[0])
        self._goes_on = not (terminated or truncated)
        return of.observation[0], float(of.reward[0]), terminated, truncated, {} if self._goes_on else told(of.stop(0))

    def close(self) -> None:
        """Free memory."""
        self._of.close()


class WheelSlideVector(VectorEnv[Numbers, Numbers, Numbers]):
    """Many environments in vector lanes and threads; row k with seed s equals the single environment with seed s + k.

    A row that has ended restarts at the next step and ignores its action then (autoreset mode NEXT_STEP). Each step
    returns new arrays.

    Parameters
    ----------
    num_envs : int
        Number of environments.
    vehicle : str
        "bogie" or "coach" (also "vehicle").
    rails : callable
        Draws a `Run` from a random generator and the number of wheelsets.
    privileged : bool
        Whether to observe quantities that a controller cannot measure.
    threads : int, optional
        Number of threads; by default the number of processors.
    **settings : float
        As in `bogie_braking.protected_stops`.
    """

    metadata = {"render_modes": [], "autoreset_mode": AutoresetMode.NEXT_STEP}

    def __init__(
        self,
        num_envs: int = 1,
        vehicle: str = "bogie",
        rails: DrawsRun = drawn_run,
        privileged: bool = False,
        threads: int | None = None,
        **settings: float,
    ) -> None:
        self._of = made(vehicle, num_envs, rails, privileged, threads, settings)
        self.num_envs = num_envs
        self.single_observation_space, self.single_action_space = spaces(self._of)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._randoms: list[np.random.Generator] = []
        self._ended = np.zeros(num_envs, bool)

    @property
    def runs(self) -> list[Run]:
        """The stops that were drawn last."""
        return list(self._of.runs)

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Numbers, dict[str, Any]]:
        """Draw a stop for each row and begin it. seed: of the first row, the next ones follow; or a list of seeds."""
        refuse(options)
        if seed is not None or not self._randoms:
            self._randoms = [seeding.np_random(one)[0] for one in self._seeds(seed)]
        self._ended[:] = False
        self._of.begin(range(self.num_envs), self._randoms)
        return self._of.observation, {}

    def _seeds(self, seed: int | Sequence[int | None] | None) -> Sequence[int | None]:
        if seed is None:
            return [None] * self.num_envs
        if isinstance(seed, int | np.integer):
            return [int(seed) + row for row in range(self.num_envs)]
        if len(seed) != self.num_envs:
            raise ValueError(f"seed must be one number, or {self.num_envs} of them; got {len(seed)}.")
        return seed

    def step(self, actions: Numbers) -> tuple[Numbers, Numbers, Numbers, Numbers, dict[str, Any]]:
        """Advance by one period. Raises ValueError if the commands are invalid, RuntimeError before the first reset."""
        if not self._randoms:
            raise RuntimeError("No stop goes on here; call reset first.")
        of = self._of
        of.turn(actions)
        anew = np.flatnonzero(self._ended).tolist()
        if anew:
            of.begin(anew, [self._randoms[row] for row in anew])
        self._ended = of.terminated | of.truncated
        info: dict[str, Any] = {}
        for row in np.flatnonzero(self._ended).tolist():
            info = self._add_info(info, told(of.stop(row)), row)
        return of.observation, of.reward, of.terminated, of.truncated, info

    def close_extras(self, **kwargs: Any) -> None:
        """Free threads and memory."""
        self._of.close()


def refuse(options: dict[str, Any] | None) -> None:
    """Raise ValueError for any option."""
    for name in options or {}:
        raise ValueError(f"There is no option {name}; give rails a function that draws what you want.")


gymnasium.register(
    NAME, entry_point=f"{__name__}:{WheelSlide.__name__}", vector_entry_point=f"{__name__}:{WheelSlideVector.__name__}"
)

"""Kwet_rst over drawn wet rails: deceleration of a protected vehicle over that of its stop on a dry rail."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import loguniform, norm, uniform

from bogie_braking.batches import threads_or_none
from bogie_braking.checks import at_most, known
from bogie_braking.quantiles import drawn_quantile, split_quantile
from bogie_braking.rare_events import MOST_MOVES, Distribution, distributions_of, values_of, whole
from bogie_braking.splitting import POPULATIONS, Numbers, climb
from products.machine import MACHINES
from products.protection.draws import CLEANED, FALLING, FRICTIONS
from products.protection.rig import Rig
from products.protection.rig_in_c import slide_protection
from products.protection.runs import Run
from products.protection.settings import BRAKE_START, Settings
from products.supervision.safety import WEAKER
from rbd_model.contact.friction import constant_friction
from rbd_model.track.friction import dry, low, wet
from readers.text import BadInputError, shown


@dataclass(frozen=True)
class WetRails:
    """Friction of wet rails as a distribution, and its source.

    Parameters
    ----------
    friction : Distribution
        Friction at rest, one value below all wheels.
    source : str
        Source of the numbers, or that they are assumed.
    """

    friction: Distribution
    source: str


#: Rails by name. Public measurements of a distribution of wet adhesion were not found: each law is assumed.
WET_RAILS = {
    "low to wet": WetRails(
        loguniform(low().friction, wet().friction),
        "assumed: uniform in its logarithm from the low rail, 0.08 (assumed), to the wet rail of Polach (2005), 0.30",
    ),
    "training": WetRails(loguniform(*FRICTIONS), "assumed: uniform in its logarithm from 0.04 to 0.15"),
    "normal": WetRails(norm(0.15, 0.02), "assumed: normal, 0.15 with a standard deviation of 0.02"),
}
#: Number of plain draws, and its limit; level up to which they suffice, and up to which the first particles do.
DRAWS, MOST_DRAWS, PLAIN, SHALLOW = 4_000, 1_000_000, 3, 1
#: Most particles of a population, whose stops run at once.
MOST_PARTICLES = 10_000
#: Friction below which a stop is not simulated and has no deceleration, and the largest.
LEAST_FRICTION, MOST_FRICTION = 0.005, 2.0
#: Deepest level of the standard; the climb ends below the probability of a level by this factor.
DEEPEST, BELOW = 9, 4.0
#: Limits of the initial speed [m/s], and of the integration step [s].
SPEEDS, STEP = (10.0, 100.0), 5e-3


@dataclass(frozen=True)
class WetFactors:
    """Kwet_rst of a vehicle by confidence levels. It is an estimate by simulation, not an approval.

    Attributes
    ----------
    factors, lower, upper : ndarray
        Deceleration over that on a dry rail that is reached with the probability of the levels 0 to 9, with its 95 %
        confidence interval, shape (10). NaN where the stops do not suffice: nothing is extrapolated.
    runs : int
        Number of simulated stops.
    messages : list of str
        The method, the source of the friction, and warnings.
    """

    factors: Numbers
    lower: Numbers
    upper: Numbers
    runs: int
    messages: list[str]

    @property
    def status(self) -> str:
        """All messages."""
        return " ".join(self.messages)


@dataclass
class _Stops:
    """Make stops of standard normal points; count those without a deceleration."""

    rig: Rig
    inputs: dict[tuple[str, ...], Distribution]
    dry: float
    without: int = 0
    runs: int = 0

    def __call__(self, points: Numbers) -> Numbers:
        """Return minus the share of the dry deceleration, shape (points,)."""
        drawn = values_of(self.inputs, points)
        wheelsets = len(self.rig.machine.numbers)
        highest = float(drawn["friction"].max())
        if highest > MOST_FRICTION:
            raise BadInputError(f"Friction of wet rails must be at most {MOST_FRICTION:g}; got a draw of {highest:g}.")
        stops = np.flatnonzero(drawn["friction"] >= LEAST_FRICTION)
        runs = [_run(wheelsets, *(float(drawn[name][row]) for name in drawn)) for row in stops]
        found = np.zeros(len(points))
        for row, stop in zip(stops, self.rig.runs(runs) if runs else [], strict=True):
            found[row] = 0.0 if stop.distance is None else -min(1.0, self.dry / _way(self.rig, stop.distance))
        self.runs += len(runs)
        self.without += int(np.sum(found == 0.0))
        return found


def wet_factors(
    vehicle: str = "bogie",
    rails: str | WetRails = "low to wet",
    *,
    level: int = 3,
    speed: float = 100.0 / 3.6,
    draws: int = DRAWS,
    particles: int = 20,
    moves: int = 3,
    step: float = STEP,
    seed: int = 0,
    threads: int | None = None,
) -> WetFactors:
    """Return Kwet_rst of a vehicle over drawn wet rails, with its wheel-slide protection on.

    Each draw is a full brake to rest: friction of the rail, constant or falling with sliding speed, cleaned by the
    wheels ahead or not, and phases of the sensors are random. All wheels run on the same rail, so a train of such
    vehicles has the same factors.

    Takes speed [m/s], step [s].
    """
    _check(level, speed, step)
    draws = at_most("draws", whole("draws", draws, 100), MOST_DRAWS)
    particles = at_most("particles", whole("particles", particles, 10), MOST_PARTICLES)
    moves, seed = at_most("moves", whole("moves", moves, 1), MOST_MOVES), whole("the seed", seed, 0)
    rails = _rails_of(rails)
    inputs = distributions_of(
        {
            "friction": rails.friction,
            "falls": uniform(),
            "cleaned": uniform(CLEANED[0], np.ptp(CLEANED)),
            "phase": uniform(),
        }
    )
    machine = MACHINES[known(vehicle, MACHINES, "vehicle with brakes")]()
    rig = Rig(machine, slide_protection(), Settings(speed=speed), step=step, threads=threads_or_none(threads))
    [on_dry] = rig.runs([Run(dry().values(len(machine.numbers)))])
    stops = _Stops(rig, inputs, _way(rig, on_dry.distance or math.nan))
    if level <= PLAIN:
        points = np.random.default_rng(seed).standard_normal((draws, len(inputs)))
        found, method = _plain(stops(points), level), f"{draws} plain draws"
    else:
        least = WEAKER[level] / BELOW
        populations, _ = climb(stops, len(inputs), np.inf, particles, moves, seed, least)
        first = np.concatenate([population.generations[0].outputs for population in populations])
        found = _plain(first, SHALLOW)
        for deep in range(SHALLOW + 1, level + 1):
            found[deep] = split_quantile(populations, WEAKER[deep])
        method = f"splitting with {POPULATIONS} populations of {particles} particles"
    factors, upper, lower = np.where(np.isfinite(found), -found, np.nan).T + 0.0
    return WetFactors(factors, lower, upper, stops.runs + 1, _messages(stops, rails, method, lower, level))


def _plain(outputs: Numbers, level: int) -> Numbers:
    """Return quantiles and bounds of outputs up to a level, shape (10, 3); NaN beyond."""
    found = np.full((DEEPEST + 1, 3), np.nan)
    for number in range(level + 1):
        found[number] = drawn_quantile(outputs, WEAKER[number])
    found[~np.isfinite(found).all(axis=1)] = np.nan
    return found


def _run(wheelsets: int, friction: float, falls: float, cleaned: float, phase: float) -> Run:
    """Return a stop on a drawn rail; the rails that fall do so by the law of the low rail."""
    condition = replace(low(), friction=friction, law=low().law if falls < FALLING else constant_friction())
    phases = (min(phase, 0.999),) * wheelsets
    return Run(condition.values(wheelsets) | {"cleaned_friction": cleaned}, phases=phases)


def _way(rig: Rig, distance: float) -> float:
    """Return the braking distance [m] without the equivalent build-up: half of the rise to 95 %, as in train data."""
    way = distance - rig.settings.speed * (BRAKE_START + rig.settings.application_time / 2.0)
    if not way > 0.0:
        raise BadInputError(
            f"The vehicle must brake from its speed longer than its build-up; got a stop of {distance:.0f} m. Give a "
            "higher speed."
        )
    return way


def _messages(stops: _Stops, rails: WetRails, method: str, lower: Sequence[float] | Numbers, level: int) -> list[str]:
    """Return the method, the source and warnings."""
    found = [f"Kwet_rst by {method}, {stops.runs} stops.", f"Friction of the rail: {rails.source}."]
    missing = [number for number in range(level + 1) if np.isnan(lower[number])]
    if missing:
        levels = ", ".join(map(str, missing))
        found.append(f"The stops do not suffice for level {levels}; give more draws or particles.")
    if stops.without:
        found.append(f"{stops.without} stops have no deceleration: they did not end, or friction was below 0.005.")
    return found


def _rails_of(rails: str | WetRails) -> WetRails:
    if isinstance(rails, WetRails):
        return rails
    if isinstance(rails, str):
        return WET_RAILS[known(rails, WET_RAILS, "law of wet rails")]
    raise BadInputError(f"rails must be {', '.join(WET_RAILS)} or WetRails; got {shown(rails)}.")


def _check(level: int, speed: float, step: float) -> None:
    if isinstance(level, bool) or not isinstance(level, int | np.integer) or not 0 <= level <= DEEPEST:
        raise BadInputError(f"The confidence level must be an integer from 0 to {DEEPEST}; got {shown(level)}.")
    for name, value, least, most, unit in (("speed", speed, *SPEEDS, "m/s"), ("step", step, 0.0, STEP, "s")):
        if isinstance(value, bool) or not isinstance(value, int | float | np.number) or not least <= value <= most:
            raise BadInputError(f"{name} must be from {least:g} to {most:g} {unit}; got {shown(value)}.")

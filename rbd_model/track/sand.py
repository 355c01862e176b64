"""Friction of a rail that sanders of the vehicle have sanded.

A sander is ahead of its wheelset. It lays a mass per second, limited to a mass per metre. A sander of fixed rate has no
such limit; the rate of a variable one is reduced by it. Sand stays where it falls, and each wheelset behind finds all
of it. With q of sand per metre, friction is mu0 + (mu_s - mu0) (1 - exp(-q / Q)) if mu0 is below mu_s.

The form is assumed. `sanded_friction` and `sand_scale` are fitted to two of five stopping distances of full-scale
trials (scenarios/brakes/sanding.py). They have no other source.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from fmu_src.symbols import ca
from fmu_src.system import ParameterSet, System, Variable, quantity

#: Least speed in the sand per metre of a sander [m/s]; length over which its sand begins [m].
SLOWEST, BLEND = 0.1, 0.5
#: Largest rate of a sander [kg/s]: fixed ones give some 0.03, from memory.
MOST_SAND = 1.0


@dataclass(frozen=True)
class SandParameters(ParameterSet):
    """When all sanders of a vehicle work, and the effect of their sand."""

    sand_start: float = quantity("s", "Time at which the sanders are asked for sand", 0.0)
    sand_delay: float = quantity("s", "Time from then until sand falls on the rail", 0.0)
    sand_limit: float = quantity("kg/m", "Most sand that a sander gives for each metre", 0.0)
    sanded_friction: float = quantity("1", "Friction of a rail with much sand; a better one stays as it is", 0.0, 1.0)
    sand_scale: float = quantity("kg/m", "Sand for each metre that takes friction 63 % of the way there", 1e-6)


def common_sand() -> SandParameters:
    """Return the fitted set of sand: the last two (see above).

    Assumed: sanders start with the brake, 1 s delay, no limit.
    """
    return SandParameters(sand_start=1.0, sand_delay=1.0, sand_limit=1.0, sanded_friction=0.1162, sand_scale=7.53e-3)


def sand_laid(rate: ca.SX, limit: ca.SX, speed: ca.SX) -> ca.SX:
    """Return the mass that a sander lays on each metre [kg/m] at its rate [kg/s]."""
    return ca.fmin(rate / ca.fmax(speed, SLOWEST), limit)


def friction_with_sand(friction: ca.SX, sand: ca.SX, sanded: ca.SX, scale: ca.SX) -> ca.SX:
    """Return mu0 + (mu_s - mu0) (1 - exp(-q / Q)), for mu0 below mu_s: assumed, and fitted to trials of RSSB T1107."""
    return friction + ca.fmax(sanded - friction, 0) * (1 - ca.exp(-sand / scale))


def sanders(places: Sequence[float], defaults: SandParameters | None = None) -> System:
    """Return a sander ahead of each wheelset, without sand unless its rate is set; places: of the wheelsets along [m].

    Inputs are speed and friction of the rail, outputs `sanded_friction_1` and so on. The sand at a wheelset is computed
    with the present speed, though the sander passed there earlier: over 20 m, at 1 m/s2 and 10 m/s, 20 % too much.
    """
    system, given = System("sanders", "Sanders ahead of the wheelsets"), defaults or common_sand()
    speed = system.input(Variable("speed", "input", "m/s", "Speed of the vehicle"))
    p = {name: system.parameter(given.variable(name)) for name in given.values()}
    way = system.state("sanded_way", "m", 0.0, 1.0)
    system.derivative(way, ca.if_else(system.time >= p["sand_start"] + p["sand_delay"], speed, 0))
    numbered = list(enumerate(places, 1))
    laid = {}
    for number, _ in numbered:
        text = f"Sand of the sander ahead of wheelset {number}"
        rate = system.parameter(Variable(f"sand_rate_{number}", "parameter", "kg/s", text, 0.0, 0.0, MOST_SAND))
        laid[number] = sand_laid(rate, p["sand_limit"], speed)
    for number, place in numbered:
        text = f"Friction of the rail under wheelset {number} without sand"
        friction = system.input(Variable(f"friction_{number}", "input", "1", text, 0.3, 0.0))
        ahead = [(laid[other], along - place) for other, along in numbered if other <= number]
        found = sum((sand * ca.fmin(ca.fmax(way - gap, 0) / BLEND, 1) for sand, gap in ahead), ca.SX(0))
        sanded = friction_with_sand(friction, found, p["sanded_friction"], p["sand_scale"])
        system.output(Variable(f"sanded_friction_{number}", "output", "1", f"The same with sand, {number}"), sanded)
    return system

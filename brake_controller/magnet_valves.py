"""The two magnet valves between regulator and cylinder that a wheel-slide protection commands, with their delay.

One lets air in, the other lets it out. Each follows its command with a first-order lag of its open area. This form,
without dead time, is assumed.
"""

from __future__ import annotations

from dataclasses import dataclass

from brake_controller.flow import Openings, commanded
from brake_controller.pneumatics import APPLY, TIME_CONSTANTS_TO_95_PERCENT
from fmu_src.symbols import ca
from fmu_src.system import ParameterSet, System, quantity


@dataclass(frozen=True)
class ValveParameters(ParameterSet):
    """Opening and closing times of the valves, which are equal."""

    valve_opening_time: float = quantity("s", "Time from the command until 95 % of a valve's area is open", 1e-3)
    valve_closing_time: float = quantity("s", "Time from the command until 95 % of a valve's area is closed", 1e-3)


def common_valves() -> ValveParameters:
    """Return valves of 30 ms. Assumed."""
    return ValveParameters(valve_opening_time=0.03, valve_closing_time=0.03)


def following(system: System, valve: ca.SX, defaults: ValveParameters) -> Openings:
    """Return openings as states of a system; valves apply at the start, as the de-energised one of section 6.3.9."""
    opens, closes = (system.parameter(defaults.variable(name)) for name in defaults.values())
    wanted, start = commanded(valve), commanded(ca.SX(APPLY))

    def follow(name: str, target: ca.SX, first: ca.SX) -> ca.SX:
        opening = system.state(name, "1", first, 1.0)
        time = ca.if_else(target > opening, opens, closes)
        system.derivative(opening, (target - opening) * TIME_CONSTANTS_TO_95_PERCENT / time)
        return opening

    return Openings(
        follow("refill_opening", wanted.refill, start.refill), follow("dump_opening", wanted.dump, start.dump)
    )

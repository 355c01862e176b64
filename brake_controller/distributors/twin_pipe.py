"""The distributor of UIC 540 with a second pipe: a main pipe charges the auxiliary reservoir, the brake pipe controls.

The main pipe stays full, and a reducing valve sets its pressure at the reservoir. Both are assumed.
"""

from __future__ import annotations

from dataclasses import dataclass

from brake_controller.air import AMBIENT, GAS_CONSTANT, HEAT_CAPACITY, WALL, choke_flow
from brake_controller.distributors import uic
from brake_controller.distributors.distributor import Answer, Distributor, Moment
from brake_controller.distributors.uic import CHARGED, UicDistributor, freight
from fmu_src.symbols import ca
from fmu_src.system import quantity


@dataclass(frozen=True)
class TwinPipeDistributor(UicDistributor):
    """A distributor whose auxiliary reservoir a main pipe charges."""

    main_pressure: float = quantity("Pa", "Pressure of the main pipe behind its reducing valve", 0.0)


def ready(position: str) -> TwinPipeDistributor:
    """Return a UIC 540 distributor by its position; its main pipe charges to 5 bar."""
    return TwinPipeDistributor(**freight(position).values(), main_pressure=CHARGED)


def whole(moment: Moment) -> Answer:
    """Return the answer of the UIC 540 distributor with another source of its reservoir's air (ISO 6358-1)."""
    p, pipe, plain = moment.given, moment.pipe, uic.whole(moment)
    auxiliary = moment.states["auxiliary"]
    by_pipe = choke_flow(p["auxiliary_choke"], pipe.pressure, pipe.temperature, auxiliary)
    by_main = choke_flow(p["auxiliary_choke"], p["main_pressure"] + AMBIENT, WALL, auxiliary)
    charges = GAS_CONSTANT * WALL * (by_main - by_pipe) / p["auxiliary_volume"]
    taken = plain.taken - by_pipe
    enthalpy = HEAT_CAPACITY * taken * ca.if_else(taken > 0, pipe.temperature, WALL)
    return Answer({**plain.rates, "auxiliary": plain.rates["auxiliary"] + charges}, taken, enthalpy, plain.filling)


TWIN_PIPE = Distributor(
    name="twin_pipe",
    parameters=TwinPipeDistributor,
    states=uic.STATES,
    ready=ready,
    whole=whole,
    pace=uic.fastest_change,
    adjustable=uic.UIC.adjustable,
)

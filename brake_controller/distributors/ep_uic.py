"""The distributor of UIC 540 with electro-pneumatic assistance: magnet valves at each vehicle vent and feed the pipe.

UIC 541-5, from a secondary source: valves of all vehicles act at once, and without current the brake is that of UIC
540. Chokes, band and limit are assumed.
"""

from __future__ import annotations

from dataclasses import dataclass

from brake_controller.air import AMBIENT, HEAT_CAPACITY, WALL, choke_flow, share_of
from brake_controller.distributors import uic
from brake_controller.distributors.distributor import Answer, Distributor, Moment
from brake_controller.distributors.uic import UicDistributor, freight
from fmu_src.symbols import ca
from fmu_src.system import quantity

#: Difference of the pipe to its demand at which a magnet valve begins to open, and beyond it to be open [Pa]. Assumed.
BAND = 5e3
#: Fall of the pipe over that of a full service up to which valves feed it: they do not work against an emergency.
FEEDS = 1.2


@dataclass(frozen=True)
class EpUicDistributor(UicDistributor):
    """A distributor with magnet valves at the pipe."""

    ep_vent_choke: float = quantity("m", "Diameter of the magnet valve that vents the pipe", 0.0)
    ep_feed_choke: float = quantity("m", "Diameter of the magnet valve that feeds the pipe", 0.0)
    main_pressure: float = quantity("Pa", "Pressure of the main pipe, which stays", 0.0)


def ready(position: str) -> EpUicDistributor:
    """Return a UIC 540 distributor by its position with magnet valves of 4 mm and a main pipe of 8 bar. Assumed."""
    return EpUicDistributor(**freight(position).values(), ep_vent_choke=4e-3, ep_feed_choke=4e-3, main_pressure=800e3)


def whole(moment: Moment) -> Answer:
    """Return the answer of the UIC 540 distributor, with the flows of its magnet valves (ISO 6358-1)."""
    p, pipe, plain = moment.given, moment.pipe, uic.whole(moment)
    fallen = moment.states["control"] - pipe.pressure
    lacks = p["ordered"] * p["full_difference"] - fallen

    def opens(excess: ca.SX) -> ca.SX:
        return share_of(excess / BAND - 1)

    feeds = opens(-lacks) * ca.if_else(fallen < FEEDS * p["full_difference"], 1, 0)
    vented = (
        opens(lacks)
        * ca.if_else(p["ordered"] > 0, 1, 0)
        * choke_flow(p["ep_vent_choke"], pipe.pressure, pipe.temperature, AMBIENT)
    )
    fed = feeds * choke_flow(p["ep_feed_choke"], p["main_pressure"] + AMBIENT, WALL, pipe.pressure)
    enthalpy = plain.enthalpy + HEAT_CAPACITY * (vented * pipe.temperature - fed * WALL)
    return Answer(plain.rates, plain.taken + vented - fed, enthalpy, plain.filling)


EP_UIC = Distributor(
    name="ep_uic",
    parameters=EpUicDistributor,
    states=uic.STATES,
    ready=ready,
    whole=whole,
    pace=uic.fastest_change,
    adjustable=uic.UIC.adjustable,
    assisted=True,
)

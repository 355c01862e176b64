"""A direct electro-pneumatic brake: an electric command fills and empties the cylinder, the pipe does not.

The air comes from a main reservoir that stays full (that of `main_reservoir.py` does not supply it), and not from the
pipe.
"""

from __future__ import annotations

from dataclasses import dataclass

from brake_controller.air import AMBIENT
from brake_controller.distributors.distributor import Answer, Distributor, DistributorParameters, Moment
from fmu_src.symbols import ca
from fmu_src.system import quantity

#: Times of filling to 95 % and of release to 0.4 bar [s], of metros. Assumed.
FILLING, RELEASE = 1.5, 2.0
#: Pressure to which a cylinder is released in the release time [Pa, gauge] (UIC 540).
RELEASED = 40e3
#: Rate at which wheel-slide protection empties a cylinder [Pa/s]. Assumed.
VENTS = 600e3
#: Paces times the shorter time: the rate is constant up to 95 %, and from full to 0.4 bar.
PACE_BY_TIME = 25.0


@dataclass(frozen=True)
class EpDirect(DistributorParameters):
    """A cylinder with constant rates of filling and release; pressures are gauge pressures."""

    filling_rate: float = quantity("Pa/s", "Largest rate at which the cylinder fills", 1.0)
    release_rate: float = quantity("Pa/s", "Largest rate at which the cylinder empties", 1.0)
    vent_rate: float = quantity("Pa/s", "Rate at which wheel-slide protection empties the cylinder", 0.0)
    settling: float = quantity("1/s", "Rate at which the cylinder settles at its target", 1e-2)


def with_times(pressure: float, filling: float = FILLING, release: float = RELEASE) -> EpDirect:
    """Return a brake with a full pressure [Pa], times of filling to 95 % and of release to 0.4 bar [s] (UIC 540)."""
    return EpDirect(
        full_pressure=pressure,
        filling_rate=0.95 * pressure / filling,
        release_rate=(pressure - RELEASED) / release,
        vent_rate=VENTS,
        settling=PACE_BY_TIME / min(filling, release),
    )


def ready(position: str) -> EpDirect:
    """Return the brake of a metro with 3.8 bar; positions make no difference."""
    del position
    return with_times(380e3)


def whole(moment: Moment) -> Answer:
    """Return the rate of the cylinder's pressure: to the demanded share of the full pressure, at limited rates.

    Ramps of constant rate, as EN 14531-1 takes build-up after a dead time.
    """
    p, over = moment.given, moment.states["cylinder"] - AMBIENT
    wanted = p["demanded"] * p["full_pressure"]
    change = ca.fmax(ca.fmin(p["settling"] * (wanted - over), p["filling_rate"]), -p["release_rate"])
    vents = p["vented"] * ca.fmin(p["settling"] * ca.fmax(over, 0), p["vent_rate"])
    return Answer({"cylinder": (1 - p["held"]) * change - vents}, ca.SX(0), ca.SX(0), ca.SX(0))


def settling(p: EpDirect) -> float:
    """Return the rate at which the cylinder settles [1/s]."""
    return p.settling


EP_DIRECT = Distributor(
    name="ep_direct",
    parameters=EpDirect,
    states=(("cylinder", "cylinder"),),
    ready=ready,
    whole=whole,
    pace=settling,
    wired=True,
)

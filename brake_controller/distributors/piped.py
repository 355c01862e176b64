"""A vehicle that only carries the brake pipe on: it has no brake."""

from __future__ import annotations

from dataclasses import dataclass

from brake_controller.distributors.distributor import Answer, Distributor, DistributorParameters, Moment
from fmu_src.symbols import ca


@dataclass(frozen=True)
class Piped(DistributorParameters):
    """No cylinder: its pressure stays that of the surroundings."""


def ready(position: str) -> Piped:
    """Return the only set, without a pressure; positions make no difference."""
    del position
    return Piped(full_pressure=0.0)


def whole(moment: Moment) -> Answer:
    """Return no change and no air from the pipe."""
    del moment
    return Answer({"cylinder": ca.SX(0)}, ca.SX(0), ca.SX(0), ca.SX(0))


def pace(p: Piped) -> float:
    """Return a rate that limits no step [1/s]."""
    del p
    return 1.0


PIPED = Distributor(
    name="piped",
    parameters=Piped,
    states=(("cylinder", "around"),),
    ready=ready,
    whole=whole,
    pace=pace,
)

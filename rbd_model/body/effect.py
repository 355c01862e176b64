"""Loads on bodies, and the effect of a connection on both of its ends, eqs (3.35) to (3.42)."""

from __future__ import annotations

import operator
from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import reduce

from fmu_src.symbols import ca
from rbd_model.body.relation import Relation, Stretch
from rbd_model.vehicle.description import DIRECTIONS


@dataclass(frozen=True)
class Load:
    """Load on a body: force [N] in the axes of the track there, moment about its centre [N.m] in its own axes."""

    force: ca.SX
    moment: ca.SX

    def __add__(self, other: Load) -> Load:
        return Load(self.force + other.force, self.moment + other.moment)


@dataclass(frozen=True)
class Effect:
    """Effect of connections of one pair: force on the lower end [N] in its axes; the upper end has the opposite one.

    raised, lowered: moments on the (upper, lower) end about its own centre, in its own axes [N.m]; energy stored [J]
    and power lost [W].
    """

    force: ca.SX
    raised: ca.SX
    lowered: ca.SX
    potential: ca.SX
    power: ca.SX

    def __add__(self, other: Effect) -> Effect:
        return Effect(*(getattr(self, item.name) + getattr(other, item.name) for item in fields(Effect)))

    @classmethod
    def of(cls, relation: Relation, stretch: Stretch, pull: ca.SX, potential: ca.SX, power: ca.SX) -> Effect:
        """Return the effect of a force between two points, eqs (3.41), (3.42): it acts in one line on both ends."""
        raised = ca.cross(relation.axes.T @ pull, stretch.upper)
        return cls(pull, raised, ca.cross(stretch.lower + stretch.way, pull), potential, power)


def sum_of(effects: Sequence[Effect]) -> Effect:
    """Return the sum of at least one effect, eqs (3.35), (3.36)."""
    return reduce(operator.add, effects)


def along(direction: str, value: ca.SX) -> ca.SX:
    """Return a vector of this size along one of DIRECTIONS, the axes of section 3.2.1."""
    return ca.vertcat(*[value if name == direction else 0 for name in DIRECTIONS])

"""The coach in a curve, pushed and pulled at its couplers: lateral forces and Y/Q in the steady part."""

from __future__ import annotations

from dataclasses import dataclass

from products.coach import COACH, NUMBERS
from products.kernel_runs import prepare_on_line
from rbd_model.track.line import Line, arc, clothoid, line_of, straight

#: Radius [m], speed at the entry [m/s], and time of steady running [s].
RADIUS, SPEED, SETTLED = 300.0, 10.0, 25.0


def curve() -> Line:
    """Return a curve to the left, without cant."""
    before, behind = straight(30.0), arc(400.0, RADIUS)
    return line_of([before, clothoid(60.0, before, behind), behind])


@dataclass(frozen=True)
class Guided:
    """Sum of the lateral forces of all rails [N], to the left above zero, and the largest Y/Q of a wheel [1]."""

    force: float
    quotient: float


def pushed(compression: float) -> Guided:
    """Return the steady state with both couplers pushed by a force [N]; below zero they are pulled."""
    both = {"coupler_force_front": -compression, "coupler_force_rear": compression}
    coach = prepare_on_line("vehicle", curve(), level=3, contact_model=2.0, initial_speed=SPEED, **both)
    coach.initialise()
    coach.advance(SETTLED)
    force = sum(coach[f"guiding_force_{n}"] for n in NUMBERS)
    quotients = (coach[f"derailment_quotient_{n}_{side}"] for n in NUMBERS for side in ("left", "right"))
    return Guided(force, max(abs(quotient) for quotient in quotients))


def on_paper(compression: float) -> float:
    """Return the lateral force of both couplers [N], along the track at their places:

    F a / R each, a half of their distance.
    """
    return compression * COACH.coupler_distance / RADIUS

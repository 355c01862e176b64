"""Flexible track below a wheelset: both rails move sideways as one, and each of them up and down.

Springs, dampers and the mass of the rails carry these motions and move along with the wheelset. The deflection below
one wheelset has no effect on the next. Different heights of both rails are the roll of the track. Without a line rails
are rigid.

Rails without mass would have their speed from an equation without derivatives, because forces depend on it by creep and
the contacts' damping. That has no solution if the force of a contact jumps; with mass there are no more unknowns.
"""

from __future__ import annotations

from dataclasses import dataclass

from fmu_src.symbols import ca
from rbd_model.vehicle.assembly import Assembly
from rbd_model.vehicle.scales import NOMINAL_TRAVEL_SPEED
from rbd_model.wheelset.touch import SIDES

#: Scale of the error control: with tolerance 1e-6, 1 nm of a rail that is deflected by 1 mm [m].
NOMINAL_GIVE = 1e-3


@dataclass(frozen=True)
class Give:
    """Deflection of rails below a wheelset and its speed; rows: both to the left, the left one up, the right one up.

    Heights are relative to those under the static load, as for the bodies that the rails carry. mass, stiffness,
    damping: of each row; static [N]: force at rest.
    """

    moved: ca.SX  # [m]
    speed: ca.SX  # [m/s]
    mass: ca.SX
    stiffness: ca.SX
    damping: ca.SX
    static: ca.SX

    @classmethod
    def rigid(cls) -> Give:
        """Return rails that do not move."""
        return cls(*(ca.SX(3, 1) for _ in range(6)))

    @property
    def kinetic(self) -> ca.SX:
        """Energy of the rails' motion [J]."""
        return ca.dot(self.mass, self.speed**2) / 2

    @property
    def stored(self) -> ca.SX:
        """Energy in the springs, relative to the state under the static load [J]."""
        return ca.dot(self.stiffness, self.moved**2) / 2 + ca.dot(self.static, self.moved)

    @property
    def damping_power(self) -> ca.SX:
        """Power dissipated in the dampers [W]."""
        return ca.dot(self.damping, self.speed**2)


def rows_of(number: int) -> list[str]:
    """Return names of the rows of a wheelset's `Give`."""
    return [f"track_{number}", *(f"track_{number}_{word}" for word in SIDES.values())]


def add_give(assembly: Assembly, number: int) -> Give:
    """Declare the motion of the rails below a wheelset; they start at their deflection under the static load."""
    system, p = assembly.system, assembly.parameter
    moved = [system.state(name, "m", 0.0, NOMINAL_GIVE) for name in rows_of(number)]
    speed = [system.state(f"{name}_speed", "m/s", 0.0, NOMINAL_TRAVEL_SPEED) for name in rows_of(number)]
    for place, rate in zip(moved, speed, strict=True):
        system.derivative(place, rate)
    stiffness, damping = (
        ca.vertcat(*[p[f"track_{direction}_{kind}"] for direction in ("lateral", "vertical", "vertical")])
        for kind in ("stiffness", "damping")
    )
    weight = assembly.value(assembly.vehicle.wheelsets[number - 1].mass) * p["gravity"]
    load = (assembly.resting_on(number) + weight) / 2
    mass = p["track_rail_mass"] * ca.SX([2, 1, 1])
    return Give(ca.vertcat(*moved), ca.vertcat(*speed), mass, stiffness, damping, -ca.vertcat(0, load, load))


def press_rails(assembly: Assembly, give: Give, sideways: ca.SX, loads: ca.SX) -> None:
    """Add the motion of the rails against their springs and dampers: Newton's second law, as (3.73).

    sideways [N]: of both wheels on the rails, to the left; loads [N]: of each wheel, downwards.
    """
    held = give.static + give.stiffness * give.moved + give.damping * give.speed
    rates = assembly.parameter["flexible_track"] * (ca.vertcat(sideways, -loads) - held) / give.mass
    for speed, rate in zip(*map(ca.vertsplit, (give.speed, rates)), strict=True):
        assembly.system.derivative(speed, rate)

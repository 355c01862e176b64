"""The electric brake of a train's vehicle, and how air fills what it lacks."""

from __future__ import annotations

from dataclasses import dataclass

from brake_controller.air import AMBIENT
from brake_controller.drive import LEAST, NO_LIMIT, OverSpeed, driven_by, followed
from brake_controller.vehicle_brake import VehicleBrake, brake_force, named
from fmu_src.chain import function_of
from fmu_src.symbols import ca
from fmu_src.system import choice, quantity

#: Speed below which an electric brake fades out, where none is given [m/s]: 8 km/h. Assumed, as train simulators do.
FADE = 8.0 / 3.6
#: Commands of a vehicle: share of its whole brake that drivers demand, and share of its electric brake alone. Then the
#: force of its electric brake before a step [N], and the length of the step [s].
DEMANDED = ("demanded", "dynamic", "before", "step")


#: Blending of air with the electric brake of a vehicle by wire, by names in consists. Air fills what the electric brake
#: lacks. Or both add, each with the whole demand. Or a valve keeps air out above a speed. OpenBVE has these three.
#: With a brake by the pipe both add, or the interlock of locomotives bails the air off while the electric brake acts.
FILLS, ADDS, CLOSES, INTERLOCK = range(4)
BLENDINGS = {"fills": FILLS, "adds": ADDS, "closes": CLOSES, "interlock": INTERLOCK}


@dataclass(frozen=True)
class ElectricBrake(OverSpeed):
    """Electric command and electric brake of one vehicle."""

    blended_pressure: float = quantity("Pa", "Full pressure of a direct electro-pneumatic brake; 0 without one", 0.0)
    dead_time: float = quantity("s", "Time from the driver's command to the vehicle's answer", 0.0, 9.0)
    dynamic_force: float = quantity("N", "Largest force of the electric brake at the rims", 0.0)
    dynamic_power: float = quantity("W", "Largest power of the electric brake at the rims", 0.0, NO_LIMIT)
    dynamic_fade: float = quantity("m/s", "Speed below which the electric brake fades out linearly", 0.0)
    dynamic_rise: float = quantity("s", "Time of the electric brake's rise to its largest force, and of its fall", 0.0)
    blending: float = choice(
        "Air with the electric brake",
        {FILLS: "it fills", ADDS: "both add", CLOSES: "it is shut", INTERLOCK: "it is bailed off"},
    )
    blending_speed: float = quantity("m/s", "Speed above which air is shut out with blending 2", 0.0)


#: A vehicle without electric command and electric brake.
NO_ELECTRIC_BRAKE = ElectricBrake(0.0, 0.0, 0.0, NO_LIMIT, FADE, 0.0, float(FILLS), 0.0)


def blending() -> ca.Function:
    """Return the function for a step of an electric brake: mean force at the rims [N], share of the air, last force.

    The electric brake gives min(F(v), P / v), fading out linearly below a speed: the part of the demanded force that it
    can, or the share that its own command demands. Its force rises and falls at the rate F / T, as EN 14531-1 takes
    build-up. Air fills what the electric brake lacks after its rise (blending of metros), as a share of the shoe force.
    This is exact for a friction that does not depend on that force. Forces are those of eqs (2.4) and (2.6). With
    other choices of BLENDINGS air has the whole demand, always or up to a speed.
    """
    wheel, command = ca.SX.sym("wheel"), ca.SX.sym("command", len(DEMANDED))
    brake, given = ca.SX.sym("brake", len(named(VehicleBrake))), ca.SX.sym("given", len(named(ElectricBrake)))
    p, b = (
        dict(zip(named(of), ca.vertsplit(row), strict=True))
        for of, row in ((ElectricBrake, given), (VehicleBrake, brake))
    )
    demanded, dynamic, before, step = ca.vertsplit(command)
    fast = ca.fabs(wheel)
    strength = driven_by(p["dynamic_force"], p["dynamic_power"], p, fast)
    able = strength * ca.fmin(fast / ca.fmax(p["dynamic_fade"], LEAST), 1)
    full = brake_force(p["blended_pressure"] + AMBIENT, wheel, b)
    electric = ca.fmin(ca.fmax(demanded * full, dynamic * able), able)
    change = p["dynamic_force"] * step / ca.fmax(p["dynamic_rise"], LEAST**2)
    mean, ends = followed(electric, able, before, change)
    lacks = ca.fmax(demanded - electric / ca.fmax(full, LEAST), 0)
    shut = ca.if_else(fast > p["blending_speed"], 0, demanded)
    lacks = ca.if_else(p["blending"] == ADDS, demanded, ca.if_else(p["blending"] == CLOSES, shut, lacks))
    pressed = ca.fmax(b["force_per_pressure"] * p["blended_pressure"], LEAST)
    share = lacks + (1 - lacks) * ca.fmin(b["counter_force"] / pressed, 1)
    found = ca.vertcat(mean, ca.if_else(lacks > 0, share, 0), ends)
    return function_of("blending", [wheel, command, brake, given], found)

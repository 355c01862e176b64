"""Track brakes of a train's vehicle, whose force acts between its body and the rails, for rolling and sliding wheels.

Magnets that rub on the rails, and linear eddy-current brakes above them. Their heat goes into the rails, not into the
wheels. Cleaning of the rails by magnets, their attraction on a warm rail, and the vertical force of eddy-current brakes
on the vehicle are not modelled.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from brake_controller.air import AMBIENT
from brake_controller.build_up import LEAST, ramped
from brake_controller.shoe_friction import KILOMETRES_PER_HOUR
from brake_controller.vehicle_brake import named
from fmu_src.chain import function_of
from fmu_src.symbols import ca
from fmu_src.system import ParameterSet, quantity

#: Friction of magnets on the rail at standstill and at high speed [1], and the speed at which half of the change is
#: reached [m/s]. Assumed, between the 0.25 and 0.1 that are reported: 0.15 at 50 km/h, 0.10 at 160 km/h.
FRICTION, FRICTION_FAST, FRICTION_SPEED = 0.25, 0.05, 50.0 / KILOMETRES_PER_HOUR
#: Speed below which magnets lift, and above which they are lowered without a command [m/s]. Assumed.
LIFT, FROM = 20.0 / KILOMETRES_PER_HOUR, 50.0 / KILOMETRES_PER_HOUR
#: Speed of the largest force of an eddy-current brake [m/s]: 80 % of it from 50 to 200 km/h. Assumed, for brakes whose
#: deceleration is reported as nearly constant down to 50 km/h.
EDDY_SPEED = 100.0 / KILOMETRES_PER_HOUR
#: Gauge pressure of the pipe below which track brakes apply [Pa]: full service has 3.5 bar. Assumed.
PIPE = 3e5
#: Time of the rise to the whole force, and of its fall [s]. Assumed.
RISE = 1.0
#: Step in which no rise is seen [s].
LONG = 1e9
#: Command of a vehicle's track brakes, absolute pressure of its pipe [Pa]; shares of attraction and of excitation
#: before a step, and the length of the step [s].
ORDERED = ("share", "pipe", "lowered", "excited", "step")


@dataclass(frozen=True)
class TrackBrakes(ParameterSet):
    """Magnetic and eddy-current brakes of one vehicle."""

    magnetic_attraction: float = quantity("N", "Attraction of all magnets to the rails; 0 without any", 0.0)
    magnetic_friction: float = quantity("1", "Friction of magnets on the rails at standstill", 0.0)
    magnetic_fast: float = quantity("1", "Friction of magnets at a speed without limit", 0.0)
    magnetic_speed: float = quantity("m/s", "Speed at which half of the change of their friction is reached", 0.0)
    magnetic_lift: float = quantity("m/s", "Speed below which magnets lift", 0.0)
    magnetic_from: float = quantity("m/s", "Speed from which the pipe lowers magnets", 0.0)
    magnetic_rise: float = quantity("s", "Time of the rise of their attraction, and of its fall", 0.0)
    eddy_force: float = quantity("N", "Largest force of the eddy-current brake; 0 without one", 0.0)
    eddy_speed: float = quantity("m/s", "Speed of the eddy-current brake's largest force", 0.0)
    eddy_rise: float = quantity("s", "Time of the rise of the eddy-current brake's excitation, and of its fall", 0.0)
    applied_below: float = quantity("Pa", "Gauge pressure of the pipe below which track brakes apply; 0: never", 0.0)


#: A vehicle without track brakes.
NO_TRACK_BRAKES = TrackBrakes(
    magnetic_attraction=0.0,
    magnetic_friction=FRICTION,
    magnetic_fast=FRICTION_FAST,
    magnetic_speed=FRICTION_SPEED,
    magnetic_lift=LIFT,
    magnetic_from=FROM,
    magnetic_rise=RISE,
    eddy_force=0.0,
    eddy_speed=EDDY_SPEED,
    eddy_rise=RISE,
    applied_below=PIPE,
)


def track_braking() -> ca.Function:
    """Return the function for a step of track brakes: force [N], shares of attraction and of excitation at its end.

    Magnets: mu F with Coulomb's friction, mu = fast + (mu0 - fast) V2 / (V + V2), which has the form of the second
    fraction of Karwatzki (1950). They are on or off: lowered by any command, and below a pressure of the pipe from a
    speed on; they lift below another speed. Eddy currents: F 2 x / (1 + x^2), x = v / vk (Kloss (1916), as in
    Modelica's EddyCurrentForce), with the
    excitation that the command demands, all of it below that pressure of the pipe. Arguments: speed of the vehicle,
    ORDERED, and the brakes.
    """
    speed, order = ca.SX.sym("speed"), ca.SX.sym("order", len(ORDERED))
    given = ca.SX.sym("given", len(named(TrackBrakes)))
    p = dict(zip(named(TrackBrakes), ca.vertsplit(given), strict=True))
    o = dict(zip(ORDERED, ca.vertsplit(order), strict=True))
    fast = ca.fabs(speed)
    low = ca.logic_and(p["applied_below"] > 0, o["pipe"] - AMBIENT < p["applied_below"])  # a vent pulls below ambient
    falls = ca.if_else(low, 1, 0)
    begins = ca.if_else(ca.fmax(fast - p["magnetic_from"], o["lowered"]) > 0, falls, 0)
    down = ca.if_else(fast >= p["magnetic_lift"], ca.fmax(ca.if_else(o["share"] > 0, 1, 0), begins), 0)
    attracted, lowered = ramped(o["lowered"], down, p["magnetic_rise"], o["step"])
    excitation, excited = ramped(o["excited"], ca.fmax(o["share"], falls), p["eddy_rise"], o["step"])
    half = ca.fmax(p["magnetic_speed"], LEAST)
    friction = p["magnetic_fast"] + (p["magnetic_friction"] - p["magnetic_fast"]) * half / (fast + half)
    x = fast / ca.fmax(p["eddy_speed"], LEAST)
    force = attracted * friction * p["magnetic_attraction"] + excitation * p["eddy_force"] * 2 * x / (1 + x**2)
    return function_of("track_braking", [speed, order, given], ca.vertcat(force, lowered, excited))


def lowered_magnets(track: TrackBrakes, speeds: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the force of lowered magnets at speeds [N], mu F with Coulomb's friction as in `track_braking`."""
    alone = [*replace(track, eddy_force=0.0).values().values()]
    orders = np.tile([[1.0], [AMBIENT], [0.0], [0.0], [LONG]], speeds.size)
    found = track_braking().map(speeds.size)(speeds[np.newaxis], orders, np.tile(np.c_[alone], speeds.size))
    return np.asarray(found)[0]

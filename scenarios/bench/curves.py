"""Curves for the bogie of chapter 5: their lines, speed and balanced cant, lateral acceleration."""

import math

from rbd_model.track.line import Line, arc, clothoid, line_of, straight
from rbd_model.track.line_table import GAUGE
from rbd_model.vehicle.parameters import tables_5_1_and_5_2

BOGIE = tables_5_1_and_5_2()
#: The whole bogie [kg], and the load of each of its wheels at rest [N].
MASS = BOGIE.frame_mass + 2 * BOGIE.wheelset_mass
WHEEL_LOAD = MASS * BOGIE.gravity / 4
#: Contribution of both wheelsets' rotation to the mass [kg].
TURNING_MASS = 2 * BOGIE.wheelset_pitch_inertia / BOGIE.wheel_radius**2
#: Largest cant of a curve [m]: EN 13803 has 160 mm.
MOST_CANT = 0.15
#: Straight track before the transition, and the least length of that [m]; its cant ramp is no steeper than 1:600.
APPROACH, LEAST_TRANSITION, RAMP = 20.0, 60.0, 600.0


def suited_cant(radius: float, speed: float) -> float:
    """Return the balanced cant of a curve [m] at a speed [m/s], at most MOST_CANT [m]."""
    return min(MOST_CANT, GAUGE * speed**2 / radius / BOGIE.gravity)


def suited_speed(radius: float, cant: float, deficiency: float = 0.0) -> float:
    """Return the speed with a cant deficiency [m] in a curve [m/s]."""
    return math.sqrt(radius * BOGIE.gravity * (cant + deficiency) / GAUGE)


def transition_length(cant: float) -> float:
    """Return the length of the clothoid into a curve [m]."""
    return max(LEAST_TRANSITION, RAMP * abs(cant))


def into_curve(radius: float, cant: float, length: float) -> Line:
    """Return straight track, a transition, and a curve to the left of some length [m]; no curve with an infinite
    radius.
    """
    before, behind = straight(APPROACH), arc(length, radius, cant)
    return line_of([before, clothoid(transition_length(cant), before, behind), behind])


def outward_acceleration(radius: float, cant: float, speed: float) -> float:
    """Return the acceleration across the track that the guiding forces of all wheelsets provide (Newton's second law)
    [m/s2].
    """
    angle = math.asin(cant / GAUGE)
    return speed**2 / radius * math.cos(angle) - BOGIE.gravity * math.sin(angle)

"""Curves for the bogie of chapter 5: their lines, speed and cant that suit each other, what pushes outwards there."""

import math

from rbd_model.track.line import Line, arc, clothoid, line_of, straight
from rbd_model.track.line_table import GAUGE
from rbd_model.vehicle.parameters import tables_5_1_and_5_2

BOGIE = tables_5_1_and_5_2()
#: The whole bogie [kg], and the load of each of its wheels at rest [N].
MASS = BOGIE.frame_mass + 2 * BOGIE.wheelset_mass
WHEEL_LOAD = MASS * BOGIE.gravity / 4
#: What both wheelsets add to the mass as they turn [kg].
TURNING_MASS = 2 * BOGIE.wheelset_pitch_inertia / BOGIE.wheel_radius**2
#: Most cant that a curve gets: EN 13803 has 160 mm [m].
MOST_CANT = 0.15
#: Straight track before the transition, and the least length of that [m]; its cant ramp is no steeper than 1:600.
APPROACH, LEAST_TRANSITION, RAMP = 20.0, 60.0, 600.0


def suited_cant(radius: float, speed: float) -> float:
    """Cant that a curve [m] gets for a speed [m/s]: what balances it, where that is not too much [m]."""
    return min(MOST_CANT, GAUGE * speed**2 / radius / BOGIE.gravity)


def suited_speed(radius: float, cant: float, deficiency: float = 0.0) -> float:
    """Speed with a cant deficiency [m] in a curve [m/s]."""
    return math.sqrt(radius * BOGIE.gravity * (cant + deficiency) / GAUGE)


def transition_length(cant: float) -> float:
    """Of the clothoid into a curve [m]."""
    return max(LEAST_TRANSITION, RAMP * abs(cant))


def into_curve(radius: float, cant: float, length: float) -> Line:
    """Straight track, a transition, and a curve to the left of some length [m]; no curve with an infinite radius."""
    before, behind = straight(APPROACH), arc(length, radius, cant)
    return line_of([before, clothoid(transition_length(cant), before, behind), behind])


def outward_acceleration(radius: float, cant: float, speed: float) -> float:
    """Across the track, which the guiding forces of all wheelsets take (Newton's second law) [m/s2]."""
    angle = math.asin(cant / GAUGE)
    return speed**2 / radius * math.cos(angle) - BOGIE.gravity * math.sin(angle)

"""Curves as OSRD computes them, where it differs from SUBSET-026: points every 2 s, joined at constant deceleration.

Read in core/envelope-sim of OpenRailAssociation/osrd: `TrainPhysicsIntegrator`, `ETCSBrakingCurves`. Level track.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from products.supervision import FixedValues, Steps
from products.supervision.curves import speed_inaccuracy

#: Time between two points [s], speed at which curves end [m/s], acceleration while the brake builds up [m/s2].
STEP, TOP, BUILDING_UP = 2.0, 110.0, 0.4


@dataclass(frozen=True)
class Points:
    """Points of a curve in the order of speed: places [m] and speeds [m/s]."""

    places: np.ndarray
    speeds: np.ndarray

    def at(self, speed: float) -> float:
        """Return the place at a speed, with a constant deceleration between two points."""
        return float(np.interp(speed**2, self.speeds**2, self.places))

    def earlier(self, seconds: float) -> Points:
        """Return the curve that a train with constant speed passes this time before."""
        return Points(self.places - seconds * self.speeds, self.speeds)


def decelerate(brake: Steps, place: float, speed: float, until: float = TOP) -> Points:
    """Return the curve through a foot, to higher speeds or back to a lower one.

    The second and third of four evaluations are at the speeds after half a step and a whole one. They should both be at
    half a step (Runge-Kutta). The fourth is at twice the step.
    """
    way, points = 1.0 if until > speed else -1.0, [(place, speed)]
    while (until - points[-1][1]) * way > 0.0:
        place, speed = points[-1]
        seen, mean = speed, 0.0
        for share, weight in ((0.5, 1.0), (0.5, 2.0), (1.0, 2.0), (0.0, 1.0)):
            rate = float(brake.at(abs(seen))[0])
            mean, seen = mean + weight * rate / 6.0, seen + way * rate * share * STEP
        points.append((place - way * speed * STEP - mean * STEP**2 / 2.0, speed + way * mean * STEP))
    places, speeds = np.array(points[:: int(way)]).T
    return Points(places, speeds)


@dataclass(frozen=True)
class Osrd:
    """A train of OSRD: decelerations [m/s2] and times [s]."""

    safe: Steps
    service: Steps
    normal_service: Steps
    T_be: float
    T_bs: float

    def indication(self, curve: Points, place: float, target: float, speed: float) -> float:
        """Return I from the curve of an intervention; guidance ends at the target, with its speed."""
        guidance = decelerate(self.normal_service, place, target)
        permitted = min(curve.earlier(self.T_bs + 4.0).at(speed), guidance.at(speed))
        return permitted - speed * (max(0.8 * self.T_bs, 5.0) + 4.0)

    def of_stop(self, speed: float) -> float:
        """Return I of an end of authority at 0, without what is behind it [m]."""
        return self.indication(decelerate(self.service, 0.0, 0.0), 0.0, 0.0, speed)

    def of_target(self, speed: float, target: float = 0.0, place: float = 0.0) -> float:
        """Return I of a supervised location (target 0), or of a limit of authority [m]."""
        margin = float(FixedValues().dV_ebi(target)) if target else 0.0
        ebd = decelerate(self.safe, place, target + margin)
        if target:
            behind = decelerate(self.safe, place, target + margin, until=0.5 * target)
            ebd = Points(*(np.append(getattr(behind, one)[:-1], getattr(ebd, one)) for one in ("places", "speeds")))
        # The way of the build-up begins at the speed of EBD; by the standard EBD has the speed at its end.
        error = speed_inaccuracy(ebd.speeds)
        faster = np.maximum(ebd.speeds + error, target) - ebd.speeds + BUILDING_UP * self.T_be
        way = (ebd.speeds + faster - BUILDING_UP * self.T_be / 2.0) * self.T_be
        ebi = Points(ebd.places - way, ebd.speeds - faster)
        return self.indication(ebi, place, target, speed)

"""Electric drives, braking or driving: force over speed, power, rise."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from brake_controller.point_table import PointTable, with_default
from fmu_src.symbols import ca
from fmu_src.system import ParameterSet

#: Largest number of points of a force over speed.
MOST_DRIVE_POINTS = 8
#: Speed above which a table falls at constant power, for drives without a table [m/s].
NO_END = 1e9
#: Power of a drive that has no limit of it [W].
NO_LIMIT = 1e12
#: Time of the rise to the largest force, where none is given [s]. Assumed: a metro's service deceleration of 1.0 to 1.3
#: m/s2 at a jerk of about 1 m/s3.
RISE = 1.0
#: Least speed [m/s] in a denominator.
LEAST = 1e-6


@dataclass(frozen=True)
class OverSpeed(ParameterSet):
    """The force of a drive over speed as a share of its largest one; by default it is constant."""

    shape_start: float = with_default("1", "Share of the force up to the first speed", 1.0, 0.0)
    shape_end: float = with_default("m/s", "Speed above which the force falls as one over speed", NO_END, LEAST)
    shape_speed_1: float = with_default("m/s", "Speed of point 1 of the force", 0.0, 0.0)
    shape_speed_2: float = with_default("m/s", "Speed of point 2 of the force", 0.0, 0.0)
    shape_speed_3: float = with_default("m/s", "Speed of point 3 of the force", 0.0, 0.0)
    shape_speed_4: float = with_default("m/s", "Speed of point 4 of the force", 0.0, 0.0)
    shape_speed_5: float = with_default("m/s", "Speed of point 5 of the force", 0.0, 0.0)
    shape_speed_6: float = with_default("m/s", "Speed of point 6 of the force", 0.0, 0.0)
    shape_speed_7: float = with_default("m/s", "Speed of point 7 of the force", 0.0, 0.0)
    shape_speed_8: float = with_default("m/s", "Speed of point 8 of the force", 0.0, 0.0)
    shape_change_1: float = with_default("s/m", "Change of slope at point 1 of the force", 0.0)
    shape_change_2: float = with_default("s/m", "Change of slope at point 2 of the force", 0.0)
    shape_change_3: float = with_default("s/m", "Change of slope at point 3 of the force", 0.0)
    shape_change_4: float = with_default("s/m", "Change of slope at point 4 of the force", 0.0)
    shape_change_5: float = with_default("s/m", "Change of slope at point 5 of the force", 0.0)
    shape_change_6: float = with_default("s/m", "Change of slope at point 6 of the force", 0.0)
    shape_change_7: float = with_default("s/m", "Change of slope at point 7 of the force", 0.0)
    shape_change_8: float = with_default("s/m", "Change of slope at point 8 of the force", 0.0)


SHAPE = PointTable("shape_start", "shape_speed", "shape_change", MOST_DRIVE_POINTS)


def shape_of(speeds: Sequence[float], forces: Sequence[float]) -> dict[str, float]:
    """Return the parameters of `OverSpeed` of points.

    Takes speeds [m/s], forces [N].
    """
    largest = max(forces)
    return SHAPE.numbers(speeds, [force / largest for force in forces]) | {"shape_end": speeds[-1]}


def points_of_drive(p: Mapping[str, float], largest: float) -> tuple[list[float], list[float]] | None:
    """Return the speeds [m/s] and forces [N] of parameters by `shape_of` with a largest force [N]; None: constant."""
    if p["shape_end"] == NO_END:
        return None
    speeds, shares = SHAPE.points(p)
    return speeds, [share * largest for share in shares]


def driven_by(force: ca.SX, power: ca.SX, p: Mapping[str, ca.SX], fast: ca.SX) -> ca.SX:
    """Return the force of a drive [N] at a speed [m/s], min(F(v), P / v).

    F is the user's table, and falls at constant power above its last point, so that no wheel spins up without a limit.
    """
    share = ca.fmax(SHAPE.at(p, fast), 0) * ca.fmin(1, p["shape_end"] / ca.fmax(fast, LEAST))
    return ca.fmin(force * share, power / ca.fmax(fast, LEAST))


def followed(wanted: ca.SX, able: ca.SX, before: ca.SX, change: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Return mean and last force of a step [N] that follows a demand at a limited rate.

    It rises and falls by at most `change` within the step, as EN 14531-1 takes build-up. Unlike `build_up.ramped`, it
    follows what the drive is able to at each speed without a rise.
    """
    ends = ca.fmin(ca.fmax(ca.fmin(wanted, before + change), before - change), able)
    return ca.if_else(ends == wanted, ends, (before + ends) / 2), ends

"""What holds a vehicle back beside its brakes where the model has no motion for it: levels point and planar.

Running resistance: W. J. Davis (1926), The tractive resistance of electric locomotives and cars, General Electric
Review 29: a + b V + c V^2. Curves: von Roeckl (1880), as railway handbooks print it: a share of the weight of
0.650 / (R - 55 m) on main lines, and 0.500 / (R - 30 m) below R = 300 m. All are zero with the start values.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from fmu_src.system import ParameterSet, quantity
from rbd_model.assembly import Assembly

#: Von Roeckl (1880): share of the weight times (R - place) [m], and the place [m]; above and below a radius of 300 m.
WIDE, TIGHT, RADIUS = (0.650, 55.0), (0.500, 30.0), 300.0


@dataclass(frozen=True)
class RunningResistance(ParameterSet):
    """Of the whole vehicle; the constant part goes to zero with the speed, over creepage_speed."""

    davis_constant: float = quantity("N", "Running resistance that does not change with speed (a of Davis)", 0.0)
    davis_linear: float = quantity("N.s/m", "Running resistance for each m/s (b of Davis)", 0.0)
    davis_quadratic: float = quantity("N.s2/m2", "Running resistance for each m2/s2 (c of Davis)", 0.0)
    curve_resistance: float = quantity(
        "1", "1: in curves von Roeckl's resistance holds the vehicle back; 0: nothing does", 0.0, 1.0, "integer"
    )


def none() -> RunningResistance:
    """As in chapter 5: no resistance but that of the axle boxes, rolling_resistance_torque."""
    return RunningResistance(0.0, 0.0, 0.0, 0)


def add_resistance(assembly: Assembly, speed: ca.SX, places: Sequence[ca.SX]) -> ca.SX:
    """Force along the track on the whole vehicle [N] and what it takes [W], Davis (1926) and von Roeckl (1880).

    places [m]: distances of the wheelsets, which carry equal shares of the weight.
    """
    p = {name: assembly.system.parameter(none().variable(name)) for name in none().values()}
    ahead = speed / ca.sqrt(speed**2 + assembly.parameter["creepage_speed"] ** 2)
    shares = [curve_share(ca.fabs(curvature)) for curvature in curvatures_at(assembly, places)]
    weight = assembly.total_mass * assembly.parameter["gravity"]
    steady = p["davis_constant"] + p["curve_resistance"] * ca.SX(sum(shares)) / len(shares) * weight
    force = -ahead * (steady + p["davis_quadratic"] * speed**2) - p["davis_linear"] * speed
    return ca.vertcat(force, -force * speed)


def curvatures_at(assembly: Assembly, places: Sequence[ca.SX]) -> list[ca.SX]:
    """Of the line that an instance runs on [1/m], which holds a vehicle back (section 2.4); without one the input."""
    if not assembly.on_line:
        return [assembly.input["curvature"]]
    return [assembly.system.along_line("heading", place, 1)[1] for place in places]


def curve_share(curvature: ca.SX) -> ca.SX:
    """Share of the weight that holds a vehicle back in a curve, von Roeckl (1880); curvature [1/m] >= 0."""
    tight = curvature * RADIUS > 1
    share, place = (ca.if_else(tight, *both) for both in zip(TIGHT, WIDE, strict=True))
    return share * curvature / (1 - place * curvature)

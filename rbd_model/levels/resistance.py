"""Running and curve resistance of a vehicle, for effects whose motion the model does not include.

Running resistance: W. J. Davis (1926), The tractive resistance of electric locomotives and cars, General Electric
Review 29: a + b V + c V^2, at all levels. Curve resistance, at levels point and planar: von Roeckl (1880), as published
in railway handbooks. Its share of the weight is 0.650 / (R - 55 m) on main lines, and 0.500 / (R - 30 m) below R = 300
m. All are zero with the start values.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from fmu_src.symbols import Term, ca
from fmu_src.system import ParameterSet, System, quantity
from rbd_model.track.line_table import along_line
from rbd_model.vehicle.assembly import Assembly

#: Von Roeckl (1880): share of the weight times (R - place) [m], and the place [m]; above and below a radius of 300 m.
WIDE, TIGHT, RADIUS = (0.650, 55.0), (0.500, 30.0), 300.0


@dataclass(frozen=True)
class RunningResistance(ParameterSet):
    """Resistance of the whole vehicle.

    Its constant part is dry friction, which holds the vehicle at rest up to its size.
    """

    davis_constant: float = quantity("N", "Running resistance that does not change with speed (a of Davis)", 0.0, 1e6)
    davis_linear: float = quantity("N.s/m", "Running resistance for each m/s (b of Davis)", 0.0, 1e6)
    davis_quadratic: float = quantity("N.s2/m2", "Running resistance for each m2/s2 (c of Davis)", 0.0)
    curve_resistance: float = quantity(
        "1", "1: in curves von Roeckl's resistance holds the vehicle back; 0: nothing does", 0.0, 1.0, "integer"
    )


def none() -> RunningResistance:
    """Return the set of chapter 5: no resistance except that of the axle boxes, rolling_resistance_torque."""
    return RunningResistance(0.0, 0.0, 0.0, 0)


@dataclass(frozen=True)
class Resistance:
    """The symbols of running resistance, Davis (1926).

    `speed` [m/s] is that of the body on which it acts. `direction` is 1, -1, or 0 while it holds that body. `steady`
    [N] is the part that does not depend on the speed. `growing` [N] is the part that does, with the sign of the speed.
    `possible` is above 0 if the steady part is not zero. `alone` is above 0 if no brake is applied, because a brake
    holds the vehicle too.
    """

    speed: ca.SX
    direction: ca.SX
    steady: ca.SX
    growing: ca.SX
    possible: ca.SX
    alone: ca.SX

    @property
    def moves(self) -> ca.SX:
        """1, or 0 while it holds the body."""
        return self.direction**2

    @property
    def force(self) -> ca.SX:
        """Force along the track on a moving body [N]. While the body is held, its steady part is 0."""
        return -(self.direction * self.steady + self.growing)

    @property
    def power(self) -> ca.SX:
        """Dissipated power [W]."""
        return -self.force * self.speed

    def hold(self, system: System, state: ca.SX, drive: ca.SX) -> None:
        """Let it hold the body whose speed is `state`, as dry friction does.

        drive [N]: all other forces on the body.
        """
        absent = system.derived("no_steady_resistance", self.possible == 0)
        words = "holds the vehicle", "lets the vehicle go"
        system.dry_friction(
            "Running resistance",
            self.direction,
            [state],
            drive,
            self.steady - absent,
            words,
            reported=(self.alone, 1.0),
        )


def add_resistance(assembly: Assembly, speed: ca.SX, places: Sequence[ca.SX]) -> Resistance:
    """Return the resistance of the whole vehicle, Davis (1926) and von Roeckl (1880).

    places [m]: distances of the wheelsets, which carry equal shares of the weight.
    """
    davis = add_davis(assembly, speed)
    on_curves = assembly.system.parameter(none().variable("curve_resistance"))
    shares = [curve_share(ca.fabs(curvature)) for curvature in curvatures_at(assembly, places)]
    weight = assembly.total_mass * assembly.parameter["gravity"]
    steady = davis.steady + on_curves * ca.SX(sum(shares)) / len(shares) * weight
    return replace(davis, steady=steady, possible=davis.possible + on_curves)


def add_davis(assembly: Assembly, speed: ca.SX) -> Resistance:
    """Return the resistance a + b V + c V^2 of the vehicle on straight track, Davis (1926).

    speed [m/s]: of its body.
    """
    names = ("davis_constant", "davis_linear", "davis_quadratic")
    constant, linear, quadratic = (assembly.system.parameter(none().variable(name)) for name in names)
    direction = assembly.system.direction("resisting")
    brakes = ca.SX(sum(assembly.input[f"brake_torque_{number}"] for number, _ in assembly.vehicle.numbered))
    growing = (linear + quadratic * ca.fabs(speed)) * speed
    return Resistance(speed, direction, constant, growing, constant, brakes == 0)


def curvatures_at(assembly: Assembly, places: Sequence[ca.SX]) -> list[ca.SX]:
    """Return the curvatures for the curve resistance [1/m] (section 2.4): of the line, or without a line the input."""
    if not assembly.on_line:
        return [assembly.input["curvature"]]
    return [along_line(assembly.system, "heading", place, 1)[1] for place in places]


def curve_share(curvature: Term) -> Term:
    """Return the resistance in a curve as a share of the weight, von Roeckl (1880); curvature [1/m] >= 0."""
    tight = curvature * RADIUS > 1
    # A sum instead of a choice, which would take longer: this is evaluated after every step.
    share, place = (wide + tight * (narrow - wide) for narrow, wide in zip(TIGHT, WIDE, strict=True))
    return share * curvature / (1 - place * curvature)

"""Friction between shoe and wheel tread. A further law is one more number and one more line in `shoe_friction`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from brake_controller.experiment import EXPERIMENT, FORCE_PER_PRESSURE, SHOES
from fmu_src.piecewise import interpolation
from fmu_src.symbols import ca
from fmu_src.system import System

#: Numbers of the laws, parameter `friction_law`.
CONSTANT, MEASURED_AGAINST_FORCE, CAST_IRON_P6, COMPOSITE, FALLING, TABULATED = range(6)
CAST_IRON_P10, COMPOSITE_BY_FORCE = 6, 7
#: Descriptions of these laws.
LAWS = {
    CONSTANT: "constant",
    MEASURED_AGAINST_FORCE: "measured against shoe force (chapter 7)",
    CAST_IRON_P6: "cast iron P6",
    COMPOSITE: "composite (type K)",
    FALLING: "falling with speed (section 2.5.2)",
    TABULATED: "a table over sliding speed that is compiled into the FMU (FrictionTable)",
    CAST_IRON_P10: "cast iron P10",
    COMPOSITE_BY_FORCE: "composite, over force and speed",
}

#: Force of one shoe [N] and average shoe friction in the three cases of the experiment.
MEASURED_FORCE = [1e3 * kpa * FORCE_PER_PRESSURE / SHOES * case.rigging_efficiency for kpa, case in EXPERIMENT.items()]
MEASURED_FRICTION = [case.shoe_friction for case in EXPERIMENT.values()]

KILOMETRES_PER_HOUR = 3.6
#: Radius of the corner that the sliding speed |w| r has at rest [m/s].
REST_SPEED = 0.01
#: Composite shoes: friction at rest, its fall per km/h, and the speed from which it is constant [km/h].
COMPOSITE_AT_REST, COMPOSITE_FALL, COMPOSITE_UP_TO = 0.3, 0.00081, 200.0


@dataclass(frozen=True)
class FrictionTable:
    """Shoe friction over sliding speed [m/s], linear between the points, constant outside; for law 5."""

    speeds: Sequence[float]
    frictions: Sequence[float]

    def __post_init__(self) -> None:
        if len(self.speeds) != len(self.frictions) or len(self.speeds) < 2:
            raise ValueError(
                f"The table must have at least two speeds and as many frictions; got {len(self.speeds)} and "
                f"{len(self.frictions)}."
            )
        if min(self.speeds) < 0.0 or min(self.frictions) < 0.0:
            raise ValueError(
                f"Speeds and frictions of the table must be at least 0; got {min(*self.speeds, *self.frictions):g}."
            )


def sliding_speed(angular_velocity: ca.SX, wheel_radius: ca.SX) -> ca.SX:
    """Return the speed of the tread below the shoe, r_w |w| [m/s], section 2.5.2.

    It has no corner at rest, where it is too small by at most REST_SPEED.
    """
    return ca.sqrt((wheel_radius * angular_velocity) ** 2 + REST_SPEED**2) - REST_SPEED


def cast_iron_p6(force_of_one_shoe: ca.SX, speed: ca.SX) -> ca.SX:
    """Return friction of cast iron P6; force in N, speed in m/s, the formula itself in kN and km/h.

    mu = 0.60 (1.6 F + 100) / (8 F + 100) (V + 100) / (5 V + 100), Karwatzki (1950), with the rounded constants of the
    train simulator MaSzyna, which calls it P10. The literature has 16 / g and 80 / g instead of 1.6 and 8, with a
    difference below 1 % up to 40 kN. It is the law of P6 in a public train simulation (`vehicle_brake.py: FRICTIONS`);
    that of phosphorous iron `P10` is 14 % above it at 10 kN, and 32 % at 20 kN.
    """
    force, fast = force_of_one_shoe / 1e3, KILOMETRES_PER_HOUR * speed
    return 0.60 * (1.6 * force + 100) / (8 * force + 100) * (fast + 100) / (5 * fast + 100)


@dataclass(frozen=True)
class Fractions:
    """Friction mu = k1 (F + k2) / (F + k3) (V + k4) / (V + k5), F in kN for each shoe, V in km/h.

    most_force: shoe force above which friction is constant [kN].
    """

    k1: float
    k2: float
    k3: float
    k4: float
    k5: float
    most_force: float

    def friction(self, force_of_one_shoe: ca.SX, speed: ca.SX) -> ca.SX:
        """Return the friction, in the form of Karwatzki (1950); force in N, speed in m/s."""
        force, fast = ca.fmin(force_of_one_shoe / 1e3, self.most_force), KILOMETRES_PER_HOUR * speed
        return self.k1 * (force + self.k2) / (force + self.k3) * (fast + self.k4) / (fast + self.k5)


#: Constants of a public train simulation (the program that runs Open Rails trains in Rust). Composite is 0.44 (K + 20)
#: / (4 K + 20) (V + 150) / (2 V + 150), K in tf. The law of pads has a pole at 27.2 kN. Assumed: it is constant from
#: 20 kN on.
P10 = Fractions(0.05, 62.5, 31.25, 100.0, 20.0, 1e3)
COMPOSITE_BLOCKS = Fractions(0.055, 200.0, 50.0, 150.0, 75.0, 1e3)
PADS = Fractions(0.385, -24.5, -27.2, 39.5, 33.0, 20.0)


def composite(speed: ca.SX) -> ca.SX:
    """Return friction of composite shoes of type K: 0.3 - 0.00081 V [km/h], speed in m/s.

    This is a fit of the train simulator MaSzyna, which gives no source of it. Assumed: it is constant from 200 km/h on.
    """
    return COMPOSITE_AT_REST - COMPOSITE_FALL * ca.fmin(KILOMETRES_PER_HOUR * speed, COMPOSITE_UP_TO)


def falling(friction_at_rest: ca.SX, constant: ca.SX, speed: ca.SX) -> ca.SX:
    """Return friction that falls with sliding speed v_s [m/s], Barwell's formula of section 2.5.2: mu_0 exp(-c_f v_s).

    Assumed: the exponential form. The thesis names the constant c_f [s/m], which depends on the material, but its
    formula is given only in Fig. 2.17.
    """
    return friction_at_rest * ca.exp(-constant * speed)


#: Default table of law 5: cast iron P6 at 20 kN, at 0, 10, 50 and 100 km/h.
EXAMPLE_TABLE = FrictionTable([v / KILOMETRES_PER_HOUR for v in (0, 10, 50, 100)], [0.3046, 0.2234, 0.1305, 0.1015])


def shoe_friction(
    system: System, p: Mapping[str, ca.SX], force_of_one_shoe: ca.SX, speed: ca.SX, table: FrictionTable
) -> ca.SX:
    """Return the shoe friction coefficient mu_b; force of one shoe in N, sliding speed in m/s.

    Law 1: linear between the three measured averages (section 7.5). Below and above the measured forces it is constant,
    because no measurements exist there.
    """
    measured = system.table("measured_friction", *interpolation(MEASURED_FORCE, MEASURED_FRICTION), force_of_one_shoe)
    constant = p["constant_shoe_friction"]
    laws = {
        MEASURED_AGAINST_FORCE: measured,
        CAST_IRON_P6: cast_iron_p6(force_of_one_shoe, speed),
        COMPOSITE: composite(speed),
        FALLING: falling(constant, p["falling_friction_constant"], speed),
        TABULATED: system.table("friction_over_speed", *interpolation(table.speeds, table.frictions), speed),
        CAST_IRON_P10: P10.friction(force_of_one_shoe, speed),
        COMPOSITE_BY_FORCE: COMPOSITE_BLOCKS.friction(force_of_one_shoe, speed),
    }
    for law, friction in laws.items():
        constant = ca.if_else(p["friction_law"] == law, friction, constant)
    return constant

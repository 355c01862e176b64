"""Brake force at the rim of a train's vehicle by its cylinder pressure: rigging, shoes, load weighing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import MISSING, dataclass, fields, replace

from brake_controller.air import AMBIENT
from brake_controller.point_table import PointTable, with_default
from brake_controller.rigging import shoe_force
from brake_controller.shoe_friction import (
    CAST_IRON_P6,
    COMPOSITE,
    COMPOSITE_BLOCKS,
    CONSTANT,
    KILOMETRES_PER_HOUR,
    LAWS,
    P10,
    PADS,
    Fractions,
    cast_iron_p6,
    composite,
)
from fmu_src.chain import function_of
from fmu_src.symbols import Term, ca
from fmu_src.system import ParameterSet, choice, quantity

#: Friction as two fractions, of shoe force and of speed, with constants of the vehicle (`fractions`).
FRACTIONS = 8
#: Friction over speed by points (`tabulated`).
TABLE = 9
OVER_SPEED = PointTable("table_friction", "table_speed", "table_change")
_LAWS = {law: LAWS[law] for law in (CONSTANT, CAST_IRON_P6, COMPOSITE)}


@dataclass(frozen=True)
class VehicleBrake(ParameterSet):
    """All shoes or discs of one vehicle."""

    force_per_pressure: float = quantity("N/Pa", "Force of all shoes over the cylinder's pressure, without losses", 0.0)
    counter_force: float = quantity("N", "Force of springs at the shoes that draw them back", 0.0)
    efficiency: float = quantity("1", "Efficiency of the rigging", 0.0, 1.0)
    shoes: float = quantity("1", "Number of shoes", 1.0)
    friction_law: float = choice("Shoe friction", _LAWS | {FRACTIONS: "two fractions", TABLE: "a table over speed"})
    constant_friction: float = quantity("1", "Friction with law 0; of discs, times their radius over the wheel's", 0.0)
    friction_scale: float = with_default("1", "Factor of the fractions, law 8", 0.0, 0.0)
    friction_force_added: float = with_default("N", "Shoe force that law 8 adds above the line", 1.0)
    friction_force_divisor: float = with_default("N", "Shoe force that law 8 adds below the line", 1.0)
    friction_speed_added: float = with_default("m/s", "Speed that law 8 adds above the line", 1.0, 0.0)
    friction_speed_divisor: float = with_default("m/s", "Speed that law 8 adds below the line", 1.0, 1e-3)
    friction_force_limit: float = with_default("N", "Shoe force above which law 8 is constant", 0.0, 0.0)
    table_friction: float = with_default("1", "Friction of law 9 up to its first speed", 0.0, 0.0)
    table_speed_1: float = with_default("m/s", "Speed of point 1 of law 9", 0.0, 0.0)
    table_speed_2: float = with_default("m/s", "Speed of point 2 of law 9", 0.0, 0.0)
    table_speed_3: float = with_default("m/s", "Speed of point 3 of law 9", 0.0, 0.0)
    table_speed_4: float = with_default("m/s", "Speed of point 4 of law 9", 0.0, 0.0)
    table_speed_5: float = with_default("m/s", "Speed of point 5 of law 9", 0.0, 0.0)
    table_speed_6: float = with_default("m/s", "Speed of point 6 of law 9", 0.0, 0.0)
    table_change_1: float = with_default("s/m", "Change of slope at point 1 of law 9", 0.0)
    table_change_2: float = with_default("s/m", "Change of slope at point 2 of law 9", 0.0)
    table_change_3: float = with_default("s/m", "Change of slope at point 3 of law 9", 0.0)
    table_change_4: float = with_default("s/m", "Change of slope at point 4 of law 9", 0.0)
    table_change_5: float = with_default("s/m", "Change of slope at point 5 of law 9", 0.0)
    table_change_6: float = with_default("s/m", "Change of slope at point 6 of law 9", 0.0)


#: Numbers of laws 8 and 9 of a brake with another law.
NO_LAW = {field.name: field.default for field in fields(VehicleBrake) if field.default is not MISSING}


def by_fractions(law: Fractions) -> dict[str, float]:
    """Return the parameters of `VehicleBrake` of a law, in SI units (Karwatzki (1950))."""
    return {
        "friction_law": float(FRACTIONS),
        "friction_scale": law.k1,
        "friction_force_added": 1e3 * law.k2,
        "friction_force_divisor": 1e3 * law.k3,
        "friction_speed_added": law.k4 / KILOMETRES_PER_HOUR,
        "friction_speed_divisor": law.k5 / KILOMETRES_PER_HOUR,
        "friction_force_limit": 1e3 * law.most_force,
    }


#: Laws that depend on shoe force, by the names in consists (`shoe_friction.py`). Cast iron P6 is Karwatzki's formula.
FRICTIONS: Mapping[str, Mapping[str, float]] = {
    "cast-iron-p6": {"friction_law": float(CAST_IRON_P6)},
    "cast-iron-p10": by_fractions(P10),
    "composite": by_fractions(COMPOSITE_BLOCKS),
    "pads": by_fractions(PADS),
}
#: Laws that do not depend on shoe force: 0.3 - 0.00081 V, a constant, `over_speed` and `over_points`, whose numbers a
#: row states.
FORCELESS: Mapping[str, Mapping[str, float]] = {
    "composite-k": {"friction_law": float(COMPOSITE)},
    "constant": {"friction_law": float(CONSTANT)},
    "speed": {"friction_law": float(FRACTIONS)},
    "table": {"friction_law": float(TABLE)},
}


def over_speed(standing: float, fast: float, half_speed: float) -> dict[str, float]:
    """Return the parameters of a friction that changes with speed alone, from `standing` to `fast`.

    mu = fast + (standing - fast) V2 / (V + V2), which is the second fraction of law 8 (Karwatzki (1950)).

    Takes half_speed [m/s].
    """
    return {
        "friction_law": float(FRACTIONS),
        "friction_scale": fast,
        "friction_force_added": 1.0,
        "friction_force_divisor": 1.0,
        "friction_speed_added": half_speed * standing / fast,
        "friction_speed_divisor": half_speed,
        "friction_force_limit": 0.0,
    }


def over_points(speeds: Sequence[float], frictions: Sequence[float]) -> dict[str, float]:
    """Return the parameters of a friction over speed by points, constant before the first and after the last.

    Takes speeds [m/s], frictions [1].
    """
    return {"friction_law": float(TABLE)} | OVER_SPEED.numbers(speeds, frictions)


def points_of(p: Mapping[str, float]) -> tuple[list[float], list[float]]:
    """Return the speeds [m/s] and frictions [1] of parameters by `over_points`."""
    return OVER_SPEED.points(p)


def tabulated(p: Mapping[str, ca.SX], speed: ca.SX) -> ca.SX:
    """Return friction of law 9 over speed [m/s]: straight lines between points, as a sum of hinges.

    Its numbers are the user's, for blocks without a public law, such as LL (EN 16452) or sintered ones.
    """
    return OVER_SPEED.at(p, speed)


def fractions(p: Mapping[str, ca.SX], force_of_one_shoe: ca.SX, speed: ca.SX) -> ca.SX:
    """Return friction of law 8, k1 (F + k2) / (F + k3) (v + k4) / (v + k5); force in N, speed in m/s.

    Karwatzki (1950) has this form for cast iron; other blocks and pads are fitted with other constants.
    """
    force = ca.fmin(force_of_one_shoe, p["friction_force_limit"])
    above = (force + p["friction_force_added"]) * (speed + p["friction_speed_added"])
    below = (force + p["friction_force_divisor"]) * (speed + p["friction_speed_divisor"])
    return p["friction_scale"] * above / below


def law_named(vehicle_brake: VehicleBrake) -> str:
    """Return the name of a brake's law of friction in FRICTIONS or FORCELESS; "speed" if its fractions are its own."""

    def is_law(name: str, law: Mapping[str, float]) -> bool:
        own = {key: value for key, value in law.items() if (name, key) != ("pads", "friction_scale")}
        return replace(vehicle_brake, **own) == vehicle_brake

    return next(name for name, law in {**FRICTIONS, **FORCELESS}.items() if is_law(name, law))


def named(parameters: type[ParameterSet]) -> list[str]:
    """Return the names of a parameter set in the order of C."""
    return list(parameters.__dataclass_fields__)


def brake_force(cylinder: Term, wheel: Term, p: Mapping[str, Term]) -> Term:
    """Return the brake force at the rim [N], eqs (2.4), (2.6) and (2.7).

    Friction is by the laws of `shoe_friction`, or by `fractions`.
    """
    over = ca.fmax(cylinder - AMBIENT, 0)
    pressed = shoe_force(over, p["force_per_pressure"], p["counter_force"], p["efficiency"])
    fast: Term = ca.fabs(wheel)
    one = pressed / p["shoes"]
    friction = ca.if_else(p["friction_law"] == CAST_IRON_P6, cast_iron_p6(one, fast), p["constant_friction"])
    friction = ca.if_else(p["friction_law"] == COMPOSITE, composite(fast), friction)
    friction = ca.if_else(p["friction_law"] == FRACTIONS, fractions(p, one, fast), friction)
    friction = ca.if_else(p["friction_law"] == TABLE, tabulated(p, fast), friction)
    return friction * pressed


def braking() -> ca.Function:
    """Return the function for the brake force at the rim of a vehicle [N], eqs (2.4), (2.6) and (2.7).

    Arguments: cylinder pressure [Pa], speed of the wheels at the rim [m/s], and the brake.
    """
    fields = named(VehicleBrake)
    cylinder, wheel, given = ca.SX.sym("cylinder"), ca.SX.sym("wheel"), ca.SX.sym("given", len(fields))
    p = dict(zip(fields, ca.vertsplit(given), strict=True))
    return function_of("braking", [cylinder, wheel, given], brake_force(cylinder, wheel, p))

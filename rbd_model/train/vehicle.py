"""A vehicle of a train as two masses, its own and that of its wheels at the rim, which roll or slide.

Brakes and resistance are capacities: they oppose any motion, and hold a vehicle that stands (Coulomb's law, as in J. J.
Moreau's time stepping: Unilateral contact and dry friction in finite freedom dynamics (1988)).
"""

from __future__ import annotations

from fmu_src.chain import function_of
from fmu_src.symbols import ca
from fmu_src.variables import Field

#: Standard gravity [m/s2] (ISO 80000-3).
GRAVITY = 9.80665
_SHAPE = "friction or resistance of a vehicle"
#: Constants of a vehicle's motion: mass and rotating mass at the rim; weight on its braked wheels. Remaining share of
#: friction at high speed of sliding, and its fall (Polach (2005)); resistance a + b v + c v^2.
MOTION = (
    Field("mass", "kg", 1e-3, 1e9, "the mass of a vehicle"),
    Field("rotating_mass", "kg", 0.0, 1e10, "the rotating mass or the weight of a vehicle"),
    Field("weight", "N", 0.0, 1e10, "the rotating mass or the weight of a vehicle"),
    Field("friction_ratio", "1", -1e9, 1e9, _SHAPE),
    Field("friction_decay", "s/m", -1e9, 1e9, _SHAPE),
    Field("constant", "N", -1e9, 1e9, _SHAPE),
    Field("linear", "N.s/m", -1e9, 1e9, _SHAPE),
    Field("square", "N.s2/m2", -1e9, 1e9, _SHAPE),
)
#: Forces on a vehicle in a step: of gravity and of motors, capacity of its brake [N], friction of its rail [1],
#: capacity of curve and track brakes to hold its body [N].
ACTING = ("slope", "pull", "brake", "friction", "body")
#: Least force in a denominator [N].
LEAST_FORCE = 1e-9


def _slowed(speed: ca.SX, most: ca.SX) -> ca.SX:
    """Return a speed after dry friction that reduces it by at most `most`."""
    left = ca.fmax(ca.fabs(speed) - most, 0)
    return ca.if_else(speed > 0, left, -left)


def _given() -> tuple[list[ca.SX], dict[str, ca.SX]]:
    sizes = {"acting": len(ACTING), "given": len(MOTION)}
    names = ("speed", "wheel", "ahead", "behind", "acting", "given", "step")
    symbols = [ca.SX.sym(name, sizes.get(name, 1)) for name in names]
    found = dict(zip(names, symbols, strict=True))
    found |= dict(zip(ACTING, ca.vertsplit(found.pop("acting")), strict=True))
    return symbols, found | dict(zip([one.name for one in MOTION], ca.vertsplit(found.pop("given")), strict=True))


def _resistance(p: dict[str, ca.SX]) -> ca.SX:
    """Return the resistance of the body [N]: a + b v + c v^2, W. J. Davis (1926), of curve and track brakes."""
    fast = ca.fabs(p["speed"])
    return p["constant"] + p["body"] + fast * (p["linear"] + fast * p["square"])


def rolling() -> ca.Function:
    """Return the function for a vehicle on rolling wheels: speed after a step, excess force and force on the rail [N].

    (m + m_r) dv = h (F_ahead - F_behind + slope + pull), less the forces of brakes and resistance (Moreau (1988)). The
    rail must transmit pull, brake and m_r dv / h, and can transmit mu N. The excess is the difference; for a sliding
    wheel it is at least 1 N.
    """
    symbols, p = _given()
    whole, resistance, step = p["mass"] + p["rotating_mass"], _resistance(p), p["step"]
    driven = p["speed"] + step / whole * (p["ahead"] - p["behind"] + p["slope"] + p["pull"])
    speed = _slowed(driven, step / whole * (p["brake"] + resistance))
    taken = whole / step * (speed - driven)
    braked = taken * p["brake"] / ca.fmax(p["brake"] + resistance, LEAST_FORCE)
    asked = p["pull"] + braked - p["rotating_mass"] / step * (speed - p["speed"])
    over = ca.fmax(ca.fabs(asked) - p["friction"] * p["weight"], ca.if_else(p["wheel"] == p["speed"], -1, 1))
    return function_of("rolling", symbols, ca.vertcat(speed, over, asked))


def sliding() -> ca.Function:
    """Return the function for a vehicle on sliding wheels: its speed, theirs at the rim after a step, rail force [N].

    m dv = h (F + H), m_r dw = h (pull - H), H = +-mu N against the sliding, mu by Polach (2005). If the speeds of
    wheels and vehicle meet, both continue together with their momentum (Moreau (1988)).
    """
    symbols, p = _given()
    asked = function_of("rolling", symbols, rolling()(*symbols)[2])(*symbols)
    step, apart = p["step"], p["wheel"] - p["speed"]
    sense = ca.if_else(ca.if_else(apart == 0, asked, apart) > 0, 1, -1)
    left = p["friction_ratio"]
    friction = p["friction"] * (left + (1 - left) * ca.exp(-p["friction_decay"] * ca.fabs(apart)))
    gives = sense * friction * p["weight"]
    driven = p["speed"] + step / p["mass"] * (p["ahead"] - p["behind"] + p["slope"] + gives)
    speed = _slowed(driven, step / p["mass"] * _resistance(p))
    turned = p["wheel"] + step / p["rotating_mass"] * (p["pull"] - gives)
    wheel = _slowed(turned, step / p["rotating_mass"] * p["brake"])
    meet = (wheel - speed) * sense <= 0
    both = (p["mass"] * speed + p["rotating_mass"] * wheel) / (p["mass"] + p["rotating_mass"])
    return function_of(
        "sliding", symbols, ca.vertcat(ca.if_else(meet, both, speed), ca.if_else(meet, both, wheel), gives)
    )

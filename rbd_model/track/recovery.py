"""RailAdhesion: friction that recovers with the energy of sliding, as an FMU between a bogie's outputs and its inputs.

Sliding wheels remove contamination from the rail. Friction rises from that of the dirty rail towards that of a cleaned
one. The trailing wheelset reaches the cleaned rail later. It is wheelset 2 forwards and wheelset 1 backwards. The bogie
does not model recovery: its inputs friction_1 and friction_2 come from this model if a case includes it.

The cleaning of the rail between the axles is stored. Beyond them the rail is treated as dirty, even where the bogie has
already been.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from fmu_src.symbols import ca
from fmu_src.system import Model, ParameterSet, System, Variable, model_of, quantity

WORDS = {1: "leading", 2: "trailing"}
DEFAULT_TOLERANCE = 1e-6
#: Speed that keeps the energy per distance finite at rest, and over which the leading wheelset changes [m/s].
SLOWEST = 0.1
#: Number of Legendre polynomials for the cleaning along the wheel base. With eight and the default parameters, the
#: cleaning arrives at the other wheelset within 2 % of the gain at its beginning, and within 0.2 % half a metre later.
MOMENTS = 8
#: Published energies of cleaning scatter by an order of magnitude. The assumed one is in the middle of this range.
SCATTER = 10.0


@dataclass(frozen=True)
class RecoveryParameters(ParameterSet):
    """Parameters of the recovery; all are assumed, because published values scatter by an order of magnitude."""

    degraded_friction: float = quantity("1", "Friction coefficient of the contaminated rail", 0.0, 2.0)
    recovered_friction: float = quantity("1", "Friction coefficient of the cleaned rail", 0.0, 2.0)
    recovery_energy: float = quantity("J/m", "Sliding energy per distance that cleans to 63 %", 1.0)
    recovery_length: float = quantity("m", "Distance over which a wheel's surface follows", 1e-2)
    left_behind: float = quantity("1", "Share of the leading wheelset's cleaning that the trailing one finds", 0.0, 1.0)
    wheel_base: float = quantity("m", "Distance between the two axles, over which it finds it later", 1e-2, 40.0)


def assumed_recovery() -> RecoveryParameters:
    """Return the assumed recovery of a wet, dirty rail, cleaned by some kJ/m. Reported: wheel base (section 5.2)."""
    return RecoveryParameters(
        degraded_friction=0.06,
        recovered_friction=0.15,
        recovery_energy=5e3,
        recovery_length=2.0,
        left_behind=0.7,
        wheel_base=1.675,
    )


def easy_recovery() -> RecoveryParameters:
    """Return an assumed recovery by sliding wheels (section 2.5.2), with the least energy of the scatter."""
    middle = assumed_recovery()
    return replace(middle, recovery_energy=middle.recovery_energy / SCATTER**0.5)


def hard_recovery() -> RecoveryParameters:
    """Return an assumed recovery by sliding wheels (section 2.5.2), with the largest energy of the scatter."""
    middle = assumed_recovery()
    return replace(middle, recovery_energy=middle.recovery_energy * SCATTER**0.5)


def no_recovery() -> RecoveryParameters:
    """Return a rail that stays dirty under any sliding, in contrast to section 2.5.2."""
    dirty = assumed_recovery()
    return replace(dirty, recovered_friction=dirty.degraded_friction)


def rail_between_axles(system: System, speed: ca.SX, cleaned: dict[int, ca.SX], wheel_base: ca.SX) -> dict[int, ca.SX]:
    """Return the cleaning of the rail between the axles, z_t + V z_x = 0, at each wheelset.

    `cleaned`: their own cleaning.

    z is a sum of Legendre polynomials along the wheel base: discontinuous Galerkin, one element, upwind; Cockburn and
    Shu (2001), J. Sci. Comput. 16. The leading wheelset writes at its end. At the other end the value written one wheel
    base ago comes out, up to Pade's approximation of that delay.
    """
    moments = [system.state(f"between_{i}", "1", 0.0, 1.0) for i in range(MOMENTS)]
    ends = {1: ca.SX(sum((-1) ** i * moment for i, moment in enumerate(moments))), 2: ca.SX(sum(moments))}
    backwards = speed < 0
    written, found = (ca.if_else(backwards, values[2], values[1]) for values in (cleaned, {1: ends[2], 2: ends[1]}))
    # Relative to the leading wheelset: backwards, the odd polynomials change their sign.
    signs = [ca.if_else(backwards, -1, 1) if i % 2 else ca.SX(1) for i in range(MOMENTS)]
    for i in range(MOMENTS):
        below = ca.SX(sum(signs[j] * moments[j] for j in range(i - 1, -1, -2)))
        change = (2 * i + 1) * ((-1) ** i * written - found + 2 * below)
        system.derivative(moments[i], signs[i] * ca.fabs(speed) / wheel_base * change)
    return {number: ca.fmin(ca.fmax(end, 0), 1) for number, end in ends.items()}


def rail_adhesion_system(defaults: RecoveryParameters) -> System:
    """Return the system in which e = |F w| / V, the energy per distance, cleans a share 1 - exp(-e / e_0) of the rail.

    The wheel follows this share. In section 2.5.2 the leading wheelset cleans the rail for those that follow. The law
    of cleaning by energy is assumed.
    """
    system = System("RailAdhesion", "Wheel-rail friction that recovers with the energy of sliding")
    speed = system.input(Variable("speed", "input", "m/s", "Speed of the bogie; below 0 wheelset 2 leads"))
    p = {name: system.parameter(defaults.variable(name)) for name in defaults.values()}
    forward = ca.sqrt(speed**2 + SLOWEST**2)
    cleaned: dict[int, ca.SX] = {}
    for number, word in WORDS.items():
        force = system.input(Variable(f"creep_force_{number}", "input", "N", f"Creep force, {word} wheelset"))
        slip = system.input(Variable(f"slip_{number}", "input", "m/s", f"Slip, {word} wheelset"))
        energy = ca.fabs(force * slip) / forward
        share = system.state(f"cleaned_{number}", "1", 0.0, 1.0)
        following = (1 - ca.exp(-energy / p["recovery_energy"]) - share) * ca.fabs(speed) / p["recovery_length"]
        system.derivative(share, following)
        cleaned[number] = share
    ends = rail_between_axles(system, speed, cleaned, p["wheel_base"])
    backwards = ca.fmin(ca.fmax(-speed / SLOWEST, 0), 1)
    trails = {1: backwards, 2: 1 - backwards}
    for number, word in WORDS.items():
        found = 1 - (1 - cleaned[number]) * (1 - p["left_behind"] * trails[number] * ends[number])
        friction = p["degraded_friction"] + (p["recovered_friction"] - p["degraded_friction"]) * found
        text = f"Friction coefficient under the {word} wheelset"
        system.output(Variable(f"friction_{number}", "output", "1", text), friction)
    return system


def rail_adhesion(defaults: RecoveryParameters | None = None) -> Model:
    """Return the recovery of adhesion as an FMU."""
    return model_of(rail_adhesion_system(defaults or assumed_recovery()), DEFAULT_TOLERANCE)

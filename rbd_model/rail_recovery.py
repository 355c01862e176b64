"""RailAdhesion: friction that recovers with the energy of sliding, as an FMU between a bogie's outputs and its inputs.

Sliding wheels burn off what lies on the rail: friction rises from that of the dirty rail towards that of a cleaned
one, and the trailing wheelset finds what the leading one has left. The bogie knows nothing of it; its inputs friction_1
and friction_2 come from here where a scene asks for recovery.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from fmu_src.system import Model, ParameterSet, System, Variable, model_of, quantity

WORDS = {1: "leading", 2: "trailing"}
DEFAULT_TOLERANCE = 1e-6
#: Speed that keeps the energy per distance finite at rest [m/s].
SLOWEST = 0.1


@dataclass(frozen=True)
class RecoveryParameters(ParameterSet):
    """How friction recovers; all assumed, published values scatter by an order of magnitude."""

    degraded_friction: float = quantity("1", "Friction coefficient of the contaminated rail", 0.0)
    recovered_friction: float = quantity("1", "Friction coefficient of the cleaned rail", 0.0)
    recovery_energy: float = quantity("J/m", "Sliding energy per distance that cleans to 63 %", 1.0)
    recovery_length: float = quantity("m", "Distance over which a wheel's surface follows", 1e-2)
    left_behind: float = quantity("1", "Share of the leading wheelset's cleaning that the trailing one finds", 0.0, 1.0)


def assumed_recovery() -> RecoveryParameters:
    """Assumed: a wet, dirty rail, cleaned by some kJ/m."""
    return RecoveryParameters(
        degraded_friction=0.06, recovered_friction=0.15, recovery_energy=5e3, recovery_length=2.0, left_behind=0.7
    )


def rail_adhesion_system(defaults: RecoveryParameters) -> System:
    """Energy of sliding per distance, e = |F w| / V, cleans a share 1 - exp(-e / e_0), which the wheel follows."""
    system = System("RailAdhesion", "Wheel-rail friction that recovers with the energy of sliding")
    speed = system.input(Variable("speed", "input", "m/s", "Speed of the bogie"))
    p = {name: system.parameter(defaults.variable(name)) for name in defaults.values()}
    forward = ca.sqrt(speed**2 + SLOWEST**2)
    cleaned: dict[int, ca.SX] = {}
    for number, word in WORDS.items():
        force = system.input(Variable(f"creep_force_{number}", "input", "N", f"Creep force, {word} wheelset"))
        slip = system.input(Variable(f"slip_{number}", "input", "m/s", f"Slip, {word} wheelset"))
        energy = ca.fabs(force * slip) / forward
        share = system.state(f"cleaned_{number}", "1", 0.0, 1.0)
        following = (1 - ca.exp(-energy / p["recovery_energy"]) - share) * ca.fabs(speed) / p["recovery_length"]
        system.derivative(f"cleaned_{number}", following)
        cleaned[number] = share
    found = {1: cleaned[1], 2: 1 - (1 - cleaned[2]) * (1 - p["left_behind"] * cleaned[1])}
    for number, word in WORDS.items():
        friction = p["degraded_friction"] + (p["recovered_friction"] - p["degraded_friction"]) * found[number]
        text = f"Friction coefficient under the {word} wheelset"
        system.output(Variable(f"friction_{number}", "output", "1", text), friction)
    return system


def rail_adhesion(defaults: RecoveryParameters | None = None) -> Model:
    """The recovery of adhesion as an FMU."""
    return model_of(rail_adhesion_system(defaults or assumed_recovery()), DEFAULT_TOLERANCE)

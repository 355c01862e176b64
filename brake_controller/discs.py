"""Brake discs on an axle: torque from the force on their pads, friction over speed and temperature, heat.

Friction falls linearly with the sliding speed and with the disc's temperature, as in regressions of bench tests: W.
Sawczuk, A.-M. Rilo Canas, D. Ulbrich, J. Kowalczyk (2021), Modeling the average and instantaneous friction coefficient
of a disc brake on the basis of bench tests, Materials 14, 4766. Its coefficients could not be read. The values below
are therefore assumed, except for the mean of 0.35 that UIC 541-3 requires of organic pads (secondary literature).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from brake_controller.cylinder import Rubbing, treads
from brake_controller.shoe_friction import sliding_speed
from fmu_src.symbols import Term, ca
from fmu_src.system import ParameterSet, System, Variable, quantity

NOMINAL_TEMPERATURE = 10.0
#: Design friction of a brake with discs: the mean that UIC 541-3 requires (secondary literature).
MEAN_PAD_FRICTION = 0.35
#: Fields of `BrakeParameters` that only shoes on treads use.
TREADS_ALONE = ("shoes", "wheel_radius", "friction_law", "constant_shoe_friction", "falling_friction_constant")


@dataclass(frozen=True)
class DiscParameters(ParameterSet):
    """All discs of one wheelset, alike and equally warm."""

    friction_radius: float = quantity("m", "Radius at which the pads rub", 1e-3, 2.0)
    pad_friction_at_rest: float = quantity("1", "Friction of the pads at rest on cold discs", 0.0, 2.0)
    pad_friction_over_speed: float = quantity("s/m", "Fall of friction with each m/s of sliding", 0.0)
    pad_friction_over_temperature: float = quantity("1/K", "Fall of friction with each K above the surroundings", 0.0)
    least_pad_friction: float = quantity("1", "Friction below which it does not fall", 0.0, 2.0)
    disc_mass: float = quantity("kg", "Mass of all discs of the wheelset", 1.0)
    disc_heat_capacity: float = quantity("J/(kg.K)", "Specific heat capacity of the discs", 1.0)
    disc_heat_share: float = quantity("1", "Share of the heat of braking that goes into the discs", 0.0, 1.0)
    disc_cooling_at_rest: float = quantity("W/K", "Heat lost for each K above the surroundings, standing", 0.0)
    disc_cooling_over_speed: float = quantity("W.s/(K.m)", "Its growth with each m/s at the friction radius", 0.0)
    initial_disc_temperature: float = quantity("K", "Temperature of the discs at the start", 100.0)
    surroundings_temperature: float = quantity("K", "Temperature of the air around the discs", 100.0)


def axle_discs() -> DiscParameters:
    """Return two ventilated discs of cast iron, 640 mm across.

    All values are assumed, except cast iron's heat capacity.
    """
    return DiscParameters(
        friction_radius=0.247,
        pad_friction_at_rest=0.38,
        pad_friction_over_speed=1e-3,
        pad_friction_over_temperature=1e-4,
        least_pad_friction=0.2,
        disc_mass=200.0,
        disc_heat_capacity=510.0,
        disc_heat_share=0.95,
        disc_cooling_at_rest=20.0,
        disc_cooling_over_speed=8.0,
        initial_disc_temperature=293.15,
        surroundings_temperature=293.15,
    )


def pad_friction(p: Mapping[str, Term], speed: Term, temperature: Term) -> Term:
    """Return mu - a v - b (T - T_0), the form of Sawczuk (2021), limited from below; speed in m/s, temperature in K."""
    warmer = temperature - p["surroundings_temperature"]
    fallen = p["pad_friction_over_speed"] * speed + p["pad_friction_over_temperature"] * warmer
    return ca.fmax(p["pad_friction_at_rest"] - fallen, p["least_pad_friction"])


def discs(defaults: DiscParameters | None = None) -> Rubbing:
    """Return pads on discs: T = mu F r; First law: m c d(theta)/dt = (share) T w - (cooling) (theta - theta_0)."""
    given = defaults or axle_discs()

    def torque(system: System, _: Mapping[str, ca.SX], force: ca.SX, angular_velocity: ca.SX) -> ca.SX:
        p = _parameters(system, given)
        return _rub(system, p, force, angular_velocity)

    return Rubbing(TREADS_ALONE, torque)


def treads_or_discs(
    choice: Variable, number: int, pads: float = 1.0, defaults: DiscParameters | None = None
) -> Rubbing:
    """Return shoes on treads, eq. (2.7); or, if the parameter has this number, pads on discs, as in `discs`.

    pads: their force over that of the shoes.
    """
    given, on_treads = defaults or axle_discs(), treads()

    def torque(system: System, p: Mapping[str, ca.SX], force: ca.SX, angular_velocity: ca.SX) -> ca.SX:
        has_discs = system.parameter(choice) == number
        own = _parameters(system, given)
        shoes = on_treads.torque(system, p, ca.if_else(has_discs, 0, force), angular_velocity)
        return shoes + _rub(system, own, ca.if_else(has_discs, pads * force, 0), angular_velocity)

    return Rubbing((), torque)


def _parameters(system: System, given: DiscParameters) -> dict[str, ca.SX]:
    return {name: system.parameter(given.variable(name)) for name in given.values()}


def _rub(system: System, p: Mapping[str, ca.SX], force: ca.SX, angular_velocity: ca.SX) -> ca.SX:
    """Return the torque of pads on discs under a force [N.m]; adds their temperature and outputs."""
    speed = sliding_speed(angular_velocity, p["friction_radius"])
    temperature = system.state("disc_temperature", "K", p["initial_disc_temperature"], NOMINAL_TEMPERATURE)
    friction = pad_friction(p, speed, temperature)
    cooling = p["disc_cooling_at_rest"] + p["disc_cooling_over_speed"] * speed
    heat = p["disc_heat_share"] * friction * force * speed
    lost = cooling * (temperature - p["surroundings_temperature"])
    system.derivative(temperature, (heat - lost) / (p["disc_mass"] * p["disc_heat_capacity"]))
    system.output(Variable("pad_force", "output", "N", "Normal force of the pads on the discs"), force)
    text = "Friction coefficient between pads and discs"
    system.output(Variable("pad_friction", "output", "1", text), friction)
    system.output(Variable("disc_temperature", "output", "K", "Temperature of the discs"), temperature)
    return friction * force * p["friction_radius"]

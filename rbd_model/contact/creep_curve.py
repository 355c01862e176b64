"""The creep of one elliptical patch as equations of its own, for curves of the creep force over creepage."""

from __future__ import annotations

from dataclasses import dataclass

from fmu_src.symbols import ca
from fmu_src.system import ParameterSet, System, Variable, quantity
from rbd_model.contact.creep.law import CreepLaw
from rbd_model.contact.creep.of_steel import law_of_ratio
from rbd_model.contact.creep_of_wheel import creep_of_wheel
from rbd_model.contact.friction import Surface, constant_friction

#: Creepages of a wheel against its rail by name: unit, description.
CREEPAGES = {
    "creepage_along": ("1", "Longitudinal creepage of the wheel"),
    "creepage_aside": ("1", "Lateral creepage of the wheel, to the left"),
    "creepage_spin": ("1/m", "Spin creepage of the wheel"),
}


@dataclass(frozen=True)
class PatchParameters(ParameterSet):
    """A wheel on the head of a rail: that of the bogie of chapter 5, with 100 kN."""

    normal_force: float = quantity("N", "Normal force", 1.0, 1e7)
    friction: float = quantity("1", "Friction coefficient without sliding", 0.0, 2.0)
    speed: float = quantity("m/s", "Forward speed, for friction that falls with sliding", 0.1, 150.0)
    wheel_radius: float = quantity("m", "Rolling radius of the wheel, a cone", 0.05, 2.0)
    rail_head_radius: float = quantity("m", "Radius of the rail's head", 0.01, 10.0)
    shear_modulus: float = quantity("Pa", "Shear modulus of wheel and rail", 1e9, 1e12)


def usual_patch() -> PatchParameters:
    """Return the patch of a wheel with 100 kN on a new rail; friction as in chapter 5 (3.97)."""
    return PatchParameters(100e3, 0.3, 20.0, 0.46, 0.3, 82e9)


def creeping_patch(law: CreepLaw, poisson_ratio: float, over: str) -> System:
    """Return equations for the forces of a creep law, (3.82)-(3.105), while one creepage grows; friction may fall.

    The creepage `over` grows from 0 to its value within 1 s; the other two are constant.
    """
    system = System("CreepingPatch", "Creep forces of one contact patch")
    share = system.state("share", "1", 0.0, 1.0)
    system.derivative(share, ca.SX(1.0))
    largest = {name: system.parameter(Variable(name, "parameter", *words)) for name, words in CREEPAGES.items()}
    creepages = [share * one if name == over else one for name, one in largest.items()]
    sets = usual_patch(), constant_friction()
    p = {name: system.parameter(one.variable(name)) for one in sets for name in one.values()}
    ratio, decay, adhesion, slip = (p[name] for name in constant_friction().values())
    surface = Surface(ratio, decay, 1 - ratio, adhesion, slip)
    curvatures = 1 / (2 * p["wheel_radius"]), 1 / (2 * p["rail_head_radius"])
    slides = creepages[0] * p["speed"], creepages[1] * p["speed"], creepages[2] * p["speed"]
    given = ca.vertcat(*slides, 1 / p["speed"], *curvatures, p["normal_force"], p["friction"])
    part = creep_of_wheel(law_of_ratio(law, poisson_ratio), "wheel")
    along, aside, _ = ca.vertsplit(system.call(part, given, ca.vertcat(p["shear_modulus"], surface.symbols)))
    size = ca.sqrt(along**2 + aside**2) / p["normal_force"]
    now = creepages[list(CREEPAGES).index(over)]
    system.output(Variable("creepage", "output", CREEPAGES[over][0], "The creepage that grows"), now)
    system.output(Variable("creep_force_along", "output", "N", "Longitudinal creep force on the wheel"), along)
    system.output(Variable("creep_force_aside", "output", "N", "Lateral creep force on the wheel"), aside)
    system.output(Variable("adhesion", "output", "1", "Size of the creep force over the normal force"), size)
    return system

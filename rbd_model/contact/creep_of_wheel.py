"""Creep of one patch in 3D: its ellipse, its friction and the chosen creep law."""

from __future__ import annotations

from functools import lru_cache

from fmu_src.chain import Chain, Part
from fmu_src.symbols import ca
from rbd_model.contact.creep.kalker import smooth_kalker_coefficients
from rbd_model.contact.creep.law import SMALLEST_FRICTION, SMALLEST_LOAD, ContactPatch, CreepLaw, at_least
from rbd_model.contact.friction import Surface
from rbd_model.contact.hertz import moving_ellipse

#: Smallest sliding speed that is distinguished from 0 [m/s]. The falling friction is smooth through zero on this scale.
SLIDING_FLOOR = 1e-9


def how_it_slides(
    sliding: ca.SX, own_rate: ca.SX, directions: tuple[ca.SX, ca.SX, ca.SX], forward: ca.SX, creepage_speed: ca.SX
) -> ca.SX:
    """Return speeds along and across [m/s], spin [rad/s] and 1 / speed [s/m], for creepages (3.89)-(3.91), (2.3).

    sliding [m/s], own_rate [rad/s]: of the wheel at the contact; directions: along the rail, sideways, normal. Kalker's
    law is for axes that point ahead. For backward rolling these are turned by 180 degrees about the normal. The force
    of spin turns with them, while that of sliding opposes the sliding in both cases. The change between both is spread
    over v_eps: with a jump at rest there would be no solution.
    """
    along, sideways, normal = directions
    slides = ca.dot(sliding, along), ca.dot(sliding, sideways)
    slowness = 1 / ca.sqrt(forward**2 + creepage_speed**2)
    ahead = ca.fmax(ca.fmin(forward / creepage_speed, 1), -1)
    return ca.vertcat(*slides, ahead * ca.dot(own_rate, normal), slowness)


@lru_cache
def creep_of_wheel(creep_law: CreepLaw, place: str) -> Part:
    """Return the part for creep forces of one patch [N] and the remaining friction, (3.82)-(3.105) and `Surface`.

    Arguments: sliding along and across [m/s], spin [rad/s], 1 / speed [s/m], both curvatures [1/m], normal force [N]
    and friction without sliding. Constants: shear modulus [Pa] and surface. place: a word for the part's name, because
    each law in a system is a part of its own.
    """
    given, constants = ca.SX.sym("given", 8), ca.SX.sym("constants", 6)
    slide_x, slide_y, spin, slowness, along_rail, across_rail, normal_force, friction = ca.vertsplit(given)
    modulus, *law = ca.vertsplit(constants)
    surface = Surface(*law)
    load = at_least(normal_force, SMALLEST_LOAD)
    sliding_speed = ca.sqrt(slide_x**2 + slide_y**2 + SLIDING_FLOOR**2)

    def friction_at(speed: ca.SX) -> ca.SX:
        return at_least(friction * surface.remaining(speed), SMALLEST_FRICTION)

    left = friction_at(sliding_speed)
    logarithm, semi_axis = moving_ellipse(along_rail, across_rail, load, modulus)
    stretch = ca.exp(logarithm / 2)
    creepages = (slide_x * slowness, slide_y * slowness, spin * slowness)
    axes, kalker = (semi_axis * stretch, semi_axis / stretch), smooth_kalker_coefficients(logarithm)
    chain = Chain()
    surroundings = surface.reduction, friction_at, 1 / slowness, chain
    forces = creep_law(ContactPatch(creepages, load, left, axes, modulus, kalker, *surroundings))
    return Part(f"creep_{place}", given, constants, ca.vertcat(*forces, left), chain)

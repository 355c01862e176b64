"""A traction curve: the creep law of the stated theory on one contact ellipse."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

from fmu_src.symbols import ca
from rbd_model.contact.creep.exact import HalfSpace, exact, half_space
from rbd_model.contact.creep.fastsim import fastsim
from rbd_model.contact.creep.kalker import kalker_coefficients
from rbd_model.contact.creep.law import CLEAN, ContactPatch, CreepLaw, Reduction
from rbd_model.contact.creep.modified_fastsim import SlopeReduction, modified_fastsim
from rbd_model.contact.creep.polach_2005 import polach_2005

#: Cells of FASTSIM, of modified FASTSIM, and of the exact theory along and across.
FASTSIM, MODIFIED, EXACT = 20, 10, (11, 18)
#: Published factors of modified FASTSIM, and those of Polach's law of 2005 for an elastic layer, fitted to every second
#: point (tests/rbd_model/test_creep_laws.py).
SLOPES, LAYER = SlopeReduction(0.54, 0.02, 0.62), Reduction(0.252, 0.279)


def answer(inputs: Mapping[str, Any]) -> dict[str, float]:
    """Return the longitudinal force over load [1]; none for a theory that is not here."""
    theory = inputs["theory"]
    if theory == "exact" and inputs["layer"] == 0.0 and inputs["friction.drop"] == 0.0:
        return {"traction": of_exact_theory(inputs)}
    if theory == "exact" and inputs["layer"] > 0.0:
        return {"traction": of_law(polach_2005, inputs, LAYER)}
    laws: dict[str, CreepLaw] = {"FASTSIM": fastsim(FASTSIM), "modified FASTSIM": modified_fastsim(MODIFIED, SLOPES)}
    return {"traction": of_law(laws[theory], inputs, CLEAN)} if theory in laws else {}


def semi_axes(inputs: Mapping[str, Any]) -> tuple[float, float]:
    """Return the semi-axes [m] along and across of a wheel on a rail by Hertz, Johnson (1985), section 4.2."""
    ratio = inputs["axis_ratio"]
    square = 1 - ratio**2
    shape = (ellipe(square) / ratio**2 - ellipk(square)) / (ellipk(square) - ellipe(square))
    along = 1 / (2 * inputs["radius"])
    across = brentq(lambda b: along / b - shape, 1e-3, 10.0)
    nu, modulus = inputs["poisson_ratio"], inputs["shear_modulus"]
    cube = 1.5 * ratio * inputs["load"] * (1 - nu) * ellipe(square) / (math.pi * modulus * (along + across))
    return cube ** (1 / 3), cube ** (1 / 3) / ratio


@lru_cache
def space_of(ratio: float, nu: float) -> HalfSpace:
    """Return the cells of an ellipse by its ratio of axes a/b [1] and Poisson's ratio."""
    return half_space(ratio, EXACT, nu)


def of_exact_theory(inputs: Mapping[str, Any]) -> float:
    """Return the traction by Kalker (1990), at the scaled creepage G a b creepage / (mu N)."""
    a, b = semi_axes(inputs)
    friction = inputs["friction.kinetic"]
    scaled = inputs["shear_modulus"] * a * b * inputs["creepage"] / (friction * inputs["load"])
    space = space_of(inputs["axis_ratio"], inputs["poisson_ratio"])
    return -friction * float(exact(space, np.array([scaled, 0.0, 0.0])).forces[0])


def of_law(law: CreepLaw, inputs: Mapping[str, Any], reduction: Reduction) -> float:
    """Return the traction of a creep law."""
    a, b = semi_axes(inputs)
    friction = falling(inputs)
    kalker = kalker_coefficients(ca.SX(inputs["axis_ratio"]), inputs["poisson_ratio"])
    creepages = (ca.SX(inputs["creepage"]), ca.SX(0), ca.SX(0))
    load, axes, modulus = ca.SX(inputs["load"]), (ca.SX(a), ca.SX(b)), ca.SX(inputs["shear_modulus"])
    mu = friction(ca.SX(0))
    patch = ContactPatch(creepages, load, mu, axes, modulus, kalker, reduction, friction, inputs["speed"])
    return -float(ca.evalf(law(patch)[0])) / float(inputs["load"])


def falling(inputs: Mapping[str, Any]) -> Callable[[ca.SX], ca.SX]:
    """Return the friction by sliding speed [m/s], kinetic + drop 2^(-w / half_speed): Polach (2005)."""
    kinetic, drop, half = (inputs[f"friction.{name}"] for name in ("kinetic", "drop", "half_speed"))
    return lambda speed: kinetic + drop * ca.exp(-math.log(2) / half * speed)

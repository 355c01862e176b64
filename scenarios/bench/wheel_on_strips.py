"""One wheel by strips, the contact model 3 of the level `spatial`: compiled alone, and evaluated at given positions."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.optimize import brentq

from fmu_src.compile import build_library
from fmu_src.kernel import Kernel, Library
from fmu_src.symbols import ca
from fmu_src.system import System, Variable, model_of
from rbd_model.body.kinematics import direction_cosines, turned_by
from rbd_model.contact.distance import LEFT, Stand, touching
from rbd_model.contact.geometry import Pair
from rbd_model.contact.normal import Steel
from rbd_model.contact.strips import WheelVelocity
from rbd_model.contact.strips_in_c import ARGUMENTS, OF_SEGMENT, segments_of, wheel_on_strips

#: Constant friction of every contact model here as a `Surface`, and a creepage speed that has no effect at metres a
#: second [m/s].
CONSTANT_FRICTION, NO_SPEED = (1.0, 0.0, 0.0, 1.0, 1.0), 1e-6
#: An approach at which any contact carries more than the required load [m], and its resolution [m].
MOST_APPROACH, FOUND = 0.5e-3, 1e-13


@lru_cache
def library_of_wheel(pair: Pair, steel: Steel, gauge_face: float = 1.0) -> Library:
    """Return a left wheel of the pair; its inputs and outputs are numbered as the part's arguments and results.

    gauge_face: factor on the friction of the rail's gauge face.
    """
    system, part = (
        System("WheelOnStrips", "one wheel on its rail, by strips"),
        wheel_on_strips(pair.left, steel.poisson_ratio),
    )
    given = [system.input(Variable(f"given_{i}", "input", "1", f"Argument {i}")) for i in range(ARGUMENTS)]
    geometry = (LEFT, pair.radius, pair.wheel_half_distance, pair.rail_half_distance)
    without_slip = CONSTANT_FRICTION[:-1]
    fixed = (*geometry, NO_SPEED, steel.shear_modulus, *without_slip, 0.0, gauge_face, steel.poisson_ratio, 0.0)
    results = system.call(part, ca.vertcat(*given), ca.SX(fixed))
    for i, result in enumerate(ca.vertsplit(results)):
        system.output(Variable(f"found_{i}", "output", "1", f"Result {i}"), result)
    none = system.state("none", "1", 0.0, 1.0)  # a kernel has at least one state
    system.derivative(none, -none)
    return Library(build_library(model_of(system, 1e-6)))


@dataclass(frozen=True)
class PressedWheel:
    """Forces of the rail on the wheel, ahead, outwards and up [N], for each segment from the flange outwards; place on
    the rail [m], contact angle [rad], largest pressure [Pa].
    """

    forces: np.ndarray
    place: float
    angle: float
    pressure: float

    @property
    def force(self) -> np.ndarray:
        """Return the sum of all segments [N]."""
        return np.asarray(np.sum(self.forces, axis=0))


def press_wheel(
    pair: Pair, steel: Steel, friction: float, stand: Stand, motion: WheelVelocity, gauge_face: float = 1.0
) -> PressedWheel:
    """Return the wheel at its stand, in motion."""
    kernel = Kernel(library_of_wheel(pair, steel, gauge_face))
    axes = np.array(ca.evalf(turned_by(direction_cosines(ca.SX(stand.yaw), ca.SX(stand.roll)))))
    own = axes.T @ np.array(motion.rotation)
    place = (stand.lateral, stand.height, stand.yaw, stand.roll)
    given = (*motion.velocity, *own, *place, 0.0, 0.0, friction)
    kernel.set(**{f"given_{i}": float(value) for i, value in enumerate(given)})
    kernel.initialise()
    count = OF_SEGMENT * len(segments_of(pair.left))
    found = np.array([kernel[f"found_{i}"] for i in range(count + 3)])
    return PressedWheel(found[:count].reshape(-1, OF_SEGMENT)[:, :3], *found[count:].tolist())


def wheel_under_load(
    pair: Pair, steel: Steel, friction: float, stand: Stand, motion: WheelVelocity, load: float
) -> PressedWheel:
    """Return the wheel at the height at which the vertical force on it is the load.

    Takes load [N].
    """
    top, _ = touching(pair, stand)

    def at(approach: float) -> PressedWheel:
        lower = Stand(stand.lateral, top - approach, stand.roll, stand.yaw)
        return press_wheel(pair, steel, friction, lower, motion)

    return at(float(brentq(lambda approach: at(approach).force[2] - load, 0.0, MOST_APPROACH, xtol=FOUND)))

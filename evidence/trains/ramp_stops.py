"""What a table of stopping distances says by itself: a deceleration, a dead time, a ramp, and a margin.

The brake grows linearly from the dead time on. Its deceleration falls linearly with speed, as friction of composite
blocks does; the margin is a factor on the distance. No train is simulated.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from evidence.trains.brake_switches import Told, rms
from evidence.trains.point_train import SPEEDS, Numbers, PointTrain
from products.train.consist import ROTATING
from products.train.running_resistance import formula_of
from rbd_model.train.vehicle import GRAVITY

#: Step of a stop [s], and longest time in which a brake grows [s].
STEP, LONGEST_RAMP = 0.5, 150.0
#: Resistance of 1 kg of a loaded wagon of 80 t: a, b, c [N, N.s/m, N.s2/m2].
_A, _B, _C = formula_of("wagon").of(80e3)
RESISTANCE = (_A / 80e3, _B / 80e3, _C / 80e3)


@dataclass(frozen=True)
class RampStop:
    """Deceleration at standstill [m/s2], dead time [s], ramp [s], margin [1], and fall with speed [s/m]."""

    deceleration: float
    dead_time: float
    ramp: float = 0.0
    margin: float = 1.0
    fall: float = 0.0

    def distances(self, speeds: Numbers, gradients: Numbers) -> Numbers:
        """Return stopping distances [m]; speeds [m/s], gradients rising above 0 [1]."""
        time = np.arange(0.0, LONGEST_RAMP + STEP, STEP)
        share = np.clip((time - self.dead_time) / max(self.ramp, STEP), 0.0, 1.0)
        turning = 1.0 + ROTATING
        force = turning * self.deceleration * np.outer(share, np.maximum(1.0 - self.fall * SPEEDS, 0.05))
        train = PointTrain(force, turning, GRAVITY, RESISTANCE, 0.0, STEP)
        return self.margin * train.distances(speeds, gradients)


#: What is fitted, by name: start values of a `RampStop`; other values keep their defaults.
MODELS = {
    "a deceleration and a dead time": {"deceleration": 0.45, "dead_time": 8.0},
    "and a ramp": {"deceleration": 0.45, "dead_time": 2.0, "ramp": 25.0},
    "and a margin": {"deceleration": 0.5, "dead_time": 2.0, "ramp": 25.0, "margin": 1.1},
    "and a fall with speed": {"deceleration": 0.6, "dead_time": 2.0, "ramp": 30.0, "margin": 1.1, "fall": 0.008},
}
_LIMITS = {"deceleration": (0.2, 2.0), "dead_time": (0.0, 40.0), "ramp": (0.5, 120.0)}
_LIMITS |= {"margin": (0.8, 1.5), "fall": (-0.005, 0.02)}


def fitted(table: Told, model: str, places: np.ndarray | None = None) -> tuple[RampStop, float]:
    """Return the best stop of a model for some points of a table, and its root mean square error [1]."""
    chosen = table.few() if places is None else places
    speed, gradient, due = table.speed[chosen], table.gradient[chosen], table.distance[chosen]
    start = MODELS[model]
    names, scale = list(start), np.array(list(start.values()))

    def misses(x: Numbers) -> Numbers:
        found = RampStop(**dict(zip(names, x * scale, strict=True))).distances(speed, gradient)
        return np.asarray(np.log(np.where(np.isfinite(found), found, 1e4) / due))

    low, high = np.array([_LIMITS[name] for name in names]).T / scale
    best = least_squares(misses, np.ones(len(names)), bounds=(low, high), diff_step=0.02, max_nfev=40)
    stop = RampStop(**dict(zip(names, (best.x * scale).tolist(), strict=True)))
    return stop, rms(np.expm1(best.fun))

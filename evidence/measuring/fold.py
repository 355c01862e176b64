"""The approach to the fold at which a tread contact is lost, in the derailment of chapter 9."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import curve_fit

from evidence.measuring.runs import layout_of
from evidence.measuring.scenes import ASYMMETRIC, Scene, asymmetric
from fmu_src.kernel import Kernel, SimulationError
from rbd_model.vehicle.parameters import AS_PRINTED
from rbd_model.wheelset.rigid import FOLD_MARGIN

#: 75 % error of the shoes on the leading wheelset, in the thesis's interpretation: with a flange pushed at the rail the
#: wheelset stays on.
DERAILING = replace(ASYMMETRIC, name="derailment", inputs=asymmetric(75), values={**ASYMMETRIC.values, **AS_PRINTED})
TOLERANCE = 1e-8
#: Times before the end of the run at which the contact is evaluated [s].
TIMES_LEFT = np.geomspace(1e-4, 1e-6, 13)


@dataclass(frozen=True)
class Approach:
    """Remaining curvature of the contact (0 at the fold) over the time left to the fold [s], and a power law through
    it.
    """

    time_left: np.ndarray
    curvature: np.ndarray
    exponent: float
    fitted: np.ndarray


def derail(scene: Scene, kernel: Kernel) -> float:
    """Run a case until it derails.

    Returns [s].
    """
    for start, end in scene.segments():
        scene.set_inputs(kernel, start, end)
        try:
            kernel.step(start, end - start)
        except SimulationError:
            break
    if not kernel.ended:
        raise SimulationError(f"{scene.name} did not derail within {scene.duration:g} s", 3)
    return kernel.time


def approach() -> Approach:
    """Return the remaining curvature before the end of the run, at FOLD_MARGIN; fold and exponent are fitted.

    At a fold two solutions meet, and the distance to it is proportional to the square root of the parameter's distance.
    """
    end = derail(DERAILING, DERAILING.kernel(tolerance=TOLERANCE))
    kernel, times, curvatures = DERAILING.kernel(tolerance=TOLERANCE), [], []
    differential = layout_of(DERAILING).differential
    for begin, finish in DERAILING.segments():
        DERAILING.set_inputs(kernel, begin, finish)
        if finish < end:
            kernel.step(begin, finish - begin)
            continue
        for time in end - TIMES_LEFT:
            kernel.step(kernel.time, time - kernel.time)
            place = np.array(kernel.linearise().state)[differential]
            times.append(time)
            curvatures.append(kernel.margin_at(kernel.time, place.tolist()) + FOLD_MARGIN)
        break
    left, curvature = end - np.array(times), np.array(curvatures)

    def law(time_left: np.ndarray, factor: float, exponent: float, beyond: float) -> np.ndarray:
        return np.log(factor * (time_left + np.abs(beyond)) ** exponent)

    guess = (curvature[0] / left[0] ** 0.5, 0.5, left[-1])
    (factor, exponent, beyond), _ = curve_fit(law, left, np.log(curvature), guess)
    to_fold = left + abs(beyond)
    return Approach(to_fold, curvature, float(exponent), factor * to_fold**exponent)

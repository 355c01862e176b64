"""Times of the service brake, with and without feedback of its pressure: SUBSET-026, 3.13.9.3.3 and A.3.10."""

from __future__ import annotations

import numpy as np

from products.supervision.train import SupervisedTrain

#: Falls of the brake pipe's pressure at which the brake begins, at which times are locked, and of a full service brake
#: [Pa], A.3.10.4; locked times of SBI1 and SBI2 [s].
BEGINS, LOCKS, FULL = 30e3, 60e3, 150e3
LOCKED_1, LOCKED_2 = 0.0, 2.0


def service_times(
    T_bs: np.ndarray, train: SupervisedTrain, pipe_fall: np.ndarray, permitted: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Return T_bs1 and T_bs2: times from both service brake interventions to SBD and to EBI.

    Takes T_bs [s], pipe_fall [Pa]; returns T_bs1, T_bs2 [s].
    """
    if not train.service_command:
        return np.zeros_like(T_bs), np.zeros_like(T_bs)
    if not (train.service_feedback and permitted):
        return T_bs, T_bs
    reduced = np.where(pipe_fall < BEGINS, T_bs, T_bs * (FULL - pipe_fall) / FULL)
    first = np.where(pipe_fall < LOCKS, reduced, LOCKED_1)
    return first, np.maximum(np.where(pipe_fall < LOCKS, reduced, LOCKED_2), LOCKED_2)

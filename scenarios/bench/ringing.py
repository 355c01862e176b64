"""Decay and frequency of the oscillations in an equally spaced signal, by linear prediction."""

import numpy as np


def modes_in(signal: np.ndarray, interval: float, order: int) -> np.ndarray:
    """Return the complex eigenvalues in a signal without noise [1/s], frequencies from low to high; Prony (1795).

    interval [s]: between two values, less than half of the shortest period. order: number of eigenvalues, those with
    negative frequencies and real ones included.
    """
    rows = np.lib.stride_tricks.sliding_window_view(signal[:-1], order)
    weights = np.linalg.lstsq(rows, signal[order:], rcond=1e-13)[0]
    found = np.log(np.roots([1.0, *-weights[::-1]]).astype(complex)) / interval
    return np.array(sorted(found[found.imag > 0.0], key=lambda one: float(one.imag)))

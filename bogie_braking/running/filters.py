"""Filters of running behaviour: low-pass, sliding mean over a distance, frequency weighting."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fmu_src.cosimulation.recording import Recording

#: Longest interval of the rows [s]: ten rows in a period of 20 Hz, the cut-off frequency of the forces.
LONGEST_INTERVAL = 5e-3
#: Relative difference of two intervals that is due to rounding, as in a file of ten digits.
EVEN = 1e-4
#: Order of the low-pass: 24 dB an octave.
ORDER = 4


def interval_of(recording: Recording) -> float:
    """Return the interval of the rows [s]. Raises ValueError if it is uneven or too long."""
    time = recording["time"]
    if time.size < 2:
        raise ValueError(f"The recording must have at least 2 rows; got {time.size}. Run longer.")
    steps = np.diff(time)
    interval = float((time[-1] - time[0]) / steps.size)
    if not np.all(np.abs(steps - interval) <= EVEN * interval):
        raise ValueError(
            f"The rows must be evenly spaced in time; got intervals from {steps.min():g} to {steps.max():g} s. Record "
            "at one interval."
        )
    if interval > LONGEST_INTERVAL * (1 + EVEN):
        raise ValueError(
            f"The interval of the rows must be at most {LONGEST_INTERVAL:g} s; got {interval:g} s. Record with "
            f"interval={LONGEST_INTERVAL:g}."
        )
    return interval


def finite(recording: Recording, name: str) -> np.ndarray:
    """Return a column without NaN, shape (rows,). Raises KeyError, ValueError."""
    values = recording[name]
    if not np.all(np.isfinite(values)):
        row = int(np.flatnonzero(~np.isfinite(values))[0])
        raise ValueError(f"{name} must have a number in each row; got {values[row]} in row {row}. Leave it out.")
    return values


def low_pass(values: np.ndarray, interval: float, cut_off: float) -> np.ndarray:
    """Return values after a Butterworth low-pass of 24 dB an octave that was at rest at the first value.

    Takes values (rows,), interval [s], cut_off [Hz].
    """
    from scipy.signal import butter, sosfilt, sosfilt_zi  # heavy

    sections = butter(ORDER, cut_off, fs=1 / interval, output="sos")
    return np.asarray(sosfilt(sections, values, zi=sosfilt_zi(sections) * values[0])[0])


def band_pass(values: np.ndarray, interval: float, band: tuple[float, float]) -> np.ndarray:
    """Return values after a Butterworth band-pass of 24 dB an octave that was at rest at the first value.

    Takes values (rows,), interval [s], band [Hz].
    """
    from scipy.signal import butter, sosfilt  # heavy

    sections = butter(ORDER, band, "bandpass", fs=1 / interval, output="sos")
    return np.asarray(sosfilt(sections, values - values[0]))


def sliding_mean(values: np.ndarray, distance: np.ndarray, window: float, places: np.ndarray) -> np.ndarray:
    """Return the mean of values over a window around places; between rows they are linear.

    Takes values (rows,), distance [m] (rows,) increasing, window [m], places [m] (n,). Returns (n,).
    """
    parts = (values[1:] + values[:-1]) / 2 * np.diff(distance)
    whole = np.concatenate([[0.0], np.cumsum(parts)])
    slopes = np.diff(values) / np.diff(distance)

    def integral(to: np.ndarray) -> np.ndarray:
        row = np.clip(np.searchsorted(distance, to, side="right") - 1, 0, distance.size - 2)
        rest = to - distance[row]
        return np.asarray(whole[row] + (values[row] + slopes[row] * rest / 2) * rest)

    return (integral(places + window / 2) - integral(places - window / 2)) / window


def weighted(values: np.ndarray, interval: float, response: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """Return values after a filter given by its frequency response, exact up to half of the sampling frequency.

    The values are followed by as many zeros, so that their end does not reach their begin. `response`: function of
    frequencies [Hz], complex.

    Takes values (rows,), interval [s].
    """
    count = 2 * values.size
    frequencies = np.fft.rfftfreq(count, interval)
    return np.fft.irfft(np.fft.rfft(values, count) * response(frequencies), count)[: values.size]

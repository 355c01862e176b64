"""Ride comfort at a point: mean comfort of EN 12299 and Sperling's index."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from bogie_braking.running.filters import finite, interval_of, weighted
from fmu_src.cosimulation.recording import Recording

#: Windows of EN 12299: their length [s], their number in a test of five minutes, and the percentile of their values.
WINDOW, WINDOWS, PERCENTILE = 5.0, 60, 95.0
#: Factor of the mean comfort.
COMFORT = 6.0


@dataclass(frozen=True)
class Weighting:
    """Frequency weighting of EN 12299, as secondary sources print it: frequencies [Hz], resonances and gain.

    A band from `low` to `high`, a transition from acceleration to velocity at `turn`, and a step from `rises` to
    `levels` (none: 0).
    """

    turn: float
    turn_resonance: float
    rises: float = 0.0
    levels: float = 0.0
    step_resonance: float = 1.0
    gain: float = 1.0
    low: float = 0.4
    high: float = 100.0

    def response(self, frequency: np.ndarray) -> np.ndarray:
        """Return the complex frequency response; frequency [Hz]."""
        band = math.sqrt(0.5)
        high_pass = (1j * frequency / self.low) ** 2 / _second(frequency, self.low, band)
        low_pass = 1 / _second(frequency, self.high, band)
        turns = (1 + 1j * frequency / self.turn) / _second(frequency, self.turn, self.turn_resonance)
        step = np.ones_like(turns)
        if self.rises:
            step = _second(frequency, self.rises, self.step_resonance) / _second(
                frequency, self.levels, self.step_resonance
            )
        return np.asarray(self.gain * high_pass * low_pass * turns * step)


def _second(frequency: np.ndarray, own: float, resonance: float) -> np.ndarray:
    """Return 1 + s / (Q w) + (s / w)^2 at s = i 2 pi f."""
    share = frequency / own
    return np.asarray(1 - share**2 + 1j * share / resonance)


#: Weightings of vertical (Wb) and of longitudinal and lateral accelerations (Wd) on the floor, EN 12299:2009, annex C.
#: The text of the standard was not at hand; the numbers agree in two programs that implement it.
WB = Weighting(16.0, 0.63, 2.5, 4.0, 0.8, gain=0.4)
WD = Weighting(2.0, 0.63)
WEIGHTINGS = {"x": WD, "y": WD, "z": WB}

#: Factors of Sperling's weighting, vertical and lateral, and of the index of a weighted r.m.s. acceleration in m/s2.
VERTICAL, LATERAL, SPERLING, EXPONENT = 0.588, 0.737, 100.0 * math.sqrt(2.0), 0.3


def mean_comfort(accelerations: Recording) -> Recording:
    """Return the mean comfort N_MV of EN 12299 (standard method) and the percentiles in it.

    N_MV = 6 (a_x95^2 + a_y95^2 + a_z95^2)^(1/2). Each is the 95th percentile of weighted r.m.s. values of 5 s.

    Parameters
    ----------
    accelerations : Recording
        `time`, `acceleration_x`, `acceleration_y`, `acceleration_z` [m/s2] on the floor, every 5 ms or more often, as
        from `floor_accelerations`. They last at least 5 s; in a test five minutes.

    Returns
    -------
    Recording
        One row: `windows`, `mean_comfort`, `acceleration_x_95`, `acceleration_y_95`, `acceleration_z_95` [m/s2]. A
        message states if these are fewer windows than in a test.

    Raises
    ------
    KeyError
        If a column is missing.
    ValueError
        If rows are uneven, more than 5 ms apart, or last less than 5 s.
    """
    interval = interval_of(accelerations)
    rows = round(WINDOW / interval)
    count = accelerations["time"].size // rows
    if count < 1:
        raise ValueError(f"The accelerations must last at least {WINDOW:g} s; got {count} windows. Run longer.")
    found = []
    for axis, weighting in WEIGHTINGS.items():
        acceleration = finite(accelerations, f"acceleration_{axis}")
        values = weighted(acceleration - acceleration[0], interval, weighting.response)
        sizes = np.sqrt(np.mean(values[: count * rows].reshape(count, rows) ** 2, axis=1))
        found.append(float(np.percentile(sizes, PERCENTILE)))
    units = {"windows": "1", "mean_comfort": "1"} | dict.fromkeys((f"acceleration_{axis}_95" for axis in "xyz"), "m/s2")
    told = [f"Mean comfort from {count} windows of {WINDOW:g} s; EN 12299 takes {WINDOWS}."] if count < WINDOWS else []
    return Recording(units, [[count, COMFORT * math.hypot(*found), *found]], told)


def sperling(accelerations: Recording) -> Recording:
    """Return Sperling's ride index W_z, vertical and lateral, of a whole recording.

    W_z = (100 2^(1/2) a)^0.3 = 4.42 a^0.3, where a is the r.m.s. acceleration [m/s2] weighted by Sperling's B(f). For a
    sine this is Sperling's formula for its amplitude in cm/s2 (Garg and Dukkipati 1984, Dynamics of Railway Vehicle
    Systems, section 3.6).

    Parameters
    ----------
    accelerations : Recording
        `time`, `acceleration_y`, `acceleration_z` [m/s2], every 5 ms or more often.

    Returns
    -------
    Recording
        One row: `sperling_lateral`, `sperling_vertical`.

    Raises
    ------
    KeyError
        If a column is missing.
    ValueError
        If rows are uneven or more than 5 ms apart.
    """
    interval, found = interval_of(accelerations), []
    for axis, factor in {"y": LATERAL, "z": VERTICAL}.items():
        acceleration = finite(accelerations, f"acceleration_{axis}")
        values = factor * weighted(acceleration - acceleration.mean(), interval, _sperling)
        found.append((SPERLING * float(np.sqrt(np.mean(values**2)))) ** EXPONENT)
    return Recording({"sperling_lateral": "1", "sperling_vertical": "1"}, [found])


def _sperling(f: np.ndarray) -> np.ndarray:
    """Return Sperling's weighting without its factor; f: frequencies [Hz]."""
    above = 1.911 * f**2 + (0.25 * f**2) ** 2
    below = (1 - 0.277 * f**2) ** 2 + (1.563 * f - 0.0368 * f**3) ** 2
    return np.asarray(np.sqrt(above / below))

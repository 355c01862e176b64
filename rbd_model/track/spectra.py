"""Irregularities of the rails from power spectral densities."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from numbers import Integral, Real

import numpy as np

from rbd_model.track.line import MOST_ROWS, NAMES, Line

#: Largest product of rows and waves: some minutes.
MOST_PRODUCTS = 1e10
#: Length of line without irregularities at its start, and length over which they grow to their size after it [m]. A
#: vehicle thus starts with all wheels on rails in their nominal position.
QUIET, GROWTH = 15.0, 35.0


@dataclass(frozen=True)
class Spectrum:
    """Power spectral densities of a track [m2/(rad/m)], by wave number W [rad/m], two-sided.

    A W_c^2 / ((W^2 + W_r^2)(W^2 + W_c^2)) is the lateral and the vertical density of the centre line. That of half of
    the cross level is the vertical one times W^2 / (W^2 + W_s^2). The variance is the integral from 0 over pi.

    Parameters
    ----------
    lateral, vertical : float
        A of both directions [m.rad].
    cut, rise, level : float
        W_c, W_r and W_s [rad/m].

    Raises
    ------
    ValueError
        If a number is negative or not finite.
    """

    lateral: float
    vertical: float
    cut: float = 0.8246
    rise: float = 0.0206
    level: float = 0.4380

    def __post_init__(self) -> None:
        for one in fields(self):
            value = getattr(self, one.name)
            if not (isinstance(value, Real) and 0.0 <= float(value) < math.inf):
                raise ValueError(f"{one.name} of a spectrum must be a number of at least 0; got {value!r}.")

    @classmethod
    def named(cls, name: str) -> Spectrum:
        """Return a published spectrum.

        Parameters
        ----------
        name : str
            "erri-low", "erri-high", or "fra-1" to "fra-6"; the numbers of the FRA's classes are unverified.

        Returns
        -------
        Spectrum
            Its densities.

        Raises
        ------
        ValueError
            If the name is unknown.
        """
        if name not in SPECTRA:
            raise ValueError(f"spectrum must be one of {', '.join(SPECTRA)}, or a Spectrum; got {name!r}.")
        return SPECTRA[name]

    def of_centre(self, size: float, number: np.ndarray) -> np.ndarray:
        """Return the density of the lateral or vertical irregularity.

        Parameters
        ----------
        size : float
            `lateral` or `vertical` of this spectrum.
        number : array
            Wave numbers [rad/m].

        Returns
        -------
        ndarray
            Densities [m2/(rad/m)].
        """
        return np.asarray(size * self.cut**2 / ((number**2 + self.rise**2) * (number**2 + self.cut**2)))

    def of_level(self, number: np.ndarray) -> np.ndarray:
        """Return the density of half of the cross level.

        Parameters
        ----------
        number : array
            Wave numbers [rad/m].

        Returns
        -------
        ndarray
            Densities [m2/(rad/m)].
        """
        return self.of_centre(self.vertical, number) * number**2 / (number**2 + self.level**2)


#: ERRI B176 (1993), as published by H. Claus and W. Schiehlen (1998), Modeling and simulation of railway bogie
#: structural vibrations, Vehicle System Dynamics 29 (S1), 538-552.
ERRI_LOW, ERRI_HIGH = Spectrum(2.119e-7, 4.032e-7), Spectrum(6.125e-7, 1.08e-6)


def _american(lateral: float, vertical: float, level: float) -> Spectrum:
    """Return a class of track of the FRA from A_a and A_v [cm2.rad/m], with k = 1/4 and one-sided densities."""
    share = math.pi * 0.25 * 1e-4
    return Spectrum(share * lateral, share * vertical, 0.8245, 0.0, level)


#: Spectra by name. UNVERIFIED: those of the FRA's classes 1 to 6 are numbers of secondary literature (V. K. Garg and R.
#: V. Dukkipati (1984), Dynamics of Railway Vehicle Systems, chapter 3), read as one-sided; check before use.
SPECTRA = {
    "erri-low": ERRI_LOW,
    "erri-high": ERRI_HIGH,
    "fra-1": _american(3.3634, 1.2107, 0.6046),
    "fra-2": _american(1.2107, 1.0181, 0.9308),
    "fra-3": _american(0.4128, 0.6816, 0.8520),
    "fra-4": _american(0.3027, 0.5376, 1.1312),
    "fra-5": _american(0.0762, 0.2095, 0.8209),
    "fra-6": _american(0.0339, 0.0339, 0.4380),
}


def irregular(
    line: Line,
    spectrum: str | Spectrum = "erri-low",
    seed: int = 1,
    waves: tuple[float, float] = (3.0, 100.0),
    pitch: float = 0.25,
) -> Line:
    """Return a line with irregularities of both rails by random phases.

    They are 0 over the first 15 m, where a vehicle starts, and grow over the next 35 m.

    Parameters
    ----------
    line : Line
        The line. Its own irregularities are kept, and these added.
    spectrum : str or Spectrum
        "erri-low", "erri-high", "fra-1" to "fra-6", or densities of your own.
    seed : int
        Seed of the waves. Equal seeds give equal rails.
    waves : tuple of float
        Lengths of waves [m]. They are the shortest and the longest one.
    pitch : float
        Distance of the rows [m], at most an eighth of the shortest wave.

    Returns
    -------
    Line
        The line with rows every `pitch`.

    Raises
    ------
    ValueError
        If the spectrum is unknown, the pitch too long, the table too large, or seed or waves have no meaning.
    """
    densities = spectrum if isinstance(spectrum, Spectrum) else Spectrum.named(spectrum)
    if not (isinstance(seed, Integral) and seed >= 0):
        raise ValueError(f"seed must be an integer from 0 on; got {seed!r}.")
    if not 0.0 < waves[0] < waves[1] < math.inf:
        raise ValueError(f"waves must be two lengths above 0 m, the shorter one first; got {waves!r}.")
    if not pitch * 8 <= waves[0]:
        raise ValueError(
            f"Waves from {waves[0]:g} to {waves[1]:g} m need rows every {waves[0] / 8:g} m, not {pitch:g} m."
        )
    needed, count = line.length / pitch if pitch > 0.0 else math.inf, 2 * line.length / waves[1] + 200.0
    if not (needed <= MOST_ROWS and needed * count <= MOST_PRODUCTS):
        raise ValueError(
            f"A line must have at most {MOST_ROWS} rows, and {MOST_PRODUCTS:g} rows times waves; {line.length:g} m by "
            f"a pitch of {pitch:g} m are {needed:.3g} rows of {count:.3g} waves. Give a longer pitch or a shorter line."
        )
    old = line.rows["distance"]
    distance = np.unique(np.concatenate([old, np.arange(old[0], old[-1], pitch)]))
    distance = distance[np.append(np.diff(distance) > pitch / 10, True)]
    rows = {name: line.value(name, distance) for name in line.rows} | {"distance": distance}
    random = np.random.default_rng(seed)
    share = np.clip((distance - distance[0] - QUIET) / GROWTH, 0.0, 1.0)
    growth = share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
    ends = np.geomspace(2 * math.pi / waves[1], 2 * math.pi / waves[0], 2 * math.ceil(line.length / waves[1]) + 201)
    numbers, widths = random.uniform(ends[:-1], ends[1:]), np.diff(ends)  # equal distances would repeat the rails

    def wave(density: np.ndarray) -> np.ndarray:
        sizes = np.sqrt(2 * density * widths / math.pi)
        phases = random.uniform(0.0, 2 * math.pi, numbers.size)
        parts = [a * np.cos(n * distance + p) for a, n, p in zip(sizes, numbers, phases, strict=True)]
        return growth * np.sum(parts, axis=0)

    lateral = wave(densities.of_centre(densities.lateral, numbers))
    vertical = wave(densities.of_centre(densities.vertical, numbers))
    level = wave(densities.of_level(numbers))
    added = {"left_lateral": lateral, "right_lateral": lateral}
    added |= {"left_vertical": vertical + level, "right_vertical": vertical - level}
    rows |= {name: rows.get(name, 0.0) + values for name, values in added.items()}
    return Line({name: rows[name] for name in NAMES if name in rows})

"""Values that a country and the standard give, SUBSET-026, A.3.1 and A.3.2."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from products.supervision.conversion import KMH
from products.supervision.steps import Steps

#: Time that each baseline adds to the indication [s]: the driver's time, which only baseline 4 counts in T_indication.
BASELINES = {"3.3.0": 0.0, "4.0.0": 4.0}


@dataclass(frozen=True)
class FixedValues:
    """Fixed values of SUBSET-026, A.3.1.

    Parameters
    ----------
    T_warning, T_driver : float
        Times between warning, permitted speed and intervention [s].
    T_indication_least : float
        Least time between indication and permitted speed [s].
    T_indication_more : float
        A value of BASELINES [s].
    """

    T_warning: float = 2.0
    T_driver: float = 4.0
    T_indication_least: float = 5.0
    T_indication_more: float = BASELINES["3.3.0"]

    def dV_ebi(self, speed: np.ndarray | float) -> np.ndarray:
        """Return the margin of the emergency brake over a permitted speed, 7.5 to 15 km/h at 110 to 210 km/h.

        Parameters
        ----------
        speed : ndarray or float
            Permitted speed [m/s].

        Returns
        -------
        ndarray
            Margin [m/s].
        """
        return np.asarray(np.interp(speed, (110.0 * KMH, 210.0 * KMH), (7.5 * KMH, 15.0 * KMH)))


@dataclass(frozen=True)
class NationalValues:
    """National values, with the defaults of SUBSET-026, A.3.2.

    Parameters
    ----------
    M_NVEBCL : int
        Confidence level of the emergency brake, 0 to 9.
    M_NVAVADH : float
        Share of the wet-rail loss that is not counted, 0 to 1.
    Kv_int : Steps
        Correction of percentages by speed; for passenger trains that of A_NVP12 (set a).
    Kv_int_b : Steps or None
        For passenger trains that brake with A_NVP23 or more (set b); None: as `Kv_int`.
    A_NVP12, A_NVP23 : float
        Decelerations between which sets a and b are interpolated [m/s2].
    Kr_int : Steps
        Correction of percentages by length; the boundaries are lengths [m].
    Kt_int : float
        Correction of build-up times of percentages.
    reduced_adhesion : tuple of float
        Largest deceleration under reduced adhesion of passenger trains with and without brakes that need none, and of
        other trains [m/s2].
    guidance : bool
        True if the guidance curve is permitted.
    """

    M_NVEBCL: int = 9
    M_NVAVADH: float = 0.0
    Kv_int: Steps = field(default_factory=lambda: Steps.constant(0.7))
    Kv_int_b: Steps | None = None
    A_NVP12: float = 0.0
    A_NVP23: float = 0.0
    Kr_int: Steps = field(default_factory=lambda: Steps.constant(0.9))
    Kt_int: float = 1.1
    reduced_adhesion: tuple[float, float, float] = (1.0, 0.7, 0.7)
    guidance: bool = False

"""Values that a country and the standard give, SUBSET-026, A.3.1 and A.3.2."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from products.supervision.arguments import at_least, finite, numbers, of_type, within
from products.supervision.conversion import KMH
from products.supervision.steps import Steps, check_boundaries, set_kinds
from readers.text import BadInputError, shown

#: Time that each baseline adds to the indication [s]: the driver's time, which only baseline 4 counts in T_indication.
BASELINES = {"3.3.0": 0.0, "4.0.0": 4.0}
#: Largest national values, SUBSET-026, 7.5.1: shares and factors [1], decelerations [m/s2].
RANGES = {
    "M_NVAVADH": 1.0,
    "Kv_int": 2.54,
    "Kv_int_b": 2.54,
    "Kr_int": 1.55,
    "Kt_int": 1.55,
    "A_NVP12": 3.15,
    "A_NVP23": 3.15,
    "reduced_adhesion": 3.15,
}


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

    def __post_init__(self) -> None:
        for name in ("T_warning", "T_driver", "T_indication_least", "T_indication_more"):
            within(name, getattr(self, name), 0.0, 60.0, "Give seconds.")
            object.__setattr__(self, name, finite(name, getattr(self, name)))

    def dV_ebi(self, speed: np.ndarray | float) -> np.ndarray:
        """Return the margin of the emergency brake over a permitted speed, 7.5 to 15 km/h at 110 to 210 km/h.

        Takes speed [m/s]; returns [m/s].
        """
        return np.asarray(
            np.interp(at_least("speed", speed, 0.0, "m/s"), (110.0 * KMH, 210.0 * KMH), (7.5 * KMH, 15.0 * KMH))
        )


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
        True if the guidance curve is permitted (Q_NVGUIPERM).
    exact_speed : bool
        True if the error of the speed is not compensated (Q_NVINHSMICPERM).
    feedback : bool
        True if feedback of the service brake is permitted (Q_NVSBFBPERM).

    Raises
    ------
    BadInputError
        If a value is outside the range of its variable in SUBSET-026, 7.5.
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
    exact_speed: bool = False
    feedback: bool = False

    def __post_init__(self) -> None:
        set_kinds(self)
        if numbers("reduced_adhesion", self.reduced_adhesion).shape != (3,):
            raise BadInputError(
                f"reduced_adhesion must be three numbers, A_NVMAXREDADH1 to 3; got {shown(self.reduced_adhesion)}."
            )
        for name, most in RANGES.items():
            value = getattr(self, name)
            if isinstance(value, Steps):
                within(name, value.values, 0.0, most)
                if name != "Kr_int":  # by length
                    check_boundaries(name, value)
            elif name != "Kv_int_b":
                within(name, value, 0.0, most)
                if name != "reduced_adhesion":
                    object.__setattr__(self, name, finite(name, value))
        checked_level("M_NVEBCL", self.M_NVEBCL)
        if self.A_NVP12 > self.A_NVP23:
            raise BadInputError(f"A_NVP12 must be at most A_NVP23, {self.A_NVP23:g} m/s2; got {self.A_NVP12:g} m/s2.")


def check_national(national: object) -> NationalValues:
    """Return the values of a country. Raises BadInputError if the argument is of another type."""
    return of_type("national", national, NationalValues, "Give NationalValues(M_NVAVADH=0.2), or read_national(path).")


def checked_level(name: str, value: object) -> int:
    """Return a confidence level."""
    if isinstance(value, bool) or not isinstance(value, int | float | np.number) or value not in range(10):
        raise BadInputError(f"{name} must be an integer from 0 to 9; got {shown(value)}. Correct it.")
    return int(value)

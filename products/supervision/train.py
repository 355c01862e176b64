"""Numbers of a train that supervision needs, SUBSET-026, 3.13.2.2."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from products.supervision.arguments import at_least, check_shapes, name_among, numbers, of_type, switch, within
from products.supervision.conversion import (
    BRAKE_POSITIONS,
    FASTEST,
    KMH,
    LEAST,
    MOST,
    MOVING_TARGET,
    brake_of_percentage,
)
from products.supervision.steps import Steps, check_boundaries, set_kinds
from products.supervision.values import NationalValues, check_national, checked_level
from readers.text import BadInputError, shown

#: Largest number of steps of a deceleration in train data, SUBSET-026, 3.13.2.2.3.1.2.
MOST_STEPS = 7
ONE = Steps.constant(1.0)
#: Limits of decelerations [m/s2], times [s] and lengths [m] of train data.
LIMITS = {
    "length": (1.0, 4095.0, "m"),
    "T_brake_emergency": (0.0, 60.0, "s"),
    "T_brake_service": (0.0, 60.0, "s"),
    "T_traction_cut_off": (0.0, 30.0, "s"),
    "rotating": (0.0, 30.0, "%"),
    "maximum_speed": (0.0, 600.0 * KMH, "m/s"),
    "percentage": (LEAST, MOST, "%"),
}
#: Numbers that need not be known.
UNKNOWN = ("rotating", "maximum_speed", "percentage")
#: Rotating mass below which a share of 1 was given instead of percent [%]: the largest share.
A_SHARE = 0.3
#: Limits of factors in train data: K of dry and wet rails by SUBSET-027; Kn, 0 to 10 m/s2 for a gradient of 1.
FACTORS = {
    "Kdry_rst": (0.0, 1.55, "Give 0.85 for 85 %."),
    "Kwet_rst": (0.0, 1.55, "Give 0.85 for 85 %."),
    "Kn_plus": (0.0, 0.01, "Give m/s2 a permille: 0.007, not 7."),
    "Kn_minus": (0.0, 0.01, "Give m/s2 a permille: 0.007, not 7."),
}


@dataclass(frozen=True)
class SupervisedTrain:
    """Train data of supervision. Numbers may be arrays with one value for each train, steps have leading axes.

    Parameters
    ----------
    length : float or ndarray
        Length of the train [m].
    A_brake_emergency, A_brake_service : Steps
        Decelerations on level track by speed [m/s2].
    T_brake_emergency, T_brake_service : float or ndarray
        Equivalent build-up times for a target at rest: reaction and half of the rise to 95 % [s].
    Kdry_rst, Kwet_rst : Steps
        Correction factors for the confidence level of the national values, and for wet rails; 1 for percentages.
    position : str or None
        Brake position of a train whose brake is given by its percentage, of BRAKE_POSITIONS; None: by decelerations.
    T_traction_cut_off : float or ndarray
        Time until traction is off [s].
    traction_command, service_command : bool
        True if the on-board unit can cut off traction, and can command the service brake.
    service_feedback : bool
        True if the on-board unit also measures the service brake, A.3.10.
    rotating : float or ndarray or None
        Nominal rotating mass [% of the mass]; None: the values of `gradients.acceleration_by`.
    A_brake_normal_service : Steps or None
        Deceleration of the guidance curve [m/s2], 3.13.6.4; None: the train has no guidance curve.
    Kn_plus, Kn_minus : Steps
        What the guidance curve subtracts up and down a gradient [m/s2 a permille].
    without_adhesion : bool
        True if the train has brakes that need no adhesion, for its deceleration on slippery rails.
    freight : bool
        True for a freight train without `position`, for its deceleration on slippery rails.
    maximum_speed : float or ndarray or None
        Largest speed of the train [m/s]: faster steps do not count for the largest deceleration, 3.13.6.2.1.8.2; None:
        all steps count.
    percentage : float or ndarray or None
        Brake percentage [%] from which `of_percentage` computed the rest; None: by decelerations.
    level : int or None
        Confidence level (M_NVEBCL) to which Kdry_rst and T_brake_emergency belong, 0 to 9: a country with another one
        is refused. None: not stated, they hold for each country.

    Raises
    ------
    BadInputError
        If a number is not finite or outside its limits, or a deceleration is not above 0 or has more than 7 steps.
    """

    length: float | np.ndarray
    A_brake_emergency: Steps
    A_brake_service: Steps
    T_brake_emergency: float | np.ndarray
    T_brake_service: float | np.ndarray
    Kdry_rst: Steps = ONE
    Kwet_rst: Steps = ONE
    position: str | None = None
    T_traction_cut_off: float | np.ndarray = 0.0
    traction_command: bool = False
    service_command: bool = False
    rotating: float | np.ndarray | None = None
    A_brake_normal_service: Steps | None = None
    Kn_plus: Steps = field(default_factory=lambda: Steps.constant(0.0))
    Kn_minus: Steps = field(default_factory=lambda: Steps.constant(0.0))
    without_adhesion: bool = False
    service_feedback: bool = False
    freight: bool = False
    maximum_speed: float | np.ndarray | None = None
    percentage: float | np.ndarray | None = None
    level: int | None = None

    def __post_init__(self) -> None:
        set_kinds(self)
        for name, (least, most, unit) in LIMITS.items():
            value = getattr(self, name)
            if value is not None or name not in UNKNOWN:
                array = numbers(name, value)
                if not np.all((array >= least) & (array <= most)):
                    raise BadInputError(f"{name} must be {least:g} to {most:g} {unit}; got {shown(value)}. Correct it.")
        if self.position is not None:
            name_among("position", self.position, tuple(BRAKE_POSITIONS))
        rotating = numbers("rotating", 0.0 if self.rotating is None else self.rotating)
        if np.any((rotating > 0.0) & (rotating < A_SHARE)):
            raise BadInputError(
                f"rotating must be 0, or {A_SHARE:g} to {LIMITS['rotating'][1]:g} % of the mass; got "
                f"{shown(self.rotating)}. Give percent: 10 for 10 %."
            )
        for name, (least, most, remedy) in FACTORS.items():
            within(name, getattr(self, name).values, least, most, remedy)
            check_boundaries(name, getattr(self, name))
        if self.level is not None:
            object.__setattr__(self, "level", checked_level("level", self.level))
        if self.service_feedback and not self.service_command:
            raise BadInputError("service_feedback must be False without service_command: there is no brake to measure.")
        for name in ("A_brake_emergency", "A_brake_service", "A_brake_normal_service"):
            if getattr(self, name) is not None:
                _check_deceleration(name, getattr(self, name))
        _ = self.shape

    @property
    def shape(self) -> tuple[int, ...]:
        """Return the leading axes of the trains. Raises BadInputError if two numbers do not fit together."""
        given = {one.name: getattr(self, one.name) for one in fields(self)}
        shapes = {name: np.shape(given[name]) for name in LIMITS if given[name] is not None}
        shapes |= {name: one.values.shape[:-1] for name, one in given.items() if isinstance(one, Steps)}
        return check_shapes(shapes)

    @classmethod
    def of_percentage(
        cls,
        percentage: float | np.ndarray,
        position: str,
        length: float | np.ndarray,
        *,
        resolution: float = 0.0,
        maximum_speed: float | np.ndarray | None = None,
        **others: Any,
    ) -> SupervisedTrain:
        """Return the train data of a brake percentage, by the conversion model, SUBSET-026, A.3.7 and A.3.8.

        Takes percentage [%], length [m], maximum_speed [m/s].
        """
        brake = brake_of_percentage(percentage, position, length, resolution)
        if maximum_speed is not None and not np.all(numbers("maximum_speed", maximum_speed) <= FASTEST * (1.0 + 1e-9)):
            raise BadInputError(
                f"The largest speed must be at most {FASTEST / KMH:g} km/h for the conversion model (SUBSET-026, "
                f"3.13.3.2); got {np.max(maximum_speed) / KMH:g} km/h. Give decelerations by speed instead."
            )
        data = (length, brake.emergency, brake.service, brake.emergency_time, brake.service_time)
        return cls(*data, position=position, maximum_speed=maximum_speed, percentage=percentage, **others)

    @property
    def is_passenger(self) -> bool:
        """Return whether this is a passenger train."""
        return not self.freight if self.position is None else self.position.startswith("passenger")

    @property
    def adhesion_number(self) -> int:
        """Return the place of the train's limit among those of reduced adhesion, A_NVMAXREDADH1 to 3, from 0."""
        return (0 if self.without_adhesion else 1) if self.is_passenger else 2

    def check_level(self, level: int) -> None:
        """Refuse a confidence level for which the train does not state its brake."""
        checked_level("M_NVEBCL", level)
        if self.position is None and self.level not in (None, level):
            raise BadInputError(
                f"The train has Kdry_rst of confidence level {self.level} alone; got M_NVEBCL {level}. Give train data "
                f"of level {level} (at_level of read_train), or M_NVEBCL {self.level} (--level {self.level})."
            )

    def safe_brake(self, national: NationalValues, slippery: bool = False) -> Steps:
        """Return A_brake_safe, the deceleration that the emergency brake reaches for certain, 3.13.6.2.

        Returns [m/s2].
        """
        check_national(national)
        self.check_level(national.M_NVEBCL)
        dry, wet = self.factors(national)
        counted = wet.with_others(lambda wet: wet + national.M_NVAVADH * (1.0 - wet))
        safe = self.A_brake_emergency.with_others(lambda *factors: np.prod(factors, axis=0), dry, counted)
        if not switch("slippery", slippery):
            return safe
        most = national.reduced_adhesion[self.adhesion_number]
        return safe.with_others(lambda brake: np.minimum(brake, most))

    def factors(self, national: NationalValues) -> tuple[Steps, Steps]:
        """Return the factors of the emergency brake on dry and on wet rails; those of percentages are the country's."""
        if self.position is None:
            return self.Kdry_rst, self.Kwet_rst
        by_length = national.Kr_int.at(np.asarray(self.length, dtype=float)[..., None])
        by_speed = self.speed_factor(national)
        return Steps(by_speed.boundaries, by_speed.values * by_length), ONE

    def speed_factor(self, national: NationalValues) -> Steps:
        """Return Kv_int, for passenger trains between both sets by the largest deceleration, 3.13.6.2.1.7."""
        check_national(national)
        low, high = national.Kv_int, national.Kv_int_b
        if high is None or not self.is_passenger:
            return low
        brake = self.A_brake_emergency
        begins = np.concatenate([np.zeros_like(brake.values[..., :1]), brake.boundaries], axis=-1)
        reached = begins < np.asarray(np.inf if self.maximum_speed is None else self.maximum_speed)[..., None]
        largest = np.where(reached, brake.values, 0.0).max(axis=-1)
        span = max(national.A_NVP23 - national.A_NVP12, 1e-9)
        between = np.clip((largest - national.A_NVP12) / span, 0.0, 1.0)[..., None]
        return low.with_others(lambda one, other: one + between * (other - one), high)

    def build_up_times(
        self, national: NationalValues, target_speed: np.ndarray | float
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return T_be and T_bs for a target, 3.13.6.2.2 and A.3.8.

        Takes target_speed [m/s]; returns emergency, service [s].
        """
        check_national(national)
        target = at_least("target_speed", target_speed, 0.0, "m/s")
        emergency, service = np.asarray(self.T_brake_emergency), np.asarray(self.T_brake_service)
        if self.position is None:
            return emergency, service
        factor = np.where(target > 0.0, MOVING_TARGET[self.position], 1.0)
        return emergency * factor * national.Kt_int, service * factor


def _check_deceleration(name: str, steps: Steps) -> None:
    """Refuse decelerations that no train has, and more steps than train data have."""
    check_boundaries(name, steps)
    if not np.all((steps.values > 0.0) & (steps.values < 10.0)):
        raise BadInputError(f"{name} must be above 0 and below 10 m/s2; got {shown(steps.values.tolist())}. Give m/s2.")
    if steps.values.shape[-1] > MOST_STEPS:
        raise BadInputError(
            f"{name} must have at most {MOST_STEPS} steps (SUBSET-026, 3.13.2.2.3); got {steps.values.shape[-1]}. "
            "Unite some of them, with the lower value."
        )


def check_train(train: object) -> None:
    """Refuse what is not a train."""
    of_type("train", train, SupervisedTrain, "Of a file, take read_train(path).at_level(M_NVEBCL).")

"""Wheel-slip protection of driven wheels: from the speeds of the wheels to commands for their motors.

It has the form of a wheel-slide controller (wheel_slide.py): 0 as demanded, 1 hold, 2 release. This file needs only
Python, so that it can be included in an FMU.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

DEMANDED, HOLD, LET_GO = 0, 1, 2
#: A released wheel rolls once it slowed by at most ROLLING [m/s2] over WHILE [s], at the earliest after
#: SHORTEST [s]. It is treated as rolling after LONGEST [s].
ROLLING, WHILE, SHORTEST, LONGEST = 0.3, 0.1, 0.25, 2.0
#: Time for which sensors are only observed after a reading of 0 [s].
SETTLING = 0.5
#: A sensor that shows 0 while another shows more than this is lost [m/s]: no driven wheel locks.
BLIND_ABOVE = 2.0
#: Time constants of the filters of speeds: for slips, and for the slowest wheel, because of errors of teeth [s]. Chosen
#: among five on 16 starts with friction from 0.03 to 0.1 below each wheelset.
CALM, SLOW = 0.02, 0.3
#: Times from the first true speed to the second, and between later ones [s].
SECOND_CHECK, CHECKS = 1.0, 3.0
#: Possible increase of the vehicle's acceleration over that between two true speeds [m/s2].
MARGIN = 0.1
#: A true speed this near the reference, as a share of it, shows that nothing spins [1].
NEAR = 0.02


def filtered(before: Sequence[float], speeds: Sequence[float], share: float) -> list[float]:
    """Return first-order lags after a step of `share` time constants; at share 1 or at first, the speeds."""
    if not before or not share:
        return list(speeds)
    return [old + min(share, 1.0) * (speed - old) for old, speed in zip(before, speeds, strict=True)]


@dataclass(frozen=True)
class SpinProtectionParameters:
    """Thresholds of `SpinProtection`; all finite and above 0."""

    #: Slip below which a motor gives its demanded torque, and above which it is released; between them it holds [1].
    lower_slip: float
    upper_slip: float
    #: Speed below which slips are those at this speed [m/s].
    slowest: float
    #: Acceleration that no vehicle has, and the one assumed of a vehicle whose wheels begin to spin [m/s2].
    largest_acceleration: float
    first_acceleration: float

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not (math.isfinite(value) and value > 0.0):
                raise ValueError(f"{name} must be finite and above 0; got {value}. Give such a number.")
        if self.lower_slip >= self.upper_slip:
            raise ValueError(
                f"lower_slip must be below upper_slip, {self.upper_slip}; got {self.lower_slip}. Reduce it."
            )


def common_spin_protection() -> SpinProtectionParameters:
    """Return assumed thresholds, not tuned: the slips at which braked wheels are held.

    No vehicle here gains 1.5 m/s2.
    """
    return SpinProtectionParameters(
        lower_slip=0.05, upper_slip=0.10, slowest=3.0, largest_acceleration=1.5, first_acceleration=0.5
    )


class SpinProtection:
    """Hold the slip of driven wheels in a band, over a reference that is at most the speed of the slowest wheel.

    If all spin at once, the slowest gains speed faster than any vehicle, and the reference stops following it. Then one
    wheelset after the other is released until it rolls, which shows the true speed and its growth. A sensor that shows
    0 while others turn is lost: its motor is released while the others spin.
    """

    def __init__(self, parameters: SpinProtectionParameters | None = None) -> None:
        self.parameters = parameters or common_spin_protection()
        self.time, self.reference, self.growth = 0.0, math.inf, self.parameters.largest_acceleration
        self.spins, self.checks, self.checked_at, self.true_speed = False, 0, 0.0, 0.0
        self.rolls: int | None = None
        self._since, self._shown_since, self._course = 0.0, 0.0, [(0.0, 0.0)]
        self._calm: list[float] = []
        self._slow: list[float] = []

    def step(self, time: float, wheel_speeds: Sequence[float]) -> list[int]:
        """Return commands of all motors from the circumferential speeds of their wheels [m/s]; time [s]."""
        blind = [speed == 0.0 and max(wheel_speeds) > BLIND_ABOVE for speed in wheel_speeds]
        size = max(time - self.time, 0.0)
        if any(speed == 0.0 and not lost for speed, lost in zip(wheel_speeds, blind, strict=True)):
            self._shown_since = time
        settles = time - self._shown_since < SETTLING
        self._calm = filtered(self._calm, wheel_speeds, 0.0 if settles else size / CALM)
        self._slow = filtered(self._slow, wheel_speeds, 0.0 if settles else size / SLOW)
        slowest = min(speed for speed, lost in zip(self._slow, blind, strict=True) if not lost)
        self.reference = slowest if settles else min(slowest + SLOW * self.growth, self.reference + size * self.growth)
        self.time = time
        if settles:
            return [DEMANDED] * len(wheel_speeds)
        unseen = LET_GO if self.spins else DEMANDED
        commands = [unseen if lost else self._command(speed) for speed, lost in zip(self._calm, blind, strict=True)]
        if any(command != DEMANDED for command in commands) and not self.spins:
            self.spins, self.checks, self.growth = True, 0, self.parameters.first_acceleration
        self._look(time, self._calm, blind)
        if self.rolls is not None:
            commands[self.rolls] = LET_GO
        return commands

    def _command(self, speed: float) -> int:
        p = self.parameters
        slip = (speed - self.reference) / max(self.reference, p.slowest)
        return LET_GO if slip > p.upper_slip else DEMANDED if slip < p.lower_slip else HOLD

    def _look(self, time: float, wheel_speeds: Sequence[float], blind: Sequence[bool]) -> None:
        """Release the slowest wheelset if a true speed is due, and take it once the wheelset rolls."""
        due = (0.0, SECOND_CHECK)[self.checks] if self.checks < 2 else CHECKS
        if self.rolls is None:
            if self.spins and time - self.checked_at >= due:
                slowest = min(range(len(wheel_speeds)), key=lambda one: (blind[one], wheel_speeds[one]))
                self.rolls, self._since, self._course = slowest, time, []
            return
        if blind[self.rolls]:  # its sensor is lost: take another
            self.rolls = None
            return
        speed = wheel_speeds[self.rolls]
        self._course = [(at, of) for at, of in self._course if time - at <= WHILE] + [(time, speed)]
        first = self._course[0]
        slows = (first[1] - speed) / max(time - first[0], 1e-9) > ROLLING
        if time - self._since > LONGEST or (time - self._since > SHORTEST and not slows):
            self._take(time, speed)

    def _take(self, time: float, speed: float) -> None:
        """Take a true speed, and from two of them its growth."""
        p = self.parameters
        if self.checks:
            gained = (speed - self.true_speed) / (time - self.checked_at)
            self.growth = min(max(gained, 0.0) + MARGIN, p.largest_acceleration)
            if self.checks > 1 and speed > (1.0 - NEAR) * self.reference - NEAR:
                self.spins, self.growth = False, p.largest_acceleration
        self.checks += 1
        self.reference, self.checked_at, self.true_speed, self.rolls = speed, time, speed, None

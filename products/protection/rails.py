"""Rails for tests of wheel-slide protection, and acceptance limits of a stop on them."""

from dataclasses import dataclass

from rbd_model.track.friction import RailCondition, dry, low, wet

#: Slip ratio up to which a wheel is protected, and speed [m/s] above which it is evaluated.
BAND, ABOVE = 0.30, 3.0
#: Speed above which a lock counts [m/s].
LOCK_ABOVE = 0.3
#: Time constant of each of two lags on the acceleration, from whose output the jerk is taken [s]: assumed.
JERK_TIME = 0.25
#: Requirements of a protection on a low rail: longest lock [s], share of the time in the slip band, and the stopping
#: distance over that of the ideal. Assumed.
LONGEST_LOCK, SHARE, OVER_IDEAL = 0.4, 0.8, 1.25


@dataclass(frozen=True)
class RailCase:
    """A rail: its condition, and changes along it (parameters of bogie and vehicle)."""

    name: str
    condition: RailCondition
    changes: tuple[tuple[str, float], ...] = ()

    def values(self, wheelsets: int = 2) -> dict[str, float]:
        """Return inputs and parameters by name."""
        return self.condition.values(wheelsets) | dict(self.changes)


#: On the changing rail leaves lie on a wet rail from 60 to 160 m, and the leading wheels clean it a little.
RAILS = (
    RailCase("dry", dry()),
    RailCase("wet", wet()),
    RailCase("low", low()),
    RailCase(
        "changing",
        wet(),
        (("patch_friction", 0.25), ("patch_start", 60.0), ("patch_length", 100.0), ("cleaned_friction", 1.1)),
    ),
)

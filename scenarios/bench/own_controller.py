"""An example of your own wheel-slide controller; `build_fmu.py --controller` makes an FMU of it."""

from collections.abc import Sequence

from brake_controller.wheel_slide import APPLY, HOLD, VENT


class FixedSlip:
    """The whole controller: a reference that falls at 1 m/s2, and two fixed slips. It does not use the true speed."""

    def __init__(self) -> None:
        self.time, self.reference = 0.0, 0.0

    def step(self, time: float, wheel_speeds: Sequence[float]) -> list[int]:
        self.reference = max(*wheel_speeds, self.reference - 1.0 * (time - self.time))
        self.time = time
        return [self.command(speed) for speed in wheel_speeds]

    def command(self, speed: float) -> int:
        sliding = self.reference - speed
        if sliding > max(0.2 * self.reference, 0.5):
            return VENT
        return HOLD if sliding > max(0.1 * self.reference, 0.3) else APPLY

"""Runs of the live page that play in one click: each is a link, as the page writes it for any other run."""

from dataclasses import dataclass, field
from typing import Any
from urllib.parse import urlencode

#: Sampling interval of the controls and of the wheel-slide protection: PERIOD of simulation.js [s].
PERIOD = 5e-3
#: Step at which presets brake, after half a second of rolling.
BRAKING = 100
#: Default values of a run's link; the names are those of the page's controls. speed [km/h], mass of the body [t] or
#: empty for its own, friction [1], protection 0 or 1, gradient [1/1000, uphill positive], curve: radius [m], 0
#: straight, uneven [%], wave [mm].
DEFAULTS: dict[str, Any] = {
    "machine": "coach",
    "level": 2,
    "speed": 90,
    "mass": "",
    "friction": 0.3,
    "protection": 1,
    "gradient": 0,
    "curve": 0,
    "uneven": 0,
    "wave": 0,
}


@dataclass(frozen=True)
class Preset:
    """A run: its settings, and its actions as (step, control, value); lever: % of the full brake."""

    title: str
    start: dict[str, Any]
    actions: tuple[tuple[int, str, float], ...] = field(default=((BRAKING, "lever", 100),))

    @property
    def link(self) -> str:
        """Return the address of the run, after #."""
        done = ",".join(f"{step}:{name}:{value:g}" for step, name, value in self.actions)
        return urlencode({**self.start, "do": done}, safe=":,")


PRESETS = {
    "full": Preset("Full brake", {}),
    "locks": Preset("Friction 0.08, wheels lock", {"friction": 0.08, "protection": 0}),
    "leaves": Preset("Leaves and protection", {}, ((BRAKING, "lever", 100), (BRAKING, "leaves", 1))),
    "uneven": Preset("Uneven brake shoes", {"machine": "bogie", "level": 3, "uneven": 75}),
    "curve": Preset("Stop in a curve", {"level": 3, "speed": 60, "curve": 300}),
}

"""What plays on the live page in one click: each is the link of a run, as the page writes it for any other."""

from dataclasses import dataclass, field
from typing import Any
from urllib.parse import urlencode

#: Between looks at the controls, and of the wheel-slide protection: PERIOD of simulation.js [s].
PERIOD = 5e-3
#: Step at which presets brake: half a second of rolling comes first.
BRAKING = 100
#: Values of a run that a link does not name; the names are those of the page's controls. speed [km/h], mass of the body
#: [t] or no text for its own, friction [1], protection 0 or 1, gradient [1/1000, uphill positive], curve: radius
#: [m], 0 straight, uneven [%], wave [mm].
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
    """A run: what it starts with, and what is done in it, as (step, control, value); lever: % of the full brake."""

    title: str
    start: dict[str, Any]
    actions: tuple[tuple[int, str, float], ...] = field(default=((BRAKING, "lever", 100),))

    @property
    def link(self) -> str:
        """The address of the run, behind #."""
        done = ",".join(f"{step}:{name}:{value:g}" for step, name, value in self.actions)
        return urlencode({**self.start, "do": done}, safe=":,")


PRESETS = {
    "full": Preset("Full brake", {}),
    "locks": Preset("Friction 0.08, wheels lock", {"friction": 0.08, "protection": 0}),
    "leaves": Preset("Leaves and protection", {}, ((BRAKING, "lever", 100), (BRAKING, "leaves", 1))),
    "uneven": Preset("Uneven brake shoes", {"machine": "bogie", "level": 3, "uneven": 75}),
    "curve": Preset("Stop in a curve", {"level": 3, "speed": 60, "curve": 300}),
}

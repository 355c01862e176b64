"""The driver's desk of a train's page: notches of the brake valve, and controls by the names of a train's inputs."""

from __future__ import annotations

from dataclasses import dataclass

from brake_controller.drivers_valve import POSITIONS

#: Notches of the driver's valve in their order, from release to emergency: its position, and its step of service.
NOTCHES = {
    "overcharge": ("overcharge", 0.0),
    "running": ("running", 0.0),
    "first step": ("service", 0.0),
    "half service": ("service", 0.4),
    "full service": ("service", 1.0),
    "emergency": ("emergency", 0.0),
}


@dataclass(frozen=True)
class Control:
    """A control of the desk; brakes: whether it brakes; less, more: keys as `KeyboardEvent.code`, and their caps."""

    brakes: bool
    less: str
    more: str
    caps: str


#: Keys of the driver's valve: a notch towards release, and towards emergency; those of Open Rails' manual.
VALVE_KEYS = ("Semicolon", "Quote", "; '")
#: Controls by input. An input that this version of a train does not have is left out; one that is not here has no keys.
CONTROLS = {
    "traction": Control(False, "KeyA", "KeyD", "A D"),
    "dynamic_brake": Control(True, "Comma", "Period", ", ."),
    "direct_brake": Control(True, "BracketLeft", "BracketRight", "[ ]"),
    "track_brake": Control(True, "KeyN", "KeyM", "N M"),
    "parking_brake": Control(True, "KeyJ", "KeyK", "J K"),
    "bail_off": Control(False, "", "Slash", "/"),
    "vigilance": Control(False, "", "KeyZ", "Z"),
}


def notches() -> dict[str, tuple[int, float]]:
    """Return the values of `driver_position` and `driver_step` of each notch."""
    return {name: (POSITIONS[position], step) for name, (position, step) in NOTCHES.items()}

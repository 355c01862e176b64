"""The driver's desk of a train's page: keys of the brake valve, and controls by the names of a train's inputs."""

from __future__ import annotations

from dataclasses import dataclass


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

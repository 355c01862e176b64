"""Inputs and outputs of BogieDynamics, the same at every level of detail. 1 = leading, 2 = trailing wheelset."""

from __future__ import annotations

import math

from fmu_src.system import Variable

WHEELSETS = {1: "leading", 2: "trailing"}
#: Above this the contact laws mean nothing; dry steel on steel stays below 0.8.
HIGHEST_FRICTION = 2.0


def _input(name: str, unit: str, description: str, start: float = 0.0, minimum: float = -math.inf) -> Variable:
    maximum = HIGHEST_FRICTION if name.startswith("friction") else math.inf
    return Variable(name, "input", unit, description, start, minimum, maximum)


def inputs() -> dict[str, Variable]:
    """All inputs by name."""
    rows = []
    for number, place in WHEELSETS.items():
        rows.append(
            _input(
                f"brake_torque_{number}",
                "N.m",
                f"Largest torque that the brake of the {place} wheelset can resist with (a capacity; its sign and the "
                "locked state are found inside)",
                minimum=0.0,
            )
        )
    for number, place in WHEELSETS.items():
        rows.append(_input(f"traction_torque_{number}", "N.m", f"Torque that drives the {place} wheelset forward"))
    for number, place in WHEELSETS.items():
        text = f"Yaw torque on the {place} wheelset, about the axis upright on its axle, which rolls with it"
        rows.append(_input(f"yaw_torque_{number}", "N.m", text))
    rows.append(_input("drawbar_force", "N", "Forward force on the sprung mass, at its centre"))
    for number, place in WHEELSETS.items():
        text = f"Wheel-rail friction coefficient under the {place} wheelset"
        rows.append(_input(f"friction_{number}", "1", text, start=0.3, minimum=0.0))
    return {row.name: row for row in rows}


def _output(name: str, unit: str, description: str, **more: str) -> Variable:
    return Variable(name, "output", unit, description, **more)  # type: ignore[arg-type]


def _pair(name: str, unit: str, description: str, **more: str) -> list[Variable]:
    return [_output(f"{name}_{n}", unit, description.format(place), **more) for n, place in WHEELSETS.items()]


def outputs() -> dict[str, Variable]:
    """All outputs by name. Those of the second group are 0 below the spatial level."""
    rows = [
        _output("speed", "m/s", "Forward speed of the bogie at its axles", display_unit="km/h"),
        _output("distance", "m", "Distance travelled"),
        _output("acceleration", "m/s2", "Forward acceleration of the bogie at its axles"),
        *_pair("angular_velocity", "rad/s", "Angular velocity of the {} wheelset, positive when rolling forward"),
        *_pair("rotation", "rad", "Rotation of the {} wheelset"),
        *_pair("slip", "m/s", "Speed minus nominal wheel radius times angular velocity, {} wheelset"),
        *_pair("slip_ratio", "1", "Slip over speed, {} wheelset: 0 rolling, 1 locked"),
        *_pair("creep_force", "N", "Longitudinal creep force of the rails on the {} wheelset, positive forward"),
        *_pair("axle_load", "N", "Vertical force of the rails on the {} wheelset", display_unit="kN"),
        *_pair("locked", "1", "The {} wheelset is locked by its brake", kind="boolean"),
        _output("bounce", "m", "Vertical displacement of the sprung mass from rest, upwards"),
        _output("pitch", "rad", "Pitch of the sprung mass, positive nose down", display_unit="deg"),
        *_pair("lateral", "m", "Lateral displacement of the {} wheelset from the track centre, to the left"),
        *_pair("yaw", "rad", "Yaw of the {} wheelset", display_unit="deg"),
        *[
            _output(f"wheel_load_{n}_{side}", "N", f"Vertical wheel load, {place} wheelset, {side}", display_unit="kN")
            for n, place in WHEELSETS.items()
            for side in ("left", "right")
        ],
        _output("frame_lateral", "m", "Lateral displacement of the sprung mass"),
        _output("frame_roll", "rad", "Roll of the sprung mass", display_unit="deg"),
        _output("frame_yaw", "rad", "Yaw of the sprung mass", display_unit="deg"),
        _output("derailed", "1", "A wheel has lost its tread contact or run off it", kind="boolean"),
        *_pair(
            "flange_force", "N", "Lateral force of the rails on the flanges of the {} wheelset, positive to the left"
        ),
        *[
            _output(
                f"derailment_quotient_{n}_{side}",
                "1",
                f"Y/Q of the {side} wheel, {place} wheelset: its lateral force on the rail, outwards and with the "
                "flange's, over the vertical one",
            )
            for n, place in WHEELSETS.items()
            for side in ("left", "right")
        ],
    ]
    return {row.name: row for row in rows}


def initial_speed(start: float) -> Variable:
    """Parameter: speed at the start, with the wheels rolling freely."""
    return Variable(
        "initial_speed", "parameter", "m/s", "Speed at the start, wheels rolling", start, display_unit="km/h"
    )


#: Largest offsets at the start: tread contact is lost at 11.5 mm (section 9.4.1) [m]; and a yaw of 3 degrees [rad].
LARGEST_LATERAL, LARGEST_YAW = 0.010, 0.05


def initial_offsets() -> tuple[Variable, Variable]:
    """Parameters of the spatial level: where it starts beside the track's centre, with no speed but along it."""
    lateral = "Lateral displacement at the start, wheelsets and sprung mass; beyond flange_clearance a flange presses"
    return (
        Variable("initial_lateral", "parameter", "m", lateral, 0.0, -LARGEST_LATERAL, LARGEST_LATERAL),
        Variable(
            "initial_yaw", "parameter", "rad", "Yaw of the wheelsets at the start", 0.0, -LARGEST_YAW, LARGEST_YAW
        ),
    )

"""Variables of BrakingCurves.fmu: names of SUBSET-026, 3.13, where it has one; start values and limits."""

from __future__ import annotations

import math

from fmu_src.arrays_fmu import ArrayVariable
from products.supervision.train import FACTORS, LIMITS, MOST_STEPS
from products.supervision.values import RANGES, NationalValues

#: Speed of an unused boundary of steps [m/s], and largest speed of a train or line [m/s].
UNUSED, FASTEST = 200.0, 150.0
#: Largest place and distance [m]; speed of a train at rest [m/s]: 0.1 km/h.
FARTHEST, STANDSTILL = 1e6, 0.1 / 3.6
#: Distance of a limit that the train can keep at no distance [m].
AT_ANY_DISTANCE = 1e9
#: Numbers of `target_kind`.
KINDS = {"EOA": 1, "LOA": 2, "MRSP": 3}
_PLACES, _DECELERATIONS, _SWITCH = (-FARTHEST, FARTHEST), (1e-3, 9.99), (0, 1)
_FACTORS, _TIMES = FACTORS["Kdry_rst"][:2], LIMITS["T_brake_emergency"][:2]
_KINDS = "Kind of the target: " + "; ".join(f"{number} {name}" for name, number in KINDS.items())
#: Inputs: name, unit, meaning, start and limits. Limits that are integers belong to an integer.
INPUTS = (
    ("V_est", "m/s", "Speed of the train; a negative one is taken as 0", 0.0, -FASTEST, FASTEST),
    ("A_est", "m/s2", "Acceleration of the train, which counts until traction is off", 0.0, -20.0, 20.0),
    ("distance_to_target", "m", "From the train's front to the target", 1e4, *_PLACES),
    ("distance", "m", "Place of the front on the line of the FMU; unused without one", 0.0, *_PLACES),
    ("gradient", "1", "Gradient at all places, uphill positive; 0 with a line", 0.0, -0.255, 0.255),
    ("target_kind", "1", _KINDS, 1, 1, 3),
    ("V_target", "m/s", "Speed at the target; 0 at an EOA", 0.0, 0.0, FASTEST),
    ("V_MRSP", "m/s", "Permitted speed of the line at the train", FASTEST, 0.0, FASTEST),
    ("V_release", "m/s", "Release speed towards an EOA; 0: none", 0.0, 0.0, 100.0 / 3.6),
    ("beyond", "m", "Distance of the supervised location (SvL) behind the EOA", 0.0, 0.0, 1e5),
    ("reduced_adhesion", "1", "1: decelerations of the emergency brake are at most A_NVMAXREDADH", 0, *_SWITCH),
)
#: Step functions of speed, after the length.
STEPS = (
    ("A_brake_emergency", "m/s2", "Deceleration of the emergency brake on level track", 1.0, *_DECELERATIONS),
    ("A_brake_service", "m/s2", "Deceleration of the full service brake on level track", 0.8, *_DECELERATIONS),
    (
        "Kdry_rst",
        "1",
        "Factor of the emergency brake for the confidence level, dry rails",
        1.0,
        *FACTORS["Kdry_rst"][:2],
    ),
    ("Kwet_rst", "1", "Factor of the emergency brake for wet rails", 1.0, *_FACTORS),
)
_ADHESION = (NationalValues().reduced_adhesion[1], 0.0, RANGES["reduced_adhesion"])
_ROTATING = "Nominal rotating mass in per cent of the mass; below 0: 15 uphill, 2 downhill"
#: Parameters but the length and the step functions, as INPUTS.
PARAMETERS = (
    (
        "T_brake_emergency",
        "s",
        "Equivalent build-up time of the emergency brake",
        3.0,
        *LIMITS["T_brake_emergency"][:2],
    ),
    ("T_brake_service", "s", "Equivalent build-up time of the service brake", 3.0, *_TIMES),
    ("moving_target_factor", "1", "Factor of both times where V_target is above 0", 1.0, 1.0, 2.0),
    ("T_traction_cut_off", "s", "Time until traction is off", 0.0, *LIMITS["T_traction_cut_off"][:2]),
    ("traction_command", "1", "1: the on-board unit can cut off traction", 0, *_SWITCH),
    ("service_command", "1", "1: it can command the service brake", 0, *_SWITCH),
    ("M_rotating_nom", "1", _ROTATING, -1.0, -1.0, LIMITS["rotating"][1]),
    ("M_NVAVADH", "1", "Share of the loss on wet rails that does not count", 0.0, 0.0, 1.0),
    ("A_NVMAXREDADH", "m/s2", "Largest deceleration under reduced adhesion", *_ADHESION),
    ("Q_NVINHSMICPERM", "1", "1: the error of the speed does not count", 0, *_SWITCH),
    ("Q_NVEMRRLS", "1", "Release of the emergency brake: 0 at rest; 1 at the permitted speed", 0, *_SWITCH),
    ("baseline", "1", "Baseline: 3 for 3.3.0; 4 for 4.0.0, indication 4 s earlier", 3, 3, 4),
)
#: Limits, and commands.
LIMITS_OF_SPEED = {
    "I": "indication",
    "P": "permitted speed",
    "W": "warning",
    "SBI": "first intervention",
    "EBI": "emergency brake intervention",
    "EBD": "emergency brake deceleration",
}
COMMANDS = {
    "indication": "1: the target is indicated, or the permitted speed is exceeded",
    "warning": "1: warning, until the permitted speed is kept",
    "traction_cut_off": "1: traction is cut off",
    "service_brake": "1: full service brake, until the permitted speed is kept",
    "emergency_brake": "1: emergency brake, until the train is at rest",
}


def every() -> list[tuple[ArrayVariable, tuple[float, ...]]]:
    """Return variables and start values in the order of their numbers; V_P is the first output (curves_fmu.c)."""
    found = [_variable("input", *row) for row in INPUTS]
    found.append(_variable("parameter", "length", "m", "Length of the train", 200.0, *LIMITS["length"][:2]))
    for name, unit, text, start, least, most in STEPS:
        ends = f"Speed up to which each step of {name} holds, ascending; {UNUSED:g}: not used"
        found.append(_variable("parameter", name, unit, text, start, least, most, MOST_STEPS))
        found.append(_variable("parameter", f"{name}_speed", "m/s", ends, UNUSED, 0.0, UNUSED, MOST_STEPS - 1))
    found += [_variable("parameter", *row) for row in PARAMETERS]
    for name in ("P", "W", "SBI", "EBI"):
        text = f"Speed of the limit at the train's place: {LIMITS_OF_SPEED[name]}"
        found.append(_variable("output", f"V_{name}", "m/s", text))
    for name, limit in LIMITS_OF_SPEED.items():
        text = f"Distance before the target at which the limit has V_est: {limit}; 1e9: at any distance"
        found.append(_variable("output", f"distance_{name}", "m", text))
    return [*found, *(_variable("output", name, "1", text, 0, *_SWITCH) for name, text in COMMANDS.items())]


def _variable(
    causality: str,
    name: str,
    unit: str,
    text: str,
    start: float = 0.0,
    least: float = -math.inf,
    most: float = math.inf,
    count: int = 1,
) -> tuple[ArrayVariable, tuple[float, ...]]:
    variable = ArrayVariable(name, causality, unit, text, least, most, isinstance(most, int))
    return variable, (float(start),) * count

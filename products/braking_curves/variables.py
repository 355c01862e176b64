"""Variables of BrakingCurves.fmu: names of SUBSET-026, 3.13, where it has one; lengths, start values and limits."""

from __future__ import annotations

import math
from dataclasses import dataclass

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


@dataclass(frozen=True)
class Entry:
    """A variable, and the start values of its elements; outputs start with 0."""

    variable: ArrayVariable
    starts: tuple[float, ...] = (0.0,)


def _real(
    causality: str,
    name: str,
    unit: str,
    text: str,
    start: float = 0.0,
    least: float = -math.inf,
    most: float = math.inf,
) -> Entry:
    return Entry(ArrayVariable(name, causality, unit, text, least, most), (start,))


def _whole(causality: str, name: str, text: str, least: int, most: int, start: int = 0) -> Entry:
    return Entry(ArrayVariable(name, causality, "1", text, least, most, True), (float(start),))


def _steps(name: str, unit: str, text: str, start: float, least: float, most: float) -> list[Entry]:
    """Return a step function of speed: its values, and the speeds up to which all but the last one hold."""
    ends = f"Speed up to which each step of {name} holds, ascending; {UNUSED:g}: not used"
    boundaries = ArrayVariable(f"{name}_speed", "parameter", "m/s", ends, 0.0, UNUSED)
    values = ArrayVariable(name, "parameter", unit, text, least, most)
    return [Entry(values, (start,) * MOST_STEPS), Entry(boundaries, (UNUSED,) * (MOST_STEPS - 1))]


def inputs() -> list[Entry]:
    """Return the inputs."""
    reach = (-FARTHEST, FARTHEST)
    kinds = "Kind of the target: " + "; ".join(f"{number} {name}" for name, number in KINDS.items())
    return [
        _real("input", "V_est", "m/s", "Speed of the train; a negative one is taken as 0", 0.0, -FASTEST, FASTEST),
        _real(
            "input", "A_est", "m/s2", "Acceleration of the train, which counts until traction is off", 0.0, -20.0, 20.0
        ),
        _real("input", "distance_to_target", "m", "From the train's front to the target", 1e4, *reach),
        _real("input", "distance", "m", "Place of the front on the line of the FMU; unused without one", 0.0, *reach),
        _real("input", "gradient", "1", "Gradient at all places, uphill positive; 0 with a line", 0.0, -0.255, 0.255),
        _whole("input", "target_kind", kinds, 1, 3, 1),
        _real("input", "V_target", "m/s", "Speed at the target; 0 at an EOA", 0.0, 0.0, FASTEST),
        _real("input", "V_MRSP", "m/s", "Permitted speed of the line at the train", FASTEST, 0.0, FASTEST),
        _real("input", "V_release", "m/s", "Release speed towards an EOA; 0: none", 0.0, 0.0, 100.0 / 3.6),
        _real("input", "beyond", "m", "Distance of the supervised location (SvL) behind the EOA", 0.0, 0.0, 1e5),
        _whole("input", "reduced_adhesion", "1: decelerations of the emergency brake are at most A_NVMAXREDADH", 0, 1),
    ]


def parameters() -> list[Entry]:
    """Return the parameters: train data, national values and the baseline."""

    def limited(name: str, own: str, text: str, start: float) -> Entry:
        least, most, unit = LIMITS[own]
        return _real("parameter", name, unit, text, start, least, most)

    values = NationalValues()
    rotating = LIMITS["rotating"][1]
    return [
        limited("length", "length", "Length of the train", 200.0),
        *_steps("A_brake_emergency", "m/s2", "Deceleration of the emergency brake on level track", 1.0, 1e-3, 9.99),
        *_steps("A_brake_service", "m/s2", "Deceleration of the full service brake on level track", 0.8, 1e-3, 9.99),
        *_steps(
            "Kdry_rst",
            "1",
            "Factor of the emergency brake for the confidence level, dry rails",
            1.0,
            *FACTORS["Kdry_rst"][:2],
        ),
        *_steps("Kwet_rst", "1", "Factor of the emergency brake for wet rails", 1.0, *FACTORS["Kwet_rst"][:2]),
        limited("T_brake_emergency", "T_brake_emergency", "Equivalent build-up time of the emergency brake", 3.0),
        limited("T_brake_service", "T_brake_service", "Equivalent build-up time of the service brake", 3.0),
        _real(
            "parameter", "moving_target_factor", "1", "Factor of both times where V_target is above 0", 1.0, 1.0, 2.0
        ),
        limited("T_traction_cut_off", "T_traction_cut_off", "Time until traction is off", 0.0),
        _whole("parameter", "traction_command", "1: the on-board unit can cut off traction", 0, 1),
        _whole("parameter", "service_command", "1: it can command the service brake", 0, 1),
        _real(
            *("parameter", "M_rotating_nom", "1"),
            "Nominal rotating mass in per cent of the mass; below 0: 15 uphill, 2 downhill",
            *(-1.0, -1.0, rotating),
        ),
        _real("parameter", "M_NVAVADH", "1", "Share of the loss on wet rails that does not count", 0.0, 0.0, 1.0),
        _real(
            *("parameter", "A_NVMAXREDADH", "m/s2", "Largest deceleration under reduced adhesion"),
            *(values.reduced_adhesion[1], 0.0, RANGES["reduced_adhesion"]),
        ),
        _whole("parameter", "Q_NVINHSMICPERM", "1: the error of the speed does not count", 0, 1),
        _whole("parameter", "Q_NVEMRRLS", "Release of the emergency brake: 0 at rest; 1 at the permitted speed", 0, 1),
        _whole("parameter", "baseline", "Baseline: 3 for 3.3.0; 4 for 4.0.0, indication 4 s earlier", 3, 4, 3),
    ]


def outputs() -> list[Entry]:
    """Return the outputs, speeds first."""
    speed = "Speed of the limit at the train's place: {}"
    before = "Distance before the target at which the limit has V_est: {}"
    names = {
        "I": "indication",
        "P": "permitted speed",
        "W": "warning",
        "SBI": "first intervention",
        "EBI": "emergency brake intervention",
        "EBD": "emergency brake deceleration",
    }
    commands = {
        "indication": "1: the target is indicated, or the permitted speed is exceeded",
        "warning": "1: warning, until the permitted speed is kept",
        "traction_cut_off": "1: traction is cut off",
        "service_brake": "1: full service brake, until the permitted speed is kept",
        "emergency_brake": "1: emergency brake, until the train is at rest",
    }
    return [
        *(_real("output", f"V_{name}", "m/s", speed.format(names[name])) for name in ("P", "W", "SBI", "EBI")),
        *(
            _real("output", f"distance_{name}", "m", f"{before.format(text)}; 1e9: at any distance")
            for name, text in names.items()
        ),
        *(_whole("output", name, text, 0, 1) for name, text in commands.items()),
    ]


def every() -> list[Entry]:
    """Return all variables in the order of their numbers; V_P is the first output (curves_fmu.c)."""
    return [*inputs(), *parameters(), *outputs()]

"""Where the FMUs connect to each other and to others: their terminals, found by the names of the variables."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from fmu_src.arrays_fmu import ArrayVariable
from fmu_src.system import Variable
from fmu_src.terminals import Terminal


@dataclass(frozen=True)
class Kind:
    """A kind of terminal: what it is; members with their variables, {} for the place, of signals and of flows."""

    name: str
    description: str
    signals: Mapping[str, str]
    flows: Mapping[str, str] = field(default_factory=dict)


COUPLED = "Forward force on the vehicle at a coupler, which with that on the vehicle beyond adds up to 0, and its speed"
KINDS = (
    Kind(
        "brake",
        "Brake of a wheelset: the torque that it can resist with, and how fast the wheelset turns",
        {"torque": "brake_torque{}", "angular_velocity": "angular_velocity{}"},
    ),
    Kind(
        "drive",
        "Drive of a wheelset: the torque that turns it, and how fast it turns",
        {"torque": "traction_torque{}", "angular_velocity": "angular_velocity{}"},
    ),
    Kind(
        "protection",
        "Wheel-slide protection of a wheelset: speed of its wheels, and the valve of its cylinder",
        {"wheel_speed": "wheel_speed{}", "valve": "valve{}"},
    ),
    Kind(
        "rail",
        "Rail under a wheelset: what wears its dirt off, and its friction",
        {"speed": "speed", "slip": "slip{}", "creep_force": "creep_force{}", "friction": "friction{}"},
    ),
    Kind("drawbar", COUPLED, {"speed": "speed"}, {"force": "drawbar_force{}"}),
    Kind("coupler", COUPLED, {"speed": "speed"}, {"force": "coupler_force{}"}),
)
PLACES = ("", "_1", "_2", "_3", "_4", "_front", "_rear")


def terminals_of(variables: Iterable[Variable | ArrayVariable]) -> list[Terminal]:
    """Those kinds at those places whose members are all there, some as inputs and some as outputs."""
    causality = {variable.name: variable.causality for variable in variables}
    found = []
    for kind in KINDS:
        for place in PLACES:
            signals, flows = (
                {member: variable.format(place) for member, variable in members.items()}
                for members in (kind.signals, kind.flows)
            )
            if {causality.get(variable) for variable in (signals | flows).values()} == {"input", "output"}:
                found.append(Terminal(f"{kind.name}{place}", kind.name, kind.description, signals, flows))
    return found

"""Inputs and outputs of a vehicle, the same at every level of detail. Wheelset 1 is the leading one."""

import math
from dataclasses import dataclass
from itertools import product

from fmu_src.system import Variable
from rbd_model.contact.pair_table import LARGEST_SHIFT
from rbd_model.track.line_table import LINE
from rbd_model.vehicle.description import RigidBody, Vehicle

#: Names of wheelsets in descriptions, by the number of wheelsets.
WORDS = {1: ("leading",), 2: ("leading", "trailing"), 3: ("leading", "middle", "trailing")}
#: Largest friction for which the contact laws are meaningful; dry steel on steel stays below 0.8.
HIGHEST_FRICTION = 2.0


@dataclass(frozen=True)
class OfContact:
    """A quantity of the contacts of a tread or flange; weighted: their mean by normal force, otherwise their sum."""

    name: str
    unit: str
    text: str
    weighted: bool


#: Quantities of each tread and flange of a vehicle with `contact_outputs`. Aside is to the left, tangential to
#: the contact. Creepages are those of the wheel against the rail.
OF_CONTACT = (
    OfContact("creepage_along", "1", "Longitudinal creepage", True),
    OfContact("creepage_aside", "1", "Lateral creepage, positive if the wheel slides to the left", True),
    OfContact("creepage_spin", "1/m", "Spin creepage", True),
    OfContact("creep_force_along", "N", "Longitudinal creep force on the wheel", False),
    OfContact("creep_force_aside", "N", "Lateral creep force on the wheel, positive to the left", False),
    OfContact("normal_force", "N", "Normal force", False),
    OfContact("contact_position", "m", "Place of the contact on the wheel's profile, positive to the field side", True),
    OfContact("rail_position", "m", "Place of the contact on the rail's profile, positive to the field side", True),
    OfContact("contact_angle", "rad", "Angle of the contact to the track, positive if it pushes inwards", True),
    OfContact("contact_area", "m2", "Area of the contact by Hertz", False),
    OfContact("wear_number", "N", "T-gamma: creep forces times creepages, energy for each metre, without spin", False),
)


def _input(name: str, unit: str, description: str, start: float = 0.0, minimum: float = -math.inf) -> Variable:
    maximum = HIGHEST_FRICTION if name.startswith("friction") else math.inf
    return Variable(name, "input", unit, description, start, minimum, maximum)


def words(vehicle: Vehicle) -> dict[int, str]:
    """Return the name of each wheelset in descriptions, by its number."""
    count = len(vehicle.wheelsets)
    return dict(enumerate(WORDS.get(count, tuple(f"{number}." for number in range(1, count + 1))), 1))


def inputs(vehicle: Vehicle) -> dict[str, Variable]:
    """Return all inputs by name."""
    wheelsets, rows = words(vehicle), []
    for number, place in wheelsets.items():
        rows.append(
            _input(
                f"brake_torque_{number}",
                "N.m",
                f"Largest torque that the brake of the {place} wheelset can resist with (a capacity; its sign and the "
                "locked state are found inside)",
                minimum=0.0,
            )
        )
    for number, place in wheelsets.items():
        rows.append(_input(f"traction_torque_{number}", "N.m", f"Torque that drives the {place} wheelset forward"))
    for number, place in wheelsets.items():
        text = f"Yaw torque on the {place} wheelset, about the axis upright on its axle, which rolls with it"
        rows.append(_input(f"yaw_torque_{number}", "N.m", text))
    rows += [_input(pull.name, "N", pull.text) for pull in vehicle.pulls]
    rows += line_inputs()
    for number, place in wheelsets.items():
        text = f"Wheel-rail friction coefficient under the {place} wheelset"
        rows.append(_input(f"friction_{number}", "1", text, start=0.3, minimum=0.0))
    return {row.name: row for row in rows}


def line_inputs() -> list[Variable]:
    """Return inputs for a line that the host computes. A line's file replaces them.

    The spatial level has none of them.
    """
    rise = "Rise of the line for each metre along it (sine of its slope), at levels 1 and 2 without line_file"
    curve = "Curvature of the line for curve_resistance, at levels 1 and 2 without line_file"
    texts = {"gradient": rise, "curvature": curve}
    columns = [LINE.column(name) for name in texts]
    return [Variable(c.name, "input", c.unit, texts[c.name], 0.0, c.minimum, c.maximum) for c in columns]


def _output(name: str, unit: str, description: str, **more: str) -> Variable:
    return Variable(name, "output", unit, description, **more)  # type: ignore[arg-type]


def _in_plane(body: RigidBody) -> list[Variable]:
    return [
        _output(body.variable("bounce"), "m", f"Vertical displacement of the {body.text} from rest, upwards"),
        _output(body.variable("pitch"), "rad", f"Pitch of the {body.text}, positive nose down", display_unit="deg"),
    ]


def _out_of_plane(body: RigidBody) -> list[Variable]:
    return [
        _output(body.variable("lateral"), "m", f"Lateral displacement of the {body.text}"),
        _output(body.variable("roll"), "rad", f"Roll of the {body.text}", display_unit="deg"),
        _output(body.variable("yaw"), "rad", f"Yaw of the {body.text}", display_unit="deg"),
    ]


def outputs(vehicle: Vehicle) -> dict[str, Variable]:
    """Return all outputs by name. Those of the second group are 0 below the spatial level.

    A new one is a row here, and an expression at each level that has it: `CONTRIBUTING.md`.
    """
    wheelsets = words(vehicle)
    whole = "vehicle" if len(vehicle.bodies) > 1 else "bogie"

    def each(name: str, unit: str, description: str, **more: str) -> list[Variable]:
        return [_output(f"{name}_{n}", unit, description.format(place), **more) for n, place in wheelsets.items()]

    def each_wheel(name: str, unit: str, description: str, **more: str) -> list[Variable]:
        wheels = product(wheelsets.items(), ("left", "right"))
        return [
            _output(f"{name}_{n}_{side}", unit, description.format(place=place, side=side), **more)
            for (n, place), side in wheels
        ]

    rows = [
        _output("speed", "m/s", f"Forward speed of the {whole} at its axles", display_unit="km/h"),
        _output("distance", "m", "Distance travelled"),
        _output("acceleration", "m/s2", f"Forward acceleration of the {whole} at its axles"),
        *each("angular_velocity", "rad/s", "Angular velocity of the {} wheelset, positive when rolling forward"),
        *each("rotation", "rad", "Rotation of the {} wheelset"),
        *each("slip", "m/s", "Speed minus nominal wheel radius times angular velocity, {} wheelset"),
        *each("slip_ratio", "1", "Slip over speed, {} wheelset: 0 rolling, 1 locked"),
        *each("creep_force", "N", "Longitudinal creep force of the rails on the {} wheelset, positive forward"),
        *each("axle_load", "N", "Vertical force of the rails on the {} wheelset", display_unit="kN"),
        *each(
            "locked",
            "1",
            "The {} wheelset is locked: its brake holds it while its axle moves; false at rest",
            kind="boolean",
        ),
        *[row for body in vehicle.bodies for row in _in_plane(body)],
        *each("lateral", "m", "Lateral displacement of the {} wheelset from the track centre, to the left"),
        *each("yaw", "rad", "Yaw of the {} wheelset", display_unit="deg"),
        *each_wheel("wheel_load", "N", "Vertical wheel load, {place} wheelset, {side}", display_unit="kN"),
        *[row for body in vehicle.bodies for row in _out_of_plane(body)],
        _output("derailed", "1", "A wheel has lost its tread contact or run off it", kind="boolean"),
        *each(
            "flange_force", "N", "Lateral force of the rails on the flanges of the {} wheelset, positive to the left"
        ),
        *each_wheel(
            "derailment_quotient",
            "1",
            "Y/Q of the {side} wheel, {place} wheelset: its lateral force on the rail, outwards and with the flange's, "
            "over the vertical one",
        ),
        *each_wheel(
            "lateral_force", "N", "Y of the {side} wheel, {place} wheelset: its lateral force on the rail, outwards"
        ),
        *each_wheel(
            "wheel_rise",
            "m",
            "How much higher over its rail the {side} wheel of the {place} wheelset stands than on its tread at rest: "
            "climbed or lifted",
        ),
        *each("guiding_force", "N", "Sum of the lateral forces of both rails on the {} wheelset, positive to the left"),
    ]
    if vehicle.contact_outputs:
        for one, place in product(OF_CONTACT, ("tread", "flange")):
            text = f"{one.text}: {place} of the {{side}} wheel, {{place}} wheelset; level 3, contact_model 2"
            rows += each_wheel(f"{one.name}_{place}", one.unit, text)
        text = "T-gamma of the {side} wheel, {place} wheelset: sum of tread and flange; level 3, contact_model 2"
        rows += each_wheel("wear_number", "N", text)
    return {row.name: row for row in rows}


#: Largest speed at the start, forwards or backwards [m/s]. The record on rails is 574.8 km/h, 159.7 m/s (SNCF, 3 April
#: 2007). A larger value here is a speed in km/h.
FASTEST = 150.0


def initial_speed(start: float) -> Variable:
    """Return the parameter for the speed at the start, with the wheels rolling freely."""
    text = "Speed at the start, wheels rolling"
    return Variable("initial_speed", "parameter", "m/s", text, start, -FASTEST, FASTEST, display_unit="km/h")


def drive_inertia() -> Variable:
    """Return the parameter for the rotating mass of a drive."""
    text = "Moment of inertia of a drive that turns with each wheelset, brought to its axle"
    return Variable("drive_inertia", "parameter", "kg.m2", text, 0.0, 0.0)


#: Largest offsets at the start: tread contact is lost at 11.5 mm (section 9.4.1) [m]; and a yaw of 3 degrees [rad].
LARGEST_LATERAL, LARGEST_YAW = LARGEST_SHIFT, 0.05


def initial_offsets() -> tuple[Variable, Variable]:
    """Return the parameters of the spatial level for the lateral position and yaw at the start, without lateral
    speed.
    """
    lateral = "Lateral displacement at the start, wheelsets and sprung mass; beyond flange_clearance a flange presses"
    return (
        Variable("initial_lateral", "parameter", "m", lateral, 0.0, -LARGEST_LATERAL, LARGEST_LATERAL),
        Variable(
            "initial_yaw", "parameter", "rad", "Yaw of the wheelsets at the start", 0.0, -LARGEST_YAW, LARGEST_YAW
        ),
    )

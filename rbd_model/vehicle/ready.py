"""The built-in vehicles as descriptions; their numbers are in `parameters.py`, with table or source."""

from rbd_model.contact.geometry import Pair, synthetic_pair, thesis_pair
from rbd_model.vehicle.description import (
    DIRECTIONS,
    BumpStop,
    Pull,
    RigidBody,
    Size,
    Springs,
    Sum,
    SuspensionElement,
    Torsion,
    Vehicle,
    Wheelset,
    wheelset_name,
)
from rbd_model.vehicle.parameters import (
    BogieParameters,
    VehicleParameters,
    coach_with_traction_rods,
    coal_wagon,
    tables_4_1_and_4_2,
    tables_5_1_and_5_2,
)

HALF_BASE = Sum((("wheel_base", 0.5),))


def sprung_mass(name: str, text: str, along: Size = 0.0, **more: object) -> RigidBody:
    """Return a frame on axle boxes, section 5.2: the mass and inertias of `frame_...`, at frame_height."""
    inertia = ("frame_roll_inertia", "frame_pitch_inertia", "frame_yaw_inertia")
    return RigidBody(name, text, "frame_mass", inertia, along, "frame_height", **more)  # type: ignore[arg-type]


def axle_box_springs(frame: str, number: int, along: Size) -> tuple[SuspensionElement, ...]:
    """Return the elements of one wheelset, left and right, section 3.3.4: level ones and, at its place, vertical ones.

    The vertical springs, which resist roll, may be further apart than the level ones, which resist yaw.
    """
    ends, across = (frame, wheelset_name(number)), ("longitudinal_half_spacing", "vertical_half_spacing")
    stiffness = "longitudinal_stiffness", "lateral_stiffness", "vertical_stiffness"
    damping = "longitudinal_damping", "lateral_damping", "vertical_damping"
    level = Springs(
        f"guidance_{number}", *ends, (along, across[0], 0.0), True, (*stiffness[:2], 0.0), (*damping[:2], 0.0)
    )
    upright = (0.0, 0.0, stiffness[2]), (0.0, 0.0, damping[2])
    return level, Springs(f"primary_{number}", *ends, (along, across[1], 0.0), True, *upright)


DRAWBAR = Pull("drawbar_force", "Forward force on the sprung mass, at its centre", "frame", (0.0, 0.0, "frame_height"))


def two_axle_bogie(parameters: BogieParameters | None = None) -> Vehicle:
    """Return the simplified bogie of section 5.2, Fig. 5.1: one sprung mass on two wheelsets.

    The default parameters are those of chapter 5.
    """
    places = {1: HALF_BASE, 2: -HALF_BASE}
    return Vehicle(
        "BogieDynamics",
        parameters or tables_5_1_and_5_2(),
        (sprung_mass("frame", "sprung mass", plain=("bounce", "pitch")),),
        tuple(Wheelset(along, "frame") for along in places.values()),
        tuple(
            axle_box_spring
            for number, along in places.items()
            for axle_box_spring in axle_box_springs("frame", number, along)
        ),
        (DRAWBAR,),
    )


def wheelset_under_frame(parameters: BogieParameters | None = None) -> Vehicle:
    """Return the wheelset under a frame of section 4.2, Fig. 4.1, whose pitch is held."""
    return Vehicle(
        "WheelsetDynamics",
        parameters or tables_4_1_and_4_2(),
        (sprung_mass("frame", "sprung mass", plain=("bounce", "pitch"), held=frozenset({"pitch"})),),
        (Wheelset(0.0, "frame"),),
        axle_box_springs("frame", 1, 0.0),
        (DRAWBAR,),
    )


#: Lateral bump stop of the Manchester vehicles, one for each bogie: travel [m], force [N]; Iwnicki (1998).
MANCHESTER_TRAVEL = (0.025, 0.030, 0.035, 0.040, 0.045, 0.050, 0.055, 0.060, 0.065)
MANCHESTER_FORCE = (0.0, 600.0, 1760.0, 3730.0, 6870.0, 11580.0, 17170.0, 29200.0, 230000.0)


def secondary(bogie: str, along: Size) -> tuple[SuspensionElement, ...]:
    """Return connections of body and one bogie's frame: springs, their bending, an anti-roll bar (Iwnicki (1998)).

    In the middle is a traction rod between rubber bushes: a spring and a damper along the track without static load.
    """
    frame, place = f"{bogie}_frame", (along, "secondary_half_spacing", "secondary_height")
    stiffness = tuple(f"secondary_{direction}_stiffness" for direction in DIRECTIONS)
    damping = tuple(f"secondary_{direction}_damping" for direction in DIRECTIONS)
    both = Sum((("secondary_bending_stiffness", 2.0),))
    ends = "body", frame, place
    rod = ("traction_rod_stiffness", 0.0, 0.0), ("traction_rod_damping", 0.0, 0.0)
    return (
        Springs(f"{bogie}_secondary", *ends, True, stiffness, damping),  # type: ignore[arg-type]
        Torsion(f"{bogie}_anti_roll_bar", *ends, False, "roll", both + "anti_roll_stiffness"),
        Torsion(f"{bogie}_bending", *ends, False, "pitch", both),
        Springs(f"{bogie}_traction_rod", "body", frame, (along, 0.0, "secondary_height"), False, *rod),
    )


def four_axle_vehicle(name: str, parameters: VehicleParameters, pair: Pair, stops: bool) -> Vehicle:
    """Return a car body on two bogies, wheelset 1 leading; stops: with the lateral bump stops of Iwnicki (1998)."""
    return _on_two_bogies(name, parameters, pair, stops, (HALF_BASE, -HALF_BASE))


def six_axle_vehicle(name: str, parameters: VehicleParameters, pair: Pair, stops: bool) -> Vehicle:
    """Return a car body on two bogies of three wheelsets each, wheel_base apart.

    Springs and stops are those of `four_axle_vehicle`, Iwnicki (1998).
    """
    base = Sum((("wheel_base", 1.0),))
    return _on_two_bogies(name, parameters, pair, stops, (base, Sum(()), -base))


def _on_two_bogies(
    name: str, parameters: VehicleParameters, pair: Pair, stops: bool, axles: tuple[Sum, ...]
) -> Vehicle:
    """Return a car body on two bogies; axles: places of the wheelsets of a bogie ahead of its middle [m]."""
    pivots = {"front": Sum((("pivot_distance", 0.5),)), "rear": Sum((("pivot_distance", -0.5),))}
    inertia = ("body_roll_inertia", "body_pitch_inertia", "body_yaw_inertia")
    bodies = [RigidBody("body", "car body", "body_mass", inertia, 0.0, "body_height")]
    wheelsets: list[Wheelset] = []
    connections: list[SuspensionElement] = []
    for bogie, pivot in pivots.items():
        frame = f"{bogie}_frame"
        bodies.append(sprung_mass(frame, f"{bogie} frame", pivot))
        connections += secondary(bogie, pivot)
        if stops:
            place = (pivot, 0.0, "secondary_height")
            travel = MANCHESTER_TRAVEL, MANCHESTER_FORCE
            connections.append(BumpStop(f"{bogie}_bump_stop", "body", frame, place, False, "lateral", *travel))
        for along in (pivot + axle for axle in axles):
            wheelsets.append(Wheelset(along, frame, pair=pair))
            connections += axle_box_springs(frame, len(wheelsets), along)
    ends = {"front": 0.5, "rear": -0.5}
    pulls = [
        Pull(
            f"coupler_force_{end}",
            f"Forward force on the {end} coupler",
            "body",
            (Sum((("coupler_distance", share),)), 0.0, "coupler_height"),
        )
        for end, share in ends.items()
    ]
    return Vehicle(name, parameters, tuple(bodies), tuple(wheelsets), tuple(connections), tuple(pulls))


def passenger_coach(parameters: VehicleParameters | None = None) -> Vehicle:
    """Return vehicle 1 of the Manchester benchmarks, Iwnicki (1998), on synthetic profiles.

    The default parameters include traction rods.
    """
    return four_axle_vehicle("VehicleDynamics", parameters or coach_with_traction_rods(), synthetic_pair(), stops=True)


def loaded_coal_wagon() -> Vehicle:
    """Return two bogies of chapter 5 under a body, chapter 10; values that the thesis does not give are assumed."""
    return four_axle_vehicle("CoalWagonDynamics", coal_wagon(), thesis_pair(), stops=False)

"""Parameter sets of the bogie, one function for each pair of tables in the thesis.

Every field has its unit, the thesis's symbol and a lower limit. The docstring of each set lists the reported values,
the fitted values and the assumptions.
"""

from dataclasses import dataclass, fields, replace

from fmu_src.system import ParameterSet, quantity
from rbd_model.vehicle.description import LARGEST_RADIUS, LONGEST_VEHICLE

#: Smallest value of quantities that must be above zero. It is far below any bogie's and far above round-off.
POSITIVE = 1e-6
#: Smallest masses [kg]: below those of models at a scale of 1:5, which have 1/125 of the mass, and above the numbers of
#: masses in t. A sprung mass is that of one body on two axles.
LEAST_BODY, LEAST_SPRUNG, LEAST_FRAME, LEAST_WHEELSET = 100.0, 100.0, 10.0, 5.0
#: Mass and inertia of a sprung mass that stands for the ground in checks of theory [kg, kg.m2].
ANCHORED = 1e11
#: Largest half lateral distance [m]: half of a vehicle's width on the widest gauges, rounded up.
WIDEST = 3.0
#: Largest height over or below the axles [m], and largest factor on friction.
HIGHEST, MOST_FRICTION = 10.0, 10.0
#: The thesis's reading of the points of action: its torques act on the wheelsets alone (3.36), its flange's force at
#: the wheelset's centre (3.106). Scenarios that compare with it use these values instead of the physical ones.
AS_PRINTED = {"torque_reaction": 0.0, "flange_at_rail": 0.0}


@dataclass(frozen=True)
class BogieParameters(ParameterSet):
    """A two-axle bogie with one sprung mass; stiffness and damping of one of its four suspension elements."""

    frame_mass: float = quantity("kg", "Sprung mass carried by the two wheelsets", LEAST_SPRUNG, ANCHORED)
    frame_roll_inertia: float = quantity("kg.m2", "Sprung mass, moment of inertia about x (I_xx)", POSITIVE, ANCHORED)
    frame_pitch_inertia: float = quantity("kg.m2", "Sprung mass, moment of inertia about y (I_yy)", POSITIVE, ANCHORED)
    frame_yaw_inertia: float = quantity("kg.m2", "Sprung mass, moment of inertia about z (I_zz)", POSITIVE, ANCHORED)
    frame_height: float = quantity("m", "Height of the sprung mass's centre above the wheelset axes", -HIGHEST, HIGHEST)
    wheelset_mass: float = quantity("kg", "Mass of one wheelset", LEAST_WHEELSET)
    wheelset_roll_inertia: float = quantity("kg.m2", "Wheelset, moment of inertia about x (I_xx)", POSITIVE)
    wheelset_pitch_inertia: float = quantity("kg.m2", "Wheelset, moment of inertia about its axle (I_yy, J)", POSITIVE)
    wheelset_yaw_inertia: float = quantity("kg.m2", "Wheelset, moment of inertia about z (I_zz)", POSITIVE)
    wheel_base: float = quantity("m", "Distance between the two axles", POSITIVE, LONGEST_VEHICLE)
    longitudinal_half_spacing: float = quantity(
        "m", "Half of the lateral distance of the longitudinal and lateral springs, which resist yaw", POSITIVE, WIDEST
    )
    vertical_half_spacing: float = quantity(
        "m", "Half of the lateral distance of the vertical springs, which resist roll", POSITIVE, WIDEST
    )
    wheel_radius: float = quantity("m", "Nominal rolling radius of the wheels (r_w)", POSITIVE, LARGEST_RADIUS)
    longitudinal_stiffness: float = quantity("N/m", "Suspension element, longitudinal stiffness", POSITIVE)
    lateral_stiffness: float = quantity("N/m", "Suspension element, lateral stiffness", POSITIVE)
    vertical_stiffness: float = quantity("N/m", "Suspension element, vertical stiffness", POSITIVE)
    longitudinal_damping: float = quantity("N.s/m", "Suspension element, longitudinal damping", 0.0)
    lateral_damping: float = quantity("N.s/m", "Suspension element, lateral damping", 0.0)
    vertical_damping: float = quantity("N.s/m", "Suspension element, vertical damping", 0.0)
    rolling_resistance_torque: float = quantity("N.m", "Rolling resistance of one wheelset, a friction torque", 0.0)
    torque_reaction: float = quantity(
        "1",
        "Share of brake and traction torque that reacts on the sprung mass, which brakes and motors hang in",
        0.0,
        1.0,
    )
    flange_clearance: float = quantity("m", "Lateral displacement at which a flange touches (y_f)", POSITIVE, 0.1)
    flange_stiffness: float = quantity("N/m", "Lateral stiffness of the rail against a flange (k_y_rail)", 0.0)
    flange_at_rail: float = quantity(
        "1", "A flange is pushed where it touches the rail (1), or at the wheelset's centre (0)", 0.0, 1.0, "integer"
    )
    yaw_torque_rotates: float = quantity(
        "1",
        "Yaw torque about the axis upright on the axle (0), or about one that turns with the wheelset's rotation (1)",
        0.0,
        1.0,
        "integer",
    )
    constant_speed: float = quantity("1", "Sprung mass held at its initial speed (1), or free (0)", 0.0, 1.0, "integer")
    wheel_lift_ends: float = quantity(
        "1",
        "A wheel that carries nothing ends the run (1), or is held down as the thesis's constraint does (0)",
        0.0,
        1.0,
        "integer",
    )
    running_safety_warnings: float = quantity(
        "1", "Warn where limits of EN 14363 on Y/Q and guiding forces are passed (1), or not (0)", 0.0, 1.0, "integer"
    )
    wheel_profile_curvature: float = quantity("1/m", "Curvature of the wheel tread across the track (1/rho_y^w)")
    rail_head_radius: float = quantity("m", "Radius of the rail head across the track (rho_y^r)", POSITIVE, 1e3)
    shear_modulus: float = quantity("Pa", "Shear modulus of wheel and rail (G)", 1e9, 1e12)
    left_rail_friction: float = quantity("1", "Factor on the friction of the left rail, in space", 0.0, MOST_FRICTION)
    right_rail_friction: float = quantity("1", "Factor on the friction of the right rail, in space", 0.0, MOST_FRICTION)
    gauge_face_friction: float = quantity(
        "1",
        "Factor on the friction of the rails' gauge faces (contact model 1: in Nadal's limit alone), in space",
        0.0,
        MOST_FRICTION,
    )
    contact_damping: float = quantity(
        "s/m", "Damping of an elastic contact, share of its force by the speed at which it is pressed", 0.0
    )
    creepage_speed: float = quantity("m/s", "Speed that keeps the creepage finite at rest (v_eps)", 1e-4)
    gravity: float = quantity("m/s2", "Gravitational acceleration (g)", POSITIVE)


@dataclass(frozen=True)
class VehicleParameters(BogieParameters):
    """A car body on two bogies. The sprung mass of `BogieParameters` is the frame of one bogie.

    Heights are above the wheelset axes. Secondary stiffness and damping are those of one side of one bogie. A traction
    rod joins the body to the middle of a frame, at the height of the secondary springs.
    """

    frame_mass: float = quantity("kg", "Sprung mass carried by the two wheelsets", LEAST_FRAME)
    body_mass: float = quantity("kg", "Car body, mass", LEAST_BODY)
    body_roll_inertia: float = quantity("kg.m2", "Car body, moment of inertia about x (I_xx)", POSITIVE)
    body_pitch_inertia: float = quantity("kg.m2", "Car body, moment of inertia about y (I_yy)", POSITIVE)
    body_yaw_inertia: float = quantity("kg.m2", "Car body, moment of inertia about z (I_zz)", POSITIVE)
    body_height: float = quantity("m", "Height of the car body's centre above the wheelset axes", -HIGHEST, HIGHEST)
    pivot_distance: float = quantity("m", "Distance between the two bogies' centres", POSITIVE, LONGEST_VEHICLE)
    secondary_half_spacing: float = quantity(
        "m", "Half of the lateral distance of the secondary springs", POSITIVE, WIDEST
    )
    secondary_height: float = quantity(
        "m", "Height of the secondary springs above the wheelset axes", -HIGHEST, HIGHEST
    )
    secondary_longitudinal_stiffness: float = quantity("N/m", "Secondary suspension, longitudinal stiffness", POSITIVE)
    secondary_lateral_stiffness: float = quantity("N/m", "Secondary suspension, lateral stiffness", POSITIVE)
    secondary_vertical_stiffness: float = quantity("N/m", "Secondary suspension, vertical stiffness", POSITIVE)
    secondary_longitudinal_damping: float = quantity("N.s/m", "Secondary suspension, longitudinal damping", 0.0)
    secondary_lateral_damping: float = quantity("N.s/m", "Secondary suspension, lateral damping", 0.0)
    secondary_vertical_damping: float = quantity("N.s/m", "Secondary suspension, vertical damping", 0.0)
    secondary_bending_stiffness: float = quantity(
        "N.m/rad", "Secondary suspension, stiffness against roll and pitch of one spring's ends", 0.0
    )
    anti_roll_stiffness: float = quantity("N.m/rad", "Anti-roll bar of one bogie", 0.0)
    coupler_distance: float = quantity("m", "Distance between the couplers of both ends", POSITIVE, LONGEST_VEHICLE)
    coupler_height: float = quantity("m", "Height of the couplers above the wheelset axes", -HIGHEST, HIGHEST)
    traction_rod_stiffness: float = quantity("N/m", "Traction rod of one bogie, stiffness along the track", 0.0)
    traction_rod_damping: float = quantity("N.s/m", "Traction rod of one bogie, damping along the track", 0.0)


def as_printed(parameters: BogieParameters) -> BogieParameters:
    """Return the same bogie with the thesis's points of action: AS_PRINTED.

    Torques act on the wheelsets alone (section 9.2), the flange's force at the wheelset's centre (section 3.3.7).
    """
    return replace(parameters, **AS_PRINTED)


def tables_4_1_and_4_2() -> BogieParameters:
    """Return the wheelset in a frame of chapter 4, axle load about 110 kN.

    Reported: Table 4.1 (springs and dampers, of each of the two elements), Table 4.2 (masses and inertias), wheel
    radius 0.425 m.
    Fitted: both half spacings 0.49 m, to the critical speed of 27 m/s (section 4.4). The thesis reports a distance of
    0.7 m, so 0.35 m. This makes the wheelset unstable from 22 m/s on; `critical-speed` shows both.
    Assumed: frame_height 0, because the thesis gives no height and the frame's pitch is held. The wheel_base has no
    effect here. The rest is as in `tables_5_1_and_5_2`.
    """
    return BogieParameters(
        **tables_5_1_and_5_2().values()
        | {
            "frame_mass": 10000.0,
            "frame_roll_inertia": 20000.0,
            "frame_pitch_inertia": 15000.0,
            "frame_yaw_inertia": 20000.0,
            "frame_height": 0.0,
            "longitudinal_half_spacing": 0.49,
            "vertical_half_spacing": 0.49,
            "longitudinal_stiffness": 20e4,
            "lateral_stiffness": 8e4,
            "vertical_stiffness": 5e4,
            "longitudinal_damping": 10e3,
            "lateral_damping": 6e3,
            "vertical_damping": 4e3,
        }
    )


def tables_5_1_and_5_2() -> BogieParameters:
    """Return the simplified two-axle bogie of chapter 5, axle load about 300 kN.

    Reported: Table 5.1 (springs and dampers, of each element). Table 5.2 (masses and inertias). Wheel base 1.675 m
    (section 5.2, where "mm" is a misprint for m). Wheel radius 0.425 m (section 4.5). Flange_clearance 9.5 mm
    (section 4.3).
    Fitted, all under the thesis's reading (AS_PRINTED): frame_height. Section 5.4.2 says only that the axles lie below
    the centre of mass; 0.8 m locks the leading wheelset half a second after 60 kN.m are applied (Fig. 5.44). Both half
    spacings 0.7 m, to the derailments of chapter 9. Flange_stiffness 1e8 N/m, to lateral peaks of 9.5 to 10 mm
    (section 5.3.1).
    Switches: torque_reaction, flange_at_rail, yaw_torque_rotates, constant_speed and wheel_lift_ends are on, on, off,
    off and on, the physical readings. AS_PRINTED has the thesis's of the first two. Also, running_safety_warnings is
    off. Both rails have the friction of the inputs, as in section 4.4.
    Assumed: contact_damping 1 s/m, 7 % of the critical damping of a wheelset on its rails. A rail head radius of 300 mm
    (60 kg rail), a conical tread, steel with G = 82 GPa, g = 9.81 m/s2, and creepage_speed. No rolling resistance.
    """
    return BogieParameters(
        frame_mass=60000.0,
        frame_roll_inertia=80000.0,
        frame_pitch_inertia=60000.0,
        frame_yaw_inertia=20000.0,
        frame_height=0.8,
        wheelset_mass=1200.0,
        wheelset_roll_inertia=720.0,
        wheelset_pitch_inertia=112.0,
        wheelset_yaw_inertia=720.0,
        wheel_base=1.675,
        longitudinal_half_spacing=0.7,
        vertical_half_spacing=0.7,
        wheel_radius=0.425,
        longitudinal_stiffness=9.5e6,
        lateral_stiffness=6.0e6,
        vertical_stiffness=3.5e6,
        longitudinal_damping=8e4,
        lateral_damping=4e4,
        vertical_damping=2.5e4,
        rolling_resistance_torque=0.0,
        torque_reaction=1.0,
        flange_clearance=9.5e-3,
        flange_stiffness=1e8,
        flange_at_rail=1.0,
        yaw_torque_rotates=0.0,
        constant_speed=0.0,
        wheel_lift_ends=1.0,
        running_safety_warnings=0.0,
        wheel_profile_curvature=0.0,
        rail_head_radius=0.3,
        shear_modulus=82e9,
        left_rail_friction=1.0,
        right_rail_friction=1.0,
        gauge_face_friction=1.0,
        contact_damping=1.0,
        creepage_speed=0.01,
        gravity=9.81,
    )


def tables_8_1_and_8_2() -> BogieParameters:
    """Return the QR30 bogie of the experiment, without a wagon body.

    Reported: Table 8.1 (masses and inertias). Table 8.2 (wheel base, wheel radius). Rolling resistance 65 N.m for each
    wheelset (section 8.3). There "kN.m" is a misprint: 65 kN.m is fifty times the torque that the rail can transmit at
    friction 0.18.
    Assumed: the suspension of Table 5.1, because section 8.2.1 refers to the model of chapter 5. Also frame_height 0:
    the measured load of the braked wheelset, 2 x 8.85 kN (section 7.4.2), is the static one to 1 %. The rest is as in
    `tables_5_1_and_5_2`.
    """
    chapter_5 = tables_5_1_and_5_2().values()
    return BogieParameters(
        **chapter_5
        | {
            "frame_mass": 1480.0,
            "frame_roll_inertia": 2000.0,
            "frame_pitch_inertia": 1500.0,
            "frame_yaw_inertia": 2500.0,
            "frame_height": 0.0,
            "wheelset_mass": 1050.0,
            "wheelset_roll_inertia": 450.0,
            "wheelset_pitch_inertia": 90.0,
            "wheelset_yaw_inertia": 450.0,
            "wheel_base": 1.675,
            "wheel_radius": 0.398,
            "rolling_resistance_torque": 65.0,
        }
    )


def manchester_vehicle_1() -> VehicleParameters:
    """Return vehicle 1 of the Manchester benchmarks, a passenger coach, Iwnicki (1998).

    S. Iwnicki (1998), Vehicle System Dynamics 30, 295-313, as transcribed in public code that cites it: masses,
    inertias, spacings, wheel radius, heights of the centres (1.8 and 0.6 m above the rail), springs, dampers, anti-roll
    bar, bending of the air springs. Transcriptions give 1.220 and 1.200 MN/m for the vertical primary stiffness; this
    set uses 1.220. No transcription has a traction rod. The secondary springs stand 0.525 m (frame) to 1.130 m (body)
    above the rail in one transcription, to 1.150 m in another. This set has the middle of the first, 0.8275 m, which
    that one uses too: a spring with equal ends has no moment in its middle.
    Assumed: couplers 20 m apart and 1.0 m above the rail. Wheels and rails (`synthetic_pair`), flange and contact are
    as in `tables_5_1_and_5_2`, without rolling resistance.
    """
    radius = 0.46
    return VehicleParameters(
        **tables_5_1_and_5_2().values()
        | {
            "frame_mass": 2615.0,
            "frame_roll_inertia": 1722.0,
            "frame_pitch_inertia": 1476.0,
            "frame_yaw_inertia": 3067.0,
            "frame_height": 0.6 - radius,
            "wheelset_mass": 1813.0,
            "wheelset_roll_inertia": 1120.0,
            "wheelset_pitch_inertia": 112.0,
            "wheelset_yaw_inertia": 1120.0,
            "wheel_base": 2.56,
            "longitudinal_half_spacing": 1.0,
            "vertical_half_spacing": 1.0,
            "wheel_radius": radius,
            "longitudinal_stiffness": 31.391e6,
            "lateral_stiffness": 3.884e6,
            "vertical_stiffness": 1.220e6,
            "longitudinal_damping": 15e3,
            "lateral_damping": 2e3,
            "vertical_damping": 4e3,
        },
        body_mass=32000.0,
        body_roll_inertia=56800.0,
        body_pitch_inertia=1.97e6,
        body_yaw_inertia=1.97e6,
        body_height=1.8 - radius,
        pivot_distance=19.0,
        secondary_half_spacing=1.0,
        secondary_height=0.8275 - radius,
        secondary_longitudinal_stiffness=160e3,
        secondary_lateral_stiffness=160e3,
        secondary_vertical_stiffness=430e3,
        secondary_longitudinal_damping=0.0,
        secondary_lateral_damping=32e3,
        secondary_vertical_damping=20e3,
        secondary_bending_stiffness=10.5e3,
        anti_roll_stiffness=940e3,
        coupler_distance=20.0,
        coupler_height=1.0 - radius,
        traction_rod_stiffness=0.0,
        traction_rod_damping=0.0,
    )


def coach_with_traction_rods() -> VehicleParameters:
    """Return the passenger coach: vehicle 1 of the Manchester benchmarks, Iwnicki (1998).

    It has a traction rod in each bogie.

    Reported: all values of `manchester_vehicle_1`, whose body has no damping along the track.
    Assumed: the rods. 5 MN/m is the size of a rod between rubber bushes. It is soft compared with the wheelsets'
    guidance and stiff compared with the secondary springs. Body and bogies oscillate against each other on it at 4.8
    Hz. It deflects by 4 mm when the coach brakes at 1.2 m/s2. 25 kN.s/m gives the bushes a loss factor of 0.15 there,
    within the 0.1 to 0.2 of filled natural rubber. The loss factor is damping times circular frequency over stiffness.
    The oscillation falls to 1/e in half a second. One transcription of vehicle 1 has 25 kN.s/m along the track on each
    side of the secondary suspension; the others have no such damping.
    """
    return replace(manchester_vehicle_1(), traction_rod_stiffness=5e6, traction_rod_damping=25e3)


def one_bogie_of(vehicle: VehicleParameters) -> BogieParameters:
    """Return one bogie of a vehicle under half its body, as the sprung mass of section 5.2, for studies of braking.

    The body's inertia force acts at the height of the secondary springs, by Newton's third law. The sprung mass
    therefore has the centre of mass of the frame with half a body at that height. Not modelled: the load transfer
    between the bogies, the secondary springs, and that the body cannot pitch with a bogie. `vehicle-or-bogie` shows the
    resulting error.
    """
    bogie_parameters = BogieParameters(
        **{name: value for name, value in vehicle.values().items() if name in BOGIE_NAMES}
    )
    mass = vehicle.frame_mass + vehicle.body_mass / 2
    height = (vehicle.frame_mass * vehicle.frame_height + vehicle.body_mass / 2 * vehicle.secondary_height) / mass
    arms = vehicle.frame_height - height, vehicle.secondary_height - height
    pitch = vehicle.frame_mass * arms[0] ** 2 + vehicle.body_mass / 2 * arms[1] ** 2
    return replace(
        bogie_parameters,
        frame_mass=mass,
        frame_height=height,
        frame_roll_inertia=vehicle.frame_roll_inertia + vehicle.body_roll_inertia / 2,
        frame_pitch_inertia=vehicle.frame_pitch_inertia + pitch,
    )


#: Names that bogies have; vehicles have more.
BOGIE_NAMES = frozenset(item.name for item in fields(BogieParameters))


def coal_wagon() -> VehicleParameters:
    """Return a coal wagon: two bogies of chapter 5 under a body, axle load about 306 kN.

    Reported: Table 5.1 (primary springs and dampers), wheelset of Table 5.2, wheel base and radius, as in
    `tables_5_1_and_5_2`.
    Assumed: the division of each bogie's sprung mass of 60 t into a frame of 2 t, with its inertias, and half a body of
    116 t. The body's centre gives the whole the height that was fitted for chapter 5, 0.8 m. The body has the inertias
    of a box of 15 m x 2.9 m x 2.4 m. Pivots are 10.4 m apart. Secondary springs have the stiffness of a centre bowl and
    side bearers, which need no traction rod. Couplers are 15.5 m apart, 0.9 m above the rail.
    """
    chapter_5 = tables_5_1_and_5_2()
    frame_height = 0.1
    body = 2 * (chapter_5.frame_mass - 2000.0)
    return VehicleParameters(
        **chapter_5.values()
        | {
            "frame_mass": 2000.0,
            "frame_roll_inertia": 1500.0,
            "frame_pitch_inertia": 1500.0,
            "frame_yaw_inertia": 2600.0,
            "frame_height": frame_height,
        },
        body_mass=body,
        body_roll_inertia=body * (2.9**2 + 2.4**2) / 12,
        body_pitch_inertia=body * (15.0**2 + 2.4**2) / 12,
        body_yaw_inertia=body * (15.0**2 + 2.9**2) / 12,
        body_height=(2 * chapter_5.frame_mass * chapter_5.frame_height - 2 * 2000.0 * frame_height) / body,
        pivot_distance=10.4,
        secondary_half_spacing=0.7,
        secondary_height=0.3,
        secondary_longitudinal_stiffness=40e6,
        secondary_lateral_stiffness=20e6,
        secondary_vertical_stiffness=40e6,
        secondary_longitudinal_damping=200e3,
        secondary_lateral_damping=100e3,
        secondary_vertical_damping=200e3,
        secondary_bending_stiffness=0.0,
        anti_roll_stiffness=0.0,
        coupler_distance=15.5,
        coupler_height=0.9 - chapter_5.wheel_radius,
        traction_rod_stiffness=0.0,
        traction_rod_damping=0.0,
    )

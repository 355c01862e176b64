"""DrivenWheelset: motor, gear and two wheels on their own rails, by rigid or elastic shafts, as one FMU."""

from brake_controller.motors import torque_loop, traction_inverter
from fmu_src.system import Model, ParameterRelation, Variable, choosing, model_of_choices
from rbd_model.wheelset.driven import driven_wheelset, electric_locomotive

#: Local error of 1e-10 rad of twist and 1 um/s of speed per step at this tolerance.
DEFAULT_TOLERANCE = 1e-7
#: Kinds of shafts by their numbers, their names, and whether drive and axle are elastic.
RIGID, ELASTIC_DRIVE, ELASTIC_AXLE, BOTH_ELASTIC = 1, 2, 3, 4
SHAFTS = {
    RIGID: ("rigid", "both rigid", (False, False)),
    ELASTIC_DRIVE: ("elastic_drive", "elastic drive, rigid axle", (True, False)),
    ELASTIC_AXLE: ("elastic_axle", "rigid drive, elastic axle", (False, True)),
    BOTH_ELASTIC: ("elastic", "both elastic", (True, True)),
}
CHOSEN = Variable(
    "shafts",
    "parameter",
    start=float(BOTH_ELASTIC),
    **choosing("Torsion of drive and axle", {number: text for number, (_, text, _) in SHAFTS.items()}),
)
#: Ratio of the radii of wheel and rail head up to which the ellipse lies within Kalker's table, 1 : 10.
SLENDER = 30.0
#: Radii that are given in millimetres, or of two different wheels, have a message before their contact fails.
RADII = (
    ParameterRelation(
        (("wheel_radius", SLENDER), ("rail_head_radius", -1.0)),
        0.0,
        f"rail_head_radius must be below {SLENDER:g} times wheel_radius; it is %s m more. Give both in metres.",
    ),
    ParameterRelation(
        (("rail_head_radius", SLENDER), ("wheel_radius", -1.0)),
        0.0,
        f"wheel_radius must be below {SLENDER:g} times rail_head_radius; it is %s m more. Give both in metres.",
    ),
)


def driven_wheelset_dynamics() -> Model:
    """Return one driven wheelset of an electric locomotive as an FMU; the parameter `shafts` chooses its equations."""
    motor = torque_loop(traction_inverter())
    wheelset = electric_locomotive()
    systems = tuple(driven_wheelset(name, wheelset, motor, elastic) for name, _, elastic in SHAFTS.values())
    text = "One driven wheelset with torsion of drive and axle: motor torque in, slips and forces out"
    choice = tuple(range(len(systems)))
    return model_of_choices("DrivenWheelset", text, systems, (CHOSEN,), choice, DEFAULT_TOLERANCE, relations=RADII)

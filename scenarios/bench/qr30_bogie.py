"""The QR30 bogie of the experiment (chapter 8): its parameters by names of the FMU, and its recorded variables."""

from rbd_model.levels.models import recommend_level
from rbd_model.vehicle.parameters import tables_8_1_and_8_2

#: Wheel-rail friction of the thesis's simulations (section 8.1) and its measured range (section 7.4.2).
FRICTION, FRICTION_RANGE = 0.18, (0.15, 0.20)
#: Initial speeds of the simulations [m/s] (sections 8.3.1 - 8.3.3).
INITIAL_SPEED = {130: 3.0, 150: 2.5, 180: 2.9}
RECORDED = (
    "speed",
    "distance",
    "acceleration",
    "angular_velocity_1",
    "angular_velocity_2",
    "slip_2",
    "axle_load_2",
    "creep_force_2",
    "locked_2",
)


def bogie_parameters(names: set[str], pressure: int) -> dict[str, float]:
    """Return the parameters of a run at a pressure [kPa] that are among these names of the FMU."""
    level = recommend_level(("brake_torque_2",), RECORDED).level
    return {name: value for name, value in tables_8_1_and_8_2().values().items() if name in names} | {
        "level": level,
        "initial_speed": INITIAL_SPEED[pressure],
    }

"""The coach, the complete vehicle of the FMU `vehicle`: its parameters, and the brake torque on all its wheelsets."""

from rbd_model.vehicle.parameters import coach_with_traction_rods, manchester_vehicle_1

COACH = coach_with_traction_rods()
#: Parameters of the published vehicle without the traction rods of the coach.
AS_PUBLISHED = {key: value for key, value in manchester_vehicle_1().values().items() if value != COACH.values()[key]}
NUMBERS = (1, 2, 3, 4)


def brakes(torque: float) -> dict[str, float]:
    """The same torque capacity on all four wheelsets [N.m]."""
    return {f"brake_torque_{number}": torque for number in NUMBERS}

"""The bogie of chapter 5 on trial: its numbers, and the brake of its wheelsets."""

from brake_controller.parameters import qr30
from rbd_model.vehicle.parameters import tables_5_1_and_5_2

BOGIE = tables_5_1_and_5_2()
#: Pressure [Pa] and torque capacity on each wheelset [N.m] of the full brake, which slows the bogie at 1.48 m/s2.
FULL_PRESSURE, FULL_TORQUE = 180e3, 20e3
TORQUE_PER_PRESSURE = FULL_TORQUE / FULL_PRESSURE
#: Tolerance of both FMUs in studies of the macro step: their own errors are far below those of the coupling.
TOLERANCE = 1e-10


def brake_values() -> dict[str, float]:
    """Return the QR30's brake with shoe forces scaled up to FULL_TORQUE; assumed.

    The thesis does not report this bogie's.
    """
    brake = qr30(int(FULL_PRESSURE / 1e3))
    per_force = brake.wheelset_share * brake.rigging_efficiency * brake.constant_shoe_friction * brake.wheel_radius
    return brake.values() | {"force_per_pressure": TORQUE_PER_PRESSURE / per_force, "tolerance": TOLERANCE}

"""The hand brake or spring-applied parking brake of a train's vehicle: an additional force at its rims."""

from __future__ import annotations

from dataclasses import dataclass

from brake_controller.build_up import ramped
from brake_controller.vehicle_brake import named
from fmu_src.chain import function_of
from fmu_src.symbols import ca
from fmu_src.system import ParameterSet, choice, quantity

#: Time of the application of the whole force, and of the release [s]. Assumed: springs, whose cylinders are vented.
TIME = 2.0
#: The sum of both forces, or the larger one, by names in consists. With a double check valve between both cylinders the
#: larger one alone acts, so that rigging and discs are protected against compounding.
ADDS, LARGER = 0, 1
COMPOUNDING = {"adds": ADDS, "larger": LARGER}
#: Share of the brake that is demanded, and applied before a step; length of the step [s].
SCREWED = ("wanted", "applied", "step")


@dataclass(frozen=True)
class ParkingBrake(ParameterSet):
    """Hand brake or spring-applied brake of one vehicle."""

    parking_force: float = quantity("N", "Force of the parking brake at the rims; 0 without one", 0.0)
    parking_time: float = quantity("s", "Time of the parking brake's application, and of its release", 0.0)
    parking_compounding: float = choice("Parking brake with air", {ADDS: "it adds", LARGER: "the larger acts"})


#: A vehicle without a parking brake.
NO_PARKING_BRAKE = ParkingBrake(parking_force=0.0, parking_time=TIME, parking_compounding=float(ADDS))


def parking() -> ca.Function:
    """Return the function for a step of a parking brake: force of both brakes at the rims [N], share at its end.

    The force is constant over speed, and is applied and released at a constant rate, as EN 14531-1 takes build-up. It
    adds to that of the air, or the larger one acts. Arguments: force of the air brake, SCREWED, and the parking brake.
    """
    air, order = ca.SX.sym("air"), ca.SX.sym("order", len(SCREWED))
    given = ca.SX.sym("given", len(named(ParkingBrake)))
    p = dict(zip(named(ParkingBrake), ca.vertsplit(given), strict=True))
    wanted, applied, step = ca.vertsplit(order)
    mean, ends = ramped(applied, wanted, p["parking_time"], step)
    own = mean * p["parking_force"]
    both = ca.if_else(p["parking_compounding"] == LARGER, ca.fmax(air, own), air + own)
    return function_of("parking", [air, order, given], ca.vertcat(both, ends))

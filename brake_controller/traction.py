"""The traction of a train's vehicle: a share of the largest force of its motors at the speed of its wheels."""

from __future__ import annotations

from dataclasses import dataclass

from brake_controller.drive import LEAST, NO_LIMIT, OverSpeed, driven_by, followed
from brake_controller.vehicle_brake import named
from fmu_src.chain import function_of
from fmu_src.symbols import ca
from fmu_src.system import quantity

#: Gauge pressure of the pipe below which the motors are off, where none is given [Pa]. Assumed: full service leaves 3.5
#: bar, an emergency nothing. A running driver's valve feeds the pipe between it and a parted hose above this.
CUT_OUT = 250e3
#: Commands of a vehicle: share of its motors' largest force at this speed, force before a step [N], its length [s].
COMMANDED = ("share", "before", "step")


@dataclass(frozen=True)
class Traction(OverSpeed):
    """The motors of one vehicle, which drive it forwards."""

    traction_force: float = quantity("N", "Largest force of the motors at the rims; 0 without motors", 0.0)
    traction_power: float = quantity("W", "Largest power of the motors at the rims", 0.0, NO_LIMIT)
    traction_rise: float = quantity("s", "Time of the motors' rise to their largest force, and of its fall", 0.0)
    traction_cut_out: float = quantity("Pa", "Gauge pressure in the pipe below which the motors are off", 0.0)


#: A vehicle without motors.
NO_TRACTION = Traction(0.0, NO_LIMIT, 0.0, 0.0)


def driving() -> ca.Function:
    """Return the function for motors in a step: mean force at the rims, and the last one [N].

    The force is the commanded share of min(F(v), P / v) and changes at the rate F / T at most, as EN 14531-1 takes the
    build-up of forces. Arguments: speed of the wheels in the middle of the step, the command, the motors.
    """
    wheel, command = ca.SX.sym("wheel"), ca.SX.sym("command", len(COMMANDED))
    given = ca.SX.sym("given", len(named(Traction)))
    p = dict(zip(named(Traction), ca.vertsplit(given), strict=True))
    share, before, step = ca.vertsplit(command)
    able = driven_by(p["traction_force"], p["traction_power"], p, ca.fabs(wheel))
    change = p["traction_force"] * step / ca.fmax(p["traction_rise"], LEAST**2)
    return function_of("driving", [wheel, command, given], ca.vertcat(*followed(share * able, able, before, change)))

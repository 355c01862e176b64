"""The start on a line: the steady state of free rolling at the vehicle's place, by curvature, cant, gradient, speed.

On straight and level track the start values are a state of rest. In a curve its bodies are displaced from the track, by
15 cm for 19 m between bogies at R 300 m. Wheelsets run at a flange, and springs are deflected.
"""

from __future__ import annotations

from collections.abc import Iterable

from fmu_src.states import SteadyStart
from fmu_src.symbols import ca
from rbd_model.body.kinematics import Body
from rbd_model.vehicle import variables
from rbd_model.vehicle.assembly import Assembly
from rbd_model.wheelset.rotation import RollingWheelset

#: Turning [rad/m] and lean [1] of the track up to which it is treated as straight and level. At R 10 000 km and 50 m/s,
#: 0.25 mm/s2 push outwards, and a body of 19 m between its bogies is displaced by 5 um.
STRAIGHT = 1e-7
NO_STEADY_STATE = (
    "The vehicle has no steady state of rolling freely where it starts on its line at %s s: with these parameters it "
    "would not stay upright on its rails there at this initial_speed; bring initial_speed nearer to what the cant "
    "suits, take stiffer springs, or begin the line with straight and level track."
)


def start_steady(
    assembly: Assembly, bodies: Iterable[Body], wheelsets: Iterable[RollingWheelset], last: Iterable[str] = ()
) -> None:
    """Let a vehicle start in a steady state, by (3.73) without accelerations, if its bodies' track turns or leans.

    The acceleration along the track remains. All parts share it, and the wheelsets turn as fast as they roll. last:
    names of the states that are solved after those of the bodies above them.
    """
    system, vehicle = assembly.system, assembly.vehicle
    leans = [ca.vertcat(body.track.turning, body.track.up[:2]) for body in bodies]
    kept = [system.name_of(one) for one in (assembly.distance, *(wheelset.rotation.angle for wheelset in wheelsets))]
    torques = [f"{kind}_{n}" for kind in ("brake_torque", "traction_torque", "yaw_torque") for n, _ in vehicle.numbered]
    drives = [*torques, *(pull.name for pull in vehicle.pulls)]
    offsets = [offset.name for offset in variables.initial_offsets()]
    system.start_steady(
        SteadyStart(
            ca.mmax(ca.fabs(ca.vertcat(*leans))) - STRAIGHT,
            system.name_of(assembly.speed),
            variables.initial_speed(0.0).name,
            tuple(kept),
            tuple(name for name in last if name not in kept),
            tuple(name for name in drives if name in system.input_symbols),
            tuple(name for name in offsets if name in system.parameter_symbols),
            NO_STEADY_STATE,
        )
    )

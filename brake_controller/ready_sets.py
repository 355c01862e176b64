"""Built-in brakes: rigging, friction and times, together with restrictions that give these times by flow."""

import math
from dataclasses import dataclass, replace

from brake_controller.experiment import APPLICATION_TIME
from brake_controller.flow_parameters import FlowParameters
from brake_controller.parameters import BrakeParameters, qr30, uic
from brake_controller.timing import with_application_time, with_release_time, with_vent_time

#: Largest pressure of the cylinder, 3.8 bar, and the pressure at which a release is complete, 0.4 bar [Pa]: UIC 540 and
#: 543, both quoted from memory.
UIC_PRESSURE, UIC_RELEASED = 380e3, 40e3
#: Piston of a tread-braked vehicle in the example of EN 14531: area [m2] and counter-force of its spring [N].
UIC_PISTON_AREA, UIC_SPRING_FORCE = 346e-4, 300.0
#: Length of a stroke until the shoes touch [m]. Assumed.
UIC_SLACK = 0.1


@dataclass(frozen=True)
class Window:
    """Shortest and longest time that a standard allows [s]."""

    shortest: float
    longest: float

    @property
    def middle(self) -> float:
        """Target of a built-in set [s]."""
        return (self.shortest + self.longest) / 2


@dataclass(frozen=True)
class Timing:
    """Times by a standard: application from 0 to 95 %, release from full to 0.4 bar."""

    application: Window
    release: Window


#: UIC 543, from secondary literature; section 2.4.2 gives the windows of position G.
UIC_P = Timing(Window(3.0, 5.0), Window(15.0, 20.0))
UIC_G = Timing(Window(18.0, 30.0), Window(45.0, 60.0))
#: A dump valve of a wheel-slide protection, from full to 0.4 bar. Assumed.
DUMP = Window(0.4, 0.8)


@dataclass(frozen=True)
class ReadySet:
    """A brake for both kinds of `cylinder_model`, which end at the same shoe force."""

    rigging: BrakeParameters
    flow: FlowParameters

    def values(self) -> dict[str, float]:
        """Return all parameters by name, in SI units."""
        return self.rigging.values() | self.flow.values()


def _air(**cylinder: float) -> FlowParameters:
    """Return a cylinder in dry air of 20 degrees, with preliminary restrictions of 1 mm.

    Assumed: discharge coefficient 0.8, between a sharp edge (0.6) and a nozzle (0.98). Only its product with the areas
    matters.
    """
    return FlowParameters(
        **{
            "ambient_pressure": 101325.0,
            "air_temperature": 293.15,
            "polytropic_exponent": 1.0,
            "discharge_coefficient": 0.8,
            "application_orifice": 1e-3,
            "release_orifice": 1e-3,
            "vent_orifice": 1e-3,
        }
        | cylinder
    )


def qr30_experiment(pressure_kpa: int = 180) -> ReadySet:
    """Return the brake of the experiment at one of its pressures.

    Reported: application time 0.8 s, set by the flow restriction for each pressure (sections 6.3.9 and 7.1). The rod
    forces do not lag behind the pressure and lie at the reported share below the specification. The piston therefore
    has no slack, and its spring is part of the efficiency (sections 7.2.1, 7.3.1, 7.4.1).
    Assumed: piston of 200 mm, because with the ratio of 5.22 it gives 0.164 N/Pa. Also 3 litres of air in cylinders and
    line, and release as fast as application. The exponent is 1.2, because 0.8 s are too short for the walls to take all
    heat.
    """
    flow = _air(
        polytropic_exponent=1.2,
        piston_area=math.pi / 4 * 0.2**2,
        dead_volume=3e-3,
        piston_slack=0.0,
        spring_preload=0.0,
        spring_stiffness=1e3,
    )
    flow = with_application_time(flow, 1e3 * pressure_kpa, APPLICATION_TIME)
    flow = with_release_time(flow, 1e3 * pressure_kpa, APPLICATION_TIME)
    return ReadySet(qr30(pressure_kpa), flow)


def _uic(timing: Timing) -> ReadySet:
    """Return a UIC freight wagon in one brake position, its times in the middle of their windows.

    Literature: pressure 3.8 bar, windows of the times (UIC), piston of 346 cm2, its spring with 300 N at the shoes'
    touch and efficiency 0.95 (example of EN 14531).
    Assumed: stroke of 100 mm, preload two thirds of the spring's force, 1 litre of dead volume, air at the temperature
    of the walls (exponent 1); rigging as in `parameters.uic`.
    """
    preload = 2 / 3 * UIC_SPRING_FORCE
    flow = _air(
        piston_area=UIC_PISTON_AREA,
        dead_volume=1e-3,
        piston_slack=UIC_SLACK,
        spring_preload=preload,
        spring_stiffness=(UIC_SPRING_FORCE - preload) / UIC_SLACK,
    )
    application, release = timing.application.middle, timing.release.middle
    flow = with_application_time(flow, UIC_PRESSURE, application)
    flow = with_release_time(flow, UIC_PRESSURE, release, UIC_RELEASED)
    # The timed law falls by a constant share per second; its release time ends at 5 %.
    to_five_percent = release * math.log(20.0) / math.log(UIC_PRESSURE / UIC_RELEASED)
    return ReadySet(uic(UIC_PRESSURE, UIC_PISTON_AREA, UIC_SPRING_FORCE, application, to_five_percent), flow)


def uic_p() -> ReadySet:
    """Return a UIC brake in position P (passenger), UIC 543: application in 3 to 5 s, release in 15 to 20 s."""
    return _uic(UIC_P)


def uic_g() -> ReadySet:
    """Return a UIC brake in position G (freight), section 2.4.2: application in 18 to 30 s, release in 45 to 60 s."""
    return _uic(UIC_G)


def with_dump_valve(ready: ReadySet) -> ReadySet:
    """Return the brake with a fast valve for wheel-slide protection (EN 15595), open while `valve` is 2.

    Its time is assumed.
    """
    return replace(ready, flow=with_vent_time(ready.flow, ready.rigging.supply_pressure, DUMP.middle, UIC_RELEASED))

"""Parameter sets of the brake cylinder and its rigging."""

import math
from dataclasses import dataclass

from brake_controller.experiment import APPLICATION_TIME, EXPERIMENT, FORCE_PER_PRESSURE, SHOES, SUPPLY_PRESSURE
from brake_controller.rigging import force_per_pressure
from brake_controller.shoe_friction import CAST_IRON_P6, CONSTANT, LAWS
from fmu_src.system import ParameterSet, choice, quantity

#: Fall of law 4 with sliding speed [s/m]. Assumed.
FALLING_FRICTION_CONSTANT = 0.02
#: Smallest pressure of a supply [Pa]: below any, and above the numbers of pressures in bar, kPa and mbar.
LEAST_SUPPLY = 2e4
#: Longest rise and fall of a pressure [s]: five times that of freight trains in position G, UIC 540.
LONGEST_RISE = 300.0


@dataclass(frozen=True)
class BrakeParameters(ParameterSet):
    """One brake cylinder system that brakes one wheelset with tread shoes."""

    application_time: float = quantity("s", "Time from 0 to 95 % of the demanded pressure", 1e-3, LONGEST_RISE)
    release_time: float = quantity("s", "Time from 100 % to 5 % of the pressure", 1e-3, LONGEST_RISE)
    supply_pressure: float = quantity("Pa", "Largest pressure the regulator lets through", LEAST_SUPPLY)
    force_per_pressure: float = quantity(
        "N/Pa", "Normal force of all shoes of the bogie per pressure (pi/4 D^2 i_t)", 0.0
    )
    wheelset_share: float = quantity("1", "Share of the shoe force that acts on this wheelset", 0.0, 1.0)
    shoes: float = quantity("1", "Shoes on this wheelset, which share its force equally", 1.0, 16.0)
    slack_adjuster_force: float = quantity("N", "Counter-force of the slack adjuster at the shoes (F_R i_b)", 0.0)
    touch_pressure: float = quantity(
        "Pa", "Pressure at which the piston has brought the shoes to the wheel against its return spring", 0.0
    )
    rigging_efficiency: float = quantity("1", "Effective over calculated shoe force (eta)", 0.0, 1.0)
    wheel_radius: float = quantity("m", "Radius at which the shoes rub (r_w)", 1e-3, 2.0)
    friction_law: float = choice("Shoe friction", LAWS)
    constant_shoe_friction: float = quantity(
        "1", "Shoe friction coefficient of law 0, and of law 4 at rest (mu_b)", 0.0, 2.0
    )
    falling_friction_constant: float = quantity("s/m", "How fast law 4 falls with sliding speed (c_f)", 0.0)


def qr30(pressure_kpa: int = 180) -> BrakeParameters:
    """Return the brake of the QR30 bogie in the experiment, trailing wheelset, at one of its three pressures.

    Reported: application time 0.8 s (section 7.1) and at most 350 kPa. Normal force of 0.164 kN for each kPa over all
    four shoes (section 6.2.3), two shoes on the braked wheelset. Wheel radius 0.398 m (Table 8.2). Efficiency and shoe
    friction of each pressure (chapter 7). Touch_pressure 0, because the efficiency includes the return spring.
    Assumed: release as fast as application, no counter-force of the slack adjuster. For law 4 a fall by half within 35
    m/s, because section 2.5.2 gives no number.

    Takes pressure_kpa [kPa].
    """
    if pressure_kpa not in EXPERIMENT:
        known = ", ".join(str(pressure) for pressure in EXPERIMENT)
        raise ValueError(f"pressure_kpa must be one of {known}; got {pressure_kpa}. Choose one of these.")
    row = EXPERIMENT[pressure_kpa]
    return BrakeParameters(
        application_time=APPLICATION_TIME,
        release_time=APPLICATION_TIME,
        supply_pressure=SUPPLY_PRESSURE,
        force_per_pressure=FORCE_PER_PRESSURE,
        wheelset_share=0.5,
        shoes=SHOES / 2,
        slack_adjuster_force=0.0,
        touch_pressure=0.0,
        rigging_efficiency=row.rigging_efficiency,
        wheel_radius=0.398,
        friction_law=CONSTANT,
        constant_shoe_friction=row.shoe_friction,
        falling_friction_constant=FALLING_FRICTION_CONSTANT,
    )


def uic(
    pressure: float, piston_area: float, spring_force: float, application_time: float, release_time: float
) -> BrakeParameters:
    """Return one wheelset of a two-axle bogie of a UIC freight wagon with double-sided cast-iron shoes.

    pressure [Pa]; piston_area [m2], spring_force [N]: of the cylinder, the spring as the shoes touch.

    Literature: rigging efficiency 0.95 (example of EN 14531), friction of cast iron P6 (Karwatzki (1950)).
    Assumed: one piston for each bogie with a rigging ratio of 6, eight shoes, wheels of 920 mm.
    """
    return BrakeParameters(
        application_time=application_time,
        release_time=release_time,
        supply_pressure=pressure,
        force_per_pressure=force_per_pressure(math.sqrt(4 * piston_area / math.pi), 6.0),
        wheelset_share=0.5,
        shoes=4.0,
        slack_adjuster_force=0.0,
        touch_pressure=spring_force / piston_area,
        rigging_efficiency=0.95,
        wheel_radius=0.46,
        friction_law=CAST_IRON_P6,
        constant_shoe_friction=0.25,
        falling_friction_constant=FALLING_FRICTION_CONSTANT,
    )

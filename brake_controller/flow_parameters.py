"""Parameters of the air that fills and leaves a brake cylinder."""

from dataclasses import dataclass

from brake_controller.air import HEAT_CAPACITY_RATIO
from fmu_src.system import ParameterSet, quantity

#: Largest diameter of a restriction [m].
LARGEST_ORIFICE = 0.1


@dataclass(frozen=True)
class FlowParameters(ParameterSet):
    """Air, restrictions, and the cylinder with its piston, for `cylinder_model` 2."""

    ambient_pressure: float = quantity("Pa", "Absolute pressure of the surroundings", 1e3)
    air_temperature: float = quantity("K", "Temperature of the supply, and of the cylinder at the start", 100.0)
    polytropic_exponent: float = quantity(
        "1", "Exponent of the air in the cylinder: 1.4 adiabatic walls, 1 isothermal", 1.0, HEAT_CAPACITY_RATIO
    )
    discharge_coefficient: float = quantity("1", "Effective over geometric area of the restrictions (C_d)", 0.01, 1.0)
    application_orifice: float = quantity(
        "m", "Diameter of the restriction between regulator and cylinder", 1e-5, LARGEST_ORIFICE
    )
    release_orifice: float = quantity("m", "Diameter of the restriction of the exhaust", 1e-5, LARGEST_ORIFICE)
    vent_orifice: float = quantity(
        "m", "Diameter of the opening to the surroundings when the valve vents", 1e-5, LARGEST_ORIFICE
    )
    piston_area: float = quantity("m2", "Area of the piston", 1e-5)
    dead_volume: float = quantity("m3", "Volume of the cylinder and its line with the piston at rest", 1e-6)
    piston_slack: float = quantity("m", "Travel of the piston until the shoes touch the wheel", 0.0, 1.0)
    spring_preload: float = quantity("N", "Force of the return spring with the piston at rest", 0.0)
    spring_stiffness: float = quantity("N/m", "Stiffness of the return spring", 1.0)

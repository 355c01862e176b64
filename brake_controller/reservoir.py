"""The reservoir of brake cylinders: it supplies their air, and the main pipe feeds it."""

from __future__ import annotations

from dataclasses import dataclass

from brake_controller.air import GAS_CONSTANT, effective_area, mass_flow
from brake_controller.parameters import LEAST_SUPPLY
from fmu_src.symbols import ca
from fmu_src.system import ParameterSet, System, Variable, quantity

NOMINAL_PRESSURE, NOMINAL_MASS = 1e5, 1e-1


@dataclass(frozen=True)
class ReservoirParameters(ParameterSet):
    """Volume, pressures and feed of a reservoir; air and its ambient pressure are those of the cylinders."""

    reservoir_volume: float = quantity("m3", "Volume of the reservoir", 1e-4)
    initial_reservoir_pressure: float = quantity("Pa", "Pressure of the reservoir at the start", 0.0)
    feed_pressure: float = quantity(
        "Pa", "Pressure of the pipe that feeds the reservoir, through a check valve", LEAST_SUPPLY
    )
    feed_orifice: float = quantity(
        "m", "Diameter of the restriction between pipe and reservoir; 0: it is cut off", 0.0, 0.1
    )


def air_reservoir(defaults: ReservoirParameters, ambient: Variable, temperature: Variable, cylinders: int) -> System:
    """Return a reservoir of an ideal gas at wall temperature.

    Inputs: mass flows to cylinders 1, 2, ... Outputs: pressure, and air taken.

    ambient, temperature: the cylinders' parameters of that name. The discharge coefficient of the feed is part of its
    orifice.
    """
    system = System("reservoir", "Air reservoir that brake cylinders are filled from")
    p = {name: system.parameter(defaults.variable(name)) for name in defaults.values()}
    around, air_temperature = system.parameter(ambient), system.parameter(temperature)
    text = "Air that flows to the cylinder of wheelset"
    flows = [
        system.input(Variable(f"air_flow_{number}", "input", "kg/s", f"{text} {number}", 0.0))
        for number in range(1, cylinders + 1)
    ]
    pressure = system.state("reservoir_pressure", "Pa", p["initial_reservoir_pressure"], NOMINAL_PRESSURE)
    taken = system.state("air_taken", "kg", 0.0, NOMINAL_MASS)
    feed = mass_flow(
        effective_area(p["feed_orifice"], ca.SX(1)), p["feed_pressure"] + around, air_temperature, pressure + around
    )
    out = sum(flows[1:], flows[0])
    system.derivative(pressure, GAS_CONSTANT * air_temperature * (feed - out) / p["reservoir_volume"])
    system.derivative(taken, out)
    shown = Variable("reservoir_pressure", "output", "Pa", "Pressure in the reservoir", display_unit="kPa")
    system.output(shown, pressure)
    system.output(Variable("air_taken", "output", "kg", "Air that the cylinders have taken from the reservoir"), taken)
    return system

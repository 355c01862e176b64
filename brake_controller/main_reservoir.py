"""Main reservoir of a vehicle with its compressor and governor: the supply of a driver's valve and of a direct brake.

The air is an ideal gas at the temperature of the walls. V dp/dt is R T times the difference of the flow from the
compressor and the flow that is taken; without flows p V is constant (Boyle (1662)). A compressor delivers free air,
measured at the pressure and temperature of the surroundings (ISO 1217), so that a pressure rises by p0 Q t / V.
"""

from __future__ import annotations

from dataclasses import dataclass

from brake_controller.air import AMBIENT
from brake_controller.vehicle_brake import named
from fmu_src.chain import function_of
from fmu_src.symbols import ca
from fmu_src.system import ParameterSet, quantity

#: Pressures of the governor [Pa, gauge]: those of the class 101 of DB, which has 800 l. Free air of its compressor
#: [m3/s]: 2400 l/min, assumed.
CUT_IN, CUT_OUT, FREE_AIR = 850e3, 1000e3, 2.4 / 60.0
#: Supply of a vehicle without a main reservoir [Pa, gauge], which stays. Assumed.
CONSTANT_SUPPLY = 800e3
#: Pressure before a step [Pa, absolute]; whether the compressor runs; length of the step [s].
PUMPED = ("pressure", "runs", "step")


@dataclass(frozen=True)
class MainReservoir(ParameterSet):
    """Main reservoir and compressor of one vehicle; pressures are gauge pressures."""

    reservoir_volume: float = quantity("m3", "Volume of the main reservoir; 0: a supply of constant pressure", 0.0)
    free_air: float = quantity("m3/s", "Free air that the compressor delivers", 0.0)
    cut_in: float = quantity("Pa", "Pressure below which the governor starts the compressor", 0.0)
    cut_out: float = quantity("Pa", "Pressure at which it stops the compressor", 0.0)
    start_pressure: float = quantity("Pa", "Pressure at the start of a run", 0.0)


#: A vehicle without a main reservoir: its supply is constant.
NO_MAIN_RESERVOIR = MainReservoir(0.0, 0.0, CONSTANT_SUPPLY, CONSTANT_SUPPLY, CONSTANT_SUPPLY)


def pumping() -> ca.Function:
    """Return the function for a compressor in a step: pressure at its end [Pa], and whether it still runs.

    The compressor starts below the cut-in, and stops within the step as soon as the cut-out is reached. Free air of the
    surroundings' temperature (ISO 1217) raises the pressure by p0 Q t / V (Boyle (1662)). Arguments: PUMPED, and the
    main reservoir.
    """
    order, given = ca.SX.sym("order", len(PUMPED)), ca.SX.sym("given", len(named(MainReservoir)))
    pressure, runs, step = ca.vertsplit(order)
    p = dict(zip(named(MainReservoir), ca.vertsplit(given), strict=True))
    lacks = ca.fmax(p["cut_out"] + AMBIENT - pressure, 0)
    starts = ca.if_else(p["free_air"] > 0, ca.if_else(pressure < p["cut_in"] + AMBIENT, 1, runs), 0)
    rises = starts * AMBIENT * p["free_air"] * step / ca.fmax(p["reservoir_volume"], 1e-9)
    ends = pressure + ca.if_else(p["reservoir_volume"] > 0, ca.fmin(rises, lacks), 0)
    return function_of("pumping", [order, given], ca.vertcat(ends, ca.if_else(rises < lacks, starts, 0)))

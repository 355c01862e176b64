"""Test cylinders filled from a reservoir through valves with a lag: balances of air, and closed forms."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from brake_controller.air import CHOKED_FLOW, CRITICAL_RATIO, GAS_CONSTANT
from brake_controller.cylinder import reservoir_brake
from brake_controller.magnet_valves import common_valves
from brake_controller.ready_sets import qr30_experiment
from brake_controller.reservoir import ReservoirParameters, air_reservoir
from fmu_src.compile import build_library
from fmu_src.compose import compose, scope
from fmu_src.kernel import Kernel, Library
from fmu_src.system import System, model_of

TIGHT, CLOSED_FORM = 1e-12, 1e-6
FULL, VOLUME, CYLINDER = 380e3, 0.05, 3e-3
FLOW = replace(qr30_experiment().flow, dead_volume=CYLINDER, application_orifice=4e-3, vent_orifice=6e-3)
RIGGING = replace(qr30_experiment().rigging, supply_pressure=500e3)


def two_cylinders() -> System:
    """Return two cylinders with a common reservoir."""
    cylinders = []
    for number in (1, 2):
        one = reservoir_brake(RIGGING, FLOW, common_valves())
        cylinders.append(scope(one, after=f"_{number}", common=list(one.parameter_symbols)))
    parameters = ReservoirParameters(VOLUME, 500e3, 500e3, 0.0)
    ambient, temperature = FLOW.variable("ambient_pressure"), FLOW.variable("air_temperature")
    reservoir = air_reservoir(parameters, ambient, temperature, 2)
    links = {f"reservoir_pressure_{number}": "reservoir_pressure" for number in (1, 2)}
    links |= {f"air_flow_{number}": f"air_flow_{number}" for number in (1, 2)}
    return compose("two", "Two cylinders", [*cylinders, reservoir], links)


@pytest.fixture(scope="module")
def library() -> Library:
    system = two_cylinders()
    observed = [name for name in system.observables if name.startswith("mass_flow_in")]
    return Library(build_library(model_of(system.with_integrals(observed), TIGHT)))


def kernel(library: Library, **values: float) -> Kernel:
    demands = {f"pressure_demand_{number}": 0.0 for number in (1, 2)}
    machine = Kernel(library, **demands | values)
    machine.initialise()
    return machine


def mass_in_reservoir(machine: Kernel) -> float:
    """Return the mass of an ideal gas at wall temperature [kg]."""
    return (machine["reservoir_pressure"] + FLOW.ambient_pressure) * VOLUME / (GAS_CONSTANT * FLOW.air_temperature)


@pytest.mark.study
def test_the_air_that_cylinders_take_is_what_the_reservoir_loses(library: Library) -> None:
    machine = kernel(library)
    before = mass_in_reservoir(machine)
    for time in range(40):
        demand, valve = (FULL, 0) if time % 3 else (100e3, 2 if time % 2 else 1)
        machine.set(pressure_demand_1=demand, valve_1=valve, pressure_demand_2=FULL, valve_2=2 - valve)
        machine.advance(0.25)
    taken = machine["air_taken"]
    assert taken > 0.1 * before
    assert before - mass_in_reservoir(machine) == pytest.approx(taken, rel=1e-9)
    assert taken == pytest.approx(sum(machine[f"integral_mass_flow_in_{number}"] for number in (1, 2)), rel=1e-9)


def test_a_cylinder_that_is_filled_takes_air_by_its_polytrope(library: Library) -> None:
    """A constant volume V filled from ambient by dp takes V dp / (n R T); the isothermal reservoir loses as much."""
    machine = kernel(library)
    machine.set(pressure_demand_1=FULL, pressure_demand_2=FULL)
    machine.advance(60.0)
    specific = GAS_CONSTANT * FLOW.air_temperature
    taken = 2 * CYLINDER * FULL / (FLOW.polytropic_exponent * specific)
    assert machine["cylinder_pressure_1"] == pytest.approx(FULL, rel=1e-5)
    assert machine["air_taken"] == pytest.approx(taken, rel=1e-5)
    assert 500e3 - machine["reservoir_pressure"] == pytest.approx(taken * specific / VOLUME, rel=1e-5)


def test_a_reservoir_with_too_little_air_fills_its_cylinders_to_its_own_pressure(library: Library) -> None:
    machine = kernel(library, initial_reservoir_pressure=100e3)
    machine.set(pressure_demand_1=FULL, pressure_demand_2=FULL)
    machine.advance(60.0)
    common = 100e3 * VOLUME / (VOLUME + 2 * CYLINDER / FLOW.polytropic_exponent)
    assert machine["cylinder_pressure_1"] == pytest.approx(common, rel=1e-4)
    assert machine["reservoir_pressure"] == pytest.approx(common, rel=1e-4)
    # Nothing flows back into a reservoir at lower pressure.
    machine.set(pressure_demand_1=FULL, pressure_demand_2=FULL, valve_2=2)
    machine.advance(0.5)
    machine.set(pressure_demand_1=FULL, pressure_demand_2=FULL, valve_2=0)
    machine.advance(60.0)
    assert machine["reservoir_pressure"] < machine["cylinder_pressure_1"] == pytest.approx(common, rel=1e-4)


def test_the_pipe_feeds_a_reservoir_by_choked_flow_in_a_straight_line(library: Library) -> None:
    orifice, pipe = 2e-3, 900e3
    machine = kernel(library, initial_reservoir_pressure=0.0, feed_pressure=pipe, feed_orifice=orifice)
    area, supply = math.pi / 4 * orifice**2, pipe + FLOW.ambient_pressure
    flow = area * supply * CHOKED_FLOW / math.sqrt(GAS_CONSTANT * FLOW.air_temperature)
    rise = flow * GAS_CONSTANT * FLOW.air_temperature / VOLUME
    time = 0.8 * (CRITICAL_RATIO * supply - FLOW.ambient_pressure) / rise
    machine.advance(time)
    assert machine["reservoir_pressure"] == pytest.approx(rise * time, rel=1e-6)


@pytest.mark.parametrize("opening", [3e-3, 0.03, 0.3])
def test_a_valve_lets_in_what_its_lag_leaves_open(library: Library, opening: float) -> None:
    """A first-order lag reaches 95 % after t. The choked inflow then has lost the air of t / ln 20."""
    machine = kernel(library, valve_opening_time=opening)
    machine.set(pressure_demand_1=0.0, pressure_demand_2=0.0, valve_1=1, valve_2=1)
    machine.advance(2.0)
    machine.set(pressure_demand_1=FULL, pressure_demand_2=0.0, valve_1=0, valve_2=1)
    area = FLOW.discharge_coefficient * math.pi / 4 * FLOW.application_orifice**2
    choked = area * (FULL + FLOW.ambient_pressure) * CHOKED_FLOW / math.sqrt(GAS_CONSTANT * FLOW.air_temperature)
    lag, time = opening / math.log(20.0), 0.08
    machine.advance(time)
    open_time = time - lag * (1.0 - math.exp(-time / lag))
    assert machine["cylinder_pressure_1"] < CRITICAL_RATIO * (FULL + FLOW.ambient_pressure) - FLOW.ambient_pressure
    assert machine["air_taken"] == pytest.approx(choked * open_time, rel=CLOSED_FORM)
    assert machine["air_taken"] != pytest.approx(choked * (open_time + 0.01 * lag), rel=CLOSED_FORM)


def test_a_valve_that_closes_slowly_lets_out_more(library: Library) -> None:
    """Vent for a while, then hold: the choked outflow continues for t / ln 20 (isothermal: an exponential)."""
    found = {}
    for closing in (3e-3, 0.3):
        machine = kernel(library, valve_closing_time=closing, valve_opening_time=1e-3, polytropic_exponent=1.0)
        machine.set(pressure_demand_1=FULL, pressure_demand_2=FULL)
        machine.advance(60.0)
        machine.set(pressure_demand_1=FULL, pressure_demand_2=FULL, valve_1=1)
        machine.advance(3.0)
        machine.set(pressure_demand_1=FULL, pressure_demand_2=FULL, valve_1=2)
        machine.advance(0.03)
        machine.set(pressure_demand_1=FULL, pressure_demand_2=FULL, valve_1=1)
        machine.advance(3.0)
        found[closing] = machine["cylinder_pressure_1"] + FLOW.ambient_pressure
    area = FLOW.discharge_coefficient * math.pi / 4 * FLOW.vent_orifice**2
    fall = math.sqrt(GAS_CONSTANT * FLOW.air_temperature) * area * CHOKED_FLOW / CYLINDER
    assert min(found.values()) > FLOW.ambient_pressure / CRITICAL_RATIO  # choked throughout
    assert math.log(found[3e-3] / found[0.3]) == pytest.approx(fall * 0.297 / math.log(20.0), rel=1e-4)

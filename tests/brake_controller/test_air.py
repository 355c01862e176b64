"""Test air flow through restrictions into a cylinder: closed forms of gas dynamics, balances of mass and energy."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import casadi as ca
import numpy as np
import pytest

from brake_controller.air import (
    CHOKED_FLOW,
    CRITICAL_RATIO,
    GAS_CONSTANT,
    LAMINAR_DIFFERENCE,
    flow_function,
)
from brake_controller.cylinder import TIMES, brake_model, flow_brake
from brake_controller.flow_parameters import FlowParameters
from brake_controller.ready_sets import ReadySet, qr30_experiment, uic_p, with_dump_valve
from fmu_src.compile import build_library
from fmu_src.kernel import Kernel, Library

#: Tolerance of the flow model against closed forms.
CLOSED_FORM = 5e-3
#: Tolerance of the balances; the integrator's own error at TIGHT is a tenth of it.
BALANCE, TIGHT = 1e-9, 1e-12
#: Tolerance of the temperature at the default tolerance: 1e-6 of each state's nominal value in each of some hundred
#: steps.
DRIFT = 1e-4
KAPPA = 1.4
OBSERVED = ("mass_flow_in", "mass_flow_out", "enthalpy_in", "enthalpy_out", "piston_work", "heat_loss")
SHOWN = ("air_temperature_in_cylinder", "piston_travel", "mass_flow_in", "mass_flow_out")


@pytest.fixture(scope="module")
def air() -> Library:
    """The flow model alone, with the integrals of its observables."""
    ready = qr30_experiment()
    system = flow_brake(ready.rigging, ready.flow).with_integrals(OBSERVED).with_outputs(SHOWN)
    return Library(build_library(brake_model((system,))))


def kernel_of(air: Library, ready: ReadySet, **values: float) -> Kernel:
    given = {name: value for name, value in ready.values().items() if name not in TIMES}
    return Kernel(air, **given | values)


def stiff_cylinder(**changes: float) -> ReadySet:
    """Return a cylinder of 3 litres with a fixed piston, filled up to 380 kPa."""
    ready = uic_p()
    return replace(ready, flow=replace(ready.flow, piston_slack=0.0, dead_volume=3e-3, **changes))


def flow_at(ratio: float) -> float:
    return float(flow_function(ca.SX(ratio)))


def slope_at(ratio: float) -> float:
    r = ca.SX.sym("ratio")
    return float(ca.Function("slope", [r], [ca.jacobian(flow_function(r), r)])(ratio))


# -- the restriction ------------------------------------------------------------------------------------------------


def test_flow_is_the_isentropic_one_and_does_not_grow_below_the_critical_ratio() -> None:
    """Saint-Venant and Wantzel; 0.5283 and 0.6847 are in any table for kappa = 1.4."""
    assert pytest.approx(0.5283, abs=5e-5) == CRITICAL_RATIO
    assert pytest.approx(0.6847, abs=5e-5) == CHOKED_FLOW
    for ratio in (0.0, 0.1, 0.5, CRITICAL_RATIO):
        assert flow_at(ratio) == pytest.approx(CHOKED_FLOW, rel=1e-12)
    for ratio in (0.6, 0.8, 0.99):
        speed = math.sqrt(2 * KAPPA / (KAPPA - 1) * (1 - ratio ** ((KAPPA - 1) / KAPPA)))  # over sqrt(R T)
        assert flow_at(ratio) == pytest.approx(speed * ratio ** (1 / KAPPA), rel=1e-12)


def test_flow_and_its_slope_are_continuous_where_it_chokes_and_where_it_turns_laminar() -> None:
    near = 1e-9
    for corner in (CRITICAL_RATIO, 1 - LAMINAR_DIFFERENCE):
        before, after = corner - near, corner + near
        assert flow_at(before) == pytest.approx(flow_at(after), rel=1e-6)
        assert slope_at(before) == pytest.approx(slope_at(after), rel=1e-4, abs=1e-6)
    assert abs(slope_at(1 - LAMINAR_DIFFERENCE)) > 1.0  # so that the comparison above does not compare zeros


def test_flow_is_monotonous_with_a_finite_slope_at_equal_pressures_and_never_goes_back() -> None:
    ratios = np.linspace(CRITICAL_RATIO, 1.0, 400)
    flows = [flow_at(ratio) for ratio in ratios]
    assert all(a > b for a, b in pairwise(flows))
    assert -100.0 < slope_at(1 - 1e-12) < -10.0
    assert flow_at(1.0) == flow_at(1.5) == 0.0


# -- closed forms ---------------------------------------------------------------------------------------------------


def supply_flow(flow: FlowParameters, target: float) -> float:
    """Return the choked mass flow from the regulator [kg/s]."""
    area = flow.discharge_coefficient * math.pi / 4 * flow.application_orifice**2
    return area * (target + flow.ambient_pressure) * CHOKED_FLOW / math.sqrt(GAS_CONSTANT * flow.air_temperature)


@pytest.mark.parametrize("exponent", [1.0, 1.2, 1.4])
def test_choked_filling_raises_the_pressure_in_a_straight_line(air: Library, exponent: float) -> None:
    """Constant volume and supply: dp/dt = n R T_s m / V while the restriction is choked."""
    ready = stiff_cylinder(polytropic_exponent=exponent)
    flow = ready.flow
    flow_in = supply_flow(flow, 380e3)
    rate = exponent * GAS_CONSTANT * flow.air_temperature * flow_in / flow.dead_volume
    choked = CRITICAL_RATIO * (380e3 + flow.ambient_pressure) - flow.ambient_pressure
    kernel = kernel_of(air, ready, pressure_demand=380e3)
    for share in (0.3, 0.6, 0.99):
        kernel.advance(share * choked / rate - kernel.time)
        assert kernel["mass_flow_in"] == pytest.approx(flow_in, rel=1e-9)
        assert kernel["cylinder_pressure"] == pytest.approx(share * choked, rel=CLOSED_FORM)
        # The closed form for another exponent differs by more than the tolerance.
        assert kernel["cylinder_pressure"] != pytest.approx(share * choked * (exponent + 0.1) / exponent, rel=0.01)


@pytest.mark.parametrize("exponent", [1.0, 1.4])
def test_filling_below_the_critical_ratio_takes_the_closed_time(air: Library, exponent: float) -> None:
    """With y = r^((kappa - 1) / kappa) the isentropic law integrates to a root of 1 - y."""
    ready = stiff_cylinder(polytropic_exponent=exponent)
    flow, supply = ready.flow, 380e3 + ready.flow.ambient_pressure
    per_ratio = flow.dead_volume * supply / (exponent * GAS_CONSTANT * flow.air_temperature) * CHOKED_FLOW
    per_ratio /= supply_flow(flow, 380e3)
    y = [ratio ** ((KAPPA - 1) / KAPPA) for ratio in (CRITICAL_RATIO, 0.95)]
    factor = 2 * KAPPA / (KAPPA - 1) / math.sqrt(2 * KAPPA / (KAPPA - 1))
    unchoked = per_ratio * factor * (math.sqrt(1 - y[0]) - math.sqrt(1 - y[1]))
    choked = per_ratio / CHOKED_FLOW * (CRITICAL_RATIO - flow.ambient_pressure / supply)
    kernel = kernel_of(air, ready, pressure_demand=380e3)
    kernel.advance(choked + unchoked)
    pressure = kernel["cylinder_pressure"] + flow.ambient_pressure
    assert pressure == pytest.approx(0.95 * supply, rel=CLOSED_FORM)
    assert pressure != pytest.approx(0.95 * supply * 1.01, rel=CLOSED_FORM)


@pytest.mark.parametrize("exponent", [1.0, 1.2, 1.4])
def test_choked_venting_follows_the_closed_fall(air: Library, exponent: float) -> None:
    """p = p0 (1 + a K t)^(-1/a), a = (n - 1) / 2n: exponential where isothermal."""
    ready = stiff_cylinder(polytropic_exponent=exponent)
    flow = ready.flow
    kernel = kernel_of(air, ready, pressure_demand=380e3)
    kernel.advance(60.0)
    start, temperature = kernel["cylinder_pressure"] + flow.ambient_pressure, kernel["air_temperature_in_cylinder"]
    kernel.set(valve=2)
    area = flow.discharge_coefficient * math.pi / 4 * flow.vent_orifice**2
    fall = exponent * math.sqrt(GAS_CONSTANT * temperature) * area * CHOKED_FLOW / flow.dead_volume
    power = (exponent - 1) / (2 * exponent)
    time = 0.5 / fall
    kernel.advance(time)
    share = math.exp(-fall * time) if exponent == 1.0 else (1 + power * fall * time) ** (-1 / power)
    assert share * start > flow.ambient_pressure / CRITICAL_RATIO  # choked throughout
    assert kernel["cylinder_pressure"] + flow.ambient_pressure == pytest.approx(share * start, rel=CLOSED_FORM)
    assert math.exp(-1.03 * fall * time) * start != pytest.approx(math.exp(-fall * time) * start, rel=CLOSED_FORM)


def test_adiabatic_charging_from_vacuum_heats_the_air_to_kappa_times_the_supply(air: Library) -> None:
    """Textbook limit. Starting from a hundredth of a bar, the error is the share of the initial air."""
    ready = stiff_cylinder(polytropic_exponent=1.4, ambient_pressure=1e3)
    kernel = kernel_of(air, ready, pressure_demand=380e3)
    kernel.advance(60.0)
    assert kernel["air_temperature_in_cylinder"] == pytest.approx(1.4 * 293.15, rel=CLOSED_FORM)


def test_isothermal_air_keeps_its_temperature(air: Library) -> None:
    kernel = kernel_of(air, uic_p(), pressure_demand=380e3)
    for command in ({"pressure_demand": 380e3}, {"pressure_demand": 100e3}, {"valve": 2}):
        kernel.set(**command)
        kernel.advance(8.0)
        assert kernel["air_temperature_in_cylinder"] == pytest.approx(293.15, rel=DRIFT)


# -- balances -------------------------------------------------------------------------------------------------------


def air_in(kernel: Kernel, flow: FlowParameters) -> tuple[float, float]:
    """Return mass [kg] and internal energy p V / (kappa - 1) [J] of the air in the cylinder."""
    volume = flow.dead_volume + flow.piston_area * kernel["piston_travel"]
    return kernel["state_air_mass"], (kernel["cylinder_pressure"] + flow.ambient_pressure) * volume / (KAPPA - 1)


def balances(kernel: Kernel, flow: FlowParameters, before: tuple[float, float]) -> tuple[float, float]:
    """Return the errors of the balances of mass and energy, over the inflow of each."""
    gathered = {name: kernel[f"integral_{name}"] for name in OBSERVED}
    mass, energy = (now - then for now, then in zip(air_in(kernel, flow), before, strict=True))
    mass_missing = gathered["mass_flow_in"] - gathered["mass_flow_out"] - mass
    energy_missing = gathered["enthalpy_in"] - gathered["enthalpy_out"] - energy
    energy_missing -= gathered["piston_work"] + gathered["heat_loss"]
    return mass_missing / gathered["mass_flow_in"], energy_missing / gathered["enthalpy_in"]


@pytest.mark.parametrize("exponent", [1.0, 1.2, 1.4])
def test_mass_and_energy_of_the_air_are_balanced(air: Library, exponent: float) -> None:
    """Through stroke, filling, partial release, hold and vent; the piston moves both ways."""
    ready = with_dump_valve(uic_p())
    ready = replace(ready, flow=replace(ready.flow, polytropic_exponent=exponent))
    kernel = kernel_of(air, ready, tolerance=TIGHT, pressure_demand=380e3)
    kernel.initialise()
    wrong = replace(ready.flow, dead_volume=ready.flow.dead_volume * (1 + 1e-6))
    before, wrong_before = air_in(kernel, ready.flow), air_in(kernel, wrong)
    commands: list[dict[str, float]] = [{"valve": 0}, {"pressure_demand": 200e3}, {"valve": 1}, {"valve": 2}]
    for command in commands:
        kernel.set(**command)
        kernel.advance(5.0)
        mass, energy = balances(kernel, ready.flow, before)
        assert abs(mass) < BALANCE
        assert abs(energy) < BALANCE
        # A millionth of the dead volume would be detected.
        if command != {"valve": 2}:
            assert abs(balances(kernel, wrong, wrong_before)[1]) > BALANCE


def test_work_on_the_piston_is_that_of_the_spring_and_of_the_surroundings(air: Library) -> None:
    """Work against ambient air and spring, until the shoes touch."""
    ready = uic_p()
    flow = ready.flow
    kernel = kernel_of(air, ready, tolerance=1e-9, pressure_demand=380e3)
    kernel.advance(20.0)
    stroke = flow.piston_slack
    spring = flow.spring_preload * stroke + flow.spring_stiffness * stroke**2 / 2
    work = spring + flow.ambient_pressure * flow.piston_area * stroke
    assert kernel["piston_travel"] == pytest.approx(stroke, rel=1e-3)
    assert kernel["integral_piston_work"] == pytest.approx(work, rel=CLOSED_FORM)


def test_hold_keeps_mass_and_pressure_to_the_last_bit(air: Library) -> None:
    kernel = kernel_of(air, uic_p(), pressure_demand=380e3)
    kernel.advance(2.0)
    kernel.set(valve=1)
    before = kernel["state_air_mass"], kernel["cylinder_pressure"]
    kernel.advance(600.0)
    assert (kernel["state_air_mass"], kernel["cylinder_pressure"]) == before

"""Compare times and restrictions of the built-in sets, with both kinds of pneumatics, with the standards."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import pytest

from brake_controller.cylinder import TIMES
from brake_controller.ready_sets import (
    DUMP,
    UIC_G,
    UIC_P,
    UIC_PRESSURE,
    UIC_RELEASED,
    ReadySet,
    Timing,
    qr30_experiment,
    uic_g,
    uic_p,
    with_dump_valve,
)
from brake_controller.timing import (
    application_time,
    emptying_time,
    release_time,
    vent_time,
    with_application_time,
    with_release_time,
)
from fmu_src.kernel import Kernel, Library

#: Tolerance of a time from a restriction, and of a restriction from a time.
INVERSION = 5e-3
#: Error of a pressure at the tolerance of 1e-6 of 1e5 Pa per step, over some hundred steps.
PRESSURE_ERROR = 30.0
TIMED, FLOW = 1, 2


def kernel_of(brake: Library, ready: ReadySet, cylinder_model: int, **values: float) -> Kernel:
    without = TIMES if cylinder_model == FLOW else ready.flow.values()
    given = {name: value for name, value in ready.values().items() if name not in without}
    return Kernel(brake, cylinder_model=cylinder_model, **given | values)


@pytest.mark.parametrize("seconds", [0.5, 4.0, 30.0])
def test_restriction_found_from_a_time_gives_that_time(brake: Library, seconds: float) -> None:
    """Compare with quadrature and simulation, with a stroke of the piston on the way."""
    ready = uic_p()
    flow = with_application_time(ready.flow, UIC_PRESSURE, seconds)
    flow = with_release_time(flow, UIC_PRESSURE, 2 * seconds)
    assert application_time(flow, UIC_PRESSURE) == pytest.approx(seconds, rel=INVERSION)
    assert release_time(flow, UIC_PRESSURE) == pytest.approx(2 * seconds, rel=INVERSION)
    kernel = kernel_of(brake, replace(ready, flow=flow), FLOW, pressure_demand=UIC_PRESSURE)
    kernel.advance(seconds)
    assert kernel["cylinder_pressure"] == pytest.approx(0.95 * UIC_PRESSURE, rel=INVERSION)
    kernel.advance(3 * seconds)
    kernel.set(pressure_demand=0.0)
    kernel.advance(2 * seconds)
    assert kernel["cylinder_pressure"] == pytest.approx(0.05 * UIC_PRESSURE, rel=INVERSION)
    # A restriction that is one per cent wider is two per cent faster.
    wider = replace(flow, application_orifice=1.01 * flow.application_orifice)
    assert application_time(wider, UIC_PRESSURE) != pytest.approx(seconds, rel=INVERSION)


@pytest.mark.parametrize("orifice", [1e-3, 3e-3])
def test_time_found_from_a_restriction_gives_that_restriction(orifice: float) -> None:
    flow = replace(uic_p().flow, application_orifice=orifice, release_orifice=orifice)
    back = with_application_time(uic_p().flow, 300e3, application_time(flow, 300e3))
    assert back.application_orifice == pytest.approx(orifice, rel=INVERSION)
    back = with_release_time(uic_p().flow, 300e3, release_time(flow, 300e3, 50e3), 50e3)
    assert back.release_orifice == pytest.approx(orifice, rel=INVERSION)


@pytest.mark.parametrize("exponent", [1.0, 1.4])
def test_times_by_quadrature_are_those_of_the_simulation(brake: Library, exponent: float) -> None:
    ready = uic_g()
    ready = replace(ready, flow=replace(ready.flow, polytropic_exponent=exponent))
    kernel = kernel_of(brake, ready, FLOW, pressure_demand=UIC_PRESSURE)
    kernel.advance(application_time(ready.flow, UIC_PRESSURE))
    assert kernel["cylinder_pressure"] == pytest.approx(0.95 * UIC_PRESSURE, abs=PRESSURE_ERROR)
    kernel.advance(200.0)
    kernel.set(valve=2)
    kernel.advance(emptying_time(ready.flow, ready.flow.vent_orifice, UIC_PRESSURE, UIC_RELEASED))
    assert kernel["cylinder_pressure"] == pytest.approx(UIC_RELEASED, abs=PRESSURE_ERROR)


@pytest.mark.parametrize("cylinder_model", [TIMED, FLOW])
@pytest.mark.parametrize(("ready", "timing"), [(uic_p(), UIC_P), (uic_g(), UIC_G)])
def test_uic_sets_keep_the_windows(brake: Library, ready: ReadySet, timing: Timing, cylinder_model: int) -> None:
    kernel = kernel_of(brake, ready, cylinder_model, pressure_demand=UIC_PRESSURE)
    kernel.advance(timing.application.shortest)
    assert kernel["cylinder_pressure"] < 0.95 * UIC_PRESSURE
    kernel.advance(timing.application.longest - timing.application.shortest)
    assert kernel["cylinder_pressure"] > 0.95 * UIC_PRESSURE
    kernel.advance(timing.application.longest)
    kernel.set(pressure_demand=0.0)
    kernel.advance(timing.release.shortest)
    assert kernel["cylinder_pressure"] > UIC_RELEASED
    kernel.advance(timing.release.longest - timing.release.shortest)
    assert kernel["cylinder_pressure"] < UIC_RELEASED


@pytest.mark.parametrize("pressure", [130, 150, 180])
def test_experiment_reaches_its_pressure_in_the_printed_time_by_flow_too(brake: Library, pressure: int) -> None:
    kernel = kernel_of(brake, qr30_experiment(pressure), FLOW, pressure_demand=1e3 * pressure)
    kernel.advance(0.8)
    assert kernel["cylinder_pressure"] == pytest.approx(0.95e3 * pressure, rel=INVERSION)


def test_dump_valve_vents_within_its_window_and_leaves_the_release_as_it_was(brake: Library) -> None:
    ready = with_dump_valve(uic_p())
    assert DUMP.shortest < vent_time(ready.flow, UIC_PRESSURE, UIC_RELEASED) < DUMP.longest
    assert release_time(ready.flow, UIC_PRESSURE, UIC_RELEASED) == pytest.approx(17.5, rel=INVERSION)
    kernel = kernel_of(brake, ready, FLOW, pressure_demand=UIC_PRESSURE)
    kernel.advance(10.0)
    kernel.set(valve=2)
    kernel.advance(DUMP.middle)
    assert kernel["cylinder_pressure"] == pytest.approx(UIC_RELEASED, rel=INVERSION)
    kernel.set(valve=0)
    kernel.advance(10.0)
    assert kernel["cylinder_pressure"] == pytest.approx(UIC_PRESSURE, rel=INVERSION)


def test_lost_demand_applies_the_brake_by_flow_too(brake: Library) -> None:
    for signal in ({}, {"pressure_demand": math.nan}):
        kernel = kernel_of(brake, uic_p(), FLOW)
        if signal:
            kernel.set(pressure_demand=0.0)
            kernel.advance(1.0)
            assert kernel["cylinder_pressure"] == pytest.approx(0.0, abs=1e-6)
            kernel.set(**signal)
        kernel.advance(30.0)
        # A lost signal applies the supply pressure of the FMU's default set, 350 kPa.
        assert kernel["cylinder_pressure"] == pytest.approx(350e3, rel=1e-6)


def test_regulator_holds_any_demand_from_above_and_from_below(brake: Library) -> None:
    kernel = kernel_of(brake, uic_p(), FLOW, pressure_demand=100e3)
    for demand in (100e3, 300e3, 900e3, 200e3, 0.0):
        kernel.set(pressure_demand=demand)
        kernel.advance(60.0)
        assert kernel["cylinder_pressure"] == pytest.approx(min(demand, UIC_PRESSURE), rel=1e-4, abs=PRESSURE_ERROR)


@pytest.mark.parametrize("cylinder_model", [TIMED, FLOW])
def test_pressure_only_rises_while_it_is_applied_and_only_falls_while_it_is_released(
    brake: Library, cylinder_model: int
) -> None:
    ready = uic_p()
    kernel = kernel_of(brake, ready, cylinder_model, pressure_demand=UIC_PRESSURE)
    rising = kernel.record(10.0, 0.05, ["cylinder_pressure", "shoe_force"])
    kernel.set(pressure_demand=0.0)
    falling = kernel.record(30.0, 0.05, ["cylinder_pressure", "shoe_force"])
    for name in ("cylinder_pressure", "shoe_force"):
        assert all(b - a > -1e-6 * max(rising[name]) for a, b in pairwise(rising[name]))
        assert all(b - a < 1e-6 * max(rising[name]) for a, b in pairwise(falling[name]))


def test_shoes_press_only_after_the_piston_has_taken_up_the_slack(brake: Library) -> None:
    """Eqs (2.4) and (2.6) with the return spring as counter-force: eta i_t (p A - F_spring)."""
    ready = uic_p()
    flow, rigging = ready.flow, ready.rigging
    touch = (flow.spring_preload + flow.spring_stiffness * flow.piston_slack) / flow.piston_area
    kernel = kernel_of(brake, ready, FLOW, pressure_demand=0.9 * touch)
    kernel.advance(100.0)
    full = kernel_of(brake, ready, FLOW, pressure_demand=UIC_PRESSURE)
    full.advance(30.0)
    per_pressure = rigging.force_per_pressure * rigging.wheelset_share * rigging.rigging_efficiency
    assert kernel["shoe_force"] < 1e-3 * full["shoe_force"]
    assert full["shoe_force"] == pytest.approx(per_pressure * (UIC_PRESSURE - touch), rel=1e-3)
    assert full["shoe_force"] != pytest.approx(per_pressure * UIC_PRESSURE, rel=1e-3)


#: Error of the integration, 1e-6 of the pressure, as a share of the full shoe force.
SPRING_ERROR = 1e-6


@pytest.mark.parametrize("ready", [qr30_experiment(180), uic_p(), uic_g()], ids=["QR30", "UIC P", "UIC G"])
@pytest.mark.parametrize("share", [0.02, 0.5, 1.0])
def test_shoe_force_at_a_pressure_is_the_same_by_time_and_by_flow(
    brake: Library, ready: ReadySet, share: float
) -> None:
    """Eq. (2.4): the return spring takes 300 N of the thrust of a UIC cylinder in both; at 2 % it takes all of it."""
    demand = share * ready.rigging.supply_pressure
    forces = []
    for cylinder_model in (TIMED, FLOW):
        kernel = kernel_of(brake, ready, cylinder_model, pressure_demand=demand)
        kernel.advance(400.0)
        assert kernel["cylinder_pressure"] == pytest.approx(demand, rel=1e-6)
        forces.append(kernel["shoe_force"])
    rigging = ready.rigging
    full = rigging.force_per_pressure * rigging.wheelset_share * rigging.rigging_efficiency * rigging.supply_pressure
    assert forces[0] == pytest.approx(forces[1], abs=SPRING_ERROR * full)
    assert (forces[0] == 0.0) == (demand < rigging.touch_pressure)


def test_fully_applied_uic_brake_presses_with_what_the_spring_leaves(brake: Library) -> None:
    """0.95 x 6 / 2 x (380 kPa x 346 cm2 - 300 N) on one of two wheelsets: 36.6 kN, not 37.5."""
    kernel = kernel_of(brake, uic_p(), TIMED, pressure_demand=UIC_PRESSURE)
    kernel.advance(100.0)
    assert kernel["shoe_force"] == pytest.approx(0.95 * 3 * (380e3 * 346e-4 - 300.0), rel=1e-6)


def test_time_that_no_restriction_gives_is_refused() -> None:
    with pytest.raises(ValueError, match="The time must be above 0 s; got 0 s"):
        with_application_time(uic_p().flow, UIC_PRESSURE, 0.0)

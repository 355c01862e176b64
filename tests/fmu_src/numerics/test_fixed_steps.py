"""Steps of a fixed size: all have the same cost, and switches within a step take effect at its end."""

from __future__ import annotations

import platform
import re
from collections.abc import Callable
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from fmu_src.compile import build_library
from fmu_src.kernel import DISCARD, Kernel, Library, SimulationError
from fmu_src.system import System, Variable, model_of
from products.dry_stops import DryStop, stop_of
from products.kernel_runs import prepare, value_at
from tests.conftest import Fmus
from tests.fmu_src.numerics.counted_steps import CASES, HostError, Steps, make_steps
from tests.needed import needed

#: Limit of the ratio of the largest to the median number of instructions of a step.
SPREAD = 1.3
METHODS = {1: "RODAS5P", 2: "ROS34PW2"}


def small(write: Callable[[System], None], tolerance: float = 1e-2) -> Library:
    system = System("small", "a small system")
    write(system)
    return Library(build_library(model_of(system, tolerance)))


def stopped(stop: DryStop, host_step: float = 1e-2, **values: float) -> Kernel:
    """Return a bogie at the end of a stop; its inputs are ramps within each communication step."""
    kernel = prepare("bogie", **stop.values | values)
    kernel.set(**{name: value_at(history, 0.0, after=True) for name, history in stop.inputs.items()})
    kernel.initialise()
    for number in range(round(stop.seconds / host_step)):
        begin, end = number * host_step, (number + 1) * host_step
        for name, history in stop.inputs.items():
            first, last = value_at(history, begin, after=True), value_at(history, end, after=False)
            kernel.set(**{name: first})
            kernel.set_rate(**{name: (last - first) / host_step})
        kernel.step(begin, host_step)
    return kernel


def when(kernel: Kernel, words: str) -> float:
    """Return the time of the first message on the leading wheelset in the log [s]."""
    found = re.search(rf"Wheelset 1 {words} at (\S+) s\.", " ".join(kernel.messages))
    assert found
    return float(found[1])


# ---- cost ------------------------------------------------------------------------------------------------------------


def counted(fmus: Fmus, case: str, step: float = 1e-3, **values: float) -> Steps:
    needed("valgrind", packages="valgrind")
    name, wheelsets, chosen = CASES[case]
    values = {"integration_step": step} | values
    stop = replace(stop_of(wheelsets, **chosen, **values), step=step)
    steps = make_steps(fmus[name, "native"], stop, counted=True)
    locked = steps.outputs["locked_1"]
    assert np.abs(np.diff(locked)).sum() == 2  # locked and released
    assert steps.instructions.size == locked.size
    if chosen["level"] == 3:
        assert np.abs(steps.outputs["flange_force_1"]).max() > 1e4
    return steps


@pytest.mark.study
def test_no_step_of_a_stop_with_lock_up_and_release_costs_much_more_than_another(fmus: Fmus) -> None:
    """The limit has to detect error control, under which steps that locate events cost more.

    valgrind writes a file after each step, so that a quarter of the steps takes a quarter of the time.
    """
    assert counted(fmus, "bogie planar", 4e-3).spread <= SPREAD
    assert counted(fmus, "bogie planar", 4e-3, integration_step=0.0).spread > 4 * SPREAD


@pytest.mark.long
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("case", CASES)
def test_no_step_costs_much_more_than_another_at_any_level(fmus: Fmus, case: str, method: int) -> None:
    """Level 3 includes flange contact."""
    assert counted(fmus, case, integration_method=method).spread <= SPREAD


@pytest.mark.study
@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="the host counts calls of glibc")
@pytest.mark.parametrize("case", ["bogie point", "bogie spatial, model 2"])
def test_steps_take_no_memory_and_no_lock_and_call_no_system(fmus: Fmus, case: str) -> None:
    """seccomp kills a host that makes a system call within a step. The test checks this by such a call of the host."""
    name, wheelsets, chosen = CASES[case]
    stop = stop_of(wheelsets, **chosen)
    for step in (1e-3, 0.0):
        values = {**stop.values, "integration_step": step}
        steps = make_steps(fmus[name, "native"], DryStop(values, stop.inputs, stop.seconds, stop.read), guard="guarded")
        assert steps.memory[0] > 0
        assert steps.memory[1] == steps.locks[1] == 0
    with pytest.raises(HostError, match="ended with -9"):
        make_steps(fmus[name, "native"], stop, guard="calling")


# ---- what it costs in accuracy ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", METHODS)
def test_events_are_late_by_at_most_a_step_and_the_stop_is_right_to_first_order(method: int) -> None:
    """The limits are twice the measured errors: of the distance, 1.1 mm at 2 ms and 0.2 mm at 0.5 ms."""
    stop = stop_of(2, level=2)
    exact = stopped(stop, integration_step=0.0, tolerance=1e-9)
    for step in (2e-3, 5e-4):
        found = stopped(stop, integration_step=step, integration_method=method)
        for words in ("locked", "turns again"):
            assert 0.0 <= when(found, words) - when(exact, words) <= 1.05 * step
        assert abs(found["distance"] - exact["distance"]) < 1.0 * step
        assert found.counts["rejected"] == 0
        assert found.counts["steps"] == found.counts["jacobians"] - 1 == round(stop.seconds / step)


@pytest.mark.study
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("level", [1, 2, 3])
@pytest.mark.parametrize("step", [5e-3, 1e-3, 2e-4])
def test_a_stop_with_fixed_steps_comes_to_rest(level: int, step: float, method: int) -> None:
    values = {"initial_speed": 3.0, "brake_torque_1": 24e3, "brake_torque_2": 20e3, "tolerance": 1e-2}
    kernel = prepare("bogie", level=level, integration_step=step, integration_method=method, **values)
    kernel.advance(4.0)
    assert kernel["speed"] == 0.0
    assert kernel["angular_velocity_1"] == kernel["angular_velocity_2"] == 0.0
    assert len(kernel.messages) < 20


def test_a_velocity_that_a_friction_cannot_hold_goes_on_through_zero() -> None:
    """A spring pulls a mass back harder than its friction can hold; later the friction is larger and holds."""

    def write(system: System) -> None:
        x, v = system.state("x", "m", 0.0, 1.0), system.state("v", "m/s", 1.0, 1.0)
        capacity = system.input(Variable("capacity", "input", "N", "friction", 0.1))
        direction = system.direction("direction")
        system.derivative(x, v)
        system.derivative(v, direction**2 * (-x - direction * capacity))
        system.dry_friction("mass", direction, [v], -x, capacity, ("sticks", "slides"))
        system.output(Variable("place", "output", "m", "x"), x)

    made, ends = small(write), []
    for step in (0.0, 1e-2, 1e-3):
        kernel = Kernel(made, integration_step=step, tolerance=1e-2 if step else 1e-10)
        table = kernel.record(4.0, 0.5, ["place", "state_v"])
        assert table["state_v"][5] < -0.5
        kernel.set(capacity=2.0)
        kernel.advance(4.0)
        assert kernel["state_v"] == 0.0
        ends.append(kernel["place"])
    assert abs(ends[1] - ends[0]) < 2e-2
    assert abs(ends[2] - ends[0]) < 2e-3


def test_a_jump_of_an_input_is_solved_for_within_a_step() -> None:
    """Algebraic states are corrected once a step. The stages of the method resolve the rest."""

    def write(system: System) -> None:
        level = system.input(Variable("level", "input", "1", "level", 4.0))
        x = system.state("x", "1", 0.0, 1.0)
        root = system.algebraic("root", "1", 1.0, 1.0)
        system.derivative(x, root + 0 * x)
        system.residual(root, root**2 - level)
        system.output(Variable("root_now", "output", "1", "root"), root)
        system.output(Variable("x_now", "output", "1", "x"), x)

    made = small(write)
    for method in METHODS:
        errors = []
        for step in (1e-2, 5e-3):
            kernel = Kernel(made, integration_step=step, integration_method=method)
            kernel.advance(1.0)
            kernel.set(level=9.0)
            kernel.advance(1.0)
            assert kernel["root_now"] == pytest.approx(3.0, abs=1e-6)
            assert kernel.counts["steps"] == round(2.0 / step)
            errors.append(abs(kernel["x_now"] - 5.0))
        assert errors[1] < 0.6 * errors[0] < 0.6 * 1e-2


def test_the_end_of_a_run_is_that_of_the_step_it_falls_into() -> None:
    def write(system: System) -> None:
        x = system.state("x", "1", 0.0, 1.0)
        system.derivative(x, ca.SX(1.0))
        system.end_when_negative(0.55 - x, "It is over at %s s.")
        system.output(Variable("x_now", "output", "1", "x"), x)

    kernel = Kernel(small(write), integration_step=0.1)
    with pytest.raises(SimulationError, match=r"It is over at 0\.6 s") as ended:
        kernel.advance(2.0)
    assert ended.value.status == DISCARD
    assert kernel.time == pytest.approx(0.6)
    assert kernel["x_now"] == pytest.approx(0.6)


def test_saved_state_goes_on_with_the_same_bits_amid_fixed_steps() -> None:
    stop = stop_of(2, level=2)
    kernel, other = (prepare("bogie", **stop.values) for _ in range(2))
    for one in (kernel, other):
        one.set(brake_torque_1=60e3)
        one.initialise()
    for number in range(300):
        kernel.step(number * 1e-3, 1e-3)
    other.restore(kernel.save())
    for number in range(300, 900):
        for one in (kernel, other):
            one.set(brake_torque_1=60e3 if number < 500 else 5e3)
            one.step(number * 1e-3, 1e-3)
    assert kernel.save() == other.save()
    assert kernel.counts["events"] > 1


def test_records_show_what_stands_at_the_ends_of_steps() -> None:
    """Rows at the ends of steps show the state there; velocities that have crossed zero are zero."""
    values = {"initial_speed": 0.5, "brake_torque_1": 24e3, "brake_torque_2": 24e3}
    kernel = prepare("bogie", level=2, integration_step=1e-3, tolerance=1e-2, **values)
    table = kernel.record(1.0, 1e-3, ["speed", "state_angular_velocity_1"])
    turning = np.array(table["state_angular_velocity_1"])
    assert turning.min() == turning[-1] == 0.0
    assert not turning[np.argmin(turning) :].any()

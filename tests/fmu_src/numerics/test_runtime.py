"""The C runtime on small systems with known solutions: integration, algebraic states, tables, friction, ends."""

from __future__ import annotations

import math
from collections.abc import Callable

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fmu_src.compile import build_library
from fmu_src.equations import functions
from fmu_src.kernel import DISCARD, ERROR, Kernel, Library, SimulationError
from fmu_src.piecewise import interpolation
from fmu_src.system import System, Variable, model_of

#: Theory: RODAS5P (Steinebach 2023), ROS34PW2 with any matrix (Rang and Angermann 2005), Runge-Kutta.
ORDERS, ORDER_BAND = {1: 5.0, 2: 3.0, 3: 4.0}, 0.2


def real(name: str, causality: str, start: float = 0.0, **more: float) -> Variable:
    return Variable(name, causality, "1", name, start, **more)  # type: ignore[arg-type]


def library(write: Callable[[System], None], tolerance: float = 1e-8) -> Library:
    system = System("small", "a small system")
    write(system)
    return Library(build_library(model_of(system, tolerance)))


def oscillator(system: System, nominal: float = 1.0) -> None:
    """A nonlinear pendulum with a time-dependent drive."""
    angle = system.state("angle", "rad", 1.0, nominal)
    rate = system.state("rate", "rad/s", 0.0, nominal)
    system.derivative(angle, rate)
    system.derivative(rate, -ca.sin(angle) + ca.cos(3 * system.time))
    system.output(real("angle", "output"), angle)
    system.output(real("rate", "output"), rate)


def reference(angle: float, rate: float, end: float) -> np.ndarray:
    solution = solve_ivp(
        lambda t, y: [y[1], -math.sin(y[0]) + math.cos(3 * t)],
        (0.0, end),
        [angle, rate],
        "DOP853",
        rtol=1e-13,
        atol=1e-13,
    )
    return np.asarray(solution.y[:, -1])


@pytest.mark.parametrize(("method", "order"), ORDERS.items())
def test_error_of_fixed_steps_falls_with_the_order_of_the_method(method: int, order: float) -> None:
    made = library(oscillator, tolerance=1e-2)
    sizes = [2.0 / n for n in (40, 80, 160, 320)]
    exact, errors = reference(1.0, 0.0, 2.0), []
    for size in sizes:
        kernel = Kernel(made, integration_method=method, integration_step=size)
        kernel.advance(2.0)
        assert kernel.counts["steps"] == round(2.0 / size)
        errors.append(np.abs(np.array([kernel["angle"], kernel["rate"]]) - exact).max())
    slope = np.polyfit(np.log(sizes), np.log(errors), 1)[0]
    assert slope == pytest.approx(order, abs=ORDER_BAND)


def test_tolerance_controls_the_error_against_another_method() -> None:
    made = library(oscillator)
    exact = reference(1.0, 0.0, 20.0)
    errors = {}
    for tolerance in (1e-5, 1e-7, 1e-9):
        kernel = Kernel(made, tolerance=tolerance)
        kernel.advance(20.0)
        errors[tolerance] = np.abs(np.array([kernel["angle"], kernel["rate"]]) - exact).max()
        assert errors[tolerance] < 100 * tolerance
    assert errors[1e-9] < 1e-2 * errors[1e-5]


def test_stiff_solution_is_followed_with_steps_far_above_the_time_constant() -> None:
    """Prothero and Robinson: x' = -1e6 (x - cos t) - sin t, so x = cos t."""

    def write(system: System) -> None:
        x = system.state("x", "1", 1.0, 1.0)
        system.derivative(x, -1e6 * (x - ca.cos(system.time)) - ca.sin(system.time))
        system.output(real("x", "output"), x)

    kernel = Kernel(library(write, tolerance=1e-6))
    kernel.advance(10.0)
    assert kernel["x"] == pytest.approx(math.cos(10.0), abs=1e-6)
    assert kernel.counts["steps"] < 500  # an explicit method needs about 4 million


def test_recording_does_not_change_the_steps_and_is_accurate_between_them() -> None:
    made = library(oscillator, tolerance=1e-7)
    plain, recorded = Kernel(made), Kernel(made)
    plain.advance(5.0)
    table = recorded.record(5.0, 0.01, ["angle"])
    assert recorded.counts["steps"] == plain.counts["steps"]
    assert recorded["angle"] == plain["angle"]
    exact = solve_ivp(
        lambda t, y: [y[1], -math.sin(y[0]) + math.cos(3 * t)],
        (0.0, 5.0),
        [1.0, 0.0],
        "DOP853",
        t_eval=table["time"],
        rtol=1e-12,
        atol=1e-12,
    ).y[0]
    assert np.abs(np.array(table["angle"]) - exact).max() < 2e-5


def test_jacobian_is_that_of_finite_differences() -> None:
    system = System("small", "a small system")
    oscillator(system)
    made = {name: one.function for name, one in functions(system).items()}
    states = np.array([0.4, -0.7])
    arguments = [0.3, states] + [ca.DM.zeros(*made["ode"].size_in(i)) for i in range(2, 8)]
    pattern = system.jacobian(system.ode, system.arguments[1]).sparsity()
    jacobian = np.array(ca.DM(pattern, made["jacobian"](*arguments)[0]))
    step = 1e-6
    for column in range(2):
        moved = [states + sign * step * np.eye(2)[column] for sign in (1, -1)]
        values = [np.array(made["ode"](0.3, x, *arguments[2:])).ravel() for x in moved]
        assert jacobian[:, column] == pytest.approx((values[0] - values[1]) / (2 * step), abs=1e-8)


def integrator(system: System) -> None:
    u = system.input(real("u", "input", minimum=-10.0, maximum=10.0))
    x = system.state("x", "1", 0.0, 1.0)
    system.derivative(x, u)
    system.output(real("x", "output"), x)
    system.output(real("u_seen", "output"), u)


def test_input_rate_makes_an_exact_ramp() -> None:
    kernel = Kernel(library(integrator), u=1.0)
    kernel.initialise()
    kernel.set_rate(u=2.0)
    kernel.step(0.0, 3.0)
    assert kernel["x"] == pytest.approx(3.0 + 9.0, rel=1e-12)
    assert kernel["u"] == pytest.approx(7.0)
    kernel.step(3.0, 1.0)  # the rate is in force for one step only
    assert kernel["x"] == pytest.approx(19.0, rel=1e-12)


def test_ramp_that_would_leave_the_limits_is_refused_and_nothing_moves() -> None:
    kernel = Kernel(library(integrator), u=1.0)
    kernel.initialise()
    kernel.set_rate(u=20.0)
    with pytest.raises(SimulationError, match="at most 10"):
        kernel.step(0.0, 1.0)
    assert (kernel.time, kernel["x"]) == (0.0, 0.0)


def test_equations_without_a_finite_solution_end_in_a_sentence_and_keep_the_last_good_state() -> None:
    def write(system: System) -> None:
        x = system.state("x", "1", 1.0, 1.0)
        system.derivative(x, -1 / ca.sqrt(x))  # reaches 0 at t = 2/3 and is NaN beyond
        system.output(real("x", "output"), x)

    kernel = Kernel(library(write))
    kernel.advance(0.5)
    before = kernel["x"]
    with pytest.raises(SimulationError, match="step size vanished") as caught:
        kernel.advance(0.5)
    assert caught.value.status == ERROR
    assert kernel["x"] == before == pytest.approx(0.25 ** (2 / 3), rel=1e-6)
    assert kernel.time == 0.5


def test_table_is_the_piecewise_polynomial_and_holds_its_ends() -> None:
    rng = np.random.default_rng(1)
    breaks, coefficients = np.array([0.0, 0.5, 1.5, 2.0]), rng.normal(size=(3, 4))

    def write(system: System) -> None:
        u = system.input(real("u", "input"))
        x = system.state("x", "1", 0.0, 1.0)
        system.derivative(x, 0 * x)
        system.output(real("value", "output"), system.table("polynomial", breaks, coefficients, u))
        system.output(real("line", "output"), system.table("line", *interpolation([0, 1, 3], [2.0, 4.0, 0.0]), u))

    kernel = Kernel(library(write))
    kernel.initialise()
    for at in np.linspace(-1.0, 4.0, 101):
        kernel.set(u=at)
        clipped = min(max(at, breaks[0]), breaks[-1])
        piece = min(int(np.searchsorted(breaks, clipped, "right")) - 1, 2)
        exact = np.polyval(coefficients[piece][::-1], clipped - breaks[piece])
        assert kernel["value"] == pytest.approx(exact, abs=1e-12)
        assert kernel["line"] == pytest.approx(np.interp(at, [0, 1, 3], [2.0, 4.0, 0.0]), abs=1e-12)


def constrained_pendulum(system: System) -> None:
    """A rod of 1 m in Cartesian coordinates: height, vertical velocity and tension are algebraic states."""
    x = system.state("x", "m", 0.5, 1.0)
    u = system.state("u", "m/s", 0.0, 1.0)
    y = system.algebraic("y", "m", -1.0, 1.0)
    v = system.algebraic("v", "m/s", 0.0, 1.0)
    tension = system.algebraic("tension", "m/s2", 9.0, 10.0)
    system.derivative(x, u)
    system.derivative(u, -tension * x)
    system.residual(y, x**2 + y**2 - 1)
    system.residual(v, x * u + y * v)
    system.residual(tension, -tension * (x**2 + y**2) - 9.81 * y + u**2 + v**2)
    system.output(real("x", "output"), x)
    system.output(real("gap", "output"), x**2 + y**2 - 1)


def test_algebraic_states_follow_their_equations_and_the_order_stays_four() -> None:
    angle = solve_ivp(
        lambda t, a: [a[1], -9.81 * math.sin(a[0])], (0.0, 3.0), [math.asin(0.5), 0.0], "DOP853", rtol=1e-13, atol=1e-13
    ).y[0, -1]
    errors, steps = [], []
    for tolerance in (1e-7, 1e-9, 1e-11):
        kernel = Kernel(library(constrained_pendulum), tolerance=tolerance)
        kernel.advance(3.0)
        errors.append(abs(kernel["x"] - math.sin(angle)))
        steps.append(kernel.counts["steps"])
        assert abs(kernel["gap"]) <= 10 * tolerance  # local error of one step; it does not accumulate
    slope = -np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert slope > ORDERS[1] - 0.5
    assert errors[-1] < 1e-8


@pytest.mark.parametrize(("method", "step"), [(2, 0.0), (2, 2e-3), (3, 2e-3)])
def test_every_method_solves_for_more_algebraic_states_than_half(method: int, step: float) -> None:
    """Three algebraic states and two others: each method, short communication steps, and records between steps."""
    angle = solve_ivp(
        lambda t, a: [a[1], -9.81 * math.sin(a[0])], (0.0, 1.0), [math.asin(0.5), 0.0], "DOP853", rtol=1e-13, atol=1e-13
    ).y[0, -1]
    made = library(constrained_pendulum, tolerance=1e-8)
    kernel = Kernel(made, integration_method=method, integration_step=step)
    table = kernel.record(1.0, 0.01, ["x", "gap"])
    assert kernel["x"] == pytest.approx(math.sin(angle), abs=1e-6)
    assert np.abs(table["gap"]).max() < 1e-6
    hosted = Kernel(made)
    for _ in range(1000):
        hosted.advance(1e-3)
    assert hosted["x"] == pytest.approx(math.sin(angle), abs=1e-6)


def test_start_and_a_jump_of_an_input_are_made_consistent() -> None:
    def write(system: System) -> None:
        level = system.input(real("level", "input", 4.0))
        x = system.state("x", "1", 0.0, 1.0)
        root = system.algebraic("root", "1", 1.0, 1.0)
        system.derivative(x, root + 0 * x)
        system.residual(root, root**2 - level)
        system.output(real("x", "output"), x)

    kernel = Kernel(library(write))
    kernel.advance(1.0)
    kernel.set(level=100.0)
    kernel.advance(1.0)
    assert kernel["x"] == pytest.approx(2.0 + 10.0, rel=1e-9)
    kernel.set(level=-1.0)
    with pytest.raises(SimulationError, match=r"The algebraic equations have no solution near t = 2 s"):
        kernel.advance(1.0)
    for _ in range(2):  # x has no value at this level, neither at the first reading nor at the next
        with pytest.raises(SimulationError, match=r"The equations have no solution at t = 2 s with these inputs"):
            print(kernel["x"])
    kernel.set(level=100.0)
    assert kernel["x"] == pytest.approx(12.0, rel=1e-9)
    with pytest.raises(SimulationError, match="no consistent start"):
        Kernel(library(write), level=-1.0).initialise()


def test_a_table_may_have_the_value_of_another_as_its_argument() -> None:
    def write(system: System) -> None:
        x = system.state("x", "1", 0.0, 1.0)
        system.derivative(x, 1.0 + 0 * x)
        inner = system.table("inner", *interpolation([0.0, 1.0, 2.0], [0.0, 3.0, 4.0]), x)
        value, slope = system.curve("outer", *interpolation([0.0, 2.0, 4.0], [1.0, 5.0, 6.0]), inner, 1)
        system.output(real("value", "output"), value)
        system.output(real("slope", "output"), slope)

    kernel = Kernel(library(write))
    for time, value, slope in ((0.5, 4.0, 2.0), (1.5, 5.75, 0.5)):
        kernel.advance(time - kernel.time if kernel.initialised else time)
        assert (kernel["value"], kernel["slope"]) == pytest.approx((value, slope), rel=1e-12)


def test_a_vanishing_diagonal_is_exchanged_for_another_pivot() -> None:
    """Each residual depends on the other's state only: without row exchange the factorisation has no pivot."""

    def write(system: System) -> None:
        x = system.state("x", "1", 1.0, 1.0)
        a = system.algebraic("a", "1", 0.0, 1.0)
        b = system.algebraic("b", "1", 0.0, 1.0)
        system.derivative(x, -a)
        system.residual(a, b - 2 * x)
        system.residual(b, a - b / 2)
        system.output(real("x", "output"), x)

    kernel = Kernel(library(write))
    kernel.advance(1.0)
    assert kernel["x"] == pytest.approx(math.exp(-1.0), rel=1e-7)


def test_saved_state_of_another_model_is_refused() -> None:
    kernel = Kernel(library(sliding_block))
    kernel.advance(1.0)
    before = kernel.save()
    with pytest.raises(SimulationError, match=r"must be of this FMU .* Nothing was restored"):
        kernel.restore(b"\x7f" * len(before))
    assert kernel.save() == before


def sliding_block(system: System) -> None:
    """A block of 1 kg with dry friction, pushed by a force."""
    force = system.input(real("force", "input"))
    capacity = system.input(real("capacity", "input", 2.0, minimum=0.0))
    x = system.state("x", "m", 0.0, 1.0)
    v = system.state("v", "m/s", 3.0, 1.0)
    direction = system.direction("direction")
    system.derivative(x, v)
    system.derivative(v, direction**2 * (force - direction * capacity))
    system.dry_friction("The block", direction, [v], force, capacity, ("stuck", "slides"))
    system.output(real("x", "output"), x)
    system.output(real("v", "output"), v)


def test_friction_stops_sticks_and_releases_at_the_analytic_times() -> None:
    kernel = Kernel(library(sliding_block))
    kernel.advance(5.0)  # 3 m/s with 2 m/s2: stops after 1.5 s and 2.25 m
    assert kernel["v"] == 0.0
    assert kernel["x"] == pytest.approx(2.25, abs=1e-9)
    assert kernel.messages == ["The block stuck at 1.5 s."]
    kernel.set_rate(force=1.0)
    kernel.step(5.0, 4.0)  # the force passes 2 N two seconds later, then v = t^2/2
    assert kernel.messages[-1] == "The block slides at 7 s."
    assert kernel["v"] == pytest.approx(2.0, abs=1e-7)


def test_friction_without_capacity_lets_the_velocity_pass_through_zero() -> None:
    kernel = Kernel(library(sliding_block), capacity=0.0, force=-1.0)
    kernel.advance(6.0)
    assert kernel["v"] == pytest.approx(-3.0, abs=1e-9)
    assert kernel.counts["events"] == 0


def test_friction_that_comes_slowly_against_a_block_that_moves_backward_does_not_stop_it_at_once() -> None:
    kernel = Kernel(library(sliding_block), capacity=0.0, force=-1.0)
    kernel.advance(5.0)  # from 3 to -2 m/s
    kernel.set(force=0.0)
    kernel.set_rate(capacity=0.5)
    kernel.step(5.0, 1.0)
    assert kernel["v"] == pytest.approx(-2.0 + 0.5 / 2, abs=1e-9)


def test_friction_larger_than_the_drive_reverses_nothing_and_smaller_one_turns_the_block_round() -> None:
    kernel = Kernel(library(sliding_block), force=-3.0)
    kernel.advance(1.6)  # decelerates by 5 m/s2, stops at 0.6 s, then slides back with 1 m/s2
    assert kernel["v"] == pytest.approx(-1.0, abs=1e-9)


def test_run_ends_at_the_located_time_with_its_sentence() -> None:
    def write(system: System) -> None:
        x = system.state("x", "1", 0.0, 1.0)
        system.derivative(x, 1.0 + 0 * x)
        system.end_when_negative(1 - x / 2, "The glass was full at %s s.")
        system.output(real("x", "output"), x)

    kernel = Kernel(library(write))
    kernel.advance(1.0)
    with pytest.raises(SimulationError, match=r"The glass was full at 2 s\.") as caught:
        kernel.advance(5.0)
    assert caught.value.status == DISCARD
    assert kernel.ended
    assert kernel.time == pytest.approx(2.0, abs=1e-9)
    with pytest.raises(SimulationError, match="ended at t = 2"):
        kernel.step(kernel.time, 1.0)
    kernel.reset()
    kernel.advance(1.0)
    assert kernel["x"] == pytest.approx(1.0)


def test_saved_state_continues_bit_for_bit() -> None:
    kernel = Kernel(library(sliding_block))
    kernel.advance(1.0)
    saved = kernel.save()

    def onward() -> list[float]:
        kernel.restore(saved)
        found = []
        for _ in range(20):
            kernel.advance(0.07)
            found += [kernel["x"], kernel["v"]]
        return found

    assert onward() == onward()


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"capacity": -1.0}, "capacity must be at least 0"),
        ({"capacity": math.nan}, "capacity must be a finite number"),
        ({"force": math.inf}, "force must be a finite number"),
        ({"x": 1.0}, "x is an output"),
        ({"forse": 1.0}, "did you mean force"),
    ],
)
def test_bad_value_gets_a_sentence_and_the_old_one_stays(values: dict[str, float], sentence: str) -> None:
    kernel = Kernel(library(sliding_block), capacity=1.5)
    with pytest.raises(SimulationError, match=sentence):
        kernel.set(**values)
    assert kernel["capacity"] == 1.5


@pytest.mark.parametrize("size", [0.0, -1.0, math.nan, math.inf])
def test_bad_step_size_advances_nothing(size: float) -> None:
    kernel = Kernel(library(sliding_block))
    kernel.initialise()
    with pytest.raises(SimulationError, match="The step must be above 0 s"):
        kernel.step(0.0, size)
    assert (kernel.time, kernel["v"]) == (0.0, 3.0)


def test_step_from_another_time_is_refused() -> None:
    kernel = Kernel(library(sliding_block))
    kernel.advance(1.0)
    with pytest.raises(SimulationError, match="The step must begin at t = 1 s"):
        kernel.step(3.0, 0.1)


def test_candidate_of_a_warning_changes_nothing_of_what_is_said() -> None:
    """A candidate only saves time: the message comes at the zero of the margin, with or without it."""

    def write(system: System) -> None:
        x = system.state("x", "s", 0.0, 1.0)
        system.derivative(x, ca.SX(1.0))
        system.limit_change(ca.SX(0.1), x)
        system.warn_when_negative(3.0 - x, "Plain at %s s.")
        system.warn_when_negative(3.0 - x, "Costly at %s s.", candidate=2.0 - x)
        system.warn_when_negative(5.0 - x, "Never at %s s.", candidate=2.0 - x)
        system.output(Variable("x", "output", "s", "x"), x)

    kernel = Kernel(library(write))
    kernel.advance(4.0)
    said = {line.split(" at ")[0]: float(line.split(" at ")[1].split()[0]) for line in kernel.messages}
    assert set(said) == {"Plain", "Costly"}
    assert said["Plain"] == said["Costly"]
    assert 3.0 < said["Plain"] < 3.2


def test_an_equation_of_what_is_no_state_is_refused() -> None:
    """Equations accept the symbol of a state, but no name, expression or symbol of another system."""
    one, other = System("one", "a state"), System("other", "a state of the same name")
    x = one.state("x", "1", 0.0, 1.0)
    for wrong in (2 * x, other.state("x", "1", 0.0, 1.0)):
        with pytest.raises(ValueError, match=r"is not a state of one; give the symbol that state\(\) or algebraic\(\)"):
            one.derivative(wrong, x)

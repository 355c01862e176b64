"""Integration methods and steps that users can select: orders, guards, reuse of the Jacobian, largest changes."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from evidence.measuring.runs import layout, own
from evidence.measuring.scenes import LOCK_UP, ON_PATCHES, SCENES, SMOOTH, Scene, difference
from evidence.peers import sundials
from evidence.peers.exchange import IN_THE_PLANE, exchange
from evidence.peers.scipy_methods import scipy
from evidence.peers.work_precision import in_the_plane, reference_of
from fmu_src.compile import build_library
from fmu_src.kernel import ERROR, Kernel, Library, SimulationError
from fmu_src.system import System, Variable, model_of
from products.kernel_runs import RIGID, prepare
from rbd_model.vehicle.parameters import tables_4_1_and_4_2, tables_5_1_and_5_2

#: Tolerance of the orders by docs/checking.md.
ORDER_BAND = 0.2
ORDERS = {1: 5.0, 2: 3.0, 3: 4.0}


@pytest.mark.parametrize(("method", "order"), ORDERS.items())
def test_order_on_the_smooth_stop_is_that_of_theory(method: int, order: float) -> None:
    """Parts of a stop at the planar level after the jump of the torque. Errors change their sign from part to part.

    Rodas' steps exceed the time constant of the slip. Its error in the rotation falls more slowly there, as for all
    Rosenbrock methods on stiff states (Hairer and Wanner (1996), section IV.15). The order therefore appears in the
    bounce.
    """
    steps = {1: (16e-3, 8e-3, 4e-3), 2: (4e-3, 2e-3, 1e-3), 3: (2e-4, 1e-4, 5e-5)}[method]
    start = braked(tolerance=1e-11)
    seconds, seen = (4e-3, slice(None)) if method == 3 else (0.32, slice(1) if method == 1 else slice(None))
    errors = np.zeros(len(steps))
    # RK4 resolves the transient. Only the transient shows its error.
    for moment in [1e-3] if method == 3 else np.arange(1.0, 3.0, 0.2):
        start.advance(moment - start.time)
        place = [start[f"state_{name}"] for name in layout("bogie", level=2).kept]
        exact = advanced(place, seconds, tolerance=1e-12)
        for number, step in enumerate(steps):
            found = advanced(place, seconds, integration_method=method, integration_step=step, tolerance=1e-2)
            errors[number] += np.square(found - exact)[seen].max()
    slope = np.polyfit(np.log(steps), np.log(errors) / 2, 1)[0]
    assert slope == pytest.approx(order, abs=ORDER_BAND)


def braked(**values: float) -> Kernel:
    return prepare("bogie", level=2, initial_speed=25.0, brake_torque_1=20e3, brake_torque_2=20e3, **values)


def advanced(place: list[float], seconds: float, **values: float) -> np.ndarray:
    """Return the rates of bounce, pitch and rotation some time after a state."""
    kernel = braked(**values)
    kernel.initialise()
    kernel.arrive(0.0, place)
    kernel.advance(seconds)
    return np.array([kernel[f"state_{name}"] for name in ("bounce_rate", "pitch_rate", "angular_velocity_1")])


def test_w_method_keeps_its_order_with_a_jacobian_of_elsewhere() -> None:
    """With short communication steps many steps share one Jacobian. The error still falls with the third power."""

    def write(system: System) -> None:
        x = system.state("x", "1", 1.0, 1.0)
        y = system.state("y", "1", 0.0, 1.0)
        system.derivative(x, y)
        system.derivative(y, -ca.sin(3 * x) + ca.cos(2 * system.time))
        system.output(Variable("x", "output", "1", "x"), x)

    made = small(write, tolerance=1e-2)
    exact = solve_ivp(
        lambda t, z: [z[1], -np.sin(3 * z[0]) + np.cos(2 * t)], (0.0, 2.0), [1.0, 0.0], "DOP853", rtol=1e-13, atol=1e-13
    ).y[0, -1]
    errors, counts = [], (40, 80, 160)
    for count in counts:
        kernel = Kernel(made)
        for _ in range(count):
            kernel.advance(2.0 / count)
        errors.append(abs(kernel["x"] - exact))
        assert kernel.counts["jacobians"] < 0.4 * kernel.counts["steps"]
    slope = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert slope > 3.0 - ORDER_BAND


def small(write: Callable[[System], None], tolerance: float) -> Library:
    system = System("small", "a small system")
    write(system)
    return Library(build_library(model_of(system, tolerance)))


def test_short_host_steps_reuse_the_jacobian_and_give_the_same_motion() -> None:
    distances, jacobians = [], []
    for step in (1e-3, 8.0):
        kernel = SMOOTH.kernel()
        for number in range(round(8.0 / step)):
            kernel.step(number * step, step)
        distances.append(kernel["distance"])
        jacobians.append(kernel.counts["jacobians"] / kernel.counts["steps"])
    assert distances[0] == pytest.approx(distances[1], rel=1e-8)
    assert jacobians[0] < 0.25  # per step; the default method evaluates one each
    assert jacobians[1] >= 1.0


def test_saved_state_goes_on_with_the_same_bits_amid_short_steps() -> None:
    """A state stores where its Jacobian was evaluated. After a restore the factors are computed again."""
    kernel, other = LOCK_UP.kernel(), LOCK_UP.kernel()
    kernel.set(brake_torque_1=30e3)
    for number in range(37):
        kernel.step(number * 1e-3, 1e-3)
    saved = kernel.save()
    other.restore(saved)
    for number in range(37, 90):
        for one in (kernel, other):
            one.step(number * 1e-3, 1e-3)
    assert other.save() == kernel.save()
    kernel.restore(saved)
    for number in range(37, 90):
        kernel.step(number * 1e-3, 1e-3)
    assert other.save() == kernel.save()


def test_fixed_step_says_when_its_error_exceeds_the_tolerance() -> None:
    journals = []
    for step in (1e-3, 3e-2):
        kernel = SMOOTH.kernel(integration_step=step, tolerance=1e-4)
        kernel.advance(2.0)
        journals.append([line for line in kernel.messages if "local error of the fixed step" in line])
    assert not journals[0]
    assert "shorten integration_step" in journals[1][0]
    assert len(journals[1]) < 5  # once for each power of ten


def test_explicit_method_without_a_step_is_refused_with_a_sentence() -> None:
    with pytest.raises(SimulationError, match="integration_step must be above 0 s") as refused:
        SMOOTH.kernel(integration_method=3)
    assert refused.value.status == ERROR


@pytest.mark.parametrize("method", ORDERS)
def test_failed_fixed_step_leaves_the_last_good_state(method: int) -> None:
    def write(system: System) -> None:
        x = system.state("x", "1", 1.0, 1.0)
        system.derivative(x, -1 - ca.sqrt(x))
        system.output(Variable("x", "output", "1", "x"), x)

    kernel = Kernel(small(write, tolerance=1e-2), integration_method=method, integration_step=0.1)
    kernel.advance(0.2)
    before = kernel["x"]
    with pytest.raises(SimulationError, match=r"finds no finite motion at t = .* shorten integration_step"):
        kernel.advance(5.0)
    assert kernel.time == 0.2
    assert kernel["x"] == before


#: Bound on switches of a stop that ends: the runtime's limit of 1000, and those before every step ends in one.
SWITCHES_OF_A_STOP = 2000


def stop_from_walking_pace(host_step: float, **values: float) -> Kernel:
    """Brake from 1 m/s for 2 s, or until the number of switches shows that they never end."""
    kernel = prepare("bogie", level=2, initial_speed=1.0, brake_torque_1=20e3, brake_torque_2=20e3, **values)
    kernel.initialise()
    for number in range(round(2.0 / host_step)):
        if kernel.counts["events"] > SWITCHES_OF_A_STOP:
            break
        kernel.step(number * host_step, host_step)
    return kernel


#: Steps [s] above the stability limit of the slip near rest.
EXPLICIT = {"integration_method": 3, "integration_step": 1e-3, "tolerance": 1e-2}


@pytest.mark.parametrize("host_step", [2.0, 1e-3, 1e-4])
def test_stop_with_explicit_steps_above_their_limit_ends_in_a_sentence_whatever_the_host_step(host_step: float) -> None:
    """A motor that pulls backwards makes sliding and sticking alternate indefinitely.

    Regression test: communication steps of 1 ms contained a thousand switches each.
    """
    sentence = "a friction chatters; above its stability limit an explicit method cannot come to rest"
    with pytest.raises(SimulationError, match=sentence) as ended:
        stop_from_walking_pace(host_step, traction_torque_1=-5e3, **EXPLICIT)
    assert ended.value.status == ERROR


@pytest.mark.parametrize("host_step", [2.0, 1e-3, 1e-4])
def test_stop_with_explicit_steps_above_their_limit_rests_within_the_way_of_one_step(host_step: float) -> None:
    """With brakes alone, sliding and sticking alternate hundreds of times before the bogie stops."""
    kernel = stop_from_walking_pace(host_step, **EXPLICIT)
    assert kernel["angular_velocity_1"] == kernel["angular_velocity_2"] == 0.0
    assert kernel["speed"] == 0.0
    implicit = stop_from_walking_pace(1e-3)
    assert kernel["distance"] == pytest.approx(implicit["distance"], abs=1.0 * EXPLICIT["integration_step"])


@pytest.mark.parametrize(
    "values", [{}, {"integration_step": 1e-3}, {"integration_method": 2, "integration_step": 1e-3}]
)
def test_same_stop_with_an_implicit_method_comes_to_rest(values: dict[str, float]) -> None:
    kernel = stop_from_walking_pace(1e-3, **values)
    assert kernel.time == pytest.approx(2.0)
    assert kernel["angular_velocity_1"] == kernel["angular_velocity_2"] == 0.0
    assert kernel.counts["events"] < 10


def test_wave_of_the_track_is_not_stepped_over() -> None:
    """A bogie in steady motion has no error that would shorten a step before a distant wave."""
    peaks = []
    for tolerance in (1e-2, 1e-7):
        values = {"lateral_irregularity": 5e-3, "lateral_wave_number": 0.2, "irregularity_start": 400.0}
        kernel = prepare("bogie", **RIGID, initial_speed=30.0, tolerance=tolerance, **values)
        table = kernel.record(16.0, 0.01, ["frame_lateral"])
        peaks.append(np.abs(table["frame_lateral"]).max())
    assert peaks[1] > 1e-4
    assert peaks[0] == pytest.approx(peaks[1], rel=0.05)


def test_step_ends_before_a_limited_state_has_changed_too_far() -> None:
    def write(system: System) -> None:
        x = system.state("x", "m", 0.0, 1.0)
        system.derivative(x, ca.SX(2.0))
        system.limit_change(ca.SX(0.5), x)
        system.output(Variable("x", "output", "m", "x"), x)

    kernel = Kernel(small(write, tolerance=1e-2))
    kernel.advance(10.0)
    assert 40 <= kernel.counts["steps"] <= 60  # 20 m in steps of 0.5 m


def test_recording_of_methods_without_an_extension_is_accurate_between_steps() -> None:
    tables = {}
    for method, step in ((1, 0.0), (2, 0.0), (3, 2e-4)):
        kernel = SMOOTH.kernel(integration_method=method, integration_step=step, tolerance=1e-6)
        tables[method] = kernel.record(0.5, 1.3e-3, ["state_frame_speed", "wheel_load_1_left"])
    for method in (2, 3):
        for name, band in (("state_frame_speed", 1e-6), ("wheel_load_1_left", 1.0)):
            assert np.abs(np.array(tables[method][name]) - tables[1][name]).max() < band, (method, name)


# ---- other methods on the same equations -----------------------------------------------------------------------------

#: Tolerance of the default by docs/checking.md; users would accept five times this value.
DEFAULT_BAND = 2e-5
#: Relative change of the wheel radius that every case must detect. The peak of a wheelset that hunts between its
#: flanges depends little on the radius.
SEEN = 3e-3


@pytest.mark.study
@pytest.mark.parametrize("scene", [*SCENES, ON_PATCHES], ids=lambda scene: scene.name)
def test_default_is_right_on_all_scenes_against_another_method(scene: Scene) -> None:
    run, _ = reference_of(scene)
    assert not run.failure
    exact = scene.measure(run.samples)
    assert difference(scene.measure(own(scene).samples), exact) < DEFAULT_BAND
    radius = (tables_5_1_and_5_2() if scene.fmu == "bogie" else tables_4_1_and_4_2()).wheel_radius
    other = own(scene, wheel_radius=radius * (1.0 + SEEN))
    assert other.failure or difference(scene.measure(other.samples), exact) > DEFAULT_BAND


@pytest.mark.study
@pytest.mark.parametrize("method", ["Radau", "BDF", "LSODA"])
def test_methods_of_scipy_pass_lock_and_release(method: str) -> None:
    exact = LOCK_UP.measure(own(LOCK_UP, tolerance=1e-10).samples)
    run = scipy(LOCK_UP, method, 1e-7, 60.0)
    assert difference(LOCK_UP.measure(run.samples), exact) < 1e-5
    assert any("locked" in line for line in run.messages)
    assert any("turns again" in line for line in run.messages)


@pytest.mark.skipif(not sundials.is_installed(), reason="scikit-SUNDAE needs Python 3.11")
@pytest.mark.parametrize("method", sundials.METHODS)
def test_methods_of_sundials_agree_with_ours(method: str) -> None:
    exact = SMOOTH.measure(own(SMOOTH, tolerance=1e-10).samples)
    run = sundials.sundials(SMOOTH, method, 1e-8)
    assert difference(SMOOTH.measure(run.samples), exact) < 1e-7
    assert run.work["right_hand_sides"] > run.work["jacobians"] > 0


def test_run_beyond_its_budget_is_a_failure_with_a_reason() -> None:
    run = scipy(SMOOTH, "RK45", 1e-6, 0.2)
    assert not run.samples
    assert "given up at t = " in run.failure


@pytest.mark.parametrize("level", [1, 2, 3])
@pytest.mark.parametrize("tolerance", [1e-6, 1e-5, 1e-4])
def test_a_stop_comes_to_rest_with_loose_tolerances_too(level: int, tolerance: float) -> None:
    """At rest, creep is so stiff that the error estimate of a step misses it: wheelsets must not break free again."""
    kernel = prepare(
        "bogie", level=level, tolerance=tolerance, initial_speed=25.0, brake_torque_1=25e3, brake_torque_2=25e3
    )
    kernel.advance(30.0)
    assert kernel["angular_velocity_1"] == kernel["angular_velocity_2"] == 0.0
    assert abs(kernel["speed"]) < 10.0 * tolerance
    assert len(kernel.messages) < 10
    assert kernel.counts["steps"] < 1500


def test_steps_behind_a_jump_are_found_with_few_trials() -> None:
    """The torque jumps at each communication step of 10 ms. The method's order alone would give nearly four trials."""
    kernel, count = prepare("bogie", level=3, initial_speed=25.0), 200
    kernel.initialise()
    for number in range(count):
        kernel.set(brake_torque_1=1e4 + 2e3 * (number % 5), brake_torque_2=1e4 + 2e3 * (number % 3))
        kernel.step(number * 0.01, 0.01)
    assert kernel.counts["rejected"] < 2.5 * count


@pytest.mark.study
@pytest.mark.parametrize("scene", IN_THE_PLANE, ids=lambda scene: scene.name)
def test_model_exchange_converges_to_the_motion_of_the_kernel(scene: Scene) -> None:
    """FMPy's CVODE at two tolerances: its error is at most ten times each, with torque ramps, locks and releases."""
    exact = in_the_plane(scene)
    for tolerance in (1e-5, 1e-7):
        run = exchange(scene, tolerance)
        assert not run.failure
        assert difference(scene.measure(run.samples), exact) < 10 * tolerance
        assert run.work["right_hand_sides"] > scene.times().size


def test_a_method_that_is_led_to_no_number_gives_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """Regression test: SciPy raises an error of its own for such a matrix, which ended `speed-accuracy`."""
    jacobian_at = Kernel.jacobian_at
    monkeypatch.setattr(Kernel, "jacobian_at", lambda *given: np.nan * np.array(jacobian_at(*given)))
    run = scipy(SMOOTH, "BDF", 1e-6)
    assert "infs or NaNs" in run.failure
    assert " at t = " in run.failure


def test_bdf_does_not_hang_on_what_memory_held(monkeypatch: pytest.MonkeyPatch) -> None:
    """Regression test: SciPy does not initialise rows of differences. Signalling NaN there ended `speed-accuracy`."""
    clean = scipy(SMOOTH, "BDF", 1e-6)
    monkeypatch.setattr("scipy.integrate._ivp.bdf.np", _Dirty())
    np.testing.assert_equal(scipy(SMOOTH, "BDF", 1e-6).samples, clean.samples)


class _Dirty:
    """NumPy with `empty` arrays full of signalling NaN."""

    def __getattr__(self, name: str) -> object:
        return getattr(np, name)

    def empty(self, shape: tuple[int, ...], dtype: type = float) -> np.ndarray:
        return np.full(shape, 0x7FF4_0000_0000_0000, dtype=np.int64).view(dtype)

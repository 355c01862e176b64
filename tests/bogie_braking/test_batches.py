"""Batches: each run equals a single run in numbers and messages; instances in control steps; refused inputs."""

from __future__ import annotations

import resource
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

import bogie_braking as bb
from bogie_braking import sweeping
from bogie_braking.machines import batch_machine_of, machine_of
from bogie_braking.reducers import results_of
from bogie_braking.single_runs import SingleRuns
from fmu_src import elimination
from fmu_src.batch import BatchLibrary, Ends, batch_source, compiled_batch, run_batch
from fmu_src.kernel import Kernel, SimulationError

BRAKED = {"initial_speed": 25.0, "brake_torque_1": 20e3, "brake_torque_2": 20e3}
OUTPUTS = ["distance", "speed", "locked_1", "axle_load_1"]
#: Friction low enough that wheels lock, and two values that the bogie refuses.
FRICTION = np.concatenate([np.linspace(0.02, 0.3, 21), [-1.0, np.nan]])


def runs_of(what: object, duration: float, line: bb.Line | None, names: list[str]) -> sweeping.Runs:
    variables = machine_of(what, {}, line is not None).variables  # type: ignore[arg-type]
    results = results_of(names, variables)
    return sweeping.Runs(SingleRuns(what, duration, line, results, 0.01), {})  # type: ignore[arg-type]


def alone(what: object, duration: float, line: bb.Line | None, row: dict[str, float]) -> tuple[list[float], str]:
    one = runs_of(what, duration, line, OUTPUTS).end(row)
    if one.results is None:
        return [np.nan] * len(OUTPUTS), str(one.failure)
    return [np.nan if end is None else end for end in one.results.values()], one.message


def assert_same(ends: Ends, rows: list[tuple[list[float], str]]) -> None:
    """Compare all numbers bit for bit, and all messages."""
    for column, name in enumerate(OUTPUTS):
        assert np.array_equal(ends[name], [values[column] for values, _ in rows], equal_nan=True), name
    assert ends.messages == [said for _, said in rows]


@pytest.fixture(scope="module")
def planar() -> BatchLibrary:
    return batch_machine_of("bogie", {}, False)


@pytest.mark.study
def test_a_long_elimination_is_cut_into_any_number_of_pieces(
    planar: BatchLibrary, monkeypatch: pytest.MonkeyPatch
) -> None:
    """More than 8 pieces, the largest number of lanes that a name ends with, give the same runs."""
    monkeypatch.setattr(elimination, "LONGEST", 8)
    model = planar.model
    system = next(one for one in model.systems if one.name == "planar")
    cut = batch_source(model, system)
    assert sum(text.count("static void piece_9_of_planar_factorise") for text in cut.values()) == 1
    values = BRAKED | {"level": 2, "friction_1": FRICTION[:4]}
    ends = [run_batch(one, values, 8.0, OUTPUTS) for one in (planar, compiled_batch(model, system))]
    for name in OUTPUTS:
        assert np.array_equal(ends[0][name], ends[1][name])


# ---- runs ----------------------------------------------------------------------------------------------------------


@pytest.mark.study
@pytest.mark.parametrize(
    ("what", "scene", "on_line"),
    [
        ("bogie", {"level": 1, **BRAKED}, False),
        ("bogie", {"level": 2, **BRAKED}, False),
        ("bogie", {"level": 2, **BRAKED, "integration_step": 5e-3}, False),
        ("bogie", {"level": 2, **BRAKED, "integration_method": 2, "integration_step": 1e-3}, False),
        ("bogie", {"level": 2, **BRAKED, "integration_method": 2}, False),
        ("bogie", {"level": 2, **BRAKED}, True),
    ],
)
def test_each_run_of_a_batch_is_that_which_it_is_alone(what: str, scene: dict[str, float], on_line: bool) -> None:
    """The runs include lock-ups, stops and refusals."""
    line = bb.line_of([bb.straight(500.0, gradient=-0.01)]) if on_line else None
    ends = bb.batch(what, 15.0, OUTPUTS, line, messages=True, **scene, friction_1=FRICTION, friction_2=FRICTION)
    assert ends.messages is not None
    assert_same(ends, [alone(what, 15.0, line, {**scene, "friction_1": mu, "friction_2": mu}) for mu in FRICTION])
    assert sum("locked" in said for said in ends.messages) > 5
    assert sorted(ends.failures) == [21, 22]
    assert "friction_1 must be at least 0" in ends.failures[21]
    assert np.isnan(ends.time[21:]).all()


#: Method and fixed step [s] of each row. Neighbouring rows differ, and each pair occurs in several lanes.
MIXED = [(1, 0.0), (2, 5e-3), (1, 5e-3), (2, 0.0), (3, 2e-4), (2, 2e-3), (1, 2e-3)] * 3


@pytest.mark.study
def test_runs_with_other_methods_beside_them_are_those_which_they_are_alone() -> None:
    methods, sizes = (np.array(column, dtype=float) for column in zip(*MIXED, strict=True))
    scene = {"level": 2, **BRAKED, "initial_speed": 12.0}
    chosen = {
        "integration_method": methods,
        "integration_step": sizes,
        "tolerance": np.geomspace(1e-7, 1e-4, len(MIXED)),
    }
    ends = bb.batch("bogie", 5.0, OUTPUTS, messages=True, **scene, **chosen)
    rows = [{name: column[row] for name, column in chosen.items()} for row in range(len(MIXED))]
    assert_same(ends, [alone("bogie", 5.0, None, {**scene, **row}) for row in rows])
    assert len(set(ends["distance"][:7].tolist())) == 7


@pytest.mark.study
def test_runs_in_space_that_end_early_are_those_which_they_are_alone() -> None:
    """In a curve the fast vehicles tip over, and waiting runs take over their lanes."""
    before, curve = bb.straight(20.0), bb.arc(500.0, 300.0)
    line = bb.line_of([before, bb.clothoid(60.0, before, curve), curve])
    scene = {"level": 3, "constant_speed": 1}
    speeds = np.random.default_rng(31).permutation(np.linspace(15.0, 60.0, 20))
    ends = bb.batch("bogie", 5.0, OUTPUTS, line, messages=True, **scene, initial_speed=speeds)
    assert_same(ends, [alone("bogie", 5.0, line, {**scene, "initial_speed": speed}) for speed in speeds.tolist()])
    assert 3 < np.count_nonzero(ends.ended) < 17
    assert (ends.time[ends.ended] < 5.0).all()
    assert (ends.time[~ends.ended] == 5.0).all()
    assert [text != "" for text in replace(ends, messages=None).table.messages] == ends.ended.tolist()


@pytest.mark.study
@pytest.mark.parametrize("lanes", [2, 4])
def test_order_threads_and_width_change_no_bit(planar: BatchLibrary, lanes: int) -> None:
    if lanes > planar.lanes:
        pytest.skip("this processor has fewer lanes")
    other = compiled_batch(planar.model, planar.model.systems[0], lanes)
    values = {**BRAKED, "friction_1": FRICTION, "friction_2": FRICTION[::-1]}
    expected = run_batch(planar, values, 12.0, OUTPUTS, 1, all_messages=True)
    order = np.random.default_rng(31).permutation(FRICTION.size)
    for threads in (1, 2):
        mixed = {name: value[order] if isinstance(value, np.ndarray) else value for name, value in values.items()}
        found = run_batch(other, mixed, 12.0, OUTPUTS, threads, all_messages=True)
        for name in OUTPUTS:
            assert np.array_equal(found[name], expected[name][order], equal_nan=True), name
        assert expected.messages is not None
        assert found.messages == [expected.messages[row] for row in order]


def test_a_batch_of_no_runs_is_empty(planar: BatchLibrary) -> None:
    ends = run_batch(planar, {**BRAKED, "friction_1": []}, 1.0, OUTPUTS, all_messages=True)
    assert ends["speed"].shape == ends.time.shape == (0,)
    assert ends.messages == []


def test_a_lost_signal_is_said_and_changes_no_other_run() -> None:
    """A NaN torque is replaced by its safe value, in its own lane only."""
    torque = [20e3, np.nan, 10e3]
    scene = {"initial_speed": 25.0, "level": 1}
    ends = bb.batch("bogie", 5.0, OUTPUTS, messages=True, **scene, brake_torque_1=torque)
    assert_same(ends, [alone("bogie", 5.0, None, {**scene, "brake_torque_1": one}) for one in torque])


@pytest.mark.study
def test_a_system_with_algebraic_states_is_in_its_lane_what_it_is_alone() -> None:
    """Its trial steps are made outside the lanes, with a separate Jacobian."""
    speeds = np.linspace(5.0, 40.0, 11)
    ends = bb.batch("wheelset", 3.0, ["speed", "distance"], messages=True, initial_speed=speeds)
    for speed, *found in zip(speeds.tolist(), ends["speed"], ends["distance"], strict=True):
        run = runs_of("wheelset", 3.0, None, ["speed", "distance"]).end({"initial_speed": speed})
        assert run.results == dict(zip(["speed", "distance"], found, strict=True))


def test_an_fmu_of_one_system_has_batches_too() -> None:
    """Its parameters do not select a level."""
    demand = np.linspace(1e5, 4e5, 9)
    torques = bb.batch("brake", 3.0, ["brake_torque"], pressure_demand=demand, angular_velocity=10.0)["brake_torque"]
    runs = [bb.run("brake", 3.0, pressure_demand=one, angular_velocity=10.0) for one in demand.tolist()]
    assert torques == pytest.approx([run["brake_torque"][-1] for run in runs], rel=1e-6)


def test_an_own_system_runs_in_lanes() -> None:
    """A body falls until it is below the ground; the reference is the closed form."""
    fall = bb.System("FallsInLanes", "A body that falls")
    gravity = fall.parameter(bb.Variable("gravity", "parameter", "m/s2", "Gravity", 9.81))
    height, speed = fall.state("height", "m", 0.0, 1.0), fall.state("speed", "m/s", 0.0, 1.0)
    fall.derivative(height, speed)
    fall.derivative(speed, -gravity)
    fall.output(bb.Variable("above", "output", "m", "Height"), height)
    given = np.linspace(1.0, 10.0, 20)
    assert bb.batch(fall, 3.0, ["above"], gravity=given)["above"] == pytest.approx(-4.5 * given, rel=1e-9)


# ---- sweeps --------------------------------------------------------------------------------------------------------


def test_a_long_sweep_is_a_batch_and_the_same_table(monkeypatch: pytest.MonkeyPatch) -> None:
    """The sweep runs here and by an executor with several rows a task; what no batch supports runs one by one."""
    vary = {"friction_1": FRICTION, "friction_2": FRICTION[::-1]}
    scene = {**BRAKED, "level": 2}
    one_by_one = bb.sweep("bogie", 20.0, ["distance", "locked_1"], vary, **scene)
    calls: list[int] = []
    plain = sweeping.batch

    def counted(*given: object, **values: object) -> Ends:
        calls.append(1)
        return plain(*given, **values)  # type: ignore[arg-type]

    monkeypatch.setattr(sweeping, "PAYS_FROM", 5)
    monkeypatch.setattr(sweeping, "batch", counted)
    tables = [bb.sweep("bogie", 20.0, ["distance", "locked_1"], vary, **scene)]
    assert len(calls) == 1
    with ProcessPoolExecutor(1) as executor:
        tables.append(bb.sweep("bogie", 20.0, ["distance", "locked_1"], vary, executor, **scene))
    for table in tables:
        for name in one_by_one.names:
            assert np.array_equal(table[name], one_by_one[name], equal_nan=True), name
        assert table.messages == one_by_one.messages
        assert table.units == one_by_one.units
    levels = bb.sweep("bogie", 1.0, ["speed"], {"level": [1, 1, 2, 2, 4, 1]}, **BRAKED)
    assert np.isnan(levels["speed"]).tolist() == [False, False, False, False, True, False]
    assert "level" in levels.messages[4]


# ---- instances -----------------------------------------------------------------------------------------------------

COUNT, SIZE = 13, 5e-3


def torque(number: int) -> np.ndarray:
    """Return torques that lock the wheels and release them."""
    return np.where((number // 60) % 2 == 0, 60e3, 0.0) * np.linspace(0.5, 1.0, COUNT)


@pytest.fixture(params=[1e-6, 1e-3], ids=["fine", "coarse"])
def together(request: pytest.FixtureRequest) -> Iterator[tuple[object, dict[str, float]]]:
    scene = {"initial_speed": 20.0, "friction_1": 0.08, "friction_2": 0.1, "tolerance": request.param}
    with bb.instances("bogie", COUNT, ["brake_torque_1", "brake_torque_2"], OUTPUTS, **scene) as made:
        yield made, scene


def test_instances_in_control_steps_are_those_which_they_are_alone(together, planar: BatchLibrary) -> None:  # type: ignore[no-untyped-def]
    """Wheels lock and turn again; one row restarts in between from another speed."""
    made, scene = together
    kernels = [Kernel(planar, **scene) for _ in range(COUNT)]
    for kernel in kernels:
        kernel.initialise()
    for number in range(240):
        if number == 100:
            made.reset([3], initial_speed=12.0)
            kernels[3] = Kernel(planar, **{**scene, "initial_speed": 12.0})
            kernels[3].initialise()
        given = torque(number)
        found = made.step(SIZE, {"brake_torque_1": given, "brake_torque_2": 0.5 * given})
        for kernel, value in zip(kernels, given.tolist(), strict=True):
            kernel.set(brake_torque_1=value, brake_torque_2=0.5 * value)
            kernel.step(kernel.time, SIZE)
        if number % 10 == 9:
            for name in OUTPUTS:
                assert np.array_equal(found[name], [kernel[name] for kernel in kernels]), (number, name)
    assert all(kernel.counts["events"] >= 2 for kernel in kernels[6:])
    assert made.time[3] == pytest.approx(140 * SIZE)
    assert not made.ended.any()


def test_instances_with_other_methods_beside_them_are_those_which_they_are_alone(planar: BatchLibrary) -> None:
    rows = [{"integration_method": method, "integration_step": size} for method, size in MIXED]
    scene = {"initial_speed": 20.0, "friction_1": 0.08}
    chosen = {name: [row[name] for row in rows] for name in rows[0]}
    kernels = [Kernel(planar, **scene, **row) for row in rows]
    for kernel in kernels:
        kernel.initialise()
    with bb.instances("bogie", len(rows), ["brake_torque_1"], OUTPUTS, **scene, **chosen) as made:
        for number in range(120):
            torque_1 = 40e3 if number % 60 < 40 else 0.0
            found = made.step(SIZE, {"brake_torque_1": torque_1})
            for kernel in kernels:
                kernel.set(brake_torque_1=torque_1)
                kernel.step(kernel.time, SIZE)
        for name in OUTPUTS:
            assert np.array_equal(found[name], [kernel[name] for kernel in kernels]), name
    assert all(kernel.counts["events"] >= 2 for kernel in kernels)


def test_first_inputs_of_instances_hold_until_others_are_given() -> None:
    with bb.instances("bogie", 3, ["brake_torque_1"], ["brake_torque_1", "speed"], brake_torque_1=9e3) as made:
        assert made.step(SIZE)["brake_torque_1"].tolist() == [9e3] * 3
        assert made.step(SIZE, {"brake_torque_1": [1.0, 2.0, 3.0]})["brake_torque_1"].tolist() == [1.0, 2.0, 3.0]
        made.reset([1])
        assert made.step(SIZE)["brake_torque_1"].tolist() == [1.0, 9e3, 3.0]


def test_masked_inputs_of_a_step_are_refused() -> None:
    given = np.ma.array([0.1, 0.2], mask=[False, True])
    with (
        bb.instances("bogie", 2, ["friction_1"], ["speed"]) as made,
        pytest.raises(ValueError, match="friction_1 must be numbers that are not masked"),
    ):
        made.step(SIZE, {"friction_1": given})


def test_names_that_are_there_twice_are_refused() -> None:
    """One of two columns of the same name would be lost, or would keep its start value."""
    for inputs, outputs in ((["brake_torque_1"] * 2, ["speed"]), (["brake_torque_1"], ["speed", "speed"])):
        with pytest.raises(ValueError, match=r"must have a name of its own; got \w+ twice\. Leave one out\."):
            bb.instances("bogie", 2, inputs, outputs)


def test_a_step_that_fails_leaves_the_others_where_they_came_to(planar: BatchLibrary) -> None:
    with bb.instances("bogie", 3, ["friction_1"], ["speed"], **BRAKED) as made:
        made.step(SIZE, {"friction_1": 0.2})
        with pytest.raises(SimulationError, match="Instance 1 of 3: friction_1 must be at least 0"):
            made.step(SIZE, {"friction_1": [0.2, -1.0, 0.2]})
        assert made.time == pytest.approx([2 * SIZE, SIZE, 2 * SIZE])
        made.step(SIZE, {"friction_1": 0.2})


def test_a_step_that_fails_on_the_way_leaves_all_as_it_was() -> None:
    """All stays bit-identical, in lanes and alone: x' = u - 1 / sqrt(x) reaches 0 at t = 2/3 if u is 0."""
    system = bb.System("falling", "A state whose slope ends")
    u = system.input(bb.Variable("u", "input", "1", "Slope beside the fall"))
    x = system.state("x", "1", 1.0, 1.0)
    system.derivative(x, u - 1 / ca.sqrt(x))
    for name, value in (("height", x), ("slope", u - 1 / ca.sqrt(x))):
        system.output(bb.Variable(name, "output", "1", name), value)
    with bb.instances(system, 3, ["u"], ["height", "slope"], tolerance=1e-9) as made:
        before = {name: values.copy() for name, values in made.step(0.5, {"u": [0.0, 2.0, 0.0]}).items()}
        with pytest.raises(SimulationError, match="Instance 0 of 3: The step size vanished"):
            made.step(0.5)
        assert made.time.tolist() == [0.5, 1.0, 0.5]
        kernel = made._kernels[0]
        assert [kernel["height"], kernel["slope"]] == [before["height"][0], before["slope"][0]]
        found = made.step(0.1)
        assert found["height"][0] == found["height"][2]
        assert found["height"][0] == pytest.approx((1 - 1.5 * 0.6) ** (2 / 3), rel=1e-5)  # the closed form


@pytest.mark.study
def test_instances_and_batches_give_their_memory_back(planar: BatchLibrary) -> None:
    def cycle() -> None:
        with bb.instances("bogie", 4, ["brake_torque_1"], ["speed"], **BRAKED) as made:
            made.step(SIZE)
        run_batch(planar, {**BRAKED, "friction_1": [0.1, -1.0]}, 0.01, ["speed"], 1, all_messages=True)

    for _ in range(100):
        cycle()
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for _ in range(900):
        cycle()
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 3000  # KiB; one kernel takes 100


# ---- what is refused -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("call", "error", "sentence"),
    [
        (lambda: bb.batch("bogey", 1.0, ["speed"]), KeyError, "There is no FMU bogey; did you mean bogie?"),
        (lambda: bb.batch("bogie", 1.0, ["sped"]), KeyError, "no variable sped; did you mean speed?"),
        (lambda: bb.batch("bogie", 1.0, ["speed"], frction_1=[0.1]), KeyError, "did you mean friction_1?"),
        (lambda: bb.batch("bogie", 0.0, ["speed"]), ValueError, "The duration must be a number of seconds above 0"),
        (
            lambda: bb.batch("bogie", 1.0, ["speed"], threads=0),
            ValueError,
            "The number of threads must be a whole number",
        ),
        (
            lambda: bb.batch("bogie", 1.0, ["speed"], friction_1=[0.1, 0.2], friction_2=[0.1]),
            ValueError,
            "friction_2 must be one number, or 2 of them as others are; got an array of shape (1,).",
        ),
        (
            lambda: bb.batch("bogie", 1.0, ["speed"], brake_torque_1=lambda time: time),
            ValueError,
            "brake_torque_1 must be one number, or a list of numbers",
        ),
        (lambda: bb.batch("bogie", 1.0, ["speed"], level=[1, 2]), ValueError, "level must be one number for all runs"),
        (lambda: bb.batch("bogie", 1.0, ["speed"], level=4), ValueError, "level must be 1, 2 or 3; got 4."),
        (lambda: bb.batch("bogie", 1.0, ["speed"])["sped"], KeyError, "no output sped; did you mean speed?"),
        (
            lambda: bb.instances("bogie", 0, [], ["speed"]),
            ValueError,
            "number of instances must be a whole number of at least 1",
        ),
        (lambda: bb.instances("bogie", 2, ["brake_torqe_1"], ["speed"]), KeyError, "did you mean brake_torque_1?"),
        (
            lambda: bb.instances("bogie", 2, [], ["speed"], friction_1=[0.1, -1.0]),
            SimulationError,
            "Instance 1 of 2: friction_1 must be at least 0",
        ),
    ],
)
def test_a_mistake_is_told_in_a_sentence(call: Callable[[], object], error: type[Exception], sentence: str) -> None:
    with pytest.raises(error) as found:
        call()
    assert sentence in str(found.value)

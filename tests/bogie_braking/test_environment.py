"""Environments for reinforcement learning: observations, rewards of a stop, and the requirements of Gymnasium."""

from __future__ import annotations

import re
import subprocess
import sys
import warnings
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from evidence.measuring.protected_throughput import LetAllGo
from fmu_src.kernel import SimulationError
from products.controller_kinds import Arrays
from products.machine import CYLINDER_VOLUME, bogie, coach
from products.protection.cost import AT_LIMIT, FILLINGS, NO_STOP, rolling_stop
from products.protection.draws import FRICTIONS, SPEEDS, drawn_run
from products.protection.environment import Environment
from products.protection.rails import ABOVE, BAND, RAILS
from products.protection.rig import Rig
from products.protection.runs import Fault, Run
from products.protection.settings import BRAKE_START, GAS, LONGEST, Settings

gymnasium = pytest.importorskip("gymnasium", reason='environments need gymnasium: pip install "bogie-braking[gym]"')
from gymnasium.utils.env_checker import check_env  # noqa: E402

from bogie_braking.gym import NAME  # noqa: E402

ROOT = Path(__file__).parents[2]
DRY, LOW = RAILS[0], RAILS[2]
#: Creep of rolling wheels; tests/products/protection/test_rig.py allows the same share for the same stop on the rig.
ROLLING = 5e-3
#: Least memory of a vector of these rows [bytes], and how often one is created and released.
ROWS, ROW, TIMES = 256, 30e3, 8


def slowly(random: np.random.Generator, wheelsets: int) -> Run:
    """Draw a short stop from walking pace on any rail."""
    return replace(drawn_run(random, wheelsets), speed=float(random.uniform(0.5, 1.5)))


def begun(
    draw: Any, count: int = 1, settings: Settings | None = None, privileged: bool = False, step: float | None = None
) -> Environment:
    made = Environment(bogie(), settings or Settings(), count, draw, privileged, step=step)
    made.begin(range(count), [np.random.default_rng(seed) for seed in range(count)])
    return made


def only(run: Run) -> Any:
    return lambda random, wheelsets: run


# ---- what a stop costs -----------------------------------------------------------------------------------------------


@pytest.mark.study
def test_rewards_add_up_to_the_score_of_the_same_stop_on_the_rig() -> None:
    """The stop is bit-identical; its reward is computed here again from the observations of a privileged row."""
    with_pause, step = Settings(period=10e-3), 10e-3
    own = begun(drawn_run, 8, with_pause, privileged=True, step=step)
    total, outside, steps = np.zeros(8), np.zeros(8), 0
    goes_on = np.ones(8, bool)
    while goes_on.any():
        seen = own.observation
        speed, slips, since = seen[:, 5], seen[:, 7:9], seen[:, 4]
        outside += goes_on & (since > 0) & (speed > ABOVE) & (slips > BAND).any(axis=1)
        own.turn(LetAllGo().step(since, seen[:, :2]))
        total += own.reward
        assert np.all(own.reward <= 0.0)
        goes_on &= ~(own.terminated | own.truncated)
        steps += 1
    stops = [own.stop(row) for row in range(8)]
    assert Rig(bogie(), Arrays(LetAllGo()), with_pause, step=step).runs(own.runs) == stops
    machine = bogie()
    for row, stop in enumerate(stops):
        rolls = rolling_stop(machine, with_pause, own.runs[row].speed or 0.0)
        assert stop.distance is not None
        shares = [
            stop.longest_lock / 0.4,
            outside[row] * with_pause.period / (0.2 * rolls.duration),
            stop.air * GAS / CYLINDER_VOLUME / (2 * machine.full_pressure) / 40.0,
        ]
        assert -total[row] == pytest.approx(stop.distance / rolls.distance + 0.25 * sum(shares), rel=1e-9)
    assert (AT_LIMIT, FILLINGS) == (0.25, 40.0)
    assert outside.max() > 0.0
    assert max(stop.longest_lock for stop in stops) > 0.0


@pytest.mark.study
@pytest.mark.parametrize("brake_ratio", [0.5, 1.0])
def test_where_all_wheels_roll_a_stop_costs_its_distance_and_one_filling(brake_ratio: float) -> None:
    costs = []
    for rail in (DRY, LOW):
        own, total = begun(only(Run(rail.values(), brake_ratio=brake_ratio))), 0.0
        while not own.terminated[0]:
            own.turn([[0, 0]])
            total -= own.reward[0]
        costs.append(total)
    assert costs[0] == pytest.approx(1.0 + 0.25 / 40.0, rel=ROLLING)
    assert costs[1] > costs[0] + 0.1


@pytest.mark.study
def test_a_machine_that_does_not_stop_is_truncated_and_one_that_is_lost_costs_its_way_on() -> None:
    settings = Settings(period=0.1, brake_ratio=1e-3)
    own, turns = begun(only(Run(DRY.values())), 1, settings), 0
    while not own.truncated[0]:
        own.turn([[0, 0]])
        turns += 1
    assert own.reward[0] < -NO_STOP
    assert turns == round(LONGEST / settings.period)
    assert not own.terminated[0]
    high = Run(DRY.values() | {"frame_height": 3.0})
    own, total = begun(only(high), 1, Settings(brake_ratio=4.0), privileged=True), 0.0
    while not own.terminated[0]:
        own.turn([[0, 0]])
        total -= own.reward[0]
    rolls, at = rolling_stop(bogie(), Settings(brake_ratio=4.0), 25.0), own.observation[0]
    stop = own.stop(0)
    assert stop.message.startswith("The machine went no further: Wheelset 2 lifted off the rail at ")
    assert at[5] > 1.0
    further = stop.end_speed * (LONGEST - stop.time) / rolls.distance
    own.turn([[0, 0]])
    assert own.reward[0] == 0.0
    assert total == pytest.approx(NO_STOP + further + at[6] / rolls.distance, abs=0.01)
    assert further > 10.0


# ---- what it shows ---------------------------------------------------------------------------------------------------


def test_a_row_shows_what_sensors_show_and_more_only_where_that_is_asked_for() -> None:
    run = Run(LOW.values() | {"patch_friction": 0.5, "patch_start": 70.0}, 20.0, faults=(Fault(2, sensor="zero"),))
    plain, told = begun(only(run)), begun(only(run), privileged=True)
    for turn in range(600):
        for one in (plain, told):
            one.turn([[0, 1] if turn > 400 else [0, 0]])
        assert np.array_equal(told.observation[:, :5], plain.observation)
    first, second, *rest = plain.observation[0]
    assert second == 0.0
    assert rest == [0.0, 1.0, pytest.approx(600 * 5e-3 - BRAKE_START)]
    speed, distance, *slips = told.observation[0, 5:9]
    assert 15.0 < speed < 20.0
    assert 0.0 < 600 * 5e-3 * 20.0 - distance < 10.0
    assert first == pytest.approx((1 - slips[0]) * speed, abs=0.2)
    assert slips[0] > 0.02
    assert told.observation[0, 9:].tolist() == [0.08, 0.08, 0.5, 70.0, 50.0]
    assert np.all((told.limits[0] <= told.observation) & (told.observation <= told.limits[1]))


def test_draws_are_within_their_limits_and_differ() -> None:
    runs = [drawn_run(np.random.default_rng(seed), 4) for seed in range(400)]
    speeds, on = [run.speed or 0.0 for run in runs], [run.values["friction_4"] for run in runs]
    assert SPEEDS[0] < min(speeds) < SPEEDS[0] + 1.0
    assert SPEEDS[1] - 1.0 < max(speeds) < SPEEDS[1]
    leaves = ["patch_start" in run.values for run in runs]
    assert 20 < sum(leaves) < 60
    bare = [friction for friction, patched in zip(on, leaves, strict=True) if not patched]
    assert FRICTIONS[0] < min(bare) < max(bare) < FRICTIONS[1]
    assert len({run.values["friction_ratio"] for run in runs}) == 2
    assert drawn_run(np.random.default_rng(3), 4) == runs[3]


# ---- what Gymnasium asks ---------------------------------------------------------------------------------------------


@pytest.mark.study
@pytest.mark.parametrize("vehicle", ["bogie", "vehicle"])
@pytest.mark.parametrize("privileged", [False, True])
def test_gymnasium_finds_nothing_wrong(vehicle: str, privileged: bool) -> None:
    made = gymnasium.make(NAME, vehicle=vehicle, privileged=privileged)
    with warnings.catch_warnings():
        if privileged:  # where a patch begins has no limits
            warnings.filterwarnings("ignore", message=".*infinity.*")
        check_env(made.unwrapped)
    made.close()


def test_a_row_of_a_vector_is_the_single_one_with_its_seed() -> None:
    """Gymnasium's own vector of single environments gives bit-identical results, also over stops that restart."""
    kwargs: dict[str, Any] = {"rails": slowly, "privileged": True}
    ours = gymnasium.make_vec(NAME, 5, **kwargs)
    other = gymnasium.make_vec(NAME, 5, vectorization_mode="sync", **kwargs)
    assert ours.metadata["autoreset_mode"] == other.metadata["autoreset_mode"]
    assert (ours.observation_space, ours.action_space) == (other.observation_space, other.action_space)
    random, ends = np.random.default_rng(1), 0
    assert np.array_equal(ours.reset(seed=7)[0], other.reset(seed=7)[0])
    for _ in range(1500):
        actions = random.integers(0, 3, (5, 2)) * (random.random() < 0.3)
        *found, info = ours.step(actions)
        *expected, told = other.step(actions)
        for one, two in zip(found, expected, strict=True):
            assert np.array_equal(one, two)
        assert info.keys() == told.keys()
        for name in info:
            assert np.array_equal(info[name], told[name], equal_nan="message" not in name), name
        ends += int(found[2].sum())
    assert ends > 5
    assert not np.array_equal(ours.reset(seed=8)[0], other.reset(seed=7)[0])
    ours.close()
    other.close()


def test_the_same_seed_draws_the_same_rails() -> None:
    made = gymnasium.make_vec(NAME, 3)
    made.reset(seed=4)
    first = made.unwrapped.runs
    made.reset()
    second = made.unwrapped.runs
    assert first != second
    made.reset(seed=4)
    assert made.unwrapped.runs == first
    made.reset(seed=[5, 4, 6])
    assert made.unwrapped.runs == [first[1], first[0], first[2]]
    one = gymnasium.make(NAME)
    one.reset(seed=5)
    assert one.unwrapped.run == first[1]
    made.close()


@pytest.mark.study
def test_the_module_alone_makes_it_known() -> None:
    code = f"import gymnasium; print(gymnasium.make('bogie_braking.gym:{NAME}').reset(seed=1)[0].shape)"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout == "(5,)\n"
    code = "import sys; sys.modules['gymnasium'] = None; import bogie_braking.gym"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.stderr.endswith("Environments need gymnasium: pip install 'bogie-braking[gym]'.\n")


# ---- what cannot be --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("commands", "sentence"),
    [
        ([[0, 3], [0, 0]], "Each valve must be 0 (apply), 1 (hold) or 2 (vent); got [0, 3] in row 0."),
        ([[0, 0], [0.5, 0]], "Each valve must be 0 (apply), 1 (hold) or 2 (vent); got [0.5, 0.0] in row 1."),
        ([[0, 0], [np.nan, 0]], "got [nan, 0.0] in row 1."),
        ([[0, 0], [2**40, 0]], "got [1099511627776, 0] in row 1."),
        ([0, 0], "commands must have the shape (2, 2); got (2,)."),
        ([["a", "b"]] * 2, "Each valve must be 0 (apply), 1 (hold) or 2 (vent)"),
        (None, "commands must have the shape (2, 2); got ()."),
    ],
)
def test_what_is_no_command_is_refused_before_anything_moves(commands: Any, sentence: str) -> None:
    made, other = (gymnasium.make_vec(NAME, 2) for _ in range(2))
    for one in (made, other):
        one.reset(seed=1)
    for _ in range(300):
        made.step(np.zeros((2, 2), int))
        other.step(np.zeros((2, 2), int))
    with pytest.raises(ValueError, match=re.escape(sentence)):
        made.step(commands)
    for one, two in zip(made.step(np.ones((2, 2)))[:4], other.step(np.ones((2, 2), int))[:4], strict=True):
        assert np.array_equal(one, two)


@pytest.mark.parametrize(
    ("kwargs", "sentence"),
    [
        ({"vehicle": "tram"}, "There is no vehicle with brakes tram;"),
        ({"rails": None}, "rails must be a function of a generator and a number of wheelsets; got None."),
        ({"rails": only(None)}, "rails must return a Run; got a NoneType."),
        ({"rails": only(Run({}, speed=0.0))}, "A drawn speed must be above 0 and at most 100 m/s; got 0.0."),
        ({"rails": only(Run({}, speed=np.nan))}, "A drawn speed must be above 0 and at most 100 m/s; got nan."),
        ({"rails": only(Run({"friction": 0.1}))}, "There is no variable friction; did you mean friction_"),
        ({"rails": only(Run({"friction_1": -0.1}))}, "friction_1"),
        (
            {"rails": only(Run({}, faults=(Fault(3, radius=1.1),)))},
            "The wheelset of a fault must be from 1 to 2; got 3.",
        ),
        ({"pulse": 80}, "There is no setting pulse; did you mean pulses?"),
        ({"period": 1e-6}, "period must be at least 1e-05 s; got 1e-06 s."),
        ({"num_envs": 0}, "The number of environments must be a whole number of at least 1; got 0."),
    ],
)
def test_what_cannot_be_made_is_refused_in_a_sentence(kwargs: dict[str, Any], sentence: str) -> None:
    with pytest.raises((ValueError, TypeError, KeyError, SimulationError), match=re.escape(sentence)):
        gymnasium.make_vec(NAME, **{"num_envs": 2, **kwargs}).reset(seed=1)


def test_a_step_before_the_first_reset_and_options_are_refused() -> None:
    one, many = gymnasium.make(NAME).unwrapped, gymnasium.make_vec(NAME, 2)
    for made, action in ((one, [0, 0]), (many, [[0, 0]] * 2)):
        with pytest.raises(RuntimeError, match=r"No stop goes on here; call reset first\."):
            made.step(np.array(action))
        with pytest.raises(ValueError, match="There is no option rail; give rails a function"):
            made.reset(options={"rail": "low"})
        with pytest.raises(ValueError, match="seed must be one number, or 2 of them; got 3"):
            many.reset(seed=[1, 2, 3])


# ---- memory ----------------------------------------------------------------------------------------------------------


GROWTH = """
import gc, sys
import gymnasium, numpy as np
from bogie_braking.gym import NAME
from tests.bogie_braking.test_environment import ROWS, TIMES, resident

def grown(closes, kept):
    for number in range(3 + TIMES):
        made = gymnasium.make_vec(NAME, ROWS)
        made.reset(seed=number)
        made.step(np.zeros((ROWS, 2), int))
        kept.append(made) if keeps else made.close() if closes else None
        del made
        gc.collect()
        begin = resident() if number == 2 else begin if number > 2 else 0.0
    return resident() - begin

for keeps, closes in ((False, True), (False, False), (True, False)):
    print(grown(closes, []))
"""


def resident() -> float:
    """Return the resident memory of this process [bytes]."""
    return 4096.0 * int(Path("/proc/self/statm").read_text().split()[1])


@pytest.mark.study
@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="reads memory where Linux tells it")
def test_environments_that_are_made_and_let_go_of_leave_no_memory() -> None:
    """Some are closed, some only released; if kept, they hold their memory. A new process has no free heap yet."""
    done = subprocess.run([sys.executable, "-c", GROWTH], cwd=ROOT, capture_output=True, text=True, check=True)
    closed, let_go, kept = map(float, done.stdout.split())
    assert closed < ROWS * ROW
    assert let_go < ROWS * ROW
    assert kept > (TIMES - 2) * ROWS * ROW


@pytest.mark.long
def test_ten_thousand_environments_a_hundred_times_leave_memory_flat() -> None:
    """Prints the resident memory after each round."""
    held = []
    for number in range(100):
        made = gymnasium.make_vec(NAME, 10_000)
        made.reset(seed=number)
        made.step(np.zeros((10_000, 2), int))
        made.close()
        held.append(resident())
    print([f"{1e-6 * one:.0f} MB" for one in held])
    assert max(held[50:]) < 1.05 * max(held[:50])


@pytest.mark.study
def test_the_coach_has_four_valves() -> None:
    own = Environment(coach(), Settings(), 2, drawn_run)
    own.begin([0, 1], [np.random.default_rng(seed) for seed in (1, 2)])
    own.turn(np.full((2, 4), 1))
    assert own.observation.shape == (2, 9)
    assert own.observation[:, 4:8].tolist() == [[1.0] * 4] * 2

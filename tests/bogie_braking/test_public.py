"""The public API: its names and their behaviour."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import bogie_braking as bb
from bogie_braking import machines, parts, sweeping
from bogie_braking.checks import known
from bogie_braking.machines import machine_of
from bogie_braking.sweeping import PAYS_FROM
from fmu_src.system import model_of
from products import braked_vehicle
from rbd_model.levels.models import places_of
from tests.fmu_src.fmi.sled import sled

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "public.md").read_text(encoding="utf-8")
#: One table that a reader surveys: 31 names to simulate, readers of users' data, drivers of trains, rails they clean,
#: running behaviour with its modes, irregularities and creep curves, and six modules with further names.
MOST_NAMES = 54
MOST_LINES = 10
#: Heavy third-party packages that `import bogie_braking` must not import.
HEAVY = ("numpy", "casadi", "scipy", "matplotlib", "fmpy", "pandas")
BRAKED = {"initial_speed": 25.0, "brake_torque_1": 20e3, "brake_torque_2": 20e3}
#: A coach braked at 300 kPa; the friction of its shoes and the noise [m/s] in the generated data.
DEMANDS = {f"pressure_demand_{number}": 300e3 for number in (1, 2, 3, 4)}
COACH = {"level": 2.0, "initial_speed": 30.0, **DEMANDS}
FRICTION, NOISE = "constant_shoe_friction", 0.1
TRUE_FRICTION = 0.27


# ---- names ---------------------------------------------------------------------------------------------------------


def test_the_page_tells_of_every_name_and_of_no_other() -> None:
    table = [line.split("|")[1] for line in PAGE.splitlines() if line.startswith("| `")]
    assert sorted(re.findall(r"`(\w+)`", " ".join(table))) == sorted(bb.__all__)
    assert len(bb.__all__) <= MOST_NAMES


def test_type_checkers_and_the_interpreter_find_the_same_names() -> None:
    """Type checkers read the imports under TYPE_CHECKING, the interpreter calls `__getattr__`."""
    tree = ast.parse((ROOT / "bogie_braking" / "__init__.py").read_text(encoding="utf-8"))
    [seen] = [node for node in tree.body if isinstance(node, ast.If)]
    found = {alias.asname: (node.module, alias.name) for node in seen.body for alias in node.names}  # type: ignore[attr-defined]
    assert set(found) | {"__version__"} == set(bb.__all__)
    for name, (module, own) in found.items():
        assert getattr(bb, name) is getattr(sys.modules[module], own), name
    assert set(dir(bb)) == set(bb.__all__)


def test_a_name_that_there_is_not_is_told() -> None:
    with pytest.raises(AttributeError, match="no public name xyz; it has __version__, "):
        bb.xyz  # noqa: B018
    with pytest.raises(AttributeError, match=r"no public name vehicles; did you mean vehicle\?"):
        bb.vehicles  # noqa: B018


def test_a_task_of_the_page_takes_ten_lines_at_most() -> None:
    """Blank lines and imports of other packages are not counted."""
    blocks = re.findall(r"^```python\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)
    for block in blocks:
        lines = [line for line in block.splitlines() if line and not line.startswith("import ")]
        assert len(lines) <= MOST_LINES, block


def test_the_import_is_light_and_so_is_the_help() -> None:
    """Prints the time that each takes."""
    asked = f"import sys, bogie_braking; print([name for name in {HEAVY} if name in sys.modules])"
    for command in (["-c", asked], ["-m", "bogie_braking", "--help"]):
        begin = time.perf_counter()
        done = subprocess.run([sys.executable, *command], cwd=ROOT, capture_output=True, text=True, check=True)
        print(f"{command[0]}: {time.perf_counter() - begin:.2f} s")
        assert done.stdout.startswith(("[]", "usage: bogie-braking"))


# ---- runs ----------------------------------------------------------------------------------------------------------


def test_a_recording_has_units_sentences_counts_and_goes_into_files(tmp_path: Path) -> None:
    stop = bb.run("bogie", 20.0, names=["speed", "distance"], interval=0.5, **BRAKED)
    assert stop.units == {"time": "s", "speed": "m/s", "distance": "m"}
    assert stop["time"] == pytest.approx(np.arange(41) * 0.5)
    assert "The vehicle stands at" in stop.status
    assert stop.counts["steps"] > 10
    figure = stop.plot()
    assert [axis.get_ylabel() for axis in figure.axes] == ["speed [m/s]", "distance [m]"]
    assert bb.measured_from(stop.write(tmp_path / "stop.csv")).units == stop.units
    parquet = pytest.importorskip("pyarrow.parquet")
    table = parquet.read_table(stop.write(tmp_path / "stop.parquet"))
    assert table.column("speed").to_numpy() == pytest.approx(stop["speed"], abs=0.0)
    assert table.schema.field("distance").metadata[b"unit"] == b"m"
    with pytest.raises(ValueError, match=r"stop.xls must end in one of .csv, .parquet, .mat, .mf4, .h5; got .\.xls"):
        stop.write(tmp_path / "stop.xls")


def test_all_outputs_are_recorded_unless_some_are_named() -> None:
    names = bb.run("brake", 0.1).names
    assert {"time", "cylinder_pressure", "brake_torque"} <= set(names)
    assert "pressure_demand" not in names


def test_a_run_that_is_continued_from_a_saved_state_is_the_same_to_the_last_bit() -> None:
    one, other = bb.Simulation("bogie", **BRAKED), bb.Simulation("bogie")
    one.advance(3.0)
    other.restore(one.save())
    ends = [each.advance(14.0) for each in (one, other)]
    for name in ends[0].names:
        assert np.array_equal(ends[0][name], ends[1][name]), name
    assert ends[0].messages == ends[1].messages != []


@pytest.mark.study
def test_a_vehicle_goes_on_with_the_system_that_is_chosen_before_the_start() -> None:
    """Its name stands for all levels, but only the chosen one is compiled; the vehicle keeps its line."""
    climb = bb.line_of([bb.straight(1000.0, gradient=0.01)])
    chosen, moved = bb.Simulation("bogie", climb, level=1, **BRAKED), bb.Simulation("bogie", climb, **BRAKED)
    moved.set(level=1)
    assert np.array_equal(moved.advance(1.0)["speed"], chosen.advance(1.0)["speed"])
    other = bb.Simulation("bogie", climb)  # at level 2
    other.restore(chosen.save())
    assert other["level"] == 1.0
    assert np.array_equal(other.advance(1.0)["speed"], chosen.advance(1.0)["speed"])


@pytest.mark.parametrize("one", [np.int64(1), np.float32(1), 1.0])
def test_a_level_of_any_kind_of_number_is_that_level(one: float) -> None:
    chosen = bb.Simulation("bogie", level=1, **BRAKED).advance(0.5)["speed"]
    moved = bb.Simulation("bogie", **BRAKED)
    moved.set(level=one)
    for run in (bb.run("bogie", 0.5, level=one, **BRAKED), moved.advance(0.5)):
        assert np.array_equal(run["speed"], chosen)


def test_a_name_of_an_earlier_version_is_refused_with_the_new_one() -> None:
    with pytest.raises(AttributeError, match=r"no public name Slave; its name is FmuInstance now"):
        _ = bb.Slave  # type: ignore[attr-defined]
    with pytest.raises(bb.SimulationError, match=r"no variable contact_depth; its name is contact_model now"):
        bb.run("bogie", 1.0, level=3, contact_depth=2)
    with pytest.raises(KeyError, match=r"no variable said; its name is messages now"):
        bb.batch("brake", 1.0, ["cylinder_pressure"], said=True)
    with pytest.raises(KeyError, match=r"no setting strength; its name is brake_ratio now"):
        bb.protected_stops(None, strength=1.0)


def test_what_cannot_be_is_told_in_a_sentence() -> None:
    with pytest.raises(KeyError, match=r"There is no FMU coahc; did you mean coach\?"):
        bb.run("coahc", 1.0)
    with pytest.raises(KeyError, match=r"There is no FMU bogey; did you mean bogie\?"):
        bb.run("bogey", 1.0)
    with pytest.raises(bb.SimulationError, match=r"There is no variable inital_speed; did you mean initial_speed\?"):
        bb.run("bogie", 1.0, inital_speed=25.0)
    with pytest.raises(bb.SimulationError, match="brake_torque_1 must be at least 0"):
        bb.run("bogie", 1.0, brake_torque_1=-1.0)


def test_an_fmu_gives_the_numbers_of_a_run() -> None:
    """The FMU runs in communication steps and agrees within the tolerance of its integration."""
    with bb.FmuInstance(bb.fmu("bogie"), initial_speed=25.0) as bogie:
        bogie.start(brake_torque_1=20e3, brake_torque_2=20e3)
        for number in range(100):
            bogie.step(0.1 * number, 0.1)
        assert bogie["distance"] == pytest.approx(bb.run("bogie", 10.0, **BRAKED)["distance"][-1], rel=1e-7)


@pytest.mark.study
@pytest.mark.parametrize(
    ("call", "error", "sentence"),
    [
        (lambda: bb.run(bb.System, 1.0), TypeError, "a System or a Model; got the class System."),
        (lambda: bb.run(None, 1.0), TypeError, "a System or a Model; got None."),
        (lambda: bb.run(bb.System("M", ""), 1.0), ValueError, "The system M has no output; give it one."),
        (lambda: bb.run("bogie", -1.0), ValueError, "The duration must be a number of seconds above 0; got -1.0."),
        (lambda: bb.run("bogie", "10"), ValueError, "seconds above 0; got '10'."),
        (lambda: bb.run("bogie", 1.0, interval=0), ValueError, "The interval must be a number of seconds above 0"),
        (lambda: bb.run("bogie", 1e9), ValueError, "over 1e+08 numbers in 1e+09 s."),
        (lambda: bb.run("bogie", 1.0, names="speed"), TypeError, 'must be a list of variables, such as ["speed"]'),
        (lambda: bb.run("bogie", 1.0, names=["sped"]), KeyError, "no variable sped; did you mean speed?"),
        (lambda: bb.run("bogie", 1.0, names=[]), ValueError, "Name at least one variable to record"),
        (lambda: bb.run("bogie", 1.0, names=["speed", "speed"]), ValueError, "a name of its own; got speed twice."),
        (lambda: bb.sweep("bogie", 1.0, ["initial_speed"], {"initial_speed": [9]}), ValueError, "initial_speed twice."),
        (lambda: bb.Recording({"time": "s"}, [[0.0, 1.0], [1.0, 2.0]]), ValueError, "an array of shape (2, 2)."),
        (lambda: bb.run("bogie", 1.0, ["speed"]), TypeError, "The line must be what line_of(...) returns"),
        (lambda: bb.run("brake", 1.0, bb.line_of([bb.straight(9)])), bb.SimulationError, "brake runs on no line"),
        (lambda: bb.run("bogie", 1.0, names=["speed"])["sped"], KeyError, "no column sped; did you mean speed?"),
        (lambda: bb.run("bogie", 1.0).plot("sped"), KeyError, "no column sped; did you mean speed?"),
        (lambda: bb.Simulation("bogie").restore(b"abc"), bb.SimulationError, "The state must be one of bogie"),
        (lambda: bb.Simulation("wheelset").restore(bb.Simulation("bogie").save()), bb.SimulationError, "of wheelset"),
        (lambda: bb.fmu(bb.vehicle("bogie")), TypeError, "name of the FMU must be a text; got a Vehicle."),
        (lambda: bb.write_fmu("tram", "x.fmu"), KeyError, "There is no FMU tram"),
        (lambda: bb.write_fmu("bogie", "x.fmu", "python", level=1), ValueError, "kind must be native or fmi3"),
        (
            lambda: bb.sweep("bogie", 1.0, ["speed"], {"friction_1": 0.1}),
            ValueError,
            "friction_1 must be a list of numbers",
        ),
        (lambda: bb.sweep("bogie", 1.0, ["speed"], {}), ValueError, "number of values; got none."),
        (lambda: bb.sweep("bogie", 1.0, ["speed"], [0.1]), TypeError, "vary must have columns by name"),
        (
            lambda: bb.sweep("bogie", 1.0, ["speed"], {"friction_1": np.ma.array([0.1, 0.2], mask=[0, 1])}),
            ValueError,
            "friction_1 must be a list of numbers",
        ),
        (
            lambda: bb.batch("bogie", 1.0, ["speed"], friction_1=np.ma.array([0.1, 0.2], mask=[0, 1])),
            ValueError,
            "friction_1 must be one number, or a list of numbers",
        ),
        (lambda: bb.Recording({"time": "s"}, np.ma.array([[0.0]], mask=[[1]])), ValueError, "some are masked."),
        (
            lambda: bb.sweep("bogie", 1.0, ["speed"], {"friction_1": [0.1]}, friction_1=0.2),
            ValueError,
            "friction_1 must be given once; got it as a column of what varies and as a value.",
        ),
        (lambda: bb.run("bogie", 1.0, names=["zzzz"]), KeyError, " more."),
        (lambda: bb.run("bogie", 1.0, zzzz=1), bb.SimulationError, " more."),
        (lambda: bb.sweep("bogie", 1.0, ["speed"], {"friction_1": [0.1]}, frction_2=1), KeyError, "mean friction_2?"),
        (lambda: bb.sweep("bogie", 1.0, ["speed"], {"friction_1": [0.1]}, 4), TypeError, "or None; got 4."),
        (lambda: bb.fit("bogie", 3, {"frame_mass": 1.0}), TypeError, "path of a log; got 3."),
        (lambda: bb.straight(-5), ValueError, "A segment is -5 m long; give each a length above 0 m"),
        (lambda: bb.arc(100, "300"), ValueError, "The radius of an arc must be a number other than 0 m"),
        (lambda: bb.line_of([bb.straight(9)], float("nan")), ValueError, "must be a finite distance [m]; got nan."),
        (lambda: bb.line_of([bb.straight(9)], "5"), ValueError, "must be a finite distance [m]; got '5'."),
        (lambda: bb.arc(100, 0), ValueError, "The radius of an arc must be a number other than 0 m"),
        (lambda: bb.line_of(bb.straight(100)), TypeError, "The segments of a line must be a list"),
        (lambda: bb.clothoid(10, 3, 4), TypeError, "A clothoid must have a length and two segments"),
    ],
)
def test_a_mistake_is_told_in_a_sentence(call: Callable[[], object], error: type[Exception], sentence: str) -> None:
    with pytest.raises(error, match=re.escape(sentence)):
        call()


def test_equations_of_ones_own_become_an_fmu_of_any_kind(tmp_path: Path) -> None:
    """A body falls; the reference is the closed form. A model of several systems is exported the same way."""
    fall = bb.System("Fall", "A body that falls")
    gravity = fall.parameter(bb.Variable("gravity", "parameter", "m/s2", "Gravity", 9.81))
    height, speed = fall.state("height", "m", 0.0, 1.0), fall.state("speed", "m/s", 0.0, 1.0)
    fall.derivative(height, speed)
    fall.derivative(speed, -gravity)
    fall.output(bb.Variable("above", "output", "m", "Height"), height)
    for kind in ("native", "fmi3"):
        with bb.FmuInstance(bb.write_fmu(fall, tmp_path / f"{kind}.fmu", kind), gravity=2.0) as slave:
            slave.start()
            slave.step(0.0, 3.0)
            assert slave["above"] == pytest.approx(-9.0, rel=1e-6)
    in_process = bb.run(model_of(fall, 1e-6), 3.0, gravity=2.0)
    assert in_process.units == {"time": "s", "above": "m"}
    assert in_process["above"] == pytest.approx(-(in_process["time"] ** 2), rel=1e-6)
    with pytest.raises(KeyError, match="There is no kind of FMU fmi2; did you mean fmi3"):
        bb.write_fmu(fall, tmp_path / "none.fmu", "fmi2")


# ---- inputs over time ----------------------------------------------------------------------------------------------


def test_an_input_over_time_turns_a_shaft_as_its_integral_says() -> None:
    """A mass of 2 kg against closed forms: exact for straight lines, within sampling error for a function."""
    system = bb.System("Pushed", "A mass that is pushed")
    force = system.input(bb.Variable("force", "input", "N", "Force", 0.0))
    speed = system.state("speed", "m/s", 0.0, 1.0)
    system.derivative(speed, force / 2.0)
    system.output(bb.Variable("forward", "output", "m/s", "Speed"), speed)
    table = ([0.5, 1.5, 1.5, 2.0], [0.0, 4.0, -2.0, -2.0])  # a ramp, a jump, then constant
    run = bb.run(system, 3.0, None, ["forward", "force"], 0.3, force=table)
    time = run["time"]
    ramp = np.clip(time - 0.5, 0.0, 1.0) ** 2
    assert time == pytest.approx(0.3 * np.arange(11))
    assert run["forward"] == pytest.approx(ramp - np.clip(time - 1.5, 0.0, None), abs=1e-9)
    assert run["force"][2:5] == pytest.approx([0.4, 1.6, 2.8])
    assert run["force"][6:] == pytest.approx(-2.0)
    swung = bb.run(system, 3.0, None, ["forward"], 0.25, force=lambda time: 2.0 * np.cos(5.0 * time))
    assert swung["forward"] == pytest.approx(np.sin(5.0 * swung["time"]) / 5.0, abs=5e-6)
    assert abs(swung["forward"] - np.sin(5.0 * swung["time"]) / 5.0).max() > 1e-9  # its samples do make a difference


def test_a_brake_over_time_is_that_of_the_steps_which_set_it() -> None:
    """The brake is set step by step, by a table, and by a run saved in the middle and continued: the same results."""
    times, torques = [0.0, 2.0, 2.0, 4.0], [0.0, 20e3, 5e3, 5e3]
    by_table = bb.run(
        "bogie", 6.0, None, ["speed", "distance"], 0.5, initial_speed=25.0, brake_torque_1=(times, torques)
    )
    by_hand = bb.Simulation("bogie", initial_speed=25.0)
    for number in range(2000):
        by_hand.set(brake_torque_1=10e3 * (number + 0.5) * 1e-3)
        by_hand.advance(1e-3, ["speed"])
    by_hand.set(brake_torque_1=5e3)
    assert by_hand.advance(4.0, ["distance"])["distance"][-1] == pytest.approx(by_table["distance"][-1], rel=1e-6)
    first = bb.Simulation("bogie", initial_speed=25.0, brake_torque_1=(times, torques))
    first.advance(1.25)
    second = bb.Simulation("bogie", brake_torque_1=(times, torques))
    second.restore(first.save())
    assert second.advance(4.75, ["distance"])["distance"][-1] == pytest.approx(by_table["distance"][-1], rel=1e-7)


def test_a_ramp_that_ends_at_a_limit_is_not_refused() -> None:
    """The rounding of the last digit must not put a brake torque below 0."""
    for torque in np.random.default_rng(3).uniform(1.0, 20e3, 50):
        run = bb.run("bogie", 0.5, None, ["brake_torque_1"], 0.1, level=1, brake_torque_1=([0.1, 0.37], [torque, 0.0]))
        assert run["brake_torque_1"][-1] == pytest.approx(0.0, abs=1e-4)


def test_a_valve_over_time_stays_what_it_was_told_last() -> None:
    valve = bb.run("brake", 0.5, None, ["valve"], 0.1, valve=([0.0, 0.15, 0.35], [0, 2, 1]))["valve"]
    assert valve.tolist() == [0.0, 0.0, 2.0, 2.0, 1.0, 1.0]


@pytest.mark.parametrize(
    ("name", "given", "sentence"),
    [
        (
            "brake_torque_1",
            ([0.0, 2.0, 1.0], [0.0, 1.0, 2.0]),
            "The times of brake_torque_1 must increase; row 2 has 1 s.",
        ),
        ("brake_torque_1", ([0.0, np.nan], [0.0, 1.0]), "The times of brake_torque_1 must increase; row 1 has nan s."),
        ("brake_torque_1", ([0.0, 1.0], [0.0, np.nan]), "from 0 to 1e+09 N.m at all times; got nan at 1 s."),
        ("brake_torque_1", ([0.0, 1.0], [0.0, -5.0]), "from 0 to 1e+09 N.m at all times; got -5.0 at 1 s."),
        ("brake_torque_1", lambda time: 1.0 - time, "from 0 to 1e+09 N.m at all times; got "),
        ("brake_torque_1", lambda time: None, "got None at 0 s."),
        ("brake_torque_1", ([0.0, 1.0], [0.0]), "brake_torque_1 must have as many values as times"),
        ("brake_torque_1", None, "brake_torque_1 must be one number, a function of time, a pair"),
        ("brake_torque_1", [1.0, 2.0, 3.0], "brake_torque_1 must be one number, a function of time, a pair"),
        ("wheel_radius", ([0.0, 1.0], [0.4, 0.5]), "wheel_radius is not an input and cannot change over time"),
        ("speed", lambda time: time, "speed is not an input and cannot change over time"),
        ("brake_torqe_1", ([0.0, 1.0], [0.0, 1.0]), "no variable brake_torqe_1; did you mean brake_torque_1?"),
    ],
)
def test_what_cannot_be_an_input_over_time_is_refused(name: str, given: object, sentence: str) -> None:
    with pytest.raises(bb.SimulationError, match=re.escape(sentence)):
        bb.run("bogie", 2.0, **{name: given})  # type: ignore[arg-type]


#: Rocking of the frame on its springs in the mean of the last second, as a share of the transferred load.
ROCKING = 0.03


# ---- vehicles ------------------------------------------------------------------------------------------------------


def longer(name: str = "Longer", half_base: float = 1.75) -> parts.Vehicle:
    """Return the bogie of chapter 5 with another wheel base."""
    bogie = bb.vehicle("bogie")
    places = {"wheelset_1": half_base, "wheelset_2": -half_base}
    axles = tuple(parts.Wheelset(place, "frame") for place in places.values())
    springs = tuple(replace(one, place=(places[one.lower], *one.place[1:])) for one in bogie.connections)
    return replace(bogie, name=name, wheelsets=axles, connections=springs)


@pytest.mark.study
def test_a_ready_vehicle_as_data_runs_as_its_fmu_does() -> None:
    for level in (1, 2):
        scene = {"level": level, **BRAKED}
        own, ready = (bb.run(what, 20.0, **scene) for what in (bb.vehicle("bogie"), "bogie"))
        assert own.names == ready.names
        for name in ready.names:
            assert own[name] == pytest.approx(ready[name], rel=1e-9, abs=1e-9), name


@pytest.mark.study
def test_a_vehicle_of_ones_own_transfers_its_load_by_its_own_base(tmp_path: Path) -> None:
    """The front axle gains the load that the rear one loses, inversely to the wheel base (moments about the rail)."""
    loads = ["axle_load_1", "axle_load_2"]
    near, far = (bb.run(longer(half_base=half), 4.0, names=loads, **BRAKED) for half in (1.5, 3.0))
    moved = [float(run["axle_load_1"][-100:].mean() - run["axle_load_2"][-100:].mean()) for run in (near, far)]
    assert moved[0] / moved[1] == pytest.approx(2.0, rel=ROCKING)
    path = bb.write_fmu(longer(half_base=3.0), tmp_path / "Longer.fmu", level=2)
    with bb.FmuInstance(path, initial_speed=25.0) as slave:
        slave.start(brake_torque_1=20e3, brake_torque_2=20e3)
        slave.step(0.0, 4.0)
        assert slave["axle_load_1"] == pytest.approx(far["axle_load_1"][-1], rel=1e-6)


def test_vehicles_that_differ_in_their_profiles_alone_are_not_taken_for_each_other() -> None:
    """Descriptions are compared by the content of their profiles, and each has its own equations."""
    wheelset, pair = bb.vehicle("wheelset"), bb.vehicle("vehicle").wheelsets[0].pair
    other = replace(wheelset, wheelsets=tuple(replace(one, pair=pair) for one in wheelset.wheelsets))
    assert other != wheelset
    first, second, again = (machine_of(what, {"level": 1}, False) for what in (wheelset, other, wheelset))
    assert first is again
    assert first is not second


def test_what_cannot_be_of_a_vehicle_is_told_in_a_sentence(tmp_path: Path) -> None:
    with pytest.raises(
        KeyError, match=r"There is no vehicle tram; there are bogie, vehicle, coal-wagon, wheelset, coach\."
    ):
        bb.vehicle("tram")
    with pytest.raises(ValueError, match=r"level must be 1, 2 or 3; got 4\."):
        bb.run(longer(), 1.0, level=4)
    with pytest.raises(ValueError, match=r"contact_model must be 2 on a line; got 3\."):
        bb.run(longer(), 1.0, bb.line_of([bb.straight(100.0)]), level=3, contact_model=3)
    with pytest.raises(
        bb.SimulationError, match="level chose the equations of Longer; give it as the simulation is made"
    ):
        bb.Simulation(longer()).set(level=1)
    with pytest.raises(ValueError, match=r"level must be 1, 2 or 3, or left out for all of them; got 7\."):
        bb.write_fmu(longer(), tmp_path / "one.fmu", level=7)
    with pytest.raises(ValueError, match=r"one must end with .fmu"):
        bb.write_fmu(longer(), tmp_path / "one")


# ---- controllers ---------------------------------------------------------------------------------------------------


class LetGo:
    """Release wheelsets slower than the fastest one."""

    def step(self, time: float, wheel_speeds: list[float]) -> list[int]:
        return [2 if speed < 0.8 * max(wheel_speeds) else 0 for speed in wheel_speeds]


class Fails:
    """Return no commands."""

    def step(self, time: float, wheel_speeds: list[float]) -> list[int]:
        raise RuntimeError("no more")


def test_a_controller_of_ones_own_stops_on_all_rails() -> None:
    stops = bb.protected_stops(LetGo)
    assert [said.split(":")[0] for said in stops.messages] == ["dry", "wet", "low", "changing"]
    assert stops["distance"][0] == pytest.approx(stops["distance"][1], rel=1e-3)
    assert stops["distance"][2] == stops["distance"].max()
    assert "low: 679 m, locked for 0.3 s." in stops.status
    assert stops["air"].min() > 0.0
    assert stops.units == {
        "number": "1",
        "friction": "1",
        "distance": "m",
        "duration": "s",
        "longest_lock": "s",
        "share_in_band": "1",
        "air": "kg",
    }


def test_a_stop_over_time_is_that_of_the_table() -> None:
    """The stop uses the brake and the sensors of the protection, sampled at the given period."""
    table = bb.protected_stops("protection", rails=["low"], pulses=80, period=10e-3)
    stop = bb.protected_stop("protection", "low", pulses=80, period=10e-3)
    assert stop.status == table.status
    assert np.diff(stop["time"]) == pytest.approx(10e-3)
    assert np.trapezoid(stop["speed"], stop["time"]) == pytest.approx(table["distance"][0], abs=0.5)
    none = bb.protected_stop(None, "low")
    assert none.counts == {"commands": 0}
    assert none["wheel_speed_1"].min() == 0.0


def test_a_controller_that_fails_has_no_stopping_distance() -> None:
    stops = bb.protected_stops(Fails, rails=["dry"])
    assert np.isnan(stops["distance"][0])
    assert "dry: The controller Fails failed at 0 s (RuntimeError: no more, test_public.py, line " in stops.status


@pytest.mark.parametrize(
    ("given", "more", "error", "sentence"),
    [
        (
            LetGo(),
            {},
            TypeError,
            "The controller must be the class LetGo; got an object of it. Each stop begins with a new one.",
        ),
        (dict, {}, TypeError, "The class dict has no method step(time, wheel_speeds); give it one."),
        (3, {}, TypeError, 'The controller must be a class, "protection" or None; got 3.'),
        ("protecton", {}, TypeError, "The controller must be a class, \"protection\" or None; got 'protecton'."),
        (LetGo, {"pulse": 80}, KeyError, "There is no setting pulse; did you mean pulses?"),
        (LetGo, {"pulses": 0}, ValueError, "pulses must be an integer of at least 1; got 0."),
        (LetGo, {"period": -1.0}, ValueError, "period must be a finite number above 0; got -1.0."),
        (LetGo, {"rails": ["wett"]}, KeyError, "There is no rail wett; did you mean wet?"),
        (LetGo, {"rails": "wet"}, TypeError, 'rails must be a list of names, such as ["wet"]'),
        (
            LetGo,
            {"vehicle": "coal-wagon"},
            KeyError,
            "There is no vehicle with brakes coal-wagon; there are bogie, vehicle, coach.",
        ),
    ],
)
def test_what_is_no_controller_is_refused(given: object, more: dict, error: type[Exception], sentence: str) -> None:
    with pytest.raises(error, match=re.escape(sentence)):
        bb.protected_stops(given, **more)  # type: ignore[arg-type]


# ---- many runs -----------------------------------------------------------------------------------------------------


def test_a_sweep_is_its_runs_in_their_order_whoever_makes_them() -> None:
    """Run by threads here and by processes as on a cluster; a refused run keeps its row and gives the reason."""
    vary = {"friction_1": [0.1, 0.2, 0.3, -1.0], "friction_2": [0.1, 0.2, 0.3, 0.3]}
    threads = bb.sweep("bogie", 60.0, ["distance"], vary, **BRAKED)
    with ProcessPoolExecutor(1) as executor:
        processes = bb.sweep("bogie", 60.0, ["distance"], vary, executor, **BRAKED)
    alone = [bb.run("bogie", 60.0, friction_1=mu, friction_2=mu, **BRAKED)["distance"][-1] for mu in (0.1, 0.2, 0.3)]
    assert threads["distance"][:3] == pytest.approx(alone, rel=1e-9)
    assert np.array_equal(threads["distance"], processes["distance"], equal_nan=True)
    assert np.isnan(threads["distance"][3])
    assert "friction_1 must be at least" in threads.messages[3]
    assert threads.units == {"number": "1", "friction_1": "1", "friction_2": "1", "distance": "m"}
    with pytest.raises(KeyError, match=r"There is no variable distanze; did you mean distance\?"):
        bb.sweep("bogie", 1.0, ["distanze"], {"friction_1": [0.1]})
    with pytest.raises(ValueError, match="the same number of values"):
        bb.sweep("bogie", 1.0, ["distance"], {"friction_1": [0.1], "friction_2": [0.1, 0.2]})


class Mixed(ThreadPoolExecutor):
    """Return the results of the first task for all later ones."""

    first: Any = None

    def submit(self, function: Any, *task: Any, **more: Any) -> Any:
        self.first = self.first or task
        return super().submit(function, *self.first, **more)


@pytest.mark.parametrize("count", [2, 2 * PAYS_FROM])
def test_results_of_another_row_are_refused(count: int) -> None:
    vary = {"friction_1": np.linspace(0.1, 0.3, count)}
    with Mixed(1) as executor, pytest.raises(RuntimeError, match="A worker must return the results of"):
        bb.sweep("bogie", 0.01, ["distance"], vary, executor, level=1, **BRAKED)


def test_a_sweep_in_a_folder_goes_on_where_it_was_interrupted(tmp_path: Path) -> None:
    """It resumes from the event log and the table that the command line uses, and equals the sweep without a folder."""
    folder, vary = tmp_path / "stops", {"friction_1": [0.1, 0.2, -1.0]}
    scene: dict[str, Any] = {"level": 1, "friction_2": 0.2, **BRAKED}
    without = bb.sweep("bogie", 5.0, ["distance"], vary, **scene)
    for _ in range(2):
        kept = bb.sweep("bogie", 5.0, ["distance"], vary, folder=folder, **scene)
        assert np.array_equal(kept["distance"], without["distance"], equal_nan=True)
        assert kept.messages == without.messages
        journal = (folder / "journal.jsonl").read_bytes()
        (folder / "journal.jsonl").write_bytes(journal[: -len(journal.splitlines()[-1]) // 2])
    assert "\nfriction_1 [1],distance [m],failure\n0.1," in (folder / "table.csv").read_text()
    for other, sentence in (
        (scene | {"friction_2": 0.3}, "held friction_2 (0.2, now 0.3)"),
        (scene | {"friction_2": lambda time: 0.3}, "Leave folder out."),
    ):
        with pytest.raises((ValueError, TypeError), match=re.escape(sentence)):
            bb.sweep("bogie", 5.0, ["distance"], vary, folder=folder, **other)
    with pytest.raises(TypeError, match=r"got equations or a function\. Leave folder out\.$"):
        bb.sweep(sled().systems[0], 0.5, ["distance"], {"mass": [10.0]}, folder=tmp_path / "sled")
    with pytest.raises(ValueError, match="friction_1 must be finite where a folder keeps the runs"):
        bb.sweep("bogie", 5.0, ["distance"], {"friction_1": [np.nan]}, folder=folder, **scene)


def test_a_value_that_is_refused_is_told_with_its_row_and_no_other_stays_in_force(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Run alone and in a batch. An earlier message claimed that the start value was used where the row is NaN."""
    system = sled().systems[0]
    masses = {"mass": [10.0, -1e9, float("nan"), 10.0]}
    tables = [bb.sweep(system, 0.5, ["distance"], masses)]
    monkeypatch.setattr(sweeping, "PAYS_FROM", 2)
    tables.append(bb.sweep(system, 0.5, ["distance"], masses))
    for table in tables:
        assert np.isnan(table["distance"]).tolist() == [False, True, True, False]
        assert table.messages == [
            "",
            "Row 1: mass must be at least 0.001 kg; got -1e+09 kg.",
            "Row 2: mass must be a finite number; got nan.",
            "",
        ]
    with pytest.raises(bb.SimulationError, match=r"^mass must be at least 0.001 kg; got -1 kg\.$"):
        bb.run(system, 0.5, mass=-1.0)
    [failure] = bb.batch(system, 0.5, ["distance"], mass=[10.0, -1.0]).failures.values()
    assert failure == "mass must be at least 0.001 kg; got -1 kg."


def test_a_signal_that_is_lost_before_the_first_step_is_told() -> None:
    """Before, the brake was applied without a message."""
    assert bb.run("brake", 0.1, pressure_demand=float("nan")).messages == [
        "The signal pressure_demand is lost (NaN): it counts as 350000 Pa, the safe side."
    ]


@pytest.mark.study
def test_a_dask_cluster_gives_the_numbers_of_threads_here() -> None:
    """Two worker processes receive an input over time, one of our vehicles and a line."""
    distributed = pytest.importorskip("distributed")
    line = bb.line_of([bb.straight(500.0, gradient=-0.01)])
    scene = {"level": 2, "initial_speed": 20.0, "brake_torque_1": ([0.0, 1.0], [0.0, 9e3])}
    vary = {"friction_1": [0.05, 0.1, -1.0]}
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        for what in ("bogie", longer()):
            far = bb.sweep(what, 5.0, ["distance", "speed"], vary, client.get_executor(), line, **scene)
            near = bb.sweep(what, 5.0, ["distance", "speed"], vary, None, line, **scene)
            for name in near.names:
                assert np.array_equal(far[name], near[name], equal_nan=True), name
            assert far.messages == near.messages
            assert near["speed"][0] > near["speed"][1]
            assert np.isnan(near["speed"][2])


def test_equations_of_ones_own_are_swept_here_and_sent_nowhere() -> None:
    fall = bb.System("Falling", "A body that falls")
    speed = fall.state("speed", "m/s", 0.0, 1.0)
    fall.derivative(speed, -fall.parameter(bb.Variable("gravity", "parameter", "m/s2", "Gravity", 9.81)))
    fall.output(bb.Variable("upwards", "output", "m/s", "Speed"), speed)
    assert bb.sweep(fall, 2.0, ["upwards"], {"gravity": [1.0, 2.0]})["upwards"] == pytest.approx([-2.0, -4.0])
    with ProcessPoolExecutor(1) as executor, pytest.raises(TypeError, match="leave it out, and threads run them here"):
        bb.sweep(fall, 2.0, ["upwards"], {"gravity": [1.0]}, executor)


# ---- fits ----------------------------------------------------------------------------------------------------------


def measured(seed: int) -> bb.Recording:
    """Return the coach's speed every 0.1 s, with noise."""
    run = bb.run("braked-vehicle", 20.0, None, ["speed"], 0.1, **COACH, **{FRICTION: TRUE_FRICTION})
    noise = np.random.default_rng(seed).normal(0.0, NOISE, run["speed"].size)
    return bb.Recording(run.units, np.column_stack([run["time"], run["speed"] + noise]).tolist())


@pytest.mark.study
def test_friction_of_a_shoe_lies_within_two_standard_errors_in_95_of_100_seeds() -> None:
    within = 0
    for seed in range(100):
        found = bb.fit("braked-vehicle", measured(seed), {FRICTION: 0.2}, **COACH)
        within += abs(found.values[FRICTION] - TRUE_FRICTION) < 2 * found.standard_errors[FRICTION]
        assert found.deviations["speed"] == pytest.approx(NOISE, rel=0.3)
    assert 90 <= within <= 99


def test_parameters_that_act_together_alone_and_those_that_do_not_act_are_named() -> None:
    both = bb.fit("braked-vehicle", measured(1), {FRICTION: 0.2, "rigging_efficiency": 0.8}, **COACH)
    assert both.unidentifiable == [(FRICTION, "rigging_efficiency")]
    assert both.values[FRICTION] * both.values["rigging_efficiency"] == pytest.approx(0.85 * TRUE_FRICTION, rel=2e-3)
    assert set(both.standard_errors.values()) == {np.inf}
    assert f"{FRICTION} and rigging_efficiency are not identifiable separately" in both.status
    silent = bb.fit("braked-vehicle", measured(1), {FRICTION: 0.2, "body_roll_inertia": 5e4}, **COACH)
    assert silent.unidentifiable == [("body_roll_inertia",)]
    assert silent.standard_errors[FRICTION] < 1e-3


def table_of(units: dict[str, str]) -> bb.Recording:
    """Return three rows of growing values."""
    return bb.Recording(units, [[0.1 * row + column for column, _ in enumerate(units)] for row in range(3)])


@pytest.mark.parametrize(
    ("units", "error", "sentence"),
    [
        ({"time": "s", "speed": "kPa"}, ValueError, "speed must be in m/s; got kPa in the measured data."),
        ({"time": "s", "sped": "m/s"}, KeyError, "There is no variable sped; did you mean speed?"),
        ({"speed": "m/s", "time": "s"}, ValueError, "The first column of the measured data must be time [s]"),
        ({"time": "s", "pressure_demand_1": "Pa"}, ValueError, "The measured data must have at least one output"),
    ],
)
def test_a_measured_table_of_something_else_is_refused(units: dict, error: type[Exception], sentence: str) -> None:
    with pytest.raises(error, match=re.escape(sentence)):
        bb.fit("braked-vehicle", table_of(units), {FRICTION: 0.2}, **COACH)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "it is empty. Give a table."),
        ("speed [m/s]\n1\n", "row 1: the column time is missing"),
        ("time [s],speed [m/s]\n0,1\n0,1\n", "must have at least 2 rows of values; it has 1."),
        ("time [s],speed [m/s]\n0,1\n1,two\n", "row 3, column speed: the value must be a number; got 'two'."),
        ("time [s],speed [m/s]\n0,1\n0,2\n", "row 3, column time: values must grow from row to row"),
    ],
)
def test_a_file_that_is_no_measured_run_is_refused(text: str, sentence: str, tmp_path: Path) -> None:
    path = tmp_path / "measured.csv"
    path.write_text(text)
    with pytest.raises(ValueError, match=re.escape(sentence)):
        bb.measured_from(path)


def test_a_fit_takes_a_line_and_the_inputs_that_were_measured() -> None:
    """The run descends a gradient under a measured torque. The fit finds the mass; without the line it cannot."""
    line = bb.line_of([bb.straight(1000.0, gradient=-0.02)])
    torque = np.array([0.0, 0.0, 4e3, 9e3, 9e3, 2e3])
    time = np.arange(6.0)
    scene = {"level": 1, "initial_speed": 20.0}
    run = bb.run("bogie", 5.0, line, ["speed"], 1.0, brake_torque_1=(time, torque), frame_mass=30e3, **scene)
    run.add("brake_torque_1", "N.m", torque)
    found = bb.fit("bogie", run, {"frame_mass": 20e3}, line, **scene)
    assert found.values["frame_mass"] == pytest.approx(30e3, rel=1e-5)
    assert list(found.deviations) == ["speed"]
    assert "frame_mass = 3e+04" in found.status
    off = bb.fit("bogie", run, {"frame_mass": 20e3}, **scene)
    assert off.deviations["speed"] > 1e-2


def test_a_fit_without_a_beginning_is_refused() -> None:
    for parameters, sentence in (
        ({FRICTION: 0.0}, "not 0"),
        (
            {"constant_shoe_fricton": 0.2},
            "no real parameter or free input constant_shoe_fricton; did you mean constant_shoe_friction?",
        ),
    ):
        with pytest.raises(ValueError, match=re.escape(sentence)):
            bb.fit("braked-vehicle", measured(1), parameters, **COACH)


def test_a_value_that_a_fit_would_not_use_is_refused() -> None:
    run = bb.Recording(
        {"time": "s", "speed": "m/s", "brake_torque_1": "N.m"}, np.ones((9, 3)) * np.arange(9.0)[:, None]
    )
    for begin, values, sentence in (
        ({"initial_speed": 20.0}, {"initial_speed": 25.0}, "initial_speed must be given once; got it as a parameter"),
        ({"frame_mass": 20e3}, {"brake_torque_1": 5.0}, "brake_torque_1 must be given once; got it as a column"),
    ):
        with pytest.raises(ValueError, match=sentence):
            bb.fit("bogie", run, begin, level=1, **values)


def test_a_file_that_is_not_there_is_named_with_what_it_should_be() -> None:
    with pytest.raises(FileNotFoundError, match=r"The file none\.csv does not exist\. Check the path\."):
        bb.measured_from("none.csv")
    with pytest.raises(FileNotFoundError, match=r"There is no file none\.fmu; give the path of an FMU"):
        bb.FmuInstance("none.fmu")


def test_a_name_of_ones_own_is_no_alias() -> None:
    assert known("coach", ["coach", "vehicle"], "variable") == "coach"
    assert known("coach", ["bogie", "vehicle"], "FMU") == "vehicle"


def test_a_terminal_is_told_of_cylinders_by_flow_of_air(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    machines.announce("braked-vehicle", max(braked_vehicle.PLACES))
    assert "Compiling the braked-vehicle at level 2 with cylinders by flow of air" in capsys.readouterr().err


def test_people_say_coach() -> None:
    assert bb.vehicle("coach") == bb.vehicle("vehicle")
    with pytest.raises(bb.SimulationError, match=r"no variable creep_law; a vehicle has it: dataclasses\.replace\("):
        bb.run("rail", 1.0, creep_law="fastsim")


@pytest.mark.parametrize(
    ("level", "said"), [(2, "Compiling the bogie at level 2: about 4 s"), (3, "level 3 with contact")]
)
def test_a_terminal_says_what_is_compiled_and_a_file_does_not(
    level: int, said: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    place = places_of(level, 2, on_line=False)[0]
    machines.announce("bogie", place)
    assert capsys.readouterr().err == ""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    machines.announce("bogie", place)
    assert said in capsys.readouterr().err

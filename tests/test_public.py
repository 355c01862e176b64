"""The public face: what it names, and what its names do."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import bogie_braking as bb
from fmu_src.system import model_of

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "public.md").read_text(encoding="utf-8")
MOST_NAMES = 30
#: What `import bogie_braking` may import of others: nothing that is heavy.
HEAVY = ("numpy", "casadi", "scipy", "matplotlib", "fmpy", "pandas")
BRAKED = {"initial_speed": 25.0, "brake_torque_1": 20e3, "brake_torque_2": 20e3}
#: A coach that is braked at 300 kPa, with the friction of its shoes that the data are made with, and their noise [m/s].
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
    """Those see what stands under TYPE_CHECKING, this what `__getattr__` finds."""
    tree = ast.parse((ROOT / "bogie_braking" / "__init__.py").read_text(encoding="utf-8"))
    [seen] = [node for node in tree.body if isinstance(node, ast.If)]
    found = {alias.asname: (node.module, alias.name) for node in seen.body for alias in node.names}  # type: ignore[attr-defined]
    assert set(found) | {"__version__"} == set(bb.__all__)
    for name, (module, own) in found.items():
        assert getattr(bb, name) is getattr(sys.modules[module], own), name
    assert set(dir(bb)) == set(bb.__all__)


def test_a_name_that_there_is_not_is_told() -> None:
    with pytest.raises(AttributeError, match="no public name stop; it has __version__, "):
        bb.stop  # noqa: B018


def test_the_import_is_light_and_so_is_the_help() -> None:
    """Prints what they take."""
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
    assert "Wheelset 1 stands at" in stop.status
    assert stop.counts["steps"] > 10
    figure = stop.plot()
    assert [axis.get_ylabel() for axis in figure.axes] == ["[m/s]", "[m]"]
    assert bb.measured_from(stop.write(tmp_path / "stop.csv")).units == stop.units
    parquet = pytest.importorskip("pyarrow.parquet")
    table = parquet.read_table(stop.write(tmp_path / "stop.parquet"))
    assert table.column("speed").to_numpy() == pytest.approx(stop["speed"], abs=0.0)
    assert table.schema.field("distance").metadata[b"unit"] == b"m"
    with pytest.raises(ValueError, match=r"stop.xls ends with .xls; a table is a .csv or a .parquet."):
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
    assert ends[0].sentences == ends[1].sentences != []


def test_what_cannot_be_is_told_in_a_sentence() -> None:
    with pytest.raises(KeyError, match=r"There is no FMU bogey; did you mean bogie\?"):
        bb.run("bogey", 1.0)
    with pytest.raises(bb.KernelError, match=r"There is no variable inital_speed; did you mean initial_speed\?"):
        bb.run("bogie", 1.0, inital_speed=25.0)
    with pytest.raises(bb.KernelError, match="Set brake_torque_1 to at least 0"):
        bb.run("bogie", 1.0, brake_torque_1=-1.0)


def test_an_fmu_gives_the_numbers_of_a_run() -> None:
    """Through FMI, in steps of its host, to the tolerance of its integration."""
    with bb.Slave(bb.fmu("bogie"), initial_speed=25.0) as bogie:
        bogie.start(brake_torque_1=20e3, brake_torque_2=20e3)
        for number in range(100):
            bogie.step(0.1 * number, 0.1)
        assert bogie["distance"] == pytest.approx(bb.run("bogie", 10.0, **BRAKED)["distance"][-1], rel=1e-7)


def test_equations_of_ones_own_become_an_fmu_of_any_kind(tmp_path: Path) -> None:
    """A body that falls, against its closed form; a model of several systems goes the same way."""
    fall = bb.System("Fall", "A body that falls")
    gravity = fall.parameter(bb.Variable("gravity", "parameter", "m/s2", "Gravity", 9.81))
    height, speed = fall.state("height", "m", 0.0, 1.0), fall.state("speed", "m/s", 0.0, 1.0)
    fall.derivative(height, speed)
    fall.derivative(speed, -gravity)
    fall.output(bb.Variable("above", "output", "m", "Height"), height)
    for kind in ("native", "fmi3"):
        with bb.Slave(bb.write_fmu(fall, tmp_path / f"{kind}.fmu", kind), gravity=2.0) as slave:
            slave.start()
            slave.step(0.0, 3.0)
            assert slave["above"] == pytest.approx(-9.0, rel=1e-6)
    in_process = bb.run(model_of(fall, 1e-6), 3.0, gravity=2.0)
    assert in_process.units == {"time": "s", "above": "m"}
    assert in_process["above"] == pytest.approx(-(in_process["time"] ** 2), rel=1e-6)
    with pytest.raises(KeyError, match="There is no kind of FMU fmi2; did you mean fmi3"):
        bb.write_fmu(fall, tmp_path / "none.fmu", "fmi2")


# ---- many runs -----------------------------------------------------------------------------------------------------


def test_a_sweep_is_its_runs_in_their_order_whoever_makes_them() -> None:
    """Threads here, processes as a cluster has them; a run that is refused keeps its row and says why."""
    vary = {"friction_1": [0.1, 0.2, 0.3, -1.0], "friction_2": [0.1, 0.2, 0.3, 0.3]}
    threads = bb.sweep("bogie", 60.0, ["distance"], vary, **BRAKED)
    with ProcessPoolExecutor(1) as executor:
        processes = bb.sweep("bogie", 60.0, ["distance"], vary, executor, **BRAKED)
    alone = [bb.run("bogie", 60.0, friction_1=mu, friction_2=mu, **BRAKED)["distance"][-1] for mu in (0.1, 0.2, 0.3)]
    assert threads["distance"][:3] == pytest.approx(alone, rel=1e-9)
    assert np.array_equal(threads["distance"], processes["distance"], equal_nan=True)
    assert np.isnan(threads["distance"][3])
    assert "Set friction_1 to at least" in threads.sentences[3]
    assert threads.units == {"number": "1", "friction_1": "1", "friction_2": "1", "distance": "m"}
    with pytest.raises(KeyError, match=r"There is no variable distanze; did you mean distance\?"):
        bb.sweep("bogie", 1.0, ["distanze"], {"friction_1": [0.1]})
    with pytest.raises(ValueError, match="the same number of values"):
        bb.sweep("bogie", 1.0, ["distance"], {"friction_1": [0.1], "friction_2": [0.1, 0.2]})


# ---- fits ----------------------------------------------------------------------------------------------------------


def measured(seed: int) -> bb.Recording:
    """The coach's speed every 0.1 s, with noise."""
    run = bb.run("braked-vehicle", 20.0, None, ["speed"], 0.1, **COACH, **{FRICTION: TRUE_FRICTION})
    noise = np.random.default_rng(seed).normal(0.0, NOISE, run["speed"].size)
    return bb.Recording(run.units, np.column_stack([run["time"], run["speed"] + noise]).tolist())


def test_friction_of_a_shoe_lies_within_two_standard_errors_in_95_of_100_seeds() -> None:
    within = 0
    for seed in range(100):
        found = bb.fit("braked-vehicle", measured(seed), {FRICTION: 0.2}, **COACH)
        within += abs(found.values[FRICTION] - TRUE_FRICTION) < 2 * found.standard_errors[FRICTION]
        assert found.deviations["speed"] == pytest.approx(NOISE, rel=0.3)
    assert 90 <= within <= 99


def test_parameters_that_act_together_alone_and_those_that_do_not_act_are_named() -> None:
    both = bb.fit("braked-vehicle", measured(1), {FRICTION: 0.2, "rigging_efficiency": 0.8}, **COACH)
    assert both.together == [(FRICTION, "rigging_efficiency")]
    assert both.values[FRICTION] * both.values["rigging_efficiency"] == pytest.approx(0.85 * TRUE_FRICTION, rel=2e-3)
    assert set(both.standard_errors.values()) == {np.inf}
    assert f"cannot tell {FRICTION} and rigging_efficiency apart" in both.status
    silent = bb.fit("braked-vehicle", measured(1), {FRICTION: 0.2, "body_roll_inertia": 5e4}, **COACH)
    assert silent.together == [("body_roll_inertia",)]
    assert silent.standard_errors[FRICTION] < 1e-3


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "give the first line names with units"),
        ("speed [m/s],time [s]\n1,2\n", "time first"),
        ("time [s],speed [m/s]\n0,1\n1\n", "line 3: give 2 finite numbers; there is '1'"),
        ("time [s],speed [m/s]\n0,1\n1,nan\n", "line 3"),
        ("time [s],speed [m/s]\n0,1\n0,1\n", "at least two rows whose time grows"),
    ],
)
def test_a_file_that_is_no_measured_run_is_refused(text: str, sentence: str, tmp_path: Path) -> None:
    path = tmp_path / "measured.csv"
    path.write_text(text)
    with pytest.raises(ValueError, match=re.escape(sentence)):
        bb.measured_from(path)


def test_a_fit_without_a_beginning_is_refused() -> None:
    for parameters, sentence in (
        ({FRICTION: 0.0}, "not 0"),
        ({"constant_shoe_fricton": 0.2}, "no parameter constant_shoe_fricton; did you mean constant_shoe_friction?"),
    ):
        with pytest.raises(ValueError, match=re.escape(sentence)):
            bb.fit("braked-vehicle", measured(1), parameters, **COACH)

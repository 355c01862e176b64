"""FMUs of trains: both standards against the class, states, refused inputs, damaged consists, C under sanitizers."""

from __future__ import annotations

import math
import re
import shutil
import subprocess
import xml.etree.ElementTree as ET
import zipfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from fmpy import read_model_description, simulate_fmu
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu

from brake_controller.distributors import DISTRIBUTORS
from brake_controller.distributors.vacuum import VacuumBrake
from brake_controller.vacuum_valve import vacuum_valve
from fmu_src.arrays_fmu import all_sources
from fmu_src.compile import FLAGS, compiler, objects_of
from fmu_src.cosimulation.faces import face_of
from fmu_src.cosimulation.slave import CosimulationError, FmuInstance
from products.building import write_in_c
from products.train.consist import Consist, block_train
from products.train.consist_file import consist_of
from products.train.fmu import OUTPUTS, train_fmu, train_in_c
from products.train.layout import layout
from products.train.library import functions
from products.train.numbers import Settings, numbers_of
from products.train.train import Train
from rbd_model.track.line import Line
from tests.fmu_src.fmi.hosting import sign
from tests.fmu_src.fmi.objects import OBJECTS
from tests.fmu_src.fmi.sanitized import HEADERS, run

STEP, COUNT, SPEED, PULL = 0.125, 32, 20.0, 65536.0
SHORT, LONG, LIGHT = block_train(2), block_train(5), block_train(2, load=10e3)
CONSISTS = {"short": SHORT, "long": LONG, "light": LIGHT}
#: Outputs with one element for each vehicle or coupling.
OF_EACH = [one.name for one in OUTPUTS[:8]]


@pytest.fixture(scope="module")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> dict[tuple[str, int], Path]:
    """Return the FMUs by consist and version of FMI."""
    folder = tmp_path_factory.mktemp("trains")
    found = {(name, version): folder / f"{name}{version}.fmu" for name in CONSISTS for version in (2, 3)}
    for (name, version), path in found.items():
        write_in_c(train_fmu(CONSISTS[name]), path, version)
    return found


class Host:
    """A train in an FMU of either standard, with arrays by name."""

    def __init__(self, path: Path) -> None:
        self.path, self.slave = path, FmuInstance(path)
        self.two = read_model_description(str(path)).fmiVersion == "2.0"
        self.count = 0

    def put(self, name: str, values: Sequence[float]) -> None:
        """Set an array; an array of one element is a scalar variable."""
        if len(values) == 1 and name in self.slave.units:
            self.slave.set(**{name: values[0]})
        elif self.two:
            self.slave.set(**{f"{name}[{number}]": value for number, value in enumerate(values, 1)})
        else:
            self.slave.set(**{name: list(values)})

    def array(self, name: str) -> list[float]:
        """Return the elements of an array."""
        if not self.two:
            return [float(value) for value in self.slave.array(name)]
        return self.slave.get([one for one in self.slave.units if one.startswith(f"{name}[")])

    def outputs(self) -> list[list[float]]:
        """Return the outputs of OF_EACH."""
        return [self.array(name) for name in OF_EACH]

    def go(self, steps: int = 1) -> None:
        """Make `steps` steps."""
        for _ in range(steps):
            self.slave.step(self.count * STEP, STEP)
            self.count += 1

    def state(self) -> bytes:
        """Return the whole state, serialised."""
        saved = self.slave.save()
        fmu = self.slave.fmu
        found = bytes(fmu.serializeFMUstate(saved) if self.two else fmu.serializeFMUState(saved))
        self.slave.forget(saved)
        return found

    def take(self, state: bytes) -> None:
        """Restore a serialised state."""
        read = self.slave.fmu.deSerializeFMUstate if self.two else self.slave.fmu.deserializeFMUState
        saved = self.slave._call(read, state)
        self.slave.restore(saved)
        self.slave.forget(saved)


@pytest.fixture(params=[2, 3])
def train(request: pytest.FixtureRequest, fmus: dict[tuple[str, int], Path]) -> Iterator[Host]:
    """Yield a train that has run for 1 s with its brake applied."""
    host = started(fmus["short", request.param])
    with host.slave:
        host.put("driver_position", [4])
        host.go(8)
        yield host


def started(path: Path) -> Host:
    """Return a train that runs at SPEED."""
    host = Host(path)
    host.slave.set(start_speed=SPEED)
    host.slave.start()
    return host


def refused(host: Host, call: Callable[[], object]) -> str:
    """Check that a call is refused without any change of the state; return its only message."""
    before = host.state()
    host.slave.messages.clear()
    with pytest.raises((CosimulationError, FMICallException)):
        call()
    [sentence] = host.slave.messages
    assert host.state() == before
    assert sentence.endswith(".")
    return sentence


# ---- numbers -----------------------------------------------------------------------------------------------------


def simulated(path: Path, version: int, vehicles: int) -> np.ndarray:
    """Simulate by FMPy: the locomotive pulls, with an emergency brake application from 1 s on.

    FMPy 0.3 does not accept discrete array inputs of FMI 3.0; the input of the only valve is a scalar.
    """
    two, pull = version == 2, [PULL, *[0.0] * (vehicles - 1)]
    if two:
        names = ["driver_position", *[f"pull[{number}]" for number in range(1, vehicles + 1)]]
        kinds = [("time", float), (names[0], np.int32), *[(name, float) for name in names[1:]]]
        rows = [(time, position, *pull) for time, position in ((0.0, 1), (1.0, 1), (1.0, 4), (4.0, 4))]
    else:
        kinds = [("time", float), ("driver_position", np.int32), ("pull", float, (vehicles,))]
        rows = [(time, position, pull) for time, position in ((0.0, 1), (1.0, 1), (1.0, 4), (4.0, 4))]
    how = {"stop_time": STEP * COUNT, "output_interval": STEP, "step_size": STEP}
    start = {"start_speed": SPEED}
    return np.asarray(simulate_fmu(str(path), start_values=start, input=np.array(rows, dtype=kinds), **how))


def reference_of(path: Path, name: str) -> int:
    """Return the value reference of a variable."""
    return next(v.valueReference for v in read_model_description(str(path)).modelVariables if v.name == name)


@pytest.mark.parametrize("name", ["short", "long"])
def test_both_versions_and_the_class_give_the_same_bits(name: str, fmus: dict[tuple[str, int], Path]) -> None:
    vehicles = len(CONSISTS[name].vehicles)
    two, three = (simulated(fmus[name, version], version, vehicles) for version in (2, 3))
    own = Train(CONSISTS[name], speed=SPEED)
    own.inputs["pull"][0] = PULL
    assert len(two) == len(three) == COUNT + 1
    for number in range(COUNT + 1):
        for output in OF_EACH:
            expected = getattr(own, output).tolist()
            assert three[output][number].tolist() == expected, (output, number)
            assert [two[f"{output}[{i}]"][number] for i in range(1, len(expected) + 1)] == expected
        assert two["largest_tension"][number] == three["largest_tension"][number] == own.largest_tension
        assert two["air_used"][number] == own.air_used
        own.drive("emergency" if number * STEP >= 1.0 else "running")
        own.advance(STEP)
    assert own.cylinder_pressure.min() > 100e3
    assert own.largest_tension > 1e3


@pytest.mark.parametrize("version", [2, 3])
def test_outputs_are_those_of_what_was_set_already_while_it_initialises(
    version: int, fmus: dict[tuple[str, int], Path]
) -> None:
    host, own = Host(fmus["short", version]), Train(SHORT, speed=SPEED, cylinder=200e3)
    with host.slave as slave:
        before: list[list[list[float]]] = []
        slave._call(
            slave._face.begin,
            0.0,
            lambda: slave.set(start_cylinder_pressure=200e3),
            lambda: (slave.set(start_speed=SPEED), before.append(host.outputs())),
        )
        assert before == [host.outputs()]
        assert before[0] == [getattr(own, name).tolist() for name in OF_EACH]
    assert own.brake_force.min() > 1e3
    assert not own.rail_force.any()


@pytest.mark.parametrize("version", [2, 3])
def test_wheels_that_lock_are_told(version: int, fmus: dict[tuple[str, int], Path]) -> None:
    host = started(fmus["short", version])
    with host.slave:
        host.put("friction", [0.3, 0.02, 0.3])
        host.put("driver_position", [4])
        host.go(80)
        assert host.array("locked") == [0, 1, 0]
        assert host.array("slip")[1] == 1.0
        assert max(host.array("slip")[::2]) < 0.1


@pytest.mark.parametrize("version", [2, 3])
def test_an_fmu_on_a_map_of_friction_is_the_train_on_it(version: int, tmp_path: Path) -> None:
    level = Line({"distance": np.array([-500.0, 500.0]), "gradient": np.zeros(2), "curvature": np.zeros(2)})
    leaves = level.with_friction([-40.0, 0.0, 80.0, 300.0], [1.0, 0.2, 0.05, 1.0])
    write_in_c(train_fmu(SHORT, line=leaves), tmp_path / "leaves.fmu", version)
    host, own = started(tmp_path / "leaves.fmu"), Train(SHORT, speed=SPEED, line=leaves)
    own.drive("emergency")
    with host.slave:
        host.put("driver_position", [4])
        for _ in range(COUNT):
            host.go()
            own.advance(STEP)
            assert host.outputs() == [getattr(own, name).tolist() for name in OF_EACH]
        assert own.wheel_speed[0] < 0.5 * own.speed[0]


def test_a_reset_train_runs_as_a_new_one(train: Host) -> None:
    train.put("coupling_closed", [0, 0])
    train.put("hose_state", [2, 1])
    train.go(4)
    train.count = 0
    train.slave.restart({"start_speed": SPEED})
    fresh = started(train.path)
    with fresh.slave:
        for _ in range(8):
            assert train.outputs() == fresh.outputs()
            train.go()
            fresh.go()


def test_where_a_step_leads_nowhere_what_was_asked_for_is_done_in_the_next() -> None:
    """A coupling opens and a hose parts in a step that fails. Both take effect in the next step."""
    one, other = Train(SHORT, speed=SPEED), Train(SHORT, speed=SPEED)
    for own in (one, other):
        own.drive("emergency")
        own.advance(1.0)
    before = one.state
    motion = one.motion
    one.motion = np.where(np.arange(4)[:, None] == 0, math.nan, motion)  # positions that lead to a failed step
    for own in (one, other):
        own.inputs["coupling_closed"][0], own.inputs["hose_state"][1] = 0, 2
    with pytest.raises(ValueError, match="no finite state"):
        one.advance(20.0)
    one.motion = motion
    assert one.brake_force.tolist() == other.brake_force.tolist()
    for own in (one, other):
        own.advance(1.0)
    assert np.array_equal(one.state, other.state, equal_nan=True)
    one.state = before
    assert np.array_equal(one.state, before, equal_nan=True)


def test_mean_forces_are_those_of_the_state_that_is_given_back() -> None:
    """Regression test: they were those of the discarded step."""
    one = Train(SHORT, speed=SPEED)
    one.drive("emergency")
    one.advance(4.0)
    state, mean = one.state, one.mean_coupler_force
    one.advance(3.0)
    assert not np.allclose(one.mean_coupler_force, mean)
    one.state = state
    assert one.mean_coupler_force.tolist() == mean.tolist()


# ---- one binary --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("version", [2, 3])
def test_archives_of_two_trains_differ_in_their_description_and_numbers_alone(
    version: int, fmus: dict[tuple[str, int], Path]
) -> None:
    contents = []
    for name in ("short", "long"):
        with zipfile.ZipFile(fmus[name, version]) as archive:
            contents.append({one: archive.read(one) for one in archive.namelist()})
    assert contents[0].keys() == contents[1].keys()
    differing = {one for one in contents[0] if contents[0][one] != contents[1][one]}
    pages = {
        "documentation/index.html",
        *(f"documentation/host.{one}" for one in {2: ("c", "cpp"), 3: ("c",)}[version]),
    }
    assert differing == pages | {"modelDescription.xml", "resources/identity.csv", "resources/train.bin"}


@pytest.mark.study
@pytest.mark.parametrize("name", CONSISTS)
@pytest.mark.parametrize("version", [2, 3])
def test_it_is_valid_and_arrays_have_the_lengths_of_the_consist(
    name: str, version: int, fmus: dict[tuple[str, int], Path]
) -> None:
    path, vehicles = fmus[name, version], len(CONSISTS[name].vehicles)
    assert validate_fmu(str(path)) == []
    about = read_model_description(str(path))
    for array, length in {"pull": vehicles, "speed": vehicles, "coupling_closed": vehicles - 1, "end_force": 2}.items():
        if version == 3:
            [one] = [v for v in about.modelVariables if v.name == array]
            assert one.shape == (length,)
        else:
            assert sum(v.name.startswith(f"{array}[") for v in about.modelVariables) == length


def test_a_locomotive_alone_is_a_train(tmp_path: Path) -> None:
    for version in (2, 3):
        path = tmp_path / f"alone{version}.fmu"
        write_in_c(train_fmu(Consist(SHORT.vehicles[:1])), path, version)
        assert validate_fmu(str(path)) == []
        with FmuInstance(path, start_speed=SPEED) as slave:
            slave.start()
            slave.step(0.0, 1.0)
            assert slave["largest_tension"] == 0.0


@pytest.mark.study
@pytest.mark.parametrize("version", [2, 3])
def test_the_sources_that_are_listed_compile(version: int, fmus: dict[tuple[str, int], Path], tmp_path: Path) -> None:
    with zipfile.ZipFile(fmus["short", version]) as archive:
        archive.extractall(tmp_path)
    place = "modelDescription.xml" if version == 2 else "sources/buildDescription.xml"
    kind = "File" if version == 2 else "SourceFile"
    listed = [str(one.get("name")) for one in ET.parse(tmp_path / place).iter(kind)]
    assert sorted(listed) == sorted(one.name for one in (tmp_path / "sources").glob("*.c"))
    command = [*compiler(), "-std=c11", "-fsyntax-only", "-Wall", "-Wextra", "-Werror", *listed]
    done = subprocess.run(command, cwd=tmp_path / "sources", capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


# ---- states ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("cells", [1.0, 6.0])
def test_a_state_goes_on_with_the_same_bits_whatever_its_train_did_before(cells: float) -> None:
    """Air steps depend on wave speeds at valves and in the step before. Steps have any length and begin at any time."""
    given, draw = Settings(cells=cells), np.random.default_rng(5)
    one, fresh, used = (Train(SHORT, speed=SPEED, settings=given) for _ in range(3))
    one.drive("emergency")
    for number in range(12):
        one.advance(0.01 * number)
        fresh = Train(SHORT, settings=given)
        state = one.state
        for other in (fresh, used):
            other.state = state
        for step in (0.05 + 0.01 * number, *draw.choice([1e-3, 2e-3, 4e-3, 0.012, 0.1], 8)):
            for own in (one, fresh, used):
                own.advance(step)
            assert np.array_equal(one.state, fresh.state, equal_nan=True)
            assert np.array_equal(one.state, used.state, equal_nan=True)
        used.drive("running")
        used.advance(3.0)


def test_a_saved_state_goes_on_with_the_same_bits_here_and_as_bytes_in_another_instance(train: Host) -> None:
    """The other instance is not initialised."""
    saved, count, state, other = train.slave.save(), train.count, train.state(), Host(train.path)
    train.go(6)
    train.slave.restore(saved)
    train.slave.forget(saved)
    train.count = count
    with other.slave:
        other.take(state)
        assert other.state() == state == train.state()
        other.count = count
        for _ in range(6):
            assert other.outputs() == train.outputs()
            other.go()
            train.go()
        assert other.state() == train.state()


@pytest.mark.parametrize("name", ["long", "light"])
def test_a_state_of_another_consist_is_refused(name: str, train: Host, fmus: dict[tuple[str, int], Path]) -> None:
    """A consist of the same length is another consist, too."""
    other = started(fmus[name, 2 if train.two else 3])
    with other.slave:
        state, saved = other.state(), other.slave.save()
        words = "A saved state must be of this FMU with the same resources; got another one."
        assert refused(train, lambda: train.take(state)) == words
        assert refused(train, lambda: train.slave.restore(saved)) == words
        other.slave.forget(saved)


# ---- what is refused ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "values", "words"),
    [
        ("speed", [1.0, 1.0, 1.0], "speed is an output and cannot be set; read it instead."),
        ("driver_position", [7], "driver_position must be from 0 to 6; got 7."),
        ("friction", [0.3, -1.0, 0.3], "friction[2] must be from 0 to 2; got -1."),
        ("friction", [0.3, 0.3, math.nan], "friction[3] must be from 0 to 2; got nan."),
        ("pull", [1e300, 0.0, 0.0], "pull[1] must be from -1e+07 to 1e+07 N; got 1e+300."),
        ("hose_state", [3, 0], "hose_state[1] must be from 0 to 2; got 3."),
    ],
)
def test_what_cannot_be_set_is_refused_and_nothing_changes(
    name: str, values: list[float], words: str, train: Host
) -> None:
    sentence = refused(train, lambda: train.put(name, values))
    assert sentence.replace("-nan", "nan") == words


@pytest.mark.parametrize("count", [0, 2, 4])
def test_sizes_that_do_not_fit_are_refused(count: int, fmus: dict[tuple[str, int], Path]) -> None:
    host = started(fmus["short", 3])
    with host.slave:
        reference, fmu = host.slave._reference("pull")[0], host.slave.fmu
        words = f"The call must have 3 values, all elements of each variable; got {count}."
        assert refused(host, lambda: fmu.setFloat64([reference], [0.0] * count)) == words
        assert refused(host, lambda: fmu.getFloat64([reference], count)) == words


@pytest.mark.parametrize("version", [2, 3])
def test_a_start_beyond_what_time_can_count_is_refused(version: int, fmus: dict[tuple[str, int], Path]) -> None:
    """Doubles are too coarse there for hundredths of a second."""
    host = Host(fmus["short", version])
    with (
        host.slave,
        pytest.raises(CosimulationError, match="The start time must be from -1e\\+10 to 1e\\+10 s; got 1e\\+15 s"),
    ):
        host.slave.start(1e15)


# ---- consists that are damaged -----------------------------------------------------------------------------------

CELLS = 6
#: Numbers of elements of each group in the short train.
COUNTS = {"one": 1, "cells": CELLS, "vehicles": 3, "couplings": 2, "valves": 1, "points": 1} | {
    f"distributor_{name}": 3 * (name == "uic") for name in DISTRIBUTORS
}


def place_of(group: str, name: str, counts: Mapping[str, int] = COUNTS) -> int:
    """Return the index of a field's first number in train.bin."""
    place = 0
    for own in layout():
        for one in own.fields:
            if (own.name, one.name) == (group, name):
                return place
            place += counts[own.of]
    raise KeyError(name)


def number_at(group: str, name: str, value: float) -> Callable[[Path], None]:
    """Return a change of this number."""

    def change(path: Path) -> None:
        numbers = np.fromfile(path, "<f8")
        numbers[place_of(group, name)] = value
        numbers.tofile(path)

    return change


DAMAGES: dict[str, tuple[Callable[[Path], None], str]] = {
    "missing": (lambda path: path.unlink(), "resources/train.bin is missing."),
    "empty": (lambda path: path.write_bytes(b""), "train.bin cannot be read; build the FMU again."),
    "odd": (lambda path: path.write_bytes(path.read_bytes()[:-3]), "train.bin cannot be read; build the FMU again."),
    "truncated": (lambda path: path.write_bytes(path.read_bytes()[:-8]), "is damaged, its length cannot be"),
    "head alone": (lambda path: path.write_bytes(path.read_bytes()[:88]), "is damaged, its length cannot be"),
    "half a head": (lambda path: path.write_bytes(path.read_bytes()[:40]), "is damaged, its length cannot be"),
    "random": (
        lambda path: path.write_bytes(np.random.default_rng(3).bytes(8000)),
        "is damaged, its number of vehicles",
    ),
}
#: Invalid values of fields. `test_each_field_is_held_to_its_limits` tests every field of every group.
BEYOND = {
    ("head", "cells", math.nan): "its number of cells",
    ("head", "vehicles", 2.5): "its number of vehicles",
    ("head", "valves", 0.0): "its number of valves",
    ("head", "brake_model", 3.0): "the model of its brake",
    ("cell", "length", -7.0): "the length of a cell",
    ("place", "cell", CELLS): "a vehicle's place at the pipe",
    ("place", "face", CELLS + 1): "a vehicle's end at the pipe",
    ("motion", "mass", math.nan): "the mass of a vehicle",
    ("valve", "face", CELLS + 1): "a driver's valve's place at the pipe",
    ("valve", "face", -1.0): "a driver's valve's place at the pipe",
}
DAMAGES |= {
    " ".join(map(str, change)): (number_at(*change), f"is damaged, {text} cannot be") for change, text in BEYOND.items()
}


@pytest.mark.study
@pytest.mark.parametrize("kind", DISTRIBUTORS)
def test_each_field_is_held_to_its_limits_and_to_whole_numbers(kind: str) -> None:
    """The limits themselves are valid. The message names the field. Distances of a line must increase."""
    of_kind = DISTRIBUTORS[kind].ready("P")
    valve = vacuum_valve(of_kind.vacuum) if isinstance(of_kind, VacuumBrake) else SHORT.vehicles[0].valve
    head, *others = (replace(one, distributor=of_kind) for one in SHORT.vehicles)
    consist = Consist((replace(head, valve=valve), *others))
    counts = COUNTS | {f"distributor_{name}": 3 * (name == kind) for name in DISTRIBUTORS}
    numbers, wrong = numbers_of(consist, Settings(), None), functions().train_wrong
    assert wrong(numbers.ctypes.data, numbers.size) is None

    def said_of(group: str, name: str, value: float) -> str:
        changed = numbers.copy()
        changed[place_of(group, name, counts)] = value
        return (wrong(changed.ctypes.data, changed.size) or b"").decode()

    for group in (own for own in layout() if counts[own.of]):
        for one in group.fields:
            most = one.most + (COUNTS[one.counts] if one.counts else 0)
            below, above = (
                (one.least - 1, most + 1)
                if one.whole
                else (np.nextafter(one.least, -math.inf), np.nextafter(most, math.inf))
            )
            for value in (math.nan, below, above, *[0.5] * one.whole):
                assert said_of(group.name, one.name, value) == one.text, (group.name, one.name, value)
            for value in (one.least, most):
                assert said_of(group.name, one.name, value) != one.text, (group.name, one.name, value)
    line = Line({"distance": np.array([0.0, 1.0])})
    level = numbers_of(SHORT, Settings(), line)
    assert wrong(level.ctypes.data, level.size) is None
    level[place_of("point", "distance") + 1] = 0.0
    assert wrong(level.ctypes.data, level.size) == b"a distance of the line"


@pytest.mark.parametrize("damage", DAMAGES)
@pytest.mark.parametrize("version", [2, 3])
def test_a_damaged_consist_gives_no_instance_and_one_sentence(
    damage: str, version: int, fmus: dict[tuple[str, int], Path], tmp_path: Path
) -> None:
    change, words = DAMAGES[damage]
    path, said = fmus["short", version], list[str]()
    with zipfile.ZipFile(path) as archive:
        archive.extractall(tmp_path)
    change(tmp_path / "resources" / "train.bin")
    if damage != "missing":
        sign(tmp_path / "resources", "train.bin")
    face = face_of(read_model_description(str(path)), str(tmp_path), "train", said.append)
    with pytest.raises(Exception, match="Failed to instantiate"):
        face.instantiate()
    [sentence] = said
    assert words in sentence
    assert sentence.endswith("build the FMU again." if damage != "missing" else "build it with the new file.")


# ---- sanitizers --------------------------------------------------------------------------------------------------


def write_numbers(consist: Consist, settings: Settings, folder: Path) -> Path:
    """Write train.bin to a new folder."""
    folder.mkdir()
    np.asarray(numbers_of(consist, settings, None), "<f8").tofile(folder / "train.bin")
    return folder


@pytest.fixture(scope="module")
def programs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Return C programs that are linked with the C code of trains, under sanitizers."""
    sources = {name: Path(__file__).with_name(f"{name}.c") for name in ("numbers_host", "pipe_host")}
    return {name: OBJECTS["train"].linked(path, tmp_path_factory.mktemp(name)) for name, path in sources.items()}


@pytest.mark.study
def test_the_pipe_in_c_reads_and_writes_nothing_but_its_own(programs: dict, tmp_path: Path) -> None:
    """The numbers of cells are not multiples of the number of lanes."""
    done = run([programs["pipe_host"]], tmp_path)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.study
def test_numbers_that_are_no_train_s_make_none_or_one_that_runs(programs: dict, tmp_path: Path) -> None:
    own = {"direct_pressure": 3.8, "main_reservoir": 800, "vigilance_time": 1, "protection": "built-in"}
    consist = consist_of([{"kind": "locomotive"} | own, {"kind": "wagon"}])
    one = write_numbers(consist, Settings(cells=1.0), tmp_path / "one")
    (tmp_path / "other").mkdir()
    done = run([programs["numbers_host"], one, tmp_path / "other", "3", "1500"], tmp_path)
    assert (done.returncode, done.stderr) == (0, ""), done.stdout
    assert int(done.stdout.split()[0]) > 150


@pytest.mark.parametrize("name", ["gcc", "clang"])
def test_the_c_is_clean_for_more_than_one_compiler(name: str, tmp_path: Path) -> None:
    if not shutil.which(name):
        pytest.skip(f"there is no {name}")
    for file, text in all_sources(train_in_c()).items():
        (tmp_path / file).write_text(text)
    files = [*sorted(tmp_path.glob("*.c")), Path(__file__).with_name("numbers_host.c")]
    done = run([name, *FLAGS, "-fsyntax-only", f"-I{tmp_path}", *HEADERS, *files], tmp_path)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.study
def test_the_c_is_clean_for_clang_and_for_windows_as_zig_has_them() -> None:
    """Compiled but not linked: to link, zig first compiles the C library of Windows, which takes minutes."""
    pytest.importorskip("ziglang")
    flags = [flag for flag in FLAGS if flag != "-fPIC"]
    assert all(one.stat().st_size > 0 for one in objects_of(all_sources(train_in_c()), flags, "x86_64-windows-gnu"))


def test_a_cock_that_a_coarse_pipe_does_not_have_is_told(tmp_path: Path) -> None:
    path = tmp_path / "coarse.fmu"
    write_in_c(train_fmu(CONSISTS["long"], settings=Settings(cells=0.5)), path, 3)
    host = started(path)
    with host.slave:
        joined = [0.0] * (len(CONSISTS["long"].vehicles) - 1)
        host.put("hose_state", [1, *joined[1:]])
        with pytest.raises(CosimulationError, match=r"hose_state\[1\] must be possible at its place; got 1"):
            host.go(1)
        host.put("hose_state", joined)
        host.go(1)


@pytest.mark.parametrize("version", [2, 3])
def test_locked_wheels_are_logged_and_the_same_in_python(version: int, fmus: dict[tuple[str, int], Path]) -> None:
    train, host = Train(SHORT, speed=SPEED), started(fmus["short", version])
    train.inputs["friction"] = 0.02
    train.drive("emergency")
    with host.slave:
        host.put("driver_position", [4])
        host.put("friction", [0.02] * 3)
        host.go(80)
        train.advance(80 * STEP)
        assert host.array("locked") == train.locked.tolist() == [1, 1, 1]
        assert host.array("slip") == train.slip.tolist() == [1.0, 1.0, 1.0]
        assert any(re.match(r"The wheels of vehicle \d.* locked at \d", one) for one in host.slave.messages)


@pytest.mark.parametrize(("closed", "what"), [(1, "coupler of vehicle 1 broke"), (0, "hose of vehicle 1 parted")])
def test_a_broken_coupler_and_a_torn_hose_are_logged_once(closed: int, what: str, tmp_path: Path) -> None:
    rows = [{"kind": "locomotive", "coupler_strength": 200.0}, {"kind": "wagon", "count": 2}]
    path = tmp_path / "breaks.fmu"
    write_in_c(train_fmu(consist_of(rows)), path, 3)
    host = started(path)
    with host.slave:
        host.put("pull", [400e3, -200e3, -200e3])
        host.put("friction", [2.0] * 3)
        host.put("coupling_closed", [closed, 1])
        host.go(40)
        told = [one for one in host.slave.messages if "rear" in one]
    assert len(told) == 1
    assert re.match(rf"The rear {what} at 0\.\d+ s\.", told[0])

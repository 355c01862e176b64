"""Edge cases of both interfaces: the ends of a run, calls against the standards, and the messages to hosts."""

from __future__ import annotations

import ast
import math
import shutil
import sys
import zipfile
from ctypes import byref, c_char_p, c_double, c_int
from pathlib import Path

import pytest
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import (
    FMU2Slave,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
)
from fmpy.fmi3 import FMU3Slave, fmi3LogMessageCallback

from fmu_src.compliance import CHECKS
from fmu_src.cosimulation.slave import CosimulationError, FmuInstance
from tests.fmu_src.fmi.hosting import DISCARD, ERROR, OK, STEP, WARNING, host

sys.path.insert(0, str(Path(__file__).parent))
from sled import END, LENGTH, MASS, SPEED, STOPPING, build_sled

NATIVE = ["native", "fmi3"]
KINDS = [*NATIVE, "python"]
#: 2023-11-14; doubles are 2.4e-7 s apart there.
UNIX = 1.7e9
#: Relative tolerance of the motion: that of the integration.
TOLERANCE = 1e-6


@pytest.fixture(scope="module")
def sleds(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    return build_sled(tmp_path_factory.mktemp("sleds"))


# ---- the times of a run ------------------------------------------------------------------------------------------


@pytest.mark.study
@pytest.mark.parametrize("kind", NATIVE)
@pytest.mark.parametrize("start", [0.0, UNIX])
def test_no_step_goes_past_the_stop_time(sleds: dict, kind: str, start: float) -> None:
    """The last step may miss the stop time by rounding errors. A miss of 1 % of a step is refused without effect."""
    with host(sleds[kind]) as sled:
        sled.start(start, start + 10 * STEP)
        for number in range(9):
            assert sled.step(start + number * STEP) == OK
        before, last = sled.state(), start + 9 * STEP
        assert sled.step(last, 1.01 * STEP) == ERROR
        assert sled.state() == before
        assert "The step must end at most at the stop time of" in sled.said[-1]
        assert sled.step(last) == OK
        assert sled.step(start + 10 * STEP) == ERROR


@pytest.mark.study
@pytest.mark.parametrize("kind", NATIVE)
@pytest.mark.parametrize("start", [0.0, 3.0, UNIX])
@pytest.mark.parametrize("size", [0.1, STEP, 1e-5])
def test_round_off_of_the_time_stops_no_run(sleds: dict, kind: str, start: float, size: float) -> None:
    """Times may be products (start + n size) or sums, and the stop time may be summed in another way."""
    count = 60
    for added in (True, False):
        with host(sleds[kind]) as sled:
            sled.start(start, start + sum([size] * count), brake=STOPPING)
            time = start
            for number in range(count):
                assert sled.step(time if added else start + number * size, size) == OK, (sled.said, number)
                time += size


@pytest.mark.study
@pytest.mark.parametrize("kind", NATIVE)
@pytest.mark.parametrize("stop", [0.999, -1.0, math.nan, -math.inf])
def test_stop_before_the_start_is_refused(sleds: dict, kind: str, stop: float) -> None:
    with host(sleds[kind]) as sled:
        assert sled.experiment(1.0, stop) == ERROR
        assert sled.said[-1].startswith("The stop time must be at least the start time of 1 s; got")
        sled.start(1.0, 2.0)
        assert sled.step(1.0, 1.0) == OK


def test_reset_forgets_the_experiment(sleds: dict) -> None:
    for kind in NATIVE:
        with host(sleds[kind]) as sled:
            sled.start(5.0, 6.0)
            assert sled.step(5.0, 1.0) == OK
            sled.fmu.reset()
            if sled.three:
                assert sled["time"] == 0.0
            sled.start(0.0)
            assert sled.step(0.0, 1.2) == OK
            assert sled["distance"] == pytest.approx(1.2 * SPEED, rel=TOLERANCE)


@pytest.mark.parametrize("kind", NATIVE)
@pytest.mark.parametrize("point", [math.inf, -math.inf, math.nan])
def test_communication_point_that_is_no_time_is_refused(sleds: dict, kind: str, point: float) -> None:
    with host(sleds[kind]) as sled:
        sled.start(push=1.0)
        assert sled.step(0.0) == OK
        before = sled.state()
        assert sled.step(point) == ERROR
        assert sled.state() == before
        assert sled.step(STEP) == OK


@pytest.mark.parametrize("kind", NATIVE)
@pytest.mark.parametrize("start", [0.0, UNIX])
@pytest.mark.parametrize("size", [STEP, 1e-5])
def test_repeated_communication_point_is_refused(sleds: dict, kind: str, start: float, size: float) -> None:
    with host(sleds[kind]) as sled:
        sled.start(start)
        assert sled.step(start, size) == OK
        before = sled.state()
        assert sled.step(start, size) == ERROR
        assert sled.state() == before
        if start == UNIX and size == STEP:
            assert sled.said[-1].startswith(
                "The step must begin at t = 1700000000.001 s, where the last step ended; got 1700000000 s"
            )


@pytest.mark.parametrize("kind", NATIVE)
def test_step_that_the_time_cannot_show_is_refused(sleds: dict, kind: str) -> None:
    with host(sleds[kind]) as sled:
        sled.start(UNIX)
        assert sled.step(UNIX, 1e-8) == ERROR
        assert "The step must be above the round-off of the time t = 1700000000 s; got 1e-08 s." in sled.said[-1]
        assert sled["distance"] == 0.0


def test_motion_and_sentences_are_the_same_at_unix_time(sleds: dict) -> None:
    """Steps of a power of two are exact at both starts; the sled stops after 1 s."""
    found = []
    for start in (0.0, UNIX):
        with host(sleds["native"]) as sled:
            sled.start(start, brake=STOPPING)
            for number in range(300):
                assert sled.step(start + number / 256, 1 / 256) == OK
            found.append([sled["distance"], sled["speed"]])
            assert sled.said == [f"Sled stopped at {'1' if start == 0.0 else '1700000001'} s."]
    assert found[1] == pytest.approx(found[0], rel=TOLERANCE, abs=0.0)
    assert found[0][0] == pytest.approx(MASS * SPEED**2 / (2 * STOPPING), rel=TOLERANCE)


# ---- steps within which the run ends --------------------------------------------------------------------------------


def test_fmi3_declares_that_it_may_return_early(sleds: dict) -> None:
    assert read_model_description(str(sleds["fmi3"])).coSimulation.mightReturnEarlyFromDoStep


def test_fmi3_discards_a_step_within_which_the_run_ends(sleds: dict) -> None:
    """Early return is not allowed. The state is the one before the step; shorter steps still succeed."""
    with host(sleds["fmi3"]) as sled:
        sled.start(0.0)
        assert sled.step(0.0, 1.0) == OK
        before, heard = sled.state(), len(sled.said)
        for _ in range(2):
            assert sled.step(1.0, 1.0) == DISCARD
            assert sled.state() == before
            assert sled["time"] == 1.0
            assert sled["distance"] == pytest.approx(SPEED, rel=TOLERANCE)
        first, second = sled.said[heard : heard + 2]
        assert first == f"The sled left the track at {END:g} s."
        assert second.startswith("The step from t = 1 s was discarded")
        assert f"take steps that end before {END:g} s" in second
        assert sled.fmu.doStep(1.0, 0.4) == (False, False, False, 1.4)
        assert sled.step(1.4, 0.2) == DISCARD
        assert sled.raw("Terminate") == OK


def test_discarded_step_tells_nothing_that_did_not_happen(sleds: dict) -> None:
    """The sled stops, moves again and leaves the track, all in one step. A discarded step reports only the end of the
    run.
    """
    with host(sleds["fmi3"]) as sled:
        sled.start(0.0, brake=STOPPING, push_growth=6.0)
        assert sled.step(0.0, 10.0) == DISCARD
        assert [line.split(" at ")[0] for line in sled.said[:1]] == ["The sled left the track"]
        assert len(sled.said) == 2
        assert sled.step(0.0, 4.0) == OK
        assert [line.split(" at ")[0] for line in sled.said[2:]] == ["Sled stopped", "Sled moved again"]


def test_fmi3_returns_early_with_ok_where_it_may(sleds: dict) -> None:
    with host(sleds["fmi3"], early=True) as sled:
        sled.start(0.0)
        _, ended, early, time = sled.fmu.doStep(0.0, 5.0)
        assert ended
        assert early
        assert time == pytest.approx(END, rel=TOLERANCE)
        assert sled["distance"] == pytest.approx(LENGTH, rel=TOLERANCE)
        before = sled.state()
        assert sled.step(time, 0.1) == ERROR  # not Discard: shorter steps would fail, too
        assert sled.state() == before
        assert "The run has ended" in sled.said[-1]
        assert sled.raw("Terminate") == OK


def test_fmi2_discards_with_the_time_that_was_reached(sleds: dict) -> None:
    """FMI 2.0: the step was computed in part, and the state is that at the time reached."""
    with host(sleds["native"]) as sled:
        sled.start(0.0)
        assert sled.step(0.0, 5.0) == DISCARD
        assert sled.fmu.getBooleanStatus(3)
        assert sled.fmu.getRealStatus(2) == pytest.approx(END, rel=TOLERANCE)
        assert sled["distance"] == pytest.approx(LENGTH, rel=TOLERANCE)
        assert sled.raw("Terminate") == OK


@pytest.mark.parametrize("kind", ["native", "fmi3"])
def test_fmpy_takes_the_run_to_its_end(sleds: dict, kind: str) -> None:
    """In both standards the last row is the end of the track."""
    named = {"early_return_allowed": True} if kind == "fmi3" else {}
    table = simulate_fmu(str(sleds[kind]), stop_time=5.0, output_interval=0.4, **named)
    assert table["time"][-1] == pytest.approx(END, rel=TOLERANCE)
    assert table["distance"][-1] == pytest.approx(LENGTH, rel=TOLERANCE)


# ---- what is said -------------------------------------------------------------------------------------------------


def test_fmi3_says_nothing_when_logging_is_off(sleds: dict) -> None:
    """FMI 3.0, section 2.3.1: the callback is not called, not even for errors."""
    with host(sleds["fmi3"], logging=False) as sled:
        assert sled.experiment(0.0, None, 2.0) == WARNING
        sled.raw("ExitInitializationMode")
        assert sled.set("brake", -1.0) == ERROR
        assert sled.step(0.0, 5.0) == DISCARD
        assert sled.said == []


def test_fmi2_tells_errors_and_warnings_always_and_the_rest_on_demand(sleds: dict) -> None:
    """FMI 2.0, section 2.1.3: a Discard is logged only if logging is on."""
    with host(sleds["native"], logging=False) as sled:
        assert sled.experiment(0.0, None, 2.0) == WARNING
        sled.raw("EnterInitializationMode")
        sled.raw("ExitInitializationMode")
        assert sled.set("brake", -1.0) == ERROR
        assert [line.split(";")[0] for line in sled.said] == [
            "The tolerance must be from 1e-12 to 0.01",
            "brake must be at least 0 N",
        ]
        assert sled.step(0.0, 5.0) == DISCARD
        assert len(sled.said) == 2


@pytest.mark.parametrize("kind", NATIVE)
def test_named_categories_are_the_only_ones(sleds: dict, kind: str) -> None:
    """Logging of one category switches the others off. An unknown name is refused and changes nothing."""
    with host(sleds[kind]) as sled:
        names = ["logStatusDiscard", "nonsense"]
        assert sled.status(sled.fmu.setDebugLogging, True, names) == ERROR
        assert sled.status(sled.fmu.setDebugLogging, True, names[:1]) == OK
        sled.said.clear()
        sled.start(0.0, brake=STOPPING)
        assert sled.step(0.0, 2.0) == OK  # the stop is an event
        assert sled.said == []


@pytest.mark.study
@pytest.mark.parametrize("kind", NATIVE)
@pytest.mark.parametrize("tolerance", [0.0, -1.0, 1.5, math.nan, math.inf])
def test_tolerance_that_does_not_serve_is_warned_of(sleds: dict, kind: str, tolerance: float) -> None:
    with host(sleds[kind]) as sled:
        assert sled.experiment(0.0, 3.0, tolerance) == WARNING
        assert sled.said == [f"The tolerance must be from 1e-12 to 0.01; got {tolerance:g}. 1e-06 stays in force."]
        assert sled["tolerance"] == 1e-6
        if not sled.three:
            assert sled.raw("EnterInitializationMode") == OK
        assert sled.raw("ExitInitializationMode") == OK
        assert sled.step(0.0, 3.0 * 1.1) == ERROR  # the rest of the experiment is in force


@pytest.mark.parametrize("kind", NATIVE)
def test_tolerance_that_serves_is_taken(sleds: dict, kind: str) -> None:
    with host(sleds[kind]) as sled:
        assert sled.experiment(0.0, None, 1e-4) == OK
        assert sled["tolerance"] == 1e-4


def test_event_mode_tells_of_what_a_step_has_found(sleds: dict) -> None:
    """The sled stops and moves again: two events. The motion equals that of one step without event mode."""
    assert read_model_description(str(sleds["fmi3"])).coSimulation.hasEventMode
    pushed = {"brake": STOPPING, "push_growth": 6.0}
    with host(sleds["fmi3"], early=True, events=True) as sled, host(sleds["fmi3"]) as whole:
        sled.start(0.0, **pushed)
        assert sled.step(0.0, 4.0) == ERROR  # an instance begins in event mode
        time, at = 0.0, []
        while time < 4.0:
            assert sled.fmu.updateDiscreteStates()[:5] == (False,) * 5
            assert sled.raw("EnterStepMode") == OK
            events, ended, early, time = sled.fmu.doStep(time, 4.0 - time)
            assert events == early == (time < 4.0)
            assert not ended
            if events:
                at.append(time)
                assert sled.raw("EnterEventMode") == OK
        whole.start(0.0, **pushed)
        assert whole.step(0.0, 4.0) == OK
        assert [line.split(" at ")[0] for line in sled.said if " at " in line] == ["Sled stopped", "Sled moved again"]
        assert len(at) == 2
        for name in ("speed", "distance"):
            assert sled[name] == pytest.approx(whole[name], rel=TOLERANCE)


def test_modes_that_were_not_asked_for_are_refused(sleds: dict) -> None:
    with host(sleds["fmi3"], events=True) as sled:
        sled.start(0.0)
        assert sled.raw("EnterContinuousTimeMode") == ERROR
        assert sled.raw("EnterStepMode") == OK
        assert sled.raw("EnterStepMode") == ERROR
        assert sled.step(0.0) == OK
    with host(sleds["fmi3"]) as sled:
        sled.start(0.0)
        assert sled.raw("EnterEventMode") == ERROR
        assert sled.said[-1] == "Event mode was not asked for; instantiate with eventModeUsed = true."
        assert sled.step(0.0) == OK


# ---- the order of calls, and arrays -------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", NATIVE)
def test_outputs_have_no_values_before_the_initialisation(sleds: dict, kind: str) -> None:
    with host(sleds[kind]) as sled:
        for name in ("speed", "state_speed"):
            with pytest.raises(FMICallException):
                sled[name]
            assert "from the initialisation on" in sled.said[-1]
        assert sled["mass"] == MASS
        sled.start()
        assert sled["speed"] == SPEED


@pytest.mark.parametrize("kind", NATIVE)
def test_fixed_parameter_is_refused_in_step_mode(sleds: dict, kind: str) -> None:
    with host(sleds[kind]) as sled:
        sled.start()
        assert sled.set("mass", 5.0) == ERROR
        assert "mass is a parameter and fixed once the run has begun" in sled.said[-1]
        assert sled["mass"] == MASS
        assert sled.set("push", 5.0) == OK
        together = [sled.refs["push"], sled.refs["mass"]]
        assert sled.status(sled.fmu.setFloat64 if sled.three else sled.fmu.setReal, together, [7.0, 7.0]) == ERROR
        assert sled["push"] == 5.0


@pytest.mark.parametrize("kind", NATIVE)
def test_calls_out_of_order_are_refused_and_change_nothing(sleds: dict, kind: str) -> None:
    with host(sleds[kind]) as sled:
        for call in (lambda: sled.step(0.0), lambda: sled.raw("ExitInitializationMode"), lambda: sled.raw("Terminate")):
            assert call() == ERROR
        sled.start()
        before = sled.state()
        assert sled.experiment() == ERROR
        assert sled.raw("ExitInitializationMode") == ERROR
        if not sled.three:
            assert sled.raw("EnterInitializationMode") == ERROR
        assert sled.state() == before
        assert all("must not be called now" in line for line in sled.said)
        assert sled.raw("Terminate") == OK
        assert sled.step(0.0) == ERROR
        assert sled.set("push", 1.0) == ERROR
        assert sled["speed"] == SPEED  # the last values can still be read


@pytest.mark.parametrize("kind", NATIVE)
def test_no_references_need_no_arrays_and_references_do(sleds: dict, kind: str) -> None:
    with host(sleds[kind]) as sled:
        sled.start()
        types = ("Float64", "Int32", "Boolean") if sled.three else ("Real", "Integer", "Boolean")
        for access in ("Get", "Set"):
            for name in types:
                count = (0,) if sled.three else ()
                assert sled.raw(access + name, None, 0, None, *count) == OK
                count = (1,) if sled.three else ()
                assert sled.raw(access + name, None, 1, None, *count) == ERROR
        state = "FMUState" if sled.three else "FMUstate"
        assert sled.raw(f"Get{state}", None) == ERROR
        assert "null pointer" in sled.said[-1]


def test_types_that_no_variable_has_can_be_asked_for_none(sleds: dict) -> None:
    with host(sleds["fmi3"]) as sled:
        sled.start()
        assert sled.raw("GetBinary", None, 0, None, None, 0) == OK
        assert sled.raw("SetBinary", None, 0, None, None, 0) == OK
        assert sled.raw("GetClock", None, 0, None) == OK
        assert sled.raw("SetClock", None, 0, None) == OK
        assert sled.raw("GetString", None, 0, None, 0) == OK
        with pytest.raises(FMICallException):
            sled.fmu.getClock([0])
        assert sled.said == ["fmi3GetClock is not offered; see modelDescription.xml."]


def test_fmi2_answers_questions_about_steps_once_there_may_be_some(sleds: dict) -> None:
    """Steps are never pending: none can be cancelled, and a status of pending steps is discarded."""
    with host(sleds["native"]) as sled:
        time, status, truth = c_double(), c_int(), c_int()
        assert sled.raw("GetRealStatus", 2, byref(time)) == ERROR
        assert sled.raw("GetIntegerStatus", 0, byref(status)) == ERROR
        sled.start(2.0)
        assert sled.raw("GetRealStatus", 2, byref(time)) == OK
        assert time.value == 2.0
        assert sled.step(2.0) == OK
        assert sled.raw("GetStatus", 0, byref(status)) == OK
        assert status.value == OK
        assert sled.raw("GetBooleanStatus", 3, byref(truth)) == OK
        assert not truth.value
        assert sled.raw("GetRealStatus", 2, None) == ERROR
        for kind, of in (("", c_int), ("Real", c_double), ("Integer", c_int), ("Boolean", c_int), ("String", c_char_p)):
            assert sled.raw(f"Get{kind}Status", 1, byref(of())) == DISCARD
        before = sled.state()
        assert sled.raw("CancelStep") == ERROR
        assert "nothing to cancel" in sled.said[-1]
        assert sled.state() == before


def test_instance_without_a_name_is_refused_with_a_sentence(sleds: dict) -> None:
    for kind in NATIVE:
        about, said = read_model_description(str(sleds[kind])), []
        folder = extract(str(sleds[kind]))
        made = (FMU3Slave if kind == "fmi3" else FMU2Slave)(
            guid=about.guid, unzipDirectory=folder, modelIdentifier="Sled", instanceName="sled"
        )
        if kind == "fmi3":
            listener = fmi3LogMessageCallback(lambda *given: said.append(given[3].decode()))  # noqa: B023
            arguments = (None, about.guid.encode(), None, False, True, False, False, None, 0, None, listener)
            from fmpy.fmi3 import fmi3IntermediateUpdateCallback

            assert not made.fmi3InstantiateCoSimulation(*arguments, fmi3IntermediateUpdateCallback())
        else:
            listener = fmi2CallbackLoggerTYPE(lambda *given: said.append(given[4].decode()))  # noqa: B023
            calls = fmi2CallbackFunctions()
            calls.logger = listener
            assert not made.fmi2Instantiate(None, 1, about.guid.encode(), None, byref(calls), 0, 0)
        assert said == ["The instance must have a name; got none."]
        shutil.rmtree(folder)


# ---- modelDescription.xml -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", KINDS)
def test_default_experiment_is_complete(sleds: dict, kind: str) -> None:
    default = read_model_description(str(sleds[kind])).defaultExperiment
    found = [float(text) for text in (default.startTime, default.stopTime, default.stepSize, default.tolerance)]
    assert found == [0.0, 10.0, 1e-3, 1e-6]


@pytest.mark.parametrize("kind", KINDS)
def test_initial_unknowns_have_the_dependencies_of_the_start(sleds: dict, kind: str) -> None:
    """Start values, the equation of the load, and the brake, which holds a sled at rest."""
    about = read_model_description(str(sleds[kind]))
    found = {u.variable.name: {d.name for d in u.dependencies} for u in about.initialUnknowns}
    assert found == {
        "distance": set(),
        "speed": {"initial_speed"},
        "load": {"mass", "lift"},
        "stopped": {"initial_speed", "push", "push_growth", "brake"},
        "pace": {"initial_speed", "push"},
    }


# ---- the FMU of pythonfmu -------------------------------------------------------------------------------------------


def test_pythonfmu_discards_steps_past_the_stop_time_with_the_same_sentence(sleds: dict) -> None:
    with FmuInstance(sleds["python"]) as sled:
        sled.fmu.setupExperiment(startTime=0.0, stopTime=1.0, tolerance=2.0)
        sled.fmu.enterInitializationMode()
        sled.fmu.exitInitializationMode()
        assert sled.messages[0].startswith("The tolerance must be from 1e-12 to 0.01")
        assert sled["tolerance"] == 1e-6
        for time, size in ((0.0, 1.1), (math.inf, 0.1), (math.nan, 0.1)):
            with pytest.raises(CosimulationError, match="Nothing was advanced"):
                sled.step(time, size)
        sled.step(0.0, 1.0)
        assert sled["distance"] == pytest.approx(SPEED, rel=TOLERANCE)
        with pytest.raises(CosimulationError, match="The step must end at most at the stop time of 1 s"):
            sled.step(1.0, 0.1)
        assert [line for line in sled.messages if "tolerance" in line] == sled.messages[:1]


def test_pythonfmu_makes_no_step_of_a_run_that_stops_before_it_starts(sleds: dict) -> None:
    with FmuInstance(sleds["python"]) as sled:
        sled.fmu.setupExperiment(startTime=1.0, stopTime=0.5)
        sled.fmu.enterInitializationMode()
        sled.fmu.exitInitializationMode()
        with pytest.raises(CosimulationError, match="The stop time must be at least the start time of 1 s"):
            sled.step(1.0, 0.1)


# ---- the page about all this ----------------------------------------------------------------------------------------


def names_of_tests() -> set[str]:
    """Return the names of all tests of FMUs."""
    return {
        node.name
        for path in Path(__file__).parent.glob("test_*.py")
        for node in ast.parse(path.read_text(encoding="utf-8")).body
        if isinstance(node, ast.FunctionDef) and node.name.startswith("test_")
    }


def test_each_check_on_the_page_has_its_test() -> None:
    names = names_of_tests()
    assert [check.test for check in CHECKS if check.test not in names] == []
    assert len({check.test for check in CHECKS}) == len(CHECKS)


def test_each_edge_is_on_the_page() -> None:
    """Each test of the standards in this file has to be listed on the page."""
    own = {
        node.name
        for node in ast.parse(Path(__file__).read_text(encoding="utf-8")).body
        if isinstance(node, ast.FunctionDef) and node.name.startswith("test_")
    }
    assert own - {check.test for check in CHECKS} == NOT_OF_THE_STANDARD


#: Tests of the motion, of hosts and of the page itself.
NOT_OF_THE_STANDARD = {
    "test_motion_and_sentences_are_the_same_at_unix_time",
    "test_discarded_step_tells_nothing_that_did_not_happen",
    "test_fmpy_takes_the_run_to_its_end",
    "test_tolerance_that_serves_is_taken",
    "test_initial_unknowns_have_the_dependencies_of_the_start",
    "test_each_check_on_the_page_has_its_test",
    "test_each_edge_is_on_the_page",
    "test_pages_of_an_archive_name_the_checks_of_its_kind",
}


@pytest.mark.parametrize("kind", KINDS)
def test_pages_of_an_archive_name_the_checks_of_its_kind(sleds: dict, kind: str) -> None:
    with zipfile.ZipFile(sleds[kind]) as archive:
        index, page = (archive.read(f"documentation/{name}.html").decode() for name in ("index", "compliance"))
    assert 'href="compliance.html"' in index
    for check in CHECKS:
        assert (f"<code>{check.test}</code>" in page) == (kind in check.of), check.test
    assert ("does not apply here" in page) == (kind == "python")

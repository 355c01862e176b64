"""Parameters without effect in the chosen system: setting one gives a single warning at initialisation."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import casadi as ca
import pytest

from fmu_src.chain import Part
from fmu_src.idle_parameters import without_effect
from fmu_src.kernel import Kernel, Library, SimulationError
from fmu_src.native_fmu import build_native_fmu, build_native_fmu3
from fmu_src.system import Model, System, Variable, model_of, model_of_choices
from products.registry import model_of as fmu_model
from tests.fmu_src.fmi.hosting import OK, WARNING, Host, host
from tests.fmu_src.quick_library import quick_library

BUILD = {"native": build_native_fmu, "fmi3": build_native_fmu3}
#: Parameters that act only in the stone's second system, each in another way.
AT_ONCE, BY_CONSTANT, BY_PART = "drag", "buoyancy", "wind"
DETAILED = (AT_ONCE, BY_CONSTANT, BY_PART)


def stone(detail: int) -> System:
    """Return a falling stone. Both levels of detail declare all parameters; some act at the second level only."""
    system = System(f"stone_{detail}", "A stone that falls")
    p = {name: system.parameter(Variable(name, "parameter", "1", name, 0.0)) for name in ("gravity", *DETAILED)}
    v = system.state("v", "m/s", 0.0, 1.0)
    lift = system.derived("lift", 2 * p[BY_CONSTANT])
    given, constants = ca.SX.sym("given", 1), ca.SX.sym("constants", 2)
    part = Part(f"blow_{detail}", given, constants, given * constants[0])
    blown = system.call(part, v, ca.vertcat(p[BY_PART] if detail == 2 else 1.0, p[AT_ONCE]))
    system.derivative(v, -p["gravity"] + blown + (p[AT_ONCE] * v + lift if detail == 2 else 0))
    system.output(Variable("speed", "output", "m/s", "Speed"), v)
    return system


def stones() -> Model:
    detail = Variable("detail", "parameter", "1", "Level of detail", 1.0, 1.0, 2.0, kind="integer")
    return model_of_choices("Stone", "A stone that falls", (stone(1), stone(2)), [detail], (0, 1), 1e-8)


def test_effect_is_told_by_what_equations_depend_on() -> None:
    """Parameters act directly, through a constant or through a part. An unused argument of a part has no effect."""
    model = stones()
    assert without_effect(model, model.systems[0]) == list(DETAILED)
    assert without_effect(model, model.systems[1]) == []


def test_parameters_that_cancel_in_a_constant_have_no_effect_and_a_branch_that_rests_has() -> None:
    """Each spring carries half of the weight at any distance. The limit is five times the value at the start."""
    system = System("scales", "A weight on two springs")
    names = {"weight": 10.0, "apart": 2.0, "limit": 50.0}
    p = {n: system.parameter(Variable(n, "parameter", "1", n, start, 0.0)) for n, start in names.items()}
    moment = p["weight"] * p["apart"] / 2
    left = system.derived("left", moment / p["apart"])
    kept = system.derived("kept", ca.fmin(p["weight"], p["limit"]))
    v = system.state("v", "1", 0.0, 1.0)
    system.derivative(v, left + kept - v)
    assert without_effect(model_of(system, 1e-6), system) == ["apart"]


SENTENCE = (
    'Nothing in the system "stone_1" depends on drag, wind, so that setting this has no effect; choose another detail.'
)


@pytest.fixture(scope="module", params=BUILD)
def path(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    made: Path = tmp_path_factory.mktemp("stones") / f"{request.param}.fmu"
    BUILD[request.param](stones(), made)
    return made


def initialised(one: Host, **values: float) -> int:
    """Initialise the instance; return the status."""
    assert one.experiment() == OK
    if not one.three:
        assert one.raw("EnterInitializationMode") == OK
    for name, value in values.items():
        assert one.set(name, value) == OK
    return one.raw("ExitInitializationMode")


@pytest.mark.study
@pytest.mark.parametrize("exchange", [False, True])
def test_an_initialisation_tells_of_them_in_one_sentence(path: Path, exchange: bool) -> None:
    with host(path, exchange=exchange) as one:
        assert initialised(one, gravity=9.81, drag=0.5, buoyancy=0.0, wind=1.0) == WARNING
        assert [sentence.decode() for status, sentence in one.heard if status == WARNING] == [SENTENCE]


@pytest.mark.study
@pytest.mark.parametrize("exchange", [False, True])
def test_values_of_the_start_are_told_of_by_nobody(path: Path, exchange: bool) -> None:
    with host(path, exchange=exchange) as one:
        assert initialised(one, gravity=9.81, drag=0.0) == OK
        assert one.said == []


@pytest.mark.study
def test_a_kernel_in_python_has_it_in_its_journal() -> None:
    one = Kernel(quick_library(stones()), drag=0.5, wind=1.0)
    one.initialise()
    assert one.messages == [SENTENCE]
    one.reopen()
    one.set(detail=2)
    one.initialise()
    assert one.messages == [SENTENCE]


@pytest.mark.study
def test_a_name_that_there_is_not_is_told_however_it_is_used() -> None:
    one = Kernel(quick_library(stones()))
    ways: list[Callable[[], object]] = [
        lambda: one.set(sped=1.0),
        lambda: one.set_rate(sped=1.0),
        lambda: one["sped"],
        lambda: one.record(1.0, 0.1, ["sped"]),
    ]
    for way in ways:
        with pytest.raises(SimulationError, match=r"There is no variable sped; did you mean speed\?"):
            way()


#: Some of the parameters without effect, by level and contact model of the bogie.
NAMED = {
    (1, 1): {"constant_speed", "wheel_lift_ends", "frame_height", "vertical_stiffness", "vertical_half_spacing"},
    (2, 1): {"constant_speed", "lateral_stiffness", "vertical_half_spacing"},
    (3, 1): {"wheel_profile_curvature", "contact_damping", "curve_resistance"},
    (3, 2): {"rail_head_radius", "wheel_profile_curvature", "flange_clearance", "flange_stiffness", "flange_at_rail"}
    | {"wheel_lift_ends", "curve_resistance"},
    (3, 3): {"slip_reduction", "rail_head_radius"},
}


@pytest.mark.parametrize(("level", "depth"), NAMED)
def test_what_has_no_effect_changes_no_bit_of_a_stop(bogie: Library, level: int, depth: int) -> None:
    """All of them are changed at once."""
    model = fmu_model("bogie")
    idle = without_effect(model, model.systems[model.choice[3 * (level - 1) + depth - 1]])
    assert NAMED[level, depth] <= set(idle)
    assert {"davis_constant", "davis_linear", "davis_quadratic"}.isdisjoint(idle)
    known = {variable.name: variable for variable in model.variables}
    changed = {n: min(0.9 * known[n].start or 1.0, known[n].maximum) for n in idle if known[n].kind == "real"}
    changed |= {name: 1.0 - known[name].start for name in idle if known[name].kind == "integer"}
    found = []
    for values in ({}, changed):
        kernel = Kernel(bogie, level=level, contact_model=depth, brake_torque_1=15e3, **values)
        kernel.advance(0.2)
        found.append([kernel[name] for name in known if known[name].causality == "output"])
    assert found[0] == found[1]
    assert [line for line in kernel.messages if line.startswith("Nothing in the system")] == kernel.messages[:1]

"""Start dependencies of the built-in models: a change of a variable that is not listed leaves the output unchanged."""

from __future__ import annotations

import pytest
from fmpy import read_model_description

from fmu_src.dependencies import start_dependencies
from fmu_src.kernel import Kernel, Library, SimulationError
from fmu_src.model_description import NOMINAL
from fmu_src.system import Model, Variable
from products.building import kernel_of
from products.registry import DIFFERENT, model_of

#: Tolerance of algebraic states, and largest relative change of an output that is treated as unchanged.
SOLVED = 1e-12
UNCHANGED = 1e-9
#: Starts at which inputs act, by model: in motion on an uneven track, and at rest, where the brake decides on sticking.
STARTS: dict[str, list[dict[str, float]]] = {
    "bogie": [
        *({"level": level, "lateral_irregularity": 0.01, "yaw_torque_2": 1e3} for level in (1, 2, 3)),
        *({"level": level, "initial_speed": 0.0, "traction_torque_1": 10.0, "drawbar_force": 50.0} for level in (1, 3)),
    ],
    "vehicle": [{"level": 1, "coupler_force_front": 1e3}, {"level": 3, "initial_speed": 0.0, "brake_torque_2": 1.0}],
    "braked-vehicle": [{"level": 1, "coupler_force_front": 1e3}],
    "wheelset": [{"lateral_irregularity": 0.01}, {"initial_speed": 0.0, "brake_torque_1": 1.0}],
    "brake": [{"friction_law": law, "cylinder_model": 1 + law % 2, "angular_velocity": 5.0} for law in range(8)],
    "rail": [{"speed": 10.0, "slip_1": 1.0, "creep_force_1": 1e3}],
    "driven-wheelset": [
        *({"shafts": shafts, "initial_slip": -0.1, "initial_torque": 2e3, "brake_torque_2": 1e3} for shafts in (1, 4)),
        {"shafts": 3, "initial_speed": 0.0, "resistance": 1e3, "brake_torque_1": 1.0},
    ],
}
#: Dependencies that these starts must show.
ACTING = {
    "bogie": [("creep_force_1", "friction_1"), ("acceleration", "drawbar_force")],
    "vehicle": [("acceleration", "coupler_force_front"), ("axle_load_4", "body_mass")],
    "braked-vehicle": [("acceleration", "coupler_force_front"), ("shoe_friction_2", "constant_shoe_friction")],
    "wheelset": [("acceleration", "friction_1"), ("axle_load_1", "cross_level")],
    "brake": [("shoe_friction", "angular_velocity"), ("shoe_friction", "friction_law")],
    "rail": [("friction_1", "degraded_friction")],
    "driven-wheelset": [("creep_force_2", "friction_2"), ("drive_twist", "drive_stiffness")],
}


def at_start(library: Library, model: Model, values: dict[str, float]) -> dict[str, float]:
    kernel = Kernel(library, tolerance=SOLVED, **values)
    kernel.initialise()
    return {v.name: kernel[v.name] for v in model.variables if v.causality == "output"}


def changed(variable: Variable, value: float) -> float:
    """Return another value within the variable's limits."""
    if variable.kind != "real":
        return value + 1 if value < variable.maximum else value - 1
    other = 1.1 * value + (0.05 * NOMINAL.get(variable.unit, 1.0) if value == 0.0 else 0.0)
    return other if other <= variable.maximum else 0.9 * value


def acting(library: Library, model: Model, start: dict[str, float]) -> set[tuple[str, str]]:
    """Return pairs of an output and a variable that changes it at this start."""
    found = set()
    base = at_start(library, model, start)
    for variable in model.variables:
        if variable.causality not in ("input", "parameter") or variable.name in ("tolerance", *model.selectors):
            continue
        value = changed(variable, start.get(variable.name, variable.start))
        try:
            after = at_start(library, model, start | {variable.name: value})
        except SimulationError:  # inconsistent geometry has no start
            continue
        for name, number in after.items():
            if abs(number - base[name]) > UNCHANGED * max(abs(number), abs(base[name]), 1e-3):
                found.add((name, variable.name))
    return found


#: Composed of other models in this list, and slow to compile.
COMPOSED = pytest.param("braked-vehicle", marks=pytest.mark.long)


@pytest.mark.parametrize("name", [COMPOSED if name == "braked-vehicle" else name for name in DIFFERENT])
def test_values_at_the_start_depend_on_nothing_that_is_not_listed(name: str) -> None:
    model = model_of(name)
    library = Library(kernel_of(name))
    listed = start_dependencies(model)
    found = set().union(*(acting(library, model, start) for start in STARTS[name]))
    assert {pair for pair in found if pair[1] not in listed[pair[0]]} == set()
    assert set(ACTING[name]) <= found


@pytest.mark.study
def test_speed_at_the_start_is_the_initial_speed_whatever_brakes(fmus: dict) -> None:
    """An importer that couples brake and bogie finds no loop: no torque affects the inputs of the brake."""
    for kind in ("native", "fmi3", "python"):
        about = read_model_description(str(fmus["bogie", kind]))
        found = {u.variable.name: {d.name for d in u.dependencies} for u in about.initialUnknowns}
        inputs = {variable.name for variable in about.modelVariables if variable.causality == "input"}
        for name in ("speed", "angular_velocity_2"):
            assert {"level", "contact_model", "initial_speed", "wheel_radius"} <= found[name]
            # On a gradient it rolls freely in steady state (fmu_src/runtime/steady.c).
            assert found[name] & inputs == {"gradient", "friction_1", "friction_2"}
        assert "friction_1" in found["acceleration"]

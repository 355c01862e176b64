"""Machines of the test rig, compiled: their models, and files that a wheel brings or that are found again."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache, partial
from pathlib import Path

from fmu_src.batch import BatchLibrary, compiled_batch, most_lanes
from fmu_src.compile import build_library, library_suffix
from fmu_src.kernel import Library
from fmu_src.system import Model, model_of
from products.build_notes import noted_path
from products.building import variables_from
from products.machine import MACHINES, Machine, composed
from products.prebuilt import prebuilt_from_these
from rbd_model.levels.models import DEFAULT_TOLERANCE, places_of, system_at

#: Levels of the test rig: planar; 3D with elastic contacts.
LEVELS = (2, 3)
#: Machines that a wheel brings, planar and without a line, by the beginning of the names of their files.
READY = {
    f"machines/{name}-by-{'flow' if by_flow else 'time'}": replace(make(), by_flow=by_flow)
    for name, make in MACHINES.items()
    for by_flow in (False, True)
}


def ready_file(machine: Machine, level: int, on_line: bool, end: str) -> Path | None:
    """Return a file of a machine that a wheel brings, if no source has changed."""
    name = next((name for name, ready in READY.items() if ready == machine), "")
    return prebuilt_from_these(f"{name}{end}") if name and (level, on_line) == (2, False) else None


@lru_cache
def machine_model(machine: Machine, level: int = 2, on_line: bool = False) -> Model:
    """Return the vehicle at a level of detail, one system. Raises ValueError if the level is not 2 or 3."""
    if level not in LEVELS:
        raise ValueError(f"level must be 2 (planar) or 3 (3D) on the test rig; got {level}.")
    [place] = places_of(level, 2, on_line)
    return model_of(composed(machine, system_at(machine.vehicle, place)), DEFAULT_TOLERANCE)


@lru_cache
def machine_table(machine: Machine, level: int = 2, on_line: bool = False) -> tuple[Model, tuple[str, ...]]:
    """Return the table of variables, as a model that may lack its equations, and the names of the states."""
    path = ready_file(machine, level, on_line, ".json")
    if path is None:
        model = machine_model(machine, level, on_line)
        return model, tuple(model.systems[0].states)
    about = json.loads(path.read_text(encoding="utf-8"))
    return Model(machine.name, "", tuple(variables_from(about["variables"]).values()), ()), tuple(about["states"])


@lru_cache
def machine_library(machine: Machine, level: int = 2, on_line: bool = False) -> BatchLibrary:
    """Return its compiled equations in vector lanes, with the start values of the built-in vehicle."""
    if machine.own:
        return machine_library(machine.built_in, level, on_line)
    if kernel := ready_file(machine, level, on_line, library_suffix()):
        lanes = ready_file(machine, level, on_line, f"-{most_lanes(kernel)}-lanes{library_suffix()}")
        if lanes:
            return BatchLibrary(lanes, machine_table(machine, level, on_line)[0])
    model = machine_model(machine, level, on_line)
    return compiled_batch(model, model.systems[0], kept=partial(_kept, machine, level, on_line))


@lru_cache
def machine_kernel(machine: Machine, on_line: bool = False) -> Library:
    """Return its compiled planar equations, for one vehicle, with the start values of the built-in vehicle."""
    if machine.own:
        return machine_kernel(machine.built_in, on_line)
    return Library(
        ready_file(machine, 2, on_line, library_suffix())
        or _kept(machine, 2, on_line, "kernel", lambda: build_library(machine_model(machine, 2, on_line)))
    )


@lru_cache
def own_values(machine: Machine, level: int = 2, on_line: bool = False) -> Mapping[str, float]:
    """Return the start values that a vehicle file changes in the compiled equations [SI]; empty without one."""
    if not machine.own:
        return {}
    built_in = {variable.name: variable.start for variable in machine_model(machine.built_in, level, on_line).variables}
    own = {one.name: one.start for one in machine_model(machine, level, on_line).variables}
    changed = {name: value for name, value in own.items() if value != built_in[name]}
    return changed | dict(machine.own.resistance)


def _kept(machine: Machine, level: int, on_line: bool, what: str, make: Callable[[], Path]) -> Path:
    """Return a file of this vehicle; its equations are written again only if the sources change."""
    return noted_path(f"{what} of the {machine} at level {level}{' on a line' if on_line else ''}", make)

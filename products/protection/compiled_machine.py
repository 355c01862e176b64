"""Machines of the test rig, compiled: their models, and files that are found again."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache, partial
from pathlib import Path

from fmu_src.batch import BatchLibrary
from fmu_src.compile import build_library
from fmu_src.kernel import Library
from fmu_src.system import Model, model_of
from products.build_notes import noted_path
from products.machine import Machine, composed
from rbd_model.levels.models import DEFAULT_TOLERANCE, places_of, system_at

#: Levels of the test rig: planar; 3D with elastic contacts.
LEVELS = (2, 3)


@lru_cache
def machine_model(machine: Machine, level: int = 2, on_line: bool = False) -> Model:
    """Return the vehicle at a level of detail, one system. Raises ValueError if the level is not 2 or 3."""
    if level not in LEVELS:
        raise ValueError(f"level must be 2 (planar) or 3 (3D) on the test rig; got {level}.")
    [place] = places_of(level, 2, on_line)
    return model_of(composed(machine, system_at(machine.vehicle, place)), DEFAULT_TOLERANCE)


@lru_cache
def machine_library(machine: Machine, level: int = 2, on_line: bool = False) -> BatchLibrary:
    """Return its compiled equations in vector lanes, with the start values of the built-in vehicle."""
    if machine.own:
        return machine_library(machine.built_in, level, on_line)
    model = machine_model(machine, level, on_line)
    return BatchLibrary(model, model.systems[0], kept=partial(_kept, machine, level, on_line))


@lru_cache
def machine_kernel(machine: Machine, on_line: bool = False) -> Library:
    """Return its compiled planar equations, for one vehicle, with the start values of the built-in vehicle."""
    if machine.own:
        return machine_kernel(machine.built_in, on_line)
    return Library(_kept(machine, 2, on_line, "kernel", lambda: build_library(machine_model(machine, 2, on_line))))


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

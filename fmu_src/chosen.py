"""The one system of a model that given values choose, alone behind the whole table of variables."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from fmu_src.system import NONE, Model


def alone(model: Model, values: Mapping[str, Any], with_file: bool = False) -> Model:
    """The model with no other system than the one that the values of its selectors, and a table file, choose.

    Its runs have the same numbers and say the same sentences. Raises ValueError where they choose none.
    """
    place = _place(model, values, with_file)
    if place == NONE:
        asked = [f"{name} = {values.get(name, 'its start value')}" for name in model.selectors]
        asked += ["a table file"] if with_file else []
        raise ValueError(f"{model.name} has no system for {' and '.join(asked)}; choose another one.")
    system = model.systems[place]
    file = model.table_file.variable if model.table_file and not system.tables else None
    kept = tuple(one for one in model.variables if one.causality != "local" and one != file)
    choice = tuple(0 if one == place else NONE for one in model.choice)
    if file:
        choice = choice[: len(choice) // 2]
    return replace(model, variables=kept, systems=(system,), choice=choice, reads=None if file else model.reads)


def _place(model: Model, values: Mapping[str, Any], with_file: bool) -> int:
    """Of the system in the model, or NONE."""
    selectors = [next(one for one in model.variables if one.name == name) for name in model.selectors]
    combination = 0
    for one in selectors:
        value = values.get(one.name, one.start)
        if value not in range(1, int(one.maximum) + 1):
            return NONE
        combination = combination * int(one.maximum) + int(value) - 1
    if with_file and not model.table_file:
        return NONE
    if with_file:
        combination += math.prod(int(one.maximum) for one in selectors)
    return model.choice[combination]

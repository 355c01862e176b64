"""The one system of a model that given values choose, with the whole table of variables."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from fmu_src.system import NONE, Model, Variable


def alone(model: Model, values: Mapping[str, Any], with_file: bool = False) -> Model:
    """Return the model with only the system that its selectors and a table file choose.

    Its runs have the same numbers and messages.
    """
    selectors = [next(one for one in model.variables if one.name == name) for name in model.selectors]
    place = place_in(model.choice, selectors, values, with_file) if model.table_file or not with_file else NONE
    if place == NONE:
        asked = [f"{name} = {values.get(name, 'its start value')}" for name in model.selectors]
        asked += ["a table file"] if with_file else []
        raise ValueError(f"{model.name} has no system for {' and '.join(asked)}; choose another one.")
    system = model.systems[place]
    file = model.table_file.variable if model.table_file and not system.tables else None
    kept = tuple(variable for variable in model.variables if variable.causality != "local" and variable != file)
    choice = tuple(0 if one == place else NONE for one in model.choice)
    if file:
        choice = choice[: len(choice) // 2]
    reads: dict[str, Any] = {"reads": None if file else model.reads, "reads_records": model.record_file}
    return replace(model, variables=kept, systems=(system,), choice=choice, **reads)


def place_in(choice: Sequence[int], selectors: Sequence[Variable], values: Mapping[str, Any], with_file: bool) -> int:
    """Return the number of the system that values of the selectors choose, or NONE; without a value the start counts.

    choice: as `Model` has it, by the selectors, the last one running first; its second half is with a table file.
    """
    combination = 0
    for one in selectors:
        value = values.get(one.name, one.start)
        if value not in range(1, int(one.maximum) + 1):
            return NONE
        combination = combination * int(one.maximum) + int(value) - 1
    return choice[combination + with_file * math.prod(int(selector.maximum) for selector in selectors)]

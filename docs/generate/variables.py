"""Tables of docs/variables.md: the variables of every FMU, from the equations."""

import math
import re
from collections.abc import Sequence
from functools import lru_cache

from pages import table

from brake_controller.protection_fmu import wheel_slide_protection
from fmu_src.arrays_fmu import ArraysInC
from fmu_src.model_description import variable_table
from fmu_src.system import Model
from products.braking_curves.fmu import curves_in_c
from products.registry import ALIKE, FMUS, model_of
from products.train.coupler_fmu import coupler_in_c
from products.train.driver_fmu import driver_in_c
from products.train.fmu import train_in_c
from products.train.layout import layout


@lru_cache
def models() -> list[Model]:
    """Return the models of all FMUs, in the order of the page."""
    return [*map(model_of, FMUS), wheel_slide_protection().model]


def choices() -> str:
    """Return the meanings of the values of each selecting integer, once for all FMUs that have it."""
    found: dict[str, tuple[tuple[tuple[int, str], ...], list[str]]] = {}
    for model in models():
        for variable in model.variables:
            if variable.choices:
                name = re.sub(r"_\d+$", "", variable.name)
                numbers, owners = found.setdefault(name, (variable.choices, []))
                assert numbers == variable.choices, f"{name} means different things in {owners} and {model.name}."
                if model.name not in owners:
                    owners.append(model.name)
    parts = ["## Choices by number\n"]
    for name, (numbers, owners) in found.items():
        rows = [(str(number), text) for number, text in numbers]
        parts.append(f"### `{name}`\n\nIn {', '.join(owners)}.\n\n{table(('number', 'meaning'), rows)}\n")
    return "\n".join(parts)


def section(model: Model, alike: str | None) -> str:
    """Return the section of one FMU; an FMU that is like another has the same variables with other start values."""
    text = variable_table(model.name, model.variables)
    if alike:
        text = f"Its variables are those of {model_of(alike).name}; `build_fmu.py --describe` shows its start values.\n"
    return f"## {model.name}\n\n{model.description}.\n\n{text}"


def arrays(given: ArraysInC) -> str:
    """Return the section of an FMU whose variables are arrays."""

    def limit(value: float) -> str:
        return f"{value:g}" if math.isfinite(value) else ""

    rows = [
        (f"`{array.name}`", array.causality, array.unit, limit(array.minimum), limit(array.maximum), array.description)
        for array in given.arrays
    ]
    heads = ("name", "causality", "unit", "min", "max", "meaning")
    return f"## {given.name}\n\n{given.description}.\n\n{table(heads, rows)}\n"


NUMBERS = """## Numbers of a train

The file train.bin in the resources of TrainDynamics.fmu holds doubles in these rows, one behind the other. A row has a
number for each of what the second column names; `n` counts from 1. A file with a number outside its limits is refused,
and the message says which.

"""


def numbers_of_a_train() -> str:
    """Return the rows of train.bin; numbered ones are one row."""
    rows: dict[str, Sequence[str]] = {}
    for group in layout():
        for field in group.fields:
            name, most = re.sub(r"_\d+$", "_n", field.name), f"{field.most:g}"
            if field.counts:
                most = f"{field.counts} {field.most:+g}" if field.most else field.counts
            rows[f"{group.name} {name}"] = (
                group.name,
                group.of,
                f"`{name}`",
                field.unit,
                f"{field.least:g}",
                most,
                field.text,
            )
    return NUMBERS + table(("group", "one for each of", "name", "unit", "from", "to", "what"), rows.values()) + "\n"


def generated() -> str:
    """Return the tables of the page."""
    alike = [*map(ALIKE.get, FMUS), None]
    in_c = [curves_in_c(), driver_in_c(), train_in_c(), coupler_in_c()]
    trains = [*map(arrays, in_c), numbers_of_a_train()]
    return "\n".join([choices(), *map(section, models(), alike), *trains])

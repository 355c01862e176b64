"""Writes docs/variables.md: the variables of every FMU, as tables from the equations. --check only compares."""

import math
import re
import sys
from collections.abc import Iterable, Sequence
from functools import lru_cache

from pages import DOCS, write_or_check

from brake_controller.cylinder import TIMES
from brake_controller.protection_fmu import wheel_slide_protection
from brake_controller.shoe_friction import EXAMPLE_TABLE, KILOMETRES_PER_HOUR, TABULATED
from fmu_src.arrays_fmu import ArraysInC
from fmu_src.model_description import variable_table
from fmu_src.system import Model
from products.braking_curves.fmu import curves_in_c
from products.registry import ALIKE, FMUS, model_of
from products.train.coupler_fmu import coupler_in_c
from products.train.fmu import train_in_c
from products.train.layout import layout
from rbd_model.levels.models import DEPTH_ON_LINE

PAGE = DOCS / "variables.md"
HEAD = """# Variables of the FMUs

Written by `docs/generate/variables.py` from the equations; `python build_fmu.py --describe` prints the tables of its
FMUs. Which way is positive: [units and signs](units.md). Each FMU has one table of inputs, one of outputs and one of
parameters; read them like this:

| column | says |
|---|---|
| name | the name for the host. 1 is the leading wheelset, 2 the one behind it |
| type | as in FMI 2.0; in FMI 3.0 `Real` is called `Float64`, and `Integer` `Int32` |
| causality | `input`: set by the host, also during a run; `output`: read by it; `parameter`: set before a run |
| variability | `fixed` once a run has begun; `continuous`: changes at any time; `discrete`: changes by jumps |
| unit | the SI unit that values have, 1 for pure numbers; display units (km/h, kPa, kN, deg) are for people only |
| start | the value until the host sets another one |
| min, max | a value of the host beyond them is refused; an empty cell is no limit |
| meaning | what it is, with the symbol or equation of the source |

A column that would be empty is left out. An `Integer` from 0 to 1 is a switch, and its meaning says what both do; what
the numbers of the others choose is listed in [choices by number](#choices-by-number). Besides what stands here each
native FMU has its states as local variables `state_...`, to read and to differentiate by.
"""


def friction_note() -> str:
    """Return the inputs of the shoe friction laws, and your own table for the last."""
    points = zip(EXAMPLE_TABLE.speeds, EXAMPLE_TABLE.frictions, strict=True)
    rows = "\n".join(f"| {KILOMETRES_PER_HOUR * speed:.0f} km/h | {friction:g} |" for speed, friction in points)
    return f"""Law 0 is `constant_shoe_friction` at any speed. Law 4 begins there and falls with speed, by
`falling_friction_constant`. `brake_controller/shoe_friction.py` has the formulas and their sources.

Law {TABULATED} draws straight lines between the points of a table, and holds the first and the last value beyond them.
The FMUs of this page have this table, which is an example, cast iron P6 at 20 kN:

| sliding speed | shoe friction |
|---|---|
{rows}

A table is compiled into the FMU. To use your own, build the brake with it:

```python
import bogie_braking as bb
from brake_controller.cylinder import brake_cylinder
from brake_controller.shoe_friction import FrictionTable

table = FrictionTable(speeds=[0.0, 10.0, 30.0], frictions=[0.25, 0.18, 0.14])  # m/s, 1
print(bb.write_fmu(brake_cylinder(table=table), "BrakeCylinder.fmu"))
```

```text
BrakeCylinder.fmu
```

Then set `friction_law` to {TABULATED}.
"""


#: Below the numbers of a choice, by its name.
NOTES = {
    "level": "Take the lowest that answers your question: [choosing](choosing.md).\n",
    "contact_model": "[Choosing](choosing.md) says which one to take. "
    f"On a [line](line.md) contact model {DEPTH_ON_LINE} is the only one.\n",
    "cylinder_model": f"Number 1 alone uses {', '.join(f'`{name}`' for name in TIMES)}.\n",
    "friction_law": friction_note(),
    "integration_method": "Keep 1 unless [choosing](choosing.md) or [real time](real_time.md) gives a reason.\n",
}


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
        lines = ["| number | meaning |", "|---|---|", *(f"| {number} | {text} |" for number, text in numbers)]
        parts.append(f"### `{name}`\n\nIn {', '.join(owners)}.\n\n" + "\n".join(lines) + "\n")
        if name in NOTES:
            parts.append(NOTES[name])
    return "\n".join(parts)


def section(model: Model, alike: str | None) -> str:
    """Return the section of one FMU; an FMU that is like another has the same variables with other start values."""
    table = variable_table(model)
    if alike:
        table = (
            f"Its variables are those of {model_of(alike).name}; `build_fmu.py --describe` shows its start values.\n"
        )
    return f"## {model.name}\n\n{model.description}.\n\n{table}"


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    return "\n".join(f"| {' | '.join(row)} |" for row in [heads, ["---"] * len(heads), *rows]) + "\n"


def arrays(given: ArraysInC) -> str:
    """Return the section of an FMU whose variables are arrays."""

    def limit(value: float) -> str:
        return f"{value:g}" if math.isfinite(value) else ""

    rows = [
        (f"`{one.name}`", one.causality, one.unit, limit(one.minimum), limit(one.maximum), one.description)
        for one in given.arrays
    ]
    heads = ("name", "causality", "unit", "min", "max", "meaning")
    return f"## {given.name}\n\n{given.description}.\n\n{table(heads, rows)}"


NUMBERS = """## Numbers of a train

The file train.bin in the resources of TrainDynamics.fmu holds doubles in these rows, one behind the other. A row has a
number for each of what the second column names; `n` counts from 1. A file with a number outside its limits is refused,
and the message says which.

"""


def numbers_of_a_train() -> str:
    """Return the rows of train.bin; numbered ones are one row."""
    rows: dict[str, Sequence[str]] = {}
    for group in layout():
        for one in group.fields:
            name, most = re.sub(r"_\d+$", "_n", one.name), f"{one.most:g}"
            if one.counts:
                most = f"{one.counts} {one.most:+g}" if one.most else one.counts
            rows[f"{group.name} {name}"] = (
                group.name,
                group.of,
                f"`{name}`",
                one.unit,
                f"{one.least:g}",
                most,
                one.text,
            )
    return NUMBERS + table(("group", "one for each of", "name", "unit", "from", "to", "what"), rows.values())


def page() -> str:
    """The text of docs/variables.md."""
    alike = [*map(ALIKE.get, FMUS), None]
    trains = [arrays(curves_in_c()), arrays(train_in_c()), arrays(coupler_in_c()), numbers_of_a_train()]
    return "\n".join([HEAD, choices(), *map(section, models(), alike), *trains])


if __name__ == "__main__":
    sys.exit(write_or_check({PAGE: page()}, sys.argv[1:]))

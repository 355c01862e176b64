"""Writes docs/variables.md: the variables of every FMU, as tables from the equations. --check only compares."""

import sys

from pages import DOCS, write_or_check

from brake_controller.protection_fmu import wheel_slide_protection
from fmu_src.model_description import variable_table
from fmu_src.system import Model
from products.registry import FMUS, model_of

PAGE = DOCS / "variables.md"
HEAD = """# Variables of the FMUs

Written by `docs/generate/variables.py` from the equations; `python build_fmu.py --describe` prints the tables of its
FMUs. SI units; display units (km/h, kPa, kN, deg) are for people only. 1 is the leading wheelset, 2 the trailing one.
Parameters are fixed once a run has begun. Besides what stands here each native FMU has its states as local variables
`state_...`, to read and to differentiate by.
"""


def section(model: Model, alike: str | None) -> str:
    """Of one FMU; one that is like another has its variables, with other start values."""
    table = variable_table(model)
    if alike:
        table = (
            f"Its variables are those of {model_of(alike).name}; `build_fmu.py --describe` shows its start values.\n"
        )
    return f"## {model.name}\n\n{model.description}.\n\n{table}"


def page() -> str:
    """The text of docs/variables.md."""
    sections = [section(model_of(name), fmu.alike) for name, fmu in FMUS.items()]
    sections.append(section(wheel_slide_protection().model, None))
    return "\n".join([HEAD, *sections])


if __name__ == "__main__":
    sys.exit(write_or_check({PAGE: page()}, sys.argv[1:]))

"""The objects with FMI functions in C, runtime/object.h, and their capabilities in modelDescription.xml."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path

RUNTIME = Path(__file__).parent / "runtime"
#: The files that fill in the table; "": pythonfmu, whose binary is not ours.
KERNEL, ARRAYS, PYTHON = "kernel_object.c", "arrays_object.c", ""
#: Start values among the resources, which both objects read; what it needs besides, where no kernel is.
START_VALUES, READERS = "start_values.c", ("text_rows.c", "decimal.c")
#: The FMI functions of both standards, after the file of their object: in one unit its table must come first.
FACES = ("face.c", "fmi2.c", "fmi3.c")
#: Attributes of both interfaces, and of co-simulation alone, with the member of the table that an FMU needs for them.
OF_BOTH = {
    2: {
        "canGetAndSetFMUstate": "take_block",
        "canSerializeFMUstate": "take_block",
        "providesDirectionalDerivative": "get_directional",
    },
    3: {
        "canGetAndSetFMUState": "take_block",
        "canSerializeFMUState": "take_block",
        "providesDirectionalDerivatives": "get_directional",
    },
}
OF_SLAVES = {
    2: {"canInterpolateInputs": "set_rates"},
    3: {"mightReturnEarlyFromDoStep": "stop_at_events", "hasEventMode": "stop_at_events"},
}


@lru_cache
def members(file: str) -> frozenset[str]:
    """Return the members of the table that are not NULL in a file of the runtime."""
    text = (RUNTIME / file).read_text(encoding="utf-8") if file else ""
    return frozenset(re.findall(r"^    /\* (\w+) \*/ (?!NULL,)", text, re.MULTILINE))


def able(file: str, attributes: Mapping[str, str], all_of_them: bool = False) -> dict[str, str]:
    """Return the attributes that an object can claim; or all, those with "false" that it cannot."""
    found = {name: str(needed in members(file)).lower() for name, needed in attributes.items()}
    return {name: value for name, value in found.items() if all_of_them or value == "true"}


def order_of_rates(file: str) -> str:
    """Return the highest order of the derivatives of outputs."""
    return str(int("get_rates" in members(file)))

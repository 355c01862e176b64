"""The table [tolerances] of a TOML file: tolerances and failures of a train's brake, with their units.

    [tolerances]
    friction = "5 %"
    friction_common = "3 %"
    isolated = "0.1 %"
    noticed = "90 %"
    delay = "0.3 s"

Names, units and limits are those of `ENTRIES` (products/supervision/tolerances.py).
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from fmu_src.suggestion import suggestion
from products.supervision.arguments import path_of
from products.supervision.tolerances import ENTRIES, Entry, Tolerances
from readers.documents import is_number
from readers.quantity import decimal_comma, number_in
from readers.text import BadInputError, quoted, shown
from readers.toml_files import toml_of

TABLE = "tolerances"


def read_tolerances(path: str | Path) -> Tolerances:
    """Return the tolerances of a file.

    Takes path [tolerances].
    """
    path = path_of(path)
    try:
        found = toml_of(path)
    except ValueError as error:
        raise BadInputError(str(error)) from error
    table = found.get(TABLE)
    if not isinstance(table, dict) or not table:
        raise BadInputError(f'{path} must have a table [{TABLE}] with entries such as friction = "5 %". Add it.')
    for name in found:
        if name != TABLE:
            raise BadInputError(f"{path} must have the table [{TABLE}] alone; got {shown(name)}. Remove it.")
    given: dict[str, Any] = {}
    for name, value in table.items():
        if name not in ENTRIES:
            near = suggestion(name, ENTRIES, f"known are {', '.join(ENTRIES)}.")
            raise BadInputError(f"{path}: {quoted(name)} is not a tolerance. {near[0].upper()}{near[1:]}")
        given[name] = _number(path, name, value, ENTRIES[name])
    try:
        return Tolerances(**given)
    except BadInputError as error:
        raise BadInputError(f"{path}: {error}") from None


def _number(path: str | Path, name: str, value: Any, entry: Entry) -> float | int:
    """Return a number [1 or s] of an entry, within its limits."""
    scale, unit = (100.0 if entry.unit == "%" else 1.0), ("" if entry.unit == "1" else f" {entry.unit}")
    limits = f"from {scale * entry.least:g} to {scale * entry.most:g}{unit}"
    got = f"{path}: {name} must be {'' if unit else 'an integer '}{limits}; got {shown(value)}."
    read = number_in(value, entry.unit) if isinstance(value, str) else float(value) if is_number(value) else None
    sample = f'"{min(1.0, scale * entry.most):g}{unit}"' if unit else "4"
    if read is None:
        raise BadInputError(f"{got}{decimal_comma(value, entry.unit) or f' Write {sample}, for example.'}")
    bare = is_number(value) or str(value).strip()[-1:] in "0123456789."
    if unit and bare and value not in (0, "0"):
        write = f'Write "{read:g}{unit}", or another.'
        raise BadInputError(f"{path}: {name} must have its unit; got {shown(value)}. {write}")
    if not entry.least <= read / scale <= entry.most or (not unit and read != int(read)):
        raise BadInputError(f"{got} Correct it.")
    return int(read) if not unit else read / scale

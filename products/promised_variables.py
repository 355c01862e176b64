"""Compatibility of the variables of the FMUs: the table of the last version, and the changes since.

`python -m products.promised_variables`, in a checkout, writes the table for a new version.
"""

import csv
from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path

from fmu_src import __version__
from fmu_src.system import Variable
from products.registry import FMUS, model_of
from readers.renamed import RENAMED

TABLE = Path(__file__).parent / "variables.csv"
COLUMNS = ("version", "fmu", "name", "causality", "unit", "start", "meaning")
#: Properties that a host may rely on: causality, unit, start value, empty for outputs, and the meaning of true, empty
#: for numbers.
Promise = tuple[str, str, str, str]


def promise_of(variable: Variable) -> Promise:
    """Return the properties of one variable; a string has no start value."""
    start = f"{variable.start:.12g}" if variable.causality in ("input", "parameter") else ""
    return variable.causality, variable.unit, start, variable.description if variable.kind == "boolean" else ""


@lru_cache
def last_version() -> tuple[str, dict[str, dict[str, Promise]]]:
    """Return the last version, and its properties by FMU and variable."""
    version, promised = "", dict[str, dict[str, Promise]]()
    with TABLE.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            version = row["version"]
            promise = row["causality"], row["unit"], row["start"], row["meaning"]
            promised.setdefault(row["fmu"], {})[row["name"]] = promise
    return version, promised


def changes(name: str, variables: Iterable[Variable] | None = None) -> list[str]:
    """Return the changes of an FMU's variables since the last version as messages; variables: the present ones."""
    version, promised = last_version()
    if name not in promised:
        return []  # nothing was promised of an FMU that there was not
    now = {one.name: promise_of(one) for one in (model_of(name).variables if variables is None else variables)}
    before = promised[name]
    renamed = {RENAMED[old]: old for old in before if old not in now and RENAMED.get(old) in now}
    said = [f"{key} is new, {now[key][0]} [{now[key][1]}]" for key in now if key not in before and key not in renamed]
    said += [f"{key} is gone" for key in before if key not in now and key not in renamed.values()]
    said += [f"{old} is called {new} now" for new, old in renamed.items()]
    for key in (one for one in now if renamed.get(one, one) in before):
        kinds = ("causality", "unit", "start value", "meaning")
        pairs = zip(kinds, before[renamed.get(key, key)], now[key], strict=True)
        said += [
            f"the {what} of {key} is {new or 'none'} in place of {old or 'none'}"
            for what, old, new in pairs
            if old != new
        ]
    return [f"{name}: {one}, since version {version}." for one in said]


def write_table() -> None:
    """The table of this version."""
    with TABLE.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        for name in FMUS:
            rows = ([__version__, name, variable.name, *promise_of(variable)] for variable in model_of(name).variables)
            writer.writerows(rows)


if __name__ == "__main__":
    write_table()

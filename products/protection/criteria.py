"""Criteria of acceptance of a wheel-slide protection as data: a TOML file with a limit for each (criteria.toml)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fmu_src.suggestion import suggestion
from products.protection.programme import Case, named_tables, number_of, words_in
from readers.text import shown

#: Built-in criteria.
CRITERIA = Path(__file__).with_name("criteria.toml")
KNOWN = ("name", "measure", "most", "least", "unit", "groups", "cases", "source")
#: Measures of a stop by their names in a file: unit and meaning. Limits apply to means over draws, with intervals.
MEANS = {
    "over_ideal": ("1", "distance over that of the best slip at every instant"),
    "over_dry": ("1", "distance over that of the same stop on the dry rail without a controller"),
    "in_band": ("1", "share of the braked time above 3 m/s in which no slip was above 0.3"),
    "air": ("l", "air that the cylinders took, at atmospheric pressure"),
    "fillings": ("1", "air that the cylinders took over that of one full application"),
    "sliding": ("kJ", "energy of sliding of the wheel that slid most"),
}
#: Measures of which the limit applies to the worst of all draws.
EXTREMES = {
    "longest_lock": ("s", "longest lock of a wheelset above 0.3 m/s"),
    "longest_vent": ("s", "longest time for which a valve stayed at vent"),
    "flat": ("mm", "length of the flat after the longest skid of a locked wheel"),
    "reservoir": ("kPa", "lowest pressure in the reservoir"),
    "commands": ("1", "number of commands to hold or vent"),
    "jerk": ("m/s3", "largest jerk of the deceleration above 3 m/s, filtered by two lags of 0.25 s"),
}
MEASURES = MEANS | EXTREMES


@dataclass(frozen=True)
class Criterion:
    """A limit of a measure in some cases.

    measure: one of MEASURES. limit: in the unit of the measure. at_most: True if larger values fail. groups, cases:
    names of those that it is for; without any, all cases. source: of the limit.
    """

    name: str
    measure: str
    limit: float
    at_most: bool
    groups: tuple[str, ...] = ()
    cases: tuple[str, ...] = ()
    source: str = "assumed"

    @property
    def unit(self) -> str:
        """Return the unit of the limit."""
        return MEASURES[self.measure][0]

    def holds_for(self, case: Case) -> bool:
        """Return whether the criterion applies to a case."""
        return not (self.groups or self.cases) or case.group in self.groups or case.name in self.cases

    def passes(self, value: float) -> bool:
        """Return whether a value is within the limit, which passes itself."""
        return value <= self.limit if self.at_most else value >= self.limit


def read_criteria(path: Path) -> list[Criterion]:
    """Return the criteria of a file."""
    return named_tables(path, "criterion", "limit", KNOWN, _criterion)


def check_scopes(criteria: Sequence[Criterion], cases: Sequence[Case]) -> None:
    """Check that each criterion applies to a case, and that each group and case that it names exists."""
    groups, names = dict.fromkeys(case.group for case in cases if case.group), [case.name for case in cases]
    for one in criteria:
        for kind, wanted, known in (("group", one.groups, list(groups)), ("case", one.cases, names)):
            for name in wanted:
                if name not in known:
                    has = ", ".join(groups) or "none"
                    near = suggestion(name, known, f"the groups of these cases are {has}.")
                    words = f"The criterion {one.name} is for the {kind} {shown(name)}, which no case has"
                    raise ValueError(f"{words}; {near} Give such a case, or other criteria.")


def _criterion(table: Mapping[str, Any]) -> Criterion:
    measure = table.get("measure")
    if not isinstance(measure, str) or measure not in MEASURES:
        near = suggestion(str(measure), MEASURES, f"give one of {', '.join(MEASURES)}.")
        raise ValueError(f"measure must be a known one; got {shown(measure or 'nothing')}; {near}")
    given = [name for name in ("most", "least") if name in table]
    if len(given) != 1:
        raise ValueError(f"give either most or least as the limit; got {' and '.join(given) or 'neither'}.")
    unit, limit = MEASURES[measure][0], number_of(given[0], table[given[0]])
    if table.get("unit") != unit:
        raise ValueError(f"unit of {measure} must be {unit}; got {shown(table.get('unit', 'nothing'))}.")
    if limit < 0.0:
        raise ValueError(f"{given[0]} must be at least 0; got {limit:g}.")
    if "source" not in table:
        raise ValueError("give the source of the limit, or source = 'assumed'.")
    scopes = (_names(table, "groups"), _names(table, "cases"))
    return Criterion(table["name"], measure, limit, given[0] == "most", *scopes, words_in(table, "source", "assumed"))


def _names(table: Mapping[str, Any], name: str) -> tuple[str, ...]:
    found = table.get(name, [])
    if not isinstance(found, list) or not all(isinstance(one, str) for one in found) or (name in table and not found):
        raise ValueError(f"give {name} a list of names, as in {name} = ['low']; got {shown(found)}.")
    return tuple(found)

"""Test suites for the test rig as data: a TOML file with a case for each stop (programme.toml in this folder)."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any, Protocol, TypeVar

from fmu_src.suggestion import suggestion
from products.machine import EQUIPMENT, SANDERS, TRACTION, Machine, in_order
from products.protection.rails import RAILS
from products.protection.runs import Fault, Run
from products.protection.settings import FASTEST, MOST_BRAKE_RATIO
from rbd_model.track.friction import CONDITIONS
from rbd_model.track.line import Line, read_line
from readers.text import quoted, shown
from readers.toml_files import toml_of

#: Built-in suites, by their names on the command line: of stops, and of starts.
PROGRAMMES = {"full": Path(__file__).with_name("programme.toml"), "starts": Path(__file__).with_name("starts.toml")}
OWN = PROGRAMMES["full"]
SPEEDS = {"m/s": 1.0, "km/h": 1 / 3.6, "": 1.0}
SPEED = re.compile(r"(\d{1,9}(?:\.\d{0,9})?|\.\d{1,9}) ?(m/s|km/h|)", re.ASCII)
KNOWN = (
    *("name", "group", "source", "rail", "friction", "speed"),
    *("brake_ratio", "load", "values", "fault", "equipment", "line"),
)
#: Upper limits of numbers above 0 [1].
MOST = {"brake_ratio": MOST_BRAKE_RATIO, "friction": 1.0}
#: Limits of the ratio of a body's loaded mass to its own mass [1].
LOADS = (0.2, 5.0)


class HasName(Protocol):
    """An object with a name."""

    @property
    def name(self) -> str:
        """Its name."""
        ...


Named = TypeVar("Named", bound=HasName)


@dataclass(frozen=True)
class Case:
    """A stop of a test suite by its name; rail: name of its condition; load: mass of the body over its own.

    equipment, line: as in `Run`; with traction it is a start, to `speed`. group: what it tests, for criteria. source:
    of its numbers. line_file: path of the line.
    """

    name: str
    rail: str
    friction: float | None = None
    speed: float | None = None
    brake_ratio: float | None = None
    load: float = 1.0
    values: tuple[tuple[str, float], ...] = ()
    faults: tuple[Fault, ...] = ()
    equipment: tuple[str, ...] = ()
    line: Line | None = None
    group: str = ""
    source: str = "assumed"
    line_file: Path | None = None

    def run(self, machine: Machine) -> Run:
        """Return the stop of a vehicle. Raises ValueError for a fault of an unknown wheelset."""
        wheelsets, body = len(machine.numbers), f"{machine.counted}_mass"
        mass = {} if self.load == 1.0 else {body: self.load * machine.parameters.values()[body]}
        for fault in self.faults:
            if fault.wheelset > wheelsets:
                raise ValueError(
                    f"The case {self.name} has a fault of wheelset {fault.wheelset}; there are {wheelsets} here."
                )
        condition = CONDITIONS[self.rail]()
        if self.friction is not None:
            condition = replace(condition, friction=self.friction)
        return Run(
            condition.values(wheelsets) | mass | dict(self.values),
            self.speed,
            self.brake_ratio,
            self.faults,
            self.equipment,
            line=self.line,
        )


def four_rails() -> list[Case]:
    """Return the rails of `products.protection.rails` as cases."""
    names = {make(): name for name, make in CONDITIONS.items()}
    return [Case(rail.name, names[rail.condition], values=rail.changes) for rail in RAILS]


def speed_of(text: str | float) -> float:
    """Return the speed in m/s of 25, "25m/s" or "160 km/h". Raises ValueError."""
    found = SPEED.fullmatch(str(text).strip())
    speed = float(found[1]) * SPEEDS[found[2]] if found else 0.0
    if not 0.0 < speed <= FASTEST:
        raise ValueError(f"speed must be above 0 and at most {FASTEST:g} m/s, as 25m/s or 160km/h; got {shown(text)}.")
    return speed


def read_programme(path: Path) -> list[Case]:
    """Return the cases of a file."""
    cases = named_tables(path, "case", "stop", KNOWN, lambda table: _case(table, path.parent))
    driven = [case.name for case in cases if TRACTION in case.equipment]
    if driven and len(driven) < len(cases):
        raise ValueError(f"{path} mixes starts such as {driven[0]} with stops; give each a file of its own.")
    return cases


def named_tables(
    path: Path, word: str, what: str, known: Sequence[str], read_one: Callable[[Mapping[str, Any]], Named]
) -> list[Named]:
    """Return the objects that the tables [[word]] of a file describe; their names must differ."""
    read = toml_of(path)
    if not isinstance(read.get(word), list) or not read[word]:
        raise ValueError(f"{path} has no [[{word}]]; give it one for each {what}.")
    for name in read:
        if name != word:
            raise ValueError(f"{path}: there is no [{shown(name)}]; call each {what} [[{word}]].")
    found = []
    for number, table in enumerate(read[word], 1):
        try:
            _check_names(table, word, what, known)
            found.append(read_one(table))
        except (ValueError, TypeError) as error:
            name = table.get("name", "without a name") if isinstance(table, dict) else "no table"
            raise ValueError(f"{path}, {word} {number} ({shown(name)}): {error}") from None
    names = [one.name for one in found]
    for name in names:
        if names.count(name) > 1:
            words = f"{names.count(name)} of [[{word}]] are called {shown(name)}"
            raise ValueError(f"{path}: {words}; give each its own name.")
    return found


def _check_names(table: object, word: str, what: str, known: Sequence[str]) -> None:
    if not isinstance(table, dict):
        raise ValueError(f"a {word} must be names with values; got {shown(table)}. Write each {what} as [[{word}]].")
    for name in table:
        if name not in known:
            near = suggestion(str(name), known, f"give some of {', '.join(known)}.")
            raise ValueError(f"there is no {shown(name)}; {near}")
    if not isinstance(table.get("name"), str) or not table["name"].strip():
        raise ValueError("give a name, as in name = 'wet, 120 km/h'.")


def words_in(table: Mapping[str, Any], name: str, default: str) -> str:
    """Return a text of a table. Raises ValueError if it is not a text, or empty."""
    found = table.get(name, default)
    if not isinstance(found, str) or (name in table and not found.strip()):
        raise ValueError(f"{name} must be a text in quotes; got {shown(found) if found else 'nothing'}.")
    return found


def number_of(name: str, value: object) -> float:
    """Return a number of a table. Raises ValueError if it is not one."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        got = quoted(value) if isinstance(value, str) else shown(value)
        raise ValueError(f"{shown(name)} must be a number; got {got}.")
    return float(value)


def _case(table: Mapping[str, Any], folder: Path) -> Case:
    rail = table.get("rail")
    if not isinstance(rail, str) or rail not in CONDITIONS:
        raise ValueError(f"rail must be one of {', '.join(CONDITIONS)}; got {shown(rail or 'nothing')}.")
    numbers = {name: number_of(name, table[name]) for name in MOST if name in table}
    for name, number in numbers.items():
        if not 0.0 < number <= MOST[name]:
            raise ValueError(f"{name} must be above 0 and at most {MOST[name]:g}; got {number:g}.")
    load = number_of("load", table.get("load", 1.0))
    if not LOADS[0] <= load <= LOADS[1]:
        raise ValueError(f"load must be {LOADS[0]:g} to {LOADS[1]:g} times the mass of the body; got {load:g}.")
    if not isinstance(table.get("fault", []), list):
        raise ValueError("give fault a list, [{ wheelset = 1, sensor = ... }].")
    given = table.get("values", {})
    if not isinstance(given, dict):
        raise ValueError("give values names, as in values = { gradient = -0.02 }.")
    values = tuple((name, number_of(name, value)) for name, value in given.items())
    speed = speed_of(table["speed"]) if "speed" in table else None
    faults = tuple(_fault(one) for one in table.get("fault", []))
    equipment = table.get("equipment", [])
    if not isinstance(equipment, list) or not all(isinstance(one, str) for one in equipment):
        raise ValueError(f"give equipment a list of names, some of {', '.join(EQUIPMENT)}.")
    if SANDERS in equipment and not any(name.startswith("sand_rate_") and value for name, value in values):
        raise ValueError("sanders without sand have no effect; set sand_rate_1 or another [kg/s] in values.")
    name = table.get("line", "")
    if "line" in table and not (isinstance(name, str) and name):
        raise ValueError(f"line must be the path of a line file (docs/line.md); got {shown(name)}.")
    line_file = folder / name if name else None
    return Case(
        table["name"],
        rail,
        speed=speed,
        load=load,
        values=values,
        faults=faults,
        equipment=in_order(equipment),
        line=None if line_file is None else read_line(line_file),
        group=words_in(table, "group", ""),
        source=words_in(table, "source", "assumed"),
        line_file=line_file,
        **numbers,
    )


def _fault(table: Mapping[str, Any]) -> Fault:
    if not isinstance(table, dict):
        raise ValueError("give fault a list, [{ wheelset = 1, sensor = ... }].")
    known = [field.name for field in fields(Fault)]
    for name in table:
        if name not in known:
            raise ValueError(f"a fault has no {shown(name)}; give some of {', '.join(known)}.")
    if "wheelset" not in table:
        raise ValueError("a fault needs the number of its wheelset.")
    for name, value in table.items():
        if name != "sensor":
            number_of(name, value)
        elif not isinstance(value, str):
            raise ValueError(f"sensor must be a word; got {shown(value)}.")
    return Fault(**table)

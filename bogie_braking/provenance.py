"""Arguments of public functions as JSON, and back; results state them, so that runs can be repeated.

A number, a text, a list or None is itself. A file is its path as it was given, with a digest of its content. A line, an
input over time is an object with its numbers. Own functions, equations, vehicles as data and long tables are absent:
`{"absent": ...}` states their kind, and the user gives them again by name.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from bogie_braking.histories import History
from fmu_src.kernel import SimulationError
from fmu_src.system import Model, System, Variable
from products.run_history import MOST_NUMBERS, RunHistory, provenance_of
from products.train.numbers import Settings
from products.vehicle_file import read_vehicle
from products.vehicle_sheet import DataSheet
from rbd_model.track.line import Line
from rbd_model.vehicle.description import Vehicle
from readers.documents import is_number
from readers.text import FileError


def encoded(value: Any) -> Any:
    """Return an argument as JSON."""
    if value is None or isinstance(value, str | bool):
        return value
    if isinstance(value, np.bool_ | np.integer):
        return value.item()
    if is_number(value):
        return int(value) if isinstance(value, int) else float(value)
    if isinstance(value, float):
        return {"number": str(float(value))}  # JSON has no infinity and no NaN
    for kind, encode in KINDS.items():
        if isinstance(value, kind):
            return encode(value)
    if hasattr(value, "dist") and type(_distribution(value.dist.name)) is type(value.dist):
        if all(isinstance(number, int | float | np.number) for number in (*value.args, *value.kwds.values())):
            return {"distribution": value.dist.name, "arguments": encoded(value.args), "options": encoded(value.kwds)}
        return absent("a distribution of arrays")
    kind = "class" if isinstance(value, type) else "function" if callable(value) else ""
    return absent(f"the {kind} {getattr(value, '__name__', '')}".strip() if kind else f"a {type(value).__name__}")


def _distribution(name: str) -> Any:
    """Return a distribution of `scipy.stats` by its name, or None."""
    from scipy import stats  # heavy

    found = getattr(stats, name, None)
    return found if isinstance(found, stats.rv_continuous | stats.rv_discrete) else None


def absent(what: str, digest: str = "") -> dict[str, str]:
    """Return the mark of an argument that JSON cannot hold. what: its kind, with an article."""
    return {"absent": what} | ({"digest": digest} if digest else {})


def _of_file(path: Path) -> dict[str, str]:
    return {"file": str(path), "digest": digest_of_file(path)}


def _of_sheet(sheet: DataSheet) -> dict[str, str]:
    if sheet.path is None:
        return absent("a vehicle from a file, changed since it was read")
    return {"file": str(sheet.path), "kind": "vehicle", "digest": sheet.digest}


def _of_line(line: Line) -> dict[str, Any]:
    digest = digest_of_line(line)
    if sum(values.size for values in line.rows.values()) > MOST_NUMBERS:
        return absent("a Line of many rows", digest)
    rows = {name: values.tolist() if np.ptp(values) else float(values[0]) for name, values in line.rows.items()}
    return {"line": rows, "digest": digest}


def _of_history(history: History) -> dict[str, Any]:
    table = history.table
    if table is None:
        return absent("your own function of time")
    if table[0].size > MOST_NUMBERS:
        return absent("a table of many rows", _digest(table[0].tobytes() + table[1].tobytes()))
    return {"times": table[0].tolist(), "values": table[1].tolist()}


def _of_equations(what: Model | System | Vehicle) -> dict[str, str]:
    return absent(f"the {type(what).__name__} {what.name}")


def _of_mapping(values: Mapping[str, Any]) -> dict[str, Any]:
    return {str(name): encoded(value) for name, value in values.items()}


def _of_sequence(values: Sequence[Any]) -> Any:
    return [encoded(value) for value in values] if len(values) <= MOST_NUMBERS else absent("a long list")


#: Functions that encode the kinds of arguments; the first that fits is called.
KINDS: dict[Any, Any] = {
    DataSheet: _of_sheet,
    **dict.fromkeys((Model, System, Vehicle), _of_equations),
    Line: _of_line,
    History: _of_history,
    Path: _of_file,
    Settings: lambda settings: {"settings": asdict(settings)},
    Mapping: _of_mapping,
    list: _of_sequence,
    tuple: _of_sequence,
}


class SimulationHistory(RunHistory):
    """History of a `Simulation`; with one `advance` it is that of `run`."""

    def __init__(self, what: Any, line: Any, identity: str) -> None:
        super().__init__("Simulation", {"what": what, "values": {}, "line": line}, identity)

    def encoded(self, steps: list[list[Any]]) -> dict[str, Any]:
        """Return the provenance of a result after these steps."""
        if [step[0] for step in steps] != ["advance"]:
            return super().encoded(steps)
        advanced = dict(zip(("duration", "interval", "names"), steps[0][1:], strict=True))
        return provenance_of("run", {"what": self.arguments["what"]} | advanced | self.arguments, self.identity)


def encoded_value(value: Any) -> Any:
    """Return a parameter or an input as JSON; a text that names files has their digests."""
    digests = [digest_of_file(path) for path in files_in(value)] if isinstance(value, str) else []
    return {"files": value, "digests": digests} if digests else encoded(value)


def encoded_settings(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Return settings as JSON, by name."""
    return {name: encoded(value) for name, value in settings.items()}


def encoded_values(values: Mapping[str, Any], variables: Mapping[str, Variable]) -> dict[str, Any]:
    """Return parameters and inputs of runs as JSON, by name."""
    found = {}
    for name, value in values.items():
        over_time = name in variables and not (isinstance(value, str | float) or is_number(value))
        try:
            found[name] = encoded_value(History(variables[name], value) if over_time else value)
        except SimulationError:  # each run is refused, with the reason
            found[name] = absent("a refused value")
    return found


def files_in(text: str) -> list[Path]:
    """Return the files that a value names: one, or several with semicolons between them."""
    return [path for path in (Path(part.strip()) for part in text.split(";")) if path.is_file()]


def digest_of_file(path: Path) -> str:
    """Return the digest of the content of a file."""
    about = path.stat()
    return _digest_of_file(str(path.absolute()), about.st_mtime_ns, about.st_size)


@lru_cache(maxsize=64)
def _digest_of_file(path: str, changed: int, size: int) -> str:
    return _digest(Path(path).read_bytes())


def digest_of_line(line: Line) -> str:
    """Return the digest of the rows of a line."""
    return _digest(b"".join(name.encode() + np.asarray(line.rows[name], float).tobytes() for name in sorted(line.rows)))


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:24]


# -- back ------------------------------------------------------------------------------------------------------------


class Decoder:
    """Decodes arguments. source: name in messages; folder: further place of files; given: absent arguments by name."""

    def __init__(self, source: str, folder: Path, given: Mapping[str, Any]) -> None:
        self._source, self._folder, self._given = source, folder, dict(given)
        self._left = set(given)

    def value(self, name: str, value: Any) -> Any:
        """Return an argument by its name. Raises ValueError, FileError."""
        if isinstance(value, list):
            return [self.value(name, one) for one in value]
        if not isinstance(value, Mapping):
            return value
        if name in self._given and ("absent" in value or "file" in value):
            self._left.discard(name)
            given = self._given[name]
            if "file" in value and isinstance(given, str | Path):
                return self._file({**value, "file": str(given)})
            return self._checked(name, given, value)
        if "absent" in value:
            raise ValueError(
                f"{self._source} cannot hold {name}, which was {value['absent']}. Give it: "
                f"bb.repeat({self._source!r}, {name}=...)."
            )
        kinds: dict[str, Callable[[Mapping[str, Any]], Any]] = {
            "line": self._line,
            "times": self._table,
            "settings": self._settings,
            "distribution": self._distribution,
            "number": lambda value: float(value["number"]),
        }
        for kind, decode in kinds.items():
            if kind in value:
                return decode(value)
        if "files" in value:
            return ";".join(self._files(value))
        if "file" in value:
            return self._file(value)
        return {key: self.value(key, one) for key, one in value.items()}

    def check_used(self) -> None:
        """Raise ValueError if a given argument is not one of the run."""
        if self._left:
            raise ValueError(f"{min(self._left)} must be an argument that {self._source} cannot hold. Leave it out.")

    def _line(self, value: Mapping[str, Any]) -> Line:
        count = len(value["line"]["distance"])
        return Line({name: np.broadcast_to(np.array(rows, float), count) for name, rows in value["line"].items()})

    def _table(self, value: Mapping[str, Any]) -> tuple[np.ndarray, np.ndarray]:
        return np.array(value["times"], float), np.array(value["values"], float)

    def _settings(self, value: Mapping[str, Any]) -> Settings:
        return Settings(**value["settings"])

    def _distribution(self, value: Mapping[str, Any]) -> Any:
        found = _distribution(value["distribution"])
        if found is None:
            raise FileError(f"{self._source} must name a distribution of scipy.stats; got {value['distribution']!r}.")
        arguments, options = (self.value("distributions", value[part]) for part in ("arguments", "options"))
        return found(*arguments, **options)

    def _files(self, value: Mapping[str, Any]) -> list[str]:
        paths = [self._found(part.strip()) for part in value["files"].split(";")]
        for path, digest in zip(paths, value["digests"], strict=True):
            self._check(str(path), digest_of_file(path), digest)
        return list(map(str, paths))

    def _file(self, value: Mapping[str, Any]) -> Path | DataSheet:
        path = self._found(value["file"])
        if value.get("kind") == "vehicle":
            return self._checked(str(path), read_vehicle(path), value)
        self._check(str(path), digest_of_file(path), value["digest"])
        return path

    def _checked(self, name: str, given: Any, value: Mapping[str, Any]) -> Any:
        """Return a given argument if its digest is that of the run. Raises FileError."""
        digest = value.get("digest", "")
        if isinstance(given, DataSheet):
            digest = given.digest
        elif isinstance(given, Line):
            digest = digest_of_line(given)
        self._check(name, digest, value.get("digest", ""))
        return given

    def _found(self, path: str) -> Path:
        places = [Path(path), self._folder / path, self._folder / Path(path).name]
        there = next((place for place in places if place.is_file()), None)
        if there is None:
            raise FileError(f"{self._source} needs the file {path}, which does not exist here. Put it beside it.")
        return there

    def _check(self, name: str, digest: str, due: str) -> None:
        if digest != due:
            raise FileError(
                f"{name} must have the content that it had in the run of {self._source}, digest {due}; got {digest}. "
                "Restore it."
            )

"""The journal of a sweep: a head line that says what is swept, then a line for each finished point, on disk at once."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from types import TracebackType
from typing import Any

from scenarios.scenario import BadInputError
from scenarios.sweep.points import Outcome, Point

#: Its name in the folder of a sweep.
JOURNAL = "journal.jsonl"
#: What to do where it is not of the sweep that is asked for.
ADVICE = "Give another --out and both stay; --restart begins anew in its place."


class Journal:
    """The finished points of one sweep, kept in a file; as a context manager it is open for more of them.

    restart: nothing of an earlier file counts, and opening drops it. Raises BadInputError where the file belongs to
    another sweep or cannot be read. A half-written last line is dropped.
    """

    def __init__(self, path: Path, head: Mapping[str, Any], points: int, restart: bool = False) -> None:
        self._path, self._head = path, head
        self._whole = [] if restart else _whole_lines(path)
        if self._whole:
            _check_head(path, _parse(path, 1, self._whole[0]), json.loads(json.dumps(head)))
        self.outcomes = dict(_outcome(path, line, text, points) for line, text in enumerate(self._whole[1:], 2))

    def __enter__(self) -> Journal:
        self._path.parent.mkdir(parents=True, exist_ok=True)
        self._file = self._path.open("ab")
        self._file.truncate(sum(len(text) for text in self._whole))
        if not self._whole:
            self._append(self._head)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.close()

    def add(self, number: int, point: Point, outcome: Outcome) -> None:
        """Keeps a finished point; when this returns it survives even a loss of power."""
        answer = {"results": outcome.results} if outcome.failure is None else {"failure": outcome.failure}
        self._append({"point": number, "parameters": point, **answer})
        self.outcomes[number] = outcome

    def _append(self, line: Mapping[str, Any]) -> None:
        self._file.write(json.dumps(line, allow_nan=False).encode() + b"\n")
        self._file.flush()
        os.fsync(self._file.fileno())


def _whole_lines(path: Path) -> list[bytes]:
    """Lines that were written to their end; none where there is no journal."""
    if not path.exists():
        return []
    return [text for text in path.read_bytes().splitlines(keepends=True) if text.endswith(b"\n")]


def _parse(path: Path, line: int, text: bytes) -> dict[str, Any]:
    try:
        found = json.loads(text)
    except ValueError:
        found = None
    if not isinstance(found, dict):
        raise BadInputError(f"{path}, line {line} cannot be read. {ADVICE}")
    return found


def _outcome(path: Path, line: int, text: bytes, points: int) -> tuple[int, Outcome]:
    """A finished point by its number."""
    found = _parse(path, line, text)
    number, results, failure = found.get("point"), found.get("results"), found.get("failure")
    known = isinstance(number, int) and 0 <= number < points
    if not (known and isinstance(results, dict) != isinstance(failure, str)):
        raise BadInputError(f"{path}, line {line} is no point of this sweep. {ADVICE}")
    return int(found["point"]), Outcome(results, failure)


def _check_head(path: Path, old: Mapping[str, Any], new: Mapping[str, Any]) -> None:
    """Says what differs between the sweep of the journal and the one that is asked for."""
    differences = []
    for key in _names(new, old):
        was, now = old.get(key), new.get(key)
        if not (isinstance(was, dict) and isinstance(now, dict)):
            differences += [f"{key} ({_short(was)}, now {_short(now)})"] if was != now else []
            continue
        for name in _names(now, was):
            if was.get(name) != now.get(name):
                differences.append(f"{key} {name} ({_short(was.get(name))}, now {_short(now.get(name))})")
        if was == now and list(was) != list(now):  # the numbers of the points hang on it
            differences.append(f"the order of {key} ({', '.join(was)}, now {', '.join(now)})")
    if differences:
        raise BadInputError(f"{path} belongs to another sweep; different: {'; '.join(differences)}. {ADVICE}")


def _names(first: Iterable[str], second: Iterable[str]) -> list[str]:
    """Names of both, each once."""
    return list(dict.fromkeys([*first, *second]))


def _short(value: object) -> str:
    """A value of the head for a sentence."""
    if value is None:
        return "absent"
    if isinstance(value, list) and len(value) > 3:
        return f"{value[0]} to {value[-1]}, {len(value)} values"
    return ", ".join(map(str, value)) if isinstance(value, list) else str(value)

"""The folder of a sweep: one writer at a time, and the event log of its finished points."""

from __future__ import annotations

import json
import os
import platform
import sys
import time
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from products.study.points import Outcome, Point, SweepError
from readers.storage import hold, sync_folder
from readers.text import BadInputError

#: Its name in the folder of a sweep.
JOURNAL = "journal.jsonl"
#: Version of its lines.
FORM = 4
#: Remedy if it belongs to another sweep.
ADVICE = "Give another --out and both stay; --restart begins anew in its place."
#: The file that is locked; it says who holds it and stays behind.
LOCK = ".lock"


class Journal:
    """The finished points of one sweep in lines of JSON; as a context manager it is open for more of them.

    The first line describes the sweep. points: of the sweep, by their numbers. results: their names. cut: whether a
    killed process left the last line incomplete, which is then dropped.

    Raises BadInputError if the file belongs to another sweep, or if a line is damaged.
    """

    def __init__(self, path: Path, head: Mapping[str, Any], points: Sequence[Point], results: Collection[str]) -> None:
        self._path, self._points, self._results = path, points, results
        self._head = json.loads(json.dumps({"journal": FORM, **head}))
        self._length, self.cut = 0, False
        self.outcomes: dict[int, Outcome] = {}
        if path.exists():
            self._read()

    def _read(self) -> None:
        """Read the file up to the last complete line."""
        with self._path.open("rb") as file:
            for number, text in enumerate(file, 1):
                whole = text.endswith(b"\n")
                if not whole and (number > 1 or json.dumps(self._head).encode().startswith(text)):
                    self.cut = True
                    return
                self._length += len(text)
                differences: list[str] = []
                try:
                    if not whole:
                        raise ValueError  # the line of another program
                    if number == 1:
                        differences = list(_differences(json.loads(text), self._head))
                    else:
                        self._keep(json.loads(text))
                except (AttributeError, KeyError, TypeError, ValueError, RecursionError):
                    remedy = "Delete this line, and the points are computed again. " if number > 1 else ""
                    raise BadInputError(
                        f"{self._path}, line {number} must be as it was written; got a damaged one. {remedy}{ADVICE}"
                    ) from None
                if differences:
                    raise BadInputError(
                        f"{self._path} belongs to another sweep; different: {'; '.join(differences)}. {ADVICE}"
                    )

    def _keep(self, line: Mapping[str, Any]) -> None:
        """Keep the outcome that a line holds. Raises KeyError, TypeError or ValueError if it is not of its point."""
        number = line["point"]
        if not 0 <= number < len(self._points) or line["parameters"] != self._points[number]:
            raise ValueError
        point = self._points[number]
        if "failure" in line:
            self.outcomes[number] = Outcome(failure=line["failure"], point=point)
        else:
            results = {name: line["results"][name] for name in self._results}
            self.outcomes[number] = Outcome(results, point=point, message=line.get("message", ""))

    def __enter__(self) -> Journal:
        self._file = self._path.open("ab")
        self._file.truncate(self._length)
        return self

    def __exit__(self, *error: object) -> None:
        self._file.close()

    def add(self, outcomes: Mapping[int, Outcome]) -> None:
        """Store finished points; when this returns, they survive a loss of power.

        Raises SweepError if the file was moved or deleted.
        """
        here = os.fstat(self._file.fileno())
        if not (self._path.exists() and os.path.samestat(here, self._path.stat())):
            raise SweepError(f"{self._path} must stay while the sweep runs; it was moved or deleted. Start it again.")
        lines = [self._line(number, outcome) for number, outcome in outcomes.items()]
        begins = here.st_size == 0
        self._file.write(b"".join(json.dumps(line).encode() + b"\n" for line in [self._head] * begins + lines))
        self._file.flush()
        os.fsync(self._file.fileno())
        if begins:
            sync_folder(self._path.parent)
        self.outcomes.update(outcomes)

    def _line(self, number: int, outcome: Outcome) -> dict[str, Any]:
        line: dict[str, Any] = {"point": number, "parameters": self._points[number]}
        if outcome.failure is not None:
            return line | {"failure": outcome.failure}
        return line | {"results": outcome.results} | ({"message": outcome.message} if outcome.message else {})


def _differences(old: Mapping[str, Any], new: Mapping[str, Any], group: str = "") -> Iterator[str]:
    """Yield the differences between two heads, in words."""
    for name in {**new, **old}:
        was, now = old.get(name), new.get(name)
        if isinstance(was, dict) and isinstance(now, dict):
            yield from _differences(was, now, f"{name} ")
            if was == now and list(was) != list(now):  # the numbers of the points depend on it
                yield f"the order of {name} ({', '.join(was)}, now {', '.join(now)})"
        elif was != now:
            yield f"{group}{name} ({_short(was)}, now {_short(now)})"


def _short(value: object) -> str:
    """Return a value of the head for a message."""
    if value is None:
        return "absent"
    if isinstance(value, list) and len(value) > 3:
        return f"{value[0]} to {value[-1]}, {len(value)} values"
    return ", ".join(map(str, value)) if isinstance(value, list) else str(value)


@contextmanager
def only_writer(folder: Path) -> Iterator[None]:
    """Make a folder, and hold it for one process until the end. Raises BadInputError while another one has it.

    The lock is one of the operating system: it ends with its process, also when that is killed.
    """
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / LOCK
    with path.open("a+b") as file:
        try:
            hold(file.fileno(), wait=False)
        except BlockingIOError:
            holder = path.read_text() or "another process holds it"
            raise BadInputError(
                f"{folder} must have one sweep at a time; got a second one while {holder}. Wait for its end, or "
                "give another --out."
            ) from None
        except OSError as error:
            print(f"{folder} cannot be locked ({error.strerror}); start no second sweep there.", file=sys.stderr)
        since = time.strftime("%Y-%m-%d %H:%M:%S %z")
        file.truncate(0)
        file.write(f"process {os.getpid()} on {platform.node()} has held it since {since}".encode())
        file.flush()
        yield

"""The log of a sweep.

A head line that describes the sweep, then a line for each finished point, written to disk at once. Each line ends with
a digest of the line and of the head. Lines of other sweeps, and lines that were cut, joined or edited are refused by
their number. Only the last line may be cut off, by a killed process.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any, BinaryIO

from products.study.points import Outcome, Point, SweepError
from readers.documents import LARGEST, document, integer_in, is_number, mapping_in, text_in
from readers.storage import sync_folder
from readers.text import BadInputError, shown

#: Its name in the folder of a sweep.
JOURNAL = "journal.jsonl"
#: Version of its lines.
FORM = 3
#: Remedy if it belongs to another sweep.
ADVICE = "Give another --out and both stay; --restart begins anew in its place."
#: Infinite results, by their strings in a line: JSON has no number for them.
INFINITE = {"inf": math.inf, "-inf": -math.inf}
#: Largest count of damaged lines whose numbers a message lists.
TOLD = 5


class Journal:
    """The finished points of one sweep, kept in a file; as a context manager it is open for more of them.

    points: of the sweep, by their numbers. results: their names. cut: whether the last line was cut
    off, which is then dropped.

    Raises BadInputError if the file belongs to another sweep, or if a line is damaged or not of its point.
    """

    def __init__(self, path: Path, head: Mapping[str, Any], points: Sequence[Point], results: Collection[str]) -> None:
        self._path, self._points, self._results = path, points, results
        self._head = checked({"journal": FORM, **json.loads(json.dumps(head))}, "")
        self._length, self.cut = 0, False
        self.outcomes: dict[int, Outcome] = {}
        if path.exists():
            self._read()

    def _read(self) -> None:
        """Read the file."""
        if not self._path.is_file():
            raise BadInputError(f"{self._path} must be a file; got a folder or a device. {ADVICE}")
        damaged: dict[int, str] = {}
        first: dict[int, int] = {}
        with self._path.open("rb") as file:
            for line, text in enumerate(self._whole_lines(file), 1):
                try:
                    if line == 1:
                        self._check_head(text)
                        continue
                    number, outcome = self._outcome(document(text, f"line {line}"), f"line {line}")
                    if self.outcomes.setdefault(number, outcome) != outcome:
                        raise ValueError(f"line {line} must agree with line {first[number]}; got other results.")
                    first.setdefault(number, line)
                except ValueError as error:
                    if isinstance(error, BadInputError):
                        raise
                    damaged[line] = str(error)
                    if len(damaged) > TOLD + 1:
                        break
        if damaged:
            raise BadInputError(self._told(damaged))

    def _whole_lines(self, file: BinaryIO) -> Iterator[bytes]:
        """Yield complete lines, one at a time."""
        while text := file.readline(LARGEST + 2):
            if text.endswith(b"\n"):
                self._length += len(text)
                yield text
            elif len(text) > LARGEST:
                yield text  # too long for a line, which `document` says
                return
            else:
                self._check_cut(text)
                self.cut = True

    def _check_cut(self, text: bytes) -> None:
        """A head that was cut off is the beginning of this sweep's; another one is not ours to drop."""
        if self._length == 0 and not line_of(self._head).startswith(text):
            raise BadInputError(
                f"{self._path} must begin with the head of this sweep; got {shown(text.decode(errors='replace'))}. "
                f"{ADVICE}"
            )

    def _check_head(self, text: bytes) -> None:
        """Raise BadInputError with the differences between the head of the file and that of this sweep."""
        try:
            old = document(text, "line 1")
            check_of(old, "", "line 1")
        except ValueError as error:
            raise BadInputError(self._told({1: str(error)})) from None
        if differences := list(_differences(old, self._head)):
            raise BadInputError(f"{self._path} belongs to another sweep; different: {'; '.join(differences)}. {ADVICE}")

    def _outcome(self, found: Any, what: str) -> tuple[int, Outcome]:
        """A finished point by its number. Raises ValueError for a line that is not of this sweep and its point."""
        check_of(found, self._head["check"], what)
        number = integer_in(found, "point", what, 0, len(self._points) - 1)
        point, given = self._points[number], mapping_in(found, "parameters", what)
        if given != point or not all(isinstance(value, float) for value in given.values()):
            raise ValueError(f"{what} must have the parameters of point {number}, {shown(point)}; got {shown(given)}.")
        if set(found) - {"point", "parameters", "check"} not in ({"results"}, {"results", "message"}, {"failure"}):
            raise ValueError(f"{what} must have results or failure; got {shown(', '.join(found))}.")
        if "failure" in found:
            return number, Outcome(failure=text_in(found, "failure", what), point=point)
        results = mapping_in(found, "results", what)
        if set(results) != set(self._results):
            names = ", ".join(self._results)
            raise ValueError(f"{what} must have the results {names}; got {shown(', '.join(results) or 'none')}.")
        for name, value in results.items():
            if not (value is None or is_number(value) or (isinstance(value, str) and value in INFINITE)):
                raise ValueError(f"{what}: {name} must be a number, null, inf or -inf; got {shown(value)}.")
        numbers = {name: None if results[name] is None else float(results[name]) for name in self._results}
        return number, Outcome(
            numbers, point=point, message=text_in(found, "message", what) if "message" in found else ""
        )

    def _told(self, damaged: Mapping[int, str]) -> str:
        """Return one message on all damaged lines."""
        line, reason = next(iter(damaged.items()))
        others = [str(one) for one in damaged if one != line]
        few = ", ".join(others[:TOLD]) + (" and more" if len(others) > TOLD else "")
        also = f" Damaged too: {'line' if len(others) == 1 else 'lines'} {few}." if others else ""
        remedy = f"Delete {'these lines' if others else 'this line'}, and the points are computed again. "
        return f"{self._path}, {reason}{also} {remedy if line > 1 else ''}{ADVICE}"

    def __enter__(self) -> Journal:
        self._path.parent.mkdir(parents=True, exist_ok=True)
        self._file = self._path.open("ab", buffering=0)
        try:
            self._file.truncate(self._length)
            if self._length == 0:
                self._append(self._head)
                sync_folder(self._path.parent)
        except BaseException:
            self._file.close()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.close()

    def add(self, outcomes: Mapping[int, Outcome]) -> None:
        """Store finished points; when this returns, they survive a loss of power.

        Raises SweepError if the file was moved or deleted.
        """
        self._append(*(self._line(number, outcome) for number, outcome in outcomes.items()))
        self.outcomes.update(outcomes)

    def _line(self, number: int, outcome: Outcome) -> dict[str, Any]:
        answer: dict[str, Any] = {"failure": outcome.failure}
        if outcome.failure is None:
            texts: dict[float | None, str] = {value: text for text, value in INFINITE.items()}
            results = {name: texts.get(value, value) for name, value in (outcome.results or {}).items()}
            answer = {"results": results} | ({"message": outcome.message} if outcome.message else {})
        return checked({"point": number, "parameters": self._points[number], **answer}, self._head["check"])

    def _append(self, *lines: Mapping[str, Any]) -> None:
        """Writes lines to their end; where there is no room for them, none stays. Raises OSError, SweepError."""
        here = os.fstat(self._file.fileno())
        if not (self._path.exists() and os.path.samestat(here, self._path.stat())):
            raise SweepError(f"{self._path} must stay while the sweep runs; it was moved or deleted. Start it again.")
        text = b"".join(map(line_of, lines))
        try:
            written = 0
            while written < len(text):
                written += self._file.write(text[written:])
            os.fsync(self._file.fileno())
        except OSError:
            with suppress(OSError):
                self._file.truncate(self._length)
            raise
        self._length += len(text)


def line_of(line: Mapping[str, Any]) -> bytes:
    """Return the text of a line."""
    return json.dumps(line, allow_nan=False).encode() + b"\n"


def checked(line: Mapping[str, Any], head: str) -> dict[str, Any]:
    """Return a line with its check at its end. head: the check of the head, empty for the head itself."""
    return {**line, "check": hashlib.sha256(head.encode() + line_of(line)).hexdigest()[:16]}


def check_of(found: Any, head: str, what: str) -> None:
    """Raise ValueError if the check of a line is not that of its contents."""
    own = text_in(found, "check", what)
    if checked({name: value for name, value in found.items() if name != "check"}, head)["check"] != own:
        raise ValueError(f"{what} must be as it was written; got a line that its check does not fit.")


def _differences(old: Mapping[str, Any], new: Mapping[str, Any]) -> Iterator[str]:
    """Yield the differences between two heads, in words."""
    for key in _names(new, old):
        was, now = old.get(key), new.get(key)
        if key == "check":
            continue
        if not (isinstance(was, dict) and isinstance(now, dict)):
            if was != now:
                yield f"{key} ({_short(was)}, now {_short(now)})"
            continue
        for name in _names(now, was):
            if was.get(name) != now.get(name):
                yield f"{key} {name} ({_short(was.get(name))}, now {_short(now.get(name))})"
        if was == now and list(was) != list(now):  # the numbers of the points depend on it
            yield f"the order of {key} ({', '.join(was)}, now {', '.join(now)})"


def _names(first: Iterable[str], second: Iterable[str]) -> list[str]:
    """Return the names of both, each once."""
    return list(dict.fromkeys([*first, *second]))


def _short(value: object) -> str:
    """Return a value of the head for a message."""
    if value is None:
        return "absent"
    if isinstance(value, list) and len(value) > 3:
        return f"{value[0]} to {value[-1]}, {len(value)} values"
    return ", ".join(map(str, value)) if isinstance(value, list) else str(value)

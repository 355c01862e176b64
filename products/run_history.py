"""Provenance of results: function, arguments and later steps of a run, as JSON by which it is repeated."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from fmu_src import __version__
from products.sources import sources_of_process

#: Largest numbers of steps and of numbers; longer histories are not kept.
MOST_STEPS, MOST_NUMBERS = 5_000, 10_000


class RunHistory:
    """Arguments of a function as JSON, and the steps of its result since then.

    function: its public name. identity: digest of the equations or vehicles, to be compared; empty: not needed.
    """

    def __init__(self, function: str, arguments: Mapping[str, Any], identity: str = "") -> None:
        self.function, self.arguments, self.identity = function, dict(arguments), identity
        self.steps: list[list[Any]] = []
        self.unrepeatable = ""
        self._numbers = 0
        sources_of_process()  # those of the modules that are loaded now

    def set(self, name: str, value: Any) -> None:
        """Add a value that was set: to the arguments at the start, later as a step."""
        if not self.steps:
            self.arguments.setdefault("values", {})[name] = value
        elif self.steps[-1][0] == "set":
            self.steps[-1][1][name] = value
        else:
            self.add("set", {name: value})

    def add(self, step: str, *arguments: Any, numbers: int = 1) -> None:
        """Add a step; numbers: how many it holds."""
        if self.unrepeatable:
            return
        self._numbers += numbers
        if len(self.steps) >= MOST_STEPS or self._numbers > MOST_NUMBERS:
            self.discard(f"it has more than {MOST_STEPS} steps or {MOST_NUMBERS} numbers")
        else:
            self.steps.append([step, *arguments])

    def discard(self, reason: str) -> None:
        """State the reason why the run cannot be repeated from here on."""
        self.unrepeatable = self.unrepeatable or reason

    def snapshot(self) -> Callable[[], dict[str, Any]]:
        """Return a function that returns the provenance up to now."""
        return partial(self._provenance, len(self.steps), self.unrepeatable)

    def _provenance(self, count: int, unrepeatable: str) -> dict[str, Any]:
        return self.encoded(self.steps[:count]) | ({"unrepeatable": unrepeatable} if unrepeatable else {})

    def encoded(self, steps: list[list[Any]]) -> dict[str, Any]:
        """Return the provenance of a result after these steps."""
        return provenance_of(self.function, self.arguments, self.identity) | {"steps": steps}


def provenance_of(function: str, arguments: Mapping[str, Any], identity: str = "") -> dict[str, Any]:
    """Return the provenance of a result: function, version, digest of the sources, and arguments as JSON."""
    about = {"function": function, "version": __version__, "sources": sources_of_process()}
    return about | ({"identity": identity} if identity else {}) | {"arguments": dict(arguments)}

"""What a scenario is, and the FMUs that all of them use."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from build_fmu import up_to_date
from scenarios.cosimulation import Slave
from scenarios.report import Result


class BadInputError(ValueError):
    """Something the user gave cannot be used; the text says what, and what to do."""


@dataclass(frozen=True)
class Options:
    """What the command line can choose."""

    kind: str = "native"
    step: float = 1e-3
    torque_csv: Path | None = None


@dataclass(frozen=True)
class Scenario:
    """One experiment: a name, what it shows, and a function that runs it."""

    name: str
    summary: str
    run: Callable[[Options], Result]
    takes_torque_csv: bool = False


def open_bogie(options: Options, **parameters: float) -> Slave:
    return Slave(up_to_date("bogie", options.kind), **parameters)


def open_brake(options: Options, **parameters: float) -> Slave:
    return Slave(up_to_date("brake", options.kind), **parameters)


def of_fmu(values: dict[str, float], slave_names: set[str]) -> dict[str, float]:
    """The entries of a parameter set that the FMU has; a level does not need them all."""
    return {name: value for name, value in values.items() if name in slave_names}

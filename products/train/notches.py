"""Notches of driver's valves by the names that drivers use: the one table of them, drivers_valves.toml."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from difflib import get_close_matches
from functools import lru_cache
from pathlib import Path
from typing import Any

from brake_controller.drivers_valve import POSITIONS, DriversValve
from brake_controller.vacuum_valve import VacuumValve
from readers.column_words import plain
from readers.quantity import number_in
from readers.text import quoted
from readers.toml_files import toml_of

#: Values of driver_position and driver_step.
Inputs = tuple[int, float]
#: The table.
TABLE = Path(__file__).with_name("drivers_valves.toml")
#: The pipe of a handle of any valve, and this handle, which a page shows without another one.
ANY, FEW = "any", "self-lapping"
#: Rounding of a step.
ROUNDING = 1e-9


@dataclass(frozen=True)
class Notch:
    """A notch: its names, its position, and the step of a service [1] or the fall of the pipe [Pa] that belongs to it.

    A service without both has the step that the driver gives.
    """

    names: tuple[str, ...]
    position: str
    step: float | None = None
    reduction: float | None = None

    @property
    def is_service(self) -> bool:
        """True if it has a step of its own."""
        return self.step is not None or self.reduction is not None

    def step_of(self, valve: DriversValve | VacuumValve) -> float:
        """Return the input driver_step of a valve [1]. Raises ValueError if its service has no such fall."""
        if self.reduction is None:
            return self.step or 0.0
        first, full = valve.first_step, valve.full_service
        step = (self.reduction - first) / (full - first)
        if not -ROUNDING <= step <= 1.0 + ROUNDING:
            raise ValueError(
                f"The notch {quoted(self.names[0])} must be a service from {1e-5 * first:.4g} to {1e-5 * full:.4g} bar "
                f"of this valve; got {1e-5 * self.reduction:.4g} bar. Take another notch."
            )
        return min(max(step, 0.0), 1.0)


@dataclass(frozen=True)
class Handle:
    """The handle of a driver's valve: its name, what its pipe holds (air, vacuum or any), its notches, their source."""

    name: str
    pipe: str
    source: str
    notches: tuple[Notch, ...]


def _notch(row: Mapping[str, Any]) -> Notch:
    reduction = number_in(row["reduction"], "Pa") if "reduction" in row else None
    return Notch(tuple(row["names"]), row.get("position", "service"), row.get("step"), reduction)


@lru_cache
def handles() -> dict[str, Handle]:
    """Return the handles by their names."""
    read = toml_of(TABLE)["valve"]
    found = [Handle(one["name"], one["pipe"], one["source"], tuple(map(_notch, one["notches"]))) for one in read]
    return {handle.name: handle for handle in found}


def check_handle(name: str, valve: DriversValve | VacuumValve) -> None:
    """Check that a handle exists and is of such a valve. Raises ValueError."""
    if name not in handles():
        raise ValueError(f"handle must be one of {', '.join(handles())}; got {name!r}. Choose one.")
    pipe = "vacuum" if isinstance(valve, VacuumValve) else "air"
    if handles()[name].pipe not in (pipe, ANY):
        fitting = ", ".join(one.name for one in handles().values() if one.pipe in (pipe, ANY))
        raise ValueError(f"handle must be of a pipe that holds {pipe}, {fitting}; got {name}. Choose one.")


def notch_named(name: str, handle: str) -> Notch | None:
    """Return the position, or the notch of a handle, with a name; None without one. An empty handle has positions."""
    if name in POSITIONS:
        return Notch((name,), name)
    own = handles()[handle].notches if handle else ()
    return next((notch for notch in own if plain(name) in map(plain, notch.names)), None)


def _nearest(name: str, handle: str) -> str:
    """Return the remedy for an unknown notch: the position or notch of the handle with the nearest name."""
    notches = handles()[handle].notches if handle else ()
    names = {plain(one): one for one in (*POSITIONS, *(one for notch in notches for one in notch.names))}
    near = get_close_matches(plain(name), list(names), 1)
    return f" Did you mean {names[near[0]]}?" if near else " Choose one."


def driven(name: str, step: float, valve: DriversValve | VacuumValve, handle: str) -> Inputs:
    """Return the inputs driver_position and driver_step of a notch or position of a valve.

    Raises ValueError for an unknown name, with those that there are, and for a step that the notch has itself.
    """
    if handle:
        check_handle(handle, valve)
    text = name if isinstance(name, str) else ""
    notch = notch_named(text, handle)
    if notch is None:
        names = [one.names[0] for one in handles()[handle].notches] if handle else list(POSITIONS)
        of = [one for one in handles() if one != handle and notch_named(text, one)]
        remedy = f" {quoted(name)} is a notch of {of[0]}: give handle = {of[0]}." if of else _nearest(text, handle)
        raise ValueError(f"A driver's valve must be set to one of {', '.join(names)}; got {name}.{remedy}")
    if notch.is_service and step:
        raise ValueError(
            f"step must be left out with the notch {quoted(notch.names[0])}, which has its own; got {step:g}. Omit it."
        )
    return POSITIONS[notch.position], notch.step_of(valve) if notch.is_service else step


def notches_shown(valve: DriversValve | VacuumValve, handle: str = FEW, by_wire: bool = False) -> dict[str, Inputs]:
    """Return the inputs of the notches of a handle, from release to emergency, by their first names.

    Without notches whose step the driver gives or the valve does not have, and those that service by wire refuses.
    """
    found: dict[str, Inputs] = {}
    for notch in handles()[handle].notches:
        if notch.position == "service" and not notch.is_service:
            continue
        if by_wire and POSITIONS[notch.position] > POSITIONS["emergency"]:
            continue
        with suppress(ValueError):
            found[notch.names[0]] = POSITIONS[notch.position], notch.step_of(valve)
    return found

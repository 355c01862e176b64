"""Tolerances and failures of a train's brake by name, with units and limits."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, replace
from typing import Any

from readers.text import BadInputError, shown


@dataclass(frozen=True)
class Entry:
    """A tolerance or a failure: unit in files, limits [1 or s], meaning."""

    unit: str
    most: float
    text: str
    least: float = 0.0


#: Largest standard deviation [1], probability [1], and delay [s].
MOST_SPREAD, MOST_FAILURES, MOST_DELAY = 0.2, 0.5, 10.0
#: Entries that do not weaken the brake by themselves.
NO_CAUSES = ("noticed", "units", "delay", "delay_common")


def _entry(unit: str, most: float, text: str, least: float = 0.0) -> Any:
    """Return a field with its entry, whose default is the least number."""
    return field(default=least, metadata={"entry": Entry(unit, most, text, least)})


@dataclass(frozen=True)
class Tolerances:
    """Tolerances and failures of a train's brake; the default is a brake that always has its nominal force.

    Parameters
    ----------
    friction, friction_common : float
        Standard deviation of the friction of blocks and pads over its nominal value: of a vehicle, and of all vehicles
        together.
    cylinder_force, efficiency : float
        Standard deviation of the cylinder force and of the rigging's efficiency of a vehicle.
    wheel_diameter : float
        Standard deviation of the wheel diameter of a vehicle with discs. Blocks brake at the tread, at any diameter.
    spread, common : float
        Standard deviation by any other cause: of a vehicle, and of all vehicles together.
    mass, mass_common : float
        Standard deviation of the mass of a vehicle, and of the train.
    isolated, noticed : float
        Probability that the distributor of a vehicle is isolated before the trip, and the share of these that the brake
        test notices. Train data without the noticed ones are right, so these do not lower the factor.
    lost, units : float, int
        Probability that a unit of a vehicle does not brake at the demand, and the number of equal units of a vehicle.
    delay, delay_common : float
        Standard deviation of the build-up time of a vehicle, and of the train [s].

    Raises
    ------
    BadInputError
        If a number is outside its limits, see ENTRIES.
    """

    friction: float = _entry("%", MOST_SPREAD, "friction of a vehicle's blocks or pads")
    friction_common: float = _entry("%", MOST_SPREAD, "friction of all blocks or pads together")
    cylinder_force: float = _entry("%", MOST_SPREAD, "cylinder force of a vehicle")
    efficiency: float = _entry("%", MOST_SPREAD, "efficiency of a vehicle's rigging")
    wheel_diameter: float = _entry("%", MOST_SPREAD, "wheel diameter of a vehicle with discs")
    spread: float = _entry("%", MOST_SPREAD, "other causes in a vehicle")
    common: float = _entry("%", MOST_SPREAD, "other causes in all vehicles together")
    mass: float = _entry("%", MOST_SPREAD, "mass of a vehicle")
    mass_common: float = _entry("%", MOST_SPREAD, "mass of the train")
    isolated: float = _entry("%", MOST_FAILURES, "distributors isolated before the trip")
    noticed: float = _entry("%", 1.0, "isolated distributors that the brake test notices")
    lost: float = _entry("%", MOST_FAILURES, "units lost at the demand")
    units: int = _entry("1", 16, "units of a vehicle", 1)
    delay: float = _entry("s", MOST_DELAY, "build-up time of a vehicle")
    delay_common: float = _entry("s", MOST_DELAY, "build-up time of the train")

    def __post_init__(self) -> None:
        for name, entry in ENTRIES.items():
            check(name, getattr(self, name), entry)
        if self.noticed and not self.isolated:
            raise BadInputError("noticed is a share of the isolated distributors; got no isolated. Give both.")
        if self.units > 1 and not self.lost:
            raise BadInputError("units counts what may be lost; got no lost. Give both.")

    @property
    def causes(self) -> list[str]:
        """Return the names of the given causes of a weaker brake."""
        return [name for name in ENTRIES if name not in NO_CAUSES and getattr(self, name)]

    def without(self, name: str) -> Tolerances:
        """Return the same without one cause."""
        if not isinstance(name, str) or name not in self.causes:
            raise BadInputError(f"name must be one of the given causes, {', '.join(self.causes)}; got {shown(name)}.")
        given: dict[str, Any] = {name: 0.0}
        given |= {"noticed": 0.0} if name == "isolated" else {"units": 1} if name == "lost" else {}
        return replace(self, **given)


ENTRIES: dict[str, Entry] = {one.name: one.metadata["entry"] for one in fields(Tolerances)}


def check(name: str, value: object, entry: Entry) -> None:
    """Raise BadInputError if a value is not a number within the limits of its entry."""
    number = isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
    whole = entry.unit != "1" or (number and float(value) == math.floor(float(value)))  # type: ignore[arg-type]
    if number and whole and entry.least <= float(value) <= entry.most:  # type: ignore[arg-type]
        return
    kind = "an integer from" if entry.unit == "1" else "from"
    unit = " s" if entry.unit == "s" else ""
    hint = " Give 0.05 for 5 %." if entry.unit == "%" else ""
    raise BadInputError(f"{name} must be {kind} {entry.least:g} to {entry.most:g}{unit}; got {shown(value)}.{hint}")

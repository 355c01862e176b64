"""An account of the fields of a file of another program: taken, converted, left out, assumed."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

#: A vehicle as a row of a consist file, by column.
Row = dict[str, Any]
#: Kinds of entries.
KINDS = ("taken", "converted", "left", "assumed")
#: Names of vehicles that a message lists.
NAMED = 3


@dataclass
class Account:
    """Use of the fields of a file, an entry each.

    Attributes
    ----------
    taken : list of str
        Unchanged values.
    converted : list of str
        Values in another unit or form, with the calculation.
    left : list of str
        Unused values, each with the reason.
    assumed : list of str
        Values that the file does not state, and values of uncertain meaning.
    """

    taken: list[str] = field(default_factory=list)
    converted: list[str] = field(default_factory=list)
    left: list[str] = field(default_factory=list)
    assumed: list[str] = field(default_factory=list)

    def __str__(self) -> str:
        """Return the entries as lines of text, each with its kind."""
        return "\n".join(f"{kind:<10}{entry}" for kind in KINDS for entry in getattr(self, kind))


@dataclass
class Imported(Account):
    """A train of another program as rows of a consist, with the account of the fields of its file.

    Attributes
    ----------
    rows : list of dict
        A row for each kind of vehicle in turn, with the columns of `products/train/consist_columns.py`.
    """

    rows: list[Row] = field(default_factory=list)


class Notes:
    """Collects messages while an importer reads vehicle by vehicle.

    Attributes
    ----------
    vehicle : str
        Name of the vehicle that is read now; empty: the message is about the train.
    """

    def __init__(self) -> None:
        self.vehicle = ""
        self._vehicles: list[str] = []
        self._told: dict[str, dict[str, list[str]]] = {kind: {} for kind in KINDS}

    def begin(self, vehicle: str) -> None:
        """Begin a vehicle; the messages that follow are about it."""
        self.vehicle = vehicle
        if vehicle not in self._vehicles:
            self._vehicles.append(vehicle)

    def taken(self, sentence: str) -> None:
        """Add a field that has a column."""
        self._add("taken", sentence)

    def converted(self, sentence: str) -> None:
        """Add a field that a calculation turns into a column."""
        self._add("converted", sentence)

    def left(self, sentence: str) -> None:
        """Add a field without a column, with the reason."""
        self._add("left", sentence)

    def left_of(self, reasons: Mapping[str, str], names: Collection[str]) -> None:
        """Add those of the names that have a reason to be left, a message for each reason."""
        for reason in dict.fromkeys(reasons.values()):
            if told := [name for name, one in reasons.items() if one == reason and name in names]:
                self.left(f"{', '.join(told)}: {reason}.")

    def assumed(self, sentence: str) -> None:
        """Add a value that the file does not state."""
        self._add("assumed", sentence)

    def _add(self, kind: str, sentence: str) -> None:
        places = self._told[kind].setdefault(sentence, [])
        if self.vehicle not in places:
            places.append(self.vehicle)

    def imported(self, rows: list[Row]) -> Imported:
        """Return the rows with all messages."""
        return Imported(
            rows=rows, **{kind: [self._told_of(*item) for item in told.items()] for kind, told in self._told.items()}
        )

    def _told_of(self, sentence: str, places: list[str]) -> str:
        """Return a message with its vehicles, unless it applies to all of them."""
        named = [place for place in places if place]
        if not named or (len(self._vehicles) > 1 and len(named) == len(self._vehicles)) or len(self._vehicles) == 1:
            return sentence
        more = f" and {len(named) - NAMED} more" if len(named) > NAMED else ""
        return f"{', '.join(named[:NAMED])}{more}: {sentence}"

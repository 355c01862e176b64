"""Notes of an importer: sentences about fields, each once, with the vehicles to which it applies."""

from __future__ import annotations

from readers.formats import Imported, Row

#: Names of vehicles that a sentence lists.
NAMED = 3


class Notes:
    """Collects sentences while an importer reads vehicle by vehicle.

    Attributes
    ----------
    vehicle : str
        Name of the vehicle that is read now; empty: the sentence is about the train.
    """

    def __init__(self) -> None:
        self.vehicle = ""
        self._vehicles: list[str] = []
        self._told: dict[str, dict[str, list[str]]] = {kind: {} for kind in ("taken", "converted", "left", "assumed")}

    def begin(self, vehicle: str) -> None:
        """Begin a vehicle; sentences that follow are about it."""
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

    def assumed(self, sentence: str) -> None:
        """Add a value that the file does not state."""
        self._add("assumed", sentence)

    def _add(self, kind: str, sentence: str) -> None:
        places = self._told[kind].setdefault(sentence, [])
        if self.vehicle not in places:
            places.append(self.vehicle)

    def imported(self, rows: list[Row]) -> Imported:
        """Return the rows with all sentences."""
        return Imported(
            rows=rows, **{kind: [self._told_of(*one) for one in told.items()] for kind, told in self._told.items()}
        )

    def _told_of(self, sentence: str, places: list[str]) -> str:
        """Return a sentence with its vehicles, unless it applies to all of them."""
        named = [one for one in places if one]
        if not named or (len(self._vehicles) > 1 and len(named) == len(self._vehicles)) or len(self._vehicles) == 1:
            return sentence
        more = f" and {len(named) - NAMED} more" if len(named) > NAMED else ""
        return f"{', '.join(named[:NAMED])}{more}: {sentence}"

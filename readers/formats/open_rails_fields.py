"""Fields of an Open Rails or MSTS vehicle: the valid one of each name, its numbers and words, and unknown names."""

from __future__ import annotations

import difflib
import math
from collections.abc import Sequence

from readers.formats.notes import Notes
from readers.formats.open_rails_text import Block
from readers.formats.open_rails_units import FACTORS, measured
from readers.text import quoted

#: Likeness from which an unknown name is a misspelt one.
ALIKE = 0.9


class Fields:
    """Fields of a vehicle.

    Parameters
    ----------
    blocks : sequence of Block
        Blocks of the vehicle; of equal names the last one is valid.
    notes : Notes
        Where a field that cannot be read is told.
    """

    def __init__(self, blocks: Sequence[Block], notes: Notes) -> None:
        self.blocks = {block.name: block for block in blocks}
        self.notes = notes

    def words(self, name: str) -> list[str]:
        """Return the words of a field, none if the file does not have it."""
        block = self.blocks.get(name.lower())
        return block.words if block else []

    def word(self, name: str) -> str:
        """Return the words of a field as one text, in small letters; empty if the file does not have it."""
        return " ".join(self.words(name)).strip().lower()

    def has(self, name: str) -> bool:
        """Return whether the file has a field."""
        return name.lower() in self.blocks

    def number(self, name: str, quantity: str, at: int = 0) -> float | None:
        """Return a number of a field in the unit of its quantity, None if it is missing or cannot be read.

        Parameters
        ----------
        name : str
            The field.
        quantity : str
            A name in FACTORS.
        at : int
            Which of its numbers, from 0.
        """
        words = self.words(name)
        if len(words) <= at:
            if self.has(name):
                self.notes.left(f"{name}: it has no number.")
            return None
        found = measured(words[at], quantity)
        if found is None or not math.isfinite(found[0]):
            units = ", ".join(unit for unit in FACTORS[quantity] if unit)
            self.notes.left(f"{name}: {quoted(words[at])} is not a number{f' in {units}' if units else ''}.")
            return None
        return self._with_unit_behind(name, words, at, quantity, found)

    def _with_unit_behind(
        self, name: str, words: list[str], at: int, quantity: str, found: tuple[float, str]
    ) -> float | None:
        """Return a number with a unit that stands apart from it, which Open Rails does not read."""
        number, unit = found
        behind = words[at + 1].lower() if len(words) > at + 1 else ""
        apart = measured(f"1{behind}", quantity) if behind[:1].isalpha() else None
        if unit or not apart or not apart[1]:
            return number
        if math.isclose(FACTORS[quantity][apart[1]], FACTORS[quantity][""]):
            return number
        self.notes.assumed(
            f"{name}: {words[at]} {words[at + 1]} is read with its unit; Open Rails ignores a unit behind a blank."
        )
        return number / FACTORS[quantity][""] * FACTORS[quantity][apart[1]]

    def misspelt(self, known: Sequence[str], taken: Sequence[str]) -> None:
        """Tell names that are unknown and nearly those of fields that are taken."""
        small = {name.lower() for name in known} | {name.lower() for name in taken}
        of_taken = {name.lower(): name for name in taken}
        for name in self.blocks:
            if name in small or not name:
                continue
            for near in difflib.get_close_matches(name, list(of_taken), 1, ALIKE):
                self.notes.left(f"{quoted(name)} is unknown and is not read; did you mean {of_taken[near]}?")

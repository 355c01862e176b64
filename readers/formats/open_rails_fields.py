"""Fields of an Open Rails or MSTS vehicle: the valid one of each name, its numbers and words, and unknown names."""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Sequence

from readers.formats.open_rails_text import Block
from readers.formats.open_rails_units import FACTORS, measured, units_of
from readers.import_account import Notes
from readers.text import FileError, quoted

#: Begin of a word that is a number.
BEGIN = re.compile(r"[+-]?\.?\d")
#: Likeness from which an unknown name is a misspelt one.
ALIKE = 0.9


class Fields:
    """Fields of a vehicle.

    Parameters
    ----------
    blocks : sequence of Block
        Blocks of the vehicle; of equal names the last one is valid.
    notes : Notes
        Receives messages about units behind a blank and misspelt names.
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
        """Return a number of a field in the unit of its quantity, None if the file does not have it."""
        block = self.blocks.get(name.lower())
        if block is None:
            return None
        words = _joined(block)
        places = [place for place, word in enumerate(words) if BEGIN.match(word)]
        if not places or places[0] != 0:
            raise self._refusal(block, name, quantity, " ".join(words))
        if len(places) <= at:
            return None
        text = words[places[at]]
        behind = words[places[at] + 1 : places[at] + 2]
        found = measured(text, quantity)
        if found is None or not math.isfinite(found[0]):
            raise self._refusal(block, name, quantity, text)
        if found[1] or not behind or BEGIN.match(behind[0]) or getattr(behind[0], "in_quotes", False):
            return found[0]
        return self._with_unit_behind(block, name, quantity, text, behind[0])

    def _with_unit_behind(self, block: Block, name: str, quantity: str, number: str, unit: str) -> float:
        """Return a number with a unit that stands apart from it, which Open Rails does not read. Raises FileError."""
        found = measured(f"{number}{unit}", quantity)
        if found is None:
            raise self._refusal(block, name, quantity, f"{number} {unit}")
        if not math.isclose(FACTORS[quantity][found[1]], FACTORS[quantity][""]):
            self.notes.assumed(
                f"{name}: {number} {unit} is read with its unit; Open Rails ignores a unit behind a blank."
            )
        return found[0]

    def _refusal(self, block: Block, name: str, quantity: str, text: str) -> FileError:
        """Return the error about a number that cannot be read."""
        units = ", ".join(one for one in units_of(quantity) if "(" not in one)
        return FileError(
            f"{block.source}, row {block.row}: {name} must be a number{f' in {units}' if units else ''}; got "
            f"{quoted(text)}. Correct it, and write a remark as comment ( )."
        )

    def misspelt(self, known: Sequence[str], taken: Sequence[str]) -> None:
        """Tell names that are unknown and nearly those of fields that are taken."""
        small = {name.lower() for name in known} | {name.lower() for name in taken}
        of_taken = {name.lower(): name for name in taken}
        for name in self.blocks:
            if name in small or not name:
                continue
            for near in difflib.get_close_matches(name, list(of_taken), 1, ALIKE):
                self.notes.left(f"{quoted(name)} is unknown and is not read; did you mean {of_taken[near]}?")


def _joined(block: Block) -> list[str]:
    """Return the words of a field, joined again where brackets of a unit began a block, as in 0.4*(ft^3)."""
    if not block.blocks:
        return block.words
    unit = "".join(f"{one.name}({' '.join(one.words)})" for one in block.blocks)
    first = [word for word in block.words[:1] if BEGIN.match(word)]
    return ["".join([*first, unit, *block.words[len(first) :]])]

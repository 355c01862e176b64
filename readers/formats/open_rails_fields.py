"""Fields of an Open Rails or MSTS vehicle: the valid one of each name, its numbers and words, and unknown names."""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Mapping, Sequence
from types import MappingProxyType

from readers.formats.open_rails_text import Block
from readers.import_account import Notes
from readers.text import FileError, quoted
from readers.units import SPELLINGS

#: A number, with commas between groups of three digits, and its unit; a remark may follow after #.
NUMBER = re.compile(r"(?P<number>[+-]?(?:\d+(?:,\d{3})*\.?\d*|\.\d+)(?:[eE][+-]?\d+)?),?\s*(?P<unit>[^#]*)(?:#.*)?")
POUND, FOOT, INCH, MILE_PER_HOUR = 0.45359237, 0.3048, 0.0254, 0.44704
POUND_FORCE = POUND * 9.80665
PSI = 1e-5 * POUND_FORCE / INCH**2
_FOOT3, _GALLON = 1e3 * FOOT**3, 3.785411784
_PRESSURES = {"psi": PSI, "bar": 1.0, "kpa": 0.01, "inhg": 0.0338638866667}
#: Factors by quantity and unit in small letters; the empty unit is that of a field that writes none.
_FACTORS: dict[str, dict[str, float]] = {
    "1": {"": 1.0},
    "kg": {"": 1.0, "kg": 1.0, "g": 1e-3, "t": 1e3, "lb": POUND, "t-us": 2000 * POUND, "t-uk": 2240 * POUND},
    "m": {
        "": 1.0,
        "m": 1.0,
        "cm": 0.01,
        "mm": 0.001,
        "km": 1e3,
        "ft": FOOT,
        "'": FOOT,
        "in": INCH,
        "in/2": INCH / 2,
    },
    "km/h": {"": 3.6 * MILE_PER_HOUR, "mph": 3.6 * MILE_PER_HOUR, "km/h": 1.0, "m/s": 3.6},
    "km/h curve": {"": 3.6, "mph": 3.6 * MILE_PER_HOUR, "km/h": 1.0, "m/s": 3.6},
    "W": {"": 1.0, "w": 1.0, "kw": 1e3, "hp": 550 * POUND_FORCE * FOOT},
    "N": {"": 1.0, "n": 1.0, "kn": 1e3, "mn": 1e6, "lbf": POUND_FORCE, "lb": POUND_FORCE},
    "N/s": {"": 1.0, "n/s": 1.0, "kn/s": 1e3, "lbf/s": POUND_FORCE},
    "N/(m/s)": {
        "": 1.0,
        "n/m/s": 1.0,
        "n/(m/s)": 1.0,
        "lbf/mph": POUND_FORCE / MILE_PER_HOUR,
        "lb/mph": POUND_FORCE / MILE_PER_HOUR,
        "kg/s": 1.0,
    },
    "N/(m/s)^2": {
        "": 1.0,
        "n/m/s^2": 1.0,
        "nm/s^2": 1.0,
        "ns^2/m^2": 1.0,
        "ns2/m2": 1.0,
        "n/(m/s)^2": 1.0,
        "lbf/mph^2": POUND_FORCE / MILE_PER_HOUR**2,
        "lb/mph^2": POUND_FORCE / MILE_PER_HOUR**2,
        "n/(m^2/s^2)": 1.0,
        "n/m^2/s^2": 1.0,
        "kg/m": 1.0,
    },
    "bar": {"": PSI} | _PRESSURES,
    "bar/s": {"": PSI}
    | {f"{unit}/s": one for unit, one in _PRESSURES.items()}
    | {f"{unit}/min": one / 60 for unit, one in _PRESSURES.items()},
    "l": {
        "": _FOOT3,
        "ft^3": _FOOT3,
        "in^3": _FOOT3 / 1728,
        "m^3": 1e3,
        "l": 1.0,
        "g-us": _GALLON,
        "gal": _GALLON,
        "gals": _GALLON,
        "g-uk": 4.54609,
        "*(ft^3)": _FOOT3,
        "*(in^3)": _FOOT3 / 1728,
        "*(m^3)": 1e3,
    },
    "N/m": {"": 1.0, "n/m": 1.0, "kn/m": 1e3, "mn/m": 1e6, "kn/mm": 1e6, "lbf/in": POUND_FORCE / INCH},
}
#: Quantities of the table of all readers, whose units are read too, and the factor from its SI unit.
_SHARED = {
    "kg": ("mass", 1.0),
    "m": ("length", 1.0),
    "km/h": ("speed", 3.6),
    "km/h curve": ("speed", 3.6),
    "W": ("power", 1.0),
    "N": ("force", 1.0),
    "N/(m/s)": ("force per speed", 1.0),
    "N/(m/s)^2": ("force per speed squared", 1.0),
    "bar": ("pressure", 1e-5),
    "l": ("volume", 1e3),
    "N/m": ("stiffness", 1.0),
}
#: Most units that a message lists.
LISTED = 6
#: Factors to SI, but pressures to bar and volumes to litres (factors of NIST SP 811).
FACTORS: Mapping[str, Mapping[str, float]] = MappingProxyType(
    {
        name: {unit.lower(): factor * up / down for unit, (up, down) in SPELLINGS.get(of, {}).items()} | own
        for name, own in _FACTORS.items()
        for of, factor in (_SHARED.get(name, ("", 1.0)),)
    }
)


def units_of(quantity: str) -> list[str]:
    """Return the first units of a quantity that Open Rails has."""
    return [unit for unit in _FACTORS[quantity] if unit][:LISTED]


def measured(text: str, quantity: str) -> tuple[float, str] | None:
    """Return a number in the unit of its quantity, and the unit that is written, or None if it cannot be read."""
    found = NUMBER.fullmatch(text.strip())
    if found is None:
        return None
    unit = found["unit"].strip().lower().replace("²", "^2").replace("³", "^3")
    factor = FACTORS[quantity].get(unit)
    if factor is None or len(found["number"]) > 40:
        return None
    return float(found["number"].replace(",", "")) * factor, unit


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

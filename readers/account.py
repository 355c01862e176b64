"""An account of the fields of a file of another program: taken, converted, left out, assumed."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass
class Account:
    """Use of the fields of a file, an entry each.

    Attributes
    ----------
    taken : list of str
        Values that are used as they are.
    converted : list of str
        Values that are used in another unit or form, with the calculation.
    left : list of str
        Values that are not used, each with the reason.
    assumed : list of str
        Values that the file does not state, or whose meaning is uncertain.
    """

    taken: list[str] = field(default_factory=list)
    converted: list[str] = field(default_factory=list)
    left: list[str] = field(default_factory=list)
    assumed: list[str] = field(default_factory=list)

    def __str__(self) -> str:
        """Return the entries as lines of text, each with its kind."""
        kinds = ("taken", "converted", "left", "assumed")
        return "\n".join(f"{kind:<10}{entry}" for kind in kinds for entry in getattr(self, kind))

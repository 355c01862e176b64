"""Long C functions in pieces: a compiler takes far more than twice as long for twice as many lines."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

#: What is no longer stays whole. Lines of a piece; shorter ones compile faster and run slower: the bogie stops 2 %
#: later than whole, the four-axle vehicle compiles in 79 instead of 167 s, with pieces of 700 lines in 62 s, and stops
#: 4 % later then.
WHOLE, LONGEST = 4500, 1500

_LOCAL = re.compile(r"\ba\d+\b")
_ARRAY = re.compile(r"double (\w+)\[\d+\];")


@dataclass(frozen=True)
class Piece:
    """Some statements, and the locals that they need of those before and that those after need of them."""

    lines: Sequence[str]
    needed_later: frozenset[str] = frozenset()

    @cached_property
    def taken_and_set(self) -> tuple[frozenset[str], frozenset[str]]:
        """Locals that are read before they are set here, and those that are set."""
        taken: set[str] = set()
        assigned: set[str] = set()
        for line in self.lines:
            name, _, value = line.partition("=")
            sets = _LOCAL.fullmatch(name) is not None
            taken |= set(_LOCAL.findall(value if sets else line)) - assigned
            if sets:
                assigned.add(name)
        return frozenset(taken), frozenset(assigned)

    @property
    def needed(self) -> frozenset[str]:
        """Locals that must be known where the piece begins, for itself and for those after it."""
        taken, assigned = self.taken_and_set
        return (self.needed_later - assigned) | taken


def in_pieces(text: str) -> str:
    """CasADi's C with its long functions, straight lines all of them, as calls of pieces one after another."""
    function = r"^static int (?P<name>\w+)\([^)]*\) ?\{\n(?P<body>.*?)^\}\n"
    return re.sub(function, _divided, text, flags=re.MULTILINE | re.DOTALL)


def _divided(found: re.Match[str]) -> str:
    lines = [line.strip() for line in found["body"].splitlines() if line.strip()]
    arrays = [line for line in lines if line.startswith("double ") and _ARRAY.fullmatch(line)]
    declared = {*arrays, "return 0;"}
    code = [
        line for line in lines if line not in declared and not line.startswith(("casadi_real a", "const double left_"))
    ]
    if len(code) <= WHOLE:
        return found[0]
    # What calls have left is read where they left it.
    code = re.sub(r"\bleft_(\d+)\b", r"left[\1]", "\n".join(code)).split("\n")
    pieces = _pieces(code)
    crossing = sorted({name for piece in pieces for name in piece.needed_later})
    place = {name: f"kept[{number}]" for number, name in enumerate(crossing)}
    names = ["arg", "res", "kept", *(array[1] for array in map(_ARRAY.fullmatch, arrays) if array)]
    given = ", ".join(["const casadi_real** arg", "casadi_real** res", *(f"double *{name}" for name in names[2:])])
    parts = [_function(f"{found['name']}_{n}", given, piece, place) for n, piece in enumerate(pieces)]
    head = found[0][: found[0].index("{") + 2]
    calls = [f"  {found['name']}_{n}({', '.join(names)});" for n in range(len(pieces))]
    room = [*(f"  {array}" for array in arrays), f"  double kept[{len(crossing) or 1}];"]
    return "".join(parts) + head + "\n".join([*room, *calls, "  return 0;", "}", ""])


def _pieces(code: Sequence[str]) -> list[Piece]:
    pieces: list[Piece] = []
    needed: frozenset[str] = frozenset()
    for start in reversed(range(0, len(code), LONGEST)):
        pieces.insert(0, Piece(code[start : start + LONGEST], needed))
        needed = pieces[0].needed
    return pieces


def _function(name: str, given: str, piece: Piece, place: dict[str, str]) -> str:
    """C of a piece; the locals that pieces share are in `kept` between them."""
    taken, assigned = piece.taken_and_set
    own = sorted(taken | assigned)
    lines = [
        *([f"casadi_real {', '.join(own)};"] if own else []),
        *(f"{one}={place[one]};" for one in sorted(taken)),
        *piece.lines,
        *(f"{place[one]}={one};" for one in sorted(assigned & piece.needed_later)),
    ]
    return f"static void {name}({given}) {{\n" + "".join(f"  {line}\n" for line in lines) + "}\n"

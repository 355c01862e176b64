"""Functions of one number in pairs: two calls of a function that do not wait for each other become one of both."""

from __future__ import annotations

from collections.abc import Sequence

from fmu_src.statements import SIN_COS, Statement, called

#: Forms that have a partner in lanes_pairs.h.
_PAIRED = {called(name): f"pair_{name}" for name in ("exp", "log", "atan", "tan", "asin", "cbrt")}
_PAIRED[SIN_COS] = "pair_sin_cos"


def paired(statements: Sequence[Statement]) -> list[Statement]:
    """Return the statements, in pairs if two may be computed together; operands of the second are moved before it.

    Nothing is moved across a statement that neither reads nor gives a value: a call, on which others depend.
    """
    made: list[Statement] = []
    begin = 0
    for number, one in enumerate([*statements, Statement("")]):
        if not one.values and not one.operands:
            made += _Segment(statements[begin:number]).in_pairs()
            made += [one] if number < len(statements) else []
            begin = number + 1
    return made


class _Segment:
    """Statements between two calls."""

    def __init__(self, statements: Sequence[Statement]) -> None:
        self.statements = statements
        self.by_value = {value: number for number, statement in enumerate(statements) for value in statement.values}
        self.done: set[int] = set()
        self.made: list[Statement] = []

    def in_pairs(self) -> list[Statement]:
        waiting: dict[str, list[int]] = {}
        for number, one in enumerate(self.statements):
            if one.form in _PAIRED:
                waiting.setdefault(one.form, []).append(number)
        for number, one in enumerate(self.statements):
            if number in self.done:
                continue
            partners = waiting.get(one.form, [])
            partner = next((n for n in partners if n > number and n not in self.done and self.is_free(n, number)), None)
            if partner is None:
                self.emit(number)
            else:
                self.emit_needed(partner)
                self.made.append(_pair(one, self.statements[partner]))
                self.done |= {number, partner}
        return self.made

    def producers(self, number: int) -> list[int]:
        """Return the unwritten statements whose values a statement reads, in their order."""
        found = {self.by_value[value] for value in self.statements[number].reads if value in self.by_value}
        return sorted(found - self.done)

    def is_free(self, number: int, of: int) -> bool:
        """Return whether a statement can be computed without another one."""
        waiting, seen = self.producers(number), set[int]()
        while waiting:
            one = waiting.pop()
            if one == of:
                return False
            if one not in seen:
                seen.add(one)
                waiting += self.producers(one)
        return True

    def emit_needed(self, number: int) -> None:
        """Write the operands of a statement."""
        needed, waiting = set[int](), self.producers(number)
        while waiting:
            one = waiting.pop()
            if one not in needed:
                needed.add(one)
                waiting += self.producers(one)
        for one in sorted(needed):
            self.emit(one)

    def emit(self, number: int) -> None:
        self.made.append(self.statements[number])
        self.done.add(number)


def _pair(first: Statement, second: Statement) -> Statement:
    """Return one statement of two with one form."""
    targets = len(first.values) + len(second.values)
    places = ", ".join(f"&{{{2 + number}}}" for number in range(targets))
    form = f"{_PAIRED[first.form]}({{0}}, {{1}}, {places})"
    return Statement(form, (*first.operands, *second.operands), (*first.values, *second.values), written=True)

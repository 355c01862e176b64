"""Solution of the linear equations of a step: Gaussian elimination as C without a loop or a search.

The nonzero entries of I/(gamma h) - J are known beforehand, and so is every multiplication of its factors. They are
written one after another in the order that fills least. Each entry is written once, with all its subtractions.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property

from fmu_src.system import System

#: Products that are added up before they are taken from a value.
TOGETHER = 4

#: Lines of one C function: a compiler takes more than twice as long for twice as many.
LONGEST = 150


@dataclass(frozen=True)
class Elimination:
    """An order of elimination of the states, which keeps the factors sparse, and the places that it fills.

    The row and column of each nonzero of the Jacobian are in `nonzeros`, column by column. For each pivot, `below` and
    `right` have the nonzero rows below it and columns right of it at its elimination.
    """

    order: list[int]
    nonzeros: list[tuple[int, int]]
    below: list[list[int]]
    right: list[list[int]]

    @cached_property
    def position(self) -> list[int]:
        """Return the position of each state in the order of elimination."""
        return sorted(range(len(self.order)), key=self.order.__getitem__)

    @cached_property
    def _number(self) -> dict[tuple[int, int], int]:
        """Return the number of each nonzero of the Jacobian by its place in the order of elimination."""
        return {(self.position[row], self.position[column]): n for n, (row, column) in enumerate(self.nonzeros)}

    def entry(self, row: int, column: int) -> str:
        """Return C of an entry of the matrix: `d` is its diagonal by states without the Jacobian, `j` the nonzeros of
        that.
        """
        nonzero = self._number.get((row, column))
        less = "" if nonzero is None else f"-j[{nonzero}]"
        if row != column:
            return less or "0.0"
        return f"d[{self.order[row]}]{less.replace('-', ' - ')}"

    @cached_property
    def place(self) -> dict[tuple[int, int], int]:
        """Return the place of each entry (row, column) of the factors: the diagonal, below it by rows, above it by
        rows.
        """
        count = len(self.order)
        lower = sorted((row, pivot) for pivot, rows in enumerate(self.below) for row in rows)
        upper = [(pivot, column) for pivot, columns in enumerate(self.right) for column in columns]
        packed = [*((pivot, pivot) for pivot in range(count)), *lower, *upper]
        return {entry: number for number, entry in enumerate(packed)}

    @property
    def lower(self) -> int:
        """Return the number of entries below the diagonal."""
        return sum(map(len, self.below))

    def factors(self) -> Iterator[str]:
        """Return C that leaves the packed factors L U = A in `e`: L below the diagonal, 1 / U on it, U above it."""
        left_of, above = _pivots(self.below), _pivots(self.right)

        def reduced(row: int, column: int) -> str:
            lost = sorted(left_of[row] & above[column])
            products = [f"e[{self.place[row, pivot]}] * e[{self.place[pivot, column]}]" for pivot in lost]
            return _less(self.entry(row, column), products)

        for pivot in range(len(self.order)):
            diagonal = self.place[pivot, pivot]
            yield f"e[{diagonal}] = 1.0 / ({reduced(pivot, pivot)});"
            for column in self.right[pivot]:
                yield f"e[{self.place[pivot, column]}] = {reduced(pivot, column)};"
            for row in self.below[pivot]:
                yield f"e[{self.place[row, pivot]}] = ({reduced(row, pivot)}) * e[{diagonal}];"

    def substitution(self) -> Iterator[str]:
        """Return C that solves L U x = v in place; `v` is in the order of the states."""
        count, left_of = len(self.order), _pivots(self.below)

        def less(row: int, columns: Iterable[int]) -> str:
            products = [f"e[{self.place[row, column]}] * v[{self.order[column]}]" for column in columns]
            return _less(f"v[{self.order[row]}]", products)

        for row in range(count):
            if left_of[row]:
                yield f"v[{self.order[row]}] = {less(row, sorted(left_of[row]))};"
        for row in reversed(range(count)):
            yield f"v[{self.order[row]}] = ({less(row, reversed(self.right[row]))}) * e[{row}];"


def _less(value: str, products: list[str]) -> str:
    """Return C of a value minus products, in independent sums of a few, with the known ones first.

    A processor computes several additions at a time.
    """
    sums = [products[start : start + TOGETHER] for start in range(0, len(products), TOGETHER)]
    return value + "".join(f" - ({' + '.join(one)})" for one in sums)


def _pivots(lists: list[list[int]]) -> list[set[int]]:
    """Return, for each row or column, the pivots that have it in their lists."""
    found: list[set[int]] = [set() for _ in lists]
    for pivot, members in enumerate(lists):
        for member in members:
            found[member].add(pivot)
    return found


def elimination(system: System) -> Elimination:
    """Factorise I/(gamma h) - J symbolically without exchanges, the pivot with the least work first (Markowitz)."""
    pattern = system.jacobian(system.ode, system.arguments[1]).sparsity()
    count = len(system.states)
    row_states: list[set[int]] = [{state} for state in range(count)]
    triplets = list(zip(*pattern.get_triplet(), strict=True))
    for i, j in triplets:
        row_states[i].add(j)
    left, order, lists = set(range(count)), [], []
    while left:
        users = {state: {row for row in left if state in row_states[row]} - {state} for state in left}
        pivot = min(left, key=lambda state: (len(users[state]) * (len(row_states[state] & left) - 1), state))
        left.remove(pivot)
        order.append(pivot)
        lists.append((users[pivot], row_states[pivot] & left))
        for row in users[pivot]:
            row_states[row] |= row_states[pivot] & left
    position = {state: place for place, state in enumerate(order)}
    below, right = ([sorted(position[state] for state in one[side]) for one in lists] for side in (0, 1))
    return Elimination(order, triplets, below, right)


def elimination_source(name: str, solving: Elimination) -> str:
    """Return C of NAME_factorise(jacobian, diagonal, entry) and NAME_substitute(entry, vector) of a system."""
    head = ['#pragma GCC diagnostic ignored "-Wunused-parameter"', '#include "model.h"', ""]
    return "\n".join([*head, *_functions(name, solving, "RUNTIME_LOCAL void {}", "double")])


def elimination_in_lanes(name: str, solving: Elimination) -> list[str]:
    """Return the same over several instances, LANES_NAME(NAME_factorise) and so on, of numbers that lie LANES apart."""
    return _functions(name, solving, "static void LANES_NAME({})", "lanes_loose")


def _functions(name: str, solving: Elimination, head: str, number: str) -> list[str]:
    """Return C of both functions. head: of their declarations; number: the type of numbers in memory."""
    lines, outside = [], "double"
    as_numbers = number != outside
    for task, pointers, body in (
        ("factorise", {"j": "const ", "d": "const ", "e": ""}, list(solving.factors())),
        ("substitute", {"e": "const ", "v": ""}, list(solving.substitution())),
    ):
        taken = ", ".join(f"{kind}{number} *{pointer}" for pointer, kind in pointers.items())
        shown = ", ".join(f"{kind}{outside} *{pointer}" for pointer, kind in pointers.items())
        casts = [f"({kind}{number} *){pointer}" for pointer, kind in pointers.items()]
        given = ", ".join(casts if as_numbers else pointers)
        pieces = [body[start : start + LONGEST] for start in range(0, len(body), LONGEST)]
        # Names must end with the number of lanes.
        names = [f"piece_{place}_of_{name}_{task}" for place in range(len(pieces))]
        for own, piece in zip(names, pieces, strict=True):
            lines += [f"static void {own}({taken}) {{", *(f"    {line}" for line in piece), "}"]
        calls = [f"    {own}({given});" for own in names]
        lines += [f"{head.format(f'{name}_{task}')}({shown}) {{", *calls, "}", ""]
    return lines

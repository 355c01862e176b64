"""Equations as links of a chain: repeated parts are generated once, and the chain rule is applied at shared variables.

Derivatives are taken from link to link and multiplied. This costs less than differentiating the whole expression at
once. A repeated part is differentiated once for all its places.
"""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass, field, fields
from functools import cached_property
from itertools import pairwise
from threading import RLock
from typing import Any, TypeVar

from fmu_src.symbols import ca

#: CasADi counts the users of its expressions without a lock: two threads that write equations or C crash or hang.
ONE_WRITES = RLock()


def function_of(name: str, given: list[ca.SX], result: ca.SX) -> ca.Function:
    """Return a function whose inputs are called like their symbols, for `equations_in_c.function_of_cells`."""
    names = [str(one[0]).rpartition("_")[0] if one.numel() > 1 else str(one) for one in given]
    return ca.Function(name, given, [ca.densify(result)], names, ["result"])


@dataclass(frozen=True)
class Part:
    """A function that is generated once and called for each repeated component, such as the wheelsets of a vehicle.

    The column vector `results` is differentiated by `arguments`, but not by `constants`. The `chain` has the calls of
    this part and its shared intermediate variables. A part may have C instead of equations (`part_in_c`): `source`,
    placed after `common`, which several parts share. With `flat` it is a table search, whose results have no slopes;
    its C is a table, see piecewise.py. With `inline`, `source` is C of a call, with {arguments}, {constants} and {left}
    in braces.
    """

    name: str
    arguments: ca.SX
    constants: ca.SX
    results: ca.SX
    chain: Chain = field(default_factory=lambda: Chain())
    source: str = ""
    common: str = ""
    flat: bool = False
    inline: bool = False

    @cached_property
    def slope(self) -> ca.SX:
        """Return derivatives of the results by the arguments, shape (results, arguments), structural nonzeros only."""
        if self.flat:
            return ca.SX(self.results.numel(), self.arguments.numel())
        return self.chain.jacobian(self.results, self.arguments)

    @cached_property
    def needed(self) -> list[list[int]]:
        """Return, for each result, the places of the arguments and constants on which it depends."""
        given = ca.vertsplit(ca.vertcat(self.arguments, self.constants))
        if self.flat:
            return [list(range(len(given)))] * self.results.numel()
        every = [symbols_in(one) for one in ca.vertsplit(self.chain.expand(self.results))]
        return [[n for n, symbol in enumerate(given) if symbol.element_hash() in one] for one in every]

    @cached_property
    def function(self) -> ca.Function:
        """Return the results, and the nonzeros of their slopes, of arguments and constants."""
        both = [ca.densify(self.chain.expand(one)) for one in (self.results, ca.vec(self.slope.nz[:]))]
        return ca.Function(self.name, [self.arguments, self.constants], both)


def part_in_c(name: str, counts: tuple[int, int, int], source: str, common: str = "") -> Part:
    """Return a part for a function that expressions cannot describe, such as a search in a table.

    In equations only its dependencies are defined: written out, its results are NaN. The C must define

        static void NAME(const double *arguments, const double *constants, double *results, double *slopes)

    Here `slopes` is 0, or room for the derivatives of all results by the arguments, column by column.
    """
    arguments, constants = ca.SX.sym("arguments", counts[0]), ca.SX.sym("constants", counts[1])
    all_of_it = math.nan * (ca.sum1(arguments) + ca.sum1(constants))
    return Part(name, arguments, constants, ca.repmat(all_of_it, counts[2], 1), source=source, common=common)


@dataclass(frozen=True)
class Each:
    """A call is made for each record of a list (records.py), and the results are added up.

    The last constant of the call is the record with the list; the part gets the record in the list in its place. The
    list has the place `place` among those of the record. The part is called where the one result of `asked`, of the
    same arguments and constants, is above 0; None: for each record. With `always` it is called for the first record in
    any case; the list then must not be empty. With `largest` the largest of each result is taken, and NOTHING of an
    empty list. Such a call has no derivatives.
    """

    place: int
    asked: Part | None = None
    always: bool = False
    largest: bool = False


#: Result of the largest of an empty list.
NOTHING = -1.0


@dataclass(frozen=True)
class Call:
    """A part at a place in the equations: its arguments there, and symbols for its results and their derivatives.

    `slopes` are the nonzeros of `slope`, the derivatives of the results by the arguments. Parts of a lower `rank` are
    called first. `when`: the part is called if this is above 0; elsewhere its results are 0. `plain` is `taken` without
    the symbols of `Waist` links.
    """

    part: Part
    given: ca.SX
    constants: ca.SX
    symbols: ca.SX
    slopes: ca.SX
    slope: ca.SX
    rank: int
    when: ca.SX
    plain: ca.SX
    each: Each | None = None

    @property
    def taken(self) -> ca.SX:
        """Return all that must be known before the call: arguments, constants, and `when` unless it is a constant."""
        return all_taken(self.given, self.constants, self.when)

    @cached_property
    def own(self) -> frozenset[int]:
        """Return its symbols, as `symbols_in` has them."""
        return symbols_in(self.symbols)

    @cached_property
    def own_slopes(self) -> frozenset[int]:
        """Return symbols of its slopes."""
        return symbols_in(self.slopes)

    @cached_property
    def found_from(self) -> list[frozenset[int]]:
        """Return, for each result, the symbols on which it depends at this place, as `symbols_in` returns them."""
        taken = [symbols_in(one) for one in ca.vertsplit(self.taken)]
        always = frozenset[int]().union(*taken[self.given.numel() + self.constants.numel() :])
        return [always.union(*(taken[place] for place in places)) for places in self.part.needed]

    @cached_property
    def written_out(self) -> ca.SX:
        """Return the part's equations at this place, to replace `symbols` and `slopes`."""
        results, slopes = self.part.function(self.given, self.constants)
        both = ca.vertcat(results, slopes)
        return both if self.when.is_constant() else ca.if_else(self.when > 0, both, 0)


def all_taken(given: ca.SX, constants: ca.SX, when: ca.SX) -> ca.SX:
    """Return the arguments of a part at a place as one column; `when` is included unless it is a constant."""
    return ca.vertcat(given, constants, *([] if when.is_constant() else [when]))


def digest_of(function: ca.Function) -> str:
    """Return twelve letters that are equal for functions that do the same, regardless of their names."""
    steps = hashlib.sha256()
    for number in range(function.n_instructions()):
        places = function.instruction_input(number), function.instruction_output(number)
        constant = function.instruction_constant(number) if function.instruction_id(number) == ca.OP_CONST else 0.0
        steps.update(repr((function.instruction_id(number), places, constant)).encode())
    return steps.hexdigest()[:12]


def symbols_in(expression: ca.SX) -> frozenset[int]:
    """Return the hashes of all symbols in an expression: one search replaces many tests for dependence."""
    return frozenset(symbol.element_hash() for symbol in ca.symvar(ca.vec(expression)))


@dataclass(frozen=True)
class Waist:
    """A few intermediate variables between states and equations for the chain rule: see `Chain.narrow`.

    `plain` are the same values without the symbols of other `Waist` links. follows: variables by which the values are
    differentiated, and the slopes, shape (values, given); None: by all symbols in the values.
    """

    values: ca.SX
    symbols: ca.SX
    plain: ca.SX
    follows: tuple[ca.SX, ca.SX] | None = None

    @cached_property
    def own(self) -> frozenset[int]:
        """Return its symbols, as `symbols_in` has them."""
        return symbols_in(self.symbols)

    @cached_property
    def found_from(self) -> list[frozenset[int]]:
        """Return, for each value, the symbols in it, as `symbols_in` returns them."""
        return [symbols_in(one) for one in ca.vertsplit(self.values)]


@dataclass(frozen=True)
class Following:
    """Constants of a part that change with `given`; `slope` has their derivatives, shape (symbols, given).

    So a sine that several parts need is computed once.
    """

    given: ca.SX
    symbols: ca.SX
    slope: ca.SX


Link = Call | Waist


@dataclass
class Chain:
    """Links in the order of their use: each may contain the symbols of those before it."""

    links: list[Link] = field(default_factory=list, kw_only=True)
    #: Of a part's own chain: how its constants change with its arguments.
    following: list[Following] = field(default_factory=list, kw_only=True)

    def call(
        self, part: Part, given: ca.SX, constants: ca.SX, when: ca.SX | float = 1.0, each: Each | None = None
    ) -> ca.SX:
        """Return the results of a part, shape (results, 1); all calls share its code, and its derivatives are exact."""
        pattern = part.slope.sparsity()
        symbols, slopes = ca.SX.sym(part.name, part.results.numel()), ca.SX.sym(f"d_{part.name}", pattern.nnz())
        plain = self.without_waists(all_taken(given, constants, ca.SX(when)))
        # Constants too must be known before.
        needed = symbols_in(plain)
        rank = 1 + max((call.rank for call in self.calls if not needed.isdisjoint(call.own)), default=-1)
        slope = ca.SX(pattern, slopes)
        self.links.append(Call(part, given, constants, symbols, slopes, slope, rank, ca.SX(when), plain, each))
        return symbols

    def narrow(self, values: ca.SX, follows: tuple[ca.SX, ca.SX] | None = None) -> ca.SX:
        """Return symbols for `values`, a column vector of few numbers between many states and long equations.

        Only derivatives change: they are taken up to these symbols and from them on, and multiplied. So a force in many
        equations is differentiated once. A constant value stays a number.
        """
        every = ca.densify(values)
        varying = [n for n, one in enumerate(ca.vertsplit(every)) if not one.is_constant()]
        if not varying:
            return every
        symbols, own = ca.SX.sym("waist", len(varying)), every[varying]
        short = follows and (follows[0], follows[1][varying, :])
        self.links.append(Waist(own, symbols, self.without_waists(own), short))
        every[varying] = symbols
        return every

    def follow(self, symbols: ca.SX, given: ca.SX, slope: ca.SX) -> None:
        """Declare how constants of a part change with its arguments; see `Following`."""
        self.following.append(Following(given, symbols, slope))

    @property
    def calls(self) -> list[Call]:
        """Return the links that are parts."""
        return [link for link in self.links if isinstance(link, Call)]

    def without_waists(self, expression: ca.SX) -> ca.SX:
        """Return the same expression in the symbols of calls, without those of `Waist` links."""
        waists = [link for link in self.links if isinstance(link, Waist)]
        known = [ca.vertcat(*[getattr(waist, name) for waist in waists]) for name in ("symbols", "plain")]
        return ca.substitute(ca.SX(expression), *known) if waists else ca.SX(expression)

    def expand(self, expression: ca.SX) -> ca.SX:
        """Return the same expression without symbols of links, the equations of all parts in their place."""
        expression = self.without_waists(expression)
        for call in reversed(self.calls):
            if not symbols_in(expression).isdisjoint(call.own | call.own_slopes):
                own = ca.vertcat(call.symbols, call.slopes)
                expression = self.without_waists(ca.substitute(expression, own, call.written_out))
        return expression

    def jacobian(self, expression: ca.SX, symbols: ca.SX) -> ca.SX:
        """Return derivatives of an expression by symbols by the chain rule, link by link."""
        known: list[tuple[Link, ca.SX]] = []

        def slope_of(one: ca.SX) -> ca.SX:
            within = symbols_in(one)
            inside = [(link, slope) for link, slope in known if not within.isdisjoint(link.own)]
            parts = [ca.jacobian(one, link.symbols) @ slope for link, slope in inside]
            return sum(parts, self._own_slope(one, symbols))

        for link in self._needed_by(expression):
            if isinstance(link, Call):
                slope = link.slope @ slope_of(link.given)
            elif link.follows:
                slope = link.follows[1] @ slope_of(link.follows[0])
            else:
                slope = slope_of(link.values)
            known.append((link, slope))
        return self.without_waists(slope_of(expression))

    def _own_slope(self, one: ca.SX, symbols: ca.SX) -> ca.SX:
        """Return derivatives by symbols and by the constants that change with them, in one run along each symbol."""
        if not self.following:
            return ca.jacobian(one, symbols)
        together = ca.vertcat(symbols, *[constants.symbols for constants in self.following])
        along = [constants.slope @ ca.jacobian(constants.given, symbols) for constants in self.following]
        return ca.sparsify(ca.jtimes(one, together, ca.densify(ca.vertcat(ca.SX.eye(symbols.numel()), *along))))

    def _needed_by(self, expression: ca.SX) -> list[Link]:
        """Return the links on the way from symbols to an expression, in their order."""
        found: list[Link] = []
        users = symbols_in(expression)
        for link in reversed(self.links):
            if not users.isdisjoint(link.own):
                found.insert(0, link)
                users |= symbols_in(
                    link.given if isinstance(link, Call) else link.follows[0] if link.follows else link.values
                )
        return found

    def along(self, expression: ca.SX, symbols: ca.SX, seed: ca.SX) -> ca.SX:
        """Return the derivative of an expression along a direction of the symbols, by the chain rule."""
        known, rates = [symbols], [seed]
        for call in self.calls:
            given = ca.jtimes(self.without_waists(call.given), ca.vertcat(*known), ca.vertcat(*rates))
            known.append(call.symbols)
            rates.append(call.slope @ given)
        return ca.jtimes(self.without_waists(expression), ca.vertcat(*known), ca.vertcat(*rates))


def rows(count: int) -> Any:
    """Return a field of a `Bundle`: a column vector of `count` rows."""
    return field(metadata={"rows": count})


AnyBundle = TypeVar("AnyBundle", bound="Bundle")


@dataclass(frozen=True)
class Bundle:
    """Column vectors under their names, which a part takes or leaves as one vector; the fields are made by `rows`."""

    @property
    def vector(self) -> ca.SX:
        """Return all of them as one column."""
        return ca.vertcat(*[getattr(self, item.name) for item in fields(self)])

    @classmethod
    def of(cls: type[AnyBundle], vector: ca.SX) -> AnyBundle:
        """Return the bundle of a vector."""
        ends = [0]
        for item in fields(cls):
            ends.append(ends[-1] + item.metadata["rows"])
        if vector.numel() != ends[-1]:
            raise ValueError(f"{cls.__name__}: give {ends[-1]} rows; there were {vector.numel()}.")
        return cls(*[vector[start:end] for start, end in pairwise(ends)])

    @classmethod
    def symbols(cls: type[AnyBundle], name: str) -> AnyBundle:
        """Return a bundle of new symbols."""
        return cls.of(ca.SX.sym(name, cls.length()))

    @classmethod
    def length(cls) -> int:
        """Return the number of rows of all columns."""
        return sum(item.metadata["rows"] for item in fields(cls))

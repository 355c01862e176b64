"""Equations as links of a chain: parts that are generated once and called where they repeat, and narrow places.

Derivatives are taken from link to link and multiplied, which costs less than differentiating what lies behind them at
once; and what repeats is differentiated once, for all the places where it stands.
"""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass, field, fields
from functools import cached_property
from itertools import pairwise
from threading import RLock
from typing import Any, TypeVar

import casadi as ca

#: CasADi counts the users of its expressions without a lock: two threads that write equations or C crash or hang.
ONE_WRITES = RLock()


def function_of(name: str, given: list[ca.SX], result: ca.SX) -> ca.Function:
    """A function whose inputs are called like their symbols, for `equations_in_c.function_of_cells`."""
    names = [str(one[0]).rpartition("_")[0] if one.numel() > 1 else str(one) for one in given]
    return ca.Function(name, given, [ca.densify(result)], names, ["result"])


@dataclass(frozen=True)
class Part:
    """A function that is generated once and called for each of what repeats, such as the wheelsets of a vehicle.

    results: of `arguments`, by which it is differentiated, and of `constants`, by which it is not; column vectors. What
    it calls itself, and its waists, are the links of its `chain`. source: C in place of equations, behind `common`, C
    that it shares with other parts; see `part_in_c`. flat: a look-up, whose results have no slopes; its C is a
    table, see piecewise.py.
    """

    name: str
    arguments: ca.SX
    constants: ca.SX
    results: ca.SX
    chain: Chain = field(default_factory=lambda: Chain())
    source: str = ""
    common: str = ""
    flat: bool = False

    @cached_property
    def slope(self) -> ca.SX:
        """Derivatives of the results by the arguments, shape (results, arguments), structural nonzeros only."""
        if self.flat:
            return ca.SX(self.results.numel(), self.arguments.numel())
        return self.chain.jacobian(self.results, self.arguments)

    @cached_property
    def needed(self) -> list[list[int]]:
        """For each result the places of the numbers that it depends on, counted over arguments and constants."""
        given = ca.vertsplit(ca.vertcat(self.arguments, self.constants))
        if self.flat:
            return [list(range(len(given)))] * self.results.numel()
        every = [symbols_in(one) for one in ca.vertsplit(self.chain.expand(self.results))]
        return [[n for n, symbol in enumerate(given) if symbol.element_hash() in one] for one in every]

    @cached_property
    def function(self) -> ca.Function:
        """The results, and the nonzeros of their slopes, of arguments and constants."""
        both = [ca.densify(self.chain.expand(one)) for one in (self.results, self.slope.nz[:])]
        return ca.Function(self.name, [self.arguments, self.constants], both)


def part_in_c(name: str, counts: tuple[int, int, int], source: str, common: str = "") -> Part:
    """A part for what no expression can say, a search or a look-up among many: numbers of its arguments, constants and
    results, and C that defines

        static void NAME(const double *arguments, const double *constants, double *results, double *slopes)

    slopes: 0, or room for the derivatives of all results by the arguments, column by column. common: C that stands
    before it, once for all parts that have the same. Equations know of it only what depends on what: written out, its
    results are no numbers.
    """
    arguments, constants = ca.SX.sym("arguments", counts[0]), ca.SX.sym("constants", counts[1])
    all_of_it = math.nan * (ca.sum1(arguments) + ca.sum1(constants))
    return Part(name, arguments, constants, ca.repmat(all_of_it, counts[2], 1), source=source, common=common)


@dataclass(frozen=True)
class Call:
    """A part at a place in the equations: what it is given, and symbols for its results and their derivatives.

    `slopes` are the nonzeros of `slope`, the derivatives of the results by the arguments. Those of a lower `rank` are
    called first. `when`: the part is called where this is above 0; elsewhere its results are 0. `plain` is `taken`
    without the symbols of waists.
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

    @property
    def taken(self) -> ca.SX:
        """All that must be known before the call: arguments, constants, and `when` where it is no number."""
        return all_taken(self.given, self.constants, self.when)

    @cached_property
    def own(self) -> frozenset[int]:
        """Its symbols, as `symbols_in` has them."""
        return symbols_in(self.symbols)

    @cached_property
    def own_slopes(self) -> frozenset[int]:
        """Symbols of its slopes."""
        return symbols_in(self.slopes)

    @cached_property
    def found_from(self) -> list[frozenset[int]]:
        """For each result the symbols that it depends on at this place, as `symbols_in` has them."""
        taken = [symbols_in(one) for one in ca.vertsplit(self.taken)]
        always = frozenset[int]().union(*taken[self.given.numel() + self.constants.numel() :])
        return [always.union(*(taken[place] for place in places)) for places in self.part.needed]

    @cached_property
    def written_out(self) -> ca.SX:
        """The part's equations at this place, in place of `symbols` and `slopes`."""
        results, slopes = self.part.function(self.given, self.constants)
        both = ca.vertcat(results, slopes)
        return both if self.when.is_constant() else ca.if_else(self.when > 0, both, 0)


def all_taken(given: ca.SX, constants: ca.SX, when: ca.SX) -> ca.SX:
    """What a part is given at a place, one below the other; `when` where it is no number."""
    return ca.vertcat(given, constants, *([] if when.is_constant() else [when]))


def digest_of(function: ca.Function) -> str:
    """Twelve letters that functions have in common which do the same, whatever their names."""
    steps = hashlib.sha256()
    for number in range(function.n_instructions()):
        places = function.instruction_input(number), function.instruction_output(number)
        constant = function.instruction_constant(number) if function.instruction_id(number) == ca.OP_CONST else 0.0
        steps.update(repr((function.instruction_id(number), places, constant)).encode())
    return steps.hexdigest()[:12]


def symbols_in(expression: ca.SX) -> frozenset[int]:
    """Which symbols are in an expression: one look for what would be many questions whether it depends on this one."""
    return frozenset(symbol.element_hash() for symbol in ca.symvar(ca.vec(expression)))


@dataclass(frozen=True)
class Waist:
    """Few numbers on the way from states to equations, through which derivatives are taken: see `Chain.narrow`.

    `plain` are the same values without the symbols of other waists. follows: what the values are differentiated by, and
    how they follow it, shape (values, given); None: by all that is in them.
    """

    values: ca.SX
    symbols: ca.SX
    plain: ca.SX
    follows: tuple[ca.SX, ca.SX] | None = None

    @cached_property
    def own(self) -> frozenset[int]:
        """Its symbols, as `symbols_in` has them."""
        return symbols_in(self.symbols)

    @cached_property
    def found_from(self) -> list[frozenset[int]]:
        """For each value the symbols that are in it, as `symbols_in` has them."""
        return [symbols_in(one) for one in ca.vertsplit(self.values)]


@dataclass(frozen=True)
class Following:
    """Constants of a part that change with `given` all the same, as `slope` says, shape (symbols, given).

    A sine that several parts need is so computed once.
    """

    given: ca.SX
    symbols: ca.SX
    slope: ca.SX


Link = Call | Waist


@dataclass
class Chain:
    """Links in the order of their use: each may contain the symbols of those before it."""

    links: list[Link] = field(default_factory=list, kw_only=True)
    #: Of a part alone.
    following: list[Following] = field(default_factory=list, kw_only=True)

    def call(self, part: Part, given: ca.SX, constants: ca.SX, when: ca.SX | float = 1.0) -> ca.SX:
        """Results of a part, shape (results, 1); its code is shared by all calls, its derivatives are exact.

        when: above 0 where the part is needed; elsewhere its results are 0 without what it costs to find that. They
        must be 0 already where it changes its sign.
        """
        pattern = part.slope.sparsity()
        symbols, slopes = ca.SX.sym(part.name, part.results.numel()), ca.SX.sym(f"d_{part.name}", pattern.nnz())
        plain = self.without_waists(all_taken(given, constants, ca.SX(when)))
        # Constants too must be known before.
        needed = symbols_in(plain)
        rank = 1 + max((call.rank for call in self.calls if not needed.isdisjoint(call.own)), default=-1)
        slope = ca.SX(pattern, slopes)
        self.links.append(Call(part, given, constants, symbols, slopes, slope, rank, ca.SX(when), plain))
        return symbols

    def narrow(self, values: ca.SX, follows: tuple[ca.SX, ca.SX] | None = None) -> ca.SX:
        """Symbols for `values`, a column vector of few numbers between many states and long equations.

        Only derivatives know the difference: they are taken up to here and from here on, and multiplied. A force that
        enters many equations is differentiated once. follows: few numbers that the values depend on, and their slopes
        by these, where a formula for them is shorter than what differentiation finds; exact ones. What is a number
        stays one.
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
        """Declares how constants of a part change with its arguments; see `Following`."""
        self.following.append(Following(given, symbols, slope))

    @property
    def calls(self) -> list[Call]:
        """The links that are parts."""
        return [link for link in self.links if isinstance(link, Call)]

    def without_waists(self, expression: ca.SX) -> ca.SX:
        """The same expression in the symbols of calls, and none of waists."""
        waists = [link for link in self.links if isinstance(link, Waist)]
        known = [ca.vertcat(*[getattr(waist, name) for waist in waists]) for name in ("symbols", "plain")]
        return ca.substitute(ca.SX(expression), *known) if waists else ca.SX(expression)

    def expand(self, expression: ca.SX) -> ca.SX:
        """The same expression without symbols of links, the equations of all parts in their place."""
        expression = self.without_waists(expression)
        for call in reversed(self.calls):
            if not symbols_in(expression).isdisjoint(call.own | call.own_slopes):
                own = ca.vertcat(call.symbols, call.slopes)
                expression = self.without_waists(ca.substitute(expression, own, call.written_out))
        return expression

    def jacobian(self, expression: ca.SX, symbols: ca.SX) -> ca.SX:
        """Derivatives of an expression by symbols by the chain rule, link by link: each from those before it."""
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
        """Derivatives by symbols and by the constants that change with them, in one run along each symbol."""
        if not self.following:
            return ca.jacobian(one, symbols)
        together = ca.vertcat(symbols, *[constants.symbols for constants in self.following])
        along = [constants.slope @ ca.jacobian(constants.given, symbols) for constants in self.following]
        return ca.sparsify(ca.jtimes(one, together, ca.densify(ca.vertcat(ca.SX.eye(symbols.numel()), *along))))

    def _needed_by(self, expression: ca.SX) -> list[Link]:
        """The links on the way from symbols to an expression, in their order."""
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
        """Derivative of an expression along a direction of the symbols, through the parts by the chain rule."""
        known, rates = [symbols], [seed]
        for call in self.calls:
            given = ca.jtimes(self.without_waists(call.given), ca.vertcat(*known), ca.vertcat(*rates))
            known.append(call.symbols)
            rates.append(call.slope @ given)
        return ca.jtimes(self.without_waists(expression), ca.vertcat(*known), ca.vertcat(*rates))


def rows(count: int) -> Any:
    """A field of a `Bundle`: a column vector of so many rows."""
    return field(metadata={"rows": count})


AnyBundle = TypeVar("AnyBundle", bound="Bundle")


@dataclass(frozen=True)
class Bundle:
    """Column vectors under their names, which a part takes or leaves as one vector; the fields are made by `rows`."""

    @property
    def vector(self) -> ca.SX:
        """All of them, one below the other."""
        return ca.vertcat(*[getattr(self, item.name) for item in fields(self)])

    @classmethod
    def of(cls: type[AnyBundle], vector: ca.SX) -> AnyBundle:
        """The bundle of a vector."""
        ends = [0]
        for item in fields(cls):
            ends.append(ends[-1] + item.metadata["rows"])
        if vector.numel() != ends[-1]:
            raise ValueError(f"{cls.__name__}: give {ends[-1]} rows; there were {vector.numel()}.")
        return cls(*[vector[start:end] for start, end in pairwise(ends)])

    @classmethod
    def symbols(cls: type[AnyBundle], name: str) -> AnyBundle:
        """A bundle of new symbols."""
        return cls.of(ca.SX.sym(name, sum(item.metadata["rows"] for item in fields(cls))))

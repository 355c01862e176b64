"""The functions of a system that the runtime calls, and those of the parts that they call."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, replace

from fmu_src.chain import Call, Chain, Part, digest_of, symbols_in
from fmu_src.symbols import ca
from fmu_src.system import System

#: Numbers of the nonzero slopes of a part.
Slopes = tuple[int, ...]


@dataclass(frozen=True)
class Generated:
    """A function as the runtime calls it: `function` takes the arguments of the system and the results of its `calls`.

    Its first results are the arguments of the calls of each rank. After its results, a call leaves the needed ones of
    its part's nonzero slopes, by their numbers in `slopes`.
    """

    function: ca.Function
    calls: list[Call]
    slopes: list[Slopes]

    @property
    def ranks(self) -> int:
        """Return the number of results that come before those of the function itself."""
        return 1 + max((call.rank for call in self.calls), default=-1)

    def sizes(self, number: int) -> tuple[int, int]:
        """Return how many numbers a call is given and how many it leaves; number: of the call."""
        call = self.calls[number]
        return call.taken.numel(), call.symbols.numel() + len(self.slopes[number])


def functions(system: System) -> dict[str, Generated]:
    """Return the generated functions of a system; all take its `arguments`, those along a direction also the seed."""
    arguments = system.arguments
    time, states, inputs, rates = arguments[:4]
    ode = system.ode
    # Exact: d/dx, its structural nonzeros only, and along the given rates of the inputs d/dt.
    jacobian = system.jacobian(ode, states)
    time_slope = ca.densify(system.along(ode, ca.vertcat(time, inputs), ca.vertcat(1, rates)))
    costly = any(warning.candidate is not None for warning in system.warnings)
    counted = any(friction.reported for friction in system.frictions)
    reported = [friction.reported or (1.0, 1.0) for friction in system.frictions if counted]
    results: dict[str, list[ca.SX]] = {
        "derive": [ca.vertcat(*system.derived_expressions.values())],
        "start": [_start(system)],
        "ode": [ode],
        "jacobian": [jacobian.nz[:], time_slope, ode],
        "output": [ca.vertcat(*system.outputs.values())],
        "drive": [ca.vertcat(*[friction.drive for friction in system.frictions])],
        "capacity": [ca.vertcat(*[f.capacity for f in system.frictions], *[f.still for f in system.frictions])],
        "condition_margin": [ca.vertcat(*[c.first_look for c in (*system.end_conditions, *system.warnings)])],
        "warning_margin": [ca.vertcat(*[c.margin for c in system.warnings])] if costly else [],
        "reported": [ca.vertcat(*[one[which] for which in (0, 1) for one in reported])],
        "largest_change": [ca.vertcat(*[largest for _, largest in system.largest_changes])],
    }
    if system.steady_start:
        given = system.parameter_symbols[system.steady_start.given]
        start = system.without_waists(_start(system))
        results |= {"course": [system.steady_start.course], "pace": [ca.densify(ca.jacobian(start, given))]}
    for rank in range(table_ranks(system)):
        asked = [table.argument for table in system.ranked_tables if table.rank == rank]
        results[f"table_argument_{rank}"] = [ca.vertcat(*asked)]
    made = {}

    def make(name: str, expressions: list[ca.SX], given: list[ca.SX]) -> None:
        if any(expression.numel() for expression in expressions):
            plain = [ca.densify(system.without_waists(expression)) for expression in expressions]
            made[name] = function_of(system, f"{system.name}_{name}", plain, given)

    for name, expressions in results.items():
        make(name, expressions, arguments)
    along = ca.vertcat(time, states, inputs)
    seed = ca.SX.sym("seed", along.numel())
    residuals = ca.vertcat(*[system.derivatives[state.name] for state in system.states.values() if state.algebraic])
    for name, expression in (("output_along", results["output"][0]), ("residual_along", residuals)):
        make(name, [system.along(expression, along, seed)] if expression.numel() else [], [*arguments, seed])
    return made | {
        name: _shared(name, made[name]) for name in ("derive", "start") if name in made and not made[name].calls
    }


#: Prefix of the names of functions that several systems of a model share, such as levels with the same parameters.
SHARED = "shared_"


def _shared(name: str, generated: Generated) -> Generated:
    """Return the function under a name that follows from its instructions."""
    function, given = generated.function, generated.function.sx_in()
    own = f"{SHARED}{name}_{digest_of(function)}"
    return replace(generated, function=ca.Function(own, given, function.call(given, True, False)))


def is_shared(generated: Generated) -> bool:
    """Return whether a function has its own name in all systems that have it, and its own file."""
    return generated.function.name().startswith(SHARED)


def function_of(chain: Chain, name: str, expressions: list[ca.SX], given: list[ca.SX]) -> Generated:
    """Return a function with the calls that its expressions need, in the order of their ranks."""
    needed: list[Call] = []
    users = symbols_in(ca.vertcat(*[ca.vec(expression) for expression in expressions]))
    for call in reversed(chain.calls):
        if not users.isdisjoint(call.own | call.own_slopes):
            needed.insert(0, call)
            users |= symbols_in(call.plain)
    needed.sort(key=lambda call: call.rank)
    slopes = _needed_slopes(needed, users)
    left = [ca.vertcat(call.symbols, call.slopes[list(slope)]) for call, slope in zip(needed, slopes, strict=True)]
    given_to: dict[int, list[ca.SX]] = {}
    for call in needed:
        given_to.setdefault(call.rank, []).append(call.plain)
    asked = [ca.vertcat(*one) for one in given_to.values()]
    results = [*[ca.densify(one) for one in asked], *expressions]
    taken = [*given, ca.vertcat(*left)] if needed else given
    return Generated(ca.Function(name, taken, results), needed, slopes)


def _needed_slopes(calls: Sequence[Call], users: frozenset[int]) -> list[Slopes]:
    """Return the used slopes of each call, one choice for all calls of a part; all of them for a part in C."""
    used: dict[str, set[int]] = {}
    for call in calls:
        own = [n for n, one in enumerate(ca.vertsplit(call.slopes)) if one.element_hash() in users]
        used.setdefault(call.part.name, set()).update(range(call.slopes.numel()) if own and call.part.source else own)
    return [tuple(sorted(used[call.part.name])) for call in calls]


def table_ranks(system: System) -> int:
    """Return the number of ranks of the tables of a system."""
    return 1 + max((table.rank for table in system.tables), default=-1)


def _start(system: System) -> ca.SX:
    return ca.vertcat(*[state.start for state in system.states.values()])


def part_function(part: Part, slopes: Slopes) -> Generated:
    """Return a part's results of its arguments and constants, followed by these of its slopes."""
    results = ca.vertcat(part.results, part.slope.nz[list(slopes)]) if slopes else part.results
    plain = ca.densify(part.chain.without_waists(results))
    return function_of(part.chain, part_name(part, slopes), [plain], [part.arguments, part.constants])


def part_name(part: Part, slopes: Slopes) -> str:
    """Return the name of a part's function."""
    if not slopes:
        return f"part_{part.name}"
    chosen = "" if len(slopes) == part.slope.nnz() else f"_{hashlib.sha256(repr(slopes).encode()).hexdigest()[:8]}"
    return f"part_{part.name}_with_slopes{chosen}"

"""Which parameters of a model have no effect in one of its systems, told by what its equations depend on."""

from __future__ import annotations

import casadi as ca

from fmu_src.chain import Part, symbols_in
from fmu_src.system import Model, System, integration_variables


def without_effect(model: Model, system: System) -> list[str]:
    """Names of the parameters that no expression of a system depends on, in the order of the model's table.

    Not those that choose a system or a line, nor those of the integration.
    """
    common = {*model.selectors, model.line_file, *(variable.name for variable in integration_variables(1e-6))}
    having = with_effect(system) | common
    return [v.name for v in model.variables if v.causality == "parameter" and v.name not in having]


def with_effect(system: System) -> set[str]:
    """Names of the parameters that some expression of a system depends on, at once or through parts and constants."""
    needed = symbols_in(system.without_waists(ca.vertcat(*[ca.vec(one) for one in expressions_of(system)])))
    for call in reversed(system.calls):
        if not needed.isdisjoint(call.own):
            taken = ca.vertsplit(call.plain)
            for place in places_that_matter(call.part, len(taken)):
                needed |= symbols_in(taken[place])
    for name, symbol in system.derived_symbols.items():
        if not needed.isdisjoint(symbols_in(symbol)):
            needed |= symbols_in(system.derived_expressions[name])
    return {name for name, symbol in system.parameter_symbols.items() if not needed.isdisjoint(symbols_in(symbol))}


def expressions_of(system: System) -> list[ca.SX]:
    """All that the runtime computes of a system, without the observables, which it does not."""
    conditions = (*system.end_conditions, *system.warnings)
    return [
        *([system.steady_start.course] if system.steady_start else []),
        system.ode,
        *(state.start for state in system.states.values()),
        *system.outputs.values(),
        *(one for friction in system.frictions for one in (friction.drive, friction.capacity, friction.still)),
        *(one for condition in conditions for one in (condition.margin, condition.first_look)),
        *(largest for _, largest in system.largest_changes),
        *(table.argument for table in system.tables),
    ]


def places_that_matter(part: Part, count: int) -> list[int]:
    """Which of the numbers that a part is given, `when` among them, its results depend on."""
    given = ca.vertsplit(ca.vertcat(part.arguments, part.constants))
    needed = symbols_in(part.chain.expand(part.results))
    within = [place for place, symbol in enumerate(given) if not needed.isdisjoint(symbols_in(symbol))]
    return [*within, *range(len(given), count)]

"""Parameters of a model without effect in one of its systems, found from the dependencies of its equations."""

from __future__ import annotations

import math

import numpy as np

from fmu_src.chain import symbols_in
from fmu_src.symbols import ca
from fmu_src.system import Model, System
from fmu_src.variables import integration_variables

#: Draws of all parameters, their seed, and how far from their start values [decades].
DRAWS, SEED, DECADES = 16, 29, 1.0
#: Relative change of a constant that is treated as zero: round-off of cancelling terms, such as springs a hundred times
#: as stiff.
NOTHING = 1e-9


def without_effect(model: Model, system: System) -> list[str]:
    """Return the parameters on which no expression of a system depends, in the order of the model's table.

    Parameters that choose a system or name a file, and those of the integration, are not listed.
    """
    named = [variable.name for variable in model.files]
    common = {*model.selectors, *named, *(variable.name for variable in integration_variables(1e-6))}
    having = with_effect(system) | common
    return [v.name for v in model.variables if v.causality == "parameter" and v.name not in having]


def with_effect(system: System) -> set[str]:
    """Return the parameters on which some expression of a system depends, directly or through parts and constants."""
    needed = symbols_in(
        system.without_waists(ca.vertcat(*[ca.vec(expression) for expression in expressions_of(system)]))
    )
    for call in reversed(system.calls):
        if not needed.isdisjoint(call.own):
            # Arguments and constants on which the results of the part depend, and `when`, which comes after them.
            taken, within = ca.vertsplit(call.plain), {place for places in call.part.needed for place in places}
            when = range(call.part.arguments.numel() + call.part.constants.numel(), len(taken))
            for place in (*within, *when):
                needed |= symbols_in(taken[place])
    for symbol, moving in zip(system.derived_symbols.values(), what_moves_constants(system), strict=True):
        if not needed.isdisjoint(symbols_in(symbol)):
            needed |= moving
    return {name for name, symbol in system.parameter_symbols.items() if not needed.isdisjoint(symbols_in(symbol))}


def what_moves_constants(system: System) -> list[frozenset[int]]:
    """Return the parameters on which each constant made of parameters depends, tested at random values.

    Many cancel in statics: half of the weight rests on each of two springs, at any distance between them.
    """
    parameters = ca.vertcat(*system.parameter_symbols.values())
    constants = without_calls(system, ca.vertcat(*system.derived_expressions.values()))
    if constants.is_empty() or parameters.is_empty():
        return [frozenset() for _ in system.derived_expressions]
    records = ca.vertcat(*[one.symbol for one in system.records])
    own = np.array([record.value for record in system.records])
    both = [constants, ca.jacobian(constants, parameters)]
    slopes = ca.Function("slopes", [parameters, records], both)
    starts = {variable.name: variable.start for variable in system.variables}
    # 1 instead of 0, so that each can be made larger and smaller.
    start = np.array([starts[name] or 1.0 for name in system.parameter_symbols], float)
    random = np.random.default_rng(SEED)
    structure = np.array(ca.DM(ca.jacobian_sparsity(constants, parameters), 1), bool)
    moved, silent = np.zeros_like(structure), np.ones((constants.numel(), 1), bool)
    for _ in range(DRAWS):
        values = start * 10 ** random.uniform(-DECADES, DECADES, start.size)
        found, slope = (np.array(one) for one in slopes(values, own))
        told = np.all(np.isfinite(slope), axis=1, keepdims=True) & np.isfinite(found)
        moved |= told & (np.abs(slope * values) > NOTHING * np.abs(found))
        silent &= ~told
    moved |= silent & structure  # a constant that is NaN at every draw: use the symbols in it
    hashes = np.array([symbol.element_hash() for symbol in ca.vertsplit(parameters)], object)
    return [frozenset(hashes[row]) for row in moved]


def expressions_of(system: System) -> list[ca.SX]:
    """Return all expressions that the runtime computes of a system; it does not compute the observables."""
    conditions = (*system.end_conditions, *system.warnings)
    return [
        *([system.steady_start.course] if system.steady_start else []),
        system.ode,
        *(state.start for state in system.states.values()),
        *system.outputs.values(),
        *(ca.SX(one) for f in system.frictions for one in (f.drive, f.capacity, f.still, *(f.reported or ()))),
        *(one for condition in conditions for one in (condition.margin, condition.first_look)),
        *(largest for _, largest in system.largest_changes),
        *(table.argument for table in system.tables),
    ]


def without_calls(system: System, expression: ca.SX) -> ca.SX:
    """Return an expression with NaN for results of parts; it depends on the same symbols."""
    expression = system.without_waists(expression)
    for call in reversed(system.calls):
        if not symbols_in(expression).isdisjoint(call.own):
            expression = ca.substitute(
                expression, call.symbols, math.nan * ca.sum1(call.plain) * ca.SX.ones(call.symbols.shape)
            )
    return expression

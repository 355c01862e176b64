"""Dependencies of outputs and derivatives, in a step and at the start, from the sparsity of the equations."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import lru_cache

from fmu_src.chain import symbols_in
from fmu_src.model_exchange import derivative_name, exchanged_states, serves_exchange
from fmu_src.symbols import ca
from fmu_src.system import Model, System
from fmu_src.variables import state_variable

#: Symbols, each with its source: an expression, or the symbols in it as `symbols_in` returns them.
Equations = Sequence["tuple[ca.SX, ca.SX | frozenset[int]]"]


def direct_inputs(system: System) -> dict[str, set[str]]:
    """Return, for each output, the inputs that reach it without passing through a state."""
    return known_behind(system.outputs, system.input_symbols, link_equations(system))


def integrated_knowns(system: System) -> dict[str, set[str]]:
    """Return, for each output and derivative of a state, the inputs and states on which it depends between events."""
    known = system.input_symbols | {state_variable(state.name): state.symbol for state in system.states.values()}
    tables = [(table.symbols, table.argument) for table in system.tables]
    return known_behind(system.outputs | _derivatives(system), known, [*link_equations(system), *tables])


def _derivatives(system: System) -> dict[str, ca.SX]:
    return {derivative_name(name): system.derivatives[name] for name in system.states}


def start_knowns(system: System) -> dict[str, set[str]]:
    """Return, for each output, state and derivative, the inputs and parameters on which its start value depends.

    States begin at their start values, and algebraic states are solved for. A friction at rest sticks or slides
    according to its drive and capacity. The tolerance of the solution for algebraic states is not listed.
    """
    states = {state_variable(state.name): state.symbol for state in system.states.values()}
    unknown = system.outputs | states | _derivatives(system)
    return known_behind(unknown, system.input_symbols | system.parameter_symbols, start_equations(system))


def known_behind(unknown: Mapping[str, ca.SX], known: Mapping[str, ca.SX], equations: Equations) -> dict[str, set[str]]:
    """Return, for each `unknown`, the names of the `known` symbols that reach it, also through those of `equations`."""
    names = list(known)
    symbols = ca.vertcat(*known.values(), *[symbol for symbol, _ in equations])
    place = {symbol.element_hash(): number for number, symbol in enumerate(ca.vertsplit(symbols))}

    def places(found_from: ca.SX | frozenset[int]) -> set[int]:
        within = found_from if isinstance(found_from, frozenset) else symbols_in(found_from)
        return {place[symbol] for symbol in within if symbol in place}

    needed: list[set[int]] = [set() for _ in names]
    seen: dict[int, set[int]] = {}  # a shared source is searched once
    for symbol, found_from in equations:
        if id(found_from) not in seen:
            seen[id(found_from)] = places(found_from)
        needed += [seen[id(found_from)]] * symbol.numel()
    return {
        name: {names[place] for place in closure(places(expression), needed) if place < len(names)}
        for name, expression in unknown.items()
    }


def start_equations(system: System) -> Equations:
    """Return the symbols that are determined at the start, each with its sources."""
    found: list[tuple[ca.SX, ca.SX | frozenset[int]]] = [
        (symbol, system.derived_expressions[name]) for name, symbol in system.derived_symbols.items()
    ]
    found += [(state.symbol, state.start) for state in system.states.values() if not state.algebraic]
    found += settled_equations(system)
    found += [(table.symbols, table.argument) for table in system.tables]
    found += link_equations(system)
    for friction in system.frictions:
        velocity = [system.states[name].symbol for name in friction.states]
        found.append((friction.direction, ca.vertcat(*velocity, friction.drive, friction.capacity, friction.still)))
    unknowns = [state.symbol for state in system.states.values() if state.algebraic]
    residuals = [system.derivatives[state.name] for state in system.states.values() if state.algebraic]
    if unknowns:
        # Any assignment of equations to unknowns will do: those of a coupled set reach each other through it.
        pattern = ca.jacobian_sparsity(ca.vertcat(*residuals), ca.vertcat(*unknowns))
        _, rows, columns, *_ = pattern.btf()
        found += [(unknowns[column], residuals[row]) for row, column in zip(rows, columns, strict=True)]
    return found


def settled_equations(system: System) -> list[tuple[ca.SX, ca.SX]]:
    """Return the states that a steady start finds, each with the derivatives, without drives and frictions, that must
    vanish.
    """
    steady = system.steady_start
    if steady is None:
        return []
    released = ca.vertcat(
        *[system.input_symbols[name] for name in steady.drives], *[friction.direction for friction in system.frictions]
    )
    changes = system.without_waists(ca.vertcat(steady.course, system.ode))
    found_by = ca.substitute(changes, released, ca.SX.zeros(released.numel()))
    settling = [state for name, state in system.states.items() if name not in {steady.speed, *steady.kept}]
    return [(state.symbol, found_by) for state in settling if not state.algebraic]


def link_equations(system: System) -> Equations:
    """Return the results of parts and `Waist` links, each with the symbols on which it depends."""
    every = [(ca.vertsplit(link.symbols), link.found_from) for link in system.links]
    return [pair for symbols, found_from in every for pair in zip(symbols, found_from, strict=True)]


def closure(begin: Iterable[int], needed: list[set[int]]) -> set[int]:
    """Return all that can be reached from a set, itself included."""
    reached, waiting = set[int](), set(begin)
    while waiting:
        reached |= waiting
        waiting = set().union(*(needed[place] for place in waiting)) - reached
    return reached


@lru_cache(maxsize=32)
def input_dependencies(model: Model) -> Mapping[str, set[str]]:
    """Return, for each unknown of a model, the inputs that reach it directly in any of its systems; found once."""
    return union(model, model.systems, direct_inputs)


@lru_cache(maxsize=32)
def step_dependencies(model: Model) -> Mapping[str, set[str]]:
    """Return the same, with the inputs and states on which it depends if the host integrates."""
    found = {name: set(names) for name, names in input_dependencies(model).items()}
    integrated = [system for system in model.systems if serves_exchange(model, system)]
    for name, names in union(model, integrated, integrated_knowns).items():
        found[name] |= names
    return found


@lru_cache(maxsize=32)
def start_dependencies(model: Model) -> Mapping[str, set[str]]:
    """Return, for each unknown, its dependencies at the start in any system of the model, selectors included."""
    found = union(model, model.systems, start_knowns)
    for names in found.values():
        names |= set(model.selectors)
    return found


def unknowns(model: Model) -> list[str]:
    """Return the outputs and, if the host integrates, states and derivatives."""
    outputs = [variable.name for variable in model.variables if variable.causality == "output"]
    states = [state.name for state in exchanged_states(model)]
    return [*outputs, *map(state_variable, states), *map(derivative_name, states)]


def union(model: Model, systems: Iterable[System], of: Callable[[System], dict[str, set[str]]]) -> dict[str, set[str]]:
    """Return, for each unknown of a model, the names that `of` finds in any of the systems."""
    found: dict[str, set[str]] = {name: set() for name in unknowns(model)}
    for system in systems:
        for name, names in of(system).items():
            if name in found:
                found[name] |= names
    return found

"""What each output depends on: in a step, and at the start. By the sparsity of the equations, FMI 2.0 section 2.2.8."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

import casadi as ca

from fmu_src.chain import symbols_in
from fmu_src.system import Model, System


def direct_inputs(system: System) -> dict[str, set[str]]:
    """For each output the inputs that reach it without passing through a state."""
    return known_behind(system, system.input_symbols, link_equations(system))


def start_knowns(system: System) -> dict[str, set[str]]:
    """For each output the inputs and parameters that its value at the start depends on.

    States begin at their start values, algebraic states are solved for, and a friction at rest sticks or slides as its
    drive and its capacity decide. The tolerance, to which algebraic states are solved for, is not counted.
    """
    return known_behind(system, system.input_symbols | system.parameter_symbols, start_equations(system))


def known_behind(
    system: System, known: Mapping[str, ca.SX], equations: Sequence[tuple[ca.SX, ca.SX]]
) -> dict[str, set[str]]:
    """For each output the names of those `known` that it depends on, also through symbols that equations stand for."""
    names = list(known)
    symbols = ca.vertcat(*known.values(), *[symbol for symbol, _ in equations])
    place = {symbol.element_hash(): number for number, symbol in enumerate(ca.vertsplit(symbols))}

    def places(expression: ca.SX) -> set[int]:
        return {place[symbol] for symbol in symbols_in(expression) if symbol in place}

    needed: list[set[int]] = [set() for _ in names]
    for symbol, expression in equations:
        needed += [places(expression)] * symbol.numel()
    return {
        output: {names[place] for place in closure(places(expression), needed) if place < len(names)}
        for output, expression in system.outputs.items()
    }


def start_equations(system: System) -> list[tuple[ca.SX, ca.SX]]:
    """What is found at the start, each with an expression of all that it is found from."""
    found = [(symbol, system.derived_expressions[name]) for name, symbol in system.derived_symbols.items()]
    found += [(state.symbol, state.start) for state in system.states.values() if not state.algebraic]
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


def link_equations(system: System) -> list[tuple[ca.SX, ca.SX]]:
    """Results of parts and waists, each with what it is found from."""
    every = [(ca.vertsplit(link.symbols), ca.vertsplit(link.values)) for link in system.links]
    return [pair for symbols, values in every for pair in zip(symbols, values, strict=True)]


def closure(begin: Iterable[int], needed: list[set[int]]) -> set[int]:
    """All that can be reached from a set, itself included."""
    reached, waiting = set(), list(begin)
    while waiting:
        place = waiting.pop()
        if place not in reached:
            reached.add(place)
            waiting += needed[place]
    return reached


def step_dependencies(model: Model) -> Mapping[str, set[str]]:
    """For each output of a model the inputs that reach it directly in any of its systems."""
    return union(model, direct_inputs)


def start_dependencies(model: Model) -> Mapping[str, set[str]]:
    """For each output of a model what it depends on at the start in any of its systems, and what chooses among them."""
    found = union(model, start_knowns)
    for names in found.values():
        names |= set(model.selectors)
    return found


def union(model: Model, of: Callable[[System], dict[str, set[str]]]) -> dict[str, set[str]]:
    """For each output of a model the names that `of` finds in any of its systems."""
    found: dict[str, set[str]] = {v.name: set() for v in model.variables if v.causality == "output"}
    for system in model.systems:
        for output, names in of(system).items():
            found[output] |= names
    return found

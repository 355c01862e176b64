"""What each output depends on: in a step, and at the start. By the sparsity of the equations, FMI 2.0 section 2.2.8."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

import casadi as ca

from fmu_src.system import Model, System


def direct_inputs(system: System) -> dict[str, set[str]]:
    """For each output the inputs that reach it without passing through a state."""
    names = list(system.input_symbols)
    inputs = ca.vertcat(*system.input_symbols.values())
    expanded = {output: system.expand(expression) for output, expression in system.outputs.items()}
    return {output: {names[place] for place in places(expanded[output], inputs)} for output in expanded}


def start_knowns(system: System) -> dict[str, set[str]]:
    """For each output the inputs and parameters that its value at the start depends on.

    States begin at their start values, algebraic states are solved for, and a friction at rest sticks or slides as its
    drive and its capacity decide. The tolerance, to which algebraic states are solved for, is not counted.
    """
    names = [*system.input_symbols, *system.parameter_symbols]
    equations = start_equations(system)
    known = [*system.input_symbols.values(), *system.parameter_symbols.values()]
    symbols = ca.vertcat(*known, *[symbol for symbol, _ in equations])
    needed: list[set[int]] = [set() for _ in names]
    for symbol, expression in equations:
        needed += [places(expression, symbols)] * symbol.numel()
    return {
        output: {names[place] for place in closure(places(expression, symbols), needed) if place < len(names)}
        for output, expression in system.outputs.items()
    }


def start_equations(system: System) -> list[tuple[ca.SX, ca.SX]]:
    """What is found at the start, each with an expression of all that it is found from."""
    found = [(symbol, system.derived_expressions[name]) for name, symbol in system.derived_symbols.items()]
    found += [(state.symbol, state.start) for state in system.states.values() if not state.algebraic]
    found += [(table.symbols, table.argument) for table in system.tables]
    for link in system.links:
        found += zip(ca.vertsplit(link.symbols), ca.vertsplit(link.values), strict=True)
    for friction in system.frictions:
        velocity = system.states[friction.velocity].symbol
        found.append((friction.direction, ca.vertcat(velocity, friction.drive, friction.capacity)))
    unknowns = [state.symbol for state in system.states.values() if state.algebraic]
    residuals = [system.derivatives[state.name] for state in system.states.values() if state.algebraic]
    if unknowns:
        # Any assignment of equations to unknowns will do: those of a coupled set reach each other through it.
        pattern = ca.jacobian_sparsity(ca.vertcat(*residuals), ca.vertcat(*unknowns))
        _, rows, columns, *_ = pattern.btf()
        found += [(unknowns[column], residuals[row]) for row, column in zip(rows, columns, strict=True)]
    return found


def places(expression: ca.SX, symbols: ca.SX) -> set[int]:
    """Which of the symbols are in an expression."""
    return set(ca.jacobian_sparsity(ca.vec(ca.SX(expression)), symbols).get_col()) if symbols.numel() else set()


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

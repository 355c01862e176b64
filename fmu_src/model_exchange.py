"""Variables of model exchange in addition to the table of variables: derivatives of the states, and event indicators.

A host integrates the equations itself and reads the number of states beforehand: it is that of the system which the
start values choose, unless that one has algebraic states. Their value references follow those of the table and of the
time.
"""

from __future__ import annotations

from fmu_src.states import State
from fmu_src.system import NONE, Model, System, Variable
from fmu_src.variables import state_variable


def exchanged(model: Model) -> System | None:
    """Return the system that the start values choose; None if there is no model exchange."""
    place = 0
    for name in model.selectors:
        selector = model.variables[model.index(name)]
        place = place * int(selector.maximum) + int(selector.start) - 1
    chosen = model.choice[place] if model.systems else NONE
    if chosen == NONE or any(state.algebraic for state in model.systems[chosen].states.values()):
        return None
    return model.systems[chosen]


def serves_exchange(model: Model, system: System) -> bool:
    """Return whether a system has the same states, in their order, and the same switches as the exchanged one."""
    of = exchanged(model)
    return of is not None and _shape(system) == _shape(of)


def _shape(system: System) -> list[tuple[object, ...]]:
    return [
        *((state.name, state.algebraic) for state in system.states.values()),
        *(friction.states for friction in system.frictions),
        *((condition.sentence,) for condition in system.end_conditions),
    ]


def exchanged_states(model: Model) -> list[State]:
    """Return the states that a host integrates, in their order."""
    of = exchanged(model)
    return list(of.states.values()) if of else []


def reset_at_events(model: Model) -> set[str]:
    """Return the names of the states that an event may set to another value: velocities that begin to stick."""
    of = exchanged(model)
    return {friction.states[0] for friction in of.frictions} if of else set()


def derivative_name(state: str) -> str:
    """Return the name of the variable that shows the derivative of a state."""
    return f"der({state_variable(state)})"


def derivatives(model: Model) -> list[Variable]:
    """Return the derivatives of the states that a host integrates, in their order."""
    return [
        Variable(derivative_name(state.name), "local", rate_unit(state.unit), f"Derivative of state {state.name}")
        for state in exchanged_states(model)
    ]


def indicators(model: Model) -> list[Variable]:
    """Return the event indicators: one for each dry friction, and one for each condition that ends a run."""
    of = exchanged(model)
    if not of:
        return []
    texts = [f"{friction.label}: {friction.stuck_word} or {friction.sliding_word}" for friction in of.frictions]
    texts += [condition.sentence.split(" at %s")[0] for condition in of.end_conditions]
    return [
        Variable(f"event_indicator_{number}", "local", "1", f"Crosses 0 at an event. {text}")
        for number, text in enumerate(texts, 1)
    ]


def first_reference(model: Model) -> int:
    """Return the value reference of the first derivative; those of the others, and of the indicators, follow."""
    return len(model.variables) + 1


def rate_unit(unit: str) -> str:
    """Return the unit of a derivative by time, "m/s2" for "m/s"."""
    return f"{unit}2" if unit.endswith("/s") else f"{unit}/s"

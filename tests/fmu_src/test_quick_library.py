"""The cache finds a library by the whole content of its model: any change of a model gives another library."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import casadi as ca
import pytest

from fmu_src.system import Model, System, Variable, model_of
from tests.fmu_src.quick_library import content_of


def brick(change: Callable[[System], object] = lambda _: None, **values: float) -> Model:
    """Return the model of a brick on a table; `change` alters its system, and `values` replace its numbers 1."""
    number = {"start": 1.0, "factor": 1.0, "nominal": 1.0, "slope": 1.0} | values
    system = System("Brick", "A brick on a table")
    push = system.input(Variable("push", "input", "N", "Force forward"))
    v = system.state("speed", "m/s", lambda: ca.SX(number["start"]), number["nominal"])
    direction = system.direction("direction")
    system.derivative(v, direction**2 * (number["factor"] * push - direction))
    system.dry_friction("The brick", direction, [v], push, 1.0, ("stuck", "slides"))
    system.end_when_negative(2.0 - number["slope"] * v, "Too fast at %s s.")
    system.output(Variable("shown", "output", "m/s", "Speed"), v)
    change(system)
    return model_of(system, 1e-6)


def one_symbol_twice(system: System) -> None:
    system.outputs["shown"] = ca.SX.sym("speed")


def another_sentence(system: System) -> None:
    system.end_conditions[0] = replace(system.end_conditions[0], sentence="Too slow at %s s.")


def another_word(system: System) -> None:
    system.frictions[0] = replace(system.frictions[0], stuck_word="held")


def function_as_a_limit(system: System) -> None:
    other_kind: Any = abs
    system.largest_changes.append((("speed",), other_kind))


def test_the_same_model_has_the_same_content() -> None:
    assert content_of(brick()) == content_of(brick())


@pytest.mark.parametrize("name", ["start", "factor", "nominal", "slope"])
def test_a_number_that_differs_in_its_last_bit_is_another_model(name: str) -> None:
    assert content_of(brick(**{name: 1.0 + 2.0**-52})) != content_of(brick())


@pytest.mark.parametrize("change", [one_symbol_twice, another_sentence, another_word])
def test_a_model_with_a_changed_part_is_another_one(change: Callable[[System], object]) -> None:
    """This includes a symbol replaced by another one of the same name."""
    assert content_of(brick(change)) != content_of(brick())


def test_what_cannot_be_compared_is_refused() -> None:
    with pytest.raises(TypeError, match="A part of a model must be a number, text, expression or dataclass; got"):
        content_of(brick(function_as_a_limit))

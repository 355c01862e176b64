"""Parts and shared intermediate variables change the generated code and its derivatives, but no values."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache

import casadi as ca
import numpy as np
import pytest

from fmu_src.chain import Bundle, Chain, Part, part_in_c, rows
from fmu_src.codegen import generate
from fmu_src.compile import build_library
from fmu_src.dependencies import direct_inputs
from fmu_src.equations import functions
from fmu_src.kernel import Kernel, Library
from fmu_src.system import System, Variable, model_of

#: Rounding errors: derivatives by two orders of the chain rule, and motions of the same equations.
ROUND_OFF = 1e-12


@lru_cache
def hardening_in_c() -> Part:
    """Return the same part, given in C."""
    source = """#include <math.h>
static void hardening_in_c(const double *arguments, const double *constants, double *results, double *slopes) {
  const double way = arguments[0], force = way + constants[0] * way * way * way + sin(arguments[1]);
  results[0] = force;
  results[1] = force * force;
  if (slopes)
    for (int i = 0; i < 2; ++i) {
      slopes[2 * i] = i ? cos(arguments[1]) : 1 + 3 * constants[0] * way * way;
      slopes[2 * i + 1] = 2 * force * slopes[2 * i];
    }
}"""
    return part_in_c("hardening_in_c", (2, 1, 2), source)


def softened(inner: Part) -> Part:
    """Return a part that calls another: a spring behind a lever, which shares its displacement."""
    way, rate, hard = ca.SX.sym("way"), ca.SX.sym("rate"), ca.SX.sym("hard")
    chain = Chain()
    found = chain.call(inner, ca.vertcat(way * 1.1, rate - way), hard)
    return Part(f"softened_{inner.name}", ca.vertcat(way, rate), hard, found * ca.vertcat(1.0, 1 + way), chain)


@lru_cache
def hardening() -> Part:
    """Return force and squared force of a hardening spring by displacement and rate; `hard` is the cubic stiffness."""
    way, rate, hard = ca.SX.sym("way"), ca.SX.sym("rate"), ca.SX.sym("hard")
    force = way + hard * way**3 + ca.sin(rate)
    return Part("hardening", ca.vertcat(way, rate), hard, ca.vertcat(force, force**2))


def two_masses(parts: bool, of: Callable[[], Part] | None = None) -> System:
    """Return two masses in a row. The second spring depends on the first one's force, so its call is of rank 1.

    of: law of the springs, `hardening` by default.
    """
    system = System("masses", "two masses on hardening springs")
    push = system.input(Variable("push", "input", "N", "Force on the second mass"))
    hard = system.parameter(Variable("hard", "parameter", "1", "Hardening", 0.3))
    x = [system.state(f"x_{n}", "m", 0.1 * n, 1.0) for n in (1, 2)]
    v = [system.state(f"v_{n}", "m/s", 0.2 * n, 1.0) for n in (1, 2)]
    part = (of or hardening)()

    def law(way: ca.SX, rate: ca.SX) -> ca.SX:
        given = ca.vertcat(way, rate)
        if parts:
            return system.call(part, given, hard)
        return ca.substitute(part.results, ca.vertcat(part.arguments, part.constants), ca.vertcat(given, hard))

    first = law(x[0], v[0])
    second = law(x[1] - x[0] + 0.1 * first[1], v[1] - v[0] + push)
    pull = system.narrow(second[0] + 0.01 * second[1]) if parts else second[0] + 0.01 * second[1]
    for n in (0, 1):
        system.derivative(x[n], v[n])
    system.derivative(v[0], pull - first[0])
    system.derivative(v[1], push - pull)
    system.output(Variable("carried", "output", "N", "Force of the first spring"), first[0] * pull)
    return system


#: Laws with parts, and the same laws written out.
LAWS = {
    "one part": (hardening, hardening),
    "a part that calls one": (lambda: softened(hardening()), None),
    "a part in C": (hardening_in_c, hardening),
    "a part that calls one in C": (lambda: softened(hardening_in_c()), lambda: softened(hardening())),
}


def written_out(part: Part) -> Part:
    """Return the same part with the part that it calls written out."""
    return replace(part, name="plain", results=part.chain.expand(part.results), chain=Chain())


@pytest.mark.study
@pytest.mark.parametrize("name", LAWS)
def test_equations_with_parts_are_those_without(name: str) -> None:
    found = []
    called, plain = LAWS[name]
    systems = two_masses(True, called), two_masses(False, lambda: written_out((plain or called)()))
    for library in [Library(build_library(model_of(system, 1e-9))) for system in systems]:
        kernel = Kernel(library, push=0.5)
        kernel.initialise()
        found.append((np.array(kernel.linearise().jacobian), np.array(kernel.linearise().slope)))
        kernel.advance(3.0)
        found[-1] += (np.array([kernel["carried"], kernel["state_x_1"], kernel["state_v_2"]]),)
    for one, other in zip(*found, strict=True):
        assert np.abs(one - other).max() < ROUND_OFF * np.abs(other).max()
    assert np.abs(found[0][0]).max() > 1.0


def test_a_part_is_generated_once_and_called_in_the_order_of_its_ranks() -> None:
    system = two_masses(parts=True)
    assert [call.rank for call in system.calls] == [0, 1]
    made = functions(system)["jacobian"]
    assert all(made.slopes)
    assert made.ranks == 2
    assert len({call.part.name for call in made.calls}) == 1


def test_outputs_depend_on_inputs_through_parts() -> None:
    assert direct_inputs(two_masses(parts=True)) == direct_inputs(two_masses(parts=False)) == {"carried": {"push"}}


def test_derivatives_along_a_direction_pass_through_parts() -> None:
    """Compare with the derivative of the expanded expression."""
    system, seed = two_masses(parts=True), ca.SX.sym("seed", 4)
    states = system.arguments[1]
    output = system.outputs["carried"]
    exact = ca.jtimes(system.expand(output), states, seed)
    through = system.along(output, states, seed)
    for call in system.calls:
        own = ca.jacobian(call.part.results, call.part.arguments)
        at = ca.vertcat(call.part.arguments, call.part.constants), ca.vertcat(call.given, call.constants)
        through = ca.substitute(through, call.slopes, ca.densify(ca.substitute(own, *at)).nz[:])
    difference = ca.Function("d", [*system.arguments, seed], [system.expand(through) - exact, exact])
    values = [ca.DM.ones(*difference.size_in(i)) * 0.3 for i in range(difference.n_in())]
    error, size = (float(x) for x in difference(*values))
    assert abs(error) < ROUND_OFF * abs(size)
    assert size != pytest.approx(0.0)


@lru_cache
def bob() -> Part:
    """Return a pendulum's bob; cosine and sine of its angle are constants, a called part gives its length."""
    angle, pull, cosines, hard = (ca.SX.sym(name, count) for name, count in (("a", 1), ("p", 1), ("c", 2), ("h", 1)))
    chain = Chain()
    chain.follow(cosines, angle, ca.vertcat(-cosines[1], cosines[0]))
    length = 1 + chain.narrow(chain.call(hardening(), ca.vertcat(pull, pull * angle), hard)[0])
    return Part("bob", ca.vertcat(angle, pull), ca.vertcat(cosines, hard), length * cosines, chain)


def test_a_part_may_call_a_part_and_be_given_what_changes_with_its_arguments() -> None:
    """Compare its slopes with those of the same equations written out."""
    angle, pull, hard = (ca.SX.sym(name) for name in ("angle", "pull", "hard"))
    given, constants = ca.vertcat(angle, pull), ca.vertcat(ca.cos(angle), ca.sin(angle), hard)
    results, slopes = bob().function(given, constants)
    way, rate = pull, pull * angle
    plain = (1 + way + hard * way**3 + ca.sin(rate)) * ca.vertcat(ca.cos(angle), ca.sin(angle))
    difference = ca.vertcat(results - plain, slopes - ca.jacobian(plain, given).nz[:])
    found = np.array(ca.Function("d", [given, hard], [difference])([0.7, 0.4], 0.3)).ravel()
    assert found.shape == (6,)
    assert np.abs(found).max() < ROUND_OFF


def test_bundle_takes_vectors_apart_and_puts_them_together() -> None:
    @dataclass(frozen=True)
    class Two(Bundle):
        place: ca.SX = rows(2)
        force: ca.SX = rows(1)

    vector = ca.SX.sym("v", 3)
    assert ca.is_equal(Two.of(vector).vector, vector)
    assert Two.symbols("two").force.numel() == 1
    with pytest.raises(ValueError, match=r"Two: give 3 rows; there were 4\."):
        Two.of(ca.SX.sym("v", 4))


def test_two_parts_of_one_name_are_refused() -> None:
    """Both calls would use the code of one part."""
    system = two_masses(parts=True)
    softer = replace(hardening(), results=2 * hardening().results)
    softer_force = system.call(softer, system.arguments[1][:2], system.parameter_symbols["hard"])
    system.derivative(system.states["v_1"].symbol, softer_force[0] + system.calls[0].symbols[0])
    with pytest.raises(ValueError, match=r"Two parts have one name, hardening; give each part a name of its own\."):
        generate(model_of(system, 1e-9))


def test_a_part_in_c_written_out_is_no_number_but_depends_on_what_it_is_given() -> None:
    assert direct_inputs(two_masses(True, hardening_in_c)) == direct_inputs(two_masses(True))
    results, slopes = hardening_in_c().function(ca.DM([0.1, 0.2]), 0.3)
    assert np.isnan(np.array(results)).all()
    assert np.isnan(np.array(slopes)).all()
    assert slopes.numel() == 4

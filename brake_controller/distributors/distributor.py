"""What a distributor is: data, and functions of a moment, of which the C of trains is generated.

A file beside this one has a parameter set, the function `whole` and, where it is cheaper, `empirical`, and a
`Distributor` that holds them. `uic.py` is the example. Trains may mix distributors.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import casadi as ca

from brake_controller.brake_pipe import Air, air_of
from fmu_src.chain import function_of
from fmu_src.system import ParameterSet, quantity

#: What wheel-slide protection commands, as shares: no air into the cylinder nor out; the cylinder open to the
#: surroundings.
COMMANDED = ("held", "vented")
#: How a state may begin: charged as the pipe, at the pressure around, at that of the cylinders [Pa].
STARTS = ("charged", "around", "cylinder")
#: The state that presses the brake.
CYLINDER = "cylinder"


@dataclass(frozen=True)
class DistributorParameters(ParameterSet):
    """Parameters that every distributor has. Pressures are differences or gauge pressures."""

    full_pressure: float = quantity("Pa", "Largest pressure of the cylinder", 0.0)


@dataclass(frozen=True)
class Moment:
    """What a distributor is given: its states [Pa, absolute], air in the pipe, parameters and commands by name."""

    states: Mapping[str, ca.SX]
    pipe: Air
    given: Mapping[str, ca.SX]


@dataclass(frozen=True)
class Answer:
    """What it gives: rates of its states [Pa/s]; from the pipe air [kg/s] and its enthalpy [W]; air to the cylinder
    [kg/s].
    """

    rates: Mapping[str, ca.SX | float]
    taken: ca.SX
    enthalpy: ca.SX
    filling: ca.SX


#: Numbers of an answer behind its rates.
ANSWERED = ("taken", "enthalpy", "filling")


@dataclass(frozen=True)
class Distributor:
    """A kind of distributor.

    Attributes
    ----------
    name : str
        Its name in consists and in C: small letters, digits, underscores.
    parameters : type of DistributorParameters
        The set that a vehicle holds, by which its kind is found.
    states : tuple of (str, str)
        Its states, absolute pressures [Pa] above zero, and how each begins, one of STARTS. One is `cylinder`.
    ready : callable
        From the position ("P" or "G") to a ready set of parameters.
    whole, empirical : callable
        From a `Moment` to an `Answer`; empirical: for the cheaper depths of a train's brake, if there is such a form.
    pace, empirical_pace : callable, float
        How fast a state comes to rest at most [1/s], of parameters and of the empirical form; steps follow from it.

    Raises
    ------
    ValueError
        If a name cannot be one, or no state is the cylinder.
    """

    name: str
    parameters: type[DistributorParameters]
    states: tuple[tuple[str, str], ...]
    ready: Callable[[str], DistributorParameters]
    whole: Callable[[Moment], Answer]
    pace: Callable[[Any], float]
    empirical: Callable[[Moment], Answer] | None = None
    empirical_pace: float = 0.0

    def __post_init__(self) -> None:
        if not re.fullmatch(r"[a-z][a-z0-9_]*", self.name):
            raise ValueError(
                f"The name of a distributor must be small letters, digits and underscores; got {self.name!r}. "
                "Rename it."
            )
        starts = dict(self.states)
        if CYLINDER not in starts or not set(starts.values()) <= set(STARTS):
            raise ValueError(
                f"States of a distributor must begin as {', '.join(STARTS)}, and one must be called {CYLINDER}; got "
                f"{starts}. Correct them."
            )

    def depths(self) -> tuple[str, str]:
        """Return the form that serves the whole depth of a train's brake, and that of the cheaper ones."""
        return ("whole", "empirical" if self.empirical else "whole")

    def fastest(self, parameters: DistributorParameters, depth: str) -> float:
        """Return how fast a state comes to rest at most [1/s] in a depth of the brake."""
        return self.pace(parameters) if depth == "whole" or not self.empirical else self.empirical_pace

    def fields(self) -> tuple[str, ...]:
        """Return the names of its parameters in their order."""
        return tuple(self.parameters.__dataclass_fields__)

    def function(self, depth: str) -> ca.Function:
        """Return `whole` or `empirical` as a function of states, cell of the pipe, parameters and commands.

        Its result: rates of the states, and ANSWERED. Air in the cell is an ideal gas.
        """
        names = [name for name, _ in self.states]
        sizes = {"states": len(names), "pipe": 3, "given": len(self.fields()), "command": len(COMMANDED)}
        symbols = [ca.SX.sym(name, size) for name, size in sizes.items()]
        states = dict(zip(names, ca.vertsplit(symbols[0]), strict=True))
        values = [*ca.vertsplit(symbols[2]), *ca.vertsplit(symbols[3])]
        given = dict(zip([*self.fields(), *COMMANDED], values, strict=True))
        answer: Answer = getattr(self, depth)(Moment(states, air_of(symbols[1]), given))
        found = [answer.rates[name] for name in names] + [getattr(answer, name) for name in ANSWERED]
        return function_of(f"{self.name}_{depth}", symbols, ca.SX(ca.vertcat(*found)))

"""Definition of a distributor: data, and functions of a moment from which the C code of trains is generated.

A file in this folder has a parameter set, the function `whole` and, if it is cheaper, `empirical`, and a `Distributor`
that holds them. `uic.py` is the example. Trains may mix distributors.
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

#: Commands of wheel-slide protection, as shares: no air into or out of the cylinder; the cylinder open to the
#: surroundings. Electric commands: demanded share of the cylinder's full pressure, which an electric brake reduces;
#: share of full service that drivers order.
COMMANDED = ("held", "vented", "demanded", "ordered")
#: Initial pressures of a state: charged as the pipe, ambient, that of the cylinders [Pa].
STARTS = ("charged", "around", "cylinder")
#: The state that presses the brake.
CYLINDER = "cylinder"


@dataclass(frozen=True)
class DistributorParameters(ParameterSet):
    """Parameters that every distributor has. Pressures are differences or gauge pressures."""

    full_pressure: float = quantity("Pa", "Largest pressure of the cylinder", 0.0)


@dataclass(frozen=True)
class Moment:
    """Arguments of a distributor: its states [Pa, absolute], air in the pipe, parameters and commands by name."""

    states: Mapping[str, ca.SX]
    pipe: Air
    given: Mapping[str, ca.SX]


@dataclass(frozen=True)
class Answer:
    """Results of a distributor: rates of its states [Pa/s]; air from the pipe [kg/s] and its enthalpy [W].

    filling: air to the cylinder [kg/s].
    """

    rates: Mapping[str, ca.SX | float]
    taken: ca.SX
    enthalpy: ca.SX
    filling: ca.SX


#: Numbers of an answer after its rates.
ANSWERED = ("taken", "enthalpy", "filling")


@dataclass(frozen=True)
class Distributor:
    """A kind of distributor.

    Attributes
    ----------
    name : str
        Its name in consists and in C: small letters, digits, underscores.

    parameters : type of DistributorParameters
        The set that a vehicle holds. It determines the kind.

    states : tuple of (str, str)
        Its states, absolute pressures [Pa] above zero, each with its start, one of STARTS. One is `cylinder`.

    ready : callable
        Function of the position ("P" or "G") for a built-in set of parameters.

    whole, empirical : callable
        Functions of a `Moment` for an `Answer`. The empirical form, if it exists, is for the cheaper brake models of
        trains.

    pace, empirical_pace : callable, float
        Largest rate at which a state comes to rest [1/s], by parameters and for the empirical form; it determines
        steps.

    without_effect : tuple of str
        Columns of a consist that have no effect on it; a consist with one is refused.

    wired : bool
        Whether the command `demanded` controls it, with a dead time; its electric brake is blended.

    assisted : bool
        Whether the command `ordered` acts on the pipe at this vehicle.

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
    without_effect: tuple[str, ...] = ()
    wired: bool = False
    assisted: bool = False

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

    def brake_models(self) -> tuple[str, str]:
        """Return the form for the full brake model of a train, and that for the cheaper ones."""
        return ("whole", "empirical" if self.empirical else "whole")

    def fastest(self, parameters: DistributorParameters, brake_model: str) -> float:
        """Return the largest rate at which a state comes to rest [1/s] in a brake model."""
        return self.pace(parameters) if brake_model == "whole" or not self.empirical else self.empirical_pace

    def fields(self) -> tuple[str, ...]:
        """Return the names of its parameters in their order."""
        return tuple(self.parameters.__dataclass_fields__)

    def function(self, brake_model: str) -> ca.Function:
        """Return `whole` or `empirical` as a function of states, cell of the pipe, parameters and commands.

        Its result: rates of the states, and ANSWERED. Air in the cell is an ideal gas.
        """
        names = [name for name, _ in self.states]
        sizes = {"states": len(names), "pipe": 3, "given": len(self.fields()), "command": len(COMMANDED)}
        symbols = [ca.SX.sym(name, size) for name, size in sizes.items()]
        states = dict(zip(names, ca.vertsplit(symbols[0]), strict=True))
        values = [*ca.vertsplit(symbols[2]), *ca.vertsplit(symbols[3])]
        given = dict(zip([*self.fields(), *COMMANDED], values, strict=True))
        answer: Answer = getattr(self, brake_model)(Moment(states, air_of(symbols[1]), given))
        found = [answer.rates[name] for name in names] + [getattr(answer, name) for name in ANSWERED]
        return function_of(f"{self.name}_{brake_model}", symbols, ca.SX(ca.vertcat(*found)))

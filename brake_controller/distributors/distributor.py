"""Definition of a distributor: data, and functions of a moment from which the C code of trains is generated.

A file in this folder has a parameter set, the function `whole` and, if it is cheaper, `empirical`, and a `Distributor`
that holds them. `uic.py` is the example. Trains may mix distributors.
"""

from __future__ import annotations

import math
import re
import traceback
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import PurePath
from typing import Any

from brake_controller.brake_pipe import Air, air_of
from fmu_src.chain import function_of
from fmu_src.symbols import ca
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

    adjustable : tuple of str
        Columns of a consist that set its parameters, among `registered.ADJUSTED`; all others of these are refused.
        `position` is accepted if `ready` has two sets.

    wired : bool
        Whether the command `demanded` controls it, with a dead time; its electric brake is blended.

    assisted : bool
        Whether the command `ordered` acts on the pipe at this vehicle.

    releases_wholly : bool
        Whether it releases as soon as the pipe rises, and not in part. Drivers do not reduce such a brake in part.

    vacuum : bool
        Whether its pipe is charged below ambient pressure.

    pressing : callable
        Function of the states and parameters for the absolute pressure that presses the brake [Pa]. It is there if
        this is not the state `cylinder`.

    drawing : callable
        Function of the parameters for the largest rate at which the pipe comes to rest with the distributor, times the
        volume of the pipe [m3/s], if it is not negligible.

    Raises
    ------
    ValueError
        If a name cannot be one, no state is the cylinder, two have one name, or an empirical form lacks its pace.
    """

    name: str
    parameters: type[DistributorParameters]
    states: tuple[tuple[str, str], ...]
    ready: Callable[[str], DistributorParameters]
    whole: Callable[[Moment], Answer]
    pace: Callable[[Any], float]
    empirical: Callable[[Moment], Answer] | None = None
    empirical_pace: float = 0.0
    adjustable: tuple[str, ...] = ()
    wired: bool = False
    assisted: bool = False
    releases_wholly: bool = False
    vacuum: bool = False
    pressing: Callable[[Mapping[str, ca.SX], Mapping[str, ca.SX]], ca.SX] | None = None
    drawing: Callable[[Any], float] | None = None

    def __post_init__(self) -> None:
        if not re.fullmatch(r"[a-z][a-z0-9_]*", self.name):
            raise ValueError(
                f"The name of a distributor must be small letters, digits and underscores; got {self.name!r}. "
                "Rename it."
            )
        starts = dict(self.states)
        if CYLINDER not in starts or not set(starts.values()) <= set(STARTS) or len(starts) < len(self.states):
            raise ValueError(
                f"States of a distributor must have different names and begin as {', '.join(STARTS)}, and one must be "
                f"called {CYLINDER}; got {self.states}. Correct them."
            )
        if self.empirical:
            self._check_pace("empirical_pace", self.empirical_pace)
        elif self.empirical_pace:
            raise ValueError(
                f"empirical_pace of the distributor {self.name} must come with empirical. Leave it out, or add it."
            )

    def brake_models(self) -> tuple[str, str]:
        """Return the form for the full brake model of a train, and that for the cheaper ones."""
        return ("whole", "empirical" if self.empirical else "whole")

    def fastest(self, parameters: DistributorParameters, brake_model: str) -> float:
        """Return the largest rate at which a state comes to rest [1/s] in a brake model.

        Raises ValueError if it is not above 0 and finite.
        """
        if brake_model != "whole" and self.empirical:
            return self.empirical_pace
        return self._check_pace("pace", self.pace(parameters))

    def _check_pace(self, what: str, value: float) -> float:
        if not 0.0 < value < math.inf:
            raise ValueError(
                f"{what} of the distributor {self.name} must be above 0 1/s and finite, as steps follow from it; got "
                f"{value:g} 1/s. Return the largest rate at which a state comes to rest."
            )
        return float(value)

    def drawn(self, parameters: DistributorParameters) -> float:
        """Return `drawing` of a distributor [m3/s], 0 without it."""
        return self.drawing(parameters) if self.drawing else 0.0

    def fields(self) -> tuple[str, ...]:
        """Return the names of its parameters in their order."""
        return tuple(self.parameters.__dataclass_fields__)

    def function(self, brake_model: str) -> ca.Function:
        """Return `whole` or `empirical` as a function of states, cell of the pipe, parameters and commands.

        Its result: rates of the states, and ANSWERED. Air in the cell is an ideal gas.

        Raises ValueError if the form fails, reads a name that does not exist, or lacks a rate or has another.
        """
        names = [name for name, _ in self.states]
        sizes = {"states": len(names), "pipe": 3, "given": len(self.fields()), "command": len(COMMANDED)}
        symbols = [ca.SX.sym(name, size) for name, size in sizes.items()]
        states = _Named(f"{brake_model} of the distributor {self.name}", "states", names, ca.vertsplit(symbols[0]))
        values = [*ca.vertsplit(symbols[2]), *ca.vertsplit(symbols[3])]
        given = _Named(states.whose, "given", [*self.fields(), *COMMANDED], values)
        found = self._answered(getattr(self, brake_model), Moment(states, air_of(symbols[1]), given), states.whose)
        return function_of(f"{self.name}_{brake_model}", symbols, ca.SX(ca.vertcat(*found)))

    def pressing_function(self) -> ca.Function:
        """Return `pressing` as a function of states and parameters."""
        assert self.pressing is not None
        states, given = ca.SX.sym("states", len(self.states)), ca.SX.sym("given", len(self.fields()))
        named = dict(zip((name for name, _ in self.states), ca.vertsplit(states), strict=True))
        pressure = self.pressing(named, dict(zip(self.fields(), ca.vertsplit(given), strict=True)))
        return function_of(f"{self.name}_pressing", [states, given], pressure)

    def _answered(self, form: Callable[[Moment], Answer], moment: Moment, whose: str) -> list[ca.SX]:
        """Return the rates in the order of the states, and ANSWERED. Raises ValueError with one message for a fault."""
        try:
            answer = form(moment)
        except _AbsentError:
            raise
        except Exception as error:
            if "truth value" in str(error):
                raise ValueError(
                    f"{whose} must not branch on a symbol by if, and, or, min or max ({_place_of(error)}). Write "
                    "ca.if_else, ca.fmin or ca.fmax."
                ) from error
            raise ValueError(
                f"{whose} fails in {_place_of(error)}: {type(error).__name__}: {error}. Correct it there."
            ) from error
        names = [name for name, _ in self.states]
        rates = getattr(answer, "rates", {})
        lacking, more = [one for one in names if one not in rates], [rate for rate in rates if rate not in names]
        if lacking or more:
            wrong = [f"it lacks {', '.join(lacking)}"] * bool(lacking) + [f"it has {', '.join(more)} too"] * bool(more)
            raise ValueError(
                f"{whose} must return an Answer with a rate for each of {', '.join(names)}; {' and '.join(wrong)}. "
                "Correct its rates."
            )
        numbers = {f"the rate of {one}": rates[one] for one in names} | {one: getattr(answer, one) for one in ANSWERED}
        for name, one in numbers.items():
            if not (isinstance(one, (int, float)) or (isinstance(one, (ca.SX, ca.DM)) and one.is_scalar())):
                raise ValueError(f"{whose} must return a number or a symbol for {name}; got {one!r}. Correct it.")
        return [ca.SX(number) for number in numbers.values()]


class _AbsentError(ValueError):
    """The message of a name that does not exist."""


class _Named(dict[str, Any]):
    """Symbols by name; a name that does not exist is refused with the names that do."""

    def __init__(self, whose: str, what: str, names: Iterable[str], symbols: Iterable[ca.SX]) -> None:
        super().__init__(zip(names, symbols, strict=True))
        self.whose, self._what = whose, what

    def __missing__(self, name: str) -> ca.SX:
        raise _AbsentError(
            f"{self.whose} reads {self._what}[{name!r}], which it lacks; there are {', '.join(self)}. Correct the name."
        )


def _place_of(error: BaseException) -> str:
    """Return the file and line of the equations in which an error occurred."""
    own = [one for one in traceback.extract_tb(error.__traceback__) if "casadi" not in one.filename]
    return f"{PurePath(own[-1].filename).name}, line {own[-1].lineno}"
